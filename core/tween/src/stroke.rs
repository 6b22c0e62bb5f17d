//! A stroke of a drawing.

use rototoon_base::geometry::{Point, polyline};

/// A line or outline as it was drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stroke {
    /// Its points in pixels, in the order of drawing.
    pub points: Vec<Point>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Its colour, sRGB-encoded, 0 to 1; compared where both strokes have one.
    pub colour: Option<[f32; 3]>,
    /// Number of its material; compared where both strokes have one.
    pub material: Option<u32>,
    /// Number of its layer; strokes of two layers never match.
    pub layer: Option<u32>,
}

impl Stroke {
    /// A stroke of these points, and nothing known beside.
    pub fn new(points: Vec<Point>, closed: bool) -> Self {
        Self { points, closed, ..Self::default() }
    }

    /// Length in pixels.
    pub fn length(&self) -> f64 {
        polyline::length(&self.points, self.closed)
    }
}

/// A point of a stroke that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("stroke {stroke}: point {point} is ({x}, {y}), expected numbers between -1e9 and 1e9")]
pub struct BadPoint {
    /// Index of the stroke.
    pub stroke: usize,
    /// Index of the point.
    pub point: usize,
    /// What was found.
    pub x: f64,
    /// What was found.
    pub y: f64,
}

/// The first point of the strokes that is no place.
pub(super) fn checked(strokes: &[Stroke]) -> Result<(), BadPoint> {
    for (stroke, points) in strokes.iter().map(|s| &s.points).enumerate() {
        if let Some(point) = polyline::first_unusable(points) {
            return Err(BadPoint { stroke, point, x: points[point].x, y: points[point].y });
        }
    }
    Ok(())
}
