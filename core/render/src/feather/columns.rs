//! The blur of columns, row by row on the way down.
//!
//! Columns are taken in strips. A strip in which no row within the reach has changed, and whose sums have come to rest, stays
//! as it is. The closure that does the work is marked to be inlined: otherwise the compiler keeps one copy of it for all
//! processors, and the vector instructions are lost.

use super::bell::Bell;
use rototoon_base::numeric::vector::vectorised;

/// Steps of a value from 0 to 1.
const STEPS: f32 = (1 << 20) as f32;
/// Number of columns that are checked together for changes.
const STRIP: usize = 32;

/// A value for each column of a strip.
type Values<T> = [T; STRIP];

/// State of the columns of a strip.
#[derive(Clone)]
struct Strip {
    /// For each column the filtered differences, summed one to four times.
    sums: [Values<f64>; 4],
    /// The latest row.
    row: Values<f32>,
    /// For how many rows nothing has changed.
    quiet: usize,
    /// Whether all sums but the last are zero, so that the last one stays constant.
    still: bool,
}

impl Strip {
    fn new() -> Self {
        Self { sums: [[0.0; STRIP]; 4], row: [0.0; STRIP], quiet: usize::MAX, still: true }
    }

    /// Takes the next row. Returns whether it differs from the latest one, and by how much.
    #[inline(always)]
    fn take(&mut self, row: &Values<f32>, difference: &mut Values<f32>) -> bool {
        let bits = |value: &f32| value.to_bits();
        let changed = row.iter().zip(&self.row).fold(0, |all, (now, before)| all | (bits(now) ^ bits(before))) != 0;
        if changed {
            for k in 0..STRIP {
                difference[k] = row[k] - self.row[k];
            }
            self.row = *row;
            self.quiet = 0;
        } else {
            self.quiet = self.quiet.saturating_add(1);
        }
        changed
    }

    /// Sums the filtered differences, and shows the last sum.
    #[inline(always)]
    fn sum(&mut self, bell: &Bell, mut filtered: Values<f64>, shown: &mut Values<f32>) {
        // One sum after the other, each over all columns: so the compiler takes several columns at once.
        for sums in &mut self.sums {
            for k in 0..STRIP {
                filtered[k] += sums[k];
            }
            *sums = filtered;
        }
        for k in 0..STRIP {
            shown[k] = bell.rounded(filtered[k]) * (1.0 / STEPS);
        }
    }

    /// Whether the sums have come to rest.
    #[inline(always)]
    fn rests(&self) -> bool {
        let [once, twice, thrice, _] = &self.sums;
        // The bits but for the sign.
        let bits = |value: f64| value.to_bits() << 1;
        (0..STRIP).fold(0, |all, k| all | bits(once[k]) | bits(twice[k]) | bits(thrice[k])) == 0
    }
}

/// State of all columns.
pub struct Columns {
    strips: Vec<Strip>,
    /// The latest row of the result.
    shown: Vec<f32>,
    /// By how much each of the latest rows differs from the row before it, in each strip. A row keeps its place until it is
    /// beyond the reach.
    differences: Vec<Values<f32>>,
    /// Whether it differs at all.
    changed: Vec<bool>,
    /// Number of rows that are kept.
    depth: usize,
    /// For each tap of the bell the place of its row, and its weight.
    taps: Vec<(usize, f64)>,
    /// Number of rows so far.
    count: usize,
}

impl Columns {
    /// For a number of columns.
    pub fn new(bell: &Bell, width: usize) -> Self {
        let (strips, depth) = (width.div_ceil(STRIP), bell.last + 4);
        Self {
            strips: vec![Strip::new(); strips],
            shown: vec![0.0; strips * STRIP],
            differences: vec![[0.0; STRIP]; strips * depth],
            changed: vec![false; strips * depth],
            depth,
            taps: Vec::new(),
            count: 0,
        }
    }

    /// Width of the rows that [`Self::next`] takes: that of the picture, rounded up to whole strips.
    pub fn padded(&self) -> usize {
        self.strips.len() * STRIP
    }

    /// The latest row of the result.
    pub fn shown(&self) -> &[f32] {
        &self.shown
    }

    /// Takes the next row, in steps.
    pub fn next(&mut self, bell: &Bell, row: &[f32]) {
        let (count, depth) = (self.strips.len(), self.depth);
        let place = self.count % depth;
        self.taps.clear();
        self.taps.extend(bell.taps.iter().map(|&(back, weight)| ((place + depth - back) % depth * count, weight)));
        self.count += 1;
        let ((rows, _), (shown, _)) = (row.as_chunks::<STRIP>(), self.shown.as_chunks_mut::<STRIP>());
        vectorised(
            #[inline(always)]
            || {
                for (index, ((strip, row), shown)) in self.strips.iter_mut().zip(rows).zip(shown).enumerate() {
                    let at = place * count + index;
                    self.changed[at] = strip.take(row, &mut self.differences[at]);
                    if strip.quiet < depth {
                        let mut filtered = [0.0; STRIP];
                        for &(first, weight) in &self.taps {
                            if self.changed[first + index] {
                                let difference = &self.differences[first + index];
                                for k in 0..STRIP {
                                    filtered[k] = f64::from(difference[k]).mul_add(weight, filtered[k]);
                                }
                            }
                        }
                        strip.sum(bell, filtered, shown);
                        strip.still = false;
                    } else if !strip.still {
                        strip.still = strip.rests();
                        if !strip.still {
                            strip.sum(bell, [0.0; STRIP], shown);
                        }
                    }
                }
            },
        );
    }
}
