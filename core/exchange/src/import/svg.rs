//! Shapes of an SVG document.
//!
//! Paths, polygons, polylines, lines, rectangles, circles and ellipses become shapes, with their transformations
//! applied. Each sub-path of a path becomes a shape of its own. The view box of the document is mapped to the footage.
//! The name of a shape is its `title`, its Inkscape label, or its `id`.
//!
//! If a path has a SMIL animation of its `d` (`svg_animation`), as written by the export, its shape has a key wherever
//! its form changes, and where a held form ends. Other shapes have one key, on a frame that the caller gives. An export says in
//! attributes of its root which frames of the document it shows.
//!
//! A path that is filled is closed, even if its data do not close it. What is hidden on all frames is left out with a warning
//! (`svg_style`). A nested `svg` has a view box of its own (`svg_view`).
//!
//! The export writes painted regions and strokes too, which are no contours of parts: a region has another outline on
//! every frame. They are left out, and one warning counts them. If there is nothing else, each stroke is a shape. Their ids and titles tell them (`"stroke-7"` and `stroke 7`).
//!
//! Limits: content that is not drawn in place (definitions, clips, masks, patterns, symbols) is ignored. Text, pictures
//! and `use` are left out with a warning, and so are animations of transformations. Nesting, coordinates and points are bounded (`limits`).

use super::limits::{Points, near};
use super::names::Names;
use super::path::{NoContours, Path, contours};
use super::problem::{LeftOut, parsed, quoted};
use super::svg_animation::{Keyed, hidden as hidden_times, keyed};
use super::svg_outline::{outline, paths};
use super::svg_style::Styles;
use super::svg_view::{View, nested, viewed};
use super::{ImportError, Shape, Shapes};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::Transform;

/// Elements whose content is not drawn in place.
const NOT_DRAWN: [&str; 9] =
    ["defs", "clipPath", "mask", "pattern", "symbol", "marker", "linearGradient", "radialGradient", "filter"];
