//! Shapes of an SVG document.
//!
//! Paths, polygons, polylines, lines, rectangles, circles and ellipses become shapes, with their transformations
//! applied. Each sub-path of a path becomes a shape of its own. The view box of the document is mapped to the footage.
//! Its names are found in several places (`svg_names`).
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
//! An element that cannot be read is left out with a warning, as browsers leave it out. If nothing else is in the file, its error is that of the file.
//!
//! Limits: content that is not drawn in place (definitions, clips, masks, patterns, symbols) is ignored. Text, pictures
//! and `use` are left out with a warning, and so are animations of transformations. Nesting, coordinates and points are bounded (`limits`).

use super::limits::{Points, near};
use super::names::Names;
use super::path::{NoContours, Path, contours};
use super::problem::{LeftOut, parsed};
use super::range::Kept;
use super::svg_animation::{Keyed, hidden as hidden_times, keyed};
use super::svg_edited::{Edit, edit};
use super::svg_elements::{GROUPS, NOT_DRAWN, SHAPES, WITHOUT_OUTLINE};
use super::svg_holes::{Bound, bounds};
use super::svg_lost::{Cause, Clips, Cover, Lost, clips, covers};
use super::svg_names::Called;
use super::svg_outline::{outline, paths};
use super::svg_style::Styles;
use super::svg_transform::{Places, joined, moved};
use super::svg_unread::unread;
use super::svg_view::{View, nested, viewed};
use super::{ImportError, Shape, Shapes};
use crate::between::{Keys, form};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};
use roxmltree::Node;
use svgtypes::Transform;

/// Attributes of the root of an export: the first and the last frame of the document that it shows.
const FIRST: &str = "data-first";
const LAST: &str = "data-last";
/// The attribute of a part of an export that has nothing but keys: their frames.
const KEYS: &str = "data-keys";

/// Reads the shapes of an SVG document for footage. A shape without animation gets its key on frame `still`. Points are
/// converted to pixels of the footage.
///
/// # Errors
///
/// An [`ImportError`] names the element and its place.
pub fn svg(text: &str, footage: &Footage, still: FrameNumber) -> Result<Shapes, ImportError> {
    svg_of(text, footage, Still { frame: still, asked: false }, &[])
}

/// The frame of shapes without animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Still {
    /// A frame of the footage.
    pub frame: FrameNumber,
    /// Whether somebody asked for it: then an export of one frame lies there too, though it says another frame. An export of several frames is refused.
    pub asked: bool,
}

/// The same for shapes that may be parts of a document with these names, in its order. A path of an export that has lost its name finds its part by
/// its number.
///
/// # Errors
///
/// As for [`svg`].
pub fn svg_of(text: &str, footage: &Footage, still: Still, parts: &[&str]) -> Result<Shapes, ImportError> {
    let document = parsed(text)?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(ImportError::at(root, "expected <svg>, the root of an SVG document"));
    }
    let (view, over) = viewed(root, footage)?;
    let (styles, clips) = (Styles::of(&document), clips(&document));
    let film = film(root, footage, still)?;
    let still = film.as_ref().map_or(still.frame, |film| still.frame.clamp(film.first, film.last));
    let read = |strokes| {
        let mut reader = Reader::new([footage, film.as_ref().unwrap_or(footage)], still, &styles, &clips);
        (reader.strokes, reader.called) = (strokes, Called::new(&document, parts));
        reader.is_film = film.is_some();
        if styles.own(root, "transform").is_some_and(|text| text != "none") {
            reader.left_out.push(root, "the transformation of the whole document is not read".to_owned());
        }
        reader.group(root, &view, over).map(|()| reader)
    };
    let mut reader = read(false)?;
    if reader.shapes.is_empty() && reader.drawn.strokes > 0 {
        reader = read(true)?;
    }
    if reader.shapes.is_empty() {
        if let Some(refused) = reader.refused {
            return Err(refused);
        }
        return Err(ImportError::Nothing(match reader.drawn.regions {
            0 => "a path, polygon, polyline, line, rect, circle or ellipse",
            _ => "one beside the painted regions that Rototoon has written, which are no parts",
        }));
    }
    reader.names.settle(&mut reader.shapes);
    reader.lost.tell(&mut reader.left_out);
    reader.called.tell(&mut reader.left_out);
    let mut warnings = reader.left_out.lines(text);
    warnings.extend(reader.drawn.told());
    Ok(Shapes { shapes: reader.shapes, warnings })
}

