//! In-betweens: the drawings between drawings on key frames.
//!
//! 1. `sure` leaves out pairs that are not sure and would fly across the drawing, and those whose places contradict the
//!    drawings. Their strokes are exchanged half way. `tracks` chains matched strokes through
//!    all drawings. It follows the places of a stroke by proportional arc
//!    length between corners ([`correspond`], `corners`).
//! 2. [`super::peg::propose`] finds groups of strokes that move together, with the hinges between them. `motion`
//!    carries each group from key to key along arcs. Pegs that the user gives replace the groups.
//! 3. `deform` handles the change of a stroke that its group's movement does not explain: a change of shape in the
//!    group's frame, as rigid as possible.
//! 4. `join` makes movements and changes of shape run through several keys with one velocity.
//! 5. `contacts` keeps strokes together that touch on both keys.
//! 6. `credible` looks at the drawing half way. Where strokes are matched unsurely and the flow of the ink ([`crate::flow`])
//!    brings it nearer to both keys, the ink flows instead (`flowing`). Where it stays hardly nearer to the keys than they are to
//!    each other, the earlier key is held: its own strokes are drawn (`present`).
//!
//! `look` gives strokes their widths and colours.
//!
//! Where the movement between the keys was captured from footage, strokes follow it instead: `captured`,
//! [`Sequence::following`].
//!
//! # Limits
//!
//! Two drawings do not show the progress of a movement on each frame between them. Where it matters, a [`Spacing`] or
//! footage gives it. Without them, a movement to and fro between two keys needs a key at its turning point.

mod captured;
mod chained;
mod check;
mod contacts;
mod corners;
mod correspond;
mod credible;
mod deform;
mod flowing;
mod hung;
mod join;
mod joint;
mod leaving;
mod look;
mod motion;
mod present;
mod sure;
mod tangle;
mod tracks;

pub use captured::Captured;
pub use check::{BetweenError, SpacingError};
pub use correspond::Places;
pub use leaving::Leaving;
pub use tracks::{Stand, Track};

use super::matching::Matching;
use super::peg::propose::{self, Moving};
use super::peg::{PegTree, Timing};
use super::stroke::Stroke;
use captured::Following;
use deform::Deform;
use flowing::Way;
use join::{Asked, Ends, Run};
use motion::{Hung, Motion};
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::scene::FrameNumber;
use std::sync::Arc;

/// The progress of the drawings between two keys.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Spacing {
    /// Smooth: one velocity through the keys. A movement that turns back at a key comes to rest there.
    #[default]
    Smooth,
    /// By a timing function.
    Timing(Timing),
    /// By a spacing chart: the share of the way for each frame between the keys, in order. 0 is the drawing of the
    /// earlier key, 1 that of the later one. Shares outside 0 to 1 go beyond the keys.
    Chart(Vec<f64>),
}

impl Spacing {
    /// The share of the way at `u`, the share of the time between the keys, 0 to 1. [`Self::Smooth`] gives `u`.
    pub fn at(&self, u: f64) -> f64 {
        match self {
            Self::Smooth => u,
            Self::Timing(timing) => timing.at(u),
            Self::Chart(shares) => {
                let place = u * (shares.len() + 1) as f64;
                let k = (place.max(0.0) as usize).min(shares.len());
                let share = |k: usize| if k == 0 { 0.0 } else { shares.get(k - 1).copied().unwrap_or(1.0) };
                let within = place - k as f64;
                if within == 0.0 { share(k) } else { share(k) + within * (share(k + 1) - share(k)) }
            }
        }
    }
}

/// A drawing on a key frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Key {
    /// The frame.
    pub frame: FrameNumber,
    /// The strokes, from back to front.
    pub strokes: Vec<Stroke>,
    /// Spacing of the movement to the next key.
    pub spacing: Spacing,
    /// Whether velocities may break at this key: a corner in time.
    pub corner: bool,
}

