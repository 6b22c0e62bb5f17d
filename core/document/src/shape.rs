//! Reads JSON of any content in one pass and without an intermediate tree.
//!
//! Each place of a document has a [`Shape`]. A value that does not fit is skipped and recorded with its path, so one
//! reading finds every problem. Only text that is not JSON ends the reading; the path then names the place. A document
//! of hundreds of megabytes takes memory for its coordinates and little more.

use super::problem::Problems;
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;

/// One step of a JSON path.
#[derive(Clone, Debug)]
pub(super) enum Step {
    /// A field by name.
    Field(&'static str),
    /// An entry whose key is a number in quotes: a frame or the index of a point.
    Entry(i64),
    /// An element of a list.
    Index(usize),
    /// A part by index.
    Part(usize),
    /// Steps in words, with the marks between them.
    Way(String),
}

/// The present place of the reader, and the problems found so far.
#[derive(Debug, Default)]
pub(super) struct Context {
    steps: Vec<Step>,
    found: Vec<(Vec<Step>, String)>,
    count: usize,
    /// Names of the parts read so far.
    pub names: BTreeMap<usize, String>,
    /// The document's version, if it is too new to be read.
    pub newer: Option<String>,
}

impl Context {
    /// Runs `read` one step deeper. After an error the path still names the place of the error.
    pub fn within<T, E>(&mut self, step: Step, read: impl FnOnce(&mut Self) -> Result<T, E>) -> Result<T, E> {
        self.steps.push(step);
        let value = read(self)?;
        self.steps.pop();
        Ok(value)
    }

    /// Records an error at the present place.
    pub fn error(&mut self, message: String) {
        self.count += 1;
        if self.found.len() < super::problem::LISTED {
            self.found.push((self.steps.clone(), message));
        }
    }

    /// Records that a value differs from the expected one.
    pub fn wrong(&mut self, found: impl fmt::Display, expected: &str) {
        self.error(format!("found {found}, expected {expected}"));
    }

    /// The path of the present place.
    pub fn place(&self) -> String {
        self.path(&self.steps)
    }

    /// All problems found so far.
    pub fn problems(&self) -> Problems {
        let mut problems = Problems::default();
        for (steps, message) in &self.found {
            problems.error(self.path(steps), message.clone());
        }
        for _ in self.found.len()..self.count {
            problems.error("", "");
        }
        problems
    }

    fn path(&self, steps: &[Step]) -> String {
        let mut path = String::new();
        for step in steps {
            match step {
                Step::Field(name) if path.is_empty() => path += name,
                Step::Field(name) => path += &format!(".{name}"),
                Step::Entry(number) => path += &format!(".\"{number}\""),
                Step::Index(index) => path += &format!("[{index}]"),
                Step::Way(way) => path += way,
                Step::Part(index) => path = part_place(*index, self.names.get(index).map(String::as_str)),
            }
        }
        path
    }
}

/// JSON path of a part, with its name if it has one.
pub(super) fn part_place(index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("parts[{index}] {name:?}"),
        None => format!("parts[{index}]"),
    }
}

/// A value that is neither a list nor an object.
pub(super) enum Scalar<'a> {
    /// `null`.
    Null,
    /// `true` or `false`.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A text.
    Text(&'a str),
}

impl fmt::Display for Scalar<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        const LONGEST: usize = 60;
        match self {
            Self::Null => out.write_str("null"),
            Self::Flag(flag) => write!(out, "{flag}"),
            Self::Number(number) => write!(out, "{number:?}"),
            Self::Text(text) if text.chars().count() <= LONGEST => write!(out, "the text {text:?}"),
            Self::Text(text) => write!(out, "the text {:?}…", text.chars().take(LONGEST).collect::<String>()),
        }
    }
}

/// The expected content at a place of the document. Methods that a shape does not define reject their kind of value.
pub(super) trait Shape<'de>: Sized {
    /// The type of the result.
    type Value;
    /// Description of the expected value, for messages.
    const EXPECTED: &'static str;

    /// Reads a list.
    fn list<A: SeqAccess<'de>>(self, context: &mut Context, mut items: A) -> Result<Option<Self::Value>, A::Error> {
        while items.next_element::<IgnoredAny>()?.is_some() {}
        context.wrong("a list", Self::EXPECTED);
        Ok(None)
    }

    /// Reads an object.
    fn object<A: MapAccess<'de>>(self, context: &mut Context, mut entries: A) -> Result<Option<Self::Value>, A::Error> {
        while entries.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        context.wrong("an object", Self::EXPECTED);
        Ok(None)
    }

    /// Reads a value that is neither a list nor an object.
    fn scalar(self, context: &mut Context, scalar: Scalar<'_>) -> Option<Self::Value> {
        context.wrong(scalar, Self::EXPECTED);
        None
    }
}

