//! Distances of pixels to segments where they decide something.
//!
//! A border that is moved by 200 pixels depends only on the distances of the pixels near the moved border. Elsewhere it is
//! enough to know that the distance is clearly smaller or clearly larger. So a window is divided into quarters, again and
//! again. For each tile the distances of its middle give a least and a greatest distance of its pixels. If all distances
//! between the two give the same picture, the tile is done. Otherwise its quarters continue with those segments that may be
//! the nearest one. Only in tiles of a few pixels are single distances computed.
//!
//! The cost grows with the length of the border and hardly with the distance. Each distance that is used is the exact least
//! one, so the picture depends neither on the tiles nor on the window.

use super::coverage::Window;
use super::line::Stretch;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;

/// Side of the smallest tiles in pixels.
const LEAST: i64 = 4;
/// Side of the tiles at which `go_on` is called.
const ASKED: i64 = 64;
/// Distances are rounded to 32-bit floats, so bounds are widened by this share and by this much.
const ROUNDING: f64 = 1e-6;

/// Squared distances of the pixels of a window to the nearest stretch. `same(least, greatest)` says whether all distances
/// between two lead to the same result; pixels for which they do get any distance between them. `None` if `go_on`, called
/// for each tile of [`ASKED`] pixels, returns false.
pub(super) fn squared_distances(
    stretches: &[Stretch],
    window: Window,
    same: &dyn Fn(f64, f64) -> bool,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Raster<f32>> {
    let mut result = Raster::new(window.width(), window.height(), f32::INFINITY);
    if stretches.is_empty() {
        return Some(result);
    }
    let all: Vec<u32> = (0..stretches.len() as u32).collect();
    let mut search = Search { stretches, window, same, go_on, result: &mut result };
    let side = (window.width().max(window.height()) as u64).next_power_of_two() as i64;
    search.tile(Window { right: window.left + side, bottom: window.top + side, ..window }, &all)?;
    Some(result)
}

struct Search<'a> {
    stretches: &'a [Stretch],
    window: Window,
    same: &'a dyn Fn(f64, f64) -> bool,
    go_on: &'a mut dyn FnMut() -> bool,
    result: &'a mut Raster<f32>,
}

impl Search<'_> {
    /// Computes a square tile. `near` are the stretches of which one is the nearest for each of its pixels.
    fn tile(&mut self, tile: Window, near: &[u32]) -> Option<()> {
        let shown =
            Window { right: tile.right.min(self.window.right), bottom: tile.bottom.min(self.window.bottom), ..tile };
        if shown.left >= shown.right || shown.top >= shown.bottom {
            return Some(());
        }
        let side = tile.right - tile.left;
        if side == ASKED && !(self.go_on)() {
            return None;
        }
        let middle = Point::new((shown.left + shown.right) as f64, (shown.top + shown.bottom) as f64) * 0.5;
        // From the middle to the centre of a corner's pixel.
        let radius = 0.5 * Point::new((shown.width() - 1) as f64, (shown.height() - 1) as f64).length();
        let squared: Vec<f64> = near.iter().map(|&k| self.stretches[k as usize].distance_squared(middle)).collect();
        let nearest = squared.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
        let slack = ROUNDING * (1.0 + nearest + radius);
        let (least, greatest) = ((nearest - radius - slack).max(0.0), nearest + radius + slack);
        if (self.same)(least, greatest) {
            self.fill(shown, (nearest * nearest) as f32);
            return Some(());
        }
        let reach = (greatest + radius) * (greatest + radius);
        let kept: Vec<u32> = near.iter().zip(&squared).filter(|(_, d)| **d <= reach).map(|(&k, _)| k).collect();
        if side <= LEAST {
            self.each(shown, &kept);
            return Some(());
        }
        let half = side / 2;
        for (x, y) in [(0, 0), (half, 0), (0, half), (half, half)] {
            let (left, top) = (tile.left + x, tile.top + y);
            self.tile(Window { left, top, right: left + half, bottom: top + half }, &kept)?;
        }
        Some(())
    }

    fn fill(&mut self, tile: Window, value: f32) {
        let columns = (tile.left - self.window.left) as usize..(tile.right - self.window.left) as usize;
        for y in tile.top..tile.bottom {
            self.result.row_mut((y - self.window.top) as usize)[columns.clone()].fill(value);
        }
    }

    /// The exact distance of each pixel of a tile.
    fn each(&mut self, tile: Window, near: &[u32]) {
        for y in tile.top..tile.bottom {
            let row = self.result.row_mut((y - self.window.top) as usize);
            for x in tile.left..tile.right {
                let centre = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                let distances = near.iter().map(|&k| self.stretches[k as usize].distance_squared(centre));
                row[(x - self.window.left) as usize] = distances.fold(f64::INFINITY, f64::min) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn stretch(a: (f64, f64), b: (f64, f64)) -> Stretch {
        Stretch { ends: [Point::new(a.0, a.1), Point::new(b.0, b.1)], from: 0.0, to: 1.0 }
    }

    proptest! {
        #[test]
        fn distances_that_decide_are_exact(
            ends in prop::collection::vec(((-30.0..90.0, -30.0..90.0), (-30.0..90.0, -30.0..90.0)), 1..12),
            amount in 0.0f64..40.0, left in -9i64..9, width in 1i64..50
        ) {
            let stretches: Vec<Stretch> = ends.iter().map(|&(a, b)| stretch(a, b)).collect();
            let window = Window { left, top: -3, right: left + width, bottom: 37 };
            let same = |least: f64, greatest: f64| 0.5 + amount - least < -1e-3 || 0.5 + amount - greatest > 1.001;
            let found = squared_distances(&stretches, window, &same, &mut || true).unwrap();
            for y in 0..window.height() {
                for x in 0..window.width() {
                    let centre = Point::new((window.left + x as i64) as f64 + 0.5, y as f64 - 2.5);
                    let exact = stretches.iter().map(|s| s.distance_squared(centre)).fold(f64::INFINITY, f64::min) as f32;
                    let picture = |squared: f32| (0.5 + amount as f32 - squared.sqrt()).clamp(0.0, 1.0);
                    prop_assert_eq!(picture(found.get(x, y)), picture(exact), "{} {}", x, y);
                }
            }
        }
    }

    #[test]
    fn it_ends_when_told_and_without_stretches_all_is_far() {
        let window = Window { left: 0, top: 0, right: 100, bottom: 80 };
        let one = [stretch((3.0, 4.0), (50.0, 60.0))];
        assert_eq!(squared_distances(&one, window, &|_, _| false, &mut || false), None);
        let none = squared_distances(&[], window, &|_, _| false, &mut || true).unwrap();
        assert!(none.data().iter().all(|d| d.is_infinite()));
    }
}
