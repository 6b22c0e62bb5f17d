//! Old footage found again in new footage.
//!
//! Work on a shot is bound to its footage: contours lie on its pixels and keys on its frames. Then a plate is delivered again: larger, with a border,
//! with handles, in another grade, and with drawings that were added, left out, held longer or drawn anew. This crate compares both footages
//! and says which new frame shows which old drawing, and where the old picture lies in the new one. What a document has is moved by
//! `rototoon-document`.
//!
//! 1. [`place`](mod@place): the placement to a place of a coarse grid, by correlation
//! 2. [`look`], [`grid`]: how far two pictures differ, whatever their grade
//! 3. [`align`](mod@align): the cheapest way through both footages in their order
//! 4. [`refine`]: the placement to a fraction of a pixel, by frames that show the same drawing; then 2 and 3 again
//!
//! Limits: the placement is one scale and one shift for all frames, without a turn or another aspect. A scale that neither makes widths or heights equal nor
//! is a usual one (2, 1.5, 4/3, 3, 4, and the reverse) must be given. Drawings in another order are new ones.

#![forbid(unsafe_code)]

pub mod align;
pub mod grid;
pub mod look;
pub mod place;
pub mod refine;

use align::Shown;
use grid::Grid;
use look::{Blocks, Look};
use rayon::prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::conform::{Conform, FrameMap, Placement, Source};
use rototoon_base::scene::{Cancelled, Colour, Footage, FrameError, FrameNumber, FrameSource, Progress, Raster};
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Places of the grid on which frames are compared.
const PLACES: f64 = 57_600.0;
/// Old pictures from which the placement is searched.
const MODELS: usize = 4;
/// Old pictures of which those with most ink are taken.
const CANDIDATES: usize = 12;
/// New pictures in which it is searched, on each of two ways to choose them.
const SEARCHED: usize = 24;
/// Pairs of frames by which the placement is refined.
const PAIRS: usize = 10;
/// Least score of a placement.
const LEAST_SCORE: f32 = 0.3;
/// Least number of blocks that both pictures must show: nothing differs where nothing is compared.
const LEAST_BLOCKS: usize = 4;
/// Largest number of pairs of frames that are compared.
const MOST: usize = 25_000_000;

/// What is known of the placement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Given {
    /// Pixels of the new picture for each pixel of the old one.
    pub scale: Option<f64>,
    /// The place of the old picture's corner in the new one.
    pub shift: Option<Point>,
}

/// Why footages cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConformError {
    /// A frame of one of the footages cannot be read.
    #[error("{which} footage: {source}")]
    Frame {
        /// `old` or `new`.
        which: &'static str,
        /// The frame and why.
        source: FrameError,
    },
    /// They are too long.
    #[error("found {old} old and {new} new frames, expected at most {MOST} pairs of them")]
    TooLong {
        /// Number of old frames.
        old: usize,
        /// Number of new frames.
        new: usize,
    },
    /// No frame of the new footage shows anything of the old one.
    #[error("no frame of the new footage shows a drawing of the old one")]
    NothingInCommon,
    /// The caller cancelled the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// One of both footages.
#[derive(Clone, Copy)]
pub struct Plate<'a> {
    /// Its frames and its size.
    pub footage: &'a Footage,
    /// Its pictures.
    pub frames: &'a dyn FrameSource,
}

impl Plate<'_> {
    fn range(&self) -> RangeInclusive<FrameNumber> {
        self.footage.first..=self.footage.last
    }

    fn len(&self) -> usize {
        self.range().count()
    }

    fn size(&self) -> [usize; 2] {
        [self.footage.width, self.footage.height]
    }

    fn picture(&self, index: usize, which: &'static str) -> Result<Arc<Raster<Colour>>, ConformError> {
        // Indices are those of a range of frames.
        let picture = self.frames.picture(self.footage.first + index as FrameNumber);
        picture.map_err(|source| ConformError::Frame { which, source })
    }

    fn pictures(&self, indices: &[usize], which: &'static str) -> Result<Vec<Arc<Raster<Colour>>>, ConformError> {
        let all: Vec<_> = indices.par_iter().map(|&index| self.picture(index, which)).collect();
        all.into_iter().collect()
    }
}

