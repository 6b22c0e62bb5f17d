//! Files of skeleton clips.
//!
//! ```json
//! {"rototoon_clips": 1, "fps": 30, "keypoints": ["pelvis", "…"],
//!  "clips": [{"character": "anna", "motion": "walk", "points": [[[x, y], "17 of them"], "one list a frame"]}]}
//! ```
//!
//! Clips of another body than the human one say so by `skeleton` ([`super::skeleton`]), for the whole file or for a clip;
//! their file has version 2. `keypoints` names the key points of the file's body.
//!
//! x right, y down, in any one unit a character. A translated clip also holds `deviation`: for each frame and key point
//! the standard deviation of its place, in the same unit. A captured clip holds `guessed`: by key point the first and the last
//! frame of each time on which it was filled in. Fields that are not known are left out of what is written anew.

use super::fields::FieldError;
use super::output::{WriteError, write_whole};
use super::plain_clips as plain;
use super::schema::{MAX_FPS, MIN_FPS};
use super::skeleton;
use rototoon_base::file;
use rototoon_base::geometry::Point;
use rototoon_base::scene::clip::Guessed;
use rototoon_base::scene::skeleton::Posture;
use rototoon_base::scene::{Clip, Template};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// Version of the form.
pub const VERSION: u64 = plain::VERSION;

/// What is wrong with a file of clips or of a key pose.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClipsError {
    /// The file cannot be read.
    #[error("{origin}: cannot read: {reason}")]
    Unreadable {
        /// The file.
        origin: String,
        /// What the system said.
        reason: String,
    },
    /// The text is not JSON.
    #[error("{origin}: found text that is not JSON (JSON has no NaN and no Infinity): {reason}")]
    Syntax {
        /// The file.
        origin: String,
        /// What the reader said, with line and column.
        reason: String,
    },
    /// The file was written by a later version.
    #[error(
        "{origin}: rototoon_clips: found version {found}, expected {VERSION} or less; reading it needs a newer Rototoon"
    )]
    Later {
        /// The file.
        origin: String,
        /// Its version.
        found: u64,
    },
    /// A field is missing or holds something else.
    #[error("{origin}: {place}: found {found}, expected {expected}")]
    Field {
        /// The file.
        origin: String,
        /// Where, with the clip's names and the frame.
        place: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
}

/// A file of clips.
#[derive(Clone, Debug, PartialEq)]
pub struct Clips {
    /// The clips in the file's order. No two have the same character and motion.
    pub clips: Vec<Clip>,
    /// Frames a second.
    pub fps: f64,
}

impl Clips {
    /// Reads a file.
    pub fn load(path: &Path) -> Result<Self, ClipsError> {
        Self::parse(&read(path)?, &path.display().to_string())
    }

    /// Reads text; `origin` names it in errors.
    ///
    /// What is as it must be is read straight into numbers. Only where it is not, it is read once more, value by value, to say
    /// what is wrong and where.
    pub fn parse(text: &str, origin: &str) -> Result<Self, ClipsError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        match plain::read(text) {
            Some((clips, fps)) => Ok(Self { clips, fps }),
            None => Self::parse_by_value(text, origin),
        }
    }

    /// The same by way of a tree of values: slow, and every error has its place.
    fn parse_by_value(text: &str, origin: &str) -> Result<Self, ClipsError> {
        let reader = Reader { origin };
        let document = reader.json(text)?;
        reader.version(&document)?;
        let fps = match document.get("fps") {
            None => 25.0,
            Some(value) => value.as_f64().filter(|fps| (MIN_FPS..=MAX_FPS).contains(fps)).ok_or_else(|| {
                reader.wrong("fps", value, &format!("a number of frames a second from {MIN_FPS} to {MAX_FPS}"))
            })?,
        };
        let template = reader.skeleton(&document, "")?.unwrap_or_default();
        reader.key_points(&template, &document)?;
        let list = document.get("clips").unwrap_or(&Value::Null);
        let list = list.as_array().ok_or_else(|| reader.wrong("clips", list, "a list of clips"))?;
        let mut clips: Vec<Clip> = Vec::with_capacity(list.len());
        for (k, value) in list.iter().enumerate() {
            let clip = reader.clip(&template, k, value)?;
            let twin = clips.iter().position(|c| c.character == clip.character && c.motion == clip.motion);
            if let Some(twin) = twin {
                let place = place_of(k, &clip.character, &clip.motion);
                let found = format!("the character and motion of clips[{twin}] again");
                return Err(reader.field(place, found, "each motion of a character once"));
            }
            clips.push(clip);
        }
        Ok(Self { clips, fps })
    }

    /// The file's text.
    pub fn text(&self) -> String {
        plain::written(&self.clips, self.fps) + "\n"
    }

    /// Writes a file, whole or not at all.
    pub fn save(&self, path: &Path) -> Result<(), WriteError> {
        write_whole(path, self.text().as_bytes())
    }
}

