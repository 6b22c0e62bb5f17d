//! What the picture leaves open, decided by what else is known: turns of discs, slides along limbs.
//!
//! A flat disc looks the same however it is turned, and a limb of one colour that vanishes into a body of the same can be
//! shifted along itself. The alignment then stops anywhere. Here a pose is moved towards what is likely without looking
//! (the turn interpolated between the keys; the joint where the part that it hangs on has it) as far as that costs
//! nothing: the share of the move is the largest one at which the visible energy has not risen by more than noise.

use super::joint::tie::Lead;
use super::propagate::Pose;
use super::stage::Stage;
use crate::geometry::Point;
use crate::geometry::similarity::Similarity;

/// Shares of a move that are tried, the largest first.
const SHARES: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.125];

/// The chosen pose of a drawing, moved where the picture does not mind.
pub(super) fn settle(stage: &Stage, drawing: usize, model: usize, pose: &[Point], leads: &[Lead]) -> Vec<Point> {
    let mut nodes = pose.to_vec();
    for lead in leads {
        let Some(place) = lead.places[drawing] else { continue };
        let shift = place - lead.bindings[model].at(&nodes);
        nodes = eased(stage, drawing, model, &nodes, |share, nodes| {
            nodes.iter().map(|&p| p + shift * share).collect()
        });
    }
    let turn = turn_missing(stage, drawing, model, &nodes);
    let center = center_of(stage, model, &nodes);
    eased(stage, drawing, model, &nodes, |share, nodes| {
        let factor = Point::from_angle(turn * share);
        nodes.iter().map(|&p| factor.rotate(p - center) + center).collect()
    })
}

/// The pose moved by the largest share that costs nothing.
fn eased(
    stage: &Stage,
    drawing: usize,
    model: usize,
    nodes: &[Point],
    moved: impl Fn(f64, &[Point]) -> Vec<Point>,
) -> Vec<Point> {
    let energy = |nodes: &[Point]| stage.seen_energy(drawing, model, nodes);
    let limit = energy(nodes) * (1.0 + crate::knob!("EASEREL", 0.05)) + crate::knob!("EASE", 0.0001);
    let tried = SHARES.iter().map(|&share| moved(share, nodes));
    let free = tried.into_iter().find(|candidate| energy(candidate) <= limit);
    free.unwrap_or_else(|| nodes.to_vec())
}

fn center_of(stage: &Stage, model: usize, nodes: &[Point]) -> Point {
    crate::geometry::polygon::center(&stage.models[model].texture.mesh.control_points(nodes))
}

/// Turn from the pose to the one interpolated between the keys, in radians.
fn turn_missing(stage: &Stage, drawing: usize, model: usize, nodes: &[Point]) -> f64 {
    let own = &stage.models[model];
    let rest = own.texture.mesh.control_points(&own.texture.mesh.rest);
    let now = Similarity::fit(&rest, &own.texture.mesh.control_points(nodes)).angle();
    let between = Similarity::fit(&rest, &own.texture.mesh.control_points(&own.there)).angle();
    let last = (stage.job.span.len() - 1) as f64;
    let share = stage.drawings[drawing].first as f64 / last;
    let wanted = between * if model == 0 { share } else { 1.0 - share };
    (wanted - now + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

/// The settled pose, aligned finely again.
pub(super) fn settled(stage: &Stage, drawing: usize, model: usize, pose: &[Point], leads: &[Lead]) -> Pose {
    let nodes = settle(stage, drawing, model, pose, leads);
    let scenery = stage.scenery(model, drawing);
    stage.models[model].measured(&scenery, nodes)
}
