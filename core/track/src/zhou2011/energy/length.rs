//! Change of the segments' lengths from frame to frame (Zhou & Xiao 2011, eq. 2):
//!
//! ```text
//! E_L = Σ_i Σ_j ( |s_{i+1}(j)| − |s_i(j)| )²
//! ```
//!
//! The derivative of |b − a| by b is the unit vector u along the segment; by a it is −u. A segment of length zero has
//! no direction. Its derivative is set to zero, so that coincident points are not pushed in an arbitrary direction.

use super::term::{Curves, Sink, Term, by_point};

/// The term E_L.
#[derive(Clone, Copy, Debug)]
pub struct Length;

impl Term for Length {
    fn walk(&self, curves: Curves<'_>, sink: &mut impl Sink) {
        let layout = curves.layout;
        for frame in 1..layout.frames {
            for (a, b) in layout.segments() {
                let before = curves.at(frame - 1, b) - curves.at(frame - 1, a);
                let after = curves.at(frame, b) - curves.at(frame, a);
                let (u, v) = (after.normalize_or_zero(), before.normalize_or_zero());
                let derivatives = [
                    by_point(layout.coordinate(frame, b), u),
                    by_point(layout.coordinate(frame, a), -u),
                    by_point(layout.coordinate(frame - 1, b), -v),
                    by_point(layout.coordinate(frame - 1, a), v),
                ];
                sink.residual(after.length() - before.length(), derivatives.into_iter().flatten());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{NONE, worst};
    use super::super::{Layout, Weights};
    use super::*;
    use rototoon_base::geometry::Point;

    #[test]
    fn the_jacobian_is_right() {
        let worst = worst(Weights { length: 2.0, ..NONE });
        assert!(worst.error < 1e-7, "{worst:?}");
    }

    #[test]
    fn residuals_are_differences_of_lengths() {
        struct Collect(Vec<f64>);
        impl Sink for Collect {
            fn residual(&mut self, value: f64, derivatives: impl IntoIterator<Item = (usize, f64)>) {
                assert!(derivatives.into_iter().all(|(_, d)| d.is_finite()));
                self.0.push(value);
            }
        }
        let points = [(0.0, 0.0), (3.0, 4.0), (3.0, 4.0), (0.0, 0.0), (0.0, 0.0), (0.0, 2.0)];
        let points = points.map(|(x, y)| Point::new(x, y));
        let mut sink = Collect(Vec::new());
        Length.walk(Curves { layout: Layout::new(2, 3, false), points: &points }, &mut sink);
        assert_eq!(sink.0, [-5.0, 2.0]);
    }
}
