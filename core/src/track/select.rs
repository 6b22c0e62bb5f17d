//! Which of several hypotheses to follow: a path of least cost through the drawings of a span.
//!
//! States are pairs of neighbouring drawings' hypotheses, so that the path can be smooth in velocity (second-order
//! Viterbi). The cost of a path is Σ √E + 0.005 min(|Δ|/z, 3) + 0.05 min(|Δ²|/z, 3): E a hypothesis' energy, Δ and Δ²
//! first and second differences of the control points (mean length over the points), z = √(40 size) px. The caps let a
//! part jump once it must.

use crate::geometry::Point;

/// Cost of speed and of change of speed, and the cap of either, in units of z.
const SPEED: f64 = 0.005;
const ACCELERATION: f64 = 0.05;
const CAP: f64 = 3.0;

/// What the selection weighs of a hypothesis.
#[derive(Clone, Copy)]
pub struct Candidate<'a> {
    /// How badly it explains the picture.
    pub energy: f64,
    /// Where it puts the control points, in working pixels.
    pub points: &'a [Point],
}

/// Index of the hypothesis to follow on each drawing; no drawing may be without one. `size` is the part's, in working
/// pixels.
pub fn best_path(candidates: &[Vec<Candidate>], size: f64) -> Vec<usize> {
    let unit = (40.0 * size).sqrt();
    let own = |i: usize, h: usize| candidates[i][h].energy.max(0.0).sqrt();
    let count = |i: usize| candidates[i].len();
    if candidates.len() < 2 {
        let least = |i: usize| (0..count(i)).min_by(|&a, &b| own(i, a).total_cmp(&own(i, b)));
        return (0..candidates.len()).filter_map(least).collect();
    }
    let speed = |i: usize, g: usize, h: usize| {
        let difference = |k: usize| candidates[i][h].points[k] - candidates[i - 1][g].points[k];
        SPEED * (mean_length(candidates[i][h].points.len(), difference) / unit).min(CAP)
    };
    let acceleration = |i: usize, f: usize, g: usize, h: usize| {
        let (a, b, c) = (candidates[i - 2][f].points, candidates[i - 1][g].points, candidates[i][h].points);
        ACCELERATION * (mean_length(c.len(), |k| c[k] - 2.0 * b[k] + a[k]) / unit).min(CAP)
    };
    // costs[g][h]: least cost of a path that ends with hypothesis g, then h.
    let mut costs: Vec<Vec<f64>> =
        (0..count(0)).map(|g| (0..count(1)).map(|h| own(0, g) + own(1, h) + speed(1, g, h)).collect()).collect();
    let mut origins: Vec<Vec<Vec<usize>>> = Vec::new();
    for i in 2..candidates.len() {
        let mut next = vec![vec![f64::INFINITY; count(i)]; count(i - 1)];
        let mut from = vec![vec![0; count(i)]; count(i - 1)];
        for g in 0..count(i - 1) {
            for h in 0..count(i) {
                let step = own(i, h) + speed(i, g, h);
                for f in 0..count(i - 2) {
                    let cost = costs[f][g] + acceleration(i, f, g, h) + step;
                    if cost < next[g][h] {
                        (next[g][h], from[g][h]) = (cost, f);
                    }
                }
            }
        }
        costs = next;
        origins.push(from);
    }
    trace_back(&costs, &origins)
}

fn trace_back(costs: &[Vec<f64>], origins: &[Vec<Vec<usize>>]) -> Vec<usize> {
    let (mut g, mut h) = (0, 0);
    for (i, row) in costs.iter().enumerate() {
        for (j, cost) in row.iter().enumerate() {
            if *cost < costs[g][h] {
                (g, h) = (i, j);
            }
        }
    }
    let mut path = vec![h, g];
    for from in origins.iter().rev() {
        (g, h) = (from[g][h], g);
        path.push(g);
    }
    path.reverse();
    path
}

fn mean_length(count: usize, vector: impl Fn(usize) -> Point) -> f64 {
    (0..count).map(|k| vector(k).length()).sum::<f64>() / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cost_of(path: &[usize], pool: &[Vec<(f64, Point)>], size: f64) -> f64 {
        let unit = (40.0 * size).sqrt();
        let at = |i: usize| pool[i][path[i]].1;
        let mut cost: f64 = (0..path.len()).map(|i| pool[i][path[i]].0.sqrt()).sum();
        cost += (1..path.len()).map(|i| SPEED * ((at(i) - at(i - 1)).length() / unit).min(CAP)).sum::<f64>();
        let bend = |i: usize| (at(i) - 2.0 * at(i - 1) + at(i - 2)).length();
        cost + (2..path.len()).map(|i| ACCELERATION * (bend(i) / unit).min(CAP)).sum::<f64>()
    }

    proptest! {
        #[test]
        fn no_other_path_costs_less(
            pool in prop::collection::vec(
                prop::collection::vec((0.0f64..0.2, -40.0f64..40.0, -40.0f64..40.0), 1..4), 1..6),
        ) {
            let pool: Vec<Vec<(f64, Point)>> =
                pool.into_iter().map(|c| c.into_iter().map(|(e, x, y)| (e, Point::new(x, y))).collect()).collect();
            let candidates: Vec<Vec<Candidate>> = pool
                .iter()
                .map(|c| c.iter().map(|(e, p)| Candidate { energy: *e, points: std::slice::from_ref(p) }).collect())
                .collect();
            let path = best_path(&candidates, 50.0);
            prop_assert_eq!(path.len(), pool.len());
            let mut all = vec![Vec::new()];
            for hypotheses in &pool {
                all = all
                    .into_iter()
                    .flat_map(|p: Vec<usize>| (0..hypotheses.len()).map(move |h| [p.clone(), vec![h]].concat()))
                    .collect();
            }
            let least = all.iter().map(|p| cost_of(p, &pool, 50.0)).fold(f64::INFINITY, f64::min);
            prop_assert!((cost_of(&path, &pool, 50.0) - least).abs() < 1e-12);
        }
    }
}
