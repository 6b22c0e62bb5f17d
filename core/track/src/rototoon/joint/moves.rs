//! Moves that lower the joint energy: new paths for one part, or for two parts at once.
//!
//! With the other parts fixed, the energy of one part's path is a sum over drawings and over pairs and triples of
//! neighbouring drawings. So its best path is found exactly ([`best_path`]). For two parts the state of a drawing is a
//! pair of hypotheses, and its motion cost is the sum of both parts' motion costs ([`pairs`](super::pairs)).

use super::contender::{Paths, State};
use super::cost::Scene;
use super::pairs::{PairProblem, best_pair};
use super::tie::overlap;
use crate::rototoon::select::{Candidate, best_path};

/// Hypotheses per part and drawing that a move of two parts considers.
const STATES: usize = 6;
/// Smaller gains are rounding errors.
const LEAST_GAIN: f64 = 1e-9;

impl Scene<'_> {
    /// New paths of one contender, or of a far and a near one with the same drawings, while the others are fixed. None
    /// if they do not lower the energy.
    pub fn proposal(&self, who: &[usize], paths: &Paths) -> Option<Vec<(usize, Vec<usize>)>> {
        let new = match *who {
            [c] => self.single(c, paths),
            [far, near] => self.pair(far, near, paths),
            _ => return None,
        };
        self.gains(&new, paths).then_some(new)
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

    /// The best path of one contender while the others are fixed.
    fn single(&self, c: usize, paths: &Paths) -> Vec<(usize, Vec<usize>)> {
        let pools = self.contenders[c].pools;
        let candidates: Vec<Vec<Candidate>> = (0..pools.len())
            .map(|d| {
                let rest = self.rest((&[c], d), paths);
                let cost = |h: usize| self.alone(c, (d, h), paths, None) + self.unexplained(&rest, &[(c, (d, h))]);
                let of = |h: usize| Candidate { cost: cost(h), points: &pools[d][h].points };
                (0..pools[d].len()).map(of).collect()
            })
            .collect();
        vec![(c, best_path(&candidates, self.smoothness(c)))]
    }

    /// The best paths of a far and a near contender with the same drawings while the others are fixed.
    fn pair(&self, far: usize, near: usize, paths: &Paths) -> Vec<(usize, Vec<usize>)> {
        let drawings = self.contenders[far].pools.len();
        let states = |c: usize| -> Vec<Vec<usize>> { (0..drawings).map(|d| self.states(c, d, paths)).collect() };
        let states = [states(far), states(near)];
        let costs = (0..drawings).map(|d| self.pair_costs([far, near], d, &states, paths)).collect();
        let points = [far, near].map(|c| self.contenders[c].pools);
        let problem = PairProblem {
            costs,
            points: std::array::from_fn(|which| {
                let of = |(d, states): (usize, &Vec<usize>)| {
                    states.iter().map(|&h| &points[which][d][h].points[..]).collect()
                };
                states[which].iter().enumerate().map(of).collect()
            }),
            smoothness: [self.smoothness(far), self.smoothness(near)],
        };
        let best = best_pair(&problem);
        let path = |which: usize| best.iter().enumerate().map(|(d, pair)| states[which][d][pair[which]]).collect();
        vec![(far, path(0)), (near, path(1))]
    }

    /// Costs of all pairs of states of a far and a near contender on a drawing. The near one's state is the inner
    /// index.
    fn pair_costs(&self, [far, near]: [usize; 2], d: usize, states: &[Vec<Vec<usize>>; 2], paths: &Paths) -> Vec<f64> {
        // The samples of the far one that are hidden depend on the pair, so its own fit is added in the table below.
        let far_alone =
            |&f: &usize| self.look_behind(far, (d, f), paths, Some(near)) + self.joints(far, (d, f), paths, Some(near));
        let far_costs: Vec<f64> = states[0][d].iter().map(far_alone).collect();
        let near_costs: Vec<f64> = states[1][d].iter().map(|&n| self.alone(near, (d, n), paths, Some(far))).collect();
        let rest = self.rest((&[far, near], d), paths);
        let mut table = Vec::new();
        for (&f, far_cost) in states[0][d].iter().zip(&far_costs) {
            for (&n, near_cost) in states[1][d].iter().zip(&near_costs) {
                let look = self.look(far, (d, f), paths, Some((near, n)));
                let torn = self.bond((far, (d, f)), (near, (d, n)));
                let unexplained = self.unexplained(&rest, &[(far, (d, f)), (near, (d, n))]);
                table.push(look + torn + unexplained + far_cost + near_cost);
            }
        }
        table
    }

    /// Cost of a state without motion and without what it leaves unexplained. The contender `but` does not count.
    pub fn alone(&self, c: usize, state: State, paths: &Paths, but: Option<usize>) -> f64 {
        self.look(c, state, paths, None) + self.look_behind(c, state, paths, but) + self.joints(c, state, paths, but)
    }

    /// The hypotheses of a drawing that a move of two parts considers: those of least energy and the present one.
    fn states(&self, c: usize, d: usize, paths: &Paths) -> Vec<usize> {
        let pool = &self.contenders[c].pools[d];
        let mut order: Vec<usize> = (0..pool.len()).filter(|&h| h != paths[c][d]).collect();
        order.sort_by(|&a, &b| pool[a].pose.energy.total_cmp(&pool[b].pose.energy));
        order.truncate(STATES - 1);
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
