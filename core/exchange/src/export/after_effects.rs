//! Shapes for After Effects: a script (`.jsx`) that makes masks.
//!
//! The text of keys on the clipboard is public for numbers only: no public example or description has mask paths in it.
//! So the masks come by After Effects' documented scripts. The script adds a mask for each part to the layer that is
//! selected, which must have the footage's size. If no layer is selected, it makes a composition with a white solid. All of
//! it is one step of undo.
//!
//! A mask has a key of its path on every frame on which the part has a contour. A part that has nothing but keys goes evenly from one to the next. Tangents are relative to their vertices; a part with
//! straight sides has none. Coordinates are those of the layer: pixels with x right and y down from the upper
//! left corner, as in the footage. Times are seconds from the layer's start. The nearest part is the uppermost mask.
//! A feather is smooth in After Effects, or linear where the part's falloff is. Where a part has no contour, the opacity of its mask is 0; its keys hold.
//!
//! Source: After Effects scripting guide (`Shape`, `MaskPropertyGroup`, `Property.setValuesAtTimes`).
//!
//! Limits: masks do not order parts in depth, they are united. An open part becomes an open mask, which has no matte. A
//! layer whose time is remapped or stretched is refused, because its frames are not those of the footage.

use super::coordinate;
use super::knot::Knot;
use super::outlines::{Keys, Outlines, ShapeOptions};
use rototoon_base::scene::{FalloffCurve, FrameNumber, Part, Scene};
use std::fmt::Write;

/// What comes before the shapes. They are JSON, so that other programs can read them too.
const HEAD: &str = "// Shapes of Rototoon for After Effects. Select the footage's layer, and run this file: File > Scripts > Run Script File.
// It adds a mask for each part. If no layer is selected, it makes a composition with a solid.

// Size, width of a pixel by its height, frame rate and number of frames of the footage; for each part its name, whether it is closed, its colour, and by
// frame, counted from 0, x and y of each point in pixels with y down. Parts have no contour on other frames. If a part is bent, each
// point is followed by x and y of the tangents before and after it, relative to the point.
var ROTOTOON = ";

const CODE: &str = r#";

function rototoonLayer(comp) {
    var layer = comp.selectedLayers[0];
    if (comp.selectedLayers.length > 1) {
        throw new Error("select one layer, not " + comp.selectedLayers.length);
    }
    if (layer.width !== ROTOTOON.width || layer.height !== ROTOTOON.height) {
        throw new Error("the layer has " + layer.width + " x " + layer.height + " pixels, the footage has "
            + ROTOTOON.width + " x " + ROTOTOON.height);
    }
    if (layer.timeRemapEnabled || layer.stretch !== 100) {
        throw new Error("the layer's time is remapped or stretched");
    }
    return layer;
}

function rototoonNewLayer() {
    var seconds = ROTOTOON.frames / ROTOTOON.fps;
    var comp = app.project.items.addComp("Rototoon", ROTOTOON.width, ROTOTOON.height, ROTOTOON.pixelAspect, seconds, ROTOTOON.fps);
    comp.openInViewer();
    return comp.layers.addSolid([1, 1, 1], "Rototoon", ROTOTOON.width, ROTOTOON.height, ROTOTOON.pixelAspect, seconds);
}

function rototoonShape(part, numbers) {
    var shape = new Shape(), vertices = [], before = [], after = [], size = part.bent ? 6 : 2;
    for (var k = 0; k < numbers.length; k += size) {
        vertices.push([numbers[k], numbers[k + 1]]);
        if (part.bent) {
            before.push([numbers[k + 2], numbers[k + 3]]);
            after.push([numbers[k + 4], numbers[k + 5]]);
        }
    }
    shape.vertices = vertices;
    if (part.bent) {
        shape.inTangents = before;
        shape.outTangents = after;
    }
    shape.closed = part.closed;
    return shape;
}

function rototoonMask(layer, part) {
    var mask = layer.property("ADBE Mask Parade").addProperty("ADBE Mask Atom");
    var path = mask.property("ADBE Mask Shape"), opacity = mask.property("ADBE Mask Opacity");
    var times = [], shapes = [], shown = [], values = [], last = -1;
    function time(frame) {
        return layer.startTime + frame / ROTOTOON.fps;
    }
    function show(frame, value) {
        shown.push(time(frame));
        values.push(value);
    }
    for (var k = 0; k < part.frames.length; k += 1) {
        var frame = part.frames[k][0];
        times.push(time(frame));
        shapes.push(rototoonShape(part, part.frames[k][1]));
        if (frame > last + 1) {
            show(last + 1, 0);
        }
        if (k === 0 || frame > last + 1) {
            show(frame, 100);
        }
        last = frame;
    }
    if (last + 1 < ROTOTOON.frames) {
        show(last + 1, 0);
    }
    mask.name = part.name;
    mask.color = part.color;
    if (part.falloff === "linear") {
        mask.maskFeatherFalloff = MaskFeatherFalloff.FFO_LINEAR;
    }
    mask.maskMode = part.closed ? MaskMode.ADD : MaskMode.NONE;
    path.setValuesAtTimes(times, shapes);
    if (shown.length > 1) {
        opacity.setValuesAtTimes(shown, values);
        for (var key = 1; key <= shown.length; key += 1) {
            opacity.setInterpolationTypeAtKey(key, KeyframeInterpolationType.HOLD, KeyframeInterpolationType.HOLD);
        }
    }
}

