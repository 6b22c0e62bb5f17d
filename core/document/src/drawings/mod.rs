//! Drawings on key frames, pairs made by hand, pegs, and the in-betweens made from them.
//!
//! Besides its scene a document may contain:
//!
//! ```json
//! "drawings": [{"frame": 0, "spacing": "smooth", "corner": false, "strokes": [
//!   {"points": [[x, y], "…"], "closed": true, "widths": [2.5, "…"], "colour": [r, g, b], "material": 0, "layer": 2, "peg": "arm"}, "…"]}, "…"],
//! "pairs": [{"frame": 0, "from": 3, "to": 5}, {"frame": 0, "from": 4, "to": null}],
//! "pegs": [{"name": "arm", "parent": "body", "pivot": [x, y], "keys": [
//!   {"frame": 0, "shift": [x, y], "turn": 30, "scale": 1.2, "timing": "ease_in_out"}, "…"]}]
//! ```
//!
//! - `drawings`: frames ascend; strokes are listed from back to front. `widths` (pixels, one for each point), `colour` (sRGB, 0 to
//!   1), `material`, `layer` and `peg` are optional. So is `fill`: the closed stroke is the outline of a shape filled with its
//!   colour. Without `widths` it has no line around it. So is `fill_colour`, the colour of the fill of a stroke that has a line
//!   too. `corner` is optional too: it marks a corner in time, where velocities need not join. `spacing`
//!   determines the movement to the next drawing: `"smooth"` (the default), a movement function, or a spacing chart,
//!   which is a list with the share of the way for each frame between.
//! - A movement function is `"constant"` (a hold), `"linear"`, `"ease_in"`, `"ease_out"`, `"ease_in_out"`, `"cosine"`,
//!   `"bounce"`, `{"curve": [[time, share], …]}`, or `{"bounce": count}`.
//! - `pairs`: stroke `from` of the drawing on `frame` becomes stroke `to` of the next drawing, or vanishes if `to` is
//!   null. Both are indices from 0.
//! - `pegs`: `turn` is in degrees from x towards y, and complete turns count. Fields missing in a key have their values
//!   at rest. A peg without `parent`, or with `null`, has none.
//!
//! Tweening writes these fields; they replace those of an earlier run:
//!
//! ```json
//! "matches": [{"frame": 0, "next": 8, "pairs": [{"from": 3, "to": 5, "reversed": false, "start": 0.25,
//!   "confidence": 0.97, "by_hand": true}, "…"], "split": [{"whole": 1, "pieces": [[2, false], [7, true]]}], "joined": [],
//!   "vanished": [4], "appeared": [], "tracks": [[0, 1, "…"], [1, 0, "…"]]}, "…"],
//! "in_betweens": [{"frame": 1, "strokes": [{"track": 0, "points": [[x, y], "…"], "closed": true, "opacity": 1,
//!   "widths": "…", "colour": "…", "fill_colour": "…", "material": "…", "layer": "…"}, "…"]}, "…"]
//! ```
//!
//! - `start`: for closed strokes, the position of the first point on the counterpart, as a share of the counterpart's
//!   length.
//! - `track`: the number of a stroke, the same on all frames.
//! - `tracks`: the numbers of the strokes of both drawings, in the order of their strokes.

mod adding;
mod between;
mod read;

pub use between::DrawnBetween;
pub use read::{read_pegs, read_timing};

use super::Document;
use super::fields::{array, wrong};
use super::line::{self, Line};
use super::schema::{Field, TOP};
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use serde_json::{Map, Value, json};

pub use super::fields::FieldError as DrawingsError;

/// A movement function or spacing chart, as written in a document.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum WrittenTiming {
    /// `"smooth"`.
    #[default]
    Smooth,
    /// The name of a movement function.
    Named(String),
    /// `{"curve": [[time, share], …]}`.
    Curve(Vec<(f64, f64)>),
    /// `{"bounce": count}`.
    Bounce(u32),
    /// A spacing chart: shares of the way.
    Chart(Vec<f64>),
}

