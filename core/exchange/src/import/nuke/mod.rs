//! Shapes of Nuke's Roto and RotoPaint nodes (`.nk`), and of nodes copied from a script.
//!
//! A `curvegroup` has a name, flags and a type. Its first curve is the shape, the second one its feather. A curve's points
//! are three pairs of numbers: the handle before the point, the point, the handle after it. A number is decimal, or an `x`
//! with the hexadecimal digits of a 32-bit float. It may be a list of keys, each with a frame and a value. A list `px`
//! begins with the frame of its points. Coordinates are pixels with y up, of the node's or the script's `format` (`picture`).
//!
//! - A shape has keys on the frames on which any of its numbers has one. Between keys numbers are taken as linear. Where the points then do
//!   not go straight, since a transformation turns them, there is a key on every frame (`way`).
//! - Keys beyond the footage are left out (`range`).
//! - Flag 8192 of a curve: handles are relative to their points. Flag 32: the curve is open.
//! - A point of a B-spline is one pair, perhaps with a weight after it. The spline is uniform and cubic, and its points are
//!   guides that it does not pass through.
//! - Layers and shapes may have a `transform`, applied here; a shape then also has keys where its transformation has.
//! - Left out with a warning that names the shape, since its place or form would be wrong: open B-splines (how they end is not
//!   public), weights other than 1, expressions, and what `transform` leaves out.
//! - The rate at which a feather falls off is read. A shape is hidden where its opacity (`opc`) is 0, outside of its lifetime
//!   (`attributes`), and where it is invisible (`vis`). One that always is, or whose layer is, is left out.
//! - Shapes that are inverted (`inv`) or not laid over those below (`bm`) come in as they are drawn, with a warning. Other opacities, those of layers, feather and brush strokes are ignored.
//!
//! Source: Foundry, Nuke Developer Kit, "Roto serialisation format"; scripts of Nuke 7 to 13 in public repositories.

mod attributes;
mod number;
mod transform;
mod words;

use super::channel::Channel;
use super::limits::MOST_POINTS;
use super::names::Names;
use super::path::{Path, contours};
use super::picture::{self, Picture};
use super::problem::Fault;
use super::range::{Kept, Reach};
use super::way::add_bent;
use super::{ImportError, Shape, Shapes};
use attributes::attribute;
use glam::DAffine2;
use number::{channel, number};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, Footage, FrameNumber};
use std::collections::{BTreeMap, BTreeSet};
use transform::Transform;
use words::{Item, items};
pub(super) use words::{place, wrong};

/// Flag of a curve: handles are relative to their points.
const RELATIVE_HANDLES: u32 = 8192;
/// Flag of a curve: the last point does not join the first.
const OPEN: u32 = 32;

/// Reads the shapes of a script for footage. Shapes that are not animated get their key on frame `still`.
///
/// # Errors
///
/// An [`ImportError`] names the list and its place.
pub fn nuke(text: &str, footage: &Footage, still: FrameNumber) -> Result<Shapes, ImportError> {
    let items = items(text)?;
    let (picture, told) = Picture::of(format(&items), footage);
    let mut reader = Reader {
        text,
        footage,
        picture,
        still,
        names: Names::default(),
        left: MOST_POINTS,
        found: Shapes::default(),
        reach: Reach::new(),
    };
    for (k, item) in items.iter().enumerate() {
        let before = reader.found.shapes.len();
        reader.walk(item, &mut Vec::new())?;
        let is_off = attributes::is_disabled(item) && reader.found.shapes.len() > before;
        if let (true, Some(node)) = (is_off, k.checked_sub(1).and_then(|k| items[k].word())) {
            let place = place(text, item.start);
            let warning = format!("{place}: the node {node} is disabled; its shapes come in as they are drawn");
            reader.found.warnings.push(warning);
        }
    }
    if !reader.found.shapes.is_empty() {
        reader.found.warnings.extend(told);
    }
    reader.reach.check().map_err(|error| ImportError::Beyond(Box::new(error)))?;
    if reader.found.shapes.is_empty() && reader.found.warnings.is_empty() {
        return Err(ImportError::Nothing("a curvegroup of a Roto or RotoPaint node"));
    }
    reader.names.settle(&mut reader.found.shapes);
    // The nearest shape comes first in the file.
    reader.found.shapes.reverse();
    Ok(reader.found)
}

