//! Tracks parts one after the other, the nearer ones first, because they hide the farther ones.
//!
//! A job needs the tracks of all nearer parts on its frames, so jobs run in waves. A wave contains the jobs whose
//! occluders are known and that share frames with the earliest of them. So a wave works on one stretch of time, and the
//! memory for pictures depends on the spans in work, not on the length of the footage.
//!
//! A job that equals the last solved job of the same part and span is not solved again.

use crate::contract::error::TrackError;
use crate::contract::job::{Job, SpanSolver, SpanTrack};
use crate::contract::tasks::{SharedProgress, Task, assemble, job, nearer_contours, next_wave, overlap, tasks};
use crate::contract::tracking::{SceneSolver, Tracking};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, FrameSource, Progress, Scene, Span};
use std::collections::BTreeMap;

/// Solves job by job with one solver, and keeps the results.
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
        let waits = |task: &Task, other: &Task| overlap(task.span, other.span);
        while let Some(wave) = next_wave(&tasks, |t| done[t].is_some(), waits) {
            let jobs: Vec<Job> =
                wave.iter().map(|&t| job(scene, tasks[t], occluders(scene, &tasks, &done, t))).collect();
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
    /// A part-by-part tracker without any results yet.
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

/// The contours that hide a task's part, for each frame of its span.
fn occluders(scene: &Scene, tasks: &[Task], done: &[Option<(SpanTrack, bool)>], t: usize) -> Vec<Vec<Vec<Point>>> {
    let on = |frame: FrameNumber| {
        nearer_contours(scene, tasks, (tasks[t].depth, frame), |o| {
            let (track, _) = done[o].as_ref()?;
            Some(track.points[(frame - tasks[o].span.first) as usize].clone())
        })
    };
    tasks[t].span.frames().map(on).collect()
}
