//! Documents moved to footage that was delivered again: the JSON options. `rototoon_session_conform` documents them.

use crate::status::Failure;
use crate::traced::within;
use rototoon::conform::Given;
use rototoon::geometry::Point;
use rototoon::pipeline::NewFootage;
use rototoon::project::schema::{MAX_COORDINATE, MAX_FPS, MIN_FPS};
use rototoon::scene::FrameNumber;
use serde::Deserialize;
use std::path::Path;

/// The options, as read from JSON.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    pattern: String,
    #[serde(default)]
    frames: Option<[FrameNumber; 2]>,
    #[serde(default)]
    fps: Option<f64>,
    #[serde(default)]
    scale: Option<f64>,
    #[serde(default)]
    shift: Option<[f64; 2]>,
    #[serde(default)]
    frame_offset: Option<FrameNumber>,
    #[serde(default)]
    hold_gaps: Option<bool>,
    /// Number of threads; 0 for one per core.
    #[serde(default)]
    pub threads: usize,
}

impl Asked {
    /// Reads and checks a caller's JSON. The limits are those of the command line.
    pub fn parse(json: &str) -> Result<Self, Failure> {
        let asked: Self = serde_json::from_str(json).map_err(|error| Failure::Error(format!("options: {error}")))?;
        if let Some(fps) = asked.fps {
            within("fps", fps, MIN_FPS..=MAX_FPS)?;
        }
        if let Some(scale) = asked.scale {
            within("scale", scale, 0.01..=100.0)?;
        }
        for value in asked.shift.into_iter().flatten() {
            within("shift", value, -MAX_COORDINATE..=MAX_COORDINATE)?;
        }
        if let Some([first, last]) = asked.frames.filter(|[first, last]| first > last) {
            return Err(Failure::Error(format!(
                "options: frames: found [{first}, {last}], expected the first frame and then the last one"
            )));
        }
        Ok(asked)
    }

    /// The new footage of a document in `folder`.
    pub fn footage(&self, folder: &Path) -> NewFootage {
        NewFootage {
            pattern: self.pattern.clone(),
            folder: folder.to_owned(),
            frames: self.frames.map(|[first, last]| first..=last),
            fps: self.fps,
            given: Given { scale: self.scale, shift: self.shift.map(|[x, y]| Point::new(x, y)) },
            offset: self.frame_offset,
            held: self.hold_gaps,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_checked() {
        let asked =
            Asked::parse(r#"{"pattern": "new/%04d.png", "frames": [3, 5], "shift": [-8, 4.5], "hold_gaps": true}"#);
        let new = asked.unwrap().footage(Path::new("/shot"));
        assert_eq!((new.pattern.as_str(), new.folder.as_path()), ("new/%04d.png", Path::new("/shot")));
        assert_eq!((new.frames, new.fps, new.offset, new.held), (Some(3..=5), None, None, Some(true)));
        assert_eq!((new.given.scale, new.given.shift), (None, Some(Point::new(-8.0, 4.5))));
        let said = |json: &str| Asked::parse(json).unwrap_err().to_string();
        assert!(said("").starts_with("options: "));
        assert!(said("{}").starts_with("options: missing field `pattern`"));
        assert_eq!(
            said(r#"{"pattern": "%d.png", "scale": 0}"#),
            "options: scale: found 0, expected a number from 0.01 to 100"
        );
        assert!(said(r#"{"pattern": "%d.png", "frames": [5, 3]}"#).contains("found [5, 3]"));
        assert!(said(r#"{"pattern": "%d.png", "turn": 1}"#).starts_with("options: unknown field `turn`"));
    }
}
