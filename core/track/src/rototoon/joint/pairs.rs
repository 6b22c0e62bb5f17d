//! The best paths of two parts at once, by second-order dynamic programming over pairs of states.
//!
//! The motion cost is the sum of both parts' costs, so it is tabulated for each part alone. The minimum over the pairs
//! of states two drawings before is taken over one part's states first and then over the other's. For s states per part
//! this needs 2 s⁵ operations per drawing, instead of the s⁶ for all triples of pairs. Only least costs are kept, not where they
//! came from: that is found again along the best path alone, so the inner loops are plain minima.
//!
//! Source: our own; the path search for a single part is in `select`.

use crate::rototoon::select::Motion;

/// Two parts with some states on each drawing.
pub struct PairProblem<M> {
    /// By drawing: costs of all pairs of states. The second part's state is the inner index.
    pub costs: Vec<Vec<f64>>,
    /// By part and drawing: the number of states.
    pub counts: [Vec<usize>; 2],
    /// By part: the cost of motion.
    pub motion: [M; 2],
}

/// Motion costs of one part between its states on neighbouring drawings. The last drawing's state is the inner index.
struct Table {
    counts: [usize; 3],
    speed: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Table {
    /// Costs of the motion to drawing `d` from the two drawings before it, or from one if `d` is 1.
    fn new<M: Motion>(problem: &PairProblem<M>, part: usize, d: usize) -> Self {
        let (counts, motion) = (&problem.counts[part], &problem.motion[part]);
        let counts = [if d >= 2 { counts[d - 2] } else { 0 }, counts[d - 1], counts[d]];
        let (mut speed, mut acceleration) = (Vec::new(), Vec::new());
        for g in 0..counts[1] {
            speed.extend((0..counts[2]).map(|h| motion.speed(d, [g, h])));
        }
        for f in 0..counts[0] {
            for g in 0..counts[1] {
                acceleration.extend((0..counts[2]).map(|h| motion.acceleration(d, [f, g, h])));
            }
        }
        Self { counts, speed, acceleration }
    }

    /// Costs of the speed from a state, by the next one.
    fn speeds(&self, g: usize) -> &[f64] {
        &self.speed[g * self.counts[2]..][..self.counts[2]]
    }

    /// Costs of the change of speed from two states, by the next one.
    fn bends(&self, f: usize, g: usize) -> &[f64] {
        &self.acceleration[(f * self.counts[1] + g) * self.counts[2]..][..self.counts[2]]
    }
}

/// The least costs of paths up to a drawing, and the costs of motion to it.
struct Stage {
    motion: [Table; 2],
    /// Least cost of the paths that end with a pair on the drawing before (outer index) and a pair on the drawing.
    least: Vec<f64>,
}

impl Stage {
    /// The stage of the second drawing.
    fn first<M: Motion>(problem: &PairProblem<M>) -> Self {
        let motion = [0, 1].map(|part: usize| Table::new(problem, part, 1));
        let mut least = Vec::new();
        for (g, start) in problem.costs[0].iter().enumerate() {
            least.extend(steps(&motion, g, &problem.costs[1]).map(|step| start + step));
        }
        Self { motion, least }
    }

    /// The stage of drawing `d`, from that of the drawing before.
    fn next<M: Motion>(problem: &PairProblem<M>, d: usize, before: &Self) -> Self {
        let motion = [0, 1].map(|part: usize| Table::new(problem, part, d));
        let [of_first, of_second] = &motion;
        let (pairs, costs) = (problem.costs[d - 1].len(), &problem.costs[d]);
        let mut least = Vec::with_capacity(pairs * costs.len());
        // Least cost of arriving at a pair from each state of the second part two drawings before (outer index), by the first
        // part's next state.
        let mut arrivals = vec![f64::INFINITY; of_second.counts[0] * of_first.counts[2]];
        let mut bent = vec![f64::INFINITY; costs.len()];
        for g in 0..pairs {
            let [g0, g1] = problem.split(d - 1, g);
            arrivals.fill(f64::INFINITY);
            for f in 0..problem.costs[d - 2].len() {
                let [f0, f1] = problem.split(d - 2, f);
                let own = &mut arrivals[f1 * of_first.counts[2]..][..of_first.counts[2]];
                lower(own, before.least[f * pairs + g], of_first.bends(f0, g0));
            }
            bent.fill(f64::INFINITY);
            for (f1, arrived) in arrivals.chunks_exact(of_first.counts[2]).enumerate() {
                let bends = of_second.bends(f1, g1);
                bent.chunks_exact_mut(of_second.counts[2])
                    .zip(arrived)
                    .for_each(|(own, &cost)| lower(own, cost, bends));
            }
            least.extend(bent.iter().zip(steps(&motion, g, costs)).map(|(bend, step)| bend + step));
        }
        Self { motion, least }
    }

