//! The best paths of two parts at once, by second-order dynamic programming over pairs of states.
//!
//! The motion cost is the sum of both parts' costs, so it is tabulated for each part alone. The minimum over the pairs
//! of states two drawings before is taken over one part's states first and then over the other's. For s states per part
//! this needs 2 s⁵ operations per drawing, instead of the s⁶ for all triples of pairs.
//!
//! Source: our own; the path search for a single part is in `select`.

use crate::rototoon::select::{Smoothness, trace_back};
use rototoon_base::geometry::Point;

/// Two parts with some states on each drawing. Places are in working pixels.
pub struct PairProblem<'a> {
    /// By drawing: costs of all pairs of states. The second part's state is the inner index.
    pub costs: Vec<Vec<f64>>,
    /// By part, drawing and state: the control points.
    pub points: [Vec<Vec<&'a [Point]>>; 2],
    /// By part: the cost of motion.
    pub smoothness: [Smoothness; 2],
}

/// Motion costs of one part between its states on neighbouring drawings. The last drawing's state is the inner index.
struct Motion {
    counts: [usize; 3],
    speed: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Motion {
    /// Costs of the motion to drawing `d` from the two drawings before it, or from one if `d` is 1.
    fn new(problem: &PairProblem, part: usize, d: usize) -> Self {
        let (points, smoothness) = (&problem.points[part], problem.smoothness[part]);
        let (mut speed, mut acceleration) = (Vec::new(), Vec::new());
        for g in &points[d - 1] {
            speed.extend(points[d].iter().map(|h| smoothness.speed(g, h)));
        }
        let first: &[&[Point]] = if d >= 2 { &points[d - 2] } else { &[] };
        for f in first {
            for g in &points[d - 1] {
                acceleration.extend(points[d].iter().map(|h| smoothness.acceleration(f, g, h)));
            }
        }
        Self { counts: [first.len(), points[d - 1].len(), points[d].len()], speed, acceleration }
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
    fn new(problem: &PairProblem, d: usize, g: usize, least: &[Vec<f64>], motion: &[Motion; 2]) -> Self {
        let (inner, targets) = (problem.points[1][d - 2].len(), problem.points[0][d].len());
        let g0 = g / problem.points[1][d - 1].len();
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
    fn least(&self, motion: &[Motion; 2], [_, g1]: [usize; 2], [h0, h1]: [usize; 2]) -> (f64, usize) {
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
pub fn best_pair(problem: &PairProblem) -> Vec<[usize; 2]> {
    let split = |d: usize, pair: usize| {
        let inner = problem.points[1][d].len();
        [pair / inner, pair % inner]
    };
    let count = |d: usize| problem.costs[d].len();
    if problem.costs.len() < 2 {
        let least = |d: usize| (0..count(d)).min_by(|&a, &b| problem.costs[d][a].total_cmp(&problem.costs[d][b]));
        return (0..problem.costs.len()).filter_map(|d| Some(split(d, least(d)?))).collect();
    }
    let mut motion = [0, 1].map(|part: usize| Motion::new(problem, part, 1));
    let step = |motion: &[Motion; 2], d: usize, g: usize, h: usize| {
        let (from, to) = (split(d - 1, g), split(d, h));
        problem.costs[d][h] + motion[0].speed(from[0], to[0]) + motion[1].speed(from[1], to[1])
    };
    // least[g][h]: least cost of the paths that end with the pair g, then the pair h.
    let mut least: Vec<Vec<f64>> =
        (0..count(0)).map(|g| (0..count(1)).map(|h| problem.costs[0][g] + step(&motion, 1, g, h)).collect()).collect();
    let mut origins: Vec<Vec<Vec<usize>>> = Vec::new();
    for d in 2..problem.costs.len() {
        motion = [0, 1].map(|part: usize| Motion::new(problem, part, d));
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
    use proptest::prelude::*;

    type Pool = Vec<(f64, f64)>;

    /// Cost of one pair of paths, added up term by term.
    fn cost_of(way: &[[usize; 2]], problem: &PairProblem) -> f64 {
        let mut cost = 0.0;
        for (d, pair) in way.iter().enumerate() {
            cost += problem.costs[d][pair[0] * problem.points[1][d].len() + pair[1]];
            for part in 0..2 {
                let at = |d: usize| problem.points[part][d][way[d][part]];
                if d >= 1 {
                    cost += problem.smoothness[part].speed(at(d - 1), at(d));
                }
                if d >= 2 {
                    cost += problem.smoothness[part].acceleration(at(d - 2), at(d - 1), at(d));
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
            let of = |part: usize| -> Vec<Vec<&[Point]>> {
                places.iter().map(|p| p[part].iter().map(std::slice::from_ref).collect()).collect()
            };
            let costs = pools.iter().map(|(a, b, c)| c[..a.len() * b.len()].to_vec()).collect();
            let smoothness = [Smoothness::new(30.0), Smoothness::new(70.0)];
            let problem = PairProblem { costs, points: [of(0), of(1)], smoothness };
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
