//! The file of curves that `rototoon fit` reads and writes.
//!
//! Input: `{"curves": [{"closed": true, "points": [[x, y], …]}]}`, in pixels.
//!
//! Output: the same curves with three fields in place of `points`. `guides` are the guiding points of a uniform
//! quadratic B-spline; a guiding point at a corner appears twice. `corners` contains the index of the first of these
//! two for each corner. `max_error` is the largest distance between line and curve, in pixels. Other fields keep their
//! places.

use super::fields::described;
use rototoon_base::file;
use rototoon_base::geometry::Point;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Why a file of curves cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurvesError {
    /// The file cannot be read.
    #[error("{origin}: cannot read the curves: {reason}")]
    Unreadable {
        /// Path of the file.
        origin: String,
        /// The message of the system.
        reason: String,
    },
    /// The text is not JSON.
    #[error("{origin}: line {line}, column {column}: {reason}")]
    Syntax {
        /// Path of the file.
        origin: String,
        /// Line, from 1.
        line: usize,
        /// Byte within the line, from 1.
        column: usize,
        /// The message of the parser.
        reason: String,
    },
    /// A field is missing or has the wrong type.
    #[error("{origin}: {place}: found {found}, expected {expected}")]
    Field {
        /// Path of the file.
        origin: String,
        /// JSON path of the field.
        place: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
}

/// A line to be fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePoints {
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Its points in pixels.
    pub points: Vec<Point>,
    /// The other fields of its object; `points` keeps an empty place.
    rest: Map<String, Value>,
}

/// The result that replaces the points of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveGuides {
    /// Guiding points in pixels; at a corner twice.
    pub guides: Vec<Point>,
    /// Index of the first guide of each corner.
    pub corners: Vec<usize>,
    /// Largest distance between line and curve in pixels.
    pub max_error: f64,
}

/// A file of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// The lines in the order of the file.
    pub curves: Vec<CurvePoints>,
    /// The other fields of the document; `curves` keeps an empty place.
    rest: Map<String, Value>,
}

impl Curves {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// A [`CurvesError`] names the file, the place, and the found and expected values.
    pub fn load(path: &Path) -> Result<Self, CurvesError> {
        let origin = path.display().to_string();
        let unreadable = |reason: String| CurvesError::Unreadable { origin: origin.clone(), reason };
        let bytes = file::bytes(path).map_err(|error| unreadable(error.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|_| unreadable("it is not text in UTF-8".into()))?;
        Self::from_json(&text, &origin)
    }

    /// Reads text; `origin` names it in messages.
    ///
    /// # Errors
    ///
    /// [`CurvesError::Syntax`] or [`CurvesError::Field`].
    pub fn from_json(text: &str, origin: &str) -> Result<Self, CurvesError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value: Value = serde_json::from_str(text).map_err(|error| {
            let whole = error.to_string();
            let reason = whole.split(" at line ").next().unwrap_or(&whole).to_owned();
            CurvesError::Syntax { origin: origin.to_owned(), line: error.line(), column: error.column(), reason }
        })?;
        let reader = Reader { origin };
        let mut rest = reader.object(value, "the document")?;
        let curves = reader.array(rest.get_mut("curves").map(Value::take), "curves", "a list of curves")?;
        let curves =
            curves.into_iter().enumerate().map(|(k, curve)| reader.curve(curve, k)).collect::<Result<_, _>>()?;
        Ok(Self { curves, rest })
    }

    /// The text of a file with guides in place of the points. `guides` has an entry for each curve; any other number
    /// panics.
    pub fn with_guides(&self, guides: &[CurveGuides]) -> String {
        assert_eq!(guides.len(), self.curves.len(), "one result for each curve");
        let pairs = |points: &[Point]| points.iter().map(|p| json!([p.x, p.y])).collect::<Vec<_>>();
        let curve = |(curve, fit): (&CurvePoints, &CurveGuides)| {
            let mut object = Map::new();
            let fitted = [
                ("guides", Value::Array(pairs(&fit.guides))),
                ("corners", json!(fit.corners)),
                ("max_error", json!(fit.max_error)),
            ];
            for (name, value) in &curve.rest {
                // Results of an earlier fit are replaced.
                if name == "points" {
                    object.extend(fitted.iter().map(|(name, value)| ((*name).to_owned(), value.clone())));
                } else if fitted.iter().all(|(known, _)| known != name) {
                    object.insert(name.clone(), value.clone());
                }
            }
            Value::Object(object)
        };
        let mut document = self.rest.clone();
        document.insert("curves".into(), self.curves.iter().zip(guides).map(curve).collect());
        let mut text = Value::Object(document).to_string();
        text.push('\n');
        text
    }
}

