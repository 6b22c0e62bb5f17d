//! Clicks of a painter, and the painted regions of every frame.
//!
//! ```json
//! "palette": {"coat": [r, g, b], "…": "…"},
//! "fills": [{"frame": 0, "regions": [{"at": [x, y], "name": "coat", "colour": [r, g, b]}, "…"]}, "…"],
//! "filled": [{"frame": 0, "regions": [{"outline": [[x, y], "…"], "holes": [[[x, y], "…"], "…"], "name": "coat", "colour": [r, g, b],
//!   "track": 3, "confidence": 0.9}, "…"]}, "…"]
//! ```
//!
//! - Frames ascend. Colours are sRGB-encoded, 0 to 1. Paper is a colour too. Places are pixels.
//! - `name` is optional. The name of a colour is what it is, and `colour` how it looks: two names stay two colours even where they look the same, and one
//!   name has one look in a document. `palette` says how named colours look. What it says counts for clicks and for regions that are painted
//!   already, so a night palette is one edit. A click with a name of the palette needs no `colour`. Without `palette` the first click of a name counts.
//!   A colour without a name is what it looks like.
//! - `track` is the number of a region, the same on all frames; on one frame each number occurs once.
//! - Later regions of a frame lie over earlier ones. What is within a hole is not painted by its region.
//! - `confidence` is the probability, 0 to 1, that the colour is right; 1 where an artist clicked.
//!
//! Colours that become others from a drawing on are in [`recolours`](super::recolours).

use super::Document;
use super::drawings::lines;
use super::fields::{FieldError, array, by_frame, colour, count, described, given, object, point, share, wrong};
use super::save::DECIMALS;
use rototoon_base::geometry::Point;
use rototoon_base::scene::palette::hex;
use rototoon_base::scene::{Colour, FrameNumber};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A colour of paint: by its name if it has one, otherwise by its look.
#[derive(Clone, Debug, PartialEq)]
pub struct Hue {
    /// Its name.
    pub name: Option<String>,
    /// Its look, sRGB-encoded, 0 to 1.
    pub colour: Colour,
}

impl Hue {
    /// Whether both are one colour, whatever the look of names. Looks are the same if they are written the same.
    pub fn is_same(&self, other: &Self) -> bool {
        let alike = || written_colour(self.colour) == written_colour(other.colour);
        self.name == other.name && (self.name.is_some() || alike())
    }
}

/// Its name as it is quoted, or its look as `#rrggbb`.
impl fmt::Display for Hue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "{name:?}"),
            None => f.write_str(&hex(self.colour)),
        }
    }
}

/// A click with the paint bucket.
#[derive(Clone, Debug, PartialEq)]
pub struct FillClick {
    /// The place in pixels.
    pub at: Point,
    /// The colour, sRGB-encoded, 0 to 1. `None` says that the region stays without paint.
    pub colour: Option<Colour>,
    /// The name of the colour.
    pub name: Option<String>,
}

impl FillClick {
    /// Its colour; `None` for no paint.
    pub fn hue(&self) -> Option<Hue> {
        self.colour.map(|colour| Hue { name: self.name.clone(), colour })
    }
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
            let mut out = json!({"at": at, "colour": click.colour.map(written_colour)});
            if let Some(name) = &click.name {
                out["name"] = json!(name);
            }
            out
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
    /// The name of its colour.
    pub name: Option<String>,
    /// Its number on all frames.
    pub track: usize,
    /// The probability that the colour is right, 0 to 1.
    pub confidence: f64,
}

