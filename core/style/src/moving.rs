//! The movement of a character in a motion: what it adds beside its stance, over time.
//!
//! The process is that of `additive`, with a row for each cosine but the constant one. B is the covariance of `kernels`
//! with the middle weight of the posture term. L compares all that characters add to the movement of the other motions,
//! with equal weights. On 8 characters × 9 motions, with each clip left out in turn, the error of the movement is 0.0662 torso
//! lengths. The average of `gaussian` has 0.0672.
//!
//! Limits: the cost grows with the cube of the number of clips. With more than [`MOST_CLIPS`] clips the movement is left to
//! `gaussian`, as with fewer than three motions.

use super::additive::Additive;
use super::basis::COSINES;
use super::cells::Cells;
use super::kernels::{Kernels, Weights};
use super::likeness;
use super::stance::FEWEST_MOTIONS;

/// Rows of a motion.
const ROWS: usize = COSINES - 1;
/// w_p, the middle one of `gaussian`.
const POSTURE: f64 = 0.2;
/// n: between the middle and the greatest one of `gaussian`.
const NOISE: f64 = 0.4;
/// With more clips the process takes too long.
const MOST_CLIPS: usize = 200;

/// Predicts the movement of the target's character in its motion, the motion's mean included: all coefficients but those of
/// the constant cosine. The first `even` axes are even. `None` if too little is known, or too much.
pub(super) fn predict(cells: &Cells, kernels: &Kernels, even: usize, target: (usize, usize)) -> Option<Vec<f64>> {
    let (d, motions) = (cells.axes, cells.motions);
    let all = (0..cells.characters).flat_map(|s| (0..motions).map(move |m| (s, m)));
    let known: Vec<(usize, usize)> = all.filter(|&(s, m)| cells.known[s * motions + m] && (s, m) != target).collect();
    if motions < FEWEST_MOTIONS || known.len() > MOST_CLIPS {
        return None;
    }
    let means: Vec<Vec<f64>> = (0..motions).map(|m| mean(cells, m, &known)).collect();
    let added: Vec<Vec<f64>> = known
        .iter()
        .map(|&(s, m)| cells.block(s, m)[d..].iter().zip(&means[m]).map(|(a, b)| a - b).collect())
        .collect();
    let clips = (0..motions).filter(|&m| m != target.1).map(|m| {
        let of = known.iter().zip(&added).filter(|(cell, _)| cell.1 == m);
        of.map(|(cell, row)| (cell.0, &row[..])).collect()
    });
    let likeness = likeness::of_clips(cells.characters, clips);
    let mut result = means[target.1].clone();
    for (columns, side) in [(0..even, true), (even..d, false)] {
        let among = rows_that_move(kernels, side);
        let process =
            Additive { likeness: &likeness, characters: cells.characters, among: &among, rows: ROWS, noise: NOISE };
        let values: Vec<f64> =
            added.iter().flat_map(|clip| clip.chunks_exact(d).flat_map(|row| &row[columns.clone()])).copied().collect();
        let found = process.predict(&known, &values, columns.len(), target)?;
        for (row, found) in result.chunks_exact_mut(d).zip(found.chunks_exact(columns.len().max(1))) {
            row[columns.clone()].iter_mut().zip(found).for_each(|(sum, v)| *sum += v);
        }
    }
    Some(result)
}

/// Mean movement of a motion over the known clips; 0 if there are none.
fn mean(cells: &Cells, motion: usize, known: &[(usize, usize)]) -> Vec<f64> {
    let mut sum = vec![0.0; ROWS * cells.axes];
    let mut count = 0.0;
    for &(s, m) in known.iter().filter(|cell| cell.1 == motion) {
        count += 1.0;
        sum.iter_mut().zip(&cells.block(s, m)[cells.axes..]).for_each(|(a, b)| *a += b);
    }
    sum.iter_mut().for_each(|v| *v /= f64::max(count, 1.0));
    sum
}

/// The covariance of `kernels` without the rows of the constant cosine.
fn rows_that_move(kernels: &Kernels, even: bool) -> Vec<f64> {
    let covariance = kernels.covariance(Weights { posture: POSTURE, noise: 0.0 }, even);
    let moving: Vec<usize> = (0..kernels.size).filter(|k| k % COSINES != 0).collect();
    moving
        .iter()
        .flat_map(|&i| moving.iter().map(move |&j| (i, j)))
        .map(|(i, j)| covariance[i * kernels.size + j])
        .collect()
}
