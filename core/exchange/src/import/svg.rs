//! Shapes of an SVG document.
//!
//! Paths, polygons, polylines, lines, rectangles, circles and ellipses become shapes, with their transformations
//! applied. Each sub-path of a path becomes a shape of its own. The view box of the document is mapped to the footage.
//! The name of a shape is its `title`, its Inkscape label, or its `id`.
//!
//! If a path has a SMIL animation of its `d` (`svg_animation`), as written by the export, its shape has a key wherever
//! its form changes, and where a held form ends. Other shapes have one key, on a frame that the caller gives.
//!
//! The export writes painted regions and strokes too, which are no contours of parts: a region has another outline on
//! every frame. They are left out, and one warning counts them. If there is nothing else, each stroke is a shape. Their ids and titles tell them (`"stroke-7"` and `stroke 7`).
//!
//! Limits: content that is not drawn in place (definitions, clips, masks, patterns, symbols) is ignored. Text, pictures
//! and `use` are left out with a warning. Nesting, coordinates and points are bounded (`limits`).

use super::limits::{FARTHEST, Points, near};
use super::names::Names;
use super::path::{NoContours, Path, contours};
use super::problem::{LeftOut, number, parsed, quoted};
use super::svg_animation::{Keyed, hidden as hidden_times, keyed};
use super::{ImportError, Shape, Shapes};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::{PathParser, PathSegment, PointsParser, SimplePathSegment, SimplifyingPathParser, Transform, ViewBox};

/// Elements whose content is not drawn in place.
const NOT_DRAWN: [&str; 9] =
    ["defs", "clipPath", "mask", "pattern", "symbol", "marker", "linearGradient", "radialGradient", "filter"];
/// Elements that are drawn but have no outline here.
const WITHOUT_OUTLINE: [&str; 4] = ["text", "image", "use", "foreignObject"];
/// Greatest relative difference between the aspect ratios of document and footage.
const PROPORTIONS: f64 = 0.005;

/// Reads the shapes of an SVG document for footage. A shape without animation gets its key on frame `still`. Points are
/// converted to pixels of the footage.
///
/// # Errors
///
/// An [`ImportError`] names the element and its place.
pub fn svg(text: &str, footage: &Footage, still: FrameNumber) -> Result<Shapes, ImportError> {
    let document = parsed(text)?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(ImportError::at(root, "expected <svg>, the root of an SVG document"));
    }
    let over = laid_over(root, footage)?;
    let read = |strokes| {
        let mut reader = Reader::new(footage, still, strokes);
        reader.group(root, over).map(|()| reader)
    };
    let mut reader = read(false)?;
    if reader.shapes.is_empty() && reader.drawn.strokes > 0 {
        reader = read(true)?;
    }
    if reader.shapes.is_empty() {
        return Err(ImportError::Nothing(match reader.drawn.regions {
            0 => "a path, polygon, polyline, line, rect, circle or ellipse",
            _ => "one beside the painted regions that Rototoon has written, which are no parts",
        }));
    }
    let mut warnings = reader.left_out.lines(text);
    warnings.extend(reader.drawn.told());
    Ok(Shapes { shapes: reader.shapes, warnings })
}

/// How many elements of an export are left out.
#[derive(Default)]
struct Drawn {
    regions: usize,
    strokes: usize,
}

impl Drawn {
    /// A warning for all of them.
    fn told(&self) -> Option<String> {
        let Self { regions, strokes } = self;
        let what = match (regions, strokes) {
            (0, 0) => return None,
            (_, 0) => format!("painted regions ({regions})"),
            (0, _) => format!("strokes ({strokes})"),
            _ => format!("painted regions ({regions}) and strokes ({strokes})"),
        };
        Some(format!("{what} that Rototoon has written are left out: they are no parts"))
    }
}