/// A stroke of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnStroke {
    /// Its points in pixels.
    pub points: Vec<Point>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Whether it is the outline of a solid shape without a line around it, as in [`TracedStroke`](crate::traced::TracedStroke).
    /// Then it is closed.
    pub fill: bool,
    /// Width of the line in pixels at each point; may be empty.
    pub widths: Vec<f64>,
    /// Colour, sRGB-encoded, 0 to 1.
    pub colour: Option<[f32; 3]>,
    /// Colour of the fill of a stroke that has a line too; `None` if it has none. Never with `fill`.
    pub fill_colour: Option<[f32; 3]>,
    /// Number of the stroke's material.
    pub material: Option<u32>,
    /// Number of the stroke's layer.
    pub layer: Option<u32>,
    /// Index of the stroke's peg.
    pub peg: Option<usize>,
}

/// A drawing on a key frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The frame.
    pub frame: FrameNumber,
    /// Strokes from back to front.
    pub strokes: Vec<DrawnStroke>,
    /// Spacing of the movement to the next drawing.
    pub spacing: WrittenTiming,
    /// Whether this is a corner in time, where velocities need not join.
    pub corner: bool,
}

/// A pair made by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawnPair {
    /// Index of the earlier drawing.
    pub drawing: usize,
    /// Index of its stroke.
    pub from: usize,
    /// Index of the stroke of the next drawing; `None` if the stroke vanishes.
    pub to: Option<usize>,
}

/// A peg's key.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPegKey {
    /// The frame.
    pub frame: FrameNumber,
    /// Shift in pixels.
    pub shift: Point,
    /// Rotation in degrees, from x towards y.
    pub turn: f64,
    /// Scale; 1 at rest.
    pub scale: f64,
    /// Movement function to the next key.
    pub timing: WrittenTiming,
}

/// A peg.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnPeg {
    /// Unique name.
    pub name: String,
    /// Index of the parent peg.
    pub parent: Option<usize>,
    /// Pivot in pixels.
    pub pivot: Point,
    /// Its keys.
    pub keys: Vec<DrawnPegKey>,
}

/// The data for tweening in a document.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawings {
    /// Drawings in ascending order of frames.
    pub drawings: Vec<Drawing>,
    /// Pairs made by hand.
    pub pairs: Vec<DrawnPair>,
    /// Pegs.
    pub pegs: Vec<DrawnPeg>,
}

impl Document {
    /// The drawings, pairs and pegs of the document; empty if it has none.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn drawings(&self) -> Result<Drawings, DrawingsError> {
        let (read, problems) = self.drawings_and_problems();
        problems.into_iter().next().map_or(Ok(read), Err)
    }

    /// The drawings, pairs and pegs of the document, and all invalid fields. An invalid value is replaced by its
    /// default, so indices stay valid.
    pub fn drawings_and_problems(&self) -> (Drawings, Vec<DrawingsError>) {
        read::Reader::default().document(self)
    }

    /// Whether the document has drawings, in-betweens, traced strokes or painted regions, or lists for them.
    pub fn has_drawn(&self) -> bool {
        ["drawings", "in_betweens", "traced", "filled"].iter().any(|name| self.other_field(name).is_some())
    }

    /// Puts the list `json` into a field that is not part of the document's scene. It replaces an earlier value.
    pub(super) fn set_other_field(&mut self, name: &'static str, json: String) {
        if self.layout.top.is_empty() {
            self.layout.top.extend(TOP.map(Field::Known));
        }
        let field = Field::Unknown { name: name.into(), json };
        match self.layout.top.iter_mut().find(|field| field.name() == name) {
            Some(known) => *known = field,
            None => self.layout.top.push(field),
        }
    }

    /// Takes a field that is not part of the document's scene out of it.
    pub(super) fn remove_other_field(&mut self, name: &'static str) {
        self.layout.top.retain(|field| field.name() != name);
    }

    pub(super) fn other_field(&self, name: &str) -> Option<&str> {
        self.layout.top.iter().find_map(|field| match field {
            Field::Unknown { name: own, json } if own == name => Some(json.as_str()),
            _ => None,
        })
    }

    /// The list in a field that is not part of the scene; empty if the field is missing.
    pub(super) fn other_list(&self, name: &'static str) -> Result<Vec<Value>, DrawingsError> {
        match self.other_field(name) {
            Some(json) => {
                let value = serde_json::from_str(json).map_err(|e| wrong(name, &e.to_string(), "JSON"))?;
                array(Some(&value), name).cloned()
            }
            None => Ok(Vec::new()),
        }
    }
}

