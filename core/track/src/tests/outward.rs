//! Parts with one key on drawn scenes of known motion.

use super::scene::{Drawn, HEIGHT, LAST, Shape, WIDTH, limb_and_ball, points, same_on_any_threads, track};
use crate::{Ending, PartTrack, TrackEnd, TrackOptions, Tracker};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, FrameError, FrameNumber, FrameSource, Part, Raster, Silent};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A part of a shape, keyed on one frame.
fn single(shape: &Shape, name: &str, depth: f64, frame: FrameNumber) -> Part {
    let keys = BTreeMap::from([(frame, shape.contour(frame))]);
    Part { name: name.into(), closed: true, depth, keys, ..Part::default() }
}

/// The largest distance of a track from the truth, on the frames of the track.
fn worst(shape: &Shape, track: &PartTrack) -> f64 {
    let on = |(frame, found): (&FrameNumber, &Vec<Point>)| {
        let truth = shape.contour(*frame);
        found.iter().zip(truth).map(|(p, q)| p.distance(q)).fold(0.0, f64::max)
    };
    track.tracks.iter().map(on).fold(0.0, f64::max)
}

fn frames(track: &PartTrack) -> Vec<FrameNumber> {
    track.tracks.keys().copied().collect()
}

/// Drawn pictures that are replaced from a frame on.
struct Changed<'a> {
    drawn: &'a Drawn,
    from: FrameNumber,
    instead: fn(usize, usize) -> Colour,
}

impl FrameSource for Changed<'_> {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        if frame < self.from {
            self.drawn.picture(frame)
        } else {
            Ok(Arc::new(Raster::from_fn(WIDTH, HEIGHT, self.instead)))
        }
    }
}

fn paper(_: usize, _: usize) -> Colour {
    [0.95, 0.93, 0.9]
}

fn night(x: usize, y: usize) -> Colour {
    [0.1, 0.1 + 0.001 * x as f32, 0.2 + 0.001 * y as f32]
}

#[test]
fn a_key_in_the_middle_is_followed_both_ways_behind_what_is_nearer() {
    let drawn = limb_and_ball();
    let parts = vec![single(&drawn.0[0], "limb", 0.0, 2), single(&drawn.0[1], "ball", 1.0, 6)];
    let tracking = track(&drawn, &drawn.scene(parts));
    for (shape, found) in drawn.0.iter().zip(&tracking.parts) {
        assert_eq!(frames(found), (0..=LAST).collect::<Vec<_>>());
        assert!(worst(shape, found) < 2.0, "{}", worst(shape, found));
        assert_eq!((found.ends.len(), found.wants_key().len()), (0, 0));
    }
    assert_eq!(tracking.parts[0].tracks[&3], drawn.0[0].contour(2), "held from the key");
    assert_eq!(tracking.jobs.iter().map(|job| (job.part, job.span.len())).collect::<Vec<_>>(), [(0, 7), (1, 7)]);
}

#[test]
fn a_part_that_disappears_needs_a_key_where_it_was_lost() {
    let drawn = limb_and_ball();
    let gone = Changed { drawn: &drawn, from: 4, instead: paper };
    let scene = drawn.scene(vec![single(&drawn.0[0], "limb", 0.0, 0)]);
    let found = &Tracker::new(TrackOptions::default()).track(&scene, &gone, &Silent).unwrap().parts[0];
    assert_eq!(frames(found), [0, 1, 2, 3]);
    assert_eq!(found.ends, [TrackEnd { frame: 4, reason: Ending::Lost }]);
    assert_eq!(found.wants_key(), [4]);
    assert!(worst(&drawn.0[0], found) < 2.0);
}

#[test]
fn another_shot_ends_a_track_and_needs_no_key() {
    let drawn = limb_and_ball();
    let shot = Changed { drawn: &drawn, from: 4, instead: night };
    let scene = drawn.scene(vec![single(&drawn.0[0], "limb", 0.0, 0)]);
    let found = &Tracker::new(TrackOptions::default()).track(&scene, &shot, &Silent).unwrap().parts[0];
    assert_eq!(frames(found), [0, 1, 2, 3]);
    assert_eq!(found.ends, [TrackEnd { frame: 4, reason: Ending::Cut }]);
    assert_eq!(found.wants_key(), [0; 0]);
}

/// A ball that rolls out of the picture to the right.
fn leaving() -> Drawn {
    let ball = limb_and_ball().0.swap_remove(1);
    Drawn(vec![Shape { motion: |t| (Point::new(150.0 + 18.0 * t, 90.0), 0.0), ..ball }])
}

