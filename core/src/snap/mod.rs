//! Snaps contours to the drawn ink: intelligent scissors (Mortensen & Barrett 1995) between fixed control points.
//!
//! **What.** A tracked contour is a polygon, but the artist sees a curve. For each two neighbouring control points this
//! module searches the chain of pixels of least cost between them. A step costs 0.43 f_Z + 0.43 f_G + 0.14 f_D per
//! pixel of length (Zhou & Xiao 2011, eq. 13). f_Z is high where the Laplacian does not cross zero, f_G where the
//! gradient is weak, and f_D where step and edge differ in direction. The chain is then moved to the sub-pixel place of
//! the edge or line.
//!
//! **Differences from the papers:**
//!
//! - The search is limited to a [strip](CorridorWidth) around the segment. So it cannot run away along another line,
//!   and it takes about a millisecond.
//! - f_G is relative to the features at the segment's ends, not to the strongest gradient of the picture. So a path on
//!   a faint line does not jump to a stronger line nearby.
//! - Diagonal steps weigh √2 in all three terms (in the paper in f_G alone). So the cost is the integral of a local
//!   cost along the path, and its minimum does not depend on the line's direction.
//! - A contour whose points are on ink follows the centre of the ink ([`Follow`]). An ink line has an edge on both
//!   sides, and a path along edges would choose one of them for each segment. The choice is made for a contour as a
//!   whole. [`snap_scene`] makes it for a part on all of its frames, so that it does not flicker. On edges, f_D uses
//!   the sign of the gradient, so changing sides is expensive.
//!
//! **Limits.** Light lines on a dark background and very wide lines are followed as edges only. A segment without ink
//! between its ends stays straight.
//!
//! Files, in reading order:
//!
//! - `derivatives`: Gaussian derivatives of a window
//! - `cost`: edges and lines of a picture, computed where a path needs them
//! - `centre`: the middle of an ink line
//! - `corridor`: the pixels that a path may use
//! - `live_wire`: Dijkstra's search
//! - `subpixel`: from a chain of pixels to a smooth path
//! - `snapper`: contours of one picture
//! - `footage`: parts of a scene on all frames

mod centre;
mod corridor;
mod cost;
mod derivatives;
mod footage;
mod live_wire;
mod snapper;
mod subpixel;

pub use corridor::CorridorWidth;
pub use cost::Follow;
pub use footage::{PartCurves, SnapError, snap_scene};
pub use snapper::{InkVote, SnapOptions, Snapper};

use crate::geometry::Point;
use crate::scene::{Colour, Raster};

/// Snaps a single contour of a picture: one path per segment, as [`Snapper::snap`] gives them. For several contours of
/// one picture use one [`Snapper`], which reuses its work.
pub fn snap_contour(
    picture: &Raster<Colour>,
    contour: &[Point],
    closed: bool,
    options: &SnapOptions,
) -> Vec<Vec<Point>> {
    Snapper::new(picture).snap(contour, closed, options)
}

#[cfg(test)]
mod tests;
