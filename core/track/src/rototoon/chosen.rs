//! The joint choices of a stretch's members, kept between runs.
//!
//! A stretch is chosen for twice: from the members' pools, and again from the pools with the hypotheses that the first choice
//! adds. Both are pure functions of the pools, of the figure and of where the members are in the scene. So where an edit
//! changes none of them, as in a stretch without it, the last choice is taken.

use super::choice::{Choice, Paths};
use super::joint::Bonds;
use super::joint::figure::canvas::Canvas;
use super::joint::figure::claims::Claims;
use super::joint::lead::Lead;
use super::pooled::Pooled;
use super::{Looks, Rototoon};
use crate::contract::error::TrackError;
use crate::contract::tasks::Task;
use rototoon_base::scene::{FrameNumber, Progress, Scene, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The first choice of a stretch, and what it was made from.
pub(super) struct First {
    members: Vec<Place>,
    sources: Vec<Arc<Pooled>>,
    canvas: Option<Arc<Canvas>>,
    /// What holds the members together.
    bonds: Bonds,
    /// The path of each member.
    pub paths: Paths,
    /// What surer members say, by member.
    pub leads: Vec<Vec<Lead>>,
    /// What each member covers of the figure.
    pub claims: Option<Claims>,
}

/// The second choice of a stretch, and what it was made from.
pub(super) struct Second {
    first: Arc<First>,
    mended: Vec<Arc<Pooled>>,
    /// The path of each member.
    pub paths: Paths,
    /// The margin of each member on each of its drawings.
    pub margins: Vec<Vec<f64>>,
}

/// Index of a member's part, its depth, and its depths on single frames of its span.
type Place = (usize, f64, Vec<(FrameNumber, f64)>);

fn place(scene: &Scene, task: Task) -> Place {
    let (part, Span { first, last }) = (&scene.parts[task.part], task.span);
    let own = part.depths.range(first..=last).map(|(&frame, &depth)| (frame, depth));
    (task.part, part.depth, own.collect())
}

/// What is kept, by name and span of the stretches' first members.
#[derive(Default)]
pub(super) struct Memory {
    first: BTreeMap<(String, Span), Arc<First>>,
    second: BTreeMap<(String, Span), Arc<Second>>,
}

impl Memory {
    /// Forgets the spans that are not among these.
    pub fn keep_only(&mut self, present: &BTreeSet<(String, Span)>) {
        self.first.retain(|key, _| present.contains(key));
        self.second.retain(|key, _| present.contains(key));
    }
}

/// Whether two lists are of the same pools in memory.
fn same(a: &[Arc<Pooled>], b: &[Arc<Pooled>]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| Arc::ptr_eq(a, b))
}

impl Rototoon {
    /// The choice of a stretch's members from their pools.
    pub(super) fn first_choice(
        &mut self,
        (scene, tasks, stretch): (&Scene, &[Task], &[usize]),
        sources: Vec<Arc<Pooled>>,
        frames: &Looks,
        progress: &dyn Progress,
    ) -> Result<Arc<First>, TrackError> {
        let pools: Vec<&Pooled> = sources.iter().map(|source| &**source).collect();
        let canvas = self.canvas(&pools, frames, progress)?;
        let members: Vec<Place> = stretch.iter().map(|&t| place(scene, tasks[t])).collect();
        let key = sources[0].key();
        let drawn = |a: &Option<Arc<Canvas>>| a.as_ref().map(Arc::as_ptr);
        let unchanged = |known: &&Arc<First>| {
            known.members == members && same(&known.sources, &sources) && drawn(&known.canvas) == drawn(&canvas)
        };
        if let Some(known) = self.choices.first.get(&key).filter(unchanged) {
            return Ok(known.clone());
        }
        let choice = Choice::new((scene, tasks, stretch), &pools, self.mechanisms);
        let bonds = choice.bonds(canvas.clone());
        let all = vec![true; pools.len()];
        let paths = choice.paths(&bonds, (choice.start(), &all), &mut self.shadows);
        let leads = choice.leads(&bonds, &paths);
        let claims = choice.claims(&bonds, &paths, &mut self.shadows);
        let first = Arc::new(First { members, sources, canvas, bonds, paths, leads, claims });
        self.choices.first.insert(key, first.clone());
        Ok(first)
    }

    /// The choice of the same members from the pools with the hypotheses that the first choice added.
    pub(super) fn second_choice(
        &mut self,
        (scene, tasks, stretch): (&Scene, &[Task], &[usize]),
        first: &Arc<First>,
        mended: &[Arc<Pooled>],
    ) -> Arc<Second> {
        let key = mended[0].key();
        let unchanged = |known: &&Arc<Second>| Arc::ptr_eq(&known.first, first) && same(&known.mended, mended);
        if let Some(known) = self.choices.second.get(&key).filter(unchanged) {
            return known.clone();
        }
        let pools: Vec<&Pooled> = mended.iter().map(|source| &**source).collect();
        let choice = Choice::new((scene, tasks, stretch), &pools, self.mechanisms);
        let all = vec![true; pools.len()];
        let paths = choice.paths(&first.bonds, (first.paths.clone(), &all), &mut self.shadows);
        let margins = choice.margins(&first.bonds, (&paths, &all), &mut self.shadows);
        let second = Arc::new(Second { first: first.clone(), mended: mended.to_vec(), paths, margins });
        self.choices.second.insert(key, second.clone());
        second
    }
}
