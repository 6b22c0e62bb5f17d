//! Gaussian processes that predict what a character adds to a motion, from what it adds to other motions and what other
//! characters add.
//!
//! X[s, m] contains the clip of character s and motion m in the coordinates of `basis`, with a column for each axis.
//! The mean motion is removed. Each axis is then a Gaussian process over characters × (motion, time) with covariance
//! (K_s + c 11ᵀ) ⊗ K_m. K_m comes from `kernels`, K_s is the covariance between characters, and c is large, which
//! leaves the mean of a motion free.
//!
//! - **Characters.** K_s = (1 − γ) S + γ I. S is the covariance of what characters add on average over time, taken from
//!   all motions except the one to be predicted. Two characters that walk, run and stand alike are expected to jump
//!   alike.
//! - **Motions.** The static half of K_m moves by the share g towards the covariance observed among the other
//!   characters. Someone who leans when walking also leans when walking sideways, even if the postures differ.
//! - **Leaving one clip out.** With the Kronecker form the prediction of a clip from all others needs no new
//!   factorisation: e = (B⁻¹)[K⁻¹ X], where B is the clip's block of K⁻¹ (Rasmussen & Williams 2006, eq. 5.12,
//!   blockwise). The same formula predicts the hole of the grid; the values that fill the hole cancel out.
//! - **Averaging.** Noise, weight of the posture, γ and g take the values of a small grid. The best values differ
//!   between axes, and between the static and the moving part: a stoop lasts through all motions, a waving hand does
//!   not. Therefore each axis and part gets its own average, weighted by exp(−κ log E), where E is the leave-one-out
//!   error. This is a likelihood of Gaussian errors; κ is proportional to the number of clips. The clips determine
//!   these four settings, not a constant.
//! - **Stance and movement.** The mean of a clip over time is most of what can be predicted. It comes from a process of its
//!   own, `stance`, and so does the rest, `moving`. The averages above give the covariances of errors, and everything in a
//!   library that is too small or too large for those processes.
//! - **Strength.** Beyond the most probable result, away from the mean and from the nearest other character: `distinct`.
//! - **Few clips of a style.** Whether they tell anything is rehearsed on the other characters: `episodes`.
//! - **Uncertainty.** The covariance of the leave-one-out errors over time, axis by axis, serves as the covariance of
//!   the prediction. `key_pose` conditions on drawn postures with it.
//!
//! Limits: the cost grows with the cube of motions × cosines. A posture is one point of a Gaussian. If a manner does a
//! thing in one of two ways, the prediction is the mean of both.

use super::basis::{Axes, COSINES, MODEL_FRAMES, cosines};
use super::cells::Cells;
use super::grid::{Grid, Row, WIDTH, mean};
use super::kernels::{Kernels, Weights};
use super::key_pose::{Errors, condition, deviation};
use super::{Prediction, STEP, Sure, distinct, episodes, moving, stance};
use rayon::iter::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::numeric::dense::DenseCholesky;
use rototoon_base::numeric::vector::dot;
use rototoon_base::scene::{Cancelled, Progress};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Values of n, w_p, γ and g.
const NOISE: [f64; 3] = [0.05, 0.2, 0.8];
const POSTURE: [f64; 3] = [0.05, 0.2, 0.6];
const SHRINK: [f64; 3] = [0.4, 0.7, 1.0];
const OBSERVED: [f64; 4] = [0.0, 0.3, 0.6, 0.85];
/// κ for each clip: on each axis a clip counts as about one and a half independent numbers.
const WEIGHT_PER_CLIP: f64 = 0.85;
/// Rounds in which holes of the grid beside the wanted one are filled.
const FILLING: usize = 3;

/// One setting's predictions of every clip from all others, in the layout of [`Cells`]; `None` where its covariance is not
/// positive definite.
type LeftOut = Option<Vec<Vec<f64>>>;

/// Data that all settings share.
struct Shared<'a> {
    cells: &'a Cells,
    kernels: &'a Kernels,
    even: usize,
    observed: Vec<Vec<f64>>,
    /// One entry for each γ.
    styles: Vec<Styles>,
}

