//! Grain on pictures: noise of the same strength in every pixel, new on each frame.
//!
//! Drawn footage compresses well, scans and video don't. Measurements of decoding and of held drawings need both. The noise is a function of
//! its seed alone, so that the same command writes the same files.

use anyhow::{Context, Result};
use std::path::Path;

/// Puts grain on a picture file of 8 bits a channel. See [`add`].
pub fn on_file(path: &Path, sigma: f64, seed: u64) -> Result<()> {
    let mut picture = image::open(path).with_context(|| format!("cannot read {path:?}"))?.into_rgb8();
    add(&mut picture, sigma, seed);
    picture.save(path).with_context(|| format!("cannot write {path:?}"))
}

/// Adds normal noise of standard deviation `sigma`, in steps of 8 bits, to every value of a picture.
///
/// Each value gets noise of its own. Values stay in 0..=255, so black and white get less.
pub fn add(values: &mut [u8], sigma: f64, seed: u64) {
    for (k, value) in values.iter_mut().enumerate() {
        let bits = mix(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ k as u64);
        // The sum of four even numbers is nearly normal; its variance is 4/12.
        let sum: f64 = (0..4).map(|part| f64::from((bits >> (16 * part)) as u16) / 65535.0).sum();
        let noise = (sum - 2.0) * 3f64.sqrt() * sigma;
        *value = (f64::from(*value) + noise).round().clamp(0.0, 255.0) as u8;
    }
}

/// A number whose bits have nothing visible to do with those of `x`: the finaliser of SplitMix64 (Steele et al. 2014).
fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grain_has_its_strength_and_depends_on_its_seed_alone() {
        let noisy = |seed| {
            let mut values = vec![128; 60_000];
            add(&mut values, 4.0, seed);
            values
        };
        let first = noisy(1);
        assert_eq!(first, noisy(1));
        assert_ne!(first, noisy(2));
        let away = first.iter().map(|&value| f64::from(value) - 128.0);
        let mean = away.clone().sum::<f64>() / first.len() as f64;
        let spread = (away.map(|d| d * d).sum::<f64>() / first.len() as f64).sqrt();
        assert!(mean.abs() < 0.1 && (spread - 4.0).abs() < 0.1, "{mean} {spread}");
    }
}
