//! Shapes for Fusion (`.setting`): one Polygon mask for each part.
//!
//! The file is a table of Lua as Fusion puts it on the clipboard. A part becomes a `PolylineMask`, nearest first, and a `BezierSpline` whose keys
//! carry its shapes. The spline's own number counts the keys, from 0: between two keys it says how far the one shape has become the other. So a
//! contour that is held needs keys at its ends only. Where the part is not there, the level of its mask is 0. That spline goes evenly too: it has keys
//! on the frame of a change and on the one before it, so whole frames are exact.
//!
//! Coordinates begin in the middle of the picture, x to the right and y up; the unit is the width of the picture for x, and its height for
//! y. Points with straight sides are linear, without handles; those of curves have handles (`LX`, `LY` before
//! the point, `RX`, `RY` after it), relative to the point. The key frames are those of the document.
//!
//! Names of tools have letters of English, digits and underscores, and begin with none of the digits.
//!
//! Source: the makers have not published the format. This module writes what saved settings of Fusion and Resolve show.
//!
//! Limits: masks are not connected to each other or to a tool; which goes where is the compositor's choice. A soft edge is a number of the
//! whole mask in Fusion and is left at 0. Fusion itself has not been tried.

use super::knot::Knot;
use super::names::joined;
use super::outlines::{Keys, Outlines, ShapeOptions, turning};
use super::presence::presence;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Scene};
use std::fmt::Write;

/// Distance of two tools in the flow: the width of a tile, and room for its name.
const STEP: usize = 110;
/// Tools in a row of the flow.
const ROW: usize = 8;

/// The scene's parts as a setting of Fusion. `options` say how they follow snapped paths, and how wide the pixels are.
pub fn fusion(scene: &Scene, options: impl Into<ShapeOptions>) -> String {
    let ShapeOptions { detail, pixel_aspect } = options.into();
    let names = joined(scene, "_", plain);
    let mut tools = Vec::new();
    for index in super::nearest_first(scene) {
        let outlines = Outlines::new(&scene.parts[index], detail);
        let keys = outlines.within(scene.footage.first, scene.footage.last);
        if !keys.is_empty() {
            let at = (STEP * (tools.len() % ROW), STEP / 2 * (tools.len() / ROW));
            tools.push(tool(scene, (index, &names), (&keys, outlines.bent(), pixel_aspect), at));
        }
    }
    format!("{{\n\tTools = ordered() {{\n{}\n\t}}\n}}\n", tools.join(",\n"))
}

/// A name in the characters of Fusion.
pub(super) fn plain(name: &str) -> String {
    let mut out: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if out.starts_with(|c: char| c.is_ascii_digit()) {
        out.insert(0, '_');
    }
    out
}

/// The name of a spline that belongs to a mask. No mask has it.
fn companion(names: &[String], index: usize, what: &str) -> String {
    let mut name = format!("{}{what}", names[index]);
    while names.contains(&name) {
        name.push('_');
    }
    name
}

/// A part's mask and its splines.
fn tool(
    scene: &Scene,
    (index, names): (usize, &[String]),
    (keys, bent, pixel_aspect): (&Keys, bool, f64),
    (left, top): (usize, usize),
) -> String {
    let (part, footage, name) = (&scene.parts[index], &scene.footage, &names[index]);
    let (shape, level) = (companion(names, index, "Polyline"), companion(names, index, "Level"));
    let changes = presence(part, keys, footage);
    let linked = |spline: &str| {
        format!("Input {{\n\t\t\t\t\tSourceOp = \"{spline}\",\n\t\t\t\t\tSource = \"Value\",\n\t\t\t\t}}")
    };
    let mut inputs = vec![
        ("OutputSize", "Input { Value = FuID { \"Custom\" }, }".to_owned()),
        ("MaskWidth", format!("Input {{ Value = {}, }}", footage.width)),
        ("MaskHeight", format!("Input {{ Value = {}, }}", footage.height)),
        ("PixelAspect", format!("Input {{ Value = {{ {pixel_aspect}, 1 }}, }}")),
        ("ClippingMode", "Input { Value = FuID { \"None\" }, }".to_owned()),
        ("Polyline", linked(&shape)),
        ("Polyline2", "Input { Value = Polyline { }, Disabled = true, }".to_owned()),
    ];
    if changes.len() > 1 {
        inputs.insert(0, ("Level", linked(&level)));
    }
    let [r, g, b] = part.shown_colour(index).map(|value| super::coordinate(value.into()));
    let mut out = format!(
        "\t\t{name} = PolylineMask {{\n\t\t\tDrawMode = \"ModifyOnly\",\n\t\t\tDrawMode2 = \"InsertAndModify\",\n"
    );
    out += "\t\t\tCtrlWZoom = false,\n\t\t\tNameSet = true,\n\t\t\tInputs = {\n";
    for (id, value) in inputs {
        let _ = writeln!(out, "\t\t\t\t{id} = {value},");
    }
    let _ = writeln!(out, "\t\t\t}},\n\t\t\tViewInfo = OperatorInfo {{ Pos = {{ {left}, {top} }} }},");
    let _ = writeln!(out, "\t\t\tColors = {{ TileColor = {{ R = {r}, G = {g}, B = {b} }} }}\n\t\t}},");
    let shapes = turning(keys);
    let shape_of = |knots: &[Knot]| polyline(knots, bent, part.closed, footage);
    let shapes = shapes.iter().enumerate().map(|(k, (frame, knots))| (*frame, k, Some(shape_of(knots))));
    out += &spline(&shape, shapes);
    if changes.len() > 1 {
        out += ",\n";
        out += &spline(&level, levels(&changes).into_iter().map(|(frame, level)| (frame, level, None)));
    }
    out
}

