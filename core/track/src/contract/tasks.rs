//! The tasks of a scene (each part over each of its spans), their shared progress, and the assembly of their results.

use super::job::{Correction, Job, SpanTrack};
use crate::contract::tracking::{JobReport, PartTrack, Tracking};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Cancelled, FrameNumber, Part, Progress, Scene, Span};
use std::ops::RangeInclusive;
use std::sync::Mutex;

/// A part over a span, before its occluders are known.
#[derive(Clone, Copy)]
pub(crate) struct Task {
    pub part: usize,
    pub span: Span,
}

/// All tasks of a scene, in the order of parts, then spans.
pub(crate) fn tasks(scene: &Scene) -> Vec<Task> {
    let of_part =
        |(part, p): (usize, &Part)| p.spans().into_iter().map(move |span| Task { part, span }).collect::<Vec<_>>();
    scene.parts.iter().enumerate().flat_map(of_part).collect()
}

/// The tasks to do next: of those that wait for no other, the ones that share frames with the earliest. `None` if all
/// tasks are done.
///
/// `waits(t, o)` says whether task t needs the result of the unfinished task o, whose part is nearer on some frame. Parts
/// that change their places in the order may wait for each other. Then those with the largest `depth` go first.
pub(crate) fn next_wave(
    scene: &Scene,
    tasks: &[Task],
    is_done: impl Fn(usize) -> bool,
    waits: impl Fn(&Task, &Task) -> bool,
) -> Option<Vec<usize>> {
    let open: Vec<usize> = (0..tasks.len()).filter(|&t| !is_done(t)).collect();
    let ready = first_of(&open, |t| scene.parts[tasks[t].part].depth, |t, o| waits(&tasks[t], &tasks[o]));
    let &earliest = ready.iter().min_by_key(|&&t| tasks[t].span)?;
    Some(ready.into_iter().filter(|&t| overlap(tasks[t].span, tasks[earliest].span)).collect())
}

/// Those that wait for none of the others, in their order. If all wait, those with the largest depth.
pub(crate) fn first_of(
    open: &[usize],
    depth: impl Fn(usize) -> f64,
    waits: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    let held_up = |t: usize| open.iter().any(|&o| waits(t, o));
    let ready: Vec<usize> = open.iter().copied().filter(|&t| !held_up(t)).collect();
    if !ready.is_empty() {
        return ready;
    }
    let largest = open.iter().map(|&t| depth(t)).max_by(f64::total_cmp);
    open.iter().copied().filter(|&t| Some(depth(t)) == largest).collect()
}

/// Whether part `a` is nearer than part `b` on a frame.
pub(crate) fn is_nearer(scene: &Scene, a: usize, b: usize, frame: FrameNumber) -> bool {
    scene.parts[a].depth_at(frame) > scene.parts[b].depth_at(frame)
}

/// Whether part `a` is nearer than part `b` on any of some frames.
pub(crate) fn is_nearer_on_any(scene: &Scene, a: usize, b: usize, mut frames: RangeInclusive<FrameNumber>) -> bool {
    let same_on_all = [a, b].iter().all(|&p| scene.parts[p].depths.is_empty());
    match same_on_all {
        true => !frames.is_empty() && scene.parts[a].depth > scene.parts[b].depth,
        false => frames.any(|frame| is_nearer(scene, a, b, frame)),
    }
}

/// The closed contours nearer than a part on a frame: the key if the frame has one, otherwise the result of `tracked`
/// for the task whose span contains the frame. A part hides nothing where it is absent.
pub(crate) fn nearer_contours(
    scene: &Scene,
    tasks: &[Task],
    (part, frame): (usize, FrameNumber),
    tracked: impl Fn(usize) -> Option<Vec<Point>>,
) -> Vec<Vec<Point>> {
    let depth = scene.parts[part].depth_at(frame);
    let hides = |p: &Part| p.closed && p.depth_at(frame) > depth && p.point_count() > 2 && !p.is_absent(frame);
    let nearer = scene.parts.iter().enumerate().filter(|(_, p)| hides(p));
    let contour = |(index, p): (usize, &Part)| {
        let holds = |t: &Task| t.part == index && t.span.first < frame && frame < t.span.last;
        p.keys.get(&frame).cloned().or_else(|| tracked(tasks.iter().position(holds)?))
    };
    nearer.filter_map(contour).collect()
}

/// Whether two spans share frames.
pub(crate) fn overlap(a: Span, b: Span) -> bool {
    a.first <= b.last && b.first <= a.last
}

