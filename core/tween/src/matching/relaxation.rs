//! Choices that support each other: graduated assignment (Gold & Rangarajan 1996).
//!
//! Each stroke has a weight for each of its labels (a counterpart and a way to lie on it) and one for having no
//! counterpart. Strokes that are neighbours in the first drawing should be neighbours in the second. A place where two
//! strokes touch, or nearly touch, is mapped by the labels of both. The distance of the two images is the cost of
//! choosing both labels.
//!
//! The weights follow from the costs under the present weights of the neighbours. β makes them sharper from round to
//! round. Between rounds they are normalised so that no stroke of the second drawing is taken more than once
//! (Sinkhorn). Exact assignments come last. They repeat as long as they lower the energy.
//!
//! Limits: the result is a local minimum. Only the nearest neighbours of a stroke support it.

use super::super::grid::Grid;
use super::Options;
use super::costs::{Figure, Label, Rows};
use super::outline::{Outline, Way};
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::sparse_assignment::{Choice, assign_sparse};

/// Largest number of neighbours of a stroke.
const NEIGHBOURS: usize = 6;
/// Number of strokes with near centres among which the neighbours are chosen.
const LOOKED_AT: usize = 24;
/// Weight of all neighbours of a stroke together.
const SUPPORT: f64 = 2.0;
/// Gap, in units of the geometric mean of the two radii, at which a neighbour has half the weight of a touching one.
const TOUCHING: f64 = 0.15;
/// Distance of two images, in units of the mean of the two radii, that costs the full weight of a neighbour.
const TORN: f64 = 1.0;
/// Cost of a neighbour that has no counterpart.
const MISSING: f64 = 0.4;
/// β of the first and of the last round.
const BETA: (f64, f64) = (1.5, 30.0);
const ROUNDS: usize = 12;
/// A stroke with a weight above this has settled; further rounds do not change it.
const SETTLED: f64 = 1.0 - 1e-5;
/// Number of normalisations in each round.
const SINKHORN: usize = 4;
/// Largest number of exact assignments at the end.
const EXACT: usize = 6;
/// Difference of cost to the next best counterpart that makes a pair nearly certain.
const SURE: f64 = 0.5;

/// The counterpart of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chosen {
    pub to: usize,
    pub way: Way,
    pub confidence: f64,
}

/// The choices of all strokes and their total cost.
pub(super) struct Relaxed {
    pub chosen: Vec<Option<Chosen>>,
    pub energy: f64,
}

/// The images of the links' places under the labels. `own[l]` has those of the stroke for link `l`, all x and then all
/// y. `other[l][k]` is that of the neighbour's label `k`.
struct Images {
    own: Vec<(Vec<f64>, Vec<f64>)>,
    other: Vec<Vec<Point>>,
}

impl Images {
    fn new(i: usize, rows: &Rows, links: &[Link]) -> Self {
        let of = |stroke: usize, link: &Link| -> Vec<Point> {
            rows.labels[stroke].iter().map(|label| label.map.apply(link.place)).collect()
        };
        Self {
            own: links.iter().map(|link| of(i, link).into_iter().map(|p| (p.x, p.y)).unzip()).collect(),
            other: links.iter().map(|link| of(link.to, link)).collect(),
        }
    }
}

/// A neighbour, the place where the two strokes nearly touch, its weight, and the distance of images that counts as
/// torn apart. Pixels.
struct Link {
    to: usize,
    place: Point,
    weight: f64,
    torn: f64,
}

/// Weights of a stroke's labels, and of having no counterpart. They sum to 1.
#[derive(Clone)]
struct Weights {
    labels: Vec<f64>,
    none: f64,
}

/// The links of all strokes and their images.
#[derive(Clone, Copy)]
struct Links<'a> {
    links: &'a [Vec<Link>],
    images: &'a [Images],
}

/// Chooses a label for each row. `neighbours` are those of the first drawing.
pub(super) fn relaxed(neighbours: &Neighbours, b: &Figure, rows: &Rows, options: &Options) -> Relaxed {
    let links = &neighbours.0;
    let images: Vec<Images> = (0..links.len()).into_par_iter().map(|i| Images::new(i, rows, &links[i])).collect();
    let links = Links { links, images: &images };
    let mut weights: Vec<Weights> =
        rows.labels.iter().map(|l| Weights { labels: vec![0.0; l.len()], none: 1.0 }).collect();
    for (i, labels) in rows.labels.iter().enumerate() {
        let own: Vec<f64> = labels.iter().map(|label| label.cost).collect();
        weights[i] = softened(&own, none_cost(rows, i, options), BETA.0);
    }
    for round in 0..ROUNDS {
        let beta = BETA.0 * (BETA.1 / BETA.0).powf(round as f64 / (ROUNDS - 1) as f64);
        let costs = supported(rows, links, &weights);
        let next = costs.par_iter().enumerate().map(|(i, c)| softened(c, none_cost(rows, i, options), beta)).collect();
        weights = normalised(next, rows, b.outlines.len());
        let settled = |w: &Weights| w.none > SETTLED || w.labels.iter().any(|&v| v > SETTLED);
        if weights.iter().all(settled) {
            break;
        }
    }
    harden(rows, links, weights, b, options)
}

