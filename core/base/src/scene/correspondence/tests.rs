//! A synthetic figure, redrawn in many ways.

use super::*;
use proptest::prelude::*;

/// A limb from `a` to `b`, thicker at `a`, as a closed contour of `count` points.
fn limb(a: (f64, f64), b: (f64, f64), wide: f64, narrow: f64, count: usize) -> DrawnContour {
    let (a, b) = (Point::new(a.0, a.1), Point::new(b.0, b.1));
    let side = (b - a).normalize().perp();
    let corners = [a + side * wide, b + side * narrow, b - side * narrow, a - side * wide];
    DrawnContour { points: polyline::resample(&corners, true, count), closed: true, ..Default::default() }
}

fn oval(centre: (f64, f64), size: (f64, f64), count: usize) -> DrawnContour {
    let at = |k: usize| Point::from_angle(k as f64 * std::f64::consts::TAU / count as f64);
    let points = (0..count).map(|k| Point::new(centre.0, centre.1) + at(k) * Point::new(size.0, size.1)).collect();
    DrawnContour { points, closed: true, ..Default::default() }
}

fn line(points: &[(f64, f64)]) -> DrawnContour {
    DrawnContour {
        points: points.iter().map(|&(x, y)| Point::new(x, y)).collect(),
        closed: false,
        ..Default::default()
    }
}

/// Ten parts; arms, legs, and eyes are nearly equal.
fn figure() -> Vec<DrawnContour> {
    vec![
        oval((200.0, 80.0), (34.0, 54.0), 14),
        limb((200.0, 130.0), (200.0, 260.0), 45.0, 30.0, 16),
        limb((160.0, 145.0), (100.0, 220.0), 12.0, 8.0, 12),
        limb((240.0, 145.0), (300.0, 220.0), 12.0, 8.0, 12),
        limb((180.0, 260.0), (165.0, 380.0), 16.0, 10.0, 12),
        limb((220.0, 260.0), (235.0, 380.0), 16.0, 10.0, 12),
        oval((185.0, 70.0), (6.0, 9.0), 8),
        oval((215.0, 70.0), (6.0, 9.0), 8),
        line(&[(180.0, 100.0), (195.0, 108.0), (210.0, 107.0), (222.0, 98.0)]),
        limb((150.0, 20.0), (250.0, 40.0), 14.0, 6.0, 10),
    ]
}

/// A simple generator, since tests must not depend on the random numbers of a library.
struct Lots(u64);

impl Lots {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) % below as u64) as usize
    }

    fn shuffled(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            order.swap(i, self.next(i + 1));
        }
        order
    }
}

/// The contour with another start and direction.
fn redrawn(contour: &DrawnContour, lots: &mut Lots) -> DrawnContour {
    let mut result = contour.clone();
    if contour.closed {
        result.points.rotate_left(lots.next(contour.points.len()));
    }
    if lots.next(2) == 1 {
        result.points.reverse();
    }
    result
}

/// The moved figure. In addition every part rotates and shifts a little by itself.
fn moved(parts: &[DrawnContour], turn: f64, scale: f64, loose: f64, lots: &mut Lots) -> Vec<DrawnContour> {
    let middle = Point::new(200.0, 200.0);
    let mut unit = || lots.next(2001) as f64 / 1000.0 - 1.0;
    let mut result = parts.to_vec();
    for contour in &mut result {
        let centre = crate::geometry::polygon::center(&contour.points);
        let (own, shift) = (Point::from_angle(0.35 * loose * unit()), loose * Point::new(unit(), unit()) * 8.0);
        for p in &mut contour.points {
            let local = own.rotate(*p - centre) + centre + shift;
            *p = (Point::from_angle(turn) * scale).rotate(local - middle) + Point::new(350.0, 260.0);
        }
    }
    result
}