function rototoonMasks() {
    var comp = app.project.activeItem;
    var selected = comp !== null && comp instanceof CompItem && comp.selectedLayers.length > 0;
    var layer = selected ? rototoonLayer(comp) : rototoonNewLayer();
    for (var k = 0; k < ROTOTOON.parts.length; k += 1) {
        rototoonMask(layer, ROTOTOON.parts[k]);
    }
}

app.beginUndoGroup("Rototoon masks");
try {
    rototoonMasks();
} catch (error) {
    alert("Rototoon: " + error.message);
} finally {
    app.endUndoGroup();
}
"#;

/// The scene's parts as a script for After Effects. `options` say how they follow snapped paths, and how wide the pixels are.
pub fn after_effects(scene: &Scene, options: impl Into<ShapeOptions>) -> String {
    let ShapeOptions { detail, pixel_aspect } = options.into();
    let footage = &scene.footage;
    let frames = i64::from(footage.last) - i64::from(footage.first) + 1;
    let (width, height, fps) = (footage.width, footage.height, footage.fps);
    let mut out = String::from(HEAD);
    let _ = write!(
        out,
        "{{\"width\": {width}, \"height\": {height}, \"pixelAspect\": {pixel_aspect}, \"fps\": {fps}, \"frames\": {frames}, \"parts\": ["
    );
    let mut any = false;
    for index in super::nearest_first(scene) {
        let outlines = Outlines::new(&scene.parts[index], detail);
        let keys = outlines.shown_within(footage.first, footage.last);
        if keys.is_empty() {
            continue;
        }
        out += if any { ",\n" } else { "\n" };
        any = true;
        part(&mut out, (&scene.parts[index], index), footage.first, (&keys, outlines.bent()));
    }
    out + "\n]}" + CODE
}

fn part(out: &mut String, (part, index): (&Part, usize), first: FrameNumber, (keys, bent): (&Keys, bool)) {
    let [r, g, b] = part.shown_colour(index);
    let (name, closed) = (literal(&part.name), part.closed);
    let linear = part.falloff.curve == Some(FalloffCurve::Linear);
    let falloff = if linear { "\"falloff\": \"linear\", " } else { "" };
    let kind = if bent { "\"bent\": true, " } else { "" };
    let _ = write!(
        out,
        "{{\"name\": {name}, \"closed\": {closed}, \"color\": [{r:.3}, {g:.3}, {b:.3}], {falloff}{kind}\"frames\": ["
    );
    let places = |knot: &Knot| if bent { vec![knot.at, knot.before, knot.after] } else { vec![knot.at] };
    for (k, (frame, knots)) in keys.iter().enumerate() {
        let frame = i64::from(*frame) - i64::from(first);
        *out += if k > 0 { ",\n  " } else { "\n  " };
        let numbers = knots.iter().flat_map(places).flat_map(|p| [coordinate(p.x), coordinate(p.y)]);
        let _ = write!(out, "[{frame}, [{}]]", numbers.collect::<Vec<_>>().join(", "));
    }
    *out += "]}";
}

/// A text for JavaScript and JSON, in ASCII.
fn literal(text: &str) -> String {
    let mut out = String::from("\"");
    for unit in text.encode_utf16() {
        match char::from_u32(unit.into()) {
            Some(c @ ('"' | '\\')) => out.extend(['\\', c]),
            Some(c @ ' '..='~') => out.push(c),
            _ => {
                let _ = write!(out, "\\u{unit:04x}");
            }
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Footage;
    use std::collections::BTreeMap;

    #[test]
    fn shapes_come_nearest_first_with_frames_from_zero() {
        let at = |x: f64| vec![Point::new(x, 2.0), Point::new(8.0, 2.0), Point::new(8.125, -0.00001)];
        let part = |name: &str, depth, closed| Part {
            name: name.into(),
            closed,
            depth,
            keys: BTreeMap::from([(11, at(0.5)), (13, at(1.0 / 3.0))]),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d".into(), first: 10, last: 15, fps: 12.5, width: 40, height: 30, held: false };
        let parts = vec![part("far", 0.0, true), part("near", 2.0, false), Part::default()];
        let text = after_effects(&Scene { footage, parts }, 1.0);
        let wanted = "{\"width\": 40, \"height\": 30, \"pixelAspect\": 1, \"fps\": 12.5, \"frames\": 6, \"parts\": [
{\"name\": \"near\", \"closed\": false, \"color\": ";
        assert!(text.contains(wanted), "{text}");
        assert!(
            text.contains(
                "\"frames\": [\n  [1, [0.5, 2, 8, 2, 8.125, 0]],\n  [2, [0.4167, 2, 8, 2, 8.125, 0]],\n  [3, [0.3333, 2, 8, 2, 8.125, 0]]]}"
            ),
            "{text}"
        );
        assert!(text.is_ascii());
    }

    #[test]
    fn a_scene_without_contours_is_an_empty_list() {
        let footage = Footage { pattern: "%d".into(), first: 0, last: 0, fps: 24.0, width: 4, height: 3, held: false };
        let text = after_effects(&Scene { footage, parts: vec![Part::default()] }, 1.0);
        assert!(text.contains("\"parts\": [\n]};"), "{text}");
    }

    #[test]
    fn names_are_texts_of_javascript() {
        assert_eq!(literal("a\\\"b\n"), "\"a\\\\\\\"b\\u000a\"");
        assert_eq!(literal("Größe 🦊"), "\"Gr\\u00f6\\u00dfe \\ud83e\\udd8a\"");
    }
}
