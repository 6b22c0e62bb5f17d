//! Limbs that the artist corrects.

use super::scene::{colour_at, points};
use crate::{TrackOptions, Tracker};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, Footage, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, Silent};
use std::sync::Arc;

const SIZE: (usize, usize) = (260, 220);
const LAST: FrameNumber = 4;

/// An arm that is bent to one side at both keys, and twice to the other side between them. A sleeve of the same colour
/// hangs beside it, and is no part.
struct Arm;

impl Arm {
    /// Degrees by which the forearm is turned.
    fn bend(frame: FrameNumber) -> f64 {
        [80.0, -100.0, 80.0, -100.0, 80.0][frame as usize]
    }

    fn contour(frame: FrameNumber) -> Vec<Point> {
        let elbow = Point::new(60.0, 0.0);
        let turn = Point::from_angle(Self::bend(frame).to_radians());
        let bent = |p: Point| if p.x > elbow.x { turn.rotate(p - elbow) + elbow } else { p };
        let upper = [0.0, 15.0, 30.0, 45.0].map(|x| (x, -8.0));
        let lower = [45.0, 30.0, 15.0, 0.0].map(|x| (x, 8.0));
        let hand = [(75.0, -8.0), (92.0, -7.0), (108.0, -6.0), (118.0, 0.0), (108.0, 6.0), (92.0, 7.0), (75.0, 8.0)];
        let all = [&upper[..], &hand, &lower].concat();
        let shift = Point::new(70.0, 110.0 + 2.0 * f64::from(frame));
        points(&all).into_iter().map(|p| bent(p) + shift).collect()
    }

    fn scene() -> Scene {
        let footage = Footage {
            pattern: "%d.png".into(),
            first: 0,
            last: LAST,
            fps: 12.0,
            width: SIZE.0,
            height: SIZE.1,
            held: false,
        };
        let keys = [0, LAST].map(|frame| (frame, Self::contour(frame)));
        let part = Part { name: "arm".into(), closed: true, keys: keys.into(), ..Part::default() };
        Scene { footage, parts: vec![part] }
    }
}

impl FrameSource for Arm {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let colour: Colour = [0.85, 0.55, 0.3];
        let sleeve = points(&[(30.0, 20.0), (46.0, 20.0), (46.0, 200.0), (30.0, 200.0)]);
        let shown: Vec<(Vec<Point>, (Point, Point), Colour)> = [Self::contour(frame), sleeve]
            .into_iter()
            .map(|contour| {
                let (low, high) = polygon::bounds(&contour).expect("a shape has points");
                (contour, (low - 1.0, high + 1.0), colour)
            })
            .collect();
        Ok(Arc::new(Raster::from_fn(SIZE.0, SIZE.1, |x, y| {
            let places = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
            let seen = places.map(|(dx, dy)| colour_at(&shown, Point::new(x as f64 + dx, y as f64 + dy)));
            std::array::from_fn(|k| seen.iter().map(|colour| colour[k]).sum::<f32>() / 4.0)
        })))
    }
}

/// Pins control points of the arm to their true places.
fn pin(scene: &mut Scene, frame: FrameNumber, points: &[usize]) {
    let truth = Arm::contour(frame);
    scene.parts[0].pins.entry(frame).or_default().extend(points.iter().map(|&j| (j, truth[j])));
}

const HAND: usize = 7;
const SHOULDER: usize = 0;
const ELBOW: usize = 11;

#[test]
fn a_limb_with_both_ends_pinned_bends_between_them() {
    let mut scene = Arm::scene();
    for frame in [1, 3] {
        pin(&mut scene, frame, &[HAND, SHOULDER]);
    }
    let tracking = Tracker::new(TrackOptions::default()).track(&scene, &Arm, &Silent).unwrap();
    for frame in [1, 3] {
        let found = &tracking.parts[0].tracks[&frame];
        // Where the elbow is sharp, the lattice rounds it.
        let far = Arm::contour(frame).iter().zip(found).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(far < 15.0, "frame {frame}: a point is {far} px from its place");
    }
}

#[test]
fn what_was_looked_for_with_corrections_is_found_again_only_with_the_same() {
    let mut scene = Arm::scene();
    let mut tracker = Tracker::new(TrackOptions::default());
    let edits: [(FrameNumber, &[usize]); 5] =
        [(1, &[HAND]), (3, &[HAND]), (1, &[SHOULDER]), (2, &[ELBOW]), (3, &[ELBOW])];
    for (frame, points) in edits {
        pin(&mut scene, frame, points);
        let again = tracker.track(&scene, &Arm, &Silent).unwrap();
        let fresh = Tracker::new(TrackOptions::default()).track(&scene, &Arm, &Silent).unwrap();
        assert!(again.parts == fresh.parts, "frame {frame}, points {points:?}");
    }
    scene.parts[0].pins.remove(&1);
    let again = tracker.track(&scene, &Arm, &Silent).unwrap();
    let fresh = Tracker::new(TrackOptions::default()).track(&scene, &Arm, &Silent).unwrap();
    assert!(again.parts == fresh.parts, "without the pins of frame 1");
}
