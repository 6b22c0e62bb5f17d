//! Names and order of the document's fields.
//!
//! A document may hold fields that this version does not know: another tool's notes, or a later minor version's
//! results. They are kept as text, byte for byte, at the place where they stood (`Layout`), so that nothing is lost
//! when the document is saved.

use std::collections::BTreeMap;

/// The major version that is read and written.
pub const VERSION: u32 = 1;

/// Largest absolute value of a coordinate, in pixels: far beyond any picture, yet small enough for exact sums.
pub const MAX_COORDINATE: f64 = 1e6;

/// Largest width or height of a picture, in pixels.
pub const MAX_SIZE: usize = 65_535;

/// Largest number of frames of a footage: eleven hours at 24 frames a second.
pub const MAX_FRAMES: i64 = 1_000_000;

/// Largest absolute frame number.
pub const MAX_FRAME_NUMBER: i64 = 1_000_000_000;

/// The document's own fields, in the order of a new document.
pub(super) const TOP: [&str; 3] = ["rototoon", "footage", "parts"];
/// The fields of the footage.
pub(super) const FOOTAGE: [&str; 6] = ["pattern", "first", "last", "fps", "width", "height"];
/// The fields of a part.
///
/// `wants_key` (written by tracking, left out where empty): the frames on which a part with one key was lost, the last
/// one before its track or the first one after it, at most two in rising order. A key there helps most.
///
/// `depths` (written by reshaping, left out where empty): by frame the depth there, where it is another than `depth`.
pub(super) const PART: [&str; 11] =
    ["name", "closed", "depth", "keys", "pins", "centers", "tracks", "confidence", "curves", "wants_key", "depths"];

/// One field of an object as it stood in the document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Field {
    /// A field whose value the scene holds.
    Known(&'static str),
    /// A field that is only kept: its name, and its value as it was written.
    Unknown {
        /// Name.
        name: String,
        /// Value, as JSON text.
        json: String,
    },
}

impl Field {
    /// The field's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Known(name) => name,
            Self::Unknown { name, .. } => name,
        }
    }
}

/// Which fields the document had, and in which order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// The version as it was written.
    pub version: String,
    /// Fields of the document.
    pub top: Vec<Field>,
    /// Fields of the footage.
    pub footage: Vec<Field>,
    /// Fields of each part, by the part's name.
    pub parts: BTreeMap<String, Vec<Field>>,
}

impl Default for Layout {
    fn default() -> Self {
        Self { version: VERSION.to_string(), top: Vec::new(), footage: Vec::new(), parts: BTreeMap::new() }
    }
}

/// `fields` followed by those of `known` that are not among them.
pub(super) fn completed<'a>(fields: &'a [Field], known: &[&'static str]) -> Vec<std::borrow::Cow<'a, Field>> {
    use std::borrow::Cow;
    let missing = known.iter().filter(|name| !fields.iter().any(|field| field.name() == **name));
    fields.iter().map(Cow::Borrowed).chain(missing.map(|name| Cow::Owned(Field::Known(name)))).collect()
}
