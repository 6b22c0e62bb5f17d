//! Parts tracked one after the other, the nearer ones first, since they hide the farther ones.
//!
//! A job of a part needs the tracks of all nearer parts on its frames, so jobs run in waves: of the jobs whose occluders
//! are known, those that share frames with the earliest of them. A wave works on one stretch of time, which bounds the
//! memory that pictures take by the span in work, not by the length of the footage.
//!
//! A job that equals the one solved before for the same part and span is not solved again.

use super::job::{Job, SpanSolver, SpanTrack};
use super::tasks::{SharedProgress, Task, assemble, job, overlap, tasks};
use super::tracker::{SceneSolver, TrackError, Tracking};
use crate::geometry::Point;
use crate::scene::{FrameNumber, FrameSource, Progress, Scene, Span};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;

/// Solves job by job with one solver, and remembers the results.
pub struct PartByPart {
    solver: Box<dyn SpanSolver>,
    known: BTreeMap<(String, Span), (Job, SpanTrack)>,
}

impl SceneSolver for PartByPart {
    fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError> {
        let tasks: Vec<Task> = tasks(scene);
        let shared = SharedProgress::new(progress, scene, &tasks);
        let mut done: Vec<Option<(SpanTrack, bool)>> = vec![None; tasks.len()];
        while let Some(wave) = next_wave(&tasks, &done) {
            let jobs: Vec<Job> =
                wave.iter().map(|&t| job(scene, tasks[t], occluders_of(scene, &tasks, &done, t))).collect();
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

    fn forget(&mut self) {
        self.known.clear();
        self.solver.forget_pictures();
    }
}

impl PartByPart {
    /// A solver that knows nothing yet.
    pub fn new(solver: Box<dyn SpanSolver>) -> Self {
        Self { solver, known: BTreeMap::new() }
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

/// The tasks to do next, or none when all are done. There is always one that is ready: the nearest part's earliest.
fn next_wave(tasks: &[Task], done: &[Option<(SpanTrack, bool)>]) -> Option<Vec<usize>> {
    let open: Vec<usize> = (0..tasks.len()).filter(|&t| done[t].is_none()).collect();
    let waits =
        |t: usize| open.iter().any(|&o| tasks[o].depth > tasks[t].depth && overlap(tasks[o].span, tasks[t].span));
    let ready: Vec<usize> = open.iter().copied().filter(|&t| !waits(t)).collect();
    let &earliest = ready.iter().min_by_key(|&&t| tasks[t].span)?;
    Some(ready.into_iter().filter(|&t| overlap(tasks[t].span, tasks[earliest].span)).collect())
}

fn occluders_of(scene: &Scene, tasks: &[Task], done: &[Option<(SpanTrack, bool)>], t: usize) -> Vec<Vec<Vec<Point>>> {
    tasks[t].span.frames().map(|frame| occluders(scene, tasks, done, tasks[t].depth, frame)).collect()
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
