//! What it means that a part and a file show the same on a frame.

use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Part};

/// Distance within which points are the same, in pixels: formats round them, and some have 32 bits for a coordinate.
const SAME: f64 = 0.01;

/// How a part is compared with what a file shows on a frame, and how it takes that.
pub(super) trait Compared {
    /// Whether the part shows this on a frame on which it has a contour.
    fn is_same(&self, part: &Part, frame: FrameNumber, file: &[Point]) -> bool;
    /// The control points of what the file shows, and the paths between them if it shows more than these.
    fn taken(&self, part: &Part, frame: FrameNumber, file: Vec<Point>) -> (Vec<Point>, Vec<Vec<Point>>);
}

/// Point by point.
pub(super) struct Points;

impl Compared for Points {
    fn is_same(&self, part: &Part, frame: FrameNumber, file: &[Point]) -> bool {
        part.points_at(frame).is_some_and(|own| is_same(own, file))
    }

    fn taken(&self, _: &Part, _: FrameNumber, file: Vec<Point>) -> (Vec<Point>, Vec<Vec<Point>>) {
        (file, Vec::new())
    }
}

/// Whether two contours have the same points, in order.
pub(super) fn is_same(a: &[Point], b: &[Point]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.distance(*b) <= SAME)
}
