//! Style translation: re-makes a motion in the manner of another character. Motions are skeleton clips.
//!
//! - [`align`]: brings clips of one motion together in time
//! - [`gaussian`]: predicts what a character adds to a motion from the other clips
//! - [`bilinear`]: separates style and content matrices (Tenenbaum & Freeman 2000)
//! - [`factorisation`]: non-negative style factorisation (Liang et al. 2012)
//! - [`liang2012`]: translation with that factorisation
//! - [`finish`]: limb lengths and standing feet
//!
//! # The task
//!
//! The known clips form a grid of characters × motions with holes. The task is to fill the hole (style, motion). The
//! motion is known from other characters, the style from other motions. The models work in torso lengths with the
//! pelvis at the origin. The result has the size of the style's character. Its pelvis follows the path of the content's
//! clip.
//!
//! # The steps
//!
//! [`translate`] checks and aligns the clips, predicts the postures with the chosen preset, and adjusts the prediction
//! to the key poses. Then it restores the limb lengths, the size, the path of the pelvis, the foot contacts and the
//! pace. Averages shorten limbs and let feet slide; the last steps repair that for every preset.
//!
//! # Limits
//!
//! The models work in the picture's plane. They know neither depth nor the ground. Clips of different length are
//! compared by their postures only.

pub mod align;
mod basis;
pub mod bilinear;
pub mod factorisation;
pub mod finish;
pub mod gaussian;
mod grid;
mod kernels;
mod key_pose;
pub mod liang2012;
mod stance;

use crate::scene::clip::resample;
use crate::scene::skeleton::{COUNT, Posture, torso};
use crate::scene::{Cancelled, Clip, Progress};
use grid::{Grid, Row};

/// Name of the step that progress reports show.
const STEP: &str = "Translating";

/// The method that translates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// Gaussian processes over style and posture; the default. The settings are averaged, weighted by how well each one
    /// predicts the known clips. The stance has a process of its own.
    #[default]
    Rototoon,
    /// The asymmetric bilinear model of Tenenbaum & Freeman 2000, with a ridge towards the mean style.
    Bilinear,
    /// The symmetric bilinear model of the same paper.
    BilinearSymmetric,
    /// Non-negative style factorisation in the consistent reading of the paper.
    Liang2012,
}

impl Preset {
    /// All presets: id, description, value.
    pub const ALL: [(&'static str, &'static str, Self); 4] = [
        ("rototoon", "Gaussian processes over style and posture", Self::Rototoon),
        ("bilinear", "Tenenbaum & Freeman 2000, a style matrix for each character", Self::Bilinear),
        ("bilinear-symmetric", "Tenenbaum & Freeman 2000, a style vector for each character", Self::BilinearSymmetric),
        ("liang2012", "Liang et al. 2012, non-negative factorisation", Self::Liang2012),
    ];

    /// The preset with this id; `None` if there is none.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _, _)| *name == id).map(|(_, _, preset)| *preset)
    }
}

/// Whose timing the result takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// The content's: each frame shows the same moment of the motion as the content's clip.
    #[default]
    Content,
    /// The style's: slower or faster by the mean ratio of the lengths of the style's and the content's clips of the
    /// same motions.
    Style,
}

/// A posture drawn for the result.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyPose {
    /// The frame of the content's clip.
    pub frame: usize,
    /// Key points in the unit of the style's clips. The position of the pelvis does not matter.
    pub posture: Posture,
}

/// What to translate.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// The character whose manner the result takes.
    pub style: &'a str,
    /// The motion. The style's own clip of this motion, if there is one, is ignored.
    pub motion: &'a str,
    /// The character whose clip of the motion is re-made. It gives the number of frames, the timing, and the path of
    /// the pelvis.
    pub content: &'a str,
    /// Postures drawn for the result. The result passes through them exactly.
    pub keys: &'a [KeyPose],
}

