//! The default solver on drawn scenes of known motion.

use crate::{Mechanism, Mechanisms, TrackOptions, Tracker, Tracking};
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::{Colour, Footage, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, Silent};
use std::collections::BTreeMap;
use std::sync::Arc;

pub(super) const WIDTH: usize = 240;
pub(super) const HEIGHT: usize = 180;
pub(super) const LAST: FrameNumber = 6;

/// Half the width of an outline, in pixels.
const OUTLINE: f64 = 1.0;

/// An outlined shape of one colour, with its motion. `motion` gives shift and rotation in degrees by time in frames.
pub(super) struct Shape {
    pub(super) rest: Vec<Point>,
    pub(super) colour: Colour,
    pub(super) motion: fn(f64) -> (Point, f64),
}

impl Shape {
    pub(super) fn contour(&self, frame: FrameNumber) -> Vec<Point> {
        // On twos: frame 1 shows the drawing of frame 0.
        let (shift, degrees) = (self.motion)(f64::from(frame / 2 * 2));
        let turn = Point::from_angle(degrees.to_radians());
        self.rest.iter().map(|&p| turn.rotate(p) + shift).collect()
    }

    pub(super) fn part(&self, name: &str, depth: f64) -> Part {
        let keys = [0, LAST].map(|f| (f, self.contour(f)));
        Part { name: name.into(), closed: true, depth, keys: keys.into(), ..Part::default() }
    }
}

/// Shapes in the order of depth: later shapes are nearer.
pub(super) struct Drawn(pub(super) Vec<Shape>);

impl Drawn {
    /// The shapes of a frame, the nearest first: contour, its bounds with the outline, and fill colour.
    fn shown(&self, frame: FrameNumber) -> Vec<(Vec<Point>, (Point, Point), Colour)> {
        let one = |shape: &Shape| {
            let contour = shape.contour(frame);
            let (low, high) = polygon::bounds(&contour).expect("a shape has points");
            (contour, (low - OUTLINE, high + OUTLINE), shape.colour)
        };
        self.0.iter().rev().map(one).collect()
    }

    pub(super) fn scene(&self, parts: Vec<Part>) -> Scene {
        let footage = Footage {
            pattern: "%d.png".into(),
            first: 0,
            last: LAST,
            fps: 12.0,
            width: WIDTH,
            height: HEIGHT,
            held: false,
        };
        Scene { footage, parts }
    }
}

/// Colour at a point: the fill of the nearest shape, its outline of 2 px, or paper.
pub(super) fn colour_at(shown: &[(Vec<Point>, (Point, Point), Colour)], p: Point) -> Colour {
    let near = shown.iter().filter(|(_, (low, high), _)| p.cmpge(*low).all() && p.cmple(*high).all());
    for (contour, _, colour) in near {
        if polyline::distance(p, contour, true) <= OUTLINE {
            return [0.05; 3];
        }
        if polygon::contains(contour, p) {
            return *colour;
        }
    }
    [0.95, 0.93, 0.9]
}

impl FrameSource for Drawn {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let shown = self.shown(frame);
        let offsets = [0.17, 0.5, 0.83];
        let picture = Raster::from_fn(WIDTH, HEIGHT, |x, y| {
            let mut sum = [0.0f32; 3];
            for dy in offsets {
                for dx in offsets {
                    let colour = colour_at(&shown, Point::new(x as f64 + dx, y as f64 + dy));
                    (0..3).for_each(|k| sum[k] += colour[k] / 9.0);
                }
            }
            sum
        });
        Ok(Arc::new(picture))
    }
}

pub(super) fn points(list: &[(f64, f64)]) -> Vec<Point> {
    list.iter().map(|&(x, y)| Point::new(x, y)).collect()
}

/// A limb that rotates by 90° while it moves, and a ball that passes in front of it.
pub(super) fn limb_and_ball() -> Drawn {
    let limb = Shape {
        rest: points(&[(-30.0, -8.0), (0.0, -10.0), (34.0, -6.0), (36.0, 8.0), (0.0, 9.0), (-30.0, 8.0)]),
        colour: [0.85, 0.3, 0.2],
        motion: |t| (Point::new(70.0 + 12.0 * t, 90.0 - 3.0 * t), 15.0 * t),
    };
    let ball = Shape {
        rest: (0..10).map(|k| Point::from_angle(f64::from(k) * 0.628) * Point::new(14.0, 11.0)).collect(),
        colour: [0.2, 0.4, 0.8],
        motion: |t| (Point::new(190.0 - 18.0 * t, 60.0 + 4.0 * t), 0.0),
    };
    Drawn(vec![limb, ball])
}