fn none_cost(rows: &Rows, i: usize, options: &Options) -> f64 {
    if rows.bound[i] && !rows.labels[i].is_empty() { 1e6 } else { options.max_cost }
}

fn softened(costs: &[f64], none: f64, beta: f64) -> Weights {
    let least = costs.iter().copied().fold(none, f64::min);
    let raw: Vec<f64> = costs.iter().map(|c| (-beta * (c - least)).exp()).collect();
    let none = (-beta * (none - least)).exp();
    let total = raw.iter().sum::<f64>() + none;
    Weights { labels: raw.into_iter().map(|w| w / total).collect(), none: none / total }
}

/// The cost of each label under the weights of the neighbours.
fn supported(rows: &Rows, links: Links, weights: &[Weights]) -> Vec<Vec<f64>> {
    let of_stroke = |i: usize| {
        let mut costs: Vec<f64> = vec![0.0; rows.labels[i].len()];
        let images = &links.images[i];
        let mut torn = vec![0.0; costs.len()];
        for (l, link) in links.links[i].iter().enumerate() {
            let neighbour = &weights[link.to];
            torn.fill(0.0);
            for (&weight, &there) in neighbour.labels.iter().zip(&images.other[l]).filter(|(w, _)| **w > 1e-6) {
                add_torn(&mut torn, &images.own[l], there, weight, 1.0 / (link.torn * link.torn));
            }
            for (cost, torn) in costs.iter_mut().zip(&torn) {
                *cost += link.weight * (torn + MISSING * neighbour.none);
            }
        }
        costs.iter_mut().zip(&rows.labels[i]).for_each(|(cost, label)| *cost += label.cost);
        costs
    };
    (0..rows.labels.len()).into_par_iter().with_min_len(16).map(of_stroke).collect()
}

/// Adds the cost of one of a neighbour's labels to each label of the stroke. The neighbour's label maps the link's
/// place to `there`, the stroke's labels map it to `own`. The cost is the squared distance in units of the tearing
/// distance, at most 1, times `weight`. All labels are computed side by side for vector instructions.
fn add_torn(torn: &mut [f64], own: &(Vec<f64>, Vec<f64>), there: Point, weight: f64, scale: f64) {
    for ((torn, x), y) in torn.iter_mut().zip(&own.0).zip(&own.1) {
        let (dx, dy) = (x - there.x, y - there.y);
        *torn += weight * ((dx * dx + dy * dy) * scale).min(1.0);
    }
}

fn normalised(mut weights: Vec<Weights>, rows: &Rows, columns: usize) -> Vec<Weights> {
    let mut sums = vec![0.0; columns];
    for _ in 0..SINKHORN {
        sums.fill(0.0);
        for (w, labels) in weights.iter().zip(&rows.labels) {
            labels.iter().zip(&w.labels).for_each(|(label, w)| sums[label.to] += w);
        }
        for (w, labels) in weights.iter_mut().zip(&rows.labels) {
            for (label, w) in labels.iter().zip(&mut w.labels) {
                *w /= sums[label.to].max(1.0);
            }
            let total = w.labels.iter().sum::<f64>() + w.none;
            if total > 0.0 {
                w.labels.iter_mut().for_each(|v| *v /= total);
                w.none /= total;
            }
        }
    }
    weights
}

/// The energy, the label of each stroke, and the cost of each label under the labels of the others.
type Assigned = (f64, Vec<Option<usize>>, Vec<Vec<f64>>);

/// Turns weights into exact assignments. The first follows from the weights, each later one from the assignment before
/// it.
fn harden(rows: &Rows, links: Links, soft: Vec<Weights>, b: &Figure, options: &Options) -> Relaxed {
    let mut weights = soft;
    let mut best: Option<Assigned> = None;
    for _ in 0..EXACT {
        let costs = supported(rows, links, &weights);
        let picked = assigned(rows, &costs, b.outlines.len(), options);
        weights = picked
            .iter()
            .zip(&rows.labels)
            .map(|(pick, labels)| Weights {
                labels: (0..labels.len()).map(|k| f64::from(u8::from(*pick == Some(k)))).collect(),
                none: f64::from(u8::from(pick.is_none())),
            })
            .collect();
        let under = supported(rows, links, &weights);
        let of = |(i, pick): (usize, &Option<usize>)| match *pick {
            // Both strokes of a link count its cost, so each counts half.
            Some(k) => 0.5 * (rows.labels[i][k].cost + under[i][k]),
            None => none_cost(rows, i, options).min(options.max_cost),
        };
        let energy = picked.iter().enumerate().map(of).sum::<f64>();
        if best.as_ref().is_some_and(|(least, ..)| energy >= *least) {
            break;
        }
        best = Some((energy, picked, under));
    }
    let (energy, picked, costs) = best.unwrap_or_default();
    let chosen = picked.iter().enumerate().map(|(i, pick)| {
        pick.map(|k| {
            let label = rows.labels[i][k];
            Chosen { to: label.to, way: label.way, confidence: sureness(rows, &costs, (i, k), b, options) }
        })
    });
    Relaxed { chosen: chosen.collect(), energy }
}

