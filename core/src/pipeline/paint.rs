//! What was painted and traced on each frame of a document, as pictures.

use super::picture::RenderJob;
use super::strokes::{self, Seen};
use super::{PipelineError, fill, frames_of};
use crate::geometry::Point;
use crate::image::colour;
use crate::project::Document;
use crate::project::fills::FilledRegion;
use crate::render::paint::{Region, paint, painted, shares};
use crate::render::stroke;
use crate::scene::{Colour, Footage, FrameNumber, Raster};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// Number of frames that a message names.
const NAMED: usize = 5;

/// The painted regions and strokes of a document on each frame: what a cel is made of.
#[derive(Debug, Default)]
pub struct Cels {
    regions: BTreeMap<FrameNumber, Vec<FilledRegion>>,
    strokes: BTreeMap<FrameNumber, Vec<Seen>>,
    /// Width of a stroke without widths, in pixels of the footage.
    plain: f64,
}

impl Cels {
    /// The painted regions of a document alone.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Field`] if they cannot be read.
    pub fn regions(document: &Document) -> Result<Self, PipelineError> {
        let filled = document.filled().map_err(|error| fill::field(&error))?;
        let regions = filled.into_iter().map(|drawing| (drawing.frame, drawing.regions)).collect();
        Ok(Self { regions, ..Self::default() })
    }

    /// The strokes of a document alone: traced, else of in-betweens, else drawn.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Field`] if they cannot be read.
    pub fn strokes(document: &Document) -> Result<Self, PipelineError> {
        let (strokes, plain) = (strokes::strokes(document)?, strokes::plain(document));
        Ok(Self { strokes, plain, ..Self::default() })
    }

    /// What the pictures of a job show. Nothing for pictures of something else.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Field`] if the document has nothing of it, or it cannot be read; [`PipelineError::Option`] if the job
    /// names parts, which regions and strokes do not have.
    pub(super) fn of(document: &Document, job: &RenderJob) -> Result<Self, PipelineError> {
        let (regions, strokes) = (job.picture.shows_regions(), job.picture.shows_strokes());
        if let Some(name) = job.parts.as_ref().and_then(|names| names.first()).filter(|_| regions || strokes) {
            let reason = format!("found {name:?}, expected none: painted regions and strokes belong to no part");
            return Err(PipelineError::option("parts", reason));
        }
        let found = |read: Self, field: &str, expected: &str| match read.is_empty() {
            true => Err(PipelineError::Field(format!("{field}: found none, expected {expected}"))),
            false => Ok(read),
        };
        let mut cels = Self::default();
        if regions {
            cels = found(Self::regions(document)?, "filled", "the painted regions that `rototoon fill` writes")?;
        }
        if strokes {
            let expected = "the strokes that `rototoon trace` writes, or drawings";
            cels = Self { regions: cels.regions, ..found(Self::strokes(document)?, "traced", expected)? };
        }
        Ok(cels)
    }

