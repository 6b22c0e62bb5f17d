//! What strokes of drawings, of in-betweens and of tracing have in common: a line, or the outline of a solid shape.
//!
//! - `points` are pixels; the last one of a `closed` line joins the first.
//! - `widths` has one width in pixels for each point, and may be missing.
//! - `fill` says that what is inside a closed line is filled with its colour. A fill without `widths` has no line around it.
//! - `colour` is sRGB-encoded, and may be missing.
//! - `fill_colour` is the colour of the fill of a stroke that has a line too; `colour` is the line's then. An open stroke is
//!   filled as if its ends were joined. It contradicts `fill`, whose colour is `colour`.

use super::fields::{FieldError, array, colour, flag, given, number, point, wrong};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Colour;
use serde_json::{Map, Value, json};

/// The largest width of a line in pixels: that of the widest picture.
const WIDEST: f64 = 65_535.0;

/// A line or the outline of a solid shape.
pub(super) struct Line {
    pub points: Vec<Point>,
    pub closed: bool,
    pub fill: bool,
    /// One for each point, or none.
    pub widths: Vec<f64>,
    pub colour: Option<Colour>,
    pub fill_colour: Option<Colour>,
}

/// Reads the fields of a line. `channel` reads a channel of its colour.
pub(super) fn read(
    fields: &Map<String, Value>,
    place: &str,
    channel: impl Fn(Option<&Value>, &str) -> Result<f64, FieldError> + Copy,
) -> Result<Line, FieldError> {
    let at = format!("{place}.points");
    let list = array(fields.get("points"), &at)?.iter().enumerate();
    let points: Vec<Point> = list.map(|(i, v)| point(Some(v), &format!("{at}[{i}]"))).collect::<Result<_, _>>()?;
    let widths = given(fields, place, "widths", |value, place| widths(value, place, points.len()))?.unwrap_or_default();
    let closed = flag(fields.get("closed"), &format!("{place}.closed"))?;
    let fill = given(fields, place, "fill", flag)?.unwrap_or(false);
    if fill && !closed {
        return Err(wrong(&format!("{place}.fill"), "true on an open stroke", "a closed stroke"));
    }
    let shade = |name| given(fields, place, name, |value, place| colour(value, place, channel));
    let (colour, fill_colour) = (shade("colour")?, shade("fill_colour")?);
    if fill && fill_colour.is_some() {
        let expected = "none beside fill: the colour of a filled shape without a line is its colour";
        return Err(wrong(&format!("{place}.fill_colour"), "a colour", expected));
    }
    Ok(Line { points, closed, fill, widths, colour, fill_colour })
}

fn widths(value: Option<&Value>, place: &str, count: usize) -> Result<Vec<f64>, FieldError> {
    let list = array(value, place)?;
    if list.len() != count {
        return Err(wrong(place, &format!("a list of {}", list.len()), &format!("a list of {count}")));
    }
    let width = |(i, value): (usize, &Value)| {
        let place = format!("{place}[{i}]");
        let found = number(Some(value), &place)?;
        let fits = (0.0..=WIDEST).contains(&found);
        if fits { Ok(found) } else { Err(wrong(&place, &found.to_string(), &format!("a width from 0 to {WIDEST}"))) }
    };
    list.iter().enumerate().map(width).collect()
}

/// Adds a line's fields, each number as `written` gives it.
pub(super) fn write(line: &Line, fields: &mut Map<String, Value>, written: impl Fn(f64) -> f64) {
    let points: Vec<Value> = line.points.iter().map(|p| json!([written(p.x), written(p.y)])).collect();
    fields.insert("points".into(), Value::Array(points));
    fields.insert("closed".into(), json!(line.closed));
    if line.fill {
        fields.insert("fill".into(), json!(true));
    }
    if !line.widths.is_empty() {
        fields.insert("widths".into(), json!(line.widths.iter().map(|&w| written(w)).collect::<Vec<_>>()));
    }
    for (name, colour) in [("colour", line.colour), ("fill_colour", line.fill_colour)] {
        if let Some(colour) = colour {
            fields.insert(name.into(), json!(colour.map(|c| (f64::from(c) * 1e4).round() / 1e4)));
        }
    }
}
