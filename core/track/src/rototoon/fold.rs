//! Hypotheses of limbs that are folded at a joint or drawn longer and shorter, where something of the figure is unexplained or
//! the artist corrected the limb.
//!
//! A limb in doubt is tried with each half turned about a joint in the middle and to both sides of it, in steps of 20°, and
//! with each half longer and shorter. The starts are ranked by their fit and by how much they cover of what the other
//! parts leave of the figure ([`claims`](super::joint::figure::claims)); on a corrected drawing of a film without a figure by
//! their fit alone. The best few are aligned.

use super::joint::figure::claims::Unclaimed;
use super::lattice::limb::Joint;
use super::pool::{Hypothesis, hypothesis};
use super::propagate::{Model, Pose};
use super::stage::Stage;
use super::starts::{SAME_PLACE, best_apart, ranked};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::Point;

/// Places of the joints that are tried, along the limb.
pub const JOINTS: [f64; 3] = [0.35, 0.5, 0.65];
/// Angles of a fold in degrees, to either side.
pub(super) const ANGLES: [f64; 6] = [20.0, 40.0, 60.0, 80.0, 100.0, 120.0];
/// Lengths of a half that are tried.
const LENGTHS: [f64; 3] = [0.7, 1.25, 1.5];
/// Hypotheses kept of each model.
const KEPT: usize = 6;
/// A part is in doubt where the chains of its two models are this far apart, in working pixels.
const DOUBT: f64 = 3.0;
/// A part is in doubt too where its pose fits no better than this: both chains may be stuck at the same wrong place.
const BADLY: f64 = 0.003;

/// New hypotheses on a drawing: the best folds of some hypotheses of each model, aligned.
pub(super) fn folds(stage: &Stage, d: usize, bases: &[&Hypothesis], unclaimed: Option<&Unclaimed>) -> Vec<Hypothesis> {
    let of_model = |model: usize| {
        let (own, scenery) = (&stage.models[model], stage.scenery(model, d));
        let starts = bases.iter().filter(|base| base.model == model).flat_map(|base| folded(own, &base.pose.nodes));
        let kept = best_apart(ranked(own, &scenery, starts, unclaimed), KEPT);
        let align = |start: Pose| hypothesis(stage, d, model, own.realigned(&scenery, &start.nodes), None);
        kept.into_par_iter().map(align).collect::<Vec<_>>()
    };
    (0..2).flat_map(of_model).collect()
}

/// The hypotheses of a pool that are folded: the one that is `chosen`, the best one of the other model, and the two that were
/// carried from the keys. None where the part is not in doubt.
pub(super) fn bases(pool: &[Hypothesis], chosen: usize) -> Vec<&Hypothesis> {
    if !matches!(pool, [a, b, ..] if a.distance(b) > DOUBT || pool[chosen].pose.energy > BADLY) {
        return Vec::new();
    }
    let chosen = &pool[chosen];
    let others = pool.iter().filter(|h| h.model != chosen.model);
    let other = others.min_by(|a, b| a.pose.energy.total_cmp(&b.pose.energy));
    let mut bases: Vec<&Hypothesis> = Vec::new();
    for base in std::iter::once(chosen).chain(other).chain(&pool[..2]) {
        if bases.iter().all(|known| known.model != base.model || known.distance(base) > SAME_PLACE) {
            bases.push(base);
        }
    }
    bases
}

/// All folds of a pose. None if the part is no limb.
fn folded(own: &Model, nodes: &[Point]) -> Vec<Vec<Point>> {
    let Some(limb) = &own.limb else { return Vec::new() };
    let mut starts = Vec::new();
    for joint in JOINTS.into_iter().flat_map(|place| [false, true].map(|towards_end| Joint { place, towards_end })) {
        let angles = ANGLES.iter().flat_map(|a| [-a, *a]).map(f64::to_radians);
        starts.extend(angles.map(|angle| limb.folded(nodes, joint, angle)));
        starts.extend(LENGTHS.iter().map(|factor| limb.stretched(nodes, joint, *factor)));
    }
    starts
}
