//! A document for footage that was delivered again.
//!
//! Pictures of both footages are compared (`rototoon-conform`), and the document is moved (`rototoon-document`). If the frames' numbers are all that has changed, or
//! the old footage is gone, an offset takes the place of the comparison.

use super::{PipelineError, gaps, memory};
use crate::conform::{ConformError, Given, Plate, compare};
use crate::geometry::Point;
use crate::pictures::{Sequence, probe};
use crate::project::Document;
use crate::project::conform::Note;
use crate::project::schema::MAX_FRAMES;
use crate::scene::conform::{Conform, FrameMap, Placement, Source};
use crate::scene::{Footage, FrameNumber, FramePattern, Progress};
use serde_json::{Map, Value, json};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Greatest difference of two proportions that are the same, as a share: sizes are whole numbers.
const SAME_PROPORTIONS: f64 = 0.01;

/// The new footage of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct NewFootage {
    /// The path of its files, with one `%d` or `%0Nd`.
    pub pattern: String,
    /// The folder from which the pattern starts.
    pub folder: PathBuf,
    /// Its frames; `None` takes all files.
    pub frames: Option<RangeInclusive<FrameNumber>>,
    /// Its frames a second; `None` takes those of the old footage.
    pub fps: Option<f64>,
    /// What is known of the place of the old picture in the new one.
    pub given: Given,
    /// What is added to the numbers of frames. Then no picture is compared.
    pub offset: Option<FrameNumber>,
    /// Whether a frame without a file shows the picture before it; `None` takes what holds for the old footage.
    pub held: Option<bool>,
}

/// A document for its new footage.
#[derive(Clone, Debug, PartialEq)]
pub struct Conformed {
    /// The document. Its footage's pattern starts from the folder of the new footage.
    pub document: Document,
    /// Where frames and places went.
    pub conform: Conform,
    /// What did not simply go with its drawing.
    pub notes: Vec<Note>,
    /// What was added to the numbers of frames, where no picture was compared.
    pub offset: Option<FrameNumber>,
}

/// Moves a document in `folder` to new footage. It runs on the caller's rayon pool, and the result does not depend on the pool.
///
/// # Errors
///
/// A pattern without files, frames that cannot be read, footages without anything in common, lists that cannot be read, not enough memory, or
/// [`PipelineError::Cancelled`].
pub fn conform(
    document: &Document,
    folder: &Path,
    new: &NewFootage,
    progress: &dyn Progress,
) -> Result<Conformed, PipelineError> {
    let old = &document.scene.footage;
    let footage = footage(new, old)?;
    let conform = match new.offset {
        Some(by) => Conform { placement: placement(&new.given, old, &footage), frames: moved(old, &footage, by)? },
        None => compared(document, folder, &footage, new, progress)?,
    };
    let failed = |error: crate::project::FieldError| PipelineError::Field(error.to_string());
    let (document, notes) = document.conformed(&conform, footage).map_err(failed)?;
    Ok(Conformed { document, conform, notes, offset: new.offset })
}

/// The frames by their numbers alone.
fn moved(old: &Footage, new: &Footage, by: FrameNumber) -> Result<FrameMap, PipelineError> {
    let map = FrameMap::offset(old.first..=old.last, new.first..=new.last, by);
    // A slip of sign would leave nothing of the artist's work.
    if map.sources().values().all(|source| matches!(source, Source::New)) {
        return Err(PipelineError::Request(format!(
            "frame offset {by}: none of the old frames, {} to {}, is among the new ones, {} to {}",
            old.first, old.last, new.first, new.last
        )));
    }
    Ok(map)
}

/// The new footage: its files say the frames and the size.
fn footage(new: &NewFootage, old: &Footage) -> Result<Footage, PipelineError> {
    let pattern = FramePattern::parse(&new.pattern)?;
    let unlisted = |error| PipelineError::Request(format!("{}: cannot list the files: {error}", new.pattern));
    let existing = pattern.existing(&new.folder).map_err(unlisted)?;
    let there = match &new.frames {
        Some(range) => existing.iter().copied().find(|frame| range.contains(frame)),
        None => existing.first().copied(),
    };
    let first = there.ok_or_else(|| PipelineError::Request(format!("{}: found no file of this name", new.pattern)))?;
    let path = new.folder.join(pattern.path(first));
    let unreadable = |error| PipelineError::Request(format!("{}: {error}", path.display()));
    let (width, height) = probe(&path).map_err(unreadable)?;
    let all = first..=existing.last().copied().unwrap_or(first);
    let range = new.frames.clone().unwrap_or(all);
    let count = i64::from(*range.end()) - i64::from(*range.start()) + 1;
    if count > MAX_FRAMES {
        let extent = format!("found frames {} to {}", range.start(), range.end());
        return Err(PipelineError::Request(format!(
            "{}: {extent}, expected at most {MAX_FRAMES} of them",
            new.pattern
        )));
    }
    let (first, last, fps) = (*range.start(), *range.end(), new.fps.unwrap_or(old.fps));
    Ok(Footage { pattern: new.pattern.clone(), first, last, fps, width, height, held: new.held.unwrap_or(old.held) })
}

