//! The joint choice of a stretch: connects [`joint`](super::joint) with the members of a stretch and the mechanisms in use.
//!
//! Members without free drawings have nothing to choose. Their paths, leads and margins are empty. Bonds are found before the
//! first choice of a stretch and stay the same for every later one.

use super::joint::figure::Figure;
use super::joint::figure::canvas::Canvas;
use super::joint::figure::claims::Claims;
use super::joint::lead::{Lead, leads};
use super::joint::margin::LARGEST;
use super::joint::shadow::Memory;
use super::joint::{Bonds, Contender, choose, companion, jumps, margins, tie};
use super::mechanisms::{Mechanism, Mechanisms};
use super::pooled::Pooled;
use crate::contract::tasks::Task;
use rototoon_base::scene::Scene;
use std::sync::Arc;

/// The hypothesis that each member of a stretch follows on each of its drawings.
pub(super) type Paths = Vec<Vec<usize>>;

/// A choice that is to be made.
pub(super) struct Choice<'a> {
    members: &'a [&'a Pooled],
    /// The members that have a choice, in the order of the contenders.
    free: Vec<usize>,
    contenders: Vec<Contender<'a>>,
    jump: f64,
    mechanisms: Mechanisms,
}

impl<'a> Choice<'a> {
    /// The choice of the `members` of a stretch, which is a list of tasks.
    pub fn new(
        (scene, tasks, stretch): (&'a Scene, &[Task], &[usize]),
        members: &'a [&'a Pooled],
        mechanisms: Mechanisms,
    ) -> Self {
        let free: Vec<usize> = (0..members.len()).filter(|&m| members[m].models.is_some()).collect();
        let contender = |&m: &usize| {
            let (task, pooled) = (tasks[stretch[m]], members[m]);
            let part = &scene.parts[task.part];
            Some(Contender {
                part: task.part,
                span: task.span,
                depth: part.depth,
                depths: &part.depths,
                hides: mechanisms.has(Mechanism::Hiding) && part.closed && part.point_count() > 2,
                drawings: &pooled.drawings,
                pools: &pooled.pools,
                models: pooled.models.as_deref()?,
            })
        };
        let mut named: Vec<(usize, Contender)> = free.iter().filter_map(|m| Some((*m, contender(m)?))).collect();
        named.sort_by(|(_, a), (_, b)| a.order(b));
        let (free, contenders): (Vec<usize>, Vec<Contender>) = named.into_iter().unzip();
        let jump = if mechanisms.has(Mechanism::Jumps) { jumps::measured(&contenders) } else { 0.0 };
        Self { members, free, contenders, jump, mechanisms }
    }

    /// The paths that each member would take alone.
    pub fn start(&self) -> Paths {
        self.members.iter().map(|member| member.path.clone()).collect()
    }

    /// What holds the contenders together. `canvas` is the figure that they explain.
    pub fn bonds(&self, canvas: Option<Arc<Canvas>>) -> Bonds {
        let start = self.of_contenders(&self.start());
        let corrected = |c: usize, d: usize| self.members[self.free[c]].corrected(d);
        let companions = || companion::find(&self.contenders, &start, &corrected);
        let has = |mechanism| self.mechanisms.has(mechanism);
        Bonds {
            ties: if has(Mechanism::Joints) { tie::find(&self.contenders) } else { Vec::new() },
            companions: if has(Mechanism::Companions) { companions() } else { Vec::new() },
            canvas,
        }
    }

    /// The paths of the members, chosen together from the `start` paths. Members that are not `chosen` keep theirs.
    pub fn paths(&self, bonds: &Bonds, (start, chosen): (Paths, &[bool]), memory: &mut Memory) -> Paths {
        if !self.mechanisms.has(Mechanism::JointChoice) {
            return start;
        }
        let from = (self.of_contenders(&start), &self.of_contenders(chosen)[..]);
        self.of_members(choose(&self.contenders, bonds, self.jump, from, memory))
    }

    /// The leads of each member.
    pub fn leads(&self, bonds: &Bonds, paths: &Paths) -> Vec<Vec<Lead>> {
        if !self.mechanisms.has(Mechanism::JointChoice) {
            return vec![Vec::new(); self.members.len()];
        }
        self.of_members(leads(&self.contenders, bonds, &self.of_contenders(paths)))
    }

    /// Which of the figure's blocks each member covers on these paths. `None` without a figure.
    pub fn claims(&self, bonds: &Bonds, paths: &Paths, memory: &mut Memory) -> Option<Claims> {
        let canvas = bonds.canvas.as_ref().filter(|_| self.mechanisms.has(Mechanism::JointChoice))?;
        let names: Vec<&str> = self.free.iter().map(|&m| &*self.members[m].job.name).collect();
        let figure = Figure::new(canvas, &self.contenders, memory);
        Some(figure.claims(&self.contenders, &names, &self.of_contenders(paths)))
    }

    /// The margin of each member on each of its drawings. Empty for members that are not `chosen`.
    pub fn margins(&self, bonds: &Bonds, (paths, chosen): (&Paths, &[bool]), memory: &mut Memory) -> Vec<Vec<f64>> {
        if !self.mechanisms.has(Mechanism::JointChoice) {
            return self.members.iter().map(|member| vec![LARGEST; member.drawings.len()]).collect();
        }
        let of = (&self.of_contenders(paths)[..], &self.of_contenders(chosen)[..]);
        self.of_members(margins(&self.contenders, bonds, self.jump, of, memory))
    }

    /// The contenders' part of a list of the members.
    fn of_contenders<T: Clone>(&self, of_members: &[T]) -> Vec<T> {
        self.free.iter().map(|&m| of_members[m].clone()).collect()
    }

    /// A list of the members from one of the contenders, empty for the other members.
    fn of_members<T: Clone + Default>(&self, of_contenders: Vec<T>) -> Vec<T> {
        let mut all = vec![T::default(); self.members.len()];
        for (&m, own) in self.free.iter().zip(of_contenders) {
            all[m] = own;
        }
        all
    }
}
