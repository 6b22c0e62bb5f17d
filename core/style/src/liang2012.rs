//! Translation by non-negative style factorisation: the content's codes with the style's basis.
//!
//! The paper factors each character separately and exchanges the bases. Two separate factorisations share no order of
//! components, so the exchange is worse than no translation at all. Here the codes are shared. A row of X is one moment
//! of one motion; its columns are the postures of all characters side by side. One code then says what happens, and
//! each character's columns of V say how that character does it.
//!
//! The style's columns are fitted to the rows of its known motions. The fit is the multiplicative step of V with U
//! fixed, and it starts at the mean character. The codes of the requested motion times these columns are the result.
//! The start at the mean and an early stop keep 24 free codes from overfitting few clips.

use super::Prediction;
use super::basis::MODEL_FRAMES;
use super::bilinear::{held_apart, onto_frames, spread};
use super::factorisation::{Options as FactorOptions, factor};
use super::grid::{Grid, Row, WIDTH, mean};
use faer::Mat;

/// Rounds that fit the style's columns.
const STYLE_ROUNDS: usize = 30;
/// Smallest value of the shifted numbers, in torso lengths.
const ABOVE_ZERO: f64 = 0.05;
/// β.
const CLASS_WEIGHT: f64 = 0.01;
/// Keeps denominators away from zero.
const TINY: f64 = 1e-12;

/// Predicts the requested clip; `rank` replaces the number of codes.
pub(super) fn predict(grid: &Grid, keys: &[(usize, Row)], rank: Option<usize>) -> Prediction {
    let k = rank.unwrap_or(FactorOptions::default().rank).max(1);
    let known: Vec<usize> =
        (0..grid.motions.len()).filter(|&m| m != grid.motion && grid.get(grid.style, m).is_some()).collect();
    let made = from_motions(grid, &known, grid.motion, k);
    let apart = held_apart(grid, &known, |rest, left_out| from_motions(grid, rest, left_out, k));
    let rows = onto_frames(grid, &made);
    spread(grid, rows, &apart, keys)
}

/// Predicts the style's clip of the motion `wanted` from its clips of the `known` motions.
fn from_motions(grid: &Grid, known: &[usize], wanted: usize, k: usize) -> Vec<Row> {
    let others: Vec<usize> = (0..grid.characters.len()).filter(|&s| s != grid.style).collect();
    let order: Vec<usize> = known.iter().copied().chain(std::iter::once(wanted)).collect();
    // If another character lacks a clip, the mean of the characters that have it takes its place.
    let clips: Vec<Vec<Vec<Row>>> = others
        .iter()
        .map(|&s| {
            let clip =
                |&m: &usize| grid.rows(s, m, MODEL_FRAMES).or_else(|| grid.mean_without(grid.style, m, MODEL_FRAMES));
            order.iter().map(|m| clip(m).unwrap_or_else(|| vec![[0.0; WIDTH]; MODEL_FRAMES])).collect()
        })
        .collect();
    let own: Vec<Vec<Row>> = known.iter().filter_map(|&m| grid.rows(grid.style, m, MODEL_FRAMES)).collect();
    let rows = || clips.iter().flatten().chain(&own).flatten();
    let shift: Row = std::array::from_fn(|d| rows().map(|row| row[d]).fold(f64::INFINITY, f64::min) - ABOVE_ZERO);
    let x = Mat::from_fn(order.len() * MODEL_FRAMES, others.len() * WIDTH, |row, column| {
        let d = column % WIDTH;
        clips[column / WIDTH][row / MODEL_FRAMES][row % MODEL_FRAMES][d] - shift[d]
    });
    let labels: Vec<usize> = (0..x.nrows()).map(|row| row / MODEL_FRAMES).collect();
    // More codes than the matrix has rows or columns add nothing but time.
    let k = k.min(x.nrows()).min(x.ncols());
    let options = FactorOptions { rank: k, class_weight: CLASS_WEIGHT, ..FactorOptions::default() };
    let Ok(found) = factor(x.as_ref(), &labels, &options) else { return mean_motion(grid, wanted) };
    let start = Mat::from_fn(k, WIDTH, |i, d| {
        (0..others.len()).map(|s| found.basis[(i, s * WIDTH + d)]).sum::<f64>() / others.len() as f64
    });
    let own = Mat::from_fn(known.len() * MODEL_FRAMES, WIDTH, |row, d| {
        own[row / MODEL_FRAMES][row % MODEL_FRAMES][d] - shift[d]
    });
    let codes = found.codes.subrows(0, own.nrows());
    let basis = columns(codes.transpose() * codes, codes.transpose() * &own, start);
    let made = found.codes.subrows(own.nrows(), MODEL_FRAMES) * &basis;
    (0..MODEL_FRAMES).map(|t| std::array::from_fn(|d| made[(t, d)] + shift[d])).collect()
}

/// Fits the style's columns of V.
fn columns(uu: Mat<f64>, ux: Mat<f64>, mut v: Mat<f64>) -> Mat<f64> {
    for _ in 0..STYLE_ROUNDS {
        let uuv = &uu * &v;
        v = Mat::from_fn(v.nrows(), v.ncols(), |i, j| v[(i, j)] * ux[(i, j)] / (uuv[(i, j)] + TINY));
    }
    v
}

fn mean_motion(grid: &Grid, m: usize) -> Vec<Row> {
    let clips = (0..grid.characters.len()).filter(|&s| s != grid.style).filter_map(|s| grid.rows(s, m, MODEL_FRAMES));
    mean(clips).unwrap_or_else(|| vec![[0.0; WIDTH]; MODEL_FRAMES])
}
