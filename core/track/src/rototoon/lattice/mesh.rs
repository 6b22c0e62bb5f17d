//! The lattice of a part at a key: square cells over the part's region, and points bound to them.
//!
//! The region is the inside of the contour plus a band around it. A larger part has larger cells, between 6 and 28
//! working pixels, so that the number of unknowns stays small. A point is bound to the four nodes of its cell
//! bilinearly and moves with them.

use super::grid::Numbered;
use super::unknowns::Unknowns;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::numeric::banded::BandMatrix;

/// Place of a point in the lattice, as bilinear weights of the four nodes of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Binding {
    /// The cell's nodes: top left, top right, bottom left, bottom right.
    pub nodes: [usize; 4],
    /// Their weights, with sum 1. A point outside its cell is extrapolated, with some negative weights.
    pub weights: [f64; 4],
}

impl Binding {
    /// Place of the point if the nodes are at `nodes`.
    #[inline(always)]
    pub fn at(&self, nodes: &[Point]) -> Point {
        let [a, b, c, d] = self.nodes;
        let [wa, wb, wc, wd] = self.weights;
        nodes[a] * wa + nodes[b] * wb + nodes[c] * wc + nodes[d] * wd
    }
}

/// Square cells that touch the region of a part: its inside and a band around its contour. All lengths are in working
/// pixels.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Places of the nodes at the key. They are numbered along the longer side of the region.
    pub rest: Vec<Point>,
    /// The nodes of each cell, as in [`Binding`].
    pub cells: Vec<[usize; 4]>,
    /// Stiffness of each cell: 1 at first, then as learned from the bend between the keys (`shape::learn_stiffness`).
    pub stiffness: Vec<f64>,
    /// Side of a cell.
    pub side: f64,
    /// The part's control points, bound to the lattice.
    pub control: Vec<Binding>,
    /// Size of the part: the square root of its area, plus 1.
    pub size: f64,
    /// Width of the band around the contour.
    pub band: f64,
    contour: Vec<Point>,
    closed: bool,
    grid: Grid,
    cell_of: Vec<Option<usize>>,
    unknowns: [Unknowns; 2],
}

/// An axis-aligned grid of square cells.
#[derive(Clone, Copy, Debug)]
struct Grid {
    origin: Point,
    side: f64,
    columns: usize,
    rows: usize,
}

impl Grid {
    fn column_row(&self, p: Point) -> (usize, usize) {
        let at = (p - self.origin) / self.side;
        (at.x.clamp(0.0, (self.columns - 1) as f64) as usize, at.y.clamp(0.0, (self.rows - 1) as f64) as usize)
    }

    fn index(&self, p: Point) -> usize {
        let (column, row) = self.column_row(p);
        row * self.columns + column
    }

    fn corner(&self, column: usize, row: usize) -> Point {
        self.origin + Point::new(column as f64, row as f64) * self.side
    }
}

/// Approximate largest number of cells of a lattice. A larger part has larger cells.
const MOST_CELLS: f64 = 900.0;
/// Number of levels of the pyramid, from the coarsest on, on which neighbouring nodes move together.
const COARSE_LEVELS: usize = 2;

