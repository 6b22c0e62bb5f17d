//! The keys that reshaping made.
//!
//! ```json
//! "reshaped": {"near hand": {"1": [[12.5, 40], [31, 44.5]], "24": [[22.5, 40], [41, 44.5]]}}
//! ```
//!
//! Reshaping gives each part a key on the first and on the last frame of the clip. They look like the artist's keys. This field tells
//! the two apart when the drawing is reshaped again: a key that is not here, or has another contour here, is the artist's, and stays.
//! The contours are kept and not only their frames, because any program may change a key and track again.
//!
//! A part that is not here was not reshaped, or got another name since.

use super::Document;
use super::fields::{FieldError, array, object, point, wrong};
use super::save::DECIMALS;
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The field.
const RESHAPED: &str = "reshaped";

/// By part and frame the contours of keys that were made.
pub type MadeKeys = BTreeMap<String, BTreeMap<FrameNumber, Vec<Point>>>;

impl Document {
    /// The keys that reshaping made.
    ///
    /// # Errors
    ///
    /// The first invalid value.
    pub fn reshaped(&self) -> Result<MadeKeys, FieldError> {
        let Some(json) = self.other_field(RESHAPED) else { return Ok(MadeKeys::new()) };
        let value = serde_json::from_str(json).unwrap_or(Value::Null);
        let contour = |value: &Value, place: &str| {
            let list = array(Some(value), place)?.iter().enumerate();
            list.map(|(k, value)| point(Some(value), &format!("{place}[{k}]"))).collect::<Result<Vec<_>, _>>()
        };
        let read = |(part, value): (&String, &Value)| {
            let place = format!("{RESHAPED}.{part:?}");
            let key = |(frame, value): (&String, &Value)| {
                let place = format!("{place}.\"{frame}\"");
                let number = frame.parse().map_err(|_| wrong(&place, &format!("{frame:?}"), "a frame number"))?;
                Ok((number, contour(value, &place)?))
            };
            let keys = object(value, &place)?.iter().map(key).collect::<Result<_, FieldError>>()?;
            Ok((part.clone(), keys))
        };
        object(&value, RESHAPED)?.iter().map(read).collect()
    }

    /// Says which keys reshaping made.
    pub fn set_reshaped(&mut self, keys: &MadeKeys) {
        let contour =
            |points: &Vec<Point>| points.iter().map(|p| json!([rounded(p.x), rounded(p.y)])).collect::<Vec<Value>>();
        let frames = |frames: &BTreeMap<FrameNumber, Vec<Point>>| {
            let fields = frames.iter().map(|(frame, points)| (frame.to_string(), json!(contour(points))));
            Value::Object(fields.collect())
        };
        let fields: Map<String, Value> = keys.iter().map(|(part, keys)| (part.clone(), frames(keys))).collect();
        self.set_other_field(RESHAPED, Value::Object(fields).to_string());
    }

    /// Forgets which keys reshaping made.
    pub fn forget_reshaped(&mut self) {
        self.remove_other_field(RESHAPED);
    }
}

/// Rounded as tracks are.
fn rounded(value: f64) -> f64 {
    let factor = 10f64.powi(DECIMALS);
    (value * factor).round() / factor
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(more: &str) -> Document {
        let footage =
            r#""footage": {"pattern": "f_%d.png", "first": 0, "last": 9, "fps": 24, "width": 64, "height": 48}"#;
        Document::parse(&format!(r#"{{"rototoon": 1, {footage}, "parts": []{more}}}"#), "a.json").unwrap()
    }

    #[test]
    fn what_is_written_is_read_again() {
        let mut made = document("");
        assert!(made.reshaped().unwrap().is_empty());
        let keys = BTreeMap::from([(
            "near \"hand\"".to_owned(),
            BTreeMap::from([(-3, vec![Point::new(0.1, -2.5)]), (24, vec![Point::ONE])]),
        )]);
        made.set_reshaped(&keys);
        assert_eq!(Document::parse(&made.to_json(), "b.json").unwrap().reshaped().unwrap(), keys);
        made.forget_reshaped();
        assert!(!made.to_json().contains(RESHAPED));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let said = |field: &str| document(&format!(r#", "reshaped": {field}"#)).reshaped().unwrap_err().to_string();
        assert_eq!(said("7"), "reshaped: found 7, expected an object");
        assert_eq!(
            said(r#"{"arm": {"1": [[1, 2], "x"]}}"#),
            "reshaped.\"arm\".\"1\"[1]: found \"x\", expected a point [x, y] of numbers between -1e6 and 1e6"
        );
    }
}
