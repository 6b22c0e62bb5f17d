//! Assignment where each row may take only a few columns, or none at a price.
//!
//! Successive shortest augmenting paths with potentials, as in [`super::assignment`], but over lists of allowed pairs and
//! with a heap (Dijkstra). Time and memory grow with the number of pairs, not with rows × columns. Each row has an extra column
//! of its own that means "none", so there is always an answer. A tie goes to the column of the smaller index, so the result
//! is the same everywhere.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A column that a row may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The column.
    pub column: usize,
    /// The cost; finite.
    pub cost: f64,
}

#[derive(PartialEq)]
struct Reached {
    distance: f64,
    node: usize,
}

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        // The heap returns the greatest first. That must be the nearest column, and of equals the one of the smallest index.
        other.distance.total_cmp(&self.distance).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

const FREE: usize = usize::MAX;

/// The column of each row, or `None`, so that the sum of costs is least. A row without a column costs `none[row]`. Choices
/// whose cost is not finite, or whose column is not below `columns`, are ignored.
pub fn assign_sparse(choices: &[Vec<Choice>], none: &[f64], columns: usize) -> Vec<Option<usize>> {
    assert_eq!(choices.len(), none.len(), "expected a price of having no column for each row");
    let mut solver = Solver::new(choices, none, columns);
    (0..choices.len()).for_each(|row| solver.enter(row));
    solver.column_of.iter().map(|&column| (column < columns).then_some(column)).collect()
}

struct Solver<'a> {
    choices: &'a [Vec<Choice>],
    none: &'a [f64],
    columns: usize,
    /// For each column. The rows' own columns follow the given ones.
    row_of: Vec<usize>,
    column_of: Vec<usize>,
    column_price: Vec<f64>,
    distance: Vec<f64>,
    previous: Vec<usize>,
    done: Vec<bool>,
}

impl<'a> Solver<'a> {
    fn new(choices: &'a [Vec<Choice>], none: &'a [f64], columns: usize) -> Self {
        let all = columns + choices.len();
        Self {
            choices,
            none,
            columns,
            row_of: vec![FREE; all],
            column_of: vec![FREE; choices.len()],
            column_price: vec![0.0; all],
            distance: vec![f64::INFINITY; all],
            previous: vec![FREE; all],
            done: vec![false; all],
        }
    }

    /// Finds the shortest path over reduced costs from a new row to a free column, and takes it.
    fn enter(&mut self, entering: usize) {
        let mut heap = BinaryHeap::new();
        let mut touched = Vec::new();
        let (mut row, mut before, mut base) = (entering, FREE, 0.0);
        let last = loop {
            self.relax(row, before, base, &mut heap, &mut touched);
            let nearest = loop {
                match heap.pop() {
                    Some(next) if !self.done[next.node] => break next,
                    Some(_) => {}
                    None => unreachable!("a row's own column is free"),
                }
            };
            self.done[nearest.node] = true;
            base = nearest.distance;
            before = nearest.node;
            match self.row_of[nearest.node] {
                FREE => break nearest.node,
                taken => row = taken,
            }
        };
        for &column in touched.iter().filter(|&&c| self.done[c]) {
            self.column_price[column] += self.distance[column] - base;
        }
        let mut column = last;
        while self.previous[column] != FREE {
            let back = self.previous[column];
            self.row_of[column] = self.row_of[back];
            self.column_of[self.row_of[column]] = column;
            column = back;
        }
        self.row_of[column] = entering;
        self.column_of[entering] = column;
        for column in touched {
            self.distance[column] = f64::INFINITY;
            self.previous[column] = FREE;
            self.done[column] = false;
        }
    }

    /// Shortens the paths to the columns of a row. The row was reached at `distance`, through the column that it holds.
    fn relax(
        &mut self,
        row: usize,
        through: usize,
        base: f64,
        heap: &mut BinaryHeap<Reached>,
        touched: &mut Vec<usize>,
    ) {
        let own = Choice { column: self.columns + row, cost: self.none[row] };
        let listed = self.choices[row].iter().filter(|c| c.cost.is_finite() && c.column < self.columns);
        let options: Vec<Choice> = listed.copied().chain([own]).collect();
        // The row's price makes the reduced cost of the column that it holds zero.
        let held = self.column_of[row];
        let held_cost = options.iter().filter(|c| c.column == held).map(|c| c.cost).fold(f64::INFINITY, f64::min);
        let price = if held == FREE { 0.0 } else { held_cost - self.column_price[held] };
        for choice in options {
            if self.done[choice.column] {
                continue;
            }
            let way = base + (choice.cost - self.column_price[choice.column]) - price;
            if way < self.distance[choice.column] {
                if self.distance[choice.column] == f64::INFINITY {
                    touched.push(choice.column);
                }
                self.distance[choice.column] = way;
                self.previous[choice.column] = through;
                heap.push(Reached { distance: way, node: choice.column });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::assignment::assign;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_total_is_that_of_the_dense_method(
            rows in 0usize..12,
            columns in 1usize..12,
            values in prop::collection::vec(prop::option::of(-5i32..20), 144),
            none in -2i32..12,
        ) {
            let none = f64::from(none);
            let at = |r: usize, c: usize| values[r * columns + c].map(f64::from);
            let choices: Vec<Vec<Choice>> = (0..rows)
                .map(|r| (0..columns).filter_map(|c| Some(Choice { column: c, cost: at(r, c)? })).collect())
                .collect();
            let found = assign_sparse(&choices, &vec![none; rows], columns);
            let mut taken = vec![false; columns];
            let mut total = 0.0;
            for (r, column) in found.iter().enumerate() {
                total += match *column {
                    Some(c) => {
                        prop_assert!(!std::mem::replace(&mut taken[c], true));
                        at(r, c).unwrap()
                    }
                    None => none,
                };
            }
            let wide = columns + rows;
            let dense: Vec<f64> = (0..rows)
                .flat_map(|r| (0..wide).map(move |c| if c < columns { at(r, c).unwrap_or(1e6) } else { none }))
                .collect();
            let best: f64 =
                assign(&dense, rows, wide).unwrap().iter().enumerate().map(|(r, c)| dense[r * wide + c.unwrap()]).sum();
            prop_assert_eq!(total, best);
        }
    }

    #[test]
    fn what_is_no_cost_is_no_choice() {
        let choices = [vec![Choice { column: 0, cost: f64::NAN }, Choice { column: 7, cost: -1.0 }], vec![]];
        assert_eq!(assign_sparse(&choices, &[1.0, 2.0], 1), [None, None]);
        assert_eq!(assign_sparse(&[], &[], 3), []);
    }
}