/// A posture that the animator drew for one frame of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPose {
    /// The frame, from 0.
    pub frame: usize,
    /// The key points; any common shift of all is left out of account.
    pub posture: Posture,
}

/// Reads drawn key poses: one posture (`[[x, y], …]`, for the first frame), or `{"frame", "points"}`, or a list of those.
pub fn load_key_poses(path: &Path) -> Result<Vec<DrawnPose>, ClipsError> {
    parse_key_poses(&read(path)?, &path.display().to_string())
}

/// Reads drawn key poses from text; `origin` names it in errors.
pub fn parse_key_poses(text: &str, origin: &str) -> Result<Vec<DrawnPose>, ClipsError> {
    let reader = Reader { origin };
    let document = reader.json(text)?;
    let pose = |value: &Value, place: &str| -> Result<DrawnPose, ClipsError> {
        let frame = value.get("frame").unwrap_or(&Value::Null);
        let frame = frame
            .as_u64()
            .and_then(|frame| usize::try_from(frame).ok())
            .ok_or_else(|| reader.wrong(format!("{place}.frame"), frame, "a frame number from 0"))?;
        let points = value.get("points").unwrap_or(&Value::Null);
        Ok(DrawnPose { frame, posture: reader.human(points, &format!("{place}.points"))? })
    };
    match &document {
        Value::Object(_) => Ok(vec![pose(&document, "key pose")?]),
        Value::Array(list) if list.first().is_some_and(Value::is_object) => {
            list.iter().enumerate().map(|(k, value)| pose(value, &format!("key pose [{k}]"))).collect()
        }
        other => Ok(vec![DrawnPose { frame: 0, posture: reader.human(other, "key pose")? }]),
    }
}

fn read(path: &Path) -> Result<String, ClipsError> {
    file::text(path).map_err(|e| ClipsError::Unreadable { origin: path.display().to_string(), reason: e.to_string() })
}

fn place_of(index: usize, character: &str, motion: &str) -> String {
    format!("clips[{index}] ({character:?}, {motion:?})")
}

struct Reader<'a> {
    origin: &'a str,
}

