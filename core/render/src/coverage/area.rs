//! The areas of the union in the pixels of a row.
//!
//! The sums are stored as differences between neighbouring pixels of a tile, as in the accumulation buffer of Levien's
//! font-rs. A side adds the area to its right within each pixel, in closed form.

use super::slabs::{Side, Sink};
use std::ops::Range;

/// Areas of one row of a window, in steps.
pub struct Area {
    window: Range<i64>,
    /// One entry for each pixel of the window.
    pub sums: Vec<i32>,
    /// Whether any sum may differ from zero.
    pub touched: bool,
    /// The columns of the tile that are in the window.
    tile: Range<i64>,
    /// One entry for each pixel of the tile, and one for the area beyond the last.
    delta: Vec<i32>,
}

impl Area {
    /// For the columns of a window.
    pub fn new(window: Range<i64>) -> Self {
        let width = (window.end - window.start).max(0) as usize;
        Self { window, sums: vec![0; width], touched: false, tile: 0..0, delta: Vec::with_capacity(width + 1) }
    }
}

impl Sink for Area {
    fn begin(&mut self, columns: Range<i64>) -> bool {
        self.tile = columns.start.max(self.window.start)..columns.end.min(self.window.end);
        if self.tile.is_empty() {
            return false;
        }
        self.delta.clear();
        self.delta.resize((self.tile.end - self.tile.start) as usize + 1, 0);
        true
    }

    fn inside(&mut self, top: i64, bottom: i64) {
        self.delta[0] += (bottom - top) as i32;
    }

    fn side(&mut self, side: &Side, top: i64, bottom: i64, enters: bool) {
        self.add(side, (bottom - top) as i32, if enters { 1 } else { -1 });
    }

    fn end(&mut self) {
        let start = (self.tile.start - self.window.start) as usize;
        let mut sum = 0;
        for (total, change) in self.sums[start..].iter_mut().zip(&self.delta[..self.delta.len() - 1]) {
            sum += change;
            *total += sum;
        }
        self.touched = true;
    }
}

impl Area {
    /// Adds (or subtracts) the area to the right of a side.
    fn add(&mut self, side: &Side, height: i32, sign: i32) {
        let (low, high) = if side.above < side.below { (side.above, side.below) } else { (side.below, side.above) };
        let (first, last) = (low.floor() as i64, high.ceil() as i64);
        let (left, right, tall) = (self.tile.start, self.tile.end, f64::from(height));
        if last <= left {
            self.delta[0] += sign * height;
            return;
        }
        if first >= right {
            return;
        }
        if last - first <= 1 {
            let own = (tall * ((first + 1) as f64 - 0.5 * (low + high))).round() as i32;
            // A side in the column left of the tile was handled with `last` above.
            let at = (first - left) as usize;
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
        for x in first.max(left)..last.min(right) {
            let own = (until((x + 1) as f64) - until(x as f64)).round() as i32;
            self.delta[(x - left) as usize] += sign * (own - before);
            before = own;
        }
        if last < right {
            self.delta[(last - left) as usize] += sign * (height - before);
        }
    }
}
