//! What a document has of the drawing's own motion and a result has not: it is taken away, and said.
//!
//! - traced strokes, painted regions and in-betweens lie on the drawings of the own motion, and would be shown in place of the result's strokes
//! - swapped sides: all frames of a result show the drawing at rest, which has one side
//! - the marks of the pictures that were read: a result is made of no picture
//!
//! What the artist drew stays in the document: drawings and clicks.

use super::{PipelineError, wrong};
use crate::pipeline::report::{ranges, runs};
use crate::project::Document;
use crate::project::drawings::DrawnBetween;
use crate::scene::FrameNumber;
use crate::scene::limbs::LimbSet;

/// The frames of what a result does not have.
pub(super) struct OwnMotion {
    traced: Vec<FrameNumber>,
    painted: Vec<FrameNumber>,
    /// In-betweens that tweening drew. Those of an earlier result are on the frame at rest, too, and have no matches.
    tweened: Vec<FrameNumber>,
    /// Whether the document has in-betweens.
    between: bool,
    /// Key drawings with strokes.
    drawn: Vec<FrameNumber>,
    swaps: Vec<(FrameNumber, FrameNumber)>,
}

impl OwnMotion {
    /// That of a document whose limbs are `set`, and whose drawing is at rest on a frame.
    pub fn of(document: &Document, set: &LimbSet, rest: FrameNumber) -> Result<Self, PipelineError> {
        let traced = document.traced().map_err(wrong)?.into_iter().filter(|own| !own.strokes.is_empty());
        let filled = document.filled().map_err(wrong)?.into_iter().filter(|own| !own.regions.is_empty());
        let between = document.in_betweens().map_err(wrong)?;
        let matched = !document.stroke_numbers().map_err(wrong)?.is_empty();
        let made = !matched && between.iter().any(|own| own.frame == rest);
        let tweened = between.iter().filter(|own| !made && !own.strokes.is_empty());
        let drawn = document.drawings().map_err(wrong)?.drawings.into_iter().filter(|own| !own.strokes.is_empty());
        let footage = &document.scene.footage;
        let is_part = |(first, last): &(FrameNumber, FrameNumber)| *first > footage.first || *last < footage.last;
        let swaps = if set.swaps.iter().any(is_part) { set.swaps.clone() } else { Vec::new() };
        Ok(Self {
            traced: traced.map(|own| own.frame).collect(),
            painted: filled.map(|own| own.frame).collect(),
            tweened: tweened.map(|own| own.frame).collect(),
            between: !between.is_empty(),
            drawn: drawn.map(|own| own.frame).collect(),
            swaps,
        })
    }

    /// Takes it out of the document, but for the sides. Limbs are written with the result.
    pub fn forget(&self, document: &mut Document) {
        if !self.traced.is_empty() {
            document.set_traced(&[]);
        }
        if !self.painted.is_empty() {
            document.set_filled(&[]);
        }
        document.forget_seen();
    }

    /// Lets no frame of a result show strokes, where the drawing has none at rest: key drawings of the own motion would show between the contours
    /// of the result. Returns what is said of them.
    pub fn show_no_strokes(&self, document: &mut Document, rest: FrameNumber) -> Option<String> {
        if !self.between && self.drawn.is_empty() {
            return None;
        }
        let footage = &document.scene.footage;
        let blank = |frame| DrawnBetween { frame, strokes: Vec::new() };
        let blank: Vec<DrawnBetween> = (footage.first..=footage.last).map(blank).collect();
        document.set_in_betweens(Vec::new(), &blank);
        let drawn = runs(&self.drawn);
        (!self.drawn.is_empty()).then(|| {
            format!("frame {rest}, at rest, has no strokes, so the result shows none: the drawings on {drawn} stay in the document")
        })
    }

    /// What is said of what the result does not have.
    pub fn said(&self) -> Option<String> {
        let results =
            [("traced strokes", &self.traced), ("painted regions", &self.painted), ("in-betweens", &self.tweened)];
        let results = results.into_iter().filter(|(_, frames)| !frames.is_empty());
        let mut list: Vec<String> = results.map(|(what, frames)| format!("{what} on {}", runs(frames))).collect();
        if !self.swaps.is_empty() {
            list.push(format!("swapped sides on {}", ranges(self.swaps.iter().copied())));
        }
        let list = list.join(", ");
        (!list.is_empty()).then(|| format!("what the drawing's own motion has and the result has not: {list}"))
    }
}
