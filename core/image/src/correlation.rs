//! Correlation of pictures by the fast Fourier transform.
//!
//! By the convolution theorem, Σ_u picture(x + u) pattern(u) for all x at once is a product of spectra: picture ×
//! conj(pattern). A complex transform of a real picture wastes half of its work. Two patterns are therefore transformed
//! together, as real and imaginary part, and their results come back in the same way. The conjugated spectrum is that
//! of the pattern turned by 180°, so the turned pattern is transformed.
//!
//! Limits: the transform is circular. Where a pattern reaches over an edge of the picture, the opposite edge is read.
//! All other places are right without padding.

use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;
use rototoon_fourier::{Complex32, Fft, plans};
use std::ops::Range;
use std::sync::Arc;

/// A transform: real and imaginary parts, column by column.
#[derive(Clone, Debug)]
pub struct Spectrum {
    re: Vec<f32>,
    im: Vec<f32>,
}

impl Spectrum {
    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.re[..]) + size_of_val(&self.im[..])
    }
}

/// Transforms of pictures of one size.
pub struct Correlator {
    width: usize,
    height: usize,
    forward: [Arc<dyn Fft<f32>>; 2],
    inverse: [Arc<dyn Fft<f32>>; 2],
}

impl Correlator {
    /// Prepares transforms for pictures of `width` × `height` pixels. Both are raised to the next size that transforms
    /// quickly.
    pub fn new(width: usize, height: usize) -> Self {
        let (width, height) = (smooth(width), smooth(height));
        let [[forward_x, inverse_x], [forward_y, inverse_y]] = plans([width, height]);
        Self { width, height, forward: [forward_x, forward_y], inverse: [inverse_x, inverse_y] }
    }

    /// The transform of a picture, padded with zeros.
    ///
    /// # Panics
    ///
    /// If the picture is larger than the size given to [`Self::new`], raised.
    pub fn picture(&self, picture: &Raster<f32>) -> Spectrum {
        assert!(picture.width() <= self.width && picture.height() <= self.height);
        let mut data = vec![Complex32::default(); self.width * self.height];
        for y in 0..picture.height() {
            let row = &mut data[y * self.width..][..picture.width()];
            row.iter_mut().zip(picture.row(y)).for_each(|(c, &v)| c.re = v);
        }
        self.transformed(data, [0..picture.height(), 0..0])
    }

    /// The transform of two patterns for [`Correlator::correlate`].
    ///
    /// # Panics
    ///
    /// If a pattern is larger than the pictures.
    pub fn patterns(&self, patterns: [&Raster<f32>; 2]) -> Spectrum {
        let mut data = vec![Complex32::default(); self.width * self.height];
        for (pattern, unit) in patterns.iter().zip([Complex32::new(1.0, 0.0), Complex32::new(0.0, 1.0)]) {
            assert!(pattern.width() <= self.width && pattern.height() <= self.height);
            for y in 0..pattern.height() {
                let turned = &mut data[(self.height - y) % self.height * self.width..][..self.width];
                for (x, &value) in pattern.row(y).iter().enumerate() {
                    turned[if x == 0 { 0 } else { self.width - x }] += unit * value;
                }
            }
        }
        // Row 0 stays the first row; the other rows wrap to the end.
        let others = patterns.iter().map(|pattern| pattern.height()).max().unwrap_or(0).saturating_sub(1);
        self.transformed(data, [0..1, self.height - others..self.height])
    }

    /// Sums of the correlations of pictures with pairs of patterns, taken in the same order. Entry (x, y) of each of
    /// the two results is Σ over the pictures of Σ_u picture(x + u) pattern(u).
    pub fn correlate(&self, pictures: &[Spectrum], patterns: &[Spectrum]) -> [Raster<f32>; 2] {
        let mut turned = vec![Complex32::default(); self.width * self.height];
        vectorised(
            #[inline(always)]
            || add_products(pictures, patterns, &mut turned),
        );
        self.inverse[1].process(&mut turned);
        let mut data = vec![Complex32::default(); turned.len()];
        transpose_rows(&turned, 0, &mut data, self.height, self.width);
        self.inverse[0].process(&mut data);
        let scale = 1.0 / data.len() as f32;
        let raster = |plane| Raster::from_vec(self.width, self.height, plane).unwrap_or_else(|| Raster::new(0, 0, 0.0));
        [raster(data.iter().map(|c| scale * c.re).collect()), raster(data.iter().map(|c| scale * c.im).collect())]
    }

