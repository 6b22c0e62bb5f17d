//! Covariance kernels: how similar what a character adds to one moment of a motion is to what it adds to another
//! moment.
//!
//! The table shows the terms between the moments (m, t) and (m′, t′). p(m, t) is the mean posture over characters, in
//! torso lengths.
//!
//! | term | meaning |
//! | --- | --- |
//! | w₀ | a character adds the same everywhere |
//! | w₁ exp(−‖p(m) − p(m′)‖² / 2ℓ²) | it adds alike to motions that are alike on the whole |
//! | w₂ [m = m′] | it adds something of its own to each motion |
//! | w_p exp(−‖p − p′‖² / 2ℓ²) ± η w_p exp(−‖p − σp′‖² / 2ℓ²) | it adds alike to similar postures |
//! | w_t [m = m′] exp(−(t − t′)² / 2τ²) | it adds alike to moments close in time |
//! | n | noise |
//!
//! σ exchanges left and right; the sign is + for axes that are even under σ and − for odd axes. This posture term has
//! the same effect as learning from every clip twice, once mirrored, at no cost. All terms are expressed in the cosines
//! of `basis`, so a motion takes twelve rows whatever its length.

use super::basis::{COSINES, MODEL_FRAMES, cosines};
use super::grid::{Row, WIDTH};
use rototoon_base::scene::skeleton::MIRROR;

/// w₀, w₁, w₂, w_t, comparable in size to w_p, over which the model averages. Doubling them hardly changes the results.
const CONSTANT: f64 = 0.15;
const MOTION: f64 = 0.25;
const OWN: f64 = 0.15;
const TIME: f64 = 0.1;
/// ℓ, in torso lengths: a distance over all key points together.
const POSTURE_LENGTH: f64 = 0.6;
/// τ, as a share of the clip.
const TIME_LENGTH: f64 = 0.15;
/// η.
const MIRRORED: f64 = 0.8;

/// Weights over which the model averages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weights {
    /// w_p.
    pub posture: f64,
    /// n.
    pub noise: f64,
}

/// The terms, each a square matrix of `motions · COSINES` rows.
pub(super) struct Kernels {
    /// Number of rows: motions times cosines.
    pub size: usize,
    fixed: Vec<f64>,
    posture: Vec<f64>,
    mirrored: Vec<f64>,
}

impl Kernels {
    /// The terms for mean motions, each in [`MODEL_FRAMES`] frames.
    pub fn new(means: &[Vec<Row>]) -> Self {
        let size = means.len() * COSINES;
        let mut kernels = Self {
            size,
            fixed: vec![0.0; size * size],
            posture: vec![0.0; size * size],
            mirrored: vec![0.0; size * size],
        };
        let swapped: Vec<Vec<Row>> = means.iter().map(|rows| rows.iter().map(mirror).collect()).collect();
        let basis = cosines(MODEL_FRAMES);
        let bell = |square: f64, length: f64| (-square / (2.0 * length * length)).exp();
        for a in 0..means.len() {
            for b in 0..means.len() {
                let apart: f64 =
                    means[a].iter().zip(&means[b]).map(|(p, q)| square(p, q)).sum::<f64>() / MODEL_FRAMES as f64;
                let whole = CONSTANT + MOTION * bell(apart, POSTURE_LENGTH) + if a == b { OWN } else { 0.0 };
                let fixed = |t: usize, u: usize| {
                    let lag = t.abs_diff(u) as f64 / MODEL_FRAMES as f64;
                    whole + if a == b { TIME * bell(lag * lag, TIME_LENGTH) } else { 0.0 }
                };
                let at = (a, b, size);
                project(&basis, &fixed, &mut kernels.fixed, at);
                project(
                    &basis,
                    &|t, u| bell(square(&means[a][t], &means[b][u]), POSTURE_LENGTH),
                    &mut kernels.posture,
                    at,
                );
                let swap = |t: usize, u: usize| bell(square(&means[a][t], &swapped[b][u]), POSTURE_LENGTH);
                project(&basis, &swap, &mut kernels.mirrored, at);
            }
        }
        kernels
    }

    /// The covariance of even axes or of odd axes under the exchange of sides.
    pub fn covariance(&self, weights: Weights, even: bool) -> Vec<f64> {
        let sign = if even { MIRRORED } else { -MIRRORED };
        let mut sum: Vec<f64> = (0..self.size * self.size)
            .map(|k| self.fixed[k] + weights.posture * (self.posture[k] + sign * self.mirrored[k]))
            .collect();
        (0..self.size).for_each(|i| sum[i * self.size + i] += weights.noise);
        sum
    }

    /// Similarity of motions on average over time, for even or odd axes: the posture terms alone, with unit diagonal.
    pub fn stances(&self, even: bool) -> Vec<f64> {
        let sign = if even { MIRRORED } else { -MIRRORED };
        let motions = self.size / COSINES;
        let at = |a: usize, b: usize| {
            let k = a * COSINES * self.size + b * COSINES;
            self.posture[k] + sign * self.mirrored[k]
        };
        let norm: Vec<f64> = (0..motions).map(|m| at(m, m).max(1e-12).sqrt()).collect();
        (0..motions * motions)
            .map(|k| (k / motions, k % motions))
            .map(|(a, b)| at(a, b) / (norm[a] * norm[b]))
            .collect()
    }
}

fn mirror(row: &Row) -> Row {
    std::array::from_fn(|d| row[2 * MIRROR[d / 2] + d % 2])
}

fn square(a: &Row, b: &Row) -> f64 {
    (0..WIDTH).map(|d| (a[d] - b[d]).powi(2)).sum()
}

/// Adds Fᵀ K F to the block (a, b) of a matrix with `size` columns.
fn project(
    basis: &[[f64; COSINES]],
    kernel: &dyn Fn(usize, usize) -> f64,
    into: &mut [f64],
    (a, b, size): (usize, usize, usize),
) {
    for (t, left) in basis.iter().enumerate() {
        let mut row = [0.0; COSINES];
        for (u, right) in basis.iter().enumerate() {
            let value = kernel(t, u);
            row.iter_mut().zip(right).for_each(|(sum, r)| *sum += value * r);
        }
        for (i, l) in left.iter().enumerate() {
            let at = (a * COSINES + i) * size + b * COSINES;
            into[at..at + COSINES].iter_mut().zip(&row).for_each(|(sum, r)| *sum += l * r);
        }
    }
}