impl Mesh {
    /// The lattice of a contour. `control` are its control points in working pixels, at least one.
    pub fn new(control: &[Point], closed: bool) -> Self {
        let length = polyline::length(control, closed);
        let inside = if closed { polygon::signed_area(control).abs() } else { 0.0 };
        // An open line has no area; its length counts instead.
        let area = inside.max(length);
        let size = area.sqrt() + 1.0;
        let band = (0.12 * size).clamp(3.0, 8.0);
        let (low, high) = polygon::bounds(control).unwrap_or_default();
        let (low, high) = (low - Point::splat(band + 1.0), high + Point::splat(band + 1.0));
        let extent = high - low;
        let side = (size / 5.0).clamp(6.0, 28.0).max((extent.x * extent.y / MOST_CELLS).sqrt());
        let count = |length: f64| (length / side).ceil().max(1.0) as usize;
        let grid = Grid { origin: low, side, columns: count(extent.x), rows: count(extent.y) };
        let mut mesh = Self {
            rest: Vec::new(),
            cells: Vec::new(),
            stiffness: Vec::new(),
            side,
            control: Vec::new(),
            size,
            band,
            contour: control.to_vec(),
            closed,
            grid,
            cell_of: Vec::new(),
            unknowns: [(); 2].map(|()| Unknowns::every(&Numbered::new(0, 0, &[]))),
        };
        mesh.occupy();
        mesh.stiffness = vec![1.0; mesh.cells.len()];
        mesh.control = control.iter().map(|&p| mesh.bind(p)).collect();
        mesh
    }

    /// Whether a point is in the region, and whether it is inside the contour.
    pub fn region(&self, p: Point) -> (bool, bool) {
        let inside = self.closed && polygon::contains(&self.contour, p);
        (inside || polyline::distance(p, &self.contour, self.closed) <= self.band, inside)
    }

    /// The mirror image of `p`, which is outside a closed contour, at the nearest point of the contour. None if it is
    /// not inside, because the part is too thin.
    pub fn across(&self, p: Point) -> Option<Point> {
        let across = self.nearest(p)? * 2.0 - p;
        self.region(across).1.then_some(across)
    }

    /// Unit vector from the contour towards `p`. None for an open line and for a point on the contour.
    pub fn outward(&self, p: Point) -> Option<Point> {
        if self.closed { (p - self.nearest(p)?).try_normalize() } else { None }
    }

