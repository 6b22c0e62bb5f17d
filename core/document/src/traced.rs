//! Strokes that tracing found on the drawings of a footage.
//!
//! ```json
//! "traced": [{"frame": 0, "strokes": [{"track": 0, "points": [[x, y], "…"], "closed": false, "widths": [2.5, "…"],
//!   "colour": [r, g, b], "confidence": 0.9}, "…"]}, "…"]
//! ```
//!
//! - Frames ascend. `track` is the number of a stroke, the same on all frames; on one frame each number occurs once.
//! - `widths` has one width in pixels for each point. `widths` and `colour` (sRGB, 0 to 1) are optional.
//! - `fill` says that what is inside a closed stroke is filled with its colour. Without it the stroke is a line. A fill
//!   without `widths` has no line around it.
//! - `fill_colour` is the colour of the fill of a stroke that has a line too.
//! - `confidence` is the probability, 0 to 1, that the stroke is the one of its number. Without it the stroke is beyond
//!   doubt: it was drawn, or begins here.

use super::Document;
use super::fields::{FieldError, by_frame, count, given, object, share, wrong};
use super::line::{self, Line};
use super::save::rounded;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, FrameNumber};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// A stroke on one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedStroke {
    /// Its number on all frames.
    pub track: usize,
    /// Points in pixels.
    pub points: Vec<Point>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Width in pixels at each point; may be empty.
    pub widths: Vec<f64>,
    /// Colour, sRGB-encoded, 0 to 1.
    pub colour: Option<Colour>,
    /// Colour of the fill of a stroke that has a line too; `None` if it has none. Never with `fill`.
    pub fill_colour: Option<Colour>,
    /// The probability that it is the stroke of its number; `None` if it is beyond doubt.
    pub confidence: Option<f64>,
    /// Whether what is inside is filled with the colour, such as a solid black. Only closed strokes are filled. Without
    /// widths there is no line around the fill.
    pub fill: bool,
}

/// The strokes of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedDrawing {
    /// The frame.
    pub frame: FrameNumber,
    /// Strokes from back to front.
    pub strokes: Vec<TracedStroke>,
}

impl Document {
    /// The traced strokes of the document; empty if it has none.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn traced(&self) -> Result<Vec<TracedDrawing>, FieldError> {
        by_frame(&self.other_list("traced")?, ["traced", "strokes"], drawing)
    }

    /// Puts traced strokes into the document, in place of earlier ones. Drawings that are as before keep their text.
    pub fn set_traced(&mut self, drawings: &[TracedDrawing]) {
        let earlier = self.traced().unwrap_or_default();
        let written = self.keeping(
            "traced",
            [&earlier, drawings],
            |drawing| drawing.frame,
            |drawing| {
                let strokes: Vec<Value> = drawing.strokes.iter().map(written).collect();
                json!({"frame": drawing.frame, "strokes": strokes})
            },
        );
        self.set_other_field("traced", written);
    }
}

fn drawing(frame: FrameNumber, list: &[Value], place: &str) -> Result<TracedDrawing, FieldError> {
    let mut tracks = BTreeSet::new();
    let read = |(i, value): (usize, &Value)| {
        let place = format!("{place}[{i}]");
        let stroke = stroke(value, &place)?;
        match tracks.insert(stroke.track) {
            true => Ok(stroke),
            false => Err(wrong(&format!("{place}.track"), &stroke.track.to_string(), "a number once on a frame")),
        }
    };
    Ok(TracedDrawing { frame, strokes: list.iter().enumerate().map(read).collect::<Result<_, _>>()? })
}

fn stroke(value: &Value, place: &str) -> Result<TracedStroke, FieldError> {
    let fields = object(value, place)?;
    let Line { points, closed, fill, widths, colour, fill_colour } = line::read(fields, place, share)?;
    Ok(TracedStroke {
        track: count(fields.get("track"), &format!("{place}.track"))?,
        points,
        closed,
        fill,
        widths,
        colour,
        fill_colour,
        confidence: given(fields, place, "confidence", share)?,
    })
}