/// Two legs of the same appearance that swing past each other below a body. The second one is nearer.
fn twins() -> Drawn {
    let leg = |motion: fn(f64) -> (Point, f64)| Shape {
        rest: points(&[(-7.0, -6.0), (7.0, -6.0), (7.0, 32.0), (6.0, 68.0), (-6.0, 68.0), (-7.0, 32.0)]),
        colour: [0.3, 0.35, 0.5],
        motion,
    };
    let body = Shape {
        rest: points(&[(-34.0, -60.0), (34.0, -60.0), (30.0, -20.0), (34.0, 6.0), (-34.0, 6.0)]),
        colour: [0.8, 0.7, 0.3],
        motion: |t| (Point::new(118.0 + 2.0 * t, 80.0), 0.0),
    };
    let far = leg(|t| (Point::new(108.0 + 2.0 * t, 80.0), 38.0 - 13.0 * t));
    let near = leg(|t| (Point::new(124.0 + 2.0 * t, 80.0), -40.0 + 13.0 * t));
    Drawn(vec![far, near, body])
}

pub(super) fn track(drawn: &Drawn, scene: &Scene) -> Tracking {
    Tracker::new(TrackOptions::default()).track(scene, drawn, &Silent).unwrap()
}

#[test]
fn turning_and_crossing_shapes_are_followed_on_held_drawings() {
    let drawn = limb_and_ball();
    let scene = drawn.scene(vec![drawn.0[0].part("limb", 0.0), drawn.0[1].part("ball", 1.0)]);
    let tracking = track(&drawn, &scene);
    for (shape, part) in drawn.0.iter().zip(&tracking.parts) {
        for frame in 0..=LAST {
            let worst = shape
                .contour(frame)
                .iter()
                .zip(&part.tracks[&frame])
                .map(|(want, got)| want.distance(*got))
                .fold(0.0, f64::max);
            assert!(worst < 1.5, "frame {frame}: {worst} px");
        }
        assert_eq!(part.tracks[&0], part.tracks[&1], "a held drawing keeps its contour");
        assert!(part.confidence[&2].iter().sum::<f64>() / part.confidence[&2].len() as f64 > 0.8);
    }
}

#[test]
fn equal_legs_that_cross_stay_on_their_own_hips() {
    let drawn = twins();
    let names = [("far leg", 0.0), ("near leg", 1.0), ("body", 2.0)];
    let parts = drawn.0.iter().zip(names).map(|(shape, (name, depth))| shape.part(name, depth)).collect();
    let tracking = track(&drawn, &drawn.scene(parts));
    for (shape, (part, (name, _))) in drawn.0.iter().zip(tracking.parts.iter().zip(names)) {
        for frame in 0..=LAST {
            let apart = shape.contour(frame).iter().zip(&part.tracks[&frame]).map(|(p, q)| p.distance(*q)).collect();
            let apart: Vec<f64> = apart;
            let mean = apart.iter().sum::<f64>() / apart.len() as f64;
            assert!(mean < 3.0, "{name}, frame {frame}: {apart:?}");
        }
    }
}

#[test]
fn an_edit_solves_only_affected_jobs_and_equals_a_new_run() {
    let drawn = twins();
    let names = [("far leg", 0.0), ("near leg", 1.0), ("body", 2.0)];
    let parts = drawn.0.iter().zip(names).map(|(shape, (name, depth))| shape.part(name, depth)).collect();
    let mut scene = drawn.scene(parts);
    let mut tracker = Tracker::new(TrackOptions::default());
    let solved = |tracking: &Tracking| tracking.jobs.iter().filter(|job| job.solved).count();
    assert_eq!(solved(&tracker.track(&scene, &drawn, &Silent).unwrap()), 3);
    assert_eq!(solved(&tracker.track(&scene, &drawn, &Silent).unwrap()), 0);
    let pin = drawn.0[0].contour(2)[3] + Point::new(1.0, 0.5);
    scene.parts[0].pins.insert(2, BTreeMap::from([(3, pin)]));
    let warm = tracker.track(&scene, &drawn, &Silent).unwrap();
    assert!(warm.jobs[0].solved && !warm.jobs[2].solved, "the body in front is not touched");
    let cold = track(&drawn, &scene);
    assert_eq!(warm.parts, cold.parts);
}

/// Tracks a scene on 1, 2 and 8 threads and compares the results.
pub(super) fn same_on_any_threads(drawn: &Drawn, scene: &Scene) {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| track(drawn, scene))
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let drawn = twins();
    let scene =
        drawn.scene(vec![drawn.0[0].part("far", 0.0), drawn.0[1].part("near", 1.0), drawn.0[2].part("body", 2.0)]);
    same_on_any_threads(&drawn, &scene);
}

