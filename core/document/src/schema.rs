//! Names, order and limits of the fields of a document.
//!
//! A document may contain fields that this version does not know: notes of another tool, or results of a later minor
//! version. They are kept as text, byte for byte and in their places ([`Layout`]), so saving loses nothing.

use std::collections::BTreeMap;

/// Largest width of a soft border, in pixels.
pub const MAX_FEATHER: f64 = 2048.0;

/// The major version that this program reads and writes.
pub const VERSION: u32 = 1;

/// Largest absolute value of a coordinate, in pixels: far beyond any picture, but small enough for exact sums.
pub const MAX_COORDINATE: f64 = 1e6;

/// Largest width or height of a picture, in pixels.
pub const MAX_SIZE: usize = 65_535;

/// Least number of frames a second: one frame in seventeen minutes.
pub const MIN_FPS: f64 = 1e-3;

/// Largest number of frames a second.
pub const MAX_FPS: f64 = 1e6;

/// Largest number of frames of a footage: eleven hours at 24 frames a second.
pub const MAX_FRAMES: i64 = 1_000_000;

/// Largest absolute frame number.
pub const MAX_FRAME_NUMBER: i64 = 1_000_000_000;

/// The known fields of the document, in the order of a new document.
pub(super) const TOP: [&str; 3] = ["rototoon", "footage", "parts"];
/// The required fields of the footage.
pub(super) const FOOTAGE: [&str; 6] = ["pattern", "first", "last", "fps", "width", "height"];
/// The field of the footage that may be left out.
pub(super) const GAPS: &str = "gaps";
/// The value of `gaps`: a frame without a file shows the one before it.
pub(super) const HELD: &str = "held";
/// The fields of a part.
///
/// `wants_key` is written by tracking and left out if empty. It contains the frames on which a part with one key was
/// lost: the last one before its track and the first one after it, at most two, ascending. A key there helps most.
///
/// `depths` is written by reshaping and left out if empty. It contains, by frame, depths that differ from `depth`.
///
/// `absent` is the artist's and left out if empty. It contains the first and the last frame of each time in which the part
/// is not there.
///
/// `feather` is the artist's and left out if empty. It has a width for each control point. `falloff` and `falloff_curve` are left out
/// if they are those of the blur, `color` if it is that of the part's index.
pub(super) const PART: [&str; 16] = [
    "name",
    "closed",
    "depth",
    "keys",
    "pins",
    "centers",
    "tracks",
    "confidence",
    "curves",
    "wants_key",
    "depths",
    "absent",
    "feather",
    "falloff",
    "falloff_curve",
    "color",
];

/// A field of an object, as read from the document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Field {
    /// A field whose value is in the scene.
    Known(&'static str),
    /// A field that is only kept: its name, and the text of its value.
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

/// The fields of the document and their order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// The text of the version.
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

/// `fields`, followed by the fields of `known` that are missing in it.
pub(super) fn completed<'a>(fields: &'a [Field], known: &[&'static str]) -> Vec<std::borrow::Cow<'a, Field>> {
    use std::borrow::Cow;
    let missing = known.iter().filter(|name| !fields.iter().any(|field| field.name() == **name));
    fields.iter().map(Cow::Borrowed).chain(missing.map(|name| Cow::Owned(Field::Known(name)))).collect()
}
