//! Rows in which most chains of sides keep apart.
//!
//! Chains that keep their order from the top of a row to its bottom need no slabs. A walk from left to right that counts
//! winding numbers finds those that bound the union. This holds for most chains of most rows of a drawing.
//!
//! The others are in knots: chains that cross, begin or end in the row, together with all whose ranges of x touch theirs.
//! Nothing crosses the gaps between knots. There the winding number of a polygon is the same in the whole row, so the slabs of
//! a knot ([`super::slabs`]) start from it. A level side has no height and is in no chain, but it can bridge a gap. Then the
//! heights of the sides in a knot do not balance. Such a row is left to the tiles ([`super::scan`]), and so is a row with
//! many sides in a knot.

use super::chains::Chain;
use super::edge::{Edge, ROW};
use super::left::Left;
use super::slabs::{NEAR, Side, Sink, Slabs};
use std::ops::Range;

/// Chains this close belong to one knot.
const GAP: f64 = 1e-6;

/// Chains of a row that are united in slabs.
struct Knot {
    chains: Range<usize>,
    /// What the knot changes, as a range of `Quiet::changes`.
    changes: Range<usize>,
}

/// Buffers for a row.
pub struct Quiet {
    knots: Vec<Knot>,
    /// Polygons of the knots, and by how much their winding numbers differ right of the knot.
    changes: Vec<(usize, i32)>,
    /// For each polygon the sum of winding number times height over its sides in a knot.
    heights: Vec<i64>,
    /// For each polygon its winding number at the place of the walk.
    winding: Vec<i32>,
    /// The sides of a knot.
    local: Vec<usize>,
}

impl Quiet {
    /// For a number of polygons.
    pub fn new(polygons: usize) -> Self {
        Self {
            knots: Vec::new(),
            changes: Vec::new(),
            heights: vec![0; polygons],
            winding: vec![0; polygons],
            local: Vec::new(),
        }
    }

    /// Finds the knots of a row. Returns false if one has more than `most` sides, or is no knot of its own.
    pub fn find(&mut self, chains: &[Chain], edges: &[Edge], rows: (i64, i64), most: usize) -> bool {
        self.knots.clear();
        self.changes.clear();
        let mut next = 0;
        while let Some(first) = chains.get(next) {
            let start = next;
            let (mut reach, mut quiet) = (first.high, first.whole);
            next += 1;
            while let Some(chain) = chains.get(next).filter(|chain| chain.low <= reach + GAP) {
                let before = &chains[next - 1];
                quiet &= chain.whole && before.single && chain.single;
                quiet &= before.above <= chain.above + NEAR && before.below <= chain.below + NEAR;
                reach = reach.max(chain.high);
                next += 1;
            }
            if !quiet && !self.tie(&chains[start..next], start, edges, rows, most) {
                return false;
            }
        }
        true
    }

    /// Notes a knot. Returns false if it is none.
    fn tie(&mut self, chains: &[Chain], start: usize, edges: &[Edge], rows: (i64, i64), most: usize) -> bool {
        let from = self.changes.len();
        let mut count = 0;
        for chain in chains {
            self.changes.push((chain.polygon, 0));
            chain.pieces(edges, rows, |_, top, bottom| {
                self.heights[chain.polygon] += i64::from(chain.winding) * (bottom - top);
                count += 1;
            });
        }
        let own = &mut self.changes[from..];
        own.sort_unstable();
        let mut kept = 0;
        for k in 0..own.len() {
            if k == 0 || own[k].0 != own[kept - 1].0 {
                own[kept] = own[k];
                kept += 1;
            }
        }
        self.changes.truncate(from + kept);
        let mut whole = true;
        for (polygon, change) in &mut self.changes[from..] {
            let height = std::mem::take(&mut self.heights[*polygon]);
            whole &= height % ROW == 0;
            *change = (height / ROW) as i32;
        }
        self.knots.push(Knot { chains: start..start + chains.len(), changes: from..self.changes.len() });
        whole && count <= most
    }

