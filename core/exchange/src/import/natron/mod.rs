//! Shapes of Natron's Roto and RotoPaint nodes, from a project (`.ntp`).
//!
//! A project of Natron 2 is an XML archive of Boost. Each roto node has a `RotoContext` with one `BaseLayer`. A layer has
//! `NumChildren` children, each with a `Type` and an `Item`: a Bézier curve, a paint stroke, or a layer. The farthest comes
//! first, since nodes draw their items in this order. A curve has `NumPoints` pairs of `CP`, a control point, and `FP`, the
//! feather's point. A control point has six numbers: its place (`X`, `Y`) and the places of the handles before it (`Left_X`,
//! `Left_Y`) and after it (`Right_X`, `Right_Y`). Each number is followed by its animation, a `KeyFrameSet` of `Time` and
//! `Value`, with an `InterpolationMethod`; without keys the number itself counts. Coordinates are pixels with y up.
//!
//! - A shape has keys on the frames on which any of its numbers or of its `transform`'s has one. Between keys numbers are taken
//!   as linear, as Natron does for control points. Where the points then do not go straight, since a transformation turns them, there is a
//!   key on every frame (`way`).
//! - A key whose `InterpolationMethod` is 0 holds its number until the next one. Other numbers than 0 and 1 stand for curves: they are
//!   taken as linear, with a warning.
//! - Keys beyond the footage are left out (`range`).
//! - A curve is open if it is not closed yet or was drawn as an open one.
//! - Left out with a warning: paint strokes, and curves whose transformation is linked, an expression or a perspective.
//! - The falloff of a feather is read. A curve is hidden where its opacity is 0 and, if its life time is *Custom*, where it is not
//!   active. Other opacities, other life times and feather are ignored.
//!
//! Source: the classes `RotoContext`, `RotoLayer`, `RotoDrawableItem`, `Bezier`, `BezierCP`, `Curve` and `Knob` with their
//! serialisations in the public sources of Natron 2. Natron 3, which was never released, writes YAML instead.

mod number;
mod transform;

use super::channel::Channel;
use super::limits::{MOST_POINTS, Points};
use super::names::Names;
use super::path::{NoContours, Path, contours};
use super::picture::{self, Picture};
use super::problem::{Fault, LeftOut, parsed};
use super::range::{Kept, Reach};
use super::way::add_bent;
use super::{ImportError, Shape, Shapes};
use number::{child, curve, named, text_of};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, FalloffCurve, Footage, FrameNumber};
use roxmltree::{Document, Node};
use std::collections::BTreeSet;
use transform::{Transform, parameter};

/// The life time *Custom*: the curve has keys for its activity.
const CUSTOM: f64 = 4.0;

/// Reads the shapes of a project for footage. Shapes that are not animated get their key on frame `still`.
///
/// # Errors
///
/// An [`ImportError`] names the element and its place.
pub fn natron(text: &str, footage: &Footage, still: FrameNumber) -> Result<Shapes, ImportError> {
    let document = parsed(text)?;
    let (picture, told) = Picture::of(format(&document), footage);
    let mut reader = Reader {
        footage,
        picture,
        still,
        names: Names::default(),
        points: Points::all(),
        shapes: Vec::new(),
        left_out: LeftOut::default(),
        reach: Reach::new(),
    };
    for context in document.descendants().filter(|node| named(*node, "RotoContext")) {
        if let Some(base) = child(context, "BaseLayer") {
            reader.layer(base)?;
        }
    }
    reader.reach.check().map_err(|error| ImportError::Beyond(Box::new(error)))?;
    reader.names.settle(&mut reader.shapes);
    let mut warnings = reader.left_out.lines(text);
    if !reader.shapes.is_empty() {
        warnings.extend(told);
    }
    if reader.shapes.is_empty() && warnings.is_empty() {
        return Err(ImportError::Nothing("a Bézier curve of a Roto or RotoPaint node"));
    }
    Ok(Shapes { shapes: reader.shapes, warnings })
}

