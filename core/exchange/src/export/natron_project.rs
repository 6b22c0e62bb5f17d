//! Shapes for Natron: a project (`.ntp`) with one Roto node.
//!
//! A project is an XML archive of Boost, which its reader takes strictly in order. This one has what Natron 2.3.12 writes,
//! class by class and version by version, so Natron from 2.3.11 on opens it: a later one reads old versions. It is marked as
//! a project of a run without windows, and so ends before the state of the windows. Settings and parameters that are not in a
//! project keep their defaults; so only the format, the frames and the rate of the footage are there.
//!
//! The parts are Bézier curves of the base layer, the farthest first, since the node draws in this order. A curve has a key on
//! every frame on which the part has a contour, but for those on which it is held, and goes evenly between keys. The handle before a point is its left one. Where sides are
//! straight, handles are at their points. The feather's points are those of the curve, so the feather, which Natron begins with 1.5 pixels, is none. Of the falloff
//! of a soft border it has the rate.
//! Coordinates are pixels with x right and y up. Where a part is not there its curve is not active: a
//! parameter with keys says so, and the curve's life time is *Custom*, since other life times ignore that parameter.
//!
//! Source: the public sources of Natron 2, folder `Engine`: order and versions of `ProjectSerialization.h` (6),
//! `NodeGroupSerialization.h` (1), `NodeSerialization.h` (15), `RotoContextSerialization.h` (2), `RotoLayerSerialization.h`
//! (2), `RotoItemSerialization.h` (2), `RotoDrawableItemSerialization.h` (4), `BezierSerialization.h` (4),
//! `BezierCPSerialization.h` (4), `CurveSerialization.h`, `KnobSerialization.h` (14, values 7) and `FormatSerialization.h`
//! (3); how they are read in `Project.cpp`, `ProjectPrivate.cpp` and `RotoDrawableItem.cpp`; derivatives of keys in
//! `Interpolation.cpp`. Compared with projects of 2.3.11 and 2.3.12 in Natron's public tests.
//!
//! Limits: an open part is a curve that is not closed yet, and has no matte: Natron would paint an open curve with a brush.
//! Projects are long: six numbers with a key each for every point, and as many for its feather.

use super::archive::{Archive, Class};
use super::coordinate;
use super::knot::Knot;
use super::names::written;
use super::natron::MOST_FALLOFF;
use super::outlines::{Detail, Keys, Outlines, turning};
use super::presence::presence;
use super::xml::plain;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Part, Scene};

/// The version of Boost's library that Natron 2.3.12 was built with.
const BOOST: u32 = 16;
/// How Natron numbers the ways from a key to the next.
const STEP: u32 = 0;
const LINEAR: u32 = 1;
/// The life time *Custom*, by its place in the list.
const CUSTOM: u32 = 4;
/// Natron's own formats come before those of a project; it goes by the label, and by the number only without one.
const FORMATS: usize = 20;

const PROJECT: Class = Class("ProjectSerialization", 6);
const NODES: Class = Class("NodeCollectionSerialization", 1);
const NODE: Class = Class("NodeSerialization", 15);
const INPUTS: Class = Class("map of texts", 0);
const CONTEXT: Class = Class("RotoContextSerialization", 2);
const LAYER: Class = Class("RotoLayerSerialization", 2);
const ITEM: Class = Class("RotoItemSerialization", 2);
const DRAWABLE: Class = Class("RotoDrawableItemSerialization", 4);
const BEZIER: Class = Class("BezierSerialization", 4);
const CONTROL_POINT: Class = Class("BezierCP", 4);
const CURVE: Class = Class("Curve", 0);
const KEYS: Class = Class("set of KeyFrame", 0);
const KEY: Class = Class("KeyFrame", 0);
const PARAMETER: Class = Class("KnobSerialization", 14);
const VALUE: Class = Class("ValueSerialization", 7);
const NAMES: Class = Class("list of texts", 0);
/// A list of the class `ImageComponents`, whose version is 2.
const PLANES: Class = Class("list of ImageComponents", 0);
const FORMAT_LIST: Class = Class("list of Format", 0);
const FORMAT: Class = Class("Format", 3);
const RECTANGLE: Class = Class("RectI", 0);

/// A time and a value.
type Key = (FrameNumber, f64);

