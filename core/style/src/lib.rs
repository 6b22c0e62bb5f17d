//! Style: a motion re-made in another character's manner, as skeleton clips.
//!
//! This crate works on key points of skeletons over time ([`Clip`]). It does not draw the result: `rototoon-reshape` lets a
//! drawing follow a skeleton.
//!
//! - [`align`]: clips of one motion brought together in time; `build`: all clips on one body
//! - [`gaussian`]: what a character adds to a motion, predicted from what it adds to others; `cells`: the clips as numbers
//! - `stance`, `moving`: the posture that is held and the movement, each a process of its own; `likeness`: which characters are alike
//! - `framing`: clips of a character from shots in which it has another size
//! - `sides`: all clips brought to the side to which the content's looks
//! - `distinct`: a result that is told apart from other characters
//! - `episodes`: how far few clips of a style are to be trusted ([`Sure`]); `grounds`: what a result rests on, in words
//! - [`bilinear`]: style and content matrices (Tenenbaum & Freeman 2000)
//! - [`factorisation`]: non-negative style factorisation (Liang et al. 2012)
//! - [`liang2012`]: translation with it
//! - [`finish`]: limb lengths, standing feet; `twos`: a content on twos gives a result on twos
//!
//! # The task
//!
//! Characters × motions form a grid of clips with holes; the hole (style, motion) is to be filled, the motion being known
//! from other characters, the style from other motions. Everything happens with the pelvis at the origin, in torso
//! lengths, on the content's build, and to the content's side; the result gets the style's build and size, and walks the content's way.
//!
//! # Example
//!
//! A figure of straight limbs walks and runs. Its manner is how far it leans. Its motion is how far arms and legs swing. No
//! clip shows the old character running.
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_base::scene::skeleton::{COUNT, PARENTS, Posture};
//! use rototoon_base::scene::{Clip, Silent};
//! use rototoon_style::{Options, Request, translate};
//! # use std::f64::consts::{PI, TAU};
//!
//! fn posture(lean: f64, swing: f64) -> Posture {
//!     let mut p = [Point::ZERO; COUNT];
//!     for k in 1..COUNT {
//!         let (angle, length) = match k {
//!             1..=4 => (PI - lean, 0.5),       // spine and head, upwards
//!             5 | 8 | 11 | 14 => (0.0, 0.1),   // shoulders and hips
//!             6 | 7 | 15 | 16 => (swing, 0.5), // the left arm and the right leg
//!             _ => (-swing, 0.5),
//!         };
//!         p[k] = p[PARENTS[k]] + length * Point::new(f64::sin(angle), f64::cos(angle));
//!     }
//!     p
//! }
//! let wave: [f64; 16] = std::array::from_fn(|frame| f64::sin(TAU * frame as f64 / 16.0));
//! let clip = |name, lean, motion, swing| Clip::new(name, motion, wave.map(|w| posture(lean, swing * w)).to_vec());
//! let people = [("plain", 0.0), ("proud", -0.2), ("shy", 0.2), ("old", 0.4)];
//! let mut clips: Vec<Clip> = people.map(|(name, lean)| clip(name, lean, "walk", 0.4)).into();
//! clips.extend(people[..3].iter().map(|&(name, lean)| clip(name, lean, "run", 0.9)));
//! let request = Request { style: "old", motion: "run", content: "plain", keys: &[] };
//! let made = translate(&clips, &request, &Options::default(), &Silent)?;
//! let (found, truth) = (&made.postures[4], posture(0.4, 0.9));
//! let [head, knee] = [4, 15].map(|k| (found[k] - found[0]).distance(truth[k]));
//! assert!(head < 0.3, "it leans like the old one: the plain runner's head is 0.8 away");
//! assert!(knee < 0.1, "it strides like a runner: the old walker's knee is 0.25 away");
//! # Ok::<(), rototoon_style::StyleError>(())
//! ```

#![forbid(unsafe_code)]

mod additive;
pub mod align;
mod basis;
pub mod bilinear;
mod build;
mod cells;
mod distinct;
mod episodes;
pub mod factorisation;
pub mod finish;
mod framing;
pub mod gaussian;
mod grid;
mod grounds;
mod kernels;
mod key_pose;
pub mod liang2012;
mod likeness;
mod moving;
mod sides;
mod stance;
mod twos;

pub use episodes::Sure;
pub use grounds::Grounds;
pub use sides::Sides;

