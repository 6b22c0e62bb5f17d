//! Draws single spans between drawings: matches their strokes and draws the requested frames.
//!
//! A host that stores drawings and in-betweens side by side redraws only the spans that an edit changes. Each span is
//! therefore a function of few drawings ([`keys_of`]): the two at its ends, and, with smooth spacing, those before and
//! after them, which determine the velocities at its ends. Two neighbouring drawings are matched only once.

use super::PipelineError;
use crate::scene::{Cancelled, FrameNumber, Progress, Silent};
use crate::tween::Stroke;
use crate::tween::between::{Captured, GivenPegs, InBetween, Key, Options, Sequence, Spacing};
use crate::tween::matching::{HandPair, Matching, Options as MatchingOptions, match_strokes};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Drawings and the decisions about them.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// The drawings, in ascending order of frames.
    pub keys: Vec<Key>,
    /// Pairs made by hand, by span.
    pub by_hand: Vec<Vec<HandPair>>,
    /// By span, the strokes of the later drawing that must have no counterpart.
    pub alone: Vec<Vec<usize>>,
    /// The given pegs.
    pub pegs: GivenPegs,
    /// The captured parts that strokes follow.
    pub captured: Arc<[Captured]>,
}

/// A span to draw.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Index of its earlier key.
    pub key: usize,
    /// The frames to draw, between its keys.
    pub frames: Vec<FrameNumber>,
}

/// A stroke that is drawn on all frames of a span.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Its origin on the earlier and the later key; `None` if it is absent there.
    pub stands: [Option<DrawnStand>; 2],
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Number of points.
    pub points: usize,
}

/// The origin of a span's stroke on one of its keys.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnStand {
    /// Index of the stroke in the drawing.
    pub stroke: usize,
    /// Whether it is only a part of that stroke.
    pub part: bool,
    /// For each point the two points of that stroke around it, and the weight of the second.
    pub blends: Vec<(usize, usize, f64)>,
}

/// A drawn span.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnSpan {
    /// The request.
    pub wanted: Wanted,
    /// Whether the earlier drawing is held, because no movement between the two can be believed.
    pub held: bool,
    /// Its strokes, from back to front.
    pub strokes: Vec<Drawn>,
    /// By frame, the share of the way, 0 to 1, for blended attributes.
    pub shares: Vec<f64>,
    /// By frame, its strokes in the same order.
    pub drawings: Vec<Vec<InBetween>>,
}

impl Sheet {
    /// Matches the drawing `key` and the next one.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Tween`] for points that are not finite or pairs of missing strokes, with the frames; or
    /// [`PipelineError::Cancelled`].
    pub fn matching(
        &self,
        key: usize,
        options: &MatchingOptions,
        progress: &dyn Progress,
    ) -> Result<Matching, PipelineError> {
        let (first, second) = (&self.keys[key], &self.keys[key + 1]);
        let by_hand = self.by_hand.get(key).map_or(&[][..], Vec::as_slice);
        let alone = self.alone.get(key).map_or(&[][..], Vec::as_slice);
        let [strokes, mut others] = self.pegs.compared(key, [first, second]);
        // A stroke without points has no counterpart.
        for &stroke in alone {
            let count = others.len();
            let Some(other) = others.get_mut(stroke) else {
                let text = format!("found stroke {stroke} of the second drawing, expected a number below {count}");
                return Err(PipelineError::Tween(text));
            };
            other.points = Vec::new();
        }
        let found = match_strokes(&strokes, &others, by_hand, options, progress).map_err(|error| match error {
            crate::tween::matching::MatchingError::Cancelled(cancelled) => PipelineError::Cancelled(cancelled),
            other => PipelineError::Tween(format!("frames {} and {}: {other}", first.frame, second.frame)),
        });
        let mut found = found?;
        found.alone[1].extend(alone);
        found.alone[1].sort_unstable();
        found.alone[1].dedup();
        Ok(found)
    }