/// Covariance between characters.
struct Styles {
    /// Precision matrices, by the motion left out.
    precisions: Vec<Vec<f64>>,
    /// Σ_t `(K_s⁻¹)[s, t] Z[t]`, by character s and the motion left out.
    mixed: Vec<Vec<Vec<f64>>>,
}

impl<'a> Shared<'a> {
    fn new(cells: &'a Cells, kernels: &'a Kernels, even: usize, shrinks: &[f64]) -> Self {
        let observed = (0..cells.characters).into_par_iter().map(|s| cells.observed(s)).collect();
        let styles = shrinks.par_iter().map(|&shrink| {
            let precisions = cells.style_precisions(shrink);
            let mixed = (0..cells.characters).map(|s| mixed(cells, &precisions, s)).collect();
            Styles { precisions, mixed }
        });
        Self { cells, kernels, even, observed, styles: styles.collect() }
    }
}

/// For one character and each motion left out: clips minus the mean of the others, weighted by the character's row of
/// the precision.
fn mixed(cells: &Cells, precisions: &[Vec<f64>], s: usize) -> Vec<Vec<f64>> {
    let means: Vec<f64> = (0..cells.motions).flat_map(|m| cells.mean_of(m, s)).collect();
    let n = cells.characters;
    precisions
        .iter()
        .map(|precision| {
            let mut sum = vec![0.0; means.len()];
            for t in 0..n {
                let weight = precision[s * n + t];
                let clips = cells.x[t].iter().zip(&means);
                sum.iter_mut().zip(clips).for_each(|(a, (x, mean))| *a += weight * (x - mean));
            }
            sum
        })
        .collect()
}

/// Predictions with all settings of γ and g for one covariance of motions. g varies in the outer loop.
fn left_out(shared: &Shared, weights: Weights, observed: &[f64]) -> Vec<LeftOut> {
    let cells = shared.cells;
    let empty = || Some(vec![vec![0.0; cells.x.first().map_or(0, Vec::len)]; cells.characters]);
    let mut found: Vec<LeftOut> = (0..observed.len() * shared.styles.len()).map(|_| empty()).collect();
    for even in [true, false] {
        let columns = if even { 0..shared.even } else { shared.even..cells.axes };
        let covariance = shared.kernels.covariance(weights, even);
        let split = Split::new(shared.kernels.size, &covariance);
        for (k, &g) in observed.iter().enumerate() {
            for s in 0..cells.characters {
                let precision = split.as_ref().and_then(|split| split.drawn(&shared.observed[s], g));
                for q in 0..shared.styles.len() {
                    let place = &mut found[k * shared.styles.len() + q];
                    let done = place
                        .as_mut()
                        .zip(precision.as_ref())
                        .and_then(|(into, precision)| clips_of(shared, precision, q, s, columns.clone(), &mut into[s]));
                    if done.is_none() {
                        *place = None;
                    }
                }
            }
        }
    }
    found
}

/// Predicts each clip of a character from all others.
fn clips_of(
    shared: &Shared,
    precision: &[f64],
    q: usize,
    s: usize,
    columns: std::ops::Range<usize>,
    into: &mut [f64],
) -> Option<()> {
    let (cells, size, d) = (shared.cells, shared.kernels.size, shared.cells.axes);
    let Styles { precisions, mixed } = &shared.styles[q];
    let width = columns.len();
    for m in 0..cells.motions {
        let at = m * COSINES;
        let mut block = vec![0.0; COSINES * COSINES];
        let mut error = vec![0.0; COSINES * width];
        for i in 0..COSINES {
            let row = &precision[(at + i) * size..(at + i + 1) * size];
            block[i * COSINES..(i + 1) * COSINES].copy_from_slice(&row[at..at + COSINES]);
            let sum = &mut error[i * width..(i + 1) * width];
            for (n, weight) in row.iter().enumerate() {
                let values = &mixed[s][m][n * d + columns.start..n * d + columns.end];
                sum.iter_mut().zip(values).for_each(|(a, v)| *a += weight * v);
            }
        }
        DenseCholesky::new(COSINES, &block)?.solve(&mut error, width);
        let own = precisions[m][s * cells.characters + s];
        for i in 0..COSINES {
            for c in 0..width {
                let place = (at + i) * d + columns.start + c;
                into[place] = cells.x[s][place] - error[i * width + c] / own;
            }
        }
    }
    Some(())
}

