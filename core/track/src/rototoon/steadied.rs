//! Steadies the tracks of a stretch: connects [`steady`](super::steady) with what the solver remembers.

use super::Rototoon;
use super::mechanisms::Mechanism;
use super::pooled::Pooled;
use super::steady::{Member, Wobble};
use crate::contract::job::SpanTrack;
use rototoon_base::geometry::Point;
use std::sync::Arc;

impl Rototoon {
    /// How much the film wobbles, by where each part alone goes without corrections.
    pub(super) fn wobble(&self, stretches: &[Vec<usize>], pooled: &[Arc<Pooled>]) -> Wobble {
        if !self.mechanisms.has(Mechanism::Steadying) {
            return Wobble::default();
        }
        let alone = |&t: &usize| {
            let plain = self.plain.get(&pooled[t].key())?;
            let points = plain.pools.iter().zip(&plain.path).map(|(pool, &h)| pool[h].points.clone()).collect();
            Some(member(plain, points))
        };
        let groups: Vec<Vec<Member>> =
            stretches.iter().map(|stretch| stretch.iter().filter_map(alone).collect()).collect();
        Wobble::measured(&groups)
    }

    /// The steadied tracks of a stretch's members, and whether they are new: found in this run, or changed by their
    /// companions.
    pub(super) fn steadied(
        &mut self,
        mended: &[Arc<Pooled>],
        found: &[bool],
        wobble: &Wobble,
    ) -> Vec<(SpanTrack, bool)> {
        let keys = || mended.iter().map(|pooled| pooled.key());
        let points = |source: &Arc<Pooled>| {
            let finished = self.finished.get(&source.key());
            finished.map(|finished| member(source, finished.points())).unwrap_or_else(|| member(source, Vec::new()))
        };
        let group: Vec<Member> = mended.iter().map(points).collect();
        let steady = wobble.steadied(&group);
        let mut tracks = Vec::new();
        for ((key, points), &found) in keys().zip(&steady).zip(found) {
            let Some(finished) = self.finished.get_mut(&key) else { continue };
            let track = finished.track_along(points);
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
