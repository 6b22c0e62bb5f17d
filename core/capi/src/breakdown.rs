//! The suggestion of a breakdown for drawings in flat arrays. `rototoon_suggest_breakdown` documents the arrays and both
//! JSON texts.

use crate::sheet::Drawings;
use crate::status::Failure;
use crate::work::{GoOn, run};
use rototoon::geometry::polyline::first_unusable;
use rototoon::pictures::Sequence;
use rototoon::pipeline::{PipelineError, Suggestion, suggest_breakdown};
use rototoon::project::Document;
use rototoon::scene::{FrameNumber, Progress};
use rototoon::tween::Stroke;
use rototoon::tween::breakdown::Shown;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// The options, as read from JSON.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Asked {
    keys: BTreeSet<FrameNumber>,
    footage: Option<Value>,
    folder: PathBuf,
    threads: usize,
}

/// The suggestion as JSON, or `null`.
pub fn suggested(drawings: &Drawings, options: &str, go_on: GoOn<'_>) -> Result<String, Failure> {
    let asked: Asked = serde_json::from_str(options).map_err(|error| Failure::Error(format!("options: {error}")))?;
    let shown = shown(drawings, &asked.keys)?;
    let pictures = pictures(&asked)?;
    let found = run(asked.threads, go_on, |progress: &dyn Progress| {
        suggest_breakdown(shown, pictures.as_ref(), progress).map_err(|error| match error {
            PipelineError::Cancelled(cancelled) => cancelled.into(),
            other => Failure::error(other),
        })
    })?;
    Ok(found.map_or(Value::Null, |found: Suggestion| found.to_json()).to_string())
}

fn shown(drawings: &Drawings, keys: &BTreeSet<FrameNumber>) -> Result<Vec<Shown>, Failure> {
    let ranges = drawings.checked()?;
    let frames = drawings.frames;
    if let Some(two) = frames.windows(2).find(|two| two[1] <= two[0]) {
        return Err(Failure::Error(format!("frames: found {} after {}, expected rising frames", two[1], two[0])));
    }
    if let Some(frame) = keys.iter().find(|frame| !frames.contains(frame)) {
        return Err(Failure::Error(format!("options: keys: found {frame}, expected frames of drawings")));
    }
    let stroke = |i: usize| {
        let points = drawings.strokes.points_of(i);
        match first_unusable(&points) {
            Some(k) => {
                let found = points[k];
                let expected = "numbers between -1e9 and 1e9";
                Err(Failure::Error(format!(
                    "stroke {i}: point {k}: found ({}, {}), expected {expected}",
                    found.x, found.y
                )))
            }
            None => Ok(Stroke::new(points, drawings.strokes.closed[i] != 0)),
        }
    };
    let drawing = |(range, &frame): (_, &FrameNumber)| {
        let strokes = std::ops::Range::<usize>::clone(range).map(stroke).collect::<Result<_, _>>()?;
        Ok(Shown { frame, key: keys.contains(&frame), strokes, apart: None })
    };
    ranges.iter().zip(frames).map(drawing).collect()
}

fn pictures(asked: &Asked) -> Result<Option<Sequence>, Failure> {
    let Some(footage) = &asked.footage else { return Ok(None) };
    let text = json!({"rototoon": 1, "footage": footage, "parts": []}).to_string();
    let document = Document::parse(&text, "options").map_err(Failure::error)?;
    Ok(Some(Sequence::new(&document.scene.footage, &asked.folder).map_err(Failure::error)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strokes::Strokes;

    const OFFSETS: [i32; 4] = [0, 2, 4, 6];
    const POINTS: [f64; 12] = [0.0, 0.0, 0.0, 9.0, 4.0, 0.0, 4.0, 9.0, 8.0, 0.0, 8.0, 9.0];

    fn asked(points: &[f64], frames: &[i32], options: Value) -> Result<Value, String> {
        let strokes = Strokes { offsets: &OFFSETS, points, closed: &[0; 3] };
        let drawings = Drawings { strokes, colours: &[], labels: &[], drawings: &[0, 1, 2, 3], frames, by_hand: &[] };
        let found = suggested(&drawings, &options.to_string(), None).map_err(|failure| failure.to_string())?;
        Ok(serde_json::from_str(&found).unwrap())
    }

    #[test]
    fn without_pictures_the_middle_is_suggested() {
        let found = asked(&POINTS, &[1, 3, 5], json!({"keys": [1, 5]})).unwrap();
        assert_eq!((&found["frame"], &found["by"], &found["distance"]), (&json!(3), &json!("movement"), &json!(8.0)));
        assert_eq!(asked(&POINTS, &[1, 3, 5], json!({"keys": [1]})), Ok(Value::Null));
        // Footage without files shows nothing.
        let footage = json!({"pattern": "none_%03d.png", "first": 1, "last": 9, "fps": 24, "width": 20, "height": 20});
        assert_eq!(asked(&POINTS, &[1, 3, 5], json!({"keys": [1, 5], "footage": footage})), Ok(found));
    }

    #[test]
    fn wrong_arguments_are_named() {
        let mut bad = POINTS;
        bad[4] = f64::NAN;
        for (points, frames, options, expected) in [
            (&bad, [1, 3, 5], json!({"keys": [1, 5]}), "stroke 1: point 0: found (NaN, 0)"),
            (&POINTS, [1, 3, 3], json!({"keys": [1]}), "frames: found 3 after 3"),
            (&POINTS, [1, 3, 5], json!({"keys": [2]}), "options: keys: found 2"),
            (&POINTS, [1, 3, 5], json!({"key": [2]}), "options: unknown field"),
            (&POINTS, [1, 3, 5], json!({"keys": [1, 5], "footage": {"pattern": 7}}), "options: footage"),
        ] {
            let message = asked(points, &frames, options).unwrap_err();
            assert!(message.starts_with(expected), "{message}");
        }
    }
}
