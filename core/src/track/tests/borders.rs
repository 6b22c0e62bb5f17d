//! Parts that enter and leave the picture, between two keys.

use super::scene::{Drawn, LAST, Shape, WIDTH, limb_and_ball, track};
use crate::geometry::Point;
use crate::scene::FrameNumber;

/// Distances of the points of the nearest part from the truth on a frame: of those in the picture, and of the others.
fn errors(drawn: &Drawn, frame: FrameNumber, found: &[Point]) -> [Vec<f64>; 2] {
    let truth = drawn.0[drawn.0.len() - 1].contour(frame);
    let mut errors = [Vec::new(), Vec::new()];
    for (p, q) in found.iter().zip(&truth) {
        let inside = q.x >= 0.0 && q.y >= 0.0 && q.x < WIDTH as f64;
        errors[usize::from(!inside)].push(p.distance(*q));
    }
    errors
}

/// Tracks the nearest shape of a scene, keyed at both ends, and holds every point to what may be missed inside and
/// outside the picture.
fn holds(drawn: &Drawn, inside: f64, outside: f64) {
    let nearest = drawn.0.len() - 1;
    let tracking = track(drawn, &drawn.scene(vec![drawn.0[nearest].part("part", 1.0)]));
    for frame in 1..LAST {
        let [seen, unseen] = errors(drawn, frame, &tracking.parts[0].tracks[&frame]);
        assert!(seen.iter().all(|&e| e < inside), "frame {frame}, inside: {seen:?}");
        assert!(unseen.iter().all(|&e| e < outside), "frame {frame}, outside: {unseen:?}");
    }
}

fn with(motion: fn(f64) -> (Point, f64)) -> Drawn {
    let ball = limb_and_ball().0.swap_remove(1);
    Drawn(vec![Shape { motion, ..ball }])
}

#[test]
fn a_part_that_walks_in_from_a_key_outside_is_followed() {
    holds(&with(|t| (Point::new(-22.0 + 22.0 * t, 90.0 + 2.0 * t), 5.0 * t)), 2.5, 8.0);
}

#[test]
fn a_part_that_goes_out_between_its_keys_comes_back() {
    // Half of it is outside on the second drawing, all of it on the third.
    holds(
        &with(|t| (Point::new(50.0 - 60.0 * (0.5 * t).sin() * if t > 3.0 { 1.45 } else { 1.0 }, 100.0), 0.0)),
        8.0,
        30.0,
    );
}

#[test]
fn a_part_that_is_cut_by_the_border_all_the_time_keeps_its_shape() {
    holds(&with(|t| (Point::new(40.0 + 20.0 * t, 1.0), 0.0)), 2.0, 4.0);
}
