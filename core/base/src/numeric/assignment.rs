//! The linear assignment problem: rows to columns at the least total cost.
//!
//! The method is shortest augmenting paths with potentials: the Hungarian method in the form of Jonker & Volgenant 1987,
//! without their heuristics for the start. Rows enter one by one, each by a Dijkstra search over reduced costs. The time is
//! O(r² c) for r ≤ c. A tie goes to the column of the smaller index, so the result is the same everywhere.

/// Why an assignment was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AssignmentError {
    /// The number of costs is not `rows` × `columns`.
    #[error("costs: found {found} values, expected {rows} rows x {columns} columns = {}", rows * columns)]
    Size {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
        /// Costs given.
        found: usize,
    },
    /// A cost is infinite or not a number.
    #[error("the cost of row {row} in column {column} is not a finite number")]
    NotFinite {
        /// The row.
        row: usize,
        /// The column.
        column: usize,
    },
}

/// The column of each row. The sum of costs is least, and no column is taken twice. `costs` holds the rows one after the
/// other. If there are enough columns, every row gets one; otherwise every column gets a row.
pub fn assign(costs: &[f64], rows: usize, columns: usize) -> Result<Vec<Option<usize>>, AssignmentError> {
    if rows.checked_mul(columns) != Some(costs.len()) {
        return Err(AssignmentError::Size { rows, columns, found: costs.len() });
    }
    if let Some(i) = costs.iter().position(|c| !c.is_finite()) {
        return Err(AssignmentError::NotFinite { row: i / columns, column: i % columns });
    }
    if rows <= columns {
        return Ok(solve(rows, columns, |r, c| costs[r * columns + c]).into_iter().map(Some).collect());
    }
    let mut result = vec![None; rows];
    for (column, row) in solve(columns, rows, |c, r| costs[r * columns + c]).into_iter().enumerate() {
        result[row] = Some(column);
    }
    Ok(result)
}

/// No row, or no column.
const FREE: usize = usize::MAX;

/// The shortest path over reduced costs from a row to a free column.
struct Path {
    /// The free column.
    end: usize,
    /// How far away each column is.
    distance: Vec<f64>,
    /// The column before each column.
    previous: Vec<usize>,
    /// The columns whose distance is final.
    done: Vec<bool>,
}

/// Finds the path from a row. `row_of` is the row that has each column. `farther(distance, row, column)` adds the reduced
/// cost of a row in a column to a distance.
fn path(entering: usize, row_of: &[usize], farther: impl Fn(f64, usize, usize) -> f64) -> Path {
    let columns = row_of.len();
    let (mut distance, mut previous) = (vec![f64::INFINITY; columns], vec![FREE; columns]);
    let mut done = vec![false; columns];
    let (mut row, mut reached, mut last) = (entering, 0.0, FREE);
    loop {
        let mut nearest = FREE;
        for c in (0..columns).filter(|&c| !done[c]) {
            let through = farther(reached, row, c);
            if through < distance[c] {
                distance[c] = through;
                previous[c] = last;
            }
            if nearest == FREE || distance[c] < distance[nearest] {
                nearest = c;
            }
        }
        done[nearest] = true;
        reached = distance[nearest];
        last = nearest;
        match row_of[nearest] {
            FREE => return Path { end: last, distance, previous, done },
            taken => row = taken,
        }
    }
}

/// The column of each row, for `rows` ≤ `columns`.
fn solve(rows: usize, columns: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    let mut row_of = vec![FREE; columns];
    let (mut row_price, mut column_price) = (vec![0.0; rows], vec![0.0; columns]);
    for entering in 0..rows {
        let farther = |reached: f64, row: usize, c: usize| reached + cost(row, c) - row_price[row] - column_price[c];
        let Path { end, distance, previous, done } = path(entering, &row_of, farther);
        let reached = distance[end];
        // The new prices keep all reduced costs non-negative and make those on the path zero.
        row_price[entering] += reached;
        for c in (0..columns).filter(|&c| done[c] && c != end) {
            row_price[row_of[c]] += reached - distance[c];
            column_price[c] -= reached - distance[c];
        }
        let mut last = end;
        while previous[last] != FREE {
            row_of[last] = row_of[previous[last]];
            last = previous[last];
        }
        row_of[last] = entering;
    }
    let mut column_of = vec![FREE; rows];
    for (column, &row) in row_of.iter().enumerate().filter(|(_, row)| **row != FREE) {
        column_of[row] = column;
    }
    column_of
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Least total by trying every choice.
    fn naive(costs: &[f64], columns: usize, row: usize, taken: &mut Vec<bool>, skips: usize) -> f64 {
        if row * columns == costs.len() {
            return 0.0;
        }
        let mut best = f64::INFINITY;
        if skips > 0 {
            best = naive(costs, columns, row + 1, taken, skips - 1);
        }
        for c in 0..columns {
            if !taken[c] {
                taken[c] = true;
                best = best.min(costs[row * columns + c] + naive(costs, columns, row + 1, taken, skips));
                taken[c] = false;
            }
        }
        best
    }

    proptest! {
        #[test]
        fn the_total_is_the_least(rows in 1usize..6, columns in 1usize..6, values in prop::collection::vec(-5i32..9, 25)) {
            let costs: Vec<f64> = values[..rows * columns].iter().map(|&v| f64::from(v)).collect();
            let found = assign(&costs, rows, columns).unwrap();
            let mut taken = vec![false; columns];
            let mut total = 0.0;
            for (row, column) in found.iter().enumerate() {
                if let Some(c) = *column {
                    prop_assert!(!std::mem::replace(&mut taken[c], true));
                    total += costs[row * columns + c];
                }
            }
            prop_assert_eq!(found.iter().flatten().count(), rows.min(columns));
            let skips = rows.saturating_sub(columns);
            prop_assert_eq!(total, naive(&costs, columns, 0, &mut vec![false; columns], skips));
        }
    }

    #[test]
    fn equal_costs_keep_the_order() {
        assert_eq!(assign(&[1.0; 9], 3, 3), Ok(vec![Some(0), Some(1), Some(2)]));
        assert_eq!(assign(&[], 0, 5), Ok(vec![]));
        assert_eq!(assign(&[], 2, 0), Ok(vec![None, None]));
    }

    #[test]
    fn bad_tables_are_refused() {
        let error = assign(&[1.0, f64::NAN, 0.0, 2.0], 2, 2).unwrap_err();
        assert_eq!(error.to_string(), "the cost of row 0 in column 1 is not a finite number");
        let error = assign(&[1.0], 2, 2).unwrap_err();
        assert_eq!(error.to_string(), "costs: found 1 values, expected 2 rows x 2 columns = 4");
    }
}
