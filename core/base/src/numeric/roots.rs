//! Real roots of polynomials of degree four or less within an interval.
//!
//! Closed formulas for cubics and quartics lose most of their digits if roots are close together or the leading coefficient
//! is small. Both cases are common with curves: a nearly straight piece, or two curves that touch.
//!
//! Instead, the roots of the derivative cut the interval into stretches on which the polynomial is monotone. Each stretch has
//! at most one root, and has one if the sign changes (Yuksel, "High-Performance Polynomial Root Finding for Graphics", 2022).
//! The recursion ends at the quadratic, which is solved without cancellation (Press et al., *Numerical Recipes*, §5.6).
//! Within a stretch, a Newton step is taken if it stays inside of the bracket; otherwise the bracket is halved.
//!
//! A value below the rounding error of its own evaluation counts as zero. A double root, where the polynomial only touches
//! zero, is therefore found once. A polynomial that is zero everywhere has no isolated roots, and the result is empty.

use std::ops::Deref;

/// Highest degree.
pub const MAX_DEGREE: usize = 4;

/// Roots in ascending order, each once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Roots {
    values: [f64; MAX_DEGREE],
    count: usize,
}

impl Roots {
    fn push(&mut self, root: f64) {
        let repeated = self.last().is_some_and(|&last| last == root);
        if self.count < MAX_DEGREE && !repeated {
            self.values[self.count] = root;
            self.count += 1;
        }
    }
}

impl Deref for Roots {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

/// Value of a polynomial. Coefficients are in ascending order.
pub fn evaluate(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, &c| sum * x + c)
}

/// Roots of a polynomial (coefficients in ascending order, at most five) in the closed interval `low..=high`.
///
/// A multiple root is given once. There are no roots if the polynomial is constant (zero included) or if a coefficient is
/// not finite.
pub fn roots_in(coefficients: &[f64], low: f64, high: f64) -> Roots {
    assert!(coefficients.len() <= MAX_DEGREE + 1, "degree {} is above {MAX_DEGREE}", coefficients.len() - 1);
    let largest = coefficients.iter().fold(0.0f64, |most, c| most.max(c.abs()));
    let mut scaled = [0.0; MAX_DEGREE + 1];
    let usable = largest > 0.0 && largest.is_finite() && low <= high && !coefficients.iter().any(|c| c.is_nan());
    if !usable {
        return Roots::default();
    }
    for (to, from) in scaled.iter_mut().zip(coefficients) {
        *to = from / largest;
    }
    monotone_stretches(&scaled[..coefficients.len()], low, high)
}

/// All real roots of a polynomial: those within Cauchy's bound 1 + max |c_i / c_n|.
pub fn real_roots(coefficients: &[f64]) -> Roots {
    let significant = coefficients.iter().rposition(|&c| c != 0.0).map_or(0, |last| last + 1);
    let Some((leading, rest)) = coefficients[..significant].split_last() else { return Roots::default() };
    let bound = 1.0 + rest.iter().fold(0.0f64, |most, c| most.max((c / leading).abs()));
    roots_in(&coefficients[..significant], -bound, bound)
}

fn monotone_stretches(c: &[f64], low: f64, high: f64) -> Roots {
    if c.len() <= 3 {
        return quadratic(c, low, high);
    }
    let mut derivative = [0.0; MAX_DEGREE];
    for i in 1..c.len() {
        derivative[i - 1] = i as f64 * c[i];
    }
    let turns = monotone_stretches(&derivative[..c.len() - 1], low, high);
    let mut roots = Roots::default();
    let (mut a, mut at_a) = (low, snapped(c, low));
    if at_a == 0.0 {
        roots.push(a);
    }
    for &b in turns.iter().chain([&high]) {
        let at_b = snapped(c, b);
        if at_a * at_b < 0.0 {
            roots.push(bracketed(c, &derivative[..c.len() - 1], (a, at_a), b));
        } else if at_b == 0.0 && at_a != 0.0 {
            roots.push(b);
        }
        (a, at_a) = (b, at_b);
    }
    roots
}

/// The polynomial's value, or zero if it is below the rounding error.
fn snapped(c: &[f64], x: f64) -> f64 {
    let value = evaluate(c, x);
    let magnitude = c.iter().rev().fold(0.0, |sum, &k| sum * x.abs() + k.abs());
    if value.abs() <= 4.0 * f64::EPSILON * magnitude { 0.0 } else { value }
}

/// Roots of c₀ + c₁ x + c₂ x² in the interval.
fn quadratic(c: &[f64], low: f64, high: f64) -> Roots {
    let at = |i: usize| c.get(i).copied().unwrap_or(0.0);
    let (k, half, a) = (at(0), 0.5 * at(1), at(2));
    let discriminant = half * half - a * k;
    let noise = 4.0 * f64::EPSILON * (half * half + (a * k).abs());
    let mut found = if discriminant < -noise {
        return Roots::default();
    } else if discriminant <= noise && a != 0.0 {
        [-half / a, f64::NAN]
    } else {
        let q = -(half + discriminant.max(0.0).sqrt().copysign(half));
        [q / a, k / q]
    };
    if found[0] > found[1] {
        found.swap(0, 1);
    }
    let mut roots = Roots::default();
    // Rounding may move a root at the end of the interval a little outside.
    let slack = 4.0 * f64::EPSILON * (low.abs().max(high.abs()));
    for x in found {
        if x >= low - slack && x <= high + slack {
            roots.push(x.clamp(low, high));
        }
    }
    roots
}

