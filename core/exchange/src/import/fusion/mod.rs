//! Shapes of Fusion and of the Fusion page of Resolve (`.setting`, `.comp`, and what these programs put on the clipboard).
//!
//! A Polygon mask (`PolylineMask`) has an input `Polyline`: the shape itself, or the name of a `BezierSpline`. Each key of the spline has
//! a number and a shape. The number counts the keys; between two of them it says how far the one shape has become the other. A `MultiPoly` has
//! several polygons, whose inputs begin with their names (`PolyMask1.Polyline`).
//!
//! Coordinates begin in the middle of the picture, x to the right and y up; their unit is its width for x, and its height for y.
//! Handles (`LX`, `LY`, `RX`, `RY`) are relative to their points.
//!
//! - Where a spline goes evenly from key to key, the shape gets keys there. Where it does not, it gets one on every frame between them
//!   (`timing`).
//! - Keys beyond the footage are left out (`range`).
//! - A shape is hidden where its `Level` is 0; other levels are ignored, as are soft edges and border widths.
//! - Masks that are inverted, or not added to those before them, come in as they are drawn, with a warning.
//! - Left out with a warning that names the shape, since its place or form would be wrong: B-splines (how they end is not public), other
//!   kinds of masks, masks that are moved, scaled or turned as a whole, and inputs by other means than a spline.
//!
//! Source: the makers have not published the format. This module reads what saved settings of Fusion and Resolve show.

mod table;
mod timing;

use super::channel::Channel;
use super::limits::{FARTHEST, MOST_POINTS};
use super::names::Names;
use super::nuke::{place, wrong};
use super::path::{NoContours, Path, contours};
use super::problem::Fault;
use super::range::{Kept, Reach};
use super::{ImportError, Shape, Shapes};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};
use std::collections::{BTreeMap, BTreeSet};
use table::{Name, Value};
use timing::{Key, Timing};

/// Kinds of masks that are no polygons.
const OTHERS: [&str; 8] = [
    "BSplineMask",
    "RectangleMask",
    "EllipseMask",
    "TriangleMask",
    "BitmapMask",
    "WandMask",
    "RangesMask",
    "PaintMask",
];
/// Inputs that move a mask as a whole, with what they are if they do nothing.
const PLACING: [(&str, &[f64]); 6] = [
    ("Center", &[0.5, 0.5]),
    ("Size", &[1.0]),
    ("XRotation", &[0.0]),
    ("YRotation", &[0.0]),
    ("ZRotation", &[0.0]),
    ("Angle", &[0.0]),
];

/// Reads the polygons of a setting for footage. Those that are not animated get their key on frame `still`.
///
/// # Errors
///
/// An [`ImportError`] names the table and its place.
pub fn fusion(text: &str, footage: &Footage, still: FrameNumber) -> Result<Shapes, ImportError> {
    let root = table::value(text)?;
    let mut splines = BTreeMap::new();
    collect(&root, &mut splines);
    let mut reader = Reader {
        text,
        footage,
        still,
        splines,
        names: Names::default(),
        left: MOST_POINTS,
        found: Shapes::default(),
        reach: Reach::new(),
    };
    reader.walk(&root, "")?;
    reader.reach.check().map_err(|error| ImportError::Beyond(Box::new(error)))?;
    if reader.found.shapes.is_empty() && reader.found.warnings.is_empty() {
        return Err(ImportError::Nothing("a PolylineMask"));
    }
    reader.names.settle(&mut reader.found.shapes);
    // The nearest shape comes first in the file.
    reader.found.shapes.reverse();
    Ok(reader.found)
}

/// Finds the splines of a file by their names.
fn collect<'a, 'b>(value: &'b Value<'a>, splines: &mut BTreeMap<&'a str, &'b Value<'a>>) {
    for (name, own) in value.fields() {
        match (name, own.word()) {
            (Name::Word(name), "BezierSpline") => drop(splines.insert(name, own)),
            _ => collect(own, splines),
        }
    }
}

struct Reader<'a, 'b> {
    text: &'a str,
    footage: &'a Footage,
    still: FrameNumber,
    splines: BTreeMap<&'a str, &'b Value<'a>>,
    names: Names,
    /// Points that the file may still have.
    left: usize,
    found: Shapes,
    reach: Reach<ImportError>,
}

