//! JᵀJ of residuals that couple neighbouring frames: a block-tridiagonal matrix with blocks of 2 × 2 for pairs of
//! control points.
//!
//! ```text
//! D₀  C₀
//! C₀ᵀ D₁  C₁
//!     C₁ᵀ D₂  …
//! ```
//!
//! D_t couples the points of a frame, and C_t couples those of frame t with those of the next. Two points are coupled
//! only if some sample reads both: they are at most [`REACH`] apart along the contour, across the end of a closed one
//! too. So both D and C store a band of 2 [`REACH`] + 1 blocks per point (all points if the contour has no more than
//! that).
//!
//! A [`Link`] is the contribution of one step from frame to frame. Links are computed in parallel and added in order,
//! so the sums do not depend on the number of threads.

use super::curve::WIDEST;
use super::{Handle, MOST_HANDLES, Sink};
use nalgebra::Matrix2;
use rototoon_base::geometry::Point;

/// Largest distance along the contour between coupled points, in points.
pub const REACH: usize = WIDEST - 1;

/// A 2 × 2 block by rows: (xx, xy, yx, yy).
type Block = [f64; 4];

/// The points that each point is coupled with.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    points: usize,
    width: usize,
}

impl Band {
    /// The band of a contour of `points` points.
    pub fn new(points: usize) -> Self {
        Self { points, width: points.min(2 * REACH + 1) }
    }

    fn slot(self, row: usize, column: usize) -> usize {
        let offset =
            if self.width == self.points { column } else { (column + self.points + REACH - row) % self.points };
        row * self.width + offset
    }

    fn column(self, row: usize, offset: usize) -> usize {
        if self.width == self.points { offset } else { (row + offset + self.points - REACH) % self.points }
    }

    fn blocks(self) -> Vec<Block> {
        vec![[0.0; 4]; self.points * self.width]
    }
}

/// The matrix JᵀJ and the gradient Jᵀr.
pub struct Blocks {
    band: Band,
    diagonal: Vec<Vec<Block>>,
    cross: Vec<Vec<Block>>,
    gradient: Vec<f64>,
    /// Inverses of the diagonal 2 × 2 blocks.
    inverses: Vec<Block>,
}

impl Blocks {
    /// The zero matrix for `frames` frames.
    pub fn new(frames: usize, points: usize) -> Self {
        let band = Band::new(points);
        Self {
            diagonal: vec![band.blocks(); frames],
            cross: vec![Vec::new(); frames.saturating_sub(1)],
            gradient: vec![0.0; 2 * frames * points],
            inverses: vec![[0.0; 4]; frames * points],
            band,
        }
    }

    /// Sets the matrix and the gradient to the sum of links, one per step from frame to frame. Returns the cost.
    pub fn assemble(&mut self, links: Vec<Link>) -> f64 {
        let mut cost = 0.0;
        self.gradient.fill(0.0);
        self.diagonal.iter_mut().flatten().for_each(|block| *block = [0.0; 4]);
        for (t, link) in links.into_iter().enumerate() {
            cost += link.cost;
            for (side, frame) in [t, t + 1].into_iter().enumerate() {
                let gradient = &mut self.gradient[2 * frame * self.band.points..][..2 * self.band.points];
                gradient.iter_mut().zip(&link.gradient[side]).for_each(|(sum, g)| *sum += g);
                let blocks = self.diagonal[frame].iter_mut().zip(&link.diagonal[side]);
                blocks.for_each(|(sum, block)| (0..4).for_each(|k| sum[k] += block[k]));
            }
            self.cross[t] = link.cross;
        }
        for (frame, blocks) in self.diagonal.iter().enumerate() {
            for j in 0..self.band.points {
                self.inverses[frame * self.band.points + j] = inverse(blocks[self.band.slot(j, j)]);
            }
        }
        cost
    }

    /// Jᵀr.
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// `product` = JᵀJ `v`.
    pub fn multiply(&self, v: &[f64], product: &mut [f64]) {
        product.fill(0.0);
        let n = 2 * self.band.points;
        for (t, blocks) in self.diagonal.iter().enumerate() {
            self.add_product(blocks, &v[t * n..(t + 1) * n], &mut product[t * n..(t + 1) * n]);
        }
        for (t, blocks) in self.cross.iter().enumerate() {
            let (before, after) = product.split_at_mut((t + 1) * n);
            self.add_product(blocks, &v[(t + 1) * n..(t + 2) * n], &mut before[t * n..]);
            self.add_transposed(blocks, &v[t * n..(t + 1) * n], &mut after[..n]);
        }
    }

