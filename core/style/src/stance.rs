//! The stance of a character in a motion: what it adds on average over time.
//!
//! Most of the unpredictable part of a clip is its static posture: who stoops, how far, in which motion. The process of
//! `gaussian` joins characters and motions by a product of covariances, noise included. Even the accidents of a clip
//! then count as shared by similar characters. For the static part a sum of covariances fits better. Let Z[a, b] be
//! what character a adds to motion b, one number for each axis. Then
//!
//! K = c 11ᵀ ⊗ I + L ⊗ B + I ⊗ B + I ⊗ I:
//!
//! - c 11ᵀ ⊗ I leaves the mean of each motion free (c is large).
//! - L ⊗ B: similar characters add alike to similar motions. L = Σ_b Z_b Z_bᵀ / ‖Z_b‖² over all motions except the one
//!   to be predicted, with unit mean diagonal. It includes all axes. If others who stoop when walking lower the arms
//!   when waving, a stooping walker is expected to do so too. Each motion counts the same, however much it varies.
//! - I ⊗ B: a character adds alike to similar motions, independently of other characters. B is the covariance of
//!   postures of `kernels`, averaged over time, with unit diagonal.
//! - I ⊗ I is the rest.
//!
//! The prediction is the conditional mean (Rasmussen & Williams 2006, eq. 2.25) given the known clips, separately for
//! the even and the odd axes. The terms have equal weights: weights fitted on one half of the characters were as often
//! worse as better on the other half. On 8 characters × 9 motions, with each clip left out in turn, the stance reduces
//! the error of the complete clip from 0.1223 to 0.1188 torso lengths.
//!
//! Limits: two motions are too few to measure similarity; they are left to `gaussian`. The cost grows with the cube of
//! the number of clips.

use super::cells::Cells;
use super::kernels::Kernels;
use rototoon_base::numeric::dense::DenseCholesky;

/// c.
const MEAN_VARIANCE: f64 = 30.0;
/// With at least this many motions the prediction is better than that of `gaussian`.
const FEWEST_MOTIONS: usize = 3;

/// Predicts the stance of the target's character in its motion, the motion's mean included. Returns the coefficient of
/// the constant cosine for each axis; the first `even` axes are even. `None` if too little is known.
pub(super) fn predict(cells: &Cells, kernels: &Kernels, even: usize, target: (usize, usize)) -> Option<Vec<f64>> {
    let keep = |s: usize, m: usize| cells.known[s * cells.motions + m] && (s, m) != target;
    from(cells, kernels, even, target, &keep)
}

/// The mean stance of a motion over the clips that `keep` accepts; 0 if there are none.
pub(super) fn mean(cells: &Cells, motion: usize, keep: &dyn Fn(usize, usize) -> bool) -> Vec<f64> {
    let mut sum = vec![0.0; cells.axes];
    let mut count = 0.0;
    for s in (0..cells.characters).filter(|&s| keep(s, motion)) {
        count += 1.0;
        sum.iter_mut().zip(cells.block(s, motion)).for_each(|(a, b)| *a += b);
    }
    sum.iter_mut().for_each(|v| *v /= f64::max(count, 1.0));
    sum
}

/// Like [`predict`], from the clips (character, motion) that `keep` accepts.
pub(super) fn from(
    cells: &Cells,
    kernels: &Kernels,
    even: usize,
    target: (usize, usize),
    keep: &dyn Fn(usize, usize) -> bool,
) -> Option<Vec<f64>> {
    let motions = cells.motions;
    if motions < FEWEST_MOTIONS {
        return None;
    }
    let means: Vec<Vec<f64>> = (0..motions).map(|m| mean(cells, m, keep)).collect();
    let known: Vec<(usize, usize)> =
        (0..cells.characters).flat_map(|s| (0..motions).map(move |m| (s, m))).filter(|&(s, m)| keep(s, m)).collect();
    let added = |(s, m): (usize, usize)| -> Vec<f64> {
        cells.block(s, m)[..cells.axes].iter().zip(&means[m]).map(|(a, b)| a - b).collect()
    };
    let likeness = likeness(cells.characters, &known, target.1, &added);
    let mut result = means[target.1].clone();
    for (columns, side) in [(0..even, true), (even..cells.axes, false)] {
        let among = kernels.stances(side);
        let covariance = |(a, b): (usize, usize), (e, f): (usize, usize)| {
            let one = |same: bool| f64::from(u8::from(same));
            let alike = among[b * motions + f];
            one(b == f) * (MEAN_VARIANCE + one(a == e)) + alike * (likeness[a * cells.characters + e] + one(a == e))
        };
        let n = known.len();
        let matrix: Vec<f64> = (0..n * n).map(|k| covariance(known[k / n], known[k % n])).collect();
        let mut weighted: Vec<f64> = known.iter().flat_map(|&cell| added(cell)[columns.clone()].to_vec()).collect();
        DenseCholesky::new(n, &matrix)?.solve(&mut weighted, columns.len());
        for (&cell, row) in known.iter().zip(weighted.chunks_exact(columns.len().max(1))) {
            let share = covariance(target, cell);
            result[columns.clone()].iter_mut().zip(row).for_each(|(sum, v)| *sum += share * v);
        }
    }
    Some(result)
}

