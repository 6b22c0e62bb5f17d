//! The outlines of SVG elements: path data of basic shapes, and paths of path data.

use super::ImportError;
use super::limits::{FARTHEST, Points};
use super::path::Path;
use super::problem::quoted;
use super::svg_length::{Along, length};
use super::svg_sheet::READ;
use super::svg_style::Styles;
use super::svg_view::View;
use rototoon_base::geometry::Point;
use roxmltree::Node;
use svgtypes::{NumberListParser, PathParser, PathSegment, PointsParser, SimplePathSegment, SimplifyingPathParser};

/// The path data of a shape element; `None` for other elements. Lengths are of its style or of attributes.
pub(super) fn outline(node: Node, styles: &Styles, view: &View) -> Result<Option<String>, ImportError> {
    let element = node.tag_name().name();
    let sizes = Sizes { node, styles, view };
    let (value, positive) = (|name| sizes.value(name), |name| sizes.positive(name));
    Ok(Some(match element {
        "path" => node.attribute("d").unwrap_or("").to_owned(),
        "polygon" => listed(node)? + "Z",
        "polyline" => listed(node)?,
        "line" => format!("M{} {}L{} {}", value("x1")?, value("y1")?, value("x2")?, value("y2")?),
        "circle" => ellipse(value("cx")?, value("cy")?, positive("r")?, positive("r")?),
        "ellipse" => {
            let [rx, ry] = sizes.radii()?;
            let one = || sizes.wrong("rx", "a length from 0");
            let (rx, ry) = (rx.or(ry).ok_or_else(one)?, ry.or(rx).ok_or_else(one)?);
            ellipse(value("cx")?, value("cy")?, rx, ry)
        }
        "rect" => {
            let (width, height) = (positive("width")?, positive("height")?);
            let [rx, ry] = sizes.radii()?;
            let round =
                |own: Option<f64>, other: Option<f64>, size: f64| own.or(other).unwrap_or(0.0).clamp(0.0, 0.5 * size);
            rectangle([value("x")?, value("y")?], [width, height], [round(rx, ry, width), round(ry, rx, height)])
        }
        _ => return Ok(None),
    }))
}

/// The lengths of a shape element.
struct Sizes<'a, 'b> {
    node: Node<'a, 'b>,
    styles: &'a Styles,
    view: &'a View,
}

impl Sizes<'_, '_> {
    fn text(&self, name: &str) -> Option<&str> {
        // The ends of a line are no properties of a style.
        if READ.contains(&name) { self.styles.own(self.node, name) } else { self.node.attribute(name) }
    }

    fn wrong(&self, name: &str, expected: &str) -> ImportError {
        ImportError::at(self.node, format!("{name}: found {}, expected {expected}", quoted(self.text(name))))
    }

    /// A length; 0 if it is missing.
    fn value(&self, name: &str) -> Result<f64, ImportError> {
        let along = match name {
            "x" | "cx" | "rx" | "width" | "x1" | "x2" => Along::X,
            "r" => Along::Both,
            _ => Along::Y,
        };
        let Some(text) = self.text(name) else { return Ok(0.0) };
        length(text, self.view, along)
            .ok_or_else(|| self.wrong(name, "a number, a length such as 5mm or a share such as 50%"))
    }

    /// A length that must be there and not be negative.
    fn positive(&self, name: &str) -> Result<f64, ImportError> {
        match self.value(name)? {
            value if value >= 0.0 && self.text(name).is_some() => Ok(value),
            _ => Err(self.wrong(name, "a length from 0")),
        }
    }

    /// The radii along x and y, as far as they are there.
    fn radii(&self) -> Result<[Option<f64>; 2], ImportError> {
        let own = |name: &str| match self.text(name) {
            None | Some("auto") => Ok(None),
            Some(_) => self.positive(name).map(Some),
        };
        Ok([own("rx")?, own("ry")?])
    }
}

fn listed(node: Node) -> Result<String, ImportError> {
    let text = node.attribute("points").unwrap_or("");
    let points: Vec<_> = PointsParser::from(text).map(|(x, y)| format!("{x} {y}")).collect();
    // Numbers need no blanks between them: `10-20` and `.5.5` are two each.
    let numbers: Result<Vec<f64>, _> = NumberListParser::from(text).collect();
    if points.is_empty() || numbers.ok().is_none_or(|numbers| numbers.len() % 2 != 0) {
        return Err(ImportError::at(node, format!("points: found {}, expected pairs of numbers", quoted(Some(text)))));
    }
    Ok(format!("M{}", points.join(" ")))
}

