//! The areas of the union in the pixels of a row.
//!
//! The sums are stored as differences between neighbouring pixels, as in the accumulation buffer of Levien's font-rs. A side
//! adds the area to its right within each pixel, in closed form. All tiles of all instants add to the same differences, and a
//! row is summed once, so the cost is that of the sides and not that of the pixels between them. The differences are integers:
//! their order plays no part. A bit for each pixel tells which differences were changed, so that the others are not read.
//!
//! Most rows are one tile that is as wide as the window. Their sides wait in a [`Batch`] until the row is taken, so that the
//! processor measures several at once.

use super::batch::{Batch, Measured};
use super::slabs::{Side, Sink};
use std::ops::Range;

/// Pixels whose bits are in one word.
const WORD: usize = u64::BITS as usize;
/// Columns beyond this are not batched.
const FAR: i64 = 1 << 29;

/// Areas of one row of a window, in steps.
pub struct Area {
    window: Range<i64>,
    sums: Sums,
    /// Whether the sides of tiles that are as wide as the window are batched.
    batches: bool,
    /// The sides of such tiles.
    batch: Batch,
    /// The columns of the tile that are in the window.
    tile: Range<i64>,
    /// Whether the tile is one of them.
    whole: bool,
    /// The sum of what the tile has added. Beyond the tile it is taken back.
    added: i32,
}

/// Differences of the areas.
struct Sums {
    /// The column of the first.
    start: i64,
    /// One entry for each pixel of the window, and one for what lies beyond the last.
    changes: Vec<i32>,
    /// Which of them may differ from zero.
    touched: Vec<u64>,
}

impl Sums {
    /// Adds a change at a column of the window, or at the one beyond it.
    #[inline]
    fn change(&mut self, column: i64, by: i32) {
        let column = (column - self.start) as usize;
        self.changes[column] += by;
        self.touched[column / WORD] |= 1 << (column % WORD);
    }
}

impl Area {
    /// For the columns of a window.
    pub fn new(window: Range<i64>) -> Self {
        let width = (window.end - window.start).max(0) as usize;
        let sums = Sums { start: window.start, changes: vec![0; width + 1], touched: vec![0; width / WORD + 1] };
        let batches = -FAR < window.start && window.end < FAR;
        Self { window, sums, batches, batch: Batch::default(), tile: 0..0, whole: false, added: 0 }
    }

    /// Calls `each` with the columns at which the area changes, from left to right, and with the area times `unit` from
    /// there on. Left of the first the area is 0. Begins the next row.
    pub fn take(&mut self, unit: f64, each: &mut impl FnMut(usize, f32)) {
        self.add_batch();
        let Sums { changes, touched, .. } = &mut self.sums;
        let width = changes.len() - 1;
        let mut sum = 0;
        for (word, bits) in touched.iter_mut().enumerate() {
            let mut bits = std::mem::take(bits);
            while bits != 0 {
                let column = word * WORD + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let change = std::mem::take(&mut changes[column]);
                if change != 0 && column < width {
                    sum += change;
                    each(column, (f64::from(sum) * unit) as f32);
                }
            }
        }
    }

    /// Adds the sides that wait.
    fn add_batch(&mut self) {
        let Self { window, sums, batch, .. } = self;
        let (left, right) = (window.start, window.end);
        batch.drain(|side| {
            let Measured { first, last, height, own, .. } = *side;
            if last <= left {
                sums.change(left, height);
            } else if first >= right {
            } else if last - first <= 1 {
                sums.change(first, own);
                sums.change(first + 1, height - own);
            } else {
                wide(side, left..right, |column, by| sums.change(column, by));
            }
        });
    }

    /// Adds a change at a pixel of the tile, or at the one beyond it.
    #[inline]
    fn change(&mut self, column: i64, by: i32) {
        self.sums.change(column, by);
        self.added += by;
    }
}

impl Sink for Area {
    fn begin(&mut self, columns: Range<i64>) -> bool {
        self.tile = columns.start.max(self.window.start)..columns.end.min(self.window.end);
        self.whole = self.batches && self.tile == self.window;
        self.added = 0;
        !self.tile.is_empty()
    }

    fn inside(&mut self, top: i64, bottom: i64) {
        self.change(self.tile.start, (bottom - top) as i32);
    }

    #[inline]
    fn side(&mut self, side: &Side, top: i64, bottom: i64, enters: bool) {
        let height = (bottom - top) as i32;
        let height = if enters { height } else { -height };
        if self.whole {
            self.batch.push(side.above, side.below, height);
        } else {
            self.add(side, height);
        }
    }

    fn end(&mut self) {
        let added = self.added;
        self.change(self.tile.end, -added);
    }
}

impl Area {
    /// Adds the area to the right of a side within the tile. It is negative where the union ends.
    fn add(&mut self, side: &Side, height: i32) {
        let (left, right) = (self.tile.start, self.tile.end);
        let side = Measured::new(side.above, side.below, height);
        let Measured { first, last, own, .. } = side;
        if last <= left {
            self.change(left, height);
        } else if first >= right {
        } else if last - first <= 1 {
            // A side in the column left of the tile was handled with `last` above.
            self.change(first, own);
            self.change(first + 1, height - own);
        } else {
            wide(&side, left..right, |column, by| self.change(column, by));
        }
    }
}

/// Calls `change` with the differences of the area right of a side that is wider than a pixel, within columns.
#[inline]
fn wide(side: &Measured, columns: Range<i64>, mut change: impl FnMut(i64, i32)) {
    let Measured { first, last, height, low, high, .. } = *side;
    let (tall, sign, middle) = (f64::from(height.abs()), height.signum(), 0.5 * (low + high));
    // The area to the left of `x` and right of the side is this times the square of the distance.
    let steep = tall / (2.0 * (high - low));
    let until = |x: i64| steep * (x as f64 - low) * (x as f64 - low);
    let from = first.max(columns.start);
    // The differences are the areas within pixels.
    let (mut before, mut reached) = (0, if from > first { until(from) } else { 0.0 });
    for x in from..(last - 1).min(columns.end) {
        let next = until(x + 1);
        let own = rounded(next - reached);
        reached = next;
        change(x, sign * (own - before));
        before = own;
    }
    if last <= columns.end {
        let own = rounded(tall * (last as f64 - middle) - reached);
        change(last - 1, sign * (own - before));
        before = own;
    }
    if last < columns.end {
        change(last, sign * (tall as i32 - before));
    }
}

/// The integer nearest to an area, which is not negative.
#[inline]
fn rounded(area: f64) -> i32 {
    (area + 0.5) as i32
}