/// A shape and the context of the reading. The result is `None` if the value does not fit.
pub(super) struct Seed<'c, S>(pub S, pub &'c mut Context);

impl<'de, S: Shape<'de>> DeserializeSeed<'de> for Seed<'_, S> {
    type Value = Option<S::Value>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de, S: Shape<'de>> Visitor<'de> for Seed<'_, S> {
    type Value = Option<S::Value>;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(S::EXPECTED)
    }

    fn visit_unit<E: Error>(self) -> Result<Self::Value, E> {
        Ok(self.0.scalar(self.1, Scalar::Null))
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Self::Value, E> {
        Ok(self.0.scalar(self.1, Scalar::Flag(value)))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        Ok(self.0.scalar(self.1, Scalar::Number(value as f64)))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
        Ok(self.0.scalar(self.1, Scalar::Number(value as f64)))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(self.0.scalar(self.1, Scalar::Number(value)))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Self::Value, E> {
        Ok(self.0.scalar(self.1, Scalar::Text(value)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<Self::Value, A::Error> {
        self.0.list(self.1, items)
    }

    fn visit_map<A: MapAccess<'de>>(self, entries: A) -> Result<Self::Value, A::Error> {
        self.0.object(self.1, entries)
    }
}

/// A finite number.
#[derive(Clone, Copy)]
pub(super) struct Number;

impl Shape<'_> for Number {
    type Value = f64;
    const EXPECTED: &'static str = "a finite number";

    fn scalar(self, context: &mut Context, scalar: Scalar<'_>) -> Option<f64> {
        match scalar {
            Scalar::Number(number) if number.is_finite() => Some(number),
            other => {
                context.wrong(other, Self::EXPECTED);
                None
            }
        }
    }
}

/// A whole number.
#[derive(Clone, Copy)]
pub(super) struct Whole;

impl Shape<'_> for Whole {
    type Value = i64;
    const EXPECTED: &'static str = "a whole number";

    fn scalar(self, context: &mut Context, scalar: Scalar<'_>) -> Option<i64> {
        const EXACT: f64 = 9e15;
        match scalar {
            Scalar::Number(number) if number.fract() == 0.0 && number.abs() <= EXACT => Some(number as i64),
            other => {
                context.wrong(other, Self::EXPECTED);
                None
            }
        }
    }
}

/// A frame number.
#[derive(Clone, Copy)]
pub(super) struct Frame;

impl Shape<'_> for Frame {
    type Value = FrameNumber;
    const EXPECTED: &'static str = "a frame number";

    fn scalar(self, context: &mut Context, scalar: Scalar<'_>) -> Option<FrameNumber> {
        let limit = super::schema::MAX_FRAME_NUMBER as f64;
        match scalar {
            Scalar::Number(number) if number.fract() == 0.0 && number.abs() <= limit => Some(number as FrameNumber),
            other => {
                context.wrong(other, Self::EXPECTED);
                None
            }
        }
    }
}

/// `true` or `false`.
#[derive(Clone, Copy)]
pub(super) struct Flag;

impl Shape<'_> for Flag {
    type Value = bool;
    const EXPECTED: &'static str = "true or false";

    fn scalar(self, context: &mut Context, scalar: Scalar<'_>) -> Option<bool> {
        match scalar {
            Scalar::Flag(flag) => Some(flag),
            other => {
                context.wrong(other, Self::EXPECTED);
                None
            }
        }
    }
}

/// A text.
#[derive(Clone, Copy)]
pub(super) struct Text;

impl Shape<'_> for Text {
    type Value = String;
    const EXPECTED: &'static str = "a text";

    fn scalar(self, context: &mut Context, scalar: Scalar<'_>) -> Option<String> {
        match scalar {
            Scalar::Text(text) => Some(text.to_owned()),
            other => {
                context.wrong(other, Self::EXPECTED);
                None
            }
        }
    }
}

/// A point `[x, y]`.
#[derive(Clone, Copy)]
pub(super) struct Pair;

impl<'de> Shape<'de> for Pair {
    type Value = Point;
    const EXPECTED: &'static str = "a point [x, y]";

