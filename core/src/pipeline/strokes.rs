//! The strokes that a document shows on each frame, for pictures and exports.
//!
//! A frame shows its traced strokes. Where it has none, it shows those of its in-between, and else those of its drawing.
//!
//! Strokes lie in the order of the document, from back to front, but fills are behind lines. Where a stroke of the film has a line and a fill of another
//! colour, such as the outline of a painted shape, fills stay where they are too, on all frames: such a stroke hides what is drawn before it, and a
//! fill that is drawn after it lies on it.

use super::{PipelineError, fill, order};
use crate::export::SvgStroke;
use crate::project::Document;
use crate::project::drawings::DrawnStroke;
use crate::project::traced::TracedStroke;
use crate::scene::{Colour, FrameNumber};
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
    // One rule for the film: no shape changes its place because of what another frame has.
    if !found.values().flatten().any(|seen| seen.stroke.fill_colour.is_some()) {
        found.values_mut().for_each(|own| own.sort_by_key(|seen| !seen.stroke.fill));
    }
    Ok(found)
}

/// The strokes of a document, each with its points on all frames of the footage, in one order from back to front.
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
    let order =
        order::common(&by_frame.values().map(|own| own.iter().map(|seen| seen.id).collect()).collect::<Vec<_>>());
    let mut found: BTreeMap<Id, SvgStroke> = BTreeMap::new();
    for (frame, mut own) in by_frame.into_iter().flat_map(|(frame, own)| own.into_iter().map(move |s| (frame, s))) {
        own.stroke.colour = if own.traced { traced.get(&own.id).copied() } else { own.stroke.colour };
        let lined = lined.contains(&own.id);
        let known = found.entry(own.id).or_insert_with(|| begun(&own, lined, plain));
        add(known, frame, own, plain);
    }
    Ok(order.into_iter().filter_map(|id| found.remove(&id)).collect())
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

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// A solid square, in a list of strokes.
    fn square(track: usize, side: f64) -> Value {
        let points = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        json!({"track": track, "points": points, "closed": true, "fill": true, "colour": [1, 0, 0]})
    }

    fn document(fields: &Value) -> Document {
        let mut text = json!({"rototoon": 1, "parts": [],
            "footage": {"pattern": "%d.png", "first": 0, "last": 2, "fps": 12, "width": 64, "height": 64}});
        text.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
        Document::parse(&text.to_string(), "p").unwrap()
    }

    /// The order of the strokes of each frame, and that of an SVG file.
    fn orders(fields: &Value) -> (Vec<Vec<String>>, Vec<String>) {
        let document = document(fields);
        let names = |own: &Vec<Seen>| own.iter().map(|seen| seen.id.to_string()).collect();
        let exported = to_export(&document).unwrap().into_iter().map(|stroke| stroke.name).collect();
        (strokes(&document).unwrap().values().map(names).collect(), exported)
    }

    fn names(tracks: &[usize]) -> Vec<String> {
        tracks.iter().map(|track| format!("stroke {track}")).collect()
    }

    #[test]
    fn solid_shapes_keep_the_order_of_the_document_whatever_their_size() {
        let drawing = |frame, side| json!({"frame": frame, "strokes": [square(0, side), square(1, 30.0)]});
        let expected = (vec![names(&[0, 1]); 3], names(&[0, 1]));
        let traced = json!({"traced": [drawing(0, 10.0), drawing(1, 30.0), drawing(2, 60.0)]});
        assert_eq!(orders(&traced), expected);
        let tweened = json!({"drawings": [drawing(0, 10.0), drawing(2, 60.0)], "in_betweens": [drawing(1, 40.0)],
            "matches": [{"frame": 0, "next": 2, "tracks": [[0, 1], [0, 1]]}]});
        assert_eq!(orders(&tweened), expected);
    }

    #[test]
    fn fills_are_behind_lines_on_all_frames_or_on_none() {
        let line = json!({"track": 7, "points": [[0, 0], [9, 9]], "closed": false});
        let outlined =
            json!({"track": 9, "points": [[1, 1], [5, 1], [5, 5]], "closed": true, "fill_colour": [0, 1, 0]});
        let mut traced = [0, 1, 2].map(|frame| json!({"frame": frame, "strokes": [line, square(0, 9.0)]}));
        assert_eq!(orders(&json!({"traced": traced})), (vec![names(&[0, 7]); 3], names(&[0, 7])));
        traced[1]["strokes"].as_array_mut().unwrap().push(outlined);
        let found = orders(&json!({"traced": traced}));
        assert_eq!(found, (vec![names(&[7, 0]), names(&[7, 0, 9]), names(&[7, 0])], names(&[7, 0, 9])));
    }
}