/// Options of the in-betweens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Strength of arcs, from 0 for straight paths to 1 for full turns about the fixed point of a movement. What turns about a
    /// joint that is drawn always goes all the way round it.
    pub arcs: f64,
    /// Whether shapes change as rigidly as possible. Otherwise points move straight in their group's frame.
    pub rigid: bool,
    /// Whether contacts are kept.
    pub contacts: bool,
    /// The behaviour of strokes that only one of two drawings has.
    pub leaving: Leaving,
    /// Whether movements start from rest at the first key and come to rest at the last key. Otherwise they have
    /// constant speed there.
    pub rest: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { arcs: 0.5, rigid: true, contacts: true, leaving: Leaving::default(), rest: true }
    }
}

/// Pegs given by the user, and the strokes that hang on them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GivenPegs {
    /// The pegs.
    pub tree: PegTree,
    /// The index of the peg of each stroke, by key and stroke. A track hangs on the peg of the first of its strokes
    /// that has one. Strokes without a peg hang on groups that are found.
    pub of: Vec<Vec<Option<usize>>>,
}

/// A stroke of a drawing between keys.
#[derive(Clone, Debug, PartialEq)]
pub struct InBetween {
    /// The stroke. It has as many points as on the first drawing of its track.
    pub stroke: Stroke,
    /// Number of its track, the same on all frames.
    pub track: usize,
    /// 1, or less while it fades.
    pub opacity: f64,
}

/// A change of shape between two keys.
#[derive(Clone, Debug, PartialEq)]
struct Change {
    deform: Deform,
    run: Run,
}

/// Everything from which in-betweens are made, computed once for a list of keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    keys: Vec<Key>,
    tracks: Vec<Track>,
    motion: Motion,
    /// By track and span; `None` where a key of the span lacks the track.
    changes: Vec<Vec<Option<Change>>>,
    /// By track and key: its points in the frame of its carrier.
    local: Vec<Vec<Option<Vec<Point>>>>,
    /// By span.
    contacts: Vec<Vec<contacts::Contact>>,
    captured: Arc<[Captured]>,
    /// By track and span: how it follows a captured part, if it does.
    followed: Vec<Vec<Option<Following>>>,
    /// By span.
    ways: Vec<Way>,
    /// By span: the progress of a flow.
    progress: Vec<Run>,
    /// The same with strokes carried to their counterparts where this one flows.
    matched: Option<Box<flowing::Alternative>>,
    /// By span: the pairs that are carried out.
    matchings: Vec<Matching>,
    /// By span: the strokes of its two keys that are exchanged half way, because their pairs are not carried out.
    exchanged: Vec<[Vec<usize>; 2]>,
    options: Options,
}

impl Sequence {
    /// Prepares the in-betweens of drawings. `matchings[k]` pairs drawing k with the next one. The given pegs carry the
    /// strokes that hang on them; the groups of all other strokes are found.
    ///
    /// # Errors
    ///
    /// A point that cannot be used; frames that do not rise; a number of matchings that does not fit the keys; a
    /// matching or peg list that names something that does not exist; a spacing that does not fit; see
    /// [`BetweenError`].
    pub fn new(
        keys: Vec<Key>,
        matchings: &[Matching],
        pegs: &GivenPegs,
        options: &Options,
    ) -> Result<Self, BetweenError> {
        Self::built(keys, matchings, pegs, options, None)
    }

    /// Like [`Self::new`], but for the frames of one span only: the span after key `base`. It follows the own points of
    /// that key's strokes. The other keys give the velocities at the ends of the span.
    ///
    /// # Errors
    ///
    /// As for [`Self::new`].
    pub fn of_span(
        keys: Vec<Key>,
        matchings: &[Matching],
        pegs: &GivenPegs,
        options: &Options,
        base: usize,
    ) -> Result<Self, BetweenError> {
        Self::built(keys, matchings, pegs, options, Some(base))
    }