use grid::{Grid, Row};
use rototoon_base::scene::clip::resample;
use rototoon_base::scene::holds::Holds;
use rototoon_base::scene::skeleton::{COUNT, LEGS, Posture, torso};
use rototoon_base::scene::template::length;
use rototoon_base::scene::{Cancelled, Clip, Progress};
use std::borrow::Cow;

/// What progress is told.
const STEP: &str = "Translating";

/// The method that translates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// Gaussian processes over style and posture, with one of its own for the stance and one for the movement: the default.
    #[default]
    Rototoon,
    /// The asymmetric bilinear model of Tenenbaum & Freeman 2000, with a ridge towards the mean style.
    Bilinear,
    /// Their symmetric model.
    BilinearSymmetric,
    /// Non-negative style factorisation in its consistent reading.
    Liang2012,
}

impl Preset {
    /// Ids of all presets, with a few words for people.
    pub const ALL: [(&'static str, &'static str, Self); 4] = [
        ("rototoon", "Gaussian processes over style and posture", Self::Rototoon),
        ("bilinear", "Tenenbaum & Freeman 2000, a style matrix for each character", Self::Bilinear),
        ("bilinear-symmetric", "Tenenbaum & Freeman 2000, a style vector for each character", Self::BilinearSymmetric),
        ("liang2012", "Liang et al. 2012, non-negative factorisation", Self::Liang2012),
    ];

    /// The preset of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _, _)| *name == id).map(|(_, _, preset)| *preset)
    }
}

/// Whose timing the result has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// The content's: frame by frame the same moment of the motion.
    #[default]
    Content,
    /// The style's: faster or slower as its other clips are beside the content's.
    Style,
}

/// A posture drawn for the result.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyPose {
    /// The frame of the content's clip.
    pub frame: usize,
    /// Key points in the unit of the style's clips; where the pelvis stands does not matter.
    pub posture: Posture,
}

/// What is to be made.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// In whose manner.
    pub style: &'a str,
    /// Which motion. A clip of it by the style is left out of account.
    pub motion: &'a str,
    /// Whose motion it was: gives the number of frames, the timing, and the way through the picture.
    pub content: &'a str,
    /// Postures drawn for the result, met exactly.
    pub keys: &'a [KeyPose],
}

/// How it is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The method.
    pub preset: Preset,
    /// Whose timing.
    pub pace: Pace,
    /// Factor on what the style adds to the motion: 0 the content's own motion, 1 the most probable result, more for a manner that is
    /// laid on thicker.
    ///
    /// The most probable result is drawn towards the mean of all characters as far as the style is uncertain. A tenth
    /// more goes away from the mean by a tenth of the distance, and by a tenth from the nearest clip of another character. It
    /// costs little accuracy and is recognised more often.
    pub strength: f64,
    /// Components of the bilinear models' contents and of the factorisation; none for their own. The default preset has none.
    pub rank: Option<usize>,
    /// Whether limbs keep within the lengths that the style's own clips show.
    pub keep_lengths: bool,
    /// Whether feet that stand in the content's clip stay where they stand.
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

/// Why nothing was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StyleError {
    /// No clip has this character or motion.
    #[error("{role}: found {found:?}, expected one of {known}")]
    Name {
        /// What the name was given for: `style`, `content` or `motion`.
        role: &'static str,
        /// The name that was given.
        found: String,
        /// All names of characters, or of motions.
        known: String,
    },
    /// Style and content are one.
    #[error("style and content: found {character:?} for both, expected two characters")]
    SameCharacter {
        /// The character.
        character: String,
    },
    /// The content's clip is not there.
    #[error("content: found no clip of {motion:?} by {character:?}, expected one to translate")]
    Content {
        /// The content's character.
        character: String,
        /// The motion.
        motion: String,
    },
    /// The content's clip is of another body.
    #[error(
        "content ({character:?}, {motion:?}): found the skeleton {found:?}, expected \"human\": a manner is known of human clips only"
    )]
    Body {
        /// The content's character.
        character: String,
        /// The motion.
        motion: String,
        /// The name of its template.
        found: String,
    },
    /// Nothing tells the manner.
    #[error(
        "style: found neither another motion of {character:?} beside {motion:?} nor a key pose, expected at least one"
    )]
    NothingKnown {
        /// The style's character.
        character: String,
        /// The motion.
        motion: String,
    },
    /// A clip holds what is not finite, or nothing.
    #[error(
        "clip ({character:?}, {motion:?}), frame {frame}: found a coordinate that is not finite, expected finite coordinates"
    )]
    Broken {
        /// The clip's character.
        character: String,
        /// The clip's motion.
        motion: String,
        /// The frame.
        frame: usize,
    },
    /// A character has no size.
    #[error("character {character:?}: found a torso of length {found}, expected a positive length")]
    Torso {
        /// The character.
        character: String,
        /// Median length over its clips.
        found: f64,
    },
    /// A key pose has no size.
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
    /// A key pose lies beyond the clip.
    #[error("key pose: found frame {found}, expected 0 to {}", frames - 1)]
    KeyFrame {
        /// The frame.
        found: usize,
        /// Frames of the content's clip.
        frames: usize,
    },
}

