//! Adds hypotheses after all parts have chosen together.
//!
//! - The chosen poses of the joint choice are tried on the neighbouring drawings, as in [`super::pool`].
//! - Where a part is in doubt but a part that it is joined to is not, the place of the joint is known. So the part is
//!   tried in all directions about the joint. That finds limbs that swung too far or bent too much for the chains, also
//!   in places that the search over the complete picture ranks too low.
//! - Where a part is not where the body that it goes with takes it, the body's motion is tried.

use super::joint::companion::Motions;
use super::joint::lead::Lead;
use super::lattice::mesh::Binding;
use super::pool::{Hypothesis, Pools, hypothesis, is_new, swept};
use super::pooled::Pooled;
use super::propagate::{Pose, mean_distance};
use super::stage::Stage;
use crate::contract::error::TrackError;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::Point;

/// Step of the rotations tried about a joint, in degrees.
const TURN_STEP: usize = 15;
/// Hypotheses kept per model and joint.
const KEPT: usize = 3;
/// Two starts nearer than this mean distance of their nodes count as one, in working pixels.
const SAME_PLACE: f64 = 6.0;

/// The pools of `source` with the hypotheses from its chosen path and from the leads of surer parts.
pub(super) fn mend(stage: &Stage, source: &Pooled, path: &[usize], leads: &[Lead]) -> Result<Pools, TrackError> {
    let pools = &source.pools;
    let last = pools.len() - 1;
    let mut extended = Pools::clone(pools);
    let (swept, _) = swept(stage, pools, path, true, &source.carried)?;
    for hypotheses in [swept, led(stage, pools, last, leads)?] {
        for (pool, more) in extended.iter_mut().zip(hypotheses) {
            for new in more {
                if is_new(pool, &new) {
                    pool.push(new);
                }
            }
        }
    }
    Ok(extended)
}

/// New hypotheses about the joints with surer parts, and where bodies carry the part.
fn led(stage: &Stage, pools: &Pools, last: usize, leads: &[Lead]) -> Result<Pools, TrackError> {
    (0..last + 1)
        .into_par_iter()
        .with_max_len(1)
        .map(|d| {
            let mut found = Vec::new();
            for lead in leads.iter().filter(|_| d != 0 && d != last && !stage.corrected(d)) {
                stage.kit.progress.report("Tracking", 0.85)?;
                for model in 0..2 {
                    let new = match lead {
                        Lead::Hinge { bindings, places } => {
                            places[d].map(|place| about(stage, d, model, &bindings[model], place))
                        }
                        Lead::Body(motions) => motions[d].map(|motions| vec![carried(stage, d, model, &motions)]),
                    };
                    found.extend(new.into_iter().flatten().filter(|h| is_new(&pools[d], h)));
                }
            }
            Ok(found)
        })
        .collect()
}

/// The best poses of a model rotated about its joint, aligned. `place` is the place of the joint in working pixels.
fn about(stage: &Stage, d: usize, model: usize, joint: &Binding, place: Point) -> Vec<Hypothesis> {
    let (own, scenery) = (&stage.models[model], stage.scenery(model, d));
    let mut starts: Vec<Pose> = Vec::new();
    for shape in [&own.texture.mesh.rest, &own.bent] {
        let pivot = joint.at(shape);
        for degrees in (0..360).step_by(TURN_STEP) {
            let turn = Point::from_angle((degrees as f64).to_radians());
            let nodes = shape.iter().map(|&q| turn.rotate(q - pivot) + place).collect();
            starts.push(own.ranked(&scenery, nodes));
        }
    }
    starts.sort_by(|a, b| a.energy.total_cmp(&b.energy));
    let mut kept: Vec<Pose> = Vec::new();
    for start in starts {
        if kept.iter().all(|k| mean_distance(&k.nodes, &start.nodes) > SAME_PLACE) {
            kept.push(start);
        }
        if kept.len() == KEPT {
            break;
        }
    }
    kept.into_iter().map(|start| hypothesis(stage, d, model, own.realigned(&scenery, &start.nodes), None)).collect()
}

/// The pose of a model that a body's motion carries from the model's key, aligned.
fn carried(stage: &Stage, d: usize, model: usize, motions: &Motions) -> Hypothesis {
    let (own, scenery) = (&stage.models[model], stage.scenery(model, d));
    let nodes: Vec<Point> = own.texture.mesh.rest.iter().map(|&q| motions[model].apply(q)).collect();
    hypothesis(stage, d, model, own.realigned(&scenery, &nodes), None)
}