    /// The pair two drawings before from which the path of least cost comes that ends with two pairs. `before` are the least
    /// costs up to the drawing before.
    fn origin<M>(&self, problem: &PairProblem<M>, d: usize, before: &[f64], [g, h]: [usize; 2]) -> usize {
        let ([g0, g1], [h0, h1]) = (problem.split(d - 1, g), problem.split(d, h));
        let [firsts, seconds] = [0, 1].map(|part: usize| problem.counts[part][d - 2]);
        let mut best = (f64::INFINITY, 0);
        for f1 in 0..seconds {
            let mut arrival = (f64::INFINITY, 0);
            for f0 in 0..firsts {
                let f = f0 * seconds + f1;
                let cost = before[f * problem.costs[d - 1].len() + g] + self.motion[0].bends(f0, g0)[h0];
                if cost < arrival.0 {
                    arrival = (cost, f);
                }
            }
            let cost = arrival.0 + self.motion[1].bends(f1, g1)[h1];
            if cost < best.0 {
                best = (cost, arrival.1);
            }
        }
        best.1
    }
}

/// Costs of the step from a pair to each pair of the next drawing, whose own costs are given.
fn steps(motion: &[Table; 2], g: usize, costs: &[f64]) -> impl Iterator<Item = f64> {
    let inner = motion[1].counts[2];
    let (first, second) = (motion[0].speeds(g / motion[1].counts[1]), motion[1].speeds(g % motion[1].counts[1]));
    costs.iter().enumerate().map(move |(h, cost)| cost + first[h / inner] + second[h % inner])
}

/// Lowers each number to a cost plus the number of a list at its place, if that is less.
fn lower(numbers: &mut [f64], cost: f64, list: &[f64]) {
    for (number, more) in numbers.iter_mut().zip(list) {
        let new = cost + more;
        *number = if new < *number { new } else { *number };
    }
}

impl<M> PairProblem<M> {
    /// The states of a pair on a drawing.
    fn split(&self, d: usize, pair: usize) -> [usize; 2] {
        let inner = self.counts[1][d];
        [pair / inner, pair % inner]
    }
}

/// The states of both parts on each drawing, along their paths of least total cost.
pub fn best_pair<M: Motion>(problem: &PairProblem<M>) -> Vec<[usize; 2]> {
    let least = |costs: &[f64]| (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
    let drawings = problem.costs.len();
    if drawings < 2 {
        return problem.costs.iter().enumerate().map(|(d, costs)| problem.split(d, least(costs))).collect();
    }
    let mut stages = vec![Stage::first(problem)];
    for d in 2..drawings {
        stages.push(Stage::next(problem, d, &stages[d - 2]));
    }
    let count = problem.costs[drawings - 1].len();
    let end = least(&stages[drawings - 2].least);
    let mut path = vec![end % count, end / count];
    for d in (2..drawings).rev() {
        let ends = [path[path.len() - 1], path[path.len() - 2]];
        path.push(stages[d - 1].origin(problem, d, &stages[d - 2].least, ends));
    }
    path.into_iter().rev().enumerate().map(|(d, pair)| problem.split(d, pair)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rototoon::select::{Candidate, Direct, Smoothness};
    use proptest::prelude::*;
    use rototoon_base::geometry::Point;

    type Pool = Vec<(f64, f64)>;

    /// Cost of one pair of paths, added up term by term.
    fn cost_of(way: &[[usize; 2]], problem: &PairProblem<Direct>) -> f64 {
        let mut cost = 0.0;
        for (d, pair) in way.iter().enumerate() {
            cost += problem.costs[d][pair[0] * problem.counts[1][d] + pair[1]];
            for part in 0..2 {
                let at = |d: usize| way[d][part];
                if d >= 1 {
                    cost += problem.motion[part].speed(d, [at(d - 1), at(d)]);
                }
                if d >= 2 {
                    cost += problem.motion[part].acceleration(d, [at(d - 2), at(d - 1), at(d)]);
                }
            }
        }
        cost
    }

    proptest! {
        #[test]
        fn no_other_pair_of_paths_costs_less(
            pools in prop::collection::vec(
                (prop::collection::vec((-60.0f64..60.0, -60.0f64..60.0), 1..4),
                 prop::collection::vec((-60.0f64..60.0, -60.0f64..60.0), 1..4),
                 prop::collection::vec(0.0f64..0.3, 9)), 1..5),
        ) {
            let points = |pool: &Pool| -> Vec<Point> { pool.iter().map(|&(x, y)| Point::new(x, y)).collect() };
            let places: Vec<[Vec<Point>; 2]> = pools.iter().map(|(a, b, _)| [points(a), points(b)]).collect();
            let of = |part: usize| -> Vec<Vec<Candidate>> {
                let candidate = |p| Candidate { cost: 0.0, points: std::slice::from_ref(p) };
                places.iter().map(|p| p[part].iter().map(candidate).collect()).collect()
            };
            let costs = pools.iter().map(|(a, b, c)| c[..a.len() * b.len()].to_vec()).collect();
            let candidates = [of(0), of(1)];
            let motion = [(0, 30.0), (1, 70.0)].map(|(part, size)| {
                Direct { candidates: &candidates[part], smoothness: Smoothness::new(size), gaps: &[] }
            });
            let counts = [0, 1].map(|part: usize| candidates[part].iter().map(Vec::len).collect());
            let problem = PairProblem { costs, counts, motion };
            let best = best_pair(&problem);
            let mut ways: Vec<Vec<[usize; 2]>> = vec![Vec::new()];
            for (a, b, _) in &pools {
                let all = |way: Vec<[usize; 2]>| {
                    (0..a.len() * b.len()).map(move |k| [way.clone(), vec![[k / b.len(), k % b.len()]]].concat())
                };
                ways = ways.into_iter().flat_map(all).collect();
            }
            let least = ways.iter().map(|way| cost_of(way, &problem)).fold(f64::INFINITY, f64::min);
            prop_assert!((cost_of(&best, &problem) - least).abs() < 1e-12);
        }
    }
}
