//! The default tracker: deformable texture lattices, carried from both keys.
//!
//! Each key gives a [`Model`]: the part's colours on a lattice that bends. Both are carried drawing by drawing through
//! the span, one forwards and one backwards ([`propagate`](super::propagate)), each always compared with its own key.
//! The poses on a drawing make a pool; [`select`](super::select) picks the path through the pools that explains the
//! pictures best and moves smoothly; where the other key's model agrees with the choice, the two are blended.
//!
//! Why: cartoons have flat colours and hard lines, so that a part's look at a key says nearly everything about it; a
//! chain that compares with the key cannot drift; going both ways covers what appears or is hidden on one side.
//! Artist's corrections are constraints of the alignment, so the poses around them follow.

use super::job::{Job, SpanSolver, SpanSummary, SpanTrack, Termination};
use super::pool::{self, Hypothesis, Pools};
use super::stage::Stage;
use super::store::Store;
use super::{TrackError, confidence};
use crate::geometry::Point;
use crate::scene::{FrameSource, Progress};
use std::sync::atomic::Ordering;

/// The default preset's solver.
#[derive(Default)]
pub struct Rototoon {
    store: Store,
}

/// Distance in working pixels at which the other key's model is no longer taken to mean the same place.
const AGREEMENT: f64 = 4.0;

impl SpanSolver for Rototoon {
    fn solve(&self, job: &Job, frames: &dyn FrameSource, progress: &dyn Progress) -> Result<SpanTrack, TrackError> {
        if job.span.len() == 2 || job.keys[0].is_empty() {
            return Ok(keys_only(job));
        }
        let stage = Stage::set(&self.store, job, frames, progress)?;
        let (pools, path) = pool::fill(&stage)?;
        Ok(track(&stage, &pools, &path))
    }

    fn forget_pictures(&self) {
        self.store.clear();
    }
}

/// A span without frames between its keys (or a part without points): nothing to solve.
pub(super) fn keys_only(job: &Job) -> SpanTrack {
    let mut points: Vec<Vec<Point>> = (0..job.span.len()).map(|i| job.interpolated(i)).collect();
    points.iter_mut().enumerate().for_each(|(i, p)| job.enforce(i, p));
    let confidence = points.iter().map(|p| vec![1.0; p.len()]).collect();
    let summary =
        SpanSummary { termination: Termination::NothingToSolve, iterations: 0, initial_cost: 0.0, final_cost: 0.0 };
    SpanTrack { points, confidence, summary }
}

/// The chosen control points of a drawing: those of the other model are blended in where they agree, by how near
/// its key is.
fn blended(pool: &[Hypothesis], chosen: usize, share: f64) -> Vec<Point> {
    let own = &pool[chosen];
    let others = pool.iter().filter(|h| h.model != own.model);
    let Some(other) = others.min_by(|a, b| a.distance(own).total_cmp(&b.distance(own))) else {
        return own.points.clone();
    };
    if other.pose.energy >= 1.5 * own.pose.energy + 0.005 {
        return own.points.clone();
    }
    let nearness = if other.model == 1 { share } else { 1.0 - share };
    let blend = |(a, b): (&Point, &Point)| {
        let apart = a.distance(*b) / AGREEMENT;
        a.lerp(*b, nearness * (-apart * apart).exp())
    };
    own.points.iter().zip(&other.points).map(blend).collect()
}

fn track(stage: &Stage, pools: &Pools, path: &[usize]) -> SpanTrack {
    let last = stage.job.span.len() - 1;
    let (mut points, mut sure) = (Vec::new(), Vec::new());
    for (d, drawing) in stage.drawings.iter().enumerate() {
        let share = drawing.first as f64 / last as f64;
        let found = blended(&pools[d], path[d], share);
        let confidence =
            confidence::of_drawing(&stage.models, &stage.features[d], &stage.covers[d], &pools[d], path[d]);
        for index in drawing.first..=drawing.last {
            let mut on_frame = stage.key_of(d).unwrap_or_else(|| found.iter().map(|&p| p * stage.scale).collect());
            stage.job.enforce(index, &mut on_frame);
            points.push(on_frame);
            sure.push(if index == 0 || index == last { vec![1.0; found.len()] } else { confidence.clone() });
        }
    }
    for (&index, correction) in &stage.job.corrections {
        correction.pins.keys().for_each(|&j| sure[index][j] = 1.0);
    }
    let energy = |choose: &dyn Fn(usize) -> usize| {
        (0..pools.len()).map(|d| pools[d][choose(d)].pose.energy).sum::<f64>() / pools.len() as f64
    };
    let summary = SpanSummary {
        termination: Termination::PathChosen,
        iterations: stage.steps_done.load(Ordering::Relaxed),
        initial_cost: energy(&|_| 0),
        final_cost: energy(&|d| path[d]),
    };
    SpanTrack { points, confidence: sure, summary }
}