/// The transformation from units of the document to pixels of the footage.
fn laid_over(root: Node, footage: &Footage) -> Result<Transform, ImportError> {
    let view = match root.attribute("viewBox") {
        Some(text) => ViewBox::from_str(text).map_err(|error| {
            ImportError::at(root, format!("viewBox: found {text:?}, expected four numbers ({error})"))
        })?,
        None => match (pixels(root, "width")?, pixels(root, "height")?) {
            (Some(width), Some(height)) => ViewBox::new(0.0, 0.0, width, height),
            _ => ViewBox::new(0.0, 0.0, footage.width as f64, footage.height as f64),
        },
    };
    let (x, y) = (footage.width as f64 / view.w, footage.height as f64 / view.h);
    if !(x > 0.0 && y > 0.0) || (x / y - 1.0).abs() > PROPORTIONS {
        let (width, height) = (footage.width, footage.height);
        let message =
            format!("found a picture of {}x{}, expected the footage's proportions, {width}x{height}", view.w, view.h);
        return Err(ImportError::at(root, message));
    }
    Ok(Transform::new(x, 0.0, 0.0, y, -view.x * x, -view.y * y))
}

/// A length in pixels; `None` if the attribute is missing or a percentage.
fn pixels(node: Node, name: &str) -> Result<Option<f64>, ImportError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let text = text.trim();
    let plain = text.strip_suffix("px").unwrap_or(text);
    match plain.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(Some(value)),
        _ if text.ends_with('%') => Ok(None),
        _ => Err(ImportError::at(node, format!("{name}: found {text:?}, expected pixels"))),
    }
}

struct Reader<'a> {
    footage: &'a Footage,
    still: FrameNumber,
    shapes: Vec<Shape>,
    names: Names,
    points: Points,
    left_out: LeftOut,
    /// Whether strokes of an export are shapes.
    strokes: bool,
    drawn: Drawn,
}

impl<'a> Reader<'a> {
    fn new(footage: &'a Footage, still: FrameNumber, strokes: bool) -> Self {
        Self {
            footage,
            still,
            shapes: Vec::new(),
            names: Names::default(),
            points: Points::all(),
            left_out: LeftOut::default(),
            strokes,
            drawn: Drawn::default(),
        }
    }

    fn group(&mut self, node: Node, outer: Transform) -> Result<(), ImportError> {
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            if NOT_DRAWN.contains(&name) || hidden(child) {
                continue;
            }
            match drawn(child) {
                Some(Written::Region) => {
                    self.drawn.regions += 1;
                    continue;
                }
                Some(Written::Stroke) if !self.strokes => {
                    self.drawn.strokes += 1;
                    continue;
                }
                _ => {}
            }
            if WITHOUT_OUTLINE.contains(&name) {
                self.left_out.push(child, format!("<{name}> has no outline here and is left out"));
                continue;
            }
            let inner = joined(outer, own_transform(child)?);
            match outline(child)? {
                Some(text) => self.shape(child, &text, inner)?,
                None if ["g", "a", "svg", "switch"].contains(&name) => self.group(child, inner)?,
                None => {}
            }
        }
        Ok(())
    }

    fn shape(&mut self, node: Node, text: &str, transform: Transform) -> Result<(), ImportError> {
        let keys = match keyed(node, self.footage)? {
            Some(keys) => keys,
            None => vec![Keyed { frame: self.still, text: text.to_owned() }],
        };
        // A part that was exported before it was tracked is there between its keys.
        let keys_only = node.attribute("data-keys") == Some("only");
        let hidden = if keys_only { Vec::new() } else { hidden_times(node, self.footage) };
        let mut frames = Vec::new();
        for key in &keys {
            let mut paths = paths(node, &key.text, &mut self.points)?;
            for path in &mut paths {
                for p in path.points_mut() {
                    *p = near(moved(*p, transform), node)?;
                }
            }
            frames.push((key.frame, paths));
        }
        let Some((first, start)) = frames.first() else { return Ok(()) };
        for number in 0..start.len() {
            let own: Vec<Path> = frames.iter().filter_map(|(_, paths)| paths.get(number).cloned()).collect();
            let unequal = || {
                let message =
                    format!("found paths of several kinds, expected the commands of frame {first} on each key");
                ImportError::at(node, message)
            };
            if own.len() != frames.len() {
                return Err(unequal());
            }
            let contours = contours(&own, |count| self.points.take(count, node)).map_err(|error| match error {
                NoContours::Unequal => unequal(),
                NoContours::Refused(error) => error,
            })?;
            let name = self.names.free(&name(node));
            let keys = frames.iter().map(|(frame, _)| *frame).zip(contours).collect();
            let (shape, never) = Shape::new((name, start[number].closed), keys, &hidden, self.footage);
            never.into_iter().for_each(|never| self.left_out.push(node, never));
            self.shapes.push(shape);
        }
        Ok(())
    }
}

