//! Where the points of strokes are on the next drawing, roughly: registration of two line drawings.
//!
//! Drawings of one film may be far apart: a hand moves by its own size, and fingers turn. Nearest ink is then the wrong
//! ink. So points are first compared by what the drawing looks like around them ([`super::context`]). Each point keeps its
//! best places as candidates, and one is chosen for all points together ([`super::belief`]): neighbours keep their distance
//! and turn little against each other, as far as their candidates allow (the as-rigid-as-possible energy on edges; Sorkine
//! & Alexa 2007). A pair costs at most a fixed amount, so parts may also move apart.
//!
//! Any two drawings can be registered somehow. If they have nothing to do with each other, the points' surroundings stay
//! unlike each other, and neighbours are torn apart. Only where both is so the drawings are *unrelated*. Over eight real
//! sequences the median difference of contexts was at most 0.14, and the mean cost of a pair at most 0.65; between drawings of
//! different sequences they were at least 0.25 and 0.88.
//!
//! The choice is smoothed, which drops outliers. A second round looks near the smoothed place only, with
//! smaller contexts and with the directions that the first round found.

use super::belief::{Tie, choose};
use super::confidence::Signs;
use super::context::{Context, context, difference};
use super::samples::{Cells, Sample, of_ink, of_line, of_short_line};
use crate::drawing::Drawing;
use crate::stroke::{Stroke, Tracked};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polyline};
use serde::{Deserialize, Serialize};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Points of all strokes together, at most about.
const POINTS: f64 = 800.0;
/// Least distance of points in pixels, at 540 lines.
const STEP: f64 = 5.0;
/// Candidates of a point.
const CANDIDATES: usize = 20;
/// Strength of ties along strokes, over longer stretches of them, and to other strokes.
const ALONG: f32 = 1.0;
const STRETCH: f32 = 0.5;
const ACROSS: f32 = 0.4;
/// Points of a stretch.
const REACH: usize = 4;
/// Relative change of length, and change of direction, that costs 1.
const LENGTH: f64 = 0.3;
const TURN: f64 = 0.8;
/// Most that a pair costs: parts may move apart, but a stroke seldom tears.
const MOST: f32 = 4.0;
const MOST_ALONG: f32 = 12.0;
/// Rounds of messages.
const ROUNDS: usize = 5;

/// Median difference of contexts, and mean cost of a pair, from which drawings are unrelated.
const UNLIKE: f32 = 0.2;
const TORN: f32 = 0.75;
/// Points from which drawings can be told to be unrelated.
const FEWEST: usize = 40;

/// The points of strokes and their places on the next drawing.
pub struct Registered {
    /// For each stroke, the points' arc lengths from its start.
    pub lengths: Vec<Vec<f64>>,
    /// For each stroke, the points' shifts.
    pub shifts: Vec<Vec<Point>>,
    /// Whether the drawings show the same thing.
    pub related: bool,
    /// For each stroke, what tells how well it was found.
    pub signs: Vec<Signs>,
}

/// What one round found.
struct Round {
    shifts: Vec<Point>,
    related: bool,
    /// For each point, how its surroundings differ.
    unlike: Vec<f32>,
    /// For each tie its cost.
    torn: Vec<f32>,
}

/// A place of ink and what it costs. The order is that of the costs, then of the places.
#[derive(Clone, Copy, PartialEq)]
struct Found {
    cost: f32,
    place: usize,
}

impl Eq for Found {}

impl Ord for Found {
    fn cmp(&self, other: &Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then(self.place.cmp(&other.place))
    }
}

impl PartialOrd for Found {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Values that both rounds share.
struct Scene {
    points: Vec<Sample>,
    /// The stroke of each point.
    stroke: Vec<usize>,
    ties: Vec<Tie>,
    step: f64,
    /// Whether there are more strokes than points should be. Then short ones have a single point.
    many: bool,
    /// Diagonal of the box around all points.
    size: f64,
}

/// Places on the lines of one drawing, and where they are on another one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Displaced {
    /// Each place with its shift, in pixels.
    pub places: Vec<(Point, Point)>,
    /// Whether the drawings show the same thing.
    pub related: bool,
}

