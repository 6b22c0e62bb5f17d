//! The exact areas of a pixel that several regions divide among themselves, with their opacities.
//!
//! The borders of the regions cut the pixel into cells. The pixel is cut at the heights of all corners in it, of all
//! crossings of borders, and where a border enters or leaves the pixel at its left or right. In a slab between two heights the
//! borders keep their order, so a cell is a trapezoid between two neighbours. Its area is its height times its width in the
//! middle of the slab. From the front to the back, a region that contains the cell takes its opacity's share of what the
//! regions before it leave (Porter & Duff, *over*). The shares of a region over all cells are what it shows in the pixel.
//!
//! A region is the union of its areas minus the union of its holes. The winding number of each polygon counts by itself
//! and is not zero inside, as in [`super::coverage`].
//!
//! The time grows with the square of the number of borders in the pixel. So only pixels in which the borders of several
//! regions meet are divided like this.

use super::coverage::Window;
use rototoon_base::geometry::{Point, polyline};

/// Borders closer than this are not cut at their crossing, in pixels.
const NEAR: f64 = 1e-9;

/// A piece of a polygon's side in one row of pixels.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Index of the polygon among those of its region.
    polygon: usize,
    /// The upper end; y from 0 at the top of the row.
    top: Point,
    /// The lower end; y up to 1.
    bottom: Point,
    /// 1 for a side that goes down, −1 for one that goes up.
    winding: i32,
}

/// The pieces of a polygon in a row, as a range, and the columns that they reach.
#[derive(Clone, Copy, Debug)]
struct Run {
    from: usize,
    to: usize,
    low: f64,
    high: f64,
}

/// The borders of a region in the rows of a band.
#[derive(Clone, Debug)]
pub(super) struct Borders {
    top: i64,
    pieces: Vec<Vec<Piece>>,
    runs: Vec<Vec<Run>>,
    /// Number of polygons that are areas; the others are holes.
    areas: usize,
    polygons: usize,
}

impl Borders {
    /// The borders of some areas and holes within the rows of a band. Polygons with a coordinate that is not finite are left out.
    pub fn new(areas: &[Vec<Point>], holes: &[Vec<Point>], band: Window) -> Self {
        let rows = band.height();
        let mut borders = Self {
            top: band.top,
            pieces: vec![Vec::new(); rows],
            runs: vec![Vec::new(); rows],
            areas: areas.len(),
            polygons: areas.len() + holes.len(),
        };
        for (polygon, points) in areas.iter().chain(holes).enumerate() {
            if Window::around(points).and_then(|own| own.common(band)).is_some() {
                borders.add(polygon, points);
            }
        }
        borders
    }

    fn add(&mut self, polygon: usize, points: &[Point]) {
        let before: Vec<usize> = self.pieces.iter().map(Vec::len).collect();
        for (a, b) in polyline::segments(points, true).filter(|(a, b)| a.y != b.y) {
            let (top, bottom, winding) = if a.y < b.y { (a, b, 1) } else { (b, a, -1) };
            let first = (top.y.floor() as i64).saturating_sub(self.top).clamp(0, self.pieces.len() as i64) as usize;
            let last = (bottom.y.ceil() as i64).saturating_sub(self.top).clamp(0, self.pieces.len() as i64) as usize;
            for row in first..last {
                let y = (self.top + row as i64) as f64;
                let at = |height: f64| {
                    let share = ((y + height - top.y) / (bottom.y - top.y)).clamp(0.0, 1.0);
                    Point::new(top.x + share * (bottom.x - top.x), height)
                };
                let (from, to) = ((top.y - y).max(0.0), (bottom.y - y).min(1.0));
                if from < to {
                    self.pieces[row].push(Piece { polygon, top: at(from), bottom: at(to), winding });
                }
            }
        }
        for (row, from) in before.into_iter().enumerate() {
            let own = &self.pieces[row][from..];
            let (low, high) = own.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), piece| {
                (low.min(piece.top.x).min(piece.bottom.x), high.max(piece.top.x).max(piece.bottom.x))
            });
            if !own.is_empty() {
                self.runs[row].push(Run { from, to: self.pieces[row].len(), low, high });
            }
        }
    }
}

/// A region in a pixel.
pub(super) enum Layer<'a> {
    /// It covers the whole pixel.
    Whole,
    /// It covers some of it.
    Partly(&'a Borders),
}

/// A border in the pixel. The pixel is the square from 0 to 1.
#[derive(Clone, Copy)]
struct Border {
    layer: usize,
    /// Index among the polygons of all layers.
    polygon: usize,
    hole: bool,
    top: Point,
    bottom: Point,
    winding: i32,
}

impl Border {
    fn at(&self, y: f64) -> f64 {
        let share = (y - self.top.y) / (self.bottom.y - self.top.y);
        self.top.x + share * (self.bottom.x - self.top.x)
    }
}

