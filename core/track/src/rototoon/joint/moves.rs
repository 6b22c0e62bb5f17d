//! Moves that lower the joint energy: new paths for one part, or for two parts at once.
//!
//! With the other parts fixed, the energy of one part's path is a sum over drawings and over pairs and triples of
//! neighbouring drawings. So its best path is found exactly ([`path_of_least_cost`]). For two parts the state of a drawing
//! is a pair of hypotheses, and its motion cost is the sum of both parts' motion costs ([`pairs`](super::pairs)).

use super::contender::{Paths, State};
use super::cost::Scene;
use super::lengths::Among;
use super::pairs::{PairProblem, best_pair};
use super::tie::overlap;
use crate::rototoon::select::{Candidate, path_of_least_cost};
use std::sync::Arc;

/// Hypotheses per part and drawing that a move of two parts considers, and that a move of two that look alike does: such parts may
/// have to change places on many drawings at once, and their places on the other one's are not always among the few of least energy.
const STATES: usize = 6;
const STATES_OF_TWINS: usize = 10;
/// Smaller gains are rounding errors.
pub(super) const LEAST_GAIN: f64 = 1e-9;

/// A move: new paths for one contender or for two.
pub struct Move {
    /// The contenders: one, or two with the same drawings of which one hides the other.
    pub who: Vec<usize>,
    /// The contenders whose choices the result depends on, with those of the move itself.
    pub seen: Vec<usize>,
    /// How many hypotheses of each contender it considers on a drawing. `None`: all.
    most: Option<usize>,
    /// The number of changes when the move was last tried.
    pub tried: Option<usize>,
    /// By drawing: the costs that were found last.
    pub tables: Vec<Arc<Table>>,
}

/// What a move costs on a drawing.
pub struct Table {
    /// The number of changes when it was found.
    at: usize,
    /// By contender of the move: the hypotheses.
    states: Vec<Vec<usize>>,
    /// Cost of each hypothesis, or of each pair of them. The second contender's one is the inner index.
    costs: Vec<f64>,
}

/// New paths of contenders.
pub type Proposal = Vec<(usize, Vec<usize>)>;

/// When each contender's choice last changed on each drawing, as a count of changes.
pub struct Changes {
    /// The number of changes.
    pub count: usize,
    last: Vec<Vec<usize>>,
}

impl Changes {
    /// No changes yet of these paths.
    pub fn none(paths: &Paths) -> Self {
        Self { count: 0, last: paths.iter().map(|path| vec![0; path.len()]).collect() }
    }

    /// Whether a path that a move depends on has changed after the change number `since`. If not, the move would give
    /// the same result again.
    pub fn seen(&self, by: &Move, since: usize) -> bool {
        by.seen.iter().any(|&c| self.last[c].iter().any(|last| *last > since))
    }

    /// Changes the paths by a proposal.
    pub fn make(&mut self, new: Proposal, paths: &mut [Vec<usize>]) {
        self.count += 1;
        for (c, path) in new {
            let changed = self.last[c].iter_mut().zip(path.iter().zip(&paths[c])).filter(|(_, (new, old))| new != old);
            changed.for_each(|(last, _)| *last = self.count);
            paths[c] = path;
        }
    }
}

impl Move {
    /// A move of these contenders that was not tried yet.
    pub fn new(scene: &Scene, who: Vec<usize>) -> Self {
        let most = match who[..] {
            [a, b] if scene.are_twins(a, b) => Some(STATES_OF_TWINS),
            [_, _] => Some(STATES),
            _ => None,
        };
        Self { seen: scene.seen_by(&who), who, most, tried: None, tables: Vec::new() }
    }
}

