//! Scans the sides of polygons row by row.
//!
//! Most rows are simple ([`super::quiet`]). The others are scanned in tiles. The work in a tile grows with the square of its number of sides and more, because each corner and each crossing cuts
//! all of them. A row with many sides is therefore divided into tiles of about the same number of sides. What is left of
//! a tile counts by its winding number only ([`super::left`]). A tile that one polygon covers as a whole needs no
//! slabs. In a picture full of polygons most tiles are such ones, so the time is nearly linear in the number of polygons.
//!
//! The tiles depend on the sides in the row, not on the window. So a pixel has the same value in any window.

use super::chains::Chains;
use super::edge::{Instant, ROW};
use super::left::Left;
use super::quiet::Quiet;
use super::slabs::{Sink, Slabs};

/// Number of sides that begin in a tile, and the most in a knot. Tiles of half or twice as many are slower where polygons overlap.
pub const TILE: usize = 16;
/// Sides this close to a tile are taken as in it, so that no pair of sides at one place is torn apart.
const MARGIN: f64 = 1e-6;

/// A side within the row.
struct Entry {
    edge: usize,
    low: f64,
    high: f64,
}

/// Scans the sides of one instant row by row.
pub struct Scan<'a> {
    instant: &'a Instant,
    /// Number of sides that begin in a tile.
    share: usize,
    chains: Chains<'a>,
    quiet: Quiet,
    entries: Vec<Entry>,
    /// Indices of the entries in the tile.
    current: Vec<usize>,
    /// Their sides.
    local: Vec<usize>,
    left: Left,
    slabs: Slabs,
}

impl<'a> Scan<'a> {
    /// A scan that begins at row `top`. `share` sides begin in a tile.
    pub fn new(instant: &'a Instant, top: i64, share: usize) -> Self {
        Self {
            instant,
            share,
            chains: Chains::new(instant, top),
            quiet: Quiet::new(instant.polygons),
            entries: Vec::new(),
            current: Vec::new(),
            local: Vec::new(),
            left: Left::new(instant.polygons),
            slabs: Slabs::new(instant.polygons),
        }
    }

    /// Scans the next row.
    pub fn row(&mut self, y: i64, sink: &mut impl Sink) {
        let edges = &self.instant.edges;
        let (top, bottom) = (y * ROW, (y + 1) * ROW);
        let rows = (top, bottom);
        self.chains.advance(rows);
        let chains = self.chains.list();
        if chains.is_empty() {
            return;
        }
        if self.quiet.find(chains, edges, rows, self.share) {
            self.quiet.draw(chains, edges, rows, (&mut self.left, &mut self.slabs), sink);
            return;
        }
        self.entries.clear();
        for chain in chains {
            chain.pieces(edges, rows, |edge, _, _| {
                let (low, high) = edges[edge].range(top, bottom);
                self.entries.push(Entry { edge, low, high });
            });
        }
        self.entries.sort_unstable_by(|a, b| a.low.total_cmp(&b.low).then(a.edge.cmp(&b.edge)));
        self.tiles(rows, sink);
    }

    fn tiles(&mut self, rows: (i64, i64), sink: &mut impl Sink) {
        let Some(first) = self.entries.first() else { return };
        let mut start = first.low.floor() as i64;
        let far = self.entries.iter().fold(first.high, |far, entry| far.max(entry.high));
        self.left.begin(rows.0, rows.1);
        self.current.clear();
        let mut begun = 0usize;
        loop {
            let next = begun.saturating_add(self.share);
            let end = self.entries.get(next).map_or(far.floor() as i64, |entry| entry.low.floor() as i64 - 1);
            let end = end.max(start).saturating_add(1);
            let until = next.min(self.entries.len());
            while begun < until || self.entries.get(begun).is_some_and(|entry| entry.low <= end as f64 + MARGIN) {
                self.current.push(begun);
                begun += 1;
            }
            self.tile(start..end, rows, sink);
            if next >= self.entries.len() {
                return;
            }
            start = end;
        }
    }

    fn tile(&mut self, columns: std::ops::Range<i64>, rows: (i64, i64), sink: &mut impl Sink) {
        let (entries, edges, left) = (&self.entries, &self.instant.edges, &mut self.left);
        let start = columns.start as f64 - MARGIN;
        self.current.retain(|&index| {
            let within = entries[index].high >= start;
            if !within {
                left.pass(&edges[entries[index].edge]);
            }
            within
        });
        if !sink.begin(columns) {
            return;
        }
        self.local.clear();
        self.local.extend(self.current.iter().map(|&index| entries[index].edge));
        self.local.sort_unstable();
        self.slabs.tile(edges, &self.local, left, rows, sink);
        sink.end();
    }
}
