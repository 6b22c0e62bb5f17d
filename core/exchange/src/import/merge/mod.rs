//! Puts the shapes of a file into a scene.
//!
//! **Why.** Shapes go out to another program, an artist edits one of them there, and all come back. What was not edited is known better in the
//! document: which contours are keys, how sure the others are, feathers, pins, snapped paths. And what the file does not speak of was not edited.
//!
//! **How.** A shape that has a part's name and its number of points is compared with the part on each frame of which the file speaks
//! ([`Extent`](super::Extent)), within a hundredth of a pixel. Where it is the same, the part stays as it is. Where it is another one, its contour becomes a key if the file or the part has
//! a key there, and a tracked contour if it is between two keys of the file. Hidden frames are compared in the same way.
//!
//! A shape with another number of points is compared as an outline (`outline`): the file of a snapped part has the points of its
//! curve, or of Bézier curves near it (`written`). Where the outline is another one, it becomes a key with control points on it and with its own paths between them. But if the file speaks of all frames of a part, and
//! the outline is another one on all of them, then the shape was drawn anew. It replaces the part: only the depth and the colour stay.
//!
//! A shape that is open where its part is closed, or closed where it is open, replaces it too. If the part has contours of which the file does not speak, it is a
//! new part beside it instead, so nothing is lost.
//!
//! Shapes with new names become new parts, nearer than all present parts. They are shown as the file shows them, also between keys, until they are tracked. Parts that lie in
//! another order in the file get depths for that order (`order`).

mod compared;
mod near;
mod order;
mod outline;
mod written;

use super::limits::MOST_POINTS;
use super::{ImportError, Shape};
use crate::between::form;
use compared::{Compared, Points, is_same};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, Footage, FrameNumber, Part, Scene};
use std::collections::{BTreeMap, BTreeSet};
use written::Written;

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
    /// It is a new part beside the one of its name, because one of both is open, and the part has frames of which the file does not speak.
    Beside(String),
    /// The part of its name was the same already.
    Nothing,
}

/// What shapes did to a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Merged {
    /// What became of each shape, farthest first.
    pub taken: Vec<Taken>,
    /// Parts that lie at another depth now, because the file has them in another order.
    pub moved: Vec<String>,
    /// Parts with contours on frames of which the file does not speak, and these frames. They stay as they were.
    pub kept: Vec<(String, Vec<FrameNumber>)>,
}

/// Puts shapes into the scene. Says for each what became of it.
///
/// # Errors
///
/// [`ImportError::Shown`] for shapes that would have more than [`MOST_POINTS`] points on all frames together; the scene is then unchanged.
pub fn into_scene(scene: &mut Scene, shapes: Vec<Shape>) -> Result<Merged, ImportError> {
    let before = scene.parts.clone();
    let merged = merged(scene, shapes);
    if merged.is_err() {
        scene.parts = before;
    }
    merged
}

fn merged(scene: &mut Scene, shapes: Vec<Shape>) -> Result<Merged, ImportError> {
    let nearest = scene.parts.iter().map(|part| part.depth).fold(f64::NEG_INFINITY, f64::max);
    let depth = if nearest.is_finite() { nearest.floor() + 1.0 } else { 0.0 };
    let places = places(&scene.parts, &shapes);
    let named = shapes.iter().map(|shape| shape.name.clone()).collect();
    let mut into = Into {
        scene,
        places,
        named,
        depth,
        found: Vec::new(),
        merged: Merged::default(),
        room: Room::all(),
        chosen: None,
    };
    shapes.into_iter().try_for_each(|shape| into.take(shape))?;
    let Into { scene, found, mut merged, .. } = into;
    let moved = put(scene, &found);
    merged.moved = moved.into_iter().map(|place| scene.parts[place].name.clone()).collect();
    Ok(merged)
}

