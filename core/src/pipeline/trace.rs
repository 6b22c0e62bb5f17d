//! Strokes of line drawings: traced on one frame, and the same strokes on the others.

mod kept;
mod known;
mod on_keys;
#[cfg(test)]
mod tests;

pub use kept::TraceMemory;
pub use on_keys::trace_drawings;

use super::holds::{Holds, SHARE, Stretch};
use super::seen::Noted;
use super::strokes::{area, behind};
use super::{PipelineError, frames, frames_of, gaps};
use crate::lines::{Drawing, Key, Options, Shown, Stroke, Tracked, between, carry, is_same};
use crate::project::Document;
use crate::project::drawings::{Drawing as Drawn, DrawnStroke};
use crate::project::seen::Made;
use crate::project::traced::{TracedDrawing, TracedStroke};
use crate::scene::{FrameNumber, FrameSource, Progress};
use blake3::Hash;
pub(super) use kept::of_picture;
use kept::{Numbers, Span};
use known::{Known, beside, renamed};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::ops::{Range, RangeInclusive};
use std::path::Path;
use std::sync::Arc;

/// Options of tracing a film.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceOptions {
    /// How lines are found.
    pub lines: Options,
    /// Whether the first frame was traced for itself by an earlier run. A document that has the strokes of that run says so itself.
    pub keep_first: bool,
}

/// Traces the drawings of a document in `folder` and puts the strokes into its field `traced`. It runs on the caller's
/// rayon pool; the result does not depend on the pool.
///
/// Work begins on the document's first drawing within `range` (the complete footage where it is `None`), whose strokes get
/// the numbers 0, 1, …. Without drawings it begins on the first frame,
/// which is traced. From there strokes are carried from frame to frame, forwards and backwards. Frames with a drawing keep
/// that drawing's strokes; each gets the number of the carried stroke that it lies on, or a new one. Frames between two
/// drawings are [bound to both](between()).
///
/// If an earlier run traced the first frame for itself, and the first drawing is a later one, the first frame stays as it was, and the frames between
/// are bound to it and to the drawing. So an edit of one traced drawing costs the lines before it nothing. An earlier run is known by its
/// strokes in the field `traced`, which are all sure there, or by the [options](TraceOptions::keep_first).
///
/// Frames that hold a drawing have its strokes to the last digit, unless the artist drew there.
///
/// Frames outside of `range` stay as they are. The nearest of them before and behind that have a drawing or traced strokes count as
/// drawings: the strokes within have their numbers, as if all frames were traced at once. New strokes have numbers that no frame
/// outside has.
///
/// With a `memory`, spans between drawings that are the same as in an earlier run are taken from it. The result is the same.
///
/// # Errors
///
/// [`PipelineError::Option`] for a range outside of the footage, [`PipelineError::Field`] for fields that cannot be read; an
/// unreadable frame; not enough memory; or [`PipelineError::Cancelled`].
pub fn trace(
    document: &mut Document,
    folder: &Path,
    range: Option<RangeInclusive<FrameNumber>>,
    options: &TraceOptions,
    memory: Option<&mut TraceMemory>,
    progress: &dyn Progress,
) -> Result<(), PipelineError> {
    let footage = &document.scene.footage;
    let range = frames_of(footage, range)?;
    super::memory::to_trace(footage)?;
    let drawn = document.drawings().map_err(|error| wrong(&error))?.drawings;
    let earlier = document.traced().map_err(|error| wrong(&error))?;
    let sequence = frames(document, folder)?;
    gaps::none(&sequence, range.clone())?;
    let beside = beside(&drawn, &earlier, &range);
    let drawn: Vec<&Drawn> = drawn.iter().filter(|d| range.contains(&d.frame) && !d.strokes.is_empty()).collect();
    let used = earlier.iter().filter(|d| !range.contains(&d.frame)).flat_map(|d| &d.strokes).map(|s| s.track + 1).max();
    let search = Stretch { progress, step: "Tracing", from: 0.0, to: SHARE };
    let noted = Noted::new(&sequence);
    let holds = Holds::of(&noted, footage.first, &looked_at(&beside, &range), &search)?;
    let all = looks(&drawn, &beside, &range, &holds);
    let mut tracing = Tracing {
        frames: &holds,
        drawn,
        options: &options.lines,
        keep_first: options.keep_first || is_own(&earlier, *range.start()),
        memory,
        hashes: BTreeMap::new(),
        progress,
        all,
        done: 0,
        next: used.unwrap_or(0),
        unit: footage.height as f64 / 540.0,
    };
    let mut found = tracing.all(&range, &beside)?;
    found.extend(earlier.into_iter().filter(|drawing| !range.contains(&drawing.frame)));
    found.sort_by_key(|drawing| drawing.frame);
    document.set_seen(Made::Traced, range, &noted.seen()).map_err(|error| wrong(&error))?;
    document.set_traced(&found);
    Ok(())
}

