//! A Gaussian process over characters and motions whose covariance is a sum.
//!
//! Let Z[a, p] be what character a adds to row p of the motions; a motion has one row (`stance`) or several (`moving`).
//! Then
//!
//! K = c 11ᵀ ⊗ I + L ⊗ B + I ⊗ B + n I ⊗ I:
//!
//! - c 11ᵀ ⊗ I leaves the mean of each row free (c is large).
//! - L ⊗ B: characters that are alike (L, see `likeness`) add alike to rows that are alike (B).
//! - I ⊗ B: a character adds alike to rows that are alike, independently of other characters.
//! - n I ⊗ I is the rest.
//!
//! The prediction is the conditional mean given the known clips (Rasmussen & Williams 2006, eq. 2.25). The terms of L and of I
//! have equal weights: weights fitted on one half of the characters were as often worse as better on the other half.
//!
//! A product of the covariances of characters and rows, as in `gaussian`, also holds the noise. Even the accidents of a clip
//! then count as shared by similar characters. A sum does not have this fault.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// c.
const MEAN_VARIANCE: f64 = 30.0;

/// The process.
pub(super) struct Additive<'a> {
    /// L: characters × characters.
    pub likeness: &'a [f64],
    pub characters: usize,
    /// B: a square matrix with `rows` rows for each motion.
    pub among: &'a [f64],
    /// Rows of each motion.
    pub rows: usize,
    /// n.
    pub noise: f64,
}

impl Additive<'_> {
    /// Predicts the rows of the clip `target` (character, motion). `values` are the rows of the `known` clips, one after the
    /// other, with `width` numbers each. `None` if the covariance is not positive definite.
    pub fn predict(
        &self,
        known: &[(usize, usize)],
        values: &[f64],
        width: usize,
        target: (usize, usize),
    ) -> Option<Vec<f64>> {
        let places = |cell: (usize, usize)| (0..self.rows).map(move |k| (cell.0, cell.1 * self.rows + k));
        let from: Vec<(usize, usize)> = known.iter().copied().flat_map(places).collect();
        let matrix = Mat::from_fn(from.len(), from.len(), |i, j| self.covariance(from[i], from[j]));
        let mut weighted = Mat::from_fn(from.len(), width, |i, j| values[i * width + j]);
        matrix.llt(Side::Lower).ok()?.solve_in_place(weighted.as_mut());
        let mut found = vec![0.0; self.rows * width];
        for (place, row) in places(target).zip(found.chunks_exact_mut(width.max(1))) {
            for (i, &known) in from.iter().enumerate() {
                let share = self.covariance(place, known);
                row.iter_mut().enumerate().for_each(|(j, sum)| *sum += share * weighted[(i, j)]);
            }
        }
        Some(found)
    }

    /// Covariance of (character, row) with another.
    fn covariance(&self, (a, p): (usize, usize), (e, q): (usize, usize)) -> f64 {
        let size = self.among.len().isqrt();
        let own = f64::from(u8::from(a == e));
        let rest = if p == q { MEAN_VARIANCE + self.noise * own } else { 0.0 };
        rest + self.among[p * size + q] * (self.likeness[a * self.characters + e] + own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is predicted for character 0 in motion 0, from four characters that add `value` to three motions.
    fn predicted(likeness: &[f64], alike: f64, value: impl Fn(usize, usize) -> f64) -> f64 {
        let among: Vec<f64> = (0..9).map(|k| if k % 4 == 0 { 1.0 } else { alike }).collect();
        let process = Additive { likeness, characters: 4, among: &among, rows: 1, noise: 0.1 };
        let known: Vec<(usize, usize)> = (1..12).map(|k| (k / 3, k % 3)).collect();
        let values: Vec<f64> = known.iter().map(|&(s, m)| value(s, m)).collect();
        process.predict(&known, &values, 1, (0, 0)).unwrap()[0]
    }

    #[test]
    fn the_mean_of_a_motion_is_free() {
        assert!((predicted(&[0.0; 16], 0.0, |_, m| if m == 0 { 5.0 } else { 0.0 }) - 5.0).abs() < 0.1);
    }

    #[test]
    fn alike_motions_tell_of_a_character_and_alike_characters_of_a_motion() {
        let own = |s: usize, _: usize| if s == 0 { 1.0 } else { 0.0 };
        assert!(predicted(&[0.0; 16], 0.9, own) > 0.5);
        assert!(predicted(&[0.0; 16], 0.0, own).abs() < 1e-9);
        let sign = [1.0, 1.0, -1.0, -1.0];
        let pairs: Vec<f64> = (0..16).map(|k| sign[k / 4] * sign[k % 4]).collect();
        assert!(predicted(&pairs, 0.0, |s, _| sign[s]) > 0.2, "the mean of the three others is -1/3");
    }

    #[test]
    fn a_covariance_that_is_none_is_refused() {
        let process = Additive { likeness: &[-2.0], characters: 1, among: &[1e3; 4], rows: 1, noise: 0.0 };
        assert_eq!(process.predict(&[(0, 0), (0, 1)], &[1.0, 2.0], 1, (0, 0)), None);
    }
}