/// Gives parts depths for the order in which the file has them. Exports write a part by the depth that it has on all frames, so that counts here too, and is
/// the part's own once another one moved.
fn put(scene: &mut Scene, found: &[usize]) -> Vec<usize> {
    let frames = scene.footage.first..=scene.footage.last;
    let before: Vec<_> = scene.parts.iter().map(|part| (part.depth, part.depths.clone())).collect();
    for part in &mut scene.parts {
        if let Some(depth) = part.depth_in(frames.clone()) {
            part.depth = depth;
            part.depths.clear();
        }
    }
    let moved = order::put(&mut scene.parts, found);
    if moved.is_empty() {
        scene.parts.iter_mut().zip(before).for_each(|(part, own)| (part.depth, part.depths) = own);
    }
    moved
}

/// A scene that shapes go into.
struct Into<'a> {
    scene: &'a mut Scene,
    /// The part that a name means.
    places: BTreeMap<String, usize>,
    /// The names of all shapes of the file.
    named: BTreeSet<String>,
    /// The depth of the next new part.
    depth: f64,
    /// The parts that the file has, in its order.
    found: Vec<usize>,
    merged: Merged,
    room: Room,
    /// The tolerance of the file's Bézier curves, once a shape has told it.
    chosen: Option<f64>,
}

/// The points that contours may still have. A shape of a few bytes is shown on all frames of a film.
struct Room(usize);

impl Room {
    fn all() -> Self {
        Self(MOST_POINTS)
    }

    /// Takes the points of contours before they are made.
    fn take(&mut self, contours: usize, points: usize) -> Result<(), ImportError> {
        let left = contours.checked_mul(points).and_then(|count| self.0.checked_sub(count));
        self.0 = left.ok_or(ImportError::Shown(MOST_POINTS))?;
        Ok(())
    }
}

impl Into<'_> {
    /// Brings the part of a shape's name up to date, or makes a new one.
    fn take(&mut self, mut shape: Shape) -> Result<(), ImportError> {
        let Some(place) = self.places.get(&shape.name).copied() else {
            let name = self.add(shape)?;
            self.told(name, Change::New);
            return Ok(());
        };
        let part = &mut self.scene.parts[place];
        let (name, kept) = (part.name.clone(), unspoken(part, &shape));
        if !kept.is_empty() && part.closed != shape.closed {
            shape.name = self.free(&shape.name);
            let new = self.add(shape)?;
            self.told(new, Change::Beside(name));
            return Ok(());
        }
        let change = update(part, shape, &self.scene.footage, (&mut self.room, &mut self.chosen))?;
        self.found.push(place);
        if !kept.is_empty() && change != Change::Replaced {
            self.merged.kept.push((name.clone(), kept));
        }
        self.told(name, change);
        Ok(())
    }

    /// Makes a new part, and returns its name. Blanks at the ends of a name go if that makes it no other one's.
    fn add(&mut self, shape: Shape) -> Result<String, ImportError> {
        let plain = shape.name.trim().to_owned();
        let is_taken = self.places.contains_key(&plain) || self.named.contains(&plain);
        let name = if is_taken { shape.name.clone() } else { plain };
        self.places.insert(name.clone(), self.scene.parts.len());
        let own = part_of(shape, &mut self.room)?;
        self.scene.parts.push(Part { name: name.clone(), depth: self.depth, ..own });
        self.depth += 1.0;
        Ok(name)
    }

    /// A name with a number that neither a part nor another shape of the file has.
    fn free(&self, name: &str) -> String {
        let mut numbered = (2..).map(|count| format!("{name} {count}"));
        let taken = |name: &String| self.places.contains_key(name) || self.named.contains(name);
        numbered.find(|name| !taken(name)).unwrap_or_default()
    }

    fn told(&mut self, name: String, change: Change) {
        self.merged.taken.push(Taken { name, change });
    }
}

/// The places of the parts that shapes name. A name counts as it stands. Some files have no blanks at the ends of names, or others: a part that no
/// shape names as it stands is found without them, if that is clear.
fn places(parts: &[Part], shapes: &[Shape]) -> BTreeMap<String, usize> {
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for (place, part) in parts.iter().enumerate() {
        places.entry(part.name.clone()).or_insert(place);
    }
    let named: BTreeSet<&str> = shapes.iter().map(|shape| shape.name.as_str()).collect();
    let mut plain: BTreeMap<&str, (Vec<usize>, Vec<&str>)> = BTreeMap::new();
    let open = parts.iter().enumerate().filter(|(_, part)| !named.contains(part.name.as_str()));
    open.for_each(|(place, part)| plain.entry(part.name.trim()).or_default().0.push(place));
    let unknown: Vec<&str> = named.iter().copied().filter(|name| !places.contains_key(*name)).collect();
    unknown.into_iter().for_each(|name| plain.entry(name.trim()).or_default().1.push(name));
    for (own, names) in plain.into_values() {
        if let ([place], [name]) = (&own[..], &names[..]) {
            places.insert((*name).to_owned(), *place);
        }
    }
    places
}

