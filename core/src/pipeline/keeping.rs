//! What tracing and painting keep beyond the run: steps whose result depends on nothing but what is in their mark.
//!
//! **What is kept.** Steps that cost much and are asked for again after most edits:
//!
//! | step | depends on |
//! | --- | --- |
//! | whether two frames show one drawing ([`super::holds`]) | both pictures |
//! | the strokes of the first picture, a step to the next one, the way between two drawings of the artist ([`super::trace()`]) | their pictures, the strokes that come there, how lines are found |
//! | the regions of a drawing ([`super::fill()`]) | its picture, how lines are found |
//! | where the lines of two drawings are on each other ([`super::fill()`]) | both pictures, how lines are found |
//!
//! Each also depends on the [code](CODE). What costs little is done anew: clicks, colours, and which region is which. So a click costs neither the search
//! for lines nor their registration.
//!
//! **Limits.** Pictures are decoded in every run, since their pixels are in the marks.

use crate::lines::Options;
use crate::scene::{FrameNumber, FrameSource, Mark};
use crate::track::cache::{Cache, keep, recall};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;

/// The mark of the code (`build.rs`).
pub(super) const CODE: &str = env!("ROTOTOON_PIPELINE");

/// How much of a run an earlier one has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Earlier {
    /// The steps that were known.
    pub known: usize,
    /// All steps.
    pub all: usize,
}

impl fmt::Display for Earlier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.known, self.all)
    }
}

/// A cache of what depends on pictures and on how lines are found.
#[derive(Clone, Copy)]
pub(super) struct Keeping<'a> {
    pub cache: Option<&'a dyn Cache>,
    pub frames: &'a dyn FrameSource,
    pub options: &'a Options,
}

impl Keeping<'_> {
    /// The mark of a frame's picture. `None` without a cache.
    pub fn mark(&self, frame: FrameNumber) -> Option<Mark> {
        self.cache.and_then(|_| self.frames.mark(frame).ok().flatten())
    }

    /// What is kept of some pictures.
    pub fn recall<T: DeserializeOwned>(&self, what: &str, pictures: &[Pictured]) -> Option<T> {
        recall(self.cache?, &self.made_from(what, pictures)?)
    }

    /// Keeps something of some pictures. Of a picture that has changed during the run nothing is kept.
    pub fn keep(&self, what: &str, pictures: &[Pictured], value: &impl Serialize) {
        let is_same = |own: &Pictured| self.mark(own.frame) == own.mark;
        if let Some(cache) = self.cache
            && let Some(made_from) = self.made_from(what, pictures)
            && pictures.iter().all(is_same)
        {
            keep(cache, &made_from, value);
        }
    }

    fn made_from<'a>(&'a self, what: &'a str, pictures: &[Pictured]) -> Option<impl Serialize + use<'a>> {
        let marks: Option<Vec<Mark>> = pictures.iter().map(|own| own.mark).collect();
        Some((CODE, what, self.options, marks?))
    }
}

/// A picture that was looked at.
#[derive(Clone, Copy)]
pub(super) struct Pictured {
    /// The frame where it was read.
    pub frame: FrameNumber,
    /// Its mark, if there is a cache and it has one.
    pub mark: Option<Mark>,
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::sync::Mutex;

    /// A cache in memory.
    #[derive(Default)]
    pub struct Store(pub Mutex<BTreeMap<Mark, Vec<u8>>>);

    impl Cache for Store {
        fn get(&self, mark: &Mark) -> Option<Vec<u8>> {
            self.0.lock().unwrap().get(mark).cloned()
        }

        fn put(&self, mark: &Mark, bytes: &[u8]) {
            self.0.lock().unwrap().insert(*mark, bytes.to_vec());
        }
    }
}
