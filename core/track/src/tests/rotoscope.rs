//! The presets `agarwala2004` and `liang2012` on an easy sequence and on extreme inputs.

use crate::contract::error::TrackError;
use crate::contract::job::{Correction, Job, SpanSolver, SpanTrack, Termination};
use crate::rotoscope::agarwala2004::Agarwala2004;
use crate::rotoscope::liang2012::Liang2012;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Cancelled, Colour, FrameError, FrameNumber, FrameSource, Progress, Raster, Silent, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const SIZE: (usize, usize) = (200, 160);
const SPAN: Span = Span { first: 0, last: 8 };

fn presets() -> [(&'static str, Box<dyn SpanSolver>); 2] {
    [("agarwala2004", Box::new(Agarwala2004::default())), ("liang2012", Box::new(Liang2012::default()))]
}

/// Place and rotation of the shape: along a bow of 16 px height, rotating by 0.4 radians.
fn pose(frame: FrameNumber) -> (Point, Point) {
    let share = f64::from(frame) / f64::from(SPAN.last);
    let bow = 16.0 * (share * std::f64::consts::PI).sin();
    (Point::new(70.0 + 40.0 * share, 90.0 - bow), Point::from_angle(0.4 * share))
}

/// Radius of the shape in a direction of its own frame: an egg with a dent.
fn radius(angle: f64) -> f64 {
    30.0 + 5.0 * angle.cos() + 4.0 * (2.0 * angle + 0.7).sin()
}

fn outline(frame: FrameNumber) -> Vec<Point> {
    let (middle, turn) = pose(frame);
    let point = |j: i32| {
        let angle = f64::from(j) * std::f64::consts::TAU / 14.0;
        middle + turn.rotate(Point::from_angle(angle) * radius(angle))
    };
    (0..14).map(point).collect()
}

/// The shape with stripes on it in front of a plain wall. `wall` hides the columns from 95 to 112.
struct Egg {
    wall: bool,
}

impl FrameSource for Egg {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let (middle, turn) = pose(frame);
        let colour = |p: Point| -> [f64; 3] {
            if self.wall && (95.0..112.0).contains(&p.x) {
                return [0.2, 0.6, 0.3];
            }
            let own = Point::new(turn.x, -turn.y).rotate(p - middle);
            let stripes = 0.5 + 0.5 * (own.x / 5.0).sin() * (own.y / 7.0).cos();
            if own.length() < radius(own.y.atan2(own.x)) {
                [0.9 * stripes, 0.3, 0.9 - 0.6 * stripes]
            } else {
                [0.9, 0.9, 0.8]
            }
        };
        Ok(Arc::new(Raster::from_fn(SIZE.0, SIZE.1, |x, y| {
            // Four samples per pixel give antialiased edges.
            let at = |k: usize| {
                colour(Point::new(x as f64 + 0.25 + 0.5 * (k % 2) as f64, y as f64 + 0.25 + 0.5 * (k / 2) as f64))
            };
            [0, 1, 2].map(|c| ((0..4).map(|k| at(k)[c]).sum::<f64>() / 4.0) as f32)
        })))
    }
}

fn job(keys: [Vec<Point>; 2], closed: bool, span: Span) -> Job {
    let occluders = vec![Vec::new(); span.len()];
    Job {
        name: "egg".into(),
        closed,
        span,
        keys,
        corrections: BTreeMap::new(),
        absent: BTreeSet::new(),
        occluders,
        size: SIZE,
    }
}

fn easy() -> Job {
    job([outline(0), outline(SPAN.last)], true, SPAN)
}

fn solve(solver: &dyn SpanSolver, job: &Job, frames: &dyn FrameSource) -> SpanTrack {
    let track = solver.solve(job, frames, &Silent).unwrap();
    assert_eq!((track.points.len(), track.confidence.len()), (job.span.len(), job.span.len()));
    for (curve, confidence) in track.points.iter().zip(&track.confidence) {
        assert_eq!((curve.len(), confidence.len()), (job.keys[0].len(), job.keys[0].len()));
        assert!(curve.iter().all(|p| p.is_finite()));
        assert!(confidence.iter().all(|c| (0.0..=1.0).contains(c)));
    }
    assert_eq!((&track.points[0], &track.points[job.span.len() - 1]), (&job.keys[0], &job.keys[1]));
    track
}

/// Largest distance of a point from the truth.
fn worst(track: &SpanTrack) -> f64 {
    let pairs = track.points.iter().zip(0..).flat_map(|(found, frame)| found.iter().zip(outline(frame)));
    pairs.map(|(found, truth)| found.distance(truth)).fold(0.0, f64::max)
}

/// Mean distance of the points between the keys from the truth.
fn mean(track: &SpanTrack) -> f64 {
    let pairs = track.points.iter().zip(0..).flat_map(|(found, frame)| found.iter().zip(outline(frame)));
    let count = track.points[0].len() * (track.points.len() - 2);
    pairs.map(|(found, truth)| found.distance(truth)).sum::<f64>() / count as f64
}