/// What each layer shows in pixel (`x`, `y`), from 0 to 1. Layers come with their opacity, the nearest first.
pub(super) fn shown(layers: &[(Layer, f32)], x: i64, y: i64) -> Vec<f64> {
    let (borders, polygons) = borders(layers, x, y);
    let mut cuts = cuts(&borders);
    cuts.sort_unstable_by(f64::total_cmp);
    cuts.dedup();
    let mut sweep = Sweep::new(layers, polygons);
    let mut order: Vec<(f64, usize)> = Vec::new();
    for pair in cuts.windows(2) {
        let middle = 0.5 * (pair[0] + pair[1]);
        order.clear();
        let there = borders.iter().enumerate().filter(|(_, own)| own.top.y < middle && middle < own.bottom.y);
        order.extend(there.map(|(k, own)| (own.at(middle).clamp(0.0, 1.0), k)));
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        sweep.slab(&borders, &order, pair[1] - pair[0]);
    }
    sweep.shown
}

/// The borders that matter in a pixel, and the number of polygons of all layers.
fn borders(layers: &[(Layer, f32)], x: i64, y: i64) -> (Vec<Border>, usize) {
    let (mut found, mut first) = (Vec::new(), 0);
    let left = x as f64;
    for (layer, (own, _)) in layers.iter().enumerate() {
        let Layer::Partly(own) = own else { continue };
        let row = (y - own.top) as usize;
        // What a closed polygon has beside the pixel alone changes nothing in it.
        for run in own.runs[row].iter().filter(|run| run.low < left + 1.0 && left < run.high) {
            let pieces = own.pieces[row][run.from..run.to].iter();
            for piece in pieces.filter(|piece| piece.top.x.min(piece.bottom.x) < left + 1.0) {
                let place = |p: Point| Point::new(p.x - left, p.y);
                found.push(Border {
                    layer,
                    polygon: first + piece.polygon,
                    hole: piece.polygon >= own.areas,
                    top: place(piece.top),
                    bottom: place(piece.bottom),
                    winding: piece.winding,
                });
            }
        }
        first += own.polygons;
    }
    (found, first)
}

/// The heights at which the order of the borders may change.
fn cuts(borders: &[Border]) -> Vec<f64> {
    let mut cuts = vec![0.0, 1.0];
    for own in borders {
        cuts.extend([own.top.y, own.bottom.y]);
        for side in [0.0, 1.0] {
            let (above, below) = (own.top.x - side, own.bottom.x - side);
            if above * below < 0.0 {
                cuts.push(own.top.y + (own.bottom.y - own.top.y) * above / (above - below));
            }
        }
    }
    let inside: Vec<&Border> = borders.iter().filter(|own| own.top.x.max(own.bottom.x) > 0.0).collect();
    for (k, a) in inside.iter().enumerate() {
        for b in &inside[k + 1..] {
            let (top, bottom) = (a.top.y.max(b.top.y), a.bottom.y.min(b.bottom.y));
            if top >= bottom {
                continue;
            }
            let (above, below) = (a.at(top) - b.at(top), a.at(bottom) - b.at(bottom));
            if above * below < 0.0 && above.abs() > NEAR && below.abs() > NEAR {
                cuts.push(top + (bottom - top) * above / (above - below));
            }
        }
    }
    cuts
}

/// Goes through the cells of a pixel from the left to the right.
struct Sweep {
    /// For each layer its opacity.
    opacities: Vec<f64>,
    /// For each layer whether it covers the whole pixel.
    whole: Vec<bool>,
    /// For each polygon its winding number.
    winding: Vec<i32>,
    /// For each layer the number of its areas and of its holes that contain the cell.
    inside: Vec<[i32; 2]>,
    shown: Vec<f64>,
}

impl Sweep {
    fn new(layers: &[(Layer, f32)], polygons: usize) -> Self {
        Self {
            opacities: layers.iter().map(|(_, opacity)| f64::from(*opacity)).collect(),
            whole: layers.iter().map(|(layer, _)| matches!(layer, Layer::Whole)).collect(),
            winding: vec![0; polygons],
            inside: vec![[0; 2]; layers.len()],
            shown: vec![0.0; layers.len()],
        }
    }

    fn slab(&mut self, borders: &[Border], order: &[(f64, usize)], height: f64) {
        self.winding.fill(0);
        self.inside.fill([0; 2]);
        let mut from = 0.0;
        for &(x, k) in order {
            self.cell(height * (x - from));
            from = x;
            let own = &borders[k];
            let winding = &mut self.winding[own.polygon];
            let before = i32::from(*winding != 0);
            *winding += own.winding;
            self.inside[own.layer][usize::from(own.hole)] += i32::from(*winding != 0) - before;
        }
        self.cell(height * (1.0 - from));
    }

