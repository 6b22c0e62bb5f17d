//! Truth documents: the true control points and contours of each part.
//!
//! ```json
//! {"parts": [{"name": "arm", "points": {"1": [[x, y], …]}, "contour": {"1": [[x, y], …]}, "scored": {"1": "1101"}}]}
//! ```
//!
//! The keys are frame numbers. `points` are the control points in the order of the project document. `contour` is a dense
//! polyline. `scored` has one digit per control point, which is 1 if the picture shows the point. Coordinates are in pixels,
//! as in the project document. Other fields are not read.

use anyhow::{Context, Result};
use rototoon::geometry::Point;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The truth of a project document, its parts in the document's order.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub struct Truth {
    /// One entry per part.
    pub parts: Vec<TruePart>,
}

/// The truth of one part.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub struct TruePart {
    /// Name of the part.
    pub name: String,
    /// Control points by frame.
    pub points: BTreeMap<i32, Vec<Point>>,
    /// Dense contour by frame. The contour of a closed part does not repeat its first point.
    pub contour: BTreeMap<i32, Vec<Point>>,
    /// For each frame a text with `1` for each control point that the picture shows, and `0` for the others.
    pub scored: BTreeMap<i32, String>,
}

impl Truth {
    /// Reads a truth document. The error names the file.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {path:?}"))?;
        serde_json::from_str(&text).with_context(|| format!("{path:?} is not a truth document"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbers_and_other_fields_are_ignored() {
        let json = r#"{"source": "x", "parts": [{"name": "a", "depth": 1, "points": {"-1": [[1, 2.5]]},
            "contour": {"-1": [[1, 2], [3, 4]]}, "scored": {"-1": "1"}}]}"#;
        let truth: Truth = serde_json::from_str(json).unwrap();
        assert_eq!(truth.parts[0].points[&-1], [Point::new(1.0, 2.5)]);
        assert_eq!(truth.parts[0].contour[&-1].len(), 2);
        assert_eq!(truth.parts[0].scored[&-1], "1");
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("truth.json");
        assert!(format!("{:#}", Truth::load(&path).unwrap_err()).contains("truth.json"));
        std::fs::write(&path, r#"{"parts": [{}]}"#).unwrap();
        let error = format!("{:#}", Truth::load(&path).unwrap_err());
        assert!(error.contains("truth.json") && error.contains("name"), "{error}");
    }
}
