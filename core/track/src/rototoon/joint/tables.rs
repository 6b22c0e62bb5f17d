//! Costs of many states of a contender on one drawing, while the other contenders stay where they are.
//!
//! A move asks for the cost of each hypothesis of a drawing. What the other contenders do to it is the same for all of them,
//! so it is found once: who is in front and where, who is behind and what others hide of it, and which joints hold. The costs
//! are those of [`Scene::look`], added in the same order, so they are the same numbers.

use super::contender::{Paths, State};
use super::cost::Scene;
use super::tie::Tie;

/// A contender and its state.
type Placed = (usize, State);

impl Scene<'_> {
    /// Cost of each of a contender's `states` on a drawing, without motion and without what it leaves unexplained. What is
    /// between it and the contender `but` is left out, except that it may hide it.
    pub fn alone(&self, (c, d): State, states: &[usize], paths: &Paths, but: Option<usize>) -> Vec<f64> {
        let looks = self.looks((c, d), states, paths);
        let bonds = self.bonds_of((c, d), states, paths, but);
        let behind = self.looks_behind((c, d), states, paths, but);
        looks.iter().zip(behind).zip(bonds).map(|((look, behind), bond)| look + behind + bond).collect()
    }

    /// √U of each state, given those in front.
    fn looks(&self, (c, d): State, states: &[usize], paths: &Paths) -> Vec<f64> {
        let in_front = self.in_front((c, d), paths, None);
        let mut hidden = Vec::new();
        let look = |&h: &usize| {
            self.hide(&mut hidden, (c, (d, h)), &in_front);
            self.shadows.cost(c, (d, h), &hidden)
        };
        states.iter().map(look).collect()
    }

    /// √U of each state of a contender (outer index), with each state of a nearer one on the drawing.
    pub fn looks_beneath(
        &self,
        (c, d): State,
        states: &[usize],
        (near, others): (usize, &[usize]),
        paths: &Paths,
    ) -> Vec<f64> {
        let in_front = self.in_front((c, d), paths, Some(near));
        let (mut base, mut hidden) = (Vec::new(), Vec::new());
        let mut table = Vec::with_capacity(states.len() * others.len());
        for &h in states {
            self.hide(&mut base, (c, (d, h)), &in_front);
            let open = self.shadows.cost(c, (d, h), &base);
            table.extend(others.iter().map(|&n| self.covered_too((c, (d, h)), (&base, open), (near, n), &mut hidden)));
        }
        table
    }

    /// Cost of the fit of all contenders behind `c`, for each of its states. The contender `but` is left out.
    pub fn looks_behind(&self, (c, d): State, states: &[usize], paths: &Paths, but: Option<usize>) -> Vec<f64> {
        let mut sums = vec![0.0; states.len()];
        let (mut base, mut hidden) = (Vec::new(), Vec::new());
        for &far in self.shadows.behind(c).iter().filter(|&&far| Some(far) != but) {
            for e in self.contenders[c].meets(d, &self.contenders[far]) {
                let placed = (far, (e, paths[far][e]));
                self.hide(&mut base, placed, &self.in_front((far, e), paths, Some(c)));
                let open = self.shadows.cost(far, placed.1, &base);
                for (sum, &h) in sums.iter_mut().zip(states) {
                    *sum += self.covered_too(placed, (&base, open), (c, h), &mut hidden);
                }
            }
        }
        sums
    }

    /// Cost of the joints and companions of each state. Those with the contender `but` are left out.
    pub fn bonds_of(&self, (c, d): State, states: &[usize], paths: &Paths, but: Option<usize>) -> Vec<f64> {
        let present = |other: usize| {
            let near = self.meeting(c, d, other).filter(|_| Some(other) != but)?;
            Some((other, (near, paths[other][near])))
        };
        let hinge = |tie| Some((tie, present(Tie::other(tie, c)?.0)?));
        let hinges: Vec<(&Tie, Placed)> = self.ties.iter().filter_map(hinge).collect();
        let pairs = self.companions.pairs.iter().enumerate();
        let pairs: Vec<(usize, Placed)> = pairs.filter_map(|(k, pair)| Some((k, present(pair.other(c)?)?))).collect();
        let cost = |&h: &usize| {
            let own = (c, (d, h));
            hinges.iter().map(|(tie, other)| self.joint(tie, own, *other)).sum::<f64>()
                + pairs.iter().map(|(k, other)| self.together(*k, own, *other)).sum::<f64>()
        };
        states.iter().map(cost).collect()
    }

    /// Cost of all joints and companions between each state of a contender (outer index) and each one of another.
    pub fn bonds_between(&self, (a, d): State, of_a: &[usize], (b, e): State, of_b: &[usize]) -> Vec<f64> {
        let joined = |tie: &&Tie| tie.other(a).is_some_and(|(other, _)| other == b);
        let ties: Vec<&Tie> = self.ties.iter().filter(joined).collect();
        let pairs = self.companions.pairs.iter().enumerate().filter(|(_, pair)| pair.other(a) == Some(b));
        let pairs: Vec<usize> = pairs.map(|(k, _)| k).collect();
        let cost = |f: usize, n: usize| {
            let (a, b) = ((a, (d, f)), (b, (e, n)));
            ties.iter().map(|tie| self.joint(tie, a, b)).sum::<f64>()
                + pairs.iter().map(|&k| self.together(k, a, b)).sum::<f64>()
        };
        of_a.iter().flat_map(|&f| of_b.iter().map(move |&n| (f, n))).map(|(f, n)| cost(f, n)).collect()
    }

    /// The contenders that may hide one on a drawing, but for one of them, and their hypotheses.
    fn in_front(&self, (c, d): State, paths: &Paths, but: Option<usize>) -> Vec<(usize, usize)> {
        let frame = self.contenders[c].frame_of(d);
        let placed = |&n: &usize| Some((n, paths[n][self.contenders[n].drawing_at(frame)?]));
        self.shadows.in_front_of(c).iter().filter(|&&n| Some(n) != but).filter_map(placed).collect()
    }

    /// Sets `hidden` to the samples of a contender's state that these hypotheses hide.
    fn hide(&self, hidden: &mut Vec<u64>, (c, (d, h)): Placed, in_front: &[(usize, usize)]) {
        hidden.clear();
        hidden.resize(self.shadows.words(c, d, h), 0);
        for &(n, choice) in in_front {
            if let Some(mask) = self.shadows.mask((c, n), (d, h), choice) {
                hidden.iter_mut().zip(mask).for_each(|(all, one)| *all |= one);
            }
        }
    }

    /// √U of a state whose samples in `base` are hidden by others, if a nearer hypothesis hides some too. `open` is √U without
    /// that.
    fn covered_too(
        &self,
        (c, state): Placed,
        (base, open): (&[u64], f64),
        (near, choice): (usize, usize),
        hidden: &mut Vec<u64>,
    ) -> f64 {
        let Some(mask) = self.shadows.mask((c, near), state, choice) else { return open };
        hidden.clear();
        hidden.extend(base.iter().zip(mask).map(|(all, one)| all | one));
        self.shadows.cost(c, state, hidden)
    }
}