/// Place of a drawing in messages: its JSON path and frame.
pub fn drawing_place(index: usize, frame: FrameNumber) -> String {
    format!("drawings[{index}] (frame {frame})")
}

/// Place of a pair in messages: its JSON path and the frame of its earlier drawing.
pub fn pair_place(index: usize, frame: FrameNumber) -> String {
    format!("pairs[{index}] (frame {frame})")
}

/// Place of a peg in messages: its JSON path and name.
pub fn peg_place(index: usize, name: &str) -> String {
    format!("pegs[{index}] {name:?}")
}

/// Place of a key of the peg at `peg` in messages: its JSON path and frame.
pub fn peg_key_place(peg: &str, key: usize, frame: FrameNumber) -> String {
    format!("{peg}.keys[{key}] (frame {frame})")
}

/// A JSON list with one element in each line.
pub(super) fn lines(values: impl Iterator<Item = Value>) -> String {
    lines_of(values.map(|value| value.to_string()))
}

/// A JSON list of these texts, one in each line.
pub(super) fn lines_of(elements: impl Iterator<Item = String>) -> String {
    let lines: Vec<String> = elements.map(|element| format!("\n    {element}")).collect();
    if lines.is_empty() { "[]".into() } else { format!("[{}\n  ]", lines.join(",")) }
}

