//! Moves points, makes and deletes keys.
//!
//! A part that is drawn or moved on a key frame changes its key. On a tracked frame a moved point becomes a pin, and a part
//! that is moved as a whole becomes a corrected centre, as in Blender. Where neither has an effect, the part gets a key. The
//! track shows the change at once; the next **Track** follows it.

use super::{Place, Refused};
use rototoon::geometry::Point;
use rototoon::project::{Document, validate};
use rototoon::render::motion::outline_at;
use rototoon::scene::limbs::{Follow, Limb};
use rototoon::scene::{FrameError, FrameNumber, Part};
use std::collections::{BTreeMap, BTreeSet};

/// Differences of at most this many pixels are no movement. It is half of what documents round to.
const STILL: f64 = 5e-5;

/// The mean of points.
pub fn middle(points: &[Point]) -> Point {
    points.iter().sum::<Point>() / points.len().max(1) as f64
}

/// Moves points on a frame to new places. `as_part` are the parts that were moved as a whole. Returns whether anything
/// moved.
pub fn move_points(
    document: &mut Document,
    frame: FrameNumber,
    moved: &BTreeMap<Place, Point>,
    as_part: &BTreeSet<usize>,
) -> Result<bool, Refused> {
    let parts: BTreeSet<usize> = moved.keys().map(|place| place.part).collect();
    let mut any = false;
    for index in parts {
        let part = document.scene.parts.get_mut(index).ok_or_else(|| Refused::new("the part is gone"))?;
        let before = part.points_at(frame).cloned();
        let Some(before) = before else {
            let name = &part.name;
            return Err(Refused::new(format!("{name:?} has no shape on frame {frame}: press New key here first")));
        };
        let mut after = before.clone();
        for (place, to) in moved.iter().filter(|(place, _)| place.part == index) {
            if let Some(point) = after.get_mut(place.point) {
                *point = *to;
            }
        }
        let changed: Vec<usize> = (0..after.len()).filter(|&k| after[k].distance(before[k]) > STILL).collect();
        if !changed.is_empty() {
            place(part, frame, &before, &after, &changed, as_part.contains(&index));
            any = true;
        }
    }
    Ok(any)
}

/// Puts a part's points on a frame at new places.
fn place(part: &mut Part, frame: FrameNumber, before: &[Point], after: &[Point], changed: &[usize], whole: bool) {
    if part.keys.contains_key(&frame) || !validate::acts(part, frame) {
        make_key(part, frame, after.to_vec());
        return;
    }
    if whole {
        part.centers.insert(frame, middle(after));
        // Pins of the frame go with the part.
        if let Some(pins) = part.pins.get_mut(&frame) {
            for (index, pin) in pins {
                if let (Some(from), Some(to)) = (before.get(*index), after.get(*index)) {
                    *pin += *to - *from;
                }
            }
        }
    } else {
        let pins = part.pins.entry(frame).or_default();
        pins.extend(changed.iter().map(|&index| (index, after[index])));
        // A centre would contradict the points.
        if part.centers.contains_key(&frame) {
            part.centers.insert(frame, middle(after));
        }
    }
    show(part, frame, after.to_vec());
}

/// Shows a shape on a tracked frame. The snapped paths belong to the old shape.
fn show(part: &mut Part, frame: FrameNumber, points: Vec<Point>) {
    if let Some(track) = part.tracks.get_mut(&frame) {
        *track = points;
    }
    part.curves.remove(&frame);
}

/// Makes a shape the key of a frame. Corrections of the frame are in the shape and have no effect beside it.
pub fn make_key(part: &mut Part, frame: FrameNumber, points: Vec<Point>) {
    let same = part.points_at(frame).is_some_and(|shown| *shown == points);
    if let Some(track) = part.tracks.get_mut(&frame) {
        track.clone_from(&points);
    }
    if !same {
        part.curves.remove(&frame);
    }
    part.pins.remove(&frame);
    part.centers.remove(&frame);
    part.wants_key.retain(|wanted| *wanted != frame);
    part.keys.insert(frame, points);
}

