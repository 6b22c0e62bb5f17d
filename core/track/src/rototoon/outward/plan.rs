//! Plans the parts that are followed outward: which ones, in which order, and which results are reused.
//!
//! A part's result depends on its key, its corrections, the pictures, and the places of nearer parts. So the parts go
//! from the nearest to the farthest, and parts of the same depth run in parallel. A result is reused if its job is the
//! same as before.
//!
//! Parts that change their places in the order may hide each other, on different frames. One of them goes first then, without
//! what the other one hides of it, and is followed once more when that is known.
//!
//! Where parts came to the place of others ([`apart`](super::apart)), all are followed a second time, without these places.

use super::apart::{Came, came};
use super::finish::track;
use super::{OutwardJob, OutwardTrack};
use crate::contract::error::TrackError;
use crate::contract::job::{Correction, SpanSummary, Termination};
use crate::contract::tasks::{first_of, is_nearer, is_nearer_on_any};
use crate::contract::tracking::{JobReport, PartTrack, Tracking};
use crate::rototoon::mechanisms::Mechanisms;
use crate::rototoon::stage::Kit;
use crate::shared::twins::on_one_place;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Cancelled, FrameNumber, Part, Progress, Scene, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

/// The results of the parts with one key, by the name of the part.
#[derive(Default)]
pub struct Memory {
    known: Results,
    /// The results of the second run, if there was one ([`apart`](super::apart)).
    again: Results,
    /// The results of the first and of the second run for parts that went before one that hides them, when they were followed once more.
    later: [Results; 2],
}

type Results = BTreeMap<String, (OutwardJob, OutwardTrack)>;

/// By part and frame: contours of other parts on whose place it cannot be.
type Taken = BTreeMap<usize, BTreeMap<FrameNumber, Vec<Vec<Point>>>>;

/// Indices of the parts with exactly one key and at least one point.
pub fn subjects(scene: &Scene) -> Vec<usize> {
    let single = |part: &Part| part.keys.len() == 1 && part.point_count() > 0;
    (0..scene.parts.len()).filter(|&p| single(&scene.parts[p])).collect()
}

impl Memory {
    /// Follows all parts with one key, and adds them to what was tracked between keys. The listener of `kit` is told.
    pub(in crate::rototoon) fn run(
        &mut self,
        kit: Kit,
        scene: &Scene,
        tracking: &mut Tracking,
    ) -> Result<(), TrackError> {
        let subjects = subjects(scene);
        let names: BTreeSet<&str> = subjects.iter().map(|&p| scene.parts[p].name.as_str()).collect();
        let [later, later_again] = &mut self.later;
        for results in [&mut self.known, &mut self.again, later, later_again] {
            results.retain(|name, _| names.contains(name.as_str()));
        }
        let counter = Counter { listener: kit.progress, done: Mutex::new(0), all: subjects.len() };
        self.follow(Kit { progress: &counter, ..kit }, scene, (&subjects, &Taken::new()), tracking, &counter)?;
        let came = came(scene, tracking, &subjects);
        if !came.is_empty() {
            let taken = taken(tracking, &came);
            self.follow(Kit { progress: &counter, ..kit }, scene, (&subjects, &taken), tracking, &counter)?;
        }
        tracking.jobs.sort_by_key(|job| (job.part, job.span));
        Ok(())
    }

    /// Follows the subjects from the nearest to the farthest. What is `taken` makes a second run, which has a memory of its own.
    fn follow(
        &mut self,
        kit: Kit,
        scene: &Scene,
        (subjects, taken): (&[usize], &Taken),
        tracking: &mut Tracking,
        counter: &Counter,
    ) -> Result<(), TrackError> {
        let (waves, early) = waves(scene, subjects);
        for wave in waves {
            self.follow_all(kit, scene, (&wave, taken, false), tracking, counter)?;
        }
        for p in early {
            self.follow_all(kit, scene, (&[p], taken, true), tracking, counter)?;
        }
        Ok(())
    }

    /// Follows some parts in parallel, for the first time or `later`.
    fn follow_all(
        &mut self,
        kit: Kit,
        scene: &Scene,
        (wave, taken, later): (&[usize], &Taken, bool),
        tracking: &mut Tracking,
        counter: &Counter,
    ) -> Result<(), TrackError> {
        let jobs: Vec<(usize, OutwardJob)> =
            wave.iter().map(|&p| (p, job(scene, tracking, p, taken.get(&p)))).collect();
        let results: Vec<Result<(OutwardTrack, bool), TrackError>> = jobs
            .par_iter()
            .map(|(_, job)| {
                let known = [&self.known, &self.again, &self.later[0], &self.later[1]].into_iter();
                let mut known = known.filter_map(|memory| memory.get(&job.name));
                let result = match known.find(|(known, _)| known == job) {
                    Some((_, result)) => (result.clone(), false),
                    None => (track(Kit { mechanisms: Mechanisms::default(), ..kit }, job)?, true),
                };
                counter.finished()?;
                Ok(result)
            })
            .collect();
        for ((p, job), result) in jobs.into_iter().zip(results) {
            let (result, solved) = result?;
            put(tracking, p, &result, solved);
            let memory = match (later, taken.is_empty()) {
                (false, true) => &mut self.known,
                (false, false) => &mut self.again,
                (true, first) => &mut self.later[usize::from(!first)],
            };
            memory.insert(job.name.clone(), (job, result));
        }
        Ok(())
    }
}

