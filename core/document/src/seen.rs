//! Which pictures results were made of.
//!
//! ```json
//! "seen": {"filled": {"109": "5f0c12a89be07d34-11c4…", "…": "…"}, "traced": {"…": "…"}, "tracks": {"…": "…"}}
//! ```
//!
//! - For each result, by frame, the marks of the picture: that of the file's bytes, and that of the pixels. Either is 16 hexadecimal digits.
//! - If the bytes are the same, so are the pixels, and nothing need be decoded. A picture that was only saved again, such as with another compression,
//!   has the same pixels.
//! - What is missing was made by an earlier version, or of no picture. Nothing is said of it.

use super::Document;
use super::fields::{FieldError, described, object, wrong};
use rototoon_base::scene::FrameNumber;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// The field.
const SEEN: &str = "seen";
/// What a mark looks like.
const EXPECTED: &str = "two marks of 16 hexadecimal digits, such as \"0123456789abcdef-0123456789abcdef\"";

/// The marks of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Of its file.
    pub file: u64,
    /// Of its pixels.
    pub pixels: u64,
}

/// Results that are made of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// Painted regions.
    Filled,
    /// Traced strokes.
    Traced,
    /// Tracked contours.
    Tracks,
}

impl Made {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Filled, Self::Traced, Self::Tracks];

    fn name(self) -> &'static str {
        match self {
            Self::Filled => "filled",
            Self::Traced => "traced",
            Self::Tracks => "tracks",
        }
    }

    /// What was done: "painted".
    pub fn done(self) -> &'static str {
        match self {
            Self::Filled => "painted",
            Self::Traced => "traced",
            Self::Tracks => "tracked",
        }
    }
}

impl Document {
    /// The marks of the pictures of which a result was made, by frame.
    ///
    /// # Errors
    ///
    /// The first invalid mark.
    pub fn seen(&self, made: Made) -> Result<BTreeMap<FrameNumber, Seen>, FieldError> {
        let all = self.all_seen()?;
        let place = format!("{SEEN}.{}", made.name());
        let Some(value) = all.get(made.name()) else { return Ok(BTreeMap::new()) };
        let read = |(frame, value): (&String, &Value)| {
            let place = format!("{place}.\"{frame}\"");
            let number = frame.parse().map_err(|_| wrong(&place, &format!("{frame:?}"), "a frame number"))?;
            let seen = value.as_str().and_then(marks);
            Ok((number, seen.ok_or_else(|| wrong(&place, &described(Some(value)), EXPECTED))?))
        };
        object(value, &place)?.iter().map(read).collect()
    }

    /// Puts the marks of pictures into the document, in place of earlier ones of this result on the frames of a range.
    ///
    /// # Errors
    ///
    /// An earlier mark that is invalid.
    pub fn set_seen(
        &mut self,
        made: Made,
        range: RangeInclusive<FrameNumber>,
        seen: &BTreeMap<FrameNumber, Seen>,
    ) -> Result<(), FieldError> {
        let mut own = self.seen(made)?;
        own.retain(|frame, _| !range.contains(frame));
        own.extend(seen.iter().filter(|(frame, _)| range.contains(frame)));
        let mut all = self.all_seen()?;
        let text = |seen: Seen| format!("{:016x}-{:016x}", seen.file, seen.pixels);
        let frames: Map<String, Value> =
            own.into_iter().map(|(frame, seen)| (frame.to_string(), json!(text(seen)))).collect();
        all.remove(made.name());
        if !frames.is_empty() {
            all.insert(made.name().into(), Value::Object(frames));
        }
        if all.is_empty() {
            self.remove_other_field(SEEN);
        } else {
            self.set_other_field(SEEN, Value::Object(all).to_string());
        }
        Ok(())
    }

    /// Forgets which pictures results were made of.
    pub fn forget_seen(&mut self) {
        self.remove_other_field(SEEN);
    }

    fn all_seen(&self) -> Result<Map<String, Value>, FieldError> {
        let Some(json) = self.other_field(SEEN) else { return Ok(Map::new()) };
        let value = serde_json::from_str(json).unwrap_or(Value::Null);
        object(&value, SEEN).cloned()
    }
}

fn marks(text: &str) -> Option<Seen> {
    let (file, pixels) = text.split_once('-')?;
    let mark = |text: &str| (text.len() == 16).then(|| u64::from_str_radix(text, 16).ok()).flatten();
    Some(Seen { file: mark(file)?, pixels: mark(pixels)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(more: &str) -> Document {
        let text = format!(
            r#"{{"rototoon": 1, "footage": {{"pattern": "f_%d.png", "first": 0, "last": 9, "fps": 24, "width": 64,
            "height": 48}}, "parts": []{more}}}"#
        );
        Document::parse(&text, "a.json").unwrap()
    }

    #[test]
    fn marks_are_written_read_replaced_within_a_range_and_forgotten() {
        let mut doc = document("");
        let bare = doc.to_json();
        let of = |frames: &[FrameNumber], file: u64| -> BTreeMap<FrameNumber, Seen> {
            frames.iter().map(|&frame| (frame, Seen { file, pixels: u64::MAX })).collect()
        };
        doc.set_seen(Made::Filled, 0..=9, &of(&[-1, 2, 3, 5], 1)).unwrap();
        doc.set_seen(Made::Traced, 0..=9, &of(&[2], 7)).unwrap();
        doc.set_seen(Made::Filled, 3..=9, &of(&[4], 2)).unwrap();
        let again = Document::parse(&doc.to_json(), "b.json").unwrap();
        let found: Vec<(FrameNumber, u64)> =
            again.seen(Made::Filled).unwrap().into_iter().map(|(frame, seen)| (frame, seen.file)).collect();
        assert_eq!(found, [(2, 1), (4, 2)]);
        assert_eq!(again.seen(Made::Traced).unwrap(), of(&[2], 7));
        assert!(again.seen(Made::Tracks).unwrap().is_empty());
        doc.forget_seen();
        assert_eq!(doc.to_json(), bare);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let said = |seen: &str| document(&format!(", \"seen\": {seen}")).seen(Made::Filled).unwrap_err().to_string();
        assert_eq!(said("3"), "seen: found 3, expected an object");
        assert!(
            said(r#"{"filled": {"7": "ab"}}"#).starts_with(r#"seen.filled."7": found "ab", expected two marks of 16"#)
        );
        assert!(said(r#"{"filled": {"x": "ab"}}"#).contains("expected a frame number"));
    }
}
