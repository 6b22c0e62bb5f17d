//! Shapes of Silhouette (`.fxs`).
//!
//! Each `Object` (or `Shape`) of type `Shape` has a property `path`, whose keys contain a `Path` of `Point`s (`key`). Coordinates
//! are those of the export (`place`), and frames count from the session's first. The footage gives the size of the picture in
//! pixels.
//!
//! - How handles are written is found out (`reading`).
//! - B-splines are uniform and cubic. The ends of an open one are repeated three times, so the curve reaches them.
//! - Layers may have a transformation, which is applied here (`matrix`). A shape then also has keys where it turns, and on every frame
//!   between them on which its points do not go straight (`way`).
//! - Keys beyond the footage are left out (`range`).
//! - A shape that cannot be read is left out with a warning, such as an X-spline. If there is no other one, its error is that of the file.
//! - Hidden shapes, and those in hidden layers, are left out with a warning. A shape is hidden where its opacity is 0; other
//!   opacities are ignored.
//! - Shapes that are inverted or not added to those below come in as they are drawn, with a warning.

mod key;
mod matrix;
mod place;
mod reading;

use super::channel::Channel;
use super::limits::{MOST_POINTS, Points, near};
use super::names::Names;
use super::path::{NoContours, Path, contours};
use super::problem::{Fault, LeftOut, number, parsed};
use super::range::{Kept, Reach};
use super::way::add_bent;
use super::{ImportError, Shape, Shapes};
use key::{Form, Key};
use matrix::Transform;
use place::Place;
use reading::Reading;
use rototoon_base::scene::{Footage, FrameNumber};
use roxmltree::Node;
use std::collections::BTreeSet;

/// Reads the shapes of a Silhouette document for footage. Points are converted to pixels of the footage.
///
/// # Errors
///
/// An [`ImportError`] names the element and its place.
pub fn silhouette(text: &str, footage: &Footage) -> Result<Shapes, ImportError> {
    let document = parsed(text)?;
    let root = document.root_element();
    if root.tag_name().name() != "Silhouette" {
        return Err(ImportError::at(root, "expected <Silhouette>, the root of a Silhouette shape file"));
    }
    let mut reader = Reader {
        footage,
        first: number(root, "sessionStartFrame")?.unwrap_or(footage.first.into()),
        place: Place::read(root, footage)?,
        names: Names::default(),
        points: Points::all(),
        shapes: Vec::new(),
        left_out: LeftOut::default(),
        omitted: false,
        refused: None,
        reach: Reach::new(),
    };
    reader.walk(root, &mut Vec::new())?;
    reader.reach.check().map_err(|error| ImportError::Beyond(Box::new(error)))?;
    if reader.shapes.is_empty() && !reader.omitted {
        if let Some(refused) = reader.refused {
            return Err(refused);
        }
        return Err(ImportError::Nothing("an <Object type=\"Shape\"> that is not hidden"));
    }
    reader.names.settle(&mut reader.shapes);
    reader.shapes.reverse();
    Ok(Shapes { shapes: reader.shapes, warnings: reader.left_out.lines(text) })
}

struct Reader<'a> {
    footage: &'a Footage,
    /// The frame of a key 0.
    first: f64,
    place: Place,
    names: Names,
    points: Points,
    shapes: Vec<Shape>,
    left_out: LeftOut,
    /// Whether a shape was left out that is not hidden.
    omitted: bool,
    /// The error of the first shape that cannot be read.
    refused: Option<ImportError>,
    reach: Reach<ImportError>,
}

/// A layer or a shape, as far as it changes the shapes in it.
struct Layer {
    hidden: bool,
    /// What it does beside showing them, in words.
    lost: Option<String>,
    /// Its transformation, or why that can't be read.
    transform: Result<Option<Transform>, String>,
}

impl Layer {
    fn read(node: Node, first: f64) -> Self {
        let hidden = node.attribute("hidden").is_some_and(is_true);
        let transform = property(node, "transform.matrix").map_or(Ok(None), |node| Transform::read(node, first));
        Self { hidden, lost: lost(node), transform }
    }
}