/// Finds where the lines of the drawing `from`, which are `strokes`, are on the drawing `to`.
pub fn displaced(from: &Drawing, strokes: &[Stroke], to: &Drawing) -> Displaced {
    let strokes = strokes.iter().filter(|stroke| stroke.points.len() > 1).cloned();
    let strokes: Vec<Tracked> = strokes.enumerate().map(|(track, stroke)| Tracked::sure(track, stroke)).collect();
    let scene = Scene::new(&strokes, from.unit);
    let found = scene.found(from, to);
    let places = scene.points.iter().zip(&found.shifts).map(|(point, &shift)| (point.place, shift)).collect();
    Displaced { places, related: scene.related(&found) }
}

/// Finds the points of strokes of the drawing `from` on the drawing `to`.
pub fn register(from: &Drawing, strokes: &[Tracked], to: &Drawing) -> Registered {
    let scene = Scene::new(strokes, from.unit);
    let found = scene.found(from, to);
    Registered { related: scene.related(&found), ..scene.registered(strokes, &found) }
}

impl Scene {
    fn new(strokes: &[Tracked], unit: f64) -> Self {
        let total: f64 = strokes.iter().map(|s| polyline::length(&s.stroke.points, s.stroke.closed)).sum();
        let step = (STEP * unit).max(total / POINTS).max(1.0);
        let many = strokes.len() as f64 > POINTS;
        let (mut points, mut stroke, mut ties) = (Vec::new(), Vec::new(), Vec::new());
        for (k, tracked) in strokes.iter().enumerate() {
            let first = points.len();
            let Stroke { points: line, closed, .. } = &tracked.stroke;
            points.extend(if many { of_short_line(line, *closed, step) } else { of_line(line, *closed, step) });
            stroke.resize(points.len(), k);
            ties.extend((first + 1..points.len()).map(|i| Tie { a: i - 1, b: i, weight: ALONG }));
            ties.extend((first + REACH..points.len()).map(|i| Tie { a: i - REACH, b: i, weight: STRETCH }));
            if tracked.stroke.closed && points.len() > first + 2 {
                ties.push(Tie { a: first, b: points.len() - 1, weight: ALONG });
            }
        }
        let low = points.iter().fold(Point::INFINITY, |low, p: &Sample| low.min(p.place));
        let high = points.iter().fold(Point::NEG_INFINITY, |high, p: &Sample| high.max(p.place));
        let size = if points.is_empty() { 1.0 } else { low.distance(high).max(1.0) };
        let mut scene = Self { points, stroke, ties, step, many, size };
        scene.tie_across();
        scene
    }

    /// Ties each point to the nearest points of the two strokes nearest to it.
    fn tie_across(&mut self) {
        let reach = 0.12 * self.size;
        let cells = Cells::new(self.points.iter().map(|p| p.place), reach.max(self.step));
        let across: Vec<Vec<Tie>> = (0..self.points.len())
            .into_par_iter()
            .map(|i| {
                let place = self.points[i].place;
                let mut near: Vec<(f64, usize)> = cells
                    .near(place, reach)
                    .filter(|&j| self.stroke[j] != self.stroke[i])
                    .map(|j| (self.points[j].place.distance(place), j))
                    .filter(|found| found.0 < reach)
                    .collect();
                near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let mut seen: Vec<usize> = Vec::new();
                near.retain(|&(_, j)| {
                    seen.len() < 2 && !seen.contains(&self.stroke[j]) && (seen.push(self.stroke[j]), true).1
                });
                near.into_iter().map(|(_, j)| Tie { a: i.min(j), b: i.max(j), weight: ACROSS }).collect()
            })
            .collect();
        self.ties.extend(across.into_iter().flatten());
        self.ties.sort_by_key(|tie| (tie.a, tie.b));
        self.ties.dedup_by_key(|tie| (tie.a, tie.b));
    }

