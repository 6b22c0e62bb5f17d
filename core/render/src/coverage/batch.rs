//! Sides of a row, measured several at once.
//!
//! Where a side begins and ends, and the area to its right within its column, are the same few operations for each side and
//! need no branches. Coordinates that are too large for 32 bits are cut: they lie beyond any window that is batched.

use rototoon_base::numeric::vector::vectorised;

/// Coordinates are cut to this.
const MOST: f64 = (1 << 30) as f64;

/// A side in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Its least x.
    pub low: f64,
    /// Its greatest x.
    pub high: f64,
    /// The column of the least x.
    pub first: i64,
    /// The column after the greatest x, or the column that begins there.
    pub last: i64,
    /// Its height in steps; negative if the union ends there.
    pub height: i32,
    /// The area to its right in the first column, with the sign of the height. It counts only for a side in a single column.
    pub own: i32,
}

impl Measured {
    /// A side from x at its top to x at its bottom.
    pub fn new(above: f64, below: f64, height: i32) -> Self {
        let (low, high) = if above < below { (above, below) } else { (below, above) };
        let (first, last) = (floor(low), ceil(high));
        let mut own = 0;
        if last - first <= 1 {
            let area = (f64::from(height.abs()) * ((first + 1) as f64 - 0.5 * (low + high)) + 0.5) as i32;
            own = if height < 0 { -area } else { area };
        }
        Self { low, high, first, last, height, own }
    }
}

/// Sides that wait, as columns of numbers.
#[derive(Default)]
pub struct Batch {
    count: usize,
    above: Vec<f64>,
    below: Vec<f64>,
    height: Vec<i32>,
    first: Vec<i32>,
    last: Vec<i32>,
    own: Vec<i32>,
}

impl Batch {
    /// Adds a side from x at its top to x at its bottom.
    #[inline]
    pub fn push(&mut self, above: f64, below: f64, height: i32) {
        if self.count == self.above.len() {
            self.grow();
        }
        self.above[self.count] = above;
        self.below[self.count] = below;
        self.height[self.count] = height;
        self.count += 1;
    }

    #[cold]
    fn grow(&mut self) {
        let length = (2 * self.count).max(64);
        self.above.resize(length, 0.0);
        self.below.resize(length, 0.0);
        for list in [&mut self.height, &mut self.first, &mut self.last, &mut self.own] {
            list.resize(length, 0);
        }
    }

    /// Measures all sides, calls `each` with them in their order, and removes them.
    pub fn drain(&mut self, mut each: impl FnMut(&Measured)) {
        let count = std::mem::take(&mut self.count);
        let (above, below, height) = (&self.above[..count], &self.below[..count], &self.height[..count]);
        let (first, last, own) = (&mut self.first[..count], &mut self.last[..count], &mut self.own[..count]);
        vectorised(
            #[inline(always)]
            || {
                for k in 0..count {
                    let (low, high) = (above[k].min(below[k]), above[k].max(below[k]));
                    let (start, end) = (low.floor().clamp(-MOST, MOST), high.ceil().clamp(-MOST, MOST));
                    (first[k], last[k]) = (integer(start), integer(end));
                    let share = (start + 1.0) - 0.5 * (low + high);
                    let area = integer((f64::from(height[k].abs()) * share + 0.5).floor());
                    own[k] = if height[k] < 0 { area.wrapping_neg() } else { area };
                }
            },
        );
        for k in 0..count {
            let (low, high) = if above[k] < below[k] { (above[k], below[k]) } else { (below[k], above[k]) };
            let (first, last) = (i64::from(first[k]), i64::from(last[k]));
            each(&Measured { low, high, first, last, height: height[k], own: own[k] });
        }
    }
}

/// A whole number of at most 31 bits as an integer. A float this large has no bits below one, so the lowest bits of the sum
/// are the number. The language's own conversion checks for numbers of more bits, and that is not done for several at once.
#[inline(always)]
fn integer(x: f64) -> i32 {
    const WHOLE: f64 = 3.0 * (1u64 << 51) as f64;
    (x + WHOLE).to_bits() as i32
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = f64> {
        prop_oneof![-40.0..40.0, (-80i32..80).prop_map(|k| f64::from(k) / 4.0), Just(1e12), Just(-1e12)]
    }

    proptest! {
        #[test]
        fn a_batch_measures_as_one_side_alone(
            sides in proptest::collection::vec((place(), place(), 1i32..1 << 24, any::<bool>()), 0..200)
        ) {
            let mut batch = Batch::default();
            for _ in 0..2 {
                for &(above, below, height, enters) in &sides {
                    batch.push(above, below, if enters { height } else { -height });
                }
                let mut found = Vec::new();
                batch.drain(|side| found.push(*side));
                prop_assert_eq!(found.len(), sides.len());
                for (found, &(above, below, height, enters)) in found.iter().zip(&sides) {
                    let alone = Measured::new(above, below, if enters { height } else { -height });
                    let cut = |column: i64| column.clamp(-(1 << 30), 1 << 30);
                    prop_assert_eq!((found.first, found.last), (cut(alone.first), cut(alone.last)));
                    prop_assert_eq!((found.low, found.high, found.height), (alone.low, alone.high, alone.height));
                    if alone.last - alone.first <= 1 && alone.first.abs() < 1 << 29 {
                        prop_assert_eq!(found.own, alone.own);
                    }
                }
            }
        }
    }
}