/// Makes the shapes of parts on a frame their keys there: the tracked shape, or else the nearest key. Parts without a key
/// are left out. Returns whether a part got a key.
pub fn new_key(document: &mut Document, frame: FrameNumber, parts: &[usize]) -> Result<bool, Refused> {
    inside_footage(document, frame)?;
    let mut any = false;
    for &index in parts {
        let Some(part) = document.scene.parts.get_mut(index) else { continue };
        if part.keys.contains_key(&frame) {
            continue;
        }
        let nearest = part.keys.iter().min_by_key(|(key, _)| (i64::from(**key) - i64::from(frame)).abs());
        let tracked = outline_at(part, f64::from(frame), false).filter(|points| points.len() == part.point_count());
        if let Some(points) = tracked.or_else(|| nearest.map(|(_, points)| points.clone())) {
            make_key(part, frame, points);
            any = true;
        }
    }
    Ok(any)
}

/// Deletes the keys of parts on a frame. Their tracks stay until the next **Track**.
pub fn delete_key(document: &mut Document, frame: FrameNumber, parts: &[usize]) -> Result<bool, Refused> {
    let mut any = false;
    for &index in parts {
        let Some(part) = document.scene.parts.get_mut(index) else { continue };
        if part.keys.len() == 1 && part.keys.contains_key(&frame) {
            let name = &part.name;
            return Err(Refused::new(format!("frame {frame} has the only key of {name:?}: use Delete part instead")));
        }
        any |= part.keys.remove(&frame).is_some();
    }
    Ok(any)
}

/// Deletes a part with everything that belongs to it.
pub fn delete_part(document: &mut Document, part: usize) -> Result<(), Refused> {
    let name = document.scene.parts.get(part).map(|part| part.name.clone());
    let name = name.ok_or_else(|| Refused::new("the part is gone"))?;
    if has_limbs(document, &name)? {
        return Err(Refused::new(format!("limbs of the project are bound to {name:?}: delete them in Blender first")));
    }
    document.scene.parts.remove(part);
    Ok(())
}

/// Whether limbs of the project name a part.
pub fn has_limbs(document: &Document, name: &str) -> Result<bool, Refused> {
    let limbs = document.limbs().map_err(|error| Refused::new(error.to_string()))?;
    let bound = |limb: &Limb| {
        limb.carries.iter().any(|carried| carried.part == name)
            || [&limb.start, &limb.end].iter().any(|end| end.points.iter().any(|point| point.part == name))
    };
    let follows = limbs.marks.iter().any(|mark| mark.front == name || mark.behind == name)
        || limbs.follows.iter().any(|(part, what)| *part == name || *what == Follow::Part(name.to_owned()));
    Ok(limbs.limbs.iter().any(bound) || follows)
}

/// Moves points on a frame halfway towards the middle of their neighbours. Ends of open contours stay.
pub fn smoothed(part: &Part, frame: FrameNumber, points: &BTreeSet<usize>) -> BTreeMap<usize, Point> {
    let Some(shape) = part.points_at(frame) else { return BTreeMap::new() };
    let count = shape.len();
    let neighbours = |k: usize| {
        if part.closed && count > 2 {
            Some((shape[(k + count - 1) % count], shape[(k + 1) % count]))
        } else if k > 0 && k + 1 < count {
            Some((shape[k - 1], shape[k + 1]))
        } else {
            None
        }
    };
    let moved = |&k: &usize| {
        let (before, after) = neighbours(k)?;
        Some((k, shape[k].lerp((before + after) * 0.5, 0.5)))
    };
    points.iter().filter(|k| **k < count).filter_map(moved).collect()
}

/// Whether the footage has a frame.
pub fn inside_footage(document: &Document, frame: FrameNumber) -> Result<(), Refused> {
    let footage = &document.scene.footage;
    if (footage.first..=footage.last).contains(&frame) {
        return Ok(());
    }
    let outside = FrameError::Outside { frame, first: footage.first, last: footage.last };
    Err(Refused::new(format!("{outside}: see Frame offset")))
}
