//! Hypotheses from the artist's corrections.
//!
//! Without corrections a pool depends on the keys and the pictures alone, so it is kept when the artist pins a point.
//!
//! 1. On each corrected drawing every hypothesis is moved to the corrections and aligned again with the corrections as
//!    constraints. A single pin leaves the rotation open, so rotated starts are tried too. A corrected centre near the part
//!    says where it is and nothing of its rotation, so alone it turns nothing: a round part fits turned as well.
//! 2. The best results are carried to the drawings on both sides, as long as they find poses that the pools there do
//!    not have yet. That is how one pin corrects its neighbours.

use super::pool::{Hypothesis, Pools, hypothesis, is_new};
use super::pooled::Pooled;
use super::propagate::Pose;
use super::stage::Stage;
use crate::contract::error::TrackError;
use crate::shared::drawings::Drawing;
use rayon::prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};

/// Rotations tried about the corrections' centre, in degrees.
const TURNS: [f64; 8] = [-90.0, -60.0, -40.0, -20.0, 20.0, 40.0, 60.0, 90.0];
/// Hypotheses of each model kept on a corrected drawing.
const KEPT: usize = 4;
/// Hypotheses of a corrected drawing that are carried to its neighbours.
const CARRIED: usize = 2;

/// A part may end up this far from its corrected centre, in sizes of the part, if the artist moved it by more than
/// twice as much.
const CENTER_REACH: f64 = 0.15;

/// For each drawing of a stage: how far the part may be from its corrected centre, in working pixels. An artist who
/// moves a part a little means the exact place, so the reach is 0. An artist who moves it far shows where to look.
/// `plain` is the result without corrections; it gives the place before the move.
pub(super) fn center_reach(stage: &Stage, plain: &Pooled) -> Vec<f64> {
    let reach = CENTER_REACH * stage.models[0].texture.mesh.size;
    let of_drawing = |d: usize| {
        let Some(center) = stage.correction(d).and_then(|c| c.center) else { return 0.0 };
        let before = plain.own_points(stage.drawings[d].first);
        let far = is_far(&before, center, stage.models[0].texture.mesh.size * stage.scale);
        if far { reach } else { 0.0 }
    };
    (0..stage.drawings.len()).map(of_drawing).collect()
}

/// Whether a corrected centre shows where to look for a part of this size, whose points are known without it. Otherwise it is the
/// exact place. All in one unit.
pub(super) fn is_far(points: &[Point], center: Point, size: f64) -> bool {
    polygon::center(points).distance(center) > 2.0 * CENTER_REACH * size
}

/// The pools of a stage with corrections, from the `pools` without. `plain` are the drawings of the pools without
/// corrections.
pub(super) fn extend(stage: &Stage, plain: &[Drawing], pools: &Pools) -> Result<Pools, TrackError> {
    let of = |d: &Drawing| plain.iter().position(|p| p.first <= d.first && d.first <= p.last).unwrap_or(0);
    let last = stage.drawings.len() - 1;
    let mut extended: Pools = (0..=last)
        .into_par_iter()
        .map(|d| {
            // In both groupings the keys' drawings are the first and the last one.
            let source = if d == last { plain.len() - 1 } else { of(&stage.drawings[d]) };
            let mut pool: Vec<Hypothesis> = pools[source].iter().map(Hypothesis::without_origin).collect();
            if stage.corrected(d) {
                pool = constrained(stage, d, &pool)?;
            }
            Ok(pool)
        })
        .collect::<Result<_, TrackError>>()?;
    let sources = (1..last).filter(|&d| stage.corrected(d));
    let ways: Vec<(usize, isize)> = sources.flat_map(|d| [(d, -1), (d, 1)]).collect();
    let carried = |&(source, step): &(usize, isize)| carried_on(stage, &extended, source, step);
    let more: Vec<Vec<(usize, Hypothesis)>> = ways.par_iter().map(carried).collect::<Result<_, TrackError>>()?;
    for (d, new) in more.into_iter().flatten() {
        if is_new(&extended[d], &new) {
            extended[d].push(new);
        }
    }
    Ok(extended)
}

