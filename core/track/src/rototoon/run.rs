//! One run over a scene: from the pictures to the tracks of all parts between their keys.
//!
//! Tasks whose spans share more than a key frame belong to one **stretch**. Stretches have nothing to do with each other, but for the film's
//! [wobble](super::steady), which is measured before any of them is finished.
//!
//! **Memory.** A store keeps what was computed from as many frames as it has [room](crate::shared::store::Store::room) for. In a longer film each part would go through all frames, and
//! find none of them kept. So the pools are made for as many stretches at a time as there is room for, and the stretches are finished one after the
//! other. Each frame is read twice then, and not once for each part. Where there is room for all frames, all pools are made together, since more threads find
//! work then.

use super::cached::{Cached, Entry, range};
use super::finer::{Broad, Film, Found};
use super::finish::Finish;
use super::outward::plan::Portion;
use super::pooled::Pooled;
use super::stage::Kit;
use super::steady::{Member, Wobble};
use super::untouched::Done;
use super::{Looks, Rototoon};
use crate::contract::error::TrackError;
use crate::contract::tasks::{SharedProgress, Steps, Task};
use crate::rototoon::mechanisms::Mechanism;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::scene::{FrameNumber, Progress, Scene, Span};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Share of the progress that reading and comparing the pictures take in a first run. On the sample cartoon it is two fifths of the time.
pub(super) const READING: f64 = 0.4;
/// Share of that which the pictures' marks take, if there is a cache.
const MARKING: f64 = 0.2;
/// Share of the rest which the pictures' features take; the flows between drawings take what is left.
const FEATURES: f64 = 0.5;

/// What a run works on, and the pools that it has made so far.
struct Run<'a> {
    scene: &'a Scene,
    film: Option<&'a Film<'a>>,
    tasks: &'a [Task],
    stretches: Vec<Vec<usize>>,
    /// By stretch: whether nothing of it is remembered from before the film was tracked this time.
    anew: Vec<bool>,
    frames: &'a Looks<'a>,
    shared: SharedProgress<'a>,
    cached: Option<Cached>,
    /// Whether the store has no room for all frames.
    is_long: bool,
    /// By task: its pools, and whether they were made in this run.
    pooled: Vec<Option<Arc<Pooled>>>,
    fresh: Vec<bool>,
}

impl Run<'_> {
    /// The cache, for a stretch of which nothing is remembered.
    fn cache_of(&self, stretch: usize) -> Option<&Cached> {
        self.cached.as_ref().filter(|_| self.anew[stretch])
    }

    /// The same, for new results. A picture that has changed during the run gets none.
    fn cache_to_fill(&self, stretch: usize) -> Option<&Cached> {
        let range = range(self.tasks, &self.stretches[stretch]);
        self.cache_of(stretch).filter(|cached| cached.still_shows(range, self.frames))
    }
}

impl Rototoon {
    /// Tracks the parts of a scene together, and with a `film` also those with corrective keys between all of their keys.
    pub(super) fn run(
        &mut self,
        scene: &Scene,
        film: Option<&Film>,
        tasks: &[Task],
        frames: &Looks,
        progress: &dyn Progress,
    ) -> Result<(Done, Found), TrackError> {
        let reading = |t: usize| if self.knows(scene, &tasks[t]) { 0.0 } else { READING };
        let shared = SharedProgress::new(progress, scene, tasks).with_reading(reading);
        let stretches = stretches(tasks);
        let all = Vec::from_iter(0..tasks.len());
        let marking = Portion { listener: &shared.reading(&all), range: [0.0, MARKING] };
        // What is remembered needs no cache: corrections are made one after the other, and are not to wait for a disk.
        let remembered = |t: usize| self.remembered.contains(&(scene.parts[tasks[t].part].name.clone(), tasks[t].span));
        let anew = |stretch: &Vec<usize>| !stretch.iter().any(|&t| remembered(t));
        let anew: Vec<bool> = stretches.iter().map(anew).collect();
        let cached = match anew.contains(&true) {
            true => self.cached((scene, film), (tasks, &stretches), frames, &marking)?,
            false => None,
        };
        let (pooled, fresh) = (vec![None; tasks.len()], vec![false; tasks.len()]);
        let mut run =
            Run { scene, film, tasks, stretches, anew, frames, shared, cached, is_long: false, pooled, fresh };
        let wobble = self.pool_and_measure(&mut run)?;
        let (mut done, mut finer): (Done, Found) = (vec![None; tasks.len()], Found::new());
        let mut new = Vec::new();
        for s in 0..run.stretches.len() {
            let entry = match self.taken(&run, s, &wobble) {
                Some(entry) => entry,
                None => self.found(&mut run, s, &wobble)?,
            };
            // Also where the tracks were known: the listener may cancel.
            run.stretches[s].iter().try_for_each(|&t| run.shared.of(t).report("Tracking", 1.0))?;
            new.push(entry.is_new() && run.cache_to_fill(s).is_some());
            entry.into_run((tasks, &run.stretches[s]), &mut done, &mut finer);
        }
        let ranges = run.stretches.iter().map(|stretch| range(tasks, stretch)).zip(new);
        self.stretches = run.cached.map(|cached| cached.done(ranges));
        Ok((done, finer))
    }

