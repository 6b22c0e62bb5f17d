//! Contours onto the drawn ink: intelligent scissors (Mortensen & Barrett 1995) between fixed control points.
//!
//! This crate makes a polygon that is already near a drawn line follow it exactly. It does not move control points and does
//! not follow contours through time; `rototoon-track` does that.
//!
//! A tracked contour is a polygon; what the artist sees is a curve. Between two neighbouring control points the least
//! costly chain of pixels is searched, where a step costs 0.43 f_Z + 0.43 f_G + 0.14 f_D a pixel's length: no zero crossing
//! of the Laplacian, weak gradient, and disagreement of directions make it dear (Zhou & Xiao 2011, eq. 13). The
//! chain is then moved to the sub-pixel place of the edge.
//!
//! Four things differ from the papers:
//!
//! - The search is confined to a [corridor](CorridorWidth) around the segment: it cannot run away along another line, and
//!   takes a millisecond.
//! - f_G is relative to what the segment's ends lie on, not to the strongest gradient of the picture, so that a faint line
//!   is not left for a stronger one.
//! - Diagonal steps weigh √2 in all three terms (the paper weighs f_G alone), so that a cost is the integral of the local
//!   cost along the path and its least value does not depend on the line's direction.
//! - Contours on ink follow its centre when their points lie there ([`Follow`]): an ink line has an edge on both sides,
//!   and paths that stick to edges would choose one of them in each segment. The choice is made for a contour as a
//!   whole, and by [`snap_scene`] for a part on all of its frames, so that it does not flicker. On edges, f_D makes the
//!   change of sides dear: it counts the sense of the gradient.
//!
//! Files, in reading order:
//!
//! - `derivatives`: Gaussian derivatives of a window
//! - `cost`: edges and lines of a picture, found where they are asked for
//! - `centre`: the middle of an ink line
//! - `corridor`: the pixels a path may use
//! - `live_wire`: Dijkstra's search
//! - `subpixel`: from pixels to a path
//! - `snapper`: contours of one picture
//! - `footage`: parts of a scene on all frames
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
mod live_wire;
mod snapper;
mod subpixel;

pub use corridor::CorridorWidth;
pub use cost::Follow;
pub use footage::{PartCurves, SnapError, snap_scene};
pub use snapper::{InkVote, SnapOptions, Snapper};

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};

/// One path a segment of a single contour: [`Snapper::snap`] for those who have but one contour in a picture.
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
