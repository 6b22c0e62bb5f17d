//! Distance of the segments from drawn edges (Zhou & Xiao 2011, eq. 7, 8, 11 and 12):
//!
//! ```text
//! E_E = Σ_i Σ_j f_Segdist(s_i(j))²,   f_Segdist = (1/t) Σ_k D_i(x_k, y_k)
//! ```
//!
//! D_i is the Manhattan distance of each pixel from the nearest edge pixel of frame i. It is read bilinearly between
//! pixel centres so that it has derivatives. The t samples are the middles of t equal pieces of the segment.
//!
//! Outside the rectangle of a [`DistanceField`], D is constant along the outward direction.

use super::term::{Curves, Sink, Term, by_point};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;

/// Manhattan distances in pixels over a rectangle of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceField {
    left: usize,
    top: usize,
    distances: Raster<u16>,
}

impl DistanceField {
    /// A field from `distance(x, y)`, the distance in whole pixels at a pixel of the picture. The rectangle has the
    /// top-left pixel (`left`, `top`).
    ///
    /// # Panics
    ///
    /// If the rectangle has no pixel.
    pub fn from_fn(
        (left, top): (usize, usize),
        width: usize,
        height: usize,
        mut distance: impl FnMut(usize, usize) -> u16,
    ) -> Self {
        assert!(width > 0 && height > 0, "a distance field needs a pixel");
        Self { left, top, distances: Raster::from_fn(width, height, |x, y| distance(left + x, top + y)) }
    }

    /// The distance at `p` (pixels of the picture) and its derivatives by x and y. Eq. 11 and 12, with pixel centres at
    /// +0.5.
    pub fn read(&self, p: Point) -> (f64, Point) {
        let x = Cell::of(p.x - 0.5 - self.left as f64, self.distances.width());
        let y = Cell::of(p.y - 0.5 - self.top as f64, self.distances.height());
        let (upper, lower) = (self.distances.row(y.low), self.distances.row(y.high));
        let [a, b] = [upper[x.low], upper[x.high]].map(f64::from);
        let [c, d] = [lower[x.low], lower[x.high]].map(f64::from);
        let above = a + x.share * (b - a);
        let below = c + x.share * (d - c);
        let dx = (b - a) + y.share * ((d - c) - (b - a));
        let slope = Point::new(if x.inside { dx } else { 0.0 }, if y.inside { below - above } else { 0.0 });
        (above + y.share * (below - above), slope)
    }
}

/// The two pixels of a row or column between which a place is.
struct Cell {
    low: usize,
    high: usize,
    share: f64,
    inside: bool,
}

impl Cell {
    fn of(place: f64, count: usize) -> Self {
        let held = place.clamp(0.0, (count - 1) as f64);
        let low = (held as usize).min(count.saturating_sub(2));
        Self { low, high: (low + 1).min(count - 1), share: held - low as f64, inside: held == place }
    }
}

/// The term E_E.
#[derive(Clone, Debug)]
pub struct Edge {
    /// D by frame. A frame without one has no residual.
    pub distances: Vec<Option<DistanceField>>,
    /// t: samples per segment.
    pub samples: usize,
}

impl Edge {
    /// f_Segdist of the segment `a`–`b` on a frame, in pixels, and its derivatives by `a` and by `b`.
    pub(super) fn segment(&self, field: &DistanceField, a: Point, b: Point) -> (f64, Point, Point) {
        let mut sum = (0.0, Point::ZERO, Point::ZERO);
        for k in 0..self.samples {
            let share = (k as f64 + 0.5) / self.samples as f64;
            let (distance, slope) = field.read(a.lerp(b, share));
            sum = (sum.0 + distance, sum.1 + (1.0 - share) * slope, sum.2 + share * slope);
        }
        let t = self.samples.max(1) as f64;
        (sum.0 / t, sum.1 / t, sum.2 / t)
    }
}

impl Term for Edge {
    fn walk(&self, curves: Curves<'_>, sink: &mut impl Sink) {
        let layout = curves.layout;
        for (frame, field) in self.distances.iter().enumerate() {
            let Some(field) = field else { continue };
            for (a, b) in layout.segments() {
                let (distance, by_a, by_b) = self.segment(field, curves.at(frame, a), curves.at(frame, b));
                let derivatives =
                    [by_point(layout.coordinate(frame, a), by_a), by_point(layout.coordinate(frame, b), by_b)];
                sink.residual(distance, derivatives.into_iter().flatten());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Weights;
    use super::super::tests::{NONE, worst};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_jacobian_is_right() {
        let worst = worst(Weights { edge: 2.0, ..NONE });
        assert!(worst.error < 1e-7, "{worst:?}");
    }

    #[test]
    fn a_pixel_is_read_at_its_centre() {
        let field = DistanceField::from_fn((10, 20), 3, 2, |x, y| (10 * x + y) as u16);
        assert_eq!(field.read(Point::new(11.5, 21.5)), (131.0, Point::new(10.0, 1.0)));
        assert_eq!(field.read(Point::new(11.0, 21.0)).0, 125.5);
    }

    #[test]
    fn outside_the_field_the_distance_is_constant() {
        let field = DistanceField::from_fn((0, 0), 3, 3, |x, y| (x + 5 * y) as u16);
        assert_eq!(field.read(Point::new(-40.0, 1.5)), (5.0, Point::new(0.0, 5.0)));
        assert_eq!(field.read(Point::new(1e300, 1e300)), (12.0, Point::ZERO));
        let pixel = DistanceField::from_fn((0, 0), 1, 1, |_, _| 7);
        assert_eq!(pixel.read(Point::new(0.5, 3.0)), (7.0, Point::ZERO));
    }

    proptest! {
        #[test]
        fn the_slope_is_that_of_the_surface(
            values in prop::collection::vec(0u16..50, 25),
            x in 0.6f64..4.4,
            y in 0.6f64..4.4,
        ) {
            let h = 1e-6;
            // Stay away from the creases between cells.
            prop_assume!([x, y].iter().all(|v| ((v - 0.5).fract() - 0.5).abs() < 0.5 - 2.0 * h));
            let field = DistanceField::from_fn((0, 0), 5, 5, |x, y| values[5 * y + x]);
            let at = |dx: f64, dy: f64| field.read(Point::new(x + dx, y + dy)).0;
            let slope = field.read(Point::new(x, y)).1;
            prop_assert!((slope.x - (at(h, 0.0) - at(-h, 0.0)) / (2.0 * h)).abs() < 1e-6);
            prop_assert!((slope.y - (at(0.0, h) - at(0.0, -h)) / (2.0 * h)).abs() < 1e-6);
        }
    }
}
