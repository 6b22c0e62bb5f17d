//! The likely counterparts of each stroke, and the cost of each under the movement expected there.
//!
//! A cost adds up differences in shape, turn, size, length, place, colour, material, layer and closedness. Some parts
//! do not depend on the movement. They and the ways to lay one stroke on another are computed once and remembered while
//! the drawings are small. In large drawings only the strokes nearest to the expected place are compared.

use super::super::angle::wrap;
use super::super::grid::Grid;
use super::super::stroke::Stroke;
use super::outline::{Outline, Way, likely};
use super::similarity::Movement;
use super::{Fixed, Options, twins};
use rayon::prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon};

/// Weight of the share of the shape's variance that the best similarity does not explain.
const SHAPE: f64 = 2.0;
/// Weight of the squared turn, in rad², of a stroke relative to the drawing around it.
const TURN: f64 = 0.06;
/// Weight of the squared logarithm of a stroke's growth relative to the drawing around it.
const SIZE: f64 = 1.0;
/// Weight of the squared logarithm of the growth in length relative to the growth in size.
const LENGTH: f64 = 0.5;
/// Weight of the squared distance from the expected place, in units of the drawing's radius.
const POSITION: f64 = 2.0;
/// Squared distance, in the same units, beyond which more distance adds little cost.
const FAR: f64 = 2.0;
/// Cost of an entirely different colour.
const COLOUR: f64 = 2.0;
/// Colour difference (root of the summed squares, sRGB 0 to 1) that costs half of [`COLOUR`]. It is small because
/// drawings have few flat colours.
const HALF_COLOUR: f64 = 0.06;
/// Cost of a different material.
const MATERIAL: f64 = 0.7;
/// Cost of a different layer.
const LAYER: f64 = 2.5;
/// Cost of a pair of an open and a closed stroke.
const CLOSEDNESS: f64 = 0.4;
/// Up to this number of pairs of strokes, every pair is compared.
const ALL_PAIRS: usize = 40_000;
/// Up to this number of pairs of strokes, the ways to lay one on the other are remembered.
const REMEMBERED: usize = 4_000;
/// The same limit, counted with the empty places of strokes that are left out.
const MOST_SLOTS: usize = 1_000_000;
/// Number of counterparts compared for each stroke in larger drawings.
const NEAREST: usize = 24;
/// Number of counterparts kept for each stroke.
const KEPT: usize = 10;

/// The strokes of a drawing in the form in which they are compared.
pub(super) struct Figure<'a> {
    pub strokes: &'a [Stroke],
    /// One entry for each stroke; `None` where it has no points.
    pub outlines: Vec<Option<Outline>>,
    /// Open strokes taken as closed, for comparison with closed ones.
    rings: Vec<Option<Outline>>,
    /// Mean of the outlines' centres.
    pub middle: Point,
    /// Root mean square distance of the samples from the middle, in pixels; at least 1.
    pub radius: f64,
    /// For each stroke the first one that is the same.
    pub firsts: Vec<usize>,
}

impl<'a> Figure<'a> {
    pub fn new(strokes: &'a [Stroke]) -> Self {
        let outlines: Vec<_> = strokes.par_iter().map(|s| Outline::new(s, s.closed)).collect();
        let rings = strokes.par_iter().map(|s| if s.closed { None } else { Outline::new(s, true) }).collect();
        Self::of_outlines(strokes, outlines, rings, twins::firsts(strokes))
    }

    /// The same drawing with the named strokes only. Indices and radius stay.
    pub fn only(&self, named: &[usize]) -> Self {
        let pick = |list: &[Option<Outline>]| {
            let mut kept = vec![None; list.len()];
            named.iter().for_each(|&i| kept[i] = list[i].clone());
            kept
        };
        let firsts = self.firsts.clone();
        Self { radius: self.radius, ..Self::of_outlines(self.strokes, pick(&self.outlines), pick(&self.rings), firsts) }
    }

    fn of_outlines(
        strokes: &'a [Stroke],
        outlines: Vec<Option<Outline>>,
        rings: Vec<Option<Outline>>,
        firsts: Vec<usize>,
    ) -> Self {
        let middle = polygon::center(&outlines.iter().flatten().map(|o| o.centre).collect::<Vec<_>>());
        let mut figure = Self { strokes, outlines, rings, middle, radius: 1.0, firsts };
        figure.radius = figure.spread();
        figure
    }

    /// Root mean square distance of the strokes' samples from the middle, in pixels; at least 1.
    pub fn spread(&self) -> f64 {
        let squares =
            self.outlines.iter().flatten().map(|o| o.centre.distance_squared(self.middle) + o.radius * o.radius);
        (squares.sum::<f64>() / self.outlines.iter().flatten().count().max(1) as f64).sqrt().max(1.0)
    }

