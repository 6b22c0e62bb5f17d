//! Closed outlines with fewer points, by the method of Ramer (1972) and Douglas & Peucker (1973).
//!
//! Some points are fixed. Between them an outline is thinned span by span: where the farthest point of a span is farther from the
//! span's chord than allowed, it is kept, and both halves are spans. Two outlines that have a stretch between fixed points in
//! common, in whatever direction, keep the same points of it: each stretch is walked from its smaller end, and of equally far
//! points the smaller one is taken (by x, then by y). An outline without fixed points begins at its smallest point, so it too is
//! thinned like the hole that it fills.

use rototoon_base::geometry::{Point, polyline};
use std::cmp::Ordering;

/// A point of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// The place in pixels.
    pub at: Point,
    /// Whether it must stay.
    pub fixed: bool,
}

/// The points of a closed outline that keep it within a distance. An outline that would have fewer than three stays as it is.
pub fn thinned(outline: &[Vertex], within: f64) -> Vec<Point> {
    let start = (0..outline.len()).min_by(|&a, &b| {
        let (a, b) = (outline[a], outline[b]);
        b.fixed.cmp(&a.fixed).then(order(a.at, b.at))
    });
    let Some(start) = start else { return Vec::new() };
    let mut round = outline.to_vec();
    round.rotate_left(start);
    round.push(round[0]);
    let mut thin: Vec<Point> = Vec::new();
    let mut from = 0;
    for to in 1..round.len() {
        if round[to].fixed || to + 1 == round.len() {
            let stretch: Vec<Point> = round[from..=to].iter().map(|vertex| vertex.at).collect();
            let kept = stretch_thinned(stretch, within);
            thin.extend(&kept[..kept.len() - 1]);
            from = to;
        }
    }
    if thin.len() > 2 { thin } else { outline.iter().map(|vertex| vertex.at).collect() }
}

/// The points of a stretch that keep it within a distance, with its ends. If both ends are one place, the walk is to the
/// point that is farthest from it, and back.
fn stretch_thinned(mut stretch: Vec<Point>, within: f64) -> Vec<Point> {
    let last = stretch.len() - 1;
    let turned = order(stretch[0], stretch[last]).then(order(stretch[1], stretch[last - 1])).is_gt();
    if turned {
        stretch.reverse();
    }
    let mut kept = vec![false; stretch.len()];
    kept[0] = true;
    kept[last] = true;
    let mut spans = vec![(0, last)];
    if stretch[0] == stretch[last]
        && let Some((_, far)) = farthest(&stretch, 0, last)
    {
        kept[far] = true;
        spans = vec![(0, far), (far, last)];
    }
    while let Some((from, to)) = spans.pop() {
        if let Some((_, k)) = farthest(&stretch, from, to).filter(|farthest| farthest.0 > within) {
            kept[k] = true;
            spans.extend([(from, k), (k, to)]);
        }
    }
    let mut thin: Vec<Point> = stretch.into_iter().zip(kept).filter(|own| own.1).map(|own| own.0).collect();
    if turned {
        thin.reverse();
    }
    thin
}

/// The point between two others that is farthest from the line between them, and how far it is.
fn farthest(points: &[Point], from: usize, to: usize) -> Option<(f64, usize)> {
    let away = |k: usize| points[k].distance(polyline::nearest_on_segment(points[k], points[from], points[to]));
    let farther = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(order(points[b.1], points[a.1]));
    (from + 1..to).map(|k| (away(k), k)).max_by(farther)
}

/// By x, then by y.
fn order(a: Point, b: Point) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn free(points: &[(f64, f64)]) -> Vec<Vertex> {
        points.iter().map(|&(x, y)| Vertex { at: Point::new(x, y), fixed: false }).collect()
    }

    #[test]
    fn an_outline_keeps_its_corners() {
        let square: Vec<(f64, f64)> = (0..40)
            .map(|k| match k / 10 {
                0 => (f64::from(k), 0.0),
                1 => (10.0, f64::from(k - 10)),
                2 => (f64::from(30 - k), 10.0),
                _ => (0.0, f64::from(40 - k)),
            })
            .collect();
        assert_eq!(thinned(&free(&square), 0.5).len(), 4);
        let mut fixed = free(&square);
        fixed[13].fixed = true;
        assert_eq!(thinned(&fixed, 0.5).len(), 5);
    }

    #[test]
    fn a_sliver_does_not_vanish() {
        assert_eq!(thinned(&free(&[(0.0, 0.0), (5.0, -0.2), (9.0, 0.0), (5.0, 0.2)]), 0.5).len(), 4);
        assert_eq!(thinned(&free(&[(1.0, 2.0)]), 0.5), [Point::new(1.0, 2.0)]);
        assert!(thinned(&[], 0.5).is_empty());
    }

    proptest! {
        #[test]
        fn a_border_is_the_same_from_both_sides(
            heights in prop::collection::vec(-3i32..4, 3..30), within in 0.2f64..2.0,
        ) {
            // One region above a border of steps and one below it. Equal heights make ties.
            let border: Vec<Vertex> = heights.iter().enumerate().map(|(k, &y)| {
                Vertex { at: Point::new(k as f64, 0.5 * f64::from(y)), fixed: k == 0 || k + 1 == heights.len() }
            }).collect();
            let right = heights.len() as f64;
            let beyond = |y: f64| [(right, y), (-1.0, y)].map(|(x, y)| Vertex { at: Point::new(x, y), fixed: false });
            let (mut above, mut below) = (border.clone(), border.clone());
            below.reverse();
            above.extend(beyond(-9.0));
            below.extend(beyond(9.0).into_iter().rev());
            let of_border = |outline: &[Vertex]| {
                let mut kept: Vec<Point> = thinned(outline, within);
                kept.retain(|p| p.y.abs() < 5.0);
                kept.sort_by(|a, b| order(*a, *b));
                kept
            };
            let kept = of_border(&above);
            prop_assert_eq!(&kept, &of_border(&below));
            for vertex in &border {
                prop_assert!(polyline::distance(vertex.at, &kept, false) <= within);
            }
        }

        #[test]
        fn a_hole_is_thinned_like_what_fills_it(steps in prop::collection::vec(0u8..4, 6..40), start in 0usize..40) {
            // Around a middle, at a radius of 4 to 7.
            let count = steps.len();
            let outline: Vec<Vertex> = steps.iter().enumerate().map(|(k, &r)| {
                let angle = std::f64::consts::TAU * k as f64 / count as f64;
                Vertex { at: (4.0 + f64::from(r)) * Point::from_angle(angle), fixed: false }
            }).collect();
            let mut hole = outline.clone();
            hole.rotate_left(start % count);
            hole.reverse();
            let sorted = |mut points: Vec<Point>| {
                points.sort_by(|a, b| order(*a, *b));
                points
            };
            prop_assert_eq!(sorted(thinned(&outline, 1.0)), sorted(thinned(&hole, 1.0)));
        }
    }
}
