//! Drawings on key frames, traced for in-betweens.
//!
//! Tracing a film follows the same strokes from frame to frame. Key drawings for in-betweens are another matter: nothing is drawn
//! between them, and their strokes are matched by [`tween`](super::super::tween()). So each is traced for itself. Pictures are needed
//! on these frames only.

use super::super::keeping::{Keeping, Pictured};
use super::super::{PipelineError, frames, memory};
use super::kept::is_stroke;
use super::layers::behind_first;
use super::wrong;
use crate::lines::{Options, Stroke, trace as traced};
use crate::project::Document;
use crate::project::drawings::{Drawing, DrawnStroke};
use crate::scene::{FrameNumber, Progress};
use crate::track::Cache;
use std::collections::BTreeSet;
use std::path::Path;

/// Traces the pictures of some frames of a document in `folder` and adds their strokes, with widths and colours, to its field
/// `drawings`. Strokes that a `cache` knows are not found again. It runs on the caller's rayon pool; the result does not depend on the pool. Returns the frames on which no line was
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
    cache: Option<&dyn Cache>,
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
    let keeping = Keeping { cache, frames: &sequence, options };
    let mut drawings = Vec::with_capacity(keys.len());
    for (k, &frame) in keys.iter().enumerate() {
        progress.report("Tracing", k as f64 / keys.len() as f64)?;
        let mut strokes = strokes(&keeping, frame)?;
        strokes.sort_by(behind_first);
        drawings.push(Drawing { frame, strokes: strokes.into_iter().map(drawn).collect(), ..Drawing::default() });
    }
    document.add_drawings(&drawings).map_err(|error| wrong(&error))?;
    progress.report("Tracing", 1.0)?;
    Ok(drawings.iter().filter(|drawing| drawing.strokes.is_empty()).map(|drawing| drawing.frame).collect())
}

/// The strokes of a frame's picture, which a cache may know.
fn strokes(keeping: &Keeping, frame: FrameNumber) -> Result<Vec<Stroke>, PipelineError> {
    let picture = keeping.frames.picture(frame)?;
    let own = Pictured { frame, mark: keeping.mark(frame) };
    let known: Option<Vec<Stroke>> = keeping.recall("strokes", &[own]);
    if let Some(known) = known.filter(|strokes| strokes.iter().all(is_stroke)) {
        return Ok(known);
    }
    let found = traced(picture, keeping.options);
    keeping.keep("strokes", &[own], &found);
    Ok(found)
}

fn drawn(Stroke { points, closed, widths, colour, fill, fill_colour }: Stroke) -> DrawnStroke {
    DrawnStroke { points, closed, fill, widths, colour: Some(colour), fill_colour, ..DrawnStroke::default() }
}
