//! The strokes that a document shows on each frame, for pictures and exports.
//!
//! A frame shows its traced strokes. Where it has none, it shows those of its in-between, and else those of its drawing.
//!
//! Fills are behind lines ([`behind`]). But where a stroke has a line and a fill of another colour, such as the outline of a
//! painted shape, the frame's strokes keep their own order, from back to front: such a stroke hides what is drawn before it, and a
//! fill that is drawn after it lies on it.

use super::{PipelineError, fill};
use crate::export::SvgStroke;
use crate::geometry::{Point, polygon};
use crate::project::Document;
use crate::project::drawings::DrawnStroke;
use crate::project::traced::TracedStroke;
use crate::scene::{Colour, FrameNumber};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Width of a stroke without widths, in pixels of 540 lines.
const PLAIN: f64 = 2.0;

/// Widths that differ less are written as one, in pixels.
const ROUNDING: f64 = 0.005;
/// A stroke whose width differs by more than this share from its mean somewhere is told as one of varying width.
const VARIES: f64 = 0.1;

/// Which stroke it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Id {
    /// Its number, which is the same on all frames.
    Track(usize),
    /// The frame of its drawing and its index there: the drawings were not tweened, or changed since, so nothing says which
    /// stroke it is on other frames.
    Drawn(FrameNumber, usize),
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Track(track) => write!(f, "stroke {track}"),
            Self::Drawn(frame, index) => write!(f, "frame {frame} stroke {index}"),
        }
    }
}

/// A stroke on a frame.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub id: Id,
    pub stroke: TracedStroke,
    /// 0 to 1.
    pub opacity: f64,
    /// Whether its colour was read from a picture. Then it is not quite the same on each frame, though nobody changed it.
    pub traced: bool,
}

impl Seen {
    /// Whether there is a line along it: fills have one only if they have widths.
    pub fn is_lined(&self) -> bool {
        !self.stroke.fill || !self.stroke.widths.is_empty()
    }
}

/// The strokes of each frame, from back to front.
///
/// # Errors
///
/// [`PipelineError::Field`].
pub(super) fn strokes(document: &Document) -> Result<BTreeMap<FrameNumber, Vec<Seen>>, PipelineError> {
    let drawings = document.drawings().map_err(|error| fill::field(&error))?.drawings;
    let numbers = document.stroke_numbers().map_err(|error| fill::field(&error))?;
    let between = document.in_betweens().map_err(|error| fill::field(&error))?;
    let traced = document.traced().map_err(|error| fill::field(&error))?;
    let drawn = |id: Id, opacity: f64, own: DrawnStroke| {
        let DrawnStroke { points, closed, fill, widths, colour, fill_colour, .. } = own;
        let stroke = TracedStroke { points, closed, fill, widths, colour, fill_colour, ..TracedStroke::default() };
        Seen { id, opacity, stroke, traced: false }
    };
    let mut found: BTreeMap<FrameNumber, Vec<Seen>> = BTreeMap::new();
    for own in drawings {
        let tracks = numbers.get(&own.frame);
        let id = |k: usize| tracks.map_or(Id::Drawn(own.frame, k), |tracks| Id::Track(tracks[k]));
        let strokes = own.strokes.into_iter().enumerate();
        found.insert(own.frame, strokes.map(|(k, stroke)| drawn(id(k), 1.0, stroke)).collect());
    }
    for own in between {
        let strokes = own.strokes.into_iter();
        let seen = strokes.map(|(track, opacity, stroke)| drawn(Id::Track(track), opacity, stroke));
        found.insert(own.frame, seen.collect());
    }
    for own in traced {
        let seen = |stroke: TracedStroke| Seen { id: Id::Track(stroke.track), opacity: 1.0, stroke, traced: true };
        found.insert(own.frame, own.strokes.into_iter().map(seen).collect());
    }
    let key = |own: &Seen| (own.stroke.fill, area(&own.stroke.points));
    let sorted = |own: &&mut Vec<Seen>| own.iter().all(|seen| seen.stroke.fill_colour.is_none());
    found.values_mut().filter(sorted).for_each(|own| own.sort_by(|a, b| behind(key(a), key(b))));
    Ok(found)
}