/// How to translate.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The method.
    pub preset: Preset,
    /// Whose timing the result takes.
    pub pace: Pace,
    /// Factor on what the style adds to the motion: 1 gives the most probable result, more exaggerates the manner.
    ///
    /// An uncertain style draws the most probable result towards the mean of all characters. A factor of 1.1 costs
    /// almost no accuracy, and the manner is recognised more often.
    pub strength: f64,
    /// Number of content components of the bilinear models, or rank of the factorisation. `None` takes the preset's own
    /// number. The default preset ignores it.
    pub rank: Option<usize>,
    /// Whether limb lengths stay within the range that the style's own clips show.
    pub keep_lengths: bool,
    /// Whether a foot that stands in the content's clip also stands in the result.
    pub keep_contacts: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            preset: Preset::default(),
            pace: Pace::default(),
            strength: 1.1,
            rank: None,
            keep_lengths: true,
            keep_contacts: true,
        }
    }
}

/// Why a translation failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StyleError {
    /// No clip is of this character.
    #[error("character: found {found:?}, expected one of {known}")]
    Character {
        /// The requested name.
        found: String,
        /// The names that the clips have.
        known: String,
    },
    /// No clip shows this motion.
    #[error("motion: found {found:?}, expected one of {known}")]
    Motion {
        /// The requested name.
        found: String,
        /// The names that the clips have.
        known: String,
    },
    /// The request names one character for both style and content.
    #[error("style and content: found {character:?} for both, expected two characters")]
    SameCharacter {
        /// The character.
        character: String,
    },
    /// The content's character has no clip of the motion.
    #[error("content: found no clip of {motion:?} by {character:?}, expected one to translate")]
    Content {
        /// The content's character.
        character: String,
        /// The motion.
        motion: String,
    },
    /// The style is unknown: its character has no other clip, and there is no key pose.
    #[error(
        "style: found neither another motion of {character:?} beside {motion:?} nor a key pose, expected at least one"
    )]
    NothingKnown {
        /// The style's character.
        character: String,
        /// The motion.
        motion: String,
    },
    /// A clip is empty or contains numbers that are not finite.
    #[error("clip ({character:?}, {motion:?}), frame {frame}: found no posture of finite numbers")]
    Broken {
        /// The clip's character.
        character: String,
        /// The clip's motion.
        motion: String,
        /// The frame.
        frame: usize,
    },
    /// The torso of a character has no positive, finite length.
    #[error("character {character:?}: found a torso of length {found}, expected a positive length")]
    Torso {
        /// The character.
        character: String,
        /// Median length over its clips.
        found: f64,
    },
    /// The torso of a key pose has no positive, finite length.
    #[error("key pose of frame {frame}: found a torso of length {found}, expected a positive length")]
    KeyPose {
        /// Its frame.
        frame: usize,
        /// Length of its torso.
        found: f64,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A key pose names a frame outside of the content's clip.
    #[error("key pose: found frame {found}, expected 0 to {}", frames - 1)]
    KeyFrame {
        /// The frame.
        found: usize,
        /// Frames of the content's clip.
        frames: usize,
    },
}

/// A method's result: postures in torso lengths with the pelvis at the origin, and for each key point the standard
/// deviation of a coordinate.
pub(crate) struct Prediction {
    rows: Vec<Row>,
    deviation: Vec<[f64; COUNT]>,
}

