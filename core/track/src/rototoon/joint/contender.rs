//! What takes part in the joint choice: a part over a span, with its hypotheses.

use crate::rototoon::pool::Pools;
use crate::rototoon::propagate::Model;
use crate::shared::drawings::{Drawing, gaps, shown};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Span};
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// For each contender the index of the hypothesis that it follows on each of its drawings.
pub type Paths = [Vec<usize>];

/// A hypothesis on a drawing: (index of the drawing, index of the hypothesis).
pub type State = (usize, usize);

/// One part over one span with its hypotheses, as the joint choice reads it.
pub struct Contender<'a> {
    /// Index of the part. A part that is keyed between the ends of a stretch has a contender for each of its spans.
    pub part: usize,
    /// The frames, with both keys.
    pub span: Span,
    /// Depth of the part. Larger is nearer.
    pub depth: f64,
    /// Its depths on single frames.
    pub depths: &'a BTreeMap<FrameNumber, f64>,
    /// Whether the part can hide others: its contour is closed.
    pub hides: bool,
    /// The span's drawings.
    pub drawings: &'a [Drawing],
    /// The hypotheses of each drawing.
    pub pools: &'a Arc<Pools>,
    /// The models of both keys that the hypotheses pose.
    pub models: &'a [Model; 2],
}

impl Contender<'_> {
    /// The part's control points at both keys, in working pixels.
    pub fn keys(&self) -> [&[Point]; 2] {
        [0, self.pools.len() - 1].map(|d| &self.pools[d][0].points[..])
    }

    /// Whether this contender is nearer than another one on a frame.
    pub fn is_nearer(&self, other: &Contender, frame: FrameNumber) -> bool {
        let depth = |contender: &Contender| contender.depths.get(&frame).copied().unwrap_or(contender.depth);
        depth(self) > depth(other)
    }

    /// The drawings that begin after a gap.
    pub fn gaps(&self) -> Vec<usize> {
        gaps(self.drawings)
    }

    /// Index of the drawing that a frame shows. `None` if the frame is outside the span, or the part is absent there.
    pub fn drawing_at(&self, frame: FrameNumber) -> Option<usize> {
        if frame < self.span.first || frame > self.span.last {
            return None;
        }
        let index = (frame - self.span.first) as usize;
        self.drawings.iter().position(|d| d.first <= index && index <= d.last)
    }

    /// The drawings of another contender that begin while this one shows its drawing `d`.
    pub fn meets(&self, d: usize, other: &Contender) -> impl Iterator<Item = usize> {
        let frames = self.drawings[d].first..=self.drawings[d].last;
        let offset = i64::from(other.span.first) - i64::from(self.span.first);
        let begins = other.drawings.iter().map(move |drawing| drawing.first as i64 + offset);
        let within = move |(e, at): (usize, i64)| usize::try_from(at).is_ok_and(|at| frames.contains(&at)).then_some(e);
        begins.enumerate().filter_map(within)
    }

    /// The drawings that this contender shows while another one shows its drawing `d`. `None` if it shows none.
    pub fn shown_during(&self, other: &Contender, d: usize) -> Option<RangeInclusive<usize>> {
        let drawing = &other.drawings[d];
        let [first, last] = [drawing.first, drawing.last].map(|index| other.span.first + index as FrameNumber);
        let (first, last) = (first.max(self.span.first), last.min(self.span.last));
        if first > last {
            return None;
        }
        shown(self.drawings, [first, last].map(|frame| (frame - self.span.first) as usize))
    }

    /// The order of contenders: from near to far, then by span, then by what is drawn on their keys, then by their depths on
    /// single frames. Two that are equal in all are the same.
    pub fn order(&self, other: &Self) -> Ordering {
        let places = |contender: &Self| -> Vec<f64> {
            contender.keys().into_iter().flatten().flat_map(|point| [point.x, point.y]).collect()
        };
        let by_places = || {
            let (own, theirs) = (places(self), places(other));
            let differs = own.iter().zip(&theirs).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
            differs.unwrap_or(own.len().cmp(&theirs.len()))
        };
        let by_depths = || {
            let of = |contender: &Self| contender.depths.iter().map(|(&f, &depth)| (f, depth)).collect::<Vec<_>>();
            of(self).partial_cmp(&of(other)).unwrap_or(Ordering::Equal)
        };
        other.depth.total_cmp(&self.depth).then(self.span.cmp(&other.span)).then_with(by_places).then_with(by_depths)
    }

    /// The first frame of each drawing.
    pub fn frames(&self) -> impl Iterator<Item = FrameNumber> {
        (0..self.drawings.len()).map(|d| self.frame_of(d))
    }

    /// First frame of a drawing.
    pub fn frame_of(&self, drawing: usize) -> FrameNumber {
        self.span.first + self.drawings[drawing].first as FrameNumber
    }
}
