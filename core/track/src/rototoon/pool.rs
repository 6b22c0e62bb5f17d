//! The pool of hypotheses on each drawing of a span, and the path through them.
//!
//! 1. Each key's model is carried through the span from its own key.
//! 2. Where the two chains disagree, both models are searched over the whole picture.
//! 3. A path is chosen; each chosen pose is carried to its neighbours once more, since what the search found on one
//!    drawing is worth trying on the next, unless both keys agree there already; the path is chosen again.

use super::mechanisms::Mechanism;
use super::propagate::{Pose, chain, mean_distance};
use super::search::Templates;
use super::select::{Candidate, Smoothness, best_path};
use super::stage::Stage;
use crate::contract::error::TrackError;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use std::collections::BTreeMap;

/// Mean distance of the chains' control points (working pixels) from which on both models are searched for.
const DISAGREEMENT: f64 = 6.0;
/// Hypotheses of each model kept of those that a search has found.
const FOUND: usize = 2;
/// Mean distance (working pixels) below which a carried pose adds nothing to the pool.
const KNOWN_PLACE: f64 = 1.0;
/// Mean distance (working pixels) up to which a chosen pose is confirmed by one of the other key's model: neither has
/// anything to learn from the neighbours.
const CONFIRMED: f64 = 2.0;

/// A hypothesis of the pool of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Which key's model it poses: 0 or 1.
    pub model: usize,
    /// The pose.
    pub pose: Pose,
    /// Where it puts the control points, in working pixels.
    pub points: Vec<Point>,
    /// Colour difference of each sample that measures it.
    pub differences: Vec<f32>,
    /// Index of the neighbouring drawing's hypothesis that it was carried from, and whether that is the drawing before.
    origin: Option<(usize, bool)>,
}

/// The hypotheses of each drawing. Those of the keys are single.
pub type Pools = Vec<Vec<Hypothesis>>;

impl Hypothesis {
    /// A pose that was not carried from anywhere.
    pub fn new(model: usize, pose: Pose, points: Vec<Point>, differences: Vec<f32>) -> Self {
        Self { model, pose, points, differences, origin: None }
    }

    fn candidate(&self) -> Candidate<'_> {
        Candidate { cost: self.pose.energy.max(0.0).sqrt(), points: &self.points }
    }

    /// The same, but no longer said to be carried from another.
    pub fn without_origin(&self) -> Self {
        Self { origin: None, ..self.clone() }
    }

    /// Mean distance of the control points.
    pub fn distance(&self, other: &Self) -> f64 {
        mean_distance(&self.points, &other.points)
    }
}

/// What came of carrying a hypothesis to a neighbouring drawing: by that drawing, the hypothesis' index, and whether time
/// went forwards. Pools only grow, so that what was carried once is not carried again.
pub(super) type Carried = BTreeMap<(usize, usize, bool), Hypothesis>;

/// The hypotheses of all drawings, the index of the chosen one on each, and what was carried on the way.
pub(super) fn fill(stage: &Stage) -> Result<(Pools, Vec<usize>, Carried), TrackError> {
    let mut pools = chains(stage)?;
    let found: Vec<Vec<Hypothesis>> = searched(stage, &pools)?;
    pools.iter_mut().zip(found).for_each(|(pool, more)| pool.extend(more));
    let path = choose(stage, &pools);
    let (more, carried) = swept(stage, &pools, &path, false, &Carried::new())?;
    for (pool, more) in pools.iter_mut().zip(more) {
        for new in more {
            if is_new(pool, &new) {
                pool.push(new);
            }
        }
    }
    let path = choose(stage, &pools);
    Ok((pools, path, carried))
}

/// What comes of carrying the chosen hypotheses to their neighbours, both ways: to all of them, or to those where the
/// chosen one is not confirmed by the other key. (What other parts say may speak against what both keys say.) `known` is what
/// was carried before; what is carried now comes back beside the new hypotheses.
pub(super) fn swept(
    stage: &Stage,
    pools: &Pools,
    path: &[usize],
    all: bool,
    known: &Carried,
) -> Result<(Pools, Carried), TrackError> {
    if !stage.kit.mechanisms.has(Mechanism::Sweep) {
        return Ok((vec![Vec::new(); pools.len()], Carried::new()));
    }
    let wanted = |d: usize| !stage.corrected(d) && (all || !confirmed(&pools[d], path[d]));
    let wanted: Vec<bool> = (0..pools.len()).map(wanted).collect();
    let sweep = |forwards: bool| sweep(stage, pools, path, known, (&wanted, forwards));
    let (forwards, backwards) = rayon::join(|| sweep(true), || sweep(false));
    let ((forwards, mut carried), (backwards, more)) = (forwards?, backwards?);
    carried.extend(more);
    Ok((forwards.into_iter().zip(backwards).map(|(a, b)| a.into_iter().chain(b).collect()).collect(), carried))
}

/// A pose on a drawing as a hypothesis of its pool.
pub(super) fn hypothesis(
    stage: &Stage,
    drawing: usize,
    model: usize,
    pose: Pose,
    origin: Option<(usize, bool)>,
) -> Hypothesis {
    let texture = &stage.models[model].texture;
    let points = texture.mesh.control_points(&pose.nodes);
    let differences = texture.differences(&stage.features[drawing], &pose.nodes);
    Hypothesis { model, pose, points, differences, origin }
}

pub(super) fn choose(stage: &Stage, pools: &Pools) -> Vec<usize> {
    let candidates: Vec<Vec<Candidate>> =
        pools.iter().map(|pool| pool.iter().map(Hypothesis::candidate).collect()).collect();
    best_path(&candidates, Smoothness::new(stage.models[0].texture.mesh.size))
}

