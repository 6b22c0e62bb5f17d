//! Numbers of a Nuke script, still or animated.
//!
//! A number is decimal, or an `x` with the hexadecimal digits of a 32-bit float. In place of a number there may be a list of
//! keys, each with a frame and a value; what follows in a key (slopes, interpolation) is not read. A list may also begin
//! with an expression, `{=parent.size x41200000}`; its value is known to Nuke alone.

use super::super::ImportError;
use super::super::limits::FARTHEST;
use super::words::{Item, wrong};

/// Why there is no shape.
pub(super) enum Fault {
    /// The shape is left out; the reason follows "the shape … is left out: ".
    Omitted(String),
    /// The file is wrong.
    Wrong(ImportError),
}

impl From<ImportError> for Fault {
    fn from(error: ImportError) -> Self {
        Self::Wrong(error)
    }
}

/// A number with its keys in the order of time: frames and values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Channel {
    keys: Vec<(f64, f64)>,
    animated: bool,
}

impl Channel {
    /// A number that does not change.
    pub(super) fn constant(value: f64) -> Self {
        Self { keys: vec![(0.0, value)], animated: false }
    }

    /// Reads a number of a list called `element`.
    pub(super) fn read(text: &str, item: &Item, element: &str) -> Result<Self, Fault> {
        if item.word().is_some() {
            return Ok(Self::constant(number(text, item, element)?));
        }
        if item.name().is_some_and(|first| first.starts_with('=')) {
            return Err(Fault::Omitted("it has an expression, whose values are known to Nuke alone".into()));
        }
        let key = |key: &Item| match key.items() {
            [time, value, ..] => Ok((number(text, time, element)?, number(text, value, element)?)),
            _ => Err(wrong(text, key.start, element, "found no key, expected {frame value}")),
        };
        let mut keys = item.items().iter().map(key).collect::<Result<Vec<_>, _>>()?;
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        if keys.is_empty() {
            return Err(wrong(text, item.start, element, "found no number, expected one or keys").into());
        }
        Ok(Self { keys, animated: true })
    }

    /// The frames of the keys; none for a plain number.
    pub(super) fn frames(&self) -> impl Iterator<Item = f64> + '_ {
        self.keys.iter().filter(|_| self.animated).map(|key| key.0)
    }

    /// Whether every key has this value.
    pub(super) fn is(&self, value: f64) -> bool {
        /// A difference that comes from 32-bit floats.
        const ROUNDING: f64 = 1e-6;
        self.keys.iter().all(|key| (key.1 - value).abs() <= ROUNDING)
    }

    /// The value on a frame: linear between keys.
    pub(super) fn at(&self, frame: f64) -> f64 {
        let after = self.keys.partition_point(|key| key.0 < frame);
        match (after.checked_sub(1).map(|k| self.keys[k]), self.keys.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (frame - a.0) / (b.0 - a.0),
            (Some(key), None) | (None, Some(&key)) => key.1,
            (None, None) => 0.0,
        }
    }
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
