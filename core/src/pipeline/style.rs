//! From contours to a skeleton clip, and translation of a motion into another character's manner.

use super::report::runs;
use super::{PipelineError, frames_of, guesses, outdated};
use crate::project::Document;
use crate::project::clips::Clips;
use crate::reshape::capture::capture;
use crate::scene::limbs::{Limb, LimbSet};
use crate::scene::outcome::Outcome;
use crate::scene::{Clip, FrameNumber, Part, Progress};
use crate::style::{self, Grounds, Options, Request, StyleError};
use std::ops::RangeInclusive;

/// The clip to make of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipJob {
    /// The character that moves.
    pub character: String,
    /// Name of the motion.
    pub motion: String,
    /// The frames; `None` takes the complete footage.
    pub frames: Option<RangeInclusive<FrameNumber>>,
}

/// A clip captured from the contours of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct CapturedClip {
    /// A file with this clip only, at the footage's frame rate.
    pub clips: Clips,
    /// The document's frame of the first posture.
    pub first: FrameNumber,
    /// Key points that were filled in on some frames because no contour determines them, with the number of these
    /// frames.
    pub guessed: Vec<(String, usize)>,
    /// In words, which contours that limbs hang on are lost or doubtful, and on which frames of the clip.
    pub doubts: Vec<String>,
    /// In words, which keys were changed after tracking, so that the clip has old contours there.
    pub outdated: Option<String>,
}

/// Captures a clip from a document's tracked contours and its limbs.
///
/// # Errors
///
/// [`PipelineError::Option`] for an empty name or frames outside of the footage; [`PipelineError::Style`] for limbs
/// that cannot be used.
pub fn clip(document: &Document, job: &ClipJob) -> Result<CapturedClip, PipelineError> {
    let wrong = |error: &dyn std::fmt::Display| PipelineError::Style(error.to_string());
    for (name, value) in [("character", &job.character), ("motion", &job.motion)] {
        if value.is_empty() {
            return Err(PipelineError::option(name, "found no name, expected one"));
        }
    }
    let footage = &document.scene.footage;
    let frames = frames_of(footage, job.frames.clone())?;
    let set = document.limbs().map_err(|e| wrong(&e))?;
    let captured = capture(&set, &document.scene.parts, frames).map_err(|e| wrong(&e))?;
    let counts = captured.guessed.iter().enumerate().filter(|(_, count)| **count > 0);
    let guessed = counts.map(|(k, count)| (set.template.point_name(k).to_owned(), *count)).collect();
    let last = captured.first + captured.postures.len() as FrameNumber - 1;
    let doubts = doubts(&set, &document.scene.parts, captured.first..=last);
    let mut clip = Clip::of(set.template.clone(), job.character.as_str(), job.motion.as_str(), captured.postures);
    clip.guessed = captured.times;
    let clips = Clips { clips: vec![clip], fps: footage.fps };
    Ok(CapturedClip { clips, first: captured.first, guessed, doubts, outdated: outdated(&document.scene) })
}

/// Says of each part that limbs hang on where its contours are lost or doubtful.
fn doubts(set: &LimbSet, parts: &[Part], frames: RangeInclusive<FrameNumber>) -> Vec<String> {
    let of = |part: &Part| {
        let hangs = |limb: &&Limb| {
            [&limb.start, &limb.end].iter().any(|end| end.points.iter().any(|point| point.part == part.name))
        };
        let named =
            |limb: &Limb| format!("{} to {}", set.template.point_name(limb.from), set.template.point_name(limb.to));
        let limbs: Vec<String> = set.limbs.iter().filter(hangs).map(named).collect();
        let within = |all: Vec<FrameNumber>| all.into_iter().filter(|f| frames.contains(f)).collect::<Vec<_>>();
        let outcome = Outcome::of(part);
        let found = [("lost", within(outcome.lost)), ("doubtful", within(outcome.doubtful))];
        let said = found.iter().filter(|(_, frames)| !frames.is_empty());
        let said: Vec<String> = said.map(|(what, frames)| format!("{what} on {}", runs(frames))).collect();
        let wrong = !limbs.is_empty() && !said.is_empty();
        wrong.then(|| format!("part {:?} ({}): {}", part.name, limbs.join(", "), said.join("; ")))
    };
    parts.iter().filter_map(of).collect()
}

/// Re-makes a motion in another character's manner. It runs on the caller's rayon pool; the result does not depend on
/// the pool.
///
/// # Errors
///
/// [`PipelineError::Option`] for a name that no clip has, or one name for style and content, [`PipelineError::Style`] or [`PipelineError::Cancelled`].
pub fn translate(
    clips: &Clips,
    request: &Request,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Clips, PipelineError> {
    translate_and_judge(clips, request, options, progress).map(|(made, _)| made)
}

/// Like [`translate`], and says what the result rests on.
///
/// # Errors
///
/// Those of [`translate`].
pub fn translate_and_judge(
    clips: &Clips,
    request: &Request,
    options: &Options,
    progress: &dyn Progress,
) -> Result<(Clips, Grounds), PipelineError> {
    let made = style::translate_and_judge(&clips.clips, request, options, progress);
    let (mut made, grounds) = made.map_err(failed)?;
    guesses::mark(&clips.clips, request, options, &mut made);
    Ok((Clips { clips: vec![made], fps: clips.fps }, grounds))
}

/// A failed translation. What the request asks of clips that do not have it is the fault of an option.
fn failed(error: StyleError) -> PipelineError {
    match error {
        StyleError::Cancelled(cancelled) => PipelineError::Cancelled(cancelled),
        StyleError::Name { role, found, known } => {
            PipelineError::option(role, format!("found {found:?}, expected one of {known}"))
        }
        StyleError::SameCharacter { character } => PipelineError::option(
            "content",
            format!("found {character:?}, the style's character, expected another one"),
        ),
        StyleError::Content { character, motion } => PipelineError::option(
            "content",
            format!("found no clip of {motion:?} by {character:?}, expected one to translate"),
        ),
        other => PipelineError::Style(other.to_string()),
    }
}
