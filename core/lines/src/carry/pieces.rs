//! Pieces of traced lines, joined to the stroke that they are.
//!
//! Pieces lie along the carried stroke in some order, and have its direction. Two that follow each other are one if a pen would have gone on: over a gap as
//! short as tracing joins, or over ink, such as that of a line that passes. What is not joined is another stroke.

use super::samples::{Sample, of_line};
use crate::pairing::GAP_TURN;
use crate::strokes::Walked;
use rototoon_base::geometry::Point;

/// Longest way over ink that is none of the stroke's own line, in gaps of the pen.
const PASSED: f64 = 3.0;
/// Distance of the ends of a chain that closes a ring, as a share of its length.
const RING: f64 = 0.35;

/// The carried stroke, with places along it.
pub struct Guide {
    samples: Vec<Sample>,
    closed: bool,
    step: f64,
}

/// A piece of a traced line.
#[derive(Clone)]
pub struct Piece {
    /// The place of the line among the drawing's.
    pub line: usize,
    /// The piece itself.
    pub walked: Walked,
}

/// A piece, and where it begins and ends along the stroke, in samples. On a ring its end may be beyond the ring's.
struct Placed {
    piece: Piece,
    from: f64,
    to: f64,
}

impl Guide {
    /// Of a stroke; places are about `step` apart.
    pub fn new(points: &[Point], closed: bool, step: f64) -> Self {
        Self { samples: of_line(points, closed, step), closed, step }
    }

    /// The longest chain of pieces, and the pieces that are left. `gap` is the longest gap of a pen, and `on_ink` whether a place is on ink.
    pub fn chained(
        &self,
        pieces: Vec<Piece>,
        gap: f64,
        on_ink: &impl Fn(Point) -> bool,
    ) -> (Option<Walked>, Vec<Piece>) {
        let longest = pieces.iter().map(|piece| piece.walked.length()).fold(0.0, f64::max);
        let (mut whole, open): (Vec<Piece>, Vec<Piece>) = pieces.into_iter().partition(|piece| piece.walked.closed);
        whole.sort_by(|a, b| b.walked.length().total_cmp(&a.walked.length()));
        if whole.first().is_some_and(|ring| ring.walked.length() >= longest) {
            let ring = self.begun(whole.remove(0).walked);
            return (Some(ring), whole.into_iter().chain(open).collect());
        }
        let joins = |a: &Placed, b: &Placed| {
            self.follows(a, b, gap) && joins(&a.piece.walked.points, &b.piece.walked.points, gap, on_ink)
        };
        let mut chains = self.chains(open, &joins);
        let length = |chain: &[Placed]| chain.iter().map(|own| own.piece.walked.length()).sum::<f64>();
        let Some(best) = (0..chains.len()).rev().max_by(|&a, &b| length(&chains[a]).total_cmp(&length(&chains[b])))
        else {
            return (None, whole);
        };
        let chain = chains.remove(best);
        whole.extend(chains.into_iter().flatten().map(|own| own.piece));
        let (first, last) = (&chain[0], &chain[chain.len() - 1]);
        let ends = [&last.piece.walked.points, &first.piece.walked.points];
        let open = ends[0][ends[0].len() - 1].distance(ends[1][0]);
        let is_ring = self.closed && open <= RING * length(&chain) && joins(last, first);
        let joined = joined(chain.into_iter().map(|own| own.piece.walked).collect(), is_ring);
        (Some(if joined.closed { self.begun(joined) } else { joined }), whole)
    }

    /// Whether a piece lies behind another one.
    fn follows(&self, a: &Placed, b: &Placed, gap: f64) -> bool {
        let (n, way) = (self.samples.len() as f64, b.from - a.to);
        let way = if self.closed { (way + 0.5 * n).rem_euclid(n) - 0.5 * n } else { way };
        way * self.step >= -gap
    }