/// The scene's parts as a project of Natron. `detail` says how they follow snapped paths.
pub fn natron_project(scene: &Scene, detail: impl Into<Detail>) -> String {
    let detail = detail.into();
    let mut out = Archive::new(BOOST);
    out.flag("Background_project", true);
    out.object("Project", PROJECT, |out| {
        for (tag, number) in [("VersionMajor", 2), ("VersionMinor", 3), ("VersionRev", 12)] {
            out.value(tag, number);
        }
        for (tag, text) in [("GitBranch", ""), ("GitCommit", ""), ("OS", "Linux")] {
            out.text(tag, text);
        }
        out.value("Bits", 64);
        out.object("NodesCollection", NODES, |out| {
            out.value("NodesCount", 1);
            out.object("item", NODE, |out| node(out, scene, detail));
        });
        settings(out, &scene.footage);
        out.value("Timeline_current_time", scene.footage.first);
        // When the project was made. The same document gives the same bytes.
        out.value("CreationDate", 0);
    });
    out.finish()
}

/// The project's format, frames and rate.
fn settings(out: &mut Archive, footage: &Footage) {
    let label = format!("{}x{}", footage.width, footage.height);
    out.value("ProjectKnobsCount", 3);
    parameter(out, "item", "outputFormat", "Choice", &[Value::still(FORMATS, 0)], Some(&label));
    let range = [footage.first, footage.last].map(|frame| Value::still(frame, 1));
    parameter(out, "item", "frameRange", "Int", &range, None);
    parameter(out, "item", "frameRate", "Double", &[Value::still(footage.fps, 24)], None);
    out.container("AdditionalFormats", FORMAT_LIST, 1, FORMAT.1, |out| {
        out.object("item", FORMAT, |out| {
            out.object("RectI", RECTANGLE, |out| {
                out.value("Left", 0);
                out.value("Bottom", 0);
                out.value("Right", footage.width);
                out.value("Top", footage.height);
            });
            out.value("Pixel_aspect_ratio", 1);
            out.text("Name", "");
        });
    });
}

/// The Roto node.
fn node(out: &mut Archive, scene: &Scene, detail: Detail) {
    out.text("Plugin_label", "Rototoon");
    out.text("Plugin_script_name", "Roto1");
    out.text("Plugin_id", "fr.inria.built-in.Roto");
    out.text("PythonModule", "");
    out.value("PythonModuleVersion", 0);
    out.value("Plugin_major_version", 1);
    out.value("Plugin_minor_version", 0);
    out.value("KnobsCount", 0);
    out.container("Inputs_map", INPUTS, 0, 0, |_| ());
    out.value("KnobsAge", 0);
    out.text("MasterNode", "");
    out.flag("HasRotoContext", true);
    out.object("RotoContext", CONTEXT, |out| context(out, scene, detail));
    out.flag("HasTrackerContext", false);
    out.text("MultiInstanceParent", "");
    for tag in ["UserPagesCount", "PagesCount", "Children"] {
        out.value(tag, 0);
    }
    out.container("UserComponents", PLANES, 0, 2, |_| ());
    out.text("CacheID", "Roto1");
}

/// The shapes of the node.
fn context(out: &mut Archive, scene: &Scene, detail: Detail) {
    let footage = &scene.footage;
    let contours = |index: usize| Outlines::new(&scene.parts[index], detail).within(footage.first, footage.last);
    let names = written(scene, plain);
    let farthest_first = super::nearest_first(scene).into_iter().rev();
    let shapes: Vec<_> = farthest_first.map(|index| (index, contours(index))).filter(|(_, k)| !k.is_empty()).collect();
    out.object("BaseLayer", LAYER, |out| {
        item(out, "Layer1", "Layer1", "");
        out.value("NumChildren", shapes.len());
        for (number, (index, keys)) in shapes.iter().enumerate() {
            // A closed curve, as opposed to a paint stroke or a layer.
            out.value("Type", 0);
            let colour = scene.parts[*index].shown_colour(*index).map(f64::from);
            let script_name = format!("Bezier{}", number + 1);
            out.object("Item", BEZIER, |out| {
                out.object("RotoDrawableItemSerialization", DRAWABLE, |out| {
                    let both = (script_name.as_str(), names[*index].as_str());
                    drawable(out, both, &scene.parts[*index], keys, footage, colour);
                });
                points(out, &turning(keys), footage.height as f64);
                out.flag("Closed", scene.parts[*index].closed);
                out.flag("OpenBezier", false);
            });
        }
    });
    out.flag("AutoKeying", true);
    out.flag("RippleEdit", false);
    out.flag("FeatherLink", true);
    out.container("Selection", NAMES, 0, 0, |_| ());
}

/// What all items of a node have: the name for scripts, the label for users, and the layer.
fn item(out: &mut Archive, name: &str, label: &str, layer: &str) {
    out.object("RotoItemSerialization", ITEM, |out| {
        out.text("Name", name);
        out.text("Label", label);
        out.flag("Activated", true);
        out.text("ParentLayer", layer);
        out.flag("Locked", false);
    });
}

