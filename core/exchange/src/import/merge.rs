//! Puts the shapes of a file into a scene.
//!
//! **Why.** Shapes go out to another program, an artist edits one of them there, and all come back. What was not edited is known better in the
//! document: which contours are keys, how sure the others are, feathers, pins, snapped paths.
//!
//! **How.** A shape that has a part's name and its number of points is compared with the part on each frame, within [`SAME`]. Where it is the same, the part stays as it
//! is. Where it is another one, its contour becomes a key if the file or the part has a key there, and a tracked contour if it is between two keys of
//! the file. Hidden frames are compared in the same way. A file of a snapped part has the points of its curve. Such a shape is the same if it lies on the curve
//! on all frames.
//!
//! Every other shape with a part's name replaces it: only the depth and the colour stay. Shapes with new names become new parts, nearer than all present parts. They are
//! shown as the file shows them, also between keys, until they are tracked.
//!
//! **Limits.** A snapped part of which one frame was edited is replaced on all frames, because its points are others.

use super::{Shape, hidden};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{Falloff, Footage, FrameNumber, Part, Scene};
use std::collections::{BTreeMap, BTreeSet};

/// Distance within which points are the same, in pixels: formats round them, and some have 32 bits for a coordinate.
const SAME: f64 = 0.01;
/// Distance from a snapped path within which a point lies on it, in pixels, and the greatest difference in length, as a share.
const ON_PATH: (f64, f64) = (0.05, 0.02);

/// What became of a shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Taken {
    /// Name of the part.
    pub name: String,
    /// What it did to the scene.
    pub change: Change,
}

/// What a shape did to a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// It is a new part.
    New,
    /// It replaced the part of its name.
    Replaced,
    /// It changed the part of its name on these frames.
    Frames(Vec<FrameNumber>),
    /// The part of its name was the same already.
    Nothing,
}

/// Puts shapes into the scene. Says for each what became of it.
pub fn into_scene(scene: &mut Scene, shapes: Vec<Shape>) -> Vec<Taken> {
    let nearest = scene.parts.iter().map(|part| part.depth).fold(f64::NEG_INFINITY, f64::max);
    let mut depth = if nearest.is_finite() { nearest.floor() + 1.0 } else { 0.0 };
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for (place, part) in scene.parts.iter().enumerate() {
        places.entry(part.name.clone()).or_insert(place);
    }
    // Files have no blanks at the ends of names.
    for (place, part) in scene.parts.iter().enumerate() {
        places.entry(part.name.trim().to_owned()).or_insert(place);
    }
    let mut taken = Vec::with_capacity(shapes.len());
    for shape in shapes {
        let (name, change) = match places.get(&shape.name) {
            Some(&place) => {
                let part = &mut scene.parts[place];
                let change = update(part, shape, &scene.footage);
                (part.name.clone(), change)
            }
            None => {
                let name = shape.name.clone();
                places.insert(name.clone(), scene.parts.len());
                scene.parts.push(Part { depth, ..part_of(shape) });
                depth += 1.0;
                (name, Change::New)
            }
        };
        taken.push(Taken { name, change });
    }
    taken
}

/// A part that is as the file shows it.
fn part_of(shape: Shape) -> Part {
    let mut part = Part { closed: shape.closed, tracks: shown(&shape), ..Part::default() };
    part.falloff = shape.falloff.unwrap_or_default();
    (part.name, part.keys, part.absent) = (shape.name, shape.keys, shape.absent);
    part.forget_where_absent();
    part
}

/// The contours on all frames on which the file shows a shape.
fn shown(shape: &Shape) -> BTreeMap<FrameNumber, Vec<Point>> {
    let frames: Vec<FrameNumber> = match (shape.keys.first_key_value(), shape.keys.last_key_value()) {
        (Some((first, _)), Some((last, _))) if first < last => (*first..=*last).collect(),
        _ if shape.held.len() > 1 => shape.held.clone(),
        _ => Vec::new(),
    };
    frames.into_iter().map(|frame| (frame, hidden::form(&shape.keys, frame))).collect()
}

/// Brings a part up to date with the shape of its name.
fn update(part: &mut Part, shape: Shape, footage: &Footage) -> Change {
    if is_comparable(part, &shape) {
        let frames = merge(part, &shape, footage);
        let same_border = merge_falloff(&mut part.falloff, shape.falloff);
        return if frames.is_empty() && same_border { Change::Nothing } else { Change::Frames(frames) };
    }
    if is_on_paths(part, &shape, footage) {
        return Change::Nothing;
    }
    let (name, depth, colour) = (std::mem::take(&mut part.name), part.depth, part.colour);
    *part = Part { name, depth, colour, ..part_of(shape) };
    Change::Replaced
}