/// The frames with contours of a part of which the file does not speak.
fn unspoken(part: &Part, shape: &Shape) -> Vec<FrameNumber> {
    let still = is_still(part);
    let frames: BTreeSet<FrameNumber> = part.keys.keys().chain(part.tracks.keys()).copied().collect();
    frames.into_iter().filter(|&frame| !shape.extent.speaks_of(frame, still)).collect()
}

/// Whether a part has the same contour on all frames.
fn is_still(part: &Part) -> bool {
    let mut contours = part.keys.values().chain(part.tracks.values());
    contours.next().is_none_or(|first| contours.all(|other| is_same(first, other)))
}

/// A part that is as the file shows it.
fn part_of(shape: Shape, room: &mut Room) -> Result<Part, ImportError> {
    let mut part = Part { closed: shape.closed, tracks: shown(&shape, room)?, ..Part::default() };
    part.falloff = shape.falloff.unwrap_or_default();
    (part.name, part.keys, part.absent) = (shape.name, shape.keys, shape.absent);
    part.forget_where_absent();
    Ok(part)
}

/// The contours on all frames on which the file shows a shape.
fn shown(shape: &Shape, room: &mut Room) -> Result<BTreeMap<FrameNumber, Vec<Point>>, ImportError> {
    let frames: Vec<FrameNumber> = match (shape.keys.first_key_value(), shape.keys.last_key_value()) {
        (Some((first, _)), Some((last, _))) if first < last => (*first..=*last).collect(),
        _ => Some(shape.extent.shown()).filter(|shown| shown.len() > 1).unwrap_or_default(),
    };
    room.take(frames.len(), shape.keys.values().next().map_or(0, Vec::len))?;
    Ok(frames.into_iter().map(|frame| (frame, form(&shape.keys, frame))).collect())
}

/// Brings a part up to date with the shape of its name.
fn update(
    part: &mut Part,
    shape: Shape,
    footage: &Footage,
    (room, chosen): (&mut Room, &mut Option<f64>),
) -> Result<Change, ImportError> {
    let same_border = |part: &mut Part| merge_falloff(&mut part.falloff, shape.falloff);
    if let Some(compared) = compared_with(part, &shape, footage, chosen) {
        let frames = merge(part, &shape, footage, &*compared, room)?;
        let same = same_border(part) && frames.is_empty();
        return Ok(if same { Change::Nothing } else { Change::Frames(frames) });
    }
    let (name, depth, colour) = (std::mem::take(&mut part.name), part.depth, part.colour);
    *part = Part { name, depth, colour, ..part_of(shape, room)? };
    Ok(Change::Replaced)
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
    let still = is_still(part);
    let spoken = |frame: &FrameNumber| shape.extent.speaks_of(*frame, still);
    let own = || part.keys.iter().filter(|(frame, _)| spoken(frame));
    let exact = || own().next().is_some() && own().all(|(at, key)| is_same(key, &form(&shape.keys, *at)));
    part.closed == shape.closed
        && contours.peek().is_some()
        && contours.all(|points| points.len() == count)
        // Few points may be those of the curve by chance.
        && (!curved || exact())
}