/// Re-makes a motion in another character's manner.
///
/// The result has the size of the style's character, in the unit of its clips. `deviation` contains, for each frame and
/// key point, the standard deviation of a coordinate in the same unit. The models estimate it from the errors made when
/// known clips are predicted from the others.
///
/// # Errors
///
/// A [`StyleError`] names the faulty clip or part of the request. [`StyleError::Cancelled`] is returned when `progress`
/// asks to stop.
pub fn translate(
    clips: &[Clip],
    request: &Request,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Clip, StyleError> {
    progress.report(STEP, 0.0)?;
    let grid = Grid::new(clips, request)?;
    let keys = keys(&grid, request);
    let mut made = match options.preset {
        Preset::Rototoon => gaussian::predict(&grid, &keys, options.strength, progress)?,
        Preset::Bilinear => bilinear::predict(&grid, &keys, bilinear::Model::Asymmetric, options.rank),
        Preset::BilinearSymmetric => bilinear::predict(&grid, &keys, bilinear::Model::Symmetric, options.rank),
        Preset::Liang2012 => liang2012::predict(&grid, &keys, options.rank),
    };
    progress.report(STEP, 0.9)?;
    meet(&mut made, &keys);
    let mut postures: Vec<Posture> = made.rows.iter().map(grid::posture).collect();
    if options.keep_lengths {
        let held: Vec<usize> = keys.iter().map(|(frame, _)| *frame).collect();
        finish::keep_lengths(&mut postures, &own_postures(&grid), &held);
    }
    let size = size_of(&grid, request);
    let content = clips.iter().find(|c| c.character == request.content && c.motion == request.motion);
    if let Some(content) = content {
        place(&mut postures, &content.postures, size, grid.torso[grid.content]);
        if options.keep_contacts {
            finish::keep_contacts(&mut postures, &content.postures);
        }
    }
    let mut clip = Clip::new(request.style, request.motion, postures);
    clip.deviation = made.deviation.iter().map(|frame| frame.map(|s| s * size)).collect();
    if options.pace == Pace::Style {
        align::change_pace(&mut clip, align::pace(clips, request));
    }
    progress.report(STEP, 1.0)?;
    Ok(clip)
}

/// Key poses as rows of numbers, sorted by frame. If a frame has several, the last one counts.
fn keys(grid: &Grid, request: &Request) -> Vec<(usize, Row)> {
    let size = size_of(grid, request);
    let mut keys: Vec<(usize, Row)> = Vec::new();
    for key in request.keys {
        keys.retain(|(frame, _)| *frame != key.frame);
        keys.push((key.frame, grid::row(&grid::unified(&key.posture, size))));
    }
    keys.sort_by_key(|(frame, _)| *frame);
    keys
}

/// Torso length of the result: that of the style's clips, or that of the first key pose if the style has no clips.
fn size_of(grid: &Grid, request: &Request) -> f64 {
    let known = (0..grid.motions.len()).any(|m| grid.get(grid.style, m).is_some());
    match request.keys.first() {
        Some(key) if !known => torso(&key.posture),
        _ => grid.torso[grid.style],
    }
}

fn own_postures(grid: &Grid) -> Vec<Posture> {
    (0..grid.motions.len()).filter_map(|m| grid.get(grid.style, m)).flatten().copied().collect()
}

/// Standard deviation, in frames, of the weight with which the remaining offset to a key pose fades.
const KEY_REACH: f64 = 3.0;

/// Adjusts the prediction to the key poses exactly. The offset that remains at a key pose fades over a few frames.
fn meet(made: &mut Prediction, keys: &[(usize, Row)]) {
    let left: Vec<(usize, Row)> =
        keys.iter().map(|(frame, key)| (*frame, std::array::from_fn(|d| key[d] - made.rows[*frame][d]))).collect();
    let weight = |frame: usize, key: usize| (-0.5 * ((frame as f64 - key as f64) / KEY_REACH).powi(2)).exp();
    for (frame, row) in made.rows.iter_mut().enumerate() {
        if let Some((_, key)) = keys.iter().find(|(at, _)| *at == frame) {
            *row = *key;
            continue;
        }
        let nearest = left.iter().min_by_key(|(at, _)| at.abs_diff(frame));
        if let Some((at, rest)) = nearest {
            row.iter_mut().zip(rest).for_each(|(value, r)| *value += weight(frame, *at) * r);
        }
    }
}

/// Gives postures the style's size and the content's path. The pelvis moves in proportion to the size of the body.
fn place(postures: &mut [Posture], content: &[Posture], size: f64, content_size: f64) {
    let way = resample(content, postures.len());
    let start = way[0][0];
    for (posture, on_way) in postures.iter_mut().zip(&way) {
        let pelvis = start + (on_way[0] - start) * (size / content_size);
        *posture = posture.map(|p| p * size + pelvis);
    }
}

#[cfg(test)]
mod tests;
