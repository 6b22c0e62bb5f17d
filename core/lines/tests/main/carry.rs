//! Strokes carried over drawings whose lines are known on every frame.

use super::common::{Line, covered, draw, line, ring, white};
use rototoon_base::geometry::{Point, polyline};
use rototoon_lines::{Drawing, Options, Stroke, Tracked, carry, identify};

/// A figure: head, two eyes, body, arms, legs, a crossing belt.
fn figure() -> Vec<Line> {
    let curve = |points: &[(f64, f64)]| line(points);
    vec![
        ring(Point::new(200.0, 80.0), 42.0),
        ring(Point::new(185.0, 72.0), 6.0),
        ring(Point::new(216.0, 72.0), 6.0),
        curve(&[(182.0, 98.0), (200.0, 105.0), (220.0, 97.0)]),
        curve(&[(170.0, 125.0), (150.0, 190.0), (165.0, 260.0)]),
        curve(&[(230.0, 125.0), (252.0, 190.0), (238.0, 260.0)]),
        curve(&[(140.0, 215.0), (200.0, 226.0), (262.0, 212.0)]),
        curve(&[(160.0, 150.0), (105.0, 175.0), (70.0, 235.0)]),
        curve(&[(242.0, 150.0), (300.0, 165.0), (345.0, 225.0)]),
        curve(&[(165.0, 260.0), (150.0, 330.0), (160.0, 390.0), (130.0, 394.0)]),
        curve(&[(238.0, 260.0), (255.0, 330.0), (250.0, 390.0), (282.0, 395.0)]),
        curve(&[(165.0, 260.0), (201.0, 290.0), (238.0, 260.0)]),
    ]
}

/// The figure at a time: it walks, leans, and swings its arms.
fn posed(time: f64) -> Vec<Line> {
    let hip = Point::new(200.0, 250.0);
    let place = |k: usize, p: Point| {
        let swing = match k {
            7 => Some((Point::new(160.0, 150.0), 0.16)),
            8 => Some((Point::new(242.0, 150.0), -0.14)),
            _ => None,
        };
        let p = swing.map_or(p, |(joint, turn)| joint + Point::from_angle(turn * time).rotate(p - joint));
        let lean = Point::from_angle(0.05 * time).rotate(p - hip);
        hip + Point::new(lean.x, lean.y * (1.0 - 0.015 * time)) + Point::new(9.0 * time, -4.0 * time)
    };
    let moved = |(k, line): (usize, Line)| {
        let points = polyline::resample(&line.points, line.closed, 40);
        Line { points: points.into_iter().map(|p| place(k, p)).collect(), ..line }
    };
    figure().into_iter().enumerate().map(moved).collect()
}

fn drawing(lines: &[Line]) -> Drawing {
    Drawing::new(draw(460, 420, lines, white), &Options::default())
}

fn tracked(lines: &[Line]) -> Vec<Tracked> {
    let stroke = |line: &Line| Stroke { points: line.points.clone(), closed: line.closed, ..Stroke::default() };
    lines.iter().enumerate().map(|(track, line)| Tracked::sure(track, stroke(line))).collect()
}

/// The share of the length of `lines` that lies on the stroke with its number.
fn right(strokes: &[Tracked], lines: &[Line]) -> f64 {
    let (mut good, mut all) = (0.0, 0.0);
    for (k, line) in lines.iter().enumerate() {
        let length = polyline::length(&line.points, line.closed);
        all += length;
        if let Some(found) = strokes.iter().find(|s| s.track == k) {
            good += length * covered(&line.points, line.closed, &found.stroke.points, found.stroke.closed, 2.5);
        }
    }
    good / all
}

#[test]
fn strokes_keep_their_numbers_over_four_drawings() {
    let (mut from, mut strokes, mut next) = (drawing(&posed(0.0)), tracked(&posed(0.0)), 12);
    for time in 1..=4 {
        let lines = posed(f64::from(time));
        let to = drawing(&lines);
        strokes = carry(&from, &strokes, &to, &mut next);
        let share = right(&strokes, &lines);
        assert!(share >= 0.95, "drawing {time}: {share}");
        from = to;
    }
    assert!(next <= 14, "{} strokes are new in a drawing that has none", next - 12);
}

#[test]
fn a_stroke_without_ink_ends_and_new_ink_is_a_new_stroke() {
    let before = posed(0.0);
    let mut after = posed(1.0);
    after.remove(3);
    after.push(line(&[(60.0, 40.0), (90.0, 100.0), (60.0, 120.0)]));
    let mut next = 12;
    let strokes = carry(&drawing(&before), &tracked(&before), &drawing(&after), &mut next);
    assert!(strokes.iter().all(|s| s.track != 3), "the mouth is gone");
    let new: Vec<&Tracked> = strokes.iter().filter(|s| s.track >= 12).collect();
    let last = &after[after.len() - 1];
    assert!(new.iter().any(|s| covered(&last.points, false, &s.stroke.points, false, 2.0) > 0.9), "{new:?}");
}

