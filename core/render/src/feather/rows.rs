//! The blur of one row.

use super::Change;
use super::bell::{Bell, GROUP};
use rototoon_base::numeric::vector::vectorised;
use std::ops::Range;

/// Steps of a value from 0 to 1.
const STEPS: f32 = (1 << 20) as f32;
/// Changes this close are filtered together.
const CLOSE: usize = 16;

/// A value of at least 0 as an integer number of steps. Truncation is faster than rounding and gives the same result.
#[inline(always)]
fn in_steps(value: f32) -> f32 {
    (value * STEPS + 0.5) as i32 as f32
}

/// Buffers for one row.
pub struct Line {
    /// Neighbouring changes, the first at column `start`.
    block: Vec<f64>,
    /// The same between zeros.
    padded: Vec<f64>,
    start: usize,
    /// The differences of the row, filtered with the taps.
    filtered: Vec<f64>,
    /// The ranges in which they may differ from zero.
    stretches: Vec<Range<usize>>,
}

impl Line {
    /// For rows of a width.
    pub fn new(bell: &Bell, width: usize) -> Self {
        Self {
            block: Vec::new(),
            padded: Vec::new(),
            start: 0,
            filtered: vec![0.0; width + bell.last + 4 + GROUP],
            stretches: Vec::new(),
        }
    }

    /// Blurs a row given by its changes. The result is in steps, and narrower by twice the reach.
    pub fn blur(&mut self, bell: &Bell, changes: &[Change], to: &mut [f32]) {
        vectorised(
            #[inline(always)]
            || self.find(bell, changes),
        );
        let mut sums = [0.0; 4];
        let mut done = 0;
        for stretch in &self.stretches {
            let start = stretch.start.saturating_sub(bell.last).min(to.len());
            // Without changes the row stays constant.
            to[done.min(start)..start].fill(bell.rounded(sums[3]));
            let end = stretch.end.saturating_sub(bell.last).min(to.len());
            for value in &mut self.filtered[stretch.clone()] {
                *value = summed(&mut sums, *value);
            }
            let whole = &mut self.filtered[stretch.clone()];
            let from = (start + bell.last).max(stretch.start) - stretch.start;
            for (to, sum) in to[start..end].iter_mut().zip(&whole[from..]) {
                *to = bell.rounded(*sum);
            }
            whole.fill(0.0);
            done = end;
        }
        to[done..].fill(bell.rounded(sums[3]));
    }

    /// Filters the differences of a row.
    #[inline(always)]
    fn find(&mut self, bell: &Bell, changes: &[Change]) {
        self.stretches.clear();
        self.block.clear();
        let mut before = 0.0;
        for &(column, value) in changes {
            let step = in_steps(value);
            let change = f64::from(step - before);
            before = step;
            if column >= self.start + self.block.len() + CLOSE {
                self.filter(bell);
            }
            if self.block.is_empty() {
                self.start = column;
            }
            self.block.resize(column - self.start, 0.0);
            self.block.push(change);
        }
        self.filter(bell);
    }

    /// Filters the block of changes, and begins the next one.
    #[inline(always)]
    fn filter(&mut self, bell: &Bell) {
        if self.block.is_empty() {
            return;
        }
        let (start, end) = (self.start, self.start + self.block.len() + bell.last + 3);
        // Zeros before and behind, so that each sum takes as many changes as there are taps in a group.
        let length = self.block.len();
        self.padded.clear();
        self.padded.resize(GROUP - 1, 0.0);
        self.padded.extend_from_slice(&self.block);
        self.padded.resize(length + 2 * (GROUP - 1), 0.0);
        for &(ahead, weights) in &bell.groups {
            let sums = &mut self.filtered[start + ahead..][..length + GROUP - 1];
            for (sum, changes) in sums.iter_mut().zip(self.padded.windows(GROUP)) {
                for (weight, change) in weights.iter().zip(changes.iter().rev()) {
                    *sum += weight * change;
                }
            }
        }
        match self.stretches.last_mut() {
            Some(last) if last.end >= start => last.end = end,
            _ => self.stretches.push(start..end),
        }
        self.block.clear();
    }
}

#[inline(always)]
fn summed(sums: &mut [f64; 4], value: f64) -> f64 {
    sums[0] += value;
    sums[1] += sums[0];
    sums[2] += sums[1];
    sums[3] += sums[2];
    sums[3]
}