    fn cell(&mut self, area: f64) {
        let mut left = area;
        for (k, shown) in self.shown.iter_mut().enumerate() {
            if left <= 0.0 {
                return;
            }
            let [areas, holes] = self.inside[k];
            if self.whole[k] || areas > 0 && holes == 0 {
                let own = self.opacities[k] * left;
                *shown += own;
                left -= own;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BAND: Window = Window { left: 0, top: 0, right: 4, bottom: 4 };

    fn box_of(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
        [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point::new(x, y)).into()
    }

    /// Areas, holes and opacity of a region.
    type Region = (Vec<Vec<Point>>, Vec<Vec<Point>>, f32);

    fn found(regions: &[Region], x: i64, y: i64) -> Vec<f64> {
        let borders: Vec<Borders> = regions.iter().map(|(a, h, _)| Borders::new(a, h, BAND)).collect();
        let layers: Vec<_> = borders.iter().zip(regions).map(|(b, r)| (Layer::Partly(b), r.2)).collect();
        shown(&layers, x, y)
    }

    #[track_caller]
    fn near(found: &[f64], expected: &[f64]) {
        let same = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(same, "{found:?}, expected {expected:?}");
    }

    #[test]
    fn what_lies_behind_shows_where_nothing_hides_it() {
        let left = |opacity| (vec![box_of(0.0, 0.0, 1.5, 4.0)], vec![], opacity);
        let upper = |opacity| (vec![box_of(0.0, 0.0, 4.0, 1.25)], vec![], opacity);
        near(&found(&[left(1.0), left(1.0)], 1, 1), &[0.5, 0.0]);
        near(&found(&[left(1.0), upper(1.0)], 1, 1), &[0.5, 0.125]);
        near(&found(&[left(0.5), upper(1.0)], 1, 1), &[0.25, 0.125 + 0.0625]);
        near(&found(&[left(0.5), upper(0.5)], 1, 1), &[0.25, 0.0625 + 0.03125]);
        let borders = Borders::new(&left(1.0).0, &[], BAND);
        near(&shown(&[(Layer::Partly(&borders), 1.0), (Layer::Whole, 0.5)], 1, 1), &[0.5, 0.25]);
    }

    #[test]
    fn holes_show_what_is_behind_whatever_way_they_turn() {
        let behind = || (vec![box_of(1.0, 1.0, 1.75, 2.0)], vec![], 1.0);
        let mut hole = box_of(1.5, 1.0, 2.0, 2.0);
        for _ in 0..2 {
            hole.reverse();
            // Areas that overlap are one, and a hole beyond them takes nothing.
            let areas = vec![box_of(0.0, 0.0, 4.0, 4.0), box_of(0.5, 0.0, 3.0, 4.0)];
            let front = (areas, vec![hole.clone(), box_of(5.0, 5.0, 9.0, 9.0)], 1.0);
            near(&found(&[front, behind()], 1, 1), &[0.5, 0.25]);
        }
        let not_finite = vec![Point::new(f64::NAN, 0.0), Point::new(2.0, 0.0), Point::new(2.0, 2.0)];
        near(&found(&[(vec![not_finite], vec![], 1.0), behind()], 1, 1), &[0.0, 0.75]);
    }

    proptest! {
        #[test]
        fn the_shares_are_those_of_many_samples(
            corners in prop::collection::vec(prop::array::uniform8(-1.0f64..5.0), 2..6),
            opacities in prop::array::uniform6(0.1f32..1.0),
        ) {
            let regions: Vec<_> = corners.iter().zip(opacities).map(|(c, opacity)| {
                let points: Vec<Point> = c.chunks(2).map(|p| Point::new(p[0], p[1])).collect();
                (vec![points], vec![], opacity)
            }).collect();
            let found = found(&regions, 1, 2);
            let mut sampled = vec![0.0; regions.len()];
            const N: usize = 100;
            for k in 0..N * N {
                let at = |k: usize| (k as f64 + 0.5) / N as f64;
                let q = Point::new(1.0 + at(k % N), 2.0 + at(k / N));
                let mut left = 1.0 / (N * N) as f64;
                for ((areas, _, opacity), sum) in regions.iter().zip(&mut sampled) {
                    let turns = polyline::segments(&areas[0], true).map(|(a, b)| {
                        let side = (b - a).perp_dot(q - a);
                        i32::from(a.y <= q.y && b.y > q.y && side > 0.0)
                            - i32::from(a.y > q.y && b.y <= q.y && side < 0.0)
                    });
                    if turns.sum::<i32>() != 0 {
                        *sum += left * f64::from(*opacity);
                        left *= 1.0 - f64::from(*opacity);
                    }
                }
            }
            for (found, sampled) in found.iter().zip(&sampled) {
                prop_assert!((found - sampled).abs() < 0.03, "{found} {sampled}");
            }
        }
    }
}
