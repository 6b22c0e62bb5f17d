//! Inserts and deletes points of a part, on all of its keys and frames.
//!
//! The number of points is the same on every frame, so a new point lies at the same share of its segment everywhere. Pins
//! and limbs of the project stay at their places of the contour. Snapped paths belong to segments that no longer exist and
//! are dropped; snapping makes new ones.

use super::Refused;
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::Part;
use rototoon::scene::limbs::Binding;
use std::collections::{BTreeMap, BTreeSet};

/// Least numbers of points of closed and open contours.
const LEAST: [usize; 2] = [3, 2];

/// Inserts points into segments of a part: each at a share of the way from the segment's first to its second point.
/// Segments are counted before the insertion. Returns the indices of the new points.
pub fn insert(document: &mut Document, index: usize, places: &BTreeMap<usize, f64>) -> Result<Vec<usize>, Refused> {
    let part = document.scene.parts.get_mut(index).ok_or_else(|| Refused::new("the part is gone"))?;
    let segments = part.segment_count();
    let places: BTreeMap<usize, f64> = places
        .iter()
        .filter(|(segment, _)| **segment < segments)
        .map(|(k, share)| (*k, share.clamp(0.0, 1.0)))
        .collect();
    let count = part.point_count();
    each_shape(part, |points| inserted(points, &places, |a, b, share| a.lerp(b, share)));
    for values in part.confidence.values_mut().filter(|values| values.len() == count) {
        // A point between two is as sure as the less sure one.
        inserted(values, &places, |a, b, _| a.min(b));
    }
    if part.feather.len() == count {
        inserted(&mut part.feather, &places, |a, b, share| a + share * (b - a));
    }
    let moved = |k: usize| k + places.range(..k).count();
    for pins in part.pins.values_mut() {
        *pins = std::mem::take(pins).into_iter().map(|(k, p)| (moved(k), p)).collect();
    }
    part.curves.clear();
    let name = part.name.clone();
    rebind(document, &name, &|at: f64| {
        let segment = at.floor().max(0.0) as usize;
        let base = moved(segment) as f64;
        match places.get(&segment) {
            Some(&share) if at.fract() > share => base + 1.0 + (at.fract() - share) / (1.0 - share),
            Some(&share) if share > 0.0 => base + at.fract() / share,
            _ => base + at.fract(),
        }
    })?;
    Ok(places.keys().map(|&segment| moved(segment) + 1).collect())
}

/// Inserts a value into each of these segments. `between` makes it of the values at the segment's ends and of its share of
/// the way.
fn inserted<T: Copy>(values: &mut Vec<T>, places: &BTreeMap<usize, f64>, between: impl Fn(T, T, f64) -> T) {
    let mut all = Vec::with_capacity(values.len() + places.len());
    for (k, &value) in values.iter().enumerate() {
        all.push(value);
        if let Some(&share) = places.get(&k) {
            all.push(between(value, values[(k + 1) % values.len()], share));
        }
    }
    *values = all;
}

/// Deletes points of a part.
pub fn delete(document: &mut Document, index: usize, gone: &BTreeSet<usize>) -> Result<(), Refused> {
    let part = document.scene.parts.get_mut(index).ok_or_else(|| Refused::new("the part is gone"))?;
    let count = part.point_count();
    let gone: BTreeSet<usize> = gone.iter().copied().filter(|k| *k < count).collect();
    let (left, least) = (count - gone.len(), LEAST[usize::from(!part.closed)]);
    if left < least {
        let (name, points) = (&part.name, if left == 1 { "point" } else { "points" });
        return Err(Refused::new(format!(
            "{name:?} would keep {left} {points}, expected at least {least}: use Delete part instead"
        )));
    }
    each_shape(part, |points| retain(points, &gone));
    for values in part.confidence.values_mut().filter(|values| values.len() == count) {
        retain(values, &gone);
    }
    if part.feather.len() == count {
        retain(&mut part.feather, &gone);
    }
    let moved = |k: usize| k - gone.range(..k).count();
    for pins in part.pins.values_mut() {
        *pins =
            std::mem::take(pins).into_iter().filter(|(k, _)| !gone.contains(k)).map(|(k, p)| (moved(k), p)).collect();
    }
    part.pins.retain(|_, pins| !pins.is_empty());
    part.curves.clear();
    let (name, closed) = (part.name.clone(), part.closed);
    let kept: Vec<usize> = (0..count).filter(|k| !gone.contains(k)).collect();
    rebind(document, &name, &|at: f64| after_deletion(at, &kept, count, closed))
}

/// The parameter of a place on a contour after points were deleted: between the remaining points around it.
fn after_deletion(at: f64, kept: &[usize], count: usize, closed: bool) -> f64 {
    let after = kept.partition_point(|&k| k as f64 <= at);
    let last = kept.len() - 1;
    let (first, span, index) = match (after, closed) {
        // Before the first remaining point: on the segment that closes the contour.
        (0, true) => (kept[last] as f64 - count as f64, (kept[0] + count - kept[last]) as f64, last as f64),
        (0, false) => return 0.0,
        (k, true) if k > last => (kept[last] as f64, (kept[0] + count - kept[last]) as f64, last as f64),
        (k, false) if k > last => return last as f64,
        (k, _) => (kept[k - 1] as f64, (kept[k] - kept[k - 1]) as f64, (k - 1) as f64),
    };
    let place = index + (at - first) / span;
    if closed && place >= kept.len() as f64 { place - kept.len() as f64 } else { place }
}

fn retain<T: Copy>(values: &mut Vec<T>, gone: &BTreeSet<usize>) {
    let mut index = 0;
    values.retain(|_| {
        index += 1;
        !gone.contains(&(index - 1))
    });
}

/// Changes the shapes of all keys and tracks that have the part's number of points.
fn each_shape(part: &mut Part, mut change: impl FnMut(&mut Vec<Point>)) {
    let count = part.point_count();
    let shapes = part.keys.values_mut().chain(part.tracks.values_mut());
    shapes.filter(|points| points.len() == count && count > 0).for_each(&mut change);
}

/// Moves the limbs' places on a part's contour.
fn rebind(document: &mut Document, name: &str, moved: &dyn Fn(f64) -> f64) -> Result<(), Refused> {
    let mut limbs = document.limbs().map_err(|error| Refused::new(error.to_string()))?;
    let mut any = false;
    for limb in &mut limbs.limbs {
        for point in limb.start.points.iter_mut().chain(&mut limb.end.points).filter(|point| point.part == name) {
            if let Binding::Place(at) = &mut point.binding {
                *at = moved(*at);
                any = true;
            }
        }
    }
    if any {
        document.set_limbs(&limbs);
    }
    Ok(())
}
