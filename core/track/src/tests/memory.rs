//! Which jobs are solved, in which order, and the progress that is reported.

use crate::{Job, SpanSolver, SpanTrack, TrackError, Tracker};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{
    Cancelled, Colour, Footage, FrameError, FrameNumber, FrameSource, Part, Progress, Raster, Scene, Silent,
};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Interpolates, and records the jobs in the order of their arrival.
#[derive(Clone, Default)]
struct Recorder(Arc<Mutex<Vec<Job>>>);

impl SpanSolver for Recorder {
    fn solve(&self, job: &Job, _: &dyn FrameSource, progress: &dyn Progress) -> Result<SpanTrack, TrackError> {
        progress.report("Recording", 0.5)?;
        self.0.lock().unwrap().push(job.clone());
        Ok(job.keys_only())
    }

    fn forget_pictures(&self) {}
}

struct NoFrames;

impl FrameSource for NoFrames {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        Err(FrameError::Outside { frame, first: 0, last: 0 })
    }
}

fn part(name: &str, depth: f64, keys: &[FrameNumber]) -> Part {
    let square = |at: f64| [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)].map(|(x, y)| Point::new(x + at, y)).to_vec();
    let keys = keys.iter().map(|&f| (f, square(f64::from(f)))).collect();
    Part { name: name.into(), closed: true, depth, keys, ..Part::default() }
}

fn scene(parts: Vec<Part>) -> Scene {
    let footage =
        Footage { pattern: "%d.png".into(), first: 0, last: 20, fps: 12.0, width: 64, height: 48, held: false };
    Scene { footage, parts }
}

fn solved(tracker: &mut Tracker, scene: &Scene) -> Vec<(usize, FrameNumber)> {
    let tracking = tracker.track(scene, &NoFrames, &Silent).unwrap();
    tracking.jobs.iter().filter(|job| job.solved).map(|job| (job.part, job.span.first)).collect()
}

#[test]
fn only_touched_spans_are_solved_again() {
    let recorder = Recorder::default();
    let mut tracker = Tracker::with_solver(Box::new(recorder.clone()));
    let mut scene = scene(vec![part("far", 0.0, &[0, 8, 16]), part("near", 1.0, &[0, 8, 16])]);
    assert_eq!(solved(&mut tracker, &scene), [(0, 0), (0, 8), (1, 0), (1, 8)]);
    assert_eq!(solved(&mut tracker, &scene), []);

    scene.parts[0].pins.insert(4, BTreeMap::from([(1, Point::new(30.0, 2.0))]));
    assert_eq!(solved(&mut tracker, &scene), [(0, 0)]);
    // The occluder of the far part has moved, in one span.
    scene.parts[1].pins.insert(11, BTreeMap::from([(1, Point::new(30.0, 2.0))]));
    assert_eq!(solved(&mut tracker, &scene), [(0, 8), (1, 8)]);
    // A key in the middle of a span replaces it by two spans.
    let key = scene.parts[0].keys[&8].clone();
    scene.parts[0].keys.insert(12, key);
    assert_eq!(solved(&mut tracker, &scene), [(0, 8), (0, 12)]);
    tracker.forget();
    assert_eq!(solved(&mut tracker, &scene).len(), 5);
}

#[test]
fn nearer_parts_come_first_and_hide_the_farther_ones() {
    let recorder = Recorder::default();
    let mut tracker = Tracker::with_solver(Box::new(recorder.clone()));
    let scene = scene(vec![part("far", 0.0, &[2, 6]), part("near", 2.0, &[0, 10]), part("level", 2.0, &[3, 5])]);
    tracker.track(&scene, &NoFrames, &Silent).unwrap();
    let jobs = recorder.0.lock().unwrap();
    assert_eq!(jobs.last().unwrap().name, "far");
    for job in jobs.iter() {
        let expected: &[usize] = if job.name == "far" { &[1, 2, 2, 2, 1] } else { &[0; 11] };
        let counts: Vec<usize> = job.occluders.iter().map(Vec::len).collect();
        assert_eq!(counts, expected[..job.span.len()], "{}", job.name);
    }
}

