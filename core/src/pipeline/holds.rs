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
use crate::scene::{Cancelled, Colour, FrameError, FrameNumber, FrameSource, Mark, Progress, Raster};
use crate::track::{self, Cache};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Share of tracing that the search takes, about.
pub(super) const SHARE: f64 = 0.1;

/// A stretch of a stage's progress: its step, and the shares at its ends.
pub(super) struct Stretch<'a> {
    pub progress: &'a dyn Progress,
    pub step: &'static str,
    pub from: f64,
    pub to: f64,
}

impl Progress for Stretch<'_> {
    fn report(&self, _: &str, done: f64) -> Result<(), Cancelled> {
        self.progress.report(self.step, self.from + (self.to - self.from) * done)
    }
}

/// The pictures of a film in which each drawing has one picture.
pub(super) struct Holds<'a> {
    frames: &'a dyn FrameSource,
    /// By frame that shows the drawing of an earlier one the first frame of the drawing.
    begun: BTreeMap<FrameNumber, FrameNumber>,
    /// The first frame that was asked about.
    start: FrameNumber,
}

impl<'a> Holds<'a> {
    /// Finds the drawings of a range of frames. The footage begins on the frame `earliest`. A `cache` may know which frames show the same.
    ///
    /// # Errors
    ///
    /// An unreadable frame, or [`PipelineError::Cancelled`].
    pub fn of(
        frames: &'a dyn FrameSource,
        earliest: FrameNumber,
        range: &RangeInclusive<FrameNumber>,
        cache: Option<&dyn Cache>,
        progress: &dyn Progress,
    ) -> Result<Self, PipelineError> {
        let start = *range.start();
        let seen = Contrast(frames);
        let from = track::began(&seen, start, earliest, cache, progress)?;
        let drawings = track::drawings(&seen, from..=*range.end(), cache, progress)?;
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

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        self.frames.mark(self.first(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Silent;

    /// A ring of light pencil with grain. From frame 2 on there is a line in it, and on frame 4 the ring has moved by half a pixel.
    struct Pencil;

    impl FrameSource for Pencil {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            let mut state = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(frame as u64 + 1);
            let mut picture = Raster::new(320, 270, [0.0; 3]);
            for y in 0..270 {
                for (x, colour) in picture.row_mut(y).iter_mut().enumerate() {
                    let (x, y) = (x as f32 + 0.5 - if frame == 4 { 0.5 } else { 0.0 }, y as f32 + 0.5);
                    let ring = ((x - 160.0).hypot(y - 135.0) - 80.0).abs();
                    let line = if frame >= 2 && (140.0..170.0).contains(&x) { (y - 135.0).abs() } else { 99.0 };
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let grain = (state >> 40) as f32 / (1u64 << 24) as f32 - 0.5;
                    *colour = [0.95 - 0.2 * (1.5 - ring.min(line)).clamp(0.0, 1.0) + 0.02 * grain; 3];
                }
            }
            Ok(Arc::new(picture))
        }
    }

    #[test]
    fn a_new_line_of_light_pencil_is_a_new_drawing() {
        let holds = Holds::of(&Pencil, 0, &(0..=4), None, &Silent).unwrap();
        let first: Vec<FrameNumber> = (0..=4).map(|frame| holds.first(frame)).collect();
        assert_eq!(first, [0, 0, 2, 2, 4]);
    }

    #[test]
    fn where_a_drawing_begins_does_not_depend_on_the_range() {
        let holds = Holds::of(&Pencil, 0, &(3..=4), None, &Silent).unwrap();
        assert_eq!((holds.first(3), holds.first(4)), (2, 4));
        assert!(!holds.is_held(3), "no frame of the range is before it");
        assert!(Holds::of(&Pencil, 0, &(2..=3), None, &Silent).unwrap().is_held(3));
    }
}