    fn list<A: SeqAccess<'de>>(self, context: &mut Context, mut items: A) -> Result<Option<Point>, A::Error> {
        let mut values = [0.0; 2];
        let mut count = 0;
        loop {
            let step = Step::Index(count);
            let Some(value) = context.within(step, |inner| items.next_element_seed(Seed(Number, inner)))? else {
                break;
            };
            if let (Some(slot), Some(value)) = (values.get_mut(count), value) {
                *slot = value;
            }
            count += 1;
        }
        if count != 2 {
            context.wrong(format_args!("a list of {count}"), Self::EXPECTED);
            return Ok(None);
        }
        Ok(Some(values.into()))
    }
}

/// The first and the last frame of a range, `[first, last]`.
#[derive(Clone, Copy)]
pub(super) struct FrameRange;

impl<'de> Shape<'de> for FrameRange {
    type Value = [FrameNumber; 2];
    const EXPECTED: &'static str = "the first and the last frame of a range, [first, last]";

    fn list<A: SeqAccess<'de>>(self, context: &mut Context, items: A) -> Result<Option<Self::Value>, A::Error> {
        let Some(frames) = List(Frame).list(context, items)? else { return Ok(None) };
        match frames[..] {
            [first, last] if first <= last => Ok(Some([first, last])),
            [first, last] => {
                context.wrong(format_args!("frames {first} to {last}"), "a first frame that is not after the last");
                Ok(None)
            }
            _ => {
                context.wrong(format_args!("a list of {}", frames.len()), Self::EXPECTED);
                Ok(None)
            }
        }
    }
}

/// A list. An element that does not fit becomes the default, so the length is preserved.
#[derive(Clone, Copy)]
pub(super) struct List<S>(pub S);

impl<'de, S: Shape<'de, Value: Default> + Copy> Shape<'de> for List<S> {
    type Value = Vec<S::Value>;
    const EXPECTED: &'static str = "a list";

    fn list<A: SeqAccess<'de>>(self, context: &mut Context, mut items: A) -> Result<Option<Self::Value>, A::Error> {
        let mut list = Vec::new();
        while let Some(item) =
            context.within(Step::Index(list.len()), |inner| items.next_element_seed(Seed(self.0, inner)))?
        {
            list.push(item.unwrap_or_default());
        }
        list.shrink_to_fit();
        Ok(Some(list))
    }
}

/// Numbers that are keys of an object.
pub(super) trait EntryNumber: Ord + Copy + fmt::Display + std::str::FromStr {
    /// Description of the expected key, for messages.
    const EXPECTED: &'static str;
    /// The number as a step of a path.
    fn step(self) -> Step;
}

impl EntryNumber for FrameNumber {
    const EXPECTED: &'static str = "a frame number such as \"11\"";

    fn step(self) -> Step {
        Step::Entry(self.into())
    }
}

impl EntryNumber for usize {
    const EXPECTED: &'static str = "the index of a point such as \"3\"";

    fn step(self) -> Step {
        Step::Entry(self as i64)
    }
}

/// An object whose keys are numbers in quotes.
pub(super) struct Entries<N, S>(pub S, std::marker::PhantomData<N>);

impl<N, S> Entries<N, S> {
    /// Entries of the given shape.
    pub fn new(shape: S) -> Self {
        Self(shape, std::marker::PhantomData)
    }
}

impl<N, S: Copy> Clone for Entries<N, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<N, S: Copy> Copy for Entries<N, S> {}

impl<'de, N: EntryNumber, S: Shape<'de, Value: Default> + Copy> Shape<'de> for Entries<N, S> {
    type Value = BTreeMap<N, S::Value>;
    const EXPECTED: &'static str = "an object";

    fn object<A: MapAccess<'de>>(self, context: &mut Context, mut entries: A) -> Result<Option<Self::Value>, A::Error> {
        let mut map = BTreeMap::new();
        while let Some(key) = entries.next_key::<String>()? {
            // Other spellings of a number ("+1", "01") would give two keys for one frame.
            let Some(number) = key.parse::<N>().ok().filter(|number| number.to_string() == key) else {
                entries.next_value::<IgnoredAny>()?;
                context.wrong(format_args!("the key {}", key_text(&key)), N::EXPECTED);
                continue;
            };
            let value = context.within(number.step(), |inner| {
                let value = entries.next_value_seed(Seed(self.0, inner))?;
                if map.contains_key(&number) {
                    inner.error("found twice, expected once".to_owned());
                }
                Ok(value)
            })?;
            map.insert(number, value.unwrap_or_default());
        }
        Ok(Some(map))
    }
}

fn key_text(key: &str) -> String {
    format!("{:?}", key.chars().take(40).collect::<String>())
}