/// Asserts that every part finds its contour, and that its points are within `tolerance` px of the truth.
fn check(parts: &[DrawnContour], truth: &[DrawnContour], drawn: &[DrawnContour], order: &[usize], tolerance: f64) {
    let found = match_contours(parts, drawn, &MatchOptions::default()).unwrap();
    for (i, found) in found.iter().enumerate() {
        let found = found.as_ref().unwrap_or_else(|| panic!("part {i} has no counterpart"));
        assert_eq!(order[found.drawn], i, "part {i}, cost {}", found.cost);
        assert_eq!(found.points.len(), parts[i].points.len());
        for (k, (p, q)) in found.points.iter().zip(&truth[i].points).enumerate() {
            assert!(p.distance(*q) <= tolerance, "part {i}, point {k}: {p} instead of {q}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn redrawn_contours_give_back_their_own_points(seed in any::<u64>(), degrees in -60i32..=60, grown in 70u32..150) {
        let mut lots = Lots(seed);
        let parts = figure();
        let truth = moved(&parts, f64::from(degrees).to_radians(), f64::from(grown) / 100.0, 0.0, &mut lots);
        let order = lots.shuffled(parts.len());
        let drawn: Vec<_> = order.iter().map(|&i| redrawn(&truth[i], &mut lots)).collect();
        check(&parts, &truth, &drawn, &order, 0.0);
    }

    #[test]
    fn resampled_contours_of_a_posed_figure_are_matched(seed in any::<u64>(), degrees in -60i32..=60) {
        let mut lots = Lots(seed);
        let parts = figure();
        let truth = moved(&parts, f64::from(degrees).to_radians(), 1.0, 1.0, &mut lots);
        let order = lots.shuffled(parts.len());
        let drawn: Vec<_> = order
            .iter()
            .map(|&i| {
                let mut contour = redrawn(&truth[i], &mut lots);
                let count = 40 + lots.next(60);
                contour.points = polyline::resample(&contour.points, contour.closed, count);
                contour
            })
            .collect();
        check(&parts, &truth, &drawn, &order, 8.0);
    }
}

#[test]
fn what_was_not_drawn_stays_without_counterpart() {
    let parts = figure();
    let mut drawn = parts.clone();
    drawn.remove(8);
    drawn.remove(3);
    drawn.push(line(&[(900.0, 900.0), (1200.0, 950.0)]));
    let found = match_contours(&parts, &drawn, &MatchOptions::default()).unwrap();
    let indices: Vec<_> = found.iter().map(|m| m.as_ref().map(|m| m.drawn)).collect();
    assert_eq!(indices, [Some(0), Some(1), Some(2), None, Some(3), Some(4), Some(5), Some(6), None, Some(7)]);
    assert!(found.iter().flatten().all(|m| m.cost < 1e-6 && m.points == drawn[m.drawn].points));
}

#[test]
fn colour_tells_equal_shapes_apart_where_place_does_not() {
    let coloured = |x: f64, colour| DrawnContour { colour: Some(colour), ..oval((x, 50.0), (20.0, 10.0), 8) };
    let (red, blue) = ([0.9, 0.1, 0.1], [0.1, 0.2, 0.9]);
    let parts = [coloured(100.0, red), coloured(106.0, blue)];
    let drawn = [coloured(100.0, blue), coloured(106.0, red)];
    let found = match_contours(&parts, &drawn, &MatchOptions::default()).unwrap();
    assert_eq!(found.iter().map(|m| m.as_ref().unwrap().drawn).collect::<Vec<_>>(), [1, 0]);
}

#[test]
fn a_closed_part_may_be_drawn_with_a_small_gap() {
    let part = oval((100.0, 100.0), (40.0, 25.0), 10);
    let mut drawn = oval((130.0, 90.0), (40.0, 25.0), 60);
    drawn.closed = false;
    drawn.points.truncate(58);
    let found = match_contours(std::slice::from_ref(&part), &[drawn], &MatchOptions::default()).unwrap();
    let points = &found[0].as_ref().unwrap().points;
    for (p, q) in points.iter().zip(&part.points) {
        assert!(p.distance(*q + Point::new(30.0, -10.0)) < 4.0, "{p} instead of {q}");
    }
}

#[test]
fn degenerate_contours_are_served() {
    let options = MatchOptions::default();
    assert_eq!(match_contours(&[], &figure(), &options), Ok(vec![]));
    assert_eq!(match_contours(&figure()[..1], &[], &options), Ok(vec![None]));
    let dot = line(&[(5.0, 5.0)]);
    let short = line(&[(50.0, 50.0), (70.0, 50.0)]);
    let flat = DrawnContour { closed: true, ..line(&[(0.0, 90.0), (50.0, 90.0), (20.0, 90.0)]) };
    let empty = DrawnContour::default();
    let parts = [dot.clone(), short.clone(), flat.clone(), empty.clone()];
    let drawn = [empty, flat.clone(), short.clone(), dot.clone()];
    let found = match_contours(&parts, &drawn, &options).unwrap();
    let indices: Vec<_> = found.iter().map(|m| m.as_ref().map(|m| m.drawn)).collect();
    assert_eq!(indices, [Some(3), Some(2), Some(1), None]);
    for (m, part) in found.iter().flatten().zip(&parts) {
        assert_eq!(m.points.len(), part.points.len());
    }
    let same = DrawnContour { closed: true, ..line(&[(3.0, 3.0); 4]) };
    let found = match_contours(std::slice::from_ref(&same), &[dot], &options).unwrap();
    assert_eq!(found[0].as_ref().map(|m| m.points.len()), Some(4));
}

#[test]
fn points_that_are_no_numbers_are_named() {
    let mut broken = figure();
    broken[3].points[2].y = f64::NAN;
    let error = match_contours(&broken, &figure(), &MatchOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "part 3: point 2 is not a pair of finite numbers");
    let error = match_contours(&figure(), &broken, &MatchOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "drawn contour 3: point 2 is not a pair of finite numbers");
}

/// Two legs of a walk in one place on the first drawing and apart on the next, below a body.
fn walking(labels: [&str; 2]) -> (Vec<DrawnContour>, Vec<DrawnContour>) {
    let leg = |foot: f64, label: &str| DrawnContour {
        labels: vec!["ink".into(), label.into()],
        ..limb((100.0, 100.0), (foot, 180.0), 9.0, 6.0, 12)
    };
    let body = oval((100.0, 60.0), (20.0, 40.0), 14);
    let [far, near] = labels;
    let passing = vec![body.clone(), leg(100.0, far), leg(100.0, near)];
    (passing, vec![body, leg(60.0, far), leg(140.0, near)])
}

#[test]
fn labels_tell_look_alikes_apart() {
    let (parts, drawn) = walking(["far leg", "near leg"]);
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0], [0, 2, 1]] {
        let shuffled: Vec<_> = order.iter().map(|&k| drawn[k].clone()).collect();
        let found = match_contours(&parts, &shuffled, &MatchOptions::default()).unwrap();
        let who: Vec<_> = found.into_iter().map(|found| order[found.unwrap().drawn]).collect();
        assert_eq!(who, [0, 1, 2], "{order:?}");
    }
    // Drawn on other layers, parts are where they are.
    let mut moved = figure();
    moved.iter_mut().enumerate().for_each(|(k, contour)| contour.labels = vec![format!("{k}")]);
    let mut again = moved.clone();
    again.iter_mut().for_each(|contour| contour.labels = vec!["one layer".into()]);
    let found = match_contours(&moved, &again, &MatchOptions::default()).unwrap();
    assert!(found.iter().enumerate().all(|(k, found)| found.as_ref().is_some_and(|found| found.drawn == k)));
}

#[test]
fn the_order_of_drawing_decides_where_nothing_else_does() {
    let (parts, drawn) = walking(["", ""]);
    let who = |drawn: &[DrawnContour]| -> Vec<usize> {
        let found = match_contours(&parts, drawn, &MatchOptions::default()).unwrap();
        found.into_iter().map(|found| found.unwrap().drawn).collect()
    };
    assert_eq!(who(&drawn), [0, 1, 2]);
    assert_eq!(who(&[drawn[0].clone(), drawn[2].clone(), drawn[1].clone()]), [0, 1, 2]);
}
