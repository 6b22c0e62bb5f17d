//! Holds: neighbouring frames that show the same drawing.
//!
//! Cartoons are drawn on twos or threes: a drawing is held for some frames, then the next one jumps. Work on each
//! drawing once.
//!
//! **Equal** must forgive the noise of compression, which is everywhere but weak, yet see a pupil that moves by two
//! pixels, which is strong but tiny. A mean over the picture does the reverse. So the difference of two pictures is
//! that of their most different block: the largest root mean square of the colour difference over blocks of 8 × 8
//! pixels, which overlap by half so that a detail of 4 × 4 lies wholly within one of them. Squares favour what is strong
//! over what is spread.
//!
//! A frame is compared with the first frame of the hold, not with its neighbour: a slow fade or drift cannot creep
//! through in small steps.
//!
//! Frames are read in a stream, a few ahead in parallel; see [`HoldOptions::ahead`].

use crate::scene::{Cancelled, Colour, FrameError, FrameNumber, FrameSource, Progress, Raster};
use rayon::prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use std::sync::Arc;

/// How to find holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldOptions {
    /// Largest [`difference`] of pictures that show the same drawing, in 8-bit levels.
    pub tolerance: f32,
    /// How many pictures are decoded at once, at least 1; with the first picture of the hold they are in memory
    /// together. The result does not depend on it.
    pub ahead: usize,
}

impl Default for HoldOptions {
    fn default() -> Self {
        Self { tolerance: 16.0, ahead: 2 }
    }
}

/// Which frames show the same drawing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Holds {
    first: FrameNumber,
    drawings: Vec<FrameNumber>,
}

impl Holds {
    /// The frame where the drawing that `frame` shows is first seen; `None` outside the frames that were looked at.
    pub fn drawing(&self, frame: FrameNumber) -> Option<FrameNumber> {
        let index = usize::try_from(i64::from(frame) - i64::from(self.first)).ok()?;
        self.drawings.get(index).copied()
    }

    /// For each frame in order, the frame where its drawing is first seen.
    pub fn all(&self) -> &[FrameNumber] {
        &self.drawings
    }

    /// The frames where a drawing is first seen, ascending.
    pub fn distinct(&self) -> Vec<FrameNumber> {
        let mut distinct = self.drawings.clone();
        distinct.dedup();
        distinct
    }
}

/// Why holds could not be found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HoldError {
    /// A picture could not be had.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Finds the holds among the frames `first` to `last`, both included; none where `last` is before `first`.
pub fn find_holds(
    source: &dyn FrameSource,
    first: FrameNumber,
    last: FrameNumber,
    options: &HoldOptions,
    progress: &dyn Progress,
) -> Result<Holds, HoldError> {
    const STEP: &str = "finding holds";
    let frames: Vec<FrameNumber> = (first..=last).collect();
    let mut drawings = Vec::with_capacity(frames.len());
    let mut held: Option<(FrameNumber, Arc<Raster<Colour>>)> = None;
    progress.report(STEP, 0.0)?;
    for some in frames.chunks(options.ahead.max(1)) {
        let pictures: Vec<_> = some.par_iter().map(|&frame| source.picture(frame)).collect();
        for (&frame, picture) in some.iter().zip(pictures) {
            let picture = picture?;
            let drawing = match &held {
                Some((first, drawing)) if difference(drawing, &picture) <= options.tolerance => *first,
                _ => {
                    held = Some((frame, picture));
                    frame
                }
            };
            drawings.push(drawing);
        }
        progress.report(STEP, drawings.len() as f64 / frames.len() as f64)?;
    }
    Ok(Holds { first, drawings })
}

/// Half the side of a block, in pixels.
const CELL: usize = 4;

/// How different two pictures are in their most different place: the largest root mean square, over blocks of 8 × 8
/// pixels, of the Euclidean distance of colours, in 8-bit levels. Infinite where the sizes differ.
pub fn difference(a: &Raster<Colour>, b: &Raster<Colour>) -> f32 {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return f32::INFINITY;
    }
    if a.data().is_empty() || std::ptr::eq(a, b) || a.data() == b.data() {
        return 0.0;
    }
    let rows = a.height().div_ceil(CELL);
    let cells: Vec<Vec<f32>> = (0..rows).into_par_iter().map(|row| cell_sums(a, b, row)).collect();
    let mut most = 0.0f32;
    for upper in 0..rows.saturating_sub(1).max(1) {
        let lower = (upper + 1).min(rows - 1);
        for left in 0..cells[0].len().saturating_sub(1).max(1) {
            let right = (left + 1).min(cells[0].len() - 1);
            // In a picture of a single row or column of cells the missing half of a block counts as equal.
            let mut sum = cells[upper][left];
            if right > left {
                sum += cells[upper][right];
            }
            if lower > upper {
                sum += cells[lower][left];
            }
            if right > left && lower > upper {
                sum += cells[lower][right];
            }
            most = most.max(sum);
        }
    }
    255.0 * (most / (4 * CELL * CELL) as f32).sqrt()
}

