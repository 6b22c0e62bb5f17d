//! Affine colouring (Zhou & Xiao 2011, Algorithm 1): a polygon B takes its pixels' colours from another polygon A with
//! the same vertices.
//!
//! 1. The affine map T from the vertices of B to those of A is fitted by least squares.
//! 2. A pixel of B whose image under T is inside A takes the colour there, read bilinearly.
//! 3. Every other pixel takes the colour of the nearest pixel that has one.
//!
//! If the vertices are on a line, or fewer than three, T is not determined across the line. Then a similarity is
//! fitted.
//!
//! The nearest pixel is found by two sweeps that propagate offsets (Danielsson, "Euclidean distance mapping", 1980).
//! The result can be off by a fraction of a pixel.

use nalgebra::{Matrix2, Vector2};
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::sample;

/// An affine map q = M (p − source) + target. The columns of M are `x` and `y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Image of the x direction.
    pub x: Point,
    /// Image of the y direction.
    pub y: Point,
    /// Centre of the source points.
    pub source: Point,
    /// Centre of the target points.
    pub target: Point,
}

impl Affine {
    /// The least-squares map from `from` to `to`, which are paired by index and have the same number of points.
    pub fn fit(from: &[Point], to: &[Point]) -> Self {
        let (source, target) = (polygon::center(from), polygon::center(to));
        // M = (Σ q pᵀ)(Σ p pᵀ)⁻¹ with both sets centred.
        let (mut images, mut moments) = (Matrix2::zeros(), Matrix2::zeros());
        for (&p, &q) in from.iter().zip(to) {
            let (p, q) = (column(p - source), column(q - target));
            images += q * p.transpose();
            moments += p * p.transpose();
        }
        let round = 1e-6 * moments.trace().powi(2);
        let inverse = moments.try_inverse().filter(|_| moments.determinant() > round);
        let Some(inverse) = inverse else {
            let factor = Similarity::fit(from, to).factor;
            return Self { x: factor, y: factor.perp(), source, target };
        };
        let map = images * inverse;
        Self { x: Point::new(map.m11, map.m21), y: Point::new(map.m12, map.m22), source, target }
    }

    /// Image of a point.
    pub fn apply(&self, p: Point) -> Point {
        let p = p - self.source;
        self.x * p.x + self.y * p.y + self.target
    }
}

fn column(p: Point) -> Vector2<f64> {
    Vector2::new(p.x, p.y)
}

/// A run of coloured pixels of one row.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Row of the picture. It may be outside.
    pub y: isize,
    /// Column of the first pixel. It may be outside.
    pub x: isize,
    /// Colours of the pixels from left to right, three values per pixel.
    pub colours: Vec<f32>,
}

/// A polygon with the colours of a key, prepared to colour other polygons.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    picture: &'a Raster<Colour>,
    polygon: &'a [Point],
    inside: Raster<bool>,
}

impl<'a> Source<'a> {
    /// Prepares the polygon A (pixels) on its picture.
    pub fn new(picture: &'a Raster<Colour>, polygon: &'a [Point]) -> Self {
        let mut inside = Raster::new(picture.width(), picture.height(), false);
        polygon::for_each_span(polygon, picture.width(), picture.height(), |y, x0, x1| {
            inside.row_mut(y)[x0..x1].fill(true);
        });
        Self { picture, polygon, inside }
    }

    /// The coloured pixels of the polygon `target` (B), with rows from the top and runs from the left. Pixels more than
    /// `margin` pixels outside the picture are left out. Empty if B contains no pixel or no pixel of B has an image in
    /// A.
    pub fn colour(&self, target: &[Point], margin: usize) -> Vec<Run> {
        let Some(canvas) = Canvas::around(target, self.picture, margin) else { return Vec::new() };
        let map = Affine::fit(target, self.polygon);
        let mut member = Raster::new(canvas.width, canvas.height, false);
        let mut colours: Raster<Option<Colour>> = Raster::new(canvas.width, canvas.height, None);
        let mut runs = Vec::new();
        let local: Vec<_> = target.iter().map(|&p| p - canvas.origin()).collect();
        polygon::for_each_span(&local, canvas.width, canvas.height, |y, x0, x1| {
            for x in x0..x1 {
                let p = Point::new(x as f64 + 0.5, y as f64 + 0.5) + canvas.origin();
                member.set(x, y, true);
                colours.set(x, y, self.read(map.apply(p)));
            }
            runs.push((y, x0, x1));
        });
        let Some(filled) = fill_from_nearest(&colours, &member) else { return Vec::new() };
        runs.into_iter()
            .map(|(y, x0, x1)| Run {
                y: y as isize + canvas.top,
                x: x0 as isize + canvas.left,
                colours: filled.row(y)[x0..x1].as_flattened().to_vec(),
            })
            .collect()
    }

