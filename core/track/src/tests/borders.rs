//! Parts that enter and leave the picture, between two keys.

use super::scene::{Drawn, LAST, Shape, WIDTH, limb_and_ball, track};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::FrameNumber;

/// Distances of the nearest part from the truth on a frame. For points in the picture it is the distance from the
/// contour, for the others the distance from their true places.
fn errors(drawn: &Drawn, frame: FrameNumber, found: &[Point]) -> [Vec<f64>; 2] {
    let truth = drawn.0[drawn.0.len() - 1].contour(frame);
    let mut errors = [Vec::new(), Vec::new()];
    for (p, q) in found.iter().zip(&truth) {
        let inside = q.x >= 0.0 && q.y >= 0.0 && q.x < WIDTH as f64;
        // An ellipse of one colour may rotate without a visible change: only its contour is visible.
        let apart = if inside { polyline::distance(*p, &truth, true) } else { p.distance(*q) };
        errors[usize::from(!inside)].push(apart);
    }
    errors
}

/// Tracks the nearest shape of a scene, keyed at both ends, and checks every point: its error must be below `inside` in
/// the picture and below `outside` outside of it.
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
    // On the second drawing half of it is outside, on the third all of it.
    let places = |t: f64| (Point::new([40.0, 2.0, -20.0, 25.0][(t / 2.0) as usize], 100.0), 0.0);
    // While it is not visible it is only kept near its path: it moves by 22 and by 45 px from drawing to drawing there.
    holds(&with(places), 4.0, 40.0);
}

#[test]
fn a_part_that_is_cut_by_the_border_all_the_time_keeps_its_shape() {
    holds(&with(|t| (Point::new(40.0 + 20.0 * t, 1.0), 0.0)), 2.0, 4.0);
}