/// What curves share with paint strokes: names, parameters, and the colour in which the viewer shows it.
fn drawable(
    out: &mut Archive,
    (name, label): (&str, &str),
    part: &Part,
    keys: &Keys,
    footage: &Footage,
    [red, green, blue]: [f64; 3],
) {
    item(out, name, label, "Layer1");
    let active = activity(part, keys, footage);
    let rate = part.falloff.rate.min(MOST_FALLOFF);
    let count = if active.is_empty() { 1 } else { 3 };
    out.value("NbItems", if rate == 1.0 { count } else { count + 1 });
    parameter(out, "Item", "feather", "Double", &[Value::still(0, 1.5)], None);
    if rate != 1.0 {
        parameter(out, "Item", "featherFallOff", "Double", &[Value::still(rate, 1)], None);
    }
    if !active.is_empty() {
        parameter(out, "Item", "lifeTime", "Choice", &[Value::still(CUSTOM, 0)], Some("Custom"));
        let value = Value { keys: &active, ..Value::still(active[0].1, 1) };
        parameter(out, "Item", "activated", "Bool", &[value], None);
    }
    for (tag, value) in [("OC.r", red), ("OC.g", green), ("OC.b", blue), ("OC.a", 1.0)] {
        out.value(tag, value);
    }
}

/// Keys of the parameter that says whether a curve is active; none if it always is.
fn activity<T>(part: &Part, keys: &[(FrameNumber, T)], footage: &Footage) -> Vec<Key> {
    let changes = presence(part, keys, footage);
    if changes.len() < 2 {
        return Vec::new();
    }
    changes.into_iter().map(|(frame, there)| (frame, f64::from(u8::from(there)))).collect()
}

/// A value of a parameter.
struct Value<'a> {
    value: String,
    default: String,
    /// Its keys; the value counts without any.
    keys: &'a [Key],
}

impl Value<'_> {
    fn still(value: impl ToString, default: impl ToString) -> Self {
        Self { value: value.to_string(), default: default.to_string(), keys: &[] }
    }
}

/// A parameter of a type, with a value for each dimension. A choice has the label that is chosen.
fn parameter(out: &mut Archive, tag: &str, name: &str, kind: &str, values: &[Value], label: Option<&str>) {
    out.object(tag, PARAMETER, |out| {
        out.text("Name", name);
        out.text("Type", kind);
        out.value("Dimension", values.len());
        out.flag("Secret", false);
        out.flag("MasterIsAlias", false);
        for value in values {
            out.object("item", VALUE, |out| {
                out.flag("Enabled", true);
                out.flag("HasAnimation", !value.keys.is_empty());
                if !value.keys.is_empty() {
                    curve(out, "Curve", value.keys, STEP);
                }
                out.value("Value", &value.value);
                out.value("Default", &value.default);
                out.flag("HasMaster", false);
                out.text("Expression", "");
                out.flag("ExprHasRet", false);
            });
        }
        if let Some(label) = label {
            out.text("ChoiceLabel", label);
        }
        out.flag("UserKnob", false);
    });
}

/// The control points, each with the feather's point. `height` turns y up.
fn points(out: &mut Archive, keys: &Keys, height: f64) {
    let count = keys[0].1.len();
    out.value("NumPoints", count);
    for index in 0..count {
        // As scripts take them, so both ways give the same shape.
        let rounded = |value: f64| coordinate(value).parse().unwrap_or(value);
        let channels = |place: &dyn Fn(&Knot) -> Point| -> [Vec<Key>; 2] {
            let of = |value: &dyn Fn(Point) -> f64| {
                keys.iter().map(|(frame, knots)| (*frame, rounded(value(place(&knots[index]))))).collect()
            };
            [of(&|p| p.x), of(&|p| height - p.y)]
        };
        let places =
            [channels(&|knot| knot.at), channels(&|knot| knot.handles()[0]), channels(&|knot| knot.handles()[1])];
        for tag in ["CP", "FP"] {
            out.object(tag, CONTROL_POINT, |out| {
                for (place, channels) in ["", "Left_", "Right_"].into_iter().zip(&places) {
                    for (axis, keys) in ["X", "Y"].into_iter().zip(channels) {
                        out.value(&format!("{place}{axis}"), keys[0].1);
                        curve(out, &format!("{place}{axis}_animation"), keys, LINEAR);
                    }
                }
            });
        }
    }
}

