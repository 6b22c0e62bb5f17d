//! Strokes from drawing to drawing, and what an earlier run knows of it.
//!
//! Outward from a drawing each *step* is from one picture to the next one. Between two drawings of the artist the way forwards is steps too, and the way
//! back is one *span*: it needs what came from both sides. A step or a span that was [kept] is taken from there, and its
//! pictures are not looked at. Ink is looked for where a step is not known, so no more than three drawings are in memory.

use super::super::PipelineError;
use super::kept::{self, Numbers, Span};
use super::{Found, Place, Tracing, of_numbers};
use crate::lines::{Drawing, Key, Shown, Stroke, Tracked, bound, carry, is_same};
use crate::scene::{FrameNumber, FrameSource, Mark};
use blake3::Hash;
use std::sync::Arc;

/// A step or a span that may be kept: its key, and the marks of the pictures that are in it.
pub(super) struct Sought {
    key: Hash,
    pictures: Vec<(FrameNumber, Mark)>,
}

/// Strokes on their way from frame to frame.
struct Way {
    /// The frame where they are.
    frame: FrameNumber,
    /// Its ink, if it was looked at and is not that of the place where the way began.
    ink: Option<Drawing>,
    /// The strokes as they are carried.
    last: Vec<Tracked>,
    /// The strokes that the frame shows.
    seen: Vec<Tracked>,
}