struct Reader<'a> {
    origin: &'a str,
}

impl Reader<'_> {
    fn wrong(&self, place: String, found: Option<&Value>, expected: &'static str) -> CurvesError {
        CurvesError::Field { origin: self.origin.to_owned(), place, found: described(found), expected }
    }

    fn object(&self, value: Value, place: &str) -> Result<Map<String, Value>, CurvesError> {
        match value {
            Value::Object(object) => Ok(object),
            other => Err(self.wrong(place.to_owned(), Some(&other), "an object")),
        }
    }

    fn array(&self, value: Option<Value>, place: &str, expected: &'static str) -> Result<Vec<Value>, CurvesError> {
        match value {
            Some(Value::Array(list)) => Ok(list),
            other => Err(self.wrong(place.to_owned(), other.as_ref(), expected)),
        }
    }

    fn curve(&self, value: Value, k: usize) -> Result<CurvePoints, CurvesError> {
        let place = format!("curves[{k}]");
        let mut rest = self.object(value, &place)?;
        let Some(Value::Bool(closed)) = rest.get("closed").cloned() else {
            return Err(self.wrong(format!("{place}.closed"), rest.get("closed"), "true or false"));
        };
        let list = rest.get_mut("points").map(Value::take);
        let list = self.array(list, &format!("{place}.points"), "a list of points")?;
        let point = |(j, value): (usize, &Value)| {
            let numbers = value.as_array().filter(|pair| pair.len() == 2);
            let pair = numbers.and_then(|pair| Some(Point::new(pair[0].as_f64()?, pair[1].as_f64()?)));
            pair.ok_or_else(|| self.wrong(format!("{place}.points[{j}]"), Some(value), "a point [x, y]"))
        };
        let points = list.iter().enumerate().map(point).collect::<Result<_, _>>()?;
        Ok(CurvePoints { closed, points, rest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_keeps_other_fields() {
        let text =
            r#"{"by":"me","curves":[{"name":"arm","closed":true,"points":[[1,2.5],[3,4]],"z":1,"guides":[]}],"n":[2]}"#;
        let file = Curves::from_json(text, "a.json").unwrap();
        assert_eq!(file.curves[0].points, [Point::new(1.0, 2.5), Point::new(3.0, 4.0)]);
        let guides = CurveGuides { guides: vec![Point::new(0.1, 2.0)], corners: vec![0], max_error: 0.25 };
        let expected = concat!(
            r#"{"by":"me","curves":[{"name":"arm","closed":true,"guides":[[0.1,2.0]],"corners":[0],"#,
            r#""max_error":0.25,"z":1}],"n":[2]}"#,
            "\n"
        );
        assert_eq!(file.with_guides(&[guides]), expected);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let said = |text: &str| Curves::from_json(text, "a.json").unwrap_err().to_string();
        assert_eq!(said("[]"), "a.json: the document: found [], expected an object");
        assert_eq!(said("{}"), "a.json: curves: found nothing, expected a list of curves");
        assert_eq!(said(r#"{"curves":[7]}"#), "a.json: curves[0]: found 7, expected an object");
        assert_eq!(
            said(r#"{"curves":[{"points":[]}]}"#),
            "a.json: curves[0].closed: found nothing, expected true or false"
        );
        let second = r#"{"curves":[{"closed":true,"points":[]},{"closed":true,"points":[[1,2],[3,"x"]]}]}"#;
        assert_eq!(said(second), r#"a.json: curves[1].points[1]: found [3,"x"], expected a point [x, y]"#);
        assert!(said("{\n 7").starts_with("a.json: line 2, column 2: key must be a string"), "{}", said("{\n 7"));
        assert!(said(r#"{"curves":[{"closed":true,"points":[[1e999,0]]}]}"#).contains("number out of range"));
    }
}
