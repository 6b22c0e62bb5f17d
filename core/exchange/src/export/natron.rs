//! Shapes for Natron: a Python script (`.py`) that makes a Roto node.
//!
//! The script adds a node to an open project; [`natron_project`](mod@super::natron_project) makes a project of its own. The script
//! uses what Natron offers to scripts, and makes the same calls as the scripts that Natron itself writes for a group with a
//! Roto node. Each part is a Bézier curve in the base layer; the farthest comes first, since the node draws in this
//! order. A curve has a key on every frame on which the part has a contour. Handles are places; where sides are straight, both are at
//! the point. The feather's point and its handles are those of the point, so the feather, which Natron begins with 1.5 pixels, is
//! none. Of the falloff of a soft border it has the rate: Natron too raises its ramp to it. Scripts cannot choose the ramp.
//! Coordinates are pixels with x right and y up. Where a part is not there its curve is not active. For
//! that its life time is *Custom*, the last of the choices: others ignore the parameter that says whether it is active.
//!
//! Source: Natron 2, Python reference (`Roto`, `BezierCurve`), and the public sources of its export of groups, of `PyRoto.cpp`
//! and of `RotoDrawableItem.cpp`.
//!
//! Limits: Natron offers scripts no open curves; an open part becomes a curve that is not closed yet, and has no matte.

use super::coordinate;
use super::knot::Knot;
use super::outlines::{Detail, Outlines};
use super::presence::presence;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Scene;
use std::fmt::Write;

/// What comes before the shapes. Natron runs a file that defines a function `createInstance` in another way, so no line may
/// contain that definition.
const HEAD: &str = "# -*- coding: utf-8 -*-
# Shapes of Rototoon for Natron 2. Run this script in Natron's Script Editor, or open it: Natron FILE.py
# It makes one Roto node.

