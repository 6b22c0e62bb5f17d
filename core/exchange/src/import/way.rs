//! Shapes that do not go straight from key to key.
//!
//! Between two frames with keys the points of a contour go on straight lines. Where a shape turns in between, or is placed by several
//! numbers that change together, its points do not: then it needs a key on every frame. Whether it does is seen by comparing its path with
//! the straight way on some of the frames.

use super::path::Path;
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeSet;

/// Greatest distance from the straight way that is none, in pixels.
const STRAIGHT: f64 = 0.01;
/// Frames between two keys that are compared at most, beside the first one. Even steps alone could all be whole turns.
const ASKED: i64 = 64;

/// Adds to the frames of a shape those between two of them on which it does not go straight. `path` is the path on a frame; `None` where there
/// is none.
pub(super) fn add_bent(frames: &mut BTreeSet<FrameNumber>, path: impl Fn(FrameNumber) -> Option<Path>) {
    let keys: Vec<FrameNumber> = frames.iter().copied().collect();
    for pair in keys.windows(2).filter(|pair| i64::from(pair[1]) - i64::from(pair[0]) > 1) {
        if is_bent([pair[0], pair[1]], &path).unwrap_or(false) {
            frames.extend(pair[0] + 1..pair[1]);
        }
    }
}

/// Whether a path leaves the straight way between two frames with others between them.
fn is_bent([from, to]: [FrameNumber; 2], path: &impl Fn(FrameNumber) -> Option<Path>) -> Option<bool> {
    let (start, end) = (path(from)?, path(to)?);
    let length = i64::from(to) - i64::from(from);
    let even = (1..=ASKED).map(|k| k * (length - 1) / ASKED).filter(|step| *step > 1);
    let mut steps: Vec<i64> = std::iter::once(1).chain(even).collect();
    steps.dedup();
    Some(steps.into_iter().any(|step| {
        let Some(own) = path((i64::from(from) + step) as FrameNumber) else { return false };
        let mut straight = start.clone();
        straight.go(&end, step as f64 / length as f64);
        own.points().zip(straight.points()).any(|(a, b): (Point, Point)| a.distance(b) > STRAIGHT)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(keys: &[FrameNumber], x: impl Fn(FrameNumber) -> f64) -> Vec<FrameNumber> {
        let mut frames = keys.iter().copied().collect();
        add_bent(&mut frames, |frame| Some(Path::new(Point::new(x(frame), 2.0))));
        frames.into_iter().collect()
    }

    #[test]
    fn only_what_does_not_go_straight_gets_frames() {
        assert_eq!(found(&[1, 5, 9], |frame| 3.0 * f64::from(frame)), [1, 5, 9]);
        assert_eq!(found(&[1, 2, 6], |frame| f64::from(frame.max(2)).powi(2)), [1, 2, 3, 4, 5, 6]);
        assert_eq!(found(&[1, 5, 9], |frame| f64::from((frame - 5).max(0)).powi(2)), [1, 5, 6, 7, 8, 9]);
        // Whole turns, of which the ends and even steps see nothing.
        let turns = |frame: FrameNumber| (f64::from(frame) * std::f64::consts::TAU / 10.0).sin();
        assert_eq!(found(&[0, 641], |frame| if frame == 641 { 0.0 } else { turns(frame) }).len(), 642);
        assert_eq!(found(&[0, 1_000_000], f64::from).len(), 2);
    }
}
