//! Arc length of a parabola piece in closed form, and the parameter at a given length.
//!
//! With B′(u) = 2(b + a u) the speed is 2√(A u² + 2B u + C), where A = a·a, B = a·b, C = b·b. Complete the square with
//! v = u + B/A and k = |a × b|/A (because AC − B² = (a × b)²). The speed becomes 2√A √(v² + k²), which has an
//! elementary integral:
//!
//! L = √A [ v √(v² + k²) + k² asinh(v/k) ], from v = B/A to v = 1 + B/A.
//!
//! This is the formula of Yang et al. 1986, Appendix F. Its print lost signs and powers.
//!
//! **The straight limit.** As the piece approaches even travel along a line, A → 0 and v → ∞, and two large numbers are
//! subtracted. For |v| > [`FAR`] the speed is very smooth, because its nearest singularity is more than `FAR` piece
//! lengths away. Five Gauss–Legendre nodes are then exact to rounding: their error falls as ρ⁻¹⁰ with ρ ≈ 4 `FAR`.
//! Folded straight pieces (k = 0) are the other limit, with k² asinh(v/k) → 0.
//!
//! **The inverse** is found by Newton's method on the length. Its derivative is the speed. A bracket keeps the
//! iteration safe.

use super::{Quadratic, Spline};
use crate::geometry::Point;

/// Distance of the parabola's vertex, in piece lengths, beyond which quadrature replaces the formula.
const FAR: f64 = 8.0;

/// Nodes and weights of the five-point Gauss–Legendre rule on −1..1, for the nodes that are not negative.
const GAUSS: [(f64, f64); 3] = [
    (0.0, 128.0 / 225.0),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

impl Quadratic {
    /// Length in pixels.
    pub fn length(&self) -> f64 {
        self.length_to(1.0)
    }

    /// Length from the start to parameter `u` (0 to 1), in pixels.
    pub fn length_to(&self, u: f64) -> f64 {
        let (a, b) = self.coefficients();
        let squared = a.length_squared();
        let start = a.dot(b) / squared;
        // For straight pieces `start` is infinite or not a number, and the comparison is false.
        let by_formula = start.abs() <= FAR && squared > f64::MIN_POSITIVE;
        if !by_formula {
            return quadrature(a, b, u);
        }
        let k = a.perp_dot(b).abs() / squared;
        squared.sqrt() * (primitive(start + u, k) - primitive(start, k))
    }

    /// The parameter (0 to 1) at which the length from the start is `length` pixels; clamped to the piece.
    pub fn parameter_at(&self, length: f64) -> f64 {
        let total = self.length();
        if length.is_nan() || length <= 0.0 || total <= 0.0 {
            return 0.0;
        }
        if length >= total {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let mut u = length / total;
        for _ in 0..80 {
            let missing = length - self.length_to(u);
            if missing > 0.0 {
                low = u
            } else {
                high = u
            }
            let newton = u + missing / self.derivative(u).length();
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - u).abs() <= f64::EPSILON {
                return next;
            }
            u = next;
        }
        u
    }
}

/// v √(v² + k²) + k² asinh(v/k).
fn primitive(v: f64, k: f64) -> f64 {
    let curved = if k > 0.0 { k * k * (v / k).asinh() } else { 0.0 };
    v * v.hypot(k) + curved
}

fn quadrature(a: Point, b: Point, u: f64) -> f64 {
    let speed = |at: f64| 2.0 * (b + a * at).length();
    let half = 0.5 * u;
    let sum: f64 = GAUSS
        .iter()
        .map(|&(x, w)| if x == 0.0 { w * speed(half) } else { w * (speed(half * (1.0 - x)) + speed(half * (1.0 + x))) })
        .sum();
    half * sum
}

/// Cumulative lengths of a spline's pieces. They give the parameter at a length, and the length at a parameter, in
/// logarithmic time.
#[derive(Clone, Debug)]
pub struct ArcLengths<'a> {
    spline: &'a Spline,
    /// Length up to the start of each piece, followed by the total length.
    before: Vec<f64>,
}

impl<'a> ArcLengths<'a> {
    /// Measures a spline.
    pub fn new(spline: &'a Spline) -> Self {
        let mut before = vec![0.0];
        let mut sum = 0.0;
        for piece in spline.pieces() {
            sum += piece.length();
            before.push(sum);
        }
        Self { spline, before }
    }

    /// Total length in pixels.
    pub fn total(&self) -> f64 {
        self.before[self.before.len() - 1]
    }

