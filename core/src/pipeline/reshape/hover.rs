//! Feet that never reach the ground.
//!
//! A foot that stands in the clip is put on the ground and bears the figure. On a body of other proportions another foot may hang in the air all the time,
//! such as the hind paws of a dog that walks as a human does. Nothing is moved for it, since it may be wanted. It is said, if
//!
//! - every foot of the clip's figure stands on some frame, so that none is lifted on purpose,
//! - some foot of the drawing comes to the ground, so that this is no jump, and
//! - the drawing at rest stands on the foot.
//!
//! In a motion of the drawing itself nothing is said: the drawing shows where it is.

use super::bodies::{Body, Moved};
use super::feet::FootLimb;
use super::motion::Motion;
use crate::geometry::Point;

/// A foot is on the ground if it is above it by no more than this share of the torso.
const ABOVE: f64 = 0.05;

/// What is to be said about the feet.
pub(super) fn notes((bodies, moved): (&[Body], &[Moved]), motion: &Motion) -> Vec<String> {
    if motion.own || !motion.all_stand {
        return Vec::new();
    }
    let feet: Vec<(&FootLimb, Height)> =
        motion.feet.iter().filter_map(|foot| Some((foot, Height::of(foot, bodies, moved, motion.ground)?))).collect();
    let least = ABOVE * motion.size;
    if feet.iter().all(|(_, height)| height.least > least) {
        return Vec::new();
    }
    let hangs = feet.iter().filter(|(_, height)| height.at_rest <= least && height.least > least);
    hangs.map(|(foot, height)| said(&foot.parts, height)).collect()
}

fn said(parts: &[String], height: &Height) -> String {
    let names: Vec<String> = parts.iter().map(|name| format!("{name:?}")).collect();
    let what = if parts.len() == 1 { "part" } else { "parts" };
    format!("{what} {}: at least {:.0} px above the ground on every frame", names.join(", "), height.least)
}

/// How far a foot is above the ground, in pixels.
struct Height {
    at_rest: f64,
    /// On the frame on which it is lowest.
    least: f64,
}

impl Height {
    /// Of a foot with closed parts.
    fn of(foot: &FootLimb, bodies: &[Body], moved: &[Moved], ground: f64) -> Option<Self> {
        let low = |points: &[Point]| points.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let own = bodies.iter().zip(moved).filter(|(body, _)| foot.parts.contains(&body.name));
        let of = |(body, moved): (&Body, &Moved)| {
            let lowest = moved.frames.iter().map(|points| low(&points[..body.count])).fold(f64::NEG_INFINITY, f64::max);
            (low(&body.points[..body.count]), lowest)
        };
        let (at_rest, lowest) = own.map(of).reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))?;
        Some(Self { at_rest: ground - at_rest, least: ground - lowest })
    }
}
