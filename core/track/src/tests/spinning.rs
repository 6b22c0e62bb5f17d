//! Parts that turn all the way round.

use super::scene::{Drawn, Shape, points, track};
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;

/// The last frame: the part has turned by 390° or more then.
const END: FrameNumber = 26;

/// A blade with a broad and a pointed end that spins while it moves.
fn blade(motion: fn(f64) -> (Point, f64)) -> Drawn {
    Drawn(vec![Shape {
        rest: points(&[(-30.0, -12.0), (0.0, -9.0), (36.0, -2.0), (36.0, 2.0), (0.0, 9.0), (-30.0, 12.0)]),
        colour: [0.85, 0.3, 0.2],
        motion,
    }])
}

#[test]
fn a_part_that_spins_more_than_once_is_followed_all_the_way() {
    let motions: [fn(f64) -> (Point, f64); 3] = [
        |t| (Point::new(60.0 + 4.0 * t, 90.0), 15.0 * t),
        |t| (Point::new(60.0 + 4.0 * t, 90.0), -15.0 * t),
        |t| (Point::new(60.0 + 4.0 * t, 90.0), 30.0 * t),
    ];
    for (k, drawn) in motions.into_iter().map(blade).enumerate() {
        for keys in [&[0][..], &[12], &[0, END]] {
            let mut part = drawn.0[0].part("blade", 0.0);
            part.keys = keys.iter().map(|&frame| (frame, drawn.0[0].contour(frame))).collect();
            let mut scene = drawn.scene(vec![part]);
            scene.footage.last = END;
            let found = &track(&drawn, &scene).parts[0];
            assert_eq!(found.tracks.len(), END as usize + 1, "motion {k}, keys {keys:?}");
            for (frame, points) in &found.tracks {
                let truth = drawn.0[0].contour(*frame);
                let worst = points.iter().zip(truth).map(|(p, q)| p.distance(q)).fold(0.0, f64::max);
                assert!(worst < 2.0, "motion {k}, keys {keys:?}, frame {frame}: {worst} px");
            }
        }
    }
}
