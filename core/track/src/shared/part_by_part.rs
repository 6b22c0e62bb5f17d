//! Tracks parts one after the other, the nearer ones first, because they hide the farther ones.
//!
//! A job needs the tracks of all nearer parts on its frames, so jobs run in waves. A wave contains the jobs whose
//! occluders are known and that share frames with the earliest of them. So a wave works on one stretch of time, and the
//! memory for pictures depends on the spans in work, not on the length of the footage.
//!
//! Parts that change their places in the order may hide each other, on different frames. One of them goes first then, without
//! what the other one hides of it, and is solved a second time when that is known.
//!
//! A job that equals the last solved job of the same part and span is not solved again.

use crate::contract::error::TrackError;
use crate::contract::job::{Job, SpanSolver, SpanTrack};
use crate::contract::tasks::{
    SharedProgress, Task, assemble, is_nearer_on_any, job, nearer_contours, next_wave, tasks,
};
use crate::contract::tracking::{SceneSolver, Tracking};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, FrameSource, Progress, Scene, Span};
use std::collections::BTreeMap;

/// Solves job by job with one solver, and keeps the results.
pub struct PartByPart {
    solver: Box<dyn SpanSolver>,
    /// By name, span and whether it was the second time.
    known: BTreeMap<(String, Span, bool), (Job, SpanTrack)>,
}

/// For each task the track, and whether it was solved in this run.
type Done = Vec<Option<(SpanTrack, bool)>>;

impl SceneSolver for PartByPart {
    fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError> {
        let tasks: Vec<Task> = tasks(scene);
        let shared = SharedProgress::new(progress, scene, &tasks);
        let mut done: Done = vec![None; tasks.len()];
        let waits = |task: &Task, other: &Task| {
            let shared = task.span.first.max(other.span.first)..=task.span.last.min(other.span.last);
            is_nearer_on_any(scene, other.part, task.part, shared)
        };
        let mut early = Vec::new();
        while let Some(wave) = next_wave(scene, &tasks, |t| done[t].is_some(), waits) {
            let is_early = |t: &usize| (0..tasks.len()).any(|o| done[o].is_none() && waits(&tasks[*t], &tasks[o]));
            early.extend(wave.iter().copied().filter(is_early));
            self.solve_all((scene, &tasks), (&wave, false), &mut done, frames, &shared)?;
        }
        for t in early {
            self.solve_all((scene, &tasks), (&[t], true), &mut done, frames, &shared)?;
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

    /// Solves some tasks in parallel, for the first or the second time.
    fn solve_all(
        &mut self,
        (scene, tasks): (&Scene, &[Task]),
        (wave, again): (&[usize], bool),
        done: &mut Done,
        frames: &dyn FrameSource,
        shared: &SharedProgress,
    ) -> Result<(), TrackError> {
        let jobs: Vec<Job> = wave.iter().map(|&t| job(scene, tasks[t], occluders(scene, tasks, done, t))).collect();
        let results: Vec<Result<(SpanTrack, bool), TrackError>> = wave
            .par_iter()
            .zip(&jobs)
            .map(|(&t, job)| {
                let result = self.solve((job, again), frames, &shared.of(t))?;
                shared.of(t).report("Tracking", 1.0)?;
                Ok(result)
            })
            .collect();
        for ((&t, job), result) in wave.iter().zip(jobs).zip(results) {
            let (track, solved) = result?;
            self.known.insert((job.name.clone(), job.span, again), (job, track.clone()));
            let before = done[t].as_ref().is_some_and(|(_, solved)| *solved);
            done[t] = Some((track, solved || before));
        }
        Ok(())
    }

    fn solve(
        &self,
        (job, again): (&Job, bool),
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<(SpanTrack, bool), TrackError> {
        match self.known.get(&(job.name.clone(), job.span, again)) {
            Some((known, track)) if known == job => Ok((track.clone(), false)),
            _ => Ok((self.solver.solve(job, frames, progress)?, true)),
        }
    }
}

/// The contours that hide a task's part, for each frame of its span.
fn occluders(scene: &Scene, tasks: &[Task], done: &Done, t: usize) -> Vec<Vec<Vec<Point>>> {
    let on = |frame: FrameNumber| {
        nearer_contours(scene, tasks, (tasks[t].part, frame), |o| {
            let (track, _) = done[o].as_ref()?;
            Some(track.points[(frame - tasks[o].span.first) as usize].clone())
        })
    };
    tasks[t].span.frames().map(on).collect()
}
