//! A tracker that remembers earlier runs finds what a new one finds.

use super::scene::{Drawn, limb_and_ball, track};
use crate::{TrackOptions, Tracker};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Scene, Silent};

/// Pins a point of a part this far from where it is drawn.
fn pin(scene: &mut Scene, drawn: &Drawn, (part, frame, point): (usize, FrameNumber, usize), shift: Point) {
    let place = drawn.0[part].contour(frame)[point] + shift;
    scene.parts[part].pins.entry(frame).or_default().insert(point, place);
}

#[test]
fn corrections_of_held_frames_change_what_a_new_tracker_would_change() {
    let drawn = limb_and_ball();
    let mut scene = drawn.scene(vec![drawn.0[0].part("limb", 0.0), drawn.0[1].part("ball", 1.0)]);
    let mut tracker = Tracker::new(TrackOptions::default());
    let first = tracker.track(&scene, &drawn, &Silent).unwrap();
    let mut check = |scene: &Scene, what: &str| {
        let again = tracker.track(scene, &drawn, &Silent).unwrap();
        assert!(again.parts == track(&drawn, scene).parts, "{what}");
        again
    };
    // Frame 1 shows the drawing of the key on frame 0: its correction makes it a drawing of its own.
    pin(&mut scene, &drawn, (0, 1, 2), Point::new(4.0, -3.0));
    let held = check(&scene, "a pin on a frame held from the key");
    assert!(held.parts[0].tracks[&1] != first.parts[0].tracks[&1], "the pin does nothing");
    pin(&mut scene, &drawn, (1, 3, 0), Point::new(2.0, 2.0));
    check(&scene, "a pin on a held frame of another part");
    pin(&mut scene, &drawn, (0, 1, 2), Point::new(-4.0, 3.0));
    check(&scene, "the first pin elsewhere");
    scene.parts[0].pins.clear();
    check(&scene, "the first pin taken away");
    scene.parts[1].pins.clear();
    assert!(check(&scene, "no pin").parts == first.parts, "pins that were taken away left something");
}
