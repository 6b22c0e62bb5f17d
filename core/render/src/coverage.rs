//! Exact area coverage of unions of polygons.
//!
//! Each pixel row is cut into slabs at the heights of all polygon corners in it and of all crossings of sides. Within a
//! slab the sides therefore keep their order from left to right. In a slab the interior of each polygon is a set of
//! intervals between two sides. The non-zero winding rule applies, so a contour that folds over itself has no hole. The
//! intervals of all polygons are united. A side that bounds the union adds the area to its right within each pixel, in
//! closed form. The coverage is exact for sides of any slope. Polygons that touch leave no seam, because intervals are
//! united and not opacities.
//!
//! Heights are integer multiples of 2⁻²⁴ of a row, and areas are integer sums. The inside is exactly 1, the outside
//! exactly 0, and the value of a pixel does not depend on the requested window. Areas of several instants add up in the
//! same sums, so motion blur by samples needs no more passes over the pixels.
//!
//! The sums are stored as differences between neighbouring pixels of a row, as in the accumulation buffer of Levien's
//! font-rs.
//!
//! Limits: at most [`MOST_INSTANTS`] instants; a picture's coordinates times 2²⁴ must fit 64-bit integers.

use rototoon_base::geometry::{Point, polyline};

/// Steps in a row: the unit of heights and of the area of a pixel.
pub(super) const ROW: i64 = 1 << 24;
/// Greatest number of instants; their areas are summed in 32 bits.
pub const MOST_INSTANTS: usize = 64;
/// Sides closer than this are not cut at their crossing. It is far less than the smallest step of a pixel.
const NEAR: f64 = 1e-9;

/// A rectangle of pixels. `right` and `bottom` are excluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub left: i64,
    /// First row.
    pub top: i64,
    /// Column after the last.
    pub right: i64,
    /// Row after the last.
    pub bottom: i64,
}

impl Window {
    /// Pixels in a row.
    pub fn width(&self) -> usize {
        (self.right - self.left).max(0) as usize
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        (self.bottom - self.top).max(0) as usize
    }

    /// The window with `by` more pixels on each side.
    pub fn grown(&self, by: i64) -> Self {
        Self { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }

    /// The window with rows and columns exchanged.
    pub(super) fn transposed(&self) -> Self {
        Self { left: self.top, top: self.left, right: self.bottom, bottom: self.right }
    }
}

/// A side of a polygon, from its upper to its lower end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Height of the upper end, in steps of [`ROW`].
    pub top: i64,
    /// Height of the lower end, in steps; greater than `top`.
    pub bottom: i64,
    x: f64,
    slope: f64,
    polygon: u32,
    winding: i32,
    /// The ends of the side before rounding.
    pub ends: [Point; 2],
}

impl Edge {
    fn new(polygon: usize, a: Point, b: Point) -> Option<Self> {
        let height = |p: Point| (p.y * ROW as f64).round() as i64;
        let (a_y, b_y) = (height(a), height(b));
        let ((upper, top), (lower, bottom), winding) =
            if a_y < b_y { ((a, a_y), (b, b_y), 1) } else { ((b, b_y), (a, a_y), -1) };
        let slope = (lower.x - upper.x) / (bottom - top) as f64;
        (top < bottom).then_some(Self {
            top,
            bottom,
            x: upper.x,
            slope,
            polygon: polygon as u32,
            winding,
            ends: [upper, lower],
        })
    }

    fn at(&self, height: i64) -> f64 {
        self.x + (height - self.top) as f64 * self.slope
    }
}

/// Polygons at one or several instants, prepared for scanning.
#[derive(Clone, Debug)]
pub struct Shape {
    instants: Vec<Instant>,
}

#[derive(Clone, Debug)]
struct Instant {
    /// Sides in the order of their upper ends.
    edges: Vec<Edge>,
    polygons: usize,
}

impl Shape {
    /// A shape from the closed polygons of some instants; its coverage is their mean. Instants after the first
    /// [`MOST_INSTANTS`] are ignored, and so are polygons with a coordinate that is not finite.
    pub fn new(instants: &[Vec<Vec<Point>>]) -> Self {
        Self { instants: instants.iter().take(MOST_INSTANTS).map(|polygons| Instant::new(polygons)).collect() }
    }