#[test]
fn a_part_that_leaves_the_picture_needs_no_key() {
    let drawn = leaving();
    let tracking = track(&drawn, &drawn.scene(vec![single(&drawn.0[0], "ball", 0.0, 0)]));
    let found = &tracking.parts[0];
    assert_eq!(found.ends, [TrackEnd { frame: 6, reason: Ending::Left }], "{:?}", found.tracks.keys());
    // On frame 4 half of the ball is outside.
    assert!(frames(found).len() >= 4);
    let center = |frame| polygon::center(&drawn.0[0].contour(frame));
    assert!(found.tracks.iter().all(|(&f, p)| polygon::center(p).distance(center(f)) < 4.0), "{:?}", found.tracks);
}

/// A ball that leaves, and one of the same look that is there from frame 4 on.
fn leaving_and_coming() -> Drawn {
    fn coming(t: f64) -> (Point, f64) {
        (if t < 3.0 { Point::splat(-100.0) } else { Point::new(60.0, 90.0) }, 0.0)
    }
    let rest = leaving().0[0].rest.clone();
    let ball = |motion: fn(f64) -> (Point, f64)| Shape { rest: rest.clone(), colour: [0.2, 0.4, 0.8], motion };
    Drawn(vec![ball(|t| (Point::new(150.0 + 26.0 * t, 90.0), 0.0)), ball(coming)])
}

#[test]
fn a_part_that_left_the_picture_is_not_what_comes_into_it() {
    let drawn = leaving_and_coming();
    let found = &track(&drawn, &drawn.scene(vec![single(&drawn.0[0], "ball", 0.0, 0)])).parts[0];
    let near = |points: &[Point]| polygon::center(points).distance(Point::new(60.0, 90.0)) < 20.0;
    assert!(!found.tracks.values().any(|points| near(points)), "{:?}", found.tracks);
    assert!(found.ends.iter().all(|end| end.reason == Ending::Left) && found.ends.len() == 1, "{:?}", found.ends);
}

#[test]
fn a_part_that_left_the_picture_is_where_a_correction_says() {
    let (drawn, there) = (leaving_and_coming(), Point::new(60.0, 90.0));
    let mut part = single(&drawn.0[0], "ball", 0.0, 0);
    part.centers.insert(4, there);
    let found = &track(&drawn, &drawn.scene(vec![part])).parts[0];
    assert_eq!(frames(found), (0..=LAST).collect::<Vec<_>>());
    assert!((4..=LAST).all(|frame| polygon::center(&found.tracks[&frame]).distance(there) < 4.0), "{:?}", found.tracks);
}

#[test]
fn pins_and_centers_extend_trust_and_are_exact() {
    let drawn = limb_and_ball();
    let gone = Changed { drawn: &drawn, from: 4, instead: paper };
    let mut part = single(&drawn.0[0], "limb", 0.0, 1);
    let (pin, center) = (Point::new(101.5, 60.25), Point::new(140.0, 70.0));
    part.pins.insert(5, BTreeMap::from([(2, pin)]));
    part.centers.insert(6, center);
    let off = drawn.0[0].contour(0)[1] + Point::new(2.0, 1.0);
    part.pins.insert(0, BTreeMap::from([(1, off)]));
    let scene = drawn.scene(vec![part]);
    let found = &Tracker::new(TrackOptions::default()).track(&scene, &gone, &Silent).unwrap().parts[0];
    assert_eq!(frames(found), (0..=LAST).collect::<Vec<_>>());
    assert_eq!((found.tracks[&5][2], found.confidence[&5][2]), (pin, 1.0));
    assert_eq!((found.tracks[&0][1], found.confidence[&0][1]), (off, 1.0), "held from the key, but corrected");
    assert!(polygon::center(&found.tracks[&6]).distance(center) < 1e-9);
    assert_eq!(found.tracks[&1], scene.parts[0].keys[&1]);
    assert!(found.tracks.values().flatten().all(|p| p.is_finite()));
}

#[test]
fn a_part_with_one_key_does_not_change_parts_between_keys() {
    let drawn = limb_and_ball();
    let limb = drawn.0[0].part("limb", 0.0);
    let alone = track(&drawn, &drawn.scene(vec![limb.clone()]));
    let both = track(&drawn, &drawn.scene(vec![single(&drawn.0[1], "ball", -1.0, 3), limb]));
    assert_eq!(alone.parts[0], both.parts[1]);
}

