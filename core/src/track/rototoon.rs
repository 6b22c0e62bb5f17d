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

use super::drawings::{Drawing, group, same_drawing};
use super::features::{Features, working_scale};
use super::job::{Job, SpanSolver, SpanSummary, SpanTrack, Termination};
use super::lattice::align::Aligner;
use super::lattice::anchors::Anchors;
use super::lattice::mesh::Mesh;
use super::lattice::texture::{Cover, Texture};
use super::propagate::{Model, Pose, Scenery, chain};
use super::select::{Candidate, best_path};
use super::store::Store;
use super::{TrackError, confidence};
use crate::geometry::Point;
use crate::scene::{FrameNumber, FrameSource, Progress};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

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
        let pools = stage.pools()?;
        let path = stage.path(&pools);
        Ok(stage.track(&pools, &path))
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

/// A hypothesis of the pool of a drawing.
pub struct Hypothesis {
    /// Which key's model it poses: 0 or 1.
    pub model: usize,
    /// The pose.
    pub pose: Pose,
    /// Where it puts the control points, in working pixels.
    pub points: Vec<Point>,
}

impl Hypothesis {
    fn candidate(&self) -> Candidate<'_> {
        Candidate { energy: self.pose.energy, points: &self.points }
    }
}

/// Everything that a job is solved with.
struct Stage<'a> {
    job: &'a Job,
    frames: &'a dyn FrameSource,
    store: &'a Store,
    progress: &'a dyn Progress,
    scale: f64,
    drawings: Vec<Drawing>,
    features: Vec<Arc<Features>>,
    covers: Vec<Cover>,
    models: [Model; 2],
    anchors: [Vec<Anchors>; 2],
    steps_done: AtomicUsize,
}

impl<'a> Stage<'a> {
    fn set(
        store: &'a Store,
        job: &'a Job,
        frames: &'a dyn FrameSource,
        progress: &'a dyn Progress,
    ) -> Result<Self, TrackError> {
        let scale = working_scale(job.size.1);
        let width = job.size.0 as f64 / scale;
        let numbers: Vec<FrameNumber> = job.span.frames().collect();
        let features: Vec<Arc<Features>> = numbers
            .par_iter()
            .map(|&frame| {
                progress.report("Reading frames", 0.0)?;
                store.features(frames, frame)
            })
            .collect::<Result<_, _>>()?;
        let held: Vec<bool> = features.par_windows(2).map(|pair| same_drawing(&pair[0], &pair[1])).collect();
        let drawings = group(job, |i| held[i]);
        let features: Vec<Arc<Features>> = drawings.iter().map(|d| features[d.first].clone()).collect();
        let working = |contour: &[Point]| contour.iter().map(|&p| p / scale).collect::<Vec<_>>();
        let cover_of = |index: usize| {
            let contours: Vec<Vec<Point>> = job.occluders[index].iter().map(|c| working(c)).collect();
            Cover::new(&contours, width)
        };
        let last = job.span.len() - 1;
        let covers: Vec<Cover> = drawings.iter().map(|d| cover_of(d.first)).collect();
        let model = |key: usize| {
            let mesh = Mesh::new(&working(&job.keys[key]), job.closed);
            let (features, cover) =
                if key == 0 { (&features[0], cover_of(0)) } else { (&features[features.len() - 1], cover_of(last)) };
            let texture = Texture::new(mesh, features, &cover, width);
            Model { aligner: Aligner::new(&texture.mesh), texture }
        };
        let models = [model(0), model(1)];
        let anchors = [0, 1].map(|key: usize| {
            let of_drawing = |d: &Drawing| {
                let correction = (d.first..=d.last).find_map(|i| job.corrections.get(&i));
                correction.map_or_else(Anchors::default, |c| Anchors::new(&models[key].texture.mesh, c, scale))
            };
            drawings.iter().map(of_drawing).collect()
        });
        let steps_done = AtomicUsize::new(0);
        Ok(Self { job, frames, store, progress, scale, drawings, features, covers, models, anchors, steps_done })
    }

