//! Drawings on key frames, traced for in-betweens.
//!
//! Tracing a film follows the same strokes from frame to frame. Key drawings for in-betweens are another matter: nothing is drawn
//! between them, and their strokes are matched by [`tween`](super::super::tween()). So each is traced for itself. Pictures are needed
//! on these frames only.

use super::super::{PipelineError, frames, memory};
use super::{behind_first, wrong};
use crate::lines::{Options, Stroke, trace as traced};
use crate::project::Document;
use crate::project::drawings::{Drawing, DrawnStroke};
use crate::scene::{FrameNumber, FrameSource, Progress};
use std::collections::BTreeSet;
use std::path::Path;

/// Traces the pictures of some frames of a document in `folder` and adds their strokes, with widths and colours, to its field
/// `drawings`. It runs on the caller's rayon pool; the result does not depend on the pool. Returns the frames on which no line was
/// found; their drawings are empty.
///
/// # Errors
///
/// [`PipelineError::Option`] for a frame outside of the footage; [`PipelineError::Field`] for a frame that has a drawing, a frame
/// between two drawings that are paired by hand, and fields that cannot be read; an unreadable frame; not enough memory; or
/// [`PipelineError::Cancelled`]. Then the document is unchanged.
pub fn trace_drawings(
    document: &mut Document,
    folder: &Path,
    keys: &BTreeSet<FrameNumber>,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Vec<FrameNumber>, PipelineError> {
    let footage = &document.scene.footage;
    if let Some(frame) = keys.iter().find(|frame| !(footage.first..=footage.last).contains(frame)) {
        let reason = format!("found {frame}, expected frames of the footage, {} to {}", footage.first, footage.last);
        return Err(PipelineError::option("drawings", reason));
    }
    memory::to_trace(footage)?;
    // What would be refused in the end is refused before the work.
    let bare = |&frame: &FrameNumber| Drawing { frame, ..Drawing::default() };
    document.clone().add_drawings(&keys.iter().map(bare).collect::<Vec<_>>()).map_err(|error| wrong(&error))?;
    let sequence = frames(document, folder)?;
    let mut drawings = Vec::with_capacity(keys.len());
    for (k, &frame) in keys.iter().enumerate() {
        progress.report("Tracing", k as f64 / keys.len() as f64)?;
        let mut strokes = traced(sequence.picture(frame)?, options);
        strokes.sort_by(behind_first);
        drawings.push(Drawing { frame, strokes: strokes.into_iter().map(drawn).collect(), ..Drawing::default() });
    }
    document.add_drawings(&drawings).map_err(|error| wrong(&error))?;
    progress.report("Tracing", 1.0)?;
    Ok(drawings.iter().filter(|drawing| drawing.strokes.is_empty()).map(|drawing| drawing.frame).collect())
}

fn drawn(Stroke { points, closed, widths, colour, fill, fill_colour }: Stroke) -> DrawnStroke {
    DrawnStroke { points, closed, fill, widths, colour: Some(colour), fill_colour, ..DrawnStroke::default() }
}
