//! The likely counterparts of each stroke, and what each costs under the movement that is expected there.

use super::super::grid::Grid;
use super::super::stroke::Stroke;
use super::movement::Movement;
use super::outline::{Outline, Way, wrap};
use super::{Fixed, Options};
use crate::geometry::similarity::Similarity;
use crate::geometry::{Point, polygon};
use rayon::prelude::*;

/// Weight of the unexplained share of the shape.
const SHAPE: f64 = 2.0;
/// Weight of the squared turn, in rad², of a stroke against the drawing around it.
const TURN: f64 = 0.06;
/// Weight of the squared logarithm of a stroke's growth against that around it.
const SIZE: f64 = 1.0;
/// Weight of the squared logarithm of a length's growth against the size's.
const LENGTH: f64 = 0.5;
/// Weight of the squared distance from the expected place, in units of the drawing's radius.
const POSITION: f64 = 2.0;
/// Squared distance, in those units, from which on farther costs little more.
const FAR: f64 = 2.0;
/// Cost of quite another colour.
const COLOUR: f64 = 2.0;
/// Colour difference (root of the summed squares) that costs half of it: drawings are painted in few flat colours.
const HALF_COLOUR: f64 = 0.06;
/// Cost of another material.
const MATERIAL: f64 = 0.7;
/// Cost of another layer.
const LAYER: f64 = 2.5;
/// Cost of an open stroke drawn closed.
const CLOSEDNESS: f64 = 0.4;
/// Pairs of strokes up to which all are looked at.
const ALL_PAIRS: usize = 40_000;
/// Counterparts looked at for each stroke where there are more.
const NEAREST: usize = 24;
/// Counterparts that are kept for each stroke.
const KEPT: usize = 10;

/// The strokes of a drawing as they are compared.
pub(super) struct Figure<'a> {
    pub strokes: &'a [Stroke],
    /// By stroke; `None` without points.
    pub outlines: Vec<Option<Outline>>,
    /// Open strokes taken as closed.
    rings: Vec<Option<Outline>>,
    /// Mean of the outlines' centres.
    pub middle: Point,
    /// Root mean square distance of the samples from the middle; at least 1.
    pub radius: f64,
}

impl<'a> Figure<'a> {
    pub fn new(strokes: &'a [Stroke]) -> Self {
        let outlines: Vec<_> = strokes.par_iter().map(|s| Outline::new(s, s.closed)).collect();
        let rings = strokes.par_iter().map(|s| if s.closed { None } else { Outline::new(s, true) }).collect();
        Self::of_outlines(strokes, outlines, rings)
    }

    /// The same drawing with no other strokes than those named.
    pub fn only(&self, named: &[usize]) -> Self {
        let pick = |list: &[Option<Outline>]| {
            let mut kept = vec![None; list.len()];
            named.iter().for_each(|&i| kept[i] = list[i].clone());
            kept
        };
        Self { radius: self.radius, ..Self::of_outlines(self.strokes, pick(&self.outlines), pick(&self.rings)) }
    }

    fn of_outlines(strokes: &'a [Stroke], outlines: Vec<Option<Outline>>, rings: Vec<Option<Outline>>) -> Self {
        let middle = polygon::center(&outlines.iter().flatten().map(|o| o.centre).collect::<Vec<_>>());
        let mut figure = Self { strokes, outlines, rings, middle, radius: 1.0 };
        figure.radius = figure.spread();
        figure
    }

    /// Root mean square distance of the strokes' samples from the middle; at least 1.
    pub fn spread(&self) -> f64 {
        let squares =
            self.outlines.iter().flatten().map(|o| o.centre.distance_squared(self.middle) + o.radius * o.radius);
        (squares.sum::<f64>() / self.outlines.iter().flatten().count().max(1) as f64).sqrt().max(1.0)
    }

    /// The outlines of two strokes in a form in which they can be laid upon each other.
    pub fn comparable<'b>(&'b self, i: usize, other: &'b Self, j: usize) -> Option<(&'b Outline, &'b Outline)> {
        let (a, b) = (self.outlines[i].as_ref()?, other.outlines[j].as_ref()?);
        Some(match (a.closed, b.closed) {
            (true, false) => (a, other.rings[j].as_ref()?),
            (false, true) => (self.rings[i].as_ref()?, b),
            _ => (a, b),
        })
    }
}