/// Compares two footages. It runs on the caller's rayon pool, and the result does not depend on the pool.
///
/// # Errors
///
/// See [`ConformError`].
pub fn compare(old: Plate, new: Plate, given: &Given, progress: &dyn Progress) -> Result<Conform, ConformError> {
    if old.len().saturating_mul(new.len()) > MOST {
        return Err(ConformError::TooLong { old: old.len(), new: new.len() });
    }
    progress.report("Placing", 0.0)?;
    let coarse = placed(old, new, given, &Span { progress, from: 0.0, to: 0.1 })?;
    let (first, differences) = shown(old, new, &coarse, &Span { progress, from: 0.1, to: 0.5 })?;
    progress.report("Placing", 0.5)?;
    let placement = refined(old, new, given, coarse, &differences)?;
    let map = match placement == coarse {
        true => first,
        false => shown(old, new, &placement, &Span { progress, from: 0.6, to: 1.0 })?.0,
    };
    if !map.sources().values().any(|source| matches!(source, Source::Same(_))) {
        return Err(ConformError::NothingInCommon);
    }
    Ok(Conform { placement, frames: map })
}

/// The part of the progress that a step is.
struct Span<'a> {
    progress: &'a dyn Progress,
    from: f64,
    to: f64,
}

impl Progress for Span<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        self.progress.report(step, self.from + (self.to - self.from) * done)
    }
}

/// The placement to a place of a coarse grid.
fn placed(old: Plate, new: Plate, given: &Given, progress: &dyn Progress) -> Result<Placement, ConformError> {
    let scales = place::scales(old.size(), new.size(), given.scale);
    if let (Some(scale), Some(shift)) = (given.scale, given.shift) {
        return Ok(Placement { scale, shift });
    }
    let models = models(old)?;
    let pictures = old.pictures(&models, "old")?;
    let mut searched: Vec<usize> = models
        .iter()
        .flat_map(|&index| {
            let middle = index * new.len() / old.len();
            let from = middle.saturating_sub(SEARCHED / (2 * MODELS));
            from..(from + SEARCHED / MODELS).min(new.len())
        })
        .chain(spread(new.len(), SEARCHED))
        .collect();
    searched.sort_unstable();
    searched.dedup();
    let targets = new.pictures(&searched, "new")?;
    let [olds, news] = [&pictures, &targets].map(|all| all.iter().map(Arc::as_ref).collect::<Vec<_>>());
    let found = place::found(&olds, &news, &scales, given.shift, progress)?;
    let found = found.filter(|found| found.score >= LEAST_SCORE).ok_or(ConformError::NothingInCommon)?;
    Ok(found.placement)
}

/// Up to `count` indices below `len`, evenly.
fn spread(len: usize, count: usize) -> impl Iterator<Item = usize> {
    let count = count.min(len);
    (0..count).map(move |k| (2 * k + 1) * len / (2 * count))
}

/// The old frames with most ink among some.
fn models(old: Plate) -> Result<Vec<usize>, ConformError> {
    let candidates: Vec<usize> = spread(old.len(), CANDIDATES).collect();
    let grid = Grid::of(old.footage.width, old.footage.height, PLACES);
    let ink = |index: &usize| -> Result<(f32, usize), ConformError> {
        let field = grid::directions(&grid.of_new(&*old.picture(*index, "old")?));
        Ok((field.data().iter().map(|n| n[0] * n[0] + n[1] * n[1]).sum(), *index))
    };
    let inks: Vec<_> = candidates.par_iter().map(ink).collect();
    let mut inks = inks.into_iter().collect::<Result<Vec<_>, _>>()?;
    inks.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    Ok(inks.into_iter().take(MODELS).map(|(_, index)| index).collect())
}