impl FilledRegion {
    /// Its colour.
    pub fn hue(&self) -> Hue {
        Hue { name: self.name.clone(), colour: self.colour }
    }
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
    /// How named colours look; empty if nothing is said.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn palette(&self) -> Result<BTreeMap<String, Colour>, FieldError> {
        let Some(json) = self.other_field("palette") else { return Ok(BTreeMap::new()) };
        let value = serde_json::from_str(json).map_err(|error| wrong("palette", &error.to_string(), "JSON"))?;
        let read = |(name, value): (&String, &Value)| {
            Ok((name.clone(), colour(Some(value), &format!("palette.{name}"), share)?))
        };
        object(&value, "palette")?.iter().map(read).collect()
    }

    /// The clicks of the painter; empty if there are none. Clicks of one name have one look.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn fills(&self) -> Result<Vec<FillClicks>, FieldError> {
        let palette = self.palette()?;
        let read = |on: FrameNumber, list: &[Value], place: &str| {
            let click = |(i, value): (usize, &Value)| click(value, &palette, &format!("{place}[{i}]"));
            Ok(FillClicks { frame: on, clicks: list.iter().enumerate().map(click).collect::<Result<_, _>>()? })
        };
        let mut fills = by_frame(&self.other_list("fills")?, ["fills", "regions"], read)?;
        let mut looks = BTreeMap::new();
        for click in fills.iter_mut().flat_map(|own| &mut own.clicks) {
            if let (Some(name), Some(colour)) = (&click.name, &mut click.colour) {
                *colour = *looks.entry(name.clone()).or_insert(*colour);
            }
        }
        Ok(fills)
    }

    /// Reads clicks in the form of the field `fills`.
    ///
    /// # Errors
    ///
    /// Text that is no JSON, and the first invalid field.
    pub fn read_fills(&self, json: &str) -> Result<Vec<FillClicks>, FieldError> {
        let mut other = self.clone();
        other.set_other_field("fills", json.to_owned());
        other.fills()
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
        let palette = self.palette()?;
        by_frame(&self.other_list("filled")?, ["filled", "regions"], |on, list, place| {
            let mut tracks = BTreeSet::new();
            let read = |(i, value): (usize, &Value)| {
                let place = format!("{place}[{i}]");
                let mut region = region(value, &place)?;
                if let Some(look) = region.name.as_ref().and_then(|name| palette.get(name)) {
                    region.colour = *look;
                }
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

    /// Puts painted regions into the document, in place of earlier ones. Drawings that are as before keep their text.
    pub fn set_filled(&mut self, drawings: &[FilledDrawing]) {
        let earlier = self.filled().unwrap_or_default();
        let written = self.keeping(
            "filled",
            [&earlier, drawings],
            |drawing| drawing.frame,
            |drawing| {
                let regions: Vec<Value> = drawing.regions.iter().map(written).collect();
                json!({"frame": drawing.frame, "regions": regions})
            },
        );
        self.set_other_field("filled", written);
    }
}

fn click(value: &Value, palette: &BTreeMap<String, Colour>, place: &str) -> Result<FillClick, FieldError> {
    let fields = object(value, place)?;
    let at = point(fields.get("at"), &format!("{place}.at"))?;
    let name = given(fields, place, "name", colour_name)?;
    let look = name.as_ref().and_then(|name| palette.get(name).copied());
    let colour = match (fields.get("colour"), &name) {
        (Some(Value::Null), Some(name)) => {
            return Err(wrong(
                &format!("{place}.name"),
                &format!("{name:?}"),
                "none beside no paint, \"colour\": null",
            ));
        }
        (Some(Value::Null), None) => None,
        (None, Some(name)) if look.is_none() => {
            let found = format!("{name:?}");
            return Err(wrong(&format!("{place}.name"), &found, "a name of the field palette, or a colour beside it"));
        }
        (None, Some(_)) => look,
        (given, _) => {
            let own = colour(given, &format!("{place}.colour"), share)?;
            Some(look.unwrap_or(own))
        }
    };
    Ok(FillClick { at, colour, name })
}

/// Reads the name of a colour.
pub(super) fn colour_name(value: Option<&Value>, place: &str) -> Result<String, FieldError> {
    match value.and_then(Value::as_str) {
        Some(name) if !name.is_empty() => Ok(name.to_owned()),
        _ => Err(wrong(place, &described(value), "the name of a colour")),
    }
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
        name: given(fields, place, "name", colour_name)?,
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
    if let Some(name) = &region.name {
        out.insert("name".into(), json!(name));
    }
    out.insert("colour".into(), json!(written_colour(region.colour)));
    out.insert("track".into(), json!(region.track));
    out.insert("confidence".into(), json!(rounded(region.confidence, 3)));
    Value::Object(out)
}

/// Colours are told as they were given: 0.1 and not 0.10000000149.
pub(super) fn written_colour(colour: Colour) -> [f64; 3] {
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
        let click = FillClick { at: Point::new(3.0, 4.5), colour: Some([1.0, 0.5, 0.0]), name: None };
        assert_eq!(doc.fills().unwrap(), [FillClicks { frame: 2, clicks: vec![click] }]);
        assert!(document(r#""author": 1"#).fills().unwrap().is_empty());
    }

    #[test]
    fn clicks_are_written_and_removed() {
        let mut doc = document(r#""author": "a""#);
        let click = FillClick { at: Point::new(3.0, 4.5), colour: Some([0.1, 0.5, 0.0]), name: Some("coat".into()) };
        let bare = FillClick { colour: None, name: None, ..click.clone() };
        let fills =
            [FillClicks { frame: -1, clicks: vec![click.clone(), bare] }, FillClicks { frame: 2, clicks: vec![click] }];
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
        let region = FilledRegion {
            outline: square(1.0),
            holes: vec![square(3.0)],
            colour,
            name: None,
            track: 4,
            confidence: 0.75,
        };
        let named = FilledRegion { name: Some("Mantel".into()), track: 5, ..region.clone() };
        let drawings = [FilledDrawing { frame: 1, regions: vec![region, named] }];
        doc.set_filled(&drawings);
        let text = doc.to_json();
        assert!(text.contains("0.1"), "{text}");
        let again = Document::parse(&text, "a.json").unwrap();
        assert_eq!(again.filled().unwrap(), drawings);
    }

    #[test]
    fn a_named_colour_looks_as_the_palette_says() {
        let fields = r#""fills": [{"frame": 0, "regions": [{"at": [1, 1], "name": "coat"}, {"at": [2, 2], "name": "hair", "colour": [1, 0, 0]},
            {"at": [3, 3], "name": "boot", "colour": [1, 0, 0]}, {"at": [4, 4], "name": "boot", "colour": [0, 1, 0]}]}],
            "filled": [{"frame": 0, "regions": [{"outline": [], "name": "coat", "colour": [0.5, 0.5, 0.5], "track": 0},
            {"outline": [], "colour": [0.5, 0.5, 0.5], "track": 1}]}]"#;
        let doc = document(&format!(r#""palette": {{"coat": [0, 0, 1], "hair": [0, 1, 1]}}, {fields}"#));
        let clicks = doc.fills().unwrap().remove(0).clicks;
        let looks: Vec<Colour> = clicks.iter().filter_map(|click| click.colour).collect();
        assert_eq!(
            looks,
            [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
            "one name has one look"
        );
        let hues: Vec<Hue> = clicks.iter().filter_map(FillClick::hue).collect();
        assert!(hues[2].is_same(&hues[3]) && !hues[1].is_same(&hues[2]));
        let regions = doc.filled().unwrap().remove(0).regions;
        assert_eq!([regions[0].colour, regions[1].colour], [[0.0, 0.0, 1.0], [0.5; 3]]);
        let told = |text: &str| document(text).fills().unwrap_err().to_string();
        assert_eq!(
            told(fields),
            "fills[0] (frame 0).regions[0].name: found \"coat\", expected a name of the field palette, or a colour beside it"
        );
        let one = |click: &str| told(&format!(r#""fills": [{{"frame": 0, "regions": [{{"at": [1, 1], {click}}}]}}]"#));
        assert!(one(r#""name": "", "colour": [1, 1, 1]"#).ends_with("expected the name of a colour"));
        assert!(one(r#""name": "coat", "colour": null"#).contains("expected none beside no paint"));
        assert!(told(r#""palette": {"coat": [0, 0]}, "fills": []"#).starts_with("palette.coat: found a list of 2"));
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
