//! Patches that search their place in the second picture, and the dense field blended from them.

use super::{Flow, read};
use crate::numeric::vector::vectorised;
use crate::scene::Raster;

/// Side of a patch in pixels.
const PATCH: usize = 8;
/// Distance between neighbouring patches in pixels.
const STRIDE: usize = 4;
/// Steps of gradient descent of a patch at the most.
const STEPS: usize = 16;
/// A patch that strays further than this from its start has lost its way, in pixels.
const FURTHEST: f32 = 8.0;

/// A picture of one level with its derivatives along x and y.
pub(super) struct Level {
    pub luma: Raster<f32>,
    pub gradient: Raster<[f32; 2]>,
    packed: Raster<[f32; 1]>,
}

impl Level {
    pub fn new(luma: Raster<f32>) -> Self {
        let at = |x: usize, y: usize, dx: isize, dy: isize| luma.clamped(x as isize + dx, y as isize + dy);
        let gradient = Raster::from_fn(luma.width(), luma.height(), |x, y| {
            [0.5 * (at(x, y, 1, 0) - at(x, y, -1, 0)), 0.5 * (at(x, y, 0, 1) - at(x, y, 0, -1))]
        });
        let packed = luma.map(|v| [v]);
        Self { luma, gradient, packed }
    }

    /// Bilinear luma of a patch whose first pixel is at pixel-centre coordinates.
    #[inline(always)]
    fn patch_at(&self, x: f32, y: f32) -> [f32; PATCH * PATCH] {
        let last = |count: usize| count as f32 - 1.0 - PATCH as f32;
        if !(x >= 0.0 && y >= 0.0 && x <= last(self.luma.width()) && y <= last(self.luma.height())) {
            return std::array::from_fn(|k| self.luma_at(x + (k % PATCH) as f32, y + (k / PATCH) as f32));
        }
        // Inside the picture all pixels of the patch have the same four weights.
        let (x0, y0) = (x as i32 as usize, y as i32 as usize);
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let along = |j: usize| -> [f32; PATCH] {
            let row = &self.luma.row(y0 + j)[x0..=x0 + PATCH];
            std::array::from_fn(|i| (1.0 - fx) * row[i] + fx * row[i + 1])
        };
        let mut patch = [0.0; PATCH * PATCH];
        let mut above = along(0);
        for (j, out) in patch.chunks_exact_mut(PATCH).enumerate() {
            let below = along(j + 1);
            for i in 0..PATCH {
                out[i] = (1.0 - fy) * above[i] + fy * below[i];
            }
            above = below;
        }
        patch
    }

    /// Bilinear luma at pixel-centre coordinates.
    pub fn luma_at(&self, x: f32, y: f32) -> f32 {
        read(&self.packed, x, y)[0]
    }
}

/// A patch of the first picture: luma without its mean, derivatives, and the inverse of their moment matrix.
struct Patch {
    x: usize,
    y: usize,
    luma: [f32; PATCH * PATCH],
    /// Along x and along y.
    gradient: [[f32; PATCH * PATCH]; 2],
    inverse: [f32; 3],
}

impl Patch {
    fn new(level: &Level, x: usize, y: usize) -> Self {
        let at = |k: usize| ((x + k % PATCH) as isize, (y + k / PATCH) as isize);
        let mut luma: [f32; PATCH * PATCH] = std::array::from_fn(|k| level.luma.clamped(at(k).0, at(k).1));
        let slope = |axis: usize| std::array::from_fn(|k| level.gradient.clamped(at(k).0, at(k).1)[axis]);
        let mut gradient: [[f32; PATCH * PATCH]; 2] = [slope(0), slope(1)];
        let count = (PATCH * PATCH) as f32;
        let mean = luma.iter().sum::<f32>() / count;
        luma.iter_mut().for_each(|v| *v -= mean);
        // Differences of mean-free patches have mean-free derivatives.
        for slope in &mut gradient {
            let mean = slope.iter().sum::<f32>() / count;
            slope.iter_mut().for_each(|g| *g -= mean);
        }
        let moment = |a: usize, b: usize| gradient[a].iter().zip(&gradient[b]).map(|(g, h)| g * h).sum::<f32>();
        // The ridge (of a contrast of one grey step in 8 bits) keeps flat patches where they are.
        let ridge = count * (1.0 / 255.0f32).powi(2);
        let (xx, xy, yy) = (moment(0, 0) + ridge, moment(0, 1), moment(1, 1) + ridge);
        let determinant = xx * yy - xy * xy;
        Self { x, y, luma, gradient, inverse: [yy / determinant, -xy / determinant, xx / determinant] }
    }

    /// The difference to the second picture at shift `u`, without its mean, and its mean square.
    #[inline(always)]
    fn difference(&self, second: &Level, u: [f32; 2]) -> ([f32; PATCH * PATCH], f32) {
        let mut d = second.patch_at(self.x as f32 + u[0], self.y as f32 + u[1]);
        let count = (PATCH * PATCH) as f32;
        let mean = total(&d, |v| v) / count;
        for (v, own) in d.iter_mut().zip(&self.luma) {
            *v -= mean + own;
        }
        let square = total(&d, |v| v * v) / count;
        (d, square)
    }