impl Reader<'_> {
    fn json(&self, text: &str) -> Result<Value, ClipsError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        serde_json::from_str(text).map_err(|e| ClipsError::Syntax { origin: self.origin.into(), reason: e.to_string() })
    }

    fn field(&self, place: impl Into<String>, found: impl Into<String>, expected: impl Into<String>) -> ClipsError {
        ClipsError::Field {
            origin: self.origin.into(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    fn wrong(&self, place: impl Into<String>, found: &Value, expected: &str) -> ClipsError {
        self.field(place, kind(found), expected)
    }

    fn version(&self, document: &Value) -> Result<(), ClipsError> {
        let version = document.get("rototoon_clips").unwrap_or(&Value::Null);
        match version.as_u64() {
            Some(1..=VERSION) => Ok(()),
            Some(found) if found > VERSION => Err(ClipsError::Later { origin: self.origin.into(), found }),
            _ => Err(self.wrong("rototoon_clips", version, &format!("a format version from 1 to {VERSION}"))),
        }
    }

    /// The body in an object's field `skeleton`; none without that field. `place` is the object's.
    fn skeleton(&self, object: &Value, place: &str) -> Result<Option<Arc<Template>>, ClipsError> {
        let Some(value) = object.get(skeleton::FIELD) else { return Ok(None) };
        let wrong = |e: FieldError| self.field(format!("{place}{}", e.place), e.found, e.expected);
        skeleton::read(Some(value)).map(Some).map_err(wrong)
    }

    fn key_points(&self, template: &Template, document: &Value) -> Result<(), ClipsError> {
        let Some(value) = document.get("keypoints") else { return Ok(()) };
        let names = value.as_array().ok_or_else(|| self.wrong("keypoints", value, "a list of names"))?;
        let expected = template.names();
        if names.len() != expected.len() {
            return Err(self.field("keypoints", format!("{} names", names.len()), expected.len().to_string()));
        }
        match names.iter().zip(&expected).position(|(name, expected)| name.as_str() != Some(expected)) {
            None => Ok(()),
            Some(k) => Err(self.field(format!("keypoints[{k}]"), names[k].to_string(), format!("{:?}", expected[k]))),
        }
    }

    fn clip(&self, template: &Arc<Template>, index: usize, value: &Value) -> Result<Clip, ClipsError> {
        let name = |field: &str| match value.get(field).and_then(Value::as_str) {
            Some(name) if !name.is_empty() => Ok(name.to_owned()),
            _ => {
                let found = value.get(field).unwrap_or(&Value::Null);
                Err(self.wrong(format!("clips[{index}].{field}"), found, "a name"))
            }
        };
        let (character, motion) = (name("character")?, name("motion")?);
        let place = place_of(index, &character, &motion);
        let own = self.skeleton(value, &format!("{place}."))?;
        let template = own.unwrap_or_else(|| template.clone());
        let points = value.get("points").unwrap_or(&Value::Null);
        let frames = match points.as_array() {
            Some(frames) if !frames.is_empty() => frames,
            Some(_) => return Err(self.field(format!("{place}.points"), "no frames", "at least one")),
            None => return Err(self.wrong(format!("{place}.points"), points, "a list of frames")),
        };
        let postures = frames
            .iter()
            .enumerate()
            .map(|(frame, posture)| self.posture(&template, posture, &format!("{place}, frame {frame}")))
            .collect::<Result<_, _>>()?;
        let guessed = self.guessed(&template, value, (&place, frames.len()))?;
        let deviation = self.deviation(&template, value, (&place, frames.len()))?;
        Ok(Clip { guessed, deviation, ..Clip::of(template, character, motion, postures) })
    }

    /// The standard deviations of a clip that was made; none of one that was captured.
    fn deviation(
        &self,
        template: &Template,
        clip: &Value,
        (place, frames): (&str, usize),
    ) -> Result<Vec<Vec<f64>>, ClipsError> {
        let Some(value) = clip.get("deviation") else { return Ok(Vec::new()) };
        let read: Option<Vec<Vec<f64>>> = serde_json::from_value(value.clone()).ok();
        let read = read.filter(|all| all.is_empty() || deviates(all, frames, template.len()));
        let expected = format!("{} numbers from 0 for each of {frames} frames", template.len());
        read.ok_or_else(|| self.wrong(format!("{place}.deviation"), value, &expected))
    }

    /// The times on which key points of a clip were filled in.
    fn guessed(
        &self,
        template: &Template,
        clip: &Value,
        (place, frames): (&str, usize),
    ) -> Result<Guessed, ClipsError> {
        let place = format!("{place}.guessed");
        let fields = match clip.get("guessed") {
            None => return Ok(Guessed::new()),
            Some(Value::Object(fields)) => fields,
            Some(other) => return Err(self.wrong(place, other, "an object with times by key point")),
        };
        let names = template.names();
        let read = |(name, value): (&String, &Value)| {
            let point = names.iter().position(|known| known == name);
            let point =
                point.ok_or_else(|| self.field(&place, format!("{name:?}"), format!("one of {}", names.join(", "))))?;
            let times: Option<Vec<[usize; 2]>> = serde_json::from_value(value.clone()).ok();
            let times = times.filter(|times| rises(times, frames));
            let expected = format!("times [first, last] that rise, of frames 0 to {}", frames - 1);
            Ok((point, times.ok_or_else(|| self.field(format!("{place}.{name}"), value.to_string(), expected))?))
        };
        fields.iter().map(read).collect()
    }

    /// A human posture.
    fn human(&self, value: &Value, place: &str) -> Result<Posture, ClipsError> {
        let points = self.posture(&Template::human(), value, place)?;
        Posture::try_from(points).map_err(|found| self.field(place, format!("{} key points", found.len()), "17"))
    }

    fn posture(&self, template: &Template, value: &Value, place: &str) -> Result<Vec<Point>, ClipsError> {
        let points = value.as_array().ok_or_else(|| self.wrong(place, value, "a list of key points"))?;
        if points.len() != template.len() {
            return Err(self.field(place, format!("{} key points", points.len()), template.len().to_string()));
        }
        let mut posture = Vec::with_capacity(points.len());
        for (k, point) in points.iter().enumerate() {
            let pair = point.as_array().map(Vec::as_slice);
            let name = template.point_name(k);
            posture.push(match pair {
                Some([x, y]) => match (x.as_f64(), y.as_f64()) {
                    (Some(x), Some(y)) => Point::new(x, y),
                    _ => return Err(self.field(format!("{place}, {name}"), point.to_string(), "two numbers")),
                },
                _ => return Err(self.wrong(format!("{place}, {name}"), point, "two numbers")),
            });
        }
        Ok(posture)
    }
}

/// Whether deviations are those of a clip: for each frame and key point a number from 0.
pub(super) fn deviates(deviation: &[Vec<f64>], frames: usize, points: usize) -> bool {
    let row = |row: &Vec<f64>| row.len() == points && row.iter().all(|s| *s >= 0.0 && s.is_finite());
    deviation.len() == frames && deviation.iter().all(row)
}

/// Whether times are those of a clip with a number of frames: each has its ends in order, and they rise.
pub(super) fn rises(times: &[[usize; 2]], frames: usize) -> bool {
    let ends: Vec<usize> = times.iter().flatten().copied().collect();
    let ordered =
        times.iter().all(|[first, last]| first <= last) && times.windows(2).all(|pair| pair[0][1] < pair[1][0]);
    ordered && ends.last().is_none_or(|last| *last < frames)
}

fn kind(value: &Value) -> String {
    match value {
        Value::Null => "nothing".into(),
        Value::Array(list) => format!("a list of {}", list.len()),
        Value::Object(_) => "an object".into(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests;
