//! The pool of hypotheses on each drawing of a span, and a first path through it.
//!
//! 1. Each key's model is carried through the span from its own key.
//! 2. Where these two chains disagree, both models are searched in the complete picture.
//! 3. A path is chosen. Each chosen pose is carried to its neighbours once more, unless both keys agree there already:
//!    a pose that the search found on one drawing is worth trying on the next. Then the path is chosen again.

use super::mechanisms::Mechanism;
use super::propagate::{Pose, chain, mean_distance};
use super::search::Templates;
use super::select::{Candidate, Smoothness, best_path};
use super::stage::Stage;
use crate::contract::error::TrackError;
use crate::shared::drawings::gaps;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use std::collections::BTreeMap;

/// Mean distance of the two chains' control points (working pixels) from which on both models are searched.
const DISAGREEMENT: f64 = 3.0;
/// Number of hypotheses kept per model and search.
const FOUND: usize = 4;
/// A carried pose is new if its mean distance (working pixels) from every known one of the same model exceeds this.
const KNOWN_PLACE: f64 = 1.0;
/// A chosen pose is confirmed if the other key's model has a pose within this mean distance (working pixels). Then the
/// neighbours have nothing to add.
const CONFIRMED: f64 = 2.0;

/// A hypothesis about a part on a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Index of the key whose model it poses: 0 or 1.
    pub model: usize,
    /// The pose.
    pub pose: Pose,
    /// Places of the control points, in working pixels.
    pub points: Vec<Point>,
    /// Cost of each sample that measures the pose, as a squared colour difference.
    pub differences: Vec<f32>,
    /// Index of the neighbouring drawing's hypothesis from which this one was carried, and whether that is the drawing
    /// before.
    origin: Option<(usize, bool)>,
}

/// The hypotheses of each drawing. On the keys' drawings there is one each.
pub type Pools = Vec<Vec<Hypothesis>>;

impl Hypothesis {
    /// A pose that was not carried from anywhere.
    pub fn new(model: usize, pose: Pose, points: Vec<Point>, differences: Vec<f32>) -> Self {
        Self { model, pose, points, differences, origin: None }
    }

    /// The hypothesis as the path search sees it.
    pub fn candidate(&self) -> Candidate<'_> {
        Candidate { cost: self.pose.energy.max(0.0).sqrt(), points: &self.points }
    }

    /// The same hypothesis without its origin.
    pub fn without_origin(&self) -> Self {
        Self { origin: None, ..self.clone() }
    }

    /// Whether another hypothesis has the same pose of the same model on the same drawing.
    pub fn is_at(&self, other: &Self) -> bool {
        self.model == other.model && self.pose == other.pose
    }

    /// Mean distance of the control points, in working pixels.
    pub fn distance(&self, other: &Self) -> f64 {
        mean_distance(&self.points, &other.points)
    }
}

/// Results of carrying hypotheses to neighbouring drawings. The key is the target drawing, the index of the source
/// hypothesis, and whether time goes forwards. Pools only grow, so no hypothesis must be carried twice.
pub(super) type Carried = BTreeMap<(usize, usize, bool), Hypothesis>;

/// The hypotheses of all drawings, the index of the chosen one on each, and the carried hypotheses.
pub(super) fn fill(stage: &Stage) -> Result<(Pools, Vec<usize>, Carried), TrackError> {
    let mut pools = chains(stage)?;
    let found: Vec<Vec<Hypothesis>> = searched(stage, &pools)?;
    pools.iter_mut().zip(found).for_each(|(pool, more)| pool.extend(more));
    let path = choose(stage, &pools);
    let (more, carried) = swept(stage, &pools, &path, false, &Carried::new())?;
    add_new(&mut pools, more);
    let path = choose(stage, &pools);
    Ok((pools, path, carried))
}

/// Adds the hypotheses that are new to the pools of their drawings.
pub(super) fn add_new(pools: &mut Pools, found: impl IntoIterator<Item = Vec<Hypothesis>>) {
    for (pool, more) in pools.iter_mut().zip(found) {
        for new in more {
            if is_new(pool, &new) {
                pool.push(new);
            }
        }
    }
}

/// New hypotheses from carrying the chosen ones to their neighbours, in both directions. With `all` they are carried to
/// all drawings, otherwise only to drawings whose chosen hypothesis the other key does not confirm. (`all` is for the
/// joint choice: other parts may contradict what both keys agree on.) `known` is what was carried before. The second
/// result is what was carried now.
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

/// The path of least cost through the pools, for this part alone.
pub(super) fn choose(stage: &Stage, pools: &Pools) -> Vec<usize> {
    let candidates: Vec<Vec<Candidate>> =
        pools.iter().map(|pool| pool.iter().map(Hypothesis::candidate).collect()).collect();
    best_path(&candidates, Smoothness::new(stage.models[0].texture.mesh.size), &gaps(&stage.drawings))
}

/// The poses of both models, carried from their keys: two hypotheses on each drawing, the first key's one first.
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

/// Hypotheses from searching the complete picture, on each drawing where the chains disagree.
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

/// New hypotheses by drawing, and everything that was carried.
type Swept = (Vec<Option<Hypothesis>>, Carried);

/// Carries the chosen poses one way to the neighbouring drawings in `wanted`. A result that is better than the chosen
/// pose there is carried further. `known` is what was carried before.
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

/// Whether the other key's model has a pose at the same place as the chosen one.
fn confirmed(pool: &[Hypothesis], chosen: usize) -> bool {
    let chosen = &pool[chosen];
    pool.iter().any(|h| h.model != chosen.model && h.distance(chosen) < CONFIRMED)
}

/// Whether no hypothesis of the pool with the same model is at the same place as `new`.
pub(super) fn is_new(pool: &[Hypothesis], new: &Hypothesis) -> bool {
    pool.iter().filter(|h| h.model == new.model).all(|h| h.distance(new) > KNOWN_PLACE)
}
