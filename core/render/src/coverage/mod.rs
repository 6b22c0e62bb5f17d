//! Exact area coverage of unions of polygons.
//!
//! Each pixel row is cut into slabs at the heights of all polygon corners in it and of all crossings of sides. Within a
//! slab the sides therefore keep their order from left to right. In a slab the interior of each polygon is a set of
//! intervals between two sides. The non-zero winding rule applies, so a contour that folds over itself has no hole. The
//! intervals of all polygons are united. A side that bounds the union adds the area to its right within each pixel, in
//! closed form. The coverage is exact for sides of any slope. Polygons that touch leave no seam, because intervals are
//! united and not opacities.
//!
//! Sides that keep their order in the whole row need no slabs: only the knots of a row do, in which sides cross or outlines
//! turn ([`quiet`]). Rows with large knots are divided into tiles, and only the sides in a tile cut its slabs ([`scan`]).
//!
//! Heights are integer multiples of 2⁻²⁴ of a row, and areas are integer sums. The inside is exactly 1, the outside
//! exactly 0, and the value of a pixel does not depend on the requested window. Areas of several instants add up in the
//! same sums, so motion blur by samples needs no more passes over the pixels.
//!
//! Limits: at most [`MOST_INSTANTS`] instants; a picture's coordinates times 2²⁴ must fit 64-bit integers.

mod area;
mod batch;
mod chains;
mod edge;
mod left;
mod quiet;
mod scan;
mod slabs;

use area::Area;
use edge::{Instant, ROW};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use scan::{Scan, TILE};

pub(super) use edge::Edge;
pub(super) use slabs::{Side, Sink};

/// Greatest number of instants; their areas are summed in 32 bits.
pub const MOST_INSTANTS: usize = 64;

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

    /// The smallest window around some points; `None` if there are none or a coordinate is not finite.
    pub(super) fn around(points: &[Point]) -> Option<Self> {
        let whole = points.iter().all(|p| p.is_finite());
        let (least, most) = points.iter().fold((Point::MAX, Point::MIN), |(a, b), &p| (a.min(p), b.max(p)));
        // A float beyond the range of integers becomes the largest integer.
        (whole && !points.is_empty()).then(|| Self {
            left: least.x.floor() as i64,
            top: least.y.floor() as i64,
            right: most.x.ceil() as i64,
            bottom: most.y.ceil() as i64,
        })
    }

    /// The smallest window that contains both.
    pub fn united(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }

    /// The pixels that both windows have; `None` if there are none.
    pub fn common(self, other: Self) -> Option<Self> {
        let (left, top) = (self.left.max(other.left), self.top.max(other.top));
        let (right, bottom) = (self.right.min(other.right), self.bottom.min(other.bottom));
        (left < right && top < bottom).then_some(Self { left, top, right, bottom })
    }

    /// The window with rows and columns exchanged.
    pub(super) fn transposed(&self) -> Self {
        Self { left: self.top, top: self.left, right: self.bottom, bottom: self.right }
    }
}

/// Polygons at one or several instants, prepared for scanning.
#[derive(Clone, Debug)]
pub struct Shape {
    instants: Vec<Instant>,
}

impl Shape {
    /// A shape from the closed polygons of some instants; its coverage is their mean. Instants after the first
    /// [`MOST_INSTANTS`] are ignored, and so are polygons with a coordinate that is not finite.
    pub fn new(instants: &[Vec<Vec<Point>>]) -> Self {
        let instants = &instants[..instants.len().min(MOST_INSTANTS)];
        // What does not move is one instant.
        let still = instants.windows(2).all(|pair| pair[0] == pair[1]);
        let count = if still { instants.len().min(1) } else { instants.len() };
        Self { instants: instants[..count].iter().map(|polygons| Instant::new(polygons)).collect() }
    }

    /// The rows of a window, from top to bottom.
    pub fn rows(&self, window: Window) -> Rows<'_> {
        self.rows_in_tiles(window, TILE)
    }

    fn rows_in_tiles(&self, window: Window, share: usize) -> Rows<'_> {
        Rows {
            scans: self.instants.iter().map(|instant| Scan::new(instant, window.top, share)).collect(),
            area: Area::new(window.left..window.right),
            unit: 1.0 / (ROW * self.instants.len().max(1) as i64) as f64,
            next: window.top,
        }
    }

    /// Draws the coverage of a window. Calls `go_on` for each row, and returns `None` if it returns false.
    pub fn draw(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let mut picture = Raster::new(window.width(), window.height(), 0.0f32);
        let mut rows = self.rows(window);
        for y in 0..window.height() {
            rows.fill(picture.row_mut(y));
            if !go_on() {
                return None;
            }
        }
        Some(picture)
    }
}

