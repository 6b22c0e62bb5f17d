//! A section: the part of a curve that is fitted at once, between two corners or ends, or a complete smooth closed
//! curve.
//!
//! The unknowns of a section are its *nodes*: its guiding points, where the doubled guiding point of a corner counts
//! once. The control points of a piece are fixed combinations of three nodes: before, about and after. The middle
//! control point is the node about which the piece is drawn. The outer control points are α · outer + (1 − α) · about.
//! The share α is a half, because pieces end at midpoints. At the free end of an open curve α is one, because the end
//! itself replaces the midpoint.

use rototoon_base::curve::Quadratic;
use rototoon_base::geometry::Point;

/// The kind of an end of an open section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// An end of an open curve. The curve starts at the end node, which may move.
    Free,
    /// A corner, whose node is given. The first piece is a straight half leg.
    Corner,
    /// A place inside a smooth curve. The outermost two nodes are given, and the section begins at their midpoint.
    Joined,
}

/// The boundary of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ends {
    /// None: the section is closed and smooth.
    Periodic,
    /// Its two ends.
    Open(End, End),
}

/// A piece's nodes, and the shares of the outer nodes in its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub nodes: [usize; 3],
    pub shares: [f64; 2],
}

impl Slot {
    /// Weights of the three nodes in the point at `u`.
    pub fn weights(&self, u: f64) -> [f64; 3] {
        let v = 1.0 - u;
        let (first, last) = (v * v, u * u);
        let [before, after] = [self.shares[0] * first, self.shares[1] * last];
        [before, first - before + 2.0 * u * v + last - after, after]
    }
}

impl Ends {
    /// The pieces of a section of `nodes` nodes.
    pub fn slots(self, nodes: usize) -> Vec<Slot> {
        let half = [0.5; 2];
        let Ends::Open(start, end) = self else {
            return (0..nodes)
                .map(|k| Slot { nodes: [(k + nodes - 1) % nodes, k, (k + 1) % nodes], shares: half })
                .collect();
        };
        let last = nodes - 1;
        let mut slots = Vec::with_capacity(nodes);
        if start == End::Corner {
            slots.push(Slot { nodes: [0, 0, 1], shares: half });
        }
        slots.extend((1..last).map(|k| Slot { nodes: [k - 1, k, k + 1], shares: half }));
        if end == End::Corner {
            slots.push(Slot { nodes: [last - 1, last, last], shares: half });
        }
        if start == End::Free
            && let Some(slot) = slots.first_mut()
        {
            slot.shares[0] = 1.0;
        }
        if end == End::Free
            && let Some(slot) = slots.last_mut()
        {
            slot.shares[1] = 1.0;
        }
        slots
    }

    /// Whether node `k` of `nodes` is given.
    pub fn fixed(self, k: usize, nodes: usize) -> bool {
        let held = |end: End| match end {
            End::Free => 0,
            End::Corner => 1,
            End::Joined => 2,
        };
        match self {
            Self::Periodic => false,
            Self::Open(start, end) => k < held(start) || nodes - 1 - k < held(end),
        }
    }

    /// Smallest number of nodes.
    pub fn least(self) -> usize {
        match self {
            Self::Periodic => 3,
            Self::Open(End::Joined, End::Joined) => 4,
            Self::Open(End::Joined, _) | Self::Open(_, End::Joined) => 3,
            Self::Open(End::Free, End::Free) => 3,
            Self::Open(..) => 2,
        }
    }
}

/// A piece in the form used to find nearest points: B(u) = p0 + 2b u + a u².
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    pub p0: Point,
    pub a: Point,
    pub b: Point,
    /// −1 or 1 where the piece is the straight half leg of a corner at its start or end (the curve has no speed there);
    /// 0 elsewhere.
    pub rest: i8,
}

impl Arc {
    pub fn new(nodes: &[Point], slot: &Slot) -> Self {
        let q = piece(nodes, slot);
        let (a, b) = q.coefficients();
        let rest = i8::from(slot.nodes[1] == slot.nodes[2]) - i8::from(slot.nodes[0] == slot.nodes[1]);
        Self { p0: q.p0, a, b, rest }
    }

    pub fn point(&self, u: f64) -> Point {
        self.p0 + (self.b * 2.0 + self.a * u) * u
    }
}

/// The piece of a slot.
pub(super) fn piece(nodes: &[Point], slot: &Slot) -> Quadratic {
    let [before, about, after] = slot.nodes.map(|k| nodes[k]);
    Quadratic::new(about.lerp(before, slot.shares[0]), about, about.lerp(after, slot.shares[1]))
}
