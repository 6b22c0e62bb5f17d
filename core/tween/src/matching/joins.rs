//! Lines that are in pieces: which ends of a drawing's strokes continue each other.
//!
//! Automatic tracing, and an artist who lifts the pen, cut one line into several strokes. Two ends continue each other if
//! the gap between them is short beside both strokes and each runs on towards the other. The cheapest joins are made
//! first; every end is used once. A chain of several strokes whose two ends continue each other is closed.
//!
//! Limits: at a place where many lines meet, the smoothest continuation is taken, which is not always the line that was
//! drawn. Strokes of different layers, materials, colours or pegs are never joined.

use super::super::chain::Chain;
use super::super::grid::Grid;
use super::super::stroke::Stroke;
use rototoon_base::geometry::Point;

/// Widest gap, as a share of the shorter of the two strokes.
const GAP: f64 = 0.25;
/// Gap, in pixels, that is always allowed.
const LEAST_GAP: f64 = 3.0;
/// Widest gap that closes a chain, as a share of its length.
const CLOSING: f64 = 0.08;
/// Cost of two ends that run in opposite directions, beside the cost of 1 of the widest gap.
const TURN: f64 = 1.0;
/// Number of nearest ends that are examined for each end.
const NEAR: usize = 8;
/// Length over which the direction at an end is measured, as a share of the stroke's length.
const REACH: f64 = 0.1;

/// An end of an open stroke.
#[derive(Clone, Copy)]
struct End {
    stroke: usize,
    last: bool,
    place: Point,
    /// The direction, of length 1, in which the stroke would run on.
    way: Point,
}

/// A possible join of two ends.
struct Join {
    cost: f64,
    gap: f64,
    ends: (usize, usize),
}

/// The lines of a drawing as chains of strokes. Every stroke is in exactly one chain. Only strokes that are `free` are
/// joined with others.
/// No join costs more than `most`: 1 is a gap of the widest kind, or a line that turns back.
pub(super) fn chains(strokes: &[Stroke], free: &dyn Fn(usize) -> bool, most: f64) -> Vec<Chain> {
    let lengths: Vec<f64> = strokes.iter().map(Stroke::length).collect();
    let open = |i: &usize| !strokes[*i].closed && lengths[*i] > 0.0 && free(*i);
    let ends: Vec<End> = (0..strokes.len()).filter(open).flat_map(|i| ends(strokes, i, lengths[i])).collect();
    let mut group = Groups::new(&lengths);
    let mut partner = vec![None; ends.len()];
    for join in joins(strokes, &ends, &lengths, most) {
        let (a, b) = join.ends;
        if partner[a].is_none() && partner[b].is_none() && group.may_join(ends[a].stroke, ends[b].stroke, join.gap) {
            group.join(ends[a].stroke, ends[b].stroke);
            (partner[a], partner[b]) = (Some(b), Some(a));
        }
    }
    walked(strokes, &ends, &partner)
}

fn ends(strokes: &[Stroke], stroke: usize, length: f64) -> [End; 2] {
    let points = &strokes[stroke].points;
    let end = |last: bool| {
        let at = |k: usize| if last { points[points.len() - 1 - k] } else { points[k] };
        let mut walked = 0.0;
        let mut inside = at(0);
        for k in 1..points.len() {
            walked += at(k).distance(at(k - 1));
            inside = at(k);
            if walked >= REACH * length {
                break;
            }
        }
        End { stroke, last, place: at(0), way: (at(0) - inside).normalize_or_zero() }
    };
    [end(false), end(true)]
}

/// The possible joins, the cheapest first.
fn joins(strokes: &[Stroke], ends: &[End], lengths: &[f64], most: f64) -> Vec<Join> {
    let places: Vec<Point> = ends.iter().map(|end| end.place).collect();
    let grid = Grid::new(&places);
    let mut found = Vec::new();
    for (a, end) in ends.iter().enumerate() {
        for b in grid.nearest(end.place, NEAR + 1) {
            let other = &ends[b];
            let shorter = lengths[end.stroke].min(lengths[other.stroke]);
            if b == a || end.stroke == other.stroke || !alike(&strokes[end.stroke], &strokes[other.stroke]) {
                continue;
            }
            let gap = end.place.distance(other.place);
            let widest = LEAST_GAP.max(GAP * shorter);
            // Where both ends would be, half way across the gap.
            let miss = (end.place + end.way * (0.5 * gap)).distance(other.place + other.way * (0.5 * gap));
            let turn = 0.5 * (1.0 + end.way.dot(other.way));
            let cost = 0.5 * (gap + miss) / widest + TURN * turn;
            if gap <= widest && cost <= most {
                found.push(Join { cost, gap, ends: (a.min(b), a.max(b)) });
            }
        }
    }
    found.sort_by(|x, y| x.cost.total_cmp(&y.cost).then(x.ends.cmp(&y.ends)));
    found.dedup_by_key(|join| join.ends);
    found
}

