//! The patches that search their places in the second picture, and the dense field blended from them.

use super::Flow;
use super::plane::Plane;
use glam::Vec4;
use rototoon_base::numeric::lanes::{LANES, Lanes};
use rototoon_base::scene::Raster;

/// Side of a patch in pixels.
const PATCH: usize = LANES;
/// Number of pixels by which a picture is continued: enough for a patch beside the picture and its next neighbours.
const BEYOND: usize = PATCH + 1;
/// Distance between neighbouring patches in pixels.
const STRIDE: usize = 4;
/// Largest number of shifts that the gradient descent of a patch tries, including the start.
const STEPS: usize = 16;
/// A patch that moves farther than this from its start, in pixels, is lost.
const FURTHEST: f32 = 8.0;

/// The rows of a patch.
type Rows = [Lanes; PATCH];

/// A picture of one level with its derivatives along x and y.
pub(super) struct Level {
    pub luma: Raster<f32>,
    pub plane: Plane,
    pub slopes: [Plane; 2],
    /// Luma, its two derivatives, and 0.
    pub together: Raster<Vec4>,
    /// Luma, continued beyond the edges by [`BEYOND`] pixels.
    wide: Raster<f32>,
}

impl Level {
    #[inline(always)]
    pub fn new(luma: Raster<f32>) -> Self {
        let (width, height) = (luma.width(), luma.height());
        let mut plane = Plane::zeros(width, height);
        (0..height).for_each(|y| plane.row_mut(y).copy_from_slice(luma.row(y)));
        plane.continue_border();
        let mut slopes = [Plane::zeros(width, height), Plane::zeros(width, height)];
        for y in 0..height {
            for x in (0..width).step_by(LANES) {
                let (xi, yi) = (x as isize, y as isize);
                slopes[0].set_lanes(x, y, 0.5 * (plane.lanes(xi + 1, yi) - plane.lanes(xi - 1, yi)));
                slopes[1].set_lanes(x, y, 0.5 * (plane.lanes(xi, yi + 1) - plane.lanes(xi, yi - 1)));
            }
        }
        let inner = |at: usize, count: usize| at.saturating_sub(BEYOND).min(count - 1);
        let wide = Raster::from_fn(width + 2 * BEYOND, height + 2 * BEYOND, |x, y| {
            luma.get(inner(x, width), inner(y, height))
        });
        let together = Raster::from_fn(width, height, |x, y| {
            Vec4::new(luma.get(x, y), slopes[0].row(y)[x], slopes[1].row(y)[x], 0.0)
        });
        Self { luma, plane, slopes, together, wide }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        let planes: usize = std::iter::once(&self.plane).chain(&self.slopes).map(Plane::bytes).sum();
        planes + size_of_val(self.luma.data()) + size_of_val(self.wide.data()) + size_of_val(self.together.data())
    }

    /// Bilinear luma of a patch. Its first pixel is at (`x`, `y`), in coordinates in which pixel centres are integers.
    #[inline(always)]
    fn patch_at(&self, x: f32, y: f32) -> Rows {
        // Farther out nothing changes.
        let within = |at: f32, count: usize| (at + BEYOND as f32).clamp(0.0, (count + BEYOND) as f32);
        let (x, y) = (within(x, self.luma.width()), within(y, self.luma.height()));
        let (x0, y0) = (x as i32 as usize, y as i32 as usize);
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let mut patch = [Lanes::splat(0.0); PATCH];
        let mut above = self.between(x0, y0, fx);
        for (j, out) in patch.iter_mut().enumerate() {
            let below = self.between(x0, y0 + j + 1, fx);
            *out = (1.0 - fy) * above + fy * below;
            above = below;
        }
        patch
    }

    /// Pixels of a row from `x` on, each mixed with the next one by `share`.
    #[inline(always)]
    fn between(&self, x: usize, y: usize, share: f32) -> Lanes {
        let row = &self.wide.row(y)[x..=x + PATCH];
        (1.0 - share) * Lanes::read(row) + share * Lanes::read(&row[1..])
    }
}

