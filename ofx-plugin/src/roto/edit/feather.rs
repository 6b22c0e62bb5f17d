//! Gives control points a feather: the width over which the border fades there, on each side of the contour.

use super::{Lens, Place, Refused};
use rototoon::geometry::Point;
use rototoon::project::Document;
use std::collections::{BTreeMap, BTreeSet};

/// Largest width in pixels: that of the parameter.
const MOST: f64 = 500.0;
/// A drag back to within this many screen pixels of its point makes the border sharp.
const SHARP: f64 = 4.0;

/// The width that a drag from a control point to the pen gives, in pixels of the footage, in steps of a tenth.
pub fn dragged(from: Point, to: Point, lens: &Lens) -> f64 {
    let width = if lens.distance(from, to) <= SHARP { 0.0 } else { from.distance(to) };
    (10.0 * width.min(MOST)).round() / 10.0
}

/// Widths of a part after some of its points got another one. Empty if all are 0.
pub fn changed(widths: &[f64], count: usize, points: &BTreeSet<usize>, width: f64) -> Vec<f64> {
    let mut widths = if widths.len() == count { widths.to_vec() } else { vec![0.0; count] };
    points.iter().filter(|point| **point < count).for_each(|&point| widths[point] = width);
    if widths.iter().all(|width| *width == 0.0) { Vec::new() } else { widths }
}

/// Gives points a width, in pixels of the footage. Returns whether anything changed.
pub fn set(document: &mut Document, places: &[Place], width: f64) -> Result<bool, Refused> {
    let width = if width.is_finite() { width.clamp(0.0, MOST) } else { 0.0 };
    let mut points: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for place in places {
        points.entry(place.part).or_default().insert(place.point);
    }
    let mut any = false;
    for (index, points) in points {
        let part = document.scene.parts.get_mut(index).ok_or_else(|| Refused::new("the part is gone"))?;
        if !part.closed {
            let name = &part.name;
            return Err(Refused::new(format!("{name:?} is open: only a closed part has a border with a feather")));
        }
        let widths = changed(&part.feather, part.point_count(), &points, width);
        any |= widths != part.feather;
        part.feather = widths;
    }
    Ok(any)
}
