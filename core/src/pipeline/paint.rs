//! What was painted and traced on each frame of a document, as pictures.

use super::picture::RenderJob;
use super::strokes::{self, Seen};
use super::{PipelineError, fill, frames_of};
use crate::geometry::Point;
use crate::image::colour;
use crate::project::Document;
use crate::project::fills::FilledRegion;
use crate::render::paint::{Region, paint, paint_picture, painted, shares};
use crate::render::{EncodeError, Format, stroke};
use crate::scene::{Colour, Footage, FrameNumber, Raster};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Number of frames that a message names.
const NAMED: usize = 5;

/// What the pictures of a job show of painted regions and strokes. Nothing for pictures of something else.
#[derive(Default)]
pub(super) struct Shown {
    regions: BTreeMap<FrameNumber, Vec<FilledRegion>>,
    strokes: BTreeMap<FrameNumber, Vec<Seen>>,
    /// Width of a stroke without widths, in pixels of the footage.
    plain: f64,
    /// Pixels of the picture for each pixel of the footage.
    scale: f64,
}

impl Shown {
    /// Reads what the pictures of a job show.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Field`] if the document has nothing of it, or it cannot be read; [`PipelineError::Option`] if the job
    /// names parts, which regions and strokes do not have.
    pub fn of(document: &Document, job: &RenderJob) -> Result<Self, PipelineError> {
        let (regions, strokes) = (job.picture.shows_regions(), job.picture.shows_strokes());
        let mut shown = Self { plain: strokes::plain(document), scale: job.scale, ..Self::default() };
        if let Some(name) = job.parts.as_ref().and_then(|names| names.first()).filter(|_| regions || strokes) {
            let reason = format!("found {name:?}, expected none: painted regions and strokes belong to no part");
            return Err(PipelineError::option("parts", reason));
        }
        let missing =
            |field: &str, expected: &str| PipelineError::Field(format!("{field}: found none, expected {expected}"));
        if regions {
            shown.regions = regions_of(document)?;
            if shown.regions.is_empty() {
                return Err(missing("filled", "the painted regions that `rototoon fill` writes"));
            }
        }
        if strokes {
            shown.strokes = strokes::strokes(document)?;
            if shown.strokes.is_empty() {
                return Err(missing("traced", "the strokes that `rototoon trace` writes, or drawings"));
            }
        }
        Ok(shown)
    }

    /// The painted regions of a document alone, in pixels of the footage.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Field`] if they cannot be read.
    pub fn regions(document: &Document) -> Result<Self, PipelineError> {
        Ok(Self { regions: regions_of(document)?, scale: 1.0, ..Self::default() })
    }

    /// The frames with painted regions, each with the least confidence of one.
    pub fn least_confidence(&self) -> impl Iterator<Item = (FrameNumber, f64)> + '_ {
        let least = |regions: &[FilledRegion]| regions.iter().map(|region| region.confidence).fold(1.0, f64::min);
        self.regions.iter().map(move |(frame, regions)| (*frame, least(regions)))
    }

    /// What is shown on a frame, from back to front: painted regions, solid shapes, lines.
    fn on(&self, frame: FrameNumber) -> Vec<Region> {
        let regions = self.regions.get(&frame).into_iter().flatten().map(|region| self.region(region));
        regions.chain(self.strokes.get(&frame).into_iter().flatten().map(|seen| self.stroke(seen))).collect()
    }

    fn region(&self, FilledRegion { outline, holes, colour, track, .. }: &FilledRegion) -> Region {
        Region {
            name: format!("region {track}"),
            areas: vec![self.scaled(outline)],
            holes: holes.iter().map(|hole| self.scaled(hole)).collect(),
            colour: *colour,
            opacity: 1.0,
        }
    }

    fn stroke(&self, seen: &Seen) -> Region {
        let own = &seen.stroke;
        let points = self.scaled(&own.points);
        let plain = vec![self.plain; points.len()];
        let widths = if own.widths.is_empty() { &plain } else { &own.widths };
        let radii: Vec<f64> = widths.iter().map(|width| 0.5 * self.scale * width).collect();
        let mut areas: Vec<Vec<Point>> =
            if seen.is_lined() { stroke::areas(&points, &radii, own.closed) } else { Vec::new() };
        if own.fill {
            areas.push(points);
        }
        let (name, colour) = (seen.id.to_string(), own.colour.unwrap_or_default());
        Region { name, areas, holes: Vec::new(), colour, opacity: seen.opacity as f32 }
    }

    fn scaled(&self, points: &[Point]) -> Vec<Point> {
        points.iter().map(|p| self.scale * *p).collect()
    }

    /// What is shown on a frame, on nothing, as bytes of a file of `size`.
    pub fn alone(&self, frame: FrameNumber, size: &Footage, format: Format) -> Result<Vec<u8>, EncodeError> {
        paint_picture(&self.on(frame), size.width, size.height, format)
    }

    /// The drawing of a frame over what is shown there.
    pub fn under(&self, frame: FrameNumber, drawing: &Raster<[f32; 4]>) -> Raster<[f32; 4]> {
        let own = self.on(frame);
        painted(drawing, &paint(&own, &shares(&own, drawing.width(), drawing.height())))
    }

    /// The picture of a frame, which hides what is behind it, over what is shown there; `None` if that is nothing.
    pub fn under_picture(&self, frame: FrameNumber, picture: &Raster<Colour>) -> Option<Raster<Colour>> {
        self.regions.get(&frame).filter(|regions| !regions.is_empty())?;
        let layer = Raster::from_fn(picture.width(), picture.height(), |x, y| {
            let [r, g, b] = picture.get(x, y).map(colour::decode);
            [r, g, b, 1.0]
        });
        let over = self.under(frame, &layer);
        Some(Raster::from_fn(over.width(), over.height(), |x, y| {
            let [r, g, b, _] = over.get(x, y);
            [r, g, b].map(colour::encode)
        }))
    }
}

/// The painted regions of a document by frame.
fn regions_of(document: &Document) -> Result<BTreeMap<FrameNumber, Vec<FilledRegion>>, PipelineError> {
    let filled = document.filled().map_err(|error| fill::field(&error))?;
    Ok(filled.into_iter().map(|drawing| (drawing.frame, drawing.regions)).collect())
}

/// The footage with the size of a job's pictures.
///
/// # Errors
///
/// [`PipelineError::Option`] for another size of pictures that show the footage.
pub(super) fn sized(footage: &Footage, job: &RenderJob) -> Result<Footage, PipelineError> {
    job.check_scale()?;
    let size = |pixels: usize| ((pixels as f64 * job.scale).round() as usize).max(1);
    Ok(Footage { width: size(footage.width), height: size(footage.height), ..footage.clone() })
}

/// The frames of a job's range on which the document has nothing of what the picture shows, as a message for the user. `None`
/// if there are none, and for pictures of something else.
pub fn undrawn(document: &Document, job: &RenderJob) -> Option<String> {
    let range = frames_of(&document.scene.footage, job.frames.clone()).ok()?;
    let regions = job.picture.shows_regions().then(|| {
        let there = document.filled().ok()?.iter().map(|drawing| drawing.frame).collect();
        lacking(there, range.clone(), "painted", "fill")
    });
    let strokes = job.picture.shows_strokes().then(|| {
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