/// Attributes of the root of an export: the first and the last frame of the document that it shows.
const FIRST: &str = "data-first";
const LAST: &str = "data-last";
/// The attribute of a part of an export that has nothing but keys: their frames.
const KEYS: &str = "data-keys";
/// Elements that contain others.
const GROUPS: [&str; 4] = ["g", "a", "svg", "switch"];
/// Elements that have an outline.
const SHAPES: [&str; 7] = ["path", "polygon", "polyline", "line", "circle", "ellipse", "rect"];
/// Elements that are drawn but have no outline here.
const WITHOUT_OUTLINE: [&str; 4] = ["text", "image", "use", "foreignObject"];

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
    let (view, over) = viewed(root, footage)?;
    let styles = Styles::of(&document);
    let film = film(root, footage);
    let still = film.as_ref().map_or(still, |film| still.clamp(film.first, film.last));
    let read = |strokes| {
        let mut reader = Reader::new(film.as_ref().unwrap_or(footage), still, strokes, &styles);
        reader.is_film = film.is_some();
        reader.group(root, &view, over).map(|()| reader)
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

/// The footage of the frames of which an export is a film. Others begin with the first frame of the footage.
fn film(root: Node, footage: &Footage) -> Option<Footage> {
    let frame = |name| root.attribute(name)?.trim().parse::<FrameNumber>().ok();
    let (first, last) = (frame(FIRST)?.max(footage.first), frame(LAST)?.min(footage.last));
    (first <= last && frame(FIRST)? == first).then(|| Footage { first, last, ..footage.clone() })
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

struct Reader<'a> {
    footage: &'a Footage,
    styles: &'a Styles,
    still: FrameNumber,
    shapes: Vec<Shape>,
    names: Names,
    points: Points,
    left_out: LeftOut,
    /// Whether strokes of an export are shapes.
    strokes: bool,
    /// Whether the document says which frames it shows.
    is_film: bool,
    drawn: Drawn,
}

impl<'a> Reader<'a> {
    fn new(footage: &'a Footage, still: FrameNumber, strokes: bool, styles: &'a Styles) -> Self {
        Self {
            footage,
            styles,
            still,
            shapes: Vec::new(),
            names: Names::default(),
            points: Points::all(),
            left_out: LeftOut::default(),
            strokes,
            is_film: false,
            drawn: Drawn::default(),
        }
    }

    fn group(&mut self, node: Node, view: &View, outer: Transform) -> Result<(), ImportError> {
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            if NOT_DRAWN.contains(&name) || self.is_left_out(child) {
                continue;
            }
            let inner = joined(outer, self.own_transform(child)?);
            match outline(child)? {
                Some(text) => self.shape(child, &text, inner)?,
                None if name == "svg" => {
                    let (view, within) = nested(child, view)?;
                    self.group(child, &view, joined(inner, within))?;
                }
                None if ["g", "a", "switch"].contains(&name) => self.group(child, view, inner)?,
                None => {}
            }
        }
        Ok(())
    }

    /// Whether an element is left out, which is told.
    fn is_left_out(&mut self, node: Node) -> bool {
        match drawn(node) {
            Some(Written::Region) => {
                self.drawn.regions += 1;
                return true;
            }
            Some(Written::Stroke) if !self.strokes => {
                self.drawn.strokes += 1;
                return true;
            }
            _ => {}
        }
        let element = node.tag_name().name();
        if WITHOUT_OUTLINE.contains(&element) {
            self.left_out.push(node, format!("<{element}> has no outline here and is left out"));
            return true;
        }
        let group = GROUPS.contains(&element);
        let invisible = || (!group && self.styles.is_invisible(node)).then_some("visibility: hidden");
        let Some(reason) = self.styles.hides(node).or_else(invisible) else { return false };
        if group || SHAPES.contains(&element) {
            self.left_out.push(node, format!("the hidden <{element}> {:?} is left out ({reason})", name(node)));
        }
        true
    }

    /// The transformation of an element. One that moves is not read, which is told.
    fn own_transform(&mut self, node: Node) -> Result<Transform, ImportError> {
        let moves = |child: &Node| ["animateTransform", "animateMotion"].contains(&child.tag_name().name());
        if node.children().any(|child| moves(&child)) {
            let told =
                format!("{:?} moves by an animated transformation, which is not read: it stands still", name(node));
            self.left_out.push(node, told);
        }
        let Some(text) = self.styles.transform(node) else { return Ok(Transform::default()) };
        Transform::from_str(&text).map_err(|error| {
            let found = quoted(Some(&text));
            ImportError::at(node, format!("transform: found {found}, expected transformations ({error})"))
        })
    }

    fn shape(&mut self, node: Node, text: &str, transform: Transform) -> Result<(), ImportError> {
        let keys = match keyed(node, self.footage)? {
            Some(found) => {
                if let Some(told) = found.kept.told(&name(node), self.footage) {
                    self.left_out.push(node, told);
                }
                found.keys
            }
            None => vec![Keyed { frame: self.still, text: text.to_owned(), toward: None }],
        };
        let (keys, hidden) = (of_artist(node, keys), hidden_times(node, self.footage));
        let frames = keys.iter().map(|key| Ok((key.frame, self.placed(node, key, transform)?)));
        let frames = frames.collect::<Result<Vec<_>, ImportError>>()?;
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
            // Another drawing is of one frame; it does not say that the part stands still.
            let extent = if self.is_film { shape.extent } else { shape.extent.of_drawing() };
            self.shapes.push(Shape { extent, ..shape });
        }
        Ok(())
    }

    /// The sub-paths of a key, in pixels of the footage.
    fn placed(&mut self, node: Node, key: &Keyed, transform: Transform) -> Result<Vec<Path>, ImportError> {
        let mut own = paths(node, &key.text, &mut self.points)?;
        // A fill joins the end of an open path to its start.
        if node.tag_name().name() != "line" && self.styles.is_filled(node) {
            own.iter_mut().filter(|path| !path.closed && path.segments.len() > 1).for_each(Path::close);
        }
        if let Some((text, share)) = &key.toward {
            let to = paths(node, text, &mut self.points)?;
            // Paths that are built differently are refused with the keys before them.
            for (path, to) in own.iter_mut().zip(&to) {
                path.go(to, *share);
            }
        }
        for p in own.iter_mut().flat_map(Path::points_mut) {
            *p = near(moved(*p, transform), node)?;
        }
        Ok(own)
    }
}

