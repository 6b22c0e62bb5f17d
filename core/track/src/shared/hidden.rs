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

/// The share of the inside of a closed contour that is hidden, by the places of a grid. 0 if none of them is inside.
pub fn hidden_area(points: &[Point], hides: impl Fn(Point) -> bool) -> f64 {
    const CELLS: usize = 20;
    let Some((low, high)) = polygon::bounds(points) else { return 0.0 };
    let cell = |k: usize| (k as f64 + 0.5) / CELLS as f64;
    let grid = (0..CELLS * CELLS).map(|k| low + (high - low) * Point::new(cell(k % CELLS), cell(k / CELLS)));
    let inside: Vec<Point> = grid.filter(|place| polygon::contains(points, *place)).collect();
    inside.iter().filter(|place| hides(**place)).count() as f64 / inside.len().max(1) as f64
}

/// Whether a place is within one of several contours.
pub fn is_under(covers: &[Vec<Point>], place: Point) -> bool {
    covers.iter().any(|cover| polygon::contains(cover, place))
}
