//! Attributes of points (pressure, radius, opacity), transferred to guiding points.
//!
//! The curve is known, and so are each point's parameter and the weights of the guiding points there. The values at the
//! guiding points are the linear least-squares solution for the same blend: one banded system for each attribute. A
//! small weight on the difference of neighbours determines the values of guiding points without nearby points. It is
//! too small to smooth noise noticeably.

use rototoon_base::curve::Spline;
use rototoon_base::numeric::banded::BandMatrix;

/// Weight of the difference of neighbours, in points per guiding point.
const EVEN: f64 = 1e-5;

/// Values at the guiding points of a spline whose blend is nearest to `values` at `parameters`.
pub(super) fn fit(spline: &Spline, parameters: &[f64], values: &[f64]) -> Vec<f64> {
    let n = spline.guides().len();
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    if n == 1 || !mean.is_finite() {
        return vec![mean; n];
    }
    // The guiding points of a closed spline are numbered alternately from both sides of the start, which keeps the band
    // narrow.
    let place = |k: usize| match spline.is_closed() {
        false => k,
        true if k < n.div_ceil(2) => 2 * k,
        true => 2 * (n - 1 - k) + 1,
    };
    let mut matrix = BandMatrix::zeros(n, 5.min(n - 1));
    let mut rhs = vec![0.0; n];
    for (&t, &value) in parameters.iter().zip(values) {
        let weights = spline.weights(t);
        for (a, &(k, w)) in weights.iter().enumerate() {
            rhs[place(k)] += w * (value - mean);
            for &(l, v) in &weights[..=a] {
                let twice = if l == k && (l, v) != (k, w) { 2.0 } else { 1.0 };
                matrix.add(place(k), place(l), twice * w * v);
            }
        }
    }
    let even = EVEN * (parameters.len() as f64 / n as f64).max(1.0);
    for k in 0..if spline.is_closed() { n } else { n - 1 } {
        let (a, b) = (place(k), place((k + 1) % n));
        matrix.add(a, a, even);
        matrix.add(b, b, even);
        if a != b {
            matrix.add(a, b, -even);
        }
    }
    for k in 0..n {
        matrix.add(k, k, 1e-3 * even);
    }
    let Ok(factor) = matrix.factor() else { return vec![mean; n] };
    factor.solve_in_place(&mut rhs);
    (0..n).map(|k| mean + rhs[place(k)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::geometry::Point;

    proptest! {
        #[test]
        fn a_blend_of_guide_values_comes_back(values in prop::collection::vec(0.0f64..10.0, 5..14), closed: bool) {
            let n = values.len();
            let guides = (0..n).map(|k| Point::from_angle(k as f64) * (50.0 + k as f64)).collect();
            let spline = Spline::new(guides, closed).unwrap();
            let count = spline.piece_count() as f64;
            let parameters: Vec<f64> = (0..800).map(|j| count * j as f64 / 799.0).collect();
            let given: Vec<f64> = parameters.iter().map(|&t| spline.blend(&values, t)).collect();
            let fitted = fit(&spline, &parameters, &given);
            for (&t, want) in parameters.iter().zip(given) {
                prop_assert!((spline.blend(&fitted, t) - want).abs() < 0.1);
            }
        }
    }

    #[test]
    fn a_constant_stays_and_guides_without_points_take_their_neighbours() {
        let guides = (0..9).map(|k| Point::new(k as f64, 0.0)).collect();
        let spline = Spline::new(guides, false).unwrap();
        let fitted = fit(&spline, &[0.1, 0.2, 0.4], &[3.0, 3.0, 3.0]);
        assert!(fitted.iter().all(|v| (v - 3.0).abs() < 1e-9), "{fitted:?}");
    }
}
