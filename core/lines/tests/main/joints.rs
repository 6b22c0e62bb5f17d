//! Which line goes on where several meet: corners, overlapping parts, crossings of several lines.

use super::common::{Line, covered, draw, line, ring, white};
use rototoon_base::geometry::{Point, polyline};
use rototoon_lines::{Options, Stroke, Style, trace};
use std::sync::Arc;

fn traced(lines: &[Line]) -> Vec<Stroke> {
    trace(draw(240, 200, lines, white), &Options { style: Style::Clean, ..Options::default() })
}

/// Whether one stroke covers the line.
fn is_whole(strokes: &[Stroke], line: &Line) -> bool {
    strokes.iter().any(|s| covered(&line.points, line.closed, &s.points, s.closed, 2.5) > 0.93)
}

fn lengths(strokes: &[Stroke]) -> Vec<f64> {
    strokes.iter().map(|s| polyline::length(&s.points, s.closed).round()).collect()
}

#[test]
fn a_sharp_corner_whose_sides_run_together_is_one_stroke() {
    for half_angle in [6.0f64, 10.0, 20.0] {
        let side =
            |sign: f64| Point::new(120.0, 180.0) + 150.0 * Point::from_angle((-90.0 + sign * half_angle).to_radians());
        let (a, b) = (side(-1.0), side(1.0));
        let corner = line(&[(a.x, a.y), (120.0, 180.0), (b.x, b.y)]);
        let strokes = traced(std::slice::from_ref(&corner));
        assert_eq!(strokes.len(), 1, "{half_angle}: {:?}", lengths(&strokes));
        assert!(is_whole(&strokes, &corner), "{half_angle}");
    }
}

#[test]
fn a_third_line_at_a_sharp_corner_is_not_its_tip() {
    // Arrows: nothing is lost, and no stroke goes where no line is.
    // Most barbs are no longer than the ink that all three lines share, as the tip of a corner would be.
    let arrows = [(25.0, 16.0), (25.0, 20.0), (25.0, 24.0), (30.0, 14.0), (30.0, 16.0), (30.0, 20.0), (30.0, 24.0)];
    let turned = |(spread, barb)| (0..12).map(move |k| (30.0 * f64::from(k) + 7.0, spread, barb));
    for (turn, spread, barb) in arrows.into_iter().flat_map(turned) {
        let tip = Point::new(120.0, 100.0);
        let side = |degrees: f64, length: f64| {
            let end = tip + length * Point::from_angle((turn + degrees).to_radians());
            line(&[(tip.x, tip.y), (end.x, end.y)])
        };
        let arrow = [side(0.0, 60.0), side(spread, barb), side(-spread, barb)];
        let strokes = traced(&arrow);
        let off = |p: &Point, lines: &mut dyn Iterator<Item = (&[Point], bool)>| {
            lines.map(|(points, closed)| polyline::distance(*p, points, closed)).fold(f64::INFINITY, f64::min)
        };
        let drawn = || arrow.iter().map(|line| (&line.points[..], false));
        let found = || strokes.iter().map(|stroke| (&stroke.points[..], stroke.closed));
        let dense = arrow.iter().flat_map(|line| polyline::resample(&line.points, false, 40));
        let missed = dense.map(|p| off(&p, &mut found())).fold(0.0, f64::max);
        let beside = strokes.iter().flat_map(|s| &s.points).map(|p| off(p, &mut drawn())).fold(0.0, f64::max);
        // Near the tip the three run together.
        assert!(missed < 8.5 && beside < 2.2, "turned by {turn}, barbs of {barb} px at {spread}°: {missed}, {beside}");
    }
}

#[test]
fn a_corner_that_touches_a_line_is_one_stroke() {
    let bar = line(&[(20.0, 150.0), (220.0, 150.0)]);
    let corner = line(&[(70.0, 40.0), (120.0, 150.0), (180.0, 50.0)]);
    let strokes = traced(&[bar.clone(), corner.clone()]);
    assert_eq!(strokes.len(), 2, "{:?}", lengths(&strokes));
    assert!(is_whole(&strokes, &bar) && is_whole(&strokes, &corner));
}

/// A round outline, open where `gap` degrees around `middle` are hidden behind something else.
fn arc(centre: Point, radius: f64, middle: f64, gap: f64) -> Line {
    let at = |k: i32| {
        centre + radius * Point::from_angle((middle + 0.5 * gap + f64::from(k) * (360.0 - gap) / 80.0).to_radians())
    };
    let points: Vec<(f64, f64)> = (0..=80).map(|k| (at(k).x, at(k).y)).collect();
    line(&points)
}