/// The hypotheses of a corrected drawing, moved to the corrections.
fn constrained(stage: &Stage, d: usize, pool: &[Hypothesis]) -> Result<Vec<Hypothesis>, TrackError> {
    stage.kit.progress.report("Tracking", 0.0)?;
    let by_model: Vec<Vec<Hypothesis>> = [0, 1].par_iter().map(|&model| obeying(stage, d, model, pool)).collect();
    let mut found: Vec<Hypothesis> = Vec::new();
    for new in by_model.into_iter().flatten() {
        if is_new(&found, &new) {
            found.push(new);
        }
    }
    Ok(found)
}

/// The same for one model: the best few starts, aligned under the constraints.
fn obeying(stage: &Stage, d: usize, model: usize, pool: &[Hypothesis]) -> Vec<Hypothesis> {
    let scenery = stage.scenery(model, d);
    let settler = stage.models[model].settler(&scenery);
    let own: Vec<&Hypothesis> = pool.iter().filter(|h| h.model == model).collect();
    let only_center = stage.correction(d).is_some_and(|correction| correction.pins.is_empty());
    let turns: &[f64] = if only_center && stage.center_reach[d] == 0.0 { &[] } else { &TURNS };
    let from = |h: &&Hypothesis| {
        let turned = turns.iter().map(|degrees| scenery.anchors.turned(&h.pose.nodes, degrees.to_radians()));
        let settled = std::iter::once(h.pose.nodes.clone())
            .chain(turned)
            .map(|start| stage.models[model].measured(&scenery, settler.settle(&start)));
        std::iter::once(stage.models[model].drawn(&scenery, &h.pose.nodes, &h.differences))
            .chain(settled)
            .collect::<Vec<Pose>>()
    };
    let mut starts: Vec<Pose> = own.par_iter().flat_map_iter(from).collect();
    starts.sort_by(|a, b| a.energy.total_cmp(&b.energy));
    let mut kept: Vec<Hypothesis> = Vec::new();
    for start in starts {
        let start = hypothesis(stage, d, model, start, None);
        if kept.iter().all(|h| h.distance(&start) > 4.0) {
            kept.push(start);
        }
        if kept.len() == KEPT {
            break;
        }
    }
    let aligned = |start: &Hypothesis| {
        let pose = stage.models[model].realigned(&scenery, &start.pose.nodes);
        let free = (stage.center_reach[d] > 0.0).then(|| freed(stage, d, model, &pose.nodes)).flatten();
        if let Some(free) = free.filter(|free| free.pose.energy < pose.energy) {
            return free;
        }
        hypothesis(stage, d, model, pose, None)
    };
    kept.par_iter().map(aligned).collect()
}

/// A pose aligned to the visible samples, with the pins as the only constraints. None if that takes the part further
/// from its corrected centre than [`center_reach`] allows.
pub(super) fn freed(stage: &Stage, d: usize, model: usize, nodes: &[Point]) -> Option<Hypothesis> {
    let pose = stage.models[model].seen(&stage.released(model, d), nodes);
    Some(hypothesis(stage, d, model, pose, None)).filter(|free| stage.near_center(d, &free.points))
}

/// New hypotheses on the drawings to one side of a corrected drawing, from its best hypotheses.
fn carried_on(
    stage: &Stage,
    pools: &Pools,
    source: usize,
    step: isize,
) -> Result<Vec<(usize, Hypothesis)>, TrackError> {
    let mut order: Vec<&Hypothesis> = pools[source].iter().collect();
    order.sort_by(|a, b| a.pose.energy.total_cmp(&b.pose.energy));
    let last = pools.len() - 1;
    let mut found: Vec<(usize, Hypothesis)> = Vec::new();
    for start in order.into_iter().take(CARRIED) {
        let (mut from, mut nodes) = (source, start.pose.nodes.clone());
        let mut moved: Option<Vec<Point>> = None;
        loop {
            let to = from.wrapping_add_signed(step);
            if to == 0 || to >= last || stage.corrected(to) {
                break;
            }
            let pose = stage.carry(start.model, &nodes, moved.as_deref(), from, to)?;
            let new = hypothesis(stage, to, start.model, pose, None);
            let known = |d: usize, h: &Hypothesis| d == to && h.model == new.model && h.distance(&new) <= 1.0;
            if !is_new(&pools[to], &new) || found.iter().any(|(d, h)| known(*d, h)) {
                break;
            }
            moved = Some(new.pose.nodes.iter().zip(&nodes).map(|(a, b)| *a - *b).collect());
            (from, nodes) = (to, new.pose.nodes.clone());
            found.push((to, new));
        }
    }
    Ok(found)
}
