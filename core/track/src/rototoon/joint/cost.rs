//! The cost of a choice of hypotheses: their fit, given their occluders, torn joints, and companions that come apart.

use super::companion::Companions;
use super::contender::{Contender, Paths, State};
use super::figure::{Figure, Rest};
use super::lengths::{Lengths, Moving};
use super::shadow::Shadows;
use super::tie::Tie;
use crate::rototoon::select::Smoothness;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Span};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The parts of a joint choice, their occlusions and their joints.
pub struct Scene<'a> {
    /// The parts with their hypotheses.
    pub contenders: &'a [Contender<'a>],
    /// Which hypotheses hide which samples.
    pub shadows: &'a Shadows,
    /// The joints between parts.
    pub ties: &'a [Tie],
    /// The parts that go with others.
    pub companions: &'a Companions<'a>,
    /// How far drawings jump ([`super::jumps`]), in working pixels.
    pub jump: f64,
    /// By contender: the lengths of motion between its hypotheses.
    pub lengths: &'a [Arc<Lengths>],
    /// What the hypotheses explain of the figure. None where colours do not tell.
    pub figure: Option<&'a Figure>,
}

impl Scene<'_> {
    /// √U of a state of contender `c`: its fit given the choices of the contenders that may hide it.
    pub fn look(&self, c: usize, (d, h): State, paths: &Paths) -> f64 {
        let frame = self.contenders[c].frame_of(d);
        let mut hidden = vec![0u64; self.shadows.words(c, d, h)];
        for &n in self.shadows.in_front_of(c) {
            let Some(near) = self.contenders[n].drawing_at(frame) else { continue };
            if let Some(mask) = self.shadows.mask((c, n), (d, h), paths[n][near]) {
                hidden.iter_mut().zip(mask).for_each(|(all, one)| *all |= one);
            }
        }
        self.shadows.cost(c, (d, h), &hidden)
    }

    /// The drawing of contender `b` that is joined to drawing `d` of contender `a`. A key within the other part's span ends one
    /// span and begins the next; it counts with the one that it ends.
    pub(super) fn meeting(&self, a: usize, d: usize, b: usize) -> Option<usize> {
        let (own, other) = (&self.contenders[a], &self.contenders[b]);
        let near = other.drawing_at(own.frame_of(d))?;
        let begins = |drawing: usize, span: Span, outer: Span| drawing == 0 && span.first > outer.first;
        (!begins(d, own.span, other.span) && !begins(near, other.span, own.span)).then_some(near)
    }

    /// Cost of one joint between two contenders in their states.
    pub fn joint(&self, tie: &Tie, (a, state_a): (usize, State), (b, state_b): (usize, State)) -> f64 {
        let place = |c: usize, (d, h): State| {
            let hypothesis = &self.contenders[c].pools[d][h];
            tie.place(c, hypothesis.model, &hypothesis.pose.nodes)
        };
        match (place(a, state_a), place(b, state_b)) {
            (Some(p), Some(q)) => Tie::cost(p, q),
            _ => 0.0,
        }
    }

    /// Cost of the pair of companions with an index in their states, given in either order.
    pub(super) fn together(&self, index: usize, a: (usize, State), b: (usize, State)) -> f64 {
        let [part, body] = if self.companions.pairs[index].parts[0] == a.0 { [a.1, b.1] } else { [b.1, a.1] };
        self.companions.cost(index, part, body)
    }

    /// The cost of motion of a contender.
    pub fn smoothness(&self, c: usize) -> Smoothness {
        Smoothness::among_jumps(self.contenders[c].models[0].texture.mesh.size, self.jump)
    }

    /// The cost of motion between the hypotheses of a contender.
    pub fn moving(&self, c: usize) -> Moving<'_> {
        Moving { lengths: &self.lengths[c], smoothness: self.smoothness(c) }
    }

    /// The part of the joint energy that depends on the choices of the contenders in `who`, which have the same drawings.
    pub fn energy(&self, who: &[usize], paths: &Paths) -> f64 {
        let on = |d: usize| {
            let states: Vec<(usize, State)> = who.iter().map(|&c| (c, (d, paths[c][d]))).collect();
            self.unexplained(&self.rest((who, d), paths), &states)
        };
        let unexplained: f64 = (0..paths[who[0]].len()).map(on).sum();
        self.without_figure(who, paths) + unexplained
    }

    /// By how much the energy falls from some paths to others. What is unexplained counts once for each frame on which a drawing of
    /// a contender begins that has another path; of these the smallest area is taken, as in a move of two.
    pub fn gain(&self, from: &Paths, to: &Paths) -> f64 {
        let who: Vec<usize> = (0..from.len()).filter(|&c| from[c] != to[c]).collect();
        if who.is_empty() {
            return 0.0;
        }
        let frames: BTreeSet<FrameNumber> = who.iter().flat_map(|&c| self.contenders[c].frames()).collect();
        let energy = |paths: &Paths| {
            let unexplained = |figure: &Figure| -> f64 {
                frames.iter().map(|&frame| figure.on_frame(self.contenders, (&who, frame), paths)).sum()
            };
            self.without_figure(&who, paths) + self.figure.map_or(0.0, unexplained)
        };
        energy(from) - energy(to)
    }

    /// The same as [`Scene::energy`] without what stays unexplained.
    fn without_figure(&self, who: &[usize], paths: &Paths) -> f64 {
        let mut seen: Vec<usize> = who.to_vec();
        who.iter().for_each(|&c| seen.extend(self.shadows.behind(c)));
        seen.sort_unstable();
        seen.dedup();
        let looks = |&c: &usize| {
            let states = paths[c].iter().copied().enumerate();
            states.map(|state| self.look(c, state, paths)).sum::<f64>()
        };
        let smooth = |&c: &usize| {
            let pools = paths[c].iter().zip(&**self.contenders[c].pools);
            let points: Vec<&[Point]> = pools.map(|(&h, pool)| &pool[h].points[..]).collect();
            self.smoothness(c).of_path(&points, &self.contenders[c].gaps())
        };
        seen.iter().map(looks).sum::<f64>() + who.iter().map(smooth).sum::<f64>() + self.torn(who, paths)
    }

    /// What the contenders that are not in `who` leave of the figure on a drawing of those that are.
    pub fn rest(&self, (who, d): (&[usize], usize), paths: &Paths) -> Option<Rest> {
        self.figure.map(|figure| figure.rest(self.contenders, (who, d), paths))
    }

    /// Cost of what stays unexplained of a rest with these states.
    pub fn unexplained(&self, rest: &Option<Rest>, states: &[(usize, State)]) -> f64 {
        self.figure.zip(rest.as_ref()).map_or(0.0, |(figure, rest)| figure.cost(rest, states))
    }

    /// Cost of the joints and companions of the contenders in `who`. What is between two of them counts once.
    fn torn(&self, who: &[usize], paths: &Paths) -> f64 {
        let touched = |parts: &[usize; 2]| who.iter().any(|c| parts.contains(c));
        let along = |[a, b]: [usize; 2], cost: &dyn Fn((usize, State), (usize, State)) -> f64| -> f64 {
            let on = |(d, &h): (usize, &usize)| {
                let near = self.meeting(a, d, b)?;
                Some(cost((a, (d, h)), (b, (near, paths[b][near]))))
            };
            paths[a].iter().enumerate().filter_map(on).sum()
        };
        let ties = self.ties.iter().filter(|tie| touched(&tie.parts));
        let pairs = self.companions.pairs.iter().enumerate().filter(|(_, pair)| touched(&pair.parts));
        ties.map(|tie| along(tie.parts, &|a, b| self.joint(tie, a, b))).sum::<f64>()
            + pairs.map(|(k, pair)| along(pair.parts, &|a, b| self.together(k, a, b))).sum::<f64>()
    }
}