/// A polygon of a mask.
struct Mask<'a, 'b> {
    name: String,
    value: &'b Value<'a>,
    inputs: &'b Value<'a>,
    /// What stands before the names of its inputs.
    prefix: String,
}

impl<'a, 'b> Mask<'a, 'b> {
    fn input(&self, name: &str) -> Option<&'b Value<'a>> {
        self.inputs.get(&format!("{}{name}", self.prefix))
    }
}

/// A polygon on a key.
struct Form {
    /// Points with the handles after and before them, in pixels of the footage.
    knots: Vec<[Point; 3]>,
    closed: bool,
}

impl<'a, 'b> Reader<'a, 'b> {
    /// Reads the masks in a table.
    fn walk(&mut self, value: &'b Value<'a>, name: &'a str) -> Result<(), ImportError> {
        let word = value.word();
        if word == "PolylineMask" || word == "MultiPoly" {
            return self.mask(value, name);
        }
        if OTHERS.contains(&word) {
            self.leave_out(value, name, &format!("found a {word}, expected a PolylineMask"));
            return Ok(());
        }
        value.fields().iter().try_for_each(|(name, own)| {
            let name = if let Name::Word(name) = name { name } else { "" };
            self.walk(own, name)
        })
    }

    fn leave_out(&mut self, value: &Value, name: &str, reason: &str) {
        let place = place(self.text, value.start);
        self.found.warnings.push(format!("{place}: the shape {name:?} is left out: {reason}"));
    }

    fn mask(&mut self, value: &'b Value<'a>, name: &str) -> Result<(), ImportError> {
        let Some(inputs) = value.get("Inputs") else {
            return Err(wrong(self.text, value.start, value.word(), "found no Inputs, expected them"));
        };
        let prefixes: Vec<&str> = inputs
            .fields()
            .iter()
            .filter_map(|(name, _)| if let Name::Word(name) = name { name.strip_suffix("Polyline") } else { None })
            .collect();
        for prefix in &prefixes {
            let own = prefix.trim_end_matches('.');
            let name = if prefixes.len() > 1 && !own.is_empty() { format!("{name} {own}") } else { name.to_owned() };
            let mask = Mask { name, value, inputs, prefix: (*prefix).to_owned() };
            match self.shape(&mask) {
                Ok(()) => {}
                Err(Fault::Wrong(error)) => return Err(error),
                Err(Fault::Omitted(reason)) => self.leave_out(value, &mask.name, &reason),
            }
        }
        if prefixes.is_empty() {
            self.leave_out(value, name, "found no Polyline among its inputs, expected one");
        }
        Ok(())
    }

    fn shape(&mut self, mask: &Mask<'a, 'b>) -> Result<(), Fault> {
        self.check_place(mask)?;
        let (forms, timing) = self.forms(mask)?;
        let frames = self.frames(mask, &timing);
        let kind = |form: &Form| (form.knots.len(), form.closed);
        if let Some(other) = forms.iter().find(|form| kind(form) != kind(&forms[0])) {
            let (first, other) = (forms[0].knots.len(), other.knots.len());
            return Err(Fault::Omitted(format!(
                "found keys of {first} and {other} points, expected the same number and kind on each"
            )));
        }
        let paths: Vec<Path> = forms.iter().map(|form| Path::through(&form.knots, form.closed)).collect();
        let placed = |frame: FrameNumber| {
            let (before, after, share) = timing.at(frame.into());
            let mut path = paths[before].clone();
            if share != 0.0 {
                path.go(&paths[after], share);
            }
            path
        };
        let full = || {
            let message = format!("found more than {MOST_POINTS} points up to here, expected fewer");
            Fault::Wrong(wrong(self.text, mask.value.start, mask.value.word(), message))
        };
        if forms[0].knots.len().saturating_mul(frames.len()) > self.left {
            return Err(full());
        }
        let paths: Vec<Path> = frames.iter().map(|&frame| placed(frame)).collect();
        let mut left = self.left;
        let made = contours(&paths, |count| {
            left = left.checked_sub(count).ok_or(())?;
            Ok::<_, ()>(())
        });
        let made = made.map_err(|error| match error {
            NoContours::Refused(()) => full(),
            NoContours::Unequal => Fault::Omitted("its keys are of several kinds".into()),
        })?;
        self.left = left;
        let keyed = timing.frames().next().is_some();
        self.add(mask, [forms[0].closed, keyed], frames.into_iter().zip(made).collect())
    }