    fn built(
        keys: Vec<Key>,
        matchings: &[Matching],
        pegs: &GivenPegs,
        options: &Options,
        base: Option<usize>,
    ) -> Result<Self, BetweenError> {
        check::check(&keys, matchings, pegs, options)?;
        let pairs = keys.windows(2).zip(matchings);
        let (carried, exchanged): (Vec<Matching>, Vec<[Vec<usize>; 2]>) = pairs
            .map(|(two, matching)| sure::carried_out(&two[0].strokes, &two[1].strokes, matching))
            .map(|found| (found.matching, found.exchanged))
            .unzip();
        let matched = Self::carried(keys, carried, exchanged, pegs, options, base);
        Ok(matched.by_their_ways(matchings, pegs, base))
    }

    /// Carries strokes to their counterparts, in every span.
    fn carried(
        keys: Vec<Key>,
        matchings: Vec<Matching>,
        exchanged: Vec<[Vec<usize>; 2]>,
        pegs: &GivenPegs,
        options: &Options,
        base: Option<usize>,
    ) -> Self {
        let tracks = match base {
            Some(base) => tracks::around(&keys, &matchings, base.min(matchings.len())),
            None => tracks::chained(&keys, &matchings),
        };
        let places = motion::by_key(&tracks, keys.len());
        let duration = |pair: &[Key]| f64::from(pair[1].frame) - f64::from(pair[0].frame);
        let durations: Vec<f64> = keys.windows(2).map(duration).collect();
        let spacings: Vec<Spacing> = keys.iter().map(|key| key.spacing.clone()).collect();
        let corners: Vec<bool> = keys.iter().map(|key| key.corner).collect();
        let spans = durations.len();
        let asked =
            Asked { durations: &durations, spacings: &spacings[..spans], corners: &corners, rest: options.rest };
        let motion = moved(&tracks, &places, pegs, &asked, options);
        let local = local(&keys, &places, &motion);
        let changes = local
            .par_iter()
            .zip(&tracks)
            .map(|(places, track)| changes(places, track.closed, &asked, options))
            .collect();
        let followed = vec![vec![None; spans]; tracks.len()];
        let (contacts, captured) = (vec![Vec::new(); spans], Arc::default());
        let (ways, progress) = (vec![Way::Matched; spans], flowing::progress(&asked));
        let options = *options;
        let mut sequence = Self {
            keys,
            tracks,
            motion,
            changes,
            local,
            contacts,
            captured,
            followed,
            ways,
            progress,
            matched: None,
            matchings,
            exchanged,
            options,
        };
        if options.contacts {
            sequence.contacts = sequence.all_touching(base);
        }
        sequence
    }

    /// The touches of every span, or only of the span `base`.
    fn all_touching(&self, base: Option<usize>) -> Vec<Vec<contacts::Contact>> {
        let wanted = |k: usize| base.is_none_or(|base| base == k);
        let touching = |k: usize| if wanted(k) { self.touching(k) } else { Vec::new() };
        (0..self.ways.len()).into_par_iter().map(touching).collect()
    }

    /// Lets strokes without a given peg follow the captured part on which they are drawn, where there is one.
    pub fn following(mut self, captured: Arc<[Captured]>) -> Self {
        if let Some(matched) = self.matched.take() {
            self = self.matched_where_seen(*matched, &captured);
        }
        let spans: Vec<[FrameNumber; 2]> = self.keys.windows(2).map(|pair| [pair[0].frame, pair[1].frame]).collect();
        let of = |(t, track): (usize, &Track)| -> Vec<Option<Following>> {
            let free = !self.motion.on_given_peg(t);
            let part = |(k, &frames)| captured::followed(&captured, track, k, frames).filter(|_| free);
            spans.iter().enumerate().map(part).collect()
        };
        self.followed = self.tracks.par_iter().enumerate().map(of).collect();
        self.captured = captured;
        for (k, way) in self.ways.iter_mut().enumerate() {
            if *way == Way::Held && self.followed.iter().any(|spans| spans[k].is_some()) {
                *way = Way::Matched;
            }
        }
        self
    }