/// A patch of the first picture: luma without its mean, its derivatives, and the inverse of their moment matrix.
struct Patch {
    x: usize,
    y: usize,
    luma: Rows,
    /// Derivatives along x and along y.
    gradient: [Rows; 2],
    inverse: [f32; 3],
}

impl Patch {
    #[inline(always)]
    fn new(level: &Level, x: usize, y: usize) -> Self {
        let count = (PATCH * PATCH) as f32;
        let mut luma = cut(&level.plane, x, y);
        // The derivatives of differences between mean-free patches are mean-free.
        let mut gradient = [cut(&level.slopes[0], x, y), cut(&level.slopes[1], x, y)];
        for rows in std::iter::once(&mut luma).chain(&mut gradient) {
            let mean = Lanes::splat(total(rows) / count);
            rows.iter_mut().for_each(|row| *row = *row - mean);
        }
        // The ridge (a contrast of one grey step of 8 bits) keeps flat patches where they are.
        let ridge = count * (1.0 / 255.0f32).powi(2);
        let [gx, gy] = &gradient;
        let (xx, xy, yy) = (total(&product(gx, gx)) + ridge, total(&product(gx, gy)), total(&product(gy, gy)) + ridge);
        let determinant = xx * yy - xy * xy;
        Self { x, y, luma, gradient, inverse: [yy / determinant, -xy / determinant, xx / determinant] }
    }

    /// The difference from the second picture at shift `u`, without its mean, and its mean square.
    #[inline(always)]
    fn difference(&self, second: &Level, u: [f32; 2]) -> (Rows, f32) {
        let mut d = second.patch_at(self.x as f32 + u[0], self.y as f32 + u[1]);
        let count = (PATCH * PATCH) as f32;
        let mean = Lanes::splat(total(&d) / count);
        for (row, own) in d.iter_mut().zip(&self.luma) {
            *row = *row - (mean + *own);
        }
        let square = total(&product(&d, &d)) / count;
        (d, square)
    }

    /// Gradient descent on the mean square difference, with the derivatives of the first picture (inverse search).
    #[inline(always)]
    fn descend(&self, second: &Level, start: [f32; 2], (mut d, square): (Rows, f32)) -> Found {
        let mut best = Found { shift: start, square, settled: false };
        let mut u = start;
        for _ in 1..STEPS {
            let bx = total(&product(&d, &self.gradient[0]));
            let by = total(&product(&d, &self.gradient[1]));
            let [xx, xy, yy] = self.inverse;
            let step = [xx * bx + xy * by, xy * bx + yy * by];
            u = [u[0] - step[0], u[1] - step[1]];
            if (u[0] - start[0]).hypot(u[1] - start[1]) > FURTHEST {
                break;
            }
            let square;
            (d, square) = self.difference(second, u);
            if square >= best.square {
                best.settled = true;
                break;
            }
            (best.shift, best.square) = (u, square);
        }
        best
    }
}

/// The place that a patch found.
#[derive(Clone, Copy)]
struct Found {
    shift: [f32; 2],
    /// Mean square difference there.
    square: f32,
    /// Whether further descent cannot improve it.
    settled: bool,
}

/// The pixels of a plane under a patch. Beyond the edge the nearest pixels are repeated.
#[inline(always)]
fn cut(plane: &Plane, x: usize, y: usize) -> Rows {
    let mut rows = [Lanes::splat(0.0); PATCH];
    for (j, row) in rows.iter_mut().enumerate() {
        *row = plane.clamped_lanes(x, y + j);
    }
    rows
}

/// The product of two patches, pixel by pixel.
#[inline(always)]
fn product(a: &Rows, b: &Rows) -> Rows {
    let mut product = *a;
    for (a, b) in product.iter_mut().zip(b) {
        *a = *a * *b;
    }
    product
}

