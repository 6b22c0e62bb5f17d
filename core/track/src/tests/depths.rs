//! Parts that pass from behind another one to its front.

use super::scene::{Drawn, LAST, Shape, points};
use crate::{TrackOptions, Tracker, Tracking};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, Silent};
use std::sync::Arc;

/// The first frame on which the arm is in front of the body.
const FRONT: FrameNumber = 4;

/// Shift and rotation in degrees by time in frames.
type Motion = fn(f64) -> (Point, f64);

/// Swings down behind the body, and back up in front of it.
const SWINGING: Motion = |t| match t as i32 {
    0 => (Point::new(60.0, 60.0), 10.0),
    2 => (Point::new(66.0, 70.0), 24.0),
    4 => (Point::new(90.0, 92.0), 0.0),
    _ => (Point::new(76.0, 76.0), 14.0),
};

/// Comes from beside the body, passes behind its edge, and then in front of it.
const COMING: Motion = |t| match t as i32 {
    0 => (Point::new(18.0, 70.0), 0.0),
    2 => (Point::new(36.0, 76.0), 7.0),
    4 => (Point::new(60.0, 82.0), -3.0),
    _ => (Point::new(84.0, 76.0), 6.0),
};

/// An arm that passes from behind a body to its front: both orders of the two.
struct Passing([Drawn; 2]);

impl Passing {
    fn new(arm: Motion) -> Self {
        Self([[0, 1], [1, 0]].map(|order| Drawn(order.map(|which| shape(which, arm)).into())))
    }

    fn shape(&self, k: usize) -> &Shape {
        &self.0[0].0[k]
    }
}

/// The arm or the body.
fn shape(which: usize, motion: Motion) -> Shape {
    let arm = Shape {
        rest: points(&[(-7.0, -7.0), (30.0, -8.0), (64.0, -6.0), (66.0, 6.0), (30.0, 8.0), (-7.0, 7.0)]),
        colour: [0.85, 0.6, 0.2],
        motion,
    };
    let body = Shape {
        rest: points(&[(-44.0, -50.0), (0.0, -54.0), (44.0, -50.0), (50.0, 50.0), (0.0, 54.0), (-50.0, 50.0)]),
        colour: [0.3, 0.45, 0.75],
        motion: |t| match t as i32 {
            0 => (Point::new(140.0, 92.0), 0.0),
            2 => (Point::new(146.0, 96.0), 5.0),
            4 => (Point::new(140.0, 84.0), -9.0),
            _ => (Point::new(132.0, 92.0), 0.0),
        },
    };
    if which == 0 { arm } else { body }
}

impl FrameSource for Passing {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        self.0[usize::from(frame >= FRONT)].picture(frame)
    }
}

/// The scene with keys on some frames, where the document says from which frame on the arm is in front, or not.
fn scene(film: &Passing, keys: &[FrameNumber], said: bool) -> Scene {
    let part = |k: usize, name: &str| {
        let keys = keys.iter().map(|&frame| (frame, film.shape(k).contour(frame))).collect();
        Part { keys, ..film.shape(k).part(name, k as f64) }
    };
    let (mut arm, body) = (part(0, "arm"), part(1, "body"));
    if said {
        arm.depths = (FRONT..=LAST).map(|frame| (frame, 2.0)).collect();
    }
    film.0[0].scene(vec![arm, body])
}

/// How far the track of each part is from the truth at most, in pixels. Infinite where it ends.
fn worst(film: &Passing, tracking: &Tracking) -> Vec<f64> {
    let of = |k: usize| {
        let on = |frame: FrameNumber| {
            let (truth, found) = (film.shape(k).contour(frame), tracking.parts[k].tracks.get(&frame));
            found.map_or(f64::INFINITY, |found| found.iter().zip(truth).map(|(p, q)| p.distance(q)).fold(0.0, f64::max))
        };
        (0..=LAST).map(on).fold(0.0, f64::max)
    };
    [0, 1].map(of).into()
}

fn tracked(film: &Passing, scene: &Scene) -> Tracking {
    Tracker::new(TrackOptions::default()).track(scene, film, &Silent).unwrap()
}

/// How far the parts are off at most, where the document says the order of each drawing, and where not.
fn said_and_not(arm: Motion, keys: &[FrameNumber]) -> [Vec<f64>; 2] {
    let film = Passing::new(arm);
    [true, false].map(|said| worst(&film, &tracked(&film, &scene(&film, keys, said))))
}

#[test]
fn the_order_of_a_drawing_says_what_is_hidden_between_keys() {
    let [said, unsaid] = said_and_not(SWINGING, &[0, 2, LAST]);
    assert!(said.iter().all(|worst| *worst < 1.5), "{said:?}");
    assert!(unsaid[0] > 3.0, "the scene needs the order: {unsaid:?}");
}

#[test]
fn the_order_of_a_drawing_says_what_is_hidden_beside_a_single_key() {
    for key in [0, FRONT, LAST] {
        let [said, unsaid] = said_and_not(COMING, &[key]);
        assert!(said.iter().all(|worst| *worst < 2.0), "key {key}: {said:?}");
        assert!(unsaid[0] > 3.0, "key {key}, the scene needs the order: {unsaid:?}");
    }
}

#[test]
fn another_order_is_another_input() {
    for (arm, keys) in [(SWINGING, &[0, 2, LAST][..]), (COMING, &[0])] {
        let film = Passing::new(arm);
        let mut tracker = Tracker::new(TrackOptions::default());
        let mut follow = |said| tracker.track(&scene(&film, keys, said), &film, &Silent).unwrap();
        let (first, second, third) = (follow(false), follow(true), follow(true));
        assert_eq!(first.parts, tracked(&film, &scene(&film, keys, false)).parts);
        assert_eq!(second.parts, tracked(&film, &scene(&film, keys, true)).parts);
        assert_ne!(first.parts, second.parts, "{keys:?}");
        assert_eq!(second.parts, third.parts);
        assert!(third.jobs.iter().all(|job| !job.solved), "{keys:?}");
    }
}

#[test]
fn the_number_of_threads_changes_nothing_where_the_order_changes() {
    for (arm, keys) in [(SWINGING, &[0, 2, LAST][..]), (COMING, &[0])] {
        let film = Passing::new(arm);
        let scene = scene(&film, keys, true);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| tracked(&film, &scene))
        };
        assert_eq!(with(1), with(4));
    }
}
