//! The grid on which pictures are compared, and the directions of their edges on it.
//!
//! The grid belongs to the new picture: a place p of it is at p / `step`. The old picture is drawn onto it by the placement. With g the gradient of
//! the smoothed luma, a place has the direction
//!
//! ```text
//! n = g / √(|g|² + κ²),   κ = 0.03
//! ```
//!
//! So a line counts the same however dark a grade makes it, and grain far below κ does not count.

use rototoon_base::geometry::Point;
use rototoon_base::scene::conform::Placement;
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::colour::luma_picture;
use rototoon_image::gaussian::{Border, blur};
use rototoon_image::resize::reduce;
use rototoon_image::sample::read;

/// Change of brightness over two places of the grid at which a direction has 0.7 of its length.
const KAPPA: f32 = 0.03;
/// Standard deviation of the blur before gradients are taken, in places of the grid.
const SMOOTHING: f64 = 0.7;

/// The grid of comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Pixels of the new picture for each place.
    pub step: f64,
}

impl Grid {
    /// The grid with about this many places over a picture of `width` × `height` pixels, and never finer than its pixels.
    pub fn of(width: usize, height: usize, places: f64) -> Self {
        let step = ((width * height) as f64 / places).sqrt().max(1.0);
        let len = |side: usize| ((side as f64 / step - 1e-9).ceil() as usize).max(1);
        Self { width: len(width), height: len(height), step }
    }

    /// The luma of the new picture on the grid.
    pub fn of_new(&self, picture: &Raster<Colour>) -> Raster<f32> {
        reduce(&luma_picture(picture), self.step)
    }

    /// The luma of the old picture on the grid, where the placement puts it. Beyond its border, its border is repeated.
    pub fn of_old(&self, picture: &Raster<Colour>, placement: &Placement) -> Raster<f32> {
        let factor = (self.step / placement.scale).max(1.0);
        let reduced = reduce(&luma_picture(picture), factor);
        Raster::from_fn(self.width, self.height, |x, y| {
            let at = Point::new(x as f64 + 0.5, y as f64 + 0.5) * self.step;
            read(&reduced, placement.old_place(at) / factor)
        })
    }

    /// The number of places that a picture of this size takes at a scale.
    pub fn places_of(&self, size: [usize; 2], scale: f64) -> f64 {
        size.iter().map(|&side| side as f64 * scale / self.step).product()
    }

    /// The luma of the complete old picture at a scale, with its corner in that of the result.
    pub fn of_old_alone(&self, picture: &Raster<Colour>, scale: f64) -> Raster<f32> {
        let len = |side: usize| ((side as f64 * scale / self.step).round() as usize).max(1);
        let own = Self { width: len(picture.width()), height: len(picture.height()), step: self.step };
        own.of_old(picture, &Placement { scale, shift: Point::ZERO })
    }

    /// The columns and rows of the grid that an old picture of this size covers, less a margin that smoothing reaches: first and one past the last.
    pub fn covered(&self, old: [usize; 2], placement: &Placement) -> [std::ops::Range<usize>; 2] {
        const MARGIN: f64 = 2.0;
        let sides = [(placement.shift.x, old[0], self.width), (placement.shift.y, old[1], self.height)];
        sides.map(|(shift, side, len)| {
            let from = (shift / self.step).max(0.0);
            let to = ((shift + placement.scale * side as f64) / self.step).min(len as f64);
            // Where the pictures end together, both repeat their borders.
            let from = if shift.abs() < self.step { 0.0 } else { (from + MARGIN).ceil() };
            let to = if to > len as f64 - 1.0 { len as f64 } else { (to - MARGIN).floor() };
            (from as usize).min(len)..(to.max(from) as usize).min(len)
        })
    }
}

/// The direction at each place.
pub fn directions(luma: &Raster<f32>) -> Raster<[f32; 2]> {
    let smooth = blur(luma, SMOOTHING, Border::Replicate);
    Raster::from_fn(smooth.width(), smooth.height(), |x, y| {
        let (x, y) = (x as isize, y as isize);
        let gx = smooth.clamped(x + 1, y) - smooth.clamped(x - 1, y);
        let gy = smooth.clamped(x, y + 1) - smooth.clamped(x, y - 1);
        let length = (gx * gx + gy * gy + KAPPA * KAPPA).sqrt();
        [gx / length, gy / length]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dark disc on light paper, at a place and with a radius in pixels.
    fn disc(width: usize, height: usize, at: Point, radius: f64, [dark, light]: [f32; 2]) -> Raster<Colour> {
        Raster::from_fn(width, height, |x, y| {
            let distance = Point::new(x as f64 + 0.5, y as f64 + 0.5).distance(at) - radius;
            [dark + (light - dark) * (distance + 0.5).clamp(0.0, 1.0) as f32; 3]
        })
    }

    fn difference(a: &Raster<[f32; 2]>, b: &Raster<[f32; 2]>) -> f32 {
        let sum = |(a, b): (&[f32; 2], &[f32; 2])| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
        a.data().iter().zip(b.data()).map(sum).sum()
    }

    #[test]
    fn an_old_picture_lies_where_its_placement_says() {
        let old = disc(96, 72, Point::new(40.0, 30.0), 12.0, [0.1, 0.9]);
        let new = disc(240, 200, Point::new(104.0, 85.0), 24.0, [0.1, 0.9]);
        let placement = Placement { scale: 2.0, shift: Point::new(24.0, 25.0) };
        let grid = Grid::of(240, 200, 3000.0);
        let own = directions(&grid.of_new(&new));
        let total: f32 = own.data().iter().map(|n| n[0] * n[0] + n[1] * n[1]).sum();
        let placed = difference(&own, &directions(&grid.of_old(&old, &placement)));
        let beside = Placement { shift: Point::new(34.0, 25.0), ..placement };
        let wrong = difference(&own, &directions(&grid.of_old(&old, &beside)));
        assert!(placed < 0.02 * total && wrong > 0.5 * total, "{placed} and {wrong} of {total}");
    }

    #[test]
    fn a_grade_changes_directions_little() {
        let grid = Grid::of(96, 72, 2000.0);
        let look = |tones| directions(&grid.of_new(&disc(96, 72, Point::new(40.0, 30.0), 12.0, tones)));
        let (own, graded) = (look([0.1, 0.9]), look([0.3, 0.8]));
        let total: f32 = own.data().iter().map(|n| n[0] * n[0] + n[1] * n[1]).sum();
        assert!(difference(&own, &graded) < 0.02 * total);
    }

    #[test]
    fn only_what_both_pictures_show_is_covered() {
        let grid = Grid { width: 120, height: 100, step: 2.0 };
        let placement = Placement { scale: 2.0, shift: Point::new(24.0, 0.0) };
        assert_eq!(grid.covered([96, 100], &placement), [14..106, 0..100]);
        assert_eq!(grid.covered([96, 100], &Placement { scale: 2.0, shift: Point::new(500.0, 0.0) })[0].len(), 0);
    }

    #[test]
    fn a_small_picture_is_compared_at_its_own_pixels() {
        assert_eq!(Grid::of(96, 72, 57_600.0), Grid { width: 96, height: 72, step: 1.0 });
    }
}
