//! Chooses a path of least cost through the hypotheses of a span's drawings, for a single part.
//!
//! The states are pairs of hypotheses of neighbouring drawings, so the path can be smooth in velocity (second-order
//! Viterbi). The cost of a path is Σ √E + 0.005 min(|Δ|/z, 3) + 0.05 min(|Δ²|/z, 3). E is the energy of a hypothesis, Δ
//! and Δ² are first and second differences of the control points (mean length over the points), and z = √(40 size) px.
//! The upper limits allow a part to jump where it must.
//!
//! Nothing is known about the motion across a [gap](crate::shared::drawings). It costs nothing, so a path on one side of a gap does not
//! depend on the other side. Nor is the change of motion beside a gap known; there the part is expected to stand still in the gap, so the step
//! beside it counts as a change of motion too. Without that, a drawing between a gap and a key could be anywhere.

use rototoon_base::geometry::Point;

/// Cost of speed, cost of change of speed, and the upper limit of both lengths, in units of z.
const SPEED: f64 = 0.005;
const ACCELERATION: f64 = 0.05;
const CAP: f64 = 3.0;

/// A hypothesis as the selection sees it.
#[derive(Clone, Copy)]
pub struct Candidate<'a> {
    /// Cost of the hypothesis by itself: √E.
    pub cost: f64,
    /// Places of the control points, in working pixels.
    pub points: &'a [Point],
}

/// The motion cost of one part.
#[derive(Clone, Copy, Debug)]
pub struct Smoothness {
    unit: f64,
}

impl Smoothness {
    /// The motion cost of a part of this size, in working pixels.
    pub fn new(size: f64) -> Self {
        Self { unit: (40.0 * size).sqrt() }
    }

    /// The same where drawings jump by `jump` working pixels: lengths count in units of at least that length.
    pub fn among_jumps(size: f64, jump: f64) -> Self {
        Self { unit: Self::new(size).unit.max(jump) }
    }

    /// Cost of a change of the motion over three drawings.
    pub fn acceleration(&self, a: &[Point], b: &[Point], c: &[Point]) -> f64 {
        self.of_bend(mean_bend(a, b, c))
    }

    /// Cost of a motion of this mean length, in working pixels.
    pub fn of_shift(&self, length: f64) -> f64 {
        SPEED * (length / self.unit).min(CAP)
    }

    /// Cost of a change of the motion of this mean length, in working pixels.
    pub fn of_bend(&self, length: f64) -> f64 {
        ACCELERATION * (length / self.unit).min(CAP)
    }

    /// Motion cost of a complete path. `gaps` are the indices of the drawings that begin after a gap.
    pub fn of_path(&self, points: &[&[Point]], gaps: &[usize]) -> f64 {
        let steps = points.windows(2).zip(1..);
        let bends = points.windows(3).zip(2..).filter(|(_, d)| !bends_over(gaps, *d));
        steps.map(|(w, d)| self.of_step(mean_shift(w[0], w[1]), (d, gaps))).sum::<f64>()
            + bends.map(|(w, _)| self.acceleration(w[0], w[1], w[2])).sum::<f64>()
    }

    /// Cost of the step to drawing `d` if it has this mean length, in working pixels.
    pub fn of_step(&self, length: f64, (d, gaps): (usize, &[usize])) -> f64 {
        if gaps.contains(&d) {
            return 0.0;
        }
        let beside = gaps.contains(&(d + 1)) || gaps.contains(&(d - 1));
        self.of_shift(length) + if beside { self.of_bend(length) } else { 0.0 }
    }
}

/// Whether there is a gap between drawing `d` and the two before.
pub fn bends_over(gaps: &[usize], d: usize) -> bool {
    gaps.contains(&d) || gaps.contains(&(d - 1))
}

/// Cost of motion between states, which are given by their indices on neighbouring drawings.
pub trait Motion {
    /// Cost of the motion to drawing `d` from the drawing before.
    fn speed(&self, d: usize, states: [usize; 2]) -> f64;
    /// Cost of the change of motion over drawing `d` and the two before.
    fn acceleration(&self, d: usize, states: [usize; 3]) -> f64;
}

/// The cost of motion between candidates, by their points.
pub struct Direct<'a> {
    /// The candidates of each drawing.
    pub candidates: &'a [Vec<Candidate<'a>>],
    /// The cost of lengths.
    pub smoothness: Smoothness,
    /// The drawings that begin after a gap.
    pub gaps: &'a [usize],
}

impl Motion for Direct<'_> {
    fn speed(&self, d: usize, [g, h]: [usize; 2]) -> f64 {
        let length = mean_shift(self.candidates[d - 1][g].points, self.candidates[d][h].points);
        self.smoothness.of_step(length, (d, self.gaps))
    }

    fn acceleration(&self, d: usize, [f, g, h]: [usize; 3]) -> f64 {
        if bends_over(self.gaps, d) {
            return 0.0;
        }
        let at = |d: usize, state: usize| self.candidates[d][state].points;
        self.smoothness.acceleration(at(d - 2, f), at(d - 1, g), at(d, h))
    }
}

/// Index of the chosen hypothesis on each drawing. Each drawing must have at least one. `gaps` are the drawings that begin after a gap.
pub fn best_path(candidates: &[Vec<Candidate>], smoothness: Smoothness, gaps: &[usize]) -> Vec<usize> {
    let costs: Vec<Vec<f64>> =
        candidates.iter().map(|states| states.iter().map(|state| state.cost).collect()).collect();
    path_of_least_cost(&costs, &Direct { candidates, smoothness, gaps })
}

