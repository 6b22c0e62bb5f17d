//! The point of a parabola piece nearest to a given point.
//!
//! At an inner nearest point the error is perpendicular to the tangent: (B(u) − p) · B′(u) = 0. With d = p0 − p this is
//! a cubic equation:
//!
//! d·b + (d·a + 2 b·b) u + 3 a·b u² + a·a u³ = 0.
//!
//! The candidates are its roots between 0 and 1 and both ends. There are up to three inner candidates: two nearest
//! points with a farthest one between them. Straight pieces, folded pieces and points are the cases a ∥ b and a = 0.
//! The root finder handles them like all others.

use super::{Quadratic, Spline};
use crate::geometry::Point;
use crate::numeric::roots::roots_in;

/// A nearest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Its parameter on the curve.
    pub parameter: f64,
    /// The point.
    pub point: Point,
    /// Its distance in pixels.
    pub distance: f64,
}

impl Quadratic {
    /// The point nearest to `p`. Among several the one with the smallest parameter counts.
    pub fn nearest(&self, p: Point) -> Nearest {
        let (a, b) = self.coefficients();
        let d = self.p0 - p;
        let cubic = [d.dot(b), d.dot(a) + 2.0 * b.dot(b), 3.0 * a.dot(b), a.dot(a)];
        let candidate = |u: f64| {
            let point = self.point(u);
            Nearest { parameter: u, point, distance: point.distance(p) }
        };
        let mut best = candidate(0.0);
        for &u in roots_in(&cubic, 0.0, 1.0).iter().chain([&1.0]) {
            let other = candidate(u);
            if other.distance < best.distance {
                best = other;
            }
        }
        best
    }
}

/// Distance of `p` from a box.
pub(super) fn box_distance(p: Point, (low, high): (Point, Point)) -> f64 {
    (low - p).max(p - high).max(Point::ZERO).length()
}

impl Spline {
    /// The point nearest to `p` among all pieces. Its parameter is that of the spline.
    pub fn nearest(&self, p: Point) -> Nearest {
        let first = self.piece(0).nearest(p);
        (1..self.piece_count()).fold(first, |best, i| {
            let piece = self.piece(i);
            if box_distance(p, piece.control_box()) >= best.distance {
                return best;
            }
            let found = piece.nearest(p);
            if found.distance < best.distance {
                Nearest { parameter: i as f64 + found.parameter, ..found }
            } else {
                best
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::quadratic::tests::any_piece;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn degenerate_pieces_have_nearest_points() {
        let point = Quadratic::new(Point::ONE, Point::ONE, Point::ONE);
        assert_eq!(point.nearest(Point::new(4.0, 5.0)).distance, 5.0);
        let line = Quadratic::new(Point::ZERO, Point::new(2.0, 0.0), Point::new(4.0, 0.0));
        assert_eq!(line.nearest(Point::new(1.0, 3.0)).point, Point::new(1.0, 0.0));
        // A folded piece turns back at (1, 0), where it has no perpendicular.
        let folded = Quadratic::new(Point::ZERO, Point::new(2.0, 0.0), Point::ZERO);
        assert!((folded.nearest(Point::new(5.0, 0.0)).distance - 4.0).abs() < 1e-12);
        let stopping = Quadratic::new(Point::ZERO, Point::new(2.0, 0.0), Point::new(2.0, 0.0));
        assert!((stopping.nearest(Point::new(1.5, 1.0)).point - Point::new(1.5, 0.0)).length() < 1e-12);
    }

    proptest! {
        #[test]
        fn no_sample_is_nearer(piece in any_piece(), x in -150.0f64..150.0, y in -150.0f64..150.0) {
            let p = Point::new(x, y);
            let found = piece.nearest(p);
            prop_assert!((0.0..=1.0).contains(&found.parameter));
            prop_assert!(piece.point(found.parameter).distance(p) == found.distance);
            let n = 1000;
            for i in 0..=n {
                prop_assert!(piece.point(i as f64 / n as f64).distance(p) >= found.distance - 1e-9);
            }
        }

        #[test]
        fn a_splines_nearest_point_is_that_of_its_nearest_piece(
            guides in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 1..12), closed: bool,
            x in -60.0f64..60.0, y in -60.0f64..60.0,
        ) {
            let spline = Spline::new(guides.into_iter().map(Point::from).collect(), closed).unwrap();
            let p = Point::new(x, y);
            let found = spline.nearest(p);
            let naive = spline.pieces().map(|piece| piece.nearest(p).distance).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(found.distance, naive);
            prop_assert!(spline.point(found.parameter).distance(found.point) < 1e-9);
        }
    }
}