    /// The outlines of two strokes, both closed or both open, so that one can be laid on the other. `None` for strokes of different pegs.
    pub fn comparable<'b>(&'b self, i: usize, other: &'b Self, j: usize) -> Option<(&'b Outline, &'b Outline)> {
        if !self.strokes[i].may_be(&other.strokes[j]) {
            return None;
        }
        let (a, b) = (self.outlines[i].as_ref()?, other.outlines[j].as_ref()?);
        Some(match (a.closed, b.closed) {
            (true, false) => (a, other.rings[j].as_ref()?),
            (false, true) => (self.rings[i].as_ref()?, b),
            _ => (a, b),
        })
    }
}

/// The ways to lay the strokes of one drawing on those of another. They are remembered if there are few strokes,
/// otherwise computed anew each time.
pub(super) struct Ways {
    columns: usize,
    known: Vec<Option<Known>>,
}

/// The comparison of two strokes as far as it does not depend on the movement.
struct Known {
    ways: Vec<Vec<Way>>,
    unlike: Unlike,
}

impl Ways {
    pub fn new(a: &Figure, b: &Figure) -> Self {
        let (rows, columns) = (a.outlines.len(), b.outlines.len());
        let there = |figure: &Figure| figure.outlines.iter().flatten().count();
        if there(a) * there(b) > REMEMBERED || rows.saturating_mul(columns) > MOST_SLOTS {
            return Self { columns, known: Vec::new() };
        }
        let pair = |k: usize| {
            let (i, j) = (k / columns, k % columns);
            let (p, q) = a.comparable(i, b, j)?;
            Some(Known { ways: p.all_ways(q), unlike: Unlike::new(a, b, (i, j))? })
        };
        Self { columns, known: (0..rows * columns).into_par_iter().map(pair).collect() }
    }

    /// Whether the ways are remembered.
    pub fn are_known(&self) -> bool {
        !self.known.is_empty()
    }

    /// The least cost among all ways to lay stroke `i` on `j`.
    fn least(&self, a: &Figure, i: usize, b: &Figure, j: usize, cost: impl Fn(&Way) -> f64) -> f64 {
        let least = |all: &[Vec<Way>]| all.iter().flatten().map(&cost).fold(f64::INFINITY, f64::min);
        match self.known.get(i * self.columns + j) {
            Some(known) => known.as_ref().map_or(f64::INFINITY, |known| least(&known.ways)),
            None => a.comparable(i, b, j).map_or(f64::INFINITY, |(p, q)| least(&p.all_ways(q))),
        }
    }

    /// The likely ways to lay stroke `i` on `j` for an expected turn.
    pub fn likely(&self, a: &Figure, i: usize, b: &Figure, j: usize, expected: f64, stiffness: f64) -> Vec<Way> {
        if let Some(known) = self.known.get(i * self.columns + j) {
            return known.as_ref().map_or_else(Vec::new, |known| likely(&known.ways, expected, stiffness));
        }
        a.comparable(i, b, j).map_or_else(Vec::new, |(p, q)| p.ways(q, expected, stiffness))
    }

    fn unlike(&self, a: &Figure, i: usize, b: &Figure, j: usize) -> Option<Unlike> {
        match self.known.get(i * self.columns + j) {
            Some(known) => known.as_ref().map(|known| known.unlike),
            None => Unlike::new(a, b, (i, j)),
        }
    }
}

/// A possible counterpart, and a way to lay the stroke on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label {
    pub to: usize,
    pub way: Way,
    pub map: Similarity,
    pub cost: f64,
}

/// The likely counterparts of all strokes of the first drawing.
pub(super) struct Rows {
    pub labels: Vec<Vec<Label>>,
    /// Whether the stroke must take one of its labels.
    pub bound: Vec<bool>,
}

impl Rows {
    pub fn new(
        (a, b): (&Figure, &Figure),
        ways: &Ways,
        around: &[Movement],
        fixed: &[Fixed],
        options: &Options,
    ) -> Self {
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
                Fixed::To(j) => return labels((a, b), ways, (i, j), &around[i]),
                Fixed::Free => {}
            }
            let near = if all {
                numbers.clone()
            } else {
                let found = grid.nearest(around[i].apply(outline.centre), NEAREST);
                found.into_iter().map(|k| numbers[k]).collect()
            };
            let free = near.into_iter().filter(|&j| !taken[j]);
            cheapest((a, b), ways, (i, &around[i]), free, options.max_cost)
        };
        let labels: Vec<Vec<Label>> = (0..a.outlines.len()).into_par_iter().map(row).collect();
        let bound = fixed.iter().map(|fixed| matches!(fixed, Fixed::To(_))).collect();
        Self { labels, bound }
    }
}

