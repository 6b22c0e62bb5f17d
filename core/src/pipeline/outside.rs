//! Contours on frames outside of the footage. Every picture and every file of shapes ends with the footage, so they are in none.
//!
//! Another program may write such a document: its drawing moves on over a single picture.

use super::report::runs;
use super::untracked::named;
use crate::scene::{FrameNumber, Part, Scene};
use std::collections::BTreeSet;

/// The contours outside of the footage, as a message for the user. `None` if there are none.
pub fn outside(scene: &Scene) -> Option<String> {
    let footage = &scene.footage;
    let beyond = |part: &Part| -> Vec<FrameNumber> {
        let frames = part.tracks.keys().filter(|frame| !part.is_absent(**frame));
        frames.filter(|frame| !(footage.first..=footage.last).contains(*frame)).copied().collect()
    };
    let parts: Vec<(&Part, Vec<FrameNumber>)> = scene.parts.iter().map(|part| (part, beyond(part))).collect();
    let listed = named(parts.iter().filter(|(_, frames)| !frames.is_empty()).map(|(part, _)| *part))?;
    let frames: BTreeSet<FrameNumber> = parts.into_iter().flat_map(|(_, frames)| frames).collect();
    let frames = runs(&frames.into_iter().collect::<Vec<_>>());
    let (first, last) = (footage.first, footage.last);
    Some(format!(
        "contours on frames {frames} are outside of the footage, frames {first} to {last}, so no picture and no shape has them: {listed}; \
         widen footage.first and footage.last"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::Footage;

    #[test]
    fn contours_outside_of_the_footage_are_named_with_their_frames() {
        let footage =
            Footage { pattern: "%d.png".into(), first: 1, last: 2, fps: 12.0, width: 64, height: 48, held: false };
        let part = |name: &str, frames: std::ops::RangeInclusive<FrameNumber>| Part {
            name: name.into(),
            tracks: frames.map(|frame| (frame, vec![Point::ZERO])).collect(),
            ..Part::default()
        };
        let mut scene = Scene { footage, parts: vec![part("arm", 1..=2), part("leg", 2..=2)] };
        assert_eq!(outside(&scene), None);
        scene.parts[1] = part("leg", 0..=5);
        scene.parts[1].absent = vec![[4, 4]];
        let said = outside(&scene).unwrap();
        assert!(said.starts_with("contours on frames 0, 3, 5 are outside of the footage, frames 1 to 2"), "{said}");
        assert!(said.contains(": \"leg\"; widen"), "{said}");
    }
}
