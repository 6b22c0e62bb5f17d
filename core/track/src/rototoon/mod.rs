//! The default tracker: deformable texture lattices, carried from both keys, with a joint choice for all parts.
//!
//! **Why.** Cartoons have flat colours and hard lines, so a part's appearance at a key identifies it almost completely.
//! A chain that always compares with the key cannot drift. Two chains in opposite directions cover what appears or is
//! hidden on one side.
//!
//! **How.**
//!
//! 1. **Pools.** Each key gives a [`Model`](propagate::Model): the part's colours on a lattice that bends. Both
//!    models are carried drawing by drawing through the span, one forwards and one backwards, and each is always
//!    compared with its own key. Where they disagree, both are searched in the complete picture ([`pool`]). The
//!    artist's corrections add to the pools ([`corrected`]).
//! 2. **Choice.** All parts of a stretch of time choose their paths through the pools together ([`joint`]): nearer
//!    parts hide farther ones, and connected parts stay together. The choice adds hypotheses to the pools, and is made
//!    again ([`mend`](mod@mend)).
//! 3. **Finish.** The chosen poses are aligned once more to the samples that nearer parts leave visible, and their
//!    contours are refined ([`finish`](mod@finish)). On a film that wobbles they are steadied ([`steady`]).
//! 4. **Corrective keys.** A key that a part has on its own corrects the tracks of all parts ([`corrective`](mod@corrective)). The
//!    part itself is tracked between all of its keys afterwards ([`finer`](mod@finer)).
//! 5. **Untouched parts.** Where a correction is not of the part itself, it moves the part only if that makes it clearly surer
//!    ([`untouched`](mod@untouched)).
//! 6. **Outward.** Parts with a single key are followed from it, after all others ([`outward`]).
//!
//! 7. **Holds.** Frames that show one drawing of a part over a background that moves take one contour ([`holds`]).
//! 8. **Exchanges.** Parts that look alike and may have changed places are doubted ([`exchange`](mod@exchange)).
//!
//! **Cache.** The tracks of a stretch can be kept beyond the program ([`cached`](mod@cached)).
//!
//! **Memory.** Each step is a pure function of its input, and its last result is kept. A pin on one part does not
//! change the pools of other parts. Stretches without a change keep their choices ([`chosen`]), and drawings without one what
//! was looked for there ([`mend`](mod@mend)). The tracks of other parts are computed again only if the choice changes them.
//!
//! Work is handed to threads piece by piece (`with_max_len`): if a thread had several pieces, the others would wait for
//! it at the end.
//!
//! **Limits.** A part must look similar at its keys and between them. Two-dimensional rotation and bending are
//! followed; a part that turns its other side to the viewer needs a key. Pictures may be at most [`WIDEST`] times as
//! wide as high.

mod alike;
mod cached;
mod choice;
mod chosen;
pub mod confidence;
mod corrected;
mod corrective;
pub mod evidence;
mod exchange;
mod facts;
mod figures;
mod finer;
mod finish;
mod fold;
mod holds;
pub mod joint;
pub mod lattice;
pub mod mechanisms;
mod mend;
pub mod outward;
pub mod pool;
mod pooled;
mod pooling;
mod pools;
pub mod propagate;
pub mod refine;
mod run;
pub mod search;
pub mod select;
pub mod stage;
mod starts;
mod steadied;
pub mod steady;
pub mod through;
mod turns;
mod untouched;

use crate::contract::cache::Cache;
use crate::contract::error::TrackError;
use crate::contract::tasks::{SharedProgress, Task, tasks};
use crate::contract::tracking::{SceneSolver, Tracking};
use crate::shared::drawings::Drawing;
use crate::shared::look::kind::Decided;
use crate::shared::look::{Kind, Looks};
use crate::shared::store::Store;
use crate::shared::twins;
use cached::Stretches;
use figures::Figures;
use finer::Film;
use finish::{Finish, Finished, finish};
use joint::shadow::Memory;
use mechanisms::{Mechanism, Mechanisms};
use mend::{Extended, Guide};
use outward::plan::Portion;
use pooled::Pooled;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::scene::{Footage, FrameSource, Progress, Scene, Span};
use run::READING;
use stage::Kit;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use untouched::Untouched;

/// Largest ratio of width to height of a picture. The tracker works on [540 lines](crate::shared::features), so a strip of few
/// lines would be enlarged to hundreds of millions of pixels.
pub const WIDEST: usize = 32;