/// Takes the falloff that a file gives. Files have its rate, but not its curve. Returns whether it was the same.
fn merge_falloff(own: &mut Falloff, file: Option<Falloff>) -> bool {
    let differs = file.filter(|file| (file.rate - own.rate).abs() > 1e-4);
    if let Some(file) = differs {
        *own = file;
    }
    differs.is_none()
}

/// Whether a shape has the points of a part.
fn is_comparable(part: &Part, shape: &Shape) -> bool {
    let count = shape.keys.values().next().map_or(0, Vec::len);
    let mut contours = part.keys.values().chain(part.tracks.values()).peekable();
    let curved = part.curves.keys().any(|&frame| part.complete_curves(frame).is_some());
    let exact = || part.keys.iter().all(|(frame, key)| is_same(key, &hidden::form(&shape.keys, *frame)));
    part.closed == shape.closed
        && contours.peek().is_some()
        && contours.all(|points| points.len() == count)
        // Few points may be those of the curve by chance.
        && (!curved || exact())
}

fn is_same(a: &[Point], b: &[Point]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.distance(*b) <= SAME)
}

/// What the file shows on a frame of which the part knows.
fn of_file(shape: &Shape, frame: FrameNumber) -> Option<Vec<Point>> {
    let is_key = shape.keys.contains_key(&frame);
    if shape.keys.len() == 1 && !is_key && !shape.held.contains(&frame) {
        return None;
    }
    let is_hidden = !is_key && shape.absent.iter().any(|[first, last]| (*first..=*last).contains(&frame));
    (!is_hidden).then(|| hidden::form(&shape.keys, frame))
}

/// Whether a frame lies on or between the keys of a shape.
fn is_between_keys(shape: &Shape, frame: FrameNumber) -> bool {
    shape.keys.range(..=frame).next().is_some() && shape.keys.range(frame..).next().is_some()
}

/// Changes a part where the file shows another contour, or another presence. Returns the frames.
fn merge(part: &mut Part, shape: &Shape, footage: &Footage) -> Vec<FrameNumber> {
    let known = part.keys.keys().chain(part.tracks.keys()).chain(shape.keys.keys());
    let hidden = (footage.first..=footage.last).filter(|&frame| part.is_absent(frame));
    let mut frames: BTreeSet<FrameNumber> = known.copied().chain(hidden).collect();
    if shape.keys.len() == 1 && shape.held.is_empty() {
        // A drawing of one frame says nothing of others.
        frames.retain(|frame| shape.keys.contains_key(frame));
    }
    let mut changed = Vec::new();
    for frame in frames {
        let own = part.points_at(frame);
        // Beyond its keys a file says nothing of frames that the part does not have.
        let file = of_file(shape, frame).filter(|_| own.is_some() || is_between_keys(shape, frame));
        let is_other = match (own, &file) {
            (Some(own), Some(file)) => !is_same(own, file),
            (None, None) => false,
            _ => true,
        };
        if is_other {
            set(part, frame, file, shape.keys.contains_key(&frame));
            changed.push(frame);
        }
    }
    changed
}

/// Sets the contour of a part on a frame, or hides the part there.
fn set(part: &mut Part, frame: FrameNumber, points: Option<Vec<Point>>, is_key: bool) {
    let was_key = part.keys.remove(&frame).is_some();
    part.pins.remove(&frame);
    part.centers.remove(&frame);
    part.confidence.remove(&frame);
    part.curves.remove(&frame);
    let is_tracked = !part.tracks.is_empty();
    part.tracks.remove(&frame);
    let Some(points) = points else {
        part.set_absent(frame, frame);
        return;
    };
    part.clear_absent(frame, frame);
    if is_key || was_key {
        part.keys.insert(frame, points.clone());
    }
    // A key that is in the tracks is one that they know: nothing else of them is out of date.
    if is_tracked {
        part.tracks.insert(frame, points);
    }
}