#[test]
fn a_textured_shape_that_moves_and_turns_slowly_is_followed() {
    let blended = (0..=SPAN.last).map(|frame| easy().interpolated(frame as usize)).collect();
    let start = SpanTrack { points: blended, ..solve(&Agarwala2004::default(), &easy(), &Egg { wall: false }) };
    assert!(worst(&start) > 15.0, "the start is no solution");
    for (name, solver) in presets() {
        let track = solve(&*solver, &easy(), &Egg { wall: false });
        assert!(worst(&track) < 1.5, "{name}: {} {:?}", worst(&track), track.summary);
        assert!(track.summary.final_cost < track.summary.initial_cost);
        assert!(track.confidence.iter().flatten().all(|&c| c > 0.5));
    }
}

#[test]
fn hidden_points_are_carried_along() {
    let wall = [(95.0, -10.0), (112.0, -10.0), (112.0, 300.0), (95.0, 300.0)].map(|(x, y)| Point::new(x, y)).to_vec();
    for (name, solver) in presets() {
        let covered = Job { occluders: vec![vec![wall.clone()]; SPAN.len()], ..easy() };
        let track = solve(&*solver, &covered, &Egg { wall: true });
        assert!(mean(&track) < 2.0, "{name}: {} {:?}", mean(&track), track.summary);
    }
}

#[test]
fn pins_and_centres_are_exact() {
    let mut job = easy();
    let pin = Point::new(58.0, 42.5);
    job.corrections.insert(2, Correction { pins: BTreeMap::from([(3, pin)]), center: None });
    let center = Point::new(90.0, 70.0);
    job.corrections.insert(3, Correction { pins: BTreeMap::new(), center: Some(center) });
    job.corrections.insert(5, Correction { pins: BTreeMap::from([(1, pin)]), center: Some(center) });
    let everything = outline(4).into_iter().enumerate().collect();
    job.corrections.insert(4, Correction { pins: everything, center: Some(center) });
    for (name, solver) in presets() {
        let track = solve(&*solver, &job, &Egg { wall: false });
        assert_eq!((track.points[2][3], track.points[5][1], track.confidence[2][3]), (pin, pin, 1.0), "{name}");
        for frame in [3, 5] {
            assert!(polygon::center(&track.points[frame]).distance(center) < 1e-9);
        }
        assert_eq!(track.points[4], outline(4));
    }
}

#[test]
fn short_flat_and_distant_parts_give_finite_tracks() {
    let shift = |points: &[Point], by: f64| points.iter().map(|&p| p + Point::splat(by)).collect::<Vec<_>>();
    let flat = vec![Point::new(20.0, 20.0); 5];
    let span = Span { first: 0, last: 3 };
    for (_, solver) in presets() {
        for closed in [true, false] {
            for key in [outline(0)[..1].to_vec(), outline(0)[..2].to_vec(), outline(0)[..3].to_vec(), flat.clone()] {
                for by in [0.0, 30.0, -500.0, 1e6] {
                    solve(&*solver, &job([key.clone(), shift(&key, by)], closed, span), &Egg { wall: false });
                }
                solve(&*solver, &job([shift(&key, -500.0), shift(&key, -500.0)], closed, span), &Egg { wall: false });
            }
        }
        let short =
            solve(&*solver, &job([outline(0), outline(1)], true, Span { first: 0, last: 1 }), &Egg { wall: false });
        assert_eq!(short.summary.termination, Termination::NothingToSolve);
        let none = solve(&*solver, &job([Vec::new(), Vec::new()], true, SPAN), &Egg { wall: false });
        assert_eq!(none.summary.termination, Termination::NothingToSolve);
    }
}

/// Empty pictures.
struct Nothing;

impl FrameSource for Nothing {
    fn picture(&self, _frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        Ok(Arc::new(Raster::new(0, 0, [0.0; 3])))
    }
}

#[test]
fn pictures_without_pixels_are_accepted() {
    for (_, solver) in presets() {
        solve(&*solver, &Job { size: (0, 0), ..easy() }, &Nothing);
    }
}

#[test]
fn threads_and_cached_views_change_nothing() {
    for (_, solver) in presets() {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| solve(&*solver, &easy(), &Egg { wall: false }))
        };
        let first = on(1);
        assert_eq!(on(2), first);
        solver.forget_pictures();
        assert_eq!(on(8), first);
    }
}

/// Stops at the `at`-th report.
struct StopAt {
    at: usize,
    reports: AtomicUsize,
}

impl Progress for StopAt {
    fn report(&self, _step: &str, done: f64) -> Result<(), Cancelled> {
        assert!((0.0..=1.0).contains(&done));
        if self.reports.fetch_add(1, Ordering::Relaxed) == self.at { Err(Cancelled) } else { Ok(()) }
    }
}

#[test]
fn every_report_can_cancel() {
    let solver = Agarwala2004::default();
    let run = |at: usize| {
        let progress = StopAt { at, reports: AtomicUsize::new(0) };
        let result = solver.solve(&easy(), &Egg { wall: false }, &progress);
        (result, progress.reports.into_inner())
    };
    let (result, reports) = run(usize::MAX);
    assert!(result.is_ok() && reports > 12, "{reports} reports");
    for at in [0, 4, 12, reports - 1] {
        assert_eq!(run(at).0, Err(TrackError::Cancelled(Cancelled)));
    }
}
