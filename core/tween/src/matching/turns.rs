//! The turn of strokes whose shape does not show it.
//!
//! An ellipse looks the same after half a turn, and so does a straight line. The places of its neighbours can mislead:
//! the feet of a walker change places above their shadow, as if all of it turned by half a turn. The shadow would stand
//! upright half way. So such a stroke turns as its neighbours themselves turn. It keeps the way that was found unless
//! another one, which fits its shape as well, agrees with them much better.

use super::super::grid::Grid;
use super::costs::{Figure, Ways};
use super::outline::Way;
use super::relaxation::Chosen;
use crate::angle::wrap;
use rototoon_base::geometry::Point;

/// Share of the variance of the shape by which two ways may differ and still fit equally well.
const AS_WELL: f64 = 0.02;
/// A way is replaced if the other one's disagreement with the neighbours is below this share of its own.
const MUCH_BETTER: f64 = 0.5;
/// Least mean disagreement in rad² at which a way is doubted: that of a quarter turn.
const DOUBTED: f64 = std::f64::consts::FRAC_PI_2 * std::f64::consts::FRAC_PI_2;
/// Distance, in units of the drawing's radius, at which a neighbour has half the weight of one at distance zero.
const NEIGHBOURHOOD: f64 = 0.4;
/// Largest number of neighbours that are asked.
const NEIGHBOURS: usize = 8;
/// Weight in the choice among ways of a squared turn, in rad², against the unexplained share of the shape.
const STIFFNESS: f64 = 0.03;

/// A stroke, and its neighbours with their weights, as indices in the list of matched strokes.
struct Asked {
    stroke: usize,
    neighbours: Vec<(usize, f64)>,
}

/// Replaces ways that turn a stroke against its neighbours where its shape allows another one. The stroke that agrees
/// least comes first, so that it does not lead its neighbours astray.
pub(super) fn settle((a, b): (&Figure, &Figure), ways: &Ways, found: &mut [Option<Chosen>]) {
    let known: Vec<(usize, Point)> = found
        .iter()
        .enumerate()
        .filter_map(|(i, choice)| choice.as_ref().and(a.outlines[i].as_ref()).map(|outline| (i, outline.centre)))
        .collect();
    let mut turns: Vec<f64> = known.iter().map(|&(i, _)| found[i].as_ref().map_or(0.0, |c| c.way.turn)).collect();
    let asked = asked(&known, (NEIGHBOURHOOD * a.radius).powi(2));
    let votes = |k: usize, turns: &[f64]| -> Vec<(f64, f64)> {
        asked[k].neighbours.iter().map(|&(n, weight)| (weight, turns[n])).collect()
    };
    let doubts: Vec<f64> = (0..known.len()).map(|k| against(turns[k], &votes(k, &turns))).collect();
    let mut order: Vec<usize> = (0..known.len()).filter(|&k| doubts[k] > DOUBTED).collect();
    order.sort_by(|&x, &y| doubts[y].total_cmp(&doubts[x]).then(x.cmp(&y)));
    for k in order {
        let i = asked[k].stroke;
        if let Some(choice) = &mut found[i]
            && let Some(way) = other_way((a, b), ways, (i, choice), &votes(k, &turns))
        {
            (choice.way, turns[k]) = (way, way.turn);
        }
    }
}

/// The neighbours of matched strokes with these centres. At the squared distance `near` a weight is a half.
fn asked(known: &[(usize, Point)], near: f64) -> Vec<Asked> {
    let places: Vec<Point> = known.iter().map(|k| k.1).collect();
    let grid = Grid::new(&places);
    let of = |(own, &(stroke, centre)): (usize, &(usize, Point))| {
        let others = grid.nearest(centre, NEIGHBOURS + 1).into_iter().filter(|&k| k != own);
        let weight = |k: usize| near / (centre.distance_squared(places[k]) + near);
        Asked { stroke, neighbours: others.map(|k| (k, weight(k))).collect() }
    };
    known.iter().enumerate().map(of).collect()
}

/// The mean disagreement of a turn with votes, weights and turns, in rad²; not a number where there are none.
fn against(turn: f64, votes: &[(f64, f64)]) -> f64 {
    let total: f64 = votes.iter().map(|vote| vote.0).sum();
    votes.iter().map(|vote| vote.0 * wrap(turn - vote.1).powi(2)).sum::<f64>() / total
}

/// A way that fits as well and agrees much better with the votes: weights and turns.
fn other_way(
    (a, b): (&Figure, &Figure),
    ways: &Ways,
    (i, choice): (usize, &Chosen),
    votes: &[(f64, f64)],
) -> Option<Way> {
    let own = against(choice.way.turn, votes);
    if own <= DOUBTED {
        return None;
    }
    let mean: Point = votes.iter().map(|vote| vote.0 * Point::from_angle(vote.1)).sum();
    let likely = ways.likely(a, i, b, choice.to, mean.to_angle(), STIFFNESS);
    likely
        .into_iter()
        .filter(|way| way.residual <= choice.way.residual + AS_WELL && against(way.turn, votes) < MUCH_BETTER * own)
        .min_by(|x, y| against(x.turn, votes).total_cmp(&against(y.turn, votes)))
}
