//! What was painted and traced on each frame of a document, as pictures.

use super::strokes::{self, Seen};
use super::{Picture, PipelineError, RenderJob, fill, frames_of};
use crate::geometry::Point;
use crate::project::Document;
use crate::project::fills::FilledRegion;
use crate::project::traced::TracedStroke;
use crate::render::paint::{Region, paint, paint_picture, painted, shares};
use crate::render::{EncodeError, Format, stroke};
use crate::scene::{Footage, FrameNumber, Raster};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Number of frames that a message names.
const NAMED: usize = 5;

/// What a picture shows of each frame, from back to front: painted regions, solid shapes, lines. Empty for pictures of
/// something else.
///
/// # Errors
///
/// [`PipelineError::Field`] if the document has nothing of what the picture shows, or it cannot be read;
/// [`PipelineError::Option`] if the job names parts, which regions and strokes do not have.
pub(super) fn of(document: &Document, job: &RenderJob) -> Result<BTreeMap<FrameNumber, Vec<Region>>, PipelineError> {
    let (regions, strokes) = (shows_regions(&job.picture), shows_strokes(&job.picture));
    let mut found = BTreeMap::new();
    if !regions && !strokes {
        return Ok(found);
    }
    if let Some(name) = job.parts.as_ref().and_then(|names| names.first()) {
        let reason = format!("found {name:?}, expected none: painted regions and traced strokes belong to no part");
        return Err(PipelineError::option("parts", reason));
    }
    if regions {
        add_regions(document, job.scale, &mut found)?;
    }
    if strokes {
        add_strokes(document, job.scale, &mut found)?;
    }
    Ok(found)
}

/// The footage with the size of a job's pictures.
///
/// # Errors
///
/// [`PipelineError::Option`] for another size of pictures that show the footage.
pub(super) fn sized(footage: &Footage, job: &RenderJob) -> Result<Footage, PipelineError> {
    let whole = matches!(job.picture, Picture::Paint | Picture::Lines | Picture::Cel);
    if job.scale != 1.0 && !whole {
        let reason = format!("found {}, expected 1: only paint, lines and cel are drawn in other sizes", job.scale);
        return Err(PipelineError::option("scale", reason));
    }
    let size = |pixels: usize| ((pixels as f64 * job.scale).round() as usize).max(1);
    Ok(Footage { width: size(footage.width), height: size(footage.height), ..footage.clone() })
}

fn shows_regions(picture: &Picture) -> bool {
    matches!(picture, Picture::Paint | Picture::Painted | Picture::Cel)
}

fn shows_strokes(picture: &Picture) -> bool {
    matches!(picture, Picture::Lines | Picture::Cel)
}

fn add_regions(
    document: &Document,
    scale: f64,
    to: &mut BTreeMap<FrameNumber, Vec<Region>>,
) -> Result<(), PipelineError> {
    let filled = document.filled().map_err(|error| fill::field(&error))?;
    if filled.is_empty() {
        let found = "filled: found no painted regions, expected those that `rototoon fill` writes";
        return Err(PipelineError::Field(found.to_owned()));
    }
    let region = |FilledRegion { outline, holes, colour, track, .. }| Region {
        name: format!("region {track}"),
        areas: vec![scaled(outline, scale)],
        holes: holes.into_iter().map(|hole| scaled(hole, scale)).collect(),
        colour,
        opacity: 1.0,
    };
    for drawing in filled {
        to.entry(drawing.frame).or_default().extend(drawing.regions.into_iter().map(region));
    }
    Ok(())
}

fn add_strokes(
    document: &Document,
    scale: f64,
    to: &mut BTreeMap<FrameNumber, Vec<Region>>,
) -> Result<(), PipelineError> {
    let found = strokes::strokes(document)?;
    if found.is_empty() {
        let found = "traced: found no strokes, expected those that `rototoon trace` writes, or drawings";
        return Err(PipelineError::Field(found.to_owned()));
    }
    let plain = strokes::plain(document);
    for (frame, own) in found {
        to.entry(frame).or_default().extend(own.into_iter().map(|own| drawn(own, plain, scale)));
    }
    Ok(())
}

/// A stroke as an area. Without widths it is `plain` pixels of the footage wide.
fn drawn(own: Seen, plain: f64, scale: f64) -> Region {
    let (name, lined) = (own.id.to_string(), own.is_lined());
    let TracedStroke { points, closed, widths, colour, fill, .. } = own.stroke;
    let points = scaled(points, scale);
    let widths = if widths.is_empty() { vec![plain; points.len()] } else { widths };
    let radii: Vec<f64> = widths.iter().map(|width| 0.5 * scale * width).collect();
    let mut areas: Vec<Vec<Point>> = if lined { stroke::areas(&points, &radii, closed) } else { Vec::new() };
    if fill {
        areas.push(points);
    }
    Region { name, areas, holes: Vec::new(), colour: colour.unwrap_or_default(), opacity: own.opacity as f32 }
}

fn scaled(points: Vec<Point>, scale: f64) -> Vec<Point> {
    points.into_iter().map(|p| scale * p).collect()
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

/// The frames of a job's range on which the document has nothing of what the picture shows, as a message for the user. `None`
/// if there are none, and for pictures of something else.
pub fn undrawn(document: &Document, job: &RenderJob) -> Option<String> {
    let range = frames_of(&document.scene.footage, job.frames.clone()).ok()?;
    let regions = shows_regions(&job.picture).then(|| {
        let there = document.filled().ok()?.iter().map(|drawing| drawing.frame).collect();
        lacking(there, range.clone(), "painted", "fill")
    });
    let strokes = shows_strokes(&job.picture).then(|| {
        let there = strokes::strokes(document).ok()?.into_keys().collect();
        lacking(there, range, "drawn", "trace")
    });
    let told: Vec<String> = [regions, strokes].into_iter().flatten().flatten().collect();
    (!told.is_empty()).then(|| told.join("; "))
}

fn lacking(there: Vec<FrameNumber>, range: RangeInclusive<FrameNumber>, what: &str, command: &str) -> Option<String> {
    let lacking: Vec<String> =
        range.filter(|frame| there.binary_search(frame).is_err()).map(|frame| frame.to_string()).collect();
    let more = lacking.len().saturating_sub(NAMED);
    let listed = lacking[..lacking.len() - more].join(", ");
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let frames = if lacking.len() == 1 { "frame" } else { "frames" };
    (!lacking.is_empty()).then(|| format!("{frames} {listed}{more}: not {what}; run `rototoon {command}` there"))
}
