//! Smooths a series as much as its noise asks for, and keeps changes that were drawn.
//!
//! Given entries a with noise of variance r, and motion whose second differences Δ have the variance q, the series x minimises
//!
//! ```text
//! Σ (x − a)² / r  +  Σ ρ(Δx) / q,   ρ(e) = e² / (1 + e² / s²)
//! ```
//!
//! For a small Δ this is the best linear estimate. A Δ far above s² = u² (q + r / 2) adds nothing more by growing, so a drawn
//! change is not smoothed (Geman & McClure 1987). u says how many standard deviations a Δ may have before it counts as drawn. The minimum is found by weights that are computed anew a few times. At
//! first s² allows for all the noise that Δ has, 6 r.

use super::noise::{Split, second_differences, weights};
use rototoon_base::numeric::banded::BandMatrix;

/// Number of times that the weights are computed.
const ROUNDS: usize = 6;
/// Least variance of the motion, as a share of the noise's.
const LEAST: f64 = 0.02;
/// Weight of entries that stay, as a multiple of the others'.
pub const STAYS: f64 = 1e6;

/// The smoothed series. Entries that are `set` stay; `usual` is u.
pub fn smoothed(times: &[f64], series: &[Vec<f64>], set: &[bool], split: Split, usual: f64) -> Vec<Vec<f64>> {
    let noise = split.noise;
    if series.len() < 3 || noise <= 0.0 {
        return series.to_vec();
    }
    let motion = split.motion.max(LEAST * noise);
    let mut found = series.to_vec();
    for round in 0..ROUNDS {
        let usual = usual * usual * if round == 0 { motion + 6.0 * noise } else { motion + noise / 2.0 };
        let tensions: Vec<f64> =
            second_differences(times, &found).iter().map(|e| tension(mean_square(e), usual) / motion).collect();
        let Some(next) = solved(times, series, set, noise, &tensions) else { return series.to_vec() };
        found = next;
    }
    found
}

/// The mean of squares.
pub fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64
}

/// The weight of a second difference whose square is `e`, where `usual` is the square of the scale s.
pub fn tension(e: f64, usual: f64) -> f64 {
    (1.0 + e / usual).powi(-2)
}

/// The minimum for given weights of the second differences.
fn solved(times: &[f64], series: &[Vec<f64>], set: &[bool], noise: f64, tensions: &[f64]) -> Option<Vec<Vec<f64>>> {
    let (count, channels) = (series.len(), series[0].len());
    let trust: Vec<f64> = set.iter().map(|&set| if set { STAYS / noise } else { 1.0 / noise }).collect();
    let mut matrix = BandMatrix::zeros(count, 2);
    (0..count).for_each(|d| matrix.add(d, d, trust[d]));
    for (first, (times, tension)) in times.windows(3).zip(tensions).enumerate() {
        let weights = weights(times);
        for i in 0..3 {
            (i..3).for_each(|j| matrix.add(first + i, first + j, tension * weights[i] * weights[j]));
        }
    }
    let factor = matrix.factor().ok()?;
    let mut found = vec![vec![0.0; channels]; count];
    for k in 0..channels {
        let mut column: Vec<f64> = (0..count).map(|d| trust[d] * series[d][k]).collect();
        factor.solve_in_place(&mut column);
        (0..count).for_each(|d| found[d][k] = column[d]);
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::super::tests::Random;
    use super::*;
    use nalgebra::{DMatrix, DVector};

    fn times(count: usize) -> Vec<f64> {
        (0..count).map(|d| d as f64).collect()
    }

    fn ends(count: usize) -> Vec<bool> {
        (0..count).map(|d| d == 0 || d + 1 == count).collect()
    }

    #[test]
    fn noise_falls_and_a_drawn_jump_stays() {
        let mut random = Random::new(3);
        let truth = |d: usize| if d < 20 { 0.5 * d as f64 } else { 60.0 };
        let noisy: Vec<Vec<f64>> = (0..40).map(|d| vec![truth(d) + random.normal(), random.normal()]).collect();
        let split = Split { noise: 1.0, motion: 0.05 };
        let smooth = smoothed(&times(40), &noisy, &[false; 40], split, 2.0);
        let error =
            |x: &[Vec<f64>]| (0..40).map(|d| (x[d][0] - truth(d)).powi(2) + x[d][1].powi(2)).sum::<f64>() / 40.0;
        assert!(error(&smooth) < 0.5 * error(&noisy), "{} of {}", error(&smooth), error(&noisy));
        assert!((smooth[20][0] - smooth[19][0] - 50.5).abs() < 2.0, "{:?}", &smooth[18..22]);
    }

    #[test]
    fn what_is_set_stays_and_without_noise_all_stays() {
        let series: Vec<Vec<f64>> = (0..9).map(|d| vec![f64::from(d % 2) * 3.0]).collect();
        let set = [true, false, false, false, true, false, false, false, true];
        let smooth = smoothed(&times(9), &series, &set, Split { noise: 4.0, motion: 0.1 }, 2.0);
        for d in 0..9 {
            let moved = (smooth[d][0] - series[d][0]).abs();
            assert!(if set[d] { moved < 1e-4 } else { moved > 0.02 }, "{smooth:?}");
        }
        assert_eq!(smoothed(&times(9), &series, &set, Split { noise: 0.0, motion: 1.0 }, 2.0), series);
    }

    #[test]
    fn the_band_solution_is_that_of_the_dense_equations() {
        let mut random = Random::new(5);
        let times = [0.0, 1.0, 2.5, 3.0, 5.0, 6.0];
        let series: Vec<Vec<f64>> = (0..6).map(|_| vec![random.normal(), random.normal()]).collect();
        let (set, tensions) = (ends(6), [0.3, 2.0, 1.0, 0.01]);
        let found = solved(&times, &series, &set, 0.5, &tensions).unwrap();
        let mut matrix = DMatrix::from_fn(6, 6, |i, j| match (i == j, set[i]) {
            (true, true) => STAYS / 0.5,
            (true, false) => 2.0,
            _ => 0.0,
        });
        let trust = matrix.diagonal();
        for (first, tension) in tensions.iter().enumerate() {
            let mut row = DVector::zeros(6);
            weights(&times[first..first + 3]).iter().enumerate().for_each(|(k, w)| row[first + k] = *w);
            matrix += &row * row.transpose() * *tension;
        }
        for k in 0..2 {
            let side = DVector::from_fn(6, |d, _| trust[d] * series[d][k]);
            let dense = matrix.clone().lu().solve(&side).unwrap();
            (0..6).for_each(|d| assert!((dense[d] - found[d][k]).abs() < 1e-6));
        }
    }
}
