//! The areas of the union in the pixels of a row.
//!
//! The sums are stored as differences between neighbouring pixels, as in the accumulation buffer of Levien's font-rs. A side
//! adds the area to its right within each pixel, in closed form. All tiles of all instants add to the same differences, and a
//! row is summed once, so the cost is that of the sides and not that of the pixels between them. The differences are integers:
//! their order plays no part.

use super::slabs::{Side, Sink};
use std::ops::Range;

/// Areas of one row of a window, in steps.
pub struct Area {
    window: Range<i64>,
    /// Differences of the areas: one entry for each pixel of the window, and one for what lies beyond the last.
    changes: Vec<i32>,
    /// Whether any of them may differ from zero.
    touched: bool,
    /// The columns of the tile that are in the window.
    tile: Range<i64>,
    /// The sum of what the tile has added. Beyond the tile it is taken back.
    added: i32,
}

impl Area {
    /// For the columns of a window.
    pub fn new(window: Range<i64>) -> Self {
        let width = (window.end - window.start).max(0) as usize;
        Self { window, changes: vec![0; width + 1], touched: false, tile: 0..0, added: 0 }
    }

    /// Writes the areas times `unit`, and begins the next row.
    pub fn take(&mut self, unit: f64, row: &mut [f32]) {
        if !std::mem::take(&mut self.touched) {
            row.fill(0.0);
            return;
        }
        let mut sum = 0;
        let mut value = 0.0;
        for (value_at, change) in row.iter_mut().zip(&mut self.changes) {
            if *change != 0 {
                sum += std::mem::take(change);
                value = (f64::from(sum) * unit) as f32;
            }
            *value_at = value;
        }
        if let Some(last) = self.changes.last_mut() {
            *last = 0;
        }
    }

    /// Adds a change at a pixel of the tile, or at the one beyond it.
    fn change(&mut self, column: i64, by: i32) {
        self.changes[(column - self.window.start) as usize] += by;
        self.added += by;
    }
}

impl Sink for Area {
    fn begin(&mut self, columns: Range<i64>) -> bool {
        self.tile = columns.start.max(self.window.start)..columns.end.min(self.window.end);
        self.added = 0;
        !self.tile.is_empty()
    }

    fn inside(&mut self, top: i64, bottom: i64) {
        self.change(self.tile.start, (bottom - top) as i32);
    }

    fn side(&mut self, side: &Side, top: i64, bottom: i64, enters: bool) {
        self.add(side, (bottom - top) as i32, if enters { 1 } else { -1 });
    }

    fn end(&mut self) {
        self.changes[(self.tile.end - self.window.start) as usize] -= self.added;
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
            self.change(left, sign * height);
            return;
        }
        if first >= right {
            return;
        }
        if last - first <= 1 {
            let own = (tall * ((first + 1) as f64 - 0.5 * (low + high))).round() as i32;
            // A side in the column left of the tile was handled with `last` above.
            self.change(first, sign * own);
            self.change(first + 1, sign * (height - own));
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
            self.change(x, sign * (own - before));
            before = own;
        }
        if last < right {
            self.change(last, sign * (height - before));
        }
    }
}