    /// Pieces in the order of the stroke, in chains that a pen would draw in one go.
    fn chains(&self, pieces: Vec<Piece>, joins: &impl Fn(&Placed, &Placed) -> bool) -> Vec<Vec<Placed>> {
        let pieces = pieces.into_iter().filter(|piece| piece.walked.points.len() > 1);
        let mut placed: Vec<Placed> = pieces.map(|piece| self.placed(piece)).collect();
        placed.sort_by(|a, b| (a.from + a.to).total_cmp(&(b.from + b.to)));
        // A ring is cut where a pen would not go on.
        if let Some(cut) = (1..placed.len()).find(|&k| self.closed && !joins(&placed[k - 1], &placed[k])) {
            placed.rotate_left(cut);
        }
        let mut chains: Vec<Vec<Placed>> = Vec::new();
        for piece in placed {
            match chains.last_mut() {
                Some(chain) if joins(&chain[chain.len() - 1], &piece) => chain.push(piece),
                _ => chains.push(vec![piece]),
            }
        }
        chains
    }

    /// A piece in the direction of the stroke.
    fn placed(&self, piece: Piece) -> Placed {
        let walked = self.directed(piece.walked);
        let [from, to] = [0, walked.points.len() - 1].map(|k| self.nearest(walked.points[k]) as f64);
        let beyond = if self.closed && to < from { self.samples.len() as f64 } else { 0.0 };
        Placed { piece: Piece { walked, ..piece }, from, to: to + beyond }
    }

    /// A line in the direction of the stroke.
    fn directed(&self, mut line: Walked) -> Walked {
        let along: f64 = line
            .points
            .windows(2)
            .step_by(3)
            .map(|pair| (pair[1] - pair[0]).dot(self.direction(self.nearest(pair[0]))))
            .sum();
        if along < 0.0 {
            line.points.reverse();
            line.radii.reverse();
            line.free.reverse();
        }
        line
    }

    fn nearest(&self, p: Point) -> usize {
        let far = |k: &usize| self.samples[*k].place.distance_squared(p);
        (0..self.samples.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
    }

    /// The direction in which the stroke goes on at a place.
    fn direction(&self, k: usize) -> Point {
        let n = self.samples.len();
        let (a, b) =
            if self.closed { ((k + n - 1) % n, (k + 1) % n) } else { (k.saturating_sub(1), (k + 1).min(n - 1)) };
        (self.samples[b].place - self.samples[a].place).normalize_or_zero()
    }

    /// A ring that begins where the stroke does and has its direction. If the stroke is open, so is the ring.
    fn begun(&self, ring: Walked) -> Walked {
        let mut ring = self.directed(ring);
        let start = self.samples[0].place;
        let far = |k: &usize| ring.points[*k].distance_squared(start);
        let first = (0..ring.points.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
        ring.points.rotate_left(first);
        ring.radii.rotate_left(first);
        if !self.closed {
            ring.points.push(ring.points[0]);
            ring.radii.push(ring.radii[0]);
            ring.closed = false;
        }
        ring
    }
}

/// Whether a pen would go on from the end of a line to the start of another one.
fn joins(a: &[Point], b: &[Point], gap: f64, on_ink: &impl Fn(Point) -> bool) -> bool {
    let (from, to) = (a[a.len() - 1], b[0]);
    let far = from.distance(to);
    let steps = (far.ceil() as usize).max(1);
    if far <= PASSED * gap && (0..=steps).all(|k| on_ink(from.lerp(to, k as f64 / steps as f64))) {
        return true;
    }
    // A direction is that of the length of the gap.
    let before = a.iter().rev().find(|p| p.distance(from) >= far).unwrap_or(&a[0]);
    let behind = b.iter().find(|p| p.distance(to) >= far).unwrap_or(&b[b.len() - 1]);
    let turn = |u: Point, v: Point| u.angle_to(v).abs();
    far <= gap && turn(from - *before, to - from).max(turn(to - from, *behind - to)) <= GAP_TURN
}

/// Pieces that follow each other, as one.
fn joined(chain: Vec<Walked>, closed: bool) -> Walked {
    let free = [chain[0].free[0], chain[chain.len() - 1].free[1]];
    let (points, radii) = chain.into_iter().map(|piece| (piece.points, piece.radii)).unzip::<_, _, Vec<_>, Vec<_>>();
    Walked { points: points.concat(), radii: radii.concat(), closed, free, fill: false }
}
