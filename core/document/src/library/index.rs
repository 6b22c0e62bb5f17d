//! The index of a library, `library.json`.
//!
//! The index is a JSON object: `rototoon_library` is the version, `clips` the list of entries. Fields that this version
//! does not know are kept, in the index and in each entry, and so is their order.

use super::{Entry, INDEX, Trouble};
use crate::fields::described;
use rototoon_base::file;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::Path;

/// Version of the index format.
pub const VERSION: u64 = 1;

/// Ending of the names of clip files.
pub const ENDING: &str = ".clip.json";

/// The index as it was read.
#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    /// Fields of the index beside `clips`.
    fields: Map<String, Value>,
    /// The entries.
    pub entries: Vec<Entry>,
    /// The fields of each entry as they were read.
    pub kept: Vec<Map<String, Value>>,
    /// What cannot be used. A later version and an index that cannot be read are among them.
    pub troubles: Vec<Trouble>,
}

impl Index {
    /// Reads the index of a folder. A folder without an index has an empty one.
    pub fn read(folder: &Path) -> Self {
        let path = folder.join(INDEX);
        let origin = path.display().to_string();
        let bytes = match file::bytes(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Self::default(),
            Err(error) => return Self::of(Trouble::Unreadable { origin, reason: error.to_string() }),
        };
        Self::parse(&bytes, &origin)
    }

    fn of(trouble: Trouble) -> Self {
        Self { troubles: vec![trouble], ..Self::default() }
    }

    fn parse(bytes: &[u8], origin: &str) -> Self {
        let origin = || origin.to_owned();
        let text = String::from_utf8_lossy(bytes);
        let damaged = |reason: String| Self::of(Trouble::Index { origin: origin(), reason });
        let plain = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let mut fields = match serde_json::from_str::<Value>(plain) {
            Ok(Value::Object(fields)) => fields,
            Ok(other) => return damaged(format!("found {}, expected an object", described(Some(&other)))),
            Err(error) => return damaged(error.to_string()),
        };
        match fields.get("rototoon_library").and_then(Value::as_u64) {
            Some(found) if found > VERSION => return Self::of(Trouble::Later { origin: origin(), found }),
            Some(_) => {}
            None => {
                let found = described(fields.get("rototoon_library"));
                return damaged(format!("rototoon_library: found {found}, expected a version from 1 to {VERSION}"));
            }
        }
        let Some(Value::Array(clips)) = fields.get_mut("clips").map(Value::take) else {
            return damaged(format!("clips: found {}, expected a list", described(fields.get("clips"))));
        };
        let mut index = Self { fields, ..Self::default() };
        if let Err(error) = std::str::from_utf8(bytes) {
            index.troubles.push(Trouble::Bytes { origin: origin(), byte: error.valid_up_to() });
        }
        index.take(clips, &origin());
        index
    }

    /// Takes the entries that can be used, and reports the others.
    fn take(&mut self, clips: Vec<Value>, origin: &str) {
        let mut seen = BTreeSet::new();
        for (entry, value) in clips.into_iter().enumerate() {
            let wrong = |(field, found, expected): (&str, String, &str)| Trouble::Entry {
                origin: origin.to_owned(),
                entry,
                field: field.to_owned(),
                found,
                expected: expected.to_owned(),
            };
            match checked(&value) {
                Ok(read) if !seen.insert(read.file.to_lowercase()) => {
                    let found = format!("{:?} a second time", read.file);
                    self.troubles.push(wrong((".file", found, "each file once")));
                }
                Ok(read) => {
                    let Value::Object(fields) = value else { continue };
                    self.push(read, fields);
                }
                Err(fault) => self.troubles.push(wrong(fault)),
            }
        }
    }

    /// Adds an entry. `kept` holds the fields that this version does not know.
    pub fn push(&mut self, entry: Entry, kept: Map<String, Value>) {
        self.entries.push(entry);
        self.kept.push(kept);
    }

    /// The reason why the index must not be changed, if there is one.
    pub fn untouchable(&self) -> Option<&Trouble> {
        self.troubles.iter().find(|t| matches!(t, Trouble::Later { .. } | Trouble::Unreadable { .. }))
    }

    /// Whether a part of the index would be lost if it were written again.
    pub fn damaged(&self) -> bool {
        let of_index = |t: &Trouble| matches!(t, Trouble::Index { .. } | Trouble::Bytes { .. } | Trouble::Entry { .. });
        self.troubles.iter().any(of_index)
    }

    /// The text of the index.
    pub fn text(&self) -> String {
        let mut all = Map::new();
        all.insert("rototoon_library".into(), json!(VERSION));
        all.extend(self.fields.iter().filter(|(name, _)| *name != "clips").map(|(k, v)| (k.clone(), v.clone())));
        let clips =
            self.entries.iter().zip(&self.kept).map(|(entry, fields)| Value::Object(written(entry, fields))).collect();
        all.insert("clips".into(), Value::Array(clips));
        format!("{:#}\n", Value::Object(all))
    }
}

/// The fields of an entry, with those that this version does not know.
fn written(entry: &Entry, kept: &Map<String, Value>) -> Map<String, Value> {
    let mut fields = match serde_json::to_value(entry) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    };
    for (name, value) in kept {
        fields.entry(name.clone()).or_insert_with(|| value.clone());
    }
    fields
}

/// The entry of a value, or the field, what was found and what was expected.
fn checked(value: &Value) -> Result<Entry, (&'static str, String, &'static str)> {
    let Value::Object(fields) = value else { return Err(("", described(Some(value)), "an object")) };
    let text = |name: &'static str, place: &'static str| match fields.get(name) {
        Some(Value::String(text)) if !text.contains(char::REPLACEMENT_CHARACTER) => Ok(text.clone()),
        other => Err((place, described(other), "a text")),
    };
    let file = text("file", ".file")?;
    if !is_clip_file(&file) {
        return Err((".file", format!("{file:?}"), "a name within the folder that ends in .clip.json"));
    }
    let frames = fields.get("frames").and_then(Value::as_u64).and_then(|n| usize::try_from(n).ok());
    let fps = fields.get("fps").and_then(Value::as_f64).filter(|fps| *fps > 0.0);
    Ok(Entry {
        file,
        character: text("character", ".character")?,
        motion: text("motion", ".motion")?,
        frames: frames.ok_or_else(|| (".frames", described(fields.get("frames")), "a whole number from 0 on"))?,
        fps: fps.ok_or_else(|| (".fps", described(fields.get("fps")), "a positive number"))?,
        source: fields.get("source").and_then(Value::as_str).unwrap_or_default().to_owned(),
    })
}

/// Whether a name is one of a clip file within the folder. Both separators count on every system, since the folder may be
/// shared.
pub(super) fn is_clip_file(name: &str) -> bool {
    name.len() > ENDING.len() && name.ends_with(ENDING) && !name.contains(['/', '\\', ':', '\0'])
}
