//! One Gauss–Newton step of a section's nodes towards its points.
//!
//! A point p with the foot B(t) and the unit normal n has the residual n · (B(t) − p): its distance, with the parameter
//! eliminated. This is the tangent distance of Blake & Isard 1998. Wang, Pottmann & Liu 2006 show that it is
//! Gauss–Newton on the true squared distance, while moving point and foot in turn converges only linearly. Moving the
//! curve along itself changes no distance to first order. A small weight on that direction keeps the equations regular.
//! A weight of one gives the plain point-to-point problem, with which a fit starts.
//!
//! **Largest error instead of mean error.** No point may be farther off than the tolerance. A least-squares fit leaves
//! a largest error of two to three times the mean. The later steps therefore minimise Σ ε r² + (|r| − θ)₊² with θ a
//! little below the tolerance. This is a piecewise quadratic penalty on the excess alone. Gauss–Newton applies
//! unchanged. The minimum has no excess if the section can be fitted at all.
//!
//! A point depends on three neighbouring nodes, so the normal equations are banded. The nodes of a closed section are
//! numbered alternately from both sides of the start, which keeps the band narrow.

use super::feet;
use super::section::{Arc, Ends, Slot};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::banded::BandMatrix;

/// The weighting of the residuals.
#[derive(Clone, Copy, Debug)]
pub(super) enum Goal {
    /// Least squares, with this weight of the direction along the curve.
    Squares(f64),
    /// No excess over this threshold, in pixels.
    Within(f64),
}

/// Weight of the direction along the curve, relative to the normal, in steps on the excess.
const SLIDE: f64 = 0.01;
/// Weight of errors without excess.
const INSIDE: f64 = 0.005;
/// Errors below this share of the threshold are well inside. Of these points one in [`KEPT`] is used.
const QUIET: f64 = 0.6;
const KEPT: usize = 4;
/// Share of each diagonal element that is added to it.
const DAMPING: f64 = 1e-5;

/// The points of a section with their parameters.
#[derive(Clone, Debug)]
pub(super) struct Track<'a> {
    pub points: &'a [Point],
    pub parameters: Vec<f64>,
}

/// The errors that a pass over the points found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Errors {
    pub largest: f64,
    /// Index of the point with the largest error.
    pub at: usize,
    pub squares: f64,
}

/// The arcs of the section's pieces.
pub(super) fn arcs(nodes: &[Point], slots: &[Slot]) -> Vec<Arc> {
    slots.iter().map(|slot| Arc::new(nodes, slot)).collect()
}

/// The normal equations under construction, reused from step to step.
pub(super) struct Step<'a> {
    ends: Ends,
    slots: &'a [Slot],
    nodes: usize,
    /// Whether each node is fixed.
    fixed: Vec<bool>,
    matrix: BandMatrix,
    rhs: Vec<f64>,
    /// For each point the distance last measured, and how far the nodes had travelled at that time.
    distances: Vec<(f64, f64)>,
    /// Sum over the steps of the largest move of a node.
    travelled: f64,
}

/// The position of node `k` in the equations.
fn place(ends: Ends, k: usize, nodes: usize) -> usize {
    match ends {
        Ends::Open(..) => k,
        Ends::Periodic if k < nodes.div_ceil(2) => 2 * k,
        Ends::Periodic => 2 * (nodes - 1 - k) + 1,
    }
}

/// The sums of one piece: 3 × 3 blocks of xx, xy and yy, of which the lower ones are gathered, and three right-hand
/// sides.
#[derive(Default)]
struct Block {
    matrix: [[[f64; 3]; 3]; 3],
    rhs: [Point; 3],
    used: bool,
}

impl<'a> Step<'a> {
    pub fn new(ends: Ends, slots: &'a [Slot], nodes: usize, points: usize) -> Self {
        let half = if ends == Ends::Periodic { 11 } else { 5 };
        let matrix = BandMatrix::zeros(2 * nodes, half.min(2 * nodes - 1));
        let fixed = (0..nodes).map(|k| ends.fixed(k, nodes)).collect();
        Self {
            ends,
            slots,
            nodes,
            fixed,
            matrix,
            rhs: vec![0.0; 2 * nodes],
            distances: vec![(f64::INFINITY, 0.0); points],
            travelled: 0.0,
        }
    }

    /// Fixes all nodes except those of the pieces for which `free` is true.
    pub fn hold_but(&mut self, free: impl Fn(usize) -> bool) {
        let mut held = vec![true; self.nodes];
        for (i, slot) in self.slots.iter().enumerate() {
            held[slot.nodes[1]] &= !free(i);
        }
        self.fixed.iter_mut().zip(held).for_each(|(fixed, held)| *fixed |= held);
    }

    /// Number of pieces.
    pub fn pieces(&self) -> usize {
        self.slots.len()
    }

    /// The distance of point `j` at the last pass that included it.
    pub fn distance(&self, j: usize) -> f64 {
        self.distances[j].0
    }

    /// Whether point `j` is certainly within the limit. A place of the curve moves at most as far as the nodes from
    /// which it is blended, so at most as far as the nodes have travelled since the point's last measurement.
    pub fn is_sure(&self, j: usize, limit: f64) -> bool {
        let (distance, travelled) = self.distances[j];
        distance + (self.travelled - travelled) <= limit
    }

