//! What is known beside the frames that are traced: the nearest drawings before and behind them.
//!
//! A shot may be traced in stages, or some of its frames once more. The strokes there are the same strokes as on the frames
//! around, so work begins and ends at the nearest drawings outside that have strokes: those of the artist, or of an earlier run.
//! Nothing is written there.
//!
//! **Limits.** A stroke that began on the way to a drawing of the artist, who did not draw it there, goes on behind that drawing in one run. In
//! stages that part there it begins anew.
//!
//! Numbers come from before. Strokes that begin on the way have the numbers that they meet behind, if nothing else has them.

use super::of_drawn;
use crate::lines::{Stroke, Tracked, identify};
use crate::project::drawings::Drawing as Drawn;
use crate::project::traced::{TracedDrawing, TracedStroke};
use crate::scene::FrameNumber;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// A drawing outside of the range whose strokes are known.
#[derive(Clone, Default)]
pub(super) struct Beside<'a> {
    /// Its frame.
    pub frame: FrameNumber,
    drawn: Option<&'a Drawn>,
    traced: Option<&'a TracedDrawing>,
    /// The numbers that strokes have where an artist drew.
    pub by_hand: BTreeSet<usize>,
}

impl Beside<'_> {
    /// Its strokes: those that the artist drew, or else the traced ones.
    pub fn strokes(&self) -> Vec<Stroke> {
        match (self.drawn, self.traced) {
            (Some(drawn), _) => drawn.strokes.iter().map(of_drawn).collect(),
            (None, Some(traced)) => traced.strokes.iter().map(|stroke| of_traced(stroke).stroke).collect(),
            (None, None) => Vec::new(),
        }
    }

    /// Whether an artist drew it.
    pub fn is_drawn(&self) -> bool {
        self.drawn.is_some()
    }

    /// Its strokes with their numbers. What the artist drew since the earlier run has numbers from `next` on, which is raised. `unit` is
    /// the size of a pixel of 540 lines.
    pub fn tracked(&self, unit: f64, next: &mut usize) -> Vec<Tracked> {
        let traced: Vec<Tracked> = self.traced.iter().flat_map(|traced| &traced.strokes).map(of_traced).collect();
        match self.drawn {
            Some(_) => identify(&traced, self.strokes(), unit, next),
            None => traced,
        }
    }
}

/// The nearest drawings before and behind a range.
pub(super) fn beside<'a>(
    drawn: &'a [Drawn],
    traced: &'a [TracedDrawing],
    range: &RangeInclusive<FrameNumber>,
) -> [Option<Beside<'a>>; 2] {
    let mut all: BTreeMap<FrameNumber, Beside> = BTreeMap::new();
    for drawing in drawn.iter().filter(|drawing| !drawing.strokes.is_empty()) {
        all.entry(drawing.frame).or_default().drawn = Some(drawing);
    }
    for drawing in traced.iter().filter(|drawing| !drawing.strokes.is_empty()) {
        all.entry(drawing.frame).or_default().traced = Some(drawing);
    }
    let is_drawn = |known: &&Beside| known.drawn.is_some();
    let strokes = all.values().filter(is_drawn).filter_map(|known| known.traced).flat_map(|traced| &traced.strokes);
    let by_hand: BTreeSet<usize> = strokes.map(|stroke| stroke.track).collect();
    let of = |(&frame, known): (&FrameNumber, &Beside<'a>)| Beside { frame, by_hand: by_hand.clone(), ..known.clone() };
    [all.range(..range.start()).next_back().map(of), all.range(range.end() + 1..).next().map(of)]
}

/// Numbers that strokes get from a drawing behind them. `there` are its strokes as they were met, `own` the same with the numbers that they
/// had before. Numbers from `new` on are those of this run. They alone change, to earlier ones that nothing else has `used`.
pub(super) fn renamed(
    there: &[Tracked],
    own: &[Tracked],
    new: usize,
    used: &BTreeSet<usize>,
) -> BTreeMap<usize, usize> {
    let met = there.iter().zip(own).map(|(met, own)| (met.track, own.track));
    met.filter(|(met, own)| *met >= new && *own < new && !used.contains(own)).collect()
}

fn of_traced(traced: &TracedStroke) -> Tracked {
    let stroke = Stroke {
        points: traced.points.clone(),
        closed: traced.closed,
        widths: traced.widths.clone(),
        fill: traced.fill,
        fill_colour: traced.fill_colour,
        colour: traced.colour.unwrap_or_default(),
    };
    Tracked { track: traced.track, stroke, confidence: traced.confidence.unwrap_or(1.0) }
}
