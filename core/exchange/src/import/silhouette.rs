//! Shapes of Silhouette (`.fxs`).
//!
//! Each `Object` (or `Shape`) of type `Shape` has a property `path`, whose keys contain a `Path` of `Point`s. A point
//! of a Bézier path has a position and two handles, a point of a B-spline only a position. Coordinates are those of the
//! export: the origin is the middle of the picture, the unit its height, y points down, and frames count from the
//! session's first. The footage gives the size of the picture in pixels.
//!
//! - Public descriptions disagree on which handle of a point leads forward, and on whether handles are places or offsets
//!   from their point. Exporters write both forms. The reader takes the reading with the shortest control polygon over all
//!   keys of a shape: handles are near their points in one reading only. Of equal readings it takes places.
//! - B-splines are uniform and cubic. The ends of an open one are repeated three times, so the curve reaches them.
//! - Transformed layers are an error, since their shapes would be in the wrong place. Hidden shapes are left out with a
//!   warning. A shape is hidden where its opacity is 0; other opacities are ignored.

use super::channel::Channel;
use super::limits::{Points, near};
use super::names::Names;
use super::path::{NoContours, Path, contours};
use super::problem::{LeftOut, number, parsed, quoted};
use super::{ImportError, Shape, Shapes};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};
use roxmltree::Node;
use std::collections::BTreeMap;

/// A point with its two handles.
type Knot = [Point; 3];

/// One key of a path.
struct Key {
    frame: FrameNumber,
    closed: bool,
    spline: bool,
    knots: Vec<Knot>,
}

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
    let first = number(root, "sessionStartFrame")?.unwrap_or(footage.first.into());
    let (mut shapes, mut left_out) = (Vec::new(), LeftOut::default());
    let (mut names, mut points) = (Names::default(), Points::all());
    for node in root.descendants().filter(Node::is_element) {
        let kind = node.attribute("type").unwrap_or(node.tag_name().name());
        match (node.tag_name().name(), kind) {
            ("Property", _) if node.attribute("id") == Some("transform.matrix") => untransformed(node)?,
            ("Object" | "Shape", "Shape")
                if node.attribute("hidden").is_some_and(|text| text.eq_ignore_ascii_case("true")) =>
            {
                let name = node.attribute("label").unwrap_or("");
                left_out.push(node, format!("the hidden shape {name:?} is left out"));
            }
            ("Object" | "Shape", "Shape") => {
                let name = names.free(node.attribute("label").unwrap_or(""));
                let (shape, never) = shape(node, name, first, footage, &mut points)?;
                never.into_iter().for_each(|never| left_out.push(node, never));
                shapes.push(shape);
            }
            _ => {}
        }
    }
    if shapes.is_empty() {
        return Err(ImportError::Nothing("an <Object type=\"Shape\"> that is not hidden"));
    }
    shapes.reverse();
    Ok(Shapes { shapes, warnings: left_out.lines(text) })
}

/// Requires that the matrices of a layer are identities.
fn untransformed(property: Node) -> Result<(), ImportError> {
    const IDENTITY: [f64; 16] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
    for node in property.children().filter(Node::is_element) {
        let text = node.text().unwrap_or("");
        let numbers: Vec<_> = text.split(['(', ')', ',']).filter_map(|part| part.trim().parse::<f64>().ok()).collect();
        let same = numbers.iter().zip(IDENTITY).all(|(a, b)| (a - b).abs() < 1e-9);
        if !same || ![0, IDENTITY.len()].contains(&numbers.len()) {
            let message = format!("transform.matrix: found {:?}, expected no transformation of layers", text.trim());
            return Err(ImportError::at(node, message));
        }
    }
    Ok(())
}

/// A shape, and a warning if it is never shown.
fn shape(
    node: Node,
    name: String,
    first: f64,
    footage: &Footage,
    points: &mut Points,
) -> Result<(Shape, Option<String>), ImportError> {
    let Some(property) = property(node, "path") else {
        return Err(ImportError::at(node, format!("shape {name:?}: found no <Property id=\"path\">, expected one")));
    };
    let mut keys = Vec::new();
    for node in property.children().filter(Node::is_element) {
        keys.push(key(node, first, footage)?);
    }
    keys.sort_by_key(|key| key.frame);
    let Some(closed) = keys.first().map(|key| key.closed) else {
        return Err(ImportError::at(property, "found no key, expected <Key> or <Value> with a <Path>"));
    };
    let reading = Reading::of(&keys, footage);
    let paths: Vec<Path> = keys.iter().map(|key| built(key, &reading)).collect();
    let contours = contours(&paths, |count| points.take(count, property)).map_err(|error| match error {
        NoContours::Unequal => {
            let found = counted(&keys);
            let message =
                format!("shape {name:?}: found keys of {found} points, expected the same number and kind on each");
            ImportError::at(property, message)
        }
        NoContours::Refused(error) => error,
    })?;
    let keys: BTreeMap<_, _> = keys.iter().map(|key| key.frame).zip(contours).collect();
    let hidden = hidden(node, first)?;
    Ok(Shape::new((name, closed), keys, &hidden, footage))
}

