//! The union of polygons in one tile of a row, slab by slab.
//!
//! The tile is cut at the heights of all corners in it, and of all crossings of sides. Within a slab the sides keep
//! their order from left to right.

use super::edge::Edge;
use super::left::Left;
use std::ops::Range;

/// Sides closer than this are not cut at their crossing. It is far less than the smallest step of a pixel.
pub const NEAR: f64 = 1e-9;

/// A side within a slab.
#[derive(Clone, Copy)]
pub struct Side {
    /// Index among the instant's sides.
    pub edge: usize,
    /// Its x at the top of the slab.
    pub above: f64,
    /// Its x at the bottom of the slab.
    pub below: f64,
}

/// Receives the border of the union, tile by tile from left to right.
pub trait Sink {
    /// A tile begins with a range of columns. Returns whether the sink wants it.
    fn begin(&mut self, columns: Range<i64>) -> bool;
    /// The union contains the left border of the tile from height `top` to height `bottom`.
    fn inside(&mut self, top: i64, bottom: i64);
    /// The union begins (`enters`) or ends at a side, from height `top` to height `bottom`. Only what is within the
    /// columns of the tile is the border of the union.
    fn side(&mut self, side: &Side, top: i64, bottom: i64, enters: bool);
    /// The tile ends.
    fn end(&mut self);
}

/// Buffers for one tile.
pub struct Slabs {
    cuts: Vec<i64>,
    crossings: Vec<i64>,
    sides: Vec<Side>,
    /// Polygons that have a border in the tile.
    polygons: Vec<usize>,
    /// For each polygon its winding number at the place of the scan.
    winding: Vec<i32>,
    /// For each polygon whether it is in `polygons`.
    listed: Vec<bool>,
}

impl Slabs {
    /// For a number of polygons.
    pub fn new(polygons: usize) -> Self {
        Self {
            cuts: Vec::new(),
            crossings: Vec::new(),
            sides: Vec::new(),
            polygons: Vec::new(),
            winding: vec![0; polygons],
            listed: vec![false; polygons],
        }
    }

    /// Passes the union in a tile between two heights to a sink. `local` are all sides in the tile, in the order of
    /// their indices. `left` are the winding numbers at the left border, without these sides.
    pub fn tile(&mut self, edges: &[Edge], local: &[usize], left: &Left, rows: (i64, i64), sink: &mut impl Sink) {
        for &edge in local {
            self.list(edges[edge].polygon());
        }
        let own = self.polygons.iter().filter(|&&polygon| left.is_full(polygon)).count();
        if left.full() > own {
            sink.inside(rows.0, rows.1);
        } else {
            left.partly().for_each(|polygon| self.list(polygon));
            self.cut(edges, local, left, rows);
            for k in 1..self.cuts.len() {
                let (top, bottom) = (self.cuts[k - 1], self.cuts[k]);
                self.slab(edges, local, left, (top, bottom), sink);
            }
        }
        for polygon in self.polygons.drain(..) {
            self.listed[polygon] = false;
        }
    }

    fn list(&mut self, polygon: usize) {
        if !self.listed[polygon] {
            self.listed[polygon] = true;
            self.polygons.push(polygon);
        }
    }

    /// Collects the heights at which a side begins or ends.
    fn cut(&mut self, edges: &[Edge], local: &[usize], left: &Left, (top, bottom): (i64, i64)) {
        self.cuts.clear();
        self.cuts.extend([top, bottom]);
        let ends = local.iter().flat_map(|&edge| [edges[edge].top, edges[edge].bottom]);
        let steps = self.polygons.iter().flat_map(|&polygon| left.steps(polygon)).map(|step| step.0);
        self.cuts.extend(ends.chain(steps).filter(|height| (top + 1..bottom).contains(height)));
        self.cuts.sort_unstable();
        self.cuts.dedup();
    }

    /// Unites the polygons in a slab in which no side begins or ends.
    fn slab(&mut self, edges: &[Edge], local: &[usize], left: &Left, rows: (i64, i64), sink: &mut impl Sink) {
        self.sides_of(edges, local, rows);
        if !self.crossed() {
            self.unite(edges, left, rows, sink);
            return;
        }
        self.cross(rows);
        for k in 1..self.crossings.len() {
            let rows = (self.crossings[k - 1], self.crossings[k]);
            self.sides_of(edges, local, rows);
            self.unite(edges, left, rows, sink);
        }
    }

    /// Collects the sides of a slab, in the order of x at the middle of the slab.
    fn sides_of(&mut self, edges: &[Edge], local: &[usize], (top, bottom): (i64, i64)) {
        self.sides.clear();
        let inside = local.iter().filter(|&&edge| edges[edge].top <= top && bottom <= edges[edge].bottom);
        self.sides.extend(inside.map(|&edge| Side { edge, above: edges[edge].at(top), below: edges[edge].at(bottom) }));
        self.sides.sort_unstable_by(|a, b| (a.above + a.below).total_cmp(&(b.above + b.below)));
    }

    fn crossed(&self) -> bool {
        let apart = |pair: &[Side]| pair[0].above > pair[1].above + NEAR || pair[0].below > pair[1].below + NEAR;
        self.sides.windows(2).any(apart)
    }

    /// Collects the heights of all crossings in a slab, and its ends.
    fn cross(&mut self, (top, bottom): (i64, i64)) {
        self.crossings.clear();
        self.crossings.extend([top, bottom]);
        for (i, a) in self.sides.iter().enumerate() {
            for b in &self.sides[i + 1..] {
                let (above, below) = (a.above - b.above, a.below - b.below);
                if above * below < 0.0 && above.abs() > NEAR && below.abs() > NEAR {
                    let height = top + ((bottom - top) as f64 * above / (above - below)).round() as i64;
                    self.crossings.push(height);
                }
            }
        }
        self.crossings.sort_unstable();
        self.crossings.dedup();
    }

    /// Passes the union of a slab without crossings to a sink. Where one interval of the union ends and the next one
    /// begins at the same place, it stays one: polygons that touch have no seam.
    fn unite(&mut self, edges: &[Edge], left: &Left, (top, bottom): (i64, i64), sink: &mut impl Sink) {
        let mut inside = 0;
        for &polygon in &self.polygons {
            let above = left.steps(polygon).iter().take_while(|step| step.0 <= top);
            self.winding[polygon] = above.map(|step| step.1).sum();
            inside += usize::from(self.winding[polygon] != 0);
        }
        if inside > 0 {
            sink.inside(top, bottom);
        }
        let mut ended: Option<Side> = None;
        for side in &self.sides {
            let edge = &edges[side.edge];
            let winding = &mut self.winding[edge.polygon()];
            let before = *winding;
            *winding += edge.winding;
            if before == 0 {
                if inside == 0 {
                    match ended.take() {
                        Some(last) if side.above - last.above <= NEAR && side.below - last.below <= NEAR => {}
                        Some(last) => {
                            sink.side(&last, top, bottom, false);
                            sink.side(side, top, bottom, true);
                        }
                        None => sink.side(side, top, bottom, true),
                    }
                }
                inside += 1;
            } else if *winding == 0 {
                inside -= 1;
                if inside == 0 {
                    ended = Some(*side);
                }
            }
        }
        if let Some(last) = ended {
            sink.side(&last, top, bottom, false);
        }
    }
}
