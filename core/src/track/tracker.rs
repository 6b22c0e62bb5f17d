//! Order, memory and progress of tracking jobs.
//!
//! A job of a part needs the tracks of all nearer parts on its frames (they hide it), so jobs run in waves: of the jobs
//! whose occluders are known, those that share frames with the earliest of them. A wave works on one stretch of time,
//! which bounds the memory that pictures take by the span in work, not by the length of the footage.
//!
//! A job's result depends on nothing but the job and the pictures, whatever the number of threads. That makes memory
//! simple: a job that equals the one solved before for the same part and span is not solved again.

use super::agarwala2004::Agarwala2004;
use super::job::{Correction, Job, SpanSolver, SpanSummary, SpanTrack};
use super::liang2012::Liang2012;
use super::rototoon::Rototoon;
use super::zhou2011::Zhou2011;
use crate::geometry::Point;
use crate::scene::{Cancelled, Footage, FrameError, FrameNumber, FrameSource, Part, Progress, Scene, Span};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Which method tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The best that Rototoon knows.
    #[default]
    Rototoon,
    /// Zhou & Xiao 2011 as printed.
    Zhou2011,
    /// Agarwala et al. 2004.
    Agarwala2004,
    /// Agarwala et al. 2004 with the ribbon and the colour penalty of Liang et al. 2012.
    Liang2012,
}

impl Preset {
    /// Every preset with its id in documents, parameters and on the command line.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Rototoon, "rototoon"),
        (Self::Zhou2011, "zhou2011"),
        (Self::Agarwala2004, "agarwala2004"),
        (Self::Liang2012, "liang2012"),
    ];

    /// The preset of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(preset, _)| *preset)
    }

    fn solver(self) -> Box<dyn SpanSolver> {
        match self {
            Self::Rototoon => Box::new(Rototoon::default()),
            Self::Zhou2011 => Box::new(Zhou2011::default()),
            Self::Agarwala2004 => Box::new(Agarwala2004::default()),
            Self::Liang2012 => Box::new(Liang2012::default()),
        }
    }
}

/// How to track.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackOptions {
    /// The method.
    pub preset: Preset,
}

/// Why tracking failed. Nothing was changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// A picture could not be had.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Keys of one part differ in their number of points.
    #[error("part {part:?}: the key on frame {frame} has {found} points, but the first key has {expected}")]
    UnequalKeys {
        /// Name of the part.
        part: String,
        /// Frame of the differing key.
        frame: FrameNumber,
        /// Its number of points.
        found: usize,
        /// The number on the first key.
        expected: usize,
    },
    /// A coordinate is no number, or far from any picture.
    #[error("part {part:?}, frame {frame}: found the point {found}, expected pixel coordinates within ±{limit}")]
    OutOfRange {
        /// Name of the part.
        part: String,
        /// Frame of the key, pin or centre.
        frame: FrameNumber,
        /// The point.
        found: Point,
        /// The largest coordinate allowed.
        limit: f64,
    },
    /// A pin names a control point that the part does not have.
    #[error("part {part:?}, frame {frame}: pin of point {index}, but the part has {count} points")]
    NoSuchPoint {
        /// Name of the part.
        part: String,
        /// Frame of the pin.
        frame: FrameNumber,
        /// Index of the point, from 0.
        index: usize,
        /// Number of points of the part.
        count: usize,
    },
}

/// What tracking found, in the order of the scene's parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// One entry a part.
    pub parts: Vec<PartTrack>,
    /// One entry a job, in the order of parts, then spans.
    pub jobs: Vec<JobReport>,
}

/// How one part fared over one span.
#[derive(Clone, Debug, PartialEq)]
pub struct JobReport {
    /// Index of the part in the scene.
    pub part: usize,
    /// The frames, keys included.
    pub span: Span,
    /// What the solver says.
    pub summary: SpanSummary,
    /// Whether it was solved in this run, not remembered from one before.
    pub solved: bool,
}

/// The track of one part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartTrack {
    /// Control points by frame, from the first key to the last.
    pub tracks: BTreeMap<FrameNumber, Vec<Point>>,
    /// Confidence by frame and point, 0 to 1.
    pub confidence: BTreeMap<FrameNumber, Vec<f64>>,
}

/// Tracks scenes, and remembers what it solved from one run to the next.
pub struct Tracker {
    solver: Box<dyn SpanSolver>,
    footage: Option<Footage>,
    known: BTreeMap<(String, Span), (Job, SpanTrack)>,
}