/// A property of a shape.
fn property<'a, 'b>(shape: Node<'a, 'b>, id: &str) -> Option<Node<'a, 'b>> {
    shape.descendants().find(|n| n.tag_name().name() == "Property" && n.attribute("id") == Some(id))
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

/// The first two keys that differ in their number of points, or the first two keys.
fn counted(keys: &[Key]) -> String {
    let other = keys.iter().position(|key| key.knots.len() != keys[0].knots.len()).unwrap_or(1);
    let shown = [0, other].into_iter().filter_map(|k| keys.get(k));
    let counts: Vec<_> = shown.map(|key| format!("{} on frame {}", key.knots.len(), key.frame)).collect();
    counts.join(", ")
}

fn key(node: Node, first: f64, footage: &Footage) -> Result<Key, ImportError> {
    let frame = number(node, "frame")?.map_or(footage.first.into(), |frame| frame + first);
    if frame.fract() != 0.0 || !(f64::from(footage.first)..=f64::from(footage.last)).contains(&frame) {
        let own = format!("{} to {}", footage.first, footage.last);
        return Err(ImportError::at(
            node,
            format!("found a key on frame {frame}, expected a frame of the footage, {own}"),
        ));
    }
    let Some(path) = node.children().find(|n| n.tag_name().name() == "Path") else {
        return Err(ImportError::at(node, "found no <Path>, expected one"));
    };
    let kind = path.attribute("type").unwrap_or("Bezier");
    let spline = kind.eq_ignore_ascii_case("bspline");
    if !spline && !kind.eq_ignore_ascii_case("bezier") {
        return Err(ImportError::at(path, format!("type: found {kind:?}, expected \"Bezier\" or \"Bspline\"")));
    }
    let closed = path.attribute("closed").is_none_or(|text| text.eq_ignore_ascii_case("true"));
    let points = path.children().filter(|n| n.tag_name().name() == "Point");
    let knots = points.map(|point| knot(point, footage)).collect::<Result<Vec<_>, _>>()?;
    if knots.is_empty() {
        return Err(ImportError::at(path, "found no <Point>, expected at least one"));
    }
    Ok(Key { frame: frame as FrameNumber, closed, spline, knots })
}

fn knot(node: Node, footage: &Footage) -> Result<Knot, ImportError> {
    let text = node.text().unwrap_or("").trim();
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().trim_matches(['(', ')']).parse().ok()).collect();
    let numbers = numbers.filter(|numbers| numbers.iter().all(|n| n.is_finite())).unwrap_or_default();
    let (width, height) = (footage.width as f64, footage.height as f64);
    let placed = |pair: &[f64]| near(Point::new(pair[0] * height + 0.5 * width, (pair[1] + 0.5) * height), node);
    match numbers.len() {
        // A point of a B-spline may have a weight after its coordinates.
        2 | 3 => Ok([placed(&numbers)?; 3]),
        6.. => Ok([placed(&numbers)?, placed(&numbers[2..])?, placed(&numbers[4..])?]),
        _ => {
            let found = quoted(Some(text));
            Err(ImportError::at(node, format!("found {found}, expected (x,y) or (x,y),(x,y),(x,y)")))
        }
    }
}

/// How the handles of a shape are written.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reading {
    /// Whether the third point of a knot leads forward, and not the second.
    swapped: bool,
    /// Where an offset of nothing was read to, if handles are offsets from their points.
    origin: Option<Point>,
}