/// What a method hands back: postures with the pelvis at the origin in torso lengths, and their standard deviations.
pub(crate) struct Prediction {
    rows: Vec<Row>,
    deviation: Vec<[f64; COUNT]>,
    sure: Option<Sure>,
}

/// Re-makes a motion in another character's manner.
///
/// The result has the style's size and, key by key point and frame, a standard deviation of each coordinate, learned from how
/// well the clips that are known are predicted from the others.
///
/// # Errors
///
/// What is wrong with the clips or the request, or [`StyleError::Cancelled`].
pub fn translate(
    clips: &[Clip],
    request: &Request,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Clip, StyleError> {
    translate_and_judge(clips, request, options, progress).map(|(clip, _)| clip)
}

/// Like [`translate`], and says what the result rests on: how sure it is, if the preset is [`Preset::Rototoon`] and the library has
/// enough other characters to tell.
///
/// # Errors
///
/// Those of [`translate`].
pub fn translate_and_judge(
    clips: &[Clip],
    request: &Request,
    options: &Options,
    progress: &dyn Progress,
) -> Result<(Clip, Grounds), StyleError> {
    progress.report(STEP, 0.0)?;
    let (clips, sides) = sides::to_content(human_clips(clips, request)?, request);
    let clips = &by_name(clips)[..];
    let grid = Grid::new(clips, request)?;
    let keys = keys(&grid, request);
    let mut grounds = Grounds::new(&grid, request, options, sides);
    let mut made = match options.preset {
        Preset::Rototoon => gaussian::predict(&grid, &keys, options.strength.max(1.0), progress)?,
        Preset::Bilinear => bilinear::predict(&grid, &keys, bilinear::Model::Asymmetric, options.rank),
        Preset::BilinearSymmetric => bilinear::predict(&grid, &keys, bilinear::Model::Symmetric, options.rank),
        Preset::Liang2012 => liang2012::predict(&grid, &keys, options.rank),
    };
    progress.report(STEP, 0.9)?;
    grounds.sure = made.sure;
    towards_content(&mut made, &grid, grounds.share(), options.keep_lengths);
    meet(&mut made, &keys);
    let own = &grid.builds[grid.style];
    let mut postures: Vec<Posture> = made.rows.iter().map(|row| build::given(&grid::posture(row), own)).collect();
    if options.keep_lengths {
        let held: Vec<usize> = keys.iter().map(|(frame, _)| *frame).collect();
        finish::keep_lengths(&mut postures, &own_postures(&grid), &held);
    }
    let size = size_of(&grid, request);
    let content = clips.iter().find(|c| c.character == request.content && c.motion == request.motion);
    let holds = content.and_then(|content| Holds::of(&content.template, &content.postures));
    if let Some(content) = content.and_then(Clip::human) {
        place(&mut postures, &content, size);
        let contacts = options.keep_contacts;
        match &holds {
            Some(holds) => twos::finish(&mut postures, &content, holds, &keys, contacts),
            None if contacts => finish::keep_contacts(&mut postures, &content),
            None => {}
        }
    }
    let mut clip = Clip::new(request.style, request.motion, postures);
    clip.deviation = made.deviation.iter().map(|frame| frame.iter().map(|s| s * size).collect()).collect();
    if let Some(holds) = holds {
        clip.deviation = holds.held(&holds.drawings(&clip.deviation));
    }
    if options.pace == Pace::Style {
        let pace = align::pace(clips, request);
        align::change_pace(&mut clip, pace.ratio);
        grounds.pace = Some(pace);
    }
    progress.report(STEP, 1.0)?;
    Ok((clip, grounds))
}

/// Goes back from a prediction to the content's own motion, of which the share 1 has nothing. It has the style's limbs, if these
/// are kept: its bones keep their directions, so it is the same motion on another body.
fn towards_content(made: &mut Prediction, grid: &Grid, share: f64, keep_lengths: bool) {
    let Some(content) = grid.get(grid.content, grid.motion).filter(|_| share < 1.0) else { return };
    let own = &grid.builds[grid.style];
    let mut content = content.to_vec();
    if keep_lengths {
        content.iter_mut().for_each(|posture| *posture = build::given(posture, own));
        finish::take_lengths(&mut content, &own_postures(grid));
    }
    content.iter_mut().for_each(|posture| *posture = build::taken(posture, own));
    for (row, posture) in made.rows.iter_mut().zip(&content) {
        row.iter_mut().zip(grid::row(posture)).for_each(|(value, own)| *value = own + share * (*value - own));
    }
}

/// The clips in the order of their names. The order in which they were given is that in which a library got them, and says nothing; a
/// factorisation and ties between framings would follow it.
fn by_name(clips: Cow<'_, [Clip]>) -> Cow<'_, [Clip]> {
    let by_name = |a: &Clip, b: &Clip| (&a.character, &a.motion).cmp(&(&b.character, &b.motion));
    if clips.is_sorted_by(|a, b| by_name(a, b).is_le()) {
        return clips;
    }
    let mut clips = clips.into_owned();
    clips.sort_by(by_name);
    Cow::Owned(clips)
}

/// The clips of humans: a library may hold other bodies, from which nothing is learned.
fn human_clips<'a>(clips: &'a [Clip], request: &Request) -> Result<Cow<'a, [Clip]>, StyleError> {
    if clips.iter().all(|clip| clip.template.is_human()) {
        return Ok(Cow::Borrowed(clips));
    }
    let asked = |clip: &&Clip| clip.motion == request.motion && clip.character == request.content;
    match clips.iter().find(asked).filter(|clip| !clip.template.is_human()) {
        Some(clip) => Err(StyleError::Body {
            character: clip.character.clone(),
            motion: clip.motion.clone(),
            found: clip.template.name().to_owned(),
        }),
        None => Ok(clips.iter().filter(|clip| clip.template.is_human()).cloned().collect()),
    }
}