/// The contours of the hosts where a part came to their place. What the part had there is forgotten: it hides nothing.
fn taken(tracking: &mut Tracking, came: &Came) -> Taken {
    let on = |&(frame, host): &(FrameNumber, usize)| Some((frame, tracking.parts[host].tracks.get(&frame)?.clone()));
    let mut taken = Taken::new();
    for (&guest, frames) in came {
        for (frame, contour) in frames.iter().filter_map(on) {
            taken.entry(guest).or_default().entry(frame).or_default().push(contour);
        }
    }
    for (&guest, frames) in came {
        for (frame, _) in frames {
            tracking.parts[guest].tracks.remove(frame);
        }
    }
    taken
}

/// Groups of parts of which none is in front of another, the nearest first; and the parts that went before one that is in
/// front of them on some frame.
fn waves(scene: &Scene, subjects: &[usize]) -> (Vec<Vec<usize>>, Vec<usize>) {
    let footage = scene.footage.first..=scene.footage.last;
    let waits = |p: usize, o: usize| is_nearer_on_any(scene, o, p, footage.clone());
    let (mut open, mut waves, mut early) = (subjects.to_vec(), Vec::new(), Vec::new());
    while !open.is_empty() {
        let wave = first_of(&open, |p| scene.parts[p].depth, waits);
        open.retain(|p| !wave.contains(p));
        early.extend(wave.iter().copied().filter(|&p| open.iter().any(|&o| waits(p, o))));
        waves.push(wave);
    }
    (waves, early)
}

fn job(
    scene: &Scene,
    tracking: &Tracking,
    p: usize,
    taken: Option<&BTreeMap<FrameNumber, Vec<Vec<Point>>>>,
) -> OutwardJob {
    let (part, footage) = (&scene.parts[p], &scene.footage);
    let (frame, key) = part.keys.first_key_value().map(|(&f, k)| (f, k.clone())).unwrap_or_default();
    let corrected: BTreeSet<FrameNumber> = part.pins.keys().chain(part.centers.keys()).copied().collect();
    let correction = |&f: &FrameNumber| {
        let (pins, center) = (part.pins.get(&f).cloned().unwrap_or_default(), part.centers.get(&f).copied());
        let acts = f != frame
            && (footage.first..=footage.last).contains(&f)
            && !part.is_absent(f)
            && (!pins.is_empty() || center.is_some());
        acts.then_some((f, Correction { pins, center }))
    };
    let nearer: Vec<usize> = (0..scene.parts.len())
        .filter(|&o| {
            let other = &scene.parts[o];
            other.closed && other.point_count() > 2 && is_nearer_on_any(scene, o, p, footage.first..=footage.last)
        })
        .collect();
    // A part that came to the place of a key does not hide it: the artist saw what is there.
    let came = |o: usize, f: FrameNumber, contour: &[Point]| {
        f == frame && !scene.parts[o].keys.contains_key(&f) && on_one_place(contour, &key)
    };
    let contours = |f: FrameNumber| -> Vec<Vec<Point>> {
        let nearer = nearer.iter().filter(|&&o| is_nearer(scene, o, p, f));
        let on = |&o: &usize| tracking.parts[o].tracks.get(&f).or_else(|| scene.parts[o].keys.get(&f)).map(|c| (o, c));
        let hides = nearer.filter_map(on).filter(|(o, contour)| !came(*o, f, contour));
        hides.map(|(_, contour)| contour.clone()).collect()
    };
    let hidden = (footage.first..=footage.last).map(|f| (f, contours(f))).filter(|(_, c)| !c.is_empty());
    let occluders = if nearer.is_empty() { BTreeMap::new() } else { hidden.collect() };
    OutwardJob {
        name: part.name.clone(),
        closed: part.closed,
        frame,
        key,
        footage: [footage.first, footage.last],
        corrections: corrected.iter().filter_map(correction).collect(),
        absent: part.absent.clone(),
        occluders,
        taken: taken.cloned().unwrap_or_default(),
        size: (footage.width, footage.height),
    }
}

fn put(tracking: &mut Tracking, part: usize, found: &OutwardTrack, solved: bool) {
    let frames: Vec<FrameNumber> = found.tracks.keys().copied().collect();
    let (Some(&first), Some(&last)) = (frames.first(), frames.last()) else { return };
    tracking.parts[part] =
        PartTrack { tracks: found.tracks.clone(), confidence: found.confidence.clone(), ends: found.ends.clone() };
    let summary = SpanSummary {
        termination: Termination::PathChosen,
        iterations: found.steps,
        initial_cost: found.cost,
        final_cost: found.cost,
    };
    tracking.jobs.retain(|job| job.part != part);
    tracking.jobs.push(JobReport { part, span: Span { first, last }, summary, solved });
}

/// Counts finished parts. It cannot measure the share within a part, because the length of a track is not known before.
struct Counter<'a> {
    listener: &'a dyn Progress,
    done: Mutex<usize>,
    all: usize,
}

impl Counter<'_> {
    fn finished(&self) -> Result<(), Cancelled> {
        self.tell("Tracking", 1)
    }

    fn tell(&self, step: &str, more: usize) -> Result<(), Cancelled> {
        // The listener is called under the lock, so that the reported share never decreases.
        let mut done = self.done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        *done += more;
        self.listener.report(step, (*done as f64 / self.all.max(1) as f64).min(1.0))
    }
}

impl Progress for Counter<'_> {
    fn report(&self, step: &str, _done: f64) -> Result<(), Cancelled> {
        self.tell(step, 0)
    }
}

/// A stretch of a longer work.
pub(crate) struct Portion<'a> {
    /// Who is told of the whole.
    pub listener: &'a dyn Progress,
    /// Share of the complete work at the beginning and at the end of the section.
    pub range: [f64; 2],
}

impl Progress for Portion<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        let [from, to] = self.range;
        self.listener.report(step, from + (to - from) * done)
    }
}