/// The size of the picture: the format of a Roto or RotoPaint node, or else that of the script.
fn format(items: &[Item]) -> Option<[f64; 2]> {
    let of = |kinds: &[&str]| {
        items.windows(2).find_map(|pair| {
            let knobs = pair[0].word().filter(|word| kinds.contains(word)).map(|_| pair[1].items())?;
            let value = knobs.windows(2).find(|knob| knob[0].word() == Some("format"))?[1].word()?;
            picture::size(value, ' ')
        })
    };
    of(&["Roto", "RotoPaint"]).or_else(|| of(&["Root"]))
}

struct Reader<'a> {
    text: &'a str,
    footage: &'a Footage,
    picture: Picture,
    still: FrameNumber,
    names: Names,
    /// Points that the file may still have.
    left: usize,
    found: Shapes,
    reach: Reach<ImportError>,
}

/// Layers around a shape, the outermost first, each with its transformation or with why it can't be read.
type Layers = Vec<Result<Option<Transform>, String>>;

/// The outline of a shape.
struct Outline {
    /// Three pairs of numbers a point for a Bézier curve, one for a B-spline.
    pairs: Vec<[Channel; 2]>,
    spline: bool,
    closed: bool,
    relative: bool,
}

impl Reader<'_> {
    /// Reads the shapes in an item.
    fn walk(&mut self, item: &Item, layers: &mut Layers) -> Result<(), ImportError> {
        match item.name() {
            Some("curvegroup") => self.group(item, layers),
            Some("layer") => {
                layers.push(match Transform::read(self.text, item) {
                    _ if attributes::is_invisible(self.text, item) => Err("its layer is invisible".to_owned()),
                    Ok(found) => Ok(found),
                    Err(Fault::Omitted(reason)) => Err(reason),
                    Err(Fault::Wrong(error)) => return Err(error),
                });
                let read = item.items().iter().try_for_each(|item| self.walk(item, layers));
                layers.pop();
                read
            }
            _ => item.items().iter().try_for_each(|item| self.walk(item, layers)),
        }
    }

    fn wrong(&self, item: &Item, element: &str, message: impl Into<String>) -> ImportError {
        wrong(self.text, item.start, element, message)
    }

    fn group(&mut self, item: &Item, layers: &Layers) -> Result<(), ImportError> {
        let [_, name, _, kind, curves, ..] = item.items() else {
            return Err(self.wrong(item, "curvegroup", "found too few items, expected name, flags, type and curves"));
        };
        let name = name.word().unwrap_or_default();
        let kind = kind.word().unwrap_or_default();
        match self.shape(item, name, kind, curves, layers) {
            Ok(()) => {}
            Err(Fault::Wrong(error)) => return Err(error),
            Err(Fault::Omitted(reason)) => {
                let place = place(self.text, item.start);
                self.found.warnings.push(format!("{place}: the shape {name:?} is left out: {reason}"));
            }
        }
        Ok(())
    }

    fn shape(&mut self, item: &Item, name: &str, kind: &str, curves: &Item, layers: &Layers) -> Result<(), Fault> {
        if kind != "bezier" && kind != "bspline" {
            return Err(Fault::Omitted(format!("found type {kind:?}, expected bezier or bspline")));
        }
        if attributes::is_invisible(self.text, item) {
            return Err(Fault::Omitted("it is invisible".into()));
        }
        let own = Transform::read(self.text, item)?;
        let mut chain: Vec<&Transform> = Vec::new();
        for layer in layers {
            chain.extend(layer.as_ref().map_err(|reason| Fault::Omitted(reason.clone()))?);
        }
        chain.extend(&own);
        let curve = curves.items().iter().find(|curve| curve.name() == Some("cc"));
        let curve = curve.ok_or_else(|| self.wrong(item, "curvegroup", "found no curve, expected {cc …}"))?;
        let (outline, time, at) = self.outline(curve, name, kind == "bspline")?;
        let mut frames = self.frames((item, name), &outline.pairs, time, &chain, at);
        if chain.iter().any(|transform| transform.bends()) {
            add_bent(&mut frames, |frame| Some(self.path(&outline, &chain, frame.into())));
        }
        let full = || {
            let message = format!("found more than {MOST_POINTS} points up to here, expected fewer");
            Fault::Wrong(self.wrong(at, "p", message))
        };
        if outline.pairs.len().saturating_mul(frames.len()) > 3 * self.left {
            return Err(full());
        }
        let paths: Vec<Path> = frames.iter().map(|&frame| self.path(&outline, &chain, frame.into())).collect();
        let mut left = self.left;
        let made = contours(&paths, |count| {
            left = left.checked_sub(count).ok_or(())?;
            Ok::<_, ()>(())
        });
        let made = made.map_err(|_| full())?;
        self.left = left;
        let keys: BTreeMap<_, _> = frames.into_iter().zip(made).collect();
        let (falloff, hidden) = (self.falloff(item, name), self.hidden(item, name));
        if let Some(lost) = attributes::lost(self.text, item) {
            let place = place(self.text, item.start);
            self.found.warnings.push(format!("{place}: the shape {name:?} {lost}; it comes in as it is drawn"));
        }
        let (shape, never) = Shape::new((self.names.free(name), outline.closed), keys, &hidden, self.footage);
        self.found.warnings.extend(never.map(|never| format!("{}: {never}", place(self.text, item.start))));
        self.found.shapes.push(Shape { falloff: Some(falloff), ..shape });
        Ok(())
    }

    /// The times in which a shape is not shown. An opacity that cannot be read is told, and counts as one that is never 0.
    fn hidden(&mut self, item: &Item, name: &str) -> Vec<[f64; 2]> {
        let mut found = match attribute(item, "opc").map(|value| (value, channel(self.text, value, "a"))) {
            Some((_, Ok(opacity))) => opacity.zeros(false),
            Some((value, Err(_))) => {
                let place = place(self.text, value.start);
                let warning = format!(
                    "{place}: the opacity of {name:?} cannot be read: frames on which it is hidden are not known"
                );
                self.found.warnings.push(warning);
                Vec::new()
            }
            None => Vec::new(),
        };
        // A visibility changes at once.
        let visible = attribute(item, "vis").and_then(|value| channel(self.text, value, "a").ok());
        found.extend(visible.into_iter().flat_map(|visible| visible.zeros(true)));
        found.extend(attributes::outside_of_lifetime(self.text, item));
        found
    }

    /// The falloff among the attributes of a shape. One that cannot be read is that of a shape without one: its outline counts.
    fn falloff(&mut self, item: &Item, name: &str) -> Falloff {
        let Some(value) = attribute(item, "ff") else { return Falloff::default() };
        let Ok(rate) = channel(self.text, value, "a") else { return Falloff::default() };
        if rate.turns().next().is_some() {
            let place = place(self.text, value.start);
            self.found.warnings.push(format!("{place}: the falloff of {name:?} has keys: its first value is taken"));
        }
        Falloff { rate: rate.rate(), curve: None }
    }

    /// The outline of a curve, the frame of its points if they have one, and their list.
    fn outline<'b>(
        &self,
        curve: &'b Item<'b>,
        name: &str,
        spline: bool,
    ) -> Result<(Outline, Option<f64>, &'b Item<'b>), Fault> {
        let list =
            |names: &[&str]| curve.items().iter().find(|list| list.name().is_some_and(|own| names.contains(&own)));
        let flags = list(&["f"]).and_then(|flags| flags.items().get(1)).and_then(Item::word);
        let flags = flags.and_then(|flags| flags.parse::<u32>().ok()).unwrap_or(RELATIVE_HANDLES);
        let points = list(&["p", "px"]).ok_or_else(|| self.wrong(curve, "cc", "found no points, expected {p …}"))?;
        let timed = points.name() == Some("px");
        let time = if timed { points.items().get(1) } else { None };
        let time = time.map(|time| number(self.text, time, "p")).transpose()?;
        let pairs = &points.items()[if timed { 2 } else { 1 }.min(points.items().len())..];
        let expected = if spline { (1, 3, "at least three") } else { (3, 6, "three for each of at least two points") };
        if pairs.len() < expected.1 || !pairs.len().is_multiple_of(expected.0) {
            let found = pairs.len();
            let message = format!("{name:?}: found {found} pairs of numbers, expected {}", expected.2);
            return Err(self.wrong(points, "p", message).into());
        }
        let (closed, relative) = (flags & OPEN == 0, flags & RELATIVE_HANDLES != 0);
        if spline && !closed {
            return Err(Fault::Omitted("it is an open B-spline, and how these end is not public".into()));
        }
        let pairs = pairs.iter().map(|pair| self.pair(pair, spline)).collect::<Result<Vec<_>, _>>()?;
        let idle = |pair: &[Channel; 2]| pair.iter().all(|channel| channel.is(0.0));
        let (triples, rest) = pairs.as_chunks::<3>();
        if spline && rest.is_empty() && triples.iter().all(|[before, _, after]| idle(before) && idle(after)) {
            return Err(Fault::Omitted("found handles beside the points of a B-spline, expected only points".into()));
        }
        Ok((Outline { pairs, spline, closed, relative }, time, points))
    }

    /// The frames on which any number has a key; the one of the points, or `still`, if none has. Keys that lie beyond the footage
    /// count on its first or last frame. Beside keys, the frame of the points says when they were drawn.
    fn frames(
        &mut self,
        (item, name): (&Item, &str),
        pairs: &[[Channel; 2]],
        time: Option<f64>,
        chain: &[&Transform],
        at: &Item,
    ) -> BTreeSet<FrameNumber> {
        let (first, last) = (self.footage.first, self.footage.last);
        let keyed: Vec<f64> = pairs.iter().flatten().flat_map(Channel::frames).collect();
        let inside = |time: &f64| (f64::from(first)..=f64::from(last)).contains(time);
        let drawn = time.filter(|time| keyed.is_empty() || inside(time));
        let still = keyed.is_empty();
        let mut kept = Kept::of(keyed.into_iter().chain(drawn), self.footage);
        kept.within |= still;
        let (text, footage) = (self.text, self.footage);
        self.reach.add(&kept, || wrong(text, at.start, "p", kept.refused(footage)));
        self.found.warnings.extend(kept.told(name, footage).map(|told| format!("{}: {told}", place(text, item.start))));
        let mut times = kept.frames;
        let moved = chain.iter().flat_map(|transform| transform.frames());
        times.extend(moved.map(|time| time.round().clamp(first.into(), last.into()) as FrameNumber));
        if times.is_empty() {
            times.insert(self.still);
        }
        times
    }

    fn pair(&self, item: &Item, weighted: bool) -> Result<[Channel; 2], Fault> {
        let [x, y, rest @ ..] = item.items() else {
            return Err(self.wrong(item, "p", "found no pair of numbers, expected {x y}").into());
        };
        if let (true, Some(weight)) = (weighted, rest.first())
            && !channel(self.text, weight, "p")?.is(1.0)
        {
            return Err(Fault::Omitted("its points have weights".into()));
        }
        Ok([channel(self.text, x, "p")?, channel(self.text, y, "p")?])
    }

    /// The path on a frame, in pixels of the footage.
    fn path(&self, outline: &Outline, chain: &[&Transform], frame: f64) -> Path {
        let placed = chain.iter().fold(DAffine2::IDENTITY, |outer, inner| outer * inner.at(frame));
        let raw = |pair: &[Channel; 2]| Point::new(pair[0].at(frame), pair[1].at(frame));
        let down = |p: Point| self.picture.pixels(placed.transform_point2(p));
        if outline.spline {
            let guides: Vec<Point> = outline.pairs.iter().map(|pair| down(raw(pair))).collect();
            return Path::spline(&guides, outline.closed);
        }
        let knots: Vec<[Point; 3]> = outline
            .pairs
            .as_chunks::<3>()
            .0
            .iter()
            .map(|[before, own, after]| {
                let own = raw(own);
                let handle = |pair| if outline.relative { own + raw(pair) } else { raw(pair) };
                [handle(after), own, handle(before)].map(down)
            })
            .map(|[after, own, before]| [own, after, before])
            .collect();
        Path::through(&knots, outline.closed)
    }
}

#[cfg(test)]
mod tests;