/// The solver of the default preset.
#[derive(Default)]
pub struct Rototoon {
    /// What was computed from the pictures themselves.
    store: Store,
    /// What was computed from their looks, if these are others.
    looked: Store,
    kind: Decided,
    plain: BTreeMap<(String, Span), Arc<Pooled>>,
    corrected: BTreeMap<(String, Span), Arc<Pooled>>,
    mended: BTreeMap<(String, Span), Mended>,
    finished: BTreeMap<(String, Span), Finished>,
    shadows: Memory,
    figures: Figures,
    choices: chosen::Memory,
    untouched: Untouched,
    outward: outward::plan::Memory,
    holds: holds::Memory,
    mechanisms: Mechanisms,
    cache: Option<Arc<dyn Cache>>,
    /// The spans that were known before this call. What is remembered needs no cache.
    remembered: BTreeSet<(String, Span)>,
    /// The stretches of the last run, if there is a cache.
    stretches: Option<Stretches>,
    /// Drawings of the spans that came from it.
    from_cache: cached::Drawings,
    /// The frames of the last run in windows of which the store keeps all, if it does not keep all of the film.
    windows: Vec<Span>,
    /// In tests: of how many frames the store keeps what was computed.
    pub(crate) room: Option<usize>,
}

/// Pools with the hypotheses from a joint choice, and their sources.
#[derive(Clone)]
struct Mended {
    source: Arc<Pooled>,
    guide: Guide,
    extended: Extended,
    result: Arc<Pooled>,
}

impl SceneSolver for Rototoon {
    fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError> {
        if too_wide(&scene.footage) {
            let Footage { width, height, .. } = scene.footage;
            return Err(TrackError::TooWide { width, height, limit: WIDEST });
        }
        let film = Film::new(scene, self.mechanisms);
        let tasks = tasks(film.broad());
        let single = outward::plan::subjects(scene).len();
        let between = tasks.len() as f64 / (tasks.len() + single).max(1) as f64;
        let first = Portion { listener: progress, range: [0.0, between] };
        let looks = self.look(scene, frames, &first)?;
        let mut tracking = self.track_between(&film, &tasks, &looks, &first)?;
        if single > 0 {
            let rest = Portion { listener: progress, range: [between, 1.0] };
            let mut outward = std::mem::take(&mut self.outward);
            let result = outward.run(self.kit(&looks, &rest), scene, &mut tracking);
            self.outward = outward;
            result?;
        }
        let stretches = self.stretches.take();
        let unknown = stretches.as_ref().map(|stretches| self.recall(stretches));
        if self.mechanisms.has(Mechanism::Holds) {
            self.unite(&looks, scene, &mut tracking, progress)?;
        }
        if self.mechanisms.has(Mechanism::Exchanges) {
            exchange::doubt(self.kit(&looks, progress), scene, &mut tracking)?;
        }
        if let (Some(stretches), Some(unknown)) = (&stretches, unknown) {
            self.note(stretches, &unknown, &looks);
        }
        twins::doubt(scene, &mut tracking.parts);
        Ok(tracking)
    }

    fn forget(&mut self) {
        *self = Self::new(self.mechanisms, self.cache.take());
    }
}

/// Whether footage is more than [`WIDEST`] times as wide as high.
pub fn too_wide(footage: &Footage) -> bool {
    footage.width > WIDEST * footage.height
}

impl Rototoon {
    /// A solver without any results yet, with the mechanisms given. It finds and keeps results in a cache, if it has one.
    pub fn new(mechanisms: Mechanisms, cache: Option<Arc<dyn Cache>>) -> Self {
        Self { mechanisms, cache, ..Self::default() }
    }

    /// For studies of confidence: the evidence of the last run.
    pub fn evidence(&self) -> evidence::BySpan {
        self.finished.iter().map(|(key, finished)| (key.clone(), finished.evidence())).collect()
    }

    /// The looks of the pictures. If they are of another kind than in the last run, its results are forgotten.
    fn look<'a>(
        &mut self,
        scene: &Scene,
        frames: &'a dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Looks<'a>, TrackError> {
        let before = self.kind.kind();
        let kind = if self.mechanisms.has(Mechanism::Looks) {
            self.kind.decide(scene, &self.store, frames, progress)?
        } else {
            Kind::Painted
        };
        if kind != before {
            let (store, kind) = (std::mem::take(&mut self.store), std::mem::take(&mut self.kind));
            *self = Self { store, kind, ..Self::new(self.mechanisms, self.cache.take()) };
        }
        Ok(Looks { frames, kind })
    }

