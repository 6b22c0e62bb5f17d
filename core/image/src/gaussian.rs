//! Separable Gaussian blur.
//!
//! The Gaussian is the only blur that is both round and a product of a row kernel and a column kernel. Each output row
//! is computed in one go: the rows above and below are summed with the kernel's weights, then the sum is filtered along
//! the row. No intermediate picture is stored, and both loops run over flat channels.
//!
//! Weights left and right of the centre are equal. Their two pixels are added before they are weighted, so a mirrored
//! picture gives the mirrored result to the last bit. A quarter turn exchanges the two passes and agrees up to rounding
//! only, unless the kernel is [`Kernel::exact`].
//!
//! Limits: the kernel ends at 3 σ, where the Gaussian has fallen to 1 % of its height; 0.3 % of its mass is beyond.

use super::pixel::Pixel;
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSliceMut};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;

/// Reach of the kernel to each side, in σ.
const REACH: f64 = 3.0;

/// Sum of the weights of an exact kernel. With it, two passes over 8-bit integers stay below 2²⁴, where `f32` is exact.
const EXACT_SUM: f64 = 256.0;

/// The pixels beyond the border of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// The border pixel is repeated: `aaa|abcd|ddd`.
    #[default]
    Replicate,
    /// The picture is mirrored at the centre of the border pixel: `dcb|abcd|cba`.
    Reflect101,
}

impl Border {
    /// The index in `0..len` that replaces `index`. `len` must not be 0.
    pub fn index(self, index: isize, len: usize) -> usize {
        let last = len as isize - 1;
        match self {
            Self::Replicate => index.clamp(0, last) as usize,
            Self::Reflect101 if last == 0 => 0,
            Self::Reflect101 => {
                let folded = index.rem_euclid(2 * last);
                folded.min(2 * last - folded) as usize
            }
        }
    }
}

/// A symmetric kernel: the weight of the centre, then the weights at distance 1, 2, … to each side.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    weights: Vec<f32>,
}

impl Kernel {
    /// The Gaussian with a standard deviation of `sigma` pixels; its weights sum to 1. If `sigma` is not positive, only
    /// the centre has a weight.
    pub fn gaussian(sigma: f64) -> Self {
        let raw = half_gaussian(sigma);
        let sum = raw[0] + 2.0 * raw[1..].iter().sum::<f64>();
        Self { weights: raw.iter().map(|w| (w / sum) as f32).collect() }
    }

    /// The Gaussian with integer weights that sum to 256. On 8-bit integers both passes of [`convolve`] are exact in
    /// `f32`, so their order does not matter. The weights are coarse where `sigma` is above 10.
    pub fn exact(sigma: f64) -> Self {
        let raw = half_gaussian(sigma);
        let sum = raw[0] + 2.0 * raw[1..].iter().sum::<f64>();
        let mut weights: Vec<f64> = raw.iter().map(|w| (w / sum * EXACT_SUM).round()).collect();
        weights[0] = EXACT_SUM - 2.0 * weights[1..].iter().sum::<f64>();
        while weights.len() > 1 && weights.last() == Some(&0.0) {
            weights.pop();
        }
        Self { weights: weights.iter().map(|&w| w as f32).collect() }
    }

    /// Reach of the kernel to each side, in pixels.
    pub fn radius(&self) -> usize {
        self.weights.len() - 1
    }

    /// Sum of all weights along one axis.
    pub fn total(&self) -> f32 {
        self.weights[0] + 2.0 * self.weights[1..].iter().sum::<f32>()
    }

    /// The weight at a distance from the centre, in pixels; at most the radius.
    pub fn weight(&self, distance: usize) -> f32 {
        self.weights[distance]
    }
}

/// Heights of the Gaussian at 0, 1, 2, … pixels.
fn half_gaussian(sigma: f64) -> Vec<f64> {
    if sigma.is_nan() || sigma <= 0.0 {
        return vec![1.0];
    }
    let sigma = sigma.min(1e4);
    let radius = (REACH * sigma).ceil() as usize;
    (0..=radius).map(|i| (-0.5 * (i as f64 / sigma).powi(2)).exp()).collect()
}

/// The picture blurred by a Gaussian with a standard deviation of `sigma` pixels. If `sigma` is not positive, it is
/// unchanged.
pub fn blur<T: Pixel>(picture: &Raster<T>, sigma: f64, border: Border) -> Raster<T> {
    convolve(picture, &Kernel::gaussian(sigma), border)
}

/// The picture filtered with `kernel` along columns and rows.
pub fn convolve<T: Pixel>(picture: &Raster<T>, kernel: &Kernel, border: Border) -> Raster<T> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 || (kernel.radius() == 0 && kernel.weight(0) == 1.0) {
        return picture.clone();
    }
    let mut out = Raster::new(width, height, T::ZERO);
    let padded = || vec![T::ZERO; width + 2 * kernel.radius()];
    out.data_mut().par_chunks_mut(width).enumerate().for_each_init(padded, |padded, (y, out)| {
        vectorised(
            #[inline(always)]
            || convolve_row(picture, kernel, border, y, padded, out),
        );
    });
    out
}

/// Row `y` of [`convolve`]. `padded` has room for the row and the kernel's radius at each end.
#[inline(always)]
pub(super) fn convolve_row<T: Pixel>(
    picture: &Raster<T>,
    kernel: &Kernel,
    border: Border,
    y: usize,
    padded: &mut [T],
    out: &mut [T],
) {
    let (width, radius) = (out.len(), kernel.radius());
    sum_rows(picture, kernel, border, y, T::flat_mut(&mut padded[radius..radius + width]));
    for i in 1..=radius as isize {
        padded[radius - i as usize] = padded[radius + border.index(-i, width)];
        padded[radius + width - 1 + i as usize] = padded[radius + border.index(width as isize - 1 + i, width)];
    }
    filter_row(T::flat(padded), T::CHANNELS, kernel, T::flat_mut(out));
}

