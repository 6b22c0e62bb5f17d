//! Pictures with the contrast of ink.
//!
//! The test for held drawings has bounds for ink that is much darker than its paper. In a drawing of light pencil a new line is no darker than what
//! the test takes for noise, but tracing finds it, because it looks for ink that is dark for this drawing. So the contrast is raised first: the
//! darkest thing of the picture gets as far from the paper as ink is.
//!
//! The paper is the median of each channel. The darkest (or lightest) thing is what [`RARE`] of the pixels exceed, in the channel that shows it
//! best. Each picture is looked at alone: two scans of one drawing differ little in it, and the answer does not depend on other frames.
//!
//! Limits: where something small is black, as a printed frame number, light pencil stays light.

use super::keeping::CODE;
use crate::scene::{Colour, FrameError, FrameNumber, FrameSource, Mark, Raster};
use crate::track::cache::mark_of;
use std::sync::Arc;

/// Share of the pixels that may be farther from the paper than what is taken to be the darkest thing.
const RARE: f64 = 0.002;
/// Distance of ink from paper.
const FULL: f32 = 0.9;
/// Greatest factor. Grain is raised too.
const MOST: f32 = 4.0;
/// Contrast that is raised by less stays as it is.
const LEAST: f32 = 1.05;
const BINS: usize = 1024;

/// Pictures whose contrast is raised.
pub(super) struct Contrast<'a>(pub &'a dyn FrameSource);

impl FrameSource for Contrast<'_> {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let picture = self.0.picture(frame)?;
        let channels = [0, 1, 2].map(|channel| spread(&picture, channel));
        let range = channels.iter().map(|(_, range)| *range).fold(0.0, f32::max);
        let factor = (FULL / range.max(FULL / MOST)).max(1.0);
        if factor < LEAST {
            return Ok(picture);
        }
        let raised = |colour: Colour| {
            let of = |c: usize| (channels[c].0 + (colour[c] - channels[c].0) * factor).clamp(0.0, 1.0);
            [of(0), of(1), of(2)]
        };
        Ok(Arc::new(Raster::from_fn(picture.width(), picture.height(), |x, y| raised(picture.get(x, y)))))
    }

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        Ok(self.0.mark(frame)?.and_then(|mark| mark_of(&(CODE, "contrast", mark))))
    }
}

/// The median of a channel, and how far the darkest or the lightest thing is from it.
fn spread(picture: &Raster<Colour>, channel: usize) -> (f32, f32) {
    let mut counts = vec![0u64; BINS];
    for colour in picture.data() {
        let value = colour[channel].clamp(0.0, 1.0);
        counts[(value * (BINS - 1) as f32 + 0.5) as usize] += 1;
    }
    let all = picture.data().len() as f64;
    let at = |share: f64| {
        let mut left = share * all;
        let bin = counts.iter().position(|&count| {
            left -= count as f64;
            left < 0.0
        });
        bin.unwrap_or(BINS - 1) as f32 / (BINS - 1) as f32
    };
    let median = at(0.5);
    (median, (median - at(RARE)).max(at(1.0 - RARE) - median))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct One(Raster<Colour>);

    impl FrameSource for One {
        fn picture(&self, _: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            Ok(Arc::new(self.0.clone()))
        }
    }

    /// A line of a shade on paper of another.
    fn raised(paper: f32, ink: f32) -> [f32; 2] {
        let drawing = Raster::from_fn(100, 50, |_, y| [if y == 20 { ink } else { paper }; 3]);
        let made = Contrast(&One(drawing)).picture(0).unwrap();
        [made.get(50, 10)[1], made.get(50, 20)[1]]
    }

    #[test]
    fn light_pencil_becomes_as_dark_as_ink() {
        let near = |[paper, ink]: [f32; 2], expected: [f32; 2]| {
            (paper - expected[0]).abs() < 0.01 && (ink - expected[1]).abs() < 0.02
        };
        assert!(near(raised(0.95, 0.65), [0.95, 0.05]));
        assert!(near(raised(0.95, 0.9), [0.95, 0.75]), "at most four times");
        assert!(near(raised(0.05, 0.35), [0.05, 0.95]), "light lines on dark paper");
    }

    #[test]
    fn ink_and_blank_paper_stay_as_they_are() {
        assert_eq!(raised(0.95, 0.05), [0.95, 0.05]);
        assert!(raised(0.5, 0.5).iter().all(|value| (value - 0.5).abs() < 0.005));
    }
}