impl Scene<'_> {
    /// What a move gives while the other contenders are fixed: new paths (none if they do not lower the energy), and the costs
    /// by drawing.
    pub fn proposal(&self, of: &Move, paths: &Paths, changes: &Changes) -> (Option<Proposal>, Vec<Arc<Table>>) {
        let table = |d: usize| {
            let states: Vec<Vec<usize>> = of.who.iter().map(|&c| self.states(of.most, (c, d), paths)).collect();
            let known =
                of.tables.get(d).filter(|known| known.states == states && !self.differs(of, (d, known.at), changes));
            known.cloned().unwrap_or_else(|| {
                let costs = match of.who[..] {
                    [c] => self.costs((c, d), &states[0], paths),
                    [far, near] => self.pair_costs([far, near], d, [&states[0], &states[1]], paths),
                    _ => Vec::new(),
                };
                Arc::new(Table { at: changes.count, states, costs })
            })
        };
        let tables: Vec<Arc<Table>> = (0..self.contenders[of.who[0]].pools.len()).map(table).collect();
        let new = self.best(&of.who, &tables);
        (self.gains(&new, paths).then_some(new), tables)
    }

    /// Whether the choice of another contender that a move depends on has changed on drawing `d` after the change `since`.
    fn differs(&self, of: &Move, (d, since): (usize, usize), changes: &Changes) -> bool {
        let own = &self.contenders[of.who[0]];
        let others = of.seen.iter().filter(|c| !of.who.contains(c));
        others.into_iter().any(|&c| {
            let shown = self.contenders[c].shown_during(own, d);
            shown.is_some_and(|shown| changes.last[c][shown].iter().any(|last| *last > since))
        })
    }

    /// The paths of least cost by the costs on each drawing.
    fn best(&self, who: &[usize], tables: &[Arc<Table>]) -> Proposal {
        let costs: Vec<Vec<f64>> = tables.iter().map(|table| table.costs.clone()).collect();
        let states: Vec<Vec<Vec<usize>>> =
            (0..who.len()).map(|k| tables.iter().map(|table| table.states[k].clone()).collect()).collect();
        let path = |which: usize, places: &mut dyn Iterator<Item = usize>| {
            (who[which], places.enumerate().map(|(d, place)| states[which][d][place]).collect())
        };
        let motion = |which: usize| Among { moving: self.moving(who[which]), states: &states[which] };
        match who.len() {
            1 => vec![path(0, &mut path_of_least_cost(&costs, &motion(0)).into_iter())],
            2 => {
                let counts = [0, 1].map(|which: usize| states[which].iter().map(Vec::len).collect());
                let best = best_pair(&PairProblem { costs, counts, motion: [0, 1].map(motion) });
                let of = |which: usize| path(which, &mut best.iter().map(|pair| pair[which]));
                vec![of(0), of(1)]
            }
            _ => Vec::new(),
        }
    }

    /// The contenders whose choices a move of `who` depends on: the contenders that hide them, that they hide, that
    /// hide the same contenders as they do, that they are joined to, and that are their companions. All at the same time
    /// explain the figure together.
    pub fn seen_by(&self, who: &[usize]) -> Vec<usize> {
        let mut seen: Vec<usize> = who.to_vec();
        for &c in who {
            seen.extend(self.shadows.in_front_of(c));
            for &far in self.shadows.behind(c) {
                seen.push(far);
                seen.extend(self.shadows.in_front_of(far));
            }
            seen.extend(self.ties.iter().filter_map(|tie| Some(tie.other(c)?.0)));
            seen.extend(self.companions.pairs.iter().filter_map(|pair| pair.other(c)));
        }
        if self.figure.is_some() {
            let spans = |k: usize| self.contenders[k].span;
            let meets = |k: &usize| who.iter().any(|&c| overlap(spans(*k), spans(c)));
            seen.extend((0..self.contenders.len()).filter(meets));
        }
        seen.sort_unstable();
        seen.dedup();
        seen
    }

    /// Costs of states of a contender on a drawing while the others are fixed.
    fn costs(&self, (c, d): State, states: &[usize], paths: &Paths) -> Vec<f64> {
        let rest = self.rest((&[c], d), paths);
        let alone = self.alone((c, d), states, paths, None);
        states.iter().zip(alone).map(|(&h, alone)| alone + self.unexplained(&rest, &[(c, (d, h))])).collect()
    }

    /// States of a contender on a drawing with their costs while the others are fixed.
    pub fn candidates(&self, (c, d): State, states: &[usize], paths: &Paths) -> Vec<Candidate<'_>> {
        let points = |h: usize| &self.contenders[c].pools[d][h].points[..];
        let costs = self.costs((c, d), states, paths).into_iter();
        states.iter().zip(costs).map(|(&h, cost)| Candidate { cost, points: points(h) }).collect()
    }

    /// Costs of all pairs of states of two contenders on a drawing. The second one's state is the inner index. The
    /// first one may be the nearer one there.
    pub(super) fn pair_costs(&self, who: [usize; 2], d: usize, states: [&[usize]; 2], paths: &Paths) -> Vec<f64> {
        let ([a, b], [of_a, of_b]) = (who, states);
        let frame = self.contenders[a].frame_of(d);
        if !self.contenders[a].is_nearer(&self.contenders[b], frame) {
            return self.costs_in_depth(who, d, states, paths);
        }
        let costs = self.costs_in_depth([b, a], d, [of_b, of_a], paths);
        (0..of_a.len()).flat_map(|i| costs.iter().skip(i).step_by(of_a.len())).copied().collect()
    }

    /// Costs of all pairs of states of a far and a near contender on a drawing. The near one's state is the inner
    /// index.
    fn costs_in_depth(
        &self,
        [far, near]: [usize; 2],
        d: usize,
        [of_far, of_near]: [&[usize]; 2],
        paths: &Paths,
    ) -> Vec<f64> {
        // The samples of the far one that are hidden depend on the pair, so its own fit is added in the table below.
        let behind = self.looks_behind((far, d), of_far, paths, Some(near));
        let bonds = self.bonds_of((far, d), of_far, paths, Some(near));
        let near_costs = self.alone((near, d), of_near, paths, Some(far));
        let looks = self.looks_beneath((far, d), of_far, (near, of_near), paths);
        let torn = self.bonds_between((far, d), of_far, (near, d), of_near);
        let rest = self.rest((&[far, near], d), paths);
        let mut table = Vec::with_capacity(looks.len());
        for (i, &f) in of_far.iter().enumerate() {
            for (j, &n) in of_near.iter().enumerate() {
                let k = i * of_near.len() + j;
                let unexplained = self.unexplained(&rest, &[(far, (d, f)), (near, (d, n))]);
                table.push(looks[k] + torn[k] + unexplained + (behind[i] + bonds[i]) + near_costs[j]);
            }
        }
        table
    }

    /// Hypotheses of a drawing: all, or at most so many, which are those of least energy and the present one.
    fn states(&self, most: Option<usize>, (c, d): State, paths: &Paths) -> Vec<usize> {
        let pool = &self.contenders[c].pools[d];
        let Some(most) = most else { return (0..pool.len()).collect() };
        let mut order: Vec<usize> = (0..pool.len()).filter(|&h| h != paths[c][d]).collect();
        order.sort_by(|&a, &b| pool[a].pose.energy.total_cmp(&pool[b].pose.energy));
        order.truncate(most - 1);
        order.push(paths[c][d]);
        order
    }

    /// Whether the energy is lower with the new paths.
    fn gains(&self, new: &[(usize, Vec<usize>)], paths: &Paths) -> bool {
        if new.iter().all(|(c, path)| paths[*c] == *path) {
            return false;
        }
        let who: Vec<usize> = new.iter().map(|(c, _)| *c).collect();
        let mut changed = paths.to_vec();
        new.iter().for_each(|(c, path)| changed[*c].clone_from(path));
        self.energy(&who, &changed) < self.energy(&who, paths) - LEAST_GAIN
    }
}