    /// Adds a shape with these keys, which stand on frames or do not.
    fn add(
        &mut self,
        mask: &Mask<'a, 'b>,
        [closed, keyed]: [bool; 2],
        keys: BTreeMap<FrameNumber, Vec<Point>>,
    ) -> Result<(), Fault> {
        let level = self.level(mask);
        let at = place(self.text, mask.value.start);
        let name = &mask.name;
        if let Some(lost) = lost(mask) {
            self.found.warnings.push(format!("{at}: the shape {name:?} {lost}; it comes in as it is drawn"));
        }
        let hidden = level.map_or(Vec::new(), |level| level.zeros(false));
        let (shape, never) = Shape::new((self.names.free(name), closed), keys, &hidden, self.footage);
        self.found.warnings.extend(never.map(|never| format!("{at}: {never}")));
        self.found.shapes.push(Shape { extent: shape.extent.of_keys(keyed), ..shape });
        Ok(())
    }

    /// Refuses a mask that is moved as a whole.
    fn check_place(&self, mask: &Mask) -> Result<(), Fault> {
        for (name, still) in PLACING {
            let Some(input) = mask.input(name) else { continue };
            let value = input.get("Value");
            let numbers: Vec<f64> = match value.and_then(Value::number) {
                Some(number) => vec![number],
                None => value.into_iter().flat_map(Value::listed).filter_map(Value::number).collect(),
            };
            if numbers != *still {
                return Err(Fault::Omitted(format!("its {name} is set, expected a mask that is not moved as a whole")));
            }
        }
        Ok(())
    }

    /// The spline that an input is connected to; `None` if it has a value of its own.
    fn spline(&self, input: &Value) -> Result<Option<&'b Value<'a>>, Fault> {
        if input.get("Expression").is_some() {
            return Err(Fault::Omitted("found an expression, expected a shape or a spline".into()));
        }
        let Some(source) = input.get("SourceOp").and_then(Value::text) else { return Ok(None) };
        let found = self.splines.get(source).copied();
        found.map(Some).ok_or_else(|| {
            Fault::Omitted(format!("its shape comes from {source:.80?}, expected a BezierSpline of the file"))
        })
    }

    /// The polygons of the keys, and when they are shown.
    fn forms(&self, mask: &Mask<'a, 'b>) -> Result<(Vec<Form>, Timing), Fault> {
        let missing = || Fault::Omitted("found no shape in its Polyline, expected one".into());
        let input = mask.input("Polyline").ok_or_else(missing)?;
        let Some(spline) = self.spline(input)? else {
            let form = self.form(input.get("Value").ok_or_else(missing)?)?;
            return Ok((vec![form], Timing::default()));
        };
        let keys = self.keys(spline)?;
        let mut forms = Vec::with_capacity(keys.len());
        for (_, value) in &keys {
            forms.push(self.form(value.get("Value").ok_or_else(missing)?)?);
        }
        if forms.is_empty() {
            return Err(missing());
        }
        Ok((forms, Timing::new(keys.into_iter().map(|(key, _)| key).collect())))
    }

    /// The keys of a spline in the order of time.
    fn keys(&self, spline: &'b Value<'a>) -> Result<Vec<(Key, &'b Value<'a>)>, Fault> {
        let mut keys = Vec::new();
        for (name, value) in spline.get("KeyFrames").map_or(&[][..], Value::fields) {
            let (Name::Number(frame), Some(number)) = (name, value.listed().next().and_then(Value::number)) else {
                let message = "found a key without a frame or a number, expected [frame] = { number }";
                return Err(wrong(self.text, value.start, "BezierSpline", message).into());
            };
            let handle = |side: &str| {
                let pair: Vec<f64> = value.get(side)?.listed().filter_map(Value::number).collect();
                (pair.len() == 2).then(|| [pair[0], pair[1]])
            };
            let flag = |name: &str| value.get("Flags").and_then(|flags| flags.get(name)).is_some_and(Value::is_true);
            let (linear, steps) = (flag("Linear"), [flag("StepIn"), flag("StepOut")]);
            keys.push((Key { frame: *frame, number, linear, handles: [handle("LH"), handle("RH")], steps }, value));
        }
        keys.sort_by(|a, b| a.0.frame.total_cmp(&b.0.frame));
        Ok(keys)
    }