/// Sums of squared colour differences over the cells of a row of cells; those at the border may be cut.
fn cell_sums(a: &Raster<Colour>, b: &Raster<Colour>, row: usize) -> Vec<f32> {
    let mut sums = vec![0.0; a.width().div_ceil(CELL)];
    for y in row * CELL..((row + 1) * CELL).min(a.height()) {
        let cells = a.row(y).chunks(CELL).zip(b.row(y).chunks(CELL));
        for (sum, (a, b)) in sums.iter_mut().zip(cells) {
            for (a, b) in a.iter().zip(b) {
                *sum += (0..3).map(|c| (a[c] - b[c]) * (a[c] - b[c])).sum::<f32>();
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Silent;
    use proptest::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    struct Pictures(Vec<Raster<Colour>>);

    impl FrameSource for Pictures {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            let picture = usize::try_from(frame - 10).ok().and_then(|i| self.0.get(i));
            let outside = FrameError::Outside { frame, first: 10, last: 9 + self.0.len() as i32 };
            picture.map(|p| Arc::new(p.clone())).ok_or(outside)
        }
    }

    /// A disc with a pupil at `eye`, and noise of ±`noise` levels that `seed` chooses.
    fn drawing(eye: isize, noise: u32, seed: u32) -> Raster<Colour> {
        let mut state = seed.wrapping_mul(747_796_405).wrapping_add(1);
        Raster::from_fn(61, 47, |x, y| {
            let disc = (x as isize - 30).pow(2) + (y as isize - 23).pow(2) < 300;
            let pupil = (x as isize - eye).abs() <= 1 && (y as isize - 20).abs() <= 1;
            let base = if pupil {
                20.0
            } else if disc {
                220.0
            } else {
                140.0
            };
            [0, 1, 2].map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let level = base + ((state >> 16) % (2 * noise + 1)) as f32 - noise as f32;
                level / 255.0
            })
        })
    }

    fn holds(pictures: Vec<Raster<Colour>>, ahead: usize) -> Vec<FrameNumber> {
        let last = 9 + pictures.len() as FrameNumber;
        let options = HoldOptions { ahead, ..HoldOptions::default() };
        find_holds(&Pictures(pictures), 10, last, &options, &Silent).unwrap().all().to_vec()
    }

    #[test]
    fn noise_holds_and_a_pupil_that_moves_does_not() {
        let eyes = [25, 25, 25, 27, 27, 25, 25];
        for noise in [0, 3, 8] {
            for ahead in [0, 1, 2, 5, 100] {
                let pictures = eyes.iter().zip(0..).map(|(&eye, seed)| drawing(eye, noise, seed)).collect();
                assert_eq!(holds(pictures, ahead), [10, 10, 10, 13, 13, 15, 15], "noise {noise}");
            }
        }
    }

    #[test]
    fn a_fade_does_not_creep_through() {
        let fade = (0..12).map(|i| Raster::new(20, 20, [0.02 * i as f32; 3])).collect();
        // Steps of 5.1 levels a channel, 8.8 in colour: one is forgiven.
        assert_eq!(holds(fade, 2), [10, 10, 12, 12, 14, 14, 16, 16, 18, 18, 20, 20]);
    }

    #[test]
    fn answers() {
        let holds = Holds { first: 3, drawings: vec![3, 3, 5, 6, 6] };
        assert_eq!(holds.distinct(), [3, 5, 6]);
        assert_eq!([2, 3, 4, 7, 8].map(|f| holds.drawing(f)), [None, Some(3), Some(3), Some(6), None]);
        assert_eq!(holds.drawing(FrameNumber::MIN), None);
        let none = find_holds(&Pictures(Vec::new()), 5, 4, &HoldOptions::default(), &Silent).unwrap();
        assert_eq!(none.all(), [0; 0]);
    }

    #[test]
    fn errors_and_cancelling() {
        struct Stop(AtomicUsize);
        impl Progress for Stop {
            fn report(&self, _: &str, _: f64) -> Result<(), Cancelled> {
                if self.0.fetch_add(1, Ordering::Relaxed) == 2 { Err(Cancelled) } else { Ok(()) }
            }
        }
        let source = Pictures(vec![drawing(25, 0, 0); 9]);
        let find = |last, progress: &dyn Progress| find_holds(&source, 10, last, &HoldOptions::default(), progress);
        assert_eq!(find(18, &Stop(AtomicUsize::new(0))), Err(HoldError::Cancelled(Cancelled)));
        let outside = FrameError::Outside { frame: 19, first: 10, last: 18 };
        assert_eq!(find(25, &Silent), Err(HoldError::Frame(outside)));
    }

    /// The definition, block by block.
    fn naive(a: &Raster<Colour>, b: &Raster<Colour>) -> f32 {
        let mut most = 0.0f64;
        for top in (0..a.height()).step_by(4) {
            for left in (0..a.width()).step_by(4) {
                let mut sum = 0.0;
                for y in top..(top + 8).min(a.height()) {
                    for x in left..(left + 8).min(a.width()) {
                        sum += (0..3).map(|c| (a.get(x, y)[c] as f64 - b.get(x, y)[c] as f64).powi(2)).sum::<f64>();
                    }
                }
                most = most.max((sum / 64.0).sqrt());
            }
        }
        (255.0 * most) as f32
    }

    proptest! {
        #[test]
        fn difference_is_that_of_the_worst_block(w in 1usize..30, h in 1usize..30, seed in 1u32..9999, rare in 1u32..40) {
            let mut state = seed;
            let mut next = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                state >> 12
            };
            let mut picture = || Raster::from_fn(w, h, |_, _| {
                if next() % rare == 0 { [(next() % 256) as f32 / 255.0; 3] } else { [0.5; 3] }
            });
            let (a, b) = (picture(), picture());
            prop_assert!((difference(&a, &b) - naive(&a, &b)).abs() < 1e-2);
        }
    }

    #[test]
    fn other_sizes_are_never_equal() {
        let of = |w, h| Raster::new(w, h, [0.0f32; 3]);
        assert_eq!(difference(&of(2, 3), &of(3, 2)), f32::INFINITY);
        assert_eq!(difference(&of(0, 0), &of(0, 0)), 0.0);
    }
}