    /// Length from the start of the spline to parameter `t`, in pixels.
    pub fn length_to(&self, t: f64) -> f64 {
        let (i, u) = self.spline.locate(t);
        self.before[i] + self.spline.piece(i).length_to(u)
    }

    /// The parameter at which the length from the start is `length` pixels; clamped to the spline.
    pub fn parameter_at(&self, length: f64) -> f64 {
        let pieces = self.before.len() - 1;
        let i = self.before[1..pieces].partition_point(|&end| end < length);
        i as f64 + self.spline.piece(i).parameter_at(length - self.before[i])
    }
}

#[cfg(test)]
mod tests {
    use super::super::quadratic::tests::any_piece;
    use super::*;
    use proptest::prelude::*;

    /// Reference of high order: the five-point rule on many parts, split where the piece nearly stops.
    fn by_quadrature(piece: &Quadratic, u: f64) -> f64 {
        let (a, b) = piece.coefficients();
        let turn = (-a.dot(b) / a.length_squared()).clamp(0.0, u);
        let turn = if turn.is_nan() { 0.0 } else { turn };
        let mut sum = 0.0;
        for (from, to) in [(turn, 0.0), (turn, u)] {
            let mut edge = from;
            // The parts become smaller towards the stop: halves of halves.
            for level in (0..50).rev() {
                let next = from + (to - from) * 0.5f64.powi(level);
                let n = 8;
                for i in 0..n {
                    let (x, y) =
                        (edge + (next - edge) * i as f64 / n as f64, edge + (next - edge) * (i + 1) as f64 / n as f64);
                    sum += quadrature(a, b + a * x.min(y), (y - x).abs());
                }
                edge = next;
            }
        }
        sum
    }

    #[test]
    fn known_lengths() {
        let line = Quadratic::new(Point::ZERO, Point::new(1.5, 2.0), Point::new(3.0, 4.0));
        assert!((line.length() - 5.0).abs() < 1e-15 * 5.0);
        let point = Quadratic::new(Point::ONE, Point::ONE, Point::ONE);
        assert_eq!(point.length(), 0.0);
        // There and back: to 1 and back.
        let folded = Quadratic::new(Point::ZERO, Point::new(2.0, 0.0), Point::ZERO);
        assert!((folded.length() - 2.0).abs() < 1e-15 * 2.0);
        // y = x² from 0 to 1: √5/2 + asinh(2)/4.
        let parabola = Quadratic::new(Point::ZERO, Point::new(0.5, 0.0), Point::ONE);
        assert!((parabola.length() - (5f64.sqrt() / 2.0 + 2f64.asinh() / 4.0)).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn the_formula_equals_quadrature(piece in any_piece(), u in 0.0f64..=1.0) {
            let (got, want) = (piece.length_to(u), by_quadrature(&piece, u));
            prop_assert!((got - want).abs() < 1e-12 * (1.0 + piece.length()), "{got} {want} {piece:?}");
        }

        #[test]
        fn nearly_straight_pieces_are_exact_too(
            x in 1.0f64..100.0, shift in -1.0f64..1.0, off in -1.0f64..1.0, small in -17i32..0,
        ) {
            let small = 10f64.powi(small);
            let piece = Quadratic::new(
                Point::ZERO, Point::new(x * (0.5 + 0.5 * shift * small), off * small), Point::new(x, 0.0),
            );
            let (got, want) = (piece.length(), by_quadrature(&piece, 1.0));
            prop_assert!((got - want).abs() < 1e-13 * want, "{got} {want}");
        }

        #[test]
        fn the_inverse_leads_back(piece in any_piece(), share in 0.0f64..=1.0) {
            let total = piece.length();
            let u = piece.parameter_at(share * total);
            prop_assert!((0.0..=1.0).contains(&u));
            prop_assert!((piece.length_to(u) - share * total).abs() < 1e-11 * (1.0 + total));
        }

        #[test]
        fn a_splines_length_leads_back(
            guides in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 1..9), closed: bool, share in 0.0f64..=1.0,
        ) {
            let guides = guides.into_iter().map(Point::from).collect();
            let spline = Spline::new(guides, closed).unwrap();
            let lengths = ArcLengths::new(&spline);
            let t = lengths.parameter_at(share * lengths.total());
            prop_assert!((lengths.length_to(t) - share * lengths.total()).abs() < 1e-10 * (1.0 + lengths.total()));
        }
    }
}
