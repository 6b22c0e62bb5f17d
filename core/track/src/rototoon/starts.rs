//! Ranks rough poses of a model, of which the best are aligned. On a corrected drawing they are moved to the corrections first.

use super::joint::figure::claims::Unclaimed;
use super::propagate::{Model, Pose, Scenery, mean_distance};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;

/// Two starts nearer than this mean distance of their nodes count as one, in working pixels.
pub(super) const SAME_PLACE: f64 = 6.0;
/// Number of starts, by their fit, for which it is asked what they cover.
const BEST_FITS: usize = 100;
/// How much a start gains that covers as much unclaimed figure as the part is large, in units of √E.
const WORTH: f64 = 0.3;

/// The starts that fit best, with what ranks them in place of their energy: the fit as √E, less what they cover of the unclaimed
/// figure.
pub(super) fn ranked(
    own: &Model,
    scenery: &Scenery,
    starts: impl Iterator<Item = Vec<Point>>,
    unclaimed: Option<&Unclaimed>,
) -> Vec<Pose> {
    let settler = own.settler(scenery);
    let starts: Vec<Vec<Point>> = starts.collect();
    let settled = starts.par_iter().map(|nodes| own.ranked(scenery, settler.settle(nodes)));
    let mut poses: Vec<Pose> = settled.collect();
    let Some(unclaimed) = unclaimed else { return poses };
    poses.sort_by(|a, b| a.energy.total_cmp(&b.energy));
    poses.truncate(BEST_FITS);
    let mesh = &own.texture.mesh;
    for pose in &mut poses {
        let covered = unclaimed.share(&mesh.control_points(&pose.nodes), (mesh.size - 1.0).powi(2));
        pose.energy = pose.energy.max(0.0).sqrt() - WORTH * covered;
    }
    poses
}

/// The best `count` of some poses of a model, of those that are at one place the best.
pub(super) fn best_apart(mut starts: Vec<Pose>, count: usize) -> Vec<Pose> {
    starts.sort_by(|a, b| a.energy.total_cmp(&b.energy));
    let mut kept: Vec<Pose> = Vec::new();
    for start in starts {
        if kept.len() == count {
            break;
        }
        if kept.iter().all(|k| mean_distance(&k.nodes, &start.nodes) > SAME_PLACE) {
            kept.push(start);
        }
    }
    kept
}