/// The keys of a shape without those that an export has put between the keys of a part. Its attribute names the frames of the artist's own.
fn of_artist(node: Node, keys: Vec<Keyed>) -> Vec<Keyed> {
    let listed = node.attribute(KEYS).unwrap_or("");
    let listed: Vec<FrameNumber> = listed.split_ascii_whitespace().filter_map(|frame| frame.parse().ok()).collect();
    let own = |key: &Keyed| listed.contains(&key.frame);
    // A form that is held has no key of its own on the frames between.
    if listed.is_empty() || !keys.iter().any(own) { keys } else { keys.into_iter().filter(own).collect() }
}

/// What an export writes beside the contours of parts.
enum Written {
    Region,
    Stroke,
}

/// What an element of an export is. The title of a region is the name of its colour, if that has one.
fn drawn(node: Node) -> Option<Written> {
    let (id, title) = (node.attribute("id")?, title(node)?);
    let words: Vec<&str> = title.split(' ').collect();
    let number = |text: &str| text.parse::<i64>().is_ok();
    if node.has_attribute("data-colour") && id.strip_prefix("fill-").is_some_and(number) {
        return Some(Written::Region);
    }
    match words[..] {
        ["region", track] if number(track) && id.strip_prefix("fill-") == Some(track) => Some(Written::Region),
        ["stroke", track] | ["frame", _, "stroke", track] if number(track) && id == title.replace(' ', "-") => {
            Some(Written::Stroke)
        }
        _ => None,
    }
}

fn title<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    node.children().find(|child| child.tag_name().name() == "title").and_then(|title| title.text())
}

