//! The clips of a grid as numbers, and how characters and motions vary together in them.

use super::basis::{Axes, COSINES, MODEL_FRAMES, cosines};
use super::grid::Grid;
use rototoon_base::numeric::dense::DenseCholesky;
use rototoon_base::numeric::vector::dot;

/// c of [`super::gaussian`].
const MEAN_VARIANCE: f64 = 30.0;
/// How far the outputs are whitened before motions are compared.
const WHITENED: f64 = 0.8;

/// The clips as numbers: `x[s]` holds motions × cosines rows of one number an axis.
pub(super) struct Cells {
    pub characters: usize,
    pub motions: usize,
    pub axes: usize,
    /// By character and motion whether there is a clip; else what stands there was filled in.
    pub known: Vec<bool>,
    pub x: Vec<Vec<f64>>,
}

impl Cells {
    pub fn new(grid: &Grid, axes: &Axes) -> Self {
        let (characters, motions) = (grid.characters.len(), grid.motions.len());
        let basis = cosines(MODEL_FRAMES);
        let mut cells = Self {
            characters,
            motions,
            axes: axes.len(),
            known: vec![false; characters * motions],
            x: vec![vec![0.0; motions * COSINES * axes.len()]; characters],
        };
        for s in 0..characters {
            for m in 0..motions {
                let Some(rows) = grid.rows(s, m, MODEL_FRAMES) else { continue };
                cells.known[s * motions + m] = true;
                let at = m * COSINES * axes.len();
                for (row, cosine) in rows.iter().zip(&basis) {
                    let coordinates = axes.coordinates(row);
                    for (k, c) in cosine.iter().enumerate() {
                        let line = &mut cells.x[s][at + k * axes.len()..at + (k + 1) * axes.len()];
                        line.iter_mut().zip(&coordinates).for_each(|(sum, v)| *sum += c * v);
                    }
                }
            }
        }
        for s in 0..characters {
            for m in (0..motions).filter(|m| !cells.known[s * motions + m]) {
                let mean = cells.mean_of(m, s);
                cells.x[s][m * mean.len()..(m + 1) * mean.len()].copy_from_slice(&mean);
            }
        }
        cells
    }

    /// A clip.
    pub fn block(&self, s: usize, m: usize) -> &[f64] {
        let size = COSINES * self.axes;
        &self.x[s][m * size..(m + 1) * size]
    }

    /// Mean of the known clips of a motion without a character's; zero where there is none.
    pub fn mean_of(&self, m: usize, without: usize) -> Vec<f64> {
        let mut sum = vec![0.0; COSINES * self.axes];
        let mut count = 0.0;
        for s in (0..self.characters).filter(|&s| s != without && self.known[s * self.motions + m]) {
            count += 1.0;
            sum.iter_mut().zip(self.block(s, m)).for_each(|(a, b)| *a += b);
        }
        sum.iter_mut().for_each(|v| *v /= f64::max(count, 1.0));
        sum
    }

    /// Inverse of K_s + c 11ᵀ for each motion, which is left out of S.
    pub fn style_precisions(&self, shrink: f64) -> Vec<Vec<f64>> {
        let n = self.characters;
        let means: Vec<Vec<f64>> = (0..self.motions).map(|m| self.mean_of(m, usize::MAX)).collect();
        let d = self.axes;
        let precision = |left_out: usize| {
            let mut s = vec![0.0; n * n];
            for m in (0..self.motions).filter(|&m| m != left_out) {
                let rest: Vec<Vec<f64>> = (0..n)
                    .map(|c| self.block(c, m)[..d].iter().zip(&means[m][..d]).map(|(a, b)| a - b).collect())
                    .collect();
                (0..n * n).for_each(|k| s[k] += dot(&rest[k / n], &rest[k % n]));
            }
            let trace: f64 = (0..n).map(|i| s[i * n + i]).sum();
            let scale = if trace > 0.0 { (1.0 - shrink) * n as f64 / trace } else { 0.0 };
            for (k, value) in s.iter_mut().enumerate() {
                let own = if k / n == k % n { shrink.max(1e-3) } else { 0.0 };
                *value = *value * scale + own + MEAN_VARIANCE;
            }
            DenseCholesky::new(n, &s).map_or_else(|| vec![0.0; n * n], |factor| factor.inverse())
        };
        (0..self.motions).map(precision).collect()
    }

    /// Covariance among motions of what characters other than one add on average over time; unit mean variance.
    pub fn observed(&self, without: usize) -> Vec<f64> {
        let (n, d) = (self.motions, self.axes);
        let others: Vec<usize> = (0..self.characters).filter(|&s| s != without).collect();
        let mut rest: Vec<Vec<f64>> = Vec::new(); // a motion: others × axes
        for m in 0..n {
            let mut mean = vec![0.0; d];
            for &s in &others {
                mean.iter_mut().zip(self.block(s, m)).for_each(|(a, b)| *a += b / others.len() as f64);
            }
            rest.push(
                others
                    .iter()
                    .flat_map(|&s| (0..d).map(move |k| (s, k)))
                    .map(|(s, k)| self.block(s, m)[k] - mean[k])
                    .collect(),
            );
        }
        let variance: Vec<f64> =
            (0..d).map(|k| rest.iter().flat_map(|r| r.iter().skip(k).step_by(d)).map(|v| v * v).sum()).collect();
        let average = variance.iter().sum::<f64>() / d.max(1) as f64;
        for row in &mut rest {
            for (k, value) in row.iter_mut().enumerate() {
                *value /= (WHITENED * variance[k % d] + (1.0 - WHITENED) * average).sqrt().max(1e-12);
            }
        }
        let mut among: Vec<f64> = (0..n * n).map(|k| dot(&rest[k / n], &rest[k % n])).collect();
        let trace: f64 = (0..n).map(|i| among[i * n + i]).sum();
        let scale = if trace > 0.0 { n as f64 / trace } else { 0.0 };
        among.iter_mut().for_each(|v| *v *= scale);
        among
    }
}