fn written(stroke: &TracedStroke) -> Value {
    let TracedStroke { track, points, closed, widths, colour, fill_colour, confidence, fill } = stroke.clone();
    let mut fields = Map::new();
    fields.insert("track".into(), json!(track));
    line::write(&Line { points, closed, fill, widths, colour, fill_colour }, &mut fields, rounded);
    if let Some(confidence) = confidence {
        fields.insert("confidence".into(), json!((confidence * 1e3).round() / 1e3));
    }
    Value::Object(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(traced: &str) -> Document {
        let text = format!(
            r#"{{"rototoon": 1, "footage": {{"pattern": "f_%d.png", "first": 0, "last": 9, "fps": 24, "width": 64,
            "height": 48}}, "parts": [], "note": 1, "traced": {traced}}}"#
        );
        Document::parse(&text, "a.json").unwrap()
    }

    #[test]
    fn what_is_written_is_read_again() {
        let stroke = TracedStroke {
            track: 3,
            points: vec![Point::new(1.5, 2.0), Point::new(7.25, 2.0)],
            closed: false,
            widths: vec![2.0, 2.5],
            colour: Some([0.0, 0.5, 1.0]),
            fill_colour: Some([1.0, 0.25, 0.0]),
            confidence: Some(0.75),
            fill: false,
        };
        let outline = TracedStroke { track: 0, points: vec![Point::ONE; 3], closed: true, ..stroke.clone() };
        let outline = TracedStroke { widths: Vec::new(), colour: None, fill_colour: None, confidence: None, ..outline };
        let black = TracedStroke { track: 1, colour: Some([0.0; 3]), fill: true, ..outline.clone() };
        let drawings = [
            TracedDrawing { frame: -2, strokes: vec![black, stroke, outline] },
            TracedDrawing { frame: 4, strokes: Vec::new() },
        ];
        let mut doc = document("[7]");
        doc.set_traced(&drawings);
        let again = Document::parse(&doc.to_json(), "b.json").unwrap();
        assert_eq!(again.traced().unwrap(), drawings);
        assert_eq!(again.to_json(), doc.to_json());
        assert!(doc.to_json().contains(r#""note": 1"#));
        assert_eq!(doc.to_json().matches(r#""fill""#).count(), 1, "lines are written as before there were fills");
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let said = |traced: &str| document(traced).traced().unwrap_err().to_string();
        assert_eq!(said("7"), "traced: found 7, expected a list");
        assert_eq!(said(r#"[{"frame": 1, "strokes": 2}]"#), "traced[0] (frame 1).strokes: found 2, expected a list");
        let stroke = r#"{"track": 0, "points": [[1, 2]], "closed": false}"#;
        assert_eq!(
            said(&format!(r#"[{{"frame": 1, "strokes": [{stroke}, {stroke}]}}]"#)),
            "traced[0] (frame 1).strokes[1].track: found 0, expected a number once on a frame"
        );
        assert_eq!(
            said(r#"[{"frame": 1, "strokes": []}, {"frame": 1, "strokes": []}]"#),
            "traced[1].frame: found 1, expected more than 1, that of traced[0]"
        );
        let widths = r#"[{"frame": 1, "strokes": [{"track": 0, "points": [[1, 2]], "closed": false, "widths": []}]}]"#;
        let sure = r#"[{"frame": 1, "strokes": [{"track": 0, "points": [[1, 2]], "closed": false, "confidence": 2}]}]"#;
        let open = r#"[{"frame": 1, "strokes": [{"track": 0, "points": [[1, 2]], "closed": false, "fill": true}]}]"#;
        assert_eq!(
            said(open),
            "traced[0] (frame 1).strokes[0].fill: found true on an open stroke, expected a closed stroke"
        );
        assert_eq!(said(sure), "traced[0] (frame 1).strokes[0].confidence: found 2, expected a number from 0 to 1");
        assert_eq!(said(widths), "traced[0] (frame 1).strokes[0].widths: found a list of 0, expected a list of 1");
    }
}