/// The keys of a mask's level: those of its changes, and before each the level until then.
fn levels(changes: &[(FrameNumber, bool)]) -> Vec<(FrameNumber, usize)> {
    let mut keys: Vec<(FrameNumber, usize)> = Vec::new();
    for &(frame, there) in changes {
        if let Some(&(earlier, before)) = keys.last()
            && earlier < frame - 1
        {
            keys.push((frame - 1, before));
        }
        keys.push((frame, usize::from(there)));
    }
    keys
}

/// A spline with linear keys: frame, number, and the shape that comes with it.
fn spline(name: &str, keys: impl Iterator<Item = (FrameNumber, usize, Option<String>)>) -> String {
    let key = |(frame, number, shape): (FrameNumber, usize, Option<String>)| match shape {
        Some(shape) => {
            format!("\t\t\t\t[{frame}] = {{ {number}, Flags = {{ Linear = true, LockedY = true }}, Value = {shape} }}")
        }
        None => format!("\t\t\t\t[{frame}] = {{ {number}, Flags = {{ Linear = true }} }}"),
    };
    let keys: Vec<String> = keys.map(key).collect();
    let head = "SplineColor = { Red = 173, Green = 255, Blue = 47 },\n\t\t\tNameSet = true,";
    format!("\t\t{name} = BezierSpline {{\n\t\t\t{head}\n\t\t\tKeyFrames = {{\n{}\n\t\t\t}}\n\t\t}}", keys.join(",\n"))
}

/// A shape. Points of bent ones have handles, also where these are 0, so that a point has one kind on all frames.
fn polyline(knots: &[Knot], bent: bool, closed: bool, footage: &Footage) -> String {
    let size = Point::new(footage.width as f64, footage.height as f64) * Point::new(1.0, -1.0);
    let kind = if bent { "" } else { "Linear = true, " };
    let point = |knot: &Knot| {
        let at = knot.at / size + Point::new(-0.5, 0.5);
        let [[x, y], [lx, ly], [rx, ry]] =
            [at, knot.before / size, knot.after / size].map(|p| [number(p.x), number(p.y)]);
        format!("\t\t\t\t\t{{ {kind}X = {x}, Y = {y}, LX = {lx}, LY = {ly}, RX = {rx}, RY = {ry} }}")
    };
    let points: Vec<String> = knots.iter().map(point).collect();
    let closed = if closed { "Closed = true, " } else { "" };
    format!("Polyline {{ {closed}Points = {{\n{}\n\t\t\t\t}} }}", points.join(",\n"))
}