    /// Gradient descent on the mean square difference, with the derivatives of the first picture (inverse search).
    #[inline(always)]
    fn descend(&self, second: &Level, start: [f32; 2]) -> [f32; 2] {
        let mut u = start;
        let mut best = (f32::INFINITY, start);
        for _ in 0..STEPS {
            let (d, square) = self.difference(second, u);
            if square >= best.0 {
                break;
            }
            best = (square, u);
            let along = |slope: &[f32; PATCH * PATCH]| total(&std::array::from_fn(|k| d[k] * slope[k]), |v| v);
            let (bx, by) = (along(&self.gradient[0]), along(&self.gradient[1]));
            let [xx, xy, yy] = self.inverse;
            let step = [xx * bx + xy * by, xy * bx + yy * by];
            u = [u[0] - step[0], u[1] - step[1]];
            if (u[0] - start[0]).hypot(u[1] - start[1]) > FURTHEST {
                break;
            }
        }
        best.1
    }
}

/// Sum of a value of each pixel of a patch, column by column first: a fixed order that the compiler can vectorise.
#[inline(always)]
fn total(patch: &[f32; PATCH * PATCH], value: impl Fn(f32) -> f32) -> f32 {
    let mut columns = [0.0; PATCH];
    for row in patch.chunks_exact(PATCH) {
        for (sum, v) in columns.iter_mut().zip(row) {
            *sum += value(*v);
        }
    }
    columns.iter().sum()
}

/// The dense flow of a level from the coarser level's, brought to this size.
pub(super) fn search(first: &Level, second: &Level, coarse: &Flow) -> Flow {
    let (width, height) = (first.luma.width(), first.luma.height());
    let columns = grid(width);
    let rows = grid(height);
    let patches: Vec<Patch> =
        rows.iter().flat_map(|&y| columns.iter().map(move |&x| (x, y))).map(|(x, y)| Patch::new(first, x, y)).collect();
    let middle = PATCH / 2;
    let from_coarse = |p: &Patch| coarse.get((p.x + middle).min(width - 1), (p.y + middle).min(height - 1));
    let mut shifts: Vec<[f32; 2]> = patches.iter().map(from_coarse).collect();
    for backwards in [false, true] {
        vectorised(
            #[inline(always)]
            || sweep(&patches, second, &mut shifts, columns.len(), backwards),
        );
    }
    blend(first, second, &patches, &shifts)
}

/// Top-left corners of the patches along one side: they reach over the far edge, so that each pixel is covered.
fn grid(count: usize) -> Vec<usize> {
    (0..count.saturating_sub(PATCH - STRIDE).max(1)).step_by(STRIDE).collect()
}

/// One pass over the patches in reading order (or from the end): each starts from its own shift or that of the two
/// neighbours passed before, whichever fits best, and descends.
#[inline(always)]
fn sweep(patches: &[Patch], second: &Level, shifts: &mut [[f32; 2]], columns: usize, backwards: bool) {
    let count = patches.len();
    for k in 0..count {
        let i = if backwards { count - 1 - k } else { k };
        let (column, row) = (i % columns, i / columns);
        let rows = count / columns;
        let mut starts = [Some(i), None, None];
        if backwards {
            starts[1] = (column + 1 < columns).then_some(i + 1);
            starts[2] = (row + 1 < rows).then_some(i + columns);
        } else {
            starts[1] = (column > 0).then(|| i - 1);
            starts[2] = (row > 0).then(|| i - columns);
        }
        let mut best = (f32::INFINITY, shifts[i]);
        for start in starts.into_iter().flatten() {
            let (_, square) = patches[i].difference(second, shifts[start]);
            if square < best.0 {
                best = (square, shifts[start]);
            }
        }
        shifts[i] = patches[i].descend(second, best.1);
    }
}

/// Each pixel takes the mean of the shifts of the patches over it, weighted by 1 / max(1, |difference| in 8-bit steps).
fn blend(first: &Level, second: &Level, patches: &[Patch], shifts: &[[f32; 2]]) -> Flow {
    let (width, height) = (first.luma.width(), first.luma.height());
    let mut sums = Raster::new(width, height, [0.0f32; 3]);
    for (patch, u) in patches.iter().zip(shifts) {
        let seen = second.patch_at(patch.x as f32 + u[0], patch.y as f32 + u[1]);
        for y in patch.y..(patch.y + PATCH).min(height) {
            for x in patch.x..(patch.x + PATCH).min(width) {
                let there = seen[(y - patch.y) * PATCH + x - patch.x];
                let weight = 1.0 / (255.0 * (there - first.luma.get(x, y)).abs()).max(1.0);
                let [su, sv, sw] = sums.get(x, y);
                sums.set(x, y, [su + weight * u[0], sv + weight * u[1], sw + weight]);
            }
        }
    }
    sums.map(|[u, v, w]| if w > 0.0 { [u / w, v / w] } else { [0.0; 2] })
}
