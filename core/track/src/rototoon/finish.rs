//! Makes tracks from the chosen poses.
//!
//! 1. The chosen pose is aligned to the samples that nearer parts leave visible.
//! 2. It is blended with the nearest pose of the other key's model.
//! 3. The contour is refined by its own colour templates, if they fit better afterwards.
//! 4. The artist's corrections are enforced, after contours were steadied ([`super::steady`]).

use super::confidence;
use super::corrected::freed;
use super::evidence::{self, Evidence, Reference, Seen, with_margin};
use super::joint::margin::LARGEST;
use super::lattice::texture::Cover;
use super::mechanisms::Mechanism;
use super::pool::{Hypothesis, hypothesis};
use super::pooled::Pooled;
use super::refine::{Frame, Key, Refiner};
use super::stage::{Kit, Stage};
use crate::contract::error::TrackError;
use crate::contract::job::{SpanSummary, SpanTrack, Termination};
use crate::contract::tasks::{Task, is_nearer};
use crate::shared::features::working_scale;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::Scene;
use std::sync::{Arc, OnceLock};

/// Distance in working pixels at which the weight of the other key's model in the blend has fallen to 1/e.
const AGREEMENT: f64 = 4.0;
/// Nearer contours further away than this from a part (working pixels) are ignored.
const REACH: f64 = 24.0;

/// The plan of a part's track: with the pools and the pictures it determines the track.
#[derive(Clone, PartialEq)]
pub(super) struct Finish {
    /// The chosen hypothesis of each drawing.
    chosen: Vec<usize>,
    /// By drawing: contours of nearer parts near the part, in working pixels.
    occluders: Vec<Vec<Vec<Point>>>,
}