/// The size of the project's picture, if its format is one of its own, which is named by its size.
fn format(document: &Document) -> Option<[f64; 2]> {
    let is_format = |node: &Node| child(*node, "Name").is_some_and(|name| text_of(name) == "outputFormat");
    let parameter = document.descendants().find(is_format)?;
    picture::size(text_of(child(parameter, "ChoiceLabel")?), 'x')
}

struct Reader<'a> {
    footage: &'a Footage,
    picture: Picture,
    still: FrameNumber,
    names: Names,
    points: Points,
    shapes: Vec<Shape>,
    left_out: LeftOut,
    reach: Reach<ImportError>,
}

/// A control point: its place, the handle after it, the handle before it; x and y each.
type Knot = [[Channel; 2]; 3];

impl Reader<'_> {
    fn layer(&mut self, layer: Node) -> Result<(), ImportError> {
        for item in layer.children().filter(|node| named(*node, "Item")) {
            if child(item, "NumPoints").is_some() {
                self.curve(item)?;
            } else if child(item, "NumChildren").is_some() {
                self.layer(item)?;
            } else {
                let name = name(item);
                self.left_out.push(item, format!("the paint stroke {name:?} is left out, since it has no outline"));
            }
        }
        Ok(())
    }

    fn curve(&mut self, item: Node) -> Result<(), ImportError> {
        match self.shape(item) {
            Ok(shape) => self.shapes.push(shape),
            Err(Fault::Wrong(error)) => return Err(error),
            Err(Fault::Omitted(reason)) => {
                let name = name(item);
                self.left_out.push(item, format!("the shape {name:?} is left out: {reason}"));
            }
        }
        Ok(())
    }

    fn shape(&mut self, item: Node) -> Result<Shape, Fault> {
        let knots = knots(item)?;
        let transform = Transform::read(item)?;
        let closed = flag(item, "Closed") && !flag(item, "OpenBezier");
        let mut frames = self.frames(item, &knots, transform.as_ref());
        if transform.as_ref().is_some_and(Transform::bends) {
            add_bent(&mut frames, |frame| Some(self.path(&knots, transform.as_ref(), closed, frame.into())));
        }
        if knots.len().saturating_mul(frames.len()) > MOST_POINTS {
            self.points.take(usize::MAX, item)?;
        }
        let paths: Vec<Path> =
            frames.iter().map(|&frame| self.path(&knots, transform.as_ref(), closed, frame.into())).collect();
        let made = contours(&paths, |count| self.points.take(count, item)).map_err(|problem| match problem {
            NoContours::Refused(error) => error,
            NoContours::Unequal => ImportError::at(item, "found no control point, expected at least two"),
        })?;
        let name = self.names.free(&name(item));
        let (falloff, hidden) = (self.falloff(item), hidden(item));
        let (shape, never) = Shape::new((name, closed), frames.into_iter().zip(made).collect(), &hidden, self.footage);
        never.into_iter().for_each(|never| self.left_out.push(item, never));
        let keyed = knots.iter().flatten().flatten().any(|channel| channel.frames().next().is_some());
        Ok(Shape { falloff: Some(falloff), extent: shape.extent.of_keys(keyed), ..shape })
    }

    /// The falloff of a curve. One that cannot be read is that of a curve without one: its outline counts.
    fn falloff(&mut self, item: Node) -> Falloff {
        let Some(rate) = single(item, "featherFallOff", 1.0) else { return Falloff::default() };
        if rate.turns().next().is_some() {
            let name = name(item);
            self.left_out.push(item, format!("the falloff of {name:?} has keys: its first value is taken"));
        }
        // The first ramp is that of all curves at first. The second one is its third power.
        let ramp = single(item, "fallOffType", 0.0).map_or(0.0, |ramp| ramp.at(0.0));
        let (power, curve) = match ramp as i32 {
            1 => (3.0, Some(FalloffCurve::Linear)),
            2 => (1.0, Some(FalloffCurve::EaseIn)),
            3 => (1.0, Some(FalloffCurve::EaseOut)),
            4 => (1.0, Some(FalloffCurve::Smooth)),
            _ => (1.0, None),
        };
        Falloff { rate: (power * rate.rate()).min(Falloff::MOST), curve }
    }

    /// The frames on which any number has a key; `still` if none has. Keys that lie beyond the footage count on its first or last
    /// frame.
    fn frames(&mut self, item: Node, knots: &[Knot], transform: Option<&Transform>) -> BTreeSet<FrameNumber> {
        let (first, last) = (self.footage.first, self.footage.last);
        let kept = Kept::of(knots.iter().flatten().flatten().flat_map(Channel::frames), self.footage);
        self.reach.add(&kept, || ImportError::at(item, kept.refused(self.footage)));
        if let Some(told) = kept.told(&name(item), self.footage) {
            self.left_out.push(item, told);
        }
        let mut times = kept.frames;
        let moving = || transform.into_iter().flat_map(Transform::channels);
        let moved = moving().flat_map(Channel::turns);
        times.extend(moved.map(|time| time.round().clamp(first.into(), last.into()) as FrameNumber));
        let own = || knots.iter().flatten().flatten().chain(moving());
        let ends = own().flat_map(Channel::ends).filter(|time| (f64::from(first)..=f64::from(last)).contains(time));
        times.extend(ends.map(|time| time as FrameNumber));
        if own().any(Channel::is_uncertain) {
            let name = name(item);
            self.left_out.push(
                item,
                format!("the shape {name:?} goes in curves between some of its keys: it is taken to go evenly"),
            );
        }
        if times.is_empty() {
            times.insert(self.still);
        }
        times
    }

    /// The path on a frame, in pixels of the footage.
    fn path(&self, knots: &[Knot], transform: Option<&Transform>, closed: bool, frame: f64) -> Path {
        let moved = transform.map(|transform| transform.at(frame));
        let place = |[x, y]: &[Channel; 2]| {
            let p = Point::new(x.at(frame), y.at(frame));
            let p = moved.map_or(p, |moved| moved.transform_point2(p));
            self.picture.pixels(p)
        };
        let knots: Vec<[Point; 3]> = knots.iter().map(|knot| [&knot[0], &knot[1], &knot[2]].map(place)).collect();
        Path::through(&knots, closed)
    }
}

