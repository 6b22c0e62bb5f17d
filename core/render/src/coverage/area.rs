//! The areas of the union in the pixels of a row.
//!
//! The sums are stored as differences between neighbouring pixels, as in the accumulation buffer of Levien's font-rs. A side
//! adds the area to its right within each pixel, in closed form. All tiles of all instants add to the same differences, and a
//! row is summed once, so the cost is that of the sides and not that of the pixels between them. The differences are integers:
//! their order plays no part. A bit for each pixel tells which differences were changed, so that the others are not read.

use super::slabs::{Side, Sink};
use std::ops::Range;

/// Pixels whose bits are in one word.
const WORD: usize = u64::BITS as usize;

/// Areas of one row of a window, in steps.
pub struct Area {
    window: Range<i64>,
    /// Differences of the areas: one entry for each pixel of the window, and one for what lies beyond the last.
    changes: Vec<i32>,
    /// Which of them may differ from zero.
    touched: Vec<u64>,
    /// The columns of the tile that are in the window.
    tile: Range<i64>,
    /// The sum of what the tile has added. Beyond the tile it is taken back.
    added: i32,
}

impl Area {
    /// For the columns of a window.
    pub fn new(window: Range<i64>) -> Self {
        let width = (window.end - window.start).max(0) as usize;
        Self { window, changes: vec![0; width + 1], touched: vec![0; width / WORD + 1], tile: 0..0, added: 0 }
    }

    /// Calls `each` with the columns at which the area changes, from left to right, and with the area times `unit` from
    /// there on. Left of the first the area is 0. Begins the next row.
    pub fn take(&mut self, unit: f64, each: &mut impl FnMut(usize, f32)) {
        let width = self.changes.len() - 1;
        let mut sum = 0;
        for (word, bits) in self.touched.iter_mut().enumerate() {
            let mut bits = std::mem::take(bits);
            while bits != 0 {
                let column = word * WORD + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let change = std::mem::take(&mut self.changes[column]);
                if change != 0 && column < width {
                    sum += change;
                    each(column, (f64::from(sum) * unit) as f32);
                }
            }
        }
    }

    /// Adds a change at a pixel of the tile, or at the one beyond it.
    #[inline]
    fn change(&mut self, column: i64, by: i32) {
        let column = (column - self.window.start) as usize;
        self.changes[column] += by;
        self.touched[column / WORD] |= 1 << (column % WORD);
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

    #[inline]
    fn side(&mut self, side: &Side, top: i64, bottom: i64, enters: bool) {
        self.add(side, (bottom - top) as i32, if enters { 1 } else { -1 });
    }

    fn end(&mut self) {
        let added = self.added;
        self.change(self.tile.end, -added);
    }
}

impl Area {
    /// Adds (or subtracts) the area to the right of a side.
    #[inline]
    fn add(&mut self, side: &Side, height: i32, sign: i32) {
        let (low, high) = if side.above < side.below { (side.above, side.below) } else { (side.below, side.above) };
        let first = floor(low);
        let last = ceil(high);
        let (left, right, tall) = (self.tile.start, self.tile.end, f64::from(height));
        if last <= left {
            self.change(left, sign * height);
            return;
        }
        if first >= right {
            return;
        }
        if last - first <= 1 {
            let own = rounded(tall * ((first + 1) as f64 - 0.5 * (low + high)));
            // A side in the column left of the tile was handled with `last` above.
            self.change(first, sign * own);
            self.change(first + 1, sign * (height - own));
            return;
        }
        // The area to the left of `x` and right of the side. Its differences are the areas within pixels.
        let (width, middle) = (high - low, 0.5 * (low + high));
        let steep = tall / (2.0 * width);
        let until = |x: f64| {
            if x <= low {
                0.0
            } else if x >= high {
                tall * (x - middle)
            } else {
                steep * (x - low) * (x - low)
            }
        };
        let (mut before, from) = (0, first.max(left));
        let mut reached = until(from as f64);
        for x in from..last.min(right) {
            let next = until((x + 1) as f64);
            let own = rounded(next - reached);
            reached = next;
            self.change(x, sign * (own - before));
            before = own;
        }
        if last < right {
            self.change(last, sign * (height - before));
        }
    }
}

/// The greatest integer that is not above a number. The library's function is slow without newer instructions.
#[inline]
fn floor(x: f64) -> i64 {
    let near = x as i64;
    near - i64::from(near as f64 > x)
}

/// The least integer that is not below a number.
#[inline]
fn ceil(x: f64) -> i64 {
    let near = x as i64;
    near + i64::from((near as f64) < x)
}

/// The integer nearest to an area, which is not negative.
#[inline]
fn rounded(area: f64) -> i32 {
    (area + 0.5) as i32
}
