//! Frames that hold a drawing: a film on twos, scanned frame by frame.
//!
//! The pictures of a drawing that was scanned twice differ by noise, and a line that is found in both wobbles by a pixel. The tracker's test
//! for held drawings ([`crate::track::drawings`]) tells them from a drawing that has moved by half a pixel; it looks at pictures with the
//! [contrast of ink](Contrast), so that a new line of light pencil counts as one of ink does. So each drawing is worked on once, in the picture of its first frame, and the frames that hold it take the result as it is.
//!
//! Where a drawing begins does not depend on which frames are asked about: the search goes back to the last change before them.
//!
//! Limits: those of the test. A new line that is much fainter than the other lines of its drawing counts as noise.

use super::PipelineError;
use super::contrast::Contrast;
use crate::scene::{Colour, FrameError, FrameNumber, FrameSource, Progress, Raster};
use crate::track;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The pictures of a film in which each drawing has one picture.
pub(super) struct Holds<'a> {
    frames: &'a dyn FrameSource,
    /// By frame that shows the drawing of an earlier one the first frame of the drawing.
    begun: BTreeMap<FrameNumber, FrameNumber>,
    /// The first frame that was asked about.
    start: FrameNumber,
}

impl<'a> Holds<'a> {
    /// Finds the drawings of a range of frames. The footage begins on the frame `earliest`.
    ///
    /// # Errors
    ///
    /// An unreadable frame, or [`PipelineError::Cancelled`].
    pub fn of(
        frames: &'a dyn FrameSource,
        earliest: FrameNumber,
        range: &RangeInclusive<FrameNumber>,
        progress: &dyn Progress,
    ) -> Result<Self, PipelineError> {
        let start = *range.start();
        let seen = Contrast(frames);
        let from = track::began(&seen, start, earliest, progress)?;
        let drawings = track::drawings(&seen, from..=*range.end(), progress)?;
        let begun = drawings.iter().flat_map(|&[first, last]| (first + 1..=last).map(move |frame| (frame, first)));
        Ok(Self { frames, begun: begun.collect(), start })
    }

    /// A film in which no drawing is held.
    pub fn none(frames: &'a dyn FrameSource) -> Self {
        Self { frames, begun: BTreeMap::new(), start: FrameNumber::MIN }
    }

    /// The first frame of a frame's drawing.
    pub fn first(&self, frame: FrameNumber) -> FrameNumber {
        self.begun.get(&frame).copied().unwrap_or(frame)
    }

    /// Whether a frame shows the drawing of the one before it, which is within the range too.
    pub fn is_held(&self, frame: FrameNumber) -> bool {
        frame > self.start && self.begun.contains_key(&frame)
    }
}

impl FrameSource for Holds<'_> {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        self.frames.picture(self.first(frame))
    }
}