/// A parameter of one number; `None` if it cannot be read.
fn single(item: Node, id: &str, fallback: f64) -> Option<Channel> {
    let own = child(item, "RotoDrawableItemSerialization")?;
    parameter(own, id, &[fallback]).ok()?.pop()
}

/// The times in which a curve is not shown.
fn hidden(item: Node) -> Vec<[f64; 2]> {
    let mut found = single(item, "opacity", 1.0).map_or(Vec::new(), |opacity| opacity.zeros(false));
    if single(item, "lifeTime", 0.0).is_some_and(|time| time.is(CUSTOM)) {
        found.extend(single(item, "activated", 1.0).into_iter().flat_map(|active| active.zeros(true)));
    }
    found
}

/// The control points of a curve.
fn knots(item: Node) -> Result<Vec<Knot>, ImportError> {
    let knot = |point: Node| {
        let pair = |x, y| Ok([curve(point, x)?, curve(point, y)?]);
        Ok([pair("X", "Y")?, pair("Right_X", "Right_Y")?, pair("Left_X", "Left_Y")?])
    };
    let points = item.children().filter(|node| named(*node, "CP"));
    let knots = points.map(knot).collect::<Result<Vec<_>, ImportError>>()?;
    let told = child(item, "NumPoints").map(text_of).unwrap_or_default();
    if told.parse() != Ok(knots.len()) || knots.len() < 2 {
        let found = knots.len();
        let message =
            format!("{:?}: found {found} <CP> and NumPoints {told:.40}, expected as many, at least 2", name(item));
        return Err(ImportError::at(item, message));
    }
    Ok(knots)
}

/// The label of an item; its script name if it has none.
fn name(item: Node) -> String {
    let own = item.descendants().find(|node| named(*node, "RotoItemSerialization"));
    // Blanks at the ends belong to a name.
    let text = |name| own.and_then(|own| child(own, name)?.text()).filter(|text| !text.trim().is_empty());
    text("Label").or_else(|| text("Name")).unwrap_or_default().to_owned()
}

fn flag(item: Node, name: &str) -> bool {
    child(item, name).is_some_and(|node| text_of(node) == "1")
}

#[cfg(test)]
mod tests;
