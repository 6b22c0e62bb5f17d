//! Change of the part's area from frame to frame (Zhou & Xiao 2011, eq. 5):
//!
//! ```text
//! E_A = Σ_i ( f_S(p_{i+1}) − f_S(p_i) )²
//! ```
//!
//! The paper does not state the unit of f_S. In px² the area of a large part would dominate every other term. Divided
//! by the square root of the part's area at the keys it is a length like the other terms, so the balance of the energy
//! does not depend on the resolution. The area has a lower limit of one pixel. An open curve encloses no area and has
//! no such term.

use super::term::{Curves, Sink, Term};
use rototoon_base::geometry::{Point, polygon};

/// The term E_A.
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// 1 / √(mean of the keys' areas), per pixel.
    scale: f64,
}

impl Area {
    /// Takes the scale from the first and the last frame, which are the keys.
    pub fn new(curves: Curves<'_>) -> Self {
        let last = curves.layout.frames.saturating_sub(1);
        let area = [0, last].map(|frame| polygon::signed_area(curves.frame(frame)).abs());
        Self { scale: 1.0 / (0.5 * (area[0] + area[1])).sqrt().max(1.0) }
    }
}

impl Term for Area {
    fn walk(&self, curves: Curves<'_>, sink: &mut impl Sink) {
        let layout = curves.layout;
        if !layout.closed {
            return;
        }
        let by_coordinate = |frame: usize, sign: f64| {
            layout.neighbours().flat_map(move |(previous, j, next)| {
                // ∂f_S/∂c(j) is half the vector between the neighbours of c(j), turned by a quarter turn.
                let chord: Point = curves.at(frame, next) - curves.at(frame, previous);
                let coordinate = layout.coordinate(frame, j);
                let factor = 0.5 * sign * self.scale;
                [(coordinate, factor * chord.y), (coordinate + 1, -factor * chord.x)]
            })
        };
        for frame in 1..layout.frames {
            let change = polygon::signed_area(curves.frame(frame)) - polygon::signed_area(curves.frame(frame - 1));
            let derivatives = by_coordinate(frame, 1.0).chain(by_coordinate(frame - 1, -1.0));
            sink.residual(self.scale * change, derivatives);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{NONE, worst};
    use super::super::{Layout, Weights};
    use super::*;

    #[test]
    fn the_jacobian_is_right() {
        let worst = worst(Weights { area: 2.0, ..NONE });
        assert!(worst.error < 1e-7, "{worst:?}");
    }

    #[test]
    fn the_unit_is_a_length() {
        let square = |side: f64| [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Point::new(x, y));
        let points = [square(10.0), square(20.0), square(10.0)].concat();
        let curves = Curves { layout: Layout::new(3, 4, true), points: &points };
        struct Collect(Vec<f64>);
        impl Sink for Collect {
            fn residual(&mut self, value: f64, _derivatives: impl IntoIterator<Item = (usize, f64)>) {
                self.0.push(value);
            }
        }
        let mut sink = Collect(Vec::new());
        Area::new(curves).walk(curves, &mut sink);
        assert_eq!(sink.0, [30.0, -30.0]);
    }

    #[test]
    fn a_part_without_area_keeps_a_finite_scale() {
        let points = [Point::ONE; 6];
        assert_eq!(Area::new(Curves { layout: Layout::new(2, 3, true), points: &points }).scale, 1.0);
    }
}