/// The root between `a` and `b`, where the polynomial is monotone and changes sign.
fn bracketed(c: &[f64], derivative: &[f64], (mut a, at_a): (f64, f64), mut b: f64) -> f64 {
    let mut x = 0.5 * (a + b);
    for _ in 0..200 {
        let value = evaluate(c, x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == (at_a < 0.0) {
            a = x
        } else {
            b = x
        }
        let newton = x - value / evaluate(derivative, x);
        let (least, most) = if a < b { (a, b) } else { (b, a) };
        let next = if newton > least && newton < most { newton } else { 0.5 * (a + b) };
        if (next - x).abs() <= f64::EPSILON * x.abs().max(f64::MIN_POSITIVE) || next == a || next == b {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Coefficients of the product of (x − r), ascending.
    fn product(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |c, r| {
            let mut next = vec![0.0; c.len() + 1];
            for (i, k) in c.iter().enumerate() {
                next[i + 1] += k;
                next[i] -= r * k;
            }
            next
        })
    }

    #[test]
    fn simple_cases() {
        assert_eq!(*real_roots(&[-6.0, 1.0, 1.0]), [-3.0, 2.0]);
        assert_eq!(*real_roots(&[0.0, 0.0, 0.0, 2.0]), [0.0]);
        assert!(real_roots(&[1.0, 0.0, 1.0]).is_empty());
        assert_eq!(*real_roots(&[-2.0, 4.0]), [0.5]);
        assert!(real_roots(&[0.0; 5]).is_empty());
        assert!(real_roots(&[3.0]).is_empty());
        assert_eq!(*roots_in(&[0.0, -1.0, 1.0], 0.0, 1.0), [0.0, 1.0]);
        assert!(roots_in(&[f64::NAN, 1.0, 1.0], 0.0, 1.0).is_empty());
    }

    #[test]
    fn a_root_of_order_four_and_two_double_roots_are_found_once_each() {
        assert_eq!(*real_roots(&product(&[0.5; 4])), [0.5]);
        assert_eq!(*real_roots(&product(&[-1.0, -1.0, 2.0, 2.0])), [-1.0, 2.0]);
    }

    #[test]
    fn a_vanishing_leading_coefficient_leaves_the_lower_degree() {
        let roots = roots_in(&[-0.06, 0.5, -1.0, 1e-18, -1e-19], 0.0, 1.0);
        assert_eq!(roots.len(), 2);
        assert!((roots[0] - 0.2).abs() < 1e-12 && (roots[1] - 0.3).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn constructed_roots_come_back(
            degree in 1usize..5, gaps in prop::collection::vec(0.02f64..1.0, 4), start in -2.0f64..0.0, scale in -1e6f64..1e6,
        ) {
            prop_assume!(scale.abs() > 1e-6);
            let roots: Vec<f64> = (0..degree).map(|i| start + gaps[..=i].iter().sum::<f64>()).collect();
            let c: Vec<f64> = product(&roots).iter().map(|k| k * scale).collect();
            let found = real_roots(&c);
            prop_assert_eq!(found.len(), degree);
            for (a, b) in found.iter().zip(&roots) {
                prop_assert!((a - b).abs() < 1e-8, "{:?} {:?}", found, roots);
            }
        }

        #[test]
        fn every_change_of_sign_on_a_fine_grid_has_its_root(c in prop::collection::vec(-1.0f64..1.0, 5)) {
            let found = roots_in(&c, -3.0, 3.0);
            for &root in found.iter() {
                prop_assert!(evaluate(&c, root).abs() < 1e-11 * (1.0 + root.abs()).powi(4));
            }
            for i in 0..6000 {
                let (a, b) = (-3.0 + i as f64 * 1e-3, -3.0 + (i + 1) as f64 * 1e-3);
                if evaluate(&c, a) * evaluate(&c, b) < 0.0 {
                    prop_assert!(found.iter().any(|&r| r >= a - 1e-9 && r <= b + 1e-9), "{a} {b} {:?}", found);
                }
            }
        }

        #[test]
        fn a_quartic_that_touches_zero_has_its_double_root(r in -1.0f64..1.0, p in 1.5f64..3.0, q in 0.1f64..3.0) {
            // (x − r)² ((x − p)² + q): no other real root.
            let c = product(&[r, r]);
            let d = [p * p + q, -2.0 * p, 1.0];
            let mut quartic = [0.0; 5];
            for (i, a) in c.iter().enumerate() {
                for (j, b) in d.iter().enumerate() {
                    quartic[i + j] += a * b;
                }
            }
            // Rounding may part or lose a double root; what is found is near it, and nothing else is.
            for &root in real_roots(&quartic).iter() {
                prop_assert!((root - r).abs() < 1e-6);
            }
        }
    }
}
