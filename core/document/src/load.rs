//! Reads project documents.
//!
//! A document is read in one pass. Reading continues after an invalid value, so the error lists every problem, up to a
//! limit for each kind. Only text that is not JSON ends the reading early.

use super::Document;
use super::looks::{Curve, Shade};
use super::problem::Problems;
use super::schema::{Field, GAPS, Layout, VERSION};
use super::shape::{Context, Entries, Flag, Frame, FrameRange, List, Number, Pair, Seed, Shape, Step, Text, Whole};
use super::unknown::OTHERS;
use super::{doubled, validate};
use rototoon_base::file;
use rototoon_base::scene::{Falloff, Footage, FrameNumber, Part, Scene};
use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess};
use serde_json::error::Category;
use serde_json::value::RawValue;
use std::path::Path;

/// Why a document cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be read.
    #[error("{origin}: cannot read the document: {reason}")]
    Unreadable {
        /// Path of the file.
        origin: String,
        /// The message of the system.
        reason: String,
    },
    /// The document's version is newer than this program.
    #[error("{origin}: found a document of version {found}, expected version {VERSION}: a newer Rototoon wrote it")]
    Newer {
        /// Path of the file.
        origin: String,
        /// The document's version.
        found: String,
    },
    /// The text is not JSON or ends too early.
    #[error("{origin}: line {line}, column {column}{}{place}: {reason}", if place.is_empty() { "" } else { ", in " })]
    Syntax {
        /// Path of the file.
        origin: String,
        /// Line, from 1.
        line: usize,
        /// Byte within the line, from 1.
        column: usize,
        /// JSON path of the value that was being read.
        place: String,
        /// The found and the expected text.
        reason: String,
    },
    /// The text is JSON, but not a valid project document.
    #[error("{}", lines(origin, problems).join("\n"))]
    Invalid {
        /// Path of the file.
        origin: String,
        /// All problems.
        problems: Problems,
    },
}

impl LoadError {
    /// The message, with one line for each problem.
    pub fn lines(&self) -> Vec<String> {
        match self {
            Self::Invalid { origin, problems } => lines(origin, problems),
            other => vec![other.to_string()],
        }
    }
}

fn lines(origin: &str, problems: &Problems) -> Vec<String> {
    let mut lines: Vec<_> = problems.errors().map(|problem| format!("{origin}: {problem}")).collect();
    if problems.left_off().0 > 0 {
        lines.push(format!("{origin}: and {} more errors", problems.left_off().0));
    }
    lines
}

impl Document {
    /// Reads the file of a document.
    ///
    /// # Errors
    ///
    /// A [`LoadError`] with every problem, each with its place.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        let origin = path.display().to_string();
        let unreadable = |reason: String| LoadError::Unreadable { origin: origin.clone(), reason };
        let json = file::text(path).map_err(|error| unreadable(error.to_string()))?;
        Self::parse(&json, &origin)
    }

    /// Reads a document from text; `origin` names it in messages. A document without errors may still have warnings
    /// ([`Document::problems`]).
    ///
    /// # Errors
    ///
    /// A [`LoadError`] with every problem, not only the first.
    pub fn parse(json: &str, origin: &str) -> Result<Self, LoadError> {
        let json = json.strip_prefix('\u{feff}').unwrap_or(json);
        let mut context = Context::default();
        let mut deserializer = serde_json::Deserializer::from_str(json);
        let read = Seed(DocumentShape, &mut context).deserialize(&mut deserializer);
        if let Some(found) = context.newer {
            return Err(LoadError::Newer { origin: origin.to_owned(), found });
        }
        let read = read.and_then(|read| deserializer.end().map(|()| read));
        let raw = read.map_err(|error| syntax_error(json, origin, &context, &error))?;
        let mut problems = context.problems();
        let document = raw.and_then(|raw| {
            problems.append(validate::parts_problems(&raw.parts, raw.footage.as_ref()));
            raw.footage.map(|footage| Self { scene: Scene { footage, parts: raw.parts }, layout: raw.layout })
        });
        match document {
            Some(document) if problems.error_count() == 0 => Ok(document),
            _ => Err(LoadError::Invalid { origin: origin.to_owned(), problems }),
        }
    }
}

