//! Writes project documents.
//!
//! Each frame takes one line. Numbers have the shortest text that reads back exactly. The artist's data (keys, pins,
//! centres) are written unchanged. Computed data are rounded to [`DECIMALS`] decimals (0.0001 pixels). A computed point
//! that equals a key or a pin is not rounded, so tracks contain the keys exactly in the file too.

use super::output::{WriteError, write_whole};
use super::path::slashed;
use super::problem::Problems;
use super::schema::{FOOTAGE, Field, GAPS, HELD, PART, TOP, completed};
use super::{Document, validate};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Part};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// Decimals of computed coordinates and confidences.
pub const DECIMALS: i32 = 4;

/// Why a document was not saved. The file is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The scene is not valid, so the document could not be read again.
    #[error("{path}: not saved, since the document is not valid: {problems}")]
    Invalid {
        /// Path of the file.
        path: String,
        /// All problems.
        problems: Problems,
    },
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Document {
    /// Writes the document completely or not at all.
    ///
    /// # Errors
    ///
    /// A [`SaveError`].
    pub fn save(&self, path: &Path) -> Result<(), SaveError> {
        Ok(write_whole(path, self.to_save(path)?.as_bytes())?)
    }

    /// The text of the document as [`save`](Self::save) writes it to `path`.
    ///
    /// # Errors
    ///
    /// [`SaveError::Invalid`].
    pub fn to_save(&self, path: &Path) -> Result<String, SaveError> {
        let problems = validate::problems(&self.scene);
        if problems.error_count() > 0 {
            return Err(SaveError::Invalid { path: path.display().to_string(), problems });
        }
        Ok(self.to_json())
    }

    /// The text of the document. If the scene is not valid ([`Document::problems`]), the text may be unreadable.
    pub fn to_json(&self) -> String {
        let mut out = String::from("{");
        let fields = completed(&self.layout.top, &TOP);
        for (i, field) in fields.iter().enumerate() {
            begin(&mut out, i, "\n  ", field.name());
            match field.as_ref() {
                Field::Unknown { json, .. } => out += json,
                Field::Known("rototoon") => out += &self.layout.version,
                Field::Known("footage") => self.footage(&mut out),
                Field::Known(_) => self.parts(&mut out),
            }
        }
        out + "\n}\n"
    }

    fn footage(&self, out: &mut String) {
        let Footage { pattern, first, last, fps, width, height, held } = &self.scene.footage;
        let known = [&FOOTAGE[..], &[GAPS]].concat();
        let mut fields = completed(&self.layout.footage, &known);
        fields.retain(|field| *held || !matches!(field.as_ref(), Field::Known(GAPS)));
        *out += "{";
        for (i, field) in fields.iter().enumerate() {
            begin(out, i, if i > 0 { " " } else { "" }, field.name());
            match field.as_ref() {
                Field::Unknown { json, .. } => *out += json,
                Field::Known("pattern") => text(out, &slashed(Path::new(pattern))),
                Field::Known("first") => number(out, f64::from(*first)),
                Field::Known("last") => number(out, f64::from(*last)),
                Field::Known("fps") => number(out, *fps),
                Field::Known("width") => number(out, *width as f64),
                Field::Known(GAPS) => text(out, HELD),
                Field::Known(_) => number(out, *height as f64),
            }
        }
        *out += "}";
    }

    fn parts(&self, out: &mut String) {
        list(out, &self.scene.parts, "\n    ", "\n  ", |out, part| {
            let own = self.layout.parts.get(&part.name).map_or(&[][..], Vec::as_slice);
            *out += "{";
            let mut count = 0;
            for field in completed(own, &PART) {
                let said = own.iter().any(|known| known.name() == field.name()) && !is_unsaid(part, field.name());
                if said || !is_default(part, field.name()) {
                    begin(out, count, "\n      ", field.name());
                    part_field(out, part, &field);
                    count += 1;
                }
            }
            *out += "\n    }";
        });
    }
}

/// Whether a field of a part has its default value and may be left out.
fn is_default(part: &Part, name: &str) -> bool {
    match name {
        "pins" => part.pins.is_empty(),
        "centers" => part.centers.is_empty(),
        "tracks" => part.tracks.is_empty(),
        "confidence" => part.confidence.is_empty(),
        "curves" => part.curves.is_empty(),
        "wants_key" => part.wants_key.is_empty(),
        "depths" => part.depths.is_empty(),
        "absent" => part.absent.is_empty(),
        "feather" => part.feather.is_empty(),
        "falloff" => part.falloff.rate == 1.0,
        "falloff_curve" => part.falloff.curve.is_none(),
        "color" => part.colour.is_none(),
        _ => false,
    }
}

