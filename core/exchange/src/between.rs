//! The way of a contour from key to key, as other programs go it.

use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;

/// Contours by frame.
pub(crate) type Keys = BTreeMap<FrameNumber, Vec<Point>>;

/// The form on a frame: linear between keys, held outside.
pub(crate) fn form(keys: &Keys, frame: FrameNumber) -> Vec<Point> {
    match (keys.range(..=frame).next_back(), keys.range(frame..).next()) {
        (Some((from, a)), Some((to, b))) if from < to => {
            let share = (f64::from(frame) - f64::from(*from)) / (f64::from(*to) - f64::from(*from));
            a.iter().zip(b).map(|(a, b)| a.lerp(*b, share)).collect()
        }
        (Some((_, own)), _) | (None, Some((_, own))) => own.clone(),
        (None, None) => Vec::new(),
    }
}