/// The footage of the frames of which an export is a film, if the document has some of them. Others begin with the first frame of the footage.
fn film(root: Node, footage: &Footage, still: Still) -> Result<Option<Footage>, ImportError> {
    let frame = |name| root.attribute(name)?.trim().parse::<FrameNumber>().ok();
    let Some((first, last)) = frame(FIRST).zip(frame(LAST)).filter(|(first, last)| first <= last) else {
        return Ok(None);
    };
    let of = |first, last| Some(Footage { first, last, ..footage.clone() });
    if !still.asked {
        let meets = first <= footage.last && footage.first <= last;
        return Ok(of(first, last).filter(|_| meets));
    }
    if first < last {
        let message = format!("found the frames {first} to {last}, expected one frame for frame {}", still.frame);
        return Err(ImportError::at(root, message));
    }
    Ok(of(still.frame, still.frame))
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
    /// The frames that the file shows: its own, or those of the footage.
    film: &'a Footage,
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
    /// The error of the first element that cannot be read.
    refused: Option<ImportError>,
    called: Called<'a>,
    clips: &'a Clips<'a>,
    /// The clips and masks of the elements around.
    covers: Vec<Cover>,
    lost: Lost,
}

/// The sub-paths of an element on its keys.
type Frames = Vec<(FrameNumber, Vec<Path>)>;

impl<'a> Reader<'a> {
    fn new([footage, film]: [&'a Footage; 2], still: FrameNumber, styles: &'a Styles, clips: &'a Clips<'a>) -> Self {
        Self {
            footage,
            film,
            styles,
            still,
            shapes: Vec::new(),
            names: Names::default(),
            points: Points::all(),
            left_out: styles.unread.clone(),
            strokes: false,
            is_film: false,
            drawn: Drawn::default(),
            refused: None,
            called: Called::default(),
            clips,
            covers: Vec::new(),
            lost: Lost::default(),
        }
    }

    fn group(&mut self, node: Node, view: &View, outer: Transform) -> Result<(), ImportError> {
        for child in node.children().filter(Node::is_element) {
            if NOT_DRAWN.contains(&child.tag_name().name()) || self.is_left_out(child) {
                continue;
            }
            if let Err(error) = self.element(child, view, outer) {
                self.refuse(child, error)?;
            }
        }
        Ok(())
    }

    /// Leaves out an element that cannot be read, which is told: browsers show the others too. Too many points are an error of the whole file.
    fn refuse(&mut self, node: Node, error: ImportError) -> Result<(), ImportError> {
        let ImportError::Element { element, message, .. } = &error else { return Err(error) };
        if self.points.spent {
            return Err(error);
        }
        self.left_out.push(node, format!("<{element}> {:?} is left out: {message}", self.called.name(node)));
        self.refused.get_or_insert(error);
        Ok(())
    }

    /// Reads an element and all in it.
    fn element(&mut self, node: Node, view: &View, outer: Transform) -> Result<(), ImportError> {
        let inner = joined(outer, self.own_transform(node, view)?);
        let around = self.covers.len();
        self.covers.extend(covers(node, self.styles, self.clips, view, inner));
        let read = self.within(node, view, inner);
        self.covers.truncate(around);
        read
    }

    /// Reads an element that is placed.
    fn within(&mut self, node: Node, view: &View, inner: Transform) -> Result<(), ImportError> {
        match (outline(node, self.styles, view)?, node.tag_name().name()) {
            (Some(text), _) => self.shape(node, &text, inner),
            (None, "svg") => {
                let (view, within) = nested(node, view)?;
                self.group(node, &view, joined(inner, within))
            }
            (None, "g" | "a" | "switch") => self.group(node, view, inner),
            (None, _) => Ok(()),
        }
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
            self.left_out
                .push(node, format!("the hidden <{element}> {:?} is left out ({reason})", self.called.name(node)));
        }
        true
    }

