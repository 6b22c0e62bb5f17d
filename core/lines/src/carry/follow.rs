//! Strokes laid onto the ink of the next drawing: map matching.
//!
//! A stroke whose rough place is known is walked in small steps. Each step may be on any point of ink near its place, or
//! off the ink at a price. The way of least cost is found by dynamic programming (Viterbi 1967; for roads: Newson & Krumm
//! 2009). A point of ink costs its distance and its difference in direction, and two steps cost the difference between
//! their move and the expected one. So the stroke keeps to one line, goes through crossings, and does not jump to a line
//! that comes near.

use super::samples::{Cells, Sample, of_line};
use rototoon_base::geometry::Point;

/// Distance of steps in pixels, at 540 lines.
pub const STEP: f64 = 3.0;
/// Candidates of a step.
const CANDIDATES: usize = 28;
/// Distance from the expected place that costs 1, at 540 lines.
const FAR: f64 = 5.0;
/// Cost of a line across.
const TURNED: f64 = 3.0;
/// Cost of a step off the ink, and of going there.
const OFF: f64 = 7.0;
const LEAVE: f64 = 2.0;
/// Difference of moves that costs 1, in steps, and the most that it costs.
const MOVE: f64 = 0.7;
const MOST: f64 = 12.0;

/// The ink of a drawing, to be searched.
pub struct Ink {
    samples: Vec<Sample>,
    cells: Cells,
    unit: f64,
}

/// A stroke on the ink.
pub struct Followed {
    /// Points.
    pub points: Vec<Point>,
    /// Whether each is on ink.
    pub on: Vec<bool>,
    /// Mean distance from the expected places, in pixels of 540 lines.
    pub far: f64,
}

struct Choice {
    place: Point,
    cost: f64,
    on: bool,
}

impl Ink {
    /// The samples of the ink, about 1.5 pixels of 540 lines apart.
    pub fn new(samples: Vec<Sample>, unit: f64) -> Self {
        let cells = Cells::new(samples.iter().map(|s| s.place), reach(unit));
        Self { samples, cells, unit }
    }

    /// Lays a line at its expected place onto the ink.
    pub fn follow(&self, expected: &[Point], closed: bool) -> Followed {
        let steps = of_line(expected, closed, STEP * self.unit);
        let choices: Vec<Vec<Choice>> = steps.iter().map(|step| self.choices(step)).collect();
        let chosen = self.least(&steps, &choices);
        let pick = chosen.iter().zip(&choices).map(|(&c, own)| &own[c]);
        let (points, on): (Vec<Point>, Vec<bool>) = pick.map(|choice| (choice.place, choice.on)).unzip();
        let far: f64 = steps.iter().zip(&points).map(|(step, p)| step.place.distance(*p)).sum();
        Followed { far: far / (self.unit * points.len().max(1) as f64), points, on }
    }

    fn choices(&self, step: &Sample) -> Vec<Choice> {
        let reach = reach(self.unit);
        let mut near: Vec<(f64, usize)> = self
            .cells
            .near(step.place, reach)
            .map(|k| (self.samples[k].place.distance(step.place), k))
            .filter(|found| found.0 <= reach)
            .collect();
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(CANDIDATES);
        let choice = |(far, k): (f64, usize)| {
            let turned = 1.0 - self.samples[k].along.dot(step.along).powi(2);
            let cost = (far / (FAR * self.unit)).powi(2) + TURNED * turned;
            Choice { place: self.samples[k].place, cost, on: true }
        };
        let mut found: Vec<Choice> = near.into_iter().map(choice).collect();
        found.push(Choice { place: step.place, cost: OFF, on: false });
        found
    }

    /// The choice of each step along the way of least cost.
    fn least(&self, steps: &[Sample], choices: &[Vec<Choice>]) -> Vec<usize> {
        let mut costs: Vec<f64> = choices[0].iter().map(|choice| choice.cost).collect();
        let mut from: Vec<Vec<usize>> = vec![Vec::new()];
        let scale = MOVE * STEP * self.unit;
        for k in 1..steps.len() {
            let expected = steps[k].place - steps[k - 1].place;
            let mut next = Vec::with_capacity(choices[k].len());
            let mut back = Vec::with_capacity(choices[k].len());
            for to in &choices[k] {
                let way = |(c, before): (usize, &Choice)| {
                    let away = (to.place - before.place).distance_squared(expected) / (scale * scale);
                    let leave = if to.on == before.on { 0.0 } else { LEAVE };
                    (costs[c] + away.min(MOST) + leave, c)
                };
                let all = choices[k - 1].iter().enumerate().map(way);
                let (cost, c) = all.fold((f64::INFINITY, 0), |best, found| if found.0 < best.0 { found } else { best });
                next.push(cost + to.cost);
                back.push(c);
            }
            costs = next;
            from.push(back);
        }
        let mut at = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
        let mut chosen = vec![at; steps.len()];
        for k in (1..steps.len()).rev() {
            at = from[k][at];
            chosen[k - 1] = at;
        }
        chosen
    }
}

fn reach(unit: f64) -> f64 {
    2.5 * FAR * unit
}
