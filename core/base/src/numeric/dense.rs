//! Small dense symmetric positive definite systems, row-major.
//!
//! A = LLᵀ by the row-oriented Cholesky algorithm (Golub & Van Loan, *Matrix Computations*, §4.2): the inner loops are dot
//! products of rows. Always on the calling thread and in one order, so results do not depend on the number of threads.

use super::vector::dot;

/// The lower factor L of a symmetric positive definite matrix.
#[derive(Clone, Debug)]
pub struct DenseCholesky {
    n: usize,
    l: Vec<f64>,
}

impl DenseCholesky {
    /// Factors the `n` × `n` matrix whose lower triangle is given (the upper is not read). `None` where it is not positive
    /// definite to working precision, or not finite.
    pub fn new(n: usize, matrix: &[f64]) -> Option<Self> {
        let mut l = matrix.to_vec();
        for i in 0..n {
            let (above, row) = l.split_at_mut(i * n);
            for j in 0..i {
                let other = &above[j * n..j * n + j + 1];
                row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
            }
            let rest = row[i] - dot(&row[..i], &row[..i]);
            // A pivot below the rounding of what it is left over from says nothing about the matrix.
            if !(rest > 1e-14 * row[i].abs() && rest.is_finite()) {
                return None;
            }
            row[i] = rest.sqrt();
            row[i + 1..n].fill(0.0);
        }
        Some(Self { n, l })
    }

    /// Replaces `b` (`n` rows of `width` right-hand sides each) by the solution of Ax = b.
    pub fn solve(&self, b: &mut [f64], width: usize) {
        let n = self.n;
        for i in 0..n {
            let (above, row) = b.split_at_mut(i * width);
            for j in 0..i {
                subtract(&mut row[..width], self.l[i * n + j], &above[j * width..(j + 1) * width]);
            }
            let pivot = 1.0 / self.l[i * n + i];
            row[..width].iter_mut().for_each(|v| *v *= pivot);
        }
        for i in (0..n).rev() {
            let (above, below) = b.split_at_mut((i + 1) * width);
            let row = &mut above[i * width..];
            for j in i + 1..n {
                subtract(row, self.l[j * n + i], &below[(j - i - 1) * width..(j - i) * width]);
            }
            let pivot = 1.0 / self.l[i * n + i];
            row.iter_mut().for_each(|v| *v *= pivot);
        }
    }

    /// A⁻¹, both triangles.
    pub fn inverse(&self) -> Vec<f64> {
        let n = self.n;
        let mut inverse = vec![0.0; n * n];
        (0..n).for_each(|i| inverse[i * n + i] = 1.0);
        self.solve(&mut inverse, n);
        inverse
    }
}

fn subtract(from: &mut [f64], factor: f64, what: &[f64]) {
    for (value, w) in from.iter_mut().zip(what) {
        *value -= factor * w;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_undoes_the_matrix() {
        let n = 7;
        let root: Vec<f64> = (0..n * n).map(|k| ((k * k + 3 * k) % 11) as f64 - 5.0).collect();
        let at = |m: &[f64], i: usize, j: usize| m[i * n + j];
        let matrix: Vec<f64> = (0..n * n)
            .map(|k| {
                let (i, j) = (k / n, k % n);
                (0..n).map(|q| at(&root, i, q) * at(&root, j, q)).sum::<f64>() + if i == j { 1.0 } else { 0.0 }
            })
            .collect();
        let inverse = DenseCholesky::new(n, &matrix).unwrap().inverse();
        for i in 0..n {
            for j in 0..n {
                let product: f64 = (0..n).map(|q| at(&matrix, i, q) * at(&inverse, q, j)).sum();
                assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        assert!(DenseCholesky::new(2, &[1.0, 0.0, 2.0, 1.0]).is_none());
        assert!(DenseCholesky::new(2, &[1.0, 0.0, 1.0, 1.0]).is_none());
        assert!(DenseCholesky::new(1, &[f64::NAN]).is_none());
    }
}
