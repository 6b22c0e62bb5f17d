//! Adds hypotheses after all parts have chosen together.
//!
//! - The chosen poses of the joint choice are tried on the neighbouring drawings, as in [`super::pool`].
//! - Where a part is in doubt but a part that it is joined to is not, the place of the joint is known. So the part is
//!   tried in all directions about the joint. That finds limbs that swung too far or bent too much for the chains, also
//!   in places that the search over the complete picture ranks too low.
//! - Limbs are also tried folded, longer and shorter ([`fold`](super::fold)), and turned at their necks ([`turns`](super::turns)).
//!   What is found that way is carried to the neighbours too.
//! - On a drawing that the artist corrected, what is folded or turned is moved to the corrections first. So a limb with both ends
//!   pinned bends to either side between them. Neither joints nor bodies lead it there: the artist says where it is.
//! - Where a part is not where the body that it goes with takes it, the body's motion is tried.

use super::fold::{JOINTS, bases, folds};
use super::joint::companion::Motions;
use super::joint::figure::claims::{Claims, Unclaimed};
use super::joint::lead::{self, Lead};
use super::lattice::limb::Joint;
use super::lattice::mesh::Binding;
use super::pool::{Hypothesis, Pools, add_new, choose, hypothesis, swept};
use super::pooled::Pooled;
use super::propagate::Model;
use super::stage::Stage;
use super::starts::{best_apart, ranked};
use super::turns::{Turned, turns};
use crate::contract::error::TrackError;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::FrameNumber;
use std::ptr;
use std::sync::Arc;

/// Step of the rotations tried about a joint, in degrees.
const TURN_STEP: usize = 15;
/// Hypotheses kept per model and joint.
const KEPT: usize = 3;
/// Angles in degrees at which a limb is folded that is tried about a joint, to either side.
const FOLDS: [f64; 3] = [30.0, 60.0, 90.0];

/// What the hypotheses depend on that a joint choice adds: the paths, what surer parts say, and by drawing what the other parts
/// leave of the figure near the part. None where nothing is looked for by it.
#[derive(Clone, PartialEq)]
pub(super) struct Guide {
    path: Vec<usize>,
    leads: Vec<Lead>,
    unclaimed: Vec<Option<Unclaimed>>,
}

/// Pools with the hypotheses that a joint choice adds.
#[derive(Clone)]
pub(super) struct Extended {
    pub pools: Arc<Pools>,
    /// By drawing: the number of hypotheses with those from neighbours, but without those that were looked for.
    swept: Vec<usize>,
    /// By drawing: the number with those that were looked for, but without those that were carried on from them.
    found: Vec<usize>,
    /// By drawing: what was looked for, with what the pools had already.
    looked: Vec<Arc<Vec<Hypothesis>>>,
}

impl Guide {
    /// The guide for a part with these pools.
    pub fn new(source: &Pooled, path: &[usize], leads: &[Lead], claims: Option<&Claims>) -> Self {
        let last = source.pools.len().saturating_sub(1);
        let near = |d: usize| {
            let claims = claims.filter(|_| d != 0 && d != last)?;
            let models = source.models.as_ref().filter(|models| models.iter().any(|model| model.limb.is_some()))?;
            let (low, high) = polygon::bounds(&models[0].texture.mesh.rest)?;
            let mut places: Vec<Point> =
                bases(&source.pools[d], path[d]).iter().flat_map(|h| h.points.clone()).collect();
            places.extend(leads.iter().filter_map(|lead| lead.place(d)));
            let reach = Point::splat((high - low).length());
            let (low, high) = polygon::bounds(&places)?;
            let frame = source.job.span.first + source.drawings[d].first as FrameNumber;
            claims.unclaimed(&source.job.name, frame, (low - reach, high + reach))
        };
        Self { path: path.to_vec(), leads: leads.to_vec(), unclaimed: (0..source.pools.len()).map(near).collect() }
    }

    /// The chosen hypothesis of each drawing.
    pub fn path(&self) -> &[usize] {
        &self.path
    }
}

