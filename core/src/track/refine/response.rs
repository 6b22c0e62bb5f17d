//! How badly a sample's templates fit at each displacement of a window.
//!
//! C_k = Σ w c / Σ w over the template's offsets, c = r / (r + σ²), r the squared colour difference; C = min over the keys
//! that show enough of the sample's inside. An offset under a nearer part costs a constant. Outside the part the ground may
//! have changed since the key: any other colour costs a little at the most, but the part's own colour as much as it is
//! like it (1 − c of the difference from that), since a contour that has slid inwards shows just that.

use super::Frame;
use super::template::{HALF, LEVEL, Template, offsets};
use crate::geometry::Point;
use crate::numeric::vector::vectorised;
use crate::scene::Colour;

/// σ² of the robust colour difference (three channels of 0 to 1).
const TOLERANCE: f32 = 0.06;
/// Cost of an offset that a nearer part hides.
const HIDDEN: f32 = 0.35;
/// Cost, at the most, of an offset outside the part whose ground has changed and is not like the part.
const OTHER_GROUND: f32 = 0.15;
/// Share of a sample's inside that a key must show.
const SHOWN: f64 = 0.35;

/// A window of displacements, in working pixels along tangent and normal.
pub struct Window {
    /// Largest displacement.
    pub reach: [i32; 2],
}

/// Costs over a window.
pub struct Map {
    /// Largest displacement along tangent and normal.
    pub reach: [i32; 2],
    /// Costs, those along the normal innermost.
    pub costs: Vec<f32>,
    /// How much of the sample the keys show: 0 to 1.
    pub shown: f64,
}

/// Displacements that are worked on at once; rows of a window are padded to a multiple of it.
const LANES: usize = 8;

/// What the window and the templates around it show.
struct Seen {
    /// Planes of one value a place, along the normal innermost: red, green, blue, and 1 where a nearer part hides the
    /// place, else 0.
    planes: [Vec<f32>; 4],
    stride: usize,
}

/// The costs of a sample at a place with a unit tangent.
pub fn map(frame: &Frame, window: &Window, (place, tangent): (Point, Point), templates: [&Template; 2]) -> Map {
    let [rows, columns] = window.reach.map(|reach| 2 * reach as usize + 1);
    let padded = columns.next_multiple_of(LANES);
    let seen = vectorised(
        #[inline(always)]
        || seen(frame, window, (place, tangent), padded - columns),
    );
    let serves = templates.map(|t| t.shown > SHOWN && t.weight > 0.0);
    let used = (0..2).filter(|&k| serves[k] || serves == [false, false]).map(|k| templates[k]);
    let mut costs = vec![1.0f32; rows * columns];
    let mut sums = vec![[0.0f32; LANES]; rows * padded / LANES];
    for template in used {
        sums.fill([0.0; LANES]);
        vectorised(
            #[inline(always)]
            || add_costs(template, &seen, &mut sums, padded / LANES),
        );
        let scale = 1.0 / template.weight.max(1e-6);
        for (row, sums) in costs.chunks_exact_mut(columns).zip(sums.chunks_exact(padded / LANES)) {
            for (cost, sum) in row.iter_mut().zip(sums.as_flattened()) {
                *cost = cost.min(sum * scale);
            }
        }
    }
    let shown = templates.iter().map(|t| t.shown).fold(0.0, f64::max);
    Map { reach: window.reach, costs, shown: (2.0 * shown).min(1.0) }
}

/// Reads the picture wherever an offset of a template may come to lie, and `padding` places beyond.
#[inline(always)]
fn seen(frame: &Frame, window: &Window, (place, tangent): (Point, Point), padding: usize) -> Seen {
    let size = [0, 1].map(|axis: usize| 2 * (window.reach[axis] + HALF[axis]) as usize + 1);
    let stride = size[1] + padding;
    let level = frame.picture.level(LEVEL);
    let empty = || vec![0.0f32; size[0] * stride];
    let mut seen = Seen { planes: [empty(), empty(), empty(), empty()], stride };
    for a in 0..size[0] {
        for b in 0..size[1] {
            let offset = [a as i32 - window.reach[0] - HALF[0], b as i32 - window.reach[1] - HALF[1]];
            let p = place + tangent.rotate(Point::new(f64::from(offset[0]), f64::from(offset[1])));
            let at = a * stride + b;
            // A colour's fourth value is zero.
            let mut values = level.colour(p);
            values.w += f32::from(u8::from(frame.cover.hides(p)));
            (0..4).for_each(|k| seen.planes[k][at] = values[k]);
        }
    }
    seen
}

/// Adds the weighted cost of each of the template's offsets at all displacements, `lanes` groups a row.
#[inline(always)]
fn add_costs(template: &Template, seen: &Seen, sums: &mut [[f32; LANES]], lanes: usize) {
    let cells = offsets(0).flat_map(|a| offsets(1).map(move |b| (a, b)));
    for ((a, b), cell) in cells.zip(&template.cells) {
        let corner = (a + HALF[0]) as usize * seen.stride + (b + HALF[1]) as usize;
        match &cell.own {
            None => add_cell(seen, corner, cell.weight, sums, lanes, |colour| wrong(colour, &cell.colour)),
            Some(own) => add_cell(seen, corner, cell.weight, sums, lanes, |colour| {
                wrong(colour, &cell.colour).min(OTHER_GROUND.max(1.0 - wrong(colour, own)))
            }),
        }
    }
}

/// Adds the weighted cost of one offset at all displacements; `corner` is the place in the planes at the first of them.
#[inline(always)]
fn add_cell(
    seen: &Seen,
    corner: usize,
    weight: f32,
    sums: &mut [[f32; LANES]],
    lanes: usize,
    cost: impl Fn(Colour) -> f32,
) {
    for (u, row) in sums.chunks_exact_mut(lanes).enumerate() {
        let from = corner + u * seen.stride;
        for (group, sums) in row.iter_mut().enumerate() {
            let from = from + group * LANES;
            let read = |plane: &[f32]| -> [f32; LANES] { std::array::from_fn(|v| plane[from..from + LANES][v]) };
            let [r, g, b, hidden] = seen.planes.each_ref().map(|plane| read(plane));
            let cost: [f32; LANES] = std::array::from_fn(|v| {
                let cost = cost([r[v], g[v], b[v]]);
                hidden[v].mul_add(HIDDEN - cost, cost)
            });
            for (sum, cost) in sums.iter_mut().zip(cost) {
                *sum = weight.mul_add(cost, *sum);
            }
        }
    }
}

/// Robust difference of two colours, 0 to 1.
#[inline(always)]
fn wrong(a: Colour, b: &Colour) -> f32 {
    let [r, g, b]: Colour = std::array::from_fn(|k| a[k] - b[k]);
    let square = r.mul_add(r, g.mul_add(g, b * b));
    square / (square + TOLERANCE)
}