    /// Makes the pools of all stretches of which the cache does not know where their members go alone, and measures how much the film wobbles.
    fn pool_and_measure(&mut self, run: &mut Run) -> Result<Wobble, TrackError> {
        let count = run.stretches.len();
        let mut alone: Vec<Option<Vec<Member>>> = (0..count).map(|s| run.cache_of(s)?.alone(s)).collect();
        let missing: Vec<usize> = (0..count).filter(|&s| alone[s].is_none()).collect();
        for batch in self.batches(run, &missing)? {
            self.pool_stretches(run, &batch)?;
            for s in batch {
                let stretch = &run.stretches[s];
                let members = self.alone(stretch, &run.pooled);
                if let Some(cached) = run.cache_to_fill(s) {
                    cached.keep_alone(s, &members);
                }
                alone[s] = Some(members);
            }
        }
        Ok(self.wobble(&Vec::from_iter(alone.into_iter().flatten())))
    }

    /// Some stretches in groups, each with as many frames as the store has room for, or of one stretch.
    fn batches(&mut self, run: &mut Run, stretches: &[usize]) -> Result<Vec<Vec<usize>>, TrackError> {
        let ranges: Vec<Span> = stretches.iter().map(|&s| range(run.tasks, &run.stretches[s])).collect();
        let Some(first) = ranges.first() else { return Ok(Vec::new()) };
        let reading = run.shared.reading(&[]);
        let kit = self.kit(run.frames, &reading);
        let all = ranges.iter().map(Span::len).sum();
        [kit.store, kit.plain.0].into_iter().for_each(|store| store.expect(all));
        let room = self.room.map_or_else(|| kit.store.room(kit.frames, first.first), Ok)?;
        run.is_long = all > room;
        let mut batches: Vec<(usize, Vec<usize>)> = Vec::new();
        for (&s, range) in stretches.iter().zip(&ranges) {
            match batches.last_mut() {
                Some((frames, batch)) if *frames + range.len() <= room => {
                    *frames += range.len();
                    batch.push(s);
                }
                _ => batches.push((range.len(), vec![s])),
            }
        }
        let batches: Vec<Vec<usize>> = batches.into_iter().map(|(_, batch)| batch).collect();
        let window = |batch: &Vec<usize>| {
            let tasks: Vec<usize> = batch.iter().flat_map(|&s| run.stretches[s].iter().copied()).collect();
            range(run.tasks, &tasks)
        };
        if run.is_long {
            self.windows.extend(batches.iter().map(window));
        }
        Ok(batches)
    }

    /// Reads the pictures of some stretches, and makes the pools of their members.
    fn pool_stretches(&mut self, run: &mut Run, stretches: &[usize]) -> Result<(), TrackError> {
        let asked: Vec<usize> = stretches.iter().flat_map(|&s| run.stretches[s].iter().copied()).collect();
        let new = asked.iter().map(|&t| run.tasks[t]).filter(|task| !self.knows(run.scene, task));
        let spans: BTreeSet<Span> = new.map(|task| task.span).collect();
        let reading = run.shared.reading(&asked);
        let begun = if run.cached.is_some() { MARKING } else { 0.0 };
        read(self.kit(run.frames, &Portion { listener: &reading, range: [begun, 1.0] }), &spans)?;
        let of = (run.scene, run.tasks, &asked[..]);
        self.pool_all(of, (&mut run.pooled, &mut run.fresh), run.frames, &run.shared)
    }

    /// The tracks of a stretch from the cache, if its pools were not made.
    fn taken(&mut self, run: &Run, s: usize, wobble: &Wobble) -> Option<Entry> {
        let (tasks, stretch) = (run.tasks, &run.stretches[s]);
        if stretch.iter().any(|&t| run.pooled[t].is_some()) {
            return None;
        }
        let entry = run.cache_of(s)?.tracks(s, wobble, (run.scene, tasks, stretch))?;
        for (&t, drawings) in stretch.iter().zip(&entry.drawings) {
            let name = run.scene.parts[tasks[t].part].name.clone();
            self.from_cache.insert((name, tasks[t].span), drawings.clone());
        }
        Some(entry)
    }

