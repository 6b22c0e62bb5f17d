//! Variational refinement of a dense flow.
//!
//! Minimises Σ ψ(brightness change) + γ ψ(gradient change) + α ψ(|∇u|² + |∇v|²) with ψ(s²) = √(s² + ε²), in which the
//! picture terms are linearised at the given flow (one warp) and the weights ψ' are refitted between sweeps of
//! successive over-relaxation. Source: Brox, Bruhn, Papenberg & Weickert, "High Accuracy Optical Flow Estimation Based
//! on a Theory for Warping" (2004), eq. 4 and 5; the sweeps are red-black, so that their order is no matter.

use super::Flow;
use super::patches::Level;
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
    let terms = linearise(first, second, flow);
    let mut update = Raster::new(width, height, [0.0f32; 2]);
    for _ in 0..OUTER {
        let system = normal_equations(&terms, &update);
        let links = link_weights(flow, &update);
        for _ in 0..SWEEPS {
            for colour in 0..2 {
                relax(&system, &links, flow, &mut update, colour);
            }
        }
    }
    for (u, du) in flow.data_mut().iter_mut().zip(update.data()) {
        *u = [u[0] + du[0], u[1] + du[1]];
    }
}

/// Brightness, x-gradient and y-gradient change at each pixel, linear in the update, in 8-bit units.
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

/// Robustly weighted normal equations of each pixel: xx, xy, yy, bx, by.
fn normal_equations(terms: &Raster<[Linear; 3]>, update: &Flow) -> Raster<[f32; 5]> {
    Raster::from_fn(terms.width(), terms.height(), |x, y| {
        let [du, dv] = update.get(x, y);
        let [brightness, gx, gy] = terms.get(x, y);
        let rest = |l: Linear| l[0] + l[1] * du + l[2] * dv;
        let robust = |square: f32| 1.0 / (square + EPSILON * EPSILON).sqrt();
        // Divided by the slope, a change counts as a distance: strong edges do not outweigh weak ones (Zimmer 2011).
        let flat = |l: Linear| 1.0 / (l[1] * l[1] + l[2] * l[2] + 0.01);
        let (nb, nx, ny) = (flat(brightness), flat(gx), flat(gy));
        let wb = BRIGHTNESS * nb * robust(nb * rest(brightness).powi(2));
        let wg = GRADIENT * robust(nx * rest(gx).powi(2) + ny * rest(gy).powi(2));
        let mut sum = [0.0f32; 5];
        for (l, w) in [(brightness, wb), (gx, wg * nx), (gy, wg * ny)] {
            for (total, add) in sum.iter_mut().zip([l[1] * l[1], l[1] * l[2], l[2] * l[2], l[0] * l[1], l[0] * l[2]]) {
                *total += w * add;
            }
        }
        sum
    })
}

/// Weight of the smoothness link of each pixel to its right and to its lower neighbour.
fn link_weights(flow: &Flow, update: &Flow) -> Raster<[f32; 2]> {
    let (width, height) = (flow.width(), flow.height());
    let at = |x: usize, y: usize| {
        let (u, du) = (flow.get(x, y), update.get(x, y));
        [u[0] + du[0], u[1] + du[1]]
    };
    let diffusivity = Raster::from_fn(width, height, |x, y| {
        let (here, right, below) = (at(x, y), at((x + 1).min(width - 1), y), at(x, (y + 1).min(height - 1)));
        let square = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
        SMOOTHNESS / (square(here, right) + square(here, below) + EPSILON * EPSILON).sqrt()
    });
    Raster::from_fn(width, height, |x, y| {
        let half = |x2: usize, y2: usize| 0.5 * (diffusivity.get(x, y) + diffusivity.get(x2, y2));
        [if x + 1 < width { half(x + 1, y) } else { 0.0 }, if y + 1 < height { half(x, y + 1) } else { 0.0 }]
    })
}

/// One relaxation of the pixels of a chequerboard's colour.
fn relax(system: &Raster<[f32; 5]>, links: &Raster<[f32; 2]>, flow: &Flow, update: &mut Flow, colour: usize) {
    let (width, height) = (flow.width(), flow.height());
    for y in 0..height {
        for x in ((y + colour) % 2..width).step_by(2) {
            let here = flow.get(x, y);
            let mut weight = 0.0;
            let mut pull = [0.0f32; 2];
            let mut link = |w: f32, x2: usize, y2: usize| {
                let (u, du) = (flow.get(x2, y2), update.get(x2, y2));
                weight += w;
                pull[0] += w * (u[0] + du[0] - here[0]);
                pull[1] += w * (u[1] + du[1] - here[1]);
            };
            let own = links.get(x, y);
            if x + 1 < width {
                link(own[0], x + 1, y);
            }
            if y + 1 < height {
                link(own[1], x, y + 1);
            }
            if x > 0 {
                link(links.get(x - 1, y)[0], x - 1, y);
            }
            if y > 0 {
                link(links.get(x, y - 1)[1], x, y - 1);
            }
            let [xx, xy, yy, bx, by] = system.get(x, y);
            let [du, dv] = update.get(x, y);
            let new_u = (pull[0] - bx - xy * dv) / (xx + weight);
            let du = du + RELAXATION * (new_u - du);
            let new_v = (pull[1] - by - xy * du) / (yy + weight);
            update.set(x, y, [du, dv + RELAXATION * (new_v - dv)]);
        }
    }
}
