//! A picture at halved sizes.
//!
//! Level 0 is the picture. Each further level is blurred, then reduced by exactly 2, so a point p of the picture is at
//! p / 2ˡ on level l for any size (see [`resize::reduce`](super::resize::reduce)). The blur of level l is a Gaussian of
//! σ = `softness` · 2ˡ pixels of the picture, as if the level were made from the picture itself. Variances add. The blur
//! before a reduction therefore has σ = √3 · `softness` pixels of the level that is reduced. For level 0 it has
//! σ = 2 · `softness`, because level 0 itself is not blurred.
//!
//! Limits: the averaging within the reduction adds to the blur and is not counted.

use super::gaussian::{Border, blur};
use super::pixel::Pixel;
use super::resize::reduce;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};

/// A picture at halved sizes. It always has a level 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid<T = Colour> {
    levels: Vec<Raster<T>>,
}

impl<T: Pixel> Pyramid<T> {
    /// At most `levels` levels, but at least the picture itself. It ends earlier at a picture of one pixel. `softness`
    /// is the σ of the blur in pixels of the level; 0 averages only.
    pub fn new(picture: Raster<T>, levels: usize, softness: f64) -> Self {
        let mut all = vec![picture];
        while all.len() < levels {
            let last = &all[all.len() - 1];
            if last.width() <= 1 && last.height() <= 1 {
                break;
            }
            let sigma = if all.len() == 1 { 2.0 * softness } else { 3.0f64.sqrt() * softness };
            let next = reduce(&blur(last, sigma, Border::Replicate), 2.0);
            all.push(next);
        }
        Self { levels: all }
    }

    /// The levels, the largest first.
    pub fn levels(&self) -> &[Raster<T>] {
        &self.levels
    }

    /// The position on a level of a point of the picture.
    pub fn to_level(point: Point, level: usize) -> Point {
        point / 2f64.powi(level as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::read;

    #[test]
    fn sizes_halve_upwards() {
        let pyramid = Pyramid::new(Raster::new(13, 5, [0.5f32; 3]), 9, 0.5);
        let sizes: Vec<_> = pyramid.levels().iter().map(|l| (l.width(), l.height())).collect();
        assert_eq!(sizes, [(13, 5), (7, 3), (4, 2), (2, 1), (1, 1)]);
        for level in pyramid.levels() {
            assert!(level.data().iter().flatten().all(|v| (v - 0.5).abs() < 1e-6));
        }
    }

    #[test]
    fn positions_are_right_on_every_level() {
        // Away from the border, blur and reduction do not change a slope.
        let picture = Raster::from_fn(101, 67, |x, y| 0.01 * (x as f32 + 0.5) - 0.02 * (y as f32 + 0.5));
        let pyramid = Pyramid::new(picture, 4, 0.5);
        let p = Point::new(47.3, 31.9);
        for (l, level) in pyramid.levels().iter().enumerate() {
            let value = read(level, Pyramid::<f32>::to_level(p, l)) as f64;
            assert!((value - (0.01 * p.x - 0.02 * p.y)).abs() < 1e-3, "level {l}: {value}");
        }
    }

    #[test]
    fn blur_is_that_of_one_step() {
        let mut picture = Raster::new(64, 64, 0.0f32);
        picture.set(31, 31, 1.0);
        let pyramid = Pyramid::new(picture, 4, 0.5);
        let level = &pyramid.levels()[3];
        let mass: f64 = level.data().iter().map(|&v| v as f64).sum();
        let mean = |f: &dyn Fn(f64) -> f64| {
            let moments = (0..8).flat_map(|y| (0..8).map(move |x| (x, y)));
            moments.map(|(x, y)| level.get(x, y) as f64 * f(x as f64 + 0.5)).sum::<f64>() / mass
        };
        let centre = mean(&|x| x);
        let variance = mean(&|x| (x - centre).powi(2));
        // (σ/8)² of the blurs, and 1/12 for a pixel's own width in the reduction and in its reading.
        assert!((variance - (0.25 + 1.0 / 12.0)).abs() < 0.06, "{variance}");
    }
}