fn syntax_error(json: &str, origin: &str, context: &Context, error: &serde_json::Error) -> LoadError {
    let (line, column) = (error.line(), error.column());
    let reason = if json.trim().is_empty() {
        "the document is empty".to_owned()
    } else if error.classify() == Category::Eof {
        "the document ends too early: it was cut short".to_owned()
    } else {
        let text = error.to_string();
        let said = text.split(" at line ").next().unwrap_or_default();
        match not_a_number(json, line, column) {
            Some(word) => format!("found {word}, expected a finite number"),
            None => said.to_owned(),
        }
    };
    LoadError::Syntax { origin: origin.to_owned(), line, column, place: context.place(), reason }
}

/// The word for a number that is not finite, as other tools write it into JSON, at or just before a place.
fn not_a_number(json: &str, line: usize, column: usize) -> Option<&'static str> {
    let text = json.split('\n').nth(line.checked_sub(1)?)?.as_bytes();
    let starts = column.saturating_sub(2)..=column;
    ["NaN", "-Infinity", "Infinity", "nan", "inf"].into_iter().find(|word| {
        starts.clone().any(|start| text.get(start..).is_some_and(|rest| rest.starts_with(word.as_bytes())))
    })
}

/// The content of a document, as far as it can be read.
struct Raw {
    footage: Option<Footage>,
    parts: Vec<Part>,
    layout: Layout,
}

/// Reads the value of one field into `slot`.
fn field<'de, S: Shape<'de>, A: MapAccess<'de>>(
    context: &mut Context,
    entries: &mut A,
    name: &'static str,
    shape: S,
    slot: &mut Option<S::Value>,
) -> Result<Field, A::Error> {
    let read = context.within(Step::Field(name), |inner| entries.next_value_seed(Seed(shape, inner)))?;
    *slot = read;
    Ok(Field::Known(name))
}

fn unknown<'de, A: MapAccess<'de>>(entries: &mut A, name: String) -> Result<Field, A::Error> {
    let json = entries.next_value::<&RawValue>()?.get().to_owned();
    Ok(Field::Unknown { name, json })
}

/// A field of the document that other stages read, or that nobody does. In the former no object may have a field twice.
fn other<'de, A: MapAccess<'de>>(context: &mut Context, entries: &mut A, name: String) -> Result<Field, A::Error> {
    let read = unknown(entries, name)?;
    let known = OTHERS.iter().find(|known| **known == read.name());
    if let (Some(known), Field::Unknown { json, .. }) = (known, &read)
        && let Some((way, name)) = doubled::first(json)
    {
        // Recording an error cannot fail, so the steps are always removed again.
        let _ = context.within(Step::Field(known), |within| {
            within.within(Step::Way(way), |inner| {
                inner.error(format!("found the field {name:?} twice, expected it once"));
                Ok::<_, std::convert::Infallible>(())
            })
        });
    }
    Ok(read)
}

/// Whether the field `name` appeared before. If so, its value is skipped and an error recorded.
fn repeated<'de, A: MapAccess<'de>>(
    context: &mut Context,
    entries: &mut A,
    fields: &[Field],
    name: &str,
) -> Result<bool, A::Error> {
    let repeated = fields.iter().any(|field| field.name() == name);
    if repeated {
        entries.next_value::<IgnoredAny>()?;
        context.error(format!("found the field {name:?} twice, expected it once"));
    }
    Ok(repeated)
}

fn require(context: &mut Context, fields: &[Field], names: &[&str]) {
    for name in names {
        if !fields.iter().any(|field| field.name() == *name) {
            context.error(format!("the field {name:?} is missing"));
        }
    }
}

/// The version: a number whose integer part is the major version.
struct Version;