fn ellipse(x: f64, y: f64, rx: f64, ry: f64) -> String {
    format!("M{} {y}A{rx} {ry} 0 0 1 {} {y}A{rx} {ry} 0 0 1 {} {y}Z", x + rx, x - rx, x + rx)
}

fn rectangle([x, y]: [f64; 2], [width, height]: [f64; 2], [rx, ry]: [f64; 2]) -> String {
    if rx == 0.0 || ry == 0.0 {
        return format!("M{x} {y}h{width}v{height}h{}Z", -width);
    }
    let (along, down) = (width - 2.0 * rx, height - 2.0 * ry);
    let corner = |dx: f64, dy: f64| format!("a{rx} {ry} 0 0 1 {dx} {dy}");
    let (a, b, c, d) = (corner(rx, ry), corner(-rx, ry), corner(-rx, -ry), corner(rx, -ry));
    format!("M{} {y}h{along}{a}v{down}{b}h{}{c}v{}{d}Z", x + rx, -along, -down)
}

/// Requires that the numbers of path data are within [`FARTHEST`]. The parser makes more curves of an arc, the larger
/// its radius is, so this is asked before.
fn bounded(node: Node, text: &str) -> Result<(), ImportError> {
    // Text that is no path data gets its error from the parser that makes curves.
    for segment in PathParser::from(text).map_while(Result::ok) {
        let numbers = match segment {
            PathSegment::MoveTo { x, y, .. } | PathSegment::LineTo { x, y, .. } => [x, y, 0.0, 0.0, 0.0, 0.0],
            PathSegment::HorizontalLineTo { x, .. } => [x, 0.0, 0.0, 0.0, 0.0, 0.0],
            PathSegment::VerticalLineTo { y, .. } => [0.0, y, 0.0, 0.0, 0.0, 0.0],
            PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => [x1, y1, x2, y2, x, y],
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => [x2, y2, x, y, 0.0, 0.0],
            PathSegment::Quadratic { x1, y1, x, y, .. } => [x1, y1, x, y, 0.0, 0.0],
            PathSegment::SmoothQuadratic { x, y, .. } => [x, y, 0.0, 0.0, 0.0, 0.0],
            PathSegment::EllipticalArc { rx, ry, x_axis_rotation, x, y, .. } => [rx, ry, x_axis_rotation, x, y, 0.0],
            PathSegment::ClosePath { .. } => [0.0; 6],
        };
        if let Some(far) = numbers.into_iter().find(|number| number.is_nan() || number.abs() > FARTHEST) {
            let message = format!("d: found {far:e}, expected numbers from {:e} to {FARTHEST:e}", -FARTHEST);
            return Err(ImportError::at(node, message));
        }
    }
    Ok(())
}

/// The sub-paths of path data that have segments.
pub(super) fn paths(node: Node, text: &str, points: &mut Points) -> Result<Vec<Path>, ImportError> {
    bounded(node, text)?;
    let mut paths: Vec<Path> = Vec::new();
    for segment in SimplifyingPathParser::from(text) {
        let segment = segment.map_err(|error| {
            ImportError::at(node, format!("d: found {}, expected path data ({error})", quoted(Some(text))))
        })?;
        points.take(1, node)?;
        if let SimplePathSegment::MoveTo { x, y } = segment {
            paths.push(Path::new(Point::new(x, y)));
            continue;
        }
        let Some(path) = paths.last_mut() else { continue };
        match segment {
            SimplePathSegment::LineTo { x, y } => path.line(Point::new(x, y)),
            SimplePathSegment::CurveTo { x1, y1, x2, y2, x, y } => {
                path.cubic(Point::new(x1, y1), Point::new(x2, y2), Point::new(x, y));
            }
            SimplePathSegment::Quadratic { x1, y1, x, y } => {
                let (from, middle, to) = (path.end(), Point::new(x1, y1), Point::new(x, y));
                path.cubic(from.lerp(middle, 2.0 / 3.0), to.lerp(middle, 2.0 / 3.0), to);
            }
            SimplePathSegment::ClosePath => path.close(),
            SimplePathSegment::MoveTo { .. } => {}
        }
    }
    paths.retain(|path| !path.segments.is_empty());
    Ok(paths)
}