/// The inverse of a covariance of motions, split so that its static block can be replaced cheaply. With E the static
/// rows, K⁻¹ = A₀ + Q (K / rest)⁻¹ Qᵀ. A change of the static block changes only the Schur complement K / rest.
struct Split {
    n: usize,
    /// K_EE.
    fixed: Vec<f64>,
    /// K_EE minus the part that the moving rows explain: the Schur complement.
    complement: Vec<f64>,
    rest: Vec<f64>,
    q: Vec<f64>,
}

impl Split {
    fn new(n: usize, covariance: &[f64]) -> Option<Self> {
        let inverse = DenseCholesky::new(n, covariance)?.inverse();
        let m = n / COSINES;
        let at = |i: usize, j: usize| (i * COSINES) * n + j * COSINES;
        let pick = |from: &[f64]| (0..m * m).map(|k| from[at(k / m, k % m)]).collect::<Vec<f64>>();
        let (fixed, own) = (pick(covariance), pick(&inverse));
        let complement = DenseCholesky::new(m, &own)?.inverse();
        let mut q = vec![0.0; n * m];
        for i in 0..n {
            for j in 0..m {
                q[i * m + j] = (0..m).map(|e| inverse[i * n + e * COSINES] * complement[e * m + j]).sum();
            }
        }
        let mut rest = inverse;
        add_product(&mut rest, &q, &own, n, m, -1.0);
        Some(Self { n, fixed, complement, rest, q })
    }

    /// The inverse after the static block is moved by `share` towards an observed covariance of mean variance 1.
    fn drawn(&self, observed: &[f64], share: f64) -> Option<Vec<f64>> {
        let m = self.n / COSINES;
        let scale = (0..m).map(|i| self.fixed[i * m + i]).sum::<f64>() / m as f64;
        let changed: Vec<f64> =
            (0..m * m).map(|k| self.complement[k] + share * (observed[k] * scale - self.fixed[k])).collect();
        let middle = DenseCholesky::new(m, &changed)?.inverse();
        let mut inverse = self.rest.clone();
        add_product(&mut inverse, &self.q, &middle, self.n, m, 1.0);
        Some(inverse)
    }
}

/// into += factor · Q M Qᵀ.
fn add_product(into: &mut [f64], q: &[f64], middle: &[f64], n: usize, m: usize, factor: f64) {
    let mut left = vec![0.0; n * m];
    for i in 0..n {
        for j in 0..m {
            left[i * m + j] = factor * (0..m).map(|e| q[i * m + e] * middle[e * m + j]).sum::<f64>();
        }
    }
    for i in 0..n {
        for j in 0..n {
            into[i * n + j] += dot(&left[i * m..(i + 1) * m], &q[j * m..(j + 1) * m]);
        }
    }
}

/// Fills the holes of the grid, except the requested one, with the predictions of a middle setting.
fn fill(cells: &mut Cells, kernels: &Kernels, even: usize, target: (usize, usize)) {
    let holes: Vec<(usize, usize)> = (0..cells.characters)
        .flat_map(|s| (0..cells.motions).map(move |m| (s, m)))
        .filter(|&(s, m)| !cells.known[s * cells.motions + m] && (s, m) != target)
        .collect();
    let middling = Weights { posture: POSTURE[1], noise: NOISE[1] };
    for _ in 0..if holes.is_empty() { 0 } else { FILLING } {
        let shared = Shared::new(cells, kernels, even, &SHRINK[1..2]);
        let Some(found) = left_out(&shared, middling, &OBSERVED[1..2]).remove(0) else { return };
        let size = COSINES * cells.axes;
        for &(s, m) in &holes {
            let place = m * size..(m + 1) * size;
            cells.x[s][place.clone()].copy_from_slice(&found[s][place]);
        }
    }
}