# Label, whether the shape is closed, its colour in the viewer, the falloff of its feather, and for each frame x and y of each
# point, in pixels with y up. Then the frames on which the shape comes (1) or goes (0). True at the end: each point is followed by x and
# y of the handles before and after it.
SHAPES = [
";

const CODE: &str = "]


def rototoon_shape(roto, layer, label, closed, colour, falloff, frames, changes, bent=False):
    bezier = roto.createBezier(0, 0, frames[0][0])
    bezier.setLabel(label)
    layer.addItem(bezier)
    size = 6 if bent else 2
    count = len(frames[0][1]) // size
    for _ in range(count - 1):
        bezier.addControlPoint(0, 0)
    for frame, numbers in frames:
        for k in range(count):
            own = numbers[size * k:size * k + size]
            places = own if bent else own * 3
            bezier.setPointAtIndex(k, frame, *places)
            bezier.setFeatherPointAtIndex(k, frame, *places)
    if closed:
        bezier.setCurveFinished(True)
    bezier.getFeatherDistanceParam().setValue(0, 0)
    bezier.getFeatherFallOffParam().setValue(falloff, 0)
    bezier.setOverlayColor(*colour)
    # Keys of Activated count in the last life time only, Custom. Newer versions of Natron begin with All.
    life = bezier.getParam(\"lifeTime\")
    if len(changes) > 1 and hasattr(life, \"getNumOptions\"):
        life.set(life.getNumOptions() - 1)
    if len(changes) > 1:
        for frame, there in changes:
            bezier.getActivatedParam().setValueAtTime(there == 1, frame)


def rototoon_shapes(app):
    node = app.createNode(\"fr.inria.built-in.Roto\")
    node.setLabel(\"Rototoon\")
    roto = node.getRotoContext()
    layer = roto.getBaseLayer()
    for shape in SHAPES:
        rototoon_shape(roto, layer, *shape)


try:
    app
except NameError:
    app = app1
rototoon_shapes(app)
";

/// Natron's greatest falloff.
pub(super) const MOST_FALLOFF: f64 = 5.0;

/// The scene's parts as a script for Natron. `detail` says how they follow snapped paths.
pub fn natron(scene: &Scene, detail: impl Into<Detail>) -> String {
    let detail = detail.into();
    let (first, last, height) = (scene.footage.first, scene.footage.last, scene.footage.height as f64);
    let mut out = String::from(HEAD);
    for index in super::nearest_first(scene).into_iter().rev() {
        let part = &scene.parts[index];
        let outlines = Outlines::new(part, detail);
        let keys = outlines.within(first, last);
        if keys.is_empty() {
            continue;
        }
        let (closed, bent) = (python(part.closed), if outlines.bent() { ", True" } else { "" });
        let [r, g, b] = part.shown_colour(index).map(|value| coordinate(value.into()));
        let rate = coordinate(part.falloff.rate.min(MOST_FALLOFF));
        let _ = writeln!(out, "    ({}, {closed}, ({r}, {g}, {b}), {rate}, [", literal(&part.name));
        let numbers = |knot: &Knot| {
            let [before, after] = knot.handles();
            let places = if outlines.bent() { &[knot.at, before, after][..] } else { &[knot.at] };
            let place = |p: &Point| format!("{}, {}", coordinate(p.x), coordinate(height - p.y));
            places.iter().map(place).collect::<Vec<_>>().join(", ")
        };
        for (frame, knots) in &keys {
            let numbers: Vec<_> = knots.iter().map(numbers).collect();
            let _ = writeln!(out, "        ({frame}, [{}]),", numbers.join(", "));
        }
        let changes = presence(part, &keys, &scene.footage).into_iter();
        let changes: Vec<_> = changes.map(|(frame, there)| format!("({frame}, {})", u8::from(there))).collect();
        // A list of one thing needs no comma in Python.
        let _ = writeln!(out, "    ], [{}]{bent}),", changes.join(", "));
    }
    out + CODE
}

fn python(value: bool) -> &'static str {
    if value { "True" } else { "False" }
}

/// A text for Python 2 and 3, in ASCII.
fn literal(text: &str) -> String {
    let mut out = String::from("u\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            ' '..='~' => out.push(c),
            _ if u32::from(c) < 0x1_0000 => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            _ => {
                let _ = write!(out, "\\U{:08x}", u32::from(c));
            }
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Falloff, Footage, Part};
    use std::collections::BTreeMap;

    #[test]
    fn shapes_come_farthest_first_with_y_up() {
        let at = |x: f64| vec![Point::new(x, 2.0), Point::new(8.0, 2.0), Point::new(8.125, 30.0)];
        let part = |name: &str, depth, closed| Part {
            name: name.into(),
            closed,
            depth,
            keys: BTreeMap::from([(1, at(0.5)), (3, at(1.0 / 3.0))]),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 5, fps: 12.5, width: 40, height: 30, held: false };
        let falloff = Falloff { rate: 2.5, curve: None };
        let far = Part { falloff, ..part("far", 0.0, true) };
        let parts = vec![part("near", 2.0, false), far, Part::default()];
        let text = natron(&Scene { footage, parts }, 1.0);
        let wanted = "SHAPES = [
    (u\"far\", True, (0.0425, 0.1328, 0.85), 2.5, [
        (1, [0.5, 28, 8, 28, 8.125, 0]),
        (3, [0.3333, 28, 8, 28, 8.125, 0]),
    ], [(0, 0), (1, 1), (4, 0)]),
    (u\"near\", False, (1, 0.303, 0.15), 1, [
";
        assert!(text.contains(wanted), "{text}");
        assert!(!text.contains("def createInstance") && text.is_ascii());
    }

    #[test]
    fn names_are_texts_of_python() {
        assert_eq!(literal("a\\\"b\n"), "u\"a\\\\\\\"b\\u000a\"");
        assert_eq!(literal("Größe 🦊"), "u\"Gr\\u00f6\\u00dfe \\U0001f98a\"");
    }
}