#[test]
fn the_outline_of_the_part_in_front_goes_on() {
    // Two discs, the left one over the right one.
    let front = ring(Point::new(95.0, 100.0), 55.0);
    let overlap = 2.0 * (0.5f64 * 80.0 / 55.0).acos().to_degrees();
    let back = arc(Point::new(175.0, 100.0), 55.0, 180.0, overlap);
    let strokes = traced(&[front.clone(), back.clone()]);
    assert_eq!(strokes.len(), 2, "{:?}", lengths(&strokes));
    assert!(is_whole(&strokes, &front) && is_whole(&strokes, &back));
}

#[test]
fn three_lines_through_nearly_one_point_go_straight_on() {
    for shift in [0.0, 2.0, 4.0] {
        let lines = [
            line(&[(20.0, 100.0), (220.0, 100.0)]),
            line(&[(70.0, 20.0), (170.0, 180.0 + shift)]),
            line(&[(170.0 + shift, 20.0), (70.0 + shift, 180.0)]),
        ];
        let strokes = traced(&lines);
        assert_eq!(strokes.len(), 3, "{shift}: {:?}", lengths(&strokes));
        assert!(lines.iter().all(|line| is_whole(&strokes, line)), "{shift}");
    }
}

#[test]
fn lines_of_other_colours_are_other_lines() {
    // The red line leaves the blue one at an angle at which lines of one colour would be one.
    let blue = [0.2, 0.3, 0.9];
    let lines = [
        Line { colour: blue, ..line(&[(20.0, 100.0), (120.0, 100.0), (220.0, 130.0)]) },
        Line { colour: [0.9, 0.2, 0.2], ..line(&[(120.0, 100.0), (220.0, 88.0)]) },
    ];
    let strokes = traced(&lines);
    assert!(lines.iter().all(|line| is_whole(&strokes, line)), "{:?}", lengths(&strokes));
    let first = strokes.iter().find(|s| covered(&lines[0].points, false, &s.points, false, 2.5) > 0.93).unwrap();
    assert!(!is_whole(std::slice::from_ref(first), &lines[1]));
}

#[test]
fn two_dots_are_no_line() {
    // The eyes of a face: discs, which are broader than the lines and not so broad that they are solid blacks.
    for (half, radius) in (8..22).flat_map(|half| [3.0, 4.0, 5.0, 6.0].map(|radius| (f64::from(half), radius))) {
        let eyes = [-1.0, 1.0].map(|side| Point::new(120.3 + side * half, 90.4));
        let mut picture = draw(240, 200, &[ring(Point::new(120.0, 100.0), 70.0)], white).as_ref().clone();
        for (x, y) in (0..200).flat_map(|y| (0..240).map(move |x| (x, y))) {
            let at = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let ink = eyes.iter().map(|eye| radius + 0.5 - at.distance(*eye)).fold(0.0, f64::max).min(1.0) as f32;
            picture.set(x, y, picture.get(x, y).map(|value| value.min(1.0 - 0.9 * ink)));
        }
        if 2.0 * half < 2.0 * radius + 5.0 {
            continue;
        }
        let strokes = trace(Arc::new(picture), &Options { style: Style::Clean, ..Options::default() });
        let wide = |s: &Stroke| s.points.iter().any(|p| p.distance(Point::new(120.3, 90.4)) < 0.5 * half);
        assert!(!strokes.iter().any(wide), "{half} px from the middle, {radius} px: {:?}", lengths(&strokes));
    }
}

#[test]
fn a_dot_is_a_stroke() {
    let dot = Line { width: 9.0, ..line(&[(60.0, 60.0), (60.5, 60.0)]) };
    let strokes = traced(&[line(&[(20.0, 150.0), (220.0, 150.0)]), dot]);
    assert_eq!(strokes.len(), 2, "{:?}", lengths(&strokes));
    let dot = strokes.iter().find(|s| polyline::length(&s.points, false) < 5.0).expect("a dot");
    assert!(dot.points[0].distance(Point::new(60.25, 60.0)) < 2.0, "{:?}", dot.points);
    assert!((dot.widths[0] - 9.0).abs() < 2.5, "{:?}", dot.widths);
}
