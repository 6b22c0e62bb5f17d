//! Clicks of a painter, and the painted regions of every frame.
//!
//! ```json
//! "fills": [{"frame": 0, "regions": [{"at": [x, y], "colour": [r, g, b]}, "…"]}, "…"],
//! "filled": [{"frame": 0, "regions": [{"outline": [[x, y], "…"], "holes": [[[x, y], "…"], "…"], "colour": [r, g, b],
//!   "track": 3, "confidence": 0.9}, "…"]}, "…"]
//! ```
//!
//! - Frames ascend. Colours are sRGB-encoded, 0 to 1. Paper is a colour too. Places are pixels.
//! - `track` is the number of a region, the same on all frames; on one frame each number occurs once.
//! - Later regions of a frame lie over earlier ones. What is within a hole is not painted by its region.
//! - `confidence` is the probability, 0 to 1, that the colour is right; 1 where an artist clicked.

use super::Document;
use super::drawings::lines;
use super::fields::{FieldError, array, by_frame, colour, count, given, object, point, share, wrong};
use super::save::DECIMALS;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, FrameNumber};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// A click with the paint bucket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillClick {
    /// The place in pixels.
    pub at: Point,
    /// The colour, sRGB-encoded, 0 to 1. `None` says that the region stays without paint.
    pub colour: Option<Colour>,
}

/// The clicks of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FillClicks {
    /// The frame.
    pub frame: FrameNumber,
    /// The clicks.
    pub clicks: Vec<FillClick>,
}

impl FillClicks {
    /// The entry of the document's field.
    pub fn to_json(&self) -> Value {
        let click = |click: &FillClick| {
            let at = click.at.to_array().map(|value| rounded(value, DECIMALS));
            json!({"at": at, "colour": click.colour.map(written_colour)})
        };
        json!({"frame": self.frame, "regions": self.clicks.iter().map(click).collect::<Vec<_>>()})
    }
}

/// A painted region on one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FilledRegion {
    /// Its outline in pixels, closed.
    pub outline: Vec<Point>,
    /// The outlines of its holes.
    pub holes: Vec<Vec<Point>>,
    /// Its colour, sRGB-encoded, 0 to 1.
    pub colour: Colour,
    /// Its number on all frames.
    pub track: usize,
    /// The probability that the colour is right, 0 to 1.
    pub confidence: f64,
}

/// The painted regions of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilledDrawing {
    /// The frame.
    pub frame: FrameNumber,
    /// The regions from back to front.
    pub regions: Vec<FilledRegion>,
}

impl Document {
    /// The clicks of the painter; empty if there are none.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn fills(&self) -> Result<Vec<FillClicks>, FieldError> {
        let read = |on: FrameNumber, list: &[Value], place: &str| {
            let click = |(i, value): (usize, &Value)| click(value, &format!("{place}[{i}]"));
            Ok(FillClicks { frame: on, clicks: list.iter().enumerate().map(click).collect::<Result<_, _>>()? })
        };
        by_frame(&self.other_list("fills")?, ["fills", "regions"], read)
    }

    /// Puts clicks into the document, in place of earlier ones. Without any, the field is removed.
    pub fn set_fills(&mut self, fills: &[FillClicks]) {
        if fills.is_empty() {
            self.remove_other_field("fills");
            return;
        }
        let written = fills.iter().map(FillClicks::to_json);
        self.set_other_field("fills", lines(written));
    }

    /// The painted regions of all frames; empty if there are none.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn filled(&self) -> Result<Vec<FilledDrawing>, FieldError> {
        by_frame(&self.other_list("filled")?, ["filled", "regions"], |on, list, place| {
            let mut tracks = BTreeSet::new();
            let read = |(i, value): (usize, &Value)| {
                let place = format!("{place}[{i}]");
                let region = region(value, &place)?;
                match tracks.insert(region.track) {
                    true => Ok(region),
                    false => {
                        Err(wrong(&format!("{place}.track"), &region.track.to_string(), "a number once on a frame"))
                    }
                }
            };
            Ok(FilledDrawing { frame: on, regions: list.iter().enumerate().map(read).collect::<Result<_, _>>()? })
        })
    }

    /// Puts painted regions into the document, in place of earlier ones.
    pub fn set_filled(&mut self, drawings: &[FilledDrawing]) {
        let written = drawings.iter().map(|drawing| {
            let regions: Vec<Value> = drawing.regions.iter().map(written).collect();
            json!({"frame": drawing.frame, "regions": regions})
        });
        self.set_other_field("filled", lines(written));
    }
}

fn click(value: &Value, place: &str) -> Result<FillClick, FieldError> {
    let fields = object(value, place)?;
    let at = point(fields.get("at"), &format!("{place}.at"))?;
    let colour = match fields.get("colour") {
        Some(Value::Null) => None,
        given => Some(colour(given, &format!("{place}.colour"), share)?),
    };
    Ok(FillClick { at, colour })
}

