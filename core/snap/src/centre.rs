//! The centre of an ink line, half-way between its two edges.
//!
//! The valley of the luma lies off the centre where the flats on the two sides differ, by more than half a pixel for thin
//! outlines between a dark and a light colour (Steger 1998 analyses this bias). Edges are found in the channel that
//! shows them best, and what pushes one outwards pushes the other too: their middle stays.

use super::cost::{Feature, Features, Kind};
use rototoon_base::geometry::Point;

/// Farthest edge from the valley, in pixels at 540 lines: half the width of the widest line, and what the valley errs.
const REACH: f64 = 4.0;

/// How far the valley may lie beyond the ink's true edge, in pixels.
const VALLEY_ERROR: f64 = 1.0;

/// Least cosine between the line's normal and a flank's gradient.
const PARALLEL: f64 = 0.7;

/// Sub-pixel centre of the ink in the pixel (`x`, `y`), whose line feature is `line`; `None` where an edge is missing.
pub(super) fn ink_centre(features: &Features, line: Feature, x: usize, y: usize) -> Option<Point> {
    let valley = line.place(x, y)?;
    let normal = line.normal();
    let flanks = (flank(features, valley, normal), flank(features, valley, -normal));
    let (Some(ahead), Some(behind)) = flanks else { return None };
    Some(valley + normal * (0.5 * (ahead - behind)))
}

/// Distance along `direction` from `from` to the first edge that brightens that way.
fn flank(features: &Features, from: Point, direction: Point) -> Option<f64> {
    let (width, height) = features.size();
    let reach = REACH * features.scale().min(2.0);
    let mut t = -VALLEY_ERROR;
    while t <= reach {
        let p = from + direction * t;
        if p.x < 0.0 || p.y < 0.0 || p.x >= width as f64 || p.y >= height as f64 {
            return None;
        }
        let (x, y) = (p.x as usize, p.y as usize);
        let edge = features.get(Kind::Edge, x, y);
        // A ray may slip diagonally through a chain of pixels with a zero crossing; gradient maxima are thicker.
        if let (true, Some(place)) = (edge.normal().dot(direction) >= PARALLEL, edge.place(x, y)) {
            return Some((place - from).dot(direction));
        }
        t += 0.5;
    }
    None
}