    /// Calls `each` for the rows of a window from top to bottom, with the row's number and coverage (0 to 1), until it
    /// returns false. Returns whether it never did.
    pub fn rows(&self, window: Window, each: &mut dyn FnMut(i64, &[f32]) -> bool) -> bool {
        let mut scans: Vec<Scan> = self.instants.iter().map(|instant| Scan::new(instant, window.top)).collect();
        let mut area = Area { left: window.left, delta: vec![0; window.width() + 1] };
        let unit = 1.0 / (ROW * self.instants.len().max(1) as i64) as f64;
        let mut row = vec![0.0f32; window.width()];
        for y in window.top..window.bottom {
            let mut touched = false;
            for scan in &mut scans {
                touched |= scan.row(y, &mut area);
            }
            if touched {
                let mut sum = 0i32;
                for (value, change) in row.iter_mut().zip(&mut area.delta) {
                    sum += std::mem::take(change);
                    *value = (f64::from(sum) * unit) as f32;
                }
                if let Some(rest) = area.delta.last_mut() {
                    *rest = 0;
                }
            } else {
                row.fill(0.0);
            }
            if !each(y, &row) {
                return false;
            }
        }
        true
    }
}

impl Instant {
    fn new(polygons: &[Vec<Point>]) -> Self {
        let mut edges = Vec::new();
        for (index, points) in polygons.iter().enumerate().filter(|(_, points)| points.iter().all(|p| p.is_finite())) {
            edges.extend(polyline::segments(points, true).filter_map(|(a, b)| Edge::new(index, a, b)));
        }
        edges.sort_by_key(|edge| edge.top);
        Self { edges, polygons: polygons.len() }
    }
}

/// Receives the intervals of the union, slab by slab.
pub(super) trait Sink {
    /// An interval between two sides, from height `top` to height `bottom`.
    fn interval(&mut self, left: &Side, right: &Side, top: i64, bottom: i64);
}

/// A side within a slab.
#[derive(Clone, Copy)]
pub(super) struct Side {
    /// Index among the instant's sides.
    pub edge: usize,
    /// Its x at the top of the slab.
    pub above: f64,
    /// Its x at the bottom of the slab.
    pub below: f64,
}

/// Scans the sides of one instant row by row.
struct Scan<'a> {
    instant: &'a Instant,
    next: usize,
    active: Vec<usize>,
    cuts: Vec<i64>,
    crossings: Vec<i64>,
    sides: Vec<Side>,
    winding: Vec<i32>,
}

impl<'a> Scan<'a> {
    fn new(instant: &'a Instant, top: i64) -> Self {
        let above = top.saturating_mul(ROW);
        // Sides are sorted by upper ends, so sides that end above the first row may be anywhere among the
        //         first ones.
        let next = instant.edges.partition_point(|edge| edge.top < above);
        let active = (0..next).filter(|&edge| instant.edges[edge].bottom > above).collect();
        let winding = vec![0; instant.polygons];
        Self { instant, next, active, cuts: Vec::new(), crossings: Vec::new(), sides: Vec::new(), winding }
    }

    /// Scans the next row. Returns whether any side is in it.
    fn row(&mut self, y: i64, sink: &mut impl Sink) -> bool {
        let edges = &self.instant.edges;
        let (top, bottom) = (y * ROW, (y + 1) * ROW);
        while self.next < edges.len() && edges[self.next].top < bottom {
            self.active.push(self.next);
            self.next += 1;
        }
        self.active.retain(|&edge| edges[edge].bottom > top);
        if self.active.is_empty() {
            return false;
        }
        self.cuts.clear();
        self.cuts.extend([top, bottom]);
        let ends = self.active.iter().flat_map(|&edge| [edges[edge].top, edges[edge].bottom]);
        self.cuts.extend(ends.filter(|height| (top + 1..bottom).contains(height)));
        self.cuts.sort_unstable();
        self.cuts.dedup();
        for k in 1..self.cuts.len() {
            let (above, below) = (self.cuts[k - 1], self.cuts[k]);
            self.sides_of(above, below);
            if self.crossed() {
                self.cross(above, below);
                for j in 1..self.crossings.len() {
                    let (above, below) = (self.crossings[j - 1], self.crossings[j]);
                    self.sides_of(above, below);
                    self.unite(above, below, sink);
                }
            } else {
                self.unite(above, below, sink);
            }
        }
        true
    }

    /// Collects the sides of a slab in which no side begins or ends, in the order of x at the middle of the slab.
    fn sides_of(&mut self, top: i64, bottom: i64) {
        let edges = &self.instant.edges;
        self.sides.clear();
        let inside = self.active.iter().filter(|&&edge| edges[edge].top <= top && bottom <= edges[edge].bottom);
        self.sides.extend(inside.map(|&edge| Side { edge, above: edges[edge].at(top), below: edges[edge].at(bottom) }));
        self.sides.sort_unstable_by(|a, b| (a.above + a.below).total_cmp(&(b.above + b.below)));
    }