fn alike(a: &Stroke, b: &Stroke) -> bool {
    (a.layer, a.material, a.colour, a.peg) == (b.layer, b.material, b.colour, b.peg)
}

/// Which strokes are in one chain already.
struct Groups {
    parent: Vec<usize>,
    length: Vec<f64>,
}

impl Groups {
    fn new(lengths: &[f64]) -> Self {
        Self { parent: (0..lengths.len()).collect(), length: lengths.to_vec() }
    }

    fn root(&self, mut i: usize) -> usize {
        while self.parent[i] != i {
            i = self.parent[i];
        }
        i
    }

    /// Two ends of one chain may only be joined where that leaves a small gap.
    fn may_join(&self, a: usize, b: usize, gap: f64) -> bool {
        let root = self.root(a);
        root != self.root(b) || gap <= LEAST_GAP.max(CLOSING * self.length[root])
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            let (a, b) = (a.min(b), a.max(b));
            self.parent[b] = a;
            self.length[a] += self.length[b];
        }
    }
}

/// The chains that follow from the partner of each end.
fn walked(strokes: &[Stroke], ends: &[End], partner: &[Option<usize>]) -> Vec<Chain> {
    let mut of = vec![[None; 2]; strokes.len()];
    for (k, end) in ends.iter().enumerate() {
        of[end.stroke][usize::from(end.last)] = Some(k);
    }
    let across = |stroke: usize, last: bool| {
        let other = ends[partner[of[stroke][usize::from(last)]?]?];
        Some((other.stroke, other.last))
    };
    let mut seen = vec![false; strokes.len()];
    let mut chains = Vec::new();
    for start in 0..strokes.len() {
        if seen[start] {
            continue;
        }
        // Back to the beginning, or once round.
        let (mut first, mut reversed) = (start, false);
        let mut closed = false;
        while let Some((before, by_last)) = across(first, reversed) {
            (first, reversed) = (before, !by_last);
            if first == start {
                closed = true;
                break;
            }
        }
        let mut pieces = Vec::new();
        let (mut here, mut against) = (first, reversed);
        while !seen[here] {
            seen[here] = true;
            pieces.push((here, against));
            let Some((next, by_last)) = across(here, !against) else { break };
            (here, against) = (next, by_last);
        }
        chains.push(Chain { closed: closed || (pieces.len() == 1 && strokes[start].closed), pieces });
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(from: f64, to: f64, radius: f64) -> Stroke {
        let at = |k: i32| Point::from_angle((from + (to - from) * f64::from(k) / 20.0).to_radians()) * radius;
        Stroke::new((0..=20).map(at).collect(), false)
    }

    #[test]
    fn a_circle_in_pieces_is_closed_and_a_bow_stays_open() {
        let circle = [arc(0.0, 110.0, 40.0), arc(230.0, 120.0, 40.0), arc(240.0, 352.0, 40.0)];
        let found = chains(&circle, &|_| true, 1.2);
        let expected = Chain { pieces: vec![(0, false), (1, true), (2, false)], closed: true };
        assert_eq!(found, [expected]);
        let bow = [arc(80.0, 10.0, 40.0), arc(85.0, 150.0, 40.0)];
        assert_eq!(chains(&bow, &|_| true, 1.2), [Chain { pieces: vec![(1, true), (0, false)], closed: false }]);
        assert_eq!(chains(&bow, &|i| i == 0, 1.2), [Chain::single(0, false), Chain::single(1, false)]);
        // A stroke alone is not closed, and far or different strokes are not joined.
        assert_eq!(chains(&[arc(0.0, 350.0, 40.0)], &|_| true, 1.2), [Chain::single(0, false)]);
        assert_eq!(chains(&[arc(0.0, 80.0, 40.0), arc(140.0, 200.0, 40.0)], &|_| true, 1.2).len(), 2);
        let other = Stroke { layer: Some(1), ..bow[1].clone() };
        assert_eq!(chains(&[bow[0].clone(), other], &|_| true, 1.2).len(), 2);
    }

    #[test]
    fn where_lines_cross_each_runs_straight_on() {
        let bar = |a: (f64, f64), b: (f64, f64)| {
            let at = |k: i32| Point::from(a).lerp(Point::from(b), f64::from(k) / 9.0);
            Stroke::new((0..10).map(at).collect(), false)
        };
        let cross = [
            bar((0.0, 0.0), (49.0, 0.0)),
            bar((50.0, 1.0), (50.0, 60.0)),
            bar((51.0, 0.0), (99.0, 0.0)),
            bar((50.0, -60.0), (50.0, -1.0)),
        ];
        let found = chains(&cross, &|_| true, 1.2);
        let pieces: Vec<_> = found.iter().map(|chain| chain.pieces.clone()).collect();
        assert_eq!(pieces, [vec![(0, false), (2, false)], vec![(3, false), (1, false)]]);
    }
}
