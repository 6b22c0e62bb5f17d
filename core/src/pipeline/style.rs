//! From contours to a skeleton clip, and from one character's clips to a motion in another's manner.

use super::PipelineError;
use crate::project::Document;
use crate::project::clips::Clips;
use crate::reshape::capture::capture;
use crate::scene::skeleton::{COUNT, NAMES};
use crate::scene::{Clip, FrameNumber, Progress};
use crate::style::{self, Options, Request, StyleError};
use std::ops::RangeInclusive;

/// Which clip to make of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipJob {
    /// Who moves.
    pub character: String,
    /// What is done.
    pub motion: String,
    /// The frames; none for the whole footage.
    pub frames: Option<RangeInclusive<FrameNumber>>,
}

/// A clip made from a document's contours.
#[derive(Clone, Debug, PartialEq)]
pub struct CapturedClip {
    /// The clip alone, with the footage's frames a second.
    pub clips: Clips,
    /// The document's frame of its first posture.
    pub first: FrameNumber,
    /// Key points that no contour tells on some frames, with the number of these; they were filled in.
    pub guessed: Vec<(&'static str, usize)>,
}

/// Makes a clip of a document's tracked contours by its limbs.
pub fn clip(document: &Document, job: &ClipJob) -> Result<CapturedClip, PipelineError> {
    let wrong = |error: &dyn std::fmt::Display| PipelineError::Style(error.to_string());
    for (name, value) in [("character", &job.character), ("motion", &job.motion)] {
        if value.is_empty() {
            return Err(PipelineError::Request(format!("{name}: found no name, expected one")));
        }
    }
    let footage = &document.scene.footage;
    let frames = job.frames.clone().unwrap_or(footage.first..=footage.last);
    if frames.is_empty() || *frames.start() < footage.first || *frames.end() > footage.last {
        let (own, asked) = ((footage.first, footage.last), (frames.start(), frames.end()));
        return Err(PipelineError::Request(format!(
            "frames {} to {}: expected frames of the footage, {} to {}",
            asked.0, asked.1, own.0, own.1
        )));
    }
    let set = document.limbs().map_err(|e| wrong(&e))?;
    let captured = capture(&set, &document.scene.parts, frames).map_err(|e| wrong(&e))?;
    let guessed = (0..COUNT).filter(|&k| captured.guessed[k] > 0).map(|k| (NAMES[k], captured.guessed[k])).collect();
    let clip = Clip::new(job.character.as_str(), job.motion.as_str(), captured.postures);
    Ok(CapturedClip { clips: Clips { clips: vec![clip], fps: footage.fps }, first: captured.first, guessed })
}

/// Re-makes a motion in another character's manner. Runs on the caller's rayon pool; the result does not depend on it.
pub fn translate(
    clips: &Clips,
    request: &Request,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Clips, PipelineError> {
    let made = style::translate(&clips.clips, request, options, progress).map_err(|error| match error {
        StyleError::Cancelled(cancelled) => PipelineError::Cancelled(cancelled),
        other => PipelineError::Style(other.to_string()),
    })?;
    Ok(Clips { clips: vec![made], fps: clips.fps })
}
