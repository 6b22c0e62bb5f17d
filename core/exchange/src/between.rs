//! The way of a contour from key to key, as other programs go it.

use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;

/// Contours by frame.
pub(crate) type Keys = BTreeMap<FrameNumber, Vec<Point>>;

/// A contour with its frame, as a map gives it.
pub(crate) type Key<'a> = (&'a FrameNumber, &'a Vec<Point>);

/// The form on a frame: linear between keys, held outside.
pub(crate) fn form(keys: &Keys, frame: FrameNumber) -> Vec<Point> {
    match (keys.range(..=frame).next_back(), keys.range(frame..).next()) {
        (Some(before), Some(after)) if before.0 < after.0 => on_way(before, after, frame),
        (Some((_, own)), _) | (None, Some((_, own))) => own.clone(),
        (None, None) => Vec::new(),
    }
}

/// The form on a frame that lies between two keys.
pub(crate) fn on_way((from, a): Key, (to, b): Key, frame: FrameNumber) -> Vec<Point> {
    let share = (f64::from(frame) - f64::from(*from)) / (f64::from(*to) - f64::from(*from));
    a.iter().zip(b).map(|(a, b)| a.lerp(*b, share)).collect()
}