    /// Follows the feet, measures the distances and gathers the equations, for the points `chosen` (rising indices).
    pub fn gather(
        &mut self,
        nodes: &[Point],
        track: &mut Track,
        goal: Goal,
        follow: bool,
        chosen: impl Iterator<Item = usize>,
    ) -> Errors {
        self.matrix.clear();
        self.rhs.fill(0.0);
        let arcs = arcs(nodes, self.slots);
        let (periodic, pieces) = (self.ends == Ends::Periodic, arcs.len());
        let held = self.held_ends(track.points.len());
        let mut errors = Errors::default();
        let mut block = Block::default();
        let mut current = 0;
        for j in chosen {
            let (p, t) = (track.points[j], &mut track.parameters[j]);
            let end = held[0] == Some(j) || held[1] == Some(j);
            if end {
                *t = if j == 0 { 0.0 } else { pieces as f64 };
            } else if follow {
                *t = feet::follow(&arcs, periodic, p, *t);
            }
            let i = (*t as usize).min(pieces - 1);
            if i != current {
                self.scatter(&mut block, current);
                current = i;
            }
            let u = *t - i as f64;
            let error = arcs[i].point(u) - p;
            let distance = error.length();
            self.distances[j] = (distance, self.travelled);
            errors.note(distance, j);
            let Some((along, across, pull)) = weights(goal, distance, end, j) else { continue };
            let half_speed = arcs[i].b + arcs[i].a * u;
            block.add(&self.slots[i].weights(u), error, half_speed, (along, across), pull);
        }
        self.scatter(&mut block, current);
        errors
    }

    /// Indices of the points at free ends.
    fn held_ends(&self, points: usize) -> [Option<usize>; 2] {
        use super::section::End::Free;
        match self.ends {
            Ends::Periodic => [None; 2],
            Ends::Open(start, end) => [(start == Free).then_some(0), (end == Free).then_some(points - 1)],
        }
    }

    fn scatter(&mut self, block: &mut Block, piece: usize) {
        if !block.used {
            return;
        }
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            block.matrix[a][b] = block.matrix[b][a];
        }
        let places = self.slots[piece].nodes.map(|k| 2 * place(self.ends, k, self.nodes));
        let fixed = self.slots[piece].nodes.map(|k| self.fixed[k]);
        for a in 0..3 {
            if fixed[a] {
                continue;
            }
            let pa = places[a];
            self.rhs[pa] += block.rhs[a].x;
            self.rhs[pa + 1] += block.rhs[a].y;
            for b in 0..3 {
                let pb = places[b];
                if fixed[b] || pb > pa {
                    continue;
                }
                let [xx, xy, yy] = block.matrix[a][b];
                self.matrix.add(pa, pb, xx);
                self.matrix.add(pa + 1, pb, xy);
                self.matrix.add(pa + 1, pb + 1, yy);
                if pa != pb {
                    self.matrix.add(pa, pb + 1, xy);
                }
            }
        }
        *block = Block::default();
    }

    /// The step of each node; `None` where the equations have no solution.
    pub fn solve(&mut self) -> Option<Vec<Point>> {
        let total: f64 = (0..2 * self.nodes).map(|k| self.matrix.get(k, k)).sum();
        let mean = (total / (2 * self.nodes) as f64).max(f64::MIN_POSITIVE);
        for k in 0..self.nodes {
            let at = 2 * place(self.ends, k, self.nodes);
            for row in [at, at + 1] {
                let diagonal = self.matrix.get(row, row);
                let extra = if self.fixed[k] { mean } else { DAMPING * (diagonal + mean) };
                self.matrix.add(row, row, extra);
            }
        }
        let factor = self.matrix.clone().factor().ok()?;
        factor.solve_in_place(&mut self.rhs);
        let step = |k: usize| {
            let at = 2 * place(self.ends, k, self.nodes);
            Point::new(self.rhs[at], self.rhs[at + 1])
        };
        let steps: Vec<_> = (0..self.nodes).map(step).collect();
        self.travelled += steps.iter().map(|by| by.length()).fold(0.0, f64::max);
        steps.iter().all(|s| s.is_finite()).then_some(steps)
    }
}

/// Weight along the curve, weight across it, and the share of the error that pulls. `None` leaves point `j` out.
fn weights(goal: Goal, distance: f64, end: bool, j: usize) -> Option<(f64, f64, f64)> {
    Some(match goal {
        Goal::Squares(_) if end => (1.0, 1.0, 1.0),
        Goal::Squares(slide) => (slide, 1.0, 1.0),
        // Points well inside only keep the equations regular; a part of them is enough.
        Goal::Within(threshold) if distance < QUIET * threshold && !j.is_multiple_of(KEPT) && !end => return None,
        Goal::Within(threshold) => {
            let over = distance > threshold;
            let weight = if over { INSIDE + 1.0 } else { INSIDE };
            let pull = if over { (weight - threshold / distance) / weight } else { 1.0 };
            (if end { weight } else { SLIDE * weight }, weight, pull)
        }
    })
}

impl Errors {
    fn note(&mut self, distance: f64, j: usize) {
        self.squares += distance * distance;
        if distance > self.largest {
            (self.largest, self.at) = (distance, j);
        }
    }
}

impl Block {
    fn add(&mut self, weights: &[f64; 3], error: Point, tangent: Point, (along, across): (f64, f64), pull: f64) {
        // Where the curve has no speed it has no tangent. All directions count there.
        let squared = tangent.length_squared();
        let extra = if squared > f64::MIN_POSITIVE { (along - across) / squared } else { 0.0 };
        let (xx, xy, yy) = (
            across + extra * tangent.x * tangent.x,
            extra * tangent.x * tangent.y,
            across + extra * tangent.y * tangent.y,
        );
        let force = Point::new(xx * error.x + xy * error.y, xy * error.x + yy * error.y) * pull;
        for a in 0..3 {
            self.rhs[a] -= force * weights[a];
            for b in 0..=a {
                let w = weights[a] * weights[b];
                let [x, y, z] = &mut self.matrix[a][b];
                *x += w * xx;
                *y += w * xy;
                *z += w * yy;
            }
        }
        self.used = true;
    }
}
