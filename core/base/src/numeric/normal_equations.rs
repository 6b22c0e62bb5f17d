//! The normal equations JᵀJ d = −Jᵀr of a sparse Jacobian whose pattern never changes.
//!
//! Row k of J adds the products of all pairs of its entries to JᵀJ. The place of a pair in the triangle depends on the
//! pattern alone. It is looked up once. An assembly is then one pass of multiplications and additions over a list of places.
//!
//! A row of m entries gives m(m + 1)/2 products. Rows of more than [`LONG_ROW`] entries would make the triangle dense, so they
//! are left out of it. [`NormalEquations::long_rows`] gives them. Gradient and diagonal include them.

/// A row with more entries than this is left out of the triangle.
pub const LONG_ROW: usize = 96;

/// Lower triangle of JᵀJ without the long rows (compressed columns) and Jᵀr, refilled for each new set of
/// values.
pub struct NormalEquations {
    variables: usize,
    /// Entries of row k, repeated columns merged: `columns[row_starts[k]..row_starts[k + 1]]`, rising.
    row_starts: Vec<usize>,
    columns: Vec<u32>,
    /// For each entry of the caller's pattern: the merged entry that it adds to.
    slots: Vec<u32>,
    /// For each row and each pair (a, b ≤ a) of its merged entries: the place in `values`.
    places: Vec<u32>,
    column_starts: Vec<usize>,
    row_indices: Vec<usize>,
    merged: Vec<f64>,
    values: Vec<f64>,
    diagonal: Vec<f64>,
    gradient: Vec<f64>,
}

impl NormalEquations {
    /// Analyses the (row, column) pairs of a Jacobian of `rows` × `variables`. Pairs may come in any order; values of
    /// repeated pairs add up.
    ///
    /// Panics on a pair outside the matrix.
    pub fn new(rows: usize, variables: usize, pattern: &[(usize, usize)]) -> Self {
        let (row_starts, columns, slots) = merge_entries(rows, variables, pattern);
        let (column_starts, row_indices) = product_pattern(variables, &row_starts, &columns);
        let mut places = Vec::new();
        for row in row_starts.windows(2) {
            let entries = &columns[row[0]..row[1]];
            if entries.len() > LONG_ROW {
                continue;
            }
            for (k, &a) in entries.iter().enumerate() {
                for &b in &entries[..=k] {
                    let start = column_starts[b as usize];
                    let column = &row_indices[start..column_starts[b as usize + 1]];
                    let place = column.binary_search(&(a as usize)).expect("the pattern holds every product");
                    places.push((start + place) as u32);
                }
            }
        }
        Self {
            variables,
            merged: vec![0.0; columns.len()],
            values: vec![0.0; row_indices.len()],
            diagonal: vec![0.0; variables],
            gradient: vec![0.0; variables],
            row_starts,
            columns,
            slots,
            places,
            column_starts,
            row_indices,
        }
    }

    /// Fills in JᵀJ and Jᵀr for the Jacobian's values (in the pattern's order) and the residuals r.
    pub fn assemble(&mut self, jacobian: &[f64], residuals: &[f64]) {
        self.merged.fill(0.0);
        for (&slot, &value) in self.slots.iter().zip(jacobian) {
            self.merged[slot as usize] += value;
        }
        self.values.fill(0.0);
        self.diagonal.fill(0.0);
        self.gradient.fill(0.0);
        let mut places = self.places.as_slice();
        for (row, &residual) in self.row_starts.windows(2).zip(residuals) {
            let entries = &self.merged[row[0]..row[1]];
            for (k, (&a, &column)) in entries.iter().zip(&self.columns[row[0]..row[1]]).enumerate() {
                self.gradient[column as usize] += a * residual;
                self.diagonal[column as usize] += a * a;
                if entries.len() > LONG_ROW {
                    continue;
                }
                let (now, later) = places.split_at(k + 1);
                places = later;
                for (&place, &b) in now.iter().zip(entries) {
                    self.values[place as usize] += a * b;
                }
            }
        }
    }

    /// Number of variables.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// Start of each column of the lower triangle, and the end of the last column.
    pub fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Row of each value of the lower triangle. Each column starts with its diagonal entry.
    pub fn row_indices(&self) -> &[usize] {
        &self.row_indices
    }

