//! Drawn postures as observations, and the standard deviation of a clip.
//!
//! The errors made on known clips show how errors correlate over time. Most of them last through a complete clip (a
//! stoop, an arm held high), so a single drawn posture corrects them everywhere. Let Σ be the covariance of the errors
//! of one axis over the cosines, φ_t the cosines at frame t, and y the drawn offset to the mean motion. Then
//!
//! c ← c + Σ Φᵀ (Φ Σ Φᵀ)⁻¹ (y − Φ c), Σ ← Σ − Σ Φᵀ (Φ Σ Φᵀ)⁻¹ Φ Σ,
//!
//! where Φ consists of the rows φ_t of the drawn frames. This is the conditioning of a Gaussian. Each axis has its own
//! Σ. With few clips it is blended with the Σ of all axes.

use super::basis::{Axes, COSINES};
use rototoon_base::numeric::dense::DenseCholesky;
use rototoon_base::scene::skeleton::COUNT;

/// The covariance of all axes together counts as much as this many clips.
const POOLED: f64 = 20.0;
/// The mean size of the errors counts as much as this many clips of a motion.
const COMMON: f64 = 3.0;
/// Variance of a drawn value as a share of the axis's variance. It stands for the motion that the cosines cannot
/// express.
const DRAWN: f64 = 1e-3;

/// Errors of the predictions of known clips, by clip, cosine and axis.
pub(super) struct Errors {
    axes: usize,
    /// Character and motion of each clip.
    clips: Vec<(usize, usize)>,
    values: Vec<f64>,
}

impl Errors {
    /// No errors yet, for these clips (character, motion).
    pub fn new(axes: usize, clips: Vec<(usize, usize)>) -> Self {
        let values = vec![0.0; clips.len() * COSINES * axes];
        Self { axes, clips, values }
    }

    /// The errors of each clip, cosines × axes.
    pub fn by_clip(&self) -> Vec<((usize, usize), Vec<f64>)> {
        let size = (COSINES * self.axes).max(1);
        self.clips.iter().copied().zip(self.values.chunks_exact(size).map(<[f64]>::to_vec)).collect()
    }

    /// Stores an error.
    pub fn set(&mut self, clip: usize, cosine: usize, axis: usize, error: f64) {
        self.values[(clip * COSINES + cosine) * self.axes + axis] = error;
    }

    fn get(&self, clip: usize, cosine: usize, axis: usize) -> f64 {
        self.values[(clip * COSINES + cosine) * self.axes + axis]
    }

    /// Sum over clips of the products of errors, cosines × cosines.
    fn products(&self, axis: usize) -> Vec<f64> {
        let mut sum = vec![0.0; COSINES * COSINES];
        for clip in 0..self.clips.len() {
            for (k, value) in sum.iter_mut().enumerate() {
                *value += self.get(clip, k / COSINES, axis) * self.get(clip, k % COSINES, axis);
            }
        }
        sum
    }

    /// Squared size of the errors of one motion relative to all motions. Few clips draw it towards 1.
    fn scale(&self, motion: usize) -> f64 {
        let size = COSINES * self.axes;
        let squares: Vec<f64> =
            self.values.chunks_exact(size.max(1)).map(|clip| clip.iter().map(|e| e * e).sum()).collect();
        let average = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        let own: Vec<f64> =
            squares.iter().zip(&self.clips).filter(|(_, clip)| clip.1 == motion).map(|(e, _)| *e).collect();
        let sum = own.iter().sum::<f64>() + COMMON * average;
        if average > 0.0 { sum / ((own.len() as f64 + COMMON) * average) } else { 1.0 }
    }