/// Averages the predictions of all settings. Also returns the errors that the average makes on the known clips.
fn averaged(cells: &Cells, found: &[Vec<Vec<f64>>], target: (usize, usize)) -> (Vec<f64>, Errors) {
    let (d, motions) = (cells.axes, cells.motions);
    let clips: Vec<(usize, usize)> = (0..cells.characters)
        .flat_map(|s| (0..motions).map(move |m| (s, m)))
        .filter(|&(s, m)| cells.known[s * motions + m] && (s, m) != target)
        .collect();
    let sharpness = WEIGHT_PER_CLIP * clips.len() as f64;
    let mut errors = Errors::new(d, clips.clone());
    let mut coefficients = vec![0.0; COSINES * d];
    for axis in 0..d {
        for band in [0..1, 1..COSINES] {
            let wrong = |setting: &Vec<Vec<f64>>| {
                let part =
                    clips.iter().flat_map(|&(s, m)| band.clone().map(move |k| (s, (m * COSINES + k) * d + axis)));
                part.map(|(s, at)| (setting[s][at] - cells.x[s][at]).powi(2)).sum::<f64>() + 1e-9
            };
            let log: Vec<f64> = found.iter().map(|setting| wrong(setting).ln()).collect();
            let least = log.iter().copied().fold(f64::INFINITY, f64::min);
            let weights: Vec<f64> = log.iter().map(|e| (-sharpness * (e - least)).exp()).collect();
            let total: f64 = weights.iter().sum();
            let average = |s: usize, at: usize| {
                found.iter().zip(&weights).map(|(setting, w)| w * setting[s][at]).sum::<f64>() / total
            };
            for k in band {
                let at = |m: usize| (m * COSINES + k) * d + axis;
                coefficients[k * d + axis] = average(target.0, at(target.1));
                for (c, &(s, m)) in clips.iter().enumerate() {
                    errors.set(c, k, axis, cells.x[s][at(m)] - average(s, at(m)));
                }
            }
        }
    }
    (coefficients, errors)
}

/// The rows of all clips without the mean of their motion.
fn residuals(grid: &Grid, means: &[Vec<Row>]) -> Vec<Row> {
    let mut residuals: Vec<Row> = Vec::new();
    for (m, mean) in means.iter().enumerate() {
        for rows in (0..grid.characters.len()).filter_map(|s| grid.rows(s, m, MODEL_FRAMES)) {
            residuals.extend(rows.iter().zip(mean).map(|(a, b)| -> Row { std::array::from_fn(|d| a[d] - b[d]) }));
        }
    }
    residuals
}

/// Puts the predicted stance and movement into the coefficients, if they can be predicted. Where an episode of the stance is judged
/// sure, the rest moves towards the content's clip. Returns that judgement.
fn with_parts(
    grid: &Grid,
    cells: &Cells,
    kernels: &Kernels,
    axes: &Axes,
    errors: &Errors,
    coefficients: &mut [f64],
) -> Option<Sure> {
    let (style, motion) = (grid.style, grid.motion);
    if let Some(moving) = moving::predict(cells, kernels, axes.even, (style, motion)) {
        coefficients[axes.len()..].copy_from_slice(&moving);
    }
    let mut stance = stance::predict(cells, kernels, axes, (style, motion))?;
    let sure = episodes::judge(cells, kernels, axes, (style, motion, grid.content), &mut stance);
    coefficients[..stance.len()].copy_from_slice(&stance);
    if sure.is_some() {
        let share = episodes::moving_share(cells, grid.content, &errors.by_clip());
        let content = cells.block(grid.content, motion);
        for (c, v) in coefficients.iter_mut().zip(content).skip(axes.len()) {
            *c += share * (v - *c);
        }
    }
    sure
}

