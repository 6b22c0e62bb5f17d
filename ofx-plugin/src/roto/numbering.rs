//! Frames of the project and frames of the composition.
//!
//! A document keeps the project's frames. Files for other programs have the composition's frames, since the other program shows
//! the same shot with the same numbers.

use rototoon::scene::{FrameNumber, Scene};

/// Adds a number to all frames of a scene. Frames beyond the greatest number are left out.
pub fn shift(scene: &mut Scene, by: FrameNumber) {
    if by == 0 {
        return;
    }
    let footage = &mut scene.footage;
    (footage.first, footage.last) = (footage.first.saturating_add(by), footage.last.saturating_add(by));
    scene.parts.iter_mut().for_each(|part| part.shift(by));
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::{Footage, Part};

    #[test]
    fn footage_and_parts_are_shifted_and_back() {
        let part = Part { keys: [(0, Vec::new()), (4, Vec::new())].into(), ..Part::default() };
        let footage = Footage { pattern: "%d".into(), first: 0, last: 9, fps: 25.0, width: 8, height: 8, held: false };
        let scene = Scene { footage, parts: vec![part] };
        let mut there = scene.clone();
        shift(&mut there, 100);
        assert_eq!((there.footage.first, there.footage.last), (100, 109));
        assert!(there.parts[0].keys.keys().eq(&[100, 104]));
        shift(&mut there, -100);
        assert_eq!(there, scene);
    }
}
