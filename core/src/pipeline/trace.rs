//! Strokes of line drawings: traced on one frame, and the same strokes on the others.

use super::{PipelineError, frames, memory};
use crate::export::SvgStroke;
use crate::geometry::{Point, polygon};
use crate::lines::{Drawing, Key, Options, Stroke, Tracked, between, carry};
use crate::project::Document;
use crate::project::drawings::{Drawing as Drawn, DrawnStroke};
use crate::project::traced::{TracedDrawing, TracedStroke};
use crate::scene::{FrameNumber, FrameSource, Progress};
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

/// Width of an exported stroke without widths, in pixels of 540 lines.
const PLAIN: f64 = 2.0;

/// Traces the drawings of a document in `folder` and puts the strokes into its field `traced`. It runs on the caller's
/// rayon pool; the result does not depend on the pool.
///
/// Work begins on the document's first drawing within `range` (the complete footage where it is `None`), whose strokes get
/// the numbers 0, 1, … (or the next free ones, where frames outside of `range` have traced strokes). Without drawings it begins on the first frame,
/// which is traced. From there strokes are carried from frame to frame, forwards and backwards. Frames with a drawing keep
/// that drawing's strokes; each gets the number of the carried stroke that it lies on, or a new one. Frames between two
/// drawings are [bound to both](between()). Traced strokes of frames outside of `range` stay; their numbers are not used
/// again.
///
/// # Errors
///
/// [`PipelineError::Request`] for a range outside of the footage, and for fields that cannot be read; an unreadable frame;
/// not enough memory; or [`PipelineError::Cancelled`].
pub fn trace(
    document: &mut Document,
    folder: &Path,
    range: Option<RangeInclusive<FrameNumber>>,
    options: &Options,
    progress: &dyn Progress,
) -> Result<(), PipelineError> {
    let wrong = |error: &dyn std::fmt::Display| PipelineError::Request(error.to_string());
    let footage = &document.scene.footage;
    let range = range.unwrap_or(footage.first..=footage.last);
    if range.is_empty() || *range.start() < footage.first || *range.end() > footage.last {
        let own = format!("{} to {}", footage.first, footage.last);
        let (first, last) = (range.start(), range.end());
        return Err(PipelineError::Request(format!("frames {first} to {last}: expected frames of the footage, {own}")));
    }
    memory::to_trace(footage)?;
    let drawn = document.drawings().map_err(|error| wrong(&error))?.drawings;
    let earlier = document.traced().map_err(|error| wrong(&error))?;
    let sequence = frames(document, folder)?;
    let drawn: Vec<&Drawn> = drawn.iter().filter(|d| range.contains(&d.frame) && !d.strokes.is_empty()).collect();
    let used = earlier.iter().filter(|d| !range.contains(&d.frame)).flat_map(|d| &d.strokes).map(|s| s.track + 1).max();
    // Frames between two drawings are looked at twice.
    let twice: usize = drawn.windows(2).map(|pair| (pair[0].frame + 1..pair[1].frame).count()).sum();
    let mut tracing = Tracing {
        frames: &sequence,
        drawn,
        options,
        progress,
        all: range.clone().count() + twice,
        done: 0,
        next: used.unwrap_or(0),
    };
    let mut found = tracing.all(&range)?;
    found.extend(earlier.into_iter().filter(|drawing| !range.contains(&drawing.frame)));
    found.sort_by_key(|drawing| drawing.frame);
    document.set_traced(&found);
    Ok(())
}

/// The traced strokes of a document, one for each number.
pub(super) fn strokes_to_export(document: &Document) -> Result<Vec<SvgStroke>, PipelineError> {
    let traced = document.traced().map_err(|error| PipelineError::Request(error.to_string()))?;
    let mut strokes: BTreeMap<usize, SvgStroke> = BTreeMap::new();
    for (frame, stroke) in
        traced.into_iter().flat_map(|drawing| drawing.strokes.into_iter().map(move |s| (drawing.frame, s)))
    {
        let known = strokes.entry(stroke.track).or_insert_with(|| SvgStroke {
            track: stroke.track,
            points: BTreeMap::new(),
            closed: stroke.closed,
            width: mean(&stroke.widths).unwrap_or(PLAIN * document.scene.footage.height as f64 / 540.0),
            colour: stroke.colour.unwrap_or_default(),
            fill: stroke.fill,
            lined: !stroke.fill || !stroke.widths.is_empty(),
        });
        known.points.insert(frame, stroke.points);
    }
    let mut strokes: Vec<SvgStroke> = strokes.into_values().collect();
    let largest = |s: &SvgStroke| s.points.values().map(|points| area(points)).fold(0.0, f64::max);
    strokes.sort_by(|a, b| behind((a.fill, largest(a)), (b.fill, largest(b))));
    Ok(strokes)
}

