//! The centre of an ink line, half-way between its two edges.
//!
//! The line detector of `cost` finds the valley of the luma. Where the two sides of a line have different colours, this
//! valley is not the centre of the ink. For a thin outline between a dark and a light colour it is off by more than
//! half a pixel (Steger 1998 analyses this bias).
//!
//! So this module starts at the valley, walks along the normal to the edge on either side, and takes the middle of the
//! two edges. The edges come from the colour channel with the strongest gradient. Blur pushes both edges outwards by
//! the same amount, so their middle does not move.
//!
//! Limit: a line with an edge on one side only has no centre here.

use super::cost::{Feature, Features, Kind};
use rototoon_base::geometry::Point;

/// Farthest edge from the valley, in pixels at 540 lines. It covers half the width of the widest line and the error of
/// the valley.
const REACH: f64 = 4.0;

/// How far the valley may be beyond the ink's true edge, in pixels.
const VALLEY_ERROR: f64 = 1.0;

/// Smallest cosine between the line's normal and the gradient of an edge.
const PARALLEL: f64 = 0.7;

/// Sub-pixel centre, in pixels of the picture, of the ink in the pixel (`x`, `y`), whose line feature is `line`. `None`
/// where the feature has no place or an edge is missing.
pub(super) fn ink_centre(features: &Features, line: Feature, x: usize, y: usize) -> Option<Point> {
    let valley = line.place(x, y)?;
    let normal = line.normal();
    let flanks = (flank(features, valley, normal), flank(features, valley, -normal));
    let (Some(ahead), Some(behind)) = flanks else { return None };
    Some(valley + normal * (0.5 * (ahead - behind)))
}

/// Distance in pixels from `from` along `direction` to the first edge across which the picture becomes lighter. It may
/// be negative, down to −[`VALLEY_ERROR`]. `None` where there is no such edge in reach.
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
        // A ray may pass diagonally through a one-pixel chain of zero crossings. The ridge of the gradient is wider.
        if let (true, Some(place)) = (edge.normal().dot(direction) >= PARALLEL, edge.place(x, y)) {
            return Some((place - from).dot(direction));
        }
        t += 0.5;
    }
    None
}
