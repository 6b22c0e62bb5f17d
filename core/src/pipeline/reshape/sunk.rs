//! Parts that go through the ground.
//!
//! Feet are put on the ground, the rest of the body is not: a figure that sits down on a drawing with short legs may sink
//! in. Nothing is moved for it, since a clip does not say what should rest on the ground. It is said.
//!
//! In a motion of the drawing itself nothing is said: the drawing shows where it is.

use super::bodies::{Body, Moved};
use super::motion::Motion;
use crate::geometry::Point;
use crate::pipeline::report::runs;
use crate::scene::{FrameNumber, Part};

/// A part is below the ground if it is by more than this share of the torso.
const BELOW: f64 = 0.03;

/// What is to be said about the parts that limbs carry. `first` is the frame of the clip's first posture.
pub(super) fn notes(
    (bodies, moved): (&[Body], &[Moved]),
    parts: &[Part],
    motion: &Motion,
    first: FrameNumber,
) -> Vec<String> {
    if motion.own || motion.feet.is_empty() {
        return Vec::new();
    }
    let foot = |name: &String| motion.feet.iter().any(|foot| foot.parts.contains(name));
    let low = |points: &[Point]| points.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    let of = |(body, moved): (&Body, &Moved)| {
        // A part that is drawn below the ground may stay there.
        let level = motion.ground.max(low(&body.points[..body.count]));
        let depth: Vec<f64> = moved.frames.iter().map(|points| low(&points[..body.count]) - level).collect();
        let below = (first..).zip(&depth).filter(|(_, depth)| **depth > BELOW * motion.size);
        let frames: Vec<FrameNumber> = below.map(|(frame, _)| frame).collect();
        let most = depth.iter().copied().fold(0.0, f64::max);
        let name = &parts[body.part].name;
        let said = format!("part {name:?}: up to {most:.0} px below the ground on frames {}", runs(&frames));
        (!frames.is_empty()).then_some(said)
    };
    let carried = bodies.iter().zip(moved).filter(|(body, _)| body.follows.is_none() && !body.carriers.is_empty());
    carried.filter(|(body, _)| !foot(&body.name)).filter_map(of).collect()
}