/// A coordinate to a hundred millionth: a ten-thousandth of a pixel at 10 000 lines.
fn number(value: f64) -> f64 {
    // −0 becomes 0.
    (value * 1e8).round() / 1e8 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Part;
    use std::collections::BTreeMap;

    fn scene(parts: Vec<Part>) -> Scene {
        let footage =
            Footage { pattern: "%d".into(), first: 10, last: 19, fps: 12.5, width: 40, height: 32, held: false };
        Scene { footage, parts }
    }

    fn part(name: &str, keys: &[(FrameNumber, f64)]) -> Part {
        let at = |x: f64| vec![Point::new(x, 0.0), Point::new(20.0, 32.0), Point::new(0.0, 16.0)];
        let keys: BTreeMap<_, _> = keys.iter().map(|&(frame, x)| (frame, at(x))).collect();
        Part { name: name.into(), closed: true, tracks: keys.clone(), keys, ..Part::default() }
    }

    /// The keys of a spline: frame, number, and the coordinates of its shape.
    fn keys(text: &str, name: &str) -> Vec<(FrameNumber, usize, Vec<f64>)> {
        let spline =
            text.split(&format!("\t\t{name} = BezierSpline")).nth(1).unwrap().split("BezierSpline").next().unwrap();
        let parts = spline.split("\t\t\t\t[").skip(1);
        let key = |part: &str| {
            let (frame, rest) = part.split_once("] = { ").unwrap();
            let (number, rest) = rest.split_once(',').unwrap();
            let words: Vec<&str> = rest.split([' ', ',']).collect();
            let of = |id: &str| {
                words
                    .windows(3)
                    .filter(|three| three[0] == id && three[1] == "=")
                    .map(|three| three[2])
                    .collect::<Vec<_>>()
            };
            let both = of("X").into_iter().zip(of("Y")).flat_map(|(x, y)| [x, y]);
            (frame.parse().unwrap(), number.parse().unwrap(), both.map(|number| number.parse().unwrap()).collect())
        };
        parts.map(key).collect()
    }

    #[test]
    fn a_part_becomes_a_mask_with_a_key_where_its_contour_turns() {
        let held: Vec<_> = (10..20).map(|frame| (frame, if frame < 18 { 10.0 } else { 30.0 })).collect();
        let text = fusion(&scene(vec![part("arm", &held)]), 1.0);
        let at = |x: f64| vec![x, 0.5, 0.0, -0.5, -0.5, 0.0];
        let expected = [(10, 0, at(-0.25)), (17, 1, at(-0.25)), (18, 2, at(0.25)), (19, 3, at(0.25))];
        assert_eq!(keys(&text, "armPolyline"), expected);
        assert!(text.contains("arm = PolylineMask {") && text.contains("MaskWidth = Input { Value = 40, }"), "{text}");
        assert!(
            text.contains("SourceOp = \"armPolyline\"") && text.contains("Closed = true") && !text.contains("Level"),
            "{text}"
        );
        assert_eq!(text.matches('{').count(), text.matches('}').count());
        let open = Part { closed: false, ..part("arm", &[(10, 1.0), (19, 2.0)]) };
        assert!(!fusion(&scene(vec![open]), 1.0).contains("Closed"));
    }

    #[test]
    fn the_level_is_0_where_the_part_is_not_there() {
        let text = fusion(&scene(vec![part("arm", &[(12, 1.0), (13, 1.0), (16, 2.0)])]), 1.0);
        let level: Vec<_> = keys(&text, "armLevel").into_iter().map(|(frame, level, _)| (frame, level)).collect();
        // Between whole frames it goes evenly: each change has a key on the frame before it.
        assert_eq!(level, [(10, 0), (11, 0), (12, 1), (13, 1), (14, 0), (15, 0), (16, 1), (17, 0)]);
        assert!(text.contains("Level = Input {\n\t\t\t\t\tSourceOp = \"armLevel\""), "{text}");
    }

    #[test]
    fn names_are_those_of_tools_each_once() {
        let names = ["große Hand", "2nd", "arm", "armPolyline", "gro_e_Hand"];
        let scene = scene(names.map(|name| part(name, &[(10, 1.0), (19, 2.0)])).into());
        let text = fusion(&scene, 1.0);
        let mut tools: Vec<&str> = text
            .lines()
            .filter_map(|line| line.strip_prefix("\t\t")?.split_once(" = ").filter(|(name, _)| !name.starts_with('\t')))
            .map(|(name, _)| name)
            .collect();
        for name in ["gro_e_Hand_2", "_2nd", "arm", "armPolyline", "armPolyline_", "gro_e_Hand"] {
            assert!(tools.contains(&name), "{name}: {tools:?}");
        }
        let all = tools.len();
        tools.sort_unstable();
        tools.dedup();
        assert_eq!((all, tools.len()), (15, 15), "each has a shape, and a level since it comes and goes");
    }
}