    /// The point of the contour nearest to `p`.
    fn nearest(&self, p: Point) -> Option<Point> {
        let on_segment = |(a, b)| polyline::nearest_on_segment(p, a, b);
        (polyline::segments(&self.contour, self.closed).map(on_segment))
            .min_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p)))
    }

    /// Area of the cells: an upper bound of the region's area.
    pub fn area(&self) -> f64 {
        self.cells.len() as f64 * self.side * self.side
    }

    /// Corners of the box around the grid.
    pub fn bounds(&self) -> (Point, Point) {
        let extent = Point::new(self.grid.columns as f64, self.grid.rows as f64) * self.side;
        (self.grid.origin, self.grid.origin + extent)
    }

    /// Index of the cell that contains `p`, or of the nearest cell, and the binding of `p` to it.
    pub fn bind_in_cell(&self, p: Point) -> (usize, Binding) {
        let cell = match self.cell_of[self.grid.index(p)] {
            Some(cell) => cell,
            None => self.nearest_cell(p),
        };
        let nodes = self.cells[cell];
        let at = (p - self.rest[nodes[0]]) / self.side;
        let (x, y) = (at.x, at.y);
        (cell, Binding { nodes, weights: [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y] })
    }

    /// The binding of `p`.
    pub fn bind(&self, p: Point) -> Binding {
        self.bind_in_cell(p).1
    }

    /// The zero matrix over the nodes' coordinates. Unknown 2 n is x of node n, and 2 n + 1 is its y.
    pub fn matrix(&self) -> BandMatrix {
        let [_, every] = &self.unknowns;
        every.matrix()
    }

    /// The unknowns of an alignment on a level of the pyramid (index in [`LEVELS`](crate::shared::features::LEVELS)).
    pub fn unknowns(&self, level: usize) -> &Unknowns {
        &self.unknowns[usize::from(level >= COARSE_LEVELS)]
    }

    /// Places of the control points if the nodes are at `nodes`.
    pub fn control_points(&self, nodes: &[Point]) -> Vec<Point> {
        self.control.iter().map(|binding| binding.at(nodes)).collect()
    }

    fn nearest_cell(&self, p: Point) -> usize {
        let distance = |cell: &[usize; 4]| (self.rest[cell[0]] + Point::splat(0.5 * self.side)).distance_squared(p);
        let nearest =
            (0..self.cells.len()).min_by(|&a, &b| distance(&self.cells[a]).total_cmp(&distance(&self.cells[b])));
        nearest.unwrap_or(0)
    }

    /// Takes the cells that the region touches: those within the band of the contour (measured along the axes), and
    /// those whose centre is inside.
    fn occupy(&mut self) {
        let Grid { columns, rows, side, .. } = self.grid;
        let mut taken = vec![false; columns * rows];
        let mut take_around = |p: Point| {
            let reach = Point::splat(self.band);
            let ((c0, r0), (c1, r1)) = (self.grid.column_row(p - reach), self.grid.column_row(p + reach));
            for r in r0..=r1 {
                taken[r * columns + c0..=r * columns + c1].fill(true);
            }
        };
        self.contour.iter().for_each(|&p| take_around(p));
        for (a, b) in polyline::segments(&self.contour, self.closed) {
            let steps = (4.0 * a.distance(b) / side).ceil();
            (1..steps as usize).for_each(|k| take_around(a.lerp(b, k as f64 / steps)));
        }
        for r in 0..rows {
            for c in 0..columns {
                let center = self.grid.corner(c, r) + Point::splat(0.5 * side);
                if self.closed && !taken[r * columns + c] {
                    taken[r * columns + c] = polygon::contains(&self.contour, center);
                }
            }
        }
        let numbered = Numbered::new(columns, rows, &taken);
        self.rest = numbered.nodes.iter().map(|&(c, r)| self.grid.corner(c, r)).collect();
        self.unknowns = [Unknowns::coarse(&numbered, columns, rows), Unknowns::every(&numbered)];
        (self.cells, self.cell_of) = (numbered.cells, numbered.cell_of);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar() -> Vec<Point> {
        [(100.0, 50.0), (220.0, 50.0), (220.0, 90.0), (100.0, 90.0)].map(|(x, y)| Point::new(x, y)).to_vec()
    }

    #[test]
    fn bound_points_are_where_they_were_at_rest() {
        let mesh = Mesh::new(&bar(), true);
        for (binding, p) in mesh.control.iter().zip(bar()) {
            assert!(binding.at(&mesh.rest).distance(p) < 1e-9);
        }
        let far = Point::new(400.0, -30.0);
        assert!(mesh.bind(far).at(&mesh.rest).distance(far) < 1e-9);
    }

    #[test]
    fn every_point_of_the_region_lies_in_a_cell() {
        let mesh = Mesh::new(&bar(), true);
        for y in 40..100 {
            for x in 90..230 {
                let p = Point::new(f64::from(x), f64::from(y));
                if mesh.region(p).0 {
                    let (_, binding) = mesh.bind_in_cell(p);
                    assert!(binding.weights.iter().all(|w| (-0.35..=1.35).contains(w)), "{p}: {binding:?}");
                }
            }
        }
    }

    #[test]
    fn the_band_of_the_equations_follows_the_shorter_side() {
        let mesh = Mesh::new(&bar(), true);
        let turned: Vec<Point> = bar().into_iter().map(|p| Point::new(p.y, p.x)).collect();
        let band = |mesh: &Mesh| mesh.matrix().row_range(0).end;
        assert_eq!(band(&mesh), band(&Mesh::new(&turned, true)));
        assert!(band(&mesh) < mesh.rest.len());
    }

    #[test]
    fn lines_points_and_flat_polygons_have_lattices() {
        let shapes: [&[Point]; 4] = [&bar()[..1], &bar()[..2], &[Point::ONE; 5], &[Point::ZERO, Point::X * 4000.0]];
        for shape in shapes {
            for closed in [false, true] {
                let mesh = Mesh::new(shape, closed);
                assert!(!mesh.cells.is_empty() && mesh.cells.len() < 2000);
            }
        }
    }
}
