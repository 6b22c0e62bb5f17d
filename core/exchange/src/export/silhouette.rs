//! Shapes for Silhouette (`.fxs`).
//!
//! The file is an XML document. One layer contains a Bézier shape for each part, nearest first. A shape has a key of
//! its path on every frame on which the part has a contour. Both handles of a point are at the point, so the sides are
//! straight like those of the part.
//!
//! Coordinates are independent of the resolution: the origin is the middle of the picture, x points right, y down, and
//! the unit is the height of the picture. Key frames are counted from the session's first frame, which the root element
//! gives.
//!
//! Source: the makers have not published the format. This module writes what M. Borgo's exporter for Nuke writes;
//! Silhouette reads that.

use super::outlines::Outlines;
use super::xml::escaped;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Part, Scene};
use std::fmt::Write;

/// Decimals of a coordinate: a hundredth of a pixel at 10 000 lines.
const DECIMALS: usize = 6;

/// The scene's parts as a Silhouette document. Points of snapped paths are about `spacing` pixels apart.
pub fn silhouette(scene: &Scene, spacing: f64) -> String {
    let footage = &scene.footage;
    let mut out = String::from("<!-- Silhouette Shape File -->\n");
    let _ = writeln!(
        out,
        "<Silhouette width=\"{}\" height=\"{}\" pixelAspect=\"1\" workRangeStart=\"0\" workRangeEnd=\"{}\" sessionStartFrame=\"{}\">",
        footage.width,
        footage.height,
        i64::from(footage.last) - i64::from(footage.first),
        footage.first
    );
    out += " <Layer type=\"Layer\" label=\"Rototoon\" expanded=\"True\">\n  <Properties>\n";
    out += "   <Property id=\"objects\" constant=\"True\" expanded=\"True\">\n";
    for index in super::nearest_first(scene) {
        shape(&mut out, scene, &scene.parts[index], index, spacing);
    }
    out + "   </Property>\n  </Properties>\n </Layer>\n</Silhouette>\n"
}

fn shape(out: &mut String, scene: &Scene, part: &Part, index: usize, spacing: f64) {
    let keys = Outlines::new(part, spacing).within(scene.footage.first, scene.footage.last);
    if keys.is_empty() {
        return;
    }
    let [r, g, b] = part.shown_colour(index);
    let _ = writeln!(
        out,
        "    <Object type=\"Shape\" label=\"{}\" shape_type=\"Bezier\" hidden=\"False\" locked=\"False\">\n     <Properties>",
        escaped(&part.name)
    );
    for (id, value) in [
        ("opacity", "100".to_owned()),
        ("motionBlur", "true".to_owned()),
        ("outlineColor", format!("({r:.3},{g:.3},{b:.3})")),
        ("mode", "Add".to_owned()),
        ("invert", "false".to_owned()),
    ] {
        let _ = writeln!(out, "      <Property constant=\"True\" id=\"{id}\"><Value>{value}</Value></Property>");
    }
    *out += "      <Property id=\"path\">\n";
    let closed = if part.closed { "True" } else { "False" };
    for (frame, points) in keys {
        let frame = i64::from(frame) - i64::from(scene.footage.first);
        let _ =
            writeln!(out, "       <Key frame=\"{frame}\" interp=\"linear\"><Path closed=\"{closed}\" type=\"Bezier\">");
        for p in points {
            let at = placed(p, scene);
            let _ = writeln!(out, "        <Point>{at},{at},{at}</Point>");
        }
        *out += "       </Path></Key>\n";
    }
    *out += "      </Property>\n     </Properties>\n    </Object>\n";
}

fn placed(p: Point, scene: &Scene) -> String {
    let (width, height) = (scene.footage.width as f64, scene.footage.height as f64);
    let (x, y) = ((p.x - 0.5 * width) / height, (p.y - 0.5 * height) / height);
    format!("({x:.DECIMALS$},{y:.DECIMALS$})")
}