impl Tracing<'_> {
    /// Carries the strokes of a place from frame to frame.
    pub(super) fn outward(
        &mut self,
        place: &mut Place,
        frames: Vec<FrameNumber>,
        found: &mut Found,
    ) -> Result<(), PipelineError> {
        if frames.is_empty() {
            return Ok(());
        }
        let all = place.all();
        let numbers = Numbers::new(&all, self.next);
        let by_hand = numbers.ranked(&of_numbers(&all, &place.by_hand));
        // What all steps depend on: which strokes may share ink, and which are the artist's.
        let begun = self.key("outward", &[&numbers.ranked(&all), &by_hand], &[place.frame], &[])?;
        let mut shown: Option<Shown> = None;
        let mut way = Way { frame: place.frame, ink: None, seen: all.clone(), last: all.clone() };
        for frame in frames {
            let strokes = [&numbers.ranked(&way.last)[..], &numbers.ranked(&way.seen)];
            let key = match &begun {
                Some(begun) => self.step("step", Some(begun), (&numbers, &strokes), [way.frame, frame])?,
                None => None,
            };
            if let Some(span) = self.recall(&key, 1, &numbers) {
                self.next += span.new;
                self.pass(1);
                let seen: Vec<Tracked> = span.drawings.iter().flat_map(|strokes| numbers.numbered(strokes)).collect();
                if !seen.is_empty() {
                    way = Way { frame, ink: None, last: numbers.numbered(&span.beside), seen: seen.clone() };
                }
                found.push((frame, seen));
            } else {
                let before = self.next;
                let first = self.ink(place)?;
                let shown = shown.get_or_insert_with(|| {
                    let mut shown = Shown::default();
                    shown.learn(&all, &first);
                    shown.learn_drawn(place.by_hand.iter().copied());
                    shown
                });
                let seen = self.on(&mut way, (place.frame, &first), shown, frame)?;
                place.ink = Some(first);
                let beside = if seen.is_empty() { Vec::new() } else { numbers.ranked(&way.last) };
                let (drawings, new) = (vec![numbers.ranked(&seen)], self.next - before);
                self.keep(key, || Span { drawings, beside, new });
                found.push((frame, seen));
            }
        }
        Ok(())
    }

    /// The step of a way to a frame. Returns what the frame shows. The way began on the frame `first`. Where the frame shows nothing, the way
    /// stays where it is: what comes back behind a blank drawing has its numbers.
    fn on(
        &mut self,
        way: &mut Way,
        (first, ink): (FrameNumber, &Drawing),
        shown: &Shown,
        frame: FrameNumber,
    ) -> Result<Vec<Tracked>, PipelineError> {
        let own = if way.frame == first { None } else { Some(self.ink_of(way.ink.take(), way.frame)?) };
        let from = own.as_ref().unwrap_or(ink);
        let drawing = self.look(frame)?;
        let new = self.next;
        let mut last = carry(from, &way.last, &drawing, &mut self.next);
        let seen: Vec<Tracked> = if is_same(from, &drawing) {
            // It has the same strokes, also those of the artist that lie off the ink, and those that the artist did not draw.
            let began = last.iter().filter(|stroke| stroke.track >= new);
            way.seen.iter().chain(began).cloned().collect()
        } else {
            let traced = shown.traced(&mut last, &drawing, &mut self.next);
            traced.into_iter().map(|(_, stroke)| stroke).collect()
        };
        if seen.is_empty() {
            way.ink = own;
        } else {
            *way = Way { frame, ink: Some(drawing), last, seen: seen.clone() };
        }
        Ok(seen)
    }

    /// Carries the strokes of a place to the next drawing. Returns the place there.
    pub(super) fn between(
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
        if let Some(span) = self.recall(&key, frames.len() + 1, &numbers) {
            self.next += span.new;
            self.pass(2 * frames.len() + 1);
            let mut drawings = span.drawings.iter().map(|strokes| numbers.numbered(strokes));
            found.extend(frames.into_iter().zip(&mut drawings));
            let drawn = drawings.next().unwrap_or_default();
            found.push((to, drawn.clone()));
            let by_hand = place.by_hand.into_iter().chain(drawn.iter().map(|s| s.track)).collect();
            return Ok(Place { frame: to, ink: None, drawn, beside: numbers.numbered(&span.beside), by_hand });
        }
        let begun = self.next;
        let (mut forwards, ink) = self.forwards(&mut place, &looked, &numbers)?;
        let came = forwards.pop().unwrap_or_default();
        let second = self.ink_of(ink, to)?;
        let drawing = self.ink(&mut place)?;
        let first = Key { drawing, drawn: place.drawn, beside: place.beside, by_hand: place.by_hand };
        let mut next = self.next;
        let mut look = |place: usize| self.look(frames.get(place - 1).copied().unwrap_or(to));
        let (drawings, second) = bound(&first, (forwards, came), &mut look, (second, drawn), &mut next)?;
        self.next = next;
        let ranked = drawings.iter().chain([&second.drawn]).map(|strokes| numbers.ranked(strokes)).collect();
        let (beside, new) = (numbers.ranked(&second.beside), self.next - begun);
        self.keep(key, || Span { drawings: ranked, beside, new });
        found.extend(frames.into_iter().zip(drawings));
        found.push((to, second.drawn.clone()));
        let Key { drawing, drawn, beside, by_hand } = second;
        Ok(Place { frame: to, ink: Some(drawing), drawn, beside, by_hand })
    }

    /// Carries all strokes of a place over frames, of which the first one is its own. Returns the strokes on the others, and the ink of the last one if
    /// it was looked at.
    fn forwards(
        &mut self,
        place: &mut Place,
        frames: &[FrameNumber],
        numbers: &Numbers,
    ) -> Result<(Vec<Vec<Tracked>>, Option<Drawing>), PipelineError> {
        let mut all: Vec<Vec<Tracked>> = Vec::with_capacity(frames.len());
        let mut ink = place.ink.take();
        let Some((&first, others)) = frames.split_first() else { return Ok((all, None)) };
        // Strokes are carried from the last drawing that shows any.
        let (mut from, mut last) = (first, place.all());
        for &to in others {
            let key = self.step("forwards", None, (numbers, &[&numbers.ranked(&last)]), [from, to])?;
            let (carried, drawing) = if let Some(span) = self.recall(&key, 1, numbers) {
                self.next += span.new;
                self.pass(1);
                (span.drawings.iter().flat_map(|strokes| numbers.numbered(strokes)).collect(), None)
            } else {
                let before = self.next;
                let own = self.ink_of(ink.take(), from)?;
                let drawing = self.look(to)?;
                let carried = carry(&own, &last, &drawing, &mut self.next);
                ink = Some(own);
                let (drawings, new) = (vec![numbers.ranked(&carried)], self.next - before);
                self.keep(key, || Span { drawings, beside: Vec::new(), new });
                (carried, Some(drawing))
            };
            if !carried.is_empty() {
                self.passed(place, from, ink.take());
                (from, last, ink) = (to, carried.clone(), drawing);
            }
            all.push(carried);
        }
        if others.last().is_some_and(|&end| end != from) {
            self.passed(place, from, ink.take());
        }
        Ok((all, ink))
    }

    /// The ink of a frame that was passed goes back to the place, if it is that of the place.
    fn passed(&self, place: &mut Place, frame: FrameNumber, ink: Option<Drawing>) {
        if frame == place.frame {
            place.ink = ink;
        }
    }

    /// The ink of a frame, if nobody has looked at it.
    fn ink_of(&self, ink: Option<Drawing>, frame: FrameNumber) -> Result<Drawing, PipelineError> {
        ink.map_or_else(|| Ok(Drawing::new(self.frames.picture(frame)?, self.options)), Ok)
    }

    /// The key of a step from frame to frame, with `strokes` that are ranks by `numbers`. `begun` is what all steps of the way depend on.
    fn step(
        &mut self,
        kind: &str,
        begun: Option<&Sought>,
        (numbers, strokes): (&Numbers, &[&[Tracked]]),
        frames: [FrameNumber; 2],
    ) -> Result<Option<Sought>, PipelineError> {
        let known = self.key(kind, strokes, &frames, &[])?;
        // New numbers go on where the last step has ended.
        let ends = numbers.ends(self.next);
        let with = |known: Sought| {
            let mut key = kept::Key::after(&known.key);
            key.count(ends);
            let pictures = begun.iter().flat_map(|begun| begun.pictures.iter().copied()).chain(known.pictures);
            begun.iter().for_each(|begun| {
                key.hashed(&begun.key);
            });
            Sought { pictures: pictures.collect(), key: key.hash() }
        };
        Ok(known.map(with))
    }

    /// The key of a span. `None` if nothing is kept, or nobody knows which pictures these are.
    pub(super) fn key(
        &mut self,
        kind: &str,
        strokes: &[&[Tracked]],
        frames: &[FrameNumber],
        drawn: &[Stroke],
    ) -> Result<Option<Sought>, PipelineError> {
        if self.kept.is_none() {
            return Ok(None);
        }
        let mut key = kept::Key::new(kind, self.options);
        strokes.iter().for_each(|strokes| {
            key.tracked(strokes);
        });
        key.strokes(drawn);
        let mut pictures = Vec::with_capacity(frames.len());
        for &frame in frames {
            self.progress.report("Tracing", self.share())?;
            let Some(mark) = self.frames.mark(frame)? else { return Ok(None) };
            key.hashed(&mark.into());
            pictures.push((frame, mark));
        }
        Ok(Some(Sought { key: key.hash(), pictures }))
    }

    /// What is kept of so many drawings.
    pub(super) fn recall(&mut self, sought: &Option<Sought>, drawings: usize, numbers: &Numbers) -> Option<Arc<Span>> {
        let fits = |span: &Span| span.fits(drawings, numbers, self.next);
        self.kept.recall(&sought.as_ref()?.key, fits)
    }

    /// Keeps a span. Of a picture that has changed during the run nothing is kept.
    pub(super) fn keep(&mut self, sought: Option<Sought>, span: impl FnOnce() -> Span) {
        let Some(Sought { key, pictures }) = sought else { return };
        let is_same = |(frame, mark): &(FrameNumber, Mark)| self.frames.mark(*frame).ok().flatten() == Some(*mark);
        if pictures.iter().all(is_same) {
            self.kept.keep(key, span());
        }
    }
}