/// Tracing at work.
struct Tracing<'a> {
    frames: &'a Holds<'a>,
    drawn: Vec<&'a Drawn>,
    options: &'a Options,
    keep_first: bool,
    memory: Option<&'a mut TraceMemory>,
    /// The hashes of pictures that were looked at.
    hashes: BTreeMap<FrameNumber, Hash>,
    progress: &'a dyn Progress,
    all: usize,
    done: usize,
    /// The next new number.
    next: usize,
    /// Size of a pixel of 540 lines.
    unit: f64,
}

/// A drawing from which strokes are carried. Its ink is looked at where it is needed.
struct Place {
    frame: FrameNumber,
    ink: Option<Drawing>,
    drawn: Vec<Tracked>,
    beside: Vec<Tracked>,
    /// The numbers of strokes that an artist drew.
    by_hand: BTreeSet<usize>,
}

impl Place {
    fn all(&self) -> Vec<Tracked> {
        self.drawn.iter().chain(&self.beside).cloned().collect()
    }
}

/// Traced drawings by frame.
type Found = Vec<(FrameNumber, Vec<Tracked>)>;

impl Tracing<'_> {
    fn all(
        &mut self,
        range: &RangeInclusive<FrameNumber>,
        [before, behind]: &[Option<Known>; 2],
    ) -> Result<Vec<TracedDrawing>, PipelineError> {
        let new = self.next;
        let mut drawn = std::mem::take(&mut self.drawn).into_iter();
        let mut found = Found::new();
        let keep =
            |frame: FrameNumber| self.keep_first && self.frames.first(frame) != self.frames.first(*range.start());
        let mut place = match (before, drawn.as_slice(), behind) {
            (Some(known), ..) => self.known(known),
            (None, [first, ..], _) if !keep(first.frame) => self.begun(first.frame, drawn.next())?,
            (None, [], Some(known)) if !keep(known.frame) => self.known(known),
            (None, ..) => self.begun(*range.start(), None)?,
        };
        found.push((place.frame, place.drawn.clone()));
        let back = self.drawings(*range.start()..place.frame).into_iter().rev().collect();
        self.outward(&mut place, back, &mut found)?;
        for drawing in drawn {
            place = self.between(place, drawing.frame, of_drawing(drawing), &mut found)?;
        }
        match behind {
            Some(known) if place.frame < known.frame => self.up_to(place, known, new, &mut found)?,
            _ => {
                let rest = self.drawings(place.frame + 1..range.end() + 1);
                self.outward(&mut place, rest, &mut found)?;
            }
        }
        self.progress.report("Tracing", 1.0)?;
        let found = held(found, *range.end());
        let within = found.into_iter().filter(|(frame, _)| range.contains(frame));
        Ok(within.map(|(frame, strokes)| written(frame, &strokes)).collect())
    }

    /// The frames of a range on which a drawing begins.
    fn drawings(&self, range: Range<FrameNumber>) -> Vec<FrameNumber> {
        range.filter(|&frame| !self.frames.is_held(frame)).collect()
    }

    /// The place of a drawing outside of the range.
    fn known(&mut self, known: &Known) -> Place {
        let drawn = known.tracked(self.unit, &mut self.next);
        let mut by_hand = known.by_hand.clone();
        if known.is_drawn() {
            by_hand.extend(drawn.iter().map(|stroke| stroke.track));
        }
        Place { frame: known.frame, ink: None, drawn, beside: Vec::new(), by_hand }
    }

    /// Carries the strokes of a place up to a drawing behind the range, whose numbers those take that are not below `new`.
    fn up_to(&mut self, place: Place, known: &Known, new: usize, found: &mut Found) -> Result<(), PipelineError> {
        let own = known.tracked(self.unit, &mut self.next.clone());
        let there = self.between(place, known.frame, known.strokes(), found)?;
        let used = found.iter().flat_map(|(_, strokes)| strokes).map(|stroke| stroke.track).collect();
        let names = renamed(&there.drawn, &own, new, &used);
        for stroke in found.iter_mut().flat_map(|(_, strokes)| strokes) {
            stroke.track = names.get(&stroke.track).copied().unwrap_or(stroke.track);
        }
        Ok(())
    }

    /// The place at which work begins: a drawing, or the traced picture of the frame `first`.
    fn begun(&mut self, first: FrameNumber, drawing: Option<&Drawn>) -> Result<Place, PipelineError> {
        let frame = drawing.map_or(first, |drawing| drawing.frame);
        let numbers = self.next..;
        let sure = |strokes: Vec<Stroke>| -> Vec<Tracked> {
            numbers.zip(strokes).map(|(track, stroke)| Tracked::sure(track, stroke)).collect()
        };
        let mut place = Place { frame, ink: None, drawn: Vec::new(), beside: Vec::new(), by_hand: BTreeSet::new() };
        if let Some(drawing) = drawing {
            place.drawn = sure(of_drawing(drawing));
            place.by_hand = place.drawn.iter().map(|stroke| stroke.track).collect();
        } else {
            let key = self.key("first", &[], &[frame], &[])?;
            let numbers = Numbers::new([], self.next);
            place.drawn = if let Some(span) = self.recall(key) {
                self.done += 1;
                span.drawings.iter().flat_map(|strokes| numbers.numbered(strokes)).collect()
            } else {
                let ink = self.look(frame)?;
                let strokes = sure(ink.strokes());
                place.ink = Some(ink);
                let (drawings, new) = (vec![numbers.ranked(&strokes)], strokes.len());
                self.keep(key, || Span { drawings, beside: Vec::new(), new });
                strokes
            };
        }
        self.next += place.drawn.len();
        Ok(place)
    }

    /// Carries the strokes of a place from frame to frame. Two frames are in memory at a time.
    fn outward(&mut self, place: &mut Place, frames: Vec<FrameNumber>, found: &mut Found) -> Result<(), PipelineError> {
        if frames.is_empty() {
            return Ok(());
        }
        let (all, next) = (place.all(), self.next);
        let numbers = Numbers::new(&all, next);
        let looked: Vec<FrameNumber> = [place.frame].into_iter().chain(frames.iter().copied()).collect();
        let by_hand = of_numbers(&all, &place.by_hand);
        let key = self.key("outward", &[&numbers.ranked(&all), &numbers.ranked(&by_hand)], &looked, &[])?;
        if let Some(span) = self.recall(key) {
            self.next += span.new;
            self.done += frames.len();
            found.extend(frames.into_iter().zip(span.drawings.iter().map(|strokes| numbers.numbered(strokes))));
            return Ok(());
        }
        let first = self.ink(place)?;
        let mut shown = Shown::default();
        shown.learn(&all, &first);
        shown.learn_drawn(place.by_hand.iter().copied());
        let mut before: Option<Drawing> = None;
        let (mut last, mut seen) = (all.clone(), all);
        let mut drawings = Vec::new();
        for frame in frames {
            let drawing = self.look(frame)?;
            let from = before.as_ref().unwrap_or(&first);
            let new = self.next;
            last = carry(from, &last, &drawing, &mut self.next);
            if is_same(from, &drawing) {
                // It has the same strokes, also those of the artist that lie off the ink, and those that the artist did not draw.
                seen.extend(last.iter().filter(|stroke| stroke.track >= new).cloned());
            } else {
                let own = shown.traced(&mut last, &drawing, &mut self.next);
                seen = own.into_iter().map(|(_, stroke)| stroke).collect();
            }
            drawings.push(numbers.ranked(&seen));
            found.push((frame, seen.clone()));
            before = Some(drawing);
        }
        place.ink = Some(first);
        let new = self.next - next;
        self.keep(key, || Span { drawings, beside: Vec::new(), new });
        Ok(())
    }

    /// Carries the strokes of a place to the next drawing. Returns the place there.
    fn between(
        &mut self,
        mut place: Place,
        to: FrameNumber,
        drawn: Vec<Stroke>,
        found: &mut Found,
    ) -> Result<Place, PipelineError> {
        let frames = self.drawings(place.frame + 1..to);
        let numbers = Numbers::new(place.drawn.iter().chain(&place.beside), self.next);
        let before = [numbers.ranked(&place.drawn), numbers.ranked(&place.beside)];
        let looked: Vec<FrameNumber> = [place.frame].into_iter().chain(frames.iter().copied()).chain([to]).collect();
        let by_hand = numbers.ranked(&of_numbers(&place.all(), &place.by_hand));
        let key = self.key("between", &[&before[0], &before[1], &by_hand], &looked, &drawn)?;
        if let Some(span) = self.recall(key) {
            self.next += span.new;
            self.done += 2 * frames.len() + 1;
            let mut drawings = span.drawings.iter().map(|strokes| numbers.numbered(strokes));
            found.extend(frames.into_iter().zip(&mut drawings));
            let drawn = drawings.next().unwrap_or_default();
            found.push((to, drawn.clone()));
            let by_hand = place.by_hand.into_iter().chain(drawn.iter().map(|s| s.track)).collect();
            return Ok(Place { frame: to, ink: None, drawn, beside: numbers.numbered(&span.beside), by_hand });
        }
        let drawing = self.ink(&mut place)?;
        let first = Key { drawing, drawn: place.drawn, beside: place.beside, by_hand: place.by_hand };
        let mut next = self.next;
        let mut look = |place: usize| self.look(frames.get(place - 1).copied().unwrap_or(to));
        let (drawings, second) = between(&first, frames.len(), &mut look, drawn, &mut next)?;
        let new = next - self.next;
        self.next = next;
        let ranked = drawings.iter().chain([&second.drawn]).map(|strokes| numbers.ranked(strokes)).collect();
        let beside = numbers.ranked(&second.beside);
        self.keep(key, || Span { drawings: ranked, beside, new });
        found.extend(frames.into_iter().zip(drawings));
        found.push((to, second.drawn.clone()));
        let Key { drawing, drawn, beside, by_hand } = second;
        Ok(Place { frame: to, ink: Some(drawing), drawn, beside, by_hand })
    }

    /// The key of a span, if spans are kept.
    fn key(
        &mut self,
        kind: &str,
        strokes: &[&[Tracked]],
        frames: &[FrameNumber],
        drawn: &[Stroke],
    ) -> Result<Option<Hash>, PipelineError> {
        if self.memory.is_none() {
            return Ok(None);
        }
        let mut key = kept::Key::new(kind, self.options);
        strokes.iter().for_each(|strokes| {
            key.tracked(strokes);
        });
        key.strokes(drawn);
        for &frame in frames {
            if !self.hashes.contains_key(&frame) {
                self.progress.report("Tracing", self.share())?;
                self.hashes.insert(frame, of_picture(&*self.frames.picture(frame)?));
            }
            key.picture(&self.hashes[&frame]);
        }
        Ok(Some(key.hash()))
    }

    fn recall(&mut self, key: Option<Hash>) -> Option<Arc<Span>> {
        self.memory.as_mut()?.recall(&key?)
    }

    fn keep(&mut self, key: Option<Hash>, span: impl FnOnce() -> Span) {
        if let (Some(memory), Some(key)) = (self.memory.as_mut(), key) {
            memory.keep(key, span());
        }
    }

    /// The ink of a place, which is taken from it.
    fn ink(&mut self, place: &mut Place) -> Result<Drawing, PipelineError> {
        match place.ink.take() {
            Some(ink) => Ok(ink),
            None => Ok(Drawing::new(self.frames.picture(place.frame)?, self.options)),
        }
    }

    /// The ink of a frame.
    fn look(&mut self, frame: FrameNumber) -> Result<Drawing, PipelineError> {
        self.progress.report("Tracing", self.share())?;
        self.done += 1;
        Ok(Drawing::new(self.frames.picture(frame)?, self.options))
    }

    /// The share of the work that is done.
    fn share(&self) -> f64 {
        SHARE + (1.0 - SHARE) * (self.done as f64 / self.all.max(1) as f64).min(1.0)
    }
}

