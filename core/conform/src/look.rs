//! What of a picture is compared, and how far two pictures differ.
//!
//! The grid is cut into blocks of 8 × 8 places. The difference of two pictures is that of the block that differs most:
//!
//! ```text
//! d = max over blocks of Σ |n − n'|² / 64
//! ```
//!
//! The mean over the picture would not see a hand that was drawn anew before a painted background. Directions are kept as bytes, so that a
//! thousand frames take some 115 MB, and a thousand times a thousand comparisons some seconds.
//!
//! The page *Conform* of the manual has d of the same drawing in other sizes, codecs and grades, at most 0.21, and of neighbouring drawings: the least was
//! 0.5, the median 1.9 to 2.5.

use crate::grid::{Grid, directions};
use rototoon_base::scene::Raster;
use std::ops::Range;

/// Side of a block, in places of the grid.
const BLOCK: usize = 8;
/// Number of values of a block: two for each place.
const VALUES: usize = 2 * BLOCK * BLOCK;
/// The byte of a direction of length 1.
const UNIT: f32 = 100.0;

/// The blocks of a grid that both pictures show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Blocks {
    columns: Range<usize>,
    rows: Range<usize>,
}

impl Blocks {
    /// The blocks within covered columns and rows of the grid; those at the end of the grid may reach beyond it.
    pub fn within(grid: &Grid, covered: [Range<usize>; 2]) -> Self {
        let whole = |range: &Range<usize>, len: usize| {
            let end = if range.end == len { len.div_ceil(BLOCK) } else { range.end / BLOCK };
            let first = range.start.div_ceil(BLOCK);
            first..end.max(first)
        };
        let [columns, rows] = covered;
        Self { columns: whole(&columns, grid.width), rows: whole(&rows, grid.height) }
    }

    /// Number of blocks.
    pub fn count(&self) -> usize {
        self.columns.len() * self.rows.len()
    }
}

/// A picture as it is compared.
#[derive(Clone, Debug)]
pub struct Look {
    /// Directions, block by block.
    values: Vec<i8>,
    /// Σ |n|² of each block, in squared bytes.
    energy: Vec<i32>,
}

impl Look {
    /// The look of a luma on the grid.
    pub fn of(luma: &Raster<f32>, blocks: &Blocks) -> Self {
        let field = directions(luma);
        let mut values = Vec::with_capacity(blocks.count() * VALUES);
        for row in blocks.rows.clone() {
            for column in blocks.columns.clone() {
                for place in 0..BLOCK * BLOCK {
                    let (x, y) = (column * BLOCK + place % BLOCK, row * BLOCK + place / BLOCK);
                    let inside = x < field.width() && y < field.height();
                    let [nx, ny] = if inside { field.get(x, y) } else { [0.0; 2] };
                    // At most 100 in absolute value.
                    values.extend([nx, ny].map(|n| (n * UNIT).round() as i8));
                }
            }
        }
        let energy = values.chunks_exact(VALUES).map(|block| product(block, block)).collect();
        Self { values, energy }
    }

    /// How far two looks differ: 0 for the same picture, up to 4.
    pub fn difference(&self, other: &Self) -> f32 {
        let blocks = self.values.chunks_exact(VALUES).zip(other.values.chunks_exact(VALUES));
        let energies = self.energy.iter().zip(&other.energy);
        let differences = blocks.zip(energies).map(|((a, b), (own, others))| own + others - 2 * product(a, b));
        let most = differences.max().unwrap_or(0);
        most as f32 / (UNIT * UNIT * (BLOCK * BLOCK) as f32)
    }
}

/// Σ ab. At most 128 products of 10 000.
fn product(a: &[i8], b: &[i8]) -> i32 {
    a.iter().zip(b).map(|(a, b)| i32::from(i16::from(*a) * i16::from(*b))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn all(grid: &Grid) -> Blocks {
        Blocks::within(grid, [0..grid.width, 0..grid.height])
    }

    /// A light square on dark ground.
    fn square(grid: &Grid, x0: usize, y0: usize, side: usize) -> Raster<f32> {
        let inside = |x: usize, y: usize| (x0..x0 + side).contains(&x) && (y0..y0 + side).contains(&y);
        Raster::from_fn(grid.width, grid.height, |x, y| if inside(x, y) { 0.9 } else { 0.1 })
    }

    #[test]
    fn a_small_thing_that_moves_makes_a_large_difference() {
        let grid = Grid { width: 300, height: 190, step: 1.0 };
        let blocks = all(&grid);
        let look = |x| Look::of(&square(&grid, x, 100, 12), &blocks);
        assert_eq!(look(40).difference(&look(40)), 0.0);
        assert!(look(40).difference(&look(48)) > 0.4, "{}", look(40).difference(&look(48)));
    }

    #[test]
    fn what_is_not_covered_does_not_count() {
        let grid = Grid { width: 64, height: 64, step: 1.0 };
        let blocks = Blocks::within(&grid, [0..32, 0..64]);
        assert_eq!(blocks.count(), 32);
        let (one, other) = (Look::of(&square(&grid, 8, 8, 12), &blocks), square(&grid, 8, 8, 12));
        let mut more = other.clone();
        (40..50).for_each(|x| (40..50).for_each(|y| more.set(x, y, 1.0)));
        assert_eq!(one.difference(&Look::of(&more, &blocks)), 0.0);
    }

    proptest! {
        #[test]
        fn the_difference_is_that_of_the_directions(values in prop::collection::vec(0.0f32..1.0, 35 * 21), others in prop::collection::vec(0.0f32..1.0, 35 * 21)) {
            let grid = Grid { width: 35, height: 21, step: 1.0 };
            let pictures = [values, others].map(|data| Raster::from_vec(35, 21, data).unwrap());
            let fields = [0, 1].map(|k| directions(&pictures[k]));
            let mut most = 0.0f32;
            for (row, column) in (0..3).flat_map(|row| (0..5).map(move |column| (row, column))) {
                let places = (0..64).map(|k| (8 * column + k % 8, 8 * row + k / 8)).filter(|&(x, y)| x < 35 && y < 21);
                let sum: f32 = places.map(|(x, y)| {
                    let [a, b] = [fields[0].get(x, y), fields[1].get(x, y)];
                    (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)
                }).sum();
                most = most.max(sum / 64.0);
            }
            let [one, other] = [0, 1].map(|k| Look::of(&pictures[k], &all(&grid)));
            prop_assert!((one.difference(&other) - most).abs() < 0.05, "{} and {most}", one.difference(&other));
            prop_assert_eq!(one.difference(&other), other.difference(&one));
        }
    }
}
