//! The damped normal equations (JᵀJ + λ diag(JᵀJ)) d = b, factored so that a few long rows of J stay cheap.
//!
//! A row of J with many variables makes a dense block in JᵀJ and in its factor. [`NormalEquations`] leaves such rows out of
//! its triangle. This module adds them again as a correction of low rank. S is the sparse part with its damping, and U are
//! the long rows:
//!
//! ```text
//! (S + UᵀU)⁻¹ b = z − Z (I + U Z)⁻¹ U z,   z = S⁻¹ b,  Z = S⁻¹ Uᵀ
//! ```
//!
//! (Sherman–Morrison–Woodbury). S is factored by sparse Cholesky, I + UZ by dense Cholesky.
//!
//! Limit: if S alone is nearly singular, the correction loses digits. Every variable should have short rows too.

use super::cholesky::{NotPositiveDefinite, SparseCholesky};
use super::normal_equations::NormalEquations;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Added to the diagonal, as a share of its mean. It keeps the matrix definite if a variable has no residual.
const DIAGONAL_FLOOR: f64 = 1e-10;

/// Factors the damped normal equations of one pattern and solves them.
pub struct DampedSystem {
    cholesky: SparseCholesky,
    damped: Vec<f64>,
    /// Z: a column for each long row, one after the other.
    spread: Vec<f64>,
    /// The factor of I + UZ.
    small: Cholesky<f64, Dyn>,
}

impl DampedSystem {
    /// Analyses the pattern of the equations.
    pub fn new(equations: &NormalEquations) -> Self {
        let (starts, rows) = (equations.column_starts().to_vec(), equations.row_indices().to_vec());
        Self {
            damped: vec![0.0; rows.len()],
            cholesky: SparseCholesky::new(equations.variables(), starts, rows),
            spread: Vec::new(),
            small: Cholesky::pack_dirty(DMatrix::zeros(0, 0)),
        }
    }

    /// Factors JᵀJ + `damping` · diag(JᵀJ).
    pub fn factor(&mut self, equations: &NormalEquations, damping: f64) -> Result<(), NotPositiveDefinite> {
        let n = equations.variables();
        let starts = equations.column_starts();
        self.damped.copy_from_slice(equations.values());
        let floor = DIAGONAL_FLOOR * equations.diagonal().iter().sum::<f64>() / n.max(1) as f64;
        for (&start, diagonal) in starts.iter().zip(equations.diagonal()) {
            self.damped[start] += damping * diagonal + floor.max(f64::MIN_POSITIVE);
        }
        self.cholesky.factor(&self.damped)?;
        self.spread.clear();
        for (columns, values) in equations.long_rows() {
            let start = self.spread.len();
            self.spread.resize(start + n, 0.0);
            columns.iter().zip(values).for_each(|(&j, &value)| self.spread[start + j as usize] = value);
        }
        self.cholesky.solve(&mut self.spread);
        let rows: Vec<(&[u32], &[f64])> = equations.long_rows().collect();
        let column = |j: usize| &self.spread[j * n..(j + 1) * n];
        let unit = DMatrix::identity(rows.len(), rows.len());
        let matrix = unit + DMatrix::from_fn(rows.len(), rows.len(), |i, j| product(rows[i], column(j)));
        self.small = matrix.cholesky().ok_or(NotPositiveDefinite)?;
        Ok(())
    }

    /// Replaces `b` by the solution of the equations that were factored last.
    pub fn solve(&mut self, equations: &NormalEquations, b: &mut [f64]) {
        self.cholesky.solve(b);
        if self.spread.is_empty() {
            return;
        }
        let shares: Vec<f64> = equations.long_rows().map(|row| product(row, b)).collect();
        let shares = self.small.solve(&DVector::from_vec(shares));
        for (column, share) in self.spread.chunks_exact(b.len()).zip(&shares) {
            b.iter_mut().zip(column).for_each(|(b, c)| *b -= share * c);
        }
    }
}

fn product((columns, values): (&[u32], &[f64]), dense: &[f64]) -> f64 {
    columns.iter().zip(values).map(|(&j, value)| value * dense[j as usize]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::normal_equations::LONG_ROW;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn long_rows_count_as_any_other(
            long in prop::collection::vec(-1.0f64..1.0, 2 * (LONG_ROW + 5)),
            b in prop::collection::vec(-1.0f64..1.0, LONG_ROW + 5),
            damping in 0.0f64..2.0,
        ) {
            // A chain of differences, held at its start, and two rows over everything.
            let n = LONG_ROW + 5;
            let mut pattern = vec![(0, 0)];
            let mut values = vec![1.0];
            for j in 1..n {
                pattern.extend([(j, j - 1), (j, j)]);
                values.extend([-1.0, 1.5]);
            }
            for (k, &value) in long.iter().enumerate() {
                pattern.push((n + k / n, k % n));
                values.push(value);
            }
            let mut equations = NormalEquations::new(n + 2, n, &pattern);
            prop_assert_eq!(equations.long_rows().count(), 2);
            equations.assemble(&values, &vec![0.0; n + 2]);
            let mut system = DampedSystem::new(&equations);
            prop_assert!(system.factor(&equations, damping).is_ok());
            let mut x = b.clone();
            system.solve(&equations, &mut x);

            let mut jacobian = vec![vec![0.0; n]; n + 2];
            for (&(row, column), &value) in pattern.iter().zip(&values) {
                jacobian[row][column] += value;
            }
            let product: Vec<f64> = jacobian.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
            for j in 0..n {
                let diagonal: f64 = jacobian.iter().map(|row| row[j] * row[j]).sum();
                let left: f64 = jacobian.iter().zip(&product).map(|(row, p)| row[j] * p).sum();
                prop_assert!((left + damping * diagonal * x[j] - b[j]).abs() < 1e-6, "{} for {}", left, b[j]);
            }
        }
    }
}
