//! Patches that search their place in the second picture, and the dense field blended from them.

use super::{Flow, read};
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
    gradient: [[f32; 2]; PATCH * PATCH],
    inverse: [f32; 3],
}

impl Patch {
    fn new(level: &Level, x: usize, y: usize) -> Self {
        let at = |k: usize| ((x + k % PATCH) as isize, (y + k / PATCH) as isize);
        let mut luma: [f32; PATCH * PATCH] = std::array::from_fn(|k| level.luma.clamped(at(k).0, at(k).1));
        let mut gradient: [[f32; 2]; PATCH * PATCH] = std::array::from_fn(|k| level.gradient.clamped(at(k).0, at(k).1));
        let count = (PATCH * PATCH) as f32;
        let mean = luma.iter().sum::<f32>() / count;
        luma.iter_mut().for_each(|v| *v -= mean);
        // Differences of mean-free patches have mean-free derivatives.
        for axis in 0..2 {
            let mean = gradient.iter().map(|g| g[axis]).sum::<f32>() / count;
            gradient.iter_mut().for_each(|g| g[axis] -= mean);
        }
        let moment = |a: usize, b: usize| gradient.iter().map(|g| g[a] * g[b]).sum::<f32>();
        // The ridge (of a contrast of one grey step in 8 bits) keeps flat patches where they are.
        let ridge = count * (1.0 / 255.0f32).powi(2);
        let (xx, xy, yy) = (moment(0, 0) + ridge, moment(0, 1), moment(1, 1) + ridge);
        let determinant = xx * yy - xy * xy;
        Self { x, y, luma, gradient, inverse: [yy / determinant, -xy / determinant, xx / determinant] }
    }

    /// The difference to the second picture at shift `u`, without its mean, and its mean square.
    fn difference(&self, second: &Level, u: [f32; 2]) -> ([f32; PATCH * PATCH], f32) {
        let mut d: [f32; PATCH * PATCH] = std::array::from_fn(|k| {
            second.luma_at((self.x + k % PATCH) as f32 + u[0], (self.y + k / PATCH) as f32 + u[1])
        });
        let count = (PATCH * PATCH) as f32;
        let mean = d.iter().sum::<f32>() / count;
        for (v, own) in d.iter_mut().zip(&self.luma) {
            *v -= mean + own;
        }
        let square = d.iter().map(|v| v * v).sum::<f32>() / count;
        (d, square)
    }

    /// Gradient descent on the mean square difference, with the derivatives of the first picture (inverse search).
    fn descend(&self, second: &Level, start: [f32; 2]) -> [f32; 2] {
        let mut u = start;
        let mut best = (f32::INFINITY, start);
        for _ in 0..STEPS {
            let (d, square) = self.difference(second, u);
            if square >= best.0 {
                break;
            }
            best = (square, u);
            let bx: f32 = d.iter().zip(&self.gradient).map(|(v, g)| v * g[0]).sum();
            let by: f32 = d.iter().zip(&self.gradient).map(|(v, g)| v * g[1]).sum();
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
    sweep(&patches, second, &mut shifts, columns.len(), false);
    sweep(&patches, second, &mut shifts, columns.len(), true);
    blend(first, second, &patches, &shifts)
}

/// Top-left corners of the patches along one side: they reach over the far edge, so that each pixel is covered.
fn grid(count: usize) -> Vec<usize> {
    (0..count.saturating_sub(PATCH - STRIDE).max(1)).step_by(STRIDE).collect()
}

/// One pass over the patches in reading order (or from the end): each starts from its own shift or that of the two
/// neighbours passed before, whichever fits best, and descends.
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
        for y in patch.y..(patch.y + PATCH).min(height) {
            for x in patch.x..(patch.x + PATCH).min(width) {
                let there = second.luma_at(x as f32 + u[0], y as f32 + u[1]);
                let weight = 1.0 / (255.0 * (there - first.luma.get(x, y)).abs()).max(1.0);
                let [su, sv, sw] = sums.get(x, y);
                sums.set(x, y, [su + weight * u[0], sv + weight * u[1], sw + weight]);
            }
        }
    }
    sums.map(|[u, v, w]| if w > 0.0 { [u / w, v / w] } else { [0.0; 2] })
}