/// Whether an earlier run traced a frame for itself.
fn is_own(earlier: &[TracedDrawing], frame: FrameNumber) -> bool {
    let sure = |drawing: &TracedDrawing| drawing.strokes.iter().all(|stroke| stroke.confidence.is_none());
    earlier.iter().any(|drawing| drawing.frame == frame && !drawing.strokes.is_empty() && sure(drawing))
}

/// Traced drawings and, up to the frame `end`, those of the frames between: each holds the one before it.
fn held(mut found: Found, end: FrameNumber) -> Found {
    found.sort_by_key(|(frame, _)| *frame);
    let nexts = found.iter().skip(1).map(|(frame, _)| *frame).chain([end.saturating_add(1)]).collect::<Vec<_>>();
    let shown = found.iter().zip(nexts).flat_map(|((frame, strokes), next)| {
        (*frame..next.max(frame.saturating_add(1))).map(move |frame| (frame, strokes.clone()))
    });
    shown.collect()
}

/// The frames that are looked at for those of a range.
fn looked_at(
    [before, behind]: &[Option<Known>; 2],
    range: &RangeInclusive<FrameNumber>,
) -> RangeInclusive<FrameNumber> {
    let frame = |known: &Option<Known>| known.as_ref().map(|known| known.frame);
    frame(before).unwrap_or(*range.start())..=frame(behind).unwrap_or(*range.end())
}