    /// The transformation of an element. One that moves is not read, which is told.
    fn own_transform(&mut self, node: Node, view: &View) -> Result<Transform, ImportError> {
        let moves = |child: &Node| ["animateTransform", "animateMotion"].contains(&child.tag_name().name());
        if node.children().any(|child| moves(&child)) {
            let told = format!(
                "{:?} moves by an animated transformation, which is not read: it stands still",
                self.called.name(node)
            );
            self.left_out.push(node, told);
        }
        for told in unread(node, &self.called.name(node), self.film) {
            self.left_out.push(node, told);
        }
        if let Some(property) = self.styles.moving(node) {
            let told = format!("{:?} is moved by `{property}` of its style, which is not read", self.called.name(node));
            self.left_out.push(node, told);
        }
        Places { styles: self.styles, points: &mut self.points }.own(node, view)
    }

    fn shape(&mut self, node: Node, text: &str, transform: Transform) -> Result<(), ImportError> {
        let found = keyed(node, self.film)?;
        if let Some(told) = found.as_ref().and_then(|found| found.kept.told(&self.called.name(node), self.film)) {
            self.left_out.push(node, told);
        }
        let own_film = self.is_film && found.is_some();
        let still = || vec![Keyed { frame: self.still, text: text.to_owned(), toward: None }];
        let keys = of_artist(node, found.map_or_else(still, |found| found.keys));
        let frames = keys.iter().map(|key| Ok((key.frame, self.placed(node, key, transform)?)));
        let mut frames = frames.collect::<Result<Frames, ImportError>>()?;
        if own_film {
            self.take_edit(node, text, transform, &mut frames)?;
        }
        let Some((_, start)) = frames.first() else { return Ok(()) };
        let made = self.contours(node, &frames)?;
        let bounds = self.bounds(node, start, &made);
        let hidden = hidden_times(node, self.film);
        let shown = self.shown();
        let all = self.shapes.len();
        for (number, contours) in made.into_iter().enumerate().filter(|(number, _)| bounds[*number] != Bound::Hole) {
            let name = self.names.free(&self.called.name(node));
            self.called.took(node, &name);
            let keys = frames.iter().map(|(frame, _)| *frame).zip(contours).collect();
            let keys = self.cut(node, &name, keys);
            let (shape, never) = Shape::new((name, start[number].closed), keys, &hidden, &shown);
            never.into_iter().for_each(|never| self.left_out.push(node, never));
            // Another drawing is of one frame; it does not say that the part stands still.
            let extent = if self.is_film { shape.extent } else { shape.extent.of_drawing() };
            self.shapes.push(Shape { extent, ..shape });
        }
        self.tell_lost(node, all, bounds.iter().any(|bound| *bound != Bound::Area));
        Ok(())
    }

    /// The frames of the footage that the file shows.
    fn shown(&self) -> Footage {
        let (first, last) = (self.film.first.max(self.footage.first), self.film.last.min(self.footage.last));
        Footage { first, last, ..self.footage.clone() }
    }

    /// The keys within the footage. Where a film goes on beyond one of its ends, the form there is a key, and the keys beyond are told.
    fn cut(&mut self, node: Node, name: &str, keys: Keys) -> Keys {
        let kept = Kept::of(keys.keys().map(|&frame| f64::from(frame)), self.footage);
        if let Some(told) = kept.told(name, self.footage) {
            self.left_out.push(node, told);
        }
        kept.frames.iter().map(|&frame| (frame, form(&keys, frame))).collect()
    }

    /// The contours of each sub-path on all keys.
    fn contours(&mut self, node: Node, frames: &Frames) -> Result<Vec<Vec<Vec<Point>>>, ImportError> {
        let Some((first, start)) = frames.first() else { return Ok(Vec::new()) };
        let unequal = || unequal(node, *first);
        if frames.iter().any(|(_, paths)| paths.len() != start.len()) {
            return Err(unequal());
        }
        let one = |number: usize| {
            let own: Vec<Path> = frames.iter().map(|(_, paths)| paths[number].clone()).collect();
            contours(&own, |count| self.points.take(count, node)).map_err(|error| match error {
                NoContours::Unequal => unequal(),
                NoContours::Refused(error) => error,
            })
        };
        (0..start.len()).map(one).collect()
    }