#[test]
fn a_second_run_remembers_and_a_second_key_makes_an_ordinary_part() {
    let drawn = limb_and_ball();
    let mut scene = drawn.scene(vec![single(&drawn.0[0], "limb", 0.0, 0), single(&drawn.0[1], "ball", 1.0, 0)]);
    let mut tracker = Tracker::new(TrackOptions::default());
    let first = tracker.track(&scene, &drawn, &Silent).unwrap();
    assert!(first.jobs.iter().all(|job| job.solved));
    let second = tracker.track(&scene, &drawn, &Silent).unwrap();
    assert!(second.jobs.iter().all(|job| !job.solved));
    assert_eq!(first.parts, second.parts);
    scene.parts[0].keys.insert(LAST, drawn.0[0].contour(LAST));
    let keyed = tracker.track(&scene, &drawn, &Silent).unwrap();
    assert_eq!(keyed.jobs.iter().map(|job| job.solved).collect::<Vec<_>>(), [true, false]);
    assert_eq!(keyed.parts, track(&drawn, &scene).parts);
}

#[test]
fn the_number_of_threads_changes_nothing_outward() {
    let drawn = limb_and_ball();
    let scene = drawn.scene(vec![single(&drawn.0[0], "limb", 0.0, 4), single(&drawn.0[1], "ball", 1.0, 2)]);
    same_on_any_threads(&drawn, &scene);
}

#[test]
fn odd_parts_with_one_key_give_finite_tracks() {
    let drawn = limb_and_ball();
    let part = |name: &str, closed: bool, shape: &[(f64, f64)]| Part {
        name: name.into(),
        closed,
        keys: BTreeMap::from([(3, points(shape))]),
        ..Part::default()
    };
    let parts = vec![
        part("nothing", true, &[]),
        part("point", true, &[(50.0, 50.0)]),
        part("pair", false, &[(50.0, 50.0), (90.0, 60.0)]),
        part("on one spot", true, &[(50.0, 50.0); 4]),
        part("off the picture", true, &[(-500.0, -500.0), (-400.0, -500.0), (-450.0, -420.0)]),
        part("half outside", true, &[(-30.0, 60.0), (40.0, 60.0), (40.0, 120.0), (-30.0, 120.0)]),
        part("larger than the picture", true, &[(-90.0, -90.0), (900.0, -90.0), (900.0, 900.0), (-90.0, 900.0)]),
    ];
    let tracking = track(&drawn, &drawn.scene(parts.clone()));
    for (part, found) in parts.iter().zip(&tracking.parts) {
        assert_eq!(found.tracks[&3], part.keys[&3], "{}", part.name);
        assert!(found.tracks.values().flatten().all(|p| p.is_finite()), "{}", part.name);
        assert!(found.confidence.values().flatten().all(|c| (0.0..=1.0).contains(c)), "{}", part.name);
        let given = frames(found);
        assert!(given.windows(2).all(|pair| pair[1] == pair[0] + 1), "{}: no gaps", part.name);
    }
}

/// Two eyes of one look on a head that turns: one is seen until frame 3, the other one from frame 2 on.
fn eyes() -> Drawn {
    let eye = |motion: fn(f64) -> (Point, f64)| Shape {
        rest: (0..8).map(|k| Point::from_angle(f64::from(k) * 0.785) * Point::new(11.0, 14.0)).collect(),
        colour: [0.2, 0.4, 0.7],
        motion,
    };
    Drawn(vec![
        eye(|t| (Point::new(if t < 4.0 { 120.0 + 6.0 * t } else { -300.0 }, 90.0), 0.0)),
        eye(|t| (Point::new(if t > 1.0 { 50.0 + 6.0 * t } else { -300.0 }, 90.0), 0.0)),
    ])
}

#[test]
fn a_part_that_disappears_does_not_go_over_to_its_twin() {
    let drawn = eyes();
    let parts = vec![single(&drawn.0[0], "right", 0.0, 0), single(&drawn.0[1], "left", 1.0, LAST)];
    let tracking = track(&drawn, &drawn.scene(parts));
    for (found, shape, own) in [(&tracking.parts[0], &drawn.0[0], 0..4), (&tracking.parts[1], &drawn.0[1], 2..7)] {
        assert_eq!(frames(found), own.collect::<Vec<_>>());
        assert!(worst(shape, found) < 2.0, "{}", worst(shape, found));
    }
    assert_eq!(tracking.parts[0].wants_key(), [4]);
    assert_eq!(tracking.parts[1].wants_key(), [1]);
}