/// The label of each stroke in an exact assignment.
fn assigned(rows: &Rows, costs: &[Vec<f64>], columns: usize, options: &Options) -> Vec<Option<usize>> {
    let mut choices = Vec::with_capacity(costs.len());
    let mut labels = Vec::with_capacity(costs.len());
    for (row, costs) in rows.labels.iter().zip(costs) {
        let mut least: Vec<(Choice, usize)> = Vec::new();
        for (k, (label, &cost)) in row.iter().zip(costs).enumerate() {
            match least.iter_mut().find(|(choice, _)| choice.column == label.to) {
                Some(known) if cost < known.0.cost => *known = (Choice { column: label.to, cost }, k),
                Some(_) => {}
                None => least.push((Choice { column: label.to, cost }, k)),
            }
        }
        choices.push(least.iter().map(|l| l.0).collect::<Vec<_>>());
        labels.push(least);
    }
    let none: Vec<f64> = (0..costs.len()).map(|i| none_cost(rows, i, options)).collect();
    let found = assign_sparse(&choices, &none, columns);
    let label_of = |(i, column): (usize, Option<usize>)| {
        let column = column?;
        labels[i].iter().find(|(choice, _)| choice.column == column).map(|l| l.1)
    };
    found.into_iter().enumerate().map(label_of).collect()
}

/// How sure a choice is, 0 to 1: by how much the next best counterpart costs more, and how cheap the choice itself is. A stroke that is the
/// same as the counterpart is no other one.
fn sureness(rows: &Rows, costs: &[Vec<f64>], (i, k): (usize, usize), b: &Figure, options: &Options) -> f64 {
    let (own, to) = (costs[i][k], b.firsts[rows.labels[i][k].to]);
    let differs = |(label, _): &(&Label, &f64)| b.firsts[label.to] != to;
    let others = rows.labels[i].iter().zip(&costs[i]).filter(differs).map(|(_, &cost)| cost);
    let next = others.fold(options.max_cost + SUPPORT, f64::min);
    let fit = (1.0 - own / (options.max_cost + SUPPORT)).clamp(0.0, 1.0);
    margin(next - own) * fit.sqrt()
}

/// How sure a choice is where another one costs more by this, 0 to 1.
pub(super) fn margin(more: f64) -> f64 {
    1.0 / (1.0 + (-4.0 * more / SURE).exp())
}

/// The neighbours of each stroke of the first drawing.
pub(super) struct Neighbours(Vec<Vec<Link>>);

impl Neighbours {
    pub fn new(a: &Figure) -> Self {
        Self(links(a))
    }
}

fn links(a: &Figure) -> Vec<Vec<Link>> {
    let numbers: Vec<usize> = (0..a.outlines.len()).filter(|&i| a.outlines[i].is_some()).collect();
    let centres: Vec<Point> = numbers.iter().filter_map(|&i| Some(a.outlines[i].as_ref()?.centre)).collect();
    let grid = Grid::new(&centres);
    let of = |i: usize| {
        let Some(own) = &a.outlines[i] else { return Vec::new() };
        let near = grid.nearest(own.centre, LOOKED_AT + 1).into_iter().map(|k| numbers[k]).filter(|&j| j != i);
        let mut links: Vec<Link> = near.filter_map(|j| Some(link(own, a.outlines[j].as_ref()?, j))).collect();
        links.sort_by(|x, y| y.weight.total_cmp(&x.weight).then(x.to.cmp(&y.to)));
        links.truncate(NEIGHBOURS);
        let total: f64 = links.iter().map(|l| l.weight).sum::<f64>().max(1e-9);
        // A stroke whose neighbours are far away is bound to them less.
        let share = SUPPORT * total / (total + 0.2) / total;
        links.iter_mut().for_each(|l| l.weight *= share);
        links
    };
    (0..a.outlines.len()).into_par_iter().map(of).collect()
}

fn link(a: &Outline, b: &Outline, to: usize) -> Link {
    let mut least = (f64::INFINITY, a.centre, b.centre);
    for &p in &a.places {
        for &q in &b.places {
            let d = p.distance_squared(q);
            if d < least.0 {
                least = (d, p, q);
            }
        }
    }
    let size = (a.radius * b.radius).sqrt();
    let gap = least.0.sqrt() / (TOUCHING * size);
    Link {
        to,
        place: 0.5 * (least.1 + least.2),
        weight: 1.0 / (1.0 + gap * gap),
        torn: TORN * 0.5 * (a.radius + b.radius),
    }
}
