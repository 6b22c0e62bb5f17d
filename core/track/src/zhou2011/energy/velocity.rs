//! Change of the control points' velocity (Zhou & Xiao 2011, eq. 6):
//!
//! ```text
//! E_V = Σ_i Σ_j ‖ (c_{i+1}(j) − c_i(j)) − (c_i(j) − c_{i−1}(j)) ‖²
//! ```

use super::term::{Curves, Sink, Term};

/// The term E_V.
#[derive(Clone, Copy, Debug)]
pub struct Velocity;

impl Term for Velocity {
    fn walk(&self, curves: Curves<'_>, sink: &mut impl Sink) {
        let layout = curves.layout;
        for frame in 1..layout.frames.saturating_sub(1) {
            for j in 0..layout.points {
                let change = curves.at(frame + 1, j) - 2.0 * curves.at(frame, j) + curves.at(frame - 1, j);
                for axis in 0..2 {
                    let derivatives = [(frame + 1, 1.0), (frame, -2.0), (frame - 1, 1.0)]
                        .map(|(frame, factor)| (layout.coordinate(frame, j) + axis, factor));
                    sink.residual(change[axis], derivatives);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Weights;
    use super::super::tests::{NONE, only, worst};
    use rototoon_base::numeric::sparse_least_squares::{LmOptions, minimise};
    use std::ops::ControlFlow;

    #[test]
    fn the_jacobian_is_right() {
        let worst = worst(Weights { velocity: 2.0, ..NONE });
        assert!(worst.error < 1e-7, "{worst:?}");
    }

    #[test]
    fn alone_it_interpolates_linearly_between_fixed_points() {
        let energy = only(Weights { velocity: 4.0, ..NONE }, 5, true);
        let mut x = energy.initial();
        minimise(&energy, &mut x, &LmOptions::default(), |_, _| ControlFlow::Continue(()));
        let points = energy.points(&x);
        // Point 1 is pinned on frame 1; the others are free on frames 1 and 2.
        for j in [0, 2, 3, 4] {
            for (frame, share) in [(1, 1.0 / 3.0), (2, 2.0 / 3.0)] {
                assert!(points[5 * frame + j].distance(points[j].lerp(points[15 + j], share)) < 1e-4);
            }
        }
        assert_eq!(points[6], energy.points(&energy.initial())[6]);
    }
}