    /// Both rounds.
    fn found(&self, from: &Drawing, to: &Drawing) -> Round {
        let ink = |drawing: &Drawing| of_ink(drawing, self.step, self.many);
        let (here, there) = (ink(from), ink(to));
        let mut found = Round::still(self);
        if !there.is_empty() {
            for round in 0..2 {
                found = self.round(round, &here, &there, &found.shifts);
            }
        }
        found
    }

    /// Whether the drawings show the same thing, as far as a few points can tell.
    fn related(&self, found: &Round) -> bool {
        found.related || self.points.len() < FEWEST
    }

    fn round(&self, round: usize, here: &[Sample], there: &[Sample], before: &[Point]) -> Round {
        let radius = self.size * if round == 0 { 0.3 } else { 0.15 };
        let contexts = |at: Vec<Point>, ink: &[Sample]| -> Vec<Context> {
            at.into_par_iter().map(|p| context(p, ink, radius)).collect()
        };
        let own = contexts(self.points.iter().map(|p| p.place).collect(), here);
        let theirs = contexts(there.iter().map(|p| p.place).collect(), there);
        let along = self.directions(before);
        let candidates: Vec<Vec<(f32, usize)>> = (0..self.points.len())
            .into_par_iter()
            .map(|i| {
                let place = self.points[i].place + before[i];
                let cost = |j: usize| {
                    let far = place.distance(there[j].place) / self.size;
                    let turned = 1.0 - along[i].dot(there[j].along).powi(2);
                    let context = f64::from(difference(&own[i], &theirs[j]));
                    match round {
                        0 => 8.0 * context + 8.0 * (far * far).min(0.25) + 0.5 * turned,
                        _ => 5.0 * context + (far / 0.04).powi(2).min(8.0) + turned,
                    }
                };
                self.candidates(there, cost)
            })
            .collect();
        let costs: Vec<Vec<f32>> = candidates.iter().map(|own| own.iter().map(|c| c.0).collect()).collect();
        let pair = |t: usize, c: usize, d: usize| {
            let Tie { a, b, weight } = self.ties[t];
            let was = self.points[b].place - self.points[a].place;
            let is = there[candidates[b][d].1].place - there[candidates[a][c].1].place;
            let scale = was.length() + self.step;
            let longer = (is.length() - was.length()) / (LENGTH * scale);
            let turned = (is - was).length() / (TURN * scale);
            ((longer * longer + turned * turned) as f32).min(if weight == ALONG { MOST_ALONG } else { MOST })
        };
        let chosen = choose(&costs, &self.ties, &pair, ROUNDS);
        let differ = |(i, &c): (usize, &usize)| difference(&own[i], &theirs[candidates[i][c].1]);
        let unlike: Vec<f32> = chosen.iter().enumerate().map(differ).collect();
        let torn: Vec<f32> =
            self.ties.iter().enumerate().map(|(t, tie)| pair(t, chosen[tie.a], chosen[tie.b])).collect();
        let related = median(unlike.iter().copied()) < UNLIKE || mean(torn.iter().copied()) < TORN;
        let shifts: Vec<Point> =
            chosen.iter().enumerate().map(|(i, &c)| there[candidates[i][c].1].place - self.points[i].place).collect();
        Round { shifts: self.smoothed(&shifts), related, unlike, torn }
    }

    /// The best places of a point, at least a step apart.
    fn candidates(&self, there: &[Sample], cost: impl Fn(usize) -> f64) -> Vec<(f32, usize)> {
        // Few of them are taken, so they are not all sorted.
        let mut all: BinaryHeap<Reverse<Found>> =
            (0..there.len()).map(|place| Reverse(Found { cost: cost(place) as f32, place })).collect();
        let mut kept: Vec<(f32, usize)> = Vec::new();
        while let Some(Reverse(Found { cost, place })) = all.pop() {
            let apart = |other: &(f32, usize)| there[other.1].place.distance(there[place].place) > 0.8 * self.step;
            if kept.iter().all(apart) {
                kept.push((cost, place));
                if kept.len() == CANDIDATES {
                    break;
                }
            }
        }
        kept
    }

