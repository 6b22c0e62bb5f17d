//! Names parts that may have changed places.

use super::report::runs;
use crate::scene::Scene;
use crate::track::Tracking;

/// A line for each two parts that look alike and may have changed places.
pub fn exchanges(scene: &Scene, tracking: &Tracking) -> Vec<String> {
    let line = |exchange: &crate::track::Exchange| {
        let [a, b] = exchange.parts.map(|p| &scene.parts[p].name);
        let frames = runs(&exchange.frames);
        format!(
            "parts {a:?} and {b:?} look alike and may have changed places on {frames}: a key or a pin there says which is which"
        )
    };
    tracking.exchanges.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Footage, Part};
    use crate::track::Exchange;

    #[test]
    fn both_parts_and_their_frames_are_named() {
        let part = |name: &str| Part { name: name.into(), ..Part::default() };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 64, height: 48, held: false };
        let scene = Scene { footage, parts: vec![part("near leg"), part("head"), part("far leg")] };
        let exchanges = vec![Exchange { parts: [0, 2], frames: vec![2, 3, 4, 7] }];
        let found = super::exchanges(&scene, &Tracking { exchanges, ..Tracking::default() });
        let expected = "parts \"near leg\" and \"far leg\" look alike and may have changed places on 2-4, 7: a key or a pin there says which is which";
        assert_eq!(found, [expected]);
    }
}
