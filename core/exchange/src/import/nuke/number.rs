//! Numbers of a Nuke script, still or animated.
//!
//! A number is decimal, or an `x` with the hexadecimal digits of a 32-bit float. In place of a number there may be a list of
//! keys, each with a frame and a value; what follows in a key (slopes, interpolation) is not read. A list may also begin
//! with an expression, `{=parent.size x41200000}`; its value is known to Nuke alone.

use super::super::channel::Channel;
use super::super::limits::FARTHEST;
use super::super::problem::{Fault, ImportError};
use super::words::{Item, wrong};

/// Reads a number of a list called `element`, still or animated.
pub(super) fn channel(text: &str, item: &Item, element: &str) -> Result<Channel, Fault> {
    if item.word().is_some() {
        return Ok(Channel::constant(number(text, item, element)?));
    }
    if item.name().is_some_and(|first| first.starts_with('=')) {
        return Err(Fault::Omitted("it has an expression, whose values are known to Nuke alone".into()));
    }
    let key = |key: &Item| match key.items() {
        [time, value, ..] => Ok((number(text, time, element)?, number(text, value, element)?)),
        _ => Err(wrong(text, key.start, element, "found no key, expected {frame value}")),
    };
    let keys = item.items().iter().map(key).collect::<Result<Vec<_>, _>>()?;
    let empty = || wrong(text, item.start, element, "found no number, expected one or keys").into();
    Channel::keyed(keys).ok_or_else(empty)
}

/// A plain number.
pub(super) fn number(text: &str, item: &Item, element: &str) -> Result<f64, ImportError> {
    let found = item.word().and_then(value).filter(|value| value.abs() <= FARTHEST);
    found.ok_or_else(|| {
        let found = item.word().unwrap_or("a list");
        wrong(text, item.start, element, format!("found {found:.40}, expected a number of at most {FARTHEST:e}"))
    })
}

/// A number as Nuke writes it. Letters after a hexadecimal number, such as those of interpolation, are left out.
fn value(word: &str) -> Option<f64> {
    let value = match word.strip_prefix('x') {
        Some(digits) => {
            let digits = digits.split('+').next().unwrap_or(digits);
            f64::from(f32::from_bits(u32::from_str_radix(digits, 16).ok()?))
        }
        None => word.parse().ok()?,
    };
    value.is_finite().then_some(value)
}
