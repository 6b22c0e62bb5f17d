//! Straight lines with a corner at each end, for sections where no smooth curve fits.
//!
//! A chord between two of the points may replace all points between them if none is farther from it than the limit.
//! Each chord grows as long as this is true. Every point between is then within the limit of the chord. Perpendicular
//! to every place of the chord there is a place of the points' line, so the chord is within the limit of the line too.
//! The guarantee is valid in both directions.

use super::grow::grow;
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::nearest_on_segment;

/// The vertices of a chain of chords, by index of their points: the first point, the last point and some between.
pub(super) fn vertices(points: &[Point], limit: f64) -> Vec<usize> {
    let last = points.len() - 1;
    let mut chosen = vec![0];
    let mut start = 0;
    while start < last {
        start = farthest(points, start, limit);
        chosen.push(start);
    }
    chosen
}

fn farthest(points: &[Point], start: usize, limit: f64) -> usize {
    let last = points.len() - 1;
    let fits = |end: usize| {
        let (a, b) = (points[start], points[end]);
        points[start + 1..end].iter().all(|&p| p.distance(nearest_on_segment(p, a, b)) <= limit)
    };
    grow(start, last, 2, |_| 1, fits)
}

/// The parameters of the points on the chords. Each chord has two pieces, which are straight half legs between corners.
pub(super) fn parameters(points: &[Point], vertices: &[usize]) -> Vec<f64> {
    let mut all = Vec::with_capacity(points.len());
    for (edge, pair) in vertices.windows(2).enumerate() {
        let (a, b) = (points[pair[0]], points[pair[1]]);
        let length = (b - a).length_squared();
        for &p in &points[pair[0]..pair[1]] {
            let share = if length > 0.0 { ((p - a).dot(b - a) / length).clamp(0.0, 1.0) } else { 0.0 };
            let u = if share <= 0.5 { (2.0 * share).sqrt() } else { 2.0 - (2.0 * (1.0 - share)).sqrt() };
            all.push(2.0 * edge as f64 + u);
        }
    }
    all.push(2.0 * (vertices.len() - 1) as f64);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_point_is_farther_from_its_chord_than_the_limit(
            points in prop::collection::vec((-20.0f64..20.0, -20.0f64..20.0), 2..60), limit in 0.1f64..10.0,
        ) {
            let points: Vec<Point> = points.into_iter().map(Point::from).collect();
            let chosen = vertices(&points, limit);
            prop_assert_eq!((chosen[0], chosen[chosen.len() - 1]), (0, points.len() - 1));
            for pair in chosen.windows(2) {
                prop_assert!(pair[0] < pair[1]);
                for &p in &points[pair[0]..=pair[1]] {
                    prop_assert!(p.distance(nearest_on_segment(p, points[pair[0]], points[pair[1]])) <= limit);
                }
            }
            let t = parameters(&points, &chosen);
            prop_assert_eq!(t.len(), points.len());
        }
    }
}
