//! The curves of all frames, read at their samples.

use super::curve::{Curve, Functional};
use rototoon_base::geometry::Point;

/// What the terms read of the control points, by frame and sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Places of the samples.
    pub places: Vec<Vec<Point>>,
    /// Directions along the curve, of any length.
    pub tangents: Vec<Vec<Point>>,
    /// Vectors between neighbouring samples.
    pub chords: Vec<Vec<Point>>,
    /// Second differences.
    pub seconds: Vec<Vec<Point>>,
}

impl Pose {
    /// Reads the control points, frame by frame.
    pub fn new<'a>(curve: &Curve, frames: impl Iterator<Item = &'a [Point]> + Clone) -> Self {
        let read = |functionals: &[Functional]| {
            let of_frame = |points: &[Point]| functionals.iter().map(|f| f.read(points)).collect();
            frames.clone().map(of_frame).collect()
        };
        Self {
            places: read(&curve.places),
            tangents: read(&curve.tangents),
            chords: read(&curve.chords),
            seconds: read(&curve.seconds),
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.places.len()
    }
}
