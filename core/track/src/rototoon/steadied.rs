//! Steadies the tracks of a stretch: connects [`steady`](super::steady) with what the solver remembers.
//!
//! A contour that was steadied lies nearer to its line, and refined from there it finds the line more often. So a film that
//! wobbles is steadied and refined by turns, [`ROUNDS`] times, and steadied last. Steadied contours have coordinates on a grid.
//! So a correction, whose effect on far drawings fades to nothing, changes only what is near it, and the rest is remembered.

use super::Rototoon;
use super::mechanisms::Mechanism;
use super::pooled::Pooled;
use super::steady::{Member, Wobble};
use crate::contract::error::TrackError;
use crate::contract::job::SpanTrack;
use crate::contract::tasks::SharedProgress;
use crate::shared::look::Looks;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use std::sync::Arc;

/// Times that a film which wobbles is refined again.
const ROUNDS: usize = 3;

/// Control points on each drawing, in working pixels.
type Drawn = Vec<Vec<Point>>;

impl Rototoon {
    /// Where each member of a stretch goes alone, without corrections.
    pub(super) fn alone(&self, stretch: &[usize], pooled: &[Option<Arc<Pooled>>]) -> Vec<Member> {
        let alone = |&t: &usize| {
            let plain = self.plain.get(&pooled[t].as_ref()?.key())?;
            let points = plain.pools.iter().zip(&plain.path).map(|(pool, &h)| pool[h].points.clone()).collect();
            Some(member(plain, points))
        };
        stretch.iter().filter_map(alone).collect()
    }

    /// How much the film wobbles, by where the members of each stretch go alone.
    pub(super) fn wobble(&self, alone: &[Vec<Member>]) -> Wobble {
        if self.mechanisms.has(Mechanism::Steadying) { Wobble::measured(alone) } else { Wobble::default() }
    }

    /// The control points of a stretch's members on each of their drawings, steadied and refined by turns.
    pub(super) fn steadied(
        &mut self,
        stretch: &[usize],
        mended: &[Arc<Pooled>],
        wobble: &Wobble,
        frames: &Looks,
        shared: &SharedProgress,
    ) -> Result<Vec<Drawn>, TrackError> {
        let found: Vec<Drawn> = mended.iter().map(|source| self.finished[&source.key()].points()).collect();
        let steady = |points: Vec<Drawn>| {
            let group: Vec<Member> = mended.iter().zip(points).map(|(source, points)| member(source, points)).collect();
            wobble.steadied(&group)
        };
        let mut drawn = steady(found);
        for round in 0..if wobble.steadies() { ROUNDS } else { 0 } {
            let again = |((source, from), &t): ((&Arc<Pooled>, &Drawn), &usize)| {
                let progress = shared.of(t);
                self.finished[&source.key()].refined_again(self.kit(frames, &progress), round, from)
            };
            let members = mended.par_iter().with_max_len(1).zip(&drawn).zip(stretch);
            let refined: Vec<Result<Drawn, TrackError>> = members.map(again).collect();
            let refined = refined.into_iter().collect::<Result<Vec<Drawn>, TrackError>>()?;
            for ((source, from), to) in mended.iter().zip(&drawn).zip(&refined) {
                if let Some(finished) = self.finished.get_mut(&source.key()) {
                    finished.remember(round, from, to);
                }
            }
            drawn = steady(refined);
        }
        Ok(drawn)
    }

    /// The tracks of a stretch's members with these control points, and whether they are new: found in this run, or changed by
    /// other parts. `margins` are those of the joint choice.
    pub(super) fn tracks(
        &mut self,
        mended: &[Arc<Pooled>],
        found: &[bool],
        (drawn, margins): (Vec<Drawn>, Vec<Vec<f64>>),
    ) -> Vec<(SpanTrack, bool)> {
        let mut tracks = Vec::new();
        for (((source, points), margins), &found) in mended.iter().zip(&drawn).zip(margins).zip(found) {
            let Some(finished) = self.finished.get_mut(&source.key()) else { continue };
            let track = finished.track_along(points, margins);
            let new = found || finished.track.as_ref() != Some(&track);
            finished.track = Some(track.clone());
            tracks.push((track, new));
        }
        tracks
    }
}

/// A part between two keys, with these control points on its drawings.
fn member(pooled: &Pooled, points: Vec<Vec<Point>>) -> Member {
    let (first, last) = (f64::from(pooled.job.span.first), points.len().saturating_sub(1));
    let time = |d: usize| {
        let drawing = &pooled.drawings[d];
        match d {
            0 => first,
            _ if d == last => first + (pooled.job.span.len() - 1) as f64,
            _ => first + (drawing.first + drawing.last) as f64 / 2.0,
        }
    };
    let set = |d: usize| d == 0 || d == last || pooled.corrected(d);
    Member {
        key: pooled.key(),
        times: (0..points.len()).map(time).collect(),
        set: (0..points.len()).map(set).collect(),
        points,
    }
}
