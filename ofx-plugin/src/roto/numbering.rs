//! Frames of the project and frames of the composition.
//!
//! A document keeps the project's frames. Files for other programs have the composition's frames, since the other program shows
//! the same shot with the same numbers.

use rototoon::scene::{FrameNumber, Scene};
use std::collections::BTreeMap;

/// Adds a number to all frames of a scene. Frames beyond the greatest number are left out.
pub fn shift(scene: &mut Scene, by: FrameNumber) {
    if by == 0 {
        return;
    }
    let footage = &mut scene.footage;
    (footage.first, footage.last) = (footage.first.saturating_add(by), footage.last.saturating_add(by));
    for part in &mut scene.parts {
        moved(&mut part.keys, by);
        moved(&mut part.pins, by);
        moved(&mut part.centers, by);
        moved(&mut part.tracks, by);
        moved(&mut part.confidence, by);
        moved(&mut part.curves, by);
        moved(&mut part.depths, by);
        part.wants_key = part.wants_key.iter().filter_map(|frame| frame.checked_add(by)).collect();
        for frames in &mut part.absent {
            *frames = frames.map(|frame| frame.saturating_add(by));
        }
    }
}

fn moved<T>(frames: &mut BTreeMap<FrameNumber, T>, by: FrameNumber) {
    let old = std::mem::take(frames);
    *frames = old.into_iter().filter_map(|(frame, value)| Some((frame.checked_add(by)?, value))).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
    use rototoon::scene::{Footage, Part};

    #[test]
    fn all_frames_are_shifted_and_back() {
        let at = |x: f64| vec![Point::new(x, 0.0)];
        let part = Part {
            keys: BTreeMap::from([(0, at(0.0)), (4, at(4.0))]),
            pins: BTreeMap::from([(2, BTreeMap::from([(0, Point::ONE)]))]),
            centers: BTreeMap::from([(3, Point::ONE)]),
            tracks: BTreeMap::from([(0, at(0.0)), (1, at(1.0))]),
            confidence: BTreeMap::from([(1, vec![0.5])]),
            curves: BTreeMap::from([(1, vec![at(1.0)])]),
            wants_key: vec![5],
            depths: BTreeMap::from([(1, 2.0)]),
            absent: vec![[2, 3]],
            ..Part::default()
        };
        let footage = Footage { pattern: "%d".into(), first: 0, last: 9, fps: 25.0, width: 8, height: 8 };
        let scene = Scene { footage, parts: vec![part] };
        let mut there = scene.clone();
        shift(&mut there, 100);
        let part = &there.parts[0];
        assert_eq!((there.footage.first, there.footage.last), (100, 109));
        assert!(part.keys.keys().eq(&[100, 104]) && part.tracks.keys().eq(&[100, 101]));
        assert!(part.pins.contains_key(&102) && part.centers.contains_key(&103));
        assert!(part.confidence.contains_key(&101) && part.curves.contains_key(&101) && part.depths.contains_key(&101));
        assert_eq!((&part.wants_key[..], &part.absent[..]), (&[105][..], &[[102, 103]][..]));
        shift(&mut there, -100);
        assert_eq!(there, scene);
    }
}
