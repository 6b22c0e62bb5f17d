//! The painted regions of a document as pictures.

use super::{PipelineError, RenderJob, fill, frames_of};
use crate::project::Document;
use crate::project::fills::FilledRegion;
use crate::render::paint::{Region, paint, paint_picture, painted, shares};
use crate::render::{EncodeError, Format};
use crate::scene::{Footage, FrameNumber, Raster};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Number of frames that a message names.
const NAMED: usize = 5;

/// The painted regions of each frame, from back to front.
///
/// # Errors
///
/// [`PipelineError::Field`] if the document has no painted regions or they cannot be read; [`PipelineError::Option`] if the job
/// names parts, which regions do not have.
pub(super) fn of(document: &Document, job: &RenderJob) -> Result<BTreeMap<FrameNumber, Vec<Region>>, PipelineError> {
    if let Some(name) = job.parts.as_ref().and_then(|names| names.first()) {
        let reason = format!("found {name:?}, expected none: painted regions belong to no part");
        return Err(PipelineError::option("parts", reason));
    }
    let filled = document.filled().map_err(|error| fill::field(&error))?;
    if filled.is_empty() {
        let found = "filled: found no painted regions, expected those that `rototoon fill` writes";
        return Err(PipelineError::Field(found.to_owned()));
    }
    let region = |FilledRegion { outline, holes, colour, track, .. }| Region {
        name: format!("region {track}"),
        outline,
        holes,
        colour,
    };
    Ok(filled.into_iter().map(|own| (own.frame, own.regions.into_iter().map(region).collect())).collect())
}

/// The paint of a frame alone, as bytes of a file. A frame without regions is empty.
pub(super) fn alone(footage: &Footage, own: Option<&Vec<Region>>, format: Format) -> Result<Vec<u8>, EncodeError> {
    paint_picture(own.map_or(&[], |own| &own[..]), footage.width, footage.height, format)
}

/// A drawing over the paint of its frame.
pub(super) fn under(drawing: &Raster<[f32; 4]>, own: Option<&Vec<Region>>) -> Raster<[f32; 4]> {
    let own = own.map_or(&[][..], |own| &own[..]);
    painted(drawing, &paint(own, &shares(own, drawing.width(), drawing.height())))
}

/// The frames of a range (all of the footage where it is `None`) without painted regions, as a message for the user. `None` if all
/// are painted.
pub fn unpainted(document: &Document, range: Option<RangeInclusive<FrameNumber>>) -> Option<String> {
    let painted: Vec<FrameNumber> = document.filled().ok()?.iter().map(|drawing| drawing.frame).collect();
    let lacking = frames_of(&document.scene.footage, range).ok()?.filter(|frame| painted.binary_search(frame).is_err());
    let lacking: Vec<String> = lacking.map(|frame| frame.to_string()).collect();
    let more = lacking.len().saturating_sub(NAMED);
    let listed = lacking[..lacking.len() - more].join(", ");
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let frames = if lacking.len() == 1 { "frame" } else { "frames" };
    (!lacking.is_empty()).then(|| format!("{frames} {listed}{more}: not painted; run `rototoon fill` on them"))
}