/// Whether a shape is what an export makes of a snapped part: points of its curve, on each frame that has one.
fn is_on_paths(part: &Part, shape: &Shape, footage: &Footage) -> bool {
    if part.closed != shape.closed || part.curves.is_empty() {
        return false;
    }
    let (near, share) = ON_PATH;
    let agrees = |frame: FrameNumber| {
        let file = of_file(shape, frame).filter(|_| is_between_keys(shape, frame));
        let (Some(own), Some(file)) = (part.outline(frame), &file) else {
            return part.points_at(frame).is_none() && file.is_none();
        };
        let (length, other) = (polyline::length(&own, part.closed), polyline::length(file, part.closed));
        (length - other).abs() <= share * length.max(1.0)
            && file.iter().all(|&p| polyline::distance(p, &own, part.closed) <= near)
    };
    (footage.first..=footage.last).all(agrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn footage() -> Footage {
        Footage { pattern: "%d".into(), first: 1, last: 12, fps: 1.0, width: 90, height: 90, held: false }
    }

    fn at(frame: FrameNumber) -> Vec<Point> {
        let x = f64::from(frame);
        vec![Point::new(x, 1.0), Point::new(x + 9.0, 2.0 + 0.1 * x * x), Point::new(4.0, 20.0)]
    }

    /// A part with two keys, tracked between them.
    fn tracked() -> Part {
        Part {
            name: "arm".into(),
            closed: true,
            depth: 3.5,
            keys: [2, 9].map(|frame| (frame, at(frame))).into(),
            tracks: (2..=9).map(|frame| (frame, at(frame))).collect(),
            confidence: (2..=9).map(|frame| (frame, vec![0.5; 3])).collect(),
            pins: [(4, [(1, at(4)[1])].into()), (6, [(0, at(6)[0])].into())].into(),
            feather: vec![1.0, 2.0, 3.0],
            falloff: Falloff { rate: 2.0, ..Falloff::default() },
            ..Part::default()
        }
    }

    /// The shape that such a part is in a file: a key on every frame.
    fn written(part: &Part) -> Shape {
        Shape {
            name: part.name.clone(),
            closed: part.closed,
            keys: part
                .tracks
                .iter()
                .map(|(frame, points)| (*frame, points.iter().map(|p| *p + 1e-3).collect()))
                .collect(),
            absent: Vec::new(),
            falloff: None,
            held: Vec::new(),
        }
    }

    fn put(part: Part, shape: Shape) -> (Part, Change) {
        let mut scene = Scene { footage: footage(), parts: vec![part] };
        let mut taken = into_scene(&mut scene, vec![shape]);
        assert_eq!(scene.parts.len(), 1);
        (scene.parts.remove(0), taken.remove(0).change)
    }

    #[test]
    fn what_comes_back_unchanged_changes_nothing() {
        let part = tracked();
        assert_eq!(put(part.clone(), written(&part)), (part.clone(), Change::Nothing));
        let untracked = Part { tracks: BTreeMap::new(), confidence: BTreeMap::new(), pins: BTreeMap::new(), ..part };
        let mut shape = written(&tracked());
        shape.keys.retain(|frame, _| untracked.keys.contains_key(frame));
        assert_eq!(put(untracked.clone(), shape), (untracked, Change::Nothing));
    }

    #[test]
    fn an_edited_frame_becomes_a_key_and_all_else_stays() {
        let part = tracked();
        let mut shape = written(&part);
        shape.keys.get_mut(&4).unwrap()[1].x += 2.0;
        let (found, change) = put(part.clone(), shape.clone());
        assert_eq!(change, Change::Frames(vec![4]));
        assert_eq!(found.keys.keys().copied().collect::<Vec<_>>(), [2, 4, 9]);
        assert_eq!((&found.keys[&4], &found.tracks[&4]), (&shape.keys[&4], &shape.keys[&4]));
        assert!(found.outdated().next().is_none() && !found.confidence.contains_key(&4));
        assert_eq!(found.pins.keys().copied().collect::<Vec<_>>(), [6], "the edit is newer than the pin");
        assert_eq!((&found.tracks[&5], &found.confidence[&5]), (&part.tracks[&5], &part.confidence[&5]));
        assert_eq!((&found.feather, found.falloff), (&part.feather, part.falloff));
    }

    #[test]
    fn frames_between_the_keys_of_the_file_are_as_it_shows_them() {
        let part = tracked();
        let mut shape = written(&part);
        // The artist has deleted the keys on 4 to 6, so the shape goes straight there.
        shape.keys.retain(|frame, _| !(4..=6).contains(frame));
        let (found, change) = put(part.clone(), shape);
        assert_eq!(change, Change::Frames(vec![4, 5, 6]));
        assert_eq!(found.keys, part.keys);
        let y = |frame: FrameNumber| found.tracks[&frame][1].y;
        assert!((y(5) - 0.5 * (y(3) + y(7))).abs() < 2e-3, "half way");
    }

    #[test]
    fn a_part_is_hidden_and_shown_as_in_the_file() {
        let part = tracked();
        let mut shape = written(&part);
        shape.keys.retain(|frame, _| !(6..=7).contains(frame));
        shape.absent = vec![[6, 7]];
        let (hidden, change) = put(part.clone(), shape);
        assert_eq!((change, &hidden.absent[..]), (Change::Frames(vec![6, 7]), &[[6, 7]][..]));
        assert!(hidden.points_at(6).is_none() && hidden.points_at(5).is_some());
        let (shown, change) = put(hidden, written(&part));
        assert_eq!((change, shown.absent.len()), (Change::Frames(vec![6, 7]), 0));
        assert!(shown.points_at(6).is_some());
    }

    #[test]
    fn points_on_the_path_of_a_snapped_part_are_its_own() {
        let mut part = tracked();
        part.pins.clear();
        let bent = |a: Point, b: Point| vec![a, a.lerp(b, 0.5) + Point::new(0.5, 1.0), b];
        let paths = |p: &Vec<Point>| vec![bent(p[0], p[1]), bent(p[1], p[2]), bent(p[2], p[0])];
        part.curves = part.tracks.iter().map(|(frame, points)| (*frame, paths(points))).collect();
        let drawn = |frame: &FrameNumber| (*frame, polyline::resample(&part.outline(*frame).unwrap(), true, 600));
        let keys: BTreeMap<_, _> = part.tracks.keys().map(drawn).collect();
        let mut shape = Shape { keys, ..written(&part) };
        assert_eq!(put(part.clone(), shape.clone()), (part.clone(), Change::Nothing));
        shape.keys.get_mut(&5).unwrap()[40] += Point::new(3.0, 3.0);
        let (found, change) = put(part, shape.clone());
        assert_eq!((change, found.keys), (Change::Replaced, shape.keys));
        assert_eq!(found.depth, 3.5);
    }

    #[test]
    fn a_new_part_is_shown_as_the_file_shows_it() {
        let keys = [2, 9].map(|frame| (frame, at(frame))).into();
        let shape = Shape { name: "leg".into(), keys, absent: vec![[4, 5]], ..written(&tracked()) };
        let mut scene = Scene { footage: footage(), parts: vec![tracked()] };
        let still = Shape { name: "box".into(), keys: [(3, at(3))].into(), held: (1..=12).collect(), ..shape.clone() };
        let still = Shape { absent: Vec::new(), ..still };
        let taken = into_scene(&mut scene, vec![shape, still]);
        assert!(taken.iter().all(|taken| taken.change == Change::New), "{taken:?}");
        let [_, leg, still] = &scene.parts[..] else { panic!("{}", scene.parts.len()) };
        assert_eq!((leg.depth, still.depth), (4.0, 5.0));
        assert_eq!(leg.tracks.keys().copied().collect::<Vec<_>>(), [2, 3, 6, 7, 8, 9]);
        assert!((leg.tracks[&6][0].x - 6.0).abs() < 1e-9);
        assert!((1..=12).all(|frame| still.points_at(frame) == Some(&at(3))) && still.keys.len() == 1);
    }

    #[test]
    fn a_drawing_of_one_frame_changes_that_frame_alone() {
        let part = tracked();
        let shape = Shape { keys: [(6, at(11))].into(), ..written(&part) };
        let (found, change) = put(part.clone(), shape.clone());
        assert_eq!((change, found.keys.len(), &found.keys[&6]), (Change::Frames(vec![6]), 3, &at(11)));
        assert!(part.tracks.iter().all(|(frame, own)| *frame == 6 || found.tracks[frame] == *own));
        // One that stands still in a film is on all of its frames.
        let still = Shape { held: (1..=12).collect(), ..shape };
        let (found, _) = put(part, still);
        assert!((2..=9).all(|frame| found.points_at(frame) == Some(&at(11))));
    }

    #[test]
    fn the_rate_of_a_falloff_is_taken_where_it_is_another_one() {
        let part = tracked();
        let border = |rate: f64| Shape { falloff: Some(Falloff { rate, curve: None }), ..written(&part) };
        assert_eq!(put(part.clone(), border(2.0)).1, Change::Nothing);
        let (found, change) = put(part.clone(), border(3.0));
        assert_eq!((found.falloff.rate, change), (3.0, Change::Frames(Vec::new())));
    }
}
