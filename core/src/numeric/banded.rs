//! Cholesky factorisation of symmetric positive definite band matrices.
//!
//! A lattice numbered along its longer side couples only unknowns that are close in number. Its normal equations are
//! then a band matrix of n rows and half width b, factored in n b²/2 multiplications (dense: n³/6), without any symbolic
//! work. Row-oriented (Cholesky–Banachiewicz; Golub & Van Loan, *Matrix Computations*, §4.3): each inner product runs
//! over two contiguous row pieces.

/// Lower triangle of a symmetric band matrix: row `i` holds the columns `i - half ..= i`.
#[derive(Clone, Debug)]
pub struct BandMatrix {
    size: usize,
    half: usize,
    data: Vec<f64>,
}

/// The matrix is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("row {row} of the band matrix makes it indefinite")]
pub struct Indefinite {
    /// First row whose pivot is not positive.
    pub row: usize,
}

impl BandMatrix {
    /// The zero matrix of `size` rows; entries further than `half` from the diagonal stay zero.
    pub fn zeros(size: usize, half: usize) -> Self {
        Self { size, half, data: vec![0.0; size * (half + 1)] }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.data.fill(0.0);
    }

    /// Adds to entry (`i`, `j`), which is also entry (`j`, `i`). Panics outside the band.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (i, j) = if i >= j { (i, j) } else { (j, i) };
        assert!(i - j <= self.half, "entry ({i}, {j}) lies outside a band of {}", self.half);
        self.data[i * (self.half + 1) + self.half - (i - j)] += value;
    }

    /// Entry (`i`, `j`), zero outside the band.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (i, j) = if i >= j { (i, j) } else { (j, i) };
        if i - j > self.half { 0.0 } else { self.data[i * (self.half + 1) + self.half - (i - j)] }
    }

    /// Adds another matrix of the same shape, times `factor`.
    pub fn add_scaled(&mut self, other: &Self, factor: f64) {
        assert_eq!((self.size, self.half), (other.size, other.half));
        for (a, b) in self.data.iter_mut().zip(&other.data) {
            *a += factor * b;
        }
    }

    /// Factors the matrix in place into L Lᵀ.
    pub fn factor(mut self) -> Result<BandCholesky, Indefinite> {
        let (half, width) = (self.half, self.half + 1);
        for i in 0..self.size {
            let first = i.saturating_sub(half);
            let (above, from_i) = self.data.split_at_mut(i * width);
            let row = &mut from_i[..width];
            for j in first..i {
                let start = first.max(j.saturating_sub(half));
                let mine = &row[start + half - i..j + half - i];
                let theirs = &above[j * width + start + half - j..j * width + half];
                let at = j + half - i;
                row[at] = (row[at] - dot(mine, theirs)) / above[j * width + half];
            }
            let pivot = row[half] - dot(&row[first + half - i..half], &row[first + half - i..half]);
            if pivot <= 0.0 || pivot.is_nan() {
                return Err(Indefinite { row: i });
            }
            row[half] = pivot.sqrt();
        }
        Ok(BandCholesky { matrix: self })
    }
}

/// L of L Lᵀ = A.
#[derive(Clone, Debug)]
pub struct BandCholesky {
    matrix: BandMatrix,
}

impl BandCholesky {
    /// Replaces `b` by the x of A x = b.
    pub fn solve_in_place(&self, b: &mut [f64]) {
        let BandMatrix { size, half, ref data } = self.matrix;
        assert_eq!(b.len(), size);
        let width = half + 1;
        for i in 0..size {
            let first = i.saturating_sub(half);
            let row = &data[i * width..(i + 1) * width];
            b[i] = (b[i] - dot(&row[first + half - i..half], &b[first..i])) / row[half];
        }
        for i in (0..size).rev() {
            let first = i.saturating_sub(half);
            let row = &data[i * width..(i + 1) * width];
            b[i] /= row[half];
            let value = b[i];
            for (x, l) in b[first..i].iter_mut().zip(&row[first + half - i..half]) {
                *x -= l * value;
            }
        }
    }
}

/// Inner product in four interleaved sums: a fixed order, and the compiler can keep them in one register.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Dense reference: Gaussian elimination without pivoting, which a positive definite matrix allows.
    fn solve_dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
        let n = b.len();
        for k in 0..n {
            for i in k + 1..n {
                let factor = a[i][k] / a[k][k];
                for j in k..n {
                    a[i][j] -= factor * a[k][j];
                }
                b[i] -= factor * b[k];
            }
        }
        for i in (0..n).rev() {
            b[i] = (b[i] - (i + 1..n).map(|j| a[i][j] * b[j]).sum::<f64>()) / a[i][i];
        }
        b
    }

    proptest! {
        #[test]
        fn the_band_solution_equals_the_dense_one(
            n in 1usize..24, half in 0usize..9, entries in prop::collection::vec(-1.0f64..1.0, 24 * 10),
        ) {
            let mut band = BandMatrix::zeros(n, half);
            let mut dense = vec![vec![0.0; n]; n];
            for i in 0..n {
                for j in i.saturating_sub(half)..=i {
                    // Diagonally dominant, so positive definite.
                    let value = if i == j { 20.0 + entries[i] } else { entries[i * 10 + i - j] };
                    band.add(i, j, value);
                    dense[i][j] = value;
                    dense[j][i] = value;
                }
            }
            let b: Vec<f64> = (0..n).map(|i| entries[200 + i]).collect();
            let mut x = b.clone();
            band.factor().unwrap().solve_in_place(&mut x);
            for (got, want) in x.iter().zip(solve_dense(dense, b)) {
                prop_assert!((got - want).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn an_indefinite_matrix_is_named_by_its_row() {
        let mut band = BandMatrix::zeros(3, 1);
        for (i, value) in [4.0, 1.0, 1.0].into_iter().enumerate() {
            band.add(i, i, value);
        }
        band.add(2, 1, 3.0);
        assert_eq!(band.factor().unwrap_err(), Indefinite { row: 2 });
    }
}