fn stroke_fields(stroke: &DrawnStroke, written: impl Fn(f64) -> f64) -> Map<String, Value> {
    let DrawnStroke { points, closed, fill, widths, colour, fill_colour, .. } = stroke.clone();
    let mut fields = Map::new();
    line::write(&Line { points, closed, fill, widths, colour, fill_colour }, &mut fields, written);
    for (name, number) in [("material", stroke.material), ("layer", stroke.layer)] {
        if let Some(number) = number {
            fields.insert(name.into(), json!(number));
        }
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A document with these fields.
    pub(super) fn document(fields: &str) -> Document {
        let text = format!(
            r#"{{"rototoon": 1, "footage": {{"pattern": "f_%d.png", "first": 0, "last": 9, "fps": 24, "width": 64,
            "height": 48}}, "parts": [], {fields}}}"#
        );
        Document::parse(&text, "a.json").unwrap()
    }

    #[test]
    fn everything_is_read() {
        let read = document(
            r#""drawings": [{"frame": 0, "spacing": [0.2, 0.9], "strokes": [{"points": [[1, 2.5], [3, 4]], "closed": false,
            "colour": [0, 0.5, 1], "material": 3, "layer": 1, "peg": "arm"}]}, {"frame": 3, "corner": true, "strokes": []}],
            "pairs": [{"frame": 0, "from": 0, "to": null}],
            "pegs": [{"name": "arm", "parent": "body", "pivot": [1, 1], "keys": [{"frame": 0, "turn": 90,
            "timing": {"curve": [[0.5, 0.2]]}}]}, {"name": "body", "pivot": [0, 0], "keys": []}]"#,
        )
        .drawings()
        .unwrap();
        let stroke = &read.drawings[0].strokes[0];
        assert_eq!(stroke.points, [Point::new(1.0, 2.5), Point::new(3.0, 4.0)]);
        assert_eq!(
            (stroke.colour, stroke.material, stroke.layer, stroke.peg, stroke.fill),
            (Some([0.0, 0.5, 1.0]), Some(3), Some(1), Some(0), false)
        );
        assert_eq!(read.drawings[0].spacing, WrittenTiming::Chart(vec![0.2, 0.9]));
        assert!(read.drawings[1].corner);
        assert_eq!(read.pairs, [DrawnPair { drawing: 0, from: 0, to: None }]);
        assert_eq!((read.pegs[0].parent, read.pegs[0].keys[0].turn), (Some(1), 90.0));
        assert_eq!(read.pegs[0].keys[0].timing, WrittenTiming::Curve(vec![(0.5, 0.2)]));
        let root =
            document(r#""pegs": [{"name": "a", "parent": null, "pivot": [0, 0], "keys": []}]"#).drawings().unwrap();
        assert_eq!(root.pegs[0].parent, None);
        assert_eq!(document(r#""x": 1"#).drawings(), Ok(Drawings::default()));
    }

    #[test]
    fn a_line_and_its_fill_are_read_and_written() {
        let text = |more: &str| {
            let colours = r#""colour": [0, 0, 0], "fill_colour": [0.25, 0.5, 1]"#;
            format!(
                r#""drawings": [{{"frame": 0, "strokes": [{{"points": [[0, 0]], "closed": true{more}, {colours}}}]}}]"#
            )
        };
        let read = document(&text("")).drawings().unwrap();
        let stroke = &read.drawings[0].strokes[0];
        assert_eq!((stroke.colour, stroke.fill_colour, stroke.fill), (Some([0.0; 3]), Some([0.25, 0.5, 1.0]), false));
        assert_eq!(stroke_fields(stroke, |value| value)["fill_colour"], json!([0.25, 0.5, 1.0]));
        let error = document(&text(r#", "fill": true"#)).drawings().unwrap_err().to_string();
        let expected = "drawings[0] (frame 0).strokes[0].fill_colour: found a colour, expected none beside fill: ";
        assert!(error.starts_with(expected), "{error}");
        let error = document(&text("").replace("0.25", "2")).drawings().unwrap_err().to_string();
        assert!(error.starts_with("drawings[0] (frame 0).strokes[0].fill_colour[0]: found 2"), "{error}");
    }

    #[test]
    fn the_outline_of_a_solid_shape_is_read_and_written() {
        let text = r#"{"points": [[0, 0], [9, 0], [0, 9]], "closed": true, "fill": true, "colour": [0, 0, 0]}"#;
        let read = document(&format!(r#""drawings": [{{"frame": 0, "strokes": [{text}]}}]"#)).drawings().unwrap();
        let stroke = &read.drawings[0].strokes[0];
        assert!(stroke.fill && stroke.closed);
        assert_eq!(stroke_fields(stroke, |value| value)["fill"], true);
        assert_eq!(stroke_fields(&DrawnStroke { fill: false, ..stroke.clone() }, |value| value).get("fill"), None);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let said = |fields: &str| document(fields).drawings().unwrap_err().to_string();
        assert_eq!(said(r#""drawings": 7"#), "drawings: found 7, expected a list");
        let stroke = |text: &str| said(&format!(r#""drawings": [{{"frame": 0, "strokes": [{text}]}}]"#));
        assert_eq!(stroke("{}"), "drawings[0] (frame 0).strokes[0].points: found nothing, expected a list");
        assert_eq!(
            stroke(r#"{"points": [[1, "x"]], "closed": true}"#),
            r#"drawings[0] (frame 0).strokes[0].points[0]: found [1,"x"], expected a point [x, y] of numbers between -1e6 and 1e6"#
        );
        assert!(
            stroke(r#"{"points": [], "closed": true, "peg": "none"}"#)
                .ends_with(r#"found "none", expected the name of a peg"#)
        );
        let twice = r#""drawings": [{"frame": 4, "strokes": []}, {"frame": 4, "strokes": []}]"#;
        assert_eq!(said(twice), "drawings[1] (frame 4).frame: found 4, expected more than 4, that of drawings[0]");
        assert_eq!(
            said(r#""pairs": [{"frame": 4, "from": 0, "to": 1}]"#),
            "pairs[0].frame: found 4, expected the frame of a drawing that has a next one"
        );
        assert!(
            said(r#""pegs": [{"name": "a"}, {"name": "a"}]"#)
                .starts_with("pegs[1] \"a\".name: found \"a\", expected a unique name: it is that of pegs[0]")
        );
    }

    #[test]
    fn results_are_written_beside_what_was_there_and_read_again() {
        let mut doc = document(r#""in_betweens": [1], "note": "kept""#);
        let stroke =
            DrawnStroke { points: vec![Point::new(1.0 / 3.0, 2.0)], material: Some(2), ..DrawnStroke::default() };
        let drawn = [DrawnBetween { frame: 2, strokes: vec![(5, 0.5, stroke.clone())] }];
        doc.set_in_betweens(vec![json!({"frame": 0})], &drawn);
        let text = doc.to_json();
        assert!(text.contains(r#"{"frame":2,"strokes":[{"track":5,"points":[[0.3333,2.0]],"closed":false,"material":2,"opacity":0.5}]}"#), "{text}");
        assert!(text.contains(r#""note": "kept""#) && text.contains(r#"{"frame":0}"#));
        let again = Document::parse(&text, "a.json").unwrap();
        assert_eq!(again.to_json(), text);
    }
}
