//! Mean value coordinates: a point as a weighted mean of a polygon's corners (Hormann & Floater 2006, "Mean value
//! coordinates for arbitrary planar polygons").
//!
//! λ_i ∝ (tan(α_{i−1} / 2) + tan(α_i / 2)) / ‖v_i − p‖, with α_i the signed angle at p between the corners v_i and
//! v_{i+1}. The weights reproduce linear functions exactly, are smooth off the polygon, and need no mesh. Here they
//! carry what is known at the corners of a contour (how far it is off) to the points that go with it.
//!
//! Limits: weights can be negative in concave polygons. A point on an edge is a special case, handled as the mean of
//! the edge's ends.

use rototoon_base::geometry::Point;

/// A point this near to the polygon, as a share of the polygon's size, is on it.
const ON: f64 = 1e-9;

/// The weights of the corners; their sum is 1. Empty for a polygon without corners.
pub fn weights(polygon: &[Point], p: Point) -> Vec<f64> {
    let n = polygon.len();
    let size = polygon.iter().map(|v| v.distance(p)).fold(0.0, f64::max);
    let mut found = vec![0.0; n];
    if let Some(corner) = polygon.iter().position(|v| v.distance(p) <= ON * size) {
        found[corner] = 1.0;
        return found;
    }
    let way = |k: usize| polygon[k % n] - p;
    let straight = |k: usize| way(k).perp_dot(way(k + 1)).abs() <= ON * size * size;
    // Between the ends of an edge.
    if let Some(k) = (0..n).find(|&k| straight(k) && way(k).dot(way(k + 1)) < 0.0) {
        let (a, b) = (way(k).length(), way(k + 1).length());
        found[k] = b / (a + b);
        found[(k + 1) % n] = a / (a + b);
        return found;
    }
    // tan(α / 2) = (r s − a · b) / (a × b)
    let tangent = |k: usize| {
        let (a, b) = (way(k), way(k + 1));
        if straight(k) { 0.0 } else { (a.length() * b.length() - a.dot(b)) / a.perp_dot(b) }
    };
    for (k, weight) in found.iter_mut().enumerate() {
        *weight = (tangent((k + n - 1) % n) + tangent(k)) / way(k).length();
    }
    let total: f64 = found.iter().sum();
    if total.abs() > 0.0 && total.is_finite() {
        found.iter_mut().for_each(|w| *w /= total);
    } else {
        found.fill(1.0 / n as f64);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn points_are_reproduced(x in -3.0f64..9.0, y in -3.0f64..9.0) {
            let corners = [(0.0, 0.0), (6.0, 1.0), (7.0, 5.0), (3.0, 3.5), (1.0, 6.0)].map(|(x, y)| Point::new(x, y));
            let found = weights(&corners, Point::new(x, y));
            let again: Point = corners.iter().zip(&found).map(|(v, w)| *v * *w).sum();
            prop_assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            prop_assert!(again.distance(Point::new(x, y)) < 1e-6, "{again}");
        }
    }

    #[test]
    fn corners_and_edges_are_exact() {
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, y)| Point::new(x, y));
        assert_eq!(weights(&square, square[2]), [0.0, 0.0, 1.0, 0.0]);
        assert_eq!(weights(&square, Point::new(1.0, 0.0)), [0.75, 0.25, 0.0, 0.0]);
        assert_eq!(weights(&[], Point::ZERO), Vec::<f64>::new());
    }
}
