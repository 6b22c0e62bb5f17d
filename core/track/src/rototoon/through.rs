//! Min-marginals of the path choice: of each drawing and hypothesis the least cost of the paths that go through it.
//!
//! The cost of a path is that of [`select`](super::select). A forward pass gives the least cost of the paths that end with a
//! pair of hypotheses on neighbouring drawings, a backward pass the least cost of what follows such a pair. Their sum is the
//! least cost of all paths through the pair, and its minimum over the pairs with a hypothesis is the min-marginal.
//!
//! For s hypotheses per drawing this needs s³ second differences per drawing, which both passes share.

use super::select::{Candidate, Smoothness, bends_over, mean_shift};

/// Of each drawing and hypothesis: the least cost of the paths through it. Each drawing must have at least one hypothesis.
/// `gaps` are the drawings that begin after a gap.
pub fn through(candidates: &[Vec<Candidate>], smoothness: Smoothness, gaps: &[usize]) -> Vec<Vec<f64>> {
    if candidates.len() < 2 {
        return candidates.iter().map(|states| states.iter().map(|state| state.cost).collect()).collect();
    }
    let steps: Vec<Step> = (1..candidates.len()).map(|d| Step::new(candidates, d, smoothness, gaps)).collect();
    let before = forward(candidates, &steps);
    let after = backward(&steps);
    let total = |d: usize, g: usize, h: usize| before[d][g][h] + after[d][g][h];
    let least = |costs: &mut dyn Iterator<Item = f64>| costs.fold(f64::INFINITY, f64::min);
    let count = |d: usize| candidates[d].len();
    let first = (0..count(0)).map(|g| least(&mut (0..count(1)).map(|h| total(0, g, h)))).collect();
    let rest = (1..candidates.len())
        .map(|d| (0..count(d)).map(|h| least(&mut (0..count(d - 1)).map(|g| total(d - 1, g, h)))).collect());
    std::iter::once(first).chain(rest).collect()
}

/// A cost for each pair of hypotheses of neighbouring drawings: the later one is the inner index.
type Pairs = Vec<Vec<f64>>;

/// What it costs to arrive on a drawing.
struct Step {
    /// Own cost of the later hypothesis, and cost of the speed.
    arrival: Pairs,
    /// Cost of the change of speed, by hypothesis two drawings before; empty for the first step.
    bends: Vec<Pairs>,
}

impl Step {
    /// The step to drawing `d`.
    fn new(candidates: &[Vec<Candidate>], d: usize, smoothness: Smoothness, gaps: &[usize]) -> Self {
        let (from, to) = (&candidates[d - 1], &candidates[d]);
        let step = |g: &Candidate, h: &Candidate| smoothness.of_step(mean_shift(g.points, h.points), (d, gaps));
        let arrive = |g: &Candidate| to.iter().map(|h| h.cost + step(g, h)).collect();
        let two_before = if d >= 2 { &candidates[d - 2][..] } else { &[] };
        let bend = |f: &Candidate| {
            let change = |g: &Candidate, h: &Candidate| {
                if bends_over(gaps, d) { 0.0 } else { smoothness.acceleration(f.points, g.points, h.points) }
            };
            let of = |g: &Candidate| to.iter().map(|h| change(g, h)).collect();
            from.iter().map(of).collect()
        };
        Self { arrival: from.iter().map(arrive).collect(), bends: two_before.iter().map(bend).collect() }
    }
}

/// By step: the least cost of the paths that end with a pair.
fn forward(candidates: &[Vec<Candidate>], steps: &[Step]) -> Vec<Pairs> {
    let mut tables: Vec<Pairs> = Vec::with_capacity(steps.len());
    for step in steps {
        let reach = |g: usize, h: usize| match tables.last() {
            None => candidates[0][g].cost,
            Some(last) => {
                let from = last.iter().zip(&step.bends).map(|(costs, bends)| costs[g] + bends[g][h]);
                from.fold(f64::INFINITY, f64::min)
            }
        };
        let row =
            |(g, costs): (usize, &Vec<f64>)| costs.iter().enumerate().map(|(h, cost)| reach(g, h) + cost).collect();
        let table = step.arrival.iter().enumerate().map(row).collect();
        tables.push(table);
    }
    tables
}

/// By step: the least cost of what follows a pair.
fn backward(steps: &[Step]) -> Vec<Pairs> {
    let mut tables: Vec<Pairs> = vec![Vec::new(); steps.len()];
    for s in (0..steps.len()).rev() {
        let Some(next) = steps.get(s + 1) else {
            tables[s] = steps[s].arrival.iter().map(|row| vec![0.0; row.len()]).collect();
            continue;
        };
        let leave = |f: usize, g: usize| {
            let on = |k: usize| next.bends[f][g][k] + next.arrival[g][k] + tables[s + 1][g][k];
            (0..next.arrival[g].len()).map(on).fold(f64::INFINITY, f64::min)
        };
        let row = |(f, costs): (usize, &Vec<f64>)| (0..costs.len()).map(|g| leave(f, g)).collect();
        tables[s] = steps[s].arrival.iter().enumerate().map(row).collect();
    }
    tables
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::geometry::Point;

    /// All paths: indices of a hypothesis for each drawing.
    fn all_paths(pool: &[Vec<Candidate>]) -> Vec<Vec<usize>> {
        pool.iter().fold(vec![Vec::new()], |paths, states| {
            let longer = |path: Vec<usize>| (0..states.len()).map(move |h| [path.clone(), vec![h]].concat());
            paths.into_iter().flat_map(longer).collect()
        })
    }

    proptest! {
        #[test]
        fn each_is_the_least_cost_of_all_paths_through_a_hypothesis(
            pool in prop::collection::vec(
                prop::collection::vec((0.0f64..0.3, -90.0f64..90.0, -90.0f64..90.0), 1..4), 1..6),
            gap in 1usize..9,
        ) {
            let state = |&(cost, x, y): &(f64, f64, f64)| (cost, Point::new(x, y));
            let states: Vec<Vec<(f64, Point)>> = pool.iter().map(|s| s.iter().map(state).collect()).collect();
            let candidates: Vec<Vec<Candidate>> = states
                .iter()
                .map(|s| s.iter().map(|(cost, p)| Candidate { cost: *cost, points: std::slice::from_ref(p) }).collect())
                .collect();
            let smoothness = Smoothness::new(50.0);
            let cost = |path: &[usize]| {
                let at = |d: usize| candidates[d][path[d]];
                let points: Vec<&[Point]> = (0..path.len()).map(|d| at(d).points).collect();
                (0..path.len()).map(|d| at(d).cost).sum::<f64>() + smoothness.of_path(&points, &[gap])
            };
            let paths = all_paths(&candidates);
            for (d, found) in through(&candidates, smoothness, &[gap]).into_iter().enumerate() {
                prop_assert_eq!(found.len(), candidates[d].len());
                for (h, found) in found.into_iter().enumerate() {
                    let with = paths.iter().filter(|path| path[d] == h).map(|path| cost(path));
                    prop_assert!((found - with.fold(f64::INFINITY, f64::min)).abs() < 1e-12);
                }
            }
        }
    }
}
