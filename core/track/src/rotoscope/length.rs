//! Change of the distances of neighbouring samples from frame to frame (Agarwala et al. 2004):
//!
//! ```text
//! E_L = Σ_t Σ_i ( ‖c_{t+1}(s_{i+1}) − c_{t+1}(s_i)‖² − ‖c_t(s_{i+1}) − c_t(s_i)‖² )²
//! ```
//!
//! The distances are squared, so that the derivative needs no division and is defined where samples coincide. The unit
//! is px⁴. The term and its weight assume samples 2 px apart, and a [chord](super::curve::Curve::chords) is scaled to
//! that distance.

use super::curve::Curve;
use super::pose::Pose;
use super::{Handle, Sink, Term};

/// The term E_L.
#[derive(Clone, Copy, Debug)]
pub struct Length<'a>(pub &'a Curve);

impl Term for Length<'_> {
    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink) {
        for (i, chord) in self.0.chords.iter().enumerate() {
            let (before, after) = (pose.chords[frame][i], pose.chords[frame + 1][i]);
            sink.open(&[Handle::earlier(chord), Handle::later(chord)]);
            sink.residual(after.length_squared() - before.length_squared(), &[-2.0 * before, 2.0 * after]);
            sink.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{curve_case, residuals, worst};
    use super::*;
    use rototoon_base::geometry::Point;

    #[test]
    fn the_jacobian_is_right() {
        for (points, closed) in [(8, true), (6, false), (3, true), (2, false)] {
            let (curve, x) = curve_case(points, closed);
            let worst = worst(&Length(&curve), &curve, &x).unwrap();
            assert!(worst.error < 1e-6, "{worst:?}");
        }
    }

    #[test]
    fn turning_costs_nothing_and_growing_does() {
        let (curve, x) = curve_case(8, true);
        let first = &x[..8];
        let changed = |factor: Point| first.iter().map(|p| factor.rotate(*p)).collect::<Vec<_>>();
        let cost = |factor| residuals(&Length(&curve), &curve, &[first, &changed(factor)].concat()).1;
        assert!(cost(Point::from_angle(1.0)) < 1e-15);
        assert!(cost(1.1 * Point::from_angle(1.0)) > 0.1);
    }
}