fn region(value: &Value, place: &str) -> Result<FilledRegion, FieldError> {
    let fields = object(value, place)?;
    let holes = match fields.get("holes") {
        None => Vec::new(),
        Some(given) => {
            let list = array(Some(given), &format!("{place}.holes"))?;
            list.iter()
                .enumerate()
                .map(|(k, hole)| outline(Some(hole), &format!("{place}.holes[{k}]")))
                .collect::<Result<_, _>>()?
        }
    };
    Ok(FilledRegion {
        outline: outline(fields.get("outline"), &format!("{place}.outline"))?,
        holes,
        colour: colour(fields.get("colour"), &format!("{place}.colour"), share)?,
        track: count(fields.get("track"), &format!("{place}.track"))?,
        confidence: given(fields, place, "confidence", share)?.unwrap_or(1.0),
    })
}

fn outline(value: Option<&Value>, place: &str) -> Result<Vec<Point>, FieldError> {
    array(value, place)?.iter().enumerate().map(|(i, p)| point(Some(p), &format!("{place}[{i}]"))).collect()
}

fn written(region: &FilledRegion) -> Value {
    let line = |points: &[Point]| -> Vec<[f64; 2]> {
        points.iter().map(|p| p.to_array().map(|value| rounded(value, DECIMALS))).collect()
    };
    let mut out = Map::new();
    out.insert("outline".into(), json!(line(&region.outline)));
    if !region.holes.is_empty() {
        out.insert("holes".into(), json!(region.holes.iter().map(|hole| line(hole)).collect::<Vec<_>>()));
    }
    out.insert("colour".into(), json!(written_colour(region.colour)));
    out.insert("track".into(), json!(region.track));
    out.insert("confidence".into(), json!(rounded(region.confidence, 3)));
    Value::Object(out)
}

/// Colours are told as they were given: 0.1 and not 0.10000000149.
fn written_colour(colour: Colour) -> [f64; 3] {
    colour.map(|channel| rounded(f64::from(channel), 6))
}

fn rounded(value: f64, decimals: i32) -> f64 {
    (value * 10f64.powi(decimals)).round() / 10f64.powi(decimals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Document;

    fn document(fields: &str) -> Document {
        let text = format!(
            r#"{{"rototoon": 1, "footage": {{"pattern": "%d.png", "first": 0, "last": 3, "fps": 12, "width": 64,
            "height": 48}}, "parts": [], "note": 1, {fields}}}"#
        );
        Document::parse(&text, "a.json").unwrap()
    }

    #[test]
    fn clicks_are_read() {
        let doc = document(r#""fills": [{"frame": 2, "regions": [{"at": [3, 4.5], "colour": [1, 0.5, 0]}]}]"#);
        let click = FillClick { at: Point::new(3.0, 4.5), colour: Some([1.0, 0.5, 0.0]) };
        assert_eq!(doc.fills().unwrap(), [FillClicks { frame: 2, clicks: vec![click] }]);
        assert!(document(r#""author": 1"#).fills().unwrap().is_empty());
    }

    #[test]
    fn clicks_are_written_and_removed() {
        let mut doc = document(r#""author": "a""#);
        let click = FillClick { at: Point::new(3.0, 4.5), colour: Some([0.1, 0.5, 0.0]) };
        let bare = FillClick { colour: None, ..click };
        let fills = [FillClicks { frame: -1, clicks: vec![click, bare] }, FillClicks { frame: 2, clicks: vec![click] }];
        doc.set_fills(&fills);
        let again = Document::parse(&doc.to_json(), "a.json").unwrap();
        assert_eq!(again.fills().unwrap(), fills);
        doc.set_fills(&[]);
        let text = doc.to_json();
        assert!(!text.contains("fills") && text.contains("author"), "{text}");
    }

    #[test]
    fn painted_regions_are_written_and_read() {
        let mut doc = document(r#""author": "a""#);
        let square = |at: f64| [(0.0, 0.0), (9.5, 0.0), (9.5, 9.5)].map(|(x, y)| Point::new(at + x, at + y)).to_vec();
        let colour = [0.1, 0.2, 0.3];
        let region =
            FilledRegion { outline: square(1.0), holes: vec![square(3.0)], colour, track: 4, confidence: 0.75 };
        let drawings = [FilledDrawing { frame: 1, regions: vec![region] }];
        doc.set_filled(&drawings);
        let text = doc.to_json();
        assert!(text.contains("0.1"), "{text}");
        let again = Document::parse(&text, "a.json").unwrap();
        assert_eq!(again.filled().unwrap(), drawings);
    }

    #[test]
    fn errors_name_frame_and_field() {
        let fills = |text: &str| document(&format!(r#""fills": {text}"#)).fills().unwrap_err().to_string();
        assert_eq!(fills("7"), "fills: found 7, expected a list");
        assert_eq!(
            fills(r#"[{"frame": 1, "regions": [{"at": [1, 2], "colour": [2, 0, 0]}]}]"#),
            "fills[0] (frame 1).regions[0].colour[0]: found 2, expected a number from 0 to 1"
        );
        assert_eq!(
            fills(r#"[{"frame": 1, "regions": []}, {"frame": 1, "regions": []}]"#),
            "fills[1].frame: found 1, expected more than 1, that of fills[0]"
        );
        let filled = |text: &str| document(&format!(r#""filled": {text}"#)).filled().unwrap_err().to_string();
        let twice = r#"{"outline": [], "colour": [0, 0, 0], "track": 1}"#;
        assert_eq!(
            filled(&format!(r#"[{{"frame": 0, "regions": [{twice}, {twice}]}}]"#)),
            "filled[0] (frame 0).regions[1].track: found 1, expected a number once on a frame"
        );
    }
}
