//! Preparation of the points: no two equal points in a row, and no long gaps.
//!
//! Fitting looks at points only, but the tolerance is for the line through them. Long segments therefore get points in
//! between. These are at most [`SPACING`] tolerances apart, unless that would multiply the work ([`MOST`]). The final
//! measurement finds errors between them.

use rototoon_base::geometry::Point;

/// Intended largest spacing of points, in tolerances.
const SPACING: f64 = 6.0;
/// At most about this many points are added for each given one, plus [`FEW`].
const MOST: f64 = 3.0;
const FEW: f64 = 200.0;
/// A segment is long beside the usual one if it is longer than this multiple of the median.
const USUAL: f64 = 2.0;

/// A polyline prepared for fitting.
#[derive(Clone, Debug)]
pub(super) struct Cleaned {
    /// Points without repetitions, with long segments filled. A closed polyline does not repeat its first point at the
    /// end.
    pub points: Vec<Point>,
    /// Arc length at each point, in pixels.
    pub lengths: Vec<f64>,
    /// Length of the complete polyline, including the closing segment.
    pub total: f64,
    /// For each point that was given, the index of its like in `points`.
    pub places: Vec<usize>,
    /// A fit with a limit below this follows the noise of the points, in pixels. 0 where that is not known.
    pub floor: f64,
}

/// The points without repetitions, and for each given point the index of its copy.
pub(super) fn distinct(points: &[Point], closed: bool) -> (Vec<Point>, Vec<usize>) {
    let mut kept: Vec<Point> = Vec::with_capacity(points.len());
    let mut places = Vec::with_capacity(points.len());
    for &p in points {
        if kept.last() != Some(&p) {
            kept.push(p);
        }
        places.push(kept.len() - 1);
    }
    while closed && kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    places.iter_mut().filter(|place| **place >= kept.len()).for_each(|place| *place = 0);
    (kept, places)
}

/// Prepares a polyline of at least one point for fitting.
pub(super) fn cleaned(points: &[Point], closed: bool, tolerance: f64) -> Cleaned {
    prepared(points, closed, |_| SPACING * tolerance)
}

/// The same line with gaps filled that are long beside the usual step, whatever the tolerance.
pub(super) fn filled(points: &[Point], closed: bool) -> Cleaned {
    prepared(points, closed, |steps| {
        let length: f64 = steps.iter().sum();
        let middle = steps.len() / 2;
        let usual = if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 };
        (USUAL * usual).min(length / FEW)
    })
}

/// Prepares a polyline. `spacing` gives the intended largest spacing from the lengths of the segments.
fn prepared(points: &[Point], closed: bool, spacing: impl FnOnce(&mut [f64]) -> f64) -> Cleaned {
    let (kept, mut places) = distinct(points, closed);
    let n = kept.len();
    let segments = if closed && n > 1 { n } else { n - 1 };
    let mut steps: Vec<f64> = (0..segments).map(|i| kept[i].distance(kept[(i + 1) % n])).collect();
    let length: f64 = steps.iter().sum();
    let spacing = spacing(&mut steps).max(length / (MOST * n as f64 + FEW));
    let (mut all, mut lengths, mut indices) = (Vec::with_capacity(n), Vec::with_capacity(n), Vec::with_capacity(n));
    let mut walked = 0.0;
    for i in 0..segments {
        let (a, b) = (kept[i], kept[(i + 1) % n]);
        let step = a.distance(b);
        let parts = (step / spacing).ceil().max(1.0);
        indices.push(all.len());
        for k in 0..parts as usize {
            let share = k as f64 / parts;
            all.push(a.lerp(b, share));
            lengths.push(walked + step * share);
        }
        walked += step;
    }
    if segments < n {
        indices.push(all.len());
        all.push(kept[n - 1]);
        lengths.push(walked);
    }
    places.iter_mut().for_each(|place| *place = indices[*place]);
    Cleaned { points: all, lengths, total: walked, places, floor: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn repetitions_go_and_are_found_again() {
        let (a, b, c) = (Point::ZERO, Point::new(3.0, 0.0), Point::new(3.0, 4.0));
        let open = cleaned(&[a, a, b, b, b, c, a], false, 100.0);
        assert_eq!((open.points, open.places, open.total), (vec![a, b, c, a], vec![0, 0, 1, 1, 1, 2, 3], 12.0));
        let closed = cleaned(&[a, b, c, a, a], true, 100.0);
        assert_eq!((closed.points, closed.places, closed.total), (vec![a, b, c], vec![0, 1, 2, 0, 0], 12.0));
        assert_eq!(cleaned(&[b, b, b], true, 1.0).points, [b]);
    }

    proptest! {
        #[test]
        fn long_segments_are_filled_evenly(
            points in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 1..20), closed: bool, tolerance in 0.01f64..5.0,
        ) {
            let points: Vec<Point> = points.into_iter().map(Point::from).collect();
            let data = cleaned(&points, closed, tolerance);
            for (p, &place) in points.iter().zip(&data.places) {
                prop_assert!(data.points[place].distance(*p) < 1e-12);
            }
            prop_assert!(data.lengths.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(data.points.len() <= 5 * points.len() + 202);
        }
    }
}