    /// Makes the necessary matchings and draws the requested spans. Returns the spans, and by span the matching if one
    /// was needed. It runs on the caller's rayon pool; the result does not depend on the pool.
    ///
    /// # Errors
    ///
    /// Those of [`Self::matching`] and [`Sequence::new`]; [`PipelineError::Tween`] for a key without a next one.
    pub fn draw(
        &self,
        wanted: &[Wanted],
        options: &Options,
        matching: &MatchingOptions,
        progress: &dyn Progress,
    ) -> Result<(Vec<DrawnSpan>, Vec<Option<Matching>>), PipelineError> {
        let spans = self.keys.len().saturating_sub(1);
        if let Some(found) = wanted.iter().map(|w| w.key).find(|&key| key >= spans) {
            return Err(PipelineError::Tween(format!("found span {found}, expected a number below {spans}")));
        }
        let needed: BTreeSet<usize> =
            wanted.iter().flat_map(|w| keys_of(&self.keys, w.key).skip(1)).map(|k| k - 1).collect();
        let needed: Vec<usize> = needed.into_iter().collect();
        let counter = Counter { done: AtomicUsize::new(0), all: needed.len() + wanted.len(), progress };
        let found = match needed[..] {
            // A single matching reports its own progress; several count as steps.
            [key] => vec![self.matching(key, matching, &Half(progress))?],
            _ => {
                let one = |&key: &usize| counter.step("matching strokes", || self.matching(key, matching, &Silent));
                needed.par_iter().map(one).collect::<Result<Vec<_>, _>>()?
            }
        };
        let mut matchings: Vec<Option<Matching>> = vec![None; spans];
        for (key, found) in needed.into_iter().zip(found) {
            matchings[key] = Some(found);
        }
        let draw = |w: &Wanted| counter.step("drawing in-betweens", || self.span(w, &matchings, options));
        let drawn = wanted.par_iter().map(draw).collect::<Result<Vec<_>, _>>()?;
        Ok((drawn, matchings))
    }

    fn span(
        &self,
        wanted: &Wanted,
        matchings: &[Option<Matching>],
        options: &Options,
    ) -> Result<DrawnSpan, PipelineError> {
        let range = keys_of(&self.keys, wanted.key);
        let base = wanted.key - range.start();
        let own: Vec<Matching> = range.clone().skip(1).map(|k| matchings[k - 1].clone().unwrap_or_default()).collect();
        let of = range.clone().filter_map(|k| self.pegs.of.get(k).cloned()).collect();
        let pegs = GivenPegs { tree: self.pegs.tree.clone(), of };
        let sequence = Sequence::of_span(self.keys[range].to_vec(), &own, &pegs, options, base)
            .map_err(|error| PipelineError::Tween(error.to_string()))?
            .following(self.captured.clone());
        let (from, to) = (&self.keys[wanted.key], &self.keys[wanted.key + 1]);
        if let Some(found) = wanted.frames.iter().find(|&&frame| frame <= from.frame || frame >= to.frame) {
            let text = format!("found frame {found}, expected one between {} and {}", from.frame, to.frame);
            return Err(PipelineError::Tween(text));
        }
        let duration = f64::from(to.frame) - f64::from(from.frame);
        // A held key keeps its own widths and colours too.
        let held = sequence.is_held(base);
        let way = if held { 0.0 } else { 1.0 };
        let share = |&frame: &FrameNumber| way * from.spacing.at((f64::from(frame) - f64::from(from.frame)) / duration);
        Ok(DrawnSpan {
            wanted: wanted.clone(),
            held,
            strokes: drawn_strokes(&sequence, base, [&from.strokes, &to.strokes]),
            shares: wanted.frames.iter().map(share).map(|s| s.clamp(0.0, 1.0)).collect(),
            drawings: wanted.frames.par_iter().map(|&frame| sequence.at(frame)).collect(),
        })
    }
}

