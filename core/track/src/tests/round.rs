//! Round parts, which fit turned as well as they are.

use super::scene::{Drawn, LAST, Shape, track};
use rototoon_base::geometry::{Point, polygon};
use std::f64::consts::TAU;

/// A ball of one colour.
fn ball() -> Drawn {
    Drawn(vec![Shape {
        rest: (0..12).map(|k| Point::from_angle(f64::from(k) / 12.0 * TAU) * 15.0).collect(),
        colour: [0.2, 0.4, 0.8],
        motion: |t| (Point::new(60.0 + 9.0 * t, 90.0 - 4.0 * t), 0.0),
    }])
}

#[test]
fn a_center_near_a_round_part_does_not_turn_it() {
    let drawn = ball();
    for single in [true, false] {
        for off in [(1.0, 0.6), (-1.5, 2.0), (-4.0, 2.0), (6.0, 0.0)] {
            let mut part = drawn.0[0].part("ball", 0.0);
            if single {
                part.keys.remove(&LAST);
            }
            let center = polygon::center(&drawn.0[0].contour(4)) + Point::new(off.0, off.1);
            part.centers.insert(4, center);
            let found = &track(&drawn, &drawn.scene(vec![part])).parts[0];
            for (frame, points) in &found.tracks {
                let middle = polygon::center(points);
                let turned = (points[0] - middle).to_angle().to_degrees();
                assert!(turned.abs() < 5.0, "single key {single}, {off:?} off, frame {frame}: {turned}°");
                assert!(*frame != 4 || middle.distance(center) < 1e-6);
            }
        }
    }
}
