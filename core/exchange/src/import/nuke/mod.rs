//! Shapes of Nuke's Roto and RotoPaint nodes (`.nk`), and of nodes copied from a script.
//!
//! A `curvegroup` has a name, flags and a type. Its first curve is the shape, the second one its feather. A curve's points
//! are three pairs of numbers: the handle before the point, the point, the handle after it. A number is decimal, or an `x`
//! with the hexadecimal digits of a 32-bit float. It may be a list of keys, each with a frame and a value. A list `px`
//! begins with the frame of its points. Coordinates are pixels with y up.
//!
//! - A shape has keys on the frames on which any of its numbers has one. Between keys numbers are taken as linear.
//! - Flag 8192 of a curve: handles are relative to their points. Flag 32: the curve is open.
//! - Shapes and layers that are moved, turned or scaled by a transformation, and B-splines, are left out with a warning,
//!   since they would be in the wrong place. Feather, opacity and brush strokes are ignored.
//!
//! Source: Foundry, Nuke Developer Kit, "Roto serialisation format"; scripts of Nuke 7 to 13 in public repositories.

mod words;

use super::limits::{FARTHEST, MOST_POINTS};
use super::names::Names;
use super::path::{Path, contours};
use super::{ImportError, Shape, Shapes};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};
use std::collections::{BTreeMap, BTreeSet};
use words::{Item, items, place, wrong};

/// Flag of a curve: handles are relative to their points.
const RELATIVE_HANDLES: u32 = 8192;
/// Flag of a curve: the last point does not join the first.
const OPEN: u32 = 32;
/// A difference of a transformation from none that is rounding.
const ROUNDING: f64 = 1e-6;

/// Reads the shapes of a script for footage. Shapes that are not animated get their key on frame `still`.
///
/// # Errors
///
/// An [`ImportError`] names the list and its place.
pub fn nuke(text: &str, footage: &Footage, still: FrameNumber) -> Result<Shapes, ImportError> {
    let mut reader =
        Reader { text, footage, still, names: Names::default(), left: MOST_POINTS, found: Shapes::default() };
    for item in items(text)? {
        reader.walk(&item, true)?;
    }
    if reader.found.shapes.is_empty() && reader.found.warnings.is_empty() {
        return Err(ImportError::Nothing("a curvegroup of a Roto or RotoPaint node"));
    }
    // The nearest shape comes first in the file.
    reader.found.shapes.reverse();
    Ok(reader.found)
}

struct Reader<'a> {
    text: &'a str,
    footage: &'a Footage,
    still: FrameNumber,
    names: Names,
    /// Points that the file may still have.
    left: usize,
    found: Shapes,
}

/// A number with its keys.
type Channel = Vec<(f64, f64)>;