impl Shape<'_> for Version {
    type Value = f64;
    const EXPECTED: &'static str = "the version 1";

    fn scalar(self, context: &mut Context, scalar: super::shape::Scalar<'_>) -> Option<f64> {
        match scalar {
            super::shape::Scalar::Number(number) if number >= 1.0 => Some(number),
            other => {
                context.wrong(other, Self::EXPECTED);
                None
            }
        }
    }
}

struct DocumentShape;

impl<'de> Shape<'de> for DocumentShape {
    type Value = Raw;
    const EXPECTED: &'static str = "a project document";

    fn object<A: MapAccess<'de>>(self, context: &mut Context, mut entries: A) -> Result<Option<Raw>, A::Error> {
        let (mut version, mut footage, mut parts) = (None, None, None);
        let mut layout = Layout::default();
        while let Some(name) = entries.next_key::<String>()? {
            if repeated(context, &mut entries, &layout.top, &name)? {
                continue;
            }
            let read = match name.as_str() {
                "rototoon" => {
                    let read = field(context, &mut entries, "rototoon", Version, &mut version)?;
                    if let Some(found) = version.filter(|found: &f64| *found >= f64::from(VERSION + 1)) {
                        context.newer = Some(found.to_string());
                        return Err(A::Error::custom("newer version"));
                    }
                    read
                }
                "footage" => field(context, &mut entries, "footage", FootageShape, &mut footage)?,
                "parts" => field(context, &mut entries, "parts", PartsShape, &mut parts)?,
                _ => other(context, &mut entries, name)?,
            };
            layout.top.push(read);
        }
        require(context, &layout.top, &super::schema::TOP);
        if let Some(version) = version {
            layout.version = version.to_string();
        }
        let footage = footage.and_then(|(footage, fields)| {
            layout.footage = fields;
            footage
        });
        let parts = parts.unwrap_or_default();
        layout.parts = parts.iter().map(|(part, fields)| (part.name.clone(), fields.clone())).collect();
        let parts = parts.into_iter().map(|(part, _)| part).collect();
        Ok(Some(Raw { footage, parts, layout }))
    }
}

struct FootageShape;

impl<'de> Shape<'de> for FootageShape {
    type Value = (Option<Footage>, Vec<Field>);
    const EXPECTED: &'static str = "an object with pattern, first, last, fps, width and height";

    fn object<A: MapAccess<'de>>(self, context: &mut Context, mut entries: A) -> Result<Option<Self::Value>, A::Error> {
        let (mut pattern, mut first, mut last) = (None, None, None);
        let (mut fps, mut width, mut height, mut gaps) = (None, None, None, None);
        let mut fields = Vec::new();
        while let Some(name) = entries.next_key::<String>()? {
            if repeated(context, &mut entries, &fields, &name)? {
                continue;
            }
            fields.push(match name.as_str() {
                "pattern" => field(context, &mut entries, "pattern", Text, &mut pattern)?,
                "first" => field(context, &mut entries, "first", Whole, &mut first)?,
                "last" => field(context, &mut entries, "last", Whole, &mut last)?,
                "fps" => field(context, &mut entries, "fps", Number, &mut fps)?,
                "width" => field(context, &mut entries, "width", Whole, &mut width)?,
                "height" => field(context, &mut entries, "height", Whole, &mut height)?,
                GAPS => field(context, &mut entries, GAPS, Text, &mut gaps)?,
                _ => unknown(&mut entries, name)?,
            });
        }
        require(context, &fields, &super::schema::FOOTAGE);
        let raw = validate::RawFootage { pattern, first, last, fps, width, height, gaps };
        Ok(Some((raw.checked(|name, message| report(context, name, message)), fields)))
    }
}

fn report(context: &mut Context, name: &'static str, message: String) {
    // Recording an error cannot fail, so the step is always removed again.
    let _ = context.within(Step::Field(name), |inner| {
        inner.error(message);
        Ok::<_, std::convert::Infallible>(())
    });
}

struct PartsShape;

impl<'de> Shape<'de> for PartsShape {
    type Value = Vec<(Part, Vec<Field>)>;
    const EXPECTED: &'static str = "a list of parts";