impl Reading {
    /// The reading with the shortest control polygons of all keys; the first of equal ones.
    fn of(keys: &[Key], footage: &Footage) -> Self {
        let middle = Point::new(footage.width as f64, footage.height as f64) * 0.5;
        let forms =
            [None, Some(middle)].into_iter().flat_map(|origin| [false, true].map(|swapped| Self { swapped, origin }));
        let mut best = (f64::INFINITY, Self { swapped: false, origin: None });
        for form in forms {
            let length = length(keys, &form);
            if length < best.0 {
                best = (length, form);
            }
        }
        best.1
    }

    /// A knot as point, forward handle, backward handle.
    fn knot(&self, [at, a, b]: Knot) -> Knot {
        let place = |handle: Point| self.origin.map_or(handle, |origin| at + handle - origin);
        if self.swapped { [at, place(b), place(a)] } else { [at, place(a), place(b)] }
    }
}

/// The path of a key.
fn built(key: &Key, reading: &Reading) -> Path {
    if key.spline {
        let guides: Vec<Point> = key.knots.iter().map(|knot| knot[0]).collect();
        return Path::spline(&guides, key.closed);
    }
    let knots: Vec<Knot> = key.knots.iter().map(|knot| reading.knot(*knot)).collect();
    Path::through(&knots, key.closed)
}

