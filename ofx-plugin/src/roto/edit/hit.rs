//! What is under the pen.

use super::{Lens, Place};
use rototoon::geometry::{Point, polygon, polyline};
use rototoon::scene::{FrameNumber, Scene};

/// Largest distance at which a control point is picked, in screen pixels.
pub const NEAR_POINT: f64 = 8.0;
/// Largest distance at which a contour is picked, in screen pixels.
pub const NEAR_LINE: f64 = 5.0;

/// The control point nearest to the pen. Of several at the same distance, that of the frontmost part. `parts` are those
/// that can be picked, the farthest first.
pub fn point(scene: &Scene, frame: FrameNumber, parts: &[usize], lens: &Lens, pen: Point) -> Option<Place> {
    let points = parts.iter().rev().flat_map(|&part| {
        let points = scene.parts[part].points_at(frame).into_iter().flatten();
        points.enumerate().map(move |(point, &at)| (Place { part, point }, lens.distance(at, pen)))
    });
    let near = points.filter(|(_, distance)| *distance <= NEAR_POINT);
    near.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(place, _)| place)
}

/// A place on a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnContour {
    /// Index of the part.
    pub part: usize,
    /// Index of the segment.
    pub segment: usize,
    /// Share of the way from the segment's first to its second point.
    pub share: f64,
}

/// The contour nearest to the pen.
pub fn contour(scene: &Scene, frame: FrameNumber, parts: &[usize], lens: &Lens, pen: Point) -> Option<OnContour> {
    let mut best: Option<(f64, OnContour)> = None;
    for &part in parts.iter().rev() {
        let Some(points) = scene.parts[part].points_at(frame) else { continue };
        for (segment, (a, b)) in polyline::segments(points, scene.parts[part].closed).enumerate() {
            let (share, distance) = lens.nearest(pen, a, b);
            if distance <= NEAR_LINE && best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, OnContour { part, segment, share }));
            }
        }
    }
    best.map(|(_, place)| place)
}

/// The frontmost closed part around the pen.
pub fn inside(scene: &Scene, frame: FrameNumber, parts: &[usize], pen: Point) -> Option<usize> {
    let around = |part: usize| {
        let part = &scene.parts[part];
        part.closed && part.points_at(frame).is_some_and(|points| polygon::contains(points, pen))
    };
    parts.iter().rev().copied().find(|&part| around(part))
}

/// The control points in a rectangle.
pub fn in_box(scene: &Scene, frame: FrameNumber, parts: &[usize], corners: [Point; 2]) -> Vec<Place> {
    let (least, most) = (corners[0].min(corners[1]), corners[0].max(corners[1]));
    let within = |at: Point| at.cmpge(least).all() && at.cmple(most).all();
    let of = |&part: &usize| {
        let points = scene.parts[part].points_at(frame).into_iter().flatten().enumerate();
        points.filter(|(_, at)| within(**at)).map(move |(point, _)| Place { part, point }).collect::<Vec<_>>()
    };
    parts.iter().flat_map(of).collect()
}
