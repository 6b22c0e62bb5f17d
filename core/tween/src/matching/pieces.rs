//! Strokes that were drawn in one go on one drawing and in pieces on the other.
//!
//! The search begins with a pair: a stroke and its counterpart. A stroke without counterpart is added to the
//! counterpart if one of its ends is near an end of the counterpart, and if both together resemble the stroke clearly
//! more than the counterpart alone. This repeats until nothing more can be gained. Strokes without any counterpart are
//! tried in the same way, beginning with each free piece near their expected place.
//!
//! Limits: pieces are open strokes. A free piece belongs to one stroke at most; the first stroke that uses it keeps it.

use super::super::grid::Grid;
use super::super::stroke::Stroke;
use super::outline::Outline;
use super::similarity::Movement;
use super::{Fixed, InPieces, Matching};
use rototoon_base::geometry::Point;
use std::collections::{BTreeMap, BTreeSet};

/// Widest gap between two pieces, as a share of their joint length.
const GAP: f64 = 0.25;
/// Gap, in pixels, that is always allowed.
const LEAST_GAP: f64 = 3.0;
/// A longer chain of pieces must cost this much less than the chain before.
const GAIN: f64 = 0.15;
/// A chain for a stroke without counterpart must cost less than this.
const MOST: f64 = 0.6;
/// Number of free ends examined around an end of a chain.
const NEAR: usize = 8;
/// Weight of the share of the shape's variance that the best similarity does not explain.
const SHAPE: f64 = 2.0;
/// Weight of the squared logarithm of the growth in length.
const LENGTH: f64 = 1.5;
/// Weight of the squared distance from the expected place, in units of the stroke's radius.
const POSITION: f64 = 0.2;

/// Finds strokes in pieces. It moves them from `pairs`, `vanished` and `appeared` to `split` and `joined`.
pub(super) fn find(first: &[Stroke], second: &[Stroke], around: &[Movement], fixed: &[Fixed], matching: &mut Matching) {
    let free = |i: usize| fixed[i] == Fixed::Free;
    let pairs: BTreeMap<usize, usize> = matching.pairs.iter().filter(|p| !p.by_hand).map(|p| (p.from, p.to)).collect();
    let expected = |i: usize, centre: Point| (around[i].apply(centre), around[i].scale);
    let loose: Vec<usize> = matching.vanished.iter().copied().filter(|&i| free(i)).collect();
    let search = Search { whole: first, pieces: second, expected: &expected };
    matching.split = search.run(&pairs, &loose, &matching.appeared);
    let split: BTreeSet<usize> = matching.split.iter().map(|s| s.whole).collect();
    let used: BTreeSet<usize> = matching.split.iter().flat_map(|s| s.pieces.iter().map(|p| p.0)).collect();
    matching.pairs.retain(|p| !split.contains(&p.from));
    matching.vanished.retain(|i| !split.contains(i));
    matching.appeared.retain(|j| !used.contains(j));

    let back: BTreeMap<usize, usize> = matching.pairs.iter().filter(|p| !p.by_hand).map(|p| (p.to, p.from)).collect();
    let undone = |j: usize, centre: Point| {
        let Some(movement) = back.get(&j).map(|&i| around[i]) else { return (centre, 1.0) };
        let turned = Point::from_angle(-movement.turn).rotate(centre - movement.target) / movement.scale;
        (turned + movement.source, 1.0 / movement.scale)
    };
    let loose: Vec<usize> = matching.vanished.iter().copied().filter(|&i| free(i)).collect();
    let search = Search { whole: second, pieces: first, expected: &undone };
    matching.joined = search.run(&back, &matching.appeared, &loose);
    let joined: BTreeSet<usize> = matching.joined.iter().map(|s| s.whole).collect();
    let used: BTreeSet<usize> = matching.joined.iter().flat_map(|s| s.pieces.iter().map(|p| p.0)).collect();
    matching.pairs.retain(|p| !joined.contains(&p.to));
    matching.appeared.retain(|j| !joined.contains(j));
    matching.vanished.retain(|i| !used.contains(i));
}

struct Search<'a, E: Fn(usize, Point) -> (Point, f64)> {
    whole: &'a [Stroke],
    pieces: &'a [Stroke],
    /// Maps a stroke's index and centre to the centre expected on the other drawing, in pixels, and the expected
    /// growth.
    expected: &'a E,
}

/// Pieces put together end to end.
#[derive(Clone)]
struct Chain {
    pieces: Vec<(usize, bool)>,
    points: Vec<Point>,
    cost: f64,
}

