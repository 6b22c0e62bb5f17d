//! What takes part in the joint choice: a part over a span, with its hypotheses.

use crate::rototoon::pool::Pools;
use crate::rototoon::propagate::Model;
use crate::shared::drawings::Drawing;
use rototoon_base::scene::{FrameNumber, Span};
use std::sync::Arc;

/// The hypothesis that each contender follows on each of its drawings.
pub type Paths = [Vec<usize>];

/// A hypothesis on a drawing.
pub type State = (usize, usize);

/// One part over one span, with its hypotheses.
pub struct Contender<'a> {
    /// The frames, keys included.
    pub span: Span,
    /// Larger is nearer.
    pub depth: f64,
    /// Whether the contour is closed and can hide anything.
    pub hides: bool,
    /// The span's drawings.
    pub drawings: &'a [Drawing],
    /// The hypotheses of each drawing.
    pub pools: &'a Arc<Pools>,
    /// What the hypotheses pose.
    pub models: &'a [Model; 2],
}

impl Contender<'_> {
    /// Index of the drawing that a frame shows, where the frame lies in the span.
    pub fn drawing_at(&self, frame: FrameNumber) -> Option<usize> {
        if frame < self.span.first || frame > self.span.last {
            return None;
        }
        let index = (frame - self.span.first) as usize;
        self.drawings.iter().position(|d| d.first <= index && index <= d.last)
    }

    /// First frame of a drawing.
    pub fn frame_of(&self, drawing: usize) -> FrameNumber {
        self.span.first + self.drawings[drawing].first as FrameNumber
    }
}
