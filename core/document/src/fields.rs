//! Reads fields of JSON values beside the scene of a document. Errors name a field by its JSON path.

use super::schema::{MAX_COORDINATE, MAX_FRAME_NUMBER};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, FrameNumber};
use serde_json::{Map, Value};

/// An invalid field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: found {found}, expected {expected}")]
pub struct FieldError {
    /// JSON path of the field.
    pub place: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

/// An error from its three texts.
pub(super) fn wrong(place: &str, found: &str, expected: &str) -> FieldError {
    FieldError { place: place.into(), found: found.into(), expected: expected.into() }
}

/// A short description of a value, for messages.
pub fn described(value: Option<&Value>) -> String {
    match value {
        None => "nothing".into(),
        Some(Value::Object(_)) => "an object".into(),
        Some(Value::Array(list)) if list.len() > 3 => format!("a list of {}", list.len()),
        Some(other) => {
            let text = other.to_string();
            if text.chars().count() > 40 { text.chars().take(40).chain(['…']).collect() } else { text }
        }
    }
}

/// Reads an object.
pub(super) fn object<'a>(value: &'a Value, place: &str) -> Result<&'a Map<String, Value>, FieldError> {
    value.as_object().ok_or_else(|| wrong(place, &described(Some(value)), "an object"))
}

/// Reads a list.
pub(super) fn array<'a>(value: Option<&'a Value>, place: &str) -> Result<&'a Vec<Value>, FieldError> {
    value.and_then(Value::as_array).ok_or_else(|| wrong(place, &described(value), "a list"))
}

/// Reads true or false.
pub(super) fn flag(value: Option<&Value>, place: &str) -> Result<bool, FieldError> {
    value.and_then(Value::as_bool).ok_or_else(|| wrong(place, &described(value), "true or false"))
}

/// Reads a number.
pub(super) fn number(value: Option<&Value>, place: &str) -> Result<f64, FieldError> {
    value.and_then(Value::as_f64).ok_or_else(|| wrong(place, &described(value), "a number"))
}

/// Reads a colour: a list of three channels, each read by `channel`.
pub(super) fn colour(
    value: Option<&Value>,
    place: &str,
    channel: impl Fn(Option<&Value>, &str) -> Result<f64, FieldError>,
) -> Result<Colour, FieldError> {
    let list = array(value, place)?;
    if list.len() != 3 {
        return Err(wrong(place, &format!("a list of {}", list.len()), "a list of 3"));
    }
    let mut colour = [0.0; 3];
    for (k, value) in colour.iter_mut().enumerate() {
        *value = channel(list.get(k), &format!("{place}[{k}]"))? as f32;
    }
    Ok(colour)
}

/// Reads a number from 0 to 1.
pub(super) fn share(value: Option<&Value>, place: &str) -> Result<f64, FieldError> {
    let found = number(value, place)?;
    match (0.0..=1.0).contains(&found) {
        true => Ok(found),
        false => Err(wrong(place, &found.to_string(), "a number from 0 to 1")),
    }
}

/// Reads a whole number of at least 0.
pub(super) fn count<T: TryFrom<u64>>(value: Option<&Value>, place: &str) -> Result<T, FieldError> {
    let number = value.and_then(Value::as_u64).and_then(|n| T::try_from(n).ok());
    number.ok_or_else(|| wrong(place, &described(value), "a whole number from 0 on"))
}

/// Reads a frame number.
pub(super) fn frame(value: Option<&Value>, place: &str) -> Result<FrameNumber, FieldError> {
    let number = value.and_then(Value::as_i64).filter(|n| n.abs() <= MAX_FRAME_NUMBER);
    let number = number.and_then(|n| FrameNumber::try_from(n).ok());
    number.ok_or_else(|| wrong(place, &described(value), "a frame number"))
}

/// Reads a point whose coordinates are within the limits.
pub(super) fn point(value: Option<&Value>, place: &str) -> Result<Point, FieldError> {
    let pair = value.and_then(Value::as_array).filter(|pair| pair.len() == 2);
    let point = pair.and_then(|pair| Some(Point::new(pair[0].as_f64()?, pair[1].as_f64()?)));
    let fits = |p: &Point| p.abs().max_element() <= MAX_COORDINATE;
    let expected = "a point [x, y] of numbers between -1e6 and 1e6";
    point.filter(fits).ok_or_else(|| wrong(place, &described(value), expected))
}

/// Reads a list with an entry for each frame; the frames rise. `name` is the list's and `content` that of an entry's own list.
/// `read` gets the frame, that list and its place.
pub(super) fn by_frame<T>(
    list: &[Value],
    [name, content]: [&str; 2],
    read: impl Fn(FrameNumber, &[Value], &str) -> Result<T, FieldError>,
) -> Result<Vec<T>, FieldError> {
    let mut out = Vec::new();
    let mut last: Option<FrameNumber> = None;
    for (k, value) in list.iter().enumerate() {
        let place = format!("{name}[{k}]");
        let fields = object(value, &place)?;
        let on = frame(fields.get("frame"), &format!("{place}.frame"))?;
        if let Some(last) = last.filter(|&last| last >= on) {
            let expected = format!("more than {last}, that of {name}[{}]", k - 1);
            return Err(wrong(&format!("{place}.frame"), &on.to_string(), &expected));
        }
        last = Some(on);
        let place = format!("{place} (frame {on}).{content}");
        out.push(read(on, array(fields.get(content), &place)?, &place)?);
    }
    Ok(out)
}

/// Reads an optional field.
pub(super) fn given<T>(
    fields: &Map<String, Value>,
    place: &str,
    name: &str,
    read: impl Fn(Option<&Value>, &str) -> Result<T, FieldError>,
) -> Result<Option<T>, FieldError> {
    fields.get(name).map(|value| read(Some(value), &format!("{place}.{name}"))).transpose()
}
