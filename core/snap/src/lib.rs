//! Snaps contours to the drawn ink: intelligent scissors (Mortensen & Barrett 1995) between fixed control points.
//!
//! This crate makes a polygon that is already near a drawn line follow it exactly. It does not move control points and does
//! not follow contours through time; `rototoon-track` does that.
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
//! - `hidden`: segments behind nearer parts
//!
//! # Example
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_base::scene::Raster;
//! use rototoon_snap::{SnapOptions, snap_contour};
//!
//! // A circle of radius 30 in ink, 3 px wide, and a tracked contour of eight points on it.
//! let (centre, radius) = (Point::new(48.0, 48.0), 30.0);
//! let off_line = |p: Point| (p.distance(centre) - radius).abs();
//! let paper = |x, y| if off_line(Point::new(x as f64 + 0.5, y as f64 + 0.5)) < 1.5 { [0.1; 3] } else { [1.0; 3] };
//! let picture = Raster::from_fn(96, 96, paper);
//! let corner = |k: u32| centre + radius * Point::from_angle(f64::from(k) * std::f64::consts::TAU / 8.0);
//! let contour: Vec<Point> = (0..8).map(corner).collect();
//! assert!(off_line(contour[0].midpoint(contour[1])) > 2.0, "the polygon cuts the corner");
//!
//! let paths = snap_contour(&picture, &contour, true, &SnapOptions::default());
//! assert_eq!(paths.len(), 8, "one path for each segment");
//! assert!(paths.iter().flatten().all(|&p| off_line(p) < 0.5), "the paths follow the centre of the ink");
//! ```

#![forbid(unsafe_code)]

mod centre;
mod corridor;
mod cost;
mod derivatives;
mod footage;
mod hidden;
mod live_wire;
mod snapper;
mod subpixel;

pub use corridor::CorridorWidth;
pub use cost::Follow;
pub use footage::{PartCurves, SnapError, snap_scene};
pub use snapper::{InkVote, SnapOptions, Snapper};

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};

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
