//! The flow from one drawing to another, without knowing which stroke is which.
//!
//! Tracing cuts the same lines anew on every drawing, so strokes have no counterparts, but ink has. The ink of one drawing
//! is registered to that of the other, much as Sýkora, Dingliana and Collins (*As-rigid-as-possible image registration for
//! hand-drawn cartoon animations*, NPAR 2009) register pictures: places are pushed to partners, and the movement is kept
//! locally rigid.
//!
//! 1. Places lie evenly along all lines of both drawings, each with the direction of its line.
//! 2. Each place looks for a partner near where the flow takes it: near, and in the same direction ([`partners`]). Both
//!    drawings look, so no ink is left out. A partner far away counts little.
//! 3. The flow is fitted to the partners: on a lattice of nodes, each with the similarity that fits the pairs around it best
//!    ([`field`]).
//! 4. Steps 2 and 3 are repeated, while the reach of a node falls from a large share of the drawing to a small one: at first the drawing
//!    moves as a whole, at the end limb by limb.
//!
//! It begins from several movements: none, the shift of the middles, and what surely matched strokes show. The flow by which
//! most ink meets is taken. The share of ink that meets says whether there is a flow at all.
//!
//! Limits: lines that cross in the movement, such as a near leg that passes a far one, are taken for each other. Ink that only
//! one drawing has flows with the ink around it.

mod field;
mod partners;

use crate::grid::Grid;
use crate::ink;
use crate::stroke::Stroke;
use field::Field;
use partners::{Pair, Place};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};

/// Number of rounds.
const ROUNDS: usize = 24;
/// Reach of a node in the first and in the last round, as shares of the drawing's size.
const REACH: (f64, f64) = (0.6, 0.08);
/// Distance at which a partner counts a quarter, in the first and in the last round, as shares of the drawing's size.
const TRUST: (f64, f64) = (0.12, 0.02);
/// Ink meets within this share of the drawing's size.
const MEETS: f64 = 0.01;
/// Squared sine of the angle between two lines below which they have the same direction: 45°.
const SAME: f64 = 0.5;

/// A flow, with its way back.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Flow {
    ahead: Field,
    back: Field,
    /// The share of the ink that meets, 0 to 1: the smaller one of both drawings.
    pub meets: f64,
}

impl Flow {
    /// The flow by which most ink meets. `known` are places on the first drawing with their counterparts on the second.
    /// `None` where a drawing has no ink.
    pub fn find(first: &[Stroke], second: &[Stroke], known: &[(Point, Point)]) -> Option<Self> {
        let size = ink::size(first.iter().chain(second).flat_map(|s| &s.points));
        let [a, b] = [first, second].map(|strokes| partners::places(strokes, size));
        if a.is_empty() || b.is_empty() || size <= 0.0 {
            return None;
        }
        let starts = starts(&a, &b, known, size);
        let found: Vec<Self> = starts.into_par_iter().map(|start| registered(&a, &b, &start, size)).collect();
        // Among equals the first start wins.
        found.into_iter().reduce(|best, next| if next.meets > best.meets { next } else { best })
    }

    /// Points of the first drawing where they are at a share of the way, 0 to 1.
    pub fn ahead(&self, points: &[Point], share: f64) -> Vec<Point> {
        points.iter().map(|p| self.ahead.at(*p, share)).collect()
    }

    /// Points of the second drawing where they are at a share of the way, 0 to 1.
    pub fn back(&self, points: &[Point], share: f64) -> Vec<Point> {
        points.iter().map(|p| self.back.at(*p, 1.0 - share)).collect()
    }
}

/// The movements from which the search begins.
fn starts(a: &[Place], b: &[Place], known: &[(Point, Point)], size: f64) -> Vec<Field> {
    let middle = |places: &[Place]| polygon::center(&places.iter().map(|p| p.at).collect::<Vec<_>>());
    let mut starts = vec![Field::shift(Point::ZERO), Field::shift(middle(b) - middle(a))];
    if !known.is_empty() {
        let pairs: Vec<Pair> = known.iter().map(|&(from, to)| Pair { from, to, weight: 1.0 }).collect();
        starts.push(Field::fit(&pairs, 0.5 * (REACH.0 + REACH.1) * size));
    }
    starts
}

fn registered(a: &[Place], b: &[Place], start: &Field, size: f64) -> Flow {
    let mut field = start.clone();
    let mut pairs = Vec::new();
    for round in 0..ROUNDS {
        let share = round as f64 / (ROUNDS - 1) as f64;
        let between = |(from, to): (f64, f64)| size * from * (to / from).powf(share);
        let moved: Vec<Place> = a.iter().map(|place| field.carry(place)).collect();
        pairs = partners::pairs(a, &moved, b, between(TRUST));
        field = Field::fit(&pairs, between(REACH));
    }
    let reversed: Vec<Pair> = pairs.iter().map(|p| Pair { from: p.to, to: p.from, ..*p }).collect();
    let back = Field::fit(&reversed, size * REACH.1);
    let meets = meeting(a, b, &field, size).min(meeting(b, a, &back, size));
    Flow { ahead: field, back, meets }
}

/// The share of places that the flow takes to ink of the other drawing in their direction.
fn meeting(from: &[Place], to: &[Place], field: &Field, size: f64) -> f64 {
    let points: Vec<Point> = to.iter().map(|place| place.at).collect();
    let grid = Grid::new(&points);
    let meets = |place: &&Place| {
        let moved = field.carry(place);
        let near = grid.nearest(moved.at, partners::TRIED);
        near.into_iter().any(|j| to[j].at.distance(moved.at) <= MEETS * size && to[j].turned(&moved) < SAME)
    };
    from.iter().filter(meets).count() as f64 / from.len() as f64
}

#[cfg(test)]
pub(crate) mod tests;