impl Finish {
    /// The plan of member `m` of a stretch whose paths are chosen. `hiding` says whether nearer parts hide it.
    pub fn of(
        scene: &Scene,
        tasks: &[Task],
        stretch: &[usize],
        members: &[&Pooled],
        paths: &[Vec<usize>],
        (m, hiding): (usize, bool),
    ) -> Self {
        let own = members[m];
        let chosen = |k: usize, d: usize| &members[k].pools[d][paths[k][d]];
        let scale = crate::shared::features::working_scale(own.job.size.1);
        let around = |d: usize| {
            let first = own.job.span.first + own.drawings[d].first as i32;
            let (low, high) = polygon::bounds(&chosen(m, d).points).unwrap_or_default();
            let near = |contour: &Vec<Point>| {
                let (a, b) = polygon::bounds(contour).unwrap_or_default();
                a.x < high.x + REACH && a.y < high.y + REACH && b.x > low.x - REACH && b.y > low.y - REACH
            };
            let of_member = |k: usize| {
                let (task, part) = (tasks[stretch[k]], &scene.parts[tasks[stretch[k]].part]);
                let is_nearer = is_nearer(scene, task.part, tasks[stretch[m]].part, first);
                if !hiding || !is_nearer || !part.closed || part.point_count() <= 2 {
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
                let drawing = members[k].drawing_at(index)?;
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

/// A track, its sources, and the intermediate results that the next run may reuse. The sources contain the complete
/// pools, not only the chosen poses: other hypotheses are blended in and affect the confidence.
#[derive(Clone)]
pub(super) struct Finished {
    pub source: Arc<Pooled>,
    pub plan: Finish,
    tools: Arc<Tools>,
    settled: Vec<Settled>,
    /// By drawing: the margin of the joint choice, which depends on other parts too.
    margins: Vec<f64>,
    /// The track of the last run.
    pub track: Option<SpanTrack>,
}

/// The result for one drawing.
#[derive(Clone)]
struct Settled {
    /// The chosen pose aligned to its visible samples; none if nothing hides the part.
    seen: Option<Hypothesis>,
    /// Control points in working pixels.
    points: Vec<Point>,
    /// What is seen at each control point; empty on the keys' drawings.
    evidence: Vec<Seen>,
    /// By round of refining again: control points before and after, as in the last run.
    again: Vec<[Vec<Point>; 2]>,
}

impl Finished {
    /// The control points on each drawing as they were found, in working pixels. None for a part without free drawings.
    pub fn points(&self) -> Vec<Vec<Point>> {
        self.settled.iter().map(|settled| settled.points.clone()).collect()
    }

    /// The control points of each drawing, refined once more from those that are `drawn`, in working pixels. Keys stay. What
    /// was refined in the same round of the last run from the same points is not refined again.
    pub fn refined_again(&self, kit: Kit, round: usize, drawn: &[Vec<Point>]) -> Result<Vec<Vec<Point>>, TrackError> {
        let last = drawn.len().saturating_sub(1);
        let known = |d: usize| {
            let before = self.settled[d].again.get(round).filter(|[from, _]| *from == drawn[d]);
            if d == 0 || d == last { Some(&drawn[d]) } else { before.map(|[_, to]| to) }
        };
        if (0..drawn.len()).all(|d| known(d).is_some()) {
            return Ok((0..drawn.len()).filter_map(known).cloned().collect());
        }
        let mut stage = Stage::set(kit, &self.source.job, self.source.models.clone())?;
        let width = stage.width();
        stage.covers = self.plan.occluders.iter().map(|contours| Cover::new(contours, width)).collect();
        let stage = &stage;
        let refines = kit.mechanisms.has(Mechanism::Refinement);
        let refiner = self.tools.refiner(stage).filter(|_| refines);
        let refined_on = |d: usize| {
            kit.progress.report("Tracking", 0.95)?;
            Ok(match (known(d), &refiner) {
                (Some(points), _) => points.clone(),
                (None, Some(refiner)) => refiner.polished(&frame(stage, d), drawn[d].clone()),
                (None, None) => drawn[d].clone(),
            })
        };
        (0..drawn.len()).into_par_iter().with_max_len(1).map(refined_on).collect()
    }

    /// Remembers what a round of refining again made of each drawing. Rounds come in their order.
    pub fn remember(&mut self, round: usize, from: &[Vec<Point>], to: &[Vec<Point>]) {
        for ((settled, from), to) in self.settled.iter_mut().zip(from).zip(to) {
            settled.again.truncate(round);
            settled.again.push([from.clone(), to.clone()]);
        }
    }

    /// Of each frame of the span: its drawing, and the evidence about each control point, which is empty where the part is absent.
    pub fn evidence(&self) -> Vec<(usize, Vec<Evidence>)> {
        let of = |index: usize| match self.source.drawing_at(index) {
            Some(d) if !self.settled.is_empty() => (d, self.evidence_on(d)),
            drawing => (drawing.unwrap_or(0), Vec::new()),
        };
        (0..self.source.job.span.len()).map(of).collect()
    }

    /// The evidence about each control point on a drawing.
    fn evidence_on(&self, d: usize) -> Vec<Evidence> {
        self.settled[d].evidence.iter().map(|seen| with_margin(seen, self.margins[d])).collect()
    }

    fn same_models(&self, source: &Pooled) -> bool {
        self.source.models.as_ref().zip(source.models.as_ref()).is_some_and(|(a, b)| Arc::ptr_eq(a, b))
    }

    /// The tools, if everything that they depend on is the same again: the keys, the frames that show their drawings, and what
    /// hides the part there. A correction of a held frame may begin a key's drawing elsewhere.
    fn tools(&self, source: &Pooled, plan: &Finish) -> Option<&Arc<Tools>> {
        let drawings = [&*self.source, source].map(|pooled| pooled.drawings.first().zip(pooled.drawings.last()));
        let occluders = [&self.plan, plan].map(|plan| plan.occluders.first().zip(plan.occluders.last()));
        let same = drawings[0] == drawings[1] && occluders[0] == occluders[1];
        (self.same_models(source) && same).then_some(&self.tools)
    }

    /// The settled result of drawing `d`, if everything that it depends on is the same again.
    fn of(&self, source: &Pooled, plan: &Finish, d: usize) -> Option<&Settled> {
        let old = &self.source;
        let e = old.drawings.iter().position(|drawing| *drawing == source.drawings[d])?;
        if !self.same_models(source) {
            return None;
        }
        let same = self.plan.chosen[e] == plan.chosen[d]
            && self.plan.occluders[e] == plan.occluders[d]
            && old.corrections(e) == source.corrections(d)
            && old.pools[e] == source.pools[d];
        same.then(|| &self.settled[e])
    }
}

/// What is found of a part whose path is chosen. `before` is the part's result of the last run.
pub(super) fn finish(
    kit: Kit,
    pooled: &Arc<Pooled>,
    plan: Finish,
    before: Option<&Finished>,
) -> Result<Finished, TrackError> {
    if pooled.models.is_none() {
        let (source, tools) = (pooled.clone(), Arc::default());
        return Ok(Finished { source, plan, tools, settled: Vec::new(), margins: Vec::new(), track: None });
    }
    let mut stage = Stage::set(kit, &pooled.job, pooled.models.clone())?;
    stage.center_reach = pooled.center_reach.clone();
    let width = stage.width();
    stage.covers = plan.occluders.iter().map(|contours| Cover::new(contours, width)).collect();
    let stage = &stage;
    // What was settled with other tools is another result.
    let kept = before.and_then(|before| Some((before, before.tools(pooled, &plan)?.clone())));
    let (before, tools) = kept.map_or_else(Default::default, |(before, tools)| (Some(before), tools));
    let settled: Vec<Settled> = (0..stage.drawings.len())
        .into_par_iter()
        .with_max_len(1)
        .map(|d| {
            kit.progress.report("Tracking", 0.9)?;
            let known = before.and_then(|before| before.of(pooled, &plan, d));
            Ok(known.cloned().unwrap_or_else(|| settle(stage, pooled, &plan, &tools, d)))
        })
        .collect::<Result<_, TrackError>>()?;
    let margins = vec![LARGEST; settled.len()];
    Ok(Finished { source: pooled.clone(), plan, tools, settled, margins, track: None })
}

/// What all drawings of a part share. It is made when the first drawing needs it, and kept while it would be the same.
#[derive(Default)]
struct Tools {
    refiner: OnceLock<Option<Refiner>>,
    reference: OnceLock<Reference>,
}

impl Tools {
    /// The contour's colour templates. None for contours without a shape.
    fn refiner(&self, stage: &Stage) -> Option<&Refiner> {
        self.refiner.get_or_init(|| refiner(stage)).as_ref()
    }
}

fn settle(stage: &Stage, pooled: &Pooled, plan: &Finish, tools: &Tools, d: usize) -> Settled {
    let (pool, chosen) = (&pooled.pools[d], plan.chosen[d]);
    let between = d != 0 && d != stage.drawings.len() - 1;
    let seen = (between && !plan.occluders[d].is_empty()).then(|| {
        let chosen = &pool[chosen];
        freed(stage, d, chosen.model, &chosen.pose.nodes).unwrap_or_else(|| {
            let pose = stage.models[chosen.model].seen(&stage.scenery(chosen.model, d), &chosen.pose.nodes);
            hypothesis(stage, d, chosen.model, pose, None)
        })
    });
    let share = stage.share(d);
    let own = seen.as_ref().unwrap_or(&pool[chosen]);
    let mixes = stage.kit.mechanisms.has(Mechanism::Blending);
    let rough = if mixes { blended(pool, own, share) } else { own.points.clone() };
    if !between {
        return Settled { seen: None, points: rough, evidence: Vec::new(), again: Vec::new() };
    }
    let refiner = tools.refiner(stage);
    let points = match refiner {
        Some(refiner) if stage.kit.mechanisms.has(Mechanism::Refinement) => {
            refiner.improved(&frame(stage, d), rough.clone())
        }
        _ => rough.clone(),
    };
    let reference = tools.reference.get_or_init(|| Reference::new(stage));
    let found = evidence::Found { drawing: d, pool, own, rough: &rough, points: &points, share };
    let evidence = evidence::of_drawing(stage, refiner, reference, &found);
    Settled { seen, points, evidence, again: Vec::new() }
}

/// The contour's colour templates. None for contours without a shape.
fn refiner(stage: &Stage) -> Option<Refiner> {
    let points = [0, 1].map(|k: usize| stage.job.keys[k].iter().map(|&p| p / stage.scale).collect::<Vec<_>>());
    let key = |k: usize| Key {
        points: &points[k],
        picture: &stage.features[k * (stage.features.len() - 1)],
        cover: &stage.models[k].cover,
    };
    let mut refiner = Refiner::new([key(0), key(1)], stage.job.closed)?;
    if !stage.kit.mechanisms.has(Mechanism::FigureAndGround) {
        refiner.forget_figure();
    }
    if !stage.kit.mechanisms.has(Mechanism::WideTemplates) {
        refiner.forget_wide();
    }
    if !stage.kit.mechanisms.has(Mechanism::Noise) {
        refiner.forget_noise();
    }
    Some(refiner)
}

/// What refinement sees of a drawing.
fn frame<'a>(stage: &'a Stage, d: usize) -> Frame<'a> {
    let pins = stage.correction(d).map(|c| c.pins.iter().map(|(&j, &p)| (j, p / stage.scale)).collect());
    let share = stage.share(d);
    Frame { picture: &stage.features[d], cover: &stage.covers[d], share, pins: pins.unwrap_or_default() }
}

/// The control points of the chosen hypothesis, blended with the nearest hypothesis of the other model. The weight of
/// the other model grows with the nearness of its key and falls with the distance between the two places.
fn blended(pool: &[Hypothesis], own: &Hypothesis, share: f64) -> Vec<Point> {
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

impl Finished {
    /// The track with these control points on each drawing, in working pixels, and these margins of the joint choice.
    pub fn track_along(&mut self, drawn: &[Vec<Point>], margins: Vec<f64>) -> SpanTrack {
        self.margins = margins;
        let (pooled, job) = (&self.source, &self.source.job);
        if self.settled.is_empty() {
            return job.keys_only();
        }
        let (last, last_drawing, scale) = (job.span.len() - 1, drawn.len() - 1, working_scale(job.size.1));
        // Where the part is absent it has no track in the end.
        let mut points: Vec<Vec<Point>> = (0..=last).map(|index| job.interpolated(index)).collect();
        let mut sure = vec![vec![0.0; job.keys[0].len()]; last + 1];
        for (d, drawing) in pooled.drawings.iter().enumerate() {
            let evidence = self.evidence_on(d);
            let confidence = if evidence.is_empty() {
                vec![confidence::HELD; drawn[d].len()]
            } else {
                evidence.iter().map(confidence::probability).collect()
            };
            // Frames held from a key get exactly its points.
            let key = (d == 0 || d == last_drawing).then(|| &job.keys[usize::from(d != 0)]);
            for index in drawing.first..=drawing.last {
                let found = || drawn[d].iter().map(|&p| p * scale).collect();
                let mut on_frame = key.map_or_else(found, Clone::clone);
                job.enforce_within(pooled.center_reach[d] * scale, index, &mut on_frame);
                points[index] = on_frame;
                sure[index] = if index == 0 || index == last { vec![1.0; drawn[d].len()] } else { confidence.clone() };
            }
        }
        for (&index, correction) in &job.corrections {
            correction.pins.keys().for_each(|&j| sure[index][j] = 1.0);
        }
        SpanTrack { points, confidence: sure, summary: self.summary() }
    }

    fn summary(&self) -> SpanSummary {
        let (pools, settled) = (&self.source.pools, &self.settled);
        let mean = |of: &dyn Fn(usize) -> f64| (0..settled.len()).map(of).sum::<f64>() / settled.len() as f64;
        let seen = |d: usize| settled[d].seen.as_ref().unwrap_or(&pools[d][self.plan.chosen[d]]);
        SpanSummary {
            termination: Termination::PathChosen,
            iterations: self.source.steps,
            initial_cost: mean(&|d| pools[d][0].pose.energy),
            final_cost: mean(&|d| seen(d).pose.energy),
        }
    }
}