impl<E: Fn(usize, Point) -> (Point, f64)> Search<'_, E> {
    /// Finds the strokes in pieces. `pairs` maps a stroke to its counterpart; the strokes in `loose` and the pieces in
    /// `free` have none.
    fn run(&self, pairs: &BTreeMap<usize, usize>, loose: &[usize], free: &[usize]) -> Vec<InPieces> {
        let open = |&&j: &&usize| !self.pieces[j].closed && self.pieces[j].length() > 0.0;
        let free: Vec<usize> = free.iter().filter(open).copied().collect();
        let ends: Vec<Point> = free.iter().flat_map(|&j| ends(&self.pieces[j].points)).collect();
        let grid = Grid::new(&ends);
        let mut taken = BTreeSet::new();
        let mut result = Vec::new();
        if free.is_empty() {
            return result;
        }
        let starts = pairs.iter().filter(|&(_, j)| open(&j)).map(|(&i, &j)| (i, vec![j]));
        let of_loose = loose.iter().map(|&i| {
            let centre = Outline::new(&self.whole[i], self.whole[i].closed).map_or(Point::ZERO, |o| o.centre);
            let near = grid.nearest((self.expected)(i, centre).0, 2 * NEAR);
            (i, near.into_iter().map(|e| free[e / 2]).collect())
        });
        for (i, seeds) in starts.chain(of_loose) {
            let paired = pairs.contains_key(&i);
            let grown = seeds.into_iter().filter(|j| !taken.contains(j)).filter_map(|j| {
                let points = Some(&self.pieces[j]).filter(|own| self.whole[i].may_be(own))?.points.clone();
                let alone = Chain { cost: self.cost(i, &points)?, pieces: vec![(j, false)], points };
                self.grown(i, alone, &grid, &free, &taken)
            });
            let best = grown.reduce(|best, next| if next.cost < best.cost { next } else { best });
            if let Some(chain) = best.filter(|chain| chain.pieces.len() > 1 && (paired || chain.cost < MOST)) {
                taken.extend(chain.pieces.iter().map(|p| p.0));
                result.push(InPieces { whole: i, pieces: self.along(i, chain) });
            }
        }
        result.sort_by_key(|found| found.whole);
        result
    }

    /// Adds free pieces to a chain as long as each addition makes it resemble stroke `i` more.
    fn grown(&self, i: usize, mut chain: Chain, grid: &Grid, free: &[usize], taken: &BTreeSet<usize>) -> Option<Chain> {
        loop {
            let mut best: Option<Chain> = None;
            for (at_end, place) in ends(&chain.points).into_iter().enumerate() {
                for end in grid.nearest(place, NEAR) {
                    let piece = free[end / 2];
                    if taken.contains(&piece) || chain.pieces.iter().any(|p| p.0 == piece) {
                        continue;
                    }
                    let Some(next) = self.joined(i, &chain, at_end == 1, piece, end % 2 == 1) else { continue };
                    let target = best.as_ref().map_or(chain.cost - GAIN, |b| b.cost);
                    if next.cost < target {
                        best = Some(next);
                    }
                }
            }
            match best {
                Some(next) => chain = next,
                None => return Some(chain),
            }
        }
    }

    /// The chain with one more piece, added behind or before it. `by_last` says that the piece's last point meets the
    /// chain.
    fn joined(&self, i: usize, chain: &Chain, behind: bool, piece: usize, by_last: bool) -> Option<Chain> {
        if !self.whole[i].may_be(&self.pieces[piece]) {
            return None;
        }
        let added = &self.pieces[piece].points;
        // Behind the chain a piece runs away from the end that meets it. Before the chain it runs towards that end.
        let reversed = behind == by_last;
        let walked: Vec<Point> = if reversed { added.iter().rev().copied().collect() } else { added.clone() };
        let (points, gap) = if behind {
            (chain.points.iter().chain(&walked).copied().collect::<Vec<_>>(), chain.points.last()?.distance(walked[0]))
        } else {
            (walked.iter().chain(&chain.points).copied().collect(), chain.points[0].distance(*walked.last()?))
        };
        let length = rototoon_base::geometry::polyline::length(&points, false);
        if gap > LEAST_GAP.max(GAP * length) {
            return None;
        }
        let mut pieces = chain.pieces.clone();
        pieces.insert(if behind { pieces.len() } else { 0 }, (piece, reversed));
        Some(Chain { cost: self.cost(i, &points)?, pieces, points })
    }

    /// How much a line of points differs from stroke `i`, without unit.
    fn cost(&self, i: usize, points: &[Point]) -> Option<f64> {
        let closed = self.whole[i].closed;
        let (whole, line) =
            (Outline::new(&self.whole[i], closed)?, Outline::new(&Stroke::new(points.into(), closed), closed)?);
        let (place, growth) = (self.expected)(i, whole.centre);
        let away = place.distance(line.centre) / (whole.radius * growth);
        let length = (line.length.max(1.0) / (whole.length.max(1.0) * growth)).ln();
        let way = whole.ways(&line, 0.0, 0.0).into_iter().next()?;
        Some(SHAPE * way.residual + LENGTH * length * length + POSITION * (away * away).min(4.0))
    }

    /// The pieces of a chain in the order and direction of stroke `i`.
    fn along(&self, i: usize, chain: Chain) -> Vec<(usize, bool)> {
        let closed = self.whole[i].closed;
        let outlines =
            (Outline::new(&self.whole[i], closed), Outline::new(&Stroke::new(chain.points.clone(), closed), closed));
        let (Some(whole), Some(line)) = outlines else { return chain.pieces };
        let reversed = whole.ways(&line, 0.0, 0.1).first().is_some_and(|way| way.reversed);
        if reversed { chain.pieces.into_iter().rev().map(|(j, r)| (j, !r)).collect() } else { chain.pieces }
    }
}

fn ends(points: &[Point]) -> [Point; 2] {
    [points[0], points[points.len() - 1]]
}
