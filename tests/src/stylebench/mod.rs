//! The measurements of `bench-style` that need no other library: limbs reshaped with and without sub-key points, overlap
//! order from few marks, and translation compared with true clips.
//!
//! - [`limbs`]: width and smoothness of bent limbs
//! - [`order`]: which limb is in front
//! - [`translation`]: error by preset and rank

pub mod limbs;
pub mod order;
pub mod translation;

/// Pseudo-random numbers from 0 to 1 (SplitMix64, Steele, Lea & Flood 2014), the same on every machine.
pub struct Random(u64);

impl Random {
    /// Starts a sequence from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, below 1.
    pub fn unit(&mut self) -> f64 {
        (self.whole() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The next number from 0 and below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Shuffles a list. All orders are equally likely.
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for k in (1..list.len()).rev() {
            let other = self.below(k + 1);
            list.swap(k, other);
        }
    }

    fn whole(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}
