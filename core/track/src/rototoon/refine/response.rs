//! How badly a sample's templates fit at each displacement of a window.
//!
//! The cost of key k is C_k = Σ w c / Σ w over the offsets of its template, where c = r / (r + σ²) and r is the squared
//! colour difference. C is the smaller of the two costs, of those keys that show enough of the sample's inside.
//!
//! Two kinds of offsets have other costs. An offset under a nearer part costs a constant. Outside the part the
//! background may have changed since the key: any other colour costs at most a small constant. But the part's own
//! colour costs more the more similar it is (1 − c of the difference from that colour), because it appears there if the
//! contour has slipped inwards.

use super::template::{Cell, Grain, HALF, Template, offsets};
use super::view::Frame;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::lanes::{LANES, Lanes};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Colour;

/// σ² of the robust colour difference (three channels of 0 to 1).
const TOLERANCE: f32 = 0.06;
/// Cost of an offset under a nearer part.
const HIDDEN: f32 = 0.35;
/// Largest cost of an offset outside the part, if the background has changed and is not like the part.
const OTHER_GROUND: f32 = 0.15;
/// Share of a sample's inside that a key must show to be used.
const SHOWN: f64 = 0.35;

/// A window of displacements along tangent and normal, in steps of the templates.
pub struct Window {
    /// Largest displacement along tangent and normal.
    pub reach: [i32; 2],
}

/// Costs over a window of displacements.
pub struct Map {
    /// Largest displacement along tangent and normal, in steps.
    pub reach: [i32; 2],
    /// Working pixels per step.
    pub step: f64,
    /// Costs at each step. The displacement along the normal is the inner index.
    pub costs: Vec<f32>,
    /// How much of the sample the keys show, 0 to 1: twice the larger visible share, at most 1.
    pub shown: f64,
}

/// The picture under the window and the templates around it.
struct Seen {
    /// Planes with one value per place: red, green, blue, and 1 where a nearer part hides the place, otherwise 0. The
    /// normal is the inner index.
    planes: [Vec<f32>; 4],
    any_hidden: bool,
    stride: usize,
}

/// The costs of a sample at a place with a unit tangent. If no key shows enough of the sample, both keys are used.
pub fn map(
    frame: &Frame,
    window: &Window,
    (place, tangent): (Point, Point),
    (templates, grain): ([&Template; 2], Grain),
) -> Map {
    let [rows, columns] = window.reach.map(|reach| 2 * reach as usize + 1);
    let padded = columns.next_multiple_of(LANES);
    let seen = vectorised(
        #[inline(always)]
        || seen(frame, (window, grain), (place, tangent), padded - columns),
    );
    let serves = templates.map(|t| t.shown > SHOWN && t.weight > 0.0);
    let used = (0..2).filter(|&k| serves[k] || serves == [false, false]).map(|k| templates[k]);
    let mut costs = vec![1.0f32; rows * columns];
    let mut sums = vec![Lanes::splat(0.0); rows * padded / LANES];
    for template in used {
        sums.fill(Lanes::splat(0.0));
        vectorised(
            #[inline(always)]
            || add_costs(template, &seen, &mut sums, padded / LANES),
        );
        let scale = 1.0 / template.weight.max(1e-6);
        for (row, sums) in costs.chunks_exact_mut(columns).zip(sums.chunks_exact(padded / LANES)) {
            for (costs, sums) in row.chunks_mut(LANES).zip(sums) {
                for (v, cost) in costs.iter_mut().enumerate() {
                    *cost = cost.min(sums.get(v) * scale);
                }
            }
        }
    }
    let shown = templates.iter().map(|t| t.shown).fold(0.0, f64::max);
    Map { reach: window.reach, step: grain.step, costs, shown: (2.0 * shown).min(1.0) }
}

/// Reads the picture at every place that an offset of a template can reach, and `padding` places beyond.
#[inline(always)]
fn seen(frame: &Frame, (window, grain): (&Window, Grain), (place, tangent): (Point, Point), padding: usize) -> Seen {
    let size = [0, 1].map(|axis: usize| 2 * (window.reach[axis] + HALF[axis]) as usize + 1);
    let stride = size[1] + padding;
    let level = frame.picture.level(grain.level);
    let empty = || vec![0.0f32; size[0] * stride];
    let mut planes = [empty(), empty(), empty(), empty()];
    let [red, green, blue, hidden] = &mut planes;
    let mut any_hidden = false;
    let corner = [0, 1].map(|axis: usize| -f64::from(window.reach[axis] + HALF[axis]));
    let tangent = tangent * grain.step;
    let normal = tangent.perp();
    for a in 0..size[0] {
        let first = place + tangent * (corner[0] + a as f64) + normal * corner[1];
        let row = a * stride..a * stride + size[1];
        level.colours_along(first, normal, [&mut red[row.clone()], &mut green[row.clone()], &mut blue[row.clone()]]);
        for (b, hidden) in hidden[row].iter_mut().enumerate() {
            if frame.cover.hides(first + normal * b as f64) {
                *hidden = 1.0;
                any_hidden = true;
            }
        }
    }
    Seen { planes, any_hidden, stride }
}

/// Adds the weighted cost of each of the template's offsets at all displacements. A row has `lanes` groups.
#[inline(always)]
fn add_costs(template: &Template, seen: &Seen, sums: &mut [Lanes], lanes: usize) {
    let mut cells = template.cells.iter();
    for a in offsets(0) {
        for b in offsets(1) {
            let Some(cell) = cells.next() else { return };
            let corner = (a + HALF[0]) as usize * seen.stride + (b + HALF[1]) as usize;
            for (u, row) in sums.chunks_exact_mut(lanes).enumerate() {
                for (group, sum) in row.iter_mut().enumerate() {
                    let at = corner + u * seen.stride + group * LANES;
                    *sum = Lanes::splat(cell.weight).mul_add(seen.cost(cell, at), *sum);
                }
            }
        }
    }
}

impl Seen {
    /// Cost of an offset at several displacements. `at` is its index in the planes at the first of them.
    #[inline(always)]
    fn cost(&self, cell: &Cell, at: usize) -> Lanes {
        let [r, g, b, hidden] = &self.planes;
        let colour = [Lanes::read(&r[at..]), Lanes::read(&g[at..]), Lanes::read(&b[at..])];
        let mut cost = wrong(&colour, &cell.colour);
        if let Some(own) = &cell.own {
            let inwards = Lanes::splat(1.0) - wrong(&colour, own);
            cost = cost.min(Lanes::splat(OTHER_GROUND).max(inwards));
        }
        if !self.any_hidden {
            return cost;
        }
        Lanes::read(&hidden[at..]).mul_add(Lanes::splat(HIDDEN) - cost, cost)
    }
}

/// Robust difference of some colours from one colour, 0 to 1.
#[inline(always)]
fn wrong([r, g, b]: &[Lanes; 3], colour: &Colour) -> Lanes {
    let (r, g, b) = (*r - Lanes::splat(colour[0]), *g - Lanes::splat(colour[1]), *b - Lanes::splat(colour[2]));
    let square = r.mul_add(r, g.mul_add(g, b * b));
    square / (square + Lanes::splat(TOLERANCE))
}
