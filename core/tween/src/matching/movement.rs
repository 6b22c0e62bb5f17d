//! The movement of the complete drawing, and the movement around each stroke.
//!
//! Movements are similarities: shift, turn and scale. Proposals for the complete drawing are rest, turns in steps of
//! 15° about the middle, and the similarities between single pairs of strokes that resemble each other. A lower bound
//! of the matching cost ranks the proposals. The best of them are tried by matching the strokes. A small preference for
//! drawings that turned and shifted little decides between equals.
//!
//! The movement around a stroke is a weighted least-squares similarity of the strokes matched near it. The movement of
//! the complete drawing enters as one more observation, so that few neighbours do not distort it.

use super::super::grid::Grid;
use super::costs::{Figure, Rows, Ways, bound};
use super::relaxation::{self, Chosen, Neighbours};
use super::similarity::Movement;
use super::{Fixed, Options};
use rayon::prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;

/// Step in radians of the proposed turns of the complete drawing.
const TURN_STEP: f64 = std::f64::consts::PI / 12.0;
/// Number of strokes on which movements are tried in a large drawing: the largest ones.
const TRIED_ON: usize = 48;
/// Up to this number of strokes, movements are tried on all of them: the comparisons of their pairs are remembered
/// anyway.
const FEW: usize = 63;
/// Largest number of movements proposed by pairs of strokes.
const MOST_PROPOSALS: usize = 120;
/// A pair proposes a movement if the unexplained share of its shape is below this.
const PROPOSING: f64 = 0.15;
/// Number of movements that are tried by matching the strokes.
const FINALISTS: usize = 6;
/// Two movements count as one if they differ by less than this in turn (rad), in the logarithm of the scale, and in
/// place (in units of the drawing's radius).
const SAME: f64 = 1e-3;
/// Cost for each stroke and rad² of the drawing's turn: drawings that turned little are preferred.
const STILLNESS: f64 = 0.02;
/// Cost for each stroke and squared shift, in units of the drawing's radius.
const RESTING: f64 = 0.02;
/// Distance, in units of the drawing's radius, at which a neighbour has half the weight of one at distance zero.
const NEIGHBOURHOOD: f64 = 0.4;
/// Largest number of neighbours from which the movement around a stroke is fitted.
const NEIGHBOURS: usize = 24;

/// The movement of the whole drawing, and what matching under it found.
pub(super) struct Whole {
    pub movement: Movement,
    /// The counterparts under that movement, then those under the movements around each stroke that follow from them.
    /// `None` where the movement was tried on some strokes only.
    pub found: Option<[Vec<Option<Chosen>>; 2]>,
    /// What matching found under the other movements that were tried.
    pub others: Vec<Other>,
}

/// Another assignment of the strokes, and by how much it costs more than the one that is taken.
pub(super) struct Other {
    pub more: f64,
    pub to: Vec<Option<usize>>,
}

/// Finds the movement of the complete drawing.
pub(super) fn of_whole(a: &Figure, b: &Figure, ways: &Ways, fixed: &[Fixed], options: &Options) -> Whole {
    let pinned = fixed.iter().enumerate().filter_map(|(i, f)| if let Fixed::To(j) = f { Some((i, *j)) } else { None });
    let (rows, columns): (Vec<usize>, Vec<usize>) = pinned.unzip();
    let there = |figure: &Figure| figure.outlines.iter().flatten().count();
    let all = there(a).max(there(b)) <= FEW;
    let (a, b) = (a.only(&largest(a, &rows)), b.only(&largest(b, &columns)));
    // The strokes keep their indices, so the remembered ways stay valid.
    let own = (!ways.are_known()).then(|| Ways::new(&a, &b));
    let ways = own.as_ref().unwrap_or(ways);
    let scored = |movement: Movement| (bound((&a, &b), ways, &movement, options) + prior(&a, &movement), movement);
    let mut scores: Vec<_> = proposals(&a, &b, ways, options).into_par_iter().map(scored).collect();
    scores.sort_by(|x, y| x.0.total_cmp(&y.0));
    scores.truncate(FINALISTS);
    let neighbours = Neighbours::new(&a);
    let energy = |movement: &Movement| {
        let rows = Rows::new((&a, &b), ways, &vec![*movement; a.outlines.len()], fixed, options);
        let first = relaxation::relaxed(&neighbours, &b, &rows, options);
        let around = around_each(&a, &b, &first.chosen, movement);
        let rows = Rows::new((&a, &b), ways, &around, fixed, options);
        let second = relaxation::relaxed(&neighbours, &b, &rows, options);
        (second.energy + prior(&a, movement), [first.chosen, second.chosen])
    };
    let to = |chosen: &[Option<Chosen>]| chosen.iter().map(|c| c.as_ref().map(|c| c.to)).collect::<Vec<_>>();
    let mut tried: Vec<Other> = Vec::new();
    let mut best: Option<(f64, Whole)> = None;
    for (score, movement) in scores {
        // The score is a lower bound of the energy. This movement and all later ones cannot be better.
        if best.as_ref().is_some_and(|(least, _)| score >= *least) {
            break;
        }
        let (energy, found) = energy(&movement);
        tried.push(Other { more: energy, to: to(&found[1]) });
        if best.as_ref().is_none_or(|(least, _)| energy < *least) {
            best = Some((energy, Whole { movement, found: all.then_some(found), others: Vec::new() }));
        }
    }
    let still = Movement { turn: 0.0, scale: 1.0, source: Point::ZERO, target: Point::ZERO };
    let Some((least, mut whole)) = best else {
        return Whole { movement: still, found: None, others: Vec::new() };
    };
    tried.iter_mut().for_each(|other| other.more -= least);
    whole.others = tried;
    whole
}