    /// A polygon in pixels of the footage.
    fn form(&self, value: &Value) -> Result<Form, Fault> {
        if value.word() != "Polyline" {
            return Err(Fault::Omitted(format!("found a {:.40?}, expected a Polyline", value.word())));
        }
        let size = Point::new(self.footage.width as f64, self.footage.height as f64) * Point::new(1.0, -1.0);
        let points = value.get("Points").map_or(&[][..], Value::fields);
        let mut knots = Vec::with_capacity(points.len());
        for (_, point) in points {
            let number = |name: &str| point.get(name).and_then(Value::number);
            let (Some(x), Some(y)) = (number("X"), number("Y")) else {
                return Err(self.wrong_point(point, "found no X and Y, expected both").into());
            };
            let vector = |x: &str, y: &str| Point::new(number(x).unwrap_or(0.0), number(y).unwrap_or(0.0));
            let own = Point::new(x, y);
            let knot = [own, own + vector("RX", "RY"), own + vector("LX", "LY")];
            let half = Point::new(0.5, -0.5);
            let knot = knot.map(|p| (p + half) * size);
            if knot.iter().any(|p| p.abs().max_element() > FARTHEST) {
                return Err(self.wrong_point(point, &format!("found a place more than {FARTHEST} pixels away")).into());
            }
            knots.push(knot);
        }
        if knots.len() < 2 {
            return Err(Fault::Omitted(format!("found {} points, expected at least two", knots.len())));
        }
        Ok(Form { knots, closed: value.get("Closed").is_some_and(Value::is_true) })
    }

    fn wrong_point(&self, point: &Value, message: &str) -> ImportError {
        wrong(self.text, point.start, "Polyline", message)
    }

    /// The frames on which a shape gets keys.
    fn frames(&mut self, mask: &Mask, timing: &Timing) -> BTreeSet<FrameNumber> {
        let mut kept = Kept::of(timing.frames(), self.footage);
        let still = timing.frames().next().is_none();
        kept.within |= still;
        let (text, footage, start) = (self.text, self.footage, mask.value.start);
        self.reach.add(&kept, || wrong(text, start, mask.value.word(), kept.refused(footage)));
        self.found
            .warnings
            .extend(kept.told(&mask.name, footage).map(|told| format!("{}: {told}", place(text, start))));
        let mut frames = std::mem::take(&mut kept.frames);
        frames.extend(timing.between([footage.first, footage.last]));
        if frames.is_empty() {
            frames.insert(self.still);
        }
        frames
    }

    /// The size of a mask's level; `None` if it says nothing.
    fn level(&self, mask: &Mask<'a, 'b>) -> Option<Channel> {
        let input = mask.input("Level")?;
        match self.spline(input) {
            Ok(Some(spline)) => {
                let keys = self.keys(spline).ok()?;
                Channel::keyed(keys.into_iter().map(|(key, _)| (key.frame, key.number.abs())).collect())
            }
            Ok(None) => input.get("Value").and_then(Value::number).map(|level| Channel::constant(level.abs())),
            Err(_) => None,
        }
    }
}

/// What a mask does beside adding its area to those before it; `None` for nothing.
fn lost(mask: &Mask) -> Option<String> {
    let value = |name: &str| mask.input(name)?.get("Value");
    let inverted = value("Invert").and_then(Value::number).is_some_and(|number| number != 0.0);
    let mode = value("PaintMode").and_then(|mode| mode.listed().next()).and_then(Value::text);
    let mode =
        mode.filter(|mode| !["Merge", "Add", "Maximum"].contains(mode)).map(|mode| format!("has the mode {mode:.40?}"));
    let taken = value("Level")
        .and_then(Value::number)
        .is_some_and(|level| level < 0.0)
        .then(|| "takes its area away".to_owned());
    let off = mask.value.get("PassThrough").is_some_and(Value::is_true).then(|| "is switched off".to_owned());
    let inverted = inverted.then(|| "is inverted".to_owned());
    let told: Vec<String> = inverted.into_iter().chain(mode).chain(taken).chain(off).collect();
    (!told.is_empty()).then(|| told.join(" and "))
}

#[cfg(test)]
mod tests;