fn name(node: Node) -> String {
    let label = || node.attributes().find(|attribute| attribute.name() == "label").map(|attribute| attribute.value());
    title(node).or_else(label).or_else(|| node.attribute("id")).unwrap_or("").to_owned()
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

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::polygon;

    fn footage() -> Footage {
        Footage { pattern: "%d".into(), first: 5, last: 8, fps: 10.0, width: 200, height: 100, held: false }
    }

    fn read(content: &str) -> Result<Shapes, ImportError> {
        svg(&format!("<svg viewBox=\"10 0 100 50\">{content}</svg>"), &footage(), 6)
    }

    #[test]
    fn painted_regions_and_strokes_of_an_export_are_counted_and_left_out() {
        use crate::export::{SvgFill, SvgOptions, SvgStroke, svg_with_drawn};
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.0, width: 40, height: 30, held: false };
        let corners = |n: usize| -> Vec<Point> { (0..n).map(|k| Point::new(k as f64, (k * k) as f64)).collect() };
        let part = rototoon_base::scene::Part {
            name: "arm".into(),
            closed: true,
            keys: [(0, corners(3))].into(),
            ..Default::default()
        };
        // The outline of a region has another number of points on every frame.
        let outlines = (0..4).map(|frame| (frame, vec![corners(4 + frame as usize)])).collect();
        let fill = SvgFill { track: 5, name: None, outlines, colour: [1.0, 0.0, 0.0] };
        // The title of a region is the name of its colour.
        let fills = [SvgFill { track: 6, name: Some("coat & \u{1}hat".into()), ..fill.clone() }, fill];
        let stroke =
            |name: &str| SvgStroke { name: name.into(), points: [(1, corners(2))].into(), ..SvgStroke::default() };
        let strokes = [stroke("stroke 7"), stroke("frame -3 stroke 2")];
        let scene = rototoon_base::scene::Scene { footage: footage.clone(), parts: vec![part] };
        let text = svg_with_drawn(&scene, &fills, &strokes, &SvgOptions::default());
        let found = svg(&text, &footage, 0).unwrap();
        assert_eq!(found.shapes.iter().map(|shape| shape.name.as_str()).collect::<Vec<_>>(), ["arm"]);
        let told = "painted regions (2) and strokes (2) that Rototoon has written are left out: they are no parts";
        assert_eq!(found.warnings, [told]);
        // Without a part the strokes are what there is to import.
        let bare = rototoon_base::scene::Scene { parts: Vec::new(), ..scene };
        let found = svg(&svg_with_drawn(&bare, &fills, &strokes, &SvgOptions::default()), &footage, 0).unwrap();
        assert_eq!(found.shapes.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["stroke 7", "frame -3 stroke 2"]);
        assert!(found.warnings[0].starts_with("painted regions (2) that"), "{:?}", found.warnings);
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
            [("r", true), ("disc", true), ("shape", true), ("shape 2", true), ("shape 3", false), ("shape 4", true)];
        assert_eq!(names[..6], expected);
        assert_eq!(names[6..], [("shape 5", true), ("r 2", false), ("r 3", true)], "a path of one segment has no area");
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
        let told = [
            "line 2, column 1: <text> has no outline here and is left out",
            "line 2, column 15: the hidden <g> \"\" is left out (display: none)",
        ];
        assert_eq!(found.warnings, told);
    }

    #[test]
    fn what_is_hidden_is_told_and_left_out() {
        let shown = "<path id='shown' d='M0 0h5v5'/>";
        for (hidden, said) in [
            (
                "<path id='a' visibility='hidden' d='M0 0h5'/>",
                "the hidden <path> \"a\" is left out (visibility: hidden)",
            ),
            ("<g id='a' opacity='0'><path d='M0 0h5'/></g>", "the hidden <g> \"a\" is left out (opacity: 0)"),
            (
                "<style>.h{display:none}</style><path id='a' class='h' d='M0 0h5'/>",
                "<path> \"a\" is left out (display: none)",
            ),
            (
                "<g visibility='hidden'><rect id='a' width='5' height='5'/></g>",
                "<rect> \"a\" is left out (visibility: hidden)",
            ),
        ] {
            let found = read(&(hidden.to_owned() + shown)).unwrap();
            assert_eq!((found.shapes.len(), found.shapes[0].name.as_str()), (1, "shown"));
            assert!(found.warnings.len() == 1 && found.warnings[0].contains(said), "{:?}", found.warnings);
        }
        let moves = "<path id='a' d='M0 0h5v5'><animateTransform attributeName='transform' type='translate' values='0 0;9 9' dur='1s'/></path>";
        let found = read(moves).unwrap();
        assert!(found.shapes.len() == 1 && found.warnings[0].contains("\"a\" moves by an animated transformation"));
    }

    #[test]
    fn a_fill_closes_a_path() {
        let closed = |path: &str| read(path).unwrap().shapes[0].closed;
        assert!(closed("<path fill='#f00' d='M0 0h5v5'/>") && closed("<path d='M0 0h5v5'/>"));
        assert!(
            !closed("<path fill='none' d='M0 0h5v5'/>") && !closed("<g style='fill:none'><path d='M0 0h5v5'/></g>")
        );
        let found = read("<path d='M0 0h5v5'/>").unwrap();
        assert_eq!(found.shapes[0].keys[&6].len(), 3);
    }

    #[test]
    fn nested_documents_and_css_have_their_places() {
        let start = |content: &str| read(content).unwrap().shapes[0].keys[&6][0] * 0.5 + Point::new(10.0, 0.0);
        let nested =
            |more: &str| format!("<svg x='30' y='10' width='40' height='20' {more}><path d='M2 3h5v5'/></svg>");
        assert_eq!(start(&nested("")), Point::new(32.0, 13.0));
        assert_eq!(start(&nested("viewBox='0 0 80 40'")), Point::new(31.0, 11.5));
        assert_eq!(start(&nested("viewBox='1 0 20 20'")), Point::new(30.0 + 10.0 + 1.0, 13.0));
        assert_eq!(start(&nested("viewBox='0 0 20 20' preserveAspectRatio='none'")), Point::new(34.0, 13.0));
        assert_eq!(
            start(&nested("viewBox='0 0 20 20' preserveAspectRatio='xMinYMax slice'")),
            Point::new(34.0, 10.0 - 20.0 + 6.0)
        );
        let all = "<svg viewBox='0 0 50 25'><path d='M2 3h5v5'/></svg>";
        assert_eq!(start(all), Point::new(4.0, 6.0), "as large as what is around it");
        assert_eq!(start("<path style='transform:translate(20px,4px)' d='M2 3h5v5'/>"), Point::new(22.0, 7.0));
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
