//! What became of parts that a caller holds, with a request and an answer in JSON. `rototoon_outcomes` documents both.
//!
//! A host such as Blender keeps the tracks in its own strokes. It asks here, so that it marks the same contours as the
//! command line and the reports.

use crate::status::Failure;
use rototoon::pipeline::Together;
use rototoon::project::schema::MAX_FRAME_NUMBER;
use rototoon::scene::{FrameNumber, Outcome, Part};
use rototoon::track::weakest_frame;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    parts: Vec<Asked>,
    #[serde(default)]
    exchanges: Vec<AskedPair>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AskedPair {
    parts: [String; 2],
    frames: BTreeSet<FrameNumber>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    keys: Vec<FrameNumber>,
    confidence: BTreeMap<FrameNumber, f64>,
    #[serde(default)]
    wants_key: Vec<FrameNumber>,
}

#[derive(Serialize)]
struct Answer {
    weakest: Option<Weakest>,
    parts: Vec<Found>,
    exchanges: Vec<String>,
}

#[derive(Serialize)]
struct Weakest {
    frame: FrameNumber,
    score: f64,
}

#[derive(Serialize)]
struct Found {
    sure: Vec<FrameNumber>,
    doubtful: Vec<FrameNumber>,
    lost: Vec<FrameNumber>,
}

impl From<Asked> for Part {
    fn from(asked: Asked) -> Self {
        Self {
            keys: asked.keys.into_iter().map(|frame| (frame, Vec::new())).collect(),
            // One point stands for all: only their mean counts.
            confidence: asked.confidence.into_iter().map(|(frame, mean)| (frame, vec![mean])).collect(),
            wants_key: asked.wants_key,
            ..Self::default()
        }
    }
}

/// The answer to a request.
pub fn answer(request: &str) -> Result<String, Failure> {
    let request: Request =
        serde_json::from_str(request).map_err(|error| Failure::Error(format!("request: {error}")))?;
    let frames =
        request.parts.iter().flat_map(|part| part.keys.iter().chain(part.confidence.keys()).chain(&part.wants_key));
    let pairs = request.exchanges.iter().flat_map(|pair| &pair.frames);
    if let Some(frame) = frames.chain(pairs).find(|frame| i64::from(**frame).abs() > MAX_FRAME_NUMBER) {
        return Err(Failure::Error(format!(
            "request: found frame {frame}, expected frames within ±{MAX_FRAME_NUMBER}"
        )));
    }
    let parts: Vec<Part> = request.parts.into_iter().map(Part::from).collect();
    let found = |part: &Part| {
        let Outcome { sure, doubtful, lost } = Outcome::of(part);
        Found { sure, doubtful, lost }
    };
    let weakest = weakest_frame(&parts).map(|w| Weakest { frame: w.frame, score: w.score });
    let exchanges = request.exchanges.into_iter().map(told).collect();
    let answer = Answer { weakest, parts: parts.iter().map(found).collect(), exchanges };
    serde_json::to_string(&answer).map_err(|error| Failure::Error(error.to_string()))
}

/// What the command line says of two parts that may have changed places.
fn told(pair: AskedPair) -> String {
    Together { parts: pair.parts, frames: pair.frames.into_iter().collect() }.exchanged()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn asked(request: Value) -> Value {
        serde_json::from_str(&answer(&request.to_string()).unwrap()).unwrap()
    }

    #[test]
    fn the_answer_is_that_of_the_core() {
        let confidence = json!({"0": 1.0, "1": 1.0, "2": 0.99, "3": 0.01, "4": 0.99, "5": 0.99, "6": 1.0});
        let found = asked(json!({"parts": [{"keys": [0, 6], "confidence": confidence, "wants_key": [9]}]}));
        assert_eq!(found["weakest"]["frame"], 9);
        assert_eq!(found["parts"], json!([{"sure": [1, 2, 4, 5], "doubtful": [], "lost": [3, 9]}]));
        assert_eq!(asked(json!({"parts": []})), json!({"weakest": null, "parts": [], "exchanges": []}));
    }

    #[test]
    fn parts_that_may_have_changed_places_are_told_as_on_the_command_line() {
        let found =
            asked(json!({"parts": [], "exchanges": [{"parts": ["near leg", "far leg"], "frames": [7, 3, 2, 4]}]}));
        let told = "parts \"near leg\" and \"far leg\" look alike and may have changed places on 2-4, 7: a key or a pin there says which is which";
        assert_eq!(found["exchanges"], json!([told]));
    }

    #[test]
    fn a_wrong_request_is_refused() {
        for request in ["", "[]", r#"{"parts": [{"keys": [0]}]}"#, r#"{"parts": [], "more": 1}"#] {
            assert!(answer(request).is_err_and(|failure| format!("{failure:?}").contains("request: ")), "{request}");
        }
    }
}