/// Index of the state on each drawing, along the path of least cost. `costs` are those of the states of each drawing, of which
/// there must be at least one.
pub fn path_of_least_cost(costs: &[Vec<f64>], motion: &impl Motion) -> Vec<usize> {
    let own = |i: usize, h: usize| costs[i][h];
    let count = |i: usize| costs[i].len();
    if costs.len() < 2 {
        let least = |i: usize| (0..count(i)).min_by(|&a, &b| own(i, a).total_cmp(&own(i, b)));
        return (0..costs.len()).filter_map(least).collect();
    }
    let first = |g: usize, h: usize| own(0, g) + own(1, h) + motion.speed(1, [g, h]);
    // least[g][h]: least cost of the paths that end with hypothesis g, then h.
    let mut least: Vec<Vec<f64>> = (0..count(0)).map(|g| (0..count(1)).map(|h| first(g, h)).collect()).collect();
    let mut origins: Vec<Vec<Vec<usize>>> = Vec::new();
    for i in 2..costs.len() {
        let mut next = vec![vec![f64::INFINITY; count(i)]; count(i - 1)];
        let mut from = vec![vec![0; count(i)]; count(i - 1)];
        for g in 0..count(i - 1) {
            let mut order: Vec<usize> = (0..count(i - 2)).collect();
            order.sort_by(|&a, &b| least[a][g].total_cmp(&least[b][g]));
            for h in 0..count(i) {
                let step = own(i, h) + motion.speed(i, [g, h]);
                for &f in &order {
                    // A change of speed costs at least 0, so none of the following can be better.
                    if least[f][g] + step >= next[g][h] {
                        break;
                    }
                    let cost = least[f][g] + motion.acceleration(i, [f, g, h]) + step;
                    if cost < next[g][h] {
                        (next[g][h], from[g][h]) = (cost, f);
                    }
                }
            }
        }
        least = next;
        origins.push(from);
    }
    trace_back(&least, &origins)
}

/// The states of a path of least cost, from the table of the last two drawings and the origins of the ones before.
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

/// Mean length of the motion from one drawing to the next, in working pixels.
pub fn mean_shift(a: &[Point], b: &[Point]) -> f64 {
    mean_length(a.len(), |k| b[k] - a[k])
}

/// Mean length of the change of motion over three drawings, in working pixels.
pub fn mean_bend(a: &[Point], b: &[Point], c: &[Point]) -> f64 {
    mean_length(c.len(), |k| c[k] - 2.0 * b[k] + a[k])
}

fn mean_length(count: usize, vector: impl Fn(usize) -> Point) -> f64 {
    (0..count).map(|k| vector(k).length()).sum::<f64>() / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cost_of(path: &[usize], pool: &[Vec<(f64, Point)>], size: f64, gap: usize) -> f64 {
        let unit = (40.0 * size).sqrt();
        let at = |i: usize| pool[i][path[i]].1;
        let mut cost: f64 = (0..path.len()).map(|i| pool[i][path[i]].0.sqrt()).sum();
        let steps = || (1..path.len()).filter(|i| *i != gap);
        let beside = steps().filter(|i| i + 1 == gap || *i == gap + 1);
        cost += beside.map(|i| ACCELERATION * ((at(i) - at(i - 1)).length() / unit).min(CAP)).sum::<f64>();
        cost += steps().map(|i| SPEED * ((at(i) - at(i - 1)).length() / unit).min(CAP)).sum::<f64>();
        let bend = |i: usize| (at(i) - 2.0 * at(i - 1) + at(i - 2)).length();
        let of_bends = (2..path.len()).filter(|i| *i != gap && i - 1 != gap);
        cost + of_bends.map(|i| ACCELERATION * (bend(i) / unit).min(CAP)).sum::<f64>()
    }

    proptest! {
        #[test]
        fn no_other_path_costs_less(
            pool in prop::collection::vec(
                prop::collection::vec((0.0f64..0.2, -40.0f64..40.0, -40.0f64..40.0), 1..4), 1..6),
            gap in 1usize..9,
        ) {
            let pool: Vec<Vec<(f64, Point)>> =
                pool.into_iter().map(|c| c.into_iter().map(|(e, x, y)| (e, Point::new(x, y))).collect()).collect();
            let candidates: Vec<Vec<Candidate>> = pool
                .iter()
                .map(|c| c.iter().map(|(e, p)| Candidate { cost: e.sqrt(), points: std::slice::from_ref(p) }).collect())
                .collect();
            let path = best_path(&candidates, Smoothness::new(50.0), &[gap]);
            prop_assert_eq!(path.len(), pool.len());
            let mut all = vec![Vec::new()];
            for hypotheses in &pool {
                all = all
                    .into_iter()
                    .flat_map(|p: Vec<usize>| (0..hypotheses.len()).map(move |h| [p.clone(), vec![h]].concat()))
                    .collect();
            }
            let least = all.iter().map(|p| cost_of(p, &pool, 50.0, gap)).fold(f64::INFINITY, f64::min);
            prop_assert!((cost_of(&path, &pool, 50.0, gap) - least).abs() < 1e-12);
        }
    }
}