    fn list<A: SeqAccess<'de>>(self, context: &mut Context, mut items: A) -> Result<Option<Self::Value>, A::Error> {
        let mut parts = Vec::new();
        // The step of a part replaces the step of the list: `parts[3]`, not `parts.parts[3]`.
        while let Some(part) = context
            .within(Step::Part(parts.len()), |inner| items.next_element_seed(Seed(PartShape(parts.len()), inner)))?
        {
            parts.push(part.unwrap_or_default());
        }
        Ok(Some(parts))
    }
}

/// A part, with its index.
struct PartShape(usize);

impl<'de> Shape<'de> for PartShape {
    type Value = (Part, Vec<Field>);
    const EXPECTED: &'static str = "a part: an object with name and keys";

    fn object<A: MapAccess<'de>>(self, context: &mut Context, mut entries: A) -> Result<Option<Self::Value>, A::Error> {
        let (mut name, mut closed, mut depth) = (None, None, None);
        let (mut keys, mut pins, mut centers) = (None, None, None);
        let (mut tracks, mut confidence, mut curves) = (None, None, None);
        let (mut wants_key, mut depths, mut absent, mut feather) = (None, None, None, None);
        let (mut falloff, mut falloff_curve, mut color) = (None, None, None);
        let mut fields = Vec::new();
        let points = Entries::<FrameNumber, _>::new(List(Pair));
        while let Some(key) = entries.next_key::<String>()? {
            if repeated(context, &mut entries, &fields, &key)? {
                continue;
            }
            let source = &mut entries;
            fields.push(match key.as_str() {
                "name" => {
                    let read = field(context, source, "name", Text, &mut name)?;
                    context.names.extend(name.clone().map(|name: String| (self.0, name)));
                    read
                }
                "closed" => field(context, source, "closed", Flag, &mut closed)?,
                "depth" => field(context, source, "depth", Number, &mut depth)?,
                "keys" => field(context, source, "keys", points, &mut keys)?,
                "pins" => field(context, source, "pins", Entries::new(Entries::<usize, _>::new(Pair)), &mut pins)?,
                "centers" => field(context, source, "centers", Entries::<FrameNumber, _>::new(Pair), &mut centers)?,
                "tracks" => field(context, source, "tracks", points, &mut tracks)?,
                "confidence" => field(context, source, "confidence", Entries::new(List(Number)), &mut confidence)?,
                "curves" => field(context, source, "curves", Entries::new(List(List(Pair))), &mut curves)?,
                "wants_key" => field(context, source, "wants_key", List(Frame), &mut wants_key)?,
                "depths" => field(context, source, "depths", Entries::<FrameNumber, _>::new(Number), &mut depths)?,
                "absent" => field(context, source, "absent", List(FrameRange), &mut absent)?,
                "feather" => field(context, source, "feather", List(Number), &mut feather)?,
                "falloff" => field(context, source, "falloff", Number, &mut falloff)?,
                "falloff_curve" => field(context, source, "falloff_curve", Curve, &mut falloff_curve)?,
                "color" => field(context, source, "color", Shade, &mut color)?,
                _ => unknown(source, key)?,
            });
        }
        require(context, &fields, &["name", "keys"]);
        let part = Part {
            name: name.unwrap_or_default(),
            closed: closed.unwrap_or(true),
            depth: depth.unwrap_or(0.0),
            keys: keys.unwrap_or_default(),
            pins: pins.unwrap_or_default(),
            centers: centers.unwrap_or_default(),
            tracks: tracks.unwrap_or_default(),
            confidence: confidence.unwrap_or_default(),
            curves: curves.unwrap_or_default(),
            wants_key: wants_key.unwrap_or_default(),
            depths: depths.unwrap_or_default(),
            absent: absent.unwrap_or_default(),
            feather: feather.unwrap_or_default(),
            falloff: Falloff { rate: falloff.unwrap_or(1.0), curve: falloff_curve },
            colour: color,
        };
        Ok(Some((part, fields)))
    }
}
