//! Shapes for Silhouette (`.fxs`).
//!
//! The file is an XML document. One layer contains a Bézier shape for each part, nearest first. A shape has a key of
//! its path on every frame on which the part has a contour, but for those on which it is held: paths go evenly from key to key. Where the part is not there, the opacity of its shape is 0. A point has three places: its own, that of the handle after
//! it, and that of the handle before it. Where sides are straight, both handles are at the point.
//!
//! Coordinates are independent of the resolution: the origin is the middle of the picture, x points right, y down, and
//! the unit is the height of the picture. Where pixels are wider than high, x is wider too. Key frames are counted from the session's first frame, which the root element
//! gives.
//!
//! Source: the makers have not published the format. This module writes what M. Borgo's exporter for Nuke writes;
//! Silhouette reads that.

use super::names::written;
use super::outlines::{Outlines, ShapeOptions, turning};
use super::presence::presence;
use super::xml::{escaped, plain};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Scene};
use std::fmt::Write;

/// Decimals of a coordinate: a hundredth of a pixel at 10 000 lines.
const DECIMALS: usize = 6;

/// The scene's parts as a Silhouette document. `options` say how they follow snapped paths, and how wide the pixels are.
pub fn silhouette(scene: &Scene, options: impl Into<ShapeOptions>) -> String {
    let options = options.into();
    let footage = &scene.footage;
    let mut out = String::from("<!-- Silhouette Shape File -->\n");
    let _ = writeln!(
        out,
        "<Silhouette width=\"{}\" height=\"{}\" pixelAspect=\"{}\" workRangeStart=\"0\" workRangeEnd=\"{}\" sessionStartFrame=\"{}\">",
        footage.width,
        footage.height,
        options.pixel_aspect,
        i64::from(footage.last) - i64::from(footage.first),
        footage.first
    );
    out += " <Layer type=\"Layer\" label=\"Rototoon\" expanded=\"True\">\n  <Properties>\n";
    out += "   <Property id=\"objects\" constant=\"True\" expanded=\"True\">\n";
    let names = written(scene, plain);
    for index in super::nearest_first(scene) {
        shape(&mut out, scene, (index, &names[index]), options);
    }
    out + "   </Property>\n  </Properties>\n </Layer>\n</Silhouette>\n"
}

fn shape(out: &mut String, scene: &Scene, (index, name): (usize, &str), options: ShapeOptions) {
    let part = &scene.parts[index];
    let keys = Outlines::new(part, options.detail).within(scene.footage.first, scene.footage.last);
    if keys.is_empty() {
        return;
    }
    let [r, g, b] = part.shown_colour(index);
    let _ = writeln!(
        out,
        "    <Object type=\"Shape\" label=\"{}\" shape_type=\"Bezier\" hidden=\"False\" locked=\"False\">\n     <Properties>",
        escaped(name)
    );
    *out += &opacity(&presence(part, &keys, &scene.footage), &scene.footage);
    for (id, value) in [
        ("motionBlur", "true".to_owned()),
        ("outlineColor", format!("({r:.3},{g:.3},{b:.3})")),
        ("mode", "Add".to_owned()),
        ("invert", "false".to_owned()),
    ] {
        let _ = writeln!(out, "      <Property constant=\"True\" id=\"{id}\"><Value>{value}</Value></Property>");
    }
    *out += "      <Property id=\"path\">\n";
    let closed = if part.closed { "True" } else { "False" };
    for (frame, knots) in turning(&keys) {
        let frame = i64::from(frame) - i64::from(scene.footage.first);
        let _ =
            writeln!(out, "       <Key frame=\"{frame}\" interp=\"linear\"><Path closed=\"{closed}\" type=\"Bezier\">");
        for knot in knots {
            let [before, after] = knot.handles();
            let [at, after, before] = [knot.at, after, before].map(|p| placed(p, scene, options.pixel_aspect));
            let _ = writeln!(out, "        <Point>{at},{after},{before}</Point>");
        }
        *out += "       </Path></Key>\n";
    }
    *out += "      </Property>\n     </Properties>\n    </Object>\n";
}