    /// Passes the union in the row whose knots were found to a sink, as one tile.
    pub fn draw(
        &mut self,
        chains: &[Chain],
        edges: &[Edge],
        rows: (i64, i64),
        (left, slabs): (&mut Left, &mut Slabs),
        sink: &mut impl Sink,
    ) {
        if !sink.begin(i64::MIN..i64::MAX) {
            return;
        }
        let knots = std::mem::take(&mut self.knots);
        let (mut inside, mut done) = (0, 0);
        for knot in &knots {
            self.walk(&chains[done..knot.chains.start], edges, rows, &mut inside, sink);
            let changes = &self.changes[knot.changes.clone()];
            let covering = changes.iter().filter(|(polygon, _)| self.winding[*polygon] != 0);
            // Another polygon that covers the gap before the knot covers the knot too.
            if inside == covering.clone().count() {
                left.begin(rows.0, rows.1);
                covering.for_each(|&(polygon, _)| left.cover(polygon, self.winding[polygon]));
                self.local.clear();
                for chain in &chains[knot.chains.clone()] {
                    chain.pieces(edges, rows, |edge, _, _| self.local.push(edge));
                }
                self.local.sort_unstable();
                slabs.tile(edges, &self.local, left, rows, &mut Within(sink));
            }
            for &(polygon, change) in changes {
                let before = self.winding[polygon];
                self.winding[polygon] += change;
                inside = inside + usize::from(before + change != 0) - usize::from(before != 0);
            }
            done = knot.chains.end;
        }
        self.walk(&chains[done..], edges, rows, &mut inside, sink);
        sink.end();
        self.knots = knots;
    }

    /// Passes the chains that bound the union to a sink. Where one interval of the union ends and the next one begins at the
    /// same place, it stays one.
    fn walk(&mut self, chains: &[Chain], edges: &[Edge], rows: (i64, i64), inside: &mut usize, sink: &mut impl Sink) {
        let mut ended: Option<&Chain> = None;
        for chain in chains {
            let winding = &mut self.winding[chain.polygon];
            let before = *winding;
            *winding += chain.winding;
            if before == 0 {
                if *inside == 0 {
                    match ended.take() {
                        Some(last) if chain.above - last.above <= NEAR && chain.below - last.below <= NEAR => {}
                        Some(last) => {
                            pass(last, edges, rows, false, sink);
                            pass(chain, edges, rows, true, sink);
                        }
                        None => pass(chain, edges, rows, true, sink),
                    }
                }
                *inside += 1;
            } else if *winding == 0 {
                *inside -= 1;
                if *inside == 0 {
                    ended = Some(chain);
                }
            }
        }
        if let Some(last) = ended {
            pass(last, edges, rows, false, sink);
        }
    }
}

/// Passes the sides of a chain to a sink.
#[inline]
fn pass(chain: &Chain, edges: &[Edge], rows: (i64, i64), enters: bool, sink: &mut impl Sink) {
    if chain.single {
        let side = Side { edge: chain.edge, above: chain.above, below: chain.below };
        sink.side(&side, rows.0, rows.1, enters);
        return;
    }
    chain.pieces(edges, rows, |edge, top, bottom| {
        let side = Side { edge, above: edges[edge].at(top), below: edges[edge].at(bottom) };
        sink.side(&side, top, bottom, enters);
    });
}

/// A knot in a row that is one tile: what covers its left border has been passed before.
struct Within<'a, S>(&'a mut S);

impl<S: Sink> Sink for Within<'_, S> {
    fn begin(&mut self, _columns: Range<i64>) -> bool {
        true
    }

    fn inside(&mut self, _top: i64, _bottom: i64) {}

    fn side(&mut self, side: &Side, top: i64, bottom: i64, enters: bool) {
        self.0.side(side, top, bottom, enters);
    }

    fn end(&mut self) {}
}
