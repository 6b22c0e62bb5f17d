//! What an SVG document shows of its shapes beside their outlines, and an import loses: holes, clipping paths and masks.
//!
//! There is one warning for each of them, at the first shape that it is about, with the names of all.
//!
//! Drawing programs put a clipping path as large as the picture around all that they export. A clip loses nothing if it is one plain rectangle
//! and a shape lies in it as far as it lies in the picture. So such a clip is not told.

use super::problem::{LeftOut, listed};
use super::svg_length::{Along, length};
use super::svg_style::Styles;
use super::svg_transform::moved;
use super::svg_view::View;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Footage;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;
use svgtypes::Transform;

/// How far beyond a rectangle a shape may lie, in pixels: files round their numbers.
const BEYOND: f64 = 0.05;

/// What is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Cause {
    /// A hole.
    Hole,
    /// Holes may be there: there are too many sub-paths to look for them.
    Unsought,
    /// A clipping path.
    Clip,
    /// A mask.
    Mask,
}

impl Cause {
    fn told(self) -> &'static str {
        match self {
            Self::Hole => "holes are left out, since a part has none and covers what shows through them",
            Self::Unsought => "too many sub-paths to look for holes, so all of them come in as parts",
            Self::Clip => "clipping paths are not read, so these shapes come in whole",
            Self::Mask => "masks are not read, so these shapes come in whole",
        }
    }
}

/// What was lost of which shapes.
#[derive(Debug, Default)]
pub(super) struct Lost(BTreeMap<Cause, (usize, Vec<String>)>);

impl Lost {
    /// Adds a shape.
    pub fn add(&mut self, cause: Cause, node: Node, name: &str) {
        let (_, names) = self.0.entry(cause).or_insert_with(|| (node.range().start, Vec::new()));
        if names.last().is_none_or(|last| last != name) {
            names.push(name.to_owned());
        }
    }

    /// Adds the warnings.
    pub fn tell(self, left_out: &mut LeftOut) {
        for (cause, (start, names)) in self.0 {
            left_out.push_at(start, format!("{}: {}", cause.told(), listed(&names)));
        }
    }
}

/// What hides something of an element and of all in it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cover {
    Mask,
    /// A clip with its rectangle, from the least to the greatest corner, and the transformation of that to pixels; `None` for another form.
    Clip(Option<([Point; 2], Transform)>),
}

/// The clipping paths of a document by their ids.
pub(super) type Clips<'a> = BTreeMap<&'a str, Node<'a, 'a>>;

/// The clipping paths of a document.
pub(super) fn clips<'a>(document: &'a Document<'a>) -> Clips<'a> {
    let all = document.descendants().filter(|node| node.is_element() && node.tag_name().name() == "clipPath");
    let mut found = Clips::new();
    for node in all {
        if let Some(id) = node.attribute("id") {
            found.entry(id).or_insert(node);
        }
    }
    found
}

/// What covers an element. `inner` is the transformation of its units to pixels.
pub(super) fn covers(node: Node, styles: &Styles, clips: &Clips, view: &View, inner: Transform) -> Vec<Cover> {
    let set = |property: &str| styles.own(node, property).filter(|value| !value.is_empty() && *value != "none");
    let mut found = Vec::new();
    if let Some(value) = set("clip-path") {
        let id = value.strip_prefix("url(").and_then(|rest| rest.split_once(')')).map(|(id, _)| id.trim());
        let id = id.map(|id| id.trim_matches(['"', '\'']).trim_start_matches('#'));
        match id.map(|id| clips.get(id)) {
            // A reference to nothing clips nothing.
            Some(None) => {}
            Some(Some(clip)) => found.push(Cover::Clip(rectangle(*clip, styles, view).map(|corners| (corners, inner)))),
            None => found.push(Cover::Clip(None)),
        }
    }
    if set("mask").is_some() {
        found.push(Cover::Mask);
    }
    found
}

/// The corners of a clip that is one plain rectangle in the units of what it clips.
fn rectangle(clip: Node, styles: &Styles, view: &View) -> Option<[Point; 2]> {
    let mut inner = clip.children().filter(Node::is_element);
    let rect = inner.next().filter(|node| node.tag_name().name() == "rect" && inner.next().is_none())?;
    let plain = |node: Node| {
        ["transform", "clip-path", "rx", "ry", "display", "mask"]
            .iter()
            .all(|property| styles.own(node, property).is_none())
    };
    if clip.attribute("clipPathUnits").is_some_and(|units| units != "userSpaceOnUse") || !plain(clip) || !plain(rect) {
        return None;
    }
    let side = |name: &str, along| styles.own(rect, name).map_or(Some(0.0), |text| length(text, view, along));
    let low = Point::new(side("x", Along::X)?, side("y", Along::Y)?);
    Some([low, low + Point::new(side("width", Along::X)?, side("height", Along::Y)?)])
}

impl Cover {
    /// What it hides of a shape with these points, in pixels; `None` for nothing.
    pub fn hides<'a>(&self, mut points: impl Iterator<Item = &'a Point>, footage: &Footage) -> Option<Cause> {
        let Self::Clip(clip) = self else { return Some(Cause::Mask) };
        let Some(([low, high], to)) = clip else { return Some(Cause::Clip) };
        let Some(back) = inverse(*to) else { return Some(Cause::Clip) };
        let picture = Point::new(footage.width as f64, footage.height as f64);
        let slack = BEYOND * back.a.hypot(back.b).max(back.c.hypot(back.d));
        let within = |p: &Point| {
            let p = moved(p.clamp(Point::ZERO, picture), back);
            (p - *low).min(*high - p).min_element() >= -slack
        };
        (!points.all(within)).then_some(Cause::Clip)
    }
}

fn inverse(t: Transform) -> Option<Transform> {
    let share = 1.0 / (t.a * t.d - t.b * t.c);
    share.is_finite().then(|| {
        let [a, b, c, d] = [t.d, -t.b, -t.c, t.a].map(|number| number * share);
        Transform::new(a, b, c, d, -(a * t.e + c * t.f), -(b * t.e + d * t.f))
    })
}
