//! Correlation of pictures by the fast Fourier transform.
//!
//! Σ_u picture(x + u) pattern(u) for all x at once is a product of spectra: picture × conj(pattern) (convolution
//! theorem). Real pictures leave half of a complex transform idle, so two results are transformed back in one go, as
//! real and imaginary part.

use crate::scene::Raster;
use rustfft::num_complex::Complex32;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// The transform of a real picture.
#[derive(Clone, Debug)]
pub struct Spectrum(Vec<Complex32>);

/// Transforms of pictures of one size.
pub struct Correlator {
    width: usize,
    height: usize,
    along_rows: [Arc<dyn Fft<f32>>; 2],
    along_columns: [Arc<dyn Fft<f32>>; 2],
}

impl Correlator {
    /// For pictures and patterns that fit into `width` × `height` together: a picture's size plus the largest pattern's
    /// keeps results from wrapping around. Both are raised to the next size that transforms quickly.
    pub fn new(width: usize, height: usize) -> Self {
        let (width, height) = (smooth(width), smooth(height));
        let mut planner = FftPlanner::new();
        let mut both = |n| [planner.plan_fft_forward(n), planner.plan_fft_inverse(n)];
        Self { width, height, along_rows: both(width), along_columns: both(height) }
    }

    /// The transform of a picture, padded with zeros.
    pub fn transform(&self, picture: &Raster<f32>) -> Spectrum {
        assert!(picture.width() <= self.width && picture.height() <= self.height);
        let mut data = vec![Complex32::default(); self.width * self.height];
        for y in 0..picture.height() {
            let row = &mut data[y * self.width..][..picture.width()];
            row.iter_mut().zip(picture.row(y)).for_each(|(c, &v)| c.re = v);
        }
        Spectrum(self.transformed(data, 0))
    }

    /// Sums of correlations: entry (x, y) of each result is Σ over the pairs of Σ_u picture(x + u) pattern(u).
    ///
    /// `patterns` are two lists that are each paired with `pictures` in order.
    pub fn correlate(&self, pictures: &[Spectrum], patterns: [&[Spectrum]; 2]) -> [Raster<f32>; 2] {
        let mut sum = vec![Complex32::default(); self.width * self.height];
        for (turn, list) in [Complex32::new(1.0, 0.0), Complex32::new(0.0, 1.0)].into_iter().zip(patterns) {
            for (picture, pattern) in pictures.iter().zip(list) {
                for ((s, a), b) in sum.iter_mut().zip(&picture.0).zip(&pattern.0) {
                    *s += turn * (a * b.conj());
                }
            }
        }
        let data = self.transformed(sum, 1);
        let scale = 1.0 / data.len() as f32;
        let part = |value: fn(&Complex32) -> f32| {
            Raster::from_fn(self.width, self.height, |x, y| scale * value(&data[y * self.width + x]))
        };
        [part(|c| c.re), part(|c| c.im)]
    }

    /// Forward (0) or inverse (1) transform along rows, then columns.
    fn transformed(&self, mut data: Vec<Complex32>, direction: usize) -> Vec<Complex32> {
        self.along_rows[direction].process(&mut data);
        let mut turned = vec![Complex32::default(); data.len()];
        transpose(&data, &mut turned, self.width);
        self.along_columns[direction].process(&mut turned);
        transpose(&turned, &mut data, self.height);
        data
    }
}

fn transpose(from: &[Complex32], to: &mut [Complex32], width: usize) {
    let height = from.len() / width;
    for (y, row) in from.chunks_exact(width).enumerate() {
        for (x, &value) in row.iter().enumerate() {
            to[x * height + y] = value;
        }
    }
}

/// The least number from `n` on that has no prime factor above 5.
fn smooth(n: usize) -> usize {
    let is_smooth = |mut k: usize| {
        for p in [2, 3, 5] {
            while k.is_multiple_of(p) {
                k /= p;
            }
        }
        k == 1
    };
    (n.max(1)..).find(|&k| is_smooth(k)).unwrap_or(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn the_transform_gives_the_direct_sums(values in prop::collection::vec(-1.0f32..1.0, 9 * 7 + 2 * 3 * 4)) {
            let picture = Raster::from_fn(9, 7, |x, y| values[y * 9 + x]);
            let pattern = |k: usize| Raster::from_fn(3, 4, |x, y| values[63 + 12 * k + y * 3 + x]);
            let patterns = [pattern(0), pattern(1)];
            let correlator = Correlator::new(12, 11);
            let spectra = patterns.clone().map(|p| [correlator.transform(&p)]);
            let results = correlator.correlate(&[correlator.transform(&picture)], [&spectra[0], &spectra[1]]);
            for (result, pattern) in results.iter().zip(&patterns) {
                for y in 0..=3 {
                    for x in 0..=6 {
                        let mut want = 0.0;
                        for v in 0..4 {
                            for u in 0..3 {
                                want += picture.get(x + u, y + v) * pattern.get(u, v);
                            }
                        }
                        prop_assert!((result.get(x, y) - want).abs() < 1e-4);
                    }
                }
            }
        }
    }

    #[test]
    fn sizes_are_raised_to_quick_ones() {
        assert_eq!([1, 7, 11, 97, 240].map(smooth), [1, 8, 12, 100, 240]);
    }
}