impl Tracker {
    /// A tracker that knows nothing yet.
    pub fn new(options: TrackOptions) -> Self {
        Self::with_solver(options.preset.solver())
    }

    /// A tracker with a solver of the caller's.
    pub fn with_solver(solver: Box<dyn SpanSolver>) -> Self {
        Self { solver, footage: None, known: BTreeMap::new() }
    }

    /// Tracks every part of `scene` between its first and its last key. Runs on the caller's rayon pool.
    ///
    /// Parts with one key have a track on that frame only. After an error the tracker still knows what it knew before.
    pub fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError> {
        scene.parts.iter().try_for_each(check)?;
        if self.footage.as_ref() != Some(&scene.footage) {
            self.forget();
            self.footage = Some(scene.footage.clone());
        }
        let tasks: Vec<Task> = tasks(scene);
        let shared = SharedProgress::new(progress, scene, &tasks);
        let mut done: Vec<Option<(SpanTrack, bool)>> = vec![None; tasks.len()];
        while let Some(wave) = next_wave(&tasks, &done) {
            let jobs: Vec<Job> = wave.iter().map(|&t| job(scene, &tasks, &done, t)).collect();
            let results: Vec<Result<(SpanTrack, bool), TrackError>> = wave
                .par_iter()
                .zip(&jobs)
                .map(|(&t, job)| {
                    let result = self.solve(job, frames, &shared.of(t))?;
                    shared.of(t).report("Tracking", 1.0)?;
                    Ok(result)
                })
                .collect();
            for ((t, job), result) in wave.into_iter().zip(jobs).zip(results) {
                let (track, solved) = result?;
                self.known.insert((job.name.clone(), job.span), (job, track.clone()));
                done[t] = Some((track, solved));
            }
        }
        Ok(assemble(scene, &tasks, done))
    }

    /// Forgets all results and pictures, since the files of the footage have changed.
    pub fn forget(&mut self) {
        self.known.clear();
        self.solver.forget_pictures();
    }