    /// The rows of J that are not in the triangle: rising columns, and values.
    pub fn long_rows(&self) -> impl Iterator<Item = (&[u32], &[f64])> {
        let ranges = self.row_starts.windows(2).map(|pair| pair[0]..pair[1]);
        ranges.filter(|range| range.len() > LONG_ROW).map(|range| (&self.columns[range.clone()], &self.merged[range]))
    }

    /// The diagonal of JᵀJ, long rows included.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Values of the lower triangle of JᵀJ without the long rows.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Jᵀr: half the gradient of ‖r‖².
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }
}

/// Sorts a pattern by rows and merges repeated pairs: row starts, columns, and the merged entry of each pair.
fn merge_entries(rows: usize, variables: usize, pattern: &[(usize, usize)]) -> (Vec<usize>, Vec<u32>, Vec<u32>) {
    let mut order: Vec<usize> = (0..pattern.len()).collect();
    order.sort_by_key(|&k| pattern[k]);
    let mut row_starts = vec![0; rows + 1];
    let mut columns = Vec::with_capacity(pattern.len());
    let mut slots = vec![0; pattern.len()];
    let mut previous = None;
    for k in order {
        let (row, column) = pattern[k];
        assert!(row < rows && column < variables, "entry ({row}, {column}) in a {rows}x{variables} Jacobian");
        if previous != Some((row, column)) {
            columns.push(column as u32);
            row_starts[row + 1] += 1;
            previous = Some((row, column));
        }
        slots[k] = columns.len() as u32 - 1;
    }
    for row in 0..rows {
        row_starts[row + 1] += row_starts[row];
    }
    (row_starts, columns, slots)
}

/// Compressed columns of the lower triangle of JᵀJ, the diagonal always included.
fn product_pattern(variables: usize, row_starts: &[usize], columns: &[u32]) -> (Vec<usize>, Vec<usize>) {
    let mut rows_of: Vec<Vec<u32>> = vec![Vec::new(); variables];
    for (row, range) in row_starts.windows(2).enumerate() {
        for &column in &columns[range[0]..range[1]] {
            rows_of[column as usize].push(row as u32);
        }
    }
    let mut column_starts = vec![0];
    let mut row_indices = Vec::new();
    let mut seen = vec![usize::MAX; variables];
    for (column, rows) in rows_of.iter().enumerate() {
        let start = row_indices.len();
        row_indices.push(column);
        seen[column] = column;
        for &row in rows {
            let range = row_starts[row as usize]..row_starts[row as usize + 1];
            if range.len() > LONG_ROW {
                continue;
            }
            for &other in columns[range].iter().rev().take_while(|&&other| other as usize > column) {
                if seen[other as usize] != column {
                    seen[other as usize] = column;
                    row_indices.push(other as usize);
                }
            }
        }
        row_indices[start..].sort_unstable();
        column_starts.push(row_indices.len());
    }
    (column_starts, row_indices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn equals_the_dense_product(
            entries in prop::collection::vec((0usize..6, 0usize..5, -2.0f64..2.0), 0..40),
            residuals in prop::collection::vec(-3.0f64..3.0, 6),
        ) {
            let pattern: Vec<_> = entries.iter().map(|&(row, column, _)| (row, column)).collect();
            let values: Vec<_> = entries.iter().map(|entry| entry.2).collect();
            let mut equations = NormalEquations::new(6, 5, &pattern);
            equations.assemble(&vec![7.0; values.len()], &residuals);
            equations.assemble(&values, &residuals);

            let mut jacobian = [[0.0; 5]; 6];
            for &(row, column, value) in &entries {
                jacobian[row][column] += value;
            }
            let mut found = [[0.0; 5]; 5];
            for j in 0..5 {
                for k in equations.column_starts()[j]..equations.column_starts()[j + 1] {
                    prop_assert!(k == equations.column_starts()[j] || equations.row_indices()[k] > j);
                    found[equations.row_indices()[k]][j] = equations.values()[k];
                }
            }
            for i in 0..5 {
                for j in 0..=i {
                    let product: f64 = (0..6).map(|k| jacobian[k][i] * jacobian[k][j]).sum();
                    prop_assert!((found[i][j] - product).abs() < 1e-12);
                }
                let gradient: f64 = (0..6).map(|k| jacobian[k][i] * residuals[k]).sum();
                prop_assert!((equations.gradient()[i] - gradient).abs() < 1e-12);
            }
        }
    }
}