    /// The directions of the strokes at their points, shifted.
    fn directions(&self, shifts: &[Point]) -> Vec<Point> {
        let n = self.points.len();
        let at = |i: usize| self.points[i].place + shifts[i];
        let mate = |i: usize, j: usize| if j < n && self.stroke[j] == self.stroke[i] { j } else { i };
        (0..n)
            .map(|i| (at(mate(i, i + 1)) - at(mate(i, i.wrapping_sub(1)))).normalize_or(self.points[i].along))
            .collect()
    }

    /// Shifts that vary little between neighbours; what disagrees with its neighbours counts little.
    fn smoothed(&self, shifts: &[Point]) -> Vec<Point> {
        /// Rounds of reweighting and sweeps in each.
        const ROUNDS: usize = 5;
        const SWEEPS: usize = 10;
        let mut around: Vec<Vec<(usize, f64)>> = vec![Vec::new(); shifts.len()];
        for tie in &self.ties {
            let way = self.points[tie.a].place.distance(self.points[tie.b].place) / self.step;
            let weight = f64::from(tie.weight) / way.max(1.0);
            around[tie.a].push((tie.b, weight));
            around[tie.b].push((tie.a, weight));
        }
        let mut smooth = shifts.to_vec();
        for _ in 0..ROUNDS {
            let trust: Vec<f64> = (0..shifts.len())
                .map(|i| (1.0 + smooth[i].distance_squared(shifts[i]) / (2.0 * self.step).powi(2)).powi(-2))
                .collect();
            for _ in 0..SWEEPS {
                for i in 0..shifts.len() {
                    let (mut sum, mut total) = (trust[i] * shifts[i], trust[i]);
                    for &(j, weight) in &around[i] {
                        sum += 0.5 * weight * smooth[j];
                        total += 0.5 * weight;
                    }
                    smooth[i] = sum / total.max(1e-12);
                }
            }
        }
        smooth
    }

    /// How well each of `count` strokes was found: means over its points and ties.
    fn signs(&self, count: usize, round: &Round) -> Vec<Signs> {
        let mut signs = vec![Signs::default(); count];
        let (mut points, mut ties) = (vec![0.0f64; count], vec![0.0f64; count]);
        for (i, &k) in self.stroke.iter().enumerate() {
            points[k] += 1.0;
            signs[k].unlike += f64::from(round.unlike[i]);
        }
        for (tie, &cost) in self.ties.iter().zip(&round.torn) {
            for k in [self.stroke[tie.a], self.stroke[tie.b]] {
                ties[k] += 1.0;
                signs[k].torn += f64::from(cost);
            }
        }
        for (own, (n, m)) in signs.iter_mut().zip(points.into_iter().zip(ties)) {
            own.unlike /= n.max(1.0);
            own.torn /= m.max(1.0);
        }
        signs
    }

    fn registered(&self, strokes: &[Tracked], round: &Round) -> Registered {
        let shifts = &round.shifts;
        let none = || vec![Vec::new(); strokes.len()];
        let mut found = Registered {
            lengths: none(),
            shifts: vec![Vec::new(); strokes.len()],
            related: true,
            signs: self.signs(strokes.len(), round),
        };
        for (i, &k) in self.stroke.iter().enumerate() {
            let at = match found.lengths[k].last() {
                Some(&before) => before + self.points[i].place.distance(self.points[i - 1].place),
                None => 0.0,
            };
            found.lengths[k].push(at);
            found.shifts[k].push(shifts[i]);
        }
        found
    }
}

impl Round {
    /// Nothing has moved.
    fn still(scene: &Scene) -> Self {
        let n = scene.points.len();
        let (unlike, torn) = (vec![0.0; n], vec![0.0; scene.ties.len()]);
        Self { shifts: vec![Point::ZERO; n], related: true, unlike, torn }
    }
}

fn median(values: impl Iterator<Item = f32>) -> f32 {
    let mut values: Vec<f32> = values.collect();
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
    sum / count.max(1) as f32
}