    fn solve(
        &self,
        job: &Job,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<(SpanTrack, bool), TrackError> {
        match self.known.get(&(job.name.clone(), job.span)) {
            Some((known, track)) if known == job => Ok((track.clone(), false)),
            _ => Ok((self.solver.solve(job, frames, progress)?, true)),
        }
    }
}

/// A part over a span, before its occluders are known.
#[derive(Clone, Copy)]
struct Task {
    part: usize,
    span: Span,
    depth: f64,
}

fn tasks(scene: &Scene) -> Vec<Task> {
    let of_part = |(part, p): (usize, &Part)| {
        let depth = p.depth;
        p.spans().into_iter().map(move |span| Task { part, span, depth }).collect::<Vec<_>>()
    };
    scene.parts.iter().enumerate().flat_map(of_part).collect()
}

fn overlap(a: Span, b: Span) -> bool {
    a.first <= b.last && b.first <= a.last
}

/// The tasks to do next, or none when all are done. There is always one that is ready: the nearest part's earliest.
fn next_wave(tasks: &[Task], done: &[Option<(SpanTrack, bool)>]) -> Option<Vec<usize>> {
    let open: Vec<usize> = (0..tasks.len()).filter(|&t| done[t].is_none()).collect();
    let waits =
        |t: usize| open.iter().any(|&o| tasks[o].depth > tasks[t].depth && overlap(tasks[o].span, tasks[t].span));
    let ready: Vec<usize> = open.iter().copied().filter(|&t| !waits(t)).collect();
    let &earliest = ready.iter().min_by_key(|&&t| tasks[t].span)?;
    Some(ready.into_iter().filter(|&t| overlap(tasks[t].span, tasks[earliest].span)).collect())
}

fn job(scene: &Scene, tasks: &[Task], done: &[Option<(SpanTrack, bool)>], t: usize) -> Job {
    let Task { part, span, depth } = tasks[t];
    let subject = &scene.parts[part];
    let occluders = span.frames().map(|frame| occluders(scene, tasks, done, depth, frame)).collect();
    let corrections = (1..span.len() - 1).filter_map(|index| {
        let frame = span.first + index as FrameNumber;
        let pins = subject.pins.get(&frame).cloned().unwrap_or_default();
        let center = subject.centers.get(&frame).copied();
        (!pins.is_empty() || center.is_some()).then_some((index, Correction { pins, center }))
    });
    Job {
        name: subject.name.clone(),
        closed: subject.closed,
        span,
        keys: [subject.keys[&span.first].clone(), subject.keys[&span.last].clone()],
        corrections: corrections.collect(),
        occluders,
        size: (scene.footage.width, scene.footage.height),
    }
}

/// The closed contours nearer than `depth` on a frame: tracked, or as keyed where a part has that key only.
fn occluders(
    scene: &Scene,
    tasks: &[Task],
    done: &[Option<(SpanTrack, bool)>],
    depth: f64,
    frame: FrameNumber,
) -> Vec<Vec<Point>> {
    let nearer = scene.parts.iter().enumerate().filter(|(_, p)| p.closed && p.depth > depth && p.point_count() > 2);
    nearer
        .filter_map(|(index, p)| {
            if let Some(key) = p.keys.get(&frame) {
                return Some(key.clone());
            }
            let on_frame = |t: &Task| t.part == index && t.span.first < frame && frame < t.span.last;
            let task = tasks.iter().position(on_frame)?;
            let (track, _) = done[task].as_ref()?;
            Some(track.points[(frame - tasks[task].span.first) as usize].clone())
        })
        .collect()
}

fn assemble(scene: &Scene, tasks: &[Task], done: Vec<Option<(SpanTrack, bool)>>) -> Tracking {
    let mut tracking = Tracking { parts: vec![PartTrack::default(); scene.parts.len()], jobs: Vec::new() };
    for (task, result) in tasks.iter().zip(done) {
        let Some((track, solved)) = result else { continue };
        let part = &mut tracking.parts[task.part];
        part.tracks.extend(task.span.frames().zip(track.points));
        part.confidence.extend(task.span.frames().zip(track.confidence));
        tracking.jobs.push(JobReport { part: task.part, span: task.span, summary: track.summary, solved });
    }
    for (part, track) in scene.parts.iter().zip(&mut tracking.parts) {
        for (&frame, key) in &part.keys {
            track.tracks.insert(frame, key.clone());
            track.confidence.insert(frame, vec![1.0; key.len()]);
        }
    }
    tracking
}

/// Largest coordinate that is still taken for a place: a hundred times the width of an 8k picture.
const FURTHEST: f64 = 1e6;

fn check(part: &Part) -> Result<(), TrackError> {
    let name = || part.name.clone();
    let expected = part.point_count();
    let in_range = |frame: FrameNumber, points: Vec<Point>| {
        // A comparison that NaN fails.
        match points.into_iter().find(|p| !(p.abs().max_element() <= FURTHEST && p.is_finite())) {
            Some(found) => Err(TrackError::OutOfRange { part: name(), frame, found, limit: FURTHEST }),
            None => Ok(()),
        }
    };
    for (&frame, key) in &part.keys {
        if key.len() != expected {
            return Err(TrackError::UnequalKeys { part: name(), frame, found: key.len(), expected });
        }
        in_range(frame, key.clone())?;
    }
    for (&frame, pins) in &part.pins {
        if let Some((&index, _)) = pins.iter().find(|(index, _)| **index >= expected) {
            return Err(TrackError::NoSuchPoint { part: name(), frame, index, count: expected });
        }
        in_range(frame, pins.values().copied().collect())?;
    }
    part.centers.iter().try_for_each(|(&frame, &center)| in_range(frame, vec![center]))
}

/// Sums the progress of jobs that run side by side; a job weighs as much as it has points and frames.
struct SharedProgress<'a> {
    listener: &'a dyn Progress,
    weights: Vec<f64>,
    done: Mutex<Vec<f64>>,
}

impl<'a> SharedProgress<'a> {
    fn new(listener: &'a dyn Progress, scene: &Scene, tasks: &[Task]) -> Self {
        let weight = |t: &Task| ((t.span.len() - 1) * (scene.parts[t.part].point_count() + 8)) as f64;
        let weights: Vec<f64> = tasks.iter().map(weight).collect();
        let total: f64 = weights.iter().sum();
        let weights = weights.into_iter().map(|w| w / total).collect();
        Self { listener, weights, done: Mutex::new(vec![0.0; tasks.len()]) }
    }

    fn of(&self, task: usize) -> JobProgress<'_> {
        JobProgress { shared: self, task }
    }
}

struct JobProgress<'a> {
    shared: &'a SharedProgress<'a>,
    task: usize,
}

impl Progress for JobProgress<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        // The listener is told under the lock, so that it never sees the share fall.
        let mut all = self.shared.done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        all[self.task] = all[self.task].max(done.clamp(0.0, 1.0));
        let share: f64 = all.iter().zip(&self.shared.weights).map(|(d, w)| d * w).sum();
        self.shared.listener.report(step, share.min(1.0))
    }
}