/// L: similarity of characters in what they add to all motions except one.
fn likeness(
    characters: usize,
    known: &[(usize, usize)],
    without: usize,
    added: &dyn Fn((usize, usize)) -> Vec<f64>,
) -> Vec<f64> {
    let mut sum = vec![0.0; characters * characters];
    let mut motions: Vec<usize> = known.iter().map(|&(_, m)| m).filter(|&m| m != without).collect();
    motions.sort_unstable();
    motions.dedup();
    for m in motions {
        let of: Vec<(usize, Vec<f64>)> =
            known.iter().filter(|cell| cell.1 == m).map(|&cell| (cell.0, added(cell))).collect();
        let square: f64 = of.iter().flat_map(|(_, row)| row).map(|v| v * v).sum();
        if square < 1e-18 {
            continue;
        }
        for (a, left) in &of {
            for (e, right) in &of {
                sum[a * characters + e] += left.iter().zip(right).map(|(v, w)| v * w).sum::<f64>() / square;
            }
        }
    }
    let trace: f64 = (0..characters).map(|i| sum[i * characters + i]).sum();
    let scale = if trace > 0.0 { characters as f64 / trace } else { 0.0 };
    sum.iter_mut().for_each(|v| *v *= scale);
    sum
}

#[cfg(test)]
mod tests {
    use super::super::basis::{COSINES, MODEL_FRAMES};
    use super::super::grid::{Row, WIDTH};
    use super::*;

    const CHARACTERS: usize = 4;

    /// Clips without movement, with two even axes and an odd one; `added` gives what a character adds to a motion.
    fn cells(motions: usize, added: impl Fn(usize, usize) -> [f64; 3]) -> Cells {
        let clip = |s: usize, m: usize| {
            let mut block = vec![0.0; COSINES * 3];
            block[..3].copy_from_slice(&added(s, m).map(|v| v + 7.0 * m as f64));
            block
        };
        Cells {
            characters: CHARACTERS,
            motions,
            axes: 3,
            known: (0..CHARACTERS * motions).map(|k| k != 0).collect(),
            x: (0..CHARACTERS).map(|s| (0..motions).flat_map(|m| clip(s, m)).collect()).collect(),
        }
    }

    /// Kernels of motions whose mean postures are `apart` from each other.
    fn kernels(motions: usize, apart: f64) -> Kernels {
        let mean = |m: usize| -> Row { std::array::from_fn(|d| if d == WIDTH - 1 { m as f64 * apart } else { 0.0 }) };
        Kernels::new(&(0..motions).map(|m| vec![mean(m); MODEL_FRAMES]).collect::<Vec<_>>())
    }

    /// The prediction for character 0 in motion 0, without the motion's mean.
    fn predicted(motions: usize, apart: f64, added: impl Fn(usize, usize) -> [f64; 3]) -> [f64; 3] {
        let cells = cells(motions, added);
        let found = predict(&cells, &kernels(motions, apart), 2, (0, 0)).unwrap();
        let mean = cells.mean_of(0, 0);
        [0, 1, 2].map(|axis| found[axis] - mean[axis])
    }

    #[test]
    fn who_adds_the_same_to_all_motions_is_expected_to_add_it_here() {
        let own = [[1.0, -2.0, 0.5], [0.2, 0.4, -0.3], [-0.5, 0.6, 0.2], [-0.7, 1.0, -0.4]];
        let found = predicted(6, 0.1, |s, _| own[s]);
        // This is what remains of the common offset relative to the mean of the others.
        let left = [0, 1, 2].map(|axis| own[0][axis] - (1..4).map(|s| own[s][axis]).sum::<f64>() / 3.0);
        for axis in 0..3 {
            assert!((found[axis] - left[axis]).abs() < 0.3 * left[axis].abs(), "{found:?} for {left:?}");
        }
    }

    #[test]
    fn who_is_like_another_is_expected_to_do_as_that_one_does() {
        // Characters 0 and 1 agree in every other motion. In those the axes alternate, and the motions have nothing in
        // common.
        let sign = |s: usize| if s < 2 { 1.0 } else { -1.0 };
        let found =
            predicted(7, 5.0, |s, m| [sign(s) * [3.0, 1.0, -1.0][m % 3], 0.0, sign(s) * [2.0, -1.0, 1.0][m % 3]]);
        // Of the other characters in motion 0 one has 3 and two have −3, so their mean is −1.
        assert!(found[0] > 1.0 && found[2] > 0.5, "towards the one that it is like: {found:?}");
        assert!(found[1].abs() < 1e-9);
    }

    #[test]
    fn two_motions_are_too_few() {
        let cells = cells(2, |s, _| [s as f64, 0.0, 1.0]);
        assert_eq!(predict(&cells, &kernels(2, 1.0), 2, (0, 0)), None);
    }

    #[test]
    fn nothing_added_is_nothing_predicted() {
        assert!(predicted(4, 1.0, |_, _| [0.0; 3]).iter().all(|v| v.abs() < 1e-9));
    }
}
