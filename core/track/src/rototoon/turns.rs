//! Hypotheses of parts with what is behind a neck turned about it.
//!
//! From the best poses known, what is behind each neck ([`necks`](super::lattice::necks)) is turned to both sides in steps of 20°.
//! The best few starts are aligned. The best result is turned once more, at another neck, as long as that fits better: a figure
//! moves both arms.

use super::fold::{ANGLES, bases};
use super::joint::figure::claims::Unclaimed;
use super::lattice::necks::Neck;
use super::pool::{Carried, Hypothesis, Pools, add_new, choose, hypothesis, swept};
use super::stage::Stage;
use super::starts::{best_apart, ranked};
use crate::contract::error::TrackError;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use std::slice;

/// A part whose pose fits better than this has nothing to gain: the path counts √E.
const FITS: f64 = 0.0016;
/// Starts of each model and round that are aligned on the middle level.
const KEPT: usize = 6;
/// Those of them that are aligned on the finest level.
const FINISHED: usize = 3;
/// Most rounds.
const ROUNDS: usize = 3;

/// Pools with branches turned where the part is in doubt, and with the chosen ones carried to their neighbours; the path through
/// them, and what was carried. The arguments are the same without branches ([`pool`](super::pool)).
pub(super) fn with_branches(
    stage: &Stage,
    (mut pools, path, carried): (Pools, Vec<usize>, Carried),
) -> Result<(Pools, Vec<usize>, Carried), TrackError> {
    let last = pools.len() - 1;
    let on = |d: usize| {
        stage.kit.progress.report("Tracking", 0.8)?;
        let bases = if d == 0 || d == last { Vec::new() } else { bases(&pools[d], path[d]) };
        Ok(turns(stage, d, &bases, &Turned::Branches))
    };
    let found: Vec<Vec<Hypothesis>> =
        (0..pools.len()).into_par_iter().with_max_len(1).map(on).collect::<Result<_, TrackError>>()?;
    if found.iter().all(Vec::is_empty) {
        return Ok((pools, path, carried));
    }
    add_new(&mut pools, found);
    let path = choose(stage, &pools);
    let (more, now) = swept(stage, &pools, &path, false, &carried)?;
    add_new(&mut pools, more);
    let path = choose(stage, &pools);
    Ok((pools, path, carried.into_iter().chain(now).collect()))
}

/// What is turned.
pub(super) enum Turned<'a> {
    /// Branches of a part, which only its own fit can tell.
    Branches,
    /// Pieces of a limb. They are also ranked by what they cover of the unclaimed figure, if there is one.
    Pieces(Option<&'a Unclaimed>),
}

/// New hypotheses on a drawing: turns of some hypotheses, aligned.
pub(super) fn turns(stage: &Stage, d: usize, bases: &[&Hypothesis], turned: &Turned) -> Vec<Hypothesis> {
    (0..2).flat_map(|model| of_model(stage, d, model, bases, turned)).collect()
}

fn of_model(stage: &Stage, d: usize, model: usize, bases: &[&Hypothesis], turned: &Turned) -> Vec<Hypothesis> {
    let necks = &stage.models[model].necks;
    let (necks, unclaimed) = match turned {
        Turned::Branches => (&necks.branches, None),
        Turned::Pieces(unclaimed) => (&necks.others, *unclaimed),
    };
    let least = |poses: &mut dyn Iterator<Item = &Hypothesis>| {
        poses.min_by(|a, b| a.pose.energy.total_cmp(&b.pose.energy)).cloned()
    };
    let bases: Vec<&Hypothesis> = bases.iter().copied().filter(|base| base.model == model).collect();
    let Some(mut best) = least(&mut bases.iter().copied()).filter(|best| best.pose.energy > FITS) else {
        return Vec::new();
    };
    let mut found = once(stage, d, &bases, (necks, unclaimed));
    for _ in 1..ROUNDS {
        match least(&mut found.iter()) {
            Some(better) if better.pose.energy < best.pose.energy => best = better,
            _ => break,
        }
        found.extend(once(stage, d, slice::from_ref(&&best), (necks, unclaimed)));
    }
    found
}

/// One round: turns of some hypotheses of one model.
fn once(
    stage: &Stage,
    d: usize,
    bases: &[&Hypothesis],
    (necks, unclaimed): (&[Neck], Option<&Unclaimed>),
) -> Vec<Hypothesis> {
    let Some(model) = bases.first().map(|base| base.model) else { return Vec::new() };
    let (own, scenery) = (&stage.models[model], stage.scenery(model, d));
    let angles = || ANGLES.iter().flat_map(|angle| [-angle, *angle]).map(f64::to_radians);
    let of_base = |base: &&Hypothesis| {
        let nodes = base.pose.nodes.clone();
        necks.iter().flat_map(move |neck| angles().map(|angle| neck.turned(&nodes, angle)).collect::<Vec<_>>())
    };
    let kept = best_apart(ranked(own, &scenery, bases.iter().flat_map(of_base), unclaimed), KEPT);
    let starts: Vec<_> = kept.into_iter().map(|start| start.nodes).collect();
    let poses = own.best_polished(&scenery, &starts, FINISHED);
    poses.into_iter().map(|pose| hypothesis(stage, d, model, pose, None)).collect()
}