    /// Covariance over the cosines for each axis.
    fn covariances(&self, motion: usize) -> Vec<Vec<f64>> {
        let products: Vec<Vec<f64>> = (0..self.axes).map(|axis| self.products(axis)).collect();
        let trace = |matrix: &[f64]| (0..COSINES).map(|k| matrix[k * COSINES + k]).sum::<f64>();
        let mut pooled = vec![0.0; COSINES * COSINES];
        products.iter().for_each(|own| pooled.iter_mut().zip(own).for_each(|(a, b)| *a += b));
        let all = trace(&pooled);
        if all > 0.0 {
            pooled.iter_mut().for_each(|v| *v /= all);
        } else {
            (0..COSINES).for_each(|k| pooled[k * COSINES + k] = if k == 0 { 0.8 } else { 0.2 / (COSINES - 1) as f64 });
        }
        let clips = self.clips.len() as f64;
        let scale = self.scale(motion) / clips.max(1.0);
        let mixed = |own: &Vec<f64>| {
            let size = trace(own).max(1e-12);
            let mix = |(a, b): (&f64, &f64)| scale * size * (a / size * clips + POOLED * b) / (clips + POOLED);
            own.iter().zip(&pooled).map(mix).collect()
        };
        products.iter().map(mixed).collect()
    }
}

/// Conditions coefficients (cosines × axes) on drawn values, given by frame and axis. Also returns the remaining
/// covariances.
pub(super) fn condition(
    mut coefficients: Vec<f64>,
    errors: &Errors,
    motion: usize,
    basis: &[[f64; COSINES]],
    drawn: &[(usize, Vec<f64>)],
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut covariances = errors.covariances(motion);
    let (axes, n) = (errors.axes, drawn.len());
    for (axis, covariance) in covariances.iter_mut().enumerate() {
        let at = |k: usize| &basis[drawn[k].0];
        let times = |row: &[f64; COSINES]| -> Vec<f64> {
            (0..COSINES).map(|i| (0..COSINES).map(|j| covariance[i * COSINES + j] * row[j]).sum()).collect()
        };
        let gains: Vec<Vec<f64>> = (0..n).map(|k| times(at(k))).collect(); // Σ Φᵀ, a column for each key
        let mut inner: Vec<f64> =
            (0..n * n).map(|k| at(k / n).iter().zip(&gains[k % n]).map(|(a, b)| a * b).sum()).collect();
        let size = (0..COSINES).map(|k| covariance[k * COSINES + k]).sum::<f64>();
        (0..n).for_each(|k| inner[k * n + k] += DRAWN * size);
        let Some(factor) = DenseCholesky::new(n, &inner).filter(|_| n > 0) else { continue };
        let mut left: Vec<f64> = drawn
            .iter()
            .map(|(frame, y)| {
                y[axis] - basis[*frame].iter().enumerate().map(|(k, c)| c * coefficients[k * axes + axis]).sum::<f64>()
            })
            .collect();
        factor.solve(&mut left, 1);
        let mut solved: Vec<f64> = gains.iter().flatten().copied().collect(); // keys × cosines
        factor.solve(&mut solved, COSINES);
        for i in 0..COSINES {
            coefficients[i * axes + axis] += (0..n).map(|k| gains[k][i] * left[k]).sum::<f64>();
            for j in 0..COSINES {
                covariance[i * COSINES + j] -= (0..n).map(|k| gains[k][i] * solved[k * COSINES + j]).sum::<f64>();
            }
        }
    }
    (coefficients, covariances)
}

/// Standard deviation of a coordinate of each key point in each frame: the root of the mean variance of x and y.
pub(super) fn deviation(covariances: &[Vec<f64>], axes: &Axes, basis: &[[f64; COSINES]]) -> Vec<[f64; COUNT]> {
    let at = |cosine: &[f64; COSINES]| {
        let along: Vec<f64> = covariances
            .iter()
            .map(|c| {
                (0..COSINES * COSINES).map(|k| cosine[k / COSINES] * c[k] * cosine[k % COSINES]).sum::<f64>().max(0.0)
            })
            .collect();
        std::array::from_fn(|point| {
            let variance = |d: usize| axes.vectors.iter().zip(&along).map(|(v, a)| v[d] * v[d] * a).sum::<f64>();
            (0.5 * (variance(2 * point) + variance(2 * point + 1))).sqrt()
        })
    };
    basis.iter().map(at).collect()
}
