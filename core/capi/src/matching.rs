//! Contour matching with a request and an answer in JSON. `rototoon_match_contours` documents both.

use crate::status::Failure;
use rototoon::geometry::Point;
use rototoon::scene::correspondence::{DrawnContour, MatchOptions, match_contours};
use serde::{Deserialize, Serialize};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    references: Vec<Contour>,
    drawn: Vec<Contour>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Contour {
    points: Vec<Point>,
    closed: bool,
    #[serde(default)]
    color: Option<[f32; 3]>,
    #[serde(default)]
    labels: Vec<String>,
}

#[derive(Serialize)]
struct Answer {
    matches: Vec<Counterpart>,
}

#[derive(Serialize)]
struct Counterpart {
    reference: usize,
    drawn: usize,
    points: Vec<Point>,
    cost: f64,
}

impl From<Contour> for DrawnContour {
    fn from(contour: Contour) -> Self {
        Self { points: contour.points, closed: contour.closed, colour: contour.color, labels: contour.labels }
    }
}

/// Matches the contours of a request. Returns the answer as JSON.
pub fn answer(request: &str) -> Result<String, Failure> {
    let request: Request =
        serde_json::from_str(request).map_err(|error| Failure::Error(format!("request: {error}")))?;
    let references: Vec<DrawnContour> = request.references.into_iter().map(Into::into).collect();
    let drawn: Vec<DrawnContour> = request.drawn.into_iter().map(Into::into).collect();
    let found = match_contours(&references, &drawn, &MatchOptions::default()).map_err(Failure::error)?;
    let matches = found.into_iter().enumerate().filter_map(|(reference, found)| {
        let found = found?;
        Some(Counterpart { reference, drawn: found.drawn, points: found.points, cost: found.cost })
    });
    serde_json::to_string(&Answer { matches: matches.collect() }).map_err(Failure::error)
}