/// Sum over a patch, first along the columns.
#[inline(always)]
fn total(patch: &Rows) -> f32 {
    let mut columns = Lanes::splat(0.0);
    for row in patch {
        columns = columns + *row;
    }
    columns.sum()
}

/// The dense flow of a level. `coarse` is the coarser level's flow, enlarged to this size.
#[inline(always)]
pub(super) fn search(first: &Level, second: &Level, coarse: &Flow) -> Flow {
    let (width, height) = (first.luma.width(), first.luma.height());
    let columns = grid(width);
    let rows = grid(height);
    let mut patches = Vec::with_capacity(rows.len() * columns.len());
    for &y in &rows {
        for &x in &columns {
            patches.push(Patch::new(first, x, y));
        }
    }
    let middle = PATCH / 2;
    let from_coarse = |p: &Patch| coarse.get((p.x + middle).min(width - 1), (p.y + middle).min(height - 1));
    let unsought = |p: &Patch| Found { shift: from_coarse(p), square: f32::INFINITY, settled: false };
    let mut found: Vec<Found> = patches.iter().map(unsought).collect();
    for backwards in [false, true] {
        sweep(&patches, second, &mut found, columns.len(), backwards);
    }
    blend(first, second, &patches, &found)
}

/// Top left corners of the patches along one axis. The patches reach over the far edge, so each pixel is covered.
fn grid(count: usize) -> Vec<usize> {
    (0..count.saturating_sub(PATCH - STRIDE).max(1)).step_by(STRIDE).collect()
}

/// One pass over the patches in reading order or in reverse. Each patch starts from its own shift or from that of the
/// two neighbours visited before, whichever fits best, and descends. A patch that has settled at the best start does
/// not descend again.
#[inline(always)]
fn sweep(patches: &[Patch], second: &Level, found: &mut [Found], columns: usize, backwards: bool) {
    let count = patches.len();
    for k in 0..count {
        let i = if backwards { count - 1 - k } else { k };
        let (column, row) = (i % columns, i / columns);
        let rows = count / columns;
        let neighbours = if backwards {
            [(column + 1 < columns).then_some(i + 1), (row + 1 < rows).then_some(i + columns)]
        } else {
            [(column > 0).then(|| i - 1), (row > 0).then(|| i - columns)]
        };
        let (patch, own) = (&patches[i], found[i]);
        let mut start = own.shift;
        let mut fit = if own.settled { None } else { Some(patch.difference(second, start)) };
        let mut square = fit.as_ref().map_or(own.square, |fit| fit.1);
        for shift in neighbours.into_iter().flatten().map(|n| found[n].shift).filter(|shift| *shift != own.shift) {
            let there = patch.difference(second, shift);
            if there.1 < square {
                (start, square, fit) = (shift, there.1, Some(there));
            }
        }
        if let Some(fit) = fit {
            found[i] = patch.descend(second, start, fit);
        }
    }
}

/// Each pixel takes the mean of the shifts of the patches over it, weighted by 1 / max(1, |difference| in 8-bit steps).
#[inline(always)]
fn blend(first: &Level, second: &Level, patches: &[Patch], found: &[Found]) -> Flow {
    let (width, height) = (first.luma.width(), first.luma.height());
    let mut sums = Raster::new(width, height, [0.0f32; 3]);
    for (patch, Found { shift: u, .. }) in patches.iter().zip(found) {
        let seen = second.patch_at(patch.x as f32 + u[0], patch.y as f32 + u[1]);
        for y in patch.y..(patch.y + PATCH).min(height) {
            for x in patch.x..(patch.x + PATCH).min(width) {
                let there = seen[y - patch.y].get(x - patch.x);
                let weight = 1.0 / (255.0 * (there - first.luma.get(x, y)).abs()).max(1.0);
                let [su, sv, sw] = sums.get(x, y);
                sums.set(x, y, [su + weight * u[0], sv + weight * u[1], sw + weight]);
            }
        }
    }
    sums.map(|[u, v, w]| if w > 0.0 { [u / w, v / w] } else { [0.0; 2] })
}
