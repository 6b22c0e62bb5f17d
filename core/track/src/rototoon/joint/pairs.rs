//! The best paths of two parts at once, by second-order dynamic programming over pairs of states.
//!
//! The motion cost is the sum of both parts' costs, so it is tabulated for each part alone. The minimum over the pairs
//! of states two drawings before is taken over one part's states first and then over the other's. For s states per part
//! this needs 2 s⁵ operations per drawing, instead of the s⁶ for all triples of pairs.
//!
//! Source: our own; the path search for a single part is in `select`.

use crate::rototoon::select::{Motion, trace_back};

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

    fn speed(&self, g: usize, h: usize) -> f64 {
        self.speed[g * self.counts[2] + h]
    }

    fn acceleration(&self, f: usize, g: usize, h: usize) -> f64 {
        self.acceleration[(f * self.counts[1] + g) * self.counts[2] + h]
    }
}

/// For one pair of states on the previous drawing: the least cost of arriving there from each state of the second part,
/// for each next state of the first part.
struct Arrivals {
    inner: usize,
    targets: usize,
    /// The least cost, and the first part's state two drawings before. Outer index: the second part's state two
    /// drawings before. Inner index: the first part's state on the present drawing.
    table: Vec<(f64, usize)>,
}

impl Arrivals {
    fn new<M>(problem: &PairProblem<M>, d: usize, g: usize, least: &[Vec<f64>], motion: &[Table; 2]) -> Self {
        let (inner, targets) = (problem.counts[1][d - 2], problem.counts[0][d]);
        let g0 = g / problem.counts[1][d - 1];
        let mut table = vec![(f64::INFINITY, 0); inner * targets];
        for (f, costs) in least.iter().enumerate() {
            let (f0, f1) = (f / inner, f % inner);
            for (h0, best) in table[f1 * targets..][..targets].iter_mut().enumerate() {
                let cost = costs[g] + motion[0].acceleration(f0, g0, h0);
                if cost < best.0 {
                    *best = (cost, f0);
                }
            }
        }
        Self { inner, targets, table }
    }

    /// Least cost of arriving at a pair of states, and the pair two drawings before.
    fn least(&self, motion: &[Table; 2], [_, g1]: [usize; 2], [h0, h1]: [usize; 2]) -> (f64, usize) {
        let mut best = (f64::INFINITY, 0);
        for f1 in 0..self.inner {
            let (before, f0) = self.table[f1 * self.targets + h0];
            let cost = before + motion[1].acceleration(f1, g1, h1);
            if cost < best.0 {
                best = (cost, f0 * self.inner + f1);
            }
        }
        best
    }
}

/// The states of both parts on each drawing, along their paths of least total cost.
pub fn best_pair<M: Motion>(problem: &PairProblem<M>) -> Vec<[usize; 2]> {
    let split = |d: usize, pair: usize| {
        let inner = problem.counts[1][d];
        [pair / inner, pair % inner]
    };
    let count = |d: usize| problem.costs[d].len();
    if problem.costs.len() < 2 {
        let least = |d: usize| (0..count(d)).min_by(|&a, &b| problem.costs[d][a].total_cmp(&problem.costs[d][b]));
        return (0..problem.costs.len()).filter_map(|d| Some(split(d, least(d)?))).collect();
    }
    let mut motion = [0, 1].map(|part: usize| Table::new(problem, part, 1));
    let step = |motion: &[Table; 2], d: usize, g: usize, h: usize| {
        let (from, to) = (split(d - 1, g), split(d, h));
        problem.costs[d][h] + motion[0].speed(from[0], to[0]) + motion[1].speed(from[1], to[1])
    };
    // least[g][h]: least cost of the paths that end with the pair g, then the pair h.
    let mut least: Vec<Vec<f64>> =
        (0..count(0)).map(|g| (0..count(1)).map(|h| problem.costs[0][g] + step(&motion, 1, g, h)).collect()).collect();
    let mut origins: Vec<Vec<Vec<usize>>> = Vec::new();
    for d in 2..problem.costs.len() {
        motion = [0, 1].map(|part: usize| Table::new(problem, part, d));
        let mut next = vec![vec![f64::INFINITY; count(d)]; count(d - 1)];
        let mut from = vec![vec![0; count(d)]; count(d - 1)];
        for g in 0..count(d - 1) {
            let arrived = Arrivals::new(problem, d, g, &least, &motion);
            for h in 0..count(d) {
                let (bend, f) = arrived.least(&motion, split(d - 1, g), split(d, h));
                (next[g][h], from[g][h]) = (bend + step(&motion, d, g, h), f);
            }
        }
        least = next;
        origins.push(from);
    }
    trace_back(&least, &origins).into_iter().enumerate().map(|(d, pair)| split(d, pair)).collect()
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
                Direct { candidates: &candidates[part], smoothness: Smoothness::new(size) }
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
