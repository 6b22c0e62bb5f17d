//! Truth documents: where the control points and contours of each part really are.
//!
//! ```json
//! {"parts": [{"name": "arm", "points": {"1": [[x, y], …]}, "contour": {"1": [[x, y], …]}, "scored": {"1": "1101"}}]}
//! ```
//!
//! Frames are the keys; `points` are the control points in the order of the project document, `contour` a dense
//! polyline, `scored` a digit a control point: 1 where the picture shows it. Pixels, as in the project document. Other
//! fields are not read.

use anyhow::{Context, Result};
use rototoon::geometry::Point;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The truth of a project document, its parts in the document's order.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub struct Truth {
    /// One entry a part.
    pub parts: Vec<TruePart>,
}

/// The truth of one part.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub struct TruePart {
    /// Name of the part.
    pub name: String,
    /// Control points by frame.
    pub points: BTreeMap<i32, Vec<Point>>,
    /// Dense contour by frame; of a closed part the last point is not the first again.
    pub contour: BTreeMap<i32, Vec<Point>>,
    /// By frame `1` for each control point that the picture shows, `0` for the others.
    pub scored: BTreeMap<i32, String>,
}

impl Truth {
    /// Reads a truth document; an error names the file.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {path:?}"))?;
        serde_json::from_str(&text).with_context(|| format!("{path:?} is no truth document"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbers_and_other_fields_are_left_out() {
        let json = r#"{"source": "x", "parts": [{"name": "a", "depth": 1, "points": {"-1": [[1, 2.5]]},
            "contour": {"-1": [[1, 2], [3, 4]]}, "scored": {"-1": "1"}}]}"#;
        let truth: Truth = serde_json::from_str(json).unwrap();
        assert_eq!(truth.parts[0].points[&-1], [Point::new(1.0, 2.5)]);
        assert_eq!(truth.parts[0].contour[&-1].len(), 2);
        assert_eq!(truth.parts[0].scored[&-1], "1");
    }

    #[test]
    fn a_file_that_is_none_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("truth.json");
        assert!(format!("{:#}", Truth::load(&path).unwrap_err()).contains("truth.json"));
        std::fs::write(&path, r#"{"parts": [{}]}"#).unwrap();
        let error = format!("{:#}", Truth::load(&path).unwrap_err());
        assert!(error.contains("truth.json") && error.contains("name"), "{error}");
    }
}
