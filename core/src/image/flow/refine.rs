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

/// A linearised picture term at a pixel: value + x du + y dv.
type Linear = [f32; 3];

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
    let terms = linearise(first, second, flow);
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
#[derive(Clone, Copy)]
struct Equation {
    /// Weights of the links to the right, lower, left and upper neighbour; 0 where there is none.
    links: [f32; 4],
    /// Picture terms: xy, and both right-hand sides.
    cross: f32,
    right: [f32; 2],
    /// Inverse of the diagonal.
    inverse: [f32; 2],
}

/// Brightness, x-gradient and y-gradient change at each pixel, linear in the update, in 8-bit units.
#[inline(always)]
fn linearise(first: &Level, second: &Level, flow: &Flow) -> Raster<[Linear; 3]> {
    let (width, height) = (flow.width(), flow.height());
    let warped = Raster::from_fn(width, height, |x, y| {
        let [u, v] = flow.get(x, y);
        let (px, py) = (x as f32 + u, y as f32 + v);
        // A shift that leaves the picture has nothing to be compared with.
        let seen = px >= 0.0 && py >= 0.0 && px <= (width - 1) as f32 && py <= (height - 1) as f32;
        let g = super::read(&second.gradient, px, py);
        [255.0 * second.luma_at(px, py), 255.0 * g[0], 255.0 * g[1], f32::from(u8::from(seen))]
    });
    Raster::from_fn(width, height, |x, y| {
        let w = warped.get(x, y);
        if w[3] == 0.0 {
            return [[0.0; 3]; 3];
        }
        let (xi, yi) = (x as isize, y as isize);
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
    })
}

/// The equations of all pixels, their robust weights those of the flow so far.
#[inline(always)]
fn equations(terms: &Raster<[Linear; 3]>, flow: &Flow, moved: &Bordered) -> Raster<Equation> {
    let links = link_weights(moved, flow.width(), flow.height());
    Raster::from_fn(flow.width(), flow.height(), |x, y| {
        let (from, to) = (flow.get(x, y), moved.row(y)[x + 1]);
        let [xx, cross, yy, bx, by] = normal_equations(terms.get(x, y), [to[0] - from[0], to[1] - from[1]]);
        let [right, below] = links.get(x, y);
        let left = if x > 0 { links.get(x - 1, y)[0] } else { 0.0 };
        let above = if y > 0 { links.get(x, y - 1)[1] } else { 0.0 };
        let weight = right + below + left + above;
        let inverse = [1.0 / (xx + weight), 1.0 / (yy + weight)];
        Equation { links: [right, below, left, above], cross, right: [bx, by], inverse }
    })
}

/// Robustly weighted normal equations of a pixel: xx, xy, yy, bx, by.
#[inline(always)]
fn normal_equations([brightness, gx, gy]: [Linear; 3], [du, dv]: [f32; 2]) -> [f32; 5] {
    let rest = |l: Linear| l[0] + l[1] * du + l[2] * dv;
    let robust = |square: f32| 1.0 / (square + EPSILON * EPSILON).sqrt();
    // Divided by the slope, a change counts as a distance: strong edges do not outweigh weak ones (Zimmer 2011).
    let flat = |l: Linear| 1.0 / (l[1] * l[1] + l[2] * l[2] + 0.01);
    let (nb, nx, ny) = (flat(brightness), flat(gx), flat(gy));
    let square = |v: f32| v * v;
    let wb = BRIGHTNESS * nb * robust(nb * square(rest(brightness)));
    let wg = GRADIENT * robust(nx * square(rest(gx)) + ny * square(rest(gy)));
    let mut sum = [0.0f32; 5];
    for (l, w) in [(brightness, wb), (gx, wg * nx), (gy, wg * ny)] {
        for (total, add) in sum.iter_mut().zip([l[1] * l[1], l[1] * l[2], l[2] * l[2], l[0] * l[1], l[0] * l[2]]) {
            *total += w * add;
        }
    }
    sum
}

/// Weight of the smoothness link of each pixel to its right and to its lower neighbour.
#[inline(always)]
fn link_weights(moved: &Bordered, width: usize, height: usize) -> Raster<[f32; 2]> {
    let at = |x: usize, y: usize| moved.row(y)[x + 1];
    let diffusivity = Raster::from_fn(width, height, |x, y| {
        let (here, right, below) = (at(x, y), at((x + 1).min(width - 1), y), at(x, (y + 1).min(height - 1)));
        let square = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
        SMOOTHNESS / (square(here, right) + square(here, below) + EPSILON * EPSILON).sqrt()
    });
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