    fn scenery(&self, model: usize, drawing: usize) -> Scenery<'_> {
        Scenery {
            features: &self.features[drawing],
            cover: &self.covers[drawing],
            anchors: &self.anchors[model][drawing],
        }
    }

    fn frame_of(&self, drawing: usize) -> FrameNumber {
        self.job.span.first + self.drawings[drawing].first as FrameNumber
    }

    /// Carries a pose from one drawing to a neighbouring one.
    fn carry(
        &self,
        model: usize,
        pose: &[Point],
        moved: Option<&[Point]>,
        from: usize,
        to: usize,
    ) -> Result<Pose, TrackError> {
        let steps = 2 * (self.drawings.len() - 2).max(1);
        let done = self.steps_done.fetch_add(1, Ordering::Relaxed);
        self.progress.report("Tracking", 0.95 * (done as f64 / steps as f64).min(1.0))?;
        let flow = self.store.flow(self.frames, self.frame_of(from), self.frame_of(to))?;
        Ok(self.models[model].carry(pose, &flow, moved, &self.scenery(model, to)))
    }

    /// The poses of a model on all drawings between the keys, carried from its key.
    fn chain(&self, model: usize) -> Result<Vec<Pose>, TrackError> {
        let last = self.drawings.len() - 1;
        let drawing = |position: usize| if model == 0 { position } else { last - position };
        let start = self.models[model].texture.mesh.rest.clone();
        let mut poses = chain(start, last - 1, |pose, moved, position| {
            self.carry(model, pose, moved, drawing(position), drawing(position + 1))
        })?;
        if model == 1 {
            poses.reverse();
        }
        Ok(poses)
    }

    fn hypothesis(&self, model: usize, pose: Pose) -> Hypothesis {
        let points = self.models[model].texture.mesh.control_points(&pose.nodes);
        Hypothesis { model, pose, points }
    }

    /// The hypotheses on each drawing; at the keys there is nothing to choose.
    fn pools(&self) -> Result<Vec<Vec<Hypothesis>>, TrackError> {
        let (forwards, backwards) = rayon::join(|| self.chain(0), || self.chain(1));
        let at_key = |model: usize| {
            let nodes = self.models[model].texture.mesh.rest.clone();
            vec![self.hypothesis(model, Pose { nodes, energy: 0.0 })]
        };
        let mut pools = vec![at_key(0)];
        for (first, second) in forwards?.into_iter().zip(backwards?) {
            pools.push(vec![self.hypothesis(0, first), self.hypothesis(1, second)]);
        }
        pools.push(at_key(1));
        Ok(pools)
    }

    fn path(&self, pools: &[Vec<Hypothesis>]) -> Vec<usize> {
        let candidates: Vec<Vec<Candidate>> =
            pools.iter().map(|p| p.iter().map(Hypothesis::candidate).collect()).collect();
        best_path(&candidates, self.models[0].texture.mesh.size)
    }

    /// The chosen control points of a drawing: those of the other model are blended in where they agree, by how near
    /// its key is.
    fn blended(&self, pool: &[Hypothesis], chosen: usize, share: f64) -> Vec<Point> {
        let own = &pool[chosen];
        let apart = |h: &Hypothesis| -> f64 { h.points.iter().zip(&own.points).map(|(a, b)| a.distance(*b)).sum() };
        let others = pool.iter().filter(|h| h.model != own.model);
        let Some(other) = others.min_by(|a, b| apart(a).total_cmp(&apart(b))) else { return own.points.clone() };
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

    fn track(&self, pools: &[Vec<Hypothesis>], path: &[usize]) -> SpanTrack {
        let last = self.job.span.len() - 1;
        let (mut points, mut sure) = (Vec::new(), Vec::new());
        for (d, drawing) in self.drawings.iter().enumerate() {
            let share = drawing.first as f64 / last as f64;
            let found = self.blended(&pools[d], path[d], share);
            let confidence =
                confidence::of_drawing(&self.models, &self.features[d], &self.covers[d], &pools[d], path[d]);
            for index in drawing.first..=drawing.last {
                let mut on_frame: Vec<Point> = found.iter().map(|&p| p * self.scale).collect();
                self.job.enforce(index, &mut on_frame);
                points.push(on_frame);
                sure.push(if index == 0 || index == last { vec![1.0; found.len()] } else { confidence.clone() });
            }
        }
        for (&index, correction) in &self.job.corrections {
            correction.pins.keys().for_each(|&j| sure[index][j] = 1.0);
        }
        let energy = |choose: &dyn Fn(usize) -> usize| {
            (0..pools.len()).map(|d| pools[d][choose(d)].pose.energy).sum::<f64>() / pools.len() as f64
        };
        let summary = SpanSummary {
            termination: Termination::CostConverged,
            iterations: self.steps_done.load(Ordering::Relaxed),
            initial_cost: energy(&|_| 0),
            final_cost: energy(&|d| path[d]),
        };
        SpanTrack { points, confidence: sure, summary }
    }
}
