//! Distance of the part's centre, the mean of its control points, from its target (Zhou & Xiao 2011, eq. 9):
//!
//! ```text
//! E_R = Σ_i ‖ pc_i − pc*_i ‖²
//! ```

use super::term::{Curves, Sink, Term};
use rototoon_base::geometry::{Point, polygon};

/// The term E_R.
#[derive(Clone, Debug)]
pub struct Center {
    /// Target pc* by frame, in pixels. A frame without one has no residual.
    pub centers: Vec<Option<Point>>,
}

impl Term for Center {
    fn walk(&self, curves: Curves<'_>, sink: &mut impl Sink) {
        let layout = curves.layout;
        let share = 1.0 / layout.points as f64;
        for (frame, wanted) in self.centers.iter().enumerate() {
            let Some(wanted) = *wanted else { continue };
            let missing = polygon::center(curves.frame(frame)) - wanted;
            for axis in 0..2 {
                sink.residual(missing[axis], (0..layout.points).map(|j| (layout.coordinate(frame, j) + axis, share)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Weights;
    use super::super::tests::{NONE, only, worst};
    use rototoon_base::geometry::{Point, polygon};
    use rototoon_base::numeric::sparse_least_squares::{LmOptions, minimise};
    use std::ops::ControlFlow;

    #[test]
    fn the_jacobian_is_right() {
        let worst = worst(Weights { center: 2.0, ..NONE });
        assert!(worst.error < 1e-7, "{worst:?}");
    }

    #[test]
    fn alone_it_moves_the_centre_to_its_target_around_a_pin() {
        let energy = only(Weights { center: 32.0, ..NONE }, 5, true);
        let mut x = energy.initial();
        minimise(&energy, &mut x, &LmOptions::default(), |_, _| ControlFlow::Continue(()));
        let points = energy.points(&x);
        assert!(polygon::center(&points[5..10]).distance(Point::new(20.0, 17.0)) < 1e-3);
        assert!(polygon::center(&points[10..15]).distance(Point::new(24.0, 19.0)) < 1e-3);
        assert_eq!(points[6], energy.points(&energy.initial())[6]);
    }
}