impl Reader<'_> {
    /// Reads the shapes in an element. `layers` are those around it, the outermost first.
    fn walk(&mut self, node: Node, layers: &mut Vec<Layer>) -> Result<(), ImportError> {
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            let own = matches!(name, "Object" | "Shape" | "Layer");
            match child.attribute("type").unwrap_or(name) {
                "Shape" if own => {
                    layers.push(Layer::read(child, self.first));
                    let read = self.found(child, layers);
                    layers.pop();
                    read?;
                }
                "Layer" if own => {
                    layers.push(Layer::read(child, self.first));
                    let read = self.walk(child, layers);
                    layers.pop();
                    read?;
                }
                _ => self.walk(child, layers)?,
            }
        }
        Ok(())
    }

    /// Adds a shape. The last of `layers` is the shape itself.
    fn found(&mut self, node: Node, layers: &[Layer]) -> Result<(), ImportError> {
        let label = node.attribute("label").unwrap_or("");
        if layers.iter().any(|layer| layer.hidden) {
            self.left_out.push(node, format!("the hidden shape {label:?} is left out"));
            return Ok(());
        }
        match self.shape(node, layers) {
            Ok(shape) => self.shapes.push(shape),
            // A shape of another kind, such as an X-spline, keeps no other one out.
            Err(Fault::Wrong(error)) => match &error {
                ImportError::Element { element, message, .. } if !self.points.spent => {
                    self.left_out.push(node, format!("the shape {label:?} is left out: <{element}>: {message}"));
                    self.refused.get_or_insert(error);
                }
                _ => return Err(error),
            },
            Err(Fault::Omitted(reason)) => {
                self.omitted = true;
                self.left_out.push(node, format!("the shape {label:?} is left out: {reason}"));
            }
        }
        Ok(())
    }

    fn shape(&mut self, node: Node, layers: &[Layer]) -> Result<Shape, Fault> {
        let name = self.names.free(node.attribute("label").unwrap_or(""));
        let Some(property) = property(node, "path") else {
            let message = format!("shape {name:?}: found no <Property id=\"path\">, expected one");
            return Err(ImportError::at(node, message).into());
        };
        let keys = self.keys(property, &name)?;
        let mut chain: Vec<&Transform> = Vec::new();
        for layer in layers {
            chain.extend(layer.transform.as_ref().map_err(|reason| Fault::Omitted(reason.clone()))?);
        }
        let mut frames = self.frames(node, &name, &keys, &chain);
        let reading = Reading::of(&keys.iter().map(|key| &key.form).collect::<Vec<_>>(), self.footage);
        // Points go straight while a matrix changes, but not if it is a perspective or if the path or another matrix changes too.
        if chain.iter().any(|transform| !transform.turns().is_empty()) {
            let path = |frame| reading.path(&key::form(&keys, frame));
            add_bent(&mut frames, |frame| self.placed(path(frame), &chain, frame, property).ok());
            self.room(frames.len().saturating_mul(keys[0].form.knots.len()), property)?;
        }
        let mut paths = Vec::new();
        for &frame in &frames {
            paths.push(self.placed(reading.path(&key::form(&keys, frame)), &chain, frame, property)?);
        }
        let made = contours(&paths, |count| self.points.take(count, property)).map_err(|error| match error {
            NoContours::Unequal => unequal(property, &name, &keys),
            NoContours::Refused(error) => error,
        })?;
        for lost in layers.iter().filter_map(|layer| layer.lost.as_ref()) {
            self.left_out.push(node, format!("the shape {name:?} or its layer {lost}; it comes in as it is drawn"));
        }
        let (closed, hidden) = (keys[0].form.closed, hidden(node, self.first)?);
        let (shape, never) = Shape::new((name, closed), frames.into_iter().zip(made).collect(), &hidden, self.footage);
        never.into_iter().for_each(|never| self.left_out.push(node, never));
        let keyed = property.children().any(|node| node.has_tag_name("Key"));
        Ok(Shape { extent: shape.extent.of_keys(keyed), ..shape })
    }

    /// Refuses more points than a file may have, before they are made.
    fn room(&mut self, points: usize, at: Node) -> Result<(), ImportError> {
        if points > MOST_POINTS { self.points.take(usize::MAX, at) } else { Ok(()) }
    }

    /// The keys of a path in the order of time, at least one.
    fn keys<'a>(&self, property: Node<'a, 'a>, name: &str) -> Result<Vec<Key<'a>>, ImportError> {
        let read = |node| Key::read(node, self.first, &self.place, self.footage);
        let mut keys = property.children().filter(Node::is_element).map(read).collect::<Result<Vec<_>, _>>()?;
        keys.sort_by(|a, b| a.frame.total_cmp(&b.frame));
        let Some(first) = keys.first() else {
            return Err(ImportError::at(property, "found no key, expected <Key> or <Value> with a <Path>"));
        };
        let kind = |form: &Form| (form.knots.len(), form.closed, form.spline);
        if keys.iter().any(|key| kind(&key.form) != kind(&first.form)) {
            return Err(unequal(property, name, &keys));
        }
        Ok(keys)
    }

    /// The frames on which a shape gets keys.
    fn frames(&mut self, node: Node, name: &str, keys: &[Key], chain: &[&Transform]) -> BTreeSet<FrameNumber> {
        let (first, last) = (self.footage.first, self.footage.last);
        let kept = Kept::of(keys.iter().map(|key| key.frame), self.footage);
        self.reach.add(&kept, || ImportError::at(keys[0].node, kept.refused(self.footage)));
        if let Some(told) = kept.told(name, self.footage) {
            self.left_out.push(node, told);
        }
        let mut frames = kept.frames;
        let moved = chain.iter().flat_map(|transform| transform.turns());
        let turns = key::turns(keys).into_iter().chain(moved);
        frames.extend(turns.map(|time| time.round().clamp(first.into(), last.into()) as FrameNumber));
        frames
    }

    /// A path with the transformations around it, the outermost first.
    fn placed(&self, mut path: Path, chain: &[&Transform], frame: FrameNumber, at: Node) -> Result<Path, Fault> {
        if chain.is_empty() {
            return Ok(path);
        }
        for p in path.points_mut() {
            let own = self.place.own(*p);
            let moved = chain.iter().rev().try_fold(own, |p, transform| transform.point(p, frame.into()));
            let beyond = || Fault::Omitted(format!("on frame {frame} a perspective puts it beyond its horizon"));
            *p = near(self.place.pixels(moved.ok_or_else(beyond)?), at)?;
        }
        Ok(path)
    }
}