    /// The tracks: which stroke of which drawing belongs together, and the places of its points.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// The drawing on a frame, from back to front. On a key it is that key's drawing. Before the first and after the
    /// last key it is empty.
    pub fn at(&self, frame: FrameNumber) -> Vec<InBetween> {
        let next = self.keys.partition_point(|key| key.frame <= frame);
        let Some(k) = next.checked_sub(1) else { return Vec::new() };
        if self.keys[k].frame == frame {
            return self.on_key(k);
        }
        if next == self.keys.len() {
            return Vec::new();
        }
        self.between(k, frame)
    }

    fn on_key(&self, k: usize) -> Vec<InBetween> {
        let strokes = &self.keys[k].strokes;
        let mut tracks = vec![usize::MAX; strokes.len()];
        for (t, track) in self.tracks.iter().enumerate() {
            if let Some(stand) = track.at(k).filter(|stand| !stand.part) {
                tracks[stand.stroke] = t;
            }
        }
        let drawn = |(stroke, track): (&Stroke, usize)| InBetween { stroke: stroke.clone(), track, opacity: 1.0 };
        strokes.iter().zip(tracks).map(drawn).collect()
    }

    fn between(&self, k: usize, frame: FrameNumber) -> Vec<InBetween> {
        let (from, to) = (&self.keys[k], &self.keys[k + 1]);
        let u = (f64::from(frame) - f64::from(from.frame)) / (f64::from(to.frame) - f64::from(from.frame));
        let present = self.present(k);
        if self.is_held(k) {
            return present.into_iter().filter_map(|t| self.held_at(t, k)).collect();
        }
        let maps = self.motion.maps(k, u, f64::from(frame));
        let mut points = vec![Vec::new(); self.tracks.len()];
        let mut opacity = vec![1.0; self.tracks.len()];
        for &t in &present {
            let moved = || match &self.ways[k] {
                Way::Flows(flow, run) if !self.motion.on_given_peg(t) => self.flowed(t, k, flow, run.share(u)),
                _ => self.moved(t, k, u, &self.motion.of_track(t, &maps)),
            };
            (points[t], opacity[t]) = self.followed_at(t, k, frame).map_or_else(moved, |points| (points, 1.0));
        }
        let closed: Vec<bool> = self.tracks.iter().map(|track| track.closed).collect();
        contacts::close(&self.contacts[k], &mut points, &closed, u);
        let drawn = present.into_iter().map(|t| InBetween {
            stroke: Stroke { points: std::mem::take(&mut points[t]), ..self.look(t, k, u) },
            track: t,
            opacity: opacity[t],
        });
        drawn.collect()
    }

    /// The points of a track that follows a captured part, on a frame.
    fn followed_at(&self, t: usize, k: usize, frame: FrameNumber) -> Option<Vec<Point>> {
        let points = [self.tracks[t].points(k)?, self.tracks[t].points(k + 1)?].map(Vec::as_slice);
        self.followed[t][k].as_ref()?.at(&self.captured, points, frame)
    }

    /// A track's points in a span, and its opacity.
    fn moved(&self, t: usize, k: usize, u: f64, map: &Similarity) -> (Vec<Point>, f64) {
        if let Some(change) = &self.changes[t][k] {
            let shape = change.deform.at(change.run.share(u));
            let beside = |i: usize| Point::new(change.run.beside(2 * i, u), change.run.beside(2 * i + 1, u));
            return (shape.iter().enumerate().map(|(i, p)| map.apply(*p + beside(i))).collect(), 1.0);
        }
        let goes = self.local[t][k].is_some();
        let Some(own) = self.local[t][k].as_ref().or(self.local[t][k + 1].as_ref()) else { return (Vec::new(), 0.0) };
        let spacing = &self.keys[k].spacing;
        let s = if *spacing == Spacing::Smooth { Timing::EaseInOut.at(u) } else { spacing.at(u).clamp(0.0, 1.0) };
        let there = if goes { 1.0 - s } else { s };
        let points: Vec<Point> = own.iter().map(|p| map.apply(*p)).collect();
        if self.is_exchanged(t, k) {
            return (points, f64::from(u8::from(goes == (s < 0.5))));
        }
        self.options.leaving.drawn(points, there)
    }