/// The keys that determine the in-betweens after key `key`.
pub fn keys_of(keys: &[Key], key: usize) -> RangeInclusive<usize> {
    let smooth = usize::from(keys[key].spacing == Spacing::Smooth);
    key.saturating_sub(smooth)..=(key + 1 + smooth).min(keys.len() - 1)
}

fn drawn_strokes(sequence: &Sequence, base: usize, strokes: [&[Stroke]; 2]) -> Vec<Drawn> {
    let of = |t: usize| {
        let track = &sequence.tracks()[t];
        let stands = [0, 1].map(|side| {
            let stand = track.at(base + side)?;
            let blends = stand.places.blends(&strokes[side][stand.stroke]);
            Some(DrawnStand { stroke: stand.stroke, part: stand.part, blends })
        });
        let points = stands.iter().flatten().next().map_or(0, |stand| stand.blends.len());
        Drawn { stands, closed: track.closed, points }
    };
    sequence.present(base).into_iter().map(of).collect()
}

/// Counts steps, which may end in any order.
struct Counter<'a> {
    done: AtomicUsize,
    all: usize,
    progress: &'a dyn Progress,
}

impl Counter<'_> {
    fn step<T>(&self, name: &str, work: impl FnOnce() -> Result<T, PipelineError>) -> Result<T, PipelineError> {
        let share = |done: usize| done as f64 / self.all.max(1) as f64;
        self.progress.report(name, share(self.done.load(Ordering::Relaxed)))?;
        let result = work()?;
        self.progress.report(name, share(self.done.fetch_add(1, Ordering::Relaxed) + 1).min(1.0))?;
        Ok(result)
    }
}

/// Maps a progress to the first half of another.
struct Half<'a>(&'a dyn Progress);

