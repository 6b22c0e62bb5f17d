//! Conversion to and from Bézier curves.
//!
//! **Out.** The pieces of a spline are quadratic Bézier curves. A quadratic p0, p1, p2 is the same curve as the cubic
//! whose inner control points are a third of the way from p1 to the ends (degree elevation).
//!
//! **Cubic to quadratics.** Take a cubic c0 … c3 and the quadratic with the same ends and the middle control point
//! (3 c1 + 3 c2 − c0 − c3)/4. They differ by (c3 − 3 c2 + 3 c1 − c0) u(u − ½)(u − 1). The factor in u is at most √3/36
//! (Sederberg, *Computer Aided Geometric Design*, §2). The third difference of n equal parts falls as n⁻³. So
//! n = ⌈∛(√3/36 · |third difference| / tolerance)⌉ parts keep the tolerance at each parameter. The parts join exactly in
//! position, but not exactly in direction: the middle control points of equal parts are on the tangents of the cubic
//! only up to third order.
//!
//! **In.** A chain of quadratics is a uniform spline exactly if each joint is the midpoint of the middle control points
//! around it ([`Spline::from_quadratics`]). Any other chain must be fitted to a tolerance, see the crate `rototoon-fit`.

use super::{Quadratic, Spline, SplineError};
use crate::geometry::Point;

/// A cubic Bézier piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// Control points, in pixels; the first and the last are on the curve.
    pub points: [Point; 4],
}

/// Largest value of |u (u − ½) (u − 1)| between 0 and 1: √3/36, at u = ½ ± √3/6.
const CUBIC_WAVE: f64 = 0.048_112_522_432_468_816;

/// Largest number of quadratics for one cubic.
const MOST_PARTS: f64 = 65_536.0;

impl Cubic {
    /// The point at parameter `u`, 0 to 1.
    pub fn point(&self, u: f64) -> Point {
        let [c0, c1, c2, c3] = self.points;
        let v = 1.0 - u;
        c0 * (v * v * v) + c1 * (3.0 * u * v * v) + c2 * (3.0 * u * u * v) + c3 * (u * u * u)
    }

    /// Derivative with respect to the parameter.
    pub fn derivative(&self, u: f64) -> Point {
        let [c0, c1, c2, c3] = self.points;
        let v = 1.0 - u;
        ((c1 - c0) * (v * v) + (c2 - c1) * (2.0 * u * v) + (c3 - c2) * (u * u)) * 3.0
    }

    /// Quadratics of equal parameter steps, nowhere farther than `tolerance` pixels from the cubic; as few as the bound
    /// of this module allows.
    ///
    /// `tolerance` must be positive. Zero gives the largest number of parts (65 536), a negative number or NaN gives
    /// one part.
    pub fn to_quadratics(self, tolerance: f64) -> Vec<Quadratic> {
        let [c0, c1, c2, c3] = self.points;
        let wave = CUBIC_WAVE * ((c3 - c0) + 3.0 * (c1 - c2)).length();
        // Slightly more than the bound, so that rounding cannot break it.
        let parts = (wave / tolerance * (1.0 + 1e-9)).cbrt().ceil();
        let parts = if parts.is_nan() { 1.0 } else { parts.clamp(1.0, MOST_PARTS) };
        let step = 1.0 / parts;
        (0..parts as usize)
            .map(|i| {
                let (from, to) = (i as f64 * step, (i + 1) as f64 * step);
                let (start, end) = (self.point(from), self.point(to.min(1.0)));
                let (inner, outer) = (self.derivative(from) * step, self.derivative(to.min(1.0)) * step);
                // (3 c1 + 3 c2 − c0 − c3)/4 of the part. Its c1 and c2 follow from its end tangents.
                Quadratic::new(start, 0.5 * (start + end) + 0.25 * (inner - outer), end)
            })
            .collect()
    }
}

impl From<Quadratic> for Cubic {
    fn from(q: Quadratic) -> Self {
        Self { points: [q.p0, q.p0.lerp(q.p1, 2.0 / 3.0), q.p2.lerp(q.p1, 2.0 / 3.0), q.p2] }
    }
}

/// A chain of Bézier pieces that is not a uniform spline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotUniform {
    /// The middle control points cannot make a spline.
    #[error(transparent)]
    Guides(#[from] SplineError),
    /// A joint is not the midpoint of the middle control points around it.
    #[error(
        "joint {index} is {distance} px from the midpoint of the control points around it, expected at most {tolerance} px; \
         fit the curve to a tolerance instead"
    )]
    Joint {
        /// Index of the piece with the joint.
        index: usize,
        /// Distance of the joint from the midpoint, in pixels.
        distance: f64,
        /// Largest distance allowed, in pixels.
        tolerance: f64,
    },
}