    fn crossed(&self) -> bool {
        let apart = |pair: &[Side]| pair[0].above > pair[1].above + NEAR || pair[0].below > pair[1].below + NEAR;
        self.sides.windows(2).any(apart)
    }

    /// Collects the heights of all crossings in a slab, and its ends.
    fn cross(&mut self, top: i64, bottom: i64) {
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

    fn unite(&mut self, top: i64, bottom: i64, sink: &mut impl Sink) {
        self.winding.fill(0);
        let mut inside = 0;
        // An interval is passed on when the next one begins apart from it. Polygons that touch make one
        //         interval.
        let mut found: Option<(Side, Side)> = None;
        let mut left = None;
        for side in &self.sides {
            let edge = &self.instant.edges[side.edge];
            let winding = &mut self.winding[edge.polygon as usize];
            let before = *winding;
            *winding += edge.winding;
            if before == 0 {
                if inside == 0 {
                    left = Some(match found.take() {
                        Some((first, last)) if side.above - last.above <= NEAR && side.below - last.below <= NEAR => {
                            first
                        }
                        Some((first, last)) => {
                            sink.interval(&first, &last, top, bottom);
                            *side
                        }
                        None => *side,
                    });
                }
                inside += 1;
            } else if *winding == 0 {
                inside -= 1;
                if inside == 0 {
                    found = left.map(|left| (left, *side));
                }
            }
        }
        if let Some((first, last)) = found {
            sink.interval(&first, &last, top, bottom);
        }
    }
}

/// Passes every interval of the first instant in the rows of a window to a sink.
pub(super) fn intervals(shape: &Shape, window: Window, sink: &mut impl Sink) {
    let Some(instant) = shape.instants.first() else { return };
    let mut scan = Scan::new(instant, window.top);
    for y in window.top..window.bottom {
        scan.row(y, sink);
    }
}

/// The sides of the first instant.
pub(super) fn edges(shape: &Shape) -> &[Edge] {
    shape.instants.first().map_or(&[], |instant| &instant.edges)
}

/// Areas of one row, as differences between neighbouring pixels.
struct Area {
    left: i64,
    /// One entry for each pixel, and one for the area beyond the last.
    delta: Vec<i32>,
}

impl Sink for Area {
    fn interval(&mut self, left: &Side, right: &Side, top: i64, bottom: i64) {
        let height = (bottom - top) as i32;
        self.side(left, height, 1);
        self.side(right, height, -1);
    }
}

impl Area {
    /// Adds (or subtracts) the area to the right of a side.
    fn side(&mut self, side: &Side, height: i32, sign: i32) {
        let (low, high) = if side.above < side.below { (side.above, side.below) } else { (side.below, side.above) };
        let (first, last) = (low.floor() as i64, high.ceil() as i64);
        let (right, tall) = (self.left + self.delta.len() as i64 - 1, f64::from(height));
        if last <= self.left {
            self.delta[0] += sign * height;
            return;
        }
        if first >= right {
            return;
        }
        if last - first <= 1 {
            let own = (tall * ((first + 1) as f64 - 0.5 * (low + high))).round() as i32;
            // A side in the column left of the window was handled with `last` above.
            let at = (first - self.left) as usize;
            self.delta[at] += sign * own;
            self.delta[at + 1] += sign * (height - own);
            return;
        }
        // The area to the left of `x` and right of the side. Its differences are the areas within pixels.
        let (width, middle) = (high - low, 0.5 * (low + high));
        let until = |x: f64| {
            if x <= low {
                0.0
            } else if x >= high {
                tall * (x - middle)
            } else {
                tall * (x - low) * (x - low) / (2.0 * width)
            }
        };
        let mut before = 0;
        for x in first.max(self.left)..last.min(right) {
            let own = (until((x + 1) as f64) - until(x as f64)).round() as i32;
            self.delta[(x - self.left) as usize] += sign * (own - before);
            before = own;
        }
        if last < right {
            self.delta[(last - self.left) as usize] += sign * (height - before);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::scene::Raster;

    fn picture(instants: &[Vec<Vec<Point>>], window: Window) -> Raster<f32> {
        let mut values = Vec::new();
        assert!(Shape::new(instants).rows(window, &mut |_, row| {
            values.extend_from_slice(row);
            true
        }));
        Raster::from_vec(window.width(), window.height(), values).unwrap()
    }

    fn size(width: i64, height: i64) -> Window {
        Window { left: 0, top: 0, right: width, bottom: height }
    }

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    /// The share of 400 × 400 points of a pixel that are inside any polygon, by winding number.
    fn sampled(polygons: &[Vec<Point>], x: usize, y: usize) -> f64 {
        const N: usize = 200;
        let inside = |q: Point| {
            polygons.iter().any(|points| {
                let turns = polyline::segments(points, true).map(|(a, b)| {
                    let side = (b - a).perp_dot(q - a);
                    i32::from(a.y <= q.y && b.y > q.y && side > 0.0) - i32::from(a.y > q.y && b.y <= q.y && side < 0.0)
                });
                turns.sum::<i32>() != 0
            })
        };
        let at = |k: usize| (k as f64 + 0.5) / N as f64;
        let hits = (0..N * N).filter(|k| inside(p(x as f64 + at(k % N), y as f64 + at(k / N)))).count();
        hits as f64 / (N * N) as f64
    }

    #[test]
    fn slanted_sides_cover_exactly() {
        let picture = picture(&[vec![vec![p(0.0, 0.0), p(4.0, 0.0), p(0.0, 2.0)]]], size(4, 2));
        let wanted = [1.0, 1.0, 0.75, 0.25, 0.75, 0.25, 0.0, 0.0];
        for (value, wanted) in picture.data().iter().zip(wanted) {
            assert!((value - wanted).abs() < 1e-6, "{:?}", picture.data());
        }
    }

    #[test]
    fn the_mean_of_instants() {
        let square = |x: f64| vec![vec![p(x, 0.0), p(x + 1.0, 0.0), p(x + 1.0, 1.0), p(x, 1.0)]];
        let picture = picture(&[square(0.0), square(1.0), square(1.5)], size(3, 1));
        for (value, wanted) in picture.data().iter().zip([1.0 / 3.0, 0.5, 0.5 / 3.0]) {
            assert!((value - wanted).abs() < 1e-6, "{:?}", picture.data());
        }
    }

    #[test]
    fn rows_end_when_told_and_polygons_of_no_numbers_cover_nothing() {
        let shape = Shape::new(&[vec![vec![p(f64::NAN, 0.0), p(4.0, 0.0), p(0.0, 2.0)]]]);
        let mut rows = 0;
        assert!(!shape.rows(size(3, 5), &mut |_, row| {
            rows += 1;
            assert_eq!(row, [0.0; 3]);
            rows < 2
        }));
        assert_eq!(rows, 2);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn as_many_samples_have_it(
            corners in proptest::collection::vec(proptest::collection::vec((-2.0..7.0, -2.0..6.0), 3..7), 1..4)
        ) {
            let polygons: Vec<Vec<Point>> =
                corners.iter().map(|points| points.iter().map(|&(x, y)| p(x, y)).collect()).collect();
            let picture = picture(std::slice::from_ref(&polygons), size(5, 4));
            for y in 0..4 {
                for x in 0..5 {
                    prop_assert!((f64::from(picture.get(x, y)) - sampled(&polygons, x, y)).abs() < 0.02);
                }
            }
        }

        #[test]
        fn any_window_has_the_same_values(
            corners in proptest::collection::vec((-20.0..30.0, -20.0..30.0), 3..12), left in 0i64..6, top in 0i64..6
        ) {
            let polygons = vec![corners.iter().map(|&(x, y)| p(x, y)).collect::<Vec<_>>()];
            let whole = picture(std::slice::from_ref(&polygons), size(10, 10));
            let part = picture(&[polygons], Window { left, top, right: left + 3, bottom: top + 4 });
            for y in 0..4 {
                for x in 0..3 {
                    prop_assert_eq!(part.get(x, y), whole.get(x + left as usize, y + top as usize));
                }
            }
        }

        #[test]
        fn halves_make_a_whole(cut in proptest::collection::vec((0.5..5.5, 0.1..3.9), 1..5)) {
            // A rectangle cut along a line that may fold: the two parts share a border and have no seam.
            let mut line: Vec<Point> = cut.iter().map(|&(x, y)| p(x, y)).collect();
            line.sort_by(|a, b| a.y.total_cmp(&b.y));
            let mut left = vec![p(2.0, 4.0), p(0.0, 4.0), p(0.0, 0.0), p(2.0, 0.0)];
            let mut right = vec![p(2.0, 4.0), p(6.0, 4.0), p(6.0, 0.0), p(2.0, 0.0)];
            left.extend(&line);
            right.extend(&line);
            let picture = picture(&[vec![left, right]], size(6, 4));
            prop_assert!(picture.data().iter().all(|value| *value == 1.0), "{:?}", picture.data());
        }
    }
}