impl Progress for Half<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        self.0.report(step, 0.5 * done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::tween::peg::Timing;

    fn sheet(spacing: &Spacing) -> Sheet {
        let line = |x: f64, count: usize| {
            let at = |k: usize| Point::new(x + (k as f64 / 7.0).sin(), 60.0 * k as f64 / (count - 1) as f64);
            Stroke::new((0..count).map(at).collect(), false)
        };
        let key = |k: usize| {
            let x = [0.0, 10.0, 50.0, 40.0, 90.0][k];
            let strokes = vec![line(x, 9 + k), line(x + 25.0, 30)];
            Key { frame: 8 * k as i32, strokes, spacing: spacing.clone(), corner: false }
        };
        Sheet { keys: (0..5).map(key).collect(), ..Sheet::default() }
    }

    fn wanted(key: usize) -> Wanted {
        Wanted { key, frames: (1..8).map(|frame| 8 * key as i32 + frame).collect() }
    }

    fn draw(sheet: &Sheet, keys: &[usize]) -> Vec<DrawnSpan> {
        let wanted: Vec<Wanted> = keys.iter().map(|&key| wanted(key)).collect();
        sheet.draw(&wanted, &Options::default(), &MatchingOptions::default(), &Silent).unwrap().0
    }

    /// Short bars at places that have nothing to do with each other.
    fn bars(seed: u32, count: u32) -> Vec<Stroke> {
        let number = |k: u32| f64::from((k.wrapping_add(seed).wrapping_mul(2_654_435_761) >> 8) % 1000) / 10.0;
        let bar = |k: u32| {
            let (at, turn) = (Point::new(number(3 * k), number(3 * k + 1)), Point::from_angle(number(3 * k + 2)));
            Stroke::new((0..6).map(|i| at + turn * (4.0 * f64::from(i))).collect(), false)
        };
        (0..count).map(bar).collect()
    }

    #[test]
    fn a_held_key_keeps_its_other_attributes_too() {
        let key = |frame, strokes| Key { frame, strokes, spacing: Spacing::Timing(Timing::Linear), corner: false };
        let drawn = |first: &[Stroke], second: Vec<Stroke>| {
            let sheet = Sheet { keys: vec![key(0, first.to_vec()), key(8, second)], ..Sheet::default() };
            draw(&sheet, &[0]).remove(0)
        };
        let (first, second) = (bars(17, 18), bars(77, 18));
        let held = drawn(&first, second);
        assert_eq!(held.shares, [0.0; 7]);
        assert!(held.drawings.iter().all(|drawing| drawing.iter().map(|d| &d.stroke).eq(&first)));
        let moved = first.iter().map(|s| Stroke::new(s.points.iter().map(|p| *p + Point::X).collect(), false));
        assert_eq!(drawn(&first, moved.collect()).shares[3], 0.5, "what moves blends them");
    }

    #[test]
    fn a_span_depends_on_its_keys_alone() {
        for (spacing, touched) in [(Spacing::Smooth, vec![1, 2, 3]), (Spacing::Timing(Timing::Linear), vec![2, 3])] {
            let before = sheet(&spacing);
            let mut after = before.clone();
            after.keys[3].strokes[1].points[4] += Point::new(3.0, 1.0);
            let (old, new) = (draw(&before, &[0, 1, 2, 3]), draw(&after, &[0, 1, 2, 3]));
            let differ: Vec<usize> = (0..4).filter(|&k| old[k] != new[k]).collect();
            assert_eq!(differ, touched, "{spacing:?}");
            // A span is the same whether drawn alone or with others.
            assert_eq!(draw(&after, &[2])[0], new[2]);
        }
    }

    #[test]
    fn points_are_those_of_the_earlier_key() {
        let sheet = sheet(&Spacing::Smooth);
        for span in draw(&sheet, &[0, 2, 3]) {
            let key = span.wanted.key;
            assert_eq!([span.strokes[0].points, span.strokes[1].points], [9 + key, 30]);
            assert!(span.drawings.iter().all(|d| d[0].stroke.points.len() == 9 + key && d.len() == 2));
            let [Some(from), Some(to)] = &span.strokes[0].stands else { panic!("{span:?}") };
            assert_eq!((from.blends[2], to.blends[0].0, to.blends[8 + key].1), ((2, 2, 0.0), 0, 9 + key));
        }
    }

    #[test]
    fn what_is_decided_by_hand_holds() {
        let mut sheet = sheet(&Spacing::Timing(Timing::EaseIn));
        sheet.by_hand = vec![vec![HandPair { from: 0, to: Some(1) }]];
        let drawn = draw(&sheet, &[0, 1]);
        assert_eq!(drawn[0].shares[3], 0.25);
        let stroke = |span: usize, side: usize| -> Vec<Option<usize>> {
            drawn[span].strokes.iter().map(|s| s.stands[side].as_ref().map(|stand| stand.stroke)).collect()
        };
        assert_eq!((stroke(0, 0), stroke(0, 1)), (vec![Some(0), Some(1)], vec![Some(1), Some(0)]));
        assert_eq!(stroke(1, 1), [Some(0), Some(1)]);
        (sheet.by_hand, sheet.alone) = (Vec::new(), vec![vec![0]]);
        let found = sheet.matching(0, &MatchingOptions::default(), &Silent).unwrap();
        assert_eq!(found.appeared, [0], "{found:?}");
    }

    #[test]
    fn what_is_not_there_is_named() {
        let mut sheet = sheet(&Spacing::Smooth);
        let said = |sheet: &Sheet, wanted: Wanted| {
            let found = sheet.draw(&[wanted], &Options::default(), &MatchingOptions::default(), &Silent);
            found.unwrap_err().to_string()
        };
        assert!(said(&sheet, wanted(4)).contains("found span 4, expected a number below 4"));
        let outside = Wanted { key: 0, frames: vec![8] };
        assert!(said(&sheet, outside).contains("found frame 8, expected one between 0 and 8"));
        sheet.alone = vec![vec![7]];
        assert!(said(&sheet, wanted(0)).contains("found stroke 7 of the second drawing, expected a number below 2"));
    }
}
