//! A pose: the curves of all frames, evaluated at their samples.

use super::curve::{Curve, Functional};
use rototoon_base::geometry::Point;

/// The values of the functionals, by frame and sample, in working pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Places of the samples.
    pub places: Vec<Vec<Point>>,
    /// Vectors along the curve, of any length.
    pub tangents: Vec<Vec<Point>>,
    /// Scaled vectors between neighbouring samples.
    pub chords: Vec<Vec<Point>>,
    /// Scaled second differences.
    pub seconds: Vec<Vec<Point>>,
}

impl Pose {
    /// Evaluates the control points, frame by frame, in working pixels.
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