/// A counterpart, and a way to lay the stroke upon it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label {
    pub to: usize,
    pub way: Way,
    pub map: Similarity,
    pub cost: f64,
}

/// The likely counterparts of each stroke of the first drawing.
pub(super) struct Rows {
    pub labels: Vec<Vec<Label>>,
    /// Whether the stroke must take one of its labels.
    pub bound: Vec<bool>,
}

impl Rows {
    pub fn new(a: &Figure, b: &Figure, around: &[Movement], fixed: &[Fixed], options: &Options) -> Self {
        let numbers: Vec<usize> = (0..b.outlines.len()).filter(|&j| b.outlines[j].is_some()).collect();
        let centres: Vec<Point> = numbers.iter().filter_map(|&j| Some(b.outlines[j].as_ref()?.centre)).collect();
        let grid = Grid::new(&centres);
        let mut taken = vec![false; b.outlines.len()];
        for fixed in fixed {
            if let Fixed::To(j) = fixed {
                taken[*j] = true;
            }
        }
        let all = a.outlines.len().saturating_mul(numbers.len()) <= ALL_PAIRS;
        let row = |i: usize| {
            let Some(outline) = &a.outlines[i] else { return Vec::new() };
            match fixed[i] {
                Fixed::Alone => return Vec::new(),
                Fixed::To(j) => return labels(a, b, i, j, &around[i]),
                Fixed::Free => {}
            }
            let near = if all {
                numbers.clone()
            } else {
                let found = grid.nearest(around[i].apply(outline.centre), NEAREST);
                found.into_iter().map(|k| numbers[k]).collect()
            };
            let mut found: Vec<Vec<Label>> =
                near.into_iter().filter(|&j| !taken[j]).map(|j| labels(a, b, i, j, &around[i])).collect();
            found.retain(|ways| ways.first().is_some_and(|label| label.cost < options.max_cost));
            found.sort_by(|x, y| x[0].cost.total_cmp(&y[0].cost).then(x[0].to.cmp(&y[0].to)));
            found.truncate(KEPT);
            found.concat()
        };
        let labels: Vec<Vec<Label>> = (0..a.outlines.len()).into_par_iter().map(row).collect();
        let bound = fixed.iter().map(|fixed| matches!(fixed, Fixed::To(_))).collect();
        Self { labels, bound }
    }
}

/// The ways to lay stroke `i` upon `j`, the cheapest first.
pub(super) fn labels(a: &Figure, b: &Figure, i: usize, j: usize, around: &Movement) -> Vec<Label> {
    let Some((p, q)) = a.comparable(i, b, j) else { return Vec::new() };
    let (Some(from), Some(to)) = (&a.outlines[i], &b.outlines[j]) else { return Vec::new() };
    let growth = (q.radius / p.radius).ln();
    let length = (q.length.max(1.0) / p.length.max(1.0)).ln() - growth;
    let size = growth - around.scale.ln();
    let away = around.apply(from.centre).distance(to.centre) / (a.radius * around.scale);
    let base = likeness(&a.strokes[i], &b.strokes[j])
        + LENGTH * length * length
        + SIZE * size * size
        + POSITION * away * away / (1.0 + away * away / FAR);
    let ways = p.ways(q, around.turn, TURN / SHAPE).into_iter().map(|way| {
        let turn = wrap(way.turn - around.turn);
        let cost = base + SHAPE * way.residual + TURN * turn * turn;
        Label { to: j, way, map: p.movement(q, &way), cost }
    });
    ways.collect()
}

/// What differs beside the geometry.
fn likeness(a: &Stroke, b: &Stroke) -> f64 {
    let differ = |a: Option<u32>, b: Option<u32>| a.zip(b).is_some_and(|(a, b)| a != b);
    let squares = |(a, b): ([f32; 3], [f32; 3])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum();
    let squares: f64 = a.colour.zip(b.colour).map_or(0.0, squares);
    let colour = squares / (squares + HALF_COLOUR * HALF_COLOUR);
    let flag = |there: bool, cost: f64| if there { cost } else { 0.0 };
    COLOUR * colour
        + flag(differ(a.material, b.material), MATERIAL)
        + flag(differ(a.layer, b.layer), LAYER)
        + flag(a.closed != b.closed, CLOSEDNESS)
}