/// Whether two movements take the drawing to about the same place.
fn alike(a: &Figure, one: &Movement, other: &Movement) -> bool {
    let apart = one.apply(a.middle).distance(other.apply(a.middle));
    crate::angle::wrap(one.turn - other.turn).abs() < SAME
        && (one.scale / other.scale).ln().abs() < SAME
        && apart < SAME * a.radius * one.scale.max(other.scale)
}

fn prior(a: &Figure, movement: &Movement) -> f64 {
    let count = a.outlines.iter().flatten().count() as f64;
    let shift = movement.apply(a.middle).distance(a.middle) / a.radius;
    count * (STILLNESS * movement.turn * movement.turn + RESTING * shift.min(2.0).powi(2))
}

/// The strokes on which movements are tried: the named ones and the largest.
fn largest(figure: &Figure, named: &[usize]) -> Vec<usize> {
    let radius = |i: usize| figure.outlines[i].as_ref().map_or(0.0, |o| o.radius);
    let mut order: Vec<usize> = (0..figure.outlines.len()).filter(|&i| figure.outlines[i].is_some()).collect();
    order.sort_by(|&i, &j| radius(j).total_cmp(&radius(i)).then(i.cmp(&j)));
    if order.len() > FEW {
        order.truncate(TRIED_ON);
    }
    order.extend(named);
    order.sort_unstable();
    order.dedup();
    order
}

/// Movements that the drawing may have made.
fn proposals(a: &Figure, b: &Figure, ways: &Ways, options: &Options) -> Vec<Movement> {
    let most = options.max_scale.max(1.0);
    let scale = (b.spread() / a.spread()).clamp(1.0 / most, most);
    let steps = (options.max_turn / TURN_STEP).clamp(0.0, 12.0) as i32;
    let mut result = vec![Movement { turn: 0.0, scale: 1.0, source: a.middle, target: a.middle }];
    for k in -steps..=steps {
        result.push(Movement { turn: f64::from(k) * TURN_STEP, scale, source: a.middle, target: b.middle });
    }
    let mut by_pairs = Vec::new();
    for i in 0..a.outlines.len() {
        for j in 0..b.outlines.len() {
            let (Some((p, q)), Some(from), Some(to)) = (a.comparable(i, b, j), &a.outlines[i], &b.outlines[j]) else {
                continue;
            };
            let scale = q.radius / p.radius;
            if scale.max(1.0 / scale) > most {
                continue;
            }
            let Some(way) =
                ways.likely(a, i, b, j, 0.0, 0.1).into_iter().find(|way| way.turn.abs() <= options.max_turn)
            else {
                continue;
            };
            if way.residual < PROPOSING {
                let movement = Movement { turn: way.turn, scale, source: from.centre, target: to.centre };
                by_pairs.push((way.residual + 0.1 * way.turn * way.turn, movement));
            }
        }
    }
    by_pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    for (_, movement) in by_pairs.into_iter().take(MOST_PROPOSALS) {
        if !result.iter().any(|other| alike(a, &movement, other)) {
            result.push(movement);
        }
    }
    result
}

/// The movement around each stroke, fitted to its matched neighbours and held by the movement `held` of the complete
/// drawing.
pub(super) fn around_each(a: &Figure, b: &Figure, chosen: &[Option<Chosen>], held: &Movement) -> Vec<Movement> {
    held_by(a, b, chosen, held, a.radius)
}

/// The same, where `held` counts as a pair at distance `far` from the centre.
pub(super) fn held_by(a: &Figure, b: &Figure, chosen: &[Option<Chosen>], held: &Movement, far: f64) -> Vec<Movement> {
    let mut known = Vec::new();
    for (outline, choice) in a.outlines.iter().zip(chosen) {
        if let (Some(from), Some(choice)) = (outline, choice)
            && let Some(to) = &b.outlines[choice.to]
        {
            known.push((from.centre, to.centre));
        }
    }
    let places: Vec<Point> = known.iter().map(|k| k.0).collect();
    let grid = Grid::new(&places);
    let near = (NEIGHBOURHOOD * a.radius).powi(2);
    let fitted = |outline: &Option<crate::matching::outline::Outline>| {
        let Some(own) = outline else { return *held };
        let neighbours = grid.nearest(own.centre, NEIGHBOURS + 1).into_iter().map(|k| known[k]);
        let pairs: Vec<_> = neighbours
            .filter(|(p, _)| *p != own.centre)
            .map(|(p, q)| (near / (own.centre.distance_squared(p) + near), p, q))
            .collect();
        fit(&pairs, held, far)
    };
    a.outlines.par_iter().map(fitted).collect()
}

/// Fits a movement to weighted pairs of places. `held` counts as one pair at distance `radius` from the centre.
fn fit(pairs: &[(f64, Point, Point)], held: &Movement, radius: f64) -> Movement {
    if pairs.len() < 2 {
        return *held;
    }
    let total: f64 = pairs.iter().map(|p| p.0).sum();
    let source = pairs.iter().map(|p| p.0 * p.1).sum::<Point>() / total;
    let target = pairs.iter().map(|p| p.0 * p.2).sum::<Point>() / total;
    let mut denominator = radius * radius;
    let mut numerator = Point::from_angle(held.turn) * (held.scale * denominator);
    for &(weight, p, q) in pairs {
        let (p, q) = (p - source, q - target);
        numerator += weight * Point::new(p.dot(q), p.perp_dot(q));
        denominator += weight * p.length_squared();
    }
    let factor = numerator / denominator;
    Movement {
        turn: factor.to_angle(),
        scale: factor.length().clamp(0.3 * held.scale, 3.0 * held.scale),
        source,
        target,
    }
}
