//! What nearer parts hide of a contour.

use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameNumber, Part};

/// The contours of the closed parts that are nearer than a part on a frame, keyed or tracked.
pub fn covers(parts: &[Part], part: usize, frame: FrameNumber) -> Vec<Vec<Point>> {
    let depth = parts[part].depth_at(frame);
    let nearer = |other: &&Part| other.closed && other.depth_at(frame) > depth && !other.is_absent(frame);
    parts.iter().filter(nearer).filter_map(|other| other.outline(frame)).collect()
}

/// The share of the places of a contour that are hidden: its points and the middles between them. 0 without points.
pub fn hidden_share(points: &[Point], hides: impl Fn(Point) -> bool) -> f64 {
    let between = points.windows(2).map(|pair| pair[0].midpoint(pair[1]));
    let places: Vec<Point> = points.iter().copied().chain(between).collect();
    let count = places.iter().filter(|place| hides(**place)).count();
    count as f64 / places.len().max(1) as f64
}

/// Whether a place is within one of several contours.
pub fn is_under(covers: &[Vec<Point>], place: Point) -> bool {
    covers.iter().any(|cover| polygon::contains(cover, place))
}