/// Length of the control polygons of all keys.
fn length(keys: &[Key], reading: &Reading) -> f64 {
    let polygon = |key: &Key| {
        let path = built(key, reading);
        let mut from = path.start;
        let each = path.segments.iter().flatten().map(|&p| std::mem::replace(&mut from, p).distance(p));
        each.sum::<f64>()
    };
    keys.iter().map(polygon).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOOTAGE: fn() -> Footage =
        || Footage { pattern: "%d".into(), first: 10, last: 20, fps: 1.0, width: 200, height: 100 };

    fn file(shape: &str, path: &str) -> String {
        format!(
            "<Silhouette sessionStartFrame=\"10\">\n<Object type=\"Shape\" {shape}><Properties>\n<Property id=\"path\">{path}</Property></Properties></Object></Silhouette>"
        )
    }

    fn key(frame: i32, kind: &str, points: &[&str]) -> String {
        let points: String = points.iter().map(|p| format!("<Point>{p}</Point>")).collect();
        format!("<Key frame=\"{frame}\"><Path closed=\"True\" type=\"{kind}\">{points}</Path></Key>")
    }

    #[test]
    fn handles_lead_on_whichever_way_they_are_written() {
        // A disc of radius 20 pixels about the middle of the picture.
        let round = 0.2 * 0.552_284_75;
        let knots = [(0.2, 0.0), (0.0, 0.2), (-0.2, 0.0), (0.0, -0.2)];
        let text = |(x, y): (f64, f64), turned: f64| {
            let (dx, dy) = (-y / 0.2 * round * turned, x / 0.2 * round * turned);
            format!("({x},{y}),({},{}),({},{})", x + dx, y + dy, x - dx, y - dy)
        };
        for turned in [1.0, -1.0] {
            let points: Vec<String> = knots.iter().map(|&knot| text(knot, turned)).collect();
            let points: Vec<&str> = points.iter().map(String::as_str).collect();
            let found = silhouette(&file("label=\"disc\"", &key(3, "Bezier", &points)), &FOOTAGE()).unwrap();
            let shape = &found.shapes[0];
            assert_eq!((shape.name.as_str(), shape.closed), ("disc", true));
            for p in &shape.keys[&13] {
                assert!((p.distance(Point::new(100.0, 50.0)) - 20.0).abs() < 0.02, "{p}");
            }
        }
    }

    #[test]
    fn handles_are_places_or_offsets() {
        // Discs of radius 20 pixels, in the middle of the picture and beside it.
        let round = 0.2 * 0.552_284_75;
        for (x0, y0) in [(0.0, 0.0), (0.6, -0.2), (-0.9, 0.4)] {
            for (offsets, turned) in [(false, 1.0), (false, -1.0), (true, 1.0), (true, -1.0)] {
                let knot = |(x, y): (f64, f64)| {
                    let (dx, dy) = (-y / 0.2 * round * turned, x / 0.2 * round * turned);
                    let (x, y) = (x + x0, y + y0);
                    let (u, v) = if offsets { (0.0, 0.0) } else { (x, y) };
                    format!("({x},{y}),({},{}),({},{})", u + dx, v + dy, u - dx, v - dy)
                };
                let knots = [(0.2, 0.0), (0.0, 0.2), (-0.2, 0.0), (0.0, -0.2)].map(knot);
                let points: Vec<&str> = knots.iter().map(String::as_str).collect();
                let found = silhouette(&file("", &key(3, "Bezier", &points)), &FOOTAGE()).unwrap();
                let middle = Point::new(100.0 + 100.0 * x0, 50.0 + 100.0 * y0);
                for p in &found.shapes[0].keys[&13] {
                    assert!((p.distance(middle) - 20.0).abs() < 0.02, "{offsets} {turned} {p}");
                }
            }
        }
        // Corners: handles at their points, or offsets of nothing.
        for handle in ["(0.3,0.1)", "(0,0)"] {
            let points = ["(0.3,0.1)", "(0.4,0.1)", "(0.3,0.3)"].map(|at| {
                let own = if handle == "(0,0)" { handle } else { at };
                format!("{at},{own},{own}")
            });
            let points: Vec<&str> = points.iter().map(String::as_str).collect();
            let found = silhouette(&file("", &key(0, "Bezier", &points)), &FOOTAGE()).unwrap();
            let shape = &found.shapes[0].keys[&10];
            let length: f64 = rototoon_base::geometry::polyline::length(shape, true);
            assert!((length - (10.0 + 20.0 + 500f64.sqrt())).abs() < 1e-6, "{handle} {shape:?}");
        }
    }

    #[test]
    fn a_spline_lies_within_its_guides_and_reaches_open_ends() {
        let points = ["(-0.2,-0.2)", "(0.2,-0.2)", "(0.2,0.2)", "(-0.2,0.2)"];
        let closed = silhouette(&file("", &key(0, "Bspline", &points)), &FOOTAGE()).unwrap();
        let far = |p: &Point| p.distance(Point::new(100.0, 50.0));
        assert!(closed.shapes[0].keys[&10].iter().all(|p| far(p) > 12.0 && far(p) < 20.0));
        let text = file("", &key(0, "Bspline", &points)).replace("True", "False");
        let open = &silhouette(&text, &FOOTAGE()).unwrap().shapes[0];
        assert!(!open.closed);
        let ends = [open.keys[&10][0], *open.keys[&10].last().unwrap()];
        assert!(ends[0].distance(Point::new(80.0, 30.0)) < 1e-9 && ends[1].distance(Point::new(80.0, 70.0)) < 1e-9);
    }

    #[test]
    fn errors_name_the_element_and_what_was_expected() {
        let points = ["(0,0)", "(0.1,0)", "(0,0.1)"];
        let good = key(0, "Bezier", &points);
        for (text, place, message) in [
            (
                file("", &key(30, "Bezier", &points)),
                "line 3, column 21: <Key>",
                "frame 40, expected a frame of the footage, 10 to 20",
            ),
            (file("", &key(0, "Oval", &points)), "<Path>", "found \"Oval\", expected \"Bezier\" or \"Bspline\""),
            (file("", &key(0, "Bezier", &["(0;0)"])), "<Point>", "found \"(0;0)\", expected (x,y)"),
            (file("", &key(0, "Bezier", &["(NaN,0)"])), "<Point>", "expected (x,y)"),
            (file("", &key(0, "Bezier", &[])), "<Path>", "found no <Point>"),
            (
                file("label=\"a\"", &(good.clone() + &key(1, "Bezier", &points[..2]))),
                "<Property>",
                "3 on frame 10, 2 on frame 11",
            ),
            (file("label=\"a\"", ""), "<Property>", "found no key"),
            (file("", &good).replace("\"path\"", "\"p\""), "<Object>", "expected one"),
            (file("", &good).replace("Silhouette", "Svg"), "<Svg>", "expected <Silhouette>"),
            (file("hidden=\"True\"", &good), "found no shape", "not hidden"),
            ("<Silhouette>".into(), "found text that is not XML", ""),
        ] {
            let error = silhouette(&text, &FOOTAGE()).unwrap_err().to_string();
            assert!(error.contains(place) && error.contains(message), "{error}");
        }
        let moved = "<Property id=\"transform.matrix\"><Value>(1,0,0,0,0,1,0,0,0,0,1,0,0.2,0,0,1)</Value></Property>";
        let text = file("", &good).replace("<Object", &format!("{moved}<Object"));
        assert!(silhouette(&text, &FOOTAGE()).unwrap_err().to_string().contains("expected no transformation"));
        assert!(silhouette(&text.replace(",0.2,0,0,1)", ",0,0,0,1)"), &FOOTAGE()).is_ok());
    }
}