    /// The colour at `q`, if `q` is in A and in the picture.
    fn read(&self, q: Point) -> Option<Colour> {
        let (width, height) = (self.picture.width() as f64, self.picture.height() as f64);
        let within = q.x >= 0.0 && q.y >= 0.0 && q.x < width && q.y < height;
        (within && self.inside.get(q.x as usize, q.y as usize)).then(|| sample::read(self.picture, q))
    }
}

/// A rectangle around the pixels that a polygon may cover.
struct Canvas {
    left: isize,
    top: isize,
    width: usize,
    height: usize,
}

impl Canvas {
    fn around(polygon: &[Point], picture: &Raster<Colour>, margin: usize) -> Option<Self> {
        let (low, high) = polygon::bounds(polygon)?;
        let margin = margin as f64;
        let low = low.floor().max(Point::splat(-margin));
        let size = Point::new(picture.width() as f64, picture.height() as f64);
        let high = high.ceil().min(size + Point::splat(margin));
        // Written so that NaN bounds give nothing.
        if !(low.x < high.x && low.y < high.y) {
            return None;
        }
        let extent = high - low;
        Some(Self { left: low.x as isize, top: low.y as isize, width: extent.x as usize, height: extent.y as usize })
    }

    fn origin(&self) -> Point {
        Point::new(self.left as f64, self.top as f64)
    }
}