/// How many pictures are looked at. Frames between two drawings are looked at twice, those that hold a drawing never.
fn looks(drawn: &[&Drawn], beside: &[Option<Known>; 2], range: &RangeInclusive<FrameNumber>, holds: &Holds) -> usize {
    let [before, behind] = beside;
    let begun = |frame: &FrameNumber| !holds.is_held(*frame);
    let outside = [before, behind].map(|known| known.as_ref().map(|known| known.frame));
    let inner = drawn.iter().map(|drawing| drawing.frame);
    let places: Vec<FrameNumber> = outside[0].into_iter().chain(inner).chain(outside[1]).collect();
    let twice: usize = places.windows(2).map(|pair| (pair[0] + 1..pair[1]).filter(begun).count()).sum();
    looked_at(beside, range).filter(begun).count() + twice
}

/// The strokes with these numbers.
fn of_numbers(strokes: &[Tracked], numbers: &BTreeSet<usize>) -> Vec<Tracked> {
    strokes.iter().filter(|stroke| numbers.contains(&stroke.track)).cloned().collect()
}

/// The strokes of a drawing.
fn of_drawing(drawing: &Drawn) -> Vec<Stroke> {
    drawing.strokes.iter().map(of_drawn).collect()
}

fn of_drawn(drawn: &DrawnStroke) -> Stroke {
    let colour = drawn.colour.unwrap_or_default();
    Stroke {
        points: drawn.points.clone(),
        closed: drawn.closed,
        widths: drawn.widths.clone(),
        fill: drawn.fill,
        fill_colour: drawn.fill_colour,
        colour,
    }
}

fn written(frame: FrameNumber, strokes: &[Tracked]) -> TracedDrawing {
    let stroke = |Tracked { track, stroke, confidence }: &Tracked| TracedStroke {
        track: *track,
        points: stroke.points.clone(),
        closed: stroke.closed,
        widths: stroke.widths.clone(),
        colour: Some(stroke.colour),
        confidence: (*confidence < 1.0).then_some(*confidence),
        fill: stroke.fill,
        fill_colour: stroke.fill_colour,
    };
    let mut strokes: Vec<Tracked> = strokes.to_vec();
    // A line with a fill of its own hides what is drawn before it, so such a drawing keeps its order.
    if strokes.iter().all(|tracked| tracked.stroke.fill_colour.is_none()) {
        strokes.sort_by(|a, b| behind_first(&a.stroke, &b.stroke));
    }
    TracedDrawing { frame, strokes: strokes.iter().map(stroke).collect() }
}

/// The order of strokes on a drawing: what is farther back comes first.
fn behind_first(a: &Stroke, b: &Stroke) -> Ordering {
    behind((a.fill, area(&a.points)), (b.fill, area(&b.points)))
}

fn wrong(error: &dyn Display) -> PipelineError {
    PipelineError::Field(error.to_string())
}
