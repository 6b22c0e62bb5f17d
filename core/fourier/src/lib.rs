//! Plans of the fast Fourier transform, by rustfft.
//!
//! Whoever plans a transform compiles all algorithms of rustfft, since they are generic. That takes 13 s. This crate plans for all
//! others, so they are compiled once, and not again with the unit tests of `rototoon-image`.

#![forbid(unsafe_code)]

use rustfft::FftPlanner;
use std::sync::Arc;

pub use rustfft::Fft;
pub use rustfft::num_complex::Complex32;

/// The transforms of complex numbers of each length: forward, and back without the division by the length.
pub fn plans(lengths: [usize; 2]) -> [[Arc<dyn Fft<f32>>; 2]; 2] {
    let mut planner = FftPlanner::new();
    lengths.map(|length| [planner.plan_fft_forward(length), planner.plan_fft_inverse(length)])
}