/// The strokes of a document, each with its points on all frames of the footage.
///
/// # Errors
///
/// [`PipelineError::Field`].
pub(super) fn to_export(document: &Document) -> Result<Vec<SvgStroke>, PipelineError> {
    let plain = plain(document);
    let mut by_frame = strokes(document)?;
    // The colour of a traced line is that of its first frame: others are read from their pictures and flicker.
    let mut traced: BTreeMap<Id, Colour> = BTreeMap::new();
    for own in by_frame.values().flatten().filter(|own| own.traced) {
        traced.entry(own.id).or_insert(own.stroke.colour.unwrap_or_default());
    }
    let footage = &document.scene.footage;
    by_frame.retain(|frame, _| (footage.first..=footage.last).contains(frame));
    let lined: BTreeSet<Id> = by_frame.values().flatten().filter(|own| own.is_lined()).map(|own| own.id).collect();
    let order = common_order(&by_frame);
    let mut found: BTreeMap<Id, SvgStroke> = BTreeMap::new();
    for (frame, mut own) in by_frame.into_iter().flat_map(|(frame, own)| own.into_iter().map(move |s| (frame, s))) {
        own.stroke.colour = if own.traced { traced.get(&own.id).copied() } else { own.stroke.colour };
        let lined = lined.contains(&own.id);
        let known = found.entry(own.id).or_insert_with(|| begun(&own, lined, plain));
        add(known, frame, own, plain);
    }
    // Else the numbers follow the order of the first drawing.
    if found.values().any(|stroke| !stroke.fills.is_empty()) {
        return Ok(order.into_iter().filter_map(|id| found.remove(&id)).collect());
    }
    let mut found: Vec<SvgStroke> = found.into_values().collect();
    let largest = |s: &SvgStroke| s.points.values().map(|points| area(points)).fold(0.0, f64::max);
    found.sort_by(|a, b| behind((a.fill, largest(a)), (b.fill, largest(b))));
    Ok(found)
}

/// A stroke as it begins on its first frame. `lined` says whether it has a line on any frame.
fn begun(own: &Seen, lined: bool, plain: f64) -> SvgStroke {
    let hidden = lined && !own.is_lined();
    SvgStroke {
        name: own.id.to_string(),
        closed: own.stroke.closed,
        width: if hidden { 0.0 } else { mean(&own.stroke.widths).unwrap_or(plain) },
        colour: own.stroke.colour.unwrap_or_default(),
        fill: own.stroke.fill && !hidden,
        lined,
        ..SvgStroke::default()
    }
}

/// Adds a stroke on a frame.
fn add(known: &mut SvgStroke, frame: FrameNumber, mut own: Seen, plain: f64) {
    let mut width = mean(&own.stroke.widths).unwrap_or(plain);
    // A stroke whose line is hidden on some frames keeps its fill there, under a line without width.
    if known.lined && !own.is_lined() {
        width = 0.0;
        own.stroke.fill_colour = Some(own.stroke.colour.take().unwrap_or_default());
    }
    if let Some(colour) = own.stroke.fill_colour {
        known.fills.insert(frame, colour);
    }
    if let Some(colour) = own.stroke.colour.filter(|colour| *colour != known.colour) {
        known.colours.insert(frame, colour);
    }
    if own.stroke.closed != known.closed {
        known.turned.insert(frame);
    }
    known.points.insert(frame, own.stroke.points);
    if (width - known.width).abs() > ROUNDING {
        known.widths.insert(frame, width);
    }
    if own.opacity < 1.0 {
        known.opacities.insert(frame, own.opacity);
    }
}

/// All strokes in one order from back to front. Those of the first frame have its order. A stroke that comes later lies where its frame has it: just over the one
/// that is behind it there.
fn common_order(by_frame: &BTreeMap<FrameNumber, Vec<Seen>>) -> Vec<Id> {
    let mut order: Vec<Id> = Vec::new();
    let mut known: BTreeSet<Id> = BTreeSet::new();
    for own in by_frame.values() {
        let mut before: Option<Id> = None;
        for seen in own {
            if known.insert(seen.id) {
                let place = before.and_then(|id| order.iter().position(|other| *other == id));
                order.insert(place.map_or(0, |place| place + 1), seen.id);
            }
            before = Some(seen.id);
        }
    }
    order
}

/// Says how many strokes have a width that varies along them, of which an SVG file has the mean; `None` if there are none.
pub(super) fn varying(document: &Document) -> Option<String> {
    let mut found: BTreeSet<Id> = BTreeSet::new();
    for own in strokes(document).ok()?.into_values().flatten() {
        let Some(mean) = mean(&own.stroke.widths) else { continue };
        if own.stroke.widths.iter().any(|width| (width - mean).abs() > VARIES * mean) {
            found.insert(own.id);
        }
    }
    let first = found.first()?;
    let count = found.len();
    let which = if count == 1 { format!("{first} has") } else { format!("{count} strokes such as {first} have") };
    Some(format!("{which} a width that varies along the line: the file has the mean of each frame"))
}

/// Width in pixels of a stroke without widths.
pub(super) fn plain(document: &Document) -> f64 {
    PLAIN * document.scene.footage.height as f64 / 540.0
}

/// The order from back to front: fills are behind lines, and a larger fill is behind a smaller one, such as its hole.
pub(super) fn behind(a: (bool, f64), b: (bool, f64)) -> Ordering {
    match (a.0, b.0) {
        (true, true) => b.1.total_cmp(&a.1),
        (fill, other) => other.cmp(&fill),
    }
}

/// The area within an outline, in square pixels.
pub(super) fn area(points: &[Point]) -> f64 {
    polygon::signed_area(points).abs()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