/// Key poses as numbers, one a frame (the last given for it).
fn keys(grid: &Grid, request: &Request) -> Vec<(usize, Row)> {
    let size = size_of(grid, request);
    let mut keys: Vec<(usize, Row)> = Vec::new();
    for key in request.keys {
        keys.retain(|(frame, _)| *frame != key.frame);
        let unified = build::taken(&grid::unified(&key.posture, size), &grid.builds[grid.style]);
        keys.push((key.frame, grid::row(&unified)));
    }
    keys.sort_by_key(|(frame, _)| *frame);
    keys
}

/// Torso length of the result: that of the style's clips, or of the first key pose where there is none.
fn size_of(grid: &Grid, request: &Request) -> f64 {
    let known = (0..grid.motions.len()).any(|m| grid.get(grid.style, m).is_some());
    match request.keys.first() {
        Some(key) if !known => torso(&key.posture),
        _ => grid.framings[grid.style].torso,
    }
}

fn own_postures(grid: &Grid) -> Vec<Posture> {
    let own = (0..grid.motions.len()).filter_map(|m| grid.get(grid.style, m)).flatten();
    own.map(|posture| build::given(posture, &grid.builds[grid.style])).collect()
}

/// Frames over which what is left of the way to a key pose fades.
const KEY_REACH: f64 = 3.0;

/// Meets key poses exactly: what is left of the way to them fades over a few frames.
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

/// Gives postures the style's size and the content's way: the pelvis goes as far as legs of this length carry it.
fn place(postures: &mut [Posture], content: &[Posture], size: f64) {
    let way = resample(content, postures.len());
    let legs =
        |postures: &[Posture]| postures.iter().map(|p| LEGS.iter().map(|leg| length(p, leg)).sum::<f64>()).sum::<f64>();
    let (own, theirs) = (size * legs(postures), legs(&way));
    let farther = if own > 0.0 && theirs > 0.0 { own / theirs } else { 1.0 };
    let start = way[0][0];
    for (posture, on_way) in postures.iter_mut().zip(&way) {
        let pelvis = start + (on_way[0] - start) * farther;
        *posture = posture.map(|p| p * size + pelvis);
    }
}

#[cfg(test)]
mod tests;
