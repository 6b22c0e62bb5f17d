//! Stretches whose tracks are kept in a [cache](crate::contract::cache), beyond the program that found them.
//!
//! **Why.** An artist changes one key of a film with ten spans, and another program tracks it: a farm, or Blender after the file was opened again. What
//! [`Rototoon`] remembers went with the program before. So all spans would be found anew, though nine of them have the same input.
//!
//! **What a stretch depends on.** Its pictures; keys, corrections and absences of all parts on its frames; the depths and the order of its parts; the kind of
//! drawing; the mechanisms; the tracker's code ([`TRACKER`]); and one thing that is measured in the whole film, its [wobble](super::steady). A hash of
//! all that is the mark of its tracks. The wobble is measured where each part would go alone, and that is kept by a mark without it. So a run first gets all parts alone,
//! then the wobble, then the tracks.
//!
//! Numbers are kept to the last bit: what comes from a cache is what would be found.
//!
//! **Limits.** A stretch is what all parts have in common: if one part has no key where the others have one, both spans are one stretch, and a change in either
//! finds both anew. Parts with a single key are not kept.

use super::finer::{Film, Found};
use super::steady::{Member, Wobble};
use super::untouched::Done;
use super::{Looks, Rototoon, Task};
use crate::contract::cache::{Cache, Mark, TRACKER, keep, mark_of, recall};
use crate::contract::error::TrackError;
use crate::contract::job::SpanTrack;
use crate::contract::tasks::Steps;
use crate::shared::drawings::Drawing;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Part, Progress, Scene, Span};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Drawings of the spans whose tracks came from the cache, by name and span.
pub(super) type Drawings = BTreeMap<(String, Span), Vec<Drawing>>;

/// The cache and the marks of a run's stretches.
pub(super) struct Cached {
    cache: Arc<dyn Cache>,
    marks: Vec<Mark>,
    /// The marks of the pictures alone, as the tracker looks at them.
    pictures: Vec<Mark>,
    shown: BTreeMap<FrameNumber, Mark>,
}

/// The stretches of a run that is done.
pub(super) struct Stretches {
    cache: Arc<dyn Cache>,
    shown: BTreeMap<FrameNumber, Mark>,
    pub of: Vec<Stretch>,
}

/// The frames of a stretch, and the mark of its pictures.
pub(super) struct Stretch {
    pub range: Span,
    /// Whether any of its tracks was found in this run.
    pub is_new: bool,
    pictures: Mark,
}

/// What is kept of a stretch.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Entry {
    /// The track of each member.
    pub tracks: Vec<SpanTrack>,
    /// The drawings of each member.
    pub drawings: Vec<Vec<Drawing>>,
    /// By index of the member: its tracks between all of its keys.
    pub finer: Vec<(usize, Span, SpanTrack)>,
    /// Whether each track was found in this run. Empty if all come from the cache.
    #[serde(skip)]
    pub new: Vec<bool>,
    #[serde(skip)]
    pub new_finer: Vec<bool>,
}