/// The job of a task. `occluders` are those of [`Job`].
pub(crate) fn job(scene: &Scene, task: Task, occluders: Vec<Vec<Vec<Point>>>) -> Job {
    let Task { part, span } = task;
    let subject = &scene.parts[part];
    let absent = |index: &usize| subject.is_absent(span.first + *index as FrameNumber);
    let corrections = (1..span.len() - 1).filter(|index| !absent(index)).filter_map(|index| {
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
        absent: (1..span.len() - 1).filter(absent).collect(),
        occluders,
        size: (scene.footage.width, scene.footage.height),
    }
}

/// The tracks of all parts, from the tracks of their spans.
pub(crate) fn assemble(scene: &Scene, tasks: &[Task], done: Vec<Option<(SpanTrack, bool)>>) -> Tracking {
    let mut tracking = Tracking { parts: vec![PartTrack::default(); scene.parts.len()], ..Tracking::default() };
    for (task, result) in tasks.iter().zip(done) {
        let Some((track, solved)) = result else { continue };
        let part = &mut tracking.parts[task.part];
        let is_there = |(frame, _): &(FrameNumber, _)| !scene.parts[task.part].is_absent(*frame);
        part.tracks.extend(task.span.frames().zip(track.points).filter(is_there));
        let is_there = |(frame, _): &(FrameNumber, _)| !scene.parts[task.part].is_absent(*frame);
        part.confidence.extend(task.span.frames().zip(track.confidence).filter(is_there));
        tracking.jobs.push(JobReport { part: task.part, span: task.span, summary: track.summary, solved });
    }
    tracking
}

/// Counts the finished steps of one kind that run in parallel.
pub(crate) struct Steps<'a> {
    listener: &'a dyn Progress,
    name: &'static str,
    all: usize,
    done: Mutex<usize>,
}

impl<'a> Steps<'a> {
    pub fn new(listener: &'a dyn Progress, name: &'static str, all: usize) -> Self {
        Self { listener, name, all, done: Mutex::new(0) }
    }

    /// Does one step, and reports before and after it.
    pub fn step<T, E: From<Cancelled>>(&self, work: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        self.tell(0)?;
        let result = work()?;
        self.tell(1)?;
        Ok(result)
    }

    fn tell(&self, more: usize) -> Result<(), Cancelled> {
        // The listener is called under the lock, so that the reported share never decreases.
        let mut done = self.done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        *done += more;
        self.listener.report(self.name, *done as f64 / self.all.max(1) as f64)
    }
}

/// Adds up the progress of jobs that run in parallel. The weight of a job grows with its number of points and frames.
pub(crate) struct SharedProgress<'a> {
    listener: &'a dyn Progress,
    weights: Vec<f64>,
    /// By job: the share of its work that is done once its pictures are read.
    reading: Vec<f64>,
    done: Mutex<Vec<f64>>,
}

impl<'a> SharedProgress<'a> {
    pub fn new(listener: &'a dyn Progress, scene: &Scene, tasks: &[Task]) -> Self {
        let weight = |t: &Task| ((t.span.len() - 1) * (scene.parts[t.part].point_count() + 8)) as f64;
        let weights: Vec<f64> = tasks.iter().map(weight).collect();
        let total: f64 = weights.iter().sum();
        let weights = weights.into_iter().map(|w| w / total).collect();
        let none = vec![0.0; tasks.len()];
        Self { listener, weights, reading: none.clone(), done: Mutex::new(none) }
    }

    /// The same for jobs that read their pictures first: which share of a job's work that is.
    pub fn with_reading(self, share: impl Fn(usize) -> f64) -> Self {
        Self { reading: (0..self.weights.len()).map(share).collect(), ..self }
    }

    /// The progress of reading the pictures of some jobs.
    pub fn reading<'b>(&'b self, tasks: &'b [usize]) -> ReadingProgress<'b> {
        ReadingProgress { shared: self, tasks }
    }

    /// Notes how much of some jobs is done, and reports the whole.
    fn tell(&self, step: &str, jobs: impl Iterator<Item = (usize, f64)>) -> Result<(), Cancelled> {
        // The listener is called under the lock, so that the reported share never decreases.
        let mut all = self.done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        for (task, done) in jobs {
            all[task] = all[task].max(done.clamp(0.0, 1.0));
        }
        let share: f64 = all.iter().zip(&self.weights).map(|(d, w)| d * w).sum();
        self.listener.report(step, share.min(1.0))
    }

    pub fn of(&self, task: usize) -> JobProgress<'_> {
        JobProgress { shared: self, task }
    }
}

/// The progress of one of these jobs.
pub(crate) struct JobProgress<'a> {
    shared: &'a SharedProgress<'a>,
    task: usize,
}

impl Progress for JobProgress<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        let read = self.shared.reading[self.task];
        self.shared.tell(step, std::iter::once((self.task, read + (1.0 - read) * done.clamp(0.0, 1.0))))
    }
}

/// The progress of reading the pictures of some of these jobs.
pub(crate) struct ReadingProgress<'a> {
    shared: &'a SharedProgress<'a>,
    tasks: &'a [usize],
}

impl Progress for ReadingProgress<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        self.shared.tell(step, self.tasks.iter().map(|&task| (task, self.shared.reading[task] * done)))
    }
}