/// Pools that were extended before, and by what guide.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    pub source: &'a Pooled,
    pub guide: &'a Guide,
    pub extended: &'a Extended,
}

impl Known<'_> {
    /// Whether what was looked for on a drawing is what would be found again for a guide: its corrections and what leads there are
    /// the same, and where it is corrected or something of the figure is unclaimed, the poses to begin from are. The corrections
    /// of other drawings do not matter.
    fn holds(&self, source: &Pooled, guide: &Guide, d: usize) -> bool {
        let models = match (&self.source.models, &source.models) {
            (Some(before), Some(now)) => Arc::ptr_eq(before, now),
            _ => false,
        };
        let same_bases = || {
            let before = bases(&self.source.pools[d], self.guide.path[d]);
            let now = bases(&source.pools[d], guide.path[d]);
            before.len() == now.len() && before.iter().zip(now).all(|(a, b)| a.is_at(b))
        };
        models
            && self.source.drawings == source.drawings
            && self.source.corrections(d) == source.corrections(d)
            && lead::same_on(&self.guide.leads, &guide.leads, d)
            && self.guide.unclaimed[d] == guide.unclaimed[d]
            && (guide.unclaimed[d].is_none() && !source.corrected(d) || same_bases())
    }
}

impl Extended {
    /// The pools of a part without free drawings.
    pub fn unchanged(pools: &Arc<Pools>) -> Self {
        let counts: Vec<usize> = pools.iter().map(Vec::len).collect();
        Self { pools: pools.clone(), swept: counts.clone(), found: counts, looked: Vec::new() }
    }
}

/// The pools of `source` with the hypotheses by a guide. What is `known` and still holds is not looked for again.
pub(super) fn mend(
    stage: &Stage,
    source: &Pooled,
    guide: &Guide,
    known: Option<Known>,
) -> Result<Extended, TrackError> {
    let unmoved = known.filter(|known| ptr::eq(known.source, source) && known.guide.path == guide.path);
    let (mut pools, swept): (Pools, Vec<usize>) = match unmoved {
        Some(Known { extended, .. }) => {
            let first = extended.pools.iter().zip(&extended.swept).map(|(pool, &count)| pool[..count].to_vec());
            (first.collect(), extended.swept.clone())
        }
        None => carried_on(stage, source, &guide.path)?,
    };
    let looked: Vec<Arc<Vec<Hypothesis>>> = (0..pools.len())
        .into_par_iter()
        .with_max_len(1)
        .map(|d| match known.filter(|known| known.holds(source, guide, d)) {
            Some(known) => Ok(known.extended.looked[d].clone()),
            None => looked_for(stage, &source.pools, guide, d).map(Arc::new),
        })
        .collect::<Result<_, TrackError>>()?;
    add_new(&mut pools, looked.iter().map(|found| found.to_vec()));
    let found: Vec<usize> = pools.iter().map(Vec::len).collect();
    // What is the same stays the same piece of memory, by which others know it.
    let same = |known: &Extended| {
        known.found == found && known.pools.iter().zip(&pools).all(|(known, pool)| known.starts_with(pool))
    };
    if let Some(Known { extended, .. }) = unmoved.filter(|known| same(known.extended)) {
        return Ok(Extended { looked, ..extended.clone() });
    }
    if !stage.models.iter().all(|model| model.necks.is_empty()) {
        let more = from_found(stage, source, &pools)?;
        add_new(&mut pools, more);
    }
    Ok(Extended { pools: Arc::new(pools), swept, found, looked })
}

/// New hypotheses on the neighbours of drawings on which the part alone would choose one that was found for the guide.
fn from_found(stage: &Stage, source: &Pooled, pools: &Pools) -> Result<Pools, TrackError> {
    let path = choose(stage, pools);
    if path.iter().zip(source.pools.iter()).all(|(&chosen, before)| chosen < before.len()) {
        return Ok(Vec::new());
    }
    Ok(swept(stage, pools, &path, true, &source.carried)?.0)
}