#[test]
fn parts_that_change_their_places_hide_each_other_in_turn() {
    let recorder = Recorder::default();
    let mut tracker = Tracker::with_solver(Box::new(recorder.clone()));
    let mut arm = part("arm", 0.0, &[0, 6]);
    arm.depths = (4..=6).map(|frame| (frame, 2.0)).collect();
    let scene = scene(vec![arm, part("body", 1.0, &[0, 6]), part("ground", -1.0, &[0, 6])]);
    assert_eq!(solved(&mut tracker, &scene), [(0, 0), (1, 0), (2, 0)]);
    let jobs: Vec<(String, Vec<usize>)> = std::mem::take(&mut *recorder.0.lock().unwrap())
        .into_iter()
        .map(|job| (job.name, job.occluders.iter().map(Vec::len).collect()))
        .collect();
    let expected: [(&str, [usize; 7]); 4] = [
        ("body", [0, 0, 0, 0, 0, 0, 1]),
        ("arm", [1, 1, 1, 1, 0, 0, 0]),
        ("ground", [2; 7]),
        ("body", [0, 0, 0, 0, 1, 1, 1]),
    ];
    assert_eq!(jobs, expected.map(|(name, counts)| (name.to_owned(), counts.to_vec())));
    assert_eq!(solved(&mut tracker, &scene), []);
    assert!(recorder.0.lock().unwrap().is_empty(), "both times are remembered");
}

#[test]
fn a_part_hides_nothing_where_it_is_absent() {
    let recorder = Recorder::default();
    let mut near = part("near", 2.0, &[0, 10]);
    near.absent = vec![[3, 5]];
    let scene = scene(vec![part("far", 0.0, &[2, 6]), near]);
    Tracker::with_solver(Box::new(recorder.clone())).track(&scene, &NoFrames, &Silent).unwrap();
    let jobs = recorder.0.lock().unwrap();
    let far = jobs.iter().find(|job| job.name == "far").expect("a job");
    assert_eq!(far.occluders.iter().map(Vec::len).collect::<Vec<_>>(), [1, 0, 0, 0, 1]);
    assert!(jobs.iter().all(|job| job.absent.is_empty() == (job.name == "far")));
}

#[test]
fn parts_without_a_span_keep_their_keys() {
    let mut tracker = Tracker::with_solver(Box::new(Recorder::default()));
    let scene = scene(vec![part("none", 0.0, &[]), part("one", 0.0, &[7])]);
    let tracking = tracker.track(&scene, &NoFrames, &Silent).unwrap();
    assert!(tracking.parts[0].tracks.is_empty());
    assert_eq!(tracking.parts[1].tracks, scene.parts[1].keys);
}

#[test]
fn bad_parts_are_named() {
    let mut tracker = Tracker::with_solver(Box::new(Recorder::default()));
    let mut track = |change: &dyn Fn(&mut Part)| {
        let mut part = part("arm", 0.0, &[0, 5]);
        change(&mut part);
        tracker.track(&scene(vec![part]), &NoFrames, &Silent).unwrap_err().to_string()
    };
    let message = track(&|p| p.keys.get_mut(&5).unwrap().truncate(2));
    assert_eq!(message, "part \"arm\": the key on frame 5 has 2 points, but the first key has 3");
    assert!(track(&|p| p.keys.get_mut(&5).unwrap()[1].x = f64::NAN).starts_with("part \"arm\", frame 5: "));
    assert!(track(&|p| p.keys.get_mut(&0).unwrap()[1].y = 1e9).starts_with("part \"arm\", frame 0: "));
    let pinned = |p: &mut Part| p.pins = BTreeMap::from([(3, BTreeMap::from([(3, Point::ZERO)]))]);
    assert_eq!(track(&pinned), "part \"arm\", frame 3: found a pin of point 3, expected an index below 3");
    assert!(track(&|p| p.centers = BTreeMap::from([(2, Point::NAN)])).starts_with("part \"arm\", frame 2: "));
}

struct Listener {
    told: Mutex<Vec<f64>>,
    stop_after: usize,
}

impl Progress for Listener {
    fn report(&self, _: &str, done: f64) -> Result<(), Cancelled> {
        let mut told = self.told.lock().unwrap();
        told.push(done);
        if told.len() > self.stop_after { Err(Cancelled) } else { Ok(()) }
    }
}

#[test]
fn progress_rises_to_the_end_and_a_cancelled_run_keeps_earlier_results() {
    let mut tracker = Tracker::with_solver(Box::new(Recorder::default()));
    let scene = scene((0..5).map(|k| part(&format!("part {k}"), f64::from(k), &[0, 8, 16])).collect());
    let stopped = Listener { told: Mutex::default(), stop_after: 7 };
    assert_eq!(tracker.track(&scene, &NoFrames, &stopped), Err(TrackError::Cancelled(Cancelled)));
    let listener = Listener { told: Mutex::default(), stop_after: usize::MAX };
    let tracking = tracker.track(&scene, &NoFrames, &listener).unwrap();
    assert!(tracking.jobs.iter().any(|job| !job.solved), "the finished jobs of the stopped run are kept");
    let told = listener.told.lock().unwrap();
    assert!(told.windows(2).all(|pair| pair[0] <= pair[1]));
    assert!((told.last().unwrap() - 1.0).abs() < 1e-9);
}