/// The opacity of a shape: a number, or keys that hold where the part comes and goes.
fn opacity(changes: &[(FrameNumber, bool)], footage: &Footage) -> String {
    if changes.len() < 2 {
        return "      <Property constant=\"True\" id=\"opacity\"><Value>100</Value></Property>\n".to_owned();
    }
    let mut out = String::from("      <Property id=\"opacity\">\n");
    for (frame, there) in changes {
        let (frame, value) = (i64::from(*frame) - i64::from(footage.first), if *there { 100 } else { 0 });
        let _ = writeln!(out, "       <Key frame=\"{frame}\" interp=\"hold\">{value}</Key>");
    }
    out + "      </Property>\n"
}

fn placed(p: Point, scene: &Scene, aspect: f64) -> String {
    let (width, height) = (scene.footage.width as f64, scene.footage.height as f64);
    let (x, y) = ((p.x - 0.5 * width) / height * aspect, (p.y - 0.5 * height) / height);
    format!("({x:.DECIMALS$},{y:.DECIMALS$})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Part;
    use std::collections::BTreeMap;

    #[test]
    fn a_part_is_transparent_where_it_is_not_there() {
        let at = |x: f64| vec![Point::new(x, 2.0), Point::new(8.0, 2.0), Point::new(8.0, 10.0)];
        let part = Part {
            name: "arm".into(),
            closed: true,
            keys: BTreeMap::from([(12, at(0.5)), (16, at(2.0))]),
            absent: vec![[14, 14]],
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d".into(), first: 10, last: 19, fps: 12.5, width: 40, height: 30, held: false };
        let mut scene = Scene { footage, parts: vec![part] };
        let keys = |text: &str| -> Vec<(String, String)> {
            let found = text
                .split("<Property id=\"opacity\">")
                .nth(1)
                .map_or("", |rest| rest.split("</Property>").next().unwrap());
            let key = |line: &str| {
                let (frame, value) = line.trim().strip_prefix("<Key frame=\"")?.split_once("\" interp=\"hold\">")?;
                Some((frame.to_owned(), value.strip_suffix("</Key>")?.to_owned()))
            };
            found.lines().filter_map(key).collect()
        };
        let expected = [("0", "0"), ("2", "100"), ("4", "0"), ("5", "100"), ("7", "0")];
        assert_eq!(keys(&silhouette(&scene, 1.0)), expected.map(|(frame, value)| (frame.to_owned(), value.to_owned())));
        scene.parts[0].absent.clear();
        scene.footage.first = 12;
        scene.footage.last = 16;
        let text = silhouette(&scene, 1.0);
        assert!(text.contains("<Property constant=\"True\" id=\"opacity\"><Value>100</Value></Property>"), "{text}");
    }

    #[test]
    fn wide_pixels_come_back() {
        let at = vec![Point::new(4.0, 2.0), Point::new(38.0, 2.0), Point::new(8.0, 10.0)];
        let part = Part { name: "arm".into(), keys: BTreeMap::from([(10, at.clone())]), ..Part::default() };
        let footage =
            Footage { pattern: "%d".into(), first: 10, last: 19, fps: 12.5, width: 40, height: 30, held: false };
        let text = silhouette(
            &Scene { footage: footage.clone(), parts: vec![part] },
            ShapeOptions { pixel_aspect: 2.0, ..1.0.into() },
        );
        // A pixel at 4 is 16 left of the middle, and each is as wide as two lines.
        assert!(text.contains("pixelAspect=\"2\"") && text.contains("<Point>(-1.066667,"), "{text}");
        let found = crate::import::silhouette::silhouette(&text, &footage).unwrap();
        assert!(found.shapes[0].keys[&10].iter().zip(&at).all(|(a, b)| a.distance(*b) < 1e-4));
    }

    #[test]
    fn a_held_contour_has_keys_at_its_ends() {
        let at = |x: f64| vec![Point::new(x, 2.0), Point::new(8.0, 2.0), Point::new(8.0, 10.0)];
        let keys = (10..20).map(|frame| (frame, at(if frame < 18 { 0.5 } else { 2.0 }))).collect();
        let part = Part { name: "arm".into(), closed: true, keys, ..Part::default() };
        let footage =
            Footage { pattern: "%d".into(), first: 10, last: 19, fps: 12.5, width: 40, height: 30, held: false };
        let text = silhouette(&Scene { footage, parts: vec![part] }, 1.0);
        let frames: Vec<&str> =
            text.split("<Key frame=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(frames, ["0", "7", "8", "9"]);
    }
}
