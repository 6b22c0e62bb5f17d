//! Motion of the samples from frame to frame (Agarwala et al. 2004):
//!
//! ```text
//! E_V = Σ_t Σ_i ‖ c_{t+1}(s_i) − c_t(s_i) ‖²
//! ```
//!
//! Alone it interpolates linearly between the fixed points. It is weak and decides only where no other term does.

use super::curve::Curve;
use super::pose::Pose;
use super::{Handle, Sink, Term};
use rototoon_base::geometry::Point;

/// The term E_V.
#[derive(Clone, Copy, Debug)]
pub struct Velocity<'a>(pub &'a Curve);

impl Term for Velocity<'_> {
    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink) {
        for (i, place) in self.0.places.iter().enumerate() {
            let way = pose.places[frame + 1][i] - pose.places[frame][i];
            sink.open(&[Handle::earlier(place), Handle::later(place)]);
            sink.residual(way.x, &[-Point::X, Point::X]);
            sink.residual(way.y, &[-Point::Y, Point::Y]);
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
        for (points, closed) in [(8, true), (6, false), (3, true), (2, false), (1, true)] {
            let (curve, x) = curve_case(points, closed);
            let worst = worst(&Velocity(&curve), &curve, &x).unwrap();
            assert!(worst.error < 1e-7, "{worst:?}");
        }
    }

    #[test]
    fn the_cost_is_the_squared_way() {
        let (curve, x) = curve_case(8, true);
        let moved: Vec<Point> = x[..8].iter().map(|p| *p + Point::new(3.0, -4.0)).collect();
        let cost = residuals(&Velocity(&curve), &curve, &[&x[..8], &moved].concat()).1;
        assert!((cost - 25.0 * curve.places.len() as f64).abs() < 1e-6);
    }
}
