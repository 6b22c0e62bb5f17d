//! Variational refinement of a dense flow.
//!
//! Minimises Σ ψ(brightness change) + γ ψ(gradient change) + α ψ(|∇u|² + |∇v|²) with ψ(s²) = √(s² + ε²), in which the
//! picture terms are linearised at the given flow (one warp) and the weights ψ' are refitted between sweeps of
//! successive over-relaxation. Source: Brox, Bruhn, Papenberg & Weickert, "High Accuracy Optical Flow Estimation Based
//! on a Theory for Warping" (2004), eq. 4 and 5; the sweeps are red-black, so that their order is no matter.

use super::Flow;
use super::patches::Level;
use crate::numeric::vector::vectorised;
use crate::scene::Raster;

/// Weight of smoothness (8-bit luma units).
const SMOOTHNESS: f32 = 20.0;
/// Weight of brightness constancy.
const BRIGHTNESS: f32 = 5.0;
/// Weight of gradient constancy.
const GRADIENT: f32 = 10.0;
/// Rounding of ψ at zero.
const EPSILON: f32 = 0.001;
/// Refits of the robust weights.
const OUTER: usize = 5;
/// Relaxation sweeps for each.
const SWEEPS: usize = 5;
/// Over-relaxation.
const RELAXATION: f32 = 1.6;

/// Pixels that are worked on at once.
const LANES: usize = 8;

/// A value of each of some neighbouring pixels.
type Lanes = [f32; LANES];

/// Improves `flow` in place.
pub(super) fn refine(first: &Level, second: &Level, flow: &mut Flow) {
    let (width, height) = (flow.width(), flow.height());
    if width < 3 || height < 3 {
        return;
    }
    vectorised(
        #[inline(always)]
        || improve(first, second, flow, (width, height)),
    );
}

#[inline(always)]
fn improve(first: &Level, second: &Level, flow: &mut Flow, (width, height): (usize, usize)) {
    let terms = Terms::new(first, second, flow);
    let mut moved = Bordered::new(flow);
    for _ in 0..OUTER {
        let equations = equations(&terms, flow, &moved);
        for _ in 0..SWEEPS {
            for colour in 0..2 {
                relax(&equations, flow, &mut moved, colour);
            }
        }
    }
    for y in 0..height {
        flow.row_mut(y).copy_from_slice(&moved.row(y)[1..=width]);
    }
}

/// A flow with a border of one pixel, so that every pixel has four neighbours.
struct Bordered {
    stride: usize,
    data: Vec<[f32; 2]>,
}

impl Bordered {
    fn new(flow: &Flow) -> Self {
        let stride = flow.width() + 2;
        let mut data = vec![[0.0; 2]; stride * (flow.height() + 2)];
        for y in 0..flow.height() {
            data[(y + 1) * stride + 1..][..flow.width()].copy_from_slice(flow.row(y));
        }
        Self { stride, data }
    }

    /// A row of the flow with its border on both sides.
    #[inline(always)]
    fn row(&self, y: usize) -> &[[f32; 2]] {
        &self.data[(y + 1) * self.stride..][..self.stride]
    }
}

/// The equations of a pixel for its change of flow.
#[derive(Clone, Copy, Default)]
struct Equation {
    /// Weights of the links to the right, lower, left and upper neighbour; 0 where there is none.
    links: [f32; 4],
    /// Picture terms: xy, and both right-hand sides.
    cross: f32,
    right: [f32; 2],
    /// Inverse of the diagonal.
    inverse: [f32; 2],
}

/// Brightness, x-gradient and y-gradient change at each pixel in 8-bit units, each linear in the update: value + x du +
/// y dv. Nine planes of one value a pixel, their rows filled up with zeros to whole [`Lanes`].
struct Terms {
    stride: usize,
    planes: [Vec<f32>; 9],
}

