//! Strokes of line drawings: traced on one frame, and the same strokes on the others.

mod beside;
mod kept;
mod layers;
mod on_keys;
mod own;
mod steps;
#[cfg(test)]
mod tests;

pub use kept::{Kept, TraceMemory};
pub use on_keys::trace_drawings;

use super::holds::{Holds, SHARE, Stretch};
use super::keeping::Earlier;
use super::seen::Noted;
use super::{PipelineError, frames, frames_of, gaps};
use crate::lines::{Drawing, Options, Stroke, Tracked};
use crate::project::Document;
use crate::project::drawings::{Drawing as Drawn, DrawnStroke};
use crate::project::seen::Made;
use crate::project::traced::{TracedDrawing, TracedStroke};
use crate::scene::{FrameNumber, FrameSource, Progress};
use beside::{Beside, beside, renamed};
pub(super) use kept::of_picture;
use kept::{Numbers, Span};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::ops::{Range, RangeInclusive};
use std::path::Path;

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
/// drawings are [bound to both](crate::lines::bound).
///
/// If an earlier run traced the first frame for itself, and the first drawing is a later one, the first frame stays as it was, and the frames between
/// are bound to it and to the drawing. So an edit of one traced drawing costs the lines before it nothing. An earlier run is known by its
/// strokes in the field `traced`, which are all sure there, or by the [options](TraceOptions::keep_first). A first frame that the artist emptied is
/// not kept.
///
/// Frames that hold a drawing have its strokes to the last digit, unless the artist drew there. A drawing without strokes is one, too: the frame
/// stays empty, and so do those that hold it.
///
/// Frames outside of `range` stay as they are. The nearest of them before and behind that have a drawing or traced strokes count as
/// drawings: the strokes within have their numbers, as if all frames were traced at once. New strokes have numbers that no frame
/// outside has.
///
/// What an earlier run has `kept` is not found again: steps and spans whose strokes and pictures are as they were. The result is the same. Returns how much that was.
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
    kept: Kept<'_>,
    progress: &dyn Progress,
) -> Result<Earlier, PipelineError> {
    let footage = &document.scene.footage;
    let range = frames_of(footage, range)?;
    super::memory::to_trace(footage)?;
    let all_drawn = document.drawings().map_err(|error| wrong(&error))?.drawings;
    let earlier = document.traced().map_err(|error| wrong(&error))?;
    let sequence = frames(document, folder)?;
    gaps::none(&sequence, range.clone())?;
    let beside = beside(&all_drawn, &earlier, &range);
    let drawn: Vec<&Drawn> = all_drawn.iter().filter(|d| range.contains(&d.frame) && !d.strokes.is_empty()).collect();
    let used = earlier.iter().filter(|d| !range.contains(&d.frame)).flat_map(|d| &d.strokes).map(|s| s.track + 1).max();
    let search = Stretch { progress, step: "Tracing", from: 0.0, to: SHARE };
    let noted = Noted::new(&sequence);
    let holds = Holds::of(&noted, footage.first, &looked_at(&beside, &range), kept.cache, &search)?;
    let all = looks(&drawn, &beside, &range, &holds);
    let keep_first = options.keep_first || is_own(&earlier, *range.start());
    let mut tracing = Tracing {
        frames: &holds,
        drawn,
        options: &options.lines,
        keep_first: keep_first && !own::is_emptied(&all_drawn, *range.start()),
        kept,
        earlier: Earlier::default(),
        progress,
        all,
        done: 0,
        next: used.unwrap_or(0),
        unit: footage.height as f64 / 540.0,
    };
    let mut found = tracing.all(&range, &beside)?;
    let earlier_run = tracing.earlier;
    own::numbered(&mut found, &all_drawn, &earlier, used.unwrap_or(0));
    own::emptied(&mut found, &all_drawn, &holds);
    found.extend(earlier.into_iter().filter(|drawing| !range.contains(&drawing.frame)));
    found.sort_by_key(|drawing| drawing.frame);
    document.set_seen(Made::Traced, range, &noted.seen()).map_err(|error| wrong(&error))?;
    document.set_traced(&found);
    Ok(earlier_run)
}

/// Tracing at work.
struct Tracing<'a> {
    frames: &'a Holds<'a>,
    drawn: Vec<&'a Drawn>,
    options: &'a Options,
    keep_first: bool,
    kept: Kept<'a>,
    /// How much an earlier run has done.
    earlier: Earlier,
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
        [before, behind]: &[Option<Beside>; 2],
    ) -> Result<Vec<TracedDrawing>, PipelineError> {
        let new = self.next;
        let beside = [before, behind].into_iter().flatten().filter(|known| known.is_drawn()).map(|known| known.frame);
        let by_hand = self.drawn.iter().map(|drawing| drawing.frame).chain(beside).collect();
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
        layers::arrange(&mut found, &by_hand);
        let found = held(found, *range.end());
        let within = found.into_iter().filter(|(frame, _)| range.contains(frame));
        Ok(within.map(|(frame, strokes)| written(frame, &strokes)).collect())
    }

    /// The frames of a range on which a drawing begins.
    fn drawings(&self, range: Range<FrameNumber>) -> Vec<FrameNumber> {
        range.filter(|&frame| !self.frames.is_held(frame)).collect()
    }

    /// The place of a drawing outside of the range.
    fn known(&mut self, known: &Beside) -> Place {
        // What an earlier run had within the range alone is forgotten, and its numbers are new ones.
        let mut by_hand: BTreeSet<usize> = known.by_hand.range(..self.next).copied().collect();
        let drawn = known.tracked(self.unit, &mut self.next);
        if known.is_drawn() {
            by_hand.extend(drawn.iter().map(|stroke| stroke.track));
        }
        Place { frame: known.frame, ink: None, drawn, beside: Vec::new(), by_hand }
    }

    /// Carries the strokes of a place up to a drawing behind the range, whose numbers those take that are not below `new`.
    fn up_to(&mut self, place: Place, known: &Beside, new: usize, found: &mut Found) -> Result<(), PipelineError> {
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
            place.drawn = if let Some(span) = self.recall(&key, 1, &numbers) {
                self.pass(1);
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
        self.earlier.all += 1;
        Ok(Drawing::new(self.frames.picture(frame)?, self.options))
    }

    /// So many looks at drawings are not needed, since an earlier run had them.
    fn pass(&mut self, looks: usize) {
        self.done += looks;
        self.earlier.all += looks;
        self.earlier.known += looks;
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
    [before, behind]: &[Option<Beside>; 2],
    range: &RangeInclusive<FrameNumber>,
) -> RangeInclusive<FrameNumber> {
    let frame = |known: &Option<Beside>| known.as_ref().map(|known| known.frame);
    frame(before).unwrap_or(*range.start())..=frame(behind).unwrap_or(*range.end())
}

/// How many pictures are looked at. Frames between two drawings are looked at twice, those that hold a drawing never.
fn looks(drawn: &[&Drawn], beside: &[Option<Beside>; 2], range: &RangeInclusive<FrameNumber>, holds: &Holds) -> usize {
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
    TracedDrawing { frame, strokes: strokes.iter().map(stroke).collect() }
}

fn wrong(error: &dyn Display) -> PipelineError {
    PipelineError::Field(error.to_string())
}
