//! Which stroke each stretch of a traced line is.
//!
//! Strokes that were carried to a drawing lie on its lines, or near them. A point of a line costs a stroke its distance, and the difference of
//! directions; a point that the stroke does not reach costs more, and so does a point of nobody. To pass from one stroke to another costs a stretch of
//! several widths. The stretches of least cost are found by dynamic programming. So crossings change nothing, and short gaps of a
//! stroke are bridged.

use super::samples::{Cells, Sample, of_line};
use crate::stroke::Tracked;
use rototoon_base::geometry::Point;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// What a point costs at the farthest place at which a stroke reaches it.
const FAR: f64 = 0.4;
/// What a line across costs.
const TURNED: f64 = 1.0;
/// What a stroke costs of which nothing is known any more.
const UNSURE: f64 = 0.2;
/// What a point of nobody costs; one that its stroke does not reach costs 1.
const NOBODY: f64 = 0.8;
/// The length whose cost a change of strokes costs, in distances in which a stroke is on ink.
const CHANGE: f64 = 3.0;

/// A stretch of a line, and the stroke that it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its points.
    pub points: Range<usize>,
    /// The place of the stroke.
    pub stroke: Option<usize>,
}

/// Strokes, to be asked for.
pub struct Labels {
    samples: Vec<(Sample, usize)>,
    cells: Cells,
    reach: f64,
    unsure: Vec<f64>,
}

impl Labels {
    /// Of strokes, which are on a line within `reach`.
    pub fn new<'a>(strokes: impl Iterator<Item = &'a Tracked>, reach: f64) -> Self {
        let (mut samples, mut unsure) = (Vec::new(), Vec::new());
        for (k, Tracked { stroke, confidence, .. }) in strokes.enumerate() {
            samples.extend(of_line(&stroke.points, stroke.closed, 0.5 * reach).into_iter().map(|sample| (sample, k)));
            unsure.push(UNSURE * (1.0 - confidence));
        }
        let cells = Cells::new(samples.iter().map(|(sample, _)| sample.place), reach);
        Self { samples, cells, reach, unsure }
    }

    /// The stretches of a line, in order, by strokes that `may` have some.
    pub fn runs(&self, points: &[Point], may: &impl Fn(usize) -> bool) -> Vec<Run> {
        let costs: Vec<BTreeMap<usize, f64>> = (0..points.len()).map(|i| self.costs(points, i, may)).collect();
        let near: BTreeSet<usize> = costs.iter().flat_map(|own| own.keys().copied()).collect();
        let states: Vec<Option<usize>> = near.into_iter().map(Some).chain([None]).collect();
        let weight = |i: usize| {
            let beside = [i.checked_sub(1), (i + 1 < points.len()).then_some(i + 1)];
            0.5 * beside.into_iter().flatten().map(|j| points[i].distance(points[j])).sum::<f64>()
        };
        let cost = |i: usize, state: Option<usize>| {
            weight(i) * state.map_or(NOBODY, |k| costs[i].get(&k).copied().unwrap_or(1.0))
        };
        let chosen = least(points.len(), &states, CHANGE * self.reach, cost);
        let places: Vec<usize> = (0..points.len()).collect();
        let runs = places.chunk_by(|&a, &b| chosen[a] == chosen[b]);
        runs.map(|run| Run { points: run[0]..run[run.len() - 1] + 1, stroke: states[chosen[run[0]]] }).collect()
    }

    /// What a point costs each stroke that reaches it.
    fn costs(&self, points: &[Point], i: usize, may: &impl Fn(usize) -> bool) -> BTreeMap<usize, f64> {
        // Neighbours are a pixel apart, so directions are those of a few of them.
        let (before, behind) = (i.saturating_sub(3), (i + 3).min(points.len() - 1));
        let along = (points[behind] - points[before]).normalize_or_zero();
        let mut found = BTreeMap::new();
        for k in self.cells.near(points[i], self.reach) {
            let (sample, stroke) = &self.samples[k];
            let far = sample.place.distance(points[i]) / self.reach;
            if far > 1.0 || !may(*stroke) {
                continue;
            }
            let turned = 1.0 - sample.along.dot(along).powi(2);
            let cost = (FAR * far * far + TURNED * turned + self.unsure[*stroke]).min(1.0);
            found.entry(*stroke).and_modify(|best: &mut f64| *best = best.min(cost)).or_insert(cost);
        }
        found
    }
}

/// The state of each of `count` points, by its place, so that the sum of costs is least. Another state than before costs `change`.
fn least(
    count: usize,
    states: &[Option<usize>],
    change: f64,
    cost: impl Fn(usize, Option<usize>) -> f64,
) -> Vec<usize> {
    let mut costs = vec![0.0; states.len()];
    let mut from: Vec<Vec<usize>> = Vec::with_capacity(count);
    let best = |costs: &[f64]| (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
    for i in 0..count {
        let cheapest = best(&costs);
        let stays = |k: usize| i == 0 || costs[k] <= costs[cheapest] + change;
        from.push((0..states.len()).map(|k| if stays(k) { k } else { cheapest }).collect());
        let to = |k: usize| costs[from[i][k]] + if stays(k) { 0.0 } else { change } + cost(i, states[k]);
        costs = (0..states.len()).map(to).collect();
    }
    let mut chosen = vec![best(&costs); count];
    for i in (1..count).rev() {
        chosen[i - 1] = from[i][chosen[i]];
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::Stroke;

    fn line(from: Point, to: Point) -> Vec<Point> {
        let count = from.distance(to) as usize;
        (0..=count).map(|k| from.lerp(to, k as f64 / count as f64)).collect()
    }

    fn labels(strokes: &[(Point, Point)]) -> Labels {
        let tracked =
            |&(from, to): &(Point, Point)| Tracked::sure(0, Stroke { points: line(from, to), ..Stroke::default() });
        let strokes: Vec<Tracked> = strokes.iter().map(tracked).collect();
        Labels::new(strokes.iter(), 4.0)
    }

    #[test]
    fn a_line_is_divided_where_its_strokes_are_and_a_stroke_across_is_passed() {
        let at = |x: f64, y: f64| Point::new(x, y);
        let strokes =
            [(at(0.0, 1.0), at(50.0, 1.0)), (at(50.0, 0.0), at(100.0, 0.0)), (at(20.0, -30.0), at(20.0, 30.0))];
        let runs = labels(&strokes).runs(&line(at(0.0, 0.0), at(200.0, 0.0)), &|_| true);
        assert_eq!(runs.iter().map(|run| run.stroke).collect::<Vec<_>>(), [Some(0), Some(1), None]);
        assert!(runs[0].points.end.abs_diff(50) <= 4 && runs[1].points.end.abs_diff(102) <= 4, "{runs:?}");
    }

    #[test]
    fn a_short_gap_of_a_stroke_is_bridged() {
        let at = |x: f64| Point::new(x, 0.0);
        let runs = labels(&[(at(0.0), at(40.0)), (at(52.0), at(100.0))]).runs(&line(at(0.0), at(100.0)), &|_| true);
        assert_eq!(runs.len(), 2, "{runs:?}");
    }
}
