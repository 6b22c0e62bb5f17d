//! The pools of all parts, as far as they have to be made again.
//!
//! Each of the [three steps](super::pooling) that make a pool is a pure function of its input. So its last result is kept, and
//! taken where the input is the same.

use super::joint::figure::claims::Claims;
use super::joint::lead::Lead;
use super::mend::{Guide, Known};
use super::pooled::Pooled;
use super::pooling::{corrected_pools, mended_pools, plain_pools};
use super::stage::Kit;
use super::{Looks, Mended, Rototoon};
use crate::contract::error::TrackError;
use crate::contract::job::Job;
use crate::contract::tasks::{SharedProgress, Task, is_nearer, job, nearer_contours, next_wave};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Scene};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The pools of a job without and with its corrections, and whether any of them was computed in this run.
pub(super) type FoundPools = (Arc<Pooled>, Arc<Pooled>, bool);

impl Rototoon {
    /// Makes the pools of some tasks: all those of some stretches. `pooled` gets them, and `fresh` whether they were computed in this run.
    pub(super) fn pool_all(
        &mut self,
        (scene, tasks, asked): (&Scene, &[Task], &[usize]),
        (pooled, fresh): (&mut [Option<Arc<Pooled>>], &mut [bool]),
        frames: &Looks,
        shared: &SharedProgress,
    ) -> Result<(), TrackError> {
        // The contours of nearer parts on a task's keys must be known, also where these parts are between two keys of
        // their own.
        let within = |o: &Task, frame: FrameNumber| o.span.first < frame && frame < o.span.last;
        let waits = |task: &Task, other: &Task| {
            let hides = |frame| within(other, frame) && is_nearer(scene, other.part, task.part, frame);
            scene.parts[other.part].closed && (hides(task.span.first) || hides(task.span.last))
        };
        let asked: BTreeSet<usize> = asked.iter().copied().collect();
        while let Some(wave) = next_wave(scene, tasks, |t| !asked.contains(&t) || pooled[t].is_some(), waits) {
            let jobs: Vec<Job> = wave
                .iter()
                .map(|&t| job(scene, tasks[t], occluders(scene, tasks, |o| pooled[o].as_deref(), tasks[t])))
                .collect();
            let results: Vec<Result<FoundPools, TrackError>> = wave
                .par_iter()
                .with_max_len(1)
                .zip(&jobs)
                .map(|(&t, job)| {
                    let progress = shared.of(t);
                    let kit = self.kit(frames, &progress);
                    let result = self.pool(kit, job)?;
                    kit.progress.report("Tracking", 0.8)?;
                    Ok(result)
                })
                .collect();
            for (t, result) in wave.into_iter().zip(results) {
                let (plain, with_corrections, solved) = result?;
                let key = plain.key();
                self.plain.insert(key.clone(), plain);
                self.corrected.insert(key, with_corrections.clone());
                (pooled[t], fresh[t]) = (Some(with_corrections), solved);
            }
        }
        Ok(())
    }

    /// The pools of a stretch's members with the hypotheses that their joint choice adds.
    pub(super) fn mend_all(
        &mut self,
        stretch: &[usize],
        pooled: &[Arc<Pooled>],
        (paths, leads, claims): (&[Vec<usize>], &[Vec<Lead>], Option<&Claims>),
        frames: &Looks,
        shared: &SharedProgress,
    ) -> Result<Vec<Arc<Pooled>>, TrackError> {
        let members: Vec<usize> = (0..stretch.len()).collect();
        let mended: Vec<Result<Mended, TrackError>> = members
            .par_iter()
            .with_max_len(1)
            .map(|&m| {
                let source = &pooled[m];
                let key = source.key();
                let guide = Guide::new(source, &paths[m], &leads[m], claims);
                let known = self.mended.get(&key);
                let unmoved = known.filter(|known| Arc::ptr_eq(&known.source, source));
                if let Some(known) = unmoved.filter(|known| known.guide == guide) {
                    return Ok(known.clone());
                }
                let progress = shared.of(stretch[m]);
                let kit = self.kit(frames, &progress);
                let before = known.map(|Mended { source, guide, extended, .. }| Known { source, guide, extended });
                let (result, extended) = mended_pools(kit, source, &guide, before)?;
                let unchanged = unmoved.filter(|known| Arc::ptr_eq(&known.result.pools, &extended.pools));
                let result = unchanged.map_or_else(|| Arc::new(result), |known| known.result.clone());
                Ok(Mended { source: source.clone(), guide, extended, result })
            })
            .collect();
        let mut results = Vec::new();
        for mended in mended {
            let mended = mended?;
            results.push(mended.result.clone());
            self.mended.insert(mended.source.key(), mended);
        }
        Ok(results)
    }

    /// The pools of a job without and with its corrections, and whether any of them was computed in this run.
    pub(super) fn pool(&self, kit: Kit, job: &Job) -> Result<FoundPools, TrackError> {
        let key = (job.name.clone(), job.span);
        let bare = Job { corrections: BTreeMap::new(), ..job.clone() };
        let (plain, mut solved) = match self.plain.get(&key) {
            Some(known) if known.job == bare => (known.clone(), false),
            _ => (Arc::new(plain_pools(kit, bare)?), true),
        };
        if job.corrections.is_empty() || plain.models.is_none() {
            return Ok((plain.clone(), plain, solved));
        }
        let with_corrections = match self.corrected.get(&key) {
            Some(known) if known.job == *job => known.clone(),
            _ => {
                solved = true;
                Arc::new(corrected_pools(kit, job, &plain)?)
            }
        };
        Ok((plain, with_corrections, solved))
    }
}

/// The contours that hide a task's part on its keys. A nearer part between two keys of its own is where its own choice
/// puts it.
pub(super) fn occluders<'a>(
    scene: &Scene,
    tasks: &[Task],
    pooled: impl Fn(usize) -> Option<&'a Pooled>,
    task: Task,
) -> Vec<Vec<Vec<Point>>> {
    let Task { part, span } = task;
    let on = |frame: FrameNumber| {
        nearer_contours(scene, tasks, (part, frame), |o| {
            Some(pooled(o)?.own_points((frame - tasks[o].span.first) as usize))
        })
    };
    let mut occluders = vec![Vec::new(); span.len()];
    occluders[0] = on(span.first);
    occluders[span.len() - 1] = on(span.last);
    occluders
}