/// Whether a text says yes. Files that are written by hand have numbers.
fn is_true(text: &str) -> bool {
    text.trim().eq_ignore_ascii_case("true") || text.trim() == "1"
}

/// A property of a shape or a layer itself.
fn property<'a, 'b>(owner: Node<'a, 'b>, id: &str) -> Option<Node<'a, 'b>> {
    let direct =
        |node: Node<'a, 'b>, name: &'static str| node.children().filter(move |child| child.tag_name().name() == name);
    let inner = direct(owner, "Properties").flat_map(|properties| direct(properties, "Property"));
    direct(owner, "Property").chain(inner).find(|node| node.attribute("id") == Some(id))
}

/// What a shape or a layer does beside adding its area to those below; `None` for nothing.
fn lost(owner: Node) -> Option<String> {
    let value = |id| property(owner, id)?.children().find(Node::is_element)?.text().map(str::trim);
    let inverted = value("invert").is_some_and(is_true);
    // The greatest of several coverages and their sum have the same outline.
    let plain = |mode: &&str| ["add", "max", "normal"].iter().any(|plain| mode.eq_ignore_ascii_case(plain));
    let mode = value("mode").filter(|mode| !mode.is_empty() && !plain(mode));
    let mode = mode.map(|mode| format!("has the mode {mode:.40?}"));
    let told: Vec<String> = inverted.then(|| "is inverted".to_owned()).into_iter().chain(mode).collect();
    (!told.is_empty()).then(|| told.join(" and "))
}

/// The times in which the opacity of a shape is 0. An opacity that is no number is not 0. Keys are held only if all say so.
fn hidden(shape: Node, first: f64) -> Result<Vec<[f64; 2]>, ImportError> {
    let Some(opacity) = property(shape, "opacity") else { return Ok(Vec::new()) };
    let (mut keys, mut held) = (Vec::new(), true);
    for key in opacity.children().filter(Node::is_element) {
        let value = key.text().and_then(|text| text.trim().parse::<f64>().ok()).filter(|value| value.is_finite());
        keys.push((number(key, "frame")?.unwrap_or_default() + first, value.unwrap_or(100.0)));
        held &= key.attribute("interp") == Some("hold");
    }
    Ok(Channel::keyed(keys).map_or(Vec::new(), |opacity| opacity.zeros(held)))
}

/// The error for keys of several kinds: the first two that differ in their number of points, or the first two.
fn unequal(property: Node, name: &str, keys: &[Key]) -> ImportError {
    let count = |key: &Key| key.form.knots.len();
    let other = keys.iter().position(|key| count(key) != count(&keys[0])).unwrap_or(1);
    let shown = [0, other].into_iter().filter_map(|k| keys.get(k));
    let counts: Vec<_> = shown.map(|key| format!("{} on frame {}", count(key), key.frame)).collect();
    let found = counts.join(", ");
    ImportError::at(
        property,
        format!("shape {name:?}: found keys of {found} points, expected the same number and kind on each"),
    )
}

#[cfg(test)]
mod tests;