/// The pools with the chosen poses carried to their neighbours, and their numbers of hypotheses.
fn carried_on(stage: &Stage, source: &Pooled, path: &[usize]) -> Result<(Pools, Vec<usize>), TrackError> {
    let mut pools = Pools::clone(&source.pools);
    let (swept, _) = swept(stage, &source.pools, path, true, &source.carried)?;
    add_new(&mut pools, swept);
    let counts = pools.iter().map(Vec::len).collect();
    Ok((pools, counts))
}

/// New hypotheses on a drawing: about the joints with surer parts and where bodies carry the part, if it is not corrected, and
/// folds.
fn looked_for(stage: &Stage, pools: &Pools, guide: &Guide, d: usize) -> Result<Vec<Hypothesis>, TrackError> {
    if d == 0 || d + 1 == pools.len() {
        return Ok(Vec::new());
    }
    let (unclaimed, corrected) = (guide.unclaimed[d].as_ref(), stage.corrected(d));
    let mut found = Vec::new();
    for lead in guide.leads.iter().filter(|_| !corrected) {
        stage.kit.progress.report("Tracking", 0.85)?;
        for model in 0..2 {
            let new = match lead {
                Lead::Hinge { bindings, places } => {
                    places[d].map(|place| about(stage, d, model, (&bindings[model], place), unclaimed))
                }
                Lead::Body(motions) => motions[d].map(|motions| vec![carried(stage, d, model, &motions)]),
            };
            found.extend(new.into_iter().flatten());
        }
    }
    if unclaimed.is_some() || corrected {
        stage.kit.progress.report("Tracking", 0.85)?;
        let bases = bases(&pools[d], guide.path[d]);
        found.extend(folds(stage, d, &bases, unclaimed));
        found.extend(turns(stage, d, &bases, &Turned::Pieces(unclaimed)));
    }
    Ok(found)
}

/// The best poses of a model rotated about its joint, aligned. `place` is the place of the joint in working pixels. A limb is
/// also folded.
fn about(
    stage: &Stage,
    d: usize,
    model: usize,
    (joint, place): (&Binding, Point),
    unclaimed: Option<&Unclaimed>,
) -> Vec<Hypothesis> {
    let (own, scenery) = (&stage.models[model], stage.scenery(model, d));
    let mut starts: Vec<Vec<Point>> = Vec::new();
    for shape in [&own.texture.mesh.rest, &own.bent] {
        let folded = if unclaimed.is_some() { folded(own, shape, joint) } else { Vec::new() };
        for shape in std::iter::once(shape).chain(&folded) {
            let pivot = joint.at(shape);
            for degrees in (0..360).step_by(TURN_STEP) {
                let turn = Point::from_angle((degrees as f64).to_radians());
                starts.push(shape.iter().map(|&q| turn.rotate(q - pivot) + place).collect());
            }
        }
    }
    let kept = best_apart(ranked(own, &scenery, starts.into_iter(), unclaimed), KEPT);
    kept.into_iter().map(|start| hypothesis(stage, d, model, own.realigned(&scenery, &start.nodes), None)).collect()
}

/// A shape of a limb with the half folded that is away from a joint.
fn folded(own: &Model, shape: &[Point], joint: &Binding) -> Vec<Vec<Point>> {
    let Some(limb) = &own.limb else { return Vec::new() };
    let towards_end = limb.place_of(joint) < 0.5;
    let fold = |place: f64| {
        let angles = FOLDS.iter().flat_map(|angle| [-angle, *angle]).map(f64::to_radians);
        angles.map(move |angle| limb.folded(shape, Joint { place, towards_end }, angle))
    };
    JOINTS.into_iter().flat_map(fold).collect()
}

/// The pose of a model that a body's motion carries from the model's key, aligned.
fn carried(stage: &Stage, d: usize, model: usize, motions: &Motions) -> Hypothesis {
    let (own, scenery) = (&stage.models[model], stage.scenery(model, d));
    let nodes: Vec<Point> = own.texture.mesh.rest.iter().map(|&q| motions[model].apply(q)).collect();
    hypothesis(stage, d, model, own.realigned(&scenery, &nodes), None)
}