/// The labels of the cheapest counterparts of stroke `i` among `near`.
fn cheapest(
    (a, b): (&Figure, &Figure),
    ways: &Ways,
    (i, around): (usize, &Movement),
    near: impl Iterator<Item = usize>,
    max_cost: f64,
) -> Vec<Label> {
    let expected = Expected::new(a, i, around);
    let mut near: Vec<(f64, usize)> = near
        .filter_map(|j| Some((ways.unlike(a, i, b, j)?.under(&expected), j)))
        .filter(|(base, _)| *base < max_cost)
        .collect();
    near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    // Cheapest first. `base` is a lower bound, so once it exceeds the last of the kept costs no later one can be
    // cheaper.
    let mut found: Vec<Vec<Label>> = Vec::with_capacity(KEPT + 1);
    for (base, j) in near {
        if found.len() == KEPT && base > found[KEPT - 1][0].cost {
            break;
        }
        let row = labels((a, b), ways, (i, j), around);
        let Some(first) = row.first().filter(|label| label.cost < max_cost) else { continue };
        let place = found.partition_point(|x| x[0].cost.total_cmp(&first.cost).then(x[0].to.cmp(&j)).is_lt());
        found.insert(place, row);
        found.truncate(KEPT);
    }
    found.concat()
}

/// The ways to lay stroke `i` on `j` with their costs, the most likely first.
fn labels((a, b): (&Figure, &Figure), ways: &Ways, (i, j): (usize, usize), around: &Movement) -> Vec<Label> {
    let (Some(unlike), Some((p, q))) = (ways.unlike(a, i, b, j), a.comparable(i, b, j)) else { return Vec::new() };
    let base = unlike.under(&Expected::new(a, i, around));
    let ways = ways.likely(a, i, b, j, around.turn, TURN / SHAPE).into_iter().map(|way| {
        let turn = wrap(way.turn - around.turn);
        let cost = base + SHAPE * way.residual + TURN * turn * turn;
        Label { to: j, way, map: p.movement(q, &way), cost }
    });
    ways.collect()
}

/// The difference of two strokes as far as it does not depend on the movement.
#[derive(Clone, Copy)]
struct Unlike {
    /// Cost of the differences in length, colour, material, layer and closedness.
    cost: f64,
    /// Logarithm of the growth from the first stroke to the second.
    growth: f64,
    /// Centre of the second stroke.
    centre: Point,
}

/// Where a movement takes a stroke.
struct Expected {
    centre: Point,
    /// Logarithm of the growth.
    growth: f64,
    /// The drawing's radius after the movement, in pixels.
    radius: f64,
}

impl Expected {
    fn new(a: &Figure, i: usize, around: &Movement) -> Self {
        let centre = a.outlines[i].as_ref().map_or(Point::ZERO, |outline| around.apply(outline.centre));
        Self { centre, growth: around.scale.ln(), radius: a.radius * around.scale }
    }
}

impl Unlike {
    fn new(a: &Figure, b: &Figure, (i, j): (usize, usize)) -> Option<Self> {
        let (p, q) = a.comparable(i, b, j)?;
        let growth = (q.radius / p.radius).ln();
        let length = (q.length.max(1.0) / p.length.max(1.0)).ln() - growth;
        let cost = likeness(&a.strokes[i], &b.strokes[j]) + LENGTH * length * length;
        Some(Self { cost, growth, centre: b.outlines[j].as_ref()?.centre })
    }

    /// A lower bound of the cost of this pair: everything but the fit of the shapes and the turn.
    fn under(&self, expected: &Expected) -> f64 {
        let size = self.growth - expected.growth;
        let square = expected.centre.distance_squared(self.centre) / (expected.radius * expected.radius);
        self.cost + SIZE * size * size + POSITION * square / (1.0 + square / FAR)
    }
}

/// A lower bound of the cost of all strokes under a movement: each takes its best counterpart, even if others take it
/// too.
pub(super) fn bound((a, b): (&Figure, &Figure), ways: &Ways, movement: &Movement, options: &Options) -> f64 {
    let there = |figure: &Figure| -> Vec<usize> {
        (0..figure.outlines.len()).filter(|&i| figure.outlines[i].is_some()).collect()
    };
    let columns = there(b);
    let of = |i: usize| {
        let expected = Expected::new(a, i, movement);
        let base = |&j: &usize| ways.unlike(a, i, b, j).map_or(f64::INFINITY, |unlike| unlike.under(&expected));
        let bases: Vec<f64> = columns.iter().map(base).collect();
        let whole = |k: usize| {
            let way = |way: &Way| SHAPE * way.residual + TURN * wrap(way.turn - movement.turn).powi(2);
            bases[k] + ways.least(a, i, b, columns[k], way)
        };
        // Trying the likeliest counterpart first spares the look at most of the others.
        let first = (0..bases.len()).min_by(|&x, &y| bases[x].total_cmp(&bases[y]));
        let least = first.filter(|&k| bases[k] < options.max_cost).map_or(options.max_cost, &whole);
        let least = least.min(options.max_cost);
        (0..bases.len()).fold(least, |least, k| if bases[k] < least { least.min(whole(k)) } else { least })
    };
    there(a).into_iter().map(of).sum()
}

/// Cost of the differences other than geometry.
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