/// What the artist made of a part on the frames of a stretch.
#[derive(Serialize)]
struct Input<'a> {
    part: (&'a str, bool, f64, usize),
    keys: Vec<(FrameNumber, &'a [Point])>,
    pins: Vec<(FrameNumber, &'a BTreeMap<usize, Point>)>,
    centers: Vec<(FrameNumber, Point)>,
    depths: Vec<(FrameNumber, f64)>,
    absent: Vec<[FrameNumber; 2]>,
    /// Its spans in the stretch.
    spans: Vec<Span>,
}

impl Rototoon {
    /// The marks of the stretches of a run. `None` without a cache, or if the pictures have no marks.
    pub(super) fn cached(
        &self,
        (scene, film): (&Scene, Option<&Film>),
        (tasks, stretches): (&[Task], &[Vec<usize>]),
        frames: &Looks,
        progress: &dyn Progress,
    ) -> Result<Option<Cached>, TrackError> {
        let Some(cache) = self.cache.clone() else { return Ok(None) };
        let ranges: Vec<Span> = stretches.iter().map(|stretch| range(tasks, stretch)).collect();
        let Some(pictures) = marks(&ranges, frames, progress)? else { return Ok(None) };
        // A run without a film is the same as one with it where the three forms of the scene are.
        let forms = film.map_or([scene; 3], Film::forms);
        let footage = (scene.footage.width, scene.footage.height);
        let of_run = (TRACKER, format!("{:?} {:?}", self.mechanisms, frames.kind));
        let of_stretch = |(stretch, range): (&Vec<usize>, &Span)| {
            let shown: Option<Vec<&Mark>> = range.frames().map(|frame| pictures.get(&frame)).collect();
            let shown = mark_of(&(&of_run, footage, range, shown?))?;
            let spans = |part: usize| stretch.iter().map(|&t| tasks[t]).filter(move |t| t.part == part).map(|t| t.span);
            let inputs = |scene: &'_ Scene| {
                let parts = scene.parts.iter().enumerate();
                let inputs = parts.map(|(p, part)| Input::of(part, *range, spans(p).collect()));
                mark_of(&inputs.filter(Input::says_something).collect::<Vec<_>>())
            };
            let inputs = [scene].into_iter().chain(forms).map(inputs).collect::<Option<Vec<Mark>>>()?;
            Some((mark_of(&(shown, inputs))?, shown))
        };
        let marks = stretches.iter().zip(&ranges).map(of_stretch).collect::<Option<Vec<(Mark, Mark)>>>();
        let (marks, of_pictures) = marks.into_iter().flatten().unzip();
        Ok(Some(Cached { cache, marks, pictures: of_pictures, shown: pictures }))
    }
}

/// The marks of the pictures of some ranges of frames. `None` if one has no mark.
fn marks(
    ranges: &[Span],
    frames: &Looks,
    progress: &dyn Progress,
) -> Result<Option<BTreeMap<FrameNumber, Mark>>, TrackError> {
    let numbers: BTreeSet<FrameNumber> = ranges.iter().flat_map(Span::frames).collect();
    let steps = Steps::new(progress, "Reading frames", numbers.len());
    let mark =
        |&frame: &FrameNumber| steps.step(|| Ok::<_, TrackError>(frames.frames.mark(frame)?.map(|mark| (frame, mark))));
    Vec::from_iter(numbers).par_iter().with_max_len(1).map(mark).collect()
}

/// Whether the pictures of a range have these marks.
fn still_shows(shown: &BTreeMap<FrameNumber, Mark>, range: Span, frames: &Looks) -> bool {
    let is_same = |(frame, mark): (&FrameNumber, &Mark)| frames.frames.mark(*frame).ok().flatten() == Some(*mark);
    shown.range(range.first..=range.last).all(is_same)
}

impl Cached {
    /// Where the members of a stretch would go alone.
    pub fn alone(&self, stretch: usize) -> Option<Vec<Member>> {
        self.get(stretch, &"alone")
    }

    /// Whether the pictures of a range are those that they were when the run began.
    pub fn still_shows(&self, range: Span, frames: &Looks) -> bool {
        still_shows(&self.shown, range, frames)
    }

    /// Keeps where the members of a stretch would go alone.
    pub fn keep_alone(&self, stretch: usize, members: &[Member]) {
        self.keep(stretch, &"alone", &members);
    }

    /// The tracks of a stretch in a film with this wobble.
    pub fn tracks(
        &self,
        stretch: usize,
        wobble: &Wobble,
        (scene, tasks, members): (&Scene, &[Task], &[usize]),
    ) -> Option<Entry> {
        let entry: Entry = self.get(stretch, &wobble.of_film())?;
        entry.fits(scene, tasks, members).then_some(entry)
    }

    /// Keeps the tracks of a stretch in a film with this wobble.
    pub fn keep_tracks(&self, stretch: usize, wobble: &Wobble, entry: &Entry) {
        self.keep(stretch, &wobble.of_film(), entry);
    }

    /// The stretches with these frames, and whether each has new tracks.
    pub fn done(self, ranges: impl Iterator<Item = (Span, bool)>) -> Stretches {
        let of = ranges.zip(self.pictures).map(|((range, is_new), pictures)| Stretch { range, is_new, pictures });
        Stretches { cache: self.cache, shown: self.shown, of: of.collect() }
    }

    fn get<T: DeserializeOwned>(&self, stretch: usize, what: &impl Serialize) -> Option<T> {
        recall(&*self.cache, &(self.marks.get(stretch)?, what))
    }

    fn keep(&self, stretch: usize, what: &impl Serialize, value: &impl Serialize) {
        if let Some(mark) = self.marks.get(stretch) {
            keep(&*self.cache, &(mark, what), value);
        }
    }
}

impl Stretches {
    /// What is kept of the pictures of a stretch.
    pub fn facts<T: DeserializeOwned>(&self, stretch: &Stretch) -> Option<T> {
        recall(&*self.cache, &(stretch.pictures, "facts"))
    }

    /// Keeps something of the pictures of a stretch. Of a picture that has changed during the run nothing is kept.
    pub fn keep_facts(&self, stretch: &Stretch, facts: &impl Serialize, frames: &Looks) {
        if still_shows(&self.shown, stretch.range, frames) {
            keep(&*self.cache, &(stretch.pictures, "facts"), facts);
        }
    }
}

impl Entry {
    /// Whether it has a contour for each frame of each member, as this program would have written it: a folder may be shared with anybody.
    fn fits(&self, scene: &Scene, tasks: &[Task], members: &[usize]) -> bool {
        let is_of = |track: &SpanTrack, t: usize, span: Span| {
            let Task { part, span: Span { first, last } } = tasks[t];
            let count = scene.parts[part].point_count();
            first <= span.first && span.first < span.last && span.last <= last && is_track(track, span.len(), count)
        };
        let has_drawings = |(drawings, &t): (&Vec<Drawing>, &usize)| {
            drawings.iter().all(|drawing| drawing.first <= drawing.last && drawing.last < tasks[t].span.len())
        };
        self.tracks.len() == members.len()
            && self.drawings.len() == members.len()
            && self.drawings.iter().zip(members).all(has_drawings)
            && self.tracks.iter().zip(members).all(|(track, &t)| is_of(track, t, tasks[t].span))
            && self.finer.iter().all(|(m, span, track)| members.get(*m).is_some_and(|&t| is_of(track, t, *span)))
    }

    /// Whether any of the tracks was found in this run.
    pub fn is_new(&self) -> bool {
        self.new.iter().chain(&self.new_finer).any(|new| *new)
    }

    /// Puts the tracks among those of a run.
    pub fn into_run(self, (tasks, members): (&[Task], &[usize]), done: &mut Done, finer: &mut Found) {
        let is = |new: &[bool], k: usize| new.get(k).copied().unwrap_or(false);
        for (k, (m, span, track)) in self.finer.into_iter().enumerate() {
            finer.insert((tasks[members[m]].part, span), (track, is(&self.new_finer, k)));
        }
        for (m, (&t, track)) in members.iter().zip(self.tracks).enumerate() {
            done[t] = Some((track, is(&self.new, m)));
        }
    }
}

impl<'a> Input<'a> {
    fn of(part: &'a Part, Span { first, last }: Span, spans: Vec<Span>) -> Self {
        let range = first..=last;
        let within = |&[a, b]: &[FrameNumber; 2]| (a <= last && b >= first).then(|| [a.max(first), b.min(last)]);
        Self {
            part: (&part.name, part.closed, part.depth, part.point_count()),
            keys: part.keys.range(range.clone()).map(|(&frame, points)| (frame, &points[..])).collect(),
            pins: part.pins.range(range.clone()).map(|(&frame, pins)| (frame, pins)).collect(),
            centers: part.centers.range(range.clone()).map(|(&frame, &center)| (frame, center)).collect(),
            depths: part.depths.range(range).map(|(&frame, &depth)| (frame, depth)).collect(),
            absent: part.absent.iter().filter_map(within).collect(),
            spans,
        }
    }

    /// Whether the part has anything to do with the stretch: a part that is only elsewhere, such as one of another shot, has not.
    fn says_something(&self) -> bool {
        !self.keys.is_empty() || !self.spans.is_empty()
    }
}

/// Whether a track has so many frames with so many points each.
fn is_track(track: &SpanTrack, frames: usize, points: usize) -> bool {
    let has_points = |contour: &Vec<Point>| contour.len() == points && contour.iter().all(|point| point.is_finite());
    let is_sure = |sure: &Vec<f64>| sure.len() == points && sure.iter().all(|share| (0.0..=1.0).contains(share));
    let [contours, confidence] = [track.points.len(), track.confidence.len()];
    [contours, confidence] == [frames; 2] && track.points.iter().all(has_points) && track.confidence.iter().all(is_sure)
}

/// The frames of a stretch.
pub(super) fn range(tasks: &[Task], stretch: &[usize]) -> Span {
    let spans = || stretch.iter().map(|&t| tasks[t].span);
    Span {
        first: spans().map(|span| span.first).min().unwrap_or(0),
        last: spans().map(|span| span.last).max().unwrap_or(0),
    }
}
