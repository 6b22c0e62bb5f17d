//! Which tracks are drawn between two keys, and in which order.
//!
//! A stroke that falls into pieces, or that pieces join into, is drawn as its pieces. Where the earlier key is held, its own
//! strokes are drawn: a piece has its points on the whole stroke by shares of length, so a drawing of pieces would be up to
//! 0.2 px off the artist's.

use super::flowing::Way;
use super::{InBetween, Sequence, Track};
use crate::stroke::Stroke;
use std::collections::BTreeSet;

impl Sequence {
    /// Whether the earlier key is held between key `k` and the next one, because no movement between them can be believed.
    pub fn is_held(&self, k: usize) -> bool {
        self.ways.get(k) == Some(&Way::Held)
    }

    /// The tracks that are drawn between key `k` and the next one, from back to front. For a stroke in pieces these are
    /// the pieces only. Where the earlier key is held these are its strokes, all of them whole.
    pub fn present(&self, k: usize) -> Vec<usize> {
        if self.is_held(k) {
            return self.own_of(k);
        }
        let parts = |key: usize| -> BTreeSet<usize> {
            let part = |track: &Track| {
                let in_span = track.at(k).is_some() && track.at(k + 1).is_some();
                track.at(key).filter(|stand| in_span && stand.part).map(|stand| stand.stroke)
            };
            self.tracks.iter().filter_map(part).collect()
        };
        let (split, joined) = (parts(k), parts(k + 1));
        let whole = |track: &Track, key: usize, parts: &BTreeSet<usize>| {
            track.at(key).is_some_and(|stand| !stand.part && parts.contains(&stand.stroke))
        };
        // A stroke that joins with others into one, or comes out of one, neither vanishes nor appears.
        let there = |track: &Track| match (track.at(k), track.at(k + 1)) {
            (Some(_), Some(_)) => true,
            (Some(stand), None) => !stand.part && !whole(track, k, &split),
            (None, Some(stand)) => !stand.part && !whole(track, k + 1, &joined),
            (None, None) => false,
        };
        let found = (0..self.tracks.len()).filter(|&t| there(&self.tracks[t])).collect();
        self.in_order(found, k)
    }

    /// Some tracks of a span from back to front: by their strokes on the earlier key. What only the later key has lies
    /// where it lies there, above the track before it.
    fn in_order(&self, mut found: Vec<usize>, k: usize) -> Vec<usize> {
        let mut rank = vec![0.0; self.tracks.len()];
        let mut by_later: Vec<(usize, usize)> =
            found.iter().filter_map(|&t| Some((self.tracks[t].at(k + 1)?.stroke, t))).collect();
        by_later.sort_unstable();
        let mut last = -1.0;
        for (_, t) in by_later {
            last = self.tracks[t].at(k).map_or(last + 1e-6, |stand| stand.stroke as f64);
            rank[t] = last;
        }
        for &t in &found {
            if let Some(stand) = self.tracks[t].at(k) {
                rank[t] = stand.stroke as f64;
            }
        }
        found.sort_by(|&a, &b| rank[a].total_cmp(&rank[b]).then(a.cmp(&b)));
        found
    }

    /// The tracks of the whole strokes of key `k`, from back to front.
    fn own_of(&self, k: usize) -> Vec<usize> {
        let stroke = |track: &Track| track.at(k).filter(|stand| !stand.part).map(|stand| stand.stroke);
        let mut own: Vec<(usize, usize)> =
            self.tracks.iter().enumerate().filter_map(|(t, track)| Some((stroke(track)?, t))).collect();
        own.sort_unstable();
        own.into_iter().map(|(_, t)| t).collect()
    }

    /// A track of the earlier key in a span in which that key is held. `None` if the key does not have it.
    pub(super) fn held_at(&self, t: usize, k: usize) -> Option<InBetween> {
        let points = self.tracks[t].points(k)?.clone();
        Some(InBetween { stroke: Stroke { points, ..self.look(t, k, 0.0) }, track: t, opacity: 1.0 })
    }
}