impl Terms {
    #[inline(always)]
    fn new(first: &Level, second: &Level, flow: &Flow) -> Self {
        let (width, height) = (flow.width(), flow.height());
        let warped = Raster::from_fn(width, height, |x, y| {
            let [u, v] = flow.get(x, y);
            let (px, py) = (x as f32 + u, y as f32 + v);
            // A shift that leaves the picture has nothing to be compared with.
            let seen = px >= 0.0 && py >= 0.0 && px <= (width - 1) as f32 && py <= (height - 1) as f32;
            let g = super::read(&second.gradient, px, py);
            [255.0 * second.luma_at(px, py), 255.0 * g[0], 255.0 * g[1], f32::from(u8::from(seen))]
        });
        let stride = width.next_multiple_of(LANES);
        let mut planes = [(); 9].map(|()| vec![0.0; stride * height]);
        for y in 0..height {
            for x in (0..width).filter(|&x| warped.get(x, y)[3] != 0.0) {
                for (plane, value) in planes.iter_mut().zip(linearised(first, &warped, (x, y)).as_flattened()) {
                    plane[y * stride + x] = *value;
                }
            }
        }
        Self { stride, planes }
    }

    /// The terms of some pixels of a row, from column `x` on.
    #[inline(always)]
    fn lanes(&self, x: usize, y: usize) -> [[Lanes; 3]; 3] {
        let from = y * self.stride + x;
        let read = |plane: usize| -> Lanes {
            let values = &self.planes[plane][from..from + LANES];
            std::array::from_fn(|v| values[v])
        };
        [0, 3, 6].map(|first| [read(first), read(first + 1), read(first + 2)])
    }
}

/// The terms of one pixel.
#[inline(always)]
fn linearised(first: &Level, warped: &Raster<[f32; 4]>, (x, y): (usize, usize)) -> [[f32; 3]; 3] {
    let (w, xi, yi) = (warped.get(x, y), x as isize, y as isize);
    let slope = |k: usize| {
        let dx = 0.5 * (warped.clamped(xi + 1, yi)[k] - warped.clamped(xi - 1, yi)[k]);
        let dy = 0.5 * (warped.clamped(xi, yi + 1)[k] - warped.clamped(xi, yi - 1)[k]);
        (dx, dy)
    };
    let g = first.gradient.get(x, y);
    let own = [255.0 * first.luma.get(x, y), 255.0 * g[0], 255.0 * g[1]];
    std::array::from_fn(|k| {
        // Brightness has its derivative at hand; averaged with the first picture's it is second-order exact.
        let (dx, dy) = if k == 0 { (0.5 * (w[1] + own[1]), 0.5 * (w[2] + own[2])) } else { slope(k) };
        [w[k] - own[k], dx, dy]
    })
}

/// The equations of all pixels, their robust weights those of the flow so far.
#[inline(always)]
fn equations(terms: &Terms, flow: &Flow, moved: &Bordered) -> Raster<Equation> {
    let (width, height) = (flow.width(), flow.height());
    let links = link_weights(moved, width, height);
    let mut equations = Raster::new(width, height, Equation::default());
    for y in 0..height {
        for x in (0..width).step_by(LANES) {
            let count = LANES.min(width - x);
            let (mut change, mut weight) = ([[0.0; LANES]; 2], [0.0; LANES]);
            let mut around = [[0.0; 4]; LANES];
            for v in 0..count {
                let (from, to) = (flow.get(x + v, y), moved.row(y)[x + v + 1]);
                (change[0][v], change[1][v]) = (to[0] - from[0], to[1] - from[1]);
                let [right, below] = links.get(x + v, y);
                let left = if x + v > 0 { links.get(x + v - 1, y)[0] } else { 0.0 };
                let above = if y > 0 { links.get(x + v, y - 1)[1] } else { 0.0 };
                around[v] = [right, below, left, above];
                weight[v] = right + below + left + above;
            }
            let [xx, cross, yy, bx, by] = normal_equations(&terms.lanes(x, y), &change);
            let inverse = [xx, yy].map(|own| -> Lanes { std::array::from_fn(|v| 1.0 / (own[v] + weight[v])) });
            for (v, equation) in equations.row_mut(y)[x..x + count].iter_mut().enumerate() {
                let inverse = inverse.map(|inverse| inverse[v]);
                *equation = Equation { links: around[v], cross: cross[v], right: [bx[v], by[v]], inverse };
            }
        }
    }
    equations
}