/// The order from back to front: fills are behind lines, and a larger fill is behind a smaller one, such as its hole.
fn behind(a: (bool, f64), b: (bool, f64)) -> Ordering {
    match (a.0, b.0) {
        (true, true) => b.1.total_cmp(&a.1),
        (fill, other) => other.cmp(&fill),
    }
}

fn area(points: &[Point]) -> f64 {
    polygon::signed_area(points).abs()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Tracing at work.
struct Tracing<'a> {
    frames: &'a dyn FrameSource,
    drawn: Vec<&'a Drawn>,
    options: &'a Options,
    progress: &'a dyn Progress,
    all: usize,
    done: usize,
    /// The next new number.
    next: usize,
}

impl Tracing<'_> {
    fn all(&mut self, range: &RangeInclusive<FrameNumber>) -> Result<Vec<TracedDrawing>, PipelineError> {
        let drawn = std::mem::take(&mut self.drawn);
        let start = drawn.first().map_or(*range.start(), |drawing| drawing.frame);
        let first = self.look(start)?;
        let strokes = drawn.first().map_or_else(|| first.strokes(), |drawing| of_drawing(drawing));
        let numbers = self.next..;
        let strokes: Vec<Tracked> = numbers.zip(strokes).map(|(track, stroke)| Tracked::sure(track, stroke)).collect();
        self.next += strokes.len();
        let mut key = Key { drawing: first, drawn: strokes, beside: Vec::new() };
        let mut found = vec![(start, key.drawn.clone())];
        self.outward(&key, (*range.start()..start).rev(), &mut found)?;
        let mut at = start;
        for drawing in drawn.iter().skip(1) {
            key = self.between(&key, at, drawing, &mut found)?;
            at = drawing.frame;
        }
        self.outward(&key, at + 1..=*range.end(), &mut found)?;
        self.progress.report("Tracing", 1.0)?;
        Ok(found.into_iter().map(|(frame, strokes)| written(frame, &strokes)).collect())
    }

    /// Carries the strokes of a key from frame to frame. Two frames are in memory at a time.
    fn outward(
        &mut self,
        key: &Key,
        frames: impl Iterator<Item = FrameNumber>,
        found: &mut Vec<(FrameNumber, Vec<Tracked>)>,
    ) -> Result<(), PipelineError> {
        let mut before: Option<(Drawing, Vec<Tracked>)> = None;
        for frame in frames {
            let (from, last) = before.take().map_or((None, key.all()), |(drawing, strokes)| (Some(drawing), strokes));
            let drawing = self.look(frame)?;
            let carried = carry(from.as_ref().unwrap_or(&key.drawing), &last, &drawing, &mut self.next);
            found.push((frame, carried.clone()));
            before = Some((drawing, carried));
        }
        Ok(())
    }

    /// Carries the strokes of the key on frame `from` to the next drawing. Returns it as a key.
    fn between(
        &mut self,
        key: &Key,
        from: FrameNumber,
        to: &Drawn,
        found: &mut Vec<(FrameNumber, Vec<Tracked>)>,
    ) -> Result<Key, PipelineError> {
        let frames: Vec<FrameNumber> = (from + 1..to.frame).collect();
        let mut next = self.next;
        let mut look = |place: usize| self.look(frames.get(place - 1).copied().unwrap_or(to.frame));
        let (drawings, second) = between(key, frames.len(), &mut look, of_drawing(to), &mut next)?;
        self.next = next;
        found.extend(frames.into_iter().zip(drawings));
        found.push((to.frame, second.drawn.clone()));
        Ok(second)
    }

    /// The ink of a frame.
    fn look(&mut self, frame: FrameNumber) -> Result<Drawing, PipelineError> {
        self.progress.report("Tracing", self.done as f64 / self.all.max(1) as f64)?;
        self.done += 1;
        Ok(Drawing::new(self.frames.picture(frame)?, self.options))
    }
}

/// The strokes of a drawing.
fn of_drawing(drawing: &Drawn) -> Vec<Stroke> {
    drawing.strokes.iter().map(of_drawn).collect()
}

fn of_drawn(drawn: &DrawnStroke) -> Stroke {
    let colour = drawn.colour.unwrap_or_default();
    Stroke { points: drawn.points.clone(), closed: drawn.closed, fill: drawn.fill, colour, ..Stroke::default() }
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
    };
    let mut strokes: Vec<TracedStroke> = strokes.iter().map(stroke).collect();
    strokes.sort_by(|a, b| behind((a.fill, area(&a.points)), (b.fill, area(&b.points))));
    TracedDrawing { frame, strokes }
}