/// Whether a field has no value that could be written.
fn is_unsaid(part: &Part, name: &str) -> bool {
    match name {
        "falloff_curve" => part.falloff.curve.is_none(),
        "color" => part.colour.is_none(),
        _ => false,
    }
}

fn part_field(out: &mut String, part: &Part, field: &Field) {
    match field {
        Field::Unknown { json, .. } => *out += json,
        Field::Known("name") => text(out, &part.name),
        Field::Known("closed") => *out += if part.closed { "true" } else { "false" },
        Field::Known("depth") => number(out, part.depth),
        Field::Known("keys") => {
            frames(out, &part.keys, |out, _, points| list(out, points, "", "", |out, p| pair(out, *p)))
        }
        Field::Known("pins") => frames(out, &part.pins, |out, _, pins| {
            *out += "{";
            for (i, (index, p)) in pins.iter().enumerate() {
                begin(out, i, if i > 0 { " " } else { "" }, &index.to_string());
                pair(out, *p);
            }
            *out += "}";
        }),
        Field::Known("centers") => frames(out, &part.centers, |out, _, p| pair(out, *p)),
        Field::Known("tracks") => frames(out, &part.tracks, |out, frame, points| track(out, part, frame, points)),
        Field::Known("confidence") => {
            frames(out, &part.confidence, |out, _, values| list(out, values, "", "", |out, v| number(out, rounded(*v))))
        }
        Field::Known("wants_key") => {
            list(out, &part.wants_key, "", "", |out, frame| number(out, f64::from(*frame)));
        }
        Field::Known("absent") => list(out, &part.absent, "", "", |out, range| {
            list(out, range, "", "", |out, frame| number(out, f64::from(*frame)));
        }),
        Field::Known("feather") => list(out, &part.feather, "", "", |out, width| number(out, *width)),
        Field::Known("falloff") => number(out, part.falloff.rate),
        Field::Known("falloff_curve") => text(out, part.falloff.curve.unwrap_or_default().id()),
        Field::Known("color") => {
            list(out, &part.colour.unwrap_or_default(), "", "", |out, value| number(out, *value));
        }
        Field::Known("depths") => frames(out, &part.depths, |out, _, depth| number(out, *depth)),
        Field::Known(_) => frames(out, &part.curves, |out, _, paths| {
            list(out, paths, "", "", |out, path| list(out, path, "", "", |out, p| pair(out, rounded_point(*p))))
        }),
    }
}

fn track(out: &mut String, part: &Part, frame: FrameNumber, points: &[Point]) {
    let (key, pins) = (part.keys.get(&frame), part.pins.get(&frame));
    let indexed: Vec<_> = points.iter().enumerate().collect();
    list(out, &indexed, "", "", |out, &(index, &p)| {
        let made = [key.and_then(|key| key.get(index)), pins.and_then(|pins| pins.get(&index))];
        pair(out, if made.contains(&Some(&p)) { p } else { rounded_point(p) });
    });
}

pub(super) fn rounded(value: f64) -> f64 {
    let scale = 10f64.powi(DECIMALS);
    (value * scale).round() / scale
}

fn rounded_point(p: Point) -> Point {
    Point::new(rounded(p.x), rounded(p.y))
}

/// Separator, line break and name of the field `index` of an object.
fn begin(out: &mut String, index: usize, space: &str, name: &str) {
    if index > 0 {
        *out += ",";
    }
    *out += space;
    text(out, name);
    *out += ": ";
}

fn frames<T>(out: &mut String, map: &BTreeMap<FrameNumber, T>, mut write: impl FnMut(&mut String, FrameNumber, &T)) {
    *out += "{";
    for (i, (frame, value)) in map.iter().enumerate() {
        begin(out, i, "\n        ", &frame.to_string());
        write(out, *frame, value);
    }
    *out += if map.is_empty() { "}" } else { "\n      }" };
}

fn list<T>(out: &mut String, items: &[T], space: &str, end: &str, mut write: impl FnMut(&mut String, &T)) {
    *out += "[";
    for (i, item) in items.iter().enumerate() {
        if i > 0 {
            *out += if space.is_empty() { ", " } else { "," };
        }
        *out += space;
        write(out, item);
    }
    *out += if items.is_empty() { "]" } else { end };
    if !items.is_empty() {
        *out += "]";
    }
}

fn pair(out: &mut String, p: Point) {
    *out += "[";
    number(out, p.x);
    *out += ", ";
    number(out, p.y);
    *out += "]";
}

/// The shortest text that reads back as the same number.
fn number(out: &mut String, value: f64) {
    if value.is_finite() {
        let _ = write!(out, "{value}"); // writing to a String cannot fail
    } else {
        *out += "null";
    }
}

fn text(out: &mut String, value: &str) {
    *out += &serde_json::Value::from(value).to_string();
}