/// How a part is compared with the shape of its name; `None` if the shape is another one. That is not so if the part has frames of which the file does not
/// speak, or if both are the same somewhere. `chosen` is as for [`Written::of`].
fn compared_with(part: &Part, shape: &Shape, footage: &Footage, chosen: &mut Option<f64>) -> Option<Box<dyn Compared>> {
    if is_comparable(part, shape) {
        return Some(Box::new(Points));
    }
    if part.closed != shape.closed || !outline::has_joints(part) {
        return None;
    }
    let still = is_still(part);
    let spoken = |frame: &FrameNumber| shape.extent.speaks_of(*frame, still);
    let same =
        |frame: FrameNumber| of_file(shape, frame).is_some_and(|file| outline::Outline.is_same(part, frame, &file));
    let known: Vec<FrameNumber> = (footage.first..=footage.last).filter(spoken).collect();
    let found = known.iter().filter(|&&frame| same(frame)).count();
    let written = (found < known.len()).then(|| Written::of(part, shape, spoken, chosen)).flatten();
    if let Some(written) = written {
        return Some(Box::new(written));
    }
    (found > 0 || !unspoken(part, shape).is_empty()).then(|| Box::new(outline::Outline) as Box<dyn Compared>)
}

/// What the file shows on a frame; `None` where it hides the shape.
fn of_file(shape: &Shape, frame: FrameNumber) -> Option<Vec<Point>> {
    let shown = shape.keys.contains_key(&frame) || !shape.extent.hides(frame);
    shown.then(|| form(&shape.keys, frame))
}

/// Changes a part where the file shows another contour, or another presence. Returns the frames.
fn merge(
    part: &mut Part,
    shape: &Shape,
    footage: &Footage,
    compared: &dyn Compared,
    room: &mut Room,
) -> Result<Vec<FrameNumber>, ImportError> {
    let known = part.keys.keys().chain(part.tracks.keys()).chain(shape.keys.keys());
    let hidden = (footage.first..=footage.last).filter(|&frame| part.is_absent(frame));
    let unseen = (footage.first..=footage.last).filter(|&frame| shape.extent.hides(frame));
    // A gap of a tracked part may have been filled.
    let gaps = (footage.first..=footage.last)
        .filter(|frame| !part.tracks.is_empty() && shape.extent.has_between_keys(*frame) && !part.is_absent(*frame));
    let mut frames: BTreeSet<FrameNumber> = known.copied().chain(hidden).chain(unseen).chain(gaps).collect();
    let still = is_still(part);
    frames.retain(|&frame| shape.extent.speaks_of(frame, still));
    let mut changed = Vec::new();
    // All are compared with the part as it is before the import.
    let own = part.clone();
    for frame in frames {
        let has = own.points_at(frame).is_some();
        // Beyond its keys a file says nothing of frames that the part does not have.
        let file = of_file(shape, frame).filter(|_| has || shape.extent.has_between_keys(frame));
        let is_other = match &file {
            Some(file) if has => !compared.is_same(&own, frame, file),
            Some(file) => !(is_undecided(&own, frame) && is_same(&form(&own.keys, frame), file)),
            None => has || is_undecided(&own, frame),
        };
        if is_other {
            room.take(1, file.as_ref().map_or(0, Vec::len))?;
            let file = file.map(|file| compared.taken(&own, frame, file));
            set(part, frame, file, shape.keys.contains_key(&frame));
            changed.push(frame);
        }
    }
    Ok(changed)
}

/// Whether a part that is not tracked yet will be there on a frame: it lies between keys, and nobody has hidden it. Other programs show it on its
/// way there.
fn is_undecided(part: &Part, frame: FrameNumber) -> bool {
    let between = part.keys.range(..frame).next().is_some() && part.keys.range(frame..).next().is_some();
    part.tracks.is_empty() && between && !part.is_absent(frame)
}

/// Sets the contour of a part on a frame, or hides the part there. The paths between its control points are those that are given, or none.
fn set(part: &mut Part, frame: FrameNumber, contour: Option<(Vec<Point>, Vec<Vec<Point>>)>, is_key: bool) {
    let was_key = part.keys.remove(&frame).is_some();
    part.pins.remove(&frame);
    part.centers.remove(&frame);
    part.confidence.remove(&frame);
    part.curves.remove(&frame);
    let is_tracked = !part.tracks.is_empty();
    part.tracks.remove(&frame);
    let Some((points, paths)) = contour else {
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
    if !paths.is_empty() {
        part.curves.insert(frame, paths);
    }
}

#[cfg(test)]
mod tests;
