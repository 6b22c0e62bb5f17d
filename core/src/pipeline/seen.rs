//! Pictures that were drawn again after they were painted, traced or tracked.
//!
//! Results lie on the pictures that they were made of. A picture that has another drawing under the same name shows none of this by itself. So each stage
//! notes which pictures it has read ([`crate::project::seen`]), and what shows results compares.
//!
//! **What is compared.** The pixels as they are used: decoded, in the footage's size. A picture that was saved again with another compression is the same. Decoding is what
//! costs; so the bytes of the file are compared first. They are the same for nearly all frames, and a megabyte of file takes less than a millisecond. Only a
//! file whose bytes differ is decoded. Both marks are the first 64 bits of BLAKE3.
//!
//! **Limits.** What an artist made is not marked: drawings, keys and clicks. A picture that cannot be read is not named here.

use super::report::runs;
use super::trace::of_picture;
use super::{PipelineError, frames};
use crate::pictures::Sequence;
use crate::project::Document;
use crate::project::seen::{Made, Seen};
use crate::scene::{Colour, FrameError, FrameNumber, FrameSource, Mark, Raster};
use blake3::Hash;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::fs::File;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Pictures, which notes those that are read.
#[derive(Debug)]
pub struct Noted<'a> {
    frames: &'a Sequence,
    seen: Mutex<BTreeMap<FrameNumber, Seen>>,
}

impl<'a> Noted<'a> {
    /// Pictures of which none was read.
    pub fn new(frames: &'a Sequence) -> Self {
        Self::knowing(frames, BTreeMap::new())
    }

    /// Pictures of which some were read before, and are still the same.
    pub fn knowing(frames: &'a Sequence, seen: BTreeMap<FrameNumber, Seen>) -> Self {
        Self { frames, seen: Mutex::new(seen) }
    }

    /// The marks of all pictures that were read.
    pub fn seen(self) -> BTreeMap<FrameNumber, Seen> {
        self.seen.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_noted(&self, frame: FrameNumber) -> bool {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).contains_key(&frame)
    }
}

impl FrameSource for Noted<'_> {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let picture = self.frames.picture(frame)?;
        if !self.is_noted(frame) {
            let pixels = short(self.frames.mark_of(frame, &picture).into());
            let seen = Seen { file: of_file(&self.frames.path(frame)).unwrap_or(0), pixels };
            self.seen.lock().unwrap_or_else(PoisonError::into_inner).insert(frame, seen);
        }
        Ok(picture)
    }

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        // The picture is noted, also if nothing else is asked of it.
        if !self.is_noted(frame) {
            self.picture(frame)?;
        }
        self.frames.mark(frame)
    }
}

/// The first digits of a hash.
fn short(hash: Hash) -> u64 {
    u64::from_be_bytes(hash.as_bytes().first_chunk().copied().unwrap_or_default())
}

/// The mark of a file's bytes; `None` if it cannot be read.
fn of_file(path: &Path) -> Option<u64> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(File::open(path).ok()?).ok()?;
    Some(short(hasher.finalize()))
}

/// A line of text for each of these results of a document in `folder` whose pictures are other ones now; with `range`, on its frames alone.
///
/// # Errors
///
/// An invalid pattern or an invalid field `seen`.
pub fn changed(
    document: &Document,
    folder: &Path,
    made: &[Made],
    range: Option<&RangeInclusive<FrameNumber>>,
) -> Result<Vec<String>, PipelineError> {
    let mut lines = Vec::new();
    // Results mostly come from the same pictures.
    let mut looked: BTreeMap<(FrameNumber, u64, u64), bool> = BTreeMap::new();
    for &made in made {
        let seen = document.seen(made).map_err(|error| PipelineError::Field(error.to_string()))?;
        let footage = &document.scene.footage;
        let is_asked = |frame: &FrameNumber| {
            (footage.first..=footage.last).contains(frame) && range.is_none_or(|range| range.contains(frame))
        };
        let seen: Vec<(FrameNumber, Seen)> = seen.into_iter().filter(|(frame, _)| is_asked(frame)).collect();
        if seen.is_empty() {
            continue;
        }
        let sequence = Sequence::keeping(footage, frames(document, folder)?.folder(), 0)?;
        let open: Vec<(FrameNumber, Seen)> =
            seen.iter().copied().filter(|(frame, seen)| !looked.contains_key(&key(*frame, *seen))).collect();
        let found: Vec<bool> = open.par_iter().map(|(frame, seen)| is_other(&sequence, *frame, *seen)).collect();
        looked.extend(open.iter().zip(found).map(|((frame, seen), other)| (key(*frame, *seen), other)));
        let other: Vec<FrameNumber> =
            seen.iter().filter(|(frame, seen)| looked[&key(*frame, *seen)]).map(|(frame, _)| *frame).collect();
        lines.extend(told(&other, made));
    }
    Ok(lines)
}

fn key(frame: FrameNumber, seen: Seen) -> (FrameNumber, u64, u64) {
    (frame, seen.file, seen.pixels)
}

/// Whether a frame has another picture than the one that was seen.
fn is_other(sequence: &Sequence, frame: FrameNumber, seen: Seen) -> bool {
    if of_file(&sequence.path(frame)) == Some(seen.file) {
        return false;
    }
    sequence.picture(frame).is_ok_and(|picture| short(of_picture(&picture)) != seen.pixels)
}

fn told(frames: &[FrameNumber], made: Made) -> Option<String> {
    let done = made.done();
    match frames {
        [] => None,
        [frame] => Some(format!("the picture of frame {frame} is another one than when it was {done}")),
        frames => Some(format!("the pictures of frames {} are other ones than when they were {done}", runs(frames))),
    }
}