/// Predicts the requested clip.
pub(super) fn predict(
    grid: &Grid,
    keys: &[(usize, Row)],
    strength: f64,
    progress: &dyn Progress,
) -> Result<Prediction, Cancelled> {
    let means: Vec<Vec<Row>> = (0..grid.motions.len())
        .map(|m| {
            mean((0..grid.characters.len()).filter_map(|s| grid.rows(s, m, MODEL_FRAMES)))
                .unwrap_or_else(|| vec![[0.0; WIDTH]; MODEL_FRAMES])
        })
        .collect();
    let axes = Axes::of(residuals(grid, &means).iter());
    let target = (grid.style, grid.motion);
    let kernels = Kernels::new(&means);
    let mut cells = Cells::new(grid, &axes);
    fill(&mut cells, &kernels, axes.even, target);
    progress.report(STEP, 0.1)?;
    let bases: Vec<Weights> =
        NOISE.iter().flat_map(|&noise| POSTURE.iter().map(move |&posture| Weights { posture, noise })).collect();
    let shared = Shared::new(&cells, &kernels, axes.even, &SHRINK);
    let done = AtomicUsize::new(0);
    let found = bases.par_iter().map(|&base| {
        let found = left_out(&shared, base, &OBSERVED);
        let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report(STEP, 0.1 + 0.8 * finished as f64 / bases.len() as f64)?;
        Ok(found)
    });
    let found: Vec<Vec<LeftOut>> = found.collect::<Result<_, Cancelled>>()?;
    let found: Vec<Vec<Vec<f64>>> = found.into_iter().flatten().flatten().collect();
    let (mut coefficients, errors) = averaged(&cells, &found, target);
    let sure = with_parts(grid, &cells, &kernels, &axes, &errors, &mut coefficients);
    lay_on(&cells, target, strength, sure, &mut coefficients);
    Ok(Prediction { sure, ..assemble(grid, &axes, coefficients, &errors, keys) })
}

/// Turns the coefficients into the offset from the mean motion, with this strength. A result that is not trusted is not made
/// more distinct.
fn lay_on(cells: &Cells, target: (usize, usize), strength: f64, sure: Option<Sure>, coefficients: &mut [f64]) {
    let (style, motion) = target;
    let mean = cells.mean_of(motion, style);
    let others = (0..cells.characters).filter(|&s| s != style && cells.known[s * cells.motions + motion]);
    let added = |s: usize| cells.block(s, motion).iter().zip(&mean).map(|(c, mean)| c - mean).collect();
    let others: Vec<Vec<f64>> = others.map(added).collect();
    coefficients.iter_mut().zip(&mean).for_each(|(c, mean)| *c -= mean);
    let trusted = sure.map_or(1.0, |sure| sure.offset * (1.0 - sure.content));
    distinct::lay_on(coefficients, &others, strength, trusted);
}

/// The clip from its offset to the mean motion, conditioned on the key poses.
fn assemble(grid: &Grid, axes: &Axes, coefficients: Vec<f64>, errors: &Errors, keys: &[(usize, Row)]) -> Prediction {
    let mean = grid.mean_without(grid.style, grid.motion, grid.frames).unwrap_or_default();
    let basis = cosines(grid.frames);
    let wanted: Vec<(usize, Vec<f64>)> = keys
        .iter()
        .map(|(frame, key)| (*frame, axes.coordinates(&std::array::from_fn(|d| key[d] - mean[*frame][d]))))
        .collect();
    let (coefficients, covariances) = condition(coefficients, errors, grid.motion, &basis, &wanted);
    let rows = mean.iter().zip(&basis).map(|(mean, cosine)| {
        let mut row = *mean;
        for (axis, vector) in axes.vectors.iter().enumerate() {
            let along: f64 = cosine.iter().enumerate().map(|(k, c)| c * coefficients[k * axes.len() + axis]).sum();
            row.iter_mut().zip(vector).for_each(|(value, v)| *value += along * v);
        }
        row
    });
    Prediction { rows: rows.collect(), deviation: deviation(&covariances, axes, &basis), sure: None }
}