impl Spline {
    /// The spline with these pieces, if each joint is within `tolerance` pixels of the midpoint around it. The result
    /// is then within the tolerance of the pieces.
    ///
    /// # Errors
    ///
    /// No pieces, or points that are not finite; a joint that is too far from the midpoint.
    pub fn from_quadratics(pieces: &[Quadratic], closed: bool, tolerance: f64) -> Result<Self, NotUniform> {
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return Err(SplineError::Empty.into()) };
        let middle = pieces.iter().map(|piece| piece.p1);
        let guides: Vec<Point> =
            if closed { middle.collect() } else { std::iter::once(first.p0).chain(middle).chain([last.p2]).collect() };
        let spline = Self::new(guides, closed)?;
        for (index, (have, made)) in pieces.iter().zip(spline.pieces()).enumerate() {
            let distance = have.p0.distance(made.p0).max(have.p2.distance(made.p2));
            let near = distance <= tolerance;
            if !near {
                return Err(NotUniform::Joint { index, distance, tolerance });
            }
        }
        Ok(spline)
    }

    /// The pieces as cubic Bézier curves of the same shape.
    pub fn to_cubics(&self) -> Vec<Cubic> {
        self.pieces().map(Cubic::from).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::quadratic::tests::any_piece;
    use super::super::spline::tests::any_spline;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_chain_that_is_not_uniform_is_refused_at_its_joint() {
        let p = Point::new;
        let chain = [
            Quadratic::new(p(0.0, 0.0), p(2.0, 0.0), p(5.0, 0.0)),
            Quadratic::new(p(5.0, 0.0), p(6.0, 0.0), p(6.0, 3.0)),
        ];
        let error = Spline::from_quadratics(&chain, false, 0.1).unwrap_err();
        assert_eq!(error, NotUniform::Joint { index: 0, distance: 1.0, tolerance: 0.1 });
        assert!(Spline::from_quadratics(&chain, false, 1.0).is_ok());
        assert!(Spline::from_quadratics(&[], true, 1.0).is_err());
    }

    proptest! {
        #[test]
        fn elevation_changes_nothing(piece in any_piece(), u in 0.0f64..=1.0) {
            let cubic = Cubic::from(piece);
            prop_assert!(cubic.point(u).distance(piece.point(u)) < 1e-12 * 100.0);
            prop_assert!(cubic.derivative(u).distance(piece.derivative(u)) < 1e-11 * 100.0);
            // Therefore one quadratic is enough on the way back.
            let back = cubic.to_quadratics(1e-6);
            prop_assert_eq!(back.len(), 1);
            prop_assert!(back[0].p1.distance(piece.p1) < 1e-9);
        }

        #[test]
        fn cubics_become_quadratics_within_the_tolerance(
            c in prop::array::uniform8(-100.0f64..100.0), tolerance in 1e-4f64..10.0,
        ) {
            let p = |i: usize| Point::new(c[i], c[i + 1]);
            let cubic = Cubic { points: [p(0), p(2), p(4), p(6)] };
            let parts = cubic.to_quadratics(tolerance);
            let n = parts.len() as f64;
            let mut worst = 0.0f64;
            for (i, part) in parts.iter().enumerate() {
                for k in 0..=24 {
                    let u = k as f64 / 24.0;
                    worst = worst.max(part.point(u).distance(cubic.point((i as f64 + u) / n)));
                }
            }
            prop_assert!(worst <= tolerance * (1.0 + 1e-6), "{worst}");
            // One part fewer would not keep the tolerance (samples miss the peak by less than a twentieth).
            let bound = |n: f64| worst / 0.95 * (n / (n - 1.0)).powi(3);
            prop_assert!(n == 1.0 || bound(n) >= tolerance, "{n} {worst}");
        }

        #[test]
        fn a_splines_pieces_make_it_again(spline in any_spline()) {
            let pieces: Vec<_> = spline.pieces().collect();
            let again = Spline::from_quadratics(&pieces, spline.is_closed(), 1e-9).unwrap();
            prop_assert_eq!(again.piece_count(), spline.piece_count());
            for (a, b) in again.pieces().zip(pieces) {
                prop_assert!(a.p0.distance(b.p0) < 1e-9 && a.p1 == b.p1);
            }
        }
    }
}