    /// Whether no frame has an entry.
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.strokes.is_empty()
    }

    /// The names of all regions and strokes, as in [`Region::name`].
    pub fn names(&self) -> BTreeSet<String> {
        let regions: BTreeSet<String> = self.regions.values().flatten().map(named).collect();
        let strokes: BTreeSet<strokes::Id> = self.strokes.values().flatten().map(|seen| seen.id).collect();
        let filled = self.strokes.values().flatten().filter(|seen| seen.stroke.fill_colour.is_some());
        let fills = filled.map(|seen| fill_of(seen.id));
        regions.into_iter().chain(strokes.iter().map(strokes::Id::to_string)).chain(fills).collect()
    }

    /// The frames with painted regions, each with the least confidence of one.
    pub(super) fn least_confidence(&self) -> impl Iterator<Item = (FrameNumber, f64)> + '_ {
        let least = |regions: &[FilledRegion]| regions.iter().map(|region| region.confidence).fold(1.0, f64::min);
        self.regions.iter().map(move |(frame, regions)| (*frame, least(regions)))
    }

    /// What is shown on a frame, from back to front: painted regions, then strokes in their order, each fill behind its line. `scale` is the number of pixels of
    /// the picture for each pixel of the footage. The origin is that of the footage.
    pub fn on(&self, frame: FrameNumber, scale: f64) -> Vec<Region> {
        let regions = self.regions.get(&frame).into_iter().flatten().map(|own| region(own, scale));
        let strokes = self.strokes.get(&frame).into_iter().flatten();
        regions.chain(strokes.flat_map(|seen| stroke(seen, self.plain, scale))).collect()
    }

    /// The drawing of a frame over what is shown there.
    pub(super) fn under(&self, frame: FrameNumber, drawing: &Raster<[f32; 4]>) -> Raster<[f32; 4]> {
        let own = self.on(frame, 1.0);
        painted(drawing, &paint(&own, &shares(&own, drawing.width(), drawing.height())))
    }

    /// The picture of a frame, which hides what is behind it, over what is shown there; `None` if that is nothing.
    pub(super) fn under_picture(&self, frame: FrameNumber, picture: &Raster<Colour>) -> Option<Raster<Colour>> {
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

/// The name of a painted region: that of its colour, which all regions of that colour share, otherwise one by its number.
fn named(region: &FilledRegion) -> String {
    region.name.clone().unwrap_or_else(|| format!("region {}", region.track))
}

/// The name of the fill of a stroke that has a line too.
fn fill_of(id: strokes::Id) -> String {
    format!("{id} fill")
}

fn region(own: &FilledRegion, scale: f64) -> Region {
    let FilledRegion { outline, holes, colour, .. } = own;
    Region {
        name: named(own),
        areas: vec![scaled(outline, scale)],
        holes: holes.iter().map(|hole| scaled(hole, scale)).collect(),
        colour: *colour,
        opacity: 1.0,
    }
}

/// A stroke as a region, behind it another one if its fill has another colour. `plain` is the width of one without widths.
fn stroke(seen: &Seen, plain: f64, scale: f64) -> impl Iterator<Item = Region> {
    let line = line(seen, plain, scale);
    let opacity = seen.opacity as f32;
    let fill = seen.stroke.fill_colour.map(|colour| Region {
        name: fill_of(seen.id),
        areas: vec![scaled(&seen.stroke.points, scale)],
        // Through a faint line what is behind the stroke shows, not its fill: line and fill fade as one.
        holes: if opacity < 1.0 { line.areas.clone() } else { Vec::new() },
        colour,
        opacity,
    });
    fill.into_iter().chain([line])
}

/// The line of a stroke, or a solid shape with the line around it.
fn line(seen: &Seen, plain: f64, scale: f64) -> Region {
    let own = &seen.stroke;
    let points = scaled(&own.points, scale);
    let plain = vec![plain; points.len()];
    let widths = if own.widths.is_empty() { &plain } else { &own.widths };
    let radii: Vec<f64> = widths.iter().map(|width| 0.5 * scale * width).collect();
    let mut areas: Vec<Vec<Point>> =
        if seen.is_lined() { stroke::areas(&points, &radii, own.closed) } else { Vec::new() };
    if own.fill {
        areas.push(points);
    }
    let (name, colour) = (seen.id.to_string(), own.colour.unwrap_or_default());
    Region { name, areas, holes: Vec::new(), colour, opacity: seen.opacity as f32 }
}

fn scaled(points: &[Point], scale: f64) -> Vec<Point> {
    points.iter().map(|p| scale * *p).collect()
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
        lacking(there, range.clone(), "painted", &|_| "fill")
    });
    let strokes = job.picture.shows_strokes().then(|| {
        let there = strokes::strokes(document).ok()?.into_keys().collect();
        let keys: Vec<FrameNumber> = document.drawings().ok()?.drawings.iter().map(|drawing| drawing.frame).collect();
        let is_between = |frame: &FrameNumber| keys.first() < Some(frame) && Some(frame) < keys.last();
        lacking(there, range, "drawn", &|frame| if is_between(&frame) { "tween" } else { "trace" })
    });
    let told: Vec<String> = [regions, strokes].into_iter().flatten().flatten().collect();
    (!told.is_empty()).then(|| told.join("; "))
}

/// The frames of a range that are not `there`, and for each the command that makes what is lacking.
fn lacking(
    there: Vec<FrameNumber>,
    range: RangeInclusive<FrameNumber>,
    what: &str,
    command: &dyn Fn(FrameNumber) -> &'static str,
) -> Option<String> {
    let mut by_command: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for frame in range.filter(|frame| there.binary_search(frame).is_err()) {
        by_command.entry(command(frame)).or_default().push(frame.to_string());
    }
    let told = |(command, lacking): (&str, Vec<String>)| {
        let more = lacking.len().saturating_sub(NAMED);
        let listed = lacking[..lacking.len() - more].join(", ");
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let frames = if lacking.len() == 1 { "frame" } else { "frames" };
        format!("{frames} {listed}{more}: not {what}; run `rototoon {command}` there")
    };
    let told: Vec<String> = by_command.into_iter().map(told).collect();
    (!told.is_empty()).then(|| told.join("; "))
}