/// What an export writes beside the contours of parts.
enum Written {
    Region,
    Stroke,
}

/// What an element of an export is.
fn drawn(node: Node) -> Option<Written> {
    let (id, title) = (node.attribute("id")?, title(node)?);
    let words: Vec<&str> = title.split(' ').collect();
    let number = |text: &str| text.parse::<i64>().is_ok();
    match words[..] {
        ["region", track] if number(track) && id.strip_prefix("fill-") == Some(track) => Some(Written::Region),
        ["stroke", track] | ["frame", _, "stroke", track] if number(track) && id == title.replace(' ', "-") => {
            Some(Written::Stroke)
        }
        _ => None,
    }
}

fn hidden(node: Node) -> bool {
    let style = node.attribute("style").unwrap_or("").replace(' ', "");
    node.attribute("display") == Some("none") || style.contains("display:none")
}

fn title<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    node.children().find(|child| child.tag_name().name() == "title").and_then(|title| title.text())
}

fn name(node: Node) -> String {
    let label = || node.attributes().find(|attribute| attribute.name() == "label").map(|attribute| attribute.value());
    title(node).or_else(label).or_else(|| node.attribute("id")).unwrap_or("").to_owned()
}

fn own_transform(node: Node) -> Result<Transform, ImportError> {
    let Some(text) = node.attribute("transform") else { return Ok(Transform::default()) };
    Transform::from_str(text).map_err(|error| {
        ImportError::at(node, format!("transform: found {}, expected transformations ({error})", quoted(Some(text))))
    })
}

/// The transformation that applies `inner` first, then `outer`.
fn joined(outer: Transform, inner: Transform) -> Transform {
    let (o, i) = (outer, inner);
    Transform::new(
        o.a * i.a + o.c * i.b,
        o.b * i.a + o.d * i.b,
        o.a * i.c + o.c * i.d,
        o.b * i.c + o.d * i.d,
        o.a * i.e + o.c * i.f + o.e,
        o.b * i.e + o.d * i.f + o.f,
    )
}

fn moved(p: Point, t: Transform) -> Point {
    Point::new(t.a * p.x + t.c * p.y + t.e, t.b * p.x + t.d * p.y + t.f)
}

/// The path data of a shape element; `None` for other elements.
fn outline(node: Node) -> Result<Option<String>, ImportError> {
    let value = |name: &str| number(node, name).map(Option::unwrap_or_default);
    let positive = |name: &str| match number(node, name)? {
        Some(value) if value >= 0.0 => Ok(value),
        _ => {
            let found = quoted(node.attribute(name));
            Err(ImportError::at(node, format!("{name}: found {found}, expected a number from 0")))
        }
    };
    Ok(Some(match node.tag_name().name() {
        "path" => node.attribute("d").unwrap_or("").to_owned(),
        "polygon" => listed(node)? + "Z",
        "polyline" => listed(node)?,
        "line" => format!("M{} {}L{} {}", value("x1")?, value("y1")?, value("x2")?, value("y2")?),
        "circle" => ellipse(value("cx")?, value("cy")?, positive("r")?, positive("r")?),
        "ellipse" => ellipse(value("cx")?, value("cy")?, positive("rx")?, positive("ry")?),
        "rect" => {
            let (width, height) = (positive("width")?, positive("height")?);
            let (rx, ry) = (number(node, "rx")?, number(node, "ry")?);
            let round =
                |own: Option<f64>, other: Option<f64>, size: f64| own.or(other).unwrap_or(0.0).clamp(0.0, 0.5 * size);
            rectangle([value("x")?, value("y")?], [width, height], [round(rx, ry, width), round(ry, rx, height)])
        }
        _ => return Ok(None),
    }))
}