    /// Finds the tracks of a stretch, and keeps them.
    fn found(&mut self, run: &mut Run, s: usize, wobble: &Wobble) -> Result<Entry, TrackError> {
        if run.stretches[s].iter().any(|&t| run.pooled[t].is_none()) {
            self.pool_stretches(run, &[s])?;
        } else if run.is_long {
            let frames = range(run.tasks, &run.stretches[s]).frames().collect::<Vec<_>>();
            let reading = run.shared.reading(&run.stretches[s]);
            let kit = self.kit(run.frames, &reading);
            kit.store.read(kit.frames, &frames, kit.progress)?;
        }
        let entry = self.stretch(run, s, wobble)?;
        if let Some(cached) = run.cache_to_fill(s) {
            cached.keep_tracks(s, wobble, &entry);
        }
        Ok(entry)
    }

    /// The tracks of a stretch whose pools are made.
    fn stretch(&mut self, run: &Run, s: usize, wobble: &Wobble) -> Result<Entry, TrackError> {
        let Run { scene, tasks, frames, shared, pooled, fresh, .. } = run;
        let stretch = &run.stretches[s];
        let of = (*scene, *tasks, &stretch[..]);
        let sources: Vec<Arc<Pooled>> = stretch.iter().filter_map(|&t| pooled[t].clone()).collect();
        let first = self.first_choice(of, sources.clone(), frames, &shared.of(stretch[0]))?;
        let guides = (&first.paths[..], &first.leads[..], first.claims.as_ref());
        let mended = self.mend_all(stretch, &sources, guides, frames, shared)?;
        let second = self.second_choice(of, &first, &mended);
        let members: Vec<&Pooled> = mended.iter().map(|m| &**m).collect();
        let paths = &second.paths;
        let hiding = self.mechanisms.has(Mechanism::Hiding);
        let plan = |m: usize| Finish::of(scene, tasks, stretch, &members, paths, (m, hiding));
        let plans = (0..members.len()).map(plan).collect();
        let new = self.finish_all(stretch, &mended, plans, frames, shared)?;
        let drawn = self.steadied(stretch, &mended, wobble, frames, shared)?;
        let tracks = self.tracks(&mended, &new, (drawn, second.margins.clone()));
        let broad = Broad { tasks, stretch, pooled, mended: &mended, paths, wobble };
        let drawings = mended.iter().map(|pooled| pooled.drawings.clone()).collect();
        let mut entry = Entry { drawings, ..Entry::default() };
        for (m, (&t, (track, new))) in stretch.iter().zip(tracks).enumerate() {
            if let Some(film) = run.film {
                for ((_, span), (track, new)) in self.finer(film, &broad, (m, &track), frames, shared)? {
                    entry.finer.push((m, span, track));
                    entry.new_finer.push(new);
                }
            }
            shared.of(t).report("Tracking", 1.0)?;
            entry.tracks.push(track);
            entry.new.push(new || fresh[t]);
        }
        Ok(entry)
    }
}

/// Computes the features and flows of some spans, which many tasks need, before the tasks are given to threads, which would wait
/// for each other.
fn read(kit: Kit, spans: &BTreeSet<Span>) -> Result<(), TrackError> {
    let numbers: BTreeSet<FrameNumber> = spans.iter().flat_map(Span::frames).collect();
    let first = Portion { listener: kit.progress, range: [0.0, FEATURES] };
    kit.plain.0.expect(numbers.len());
    kit.store.read(kit.frames, &Vec::from_iter(numbers), &first)?;
    let mut pairs = BTreeSet::new();
    for span in spans {
        let report = || Ok(kit.progress.report("Reading frames", FEATURES)?);
        let held = kit.held(&Vec::from_iter(span.frames()), &report)?;
        let mut before = span.first;
        for (frame, held) in (span.first + 1..=span.last).zip(held) {
            if !held {
                pairs.extend([(before, frame), (frame, before)]);
                before = frame;
            }
        }
    }
    let rest = Portion { listener: kit.progress, range: [FEATURES, 1.0] };
    let steps = Steps::new(&rest, "Comparing drawings", pairs.len());
    Vec::from_iter(pairs)
        .par_iter()
        .with_max_len(1)
        .try_for_each(|&(from, to)| steps.step(|| kit.store.flow(kit.frames, from, to).map(|_| ())))
}

/// Groups of tasks whose spans share more than a key frame, directly or through others, in the order of time.
fn stretches(tasks: &[Task]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..tasks.len()).collect();
    order.sort_by_key(|&t| (tasks[t].span, t));
    let mut stretches: Vec<(FrameNumber, Vec<usize>)> = Vec::new();
    for t in order {
        let span = tasks[t].span;
        match stretches.last_mut() {
            Some((end, members)) if span.first < *end => {
                *end = (*end).max(span.last);
                members.push(t);
            }
            _ => stretches.push((span.last, vec![t])),
        }
    }
    stretches.into_iter().map(|(_, members)| members).collect()
}
