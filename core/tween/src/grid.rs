//! Search for the nearest places among many, with a grid of square cells.
//!
//! A cell has [`PER_CELL`] places on average. A search visits the cell of the given place first, then the rings of
//! cells around it. It ends when no cell further out can have a nearer place. Evenly spread places need constant time
//! per search. Places that crowd in few cells need more.

use rototoon_base::geometry::{Point, polygon};

/// Places sorted into cells.
pub(super) struct Grid<'a> {
    places: &'a [Point],
    origin: Point,
    cell: f64,
    columns: i64,
    rows: i64,
    /// Where each cell's places start in `sorted`.
    starts: Vec<usize>,
    sorted: Vec<usize>,
}

/// Average number of places in a cell.
const PER_CELL: f64 = 2.0;

impl<'a> Grid<'a> {
    pub fn new(places: &'a [Point]) -> Self {
        let (low, high) = polygon::bounds(places).unwrap_or((Point::ZERO, Point::ZERO));
        let extent = (high - low).max(Point::splat(1e-9));
        let cells = (places.len() as f64 / PER_CELL).max(1.0);
        // For a long thin picture this keeps the cells of each side below the intended number of all cells.
        let cell = (extent.x * extent.y / cells).sqrt().max(extent.max_element() / cells);
        let (columns, rows) = ((extent.x / cell) as i64 + 1, (extent.y / cell) as i64 + 1);
        let mut grid =
            Self { places, origin: low, cell, columns, rows, starts: Vec::new(), sorted: (0..places.len()).collect() };
        let cells: Vec<usize> = places.iter().map(|&p| grid.index(grid.cell_of(p))).collect();
        grid.sorted.sort_by_key(|&i| cells[i]);
        grid.starts = vec![0; (columns * rows) as usize + 1];
        cells.iter().for_each(|&c| grid.starts[c + 1] += 1);
        for c in 1..grid.starts.len() {
            grid.starts[c] += grid.starts[c - 1];
        }
        grid
    }

    fn cell_of(&self, p: Point) -> (i64, i64) {
        let at = (p - self.origin) / self.cell;
        ((at.x as i64).clamp(0, self.columns - 1), (at.y as i64).clamp(0, self.rows - 1))
    }

    fn index(&self, (x, y): (i64, i64)) -> usize {
        (y * self.columns + x) as usize
    }

    /// Indices of the `count` places nearest to `p`, the nearest first. Among equally near places the smaller index
    /// comes first. The list is shorter where there are fewer places.
    pub fn nearest(&self, p: Point, count: usize) -> Vec<usize> {
        let (x, y) = self.cell_of(p);
        let mut found: Vec<(f64, usize)> = Vec::new();
        for ring in 0..=self.columns.max(self.rows) {
            self.ring((x, y), ring, |i| keep(&mut found, count, (self.places[i].distance_squared(p), i)));
            // Every place outside the ring is at least this far from `p`.
            let beyond = self.beyond(p, (x, y), ring);
            if found.len() == count && found.last().is_none_or(|last| last.0 <= beyond * beyond) {
                break;
            }
        }
        found.into_iter().map(|(_, i)| i).collect()
    }

    /// Distance of `p` from the nearest cell outside the square of cells that reaches `ring` cells from cell (x, y). It
    /// is 0 where `p` is outside that square.
    fn beyond(&self, p: Point, (x, y): (i64, i64), ring: i64) -> f64 {
        let at = (p - self.origin) / self.cell;
        let sides = [
            at.x - (x - ring) as f64,
            (x + ring + 1) as f64 - at.x,
            at.y - (y - ring) as f64,
            (y + ring + 1) as f64 - at.y,
        ];
        sides.into_iter().fold(f64::INFINITY, f64::min).max(0.0) * self.cell
    }

    fn ring(&self, (x, y): (i64, i64), ring: i64, mut visit: impl FnMut(usize)) {
        for row in (y - ring).max(0)..=(y + ring).min(self.rows - 1) {
            let whole = (row - y).abs() == ring;
            let step = if whole || ring == 0 { 1 } else { 2 * ring };
            let mut column = x - ring;
            while column <= x + ring {
                if (0..self.columns).contains(&column) {
                    let cell = self.index((column, row));
                    self.sorted[self.starts[cell]..self.starts[cell + 1]].iter().for_each(|&i| visit(i));
                }
                column += step;
            }
        }
    }
}

/// Puts a place into a sorted list of the `count` nearest ones, with its squared distance.
fn keep(found: &mut Vec<(f64, usize)>, count: usize, (distance, place): (f64, usize)) {
    let nearer = |other: &(f64, usize)| other.0.total_cmp(&distance).then(other.1.cmp(&place)).is_lt();
    if found.len() < count || found.last().is_some_and(|last| !nearer(last)) {
        found.truncate(count.saturating_sub(1));
        found.insert(found.partition_point(nearer), (distance, place));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_nearest_are_those_of_trying_all(
            places in prop::collection::vec((-50.0f64..50.0, -3.0f64..9.0), 1..60),
            p in (-80.0f64..80.0, -80.0f64..80.0),
            count in 1usize..9,
        ) {
            let places: Vec<Point> = places.into_iter().map(Point::from).collect();
            let p = Point::from(p);
            let mut all: Vec<usize> = (0..places.len()).collect();
            all.sort_by(|&a, &b| places[a].distance_squared(p).total_cmp(&places[b].distance_squared(p)).then(a.cmp(&b)));
            all.truncate(count);
            prop_assert_eq!(Grid::new(&places).nearest(p, count), all);
        }
    }

    #[test]
    fn places_on_one_spot_or_none() {
        assert_eq!(Grid::new(&[Point::ONE; 5]).nearest(Point::ZERO, 2), [0, 1]);
        assert!(Grid::new(&[]).nearest(Point::ZERO, 2).is_empty());
    }
}