/// The weighted sum of the rows around row `y`.
#[inline(always)]
fn sum_rows<T: Pixel>(picture: &Raster<T>, kernel: &Kernel, border: Border, y: usize, out: &mut [f32]) {
    let row = |y: isize| T::flat(picture.row(border.index(y, picture.height())));
    let centre = kernel.weight(0);
    for (o, &v) in out.iter_mut().zip(row(y as isize)) {
        *o = centre * v;
    }
    for i in 1..=kernel.radius() {
        let weight = kernel.weight(i);
        let (above, below) = (row(y as isize - i as isize), row(y as isize + i as isize));
        for ((o, &a), &b) in out.iter_mut().zip(above).zip(below) {
            *o += weight * (a + b);
        }
    }
}

/// Filters along a row. `padded` has `radius` more pixels at each end than `out`.
#[inline(always)]
fn filter_row(padded: &[f32], channels: usize, kernel: &Kernel, out: &mut [f32]) {
    let (radius, len) = (kernel.radius(), out.len());
    let shifted = |pixels: usize| &padded[pixels * channels..pixels * channels + len];
    let centre = kernel.weight(0);
    for (o, &v) in out.iter_mut().zip(shifted(radius)) {
        *o = centre * v;
    }
    for i in 1..=radius {
        let weight = kernel.weight(i);
        for ((o, &a), &b) in out.iter_mut().zip(shifted(radius - i)).zip(shifted(radius + i)) {
            *o += weight * (a + b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition: every pixel is a double sum over the two-dimensional kernel.
    fn naive(picture: &Raster<f32>, sigma: f64, border: Border) -> Raster<f32> {
        let radius = (REACH * sigma).ceil() as isize;
        let height = |i: isize, j: isize| (-((i * i + j * j) as f64) / (2.0 * sigma * sigma)).exp();
        let window = || (-radius..=radius).flat_map(|j| (-radius..=radius).map(move |i| (i, j)));
        let total: f64 = window().map(|(i, j)| height(i, j)).sum();
        Raster::from_fn(picture.width(), picture.height(), |x, y| {
            let at = |i, j| {
                let column = border.index(x as isize + i, picture.width());
                picture.get(column, border.index(y as isize + j, picture.height())) as f64
            };
            (window().map(|(i, j)| height(i, j) * at(i, j)).sum::<f64>() / total) as f32
        })
    }

    fn pictures() -> impl Strategy<Value = Raster<f32>> {
        (1usize..14, 1usize..14).prop_flat_map(|(w, h)| {
            prop::collection::vec(0.0f32..1.0, w * h).prop_map(move |data| Raster::from_vec(w, h, data).unwrap())
        })
    }

    proptest! {
        #[test]
        fn equals_the_double_sum(picture in pictures(), sigma in 0.2f64..3.0, reflect: bool) {
            let border = if reflect { Border::Reflect101 } else { Border::Replicate };
            let (fast, slow) = (blur(&picture, sigma, border), naive(&picture, sigma, border));
            for (a, b) in fast.data().iter().zip(slow.data()) {
                prop_assert!((a - b).abs() < 1e-5, "{a} {b}");
            }
        }

        #[test]
        fn channels_do_not_mix(picture in pictures(), sigma in 0.2f64..2.0) {
            let coloured = picture.map(|v| [v, 1.0 - v, v * v]);
            let blurred = blur(&coloured, sigma, Border::Reflect101);
            for channel in 0..3 {
                let alone = blur(&coloured.map(|c| c[channel]), sigma, Border::Reflect101);
                prop_assert_eq!(blurred.map(|c| c[channel]), alone);
            }
        }

        #[test]
        fn exact_kernels_do_not_depend_on_the_order_of_passes(picture in pictures(), sigma in 0.1f64..12.0) {
            let bytes = picture.map(|v| (v * 255.0).round());
            let turned = Raster::from_fn(bytes.height(), bytes.width(), |x, y| bytes.get(y, x));
            let kernel = Kernel::exact(sigma);
            let straight = convolve(&bytes, &kernel, Border::Reflect101);
            let sideways = convolve(&turned, &kernel, Border::Reflect101);
            prop_assert!(straight.data().iter().all(|v| v.fract() == 0.0));
            prop_assert_eq!(sideways, Raster::from_fn(bytes.height(), bytes.width(), |x, y| straight.get(y, x)));
        }
    }

    #[test]
    fn borders() {
        let replicated: Vec<_> = (-3..7).map(|i| Border::Replicate.index(i, 4)).collect();
        assert_eq!(replicated, [0, 0, 0, 0, 1, 2, 3, 3, 3, 3]);
        let reflected: Vec<_> = (-3..7).map(|i| Border::Reflect101.index(i, 4)).collect();
        assert_eq!(reflected, [3, 2, 1, 0, 1, 2, 3, 2, 1, 0]);
        assert_eq!(Border::Reflect101.index(-5, 1), 0);
    }

    #[test]
    fn no_blur_and_no_picture() {
        let picture = Raster::from_fn(3, 2, |x, y| (x + y) as f32);
        for sigma in [0.0, -1.0, f64::NAN] {
            assert_eq!(blur(&picture, sigma, Border::Replicate), picture);
        }
        let empty = Raster::new(0, 5, 0.0f32);
        assert_eq!(blur(&empty, 2.0, Border::Replicate), empty);
    }
}