/// Each member's own colour, or that of the nearest pixel that has one. `None` if no pixel has a colour.
fn fill_from_nearest(colours: &Raster<Option<Colour>>, member: &Raster<bool>) -> Option<Raster<Colour>> {
    let (width, height) = (colours.width(), colours.height());
    if colours.data().iter().all(Option::is_none) {
        return None;
    }
    let complete = colours.data().iter().zip(member.data()).all(|(colour, &member)| colour.is_some() || !member);
    if complete {
        return Some(colours.map(|colour| colour.unwrap_or_default()));
    }
    // Offset to the nearest coloured pixel found so far.
    let mut offsets: Raster<Option<(i32, i32)>> = colours.map(|colour| colour.map(|_| (0, 0)));
    let relax = |offsets: &mut Raster<Option<(i32, i32)>>, x: usize, y: usize, dx: isize, dy: isize| {
        let (nx, ny) = (x as isize + dx, y as isize + dy);
        if nx < 0 || ny < 0 || nx >= width as isize || ny >= height as isize {
            return;
        }
        let Some((ox, oy)) = offsets.get(nx as usize, ny as usize) else { return };
        let offset = (ox + dx as i32, oy + dy as i32);
        let squared = |(x, y): (i32, i32)| i64::from(x) * i64::from(x) + i64::from(y) * i64::from(y);
        if offsets.get(x, y).is_none_or(|old| squared(offset) < squared(old)) {
            offsets.set(x, y, Some(offset));
        }
    };
    let mut sweep = |rows: &mut dyn Iterator<Item = usize>, dy: isize| {
        for y in rows {
            for x in 0..width {
                for (dx, dy) in [(0, dy), (-1, dy), (1, dy), (-1, 0)] {
                    relax(&mut offsets, x, y, dx, dy);
                }
            }
            for x in (0..width).rev() {
                relax(&mut offsets, x, y, 1, 0);
            }
        }
    };
    sweep(&mut (0..height), -1);
    sweep(&mut (0..height).rev(), 1);
    Some(Raster::from_fn(width, height, |x, y| {
        let (dx, dy) = offsets.get(x, y).unwrap_or_default();
        let source = colours.get((x as i32 + dx) as usize, (y as i32 + dy) as usize);
        source.unwrap_or_default()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points<const N: usize>(list: [(f64, f64); N]) -> [Point; N] {
        list.map(|(x, y)| Point::new(x, y))
    }

    #[test]
    fn an_affine_map_is_recovered() {
        let from = points([(0.0, 0.0), (4.0, 1.0), (3.0, 5.0), (-2.0, 2.0)]);
        let to = from.map(|p| Point::new(2.0 * p.x - p.y + 3.0, 0.5 * p.x + p.y - 7.0));
        let map = Affine::fit(&from, &to);
        for (p, q) in from.into_iter().zip(to) {
            assert!(map.apply(p).distance(q) < 1e-12);
        }
    }

    #[test]
    fn vertices_on_a_line_give_a_similarity() {
        let from = points([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]);
        let to = points([(5.0, 5.0), (5.0, 7.0), (5.0, 9.0)]);
        let map = Affine::fit(&from, &to);
        assert!(map.apply(Point::new(1.0, 1.0)).distance(Point::new(3.0, 7.0)) < 1e-12);
        let still = Affine::fit(&[Point::ONE; 2], &[Point::ZERO; 2]);
        assert_eq!(still.apply(Point::new(2.0, 3.0)), Point::new(1.0, 2.0));
    }

    #[test]
    fn a_shifted_polygon_takes_the_pixels_over() {
        let picture = Raster::from_fn(12, 9, |x, y| [x as f32, y as f32, 1.0]);
        let a = points([(1.0, 1.0), (4.0, 1.0), (4.0, 3.0), (1.0, 3.0)]);
        let b = a.map(|p| p + Point::new(5.0, 4.0));
        let runs = Source::new(&picture, &a).colour(&b, 0);
        assert_eq!(runs.len(), 2);
        assert_eq!((runs[0].x, runs[0].y), (6, 5));
        assert_eq!(runs[0].colours, [1.0, 1.0, 1.0, 2.0, 1.0, 1.0, 3.0, 1.0, 1.0]);
        assert_eq!(runs[1].colours, [1.0, 2.0, 1.0, 2.0, 2.0, 1.0, 3.0, 2.0, 1.0]);
    }

    #[test]
    fn pixels_without_a_counterpart_take_the_nearest_colour() {
        // The key's polygon extends two pixels beyond the picture's left border.
        let picture = Raster::from_fn(6, 2, |x, _| [x as f32, 0.0, 0.0]);
        let a = points([(-2.0, 0.0), (2.0, 0.0), (2.0, 2.0), (-2.0, 2.0)]);
        let b = a.map(|p| p + Point::new(3.0, 0.0));
        let runs = Source::new(&picture, &a).colour(&b, 0);
        assert_eq!(runs[0].colours.iter().step_by(3).copied().collect::<Vec<_>>(), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn polygons_without_a_counterpart_get_no_colours() {
        let picture = Raster::new(6, 6, [0.5; 3]);
        let square = points([(1.0, 1.0), (4.0, 1.0), (4.0, 4.0), (1.0, 4.0)]);
        let source = Source::new(&picture, &square);
        assert!(source.colour(&[], 5).is_empty());
        assert!(source.colour(&[Point::ONE; 4], 5).is_empty());
        assert!(source.colour(&square.map(|p| p + Point::splat(1e9)), 5).is_empty());
        assert!(source.colour(&[Point::NAN; 4], 5).is_empty());
        let outside = square.map(|p| p - Point::splat(50.0));
        assert!(Source::new(&picture, &outside).colour(&square, 5).is_empty());
    }

    proptest! {
        #[test]
        fn the_nearest_colour_is_as_near_as_by_search(seeds in prop::collection::vec((0usize..12, 0usize..10), 1..5)) {
            let mut colours = Raster::new(12, 10, None);
            for &(x, y) in &seeds {
                colours.set(x, y, Some([x as f32, y as f32, 0.0]));
            }
            let filled = fill_from_nearest(&colours, &Raster::new(12, 10, true)).unwrap();
            for y in 0..10 {
                for x in 0..12 {
                    let distance = |sx: f64, sy: f64| (sx - x as f64).hypot(sy - y as f64);
                    let least = seeds.iter().map(|&(x, y)| distance(x as f64, y as f64)).fold(f64::INFINITY, f64::min);
                    let [sx, sy, _] = filled.get(x, y);
                    prop_assert!(distance(sx.into(), sy.into()) < least + 0.5);
                }
            }
        }
    }
}
