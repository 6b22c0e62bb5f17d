//! Motion capture in BVH files, as skeleton clips.
//!
//! - [`parse`]: the file's hierarchy and motion
//! - [`kinematics`]: where its joints are on each frame
//! - [`joints`]: which joints are the template's key points
//! - [`view`]: from space onto the picture
//!
//! A clip is told as those that are learned from are told: the pelvis at the origin, the torso (pelvis over chest to neck, in
//! space, its median over the clip) of length 1, x right and y down. With [`Options::way`] the pelvis goes its way through the
//! picture instead, from the origin, which is what a drawing needs that shall walk and stand on its feet.
//!
//! Limits: everything is seen without perspective from one direction all the time. Limbs that point at the viewer are short;
//! a character that turns about is seen turning.

pub mod joints;
pub mod kinematics;
pub mod parse;
pub mod view;

pub use joints::{JointMap, MapError};
pub use parse::{Bvh, BvhError};
pub use view::{Up, View};

use glam::DVec3;
use rototoon_base::scene::clip::between;
use rototoon_base::scene::skeleton::{COUNT, NAMES, Posture};
use std::ops::RangeInclusive;

/// A torso shorter than this has no length to measure by.
const NO_TORSO: f64 = 1e-9;
/// More frames than this are not made of one motion, whatever frames a second are asked for.
const MOST_FRAMES: f64 = 1e6;

/// How a motion becomes a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// From where it is seen.
    pub view: View,
    /// Which of the file's axes points up.
    pub up: Up,
    /// Joints of key points that their names do not tell.
    pub joints: JointMap,
    /// Whether the pelvis goes its way; else it stays at the origin.
    pub way: bool,
    /// The frames of the file, from 0; none for all.
    pub frames: Option<RangeInclusive<usize>>,
    /// Frames a second of the clip; none for the file's.
    pub fps: Option<f64>,
}

/// Postures seen in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// One a frame, in torso lengths, x right and y down.
    pub postures: Vec<Posture>,
    /// Frames a second.
    pub fps: f64,
    /// The direction that they are seen from, in degrees about the vertical: 0 where the character faces the viewer, 90 where it
    /// faces right.
    pub yaw: f64,
}

/// Why a motion does not become a clip.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// The file is not as it must be.
    #[error(transparent)]
    File(#[from] BvhError),
    /// Its joints are not the template's.
    #[error(transparent)]
    Joints(#[from] MapError),
    /// Frames that the file does not have.
    #[error("frames {first} to {last}: expected frames of the file, 0 to {}", count - 1)]
    Frames {
        /// First frame asked for.
        first: usize,
        /// Last frame asked for.
        last: usize,
        /// Number of frames of the file.
        count: usize,
    },
    /// Frames a second that cannot be.
    #[error("frames a second: found {found}, expected a positive number that gives at most {MOST_FRAMES} frames")]
    Rate {
        /// What was asked for.
        found: f64,
    },
    /// A key point is nowhere.
    #[error("frame {frame}: found {point} at no finite place")]
    Place {
        /// The frame.
        frame: usize,
        /// The key point.
        point: &'static str,
    },
    /// The character has no size.
    #[error("found a torso of length {found} (pelvis over chest to neck), expected a positive length")]
    Torso {
        /// Its length.
        found: f64,
    },
}

/// The text of a BVH file, as postures seen from somewhere.
pub fn seen(text: &str, options: &Options) -> Result<Seen, MotionError> {
    let bvh = parse::parse(text)?;
    let places = joints::places(&bvh, &options.joints)?;
    let frames = frames(&bvh, options)?;
    let first = *frames.start();
    let mut in_space = Vec::with_capacity(frames.clone().count());
    for frame in frames {
        let nodes = kinematics::nodes_at(&bvh, frame);
        let posture: [DVec3; COUNT] = std::array::from_fn(|k| places[k].at(&nodes));
        if let Some(k) = posture.iter().position(|p| !p.is_finite()) {
            return Err(MotionError::Place { frame, point: NAMES[k] });
        }
        in_space.push(posture);
    }
    let torso = torso(&in_space);
    if !(torso > NO_TORSO && torso.is_finite()) {
        return Err(MotionError::Torso { found: torso });
    }
    let camera = view::camera(&in_space, options.up, options.view);
    let start = camera.picture(in_space[0][0]);
    let mut postures = Vec::with_capacity(in_space.len());
    for (frame, posture) in in_space.iter().enumerate() {
        let origin = if options.way { start } else { camera.picture(posture[0]) };
        let flat = posture.map(|p| (camera.picture(p) - origin) / torso);
        if let Some(k) = flat.iter().position(|p| !p.is_finite()) {
            return Err(MotionError::Place { frame: first + frame, point: NAMES[k] });
        }
        postures.push(flat);
    }
    let (postures, fps) = at_rate(postures, 1.0 / bvh.frame_time, options.fps)?;
    Ok(Seen { postures, fps, yaw: camera.yaw })
}

fn frames(bvh: &Bvh, options: &Options) -> Result<RangeInclusive<usize>, MotionError> {
    let count = bvh.frame_count();
    let frames = options.frames.clone().unwrap_or(0..=count - 1);
    let (first, last) = (*frames.start(), *frames.end());
    if first <= last && last < count { Ok(frames) } else { Err(MotionError::Frames { first, last, count }) }
}

/// The median length of the torso in space.
fn torso(postures: &[[DVec3; COUNT]]) -> f64 {
    let mut lengths: Vec<f64> = postures.iter().map(|p| p[0].distance(p[1]) + p[1].distance(p[2])).collect();
    lengths.sort_by(f64::total_cmp);
    lengths[lengths.len() / 2]
}

/// Postures at another number of frames a second: the same time, straight between neighbours.
fn at_rate(postures: Vec<Posture>, own: f64, wanted: Option<f64>) -> Result<(Vec<Posture>, f64), MotionError> {
    let fps = wanted.unwrap_or(own);
    let last = (postures.len() - 1) as f64;
    // What falls short of a whole frame by rounding is one.
    let frames = (last * fps / own + 1e-6).floor() + 1.0;
    if !(fps > 0.0 && fps.is_finite() && frames <= MOST_FRAMES) {
        return Err(MotionError::Rate { found: fps });
    }
    if (fps - own).abs() <= 1e-9 * own {
        return Ok((postures, fps));
    }
    let snapped = |time: f64| if (time - time.round()).abs() < 1e-6 { time.round() } else { time };
    let times = (0..frames as usize).map(|frame| snapped(frame as f64 * own / fps));
    Ok((times.map(|time| between(&postures, time)).collect(), fps))
}

#[cfg(test)]
mod tests;
