//! A stroke of a drawing, and the check that its points are usable.

use rototoon_base::geometry::{Point, polyline};

/// A line or outline as the artist drew it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stroke {
    /// Points in pixels (x to the right, y down), in the order of drawing.
    pub points: Vec<Point>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Width of the line in pixels at each point; empty if it has none of its own. Matching does not look at it.
    pub widths: Vec<f64>,
    /// Colour, sRGB-encoded, 0 to 1. Matching compares colours where both strokes have one.
    pub colour: Option<[f32; 3]>,
    /// Number of the material. Matching compares materials where both strokes have one.
    pub material: Option<u32>,
    /// Whether it is the outline of a solid shape, which is filled with the colour. Matching does not look at it.
    pub fill: bool,
    /// Colour of the fill of a stroke that has a line too, as `colour`. Matching does not look at it.
    pub fill_colour: Option<[f32; 3]>,
    /// Number of the layer. Matching adds a cost where both strokes have a layer and the layers differ.
    pub layer: Option<u32>,
    /// Number of the peg on which it is hung. Matching pairs no strokes of different pegs.
    pub peg: Option<u32>,
}

impl Stroke {
    /// A stroke of these points without colour, material and layer.
    pub fn new(points: Vec<Point>, closed: bool) -> Self {
        Self { points, closed, ..Self::default() }
    }

    /// Whether no peg forbids that the strokes are a pair.
    pub(crate) fn may_be(&self, other: &Self) -> bool {
        self.peg.zip(other.peg).is_none_or(|(own, other)| own == other)
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
    /// The x found.
    pub x: f64,
    /// The y found.
    pub y: f64,
}

/// Checks all points of the strokes.
///
/// # Errors
///
/// The first point with a coordinate that is not a number or outside −1e9 to 1e9.
pub(super) fn checked(strokes: &[Stroke]) -> Result<(), BadPoint> {
    for (stroke, points) in strokes.iter().map(|s| &s.points).enumerate() {
        if let Some(point) = polyline::first_unusable(points) {
            return Err(BadPoint { stroke, point, x: points[point].x, y: points[point].y });
        }
    }
    Ok(())
}
