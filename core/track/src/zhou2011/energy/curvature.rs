//! Change of the second differences from frame to frame (Zhou & Xiao 2011, eq. 3 and 4):
//!
//! ```text
//! E_C = Σ_i Σ_j ‖ f_C(c_{i+1}(j)) − f_C(c_i(j)) ‖²,   f_C(c) = (c_prev − c) − (c − c_next)
//! ```
//!
//! The difference is one of vectors. So a part that rotates has a cost although its shape stays the same: a limit of
//! the printed method. The ends of an open curve have no second difference.

use super::term::{Curves, Sink, Term};

/// The term E_C.
#[derive(Clone, Copy, Debug)]
pub struct Curvature;

impl Term for Curvature {
    fn walk(&self, curves: Curves<'_>, sink: &mut impl Sink) {
        let layout = curves.layout;
        let second = |frame, (previous, j, next)| {
            curves.at(frame, previous) - 2.0 * curves.at(frame, j) + curves.at(frame, next)
        };
        for frame in 1..layout.frames {
            for point in layout.neighbours() {
                let change = second(frame, point) - second(frame - 1, point);
                let (previous, j, next) = point;
                for axis in 0..2 {
                    let derivatives = [(previous, 1.0), (j, -2.0), (next, 1.0)].into_iter().flat_map(|(j, factor)| {
                        [
                            (layout.coordinate(frame, j) + axis, factor),
                            (layout.coordinate(frame - 1, j) + axis, -factor),
                        ]
                    });
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
    use rototoon_base::geometry::Point;
    use rototoon_base::numeric::sparse_least_squares::Problem;

    #[test]
    fn the_jacobian_is_right() {
        let worst = worst(Weights { curvature: 2.0, ..NONE });
        assert!(worst.error < 1e-7, "{worst:?}");
    }

    #[test]
    fn a_shift_of_a_whole_frame_costs_nothing() {
        let energy = only(Weights { curvature: 1.0, ..NONE }, 6, true);
        // Frame 2 has no pin: all of its coordinates are the last variables.
        let mut x = energy.initial();
        let mut before = vec![0.0; energy.residuals()];
        energy.evaluate(&x, &mut before);
        let free = x.len();
        let shift = Point::new(3.0, -2.0);
        (free - 12..free).for_each(|k| x[k] += shift[k % 2]);
        let mut after = vec![0.0; energy.residuals()];
        energy.evaluate(&x, &mut after);
        assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(before.iter().any(|r| r.abs() > 0.1));
    }
}