/// Keys with the derivatives on both sides, in units a frame: Natron reads them and does not compute them anew.
fn curve(out: &mut Archive, tag: &str, keys: &[Key], interpolation: u32) {
    let slope = |a: Option<&Key>, b: Option<&Key>| match (a, b) {
        (Some(a), Some(b)) if interpolation == LINEAR => (b.1 - a.1) / (f64::from(b.0) - f64::from(a.0)),
        _ => 0.0,
    };
    out.object(tag, CURVE, |out| {
        out.container("KeyFrameSet", KEYS, keys.len(), KEY.1, |out| {
            for (index, key) in keys.iter().enumerate() {
                let before = index.checked_sub(1).and_then(|index| keys.get(index));
                out.object("item", KEY, |out| {
                    out.value("Time", key.0);
                    out.value("Value", key.1);
                    out.value("InterpolationMethod", interpolation);
                    out.value("LeftDerivative", slope(before, Some(key)));
                    out.value("RightDerivative", slope(Some(key), keys.get(index + 1)));
                });
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::natron::natron as read;
    use std::collections::BTreeMap;

    fn scene() -> Scene {
        let at = |x: f64| vec![Point::new(x, 2.0), Point::new(8.0, 2.25), Point::new(8.125, 30.0)];
        let part = |name: &str, depth, closed, keys: &[(FrameNumber, f64)]| Part {
            name: name.into(),
            closed,
            depth,
            keys: keys.iter().map(|&(frame, x)| (frame, at(x))).collect::<BTreeMap<_, _>>(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d".into(), first: 1, last: 9, fps: 12.5, width: 40, height: 32, held: false };
        let parts = vec![
            part("near", 2.0, false, &[(1, 0.5), (3, 4.5), (9, -7.25)]),
            part("Größe <1> & \"2\"", 0.0, true, &[(3, 1.0 / 3.0), (4, 2.0)]),
            part("nothing", 1.0, true, &[]),
        ];
        Scene { footage, parts }
    }

    #[test]
    fn the_own_reader_finds_the_same_shapes_in_order() {
        let scene = scene();
        let found = read(&natron_project(&scene, 1.0), &scene.footage, 0).unwrap();
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        let names: Vec<_> = found.shapes.iter().map(|shape| (&shape.name[..], shape.closed)).collect();
        assert_eq!(names, [("Größe <1> & \"2\"", true), ("near", false)]);
        for (shape, part) in found.shapes.iter().zip([&scene.parts[1], &scene.parts[0]]) {
            assert!(shape.keys.keys().eq(part.keys.keys()));
            for (frame, points) in &part.keys {
                let off = points.iter().zip(&shape.keys[frame]).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
                assert!(off < 1e-4, "{frame}: {off}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_straight_lines_and_ends_have_none() {
        let text = natron_project(&scene(), 1.0);
        // x of the near part: 0.5, 4.5 after two frames, −7.25 after six more.
        let key = |time: i32, value: &str, left: &str, right: &str| {
            format!(
                "<Time>{time}</Time>\n<Value>{value}</Value>\n<InterpolationMethod>1</InterpolationMethod>\n\
                 <LeftDerivative>{left}</LeftDerivative>\n<RightDerivative>{right}</RightDerivative>\n"
            )
        };
        let slope = (-7.25 - 4.5) / 6.0;
        for wanted in
            [key(1, "0.5", "0", "2"), key(3, "4.5", "2", &slope.to_string()), key(9, "-7.25", &slope.to_string(), "0")]
        {
            // Point and handles, and those of the feather.
            assert_eq!(text.matches(&wanted).count(), 6, "{wanted}");
        }
    }

    #[test]
    fn a_part_is_active_while_it_has_contours() {
        let footage = scene().footage;
        let part = Part { absent: vec![[5, 6]], ..Part::default() };
        let of = |begin, end| activity(&part, &[begin, end].map(|frame| (frame, vec![Point::ONE])), &footage);
        assert_eq!(of(1, 4), [(1, 1.0), (5, 0.0)]);
        assert_eq!(of(3, 4), [(1, 0.0), (3, 1.0), (5, 0.0)]);
        assert_eq!(of(7, 9), [(1, 0.0), (7, 1.0)]);
        assert_eq!(of(1, 9), [(1, 1.0), (5, 0.0), (7, 1.0)]);
        assert_eq!(activity(&Part::default(), &[(1, vec![Point::ONE]), (9, vec![Point::ONE])], &footage), []);
        let text = natron_project(&scene(), 1.0);
        assert_eq!(text.matches("<ChoiceLabel>Custom</ChoiceLabel>").count(), 1);
    }
}