    /// Takes what a drawing program has changed in a film of Rototoon as the form on its first key, or tells why not.
    fn take_edit(&mut self, node: Node, text: &str, to: Transform, frames: &mut Frames) -> Result<(), ImportError> {
        let Some((frame, _)) = frames.first() else { return Ok(()) };
        let key = Keyed { frame: *frame, text: text.to_owned(), toward: None };
        let shown = self.placed(node, &key, to);
        if self.points.spent {
            return shown.map(drop);
        }
        let keys: Vec<&[Path]> = frames.iter().map(|(_, paths)| &paths[..]).collect();
        match shown.as_ref().map_or(Edit::Other, |shown| edit(&keys, shown)) {
            Edit::None => {}
            Edit::Moved => frames[0].1 = shown?,
            Edit::Other => {
                let told = format!(
                    "the edit of {:?} on frame {frame} is left out: it has other points than the other frames; export that frame alone to give it others",
                    self.called.name(node)
                );
                self.left_out.push(node, told);
            }
        }
        Ok(())
    }

    /// What the sub-paths of a filled path bound on its first key.
    fn bounds(&mut self, node: Node, start: &[Path], made: &[Vec<Vec<Point>>]) -> Vec<Bound> {
        let closed: Vec<usize> = (0..start.len()).filter(|&number| start[number].closed).collect();
        let mut found = vec![Bound::Area; start.len()];
        if closed.len() < 2 || !self.styles.is_filled(node) {
            return found;
        }
        let is_even_odd = self.styles.inherited(node, "fill-rule") == Some("evenodd");
        let contours: Vec<&[Point]> = closed.iter().map(|&number| &made[number][0][..]).collect();
        match bounds(&contours, is_even_odd) {
            Some(bounds) => closed.iter().zip(bounds).for_each(|(&number, bound)| found[number] = bound),
            None => self.lost.add(Cause::Unsought, node, &self.called.name(node)),
        }
        found
    }

    /// Tells what is lost of the shapes of an element, which are those from `from` on.
    fn tell_lost(&mut self, node: Node, from: usize, has_holes: bool) {
        let shapes = &self.shapes[from..];
        if let Some(first) = shapes.first().filter(|_| has_holes) {
            self.lost.add(Cause::Hole, node, &first.name);
        }
        for shape in shapes {
            let points = || shape.keys.values().flatten();
            for cause in self.covers.iter().filter_map(|cover| cover.hides(points(), self.footage)) {
                self.lost.add(cause, node, &shape.name);
            }
        }
    }

    /// The sub-paths of a key, in pixels of the footage.
    fn placed(&mut self, node: Node, key: &Keyed, transform: Transform) -> Result<Vec<Path>, ImportError> {
        let is_filled = node.tag_name().name() != "line" && self.styles.is_filled(node);
        let mut read = |text: &str| {
            let mut own = paths(node, text, &mut self.points)?;
            // A fill joins the end of an open path to its start.
            if is_filled {
                own.iter_mut().filter(|path| !path.closed && path.segments.len() > 1).for_each(Path::close);
            }
            Ok::<_, ImportError>(own)
        };
        let mut own = read(&key.text)?;
        if let Some((text, share)) = &key.toward {
            let to = read(text)?;
            let built =
                |paths: &[Path]| paths.iter().map(|path| (path.segments.len(), path.closed)).collect::<Vec<_>>();
            if built(&own) != built(&to) {
                return Err(unequal(node, key.frame));
            }
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

/// The error for keys of several kinds, of which the first is on a frame.
fn unequal(node: Node, first: FrameNumber) -> ImportError {
    let message = format!("found paths of several kinds, expected the commands of frame {first} on each key");
    ImportError::at(node, message)
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

/// What an element of an export is. The title of a region is the name of its colour, if that has one. Programs that drop titles keep the groups.
fn drawn(node: Node) -> Option<Written> {
    let id = node.attribute("id")?;
    let number = |text: &str| text.parse::<i64>().is_ok();
    let Some(title) = title(node).filter(|title| !title.trim().is_empty()) else {
        let within = |group: &str| node.ancestors().any(|around| around.attribute("id") == Some(group));
        let is = |before: &str| id.strip_prefix(before).is_some_and(number);
        return match () {
            () if is("fill-") && within("paint") => Some(Written::Region),
            () if is("stroke-") && within("lines") => Some(Written::Stroke),
            () => None,
        };
    };
    let words: Vec<&str> = title.split(' ').collect();
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

#[cfg(test)]
mod tests;
