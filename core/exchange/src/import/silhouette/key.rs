//! The keys of a path.
//!
//! A key has a frame and a `Path` of `Point`s. A point of a Bézier path has a position and two handles, a point of a B-spline only
//! a position, perhaps with a weight. Between keys points move evenly. A key with `interp="hold"` keeps its form until the frame
//! before the next key.

use super::super::ImportError;
use super::super::limits::near;
use super::super::problem::{number, quoted};
use super::is_true;
use super::place::Place;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};
use roxmltree::Node;

/// A point with its two handles.
pub(super) type Knot = [Point; 3];

/// The form of a path on one frame, in pixels of the footage.
#[derive(Clone, Debug)]
pub(super) struct Form {
    pub closed: bool,
    pub spline: bool,
    pub knots: Vec<Knot>,
}

/// One key of a path.
pub(super) struct Key<'a> {
    pub node: Node<'a, 'a>,
    pub frame: f64,
    pub held: bool,
    pub form: Form,
}

impl<'a> Key<'a> {
    pub fn read(node: Node<'a, 'a>, first: f64, place: &Place, footage: &Footage) -> Result<Self, ImportError> {
        let frame = number(node, "frame")?.map_or(footage.first.into(), |frame| frame + first);
        if frame.fract() != 0.0 {
            return Err(ImportError::at(node, format!("found a key on frame {frame}, expected a whole frame")));
        }
        let Some(path) = node.children().find(|n| n.tag_name().name() == "Path") else {
            return Err(ImportError::at(node, "found no <Path>, expected one"));
        };
        let kind = path.attribute("type").unwrap_or("Bezier");
        let spline = kind.eq_ignore_ascii_case("bspline");
        if !spline && !kind.eq_ignore_ascii_case("bezier") {
            return Err(ImportError::at(path, format!("type: found {kind:?}, expected \"Bezier\" or \"Bspline\"")));
        }
        let closed = path.attribute("closed").is_none_or(is_true);
        let points = path.children().filter(|n| n.tag_name().name() == "Point");
        let knots = points.map(|point| knot(point, place)).collect::<Result<Vec<_>, _>>()?;
        if knots.is_empty() {
            return Err(ImportError::at(path, "found no <Point>, expected at least one"));
        }
        let held = node.attribute("interp").is_some_and(|text| text.eq_ignore_ascii_case("hold"));
        Ok(Self { node, frame, held, form: Form { closed, spline, knots } })
    }
}

fn knot(node: Node, place: &Place) -> Result<Knot, ImportError> {
    let text = node.text().unwrap_or("").trim();
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().trim_matches(['(', ')']).parse().ok()).collect();
    let numbers = numbers.filter(|numbers| numbers.iter().all(|n| n.is_finite())).unwrap_or_default();
    let placed = |pair: &[f64]| near(place.pixels(Point::new(pair[0], pair[1])), node);
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

/// The frames on which a path turns: its keys, and the last frame of each held form.
pub(super) fn turns(keys: &[Key]) -> Vec<f64> {
    let ends = keys.windows(2).filter(|pair| pair[0].held).map(|pair| pair[1].frame - 1.0);
    let mut frames: Vec<f64> = keys.iter().map(|key| key.frame).chain(ends).collect();
    frames.sort_by(f64::total_cmp);
    frames.dedup();
    frames
}

/// The form on a frame. `keys` are in the order of time, at least one, and have the same number of points.
pub(super) fn form(keys: &[Key], frame: FrameNumber) -> Form {
    let frame = f64::from(frame);
    let next = keys.partition_point(|key| key.frame <= frame);
    let (Some(from), Some(to)) = (next.checked_sub(1).map(|k| &keys[k]), keys.get(next)) else {
        return keys[next.saturating_sub(1)].form.clone();
    };
    let share = if from.held { 0.0 } else { (frame - from.frame) / (to.frame - from.frame) };
    let pairs = from.form.knots.iter().zip(&to.form.knots);
    let knots = pairs.map(|(a, b)| std::array::from_fn(|k| a[k].lerp(b[k], share))).collect();
    Form { knots, ..from.form }
}