impl Reader<'_> {
    /// Reads the shapes in an item. `straight` says that no layer around it has a transformation.
    fn walk(&mut self, item: &Item, straight: bool) -> Result<(), ImportError> {
        match item.name() {
            Some("curvegroup") => self.group(item, straight),
            Some("layer") => {
                let straight = straight && !transformed(item);
                item.items().iter().try_for_each(|item| self.walk(item, straight))
            }
            _ => item.items().iter().try_for_each(|item| self.walk(item, straight)),
        }
    }

    fn warn(&mut self, item: &Item, reason: String) {
        self.found.warnings.push(format!("{}: {reason}", place(self.text, item.start)));
    }

    fn wrong(&self, item: &Item, element: &str, message: impl Into<String>) -> ImportError {
        wrong(self.text, item.start, element, message)
    }

    fn group(&mut self, item: &Item, straight: bool) -> Result<(), ImportError> {
        let [_, name, _, kind, curves, ..] = item.items() else {
            return Err(self.wrong(item, "curvegroup", "found too few items, expected name, flags, type and curves"));
        };
        let name = name.word().unwrap_or_default();
        let kind = kind.word().unwrap_or_default();
        if kind != "bezier" {
            self.warn(item, format!("the shape {name:?} is left out: found type {kind:?}, expected bezier"));
            return Ok(());
        }
        if !straight || transformed(item) {
            self.warn(item, format!("the shape {name:?} is left out, because it or its layer has a transformation"));
            return Ok(());
        }
        let curve = curves.items().iter().find(|curve| curve.name() == Some("cc"));
        let curve = curve.ok_or_else(|| self.wrong(item, "curvegroup", "found no curve, expected {cc …}"))?;
        self.shape(curve, name)
    }

    fn shape(&mut self, curve: &Item, name: &str) -> Result<(), ImportError> {
        let list =
            |names: &[&str]| curve.items().iter().find(|list| list.name().is_some_and(|own| names.contains(&own)));
        let flags = list(&["f"]).and_then(|flags| flags.items().get(1)).and_then(Item::word);
        let flags = flags.and_then(|flags| flags.parse::<u32>().ok()).unwrap_or(RELATIVE_HANDLES);
        let points = list(&["p", "px"]).ok_or_else(|| self.wrong(curve, "cc", "found no points, expected {p …}"))?;
        let timed = points.name() == Some("px");
        let time = if timed { points.items().get(1) } else { None };
        let time = time.map(|time| self.number(time)).transpose()?;
        let pairs = &points.items()[if timed { 2 } else { 1 }.min(points.items().len())..];
        if pairs.len() < 6 || !pairs.len().is_multiple_of(3) {
            let found = pairs.len();
            let message =
                format!("{name:?}: found {found} pairs of numbers, expected three for each of at least two points");
            return Err(self.wrong(points, "p", message));
        }
        let channels = pairs.iter().map(|pair| self.pair(pair)).collect::<Result<Vec<_>, _>>()?;
        let frames = self.frames(&channels, time, points)?;
        let closed = flags & OPEN == 0;
        let paths: Vec<Path> = frames
            .iter()
            .map(|frame| self.path(&channels, f64::from(*frame), closed, flags & RELATIVE_HANDLES != 0))
            .collect();
        let left = &mut self.left;
        let made = contours(&paths, |count| match left.checked_sub(count) {
            Some(rest) => {
                *left = rest;
                Ok(())
            }
            None => Err(()),
        });
        let Ok(made) = made else {
            return Err(self.wrong(
                points,
                "p",
                format!("found more than {MOST_POINTS} points up to here, expected fewer"),
            ));
        };
        let keys: BTreeMap<_, _> = frames.into_iter().zip(made).collect();
        self.found.shapes.push(Shape { name: self.names.free(name), closed, keys });
        Ok(())
    }

    /// The frames on which any number has a key; the one of the points, or `still`, if none has.
    fn frames(
        &self,
        channels: &[[Channel; 2]],
        time: Option<f64>,
        at: &Item,
    ) -> Result<BTreeSet<FrameNumber>, ImportError> {
        let keys = channels.iter().flatten().filter(|channel| channel.len() > 1 || channel[0].0.is_finite());
        let mut times: BTreeSet<FrameNumber> = BTreeSet::new();
        let own: Vec<f64> = keys.flatten().map(|key| key.0).chain(time).filter(|time| time.is_finite()).collect();
        for time in own {
            let frame = time.round();
            let (first, last) = (self.footage.first, self.footage.last);
            if !(f64::from(first)..=f64::from(last)).contains(&frame) {
                let message =
                    format!("found a key on frame {time}, expected a frame of the footage, {first} to {last}");
                return Err(self.wrong(at, "p", message));
            }
            times.insert(frame as FrameNumber);
        }
        if times.is_empty() {
            times.insert(self.still);
        }
        Ok(times)
    }

    fn pair(&self, item: &Item) -> Result<[Channel; 2], ImportError> {
        let [x, y, ..] = item.items() else {
            return Err(self.wrong(item, "p", "found no pair of numbers, expected {x y}"));
        };
        Ok([self.channel(x)?, self.channel(y)?])
    }

    /// A number: one key at no time, or keys in the order of time.
    fn channel(&self, item: &Item) -> Result<Channel, ImportError> {
        if item.word().is_some() {
            return Ok(vec![(f64::NAN, self.number(item)?)]);
        }
        let key = |key: &Item| match key.items() {
            [time, value, ..] => Ok((self.number(time)?, self.number(value)?)),
            _ => Err(self.wrong(key, "p", "found no key, expected {frame value}")),
        };
        let mut keys = item.items().iter().map(key).collect::<Result<Channel, _>>()?;
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        if keys.is_empty() {
            return Err(self.wrong(item, "p", "found no number, expected one or keys"));
        }
        Ok(keys)
    }

    fn number(&self, item: &Item) -> Result<f64, ImportError> {
        let value = item.word().and_then(value).filter(|value| value.abs() <= FARTHEST);
        value.ok_or_else(|| {
            let found = item.word().unwrap_or("a list");
            self.wrong(item, "p", format!("found {found:.40}, expected a number of at most {FARTHEST:e}"))
        })
    }

    /// The path on a frame, in pixels of the footage.
    fn path(&self, channels: &[[Channel; 2]], frame: f64, closed: bool, relative: bool) -> Path {
        let height = self.footage.height as f64;
        let raw = |pair: &[Channel; 2]| Point::new(at(&pair[0], frame), at(&pair[1], frame));
        let knots: Vec<[Point; 3]> = channels
            .as_chunks::<3>()
            .0
            .iter()
            .map(|[before, own, after]| {
                let own = raw(own);
                let handle = |pair| if relative { own + raw(pair) } else { raw(pair) };
                [handle(before), own, handle(after)].map(|p| Point::new(p.x, height - p.y))
            })
            .collect();
        let mut path = Path::new(knots[0][1]);
        for pair in knots.windows(2) {
            path.cubic(pair[0][2], pair[1][0], pair[1][1]);
        }
        if let (true, [first, .., last]) = (closed, &knots[..]) {
            path.cubic(last[2], first[0], first[1]);
        }
        path.closed = closed;
        path
    }
}

/// The value of a channel on a frame: linear between keys.
fn at(channel: &Channel, frame: f64) -> f64 {
    let after = channel.partition_point(|key| key.0 < frame);
    match (after.checked_sub(1).map(|k| channel[k]), channel.get(after)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (frame - a.0) / (b.0 - a.0),
        (Some(key), None) | (None, Some(&key)) => key.1,
        (None, None) => 0.0,
    }
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

/// Whether a shape or a layer has a transformation: its list `t` has, after the three numbers of the centre, three of the
/// translation, three of the rotation and three of the scale. A shorter list has the centre only.
fn transformed(item: &Item) -> bool {
    let Some(list) = item.items().iter().find(|list| list.name() == Some("t")) else { return false };
    let numbers = &list.items()[1..];
    let differs = |number: &Item, wanted: f64| {
        let other = |word: &str| value(word).is_none_or(|found| (found - wanted).abs() > ROUNDING);
        match number.word() {
            Some(word) => other(word),
            None => number.items().iter().any(|key| key.items().get(1).and_then(Item::word).is_none_or(other)),
        }
    };
    let moved = numbers.iter().skip(3).take(6).any(|number| differs(number, 0.0));
    moved || numbers.iter().skip(9).take(3).any(|number| differs(number, 1.0))
}

#[cfg(test)]
mod tests;