    /// Transforms a picture that is zero outside some rows. Only these rows need the transform along rows.
    fn transformed(&self, mut data: Vec<Complex32>, rows: [Range<usize>; 2]) -> Spectrum {
        let mut turned = vec![Complex32::default(); data.len()];
        for rows in rows.into_iter().filter(|rows| !rows.is_empty()) {
            let first = rows.start;
            let rows = &mut data[first * self.width..rows.end * self.width];
            self.forward[0].process(rows);
            transpose_rows(rows, first, &mut turned, self.width, self.height);
        }
        self.forward[1].process(&mut turned);
        Spectrum { re: turned.iter().map(|c| c.re).collect(), im: turned.iter().map(|c| c.im).collect() }
    }
}

/// The sum of the products of spectra, pair by pair.
#[inline(always)]
fn add_products(pictures: &[Spectrum], patterns: &[Spectrum], sums: &mut [Complex32]) {
    const PIECE: usize = 256;
    let count = sums.len();
    for (k, sums) in sums.chunks_mut(PIECE).enumerate() {
        let range = k * PIECE..(k * PIECE + sums.len()).min(count);
        let (mut re, mut im) = ([0.0f32; PIECE], [0.0f32; PIECE]);
        for (a, b) in pictures.iter().zip(patterns) {
            let [ar, ai, br, bi] = [&a.re, &a.im, &b.re, &b.im].map(|plane| &plane[range.clone()]);
            let (re, im) = (&mut re[..ar.len()], &mut im[..ar.len()]);
            let (ai, br, bi) = (&ai[..ar.len()], &br[..ar.len()], &bi[..ar.len()]);
            for i in 0..ar.len() {
                re[i] += ar[i] * br[i] - ai[i] * bi[i];
                im[i] += ar[i] * bi[i] + ai[i] * br[i];
            }
        }
        for (i, sum) in sums.iter_mut().enumerate() {
            *sum = Complex32::new(re[i], im[i]);
        }
    }
}

/// Writes rows of `width` values as columns of `height`, from column `first` on, in tiles that stay in the processor's
/// cache.
fn transpose_rows(rows: &[Complex32], first: usize, to: &mut [Complex32], width: usize, height: usize) {
    const TILE: usize = 16;
    let count = rows.len() / width;
    for y0 in (0..count).step_by(TILE) {
        for x0 in (0..width).step_by(TILE) {
            for y in y0..(y0 + TILE).min(count) {
                for x in x0..(x0 + TILE).min(width) {
                    to[x * height + first + y] = rows[y * width + x];
                }
            }
        }
    }
}

/// The smallest number from `n` on without a prime factor above 5.
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
            let correlator = Correlator::new(9, 7);
            let spectrum = correlator.patterns([&patterns[0], &patterns[1]]);
            let twice = [correlator.picture(&picture), correlator.picture(&picture)];
            let results = correlator.correlate(&twice, &[spectrum.clone(), spectrum]);
            for (result, pattern) in results.iter().zip(&patterns) {
                for y in 0..=3 {
                    for x in 0..=6 {
                        let mut want = 0.0;
                        for v in 0..4 {
                            for u in 0..3 {
                                want += 2.0 * picture.get(x + u, y + v) * pattern.get(u, v);
                            }
                        }
                        prop_assert!((result.get(x, y) - want).abs() < 1e-4);
                    }
                }
            }
        }
    }

    #[test]
    fn sizes_are_raised_to_fast_ones() {
        assert_eq!([1, 7, 11, 97, 240].map(smooth), [1, 8, 12, 100, 240]);
    }
}