/// The placement by the pairs of frames that differ least.
fn refined(
    old: Plate,
    new: Plate,
    given: &Given,
    coarse: Placement,
    differences: &Raster<f32>,
) -> Result<Placement, ConformError> {
    if given.scale.is_some() && given.shift.is_some() {
        return Ok(coarse);
    }
    let nearest = |j: usize| {
        let row = differences.row(j);
        let i = (0..row.len()).fold(0, |best, i| if row[i] < row[best] { i } else { best });
        (row[i], i, j)
    };
    let mut pairs: Vec<(f32, usize, usize)> = (0..new.len()).map(nearest).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    // Of the better half, spread over the footage: a hold at the beginning would be one drawing ten times.
    pairs.truncate(pairs.len().div_ceil(2).max(PAIRS));
    pairs.sort_by_key(|pair| pair.2);
    let pairs: Vec<_> = spread(pairs.len(), PAIRS).map(|k| pairs[k]).collect();
    let olds = old.pictures(&pairs.iter().map(|pair| pair.1).collect::<Vec<_>>(), "old")?;
    let news = new.pictures(&pairs.iter().map(|pair| pair.2).collect::<Vec<_>>(), "new")?;
    let pictures: Vec<refine::Pair> = olds.iter().zip(&news).map(|(old, new)| [old.as_ref(), new.as_ref()]).collect();
    let scales = place::scales(old.size(), new.size(), given.scale);
    Ok(refine::refined(&pictures, coarse, &scales, [given.scale.is_some(), given.shift.is_some()]))
}

/// What each new frame shows under a placement, and how far each new frame differs from each old one.
fn shown(old: Plate, new: Plate, placement: &Placement, span: &Span) -> Result<(FrameMap, Raster<f32>), ConformError> {
    let grid = Grid::of(new.footage.width, new.footage.height, PLACES);
    let blocks = Blocks::within(&grid, grid.covered(old.size(), placement));
    if blocks.count() < LEAST_BLOCKS {
        return Err(ConformError::NothingInCommon);
    }
    let (all, done) = (old.len() + new.len(), AtomicUsize::new(0));
    let told = |look: Look| {
        let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / all as f64;
        span.progress.report("Comparing frames", span.from + share * (span.to - span.from)).map(|()| look)
    };
    let of_old = |index| Ok(told(Look::of(&grid.of_old(&*old.picture(index, "old")?, placement), &blocks))?);
    let of_new = |index| Ok(told(Look::of(&grid.of_new(&*new.picture(index, "new")?), &blocks))?);
    let olds: Vec<Result<Look, ConformError>> = (0..old.len()).into_par_iter().map(of_old).collect();
    let olds = olds.into_iter().collect::<Result<Vec<_>, _>>()?;
    let news: Vec<Result<Look, ConformError>> = (0..new.len()).into_par_iter().map(of_new).collect();
    let news = news.into_iter().collect::<Result<Vec<_>, _>>()?;
    let rows: Vec<Vec<f32>> = news.par_iter().map(|new| olds.iter().map(|old| old.difference(new)).collect()).collect();
    let differences = Raster::from_fn(olds.len(), news.len(), |i, j| rows[j][i]);
    let bound = align::bound(&differences);
    let beside: Vec<bool> = olds.windows(2).map(|pair| pair[0].difference(&pair[1]) <= HELD).collect();
    let held = (0..olds.len()).map(|i| beside.get(i) == Some(&true) || i > 0 && beside[i - 1]).collect::<Vec<_>>();
    let found = align::align(&differences, &held, bound);
    Ok((map(old, new, &found, &beside), differences))
}

/// Difference up to which neighbours of the old footage show one drawing that is held. Smaller than that of the same drawing in another plate: slow
/// movement is no hold.
const HELD: f32 = 0.05;

/// The map by the indices of frames. `beside[i]` says whether the old frames i and i + 1 show the same.
fn map(old: Plate, new: Plate, found: &[Shown], beside: &[bool]) -> FrameMap {
    let frame = |index: usize| old.footage.first + index as FrameNumber;
    let source = |shown: &Shown| match shown {
        Shown::Same(i) => Source::Same(frame(*i)),
        Shown::Redrawn(i) => Source::Redrawn(frame(*i)),
        Shown::New => Source::New,
    };
    let mut held: Vec<[FrameNumber; 2]> = Vec::new();
    for i in (0..beside.len()).filter(|&i| beside[i]) {
        match held.last_mut() {
            Some([_, last]) if *last == frame(i) => *last = frame(i + 1),
            _ => held.push([frame(i), frame(i + 1)]),
        }
    }
    FrameMap::new(old.range(), new.range().zip(found.iter().map(source)).collect(), held)
}

#[cfg(test)]
mod tests;
