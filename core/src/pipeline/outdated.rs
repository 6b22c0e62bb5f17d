//! Parts with keys that were changed after tracking. Their tracks still show the old contours.

use super::untracked::named;
use crate::scene::Scene;

/// The parts whose tracks are out of date, as a message for the user. `None` if there are none.
///
/// Shapes and pictures are made of the tracks, which `rototoon track` alone brings up to date. Another program may have edited the keys.
pub fn outdated(scene: &Scene) -> Option<String> {
    let listed = named(scene.parts.iter().filter(|part| part.outdated().next().is_some()))?;
    Some(format!(
        "keys were changed after tracking, and the old contours are used: {listed}; run `rototoon track` first"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::{Footage, Part};

    #[test]
    fn parts_with_keys_that_differ_from_their_tracks_are_named() {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 12.0, width: 64, height: 48, held: false };
        let contour = vec![Point::ZERO, Point::X, Point::Y];
        let frames = [0, 1, 4];
        let part = |name: &str| Part {
            name: name.into(),
            closed: true,
            keys: frames.iter().map(|&frame| (frame, contour.clone())).collect(),
            tracks: (0..=4).map(|frame| (frame, contour.clone())).collect(),
            ..Part::default()
        };
        let mut scene = Scene { footage, parts: vec![part("arm"), part("leg"), part("head")] };
        assert_eq!(outdated(&scene), None);
        scene.parts[0].keys.insert(1, vec![Point::ZERO, Point::X, Point::Y * 1.02]);
        scene.parts[1].keys.insert(4, vec![Point::ZERO, Point::X]);
        // What a file rounds is no change.
        scene.parts[2].keys.insert(1, vec![Point::ZERO, Point::X, Point::Y * 1.005]);
        assert_eq!(scene.parts[0].outdated().collect::<Vec<_>>(), [1]);
        let said = outdated(&scene).unwrap();
        assert!(said.contains(r#"used: "arm", "leg"; run"#), "{said}");
    }
}
