//! Motion capture in BVH files, converted to skeleton clips.
//!
//! - [`parse`]: the hierarchy and motion of a file
//! - [`kinematics`]: positions of its joints on each frame
//! - [`joints`]: the joints of the template's key points
//! - [`view`]: projection from space to the picture
//!
//! A clip has the form that the style models expect: the pelvis at the origin, x right and y down, and a torso of
//! length 1. The torso is measured in space, from the pelvis over the chest to the neck, and its median over the clip
//! counts. With [`Options::way`] the pelvis follows its path through the picture instead, starting at the origin. A
//! drawing that walks and stands on its feet needs this path.
//!
//! Limits: the view has no perspective, and its direction is constant. Limbs that point towards the viewer are short. A
//! character that turns around is seen turning.

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

/// A shorter torso is not usable as a unit of length.
const NO_TORSO: f64 = 1e-9;
/// Frames a second that files of clips may have.
const SLOWEST: f64 = 1e-3;
const FASTEST: f64 = 1e6;
/// Greatest number of frames of a clip, whatever frame rate is requested.
const MOST_FRAMES: f64 = 1e6;

/// Options of the conversion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Direction of the view.
    pub view: View,
    /// The file's vertical axis.
    pub up: Up,
    /// Joints of key points that names do not determine.
    pub joints: JointMap,
    /// Whether the pelvis follows its path; otherwise it stays at the origin.
    pub way: bool,
    /// Frames of the file, from 0; `None` takes all.
    pub frames: Option<RangeInclusive<usize>>,
    /// Frames per second of the clip; `None` takes the file's rate.
    pub fps: Option<f64>,
}

/// Postures as seen in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// A posture for each frame, in torso lengths, x right and y down.
    pub postures: Vec<Posture>,
    /// Frames per second.
    pub fps: f64,
    /// Direction of the view about the vertical, in degrees: at 0 the character faces the viewer, at 90 it faces right.
    pub yaw: f64,
    /// What a person should know, in words: joints that were not taken by their names.
    pub notes: Vec<String>,
}

/// Why a motion cannot be converted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// The file is invalid.
    #[error(transparent)]
    File(#[from] BvhError),
    /// Key points have no joints.
    #[error(transparent)]
    Joints(#[from] MapError),
    /// The requested frames are not in the file.
    #[error("frames: found {first} to {last}, expected frames of the file, 0 to {}", count - 1)]
    Frames {
        /// First requested frame.
        first: usize,
        /// Last requested frame.
        last: usize,
        /// Number of frames of the file.
        count: usize,
    },
    /// The requested frame rate is impossible.
    #[error("frames a second: found {}, expected {SLOWEST} to {FASTEST}, and at most {MOST_FRAMES} frames", plain(*found))]
    Rate {
        /// The requested frame rate.
        found: f64,
    },
    /// The position of a key point is not finite.
    #[error("frame {frame}: found {point} at a position that is not finite, expected finite coordinates")]
    Place {
        /// The frame.
        frame: usize,
        /// The key point.
        point: &'static str,
    },
    /// The torso has no positive, finite length.
    #[error("torso (pelvis to chest to neck): found length {found}, expected a positive length")]
    Torso {
        /// Its length.
        found: f64,
    },
}

/// Converts the text of a BVH file to postures in a picture.
///
/// # Errors
///
/// A [`MotionError`].
pub fn seen(text: &str, options: &Options) -> Result<Seen, MotionError> {
    let mut bvh = parse::parse(text)?;
    let joints::Places { points, notes } = joints::places(&mut bvh, &options.joints)?;
    let frames = frames(&bvh, options)?;
    let first = *frames.start();
    let mut in_space = Vec::with_capacity(frames.clone().count());
    for frame in frames {
        let nodes = kinematics::nodes_at(&bvh, frame);
        let posture: [DVec3; COUNT] = std::array::from_fn(|k| points[k].at(&nodes));
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
    let (postures, fps) = at_rate(postures, rate(&bvh), options.fps)?;
    Ok(Seen { postures, fps, yaw: camera.yaw, notes })
}

/// Frames per second; a rate that misses an integer only by rounding is that integer.
fn rate(bvh: &Bvh) -> f64 {
    let rate = 1.0 / bvh.frame_time;
    if (rate - rate.round()).abs() <= 1e-12 * rate { rate.round() } else { rate }
}

fn frames(bvh: &Bvh, options: &Options) -> Result<RangeInclusive<usize>, MotionError> {
    let count = bvh.frame_count();
    let frames = options.frames.clone().unwrap_or(0..=count - 1);
    let (first, last) = (*frames.start(), *frames.end());
    if first <= last && last < count { Ok(frames) } else { Err(MotionError::Frames { first, last, count }) }
}

/// A number without hundreds of digits.
fn plain(number: f64) -> String {
    if (1e-6..1e12).contains(&number.abs()) { number.to_string() } else { format!("{number:e}") }
}

/// The median length of the torso in space.
fn torso(postures: &[[DVec3; COUNT]]) -> f64 {
    let mut lengths: Vec<f64> = postures.iter().map(|p| p[0].distance(p[1]) + p[1].distance(p[2])).collect();
    lengths.sort_by(f64::total_cmp);
    lengths[lengths.len() / 2]
}

/// Resamples postures to another frame rate over the same time, with linear interpolation.
fn at_rate(postures: Vec<Posture>, own: f64, wanted: Option<f64>) -> Result<(Vec<Posture>, f64), MotionError> {
    let fps = wanted.unwrap_or(own);
    let last = (postures.len() - 1) as f64;
    // A number of frames that misses an integer only by rounding counts as that integer.
    let frames = (last * fps / own + 1e-6).floor() + 1.0;
    if !((SLOWEST..=FASTEST).contains(&fps) && frames <= MOST_FRAMES) {
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