fn listed(node: Node) -> Result<String, ImportError> {
    let text = node.attribute("points").unwrap_or("");
    let points: Vec<_> = PointsParser::from(text).map(|(x, y)| format!("{x} {y}")).collect();
    let numbers = text.split([' ', ',', '\t', '\n', '\r']).filter(|part| !part.is_empty()).count();
    if points.is_empty() || numbers % 2 != 0 {
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
fn paths(node: Node, text: &str, points: &mut Points) -> Result<Vec<Path>, ImportError> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::polygon;

    fn footage() -> Footage {
        Footage { pattern: "%d".into(), first: 5, last: 8, fps: 10.0, width: 200, height: 100 }
    }

    fn read(content: &str) -> Result<Shapes, ImportError> {
        svg(&format!("<svg viewBox=\"10 0 100 50\">{content}</svg>"), &footage(), 6)
    }

    #[test]
    fn painted_regions_and_strokes_of_an_export_are_counted_and_left_out() {
        use crate::export::{SvgFill, SvgOptions, SvgStroke, svg_with_drawn};
        let footage = Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.0, width: 40, height: 30 };
        let corners = |n: usize| -> Vec<Point> { (0..n).map(|k| Point::new(k as f64, (k * k) as f64)).collect() };
        let part = rototoon_base::scene::Part {
            name: "arm".into(),
            closed: true,
            keys: [(0, corners(3))].into(),
            ..Default::default()
        };
        // The outline of a region has another number of points on every frame.
        let outlines = (0..4).map(|frame| (frame, vec![corners(4 + frame as usize)])).collect();
        let fills = [SvgFill { track: 5, outlines, colour: [1.0, 0.0, 0.0] }];
        let stroke =
            |name: &str| SvgStroke { name: name.into(), points: [(1, corners(2))].into(), ..SvgStroke::default() };
        let strokes = [stroke("stroke 7"), stroke("frame -3 stroke 2")];
        let scene = rototoon_base::scene::Scene { footage: footage.clone(), parts: vec![part] };
        let text = svg_with_drawn(&scene, &fills, &strokes, &SvgOptions::default());
        let found = svg(&text, &footage, 0).unwrap();
        assert_eq!(found.shapes.iter().map(|shape| shape.name.as_str()).collect::<Vec<_>>(), ["arm"]);
        let told = "painted regions (1) and strokes (2) that Rototoon has written are left out: they are no parts";
        assert_eq!(found.warnings, [told]);
        // Without a part the strokes are what there is to import.
        let bare = rototoon_base::scene::Scene { parts: Vec::new(), ..scene };
        let found = svg(&svg_with_drawn(&bare, &fills, &strokes, &SvgOptions::default()), &footage, 0).unwrap();
        assert_eq!(found.shapes.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["stroke 7", "frame -3 stroke 2"]);
        assert!(found.warnings[0].starts_with("painted regions (1) that"), "{:?}", found.warnings);
        let text = svg_with_drawn(&bare, &fills, &[], &SvgOptions::default());
        assert!(svg(&text, &footage, 0).unwrap_err().to_string().contains("painted regions that Rototoon has written"));
        // A part of such a name is a part.
        let own = "<svg><path id='a' d='M0 0L9 9'><title>stroke 7</title></path></svg>";
        assert_eq!(svg(own, &footage, 0).unwrap().shapes[0].name, "stroke 7");
    }

    #[test]
    fn every_basic_shape_has_its_outline() {
        let found = read(
            "<!-- far --><rect id=\"r\" x=\"10\" width=\"20\" height=\"10\"/><g transform=\"translate(10 5) scale(2)\">
            <circle r=\"4\"><title>disc</title></circle><ellipse cx=\"3\" rx=\"2\" ry=\"1\"/></g>
            <rect x=\"20\" y=\"20\" width=\"20\" height=\"10\" rx=\"2\"/><line x2=\"10\"/><polyline points=\"10,0 20,0 20,5\"/>
            <polygon points=\"10,0 20,0 20,5\"/><path id=\"r\" d=\"M10 0q10 0 10 10M30 0h10v10z\"/><defs><rect width=\"1\" height=\"1\"/></defs>",
        )
        .unwrap();
        let area = |index: usize| polygon::signed_area(&found.shapes[index].keys[&6]).abs();
        let names: Vec<_> = found.shapes.iter().map(|shape| (shape.name.as_str(), shape.closed)).collect();
        let expected =
            [("r", true), ("disc", true), ("shape", true), ("shape 2", true), ("shape 3", false), ("shape 4", false)];
        assert_eq!(names[..6], expected);
        assert_eq!(names[6..], [("shape 5", true), ("r 2", false), ("r 3", true)]);
        assert_eq!(
            found.shapes[0].keys[&6],
            [(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0)].map(|(x, y)| Point::new(x, y))
        );
        let round = std::f64::consts::PI;
        assert!((area(1) - round * 256.0).abs() < 8.0 && (area(2) - round * 32.0).abs() < 3.0);
        assert!((area(3) - (800.0 - 16.0 * (4.0 - round))).abs() < 2.0, "{}", area(3));
        assert_eq!(area(8), 200.0);
    }

    #[test]
    fn what_has_no_outline_is_told_and_left_out() {
        let found = read("<path d=\"M0 0h5\"/>\n<text>a</text><g display=\"none\"><path d=\"M0 0h5\"/></g>").unwrap();
        assert_eq!(found.shapes.len(), 1);
        assert_eq!(found.warnings, ["line 2, column 1: <text> has no outline here and is left out"]);
    }

    #[test]
    fn errors_name_the_element_and_what_was_expected() {
        for (content, place, message) in [
            ("\n <path d=\"M0 0 L5\"/>", "line 2, column 2: <path>: d: found", "expected path data"),
            ("<circle r=\"-1\"/>", "<circle>", "r: found \"-1\", expected a number from 0"),
            ("<circle/>", "<circle>", "r: found nothing, expected a number from 0"),
            ("<path d=\"M0 0A5 1e40 0 0 1 9 9\"/>", "<path>", "d: found 1e40, expected numbers from -1e7 to 1e7"),
            ("<path d=\"M0 0a5e62 5 0 0 1 9 9\"/>", "<path>", "d: found 5e62, expected numbers"),
            ("<path d=\"M0 0h9999999h9999999\"/>", "<path>", "found a point at (1.33"),
            ("<g transform=\"scale(1e300)\"><path d=\"M1 1h1\"/></g>", "<path>", "found a point at ("),
            ("<circle r=\"1e30\"/>", "<circle>", "d: found 1e30, expected numbers"),
            ("<rect width=\"a\" height=\"1\"/>", "<rect>", "width: found \"a\", expected a number"),
            ("<polygon points=\"1 2 3\"/>", "<polygon>", "expected pairs of numbers"),
            ("<g transform=\"turn(3)\"><path d=\"M0 0h1\"/></g>", "<g>", "transform: found \"turn(3)\""),
            ("<g/>", "found no shape", "expected a path"),
            ("<g>", "found text that is not XML", ""),
        ] {
            let error = read(content).unwrap_err().to_string();
            assert!(error.contains(place) && error.contains(message), "{error}");
        }
        let wide =
            svg("<svg viewBox=\"0 0 100 100\"><path d=\"M0 0h1\"/></svg>", &footage(), 6).unwrap_err().to_string();
        assert!(wide.contains("found a picture of 100x100, expected the footage's proportions, 200x100"), "{wide}");
    }
}
