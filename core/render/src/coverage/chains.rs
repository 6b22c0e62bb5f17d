//! The chains of sides that cross a row, from left to right.
//!
//! A chain is a run of sides of one polygon, each of which continues the one above it. Most corners of an outline only link
//! two sides of a chain. A chain begins and ends where the outline turns back up or down, and at level sides.

use super::edge::{Edge, Instant, ROW};
use std::cmp::Ordering;

/// More new chains than this are sorted, and not moved to their places one by one.
const MANY: usize = 8;

/// What of a chain is in a row.
#[derive(Clone, Copy, Debug)]
pub struct Chain {
    /// The first side of the chain in the row.
    pub edge: usize,
    /// The polygon of the chain.
    pub polygon: usize,
    /// Change of the polygon's winding number from left to right.
    pub winding: i32,
    /// Where the chain begins in the row, or enters it.
    pub above: f64,
    /// Where the chain ends in the row, or leaves it.
    pub below: f64,
    /// Least x in the row.
    pub low: f64,
    /// Greatest x in the row.
    pub high: f64,
    /// Whether the chain reaches from the top of the row to the bottom.
    pub whole: bool,
    /// Whether there is only one side of it in the row.
    pub single: bool,
}

impl Chain {
    /// The order from left to right. It does not depend on earlier rows.
    #[inline]
    fn order(&self, other: &Self) -> Ordering {
        if self.low < other.low {
            return Ordering::Less;
        }
        let order = self.low.total_cmp(&other.low).then(self.high.total_cmp(&other.high));
        order.then(self.edge.cmp(&other.edge))
    }

    /// Calls `each` with the sides of the chain between two heights, and the heights at which they begin and end there.
    #[inline]
    pub fn pieces(&self, edges: &[Edge], rows: (i64, i64), mut each: impl FnMut(usize, i64, i64)) {
        let mut next = Some(self.edge);
        while let Some(edge) = next
            && edges[edge].top < rows.1
        {
            each(edge, edges[edge].top.max(rows.0), edges[edge].bottom.min(rows.1));
            next = edges[edge].next();
        }
    }

    /// Measures the chain between two heights. Its first side must be between them.
    #[inline]
    fn measure(&mut self, edges: &[Edge], rows: (i64, i64)) {
        let first = &edges[self.edge];
        if first.top <= rows.0 && first.bottom >= rows.1 {
            (self.above, self.below) = (first.at(rows.0), first.at(rows.1));
            (self.low, self.high) = (self.above.min(self.below), self.above.max(self.below));
            (self.whole, self.single) = (true, true);
            return;
        }
        self.above = first.at(first.top.max(rows.0));
        (self.low, self.high) = (self.above, self.above);
        let (mut sides, mut reached) = (0, first.top);
        let sought = *self;
        sought.pieces(edges, rows, |edge, _, bottom| {
            let below = edges[edge].at(bottom);
            (self.low, self.high) = (self.low.min(below), self.high.max(below));
            (sides, reached) = (sides + 1, bottom);
            self.below = below;
        });
        (self.whole, self.single) = (first.top <= rows.0 && reached >= rows.1, sides == 1);
    }
}

/// The chains of an instant in a row.
pub struct Chains<'a> {
    instant: &'a Instant,
    /// Number of heads that have begun.
    begun: usize,
    list: Vec<Chain>,
}

impl<'a> Chains<'a> {
    /// The chains that reach below the upper border of row `top`.
    pub fn new(instant: &'a Instant, top: i64) -> Self {
        let mut chains = Self { instant, begun: 0, list: Vec::new() };
        chains.begin(top.saturating_mul(ROW));
        chains
    }

    /// Adds the chains that begin above a height.
    fn begin(&mut self, height: i64) {
        let edges = &self.instant.edges;
        while let Some(&edge) = self.instant.heads.get(self.begun).filter(|&&edge| edges[edge].top < height) {
            let (polygon, winding) = (edges[edge].polygon(), edges[edge].winding);
            let (above, below, low, high) = (0.0, 0.0, 0.0, 0.0);
            self.list.push(Chain { edge, polygon, winding, above, below, low, high, whole: false, single: false });
            self.begun += 1;
        }
    }

    /// Goes to the row between two heights, below the previous ones.
    pub fn advance(&mut self, rows: (i64, i64)) {
        let before = self.begun;
        self.begin(rows.1);
        let edges = &self.instant.edges[..];
        self.list.retain_mut(|chain| {
            while edges[chain.edge].bottom <= rows.0 {
                match edges[chain.edge].next() {
                    Some(next) => chain.edge = next,
                    None => return false,
                }
            }
            chain.measure(edges, rows);
            true
        });
        self.sort(self.begun - before > MANY);
    }

    fn sort(&mut self, many: bool) {
        if many {
            self.list.sort_unstable_by(Chain::order);
            return;
        }
        // The order hardly changes from row to row, so moving each chain to its place is fast.
        for k in 1..self.list.len() {
            let chain = self.list[k];
            let mut at = k;
            while at > 0 && chain.order(&self.list[at - 1]).is_lt() {
                self.list[at] = self.list[at - 1];
                at -= 1;
            }
            self.list[at] = chain;
        }
    }

    /// The chains of the row, ordered by least x, then by greatest x.
    pub fn list(&self) -> &[Chain] {
        &self.list
    }
}