#[test]
fn pins_and_small_moves_are_exact_and_neighbours_follow() {
    let drawn = limb_and_ball();
    let mut limb = drawn.0[0].part("limb", 0.0);
    let pin = drawn.0[0].contour(3)[2] + Point::new(6.0, -5.0);
    limb.pins.insert(3, BTreeMap::from([(2, pin)]));
    let center = polygon::center(&drawn.0[0].contour(4)) + Point::new(3.0, 3.0);
    limb.centers.insert(4, center);
    let tracking = track(&drawn, &drawn.scene(vec![limb]));
    let tracks = &tracking.parts[0].tracks;
    assert_eq!(tracks[&3][2], pin);
    assert_eq!(tracking.parts[0].confidence[&3][2], 1.0);
    assert!(polygon::center(&tracks[&4]).distance(center) < 1e-9);
    // Frames 2 and 3 show the same drawing, so the correction is for both.
    assert!(tracks[&2][2].distance(pin) < 0.5);
}

#[test]
fn a_far_center_shows_where_to_search() {
    let ball = |motion: fn(f64) -> (Point, f64)| Shape {
        rest: (0..10).map(|k| Point::from_angle(f64::from(k) * 0.628) * Point::new(16.0, 12.0)).collect(),
        colour: [0.2, 0.4, 0.8],
        motion,
    };
    fn between(t: f64) -> bool {
        t > 0.5 && t < 5.5
    }
    let hops = |t: f64| (if between(t) { Point::new(180.0, 120.0) } else { Point::new(60.0, 90.0) }, 0.0);
    let decoy = |t: f64| (if between(t) { Point::new(63.0, 91.0) } else { Point::new(180.0, 40.0) }, 0.0);
    let drawn = Drawn(vec![ball(hops), ball(decoy)]);
    let mut part = drawn.0[0].part("ball", 0.0);
    let there = |part: &Part| polygon::center(&track(&drawn, &drawn.scene(vec![part.clone()])).parts[0].tracks[&4]);
    let truth = polygon::center(&drawn.0[0].contour(4));
    assert!(there(&part).distance(truth) > 50.0, "its twin is nearer");
    part.centers.insert(4, truth + Point::new(1.2, -1.0));
    let found = there(&part);
    assert!(found.distance(truth) < 0.5, "{found} for {truth}");
}

#[test]
fn odd_parts_give_finite_tracks() {
    let drawn = limb_and_ball();
    let part = |name: &str, closed: bool, shape: &[(f64, f64)]| {
        let moved = |dx: f64| points(shape).iter().map(|&p| p + Point::new(dx, 0.0)).collect();
        let keys = BTreeMap::from([(0, moved(0.0)), (LAST, moved(10.0))]);
        Part { name: name.into(), closed, keys, ..Part::default() }
    };
    let parts = vec![
        part("point", true, &[(50.0, 50.0)]),
        part("pair", false, &[(50.0, 50.0), (90.0, 60.0)]),
        part("line", false, &[(40.0, 80.0), (70.0, 82.0), (100.0, 90.0)]),
        part("without area", true, &[(50.0, 50.0), (90.0, 50.0), (70.0, 50.0)]),
        part("on one spot", true, &[(50.0, 50.0); 4]),
        part("off the picture", true, &[(-500.0, -500.0), (-400.0, -500.0), (-450.0, -420.0)]),
        part("half outside", true, &[(-30.0, 60.0), (40.0, 60.0), (40.0, 120.0), (-30.0, 120.0)]),
        part("larger than the picture", true, &[(-90.0, -90.0), (900.0, -90.0), (900.0, 900.0), (-90.0, 900.0)]),
    ];
    let tracking = track(&drawn, &drawn.scene(parts.clone()));
    for (part, track) in parts.iter().zip(&tracking.parts) {
        assert_eq!(track.tracks.len(), LAST as usize + 1, "{}", part.name);
        assert!(track.tracks.values().flatten().all(|p| p.is_finite()), "{}", part.name);
        assert!(track.confidence.values().flatten().all(|c| (0.0..=1.0).contains(c)), "{}", part.name);
    }
}

#[test]
fn pictures_that_would_fill_the_memory_are_refused() {
    let drawn = limb_and_ball();
    let mut scene = drawn.scene(vec![drawn.0[0].part("limb", 1.0)]);
    (scene.footage.width, scene.footage.height) = (10_000, 1);
    let error = Tracker::new(TrackOptions::default()).track(&scene, &drawn, &Silent).unwrap_err();
    let told = "footage: found pictures of 10000x1 pixels, expected at most 32 times as wide as high";
    assert_eq!(error.to_string(), told);
}