/// The placement without a look at pictures: as given, or what makes sizes of the same proportions equal.
fn placement(given: &Given, old: &Footage, new: &Footage) -> Placement {
    let scales = [new.width as f64 / old.width as f64, new.height as f64 / old.height as f64];
    let fitting = (scales[0] / scales[1] - 1.0).abs() <= SAME_PROPORTIONS;
    let scale = given.scale.unwrap_or(if fitting { scales[1] } else { 1.0 });
    Placement { scale, shift: given.shift.unwrap_or(Point::ZERO) }
}

fn compared(
    document: &Document,
    folder: &Path,
    footage: &Footage,
    new: &NewFootage,
    progress: &dyn Progress,
) -> Result<Conform, PipelineError> {
    let (old, sequences) =
        (&document.scene.footage, [("old", &document.scene.footage, folder), ("new", footage, &new.folder)]);
    let mut frames = Vec::new();
    for (which, footage, folder) in sequences {
        memory::to_follow(footage)?;
        let sequence = Sequence::keeping(footage, folder, 0)?;
        gaps::none(&sequence, footage.first..=footage.last).map_err(|error| of_footage(which, error))?;
        frames.push(sequence);
    }
    let plates = [Plate { footage: old, frames: &frames[0] }, Plate { footage, frames: &frames[1] }];
    compare(plates[0], plates[1], &new.given, progress).map_err(|error| match error {
        ConformError::Cancelled(cancelled) => cancelled.into(),
        ConformError::Frame { which, source } => of_footage(which, source.into()),
        other => PipelineError::Request(other.to_string()),
    })
}

fn of_footage(which: &'static str, error: PipelineError) -> PipelineError {
    PipelineError::Footage { which, source: Box::new(error) }
}

impl Conformed {
    /// What is told of frames and places, a line each. Where no picture was compared, nothing is said of what pictures show.
    pub fn told(&self) -> Vec<String> {
        let Placement { scale, shift } = self.conform.placement;
        let moved = format!("the old picture is scaled by {scale:.6} and moved by {:.2}, {:.2} px", shift.x, shift.y);
        let same_place = self.conform.placement.is_same();
        if let Some(by) = self.offset {
            let added = format!("{by} is added to the numbers of frames; no pictures were compared");
            return std::iter::once(added).chain((!same_place).then_some(moved)).chain(self.renumbered()).collect();
        }
        let place = if same_place { "the pictures lie on each other".to_owned() } else { moved };
        let sources = self.conform.frames.sources();
        let of = |kind: fn(&Source) -> bool| -> Vec<FrameNumber> {
            sources.iter().filter(|(_, source)| kind(source)).map(|(frame, _)| *frame).collect()
        };
        let same = of(|source| matches!(source, Source::Same(_)));
        let mut lines =
            vec![place, format!("{} of {} frames show a drawing of the old footage", same.len(), sources.len())];
        let lists = [
            ("drawn again", of(|source| matches!(source, Source::Redrawn(_)))),
            ("new", of(|source| *source == Source::New)),
            ("gone from the old footage", self.conform.frames.removed().collect()),
        ];
        let filled = lists.into_iter().filter(|(_, frames)| !frames.is_empty());
        lines.extend(filled.map(|(what, frames)| format!("{what}: {}", super::report::runs(&frames))));
        lines
    }

    /// What is told of frames that have other numbers.
    fn renumbered(&self) -> Vec<String> {
        let frames = &self.conform.frames;
        let (all, alone) =
            (frames.sources().len(), frames.sources().iter().filter(|(_, source)| **source == Source::New));
        let alone: Vec<FrameNumber> = alone.map(|(frame, _)| *frame).collect();
        let removed: Vec<FrameNumber> = frames.removed().collect();
        let mut lines = vec![format!("{} of {all} frames are frames of the old footage", all - alone.len())];
        let lists = [("not in the old footage", alone), ("not in the new footage, by the old numbers", removed)];
        let filled = lists.into_iter().filter(|(_, frames)| !frames.is_empty());
        lines.extend(filled.map(|(what, frames)| format!("{what}: {}", super::report::runs(&frames))));
        lines
    }

    /// What became of frames and places as JSON: `scale` and `shift`; by new frame what it shows in `frames`; by old frame where the artist's work on
    /// it went in `went`; the old frames that are `gone`; `warnings`. All that need a report of it write this one.
    pub fn report(&self) -> Value {
        let Conform { placement, frames } = &self.conform;
        let shows = |source: &Source| match source {
            Source::Same(old) => json!({"same": old}),
            Source::Redrawn(old) => json!({"redrawn": old}),
            Source::New => json!({"new": true}),
        };
        let sources = frames.sources().iter().map(|(frame, source)| (frame.to_string(), shows(source)));
        let went = frames.old().filter_map(|old| Some((old.to_string(), json!(frames.made(old)?))));
        json!({
            "scale": placement.scale,
            "shift": placement.shift.to_array(),
            "frames": sources.collect::<Map<_, _>>(),
            "went": went.collect::<Map<_, _>>(),
            "gone": frames.removed().collect::<Vec<_>>(),
            "warnings": self.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
    }
}

#[cfg(test)]
mod tests;