    /// Preconditions `v`: multiplies it by the inverse of the diagonal 2 × 2 blocks of JᵀJ.
    pub fn precondition(&self, v: &mut [f64]) {
        for (p, [a, b, c, d]) in v.chunks_exact_mut(2).zip(&self.inverses) {
            (p[0], p[1]) = (a * p[0] + b * p[1], c * p[0] + d * p[1]);
        }
    }

    fn add_product(&self, blocks: &[Block], v: &[f64], sum: &mut [f64]) {
        for (row, blocks) in blocks.chunks_exact(self.band.width.max(1)).enumerate() {
            let (mut x, mut y) = (0.0, 0.0);
            for (offset, [a, b, c, d]) in blocks.iter().enumerate() {
                let column = 2 * self.band.column(row, offset);
                x += a * v[column] + b * v[column + 1];
                y += c * v[column] + d * v[column + 1];
            }
            sum[2 * row] += x;
            sum[2 * row + 1] += y;
        }
    }

    fn add_transposed(&self, blocks: &[Block], v: &[f64], sum: &mut [f64]) {
        for (row, blocks) in blocks.chunks_exact(self.band.width.max(1)).enumerate() {
            let (x, y) = (v[2 * row], v[2 * row + 1]);
            for (offset, [a, b, c, d]) in blocks.iter().enumerate() {
                let column = 2 * self.band.column(row, offset);
                sum[column] += a * x + c * y;
                sum[column + 1] += b * x + d * y;
            }
        }
    }
}

/// Inverse of a symmetric block, with a floor on its diagonal. The unit block if the block has no information.
fn inverse([a, b, _, d]: Block) -> Block {
    let floor = 1e-9 * (a + d);
    let block = Matrix2::new(a + floor, b, b, d + floor);
    let inverse = block.try_inverse().filter(|_| block.determinant() > 0.0).unwrap_or_else(Matrix2::identity);
    [inverse.m11, inverse.m12, inverse.m21, inverse.m22]
}

/// The contribution of the residuals between two neighbouring frames to the matrix. It is a [`Sink`].
pub struct Link {
    band: Band,
    cost: f64,
    gradient: [Vec<f64>; 2],
    diagonal: [Vec<Block>; 2],
    cross: Vec<Block>,
    handles: [(bool, super::curve::Functional); MOST_HANDLES],
    count: usize,
    /// Lower triangle of the group's JᵀJ, by the coordinates of its handles.
    squares: [[f64; 2 * MOST_HANDLES]; 2 * MOST_HANDLES],
    products: [f64; 2 * MOST_HANDLES],
}

impl Link {
    /// An empty link for contours of `points` points.
    pub fn new(points: usize) -> Self {
        let band = Band::new(points);
        Self {
            cost: 0.0,
            gradient: [vec![0.0; 2 * points], vec![0.0; 2 * points]],
            diagonal: [band.blocks(), band.blocks()],
            cross: band.blocks(),
            handles: Default::default(),
            count: 0,
            squares: [[0.0; 2 * MOST_HANDLES]; 2 * MOST_HANDLES],
            products: [0.0; 2 * MOST_HANDLES],
            band,
        }
    }

    /// Adds the group's block of the handles `a` and `b` to the matrix. `a` must not come after `b`.
    fn spread(&mut self, a: usize, b: usize) {
        let at = |i: usize, j: usize| self.squares[i.max(j)][i.min(j)];
        let (i, j) = (2 * a, 2 * b);
        let block = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
        let ((late_a, from), (late_b, to)) = (self.handles[a], self.handles[b]);
        let blocks = if late_a == late_b { &mut self.diagonal[usize::from(late_a)] } else { &mut self.cross };
        for (p, weight_p) in from.entries() {
            for (q, weight_q) in to.entries() {
                let weight = weight_p * weight_q;
                let sum = &mut blocks[self.band.slot(p, q)];
                (0..4).for_each(|k| sum[k] += weight * block[k]);
                if late_a == late_b && a != b {
                    let mirrored = [block[0], block[2], block[1], block[3]];
                    let sum = &mut blocks[self.band.slot(q, p)];
                    (0..4).for_each(|k| sum[k] += weight * mirrored[k]);
                }
            }
        }
    }
}

impl Sink for Link {
    const SLOPES: bool = true;