    /// Whether a track that only one key of a span has is exchanged half way for its counterpart, whose pair is not carried
    /// out.
    fn is_exchanged(&self, t: usize, k: usize) -> bool {
        let on = |key: usize, strokes: &[usize]| {
            self.tracks[t].at(key).is_some_and(|stand| strokes.binary_search(&stand.stroke).is_ok())
        };
        let [before, after] = &self.exchanged[k];
        on(k, before) || on(k + 1, after)
    }

    /// The contacts of a span, between tracks.
    fn touching(&self, k: usize) -> Vec<contacts::Contact> {
        let mut strokes = Vec::with_capacity(self.tracks.len());
        for track in &self.tracks {
            let ends: [&[Point]; 2] = match (track.points(k), track.points(k + 1)) {
                (Some(a), Some(b)) => [a, b],
                _ => [&[], &[]],
            };
            strokes.push(contacts::Between { ends, closed: track.closed });
        }
        contacts::find(&strokes)
    }
}

/// How strokes move that are carried to their counterparts.
fn moved(
    tracks: &[Track],
    places: &[Vec<Option<Vec<Point>>>],
    pegs: &GivenPegs,
    asked: &Asked,
    options: &Options,
) -> Motion {
    let moving: Vec<Moving> =
        tracks.iter().zip(places).map(|(t, places)| Moving { places, closed: t.closed }).collect();
    let hung = Hung { tree: pegs.tree.clone(), pegs: tracks.iter().map(|track| peg_of(track, pegs)).collect() };
    Motion::new(tracks, places, &propose::groups(&moving), &hung, asked, options.arcs)
}

/// The peg of the first of a track's strokes that has one.
fn peg_of(track: &Track, pegs: &GivenPegs) -> Option<usize> {
    let of = |(n, stand): (usize, &Stand)| *pegs.of.get(track.first + n)?.get(stand.stroke)?;
    track.stands.iter().enumerate().find_map(of)
}

/// Points of tracks on the keys, in the frames of their carriers.
fn local(keys: &[Key], places: &[Vec<Option<Vec<Point>>>], motion: &Motion) -> Vec<Vec<Option<Vec<Point>>>> {
    let maps: Vec<_> = (0..keys.len())
        .map(|k| {
            let time = f64::from(keys[k].frame);
            if k + 1 < keys.len() { motion.maps(k, 0.0, time) } else { motion.maps(k.max(1) - 1, 1.0, time) }
        })
        .collect();
    let of = |(t, places): (usize, &Vec<Option<Vec<Point>>>)| {
        let on = |(k, points): (usize, &Option<Vec<Point>>)| {
            let back = motion.of_track(t, &maps[k]).inverse();
            points.as_ref().map(|points| points.iter().map(|&p| back.apply(p)).collect())
        };
        places.iter().enumerate().map(on).collect()
    };
    places.par_iter().enumerate().map(of).collect()
}

fn changes(places: &[Option<Vec<Point>>], closed: bool, asked: &Asked, options: &Options) -> Vec<Option<Change>> {
    let deforms: Vec<Option<Deform>> = places
        .windows(2)
        .map(|pair| Some(Deform::new(pair[0].as_ref()?, pair[1].as_ref()?, closed, options.rigid)))
        .collect();
    let ends: Vec<Option<Ends>> =
        deforms.iter().map(|d| d.as_ref().map(|d| Ends { start: d.way(), end: d.way() })).collect();
    let runs = join::runs(&ends, asked);
    deforms.into_iter().zip(runs).map(|(deform, run)| deform.map(|deform| Change { deform, run })).collect()
}

#[cfg(test)]
mod tests;
