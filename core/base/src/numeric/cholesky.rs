//! Sparse Cholesky factorisation A = LLᵀ of symmetric positive definite matrices that share one pattern.
//!
//! Iterative methods factor the same pattern many times with other values. The order of elimination and the pattern of L
//! depend on the pattern of A alone. [`SparseCholesky::new`] finds them once, and each
//! [`factor`](SparseCholesky::factor) fills in numbers. faer does the work, with an approximate minimum degree ordering. It
//! chooses the supernodal or the simplicial method by their operation counts. It always runs on the calling thread, so the
//! factor does not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

/// The matrix is not positive definite to working precision, or has a value that is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix is not positive definite")]
pub struct NotPositiveDefinite;

/// Factors matrices of one pattern and solves with the latest factor.
pub struct SparseCholesky {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    scratch: MemBuffer,
    /// Number of right-hand sides that the scratch memory has room for.
    width: usize,
}

impl SparseCholesky {
    /// Prepares for symmetric `n` × `n` matrices given by their lower triangle in compressed columns: column `j` holds
    /// rows `row_indices[column_starts[j]..column_starts[j + 1]]`, rising, all ≥ `j`.
    ///
    /// Panics if the arrays do not describe such a triangle, or if there is too little memory for the factor.
    pub fn new(n: usize, column_starts: Vec<usize>, row_indices: Vec<usize>) -> Self {
        let pattern = SymbolicSparseColMat::new_checked(n, n, column_starts, None, row_indices);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .expect("memory for the pattern of the factor");
        let factor = vec![0.0; symbolic.len_val()];
        let scratch = scratch_for(&symbolic, 1);
        Self { pattern, symbolic, factor, scratch, width: 1 }
    }

    /// Factors the matrix whose lower triangle holds `values`, in the order of the pattern.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), NotPositiveDefinite> {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), values);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.scratch),
                Default::default(),
            )
            .map(|_| ())
            .map_err(|_| NotPositiveDefinite)
    }

    /// Replaces each right-hand side b by the solution x of Ax = b, where A is the matrix factored last. `b` holds any
    /// number of right-hand sides of `n` values, one after the other. Many at once are much faster than one by one.
    pub fn solve(&mut self, b: &mut [f64]) {
        let n = self.pattern.nrows();
        let count = b.len().checked_div(n).unwrap_or(0);
        if count > self.width {
            self.scratch = scratch_for(&self.symbolic, count);
            self.width = count;
        }
        let b = MatMut::from_column_major_slice_mut(b, n, count);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            b,
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}

fn scratch_for(symbolic: &SymbolicCholesky<usize>, right_hand_sides: usize) -> MemBuffer {
    let solve = symbolic.solve_in_place_scratch::<f64>(right_hand_sides, Par::Seq);
    MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()).or(solve))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_matrix_of_the_pattern_is_solved_without_a_new_analysis() {
        let mut solver = SparseCholesky::new(3, vec![0, 2, 4, 5], vec![0, 1, 1, 2, 2]);
        for scale in [1.0, 10.0] {
            solver.factor(&[4.0 * scale, scale, 3.0 * scale, -scale, 5.0 * scale]).unwrap();
            let mut x = [5.0, 3.0, 4.0, 10.0, 6.0, 8.0].map(|value| scale * value);
            solver.solve(&mut x);
            for (k, value) in x.into_iter().enumerate() {
                let expected = if k < 3 { 1.0 } else { 2.0 };
                assert!((value - expected).abs() < 1e-14, "{x:?}");
            }
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let mut solver = SparseCholesky::new(2, vec![0, 2, 3], vec![0, 1, 1]);
        assert_eq!(solver.factor(&[1.0, 2.0, 1.0]), Err(NotPositiveDefinite));
        assert_eq!(solver.factor(&[f64::NAN, 0.0, 1.0]), Err(NotPositiveDefinite));
    }
}