    fn open(&mut self, handles: &[Handle<'_>]) {
        self.count = handles.len();
        for (slot, handle) in self.handles.iter_mut().zip(handles) {
            *slot = (handle.later, *handle.functional);
        }
        self.squares = [[0.0; 2 * MOST_HANDLES]; 2 * MOST_HANDLES];
        self.products = [0.0; 2 * MOST_HANDLES];
    }

    fn residual(&mut self, value: f64, by: &[Point]) {
        let mut slopes = [0.0; 2 * MOST_HANDLES];
        for (k, by) in by.iter().enumerate() {
            slopes[2 * k] = by.x;
            slopes[2 * k + 1] = by.y;
        }
        self.cost += value * value;
        for i in 0..2 * by.len() {
            self.products[i] += slopes[i] * value;
            for j in 0..=i {
                self.squares[i][j] += slopes[i] * slopes[j];
            }
        }
    }

    fn close(&mut self) {
        for k in 0..self.count {
            let (later, functional) = self.handles[k];
            let product = [self.products[2 * k], self.products[2 * k + 1]];
            let gradient = &mut self.gradient[usize::from(later)];
            for (point, weight) in functional.entries() {
                gradient[2 * point] += weight * product[0];
                gradient[2 * point + 1] += weight * product[1];
            }
            // Handles of the earlier frame come first, so a cross block always has its row in the earlier frame.
            (k..self.count).for_each(|other| self.spread(k, other));
        }
    }

    fn constant(&mut self, cost: f64) {
        self.cost += cost;
    }
}

/// Sums the cost alone. It is a [`Sink`].
#[derive(Default)]
pub struct Cost(pub f64);

impl Sink for Cost {
    const SLOPES: bool = false;

    fn open(&mut self, _handles: &[Handle<'_>]) {}

    fn residual(&mut self, value: f64, _by: &[Point]) {
        self.0 += value * value;
    }

    fn close(&mut self) {}

    fn constant(&mut self, cost: f64) {
        self.0 += cost;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{curve_case, jacobian, pose, scenery};
    use super::super::{Term, appearance};
    use super::*;

    /// Compares gradient and products with those of the explicit Jacobian.
    fn check(points: usize, closed: bool) {
        let scenery = scenery();
        let (curve, x) = curve_case(points, closed);
        let term = appearance::Appearance { curve: &curve, scenery: &scenery, level: 0, offsets: &appearance::WINDOW };
        let pose = pose(&curve, &x);
        let link = |t: usize| {
            let mut link = Link::new(points);
            term.walk(t, &pose, &mut link);
            link
        };
        let mut blocks = Blocks::new(4, points);
        let cost = blocks.assemble((0..3).map(link).collect());
        let (values, rows) = jacobian(&term, &curve, &x);
        let n = 8 * points;
        let mut gradient = vec![0.0; n];
        let mut product = vec![0.0; n];
        let v: Vec<f64> = (0..n).map(|k| (0.7 * k as f64).sin()).collect();
        for (value, row) in values.iter().zip(&rows) {
            let along: f64 = row.iter().map(|&(k, a)| a * v[k]).sum();
            row.iter().for_each(|&(k, a)| {
                gradient[k] += a * value;
                product[k] += a * along;
            });
        }
        let mut found = vec![0.0; n];
        blocks.multiply(&v, &mut found);
        let size = product.iter().fold(1.0f64, |most, p| most.max(p.abs()));
        assert!(found.iter().zip(&product).all(|(a, b)| (a - b).abs() < 1e-9 * size));
        let size = gradient.iter().fold(1.0f64, |most, p| most.max(p.abs()));
        assert!(blocks.gradient().iter().zip(&gradient).all(|(a, b)| (a - b).abs() < 1e-9 * size));
        let squares: f64 = values.iter().map(|v| v * v).sum();
        assert!((cost - squares).abs() < 1e-9 * squares);
        let mut sum = Cost::default();
        (0..3).for_each(|t| term.walk(t, &pose, &mut sum));
        assert!((sum.0 - squares).abs() < 1e-9 * squares);
    }

    #[test]
    fn products_are_those_of_the_jacobian() {
        for (points, closed) in
            [(2, false), (3, true), (5, false), (8, true), (11, true), (12, true), (17, true), (17, false)]
        {
            check(points, closed);
        }
    }

    #[test]
    fn a_block_without_information_is_left_alone() {
        assert_eq!(inverse([0.0; 4]), [1.0, 0.0, 0.0, 1.0]);
        let [a, b, c, d] = inverse([4.0, 1.0, 1.0, 2.0]);
        assert!((a - 2.0 / 7.0).abs() < 1e-6 && (b + 1.0 / 7.0).abs() < 1e-6 && b == c && (d - 4.0 / 7.0).abs() < 1e-6);
    }
}