/// The poses of both models, carried from their keys: two hypotheses on each drawing, the first key's first.
fn chains(stage: &Stage) -> Result<Pools, TrackError> {
    let (forwards, backwards) = rayon::join(|| carried(stage, 0), || carried(stage, 1));
    let at_key = |model: usize| {
        let nodes = stage.models[model].texture.mesh.rest.clone();
        let drawing = if model == 0 { 0 } else { stage.drawings.len() - 1 };
        vec![hypothesis(stage, drawing, model, Pose { nodes, energy: 0.0 }, None)]
    };
    let mut pools = vec![at_key(0)];
    let last = stage.drawings.len() - 1;
    for (i, (first, second)) in forwards?.into_iter().zip(backwards?).enumerate() {
        let from = [0, usize::from(i + 2 < last)];
        pools.push(vec![
            hypothesis(stage, i + 1, 0, first, Some((from[0], true))),
            hypothesis(stage, i + 1, 1, second, Some((from[1], false))),
        ]);
    }
    pools.push(at_key(1));
    Ok(pools)
}

fn carried(stage: &Stage, model: usize) -> Result<Vec<Pose>, TrackError> {
    let last = stage.drawings.len() - 1;
    let drawing = |position: usize| if model == 0 { position } else { last - position };
    let start = stage.models[model].texture.mesh.rest.clone();
    let mut poses = chain(start, last - 1, |pose, moved, position| {
        stage.carry(model, pose, moved, drawing(position), drawing(position + 1))
    })?;
    if model == 1 {
        poses.reverse();
    }
    Ok(poses)
}

/// Hypotheses from searching the whole picture, on each drawing where the chains disagree.
fn searched(stage: &Stage, pools: &Pools) -> Result<Pools, TrackError> {
    let lost: Vec<bool> =
        pools.iter().map(|pool| matches!(&pool[..], [a, b] if a.distance(b) >= DISAGREEMENT)).collect();
    if !lost.contains(&true) || !stage.kit.mechanisms.has(Mechanism::Search) {
        return Ok(vec![Vec::new(); pools.len()]);
    }
    let last = stage.drawings.len() - 1;
    let ends = [0, last];
    let contours = ends.map(|d| &pools[d][0].points);
    let templates: Vec<Option<Templates>> = (0..2)
        .into_par_iter()
        .map(|key| {
            let model = &stage.models[key];
            Templates::new(model, &stage.features[ends[key]], &model.cover, contours[key], stage.width())
        })
        .collect();
    lost.par_iter()
        .with_max_len(1)
        .enumerate()
        .map(|(drawing, &lost)| {
            let mut found = Vec::new();
            for (key, templates) in templates.iter().enumerate() {
                let (true, Some(templates)) = (lost, templates) else { continue };
                stage.kit.progress.report("Searching", 0.0)?;
                let (model, scenery) = (&stage.models[key], stage.scenery(key, drawing));
                let sought = stage.kit.store.sought(stage.kit.frames, stage.frame_of(drawing), templates.level())?;
                let starts = templates.find(&stage.features[drawing], &sought, model, contours[key]);
                let poses = model.best_polished(&scenery, &starts, FOUND);
                found.extend(poses.into_iter().map(|pose| hypothesis(stage, drawing, key, pose, None)));
            }
            Ok(found)
        })
        .collect()
}

/// New hypotheses of the drawings, and all that was carried.
type Swept = (Vec<Option<Hypothesis>>, Carried);

/// Carries the chosen poses to the next drawing (or the one before) where that is wanted, and what comes of it further
/// while it is better than what was chosen there. `known` is what was carried before.
fn sweep(
    stage: &Stage,
    pools: &Pools,
    path: &[usize],
    known: &Carried,
    (wanted, forwards): (&[bool], bool),
) -> Result<Swept, TrackError> {
    let last = pools.len() - 1;
    let mut found: Vec<Option<Hypothesis>> = vec![None; pools.len()];
    let mut all = Carried::new();
    let mut better: Option<Hypothesis> = None;
    for step in 1..last {
        let (to, from) = if forwards { (step, step - 1) } else { (last - step, last - step + 1) };
        if from == 0 || from == last || !wanted[to] {
            better = None;
            continue;
        }
        let origin = Some((path[from], forwards));
        if better.is_none() && pools[to].iter().any(|h| h.origin == origin) {
            continue;
        }
        let carry = |source: &Hypothesis, origin: Option<(usize, bool)>| {
            let pose = stage.carry(source.model, &source.pose.nodes, None, from, to)?;
            Ok::<_, TrackError>(hypothesis(stage, to, source.model, pose, origin))
        };
        let new = match &better {
            Some(source) => carry(source, None)?,
            None => {
                let place = (to, path[from], forwards);
                let new =
                    known.get(&place).map_or_else(|| carry(&pools[from][path[from]], origin), |h| Ok(h.clone()))?;
                all.insert(place, new.clone());
                new
            }
        };
        found[to] = is_new(&pools[to], &new).then(|| new.clone());
        better = (new.pose.energy < pools[to][path[to]].pose.energy).then_some(new);
    }
    Ok((found, all))
}

/// Whether the other key's model says the same as a hypothesis.
fn confirmed(pool: &[Hypothesis], chosen: usize) -> bool {
    let chosen = &pool[chosen];
    pool.iter().any(|h| h.model != chosen.model && h.distance(chosen) < CONFIRMED)
}

pub(super) fn is_new(pool: &[Hypothesis], new: &Hypothesis) -> bool {
    pool.iter().filter(|h| h.model == new.model).all(|h| h.distance(new) > KNOWN_PLACE)
}