/// The coverage of the rows of a window, from top to bottom.
pub struct Rows<'a> {
    scans: Vec<Scan<'a>>,
    area: Area,
    /// The inverse of the area of a pixel over all instants, in steps.
    unit: f64,
    next: i64,
}

impl Rows<'_> {
    /// Calls `change` with the columns of the next row at which the coverage changes, from left to right, and with the
    /// coverage (0 to 1) from there on. Left of the first it is 0.
    pub fn next(&mut self, mut change: impl FnMut(usize, f32)) {
        for scan in &mut self.scans {
            scan.row(self.next, &mut self.area);
        }
        self.next += 1;
        self.area.take(self.unit, &mut change);
    }

    /// Writes the coverage of the next row over zeros.
    pub fn fill(&mut self, row: &mut [f32]) {
        let (mut from, mut covered) = (0, 0.0);
        self.next(|column, value| {
            // The row is 0 already.
            if covered != 0.0 {
                row[from..column].fill(covered);
            }
            (from, covered) = (column, value);
        });
        if covered != 0.0 {
            row[from..].fill(covered);
        }
    }
}

/// Passes the border of the union of the first instant in the rows of a window to a sink, each row as one tile.
pub(super) fn border(shape: &Shape, window: Window, sink: &mut impl Sink) {
    let Some(instant) = shape.instants.first() else { return };
    let mut scan = Scan::new(instant, window.top, usize::MAX);
    for y in window.top..window.bottom {
        scan.row(y, sink);
    }
}

/// The sides of the first instant, and the upper and lower end of each.
pub(super) fn edges(shape: &Shape) -> (&[Edge], &[[Point; 2]]) {
    shape.instants.first().map_or((&[], &[]), |instant| (&instant.edges, &instant.ends))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::geometry::polyline;

    fn picture(instants: &[Vec<Vec<Point>>], window: Window) -> Raster<f32> {
        Shape::new(instants).draw(window, &mut || true).unwrap()
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
        assert_eq!(shape.draw(size(3, 5), &mut || true), Some(Raster::new(3, 5, 0.0)));
        let mut rows = 0;
        assert_eq!(
            shape.draw(size(3, 5), &mut || {
                rows += 1;
                rows < 2
            }),
            None
        );
        assert_eq!(rows, 2);
    }

    /// Discs in a grid of quarters of pixels, so that many sides and corners are at the same place.
    fn discs(places: &[(u8, u8, u8)]) -> Vec<Vec<Point>> {
        let disc = |&(x, y, radius): &(u8, u8, u8)| {
            let (x, y, radius) = (f64::from(x) / 4.0, f64::from(y) / 4.0, f64::from(radius) / 4.0);
            let corner = |k: u32| Point::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_4) * radius + p(x, y);
            (0..8).map(corner).collect()
        };
        places.iter().map(disc).collect()
    }

    fn in_tiles(polygons: &[Vec<Point>], window: Window, share: usize) -> Vec<f32> {
        let shape = Shape::new(&[polygons.to_vec()]);
        let mut rows = shape.rows_in_tiles(window, share);
        let mut values = Vec::new();
        for _ in 0..window.height() {
            let (start, mut covered) = (values.len(), 0.0);
            rows.next(|column, value| {
                values.resize(start + column, covered);
                covered = value;
            });
            values.resize(start + window.width(), covered);
        }
        values
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn tiles_of_any_size_have_the_same_values(
            places in proptest::collection::vec((0u8..90, 0u8..40, 1u8..20), 1..60), share in 1usize..12
        ) {
            let polygons = discs(&places);
            let (whole, tiles) =
                (in_tiles(&polygons, size(24, 10), usize::MAX), in_tiles(&polygons, size(24, 10), share));
            for (a, b) in whole.iter().zip(&tiles) {
                // Each slab's area is rounded to 2⁻²⁴ of a pixel.
                prop_assert!((a - b).abs() < 1e-5, "{a} {b}");
                prop_assert_eq!(*a == 1.0, *b == 1.0);
            }
        }

        #[test]
        fn a_window_has_the_same_tiles(
            places in proptest::collection::vec((0u8..90, 0u8..40, 1u8..20), 30..60), left in 0i64..20, top in 0i64..6
        ) {
            let polygons = discs(&places);
            let whole = picture(std::slice::from_ref(&polygons), size(24, 10));
            let part = picture(&[polygons], Window { left, top, right: left + 4, bottom: top + 4 });
            for y in 0..4 {
                for x in 0..4 {
                    prop_assert_eq!(part.get(x, y), whole.get(x + left as usize, y + top as usize));
                }
            }
        }

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