/// Robustly weighted normal equations of some pixels: xx, xy, yy, bx, by.
#[inline(always)]
fn normal_equations(terms: &[[Lanes; 3]; 3], [du, dv]: &[Lanes; 2]) -> [Lanes; 5] {
    let mut sums = [[0.0; LANES]; 5];
    let robust = |square: f32| 1.0 / (square + EPSILON * EPSILON).sqrt();
    let square = |v: f32| v * v;
    for v in 0..LANES {
        let [brightness, gx, gy] = terms.each_ref().map(|term| term.each_ref().map(|part| part[v]));
        let rest = |l: [f32; 3]| l[0] + l[1] * du[v] + l[2] * dv[v];
        // Divided by the slope, a change counts as a distance: strong edges do not outweigh weak ones (Zimmer 2011).
        let flat = |l: [f32; 3]| 1.0 / (l[1] * l[1] + l[2] * l[2] + 0.01);
        let (nb, nx, ny) = (flat(brightness), flat(gx), flat(gy));
        let wb = BRIGHTNESS * nb * robust(nb * square(rest(brightness)));
        let wg = GRADIENT * robust(nx * square(rest(gx)) + ny * square(rest(gy)));
        for (l, w) in [(brightness, wb), (gx, wg * nx), (gy, wg * ny)] {
            for (sum, add) in sums.iter_mut().zip([l[1] * l[1], l[1] * l[2], l[2] * l[2], l[0] * l[1], l[0] * l[2]]) {
                sum[v] += w * add;
            }
        }
    }
    sums
}

/// Weight of the smoothness link of each pixel to its right and to its lower neighbour.
#[inline(always)]
fn link_weights(moved: &Bordered, width: usize, height: usize) -> Raster<[f32; 2]> {
    let mut diffusivity = Raster::new(width, height, 0.0f32);
    for y in 0..height {
        let (here, below) = (&moved.row(y)[1..], &moved.row((y + 1).min(height - 1))[1..]);
        for x in (0..width).step_by(LANES) {
            let count = LANES.min(width - x);
            let mut squares = [0.0; LANES];
            for (v, sum) in squares[..count].iter_mut().enumerate() {
                let (x, right) = (x + v, (x + v + 1).min(width - 1));
                let square = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
                *sum = square(here[x], here[right]) + square(here[x], below[x]);
            }
            let weights = squares.map(|square: f32| SMOOTHNESS / (square + EPSILON * EPSILON).sqrt());
            diffusivity.row_mut(y)[x..x + count].copy_from_slice(&weights[..count]);
        }
    }
    Raster::from_fn(width, height, |x, y| {
        let half = |x2: usize, y2: usize| 0.5 * (diffusivity.get(x, y) + diffusivity.get(x2, y2));
        [if x + 1 < width { half(x + 1, y) } else { 0.0 }, if y + 1 < height { half(x, y + 1) } else { 0.0 }]
    })
}

/// One relaxation of the pixels of a chequerboard's colour.
#[inline(always)]
fn relax(equations: &Raster<Equation>, flow: &Flow, moved: &mut Bordered, colour: usize) {
    let (width, height, stride) = (flow.width(), flow.height(), moved.stride);
    for y in 0..height {
        let (equations, from) = (equations.row(y), flow.row(y));
        let rows = &mut moved.data[y * stride..][..3 * stride];
        for x in ((y + colour) % 2..width).step_by(2) {
            let Equation { links, cross, right, inverse } = equations[x];
            let (here, at) = (from[x], stride + x + 1);
            let mut pull = [-right[0], -right[1]];
            for (w, neighbour) in links.into_iter().zip([at + 1, at + stride, at - 1, at - stride]) {
                pull[0] += w * (rows[neighbour][0] - here[0]);
                pull[1] += w * (rows[neighbour][1] - here[1]);
            }
            let [du, dv] = [rows[at][0] - here[0], rows[at][1] - here[1]];
            let du = du + RELAXATION * ((pull[0] - cross * dv) * inverse[0] - du);
            let dv = dv + RELAXATION * ((pull[1] - cross * du) * inverse[1] - dv);
            rows[at] = [here[0] + du, here[1] + dv];
        }
    }
}
