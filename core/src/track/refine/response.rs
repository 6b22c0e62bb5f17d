//! How badly a sample's templates fit at each displacement of a window.
//!
//! C_k = Σ w r / (r + σ²) / Σ w over the template's offsets, r the squared colour difference; an offset under a nearer
//! part costs a constant; C = min over the keys that show enough of the sample's inside.

use super::Frame;
use super::template::{HALF, LEVEL, Template, offsets};
use crate::geometry::Point;
use crate::scene::Colour;

/// σ² of the robust colour difference (three channels of 0 to 1).
const TOLERANCE: f32 = 0.06;
/// Cost of an offset that a nearer part hides.
const HIDDEN: f32 = 0.35;
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

/// The costs of a sample at a place with a unit tangent.
pub fn map(frame: &Frame, window: &Window, (place, tangent): (Point, Point), templates: [&Template; 2]) -> Map {
    let size = [0, 1].map(|axis: usize| 2 * (window.reach[axis] + HALF[axis]) + 1);
    let level = frame.picture.level(LEVEL);
    let mut seen: Vec<(Colour, bool)> = Vec::with_capacity((size[0] * size[1]) as usize);
    for a in 0..size[0] {
        for b in 0..size[1] {
            let offset = [a - window.reach[0] - HALF[0], b - window.reach[1] - HALF[1]];
            let p = place + tangent.rotate(Point::new(f64::from(offset[0]), f64::from(offset[1])));
            seen.push((level.colour(p), frame.cover.hides(p)));
        }
    }
    let serves = templates.map(|t| t.shown > SHOWN && t.weight > 0.0);
    let used: Vec<&Template> =
        (0..2).filter(|&k| serves[k] || serves == [false, false]).map(|k| templates[k]).collect();
    let mut costs = Vec::with_capacity(((2 * window.reach[0] + 1) * (2 * window.reach[1] + 1)) as usize);
    for u in 0..=2 * window.reach[0] {
        for v in 0..=2 * window.reach[1] {
            let cost = |t: &&Template| cost_at(t, &seen, size[1] as usize, (u + HALF[0], v + HALF[1]));
            costs.push(used.iter().map(cost).fold(1.0, f32::min));
        }
    }
    let shown = templates.iter().map(|t| t.shown).fold(0.0, f64::max);
    Map { reach: window.reach, costs, shown: (2.0 * shown).min(1.0) }
}

fn cost_at(template: &Template, seen: &[(Colour, bool)], stride: usize, (u, v): (i32, i32)) -> f32 {
    let mut sum = 0.0;
    let mut cells = template.cells.iter();
    for a in offsets(0) {
        let row = (u + a) as usize * stride;
        for (b, (key, weight)) in offsets(1).zip(&mut cells) {
            let (colour, hidden) = &seen[row + (v + b) as usize];
            let r: f32 = (0..3).map(|k| (colour[k] - key[k]) * (colour[k] - key[k])).sum();
            sum += weight * if *hidden { HIDDEN } else { r / (r + TOLERANCE) };
        }
    }
    sum / template.weight.max(1e-6)
}