    /// Access to the pictures and their looks.
    fn kit<'a>(&'a self, looks: &'a Looks<'a>, progress: &'a dyn Progress) -> Kit<'a> {
        let store = if looks.kind == Kind::Painted { &self.store } else { &self.looked };
        Kit { store, frames: looks, plain: (&self.store, looks.frames), progress, mechanisms: self.mechanisms }
    }

    /// Tracks the parts between their keys.
    fn track_between(
        &mut self,
        film: &Film,
        tasks: &[Task],
        frames: &Looks,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError> {
        let scene = film.broad();
        self.remembered = self.plain.keys().cloned().collect();
        self.windows.clear();
        let unread = if tasks.iter().all(|task| self.knows(scene, task)) { 0.0 } else { READING };
        // A run without corrections and one with them, if there are any. The first one reads the pictures.
        let half = if film.untouched().is_some() { 0.5 * (1.0 + unread) } else { 0.0 };
        let first = Portion { listener: progress, range: [0.0, half] };
        let untouched = self.untouched(film, tasks, frames, &first)?;
        let rest = Portion { listener: progress, range: [half, 1.0] };
        let (mut done, finer) = self.run(scene, Some(film), tasks, frames, &rest)?;
        match untouched {
            Some(untouched) => self.settle(scene, tasks, &untouched, &mut done),
            None => self.untouched.keep(scene, &done),
        }
        self.keep_only(film);
        Ok(film.assembled(tasks, done, finer))
    }

    /// Gives parts that are held one contour, and remembers what it found, also after an error.
    fn unite(
        &mut self,
        looks: &Looks,
        scene: &Scene,
        tracking: &mut Tracking,
        progress: &dyn Progress,
    ) -> Result<(), TrackError> {
        let mut memory = std::mem::take(&mut self.holds);
        let kit = self.kit(looks, progress);
        let mut windows = self.windows.iter();
        let looked = windows.try_for_each(|&window| holds::look_at(window, kit, (scene, tracking), &mut memory));
        let found = looked.and_then(|()| holds::unite(kit, scene, tracking, &memory));
        let (memory, result) = found.map_or_else(|error| (memory, Err(error)), |memory| (memory, Ok(())));
        self.holds = memory;
        result
    }

    /// The drawings of a span, found in this run or an earlier one, or kept in the cache.
    fn drawings(&self, key: &(String, Span)) -> Option<&[Drawing]> {
        self.plain.get(key).map(|plain| &*plain.drawings).or_else(|| self.from_cache.get(key).map(|found| &**found))
    }

    /// Whether a task was solved in an earlier run.
    fn knows(&self, scene: &Scene, task: &Task) -> bool {
        self.plain.contains_key(&(scene.parts[task.part].name.clone(), task.span))
    }

    /// Forgets the spans that no longer exist because keys were added or removed.
    fn keep_only(&mut self, film: &Film) {
        let present = film.keys();
        self.plain.retain(|key, _| present.contains(key));
        self.from_cache.retain(|key, _| present.contains(key));
        self.corrected.retain(|key, _| present.contains(key));
        self.mended.retain(|key, _| present.contains(key));
        self.finished.retain(|key, _| present.contains(key));
        self.figures.keep_only(&present);
        self.choices.keep_only(&present);
        self.untouched.keep_only(&present);
        let mended = self.mended.values().map(|mended| &mended.result);
        let pooled = self.plain.values().chain(self.corrected.values()).chain(mended).chain(self.untouched.pooled());
        self.shadows.keep_only(pooled.map(|pooled| &pooled.pools));
    }

    /// Finds the contours of a stretch's members on their chosen paths. Returns which were found in this run: a result with
    /// the same pools and the same plan as before is kept.
    fn finish_all(
        &mut self,
        stretch: &[usize],
        mended: &[Arc<Pooled>],
        plans: Vec<Finish>,
        frames: &Looks,
        shared: &SharedProgress,
    ) -> Result<Vec<bool>, TrackError> {
        let results: Vec<Result<Option<Finished>, TrackError>> = stretch
            .par_iter()
            .with_max_len(1)
            .zip(plans)
            .zip(mended)
            .map(|((&t, plan), source)| {
                let before = self.finished.get(&source.key());
                if before.is_some_and(|known| Arc::ptr_eq(&known.source, source) && known.plan == plan) {
                    return Ok(None);
                }
                let progress = shared.of(t);
                let kit = self.kit(frames, &progress);
                finish(kit, source, plan, before).map(Some)
            })
            .collect();
        let mut new = Vec::with_capacity(results.len());
        for result in results {
            let result = result?;
            new.push(result.is_some());
            if let Some(found) = result {
                self.finished.insert(found.source.key(), found);
            }
        }
        Ok(new)
    }
}
