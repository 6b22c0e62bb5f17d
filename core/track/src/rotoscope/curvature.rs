//! Change of the second differences from frame to frame (Agarwala et al. 2004):
//!
//! ```text
//! E_C = Σ_t Σ_i ‖ Δ²c_{t+1}(s_i) − Δ²c_t(s_i) ‖²,   Δ²c(s_i) = c(s_{i−1}) − 2 c(s_i) + c(s_{i+1})
//! ```
//!
//! The difference is one of vectors, so a part that rotates has a cost in proportion to its curvature.

use super::curve::Curve;
use super::pose::Pose;
use super::{Handle, Sink, Term};
use rototoon_base::geometry::Point;

/// The term E_C.
#[derive(Clone, Copy, Debug)]
pub struct Curvature<'a>(pub &'a Curve);

impl Term for Curvature<'_> {
    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink) {
        for (i, second) in self.0.seconds.iter().enumerate() {
            let change = pose.seconds[frame + 1][i] - pose.seconds[frame][i];
            sink.open(&[Handle::earlier(second), Handle::later(second)]);
            sink.residual(change.x, &[-Point::X, Point::X]);
            sink.residual(change.y, &[-Point::Y, Point::Y]);
            sink.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{curve_case, residuals, worst};
    use super::*;

    #[test]
    fn the_jacobian_is_right() {
        for (points, closed) in [(8, true), (6, false), (3, true), (3, false)] {
            let (curve, x) = curve_case(points, closed);
            let worst = worst(&Curvature(&curve), &curve, &x).unwrap();
            assert!(worst.error < 1e-7, "{worst:?}");
        }
    }

    #[test]
    fn shifts_cost_nothing() {
        let (curve, x) = curve_case(8, false);
        let moved: Vec<Point> = x[..8].iter().map(|p| *p + Point::new(5.0, -30.0)).collect();
        assert!(residuals(&Curvature(&curve), &curve, &[&x[..8], &moved].concat()).1 < 1e-20);
        assert!(residuals(&Curvature(&curve), &curve, &x).1 > 0.1);
    }
}