#[test]
fn a_key_of_one_part_alone_acts_as_a_correction_on_the_others() {
    let drawn = twins();
    let names = [("far leg", 0.0), ("near leg", 1.0), ("body", 2.0)];
    let parts = drawn.0.iter().zip(names).map(|(shape, (name, depth))| shape.part(name, depth)).collect();
    let base = drawn.scene(parts);
    let mut tracker = Tracker::new(TrackOptions::default());
    tracker.track(&base, &drawn, &Silent).unwrap();
    // Frame 2 is held on frame 3. The new key is not where the drawing is, so that its effect is seen.
    let key: Vec<Point> = drawn.0[1].contour(2).into_iter().map(|p| p + Point::new(5.0, 0.0)).collect();
    let (mut keyed, mut pinned) = (base.clone(), base.clone());
    keyed.parts[1].keys.insert(2, key.clone());
    pinned.parts[1].pins.insert(2, key.iter().copied().enumerate().collect());
    let found = tracker.track(&keyed, &drawn, &Silent).unwrap();
    let corrected = track(&drawn, &pinned);
    assert!(found.parts == corrected.parts, "a contour that is moved as a whole is a key");
    let whole: Vec<usize> = corrected.jobs.iter().map(|job| job.span.len()).collect();
    assert_eq!(whole, [7, 7, 7], "but it ends no span");
    let mechanisms = Mechanisms::without(Mechanism::CorrectiveKeys);
    let options = TrackOptions { mechanisms, ..TrackOptions::default() };
    let plain = Tracker::new(options).track(&pinned, &drawn, &Silent).unwrap();
    let others = |tracking: &Tracking| [tracking.parts[0].clone(), tracking.parts[2].clone()];
    assert!(others(&plain) == others(&found), "to the others it is a correction");
    assert!(plain.parts[1] != found.parts[1], "to the part itself it is more");
    let own = &found.parts[1];
    assert_eq!([&own.tracks[&2], &own.tracks[&3]], [&key, &key], "a frame held from a key shows the key");
    assert_eq!(own.confidence[&2], vec![1.0; key.len()]);
    let spans: Vec<(usize, FrameNumber, FrameNumber)> =
        found.jobs.iter().map(|job| (job.part, job.span.first, job.span.last)).collect();
    assert_eq!(spans, [(0, 0, 6), (1, 0, 2), (1, 2, 6), (2, 0, 6)]);
    assert_eq!(found.parts, track(&drawn, &keyed).parts, "an edit equals a new run");
    let again = tracker.track(&keyed, &drawn, &Silent).unwrap();
    assert!(again.jobs.iter().all(|job| !job.solved), "nothing is computed twice");
    same_on_any_threads(&drawn, &keyed);
    assert_eq!(tracker.track(&base, &drawn, &Silent).unwrap().parts, track(&drawn, &base).parts, "and can be undone");
}

#[test]
fn a_part_that_nobody_corrected_stays_unless_it_becomes_clearly_surer() {
    let drawn = twins();
    let names = [("far leg", 0.0), ("near leg", 1.0), ("body", 2.0)];
    let parts = drawn.0.iter().zip(names).map(|(shape, (name, depth))| shape.part(name, depth)).collect();
    let base = drawn.scene(parts);
    // Somebody drags the near leg onto the far one.
    let mut wrong = base.clone();
    wrong.parts[1].centers.insert(2, polygon::center(&drawn.0[0].contour(2)));
    let off = TrackOptions { mechanisms: Mechanisms::without(Mechanism::Untouched), ..TrackOptions::default() };
    let before = track(&drawn, &base);
    let moved = Tracker::new(off).track(&wrong, &drawn, &Silent).unwrap();
    assert!(moved.parts[0].tracks[&2] != before.parts[0].tracks[&2], "the choice would move the far leg too");
    let mut tracker = Tracker::new(TrackOptions::default());
    tracker.track(&base, &drawn, &Silent).unwrap();
    let found = tracker.track(&wrong, &drawn, &Silent).unwrap();
    assert!(found.parts[0] == before.parts[0] && found.parts[2] == before.parts[2]);
    assert!(
        found.parts[1] == moved.parts[1] && found.parts[1] != before.parts[1],
        "the near leg goes where it is dragged"
    );
    assert!(found.parts == track(&drawn, &wrong).parts, "an edit equals a new run");
    same_on_any_threads(&drawn, &wrong);
}