#[test]
fn a_held_drawing_changes_nothing() {
    let lines = posed(2.0);
    let mut next = 12;
    let strokes = carry(&drawing(&lines), &tracked(&lines), &drawing(&lines), &mut next);
    assert!(right(&strokes, &lines) > 0.99);
    assert_eq!(next, 12);
}

#[test]
fn lines_with_paint_in_them_are_carried_as_lines() {
    let (before, after) = (posed(0.0), posed(1.0));
    let mut painted = tracked(&before);
    painted.iter_mut().for_each(|s| s.stroke.fill = s.stroke.closed);
    let found = carry(&drawing(&before), &painted, &drawing(&after), &mut 12);
    assert!(right(&found[..], &after) > 0.95, "{}", right(&found, &after));
    assert!((0..3).all(|track| found.iter().any(|s| s.track == track && s.stroke.fill)), "head and eyes");
}

#[test]
fn the_order_of_the_strokes_changes_nothing() {
    // Far enough apart that much is in doubt.
    let (from, to) = (drawing(&posed(0.0)), drawing(&posed(3.5)));
    let strokes = tracked(&posed(0.0));
    let carried = |strokes: &[Tracked]| {
        let mut found = carry(&from, strokes, &to, &mut 12);
        found.sort_by_key(|stroke| stroke.track);
        found
    };
    let found = carried(&strokes);
    let turned: Vec<Tracked> = strokes.iter().rev().cloned().collect();
    let mixed: Vec<Tracked> = (0..12).map(|k| strokes[k * 5 % 12].clone()).collect();
    for other in [turned, mixed] {
        assert!(carried(&other) == found, "{} strokes", found.len());
        let kept: Vec<usize> = carry(&from, &other, &to, &mut 12).iter().map(|s| s.track).filter(|&k| k < 12).collect();
        let given = other.iter().map(|s| s.track).filter(|k| kept.contains(k));
        assert!(kept.iter().copied().eq(given), "they come in the order in which they went");
    }
}

#[test]
fn drawings_without_ink_end_all_strokes() {
    let lines = posed(0.0);
    let (full, empty) = (drawing(&lines), drawing(&[]));
    let mut next = 12;
    assert!(carry(&full, &tracked(&lines), &empty, &mut next).is_empty());
    let fresh = carry(&empty, &[], &full, &mut next);
    assert!(fresh.len() >= 10 && fresh[0].track == 12);
}

#[test]
fn drawn_strokes_get_the_numbers_of_what_they_lie_on() {
    let lines = posed(1.0);
    let mut carried = tracked(&lines);
    carried.iter_mut().for_each(|s| s.track += 100);
    let mut own: Vec<Stroke> = carried.iter().rev().map(|s| s.stroke.clone()).collect();
    own.push(Stroke { points: vec![Point::new(5.0, 5.0), Point::new(40.0, 9.0)], ..Stroke::default() });
    let mut next = 300;
    let found: Vec<usize> = identify(&carried, own, 420.0 / 540.0, &mut next).iter().map(|s| s.track).collect();
    let expected: Vec<usize> = (100..112).rev().chain([300]).collect();
    assert_eq!((found, next), (expected, 301));
}

#[test]
fn a_carried_line_is_thick_and_thin_where_its_own_drawing_is() {
    // On the first drawing it gets thicker to the right, on the second one to the left.
    let wedge = |down: f64, back: bool| -> Vec<Line> {
        let piece = |k: u32| {
            let x = 40.0 + 10.0 * f64::from(k);
            let width = 2.0 + 0.25 * f64::from(if back { 23 - k } else { k });
            Line { width, ..line(&[(x, 100.0 + down), (x + 10.0, 100.0 + down)]) }
        };
        (0..24).map(piece).collect()
    };
    let (from, to) = (drawing(&wedge(0.0, false)), drawing(&wedge(6.0, true)));
    let strokes = from.strokes();
    assert_eq!(strokes.len(), 1);
    let mut next = 1;
    let carried = carry(&from, &[Tracked::sure(0, strokes[0].clone())], &to, &mut next);
    assert_eq!(next, 1);
    for (stroke, back) in [(&strokes[0], false), (&carried[0].stroke, true)] {
        for (point, found) in stroke.points.iter().zip(&stroke.widths) {
            let place = (point.x - 40.0) / 10.0 - 0.5;
            let width = 2.0 + 0.25 * if back { 23.0 - place } else { place };
            assert!((found - width).abs() < 0.6, "{found} for {width} at {point}");
        }
    }
}
