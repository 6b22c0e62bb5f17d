//! The chosen poses made into tracks: aligned where the part is seen, blended with the other key's model, refined by the
//! contour's own templates where those fit better after it, made to obey the artist's corrections.

use super::TrackError;
use super::confidence;
use super::job::{SpanSummary, SpanTrack, Termination};
use super::lattice::texture::Cover;
use super::pool::{Hypothesis, hypothesis};
use super::refine::{Frame, Key, Refiner};
use super::rototoon::{Pooled, keys_only};
use super::stage::{Kit, Stage};
use super::tasks::Task;
use crate::geometry::{Point, polygon};
use crate::scene::Scene;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

/// Distance in working pixels at which the other key's model is no longer taken to mean the same place.
const AGREEMENT: f64 = 4.0;
/// Nearer contours further away than this from a part (working pixels) do not matter to it.
const REACH: f64 = 24.0;

/// Fall of the templates' cost that makes a refined contour worth taking.
const WORTH: f64 = 0.01;

/// What a part's track is made from, apart from its pools and the pictures.
#[derive(Clone, PartialEq)]
pub(super) struct Finish {
    /// The chosen hypothesis of each drawing.
    chosen: Vec<usize>,
    /// By drawing: contours of nearer parts that reach the part, in working pixels.
    occluders: Vec<Vec<Vec<Point>>>,
}

impl Finish {
    /// The plan of member `m` of a stretch, whose paths are chosen.
    pub fn of(
        scene: &Scene,
        tasks: &[Task],
        stretch: &[usize],
        members: &[&Pooled],
        paths: &[Vec<usize>],
        m: usize,
    ) -> Self {
        let own = members[m];
        let chosen = |k: usize, d: usize| &members[k].pools[d][paths[k][d]];
        let scale = super::features::working_scale(own.job.size.1);
        let around = |d: usize| {
            let first = own.job.span.first + own.drawings[d].first as i32;
            let (low, high) = polygon::bounds(&chosen(m, d).points).unwrap_or_default();
            let near = |contour: &Vec<Point>| {
                let (a, b) = polygon::bounds(contour).unwrap_or_default();
                a.x < high.x + REACH && a.y < high.y + REACH && b.x > low.x - REACH && b.y > low.y - REACH
            };
            let of_member = |k: usize| {
                let (task, part) = (tasks[stretch[k]], &scene.parts[tasks[stretch[k]].part]);
                if task.depth <= tasks[stretch[m]].depth || !part.closed || part.point_count() <= 2 {
                    return None;
                }
                let span = members[k].job.span;
                if first < span.first || first > span.last {
                    return None;
                }
                if let Some(key) = part.keys.get(&first) {
                    return Some(key.iter().map(|&p| p / scale).collect());
                }
                let index = (first - span.first) as usize;
                let drawing = members[k].drawings.iter().position(|x| x.first <= index && index <= x.last)?;
                Some(chosen(k, drawing).points.clone())
            };
            (0..members.len()).filter_map(of_member).filter(near).collect()
        };
        let free = own.models.is_some();
        let drawings = if free { own.drawings.len() } else { 0 };
        let occluders = (0..drawings).map(around).collect();
        Self { chosen: paths[m].clone(), occluders }
    }
}

/// The track of a part whose path is chosen.
pub(super) fn finish(kit: Kit, pooled: &Pooled, plan: &Finish) -> Result<SpanTrack, TrackError> {
    if pooled.models.is_none() {
        return Ok(keys_only(&pooled.job));
    }
    let mut stage = Stage::set(kit, &pooled.job, pooled.models.clone())?;
    let width = stage.width();
    stage.covers = plan.occluders.iter().map(|contours| Cover::new(contours, width)).collect();
    let stage = &stage;
    let last = stage.drawings.len() - 1;
    let refiner = refiner(stage);
    let drawings: Vec<(Vec<Hypothesis>, Vec<Point>)> = (0..=last)
        .into_par_iter()
        .map(|d| {
            kit.progress.report("Tracking", 0.9)?;
            let mut pool = pooled.pools[d].clone();
            if d != 0 && d != last && !plan.occluders[d].is_empty() {
                let chosen = &pool[plan.chosen[d]];
                let pose = stage.models[chosen.model].seen(&stage.scenery(chosen.model, d), &chosen.pose.nodes);
                pool[plan.chosen[d]] = hypothesis(stage, d, chosen.model, pose, None);
            }
            let share = stage.drawings[d].first as f64 / (stage.job.span.len() - 1) as f64;
            let rough = blended(&pool, plan.chosen[d], share);
            let points = match &refiner {
                Some(refiner) if d != 0 && d != last => refined(stage, refiner, d, share, rough),
                _ => rough,
            };
            Ok((pool, points))
        })
        .collect::<Result<_, TrackError>>()?;
    Ok(track(stage, pooled, &drawings, &plan.chosen))
}

/// The contour's own templates, where it has a shape.
fn refiner(stage: &Stage) -> Option<Refiner> {
    let points = [0, 1].map(|k: usize| stage.job.keys[k].iter().map(|&p| p / stage.scale).collect::<Vec<_>>());
    let key = |k: usize| Key {
        points: &points[k],
        picture: &stage.features[k * (stage.features.len() - 1)],
        cover: &stage.models[k].cover,
    };
    Refiner::new([key(0), key(1)], stage.job.closed)
}

/// Refined control points of a drawing, or the rough ones where the templates fit those no worse.
fn refined(stage: &Stage, refiner: &Refiner, d: usize, share: f64, rough: Vec<Point>) -> Vec<Point> {
    let pins = stage.correction(d).map(|c| c.pins.iter().map(|(&j, &p)| (j, p / stage.scale)).collect());
    let frame = Frame { picture: &stage.features[d], cover: &stage.covers[d], share, pins: pins.unwrap_or_default() };
    let fine = refiner.refine(&frame, &rough);
    if refiner.cost(&frame, &fine) < refiner.cost(&frame, &rough) - WORTH { fine } else { rough }
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

fn track(stage: &Stage, pooled: &Pooled, drawings: &[(Vec<Hypothesis>, Vec<Point>)], path: &[usize]) -> SpanTrack {
    let last = stage.job.span.len() - 1;
    let (mut points, mut sure) = (Vec::new(), Vec::new());
    for (d, drawing) in stage.drawings.iter().enumerate() {
        let (pool, found) = &drawings[d];
        let confidence = confidence::of_drawing(&stage.models, &stage.features[d], &stage.covers[d], pool, path[d]);
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
        (0..drawings.len()).map(|d| drawings[d].0[choose(d)].pose.energy).sum::<f64>() / drawings.len() as f64
    };
    let summary = SpanSummary {
        termination: Termination::PathChosen,
        iterations: pooled.steps,
        initial_cost: energy(&|_| 0),
        final_cost: energy(&|d| path[d]),
    };
    SpanTrack { points, confidence: sure, summary }
}
