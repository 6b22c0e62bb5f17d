//! Area reduction and bilinear enlargement.
//!
//! **Reduction**: a pixel of the result is the mean of the area that it covers. Source pixels cut by the border of this
//! area count by their share. This is the exact integral of the picture as squares of colour. It does not alias like
//! nearest or bilinear sampling, and thin lines keep their weight.
//!
//! **Enlargement**: bilinear between pixel centres; the border pixel continues outwards.
//!
//! Both are products of a row rule and a column rule. Each axis is therefore a list of taps: the first source pixel and
//! the weights from there on. [`resize`] chooses the rule separately for each axis. [`reduce`] keeps the factor exact
//! even if it does not divide the size: a point p of the picture is at p / factor in the result, and the last pixel is
//! the mean of the part of its area inside the picture.

use super::pixel::Pixel;
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSliceMut};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;

/// The resampling of one axis: for each pixel of the result its first source pixel and the weights from there on.
struct Axis {
    starts: Vec<usize>,
    offsets: Vec<usize>,
    weights: Vec<f32>,
}

impl Axis {
    fn with_capacity(len: usize) -> Self {
        Self { starts: Vec::with_capacity(len), offsets: vec![0], weights: Vec::new() }
    }

    fn push(&mut self, start: usize, weights: impl IntoIterator<Item = f32>) {
        self.starts.push(start);
        self.weights.extend(weights);
        self.offsets.push(self.weights.len());
    }

    /// `len` pixels, each `factor` source pixels wide; `factor` is at least 1.
    fn area(source: usize, len: usize, factor: f64) -> Self {
        let mut axis = Self::with_capacity(len);
        for i in 0..len {
            let from = (i as f64 * factor).min(source as f64 - 1.0);
            let to = ((i + 1) as f64 * factor).min(source as f64);
            let first = from.floor() as usize;
            let last = (to.ceil() as usize).clamp(first + 1, source);
            let cover = |j: usize| (to.min((j + 1) as f64) - from.max(j as f64)).max(0.0);
            // A sliver that comes from rounding only would cost a tap.
            let last = if last - first > 1 && cover(last - 1) < 1e-9 { last - 1 } else { last };
            let total: f64 = (first..last).map(cover).sum();
            axis.push(first, (first..last).map(|j| (cover(j) / total) as f32));
        }
        axis
    }

    /// `len` pixels of a larger picture, interpolated between the centres of the source pixels.
    fn bilinear(source: usize, len: usize) -> Self {
        let mut axis = Self::with_capacity(len);
        for i in 0..len {
            let centre = (i as f64 + 0.5) * source as f64 / len as f64 - 0.5;
            let centre = centre.clamp(0.0, source as f64 - 1.0);
            let first = (centre as usize).min(source.saturating_sub(2));
            let share = (centre - first as f64) as f32;
            axis.push(first, [1.0 - share, share].into_iter().take(source));
        }
        axis
    }

    /// Area reduction or bilinear enlargement, depending on the sizes.
    fn between(source: usize, len: usize) -> Self {
        if len <= source { Self::area(source, len, source as f64 / len as f64) } else { Self::bilinear(source, len) }
    }

    fn len(&self) -> usize {
        self.starts.len()
    }

    fn taps(&self, i: usize) -> (usize, &[f32]) {
        (self.starts[i], &self.weights[self.offsets[i]..self.offsets[i + 1]])
    }
}

/// The picture at `width` × `height` pixels: the mean of the area along an axis that shrinks, bilinear along one that
/// grows. The result is empty where either size is 0.
pub fn resize<T: Pixel>(picture: &Raster<T>, width: usize, height: usize) -> Raster<T> {
    if picture.data().is_empty() || width == 0 || height == 0 {
        return Raster::new(0, 0, T::ZERO);
    }
    if (width, height) == (picture.width(), picture.height()) {
        return picture.clone();
    }
    resample(picture, &Axis::between(picture.width(), width), &Axis::between(picture.height(), height))
}

/// The picture reduced by `factor` along both axes: ⌈width / factor⌉ × ⌈height / factor⌉ pixels. A point p of the
/// picture is at exactly p / `factor`. A factor of 1 or less, or NaN, gives the picture itself.
pub fn reduce<T: Pixel>(picture: &Raster<T>, factor: f64) -> Raster<T> {
    if factor.is_nan() || factor <= 1.0 || picture.data().is_empty() {
        return picture.clone();
    }
    let len = |source: usize| ((source as f64 / factor - 1e-9).ceil() as usize).max(1);
    let (width, height) = (len(picture.width()), len(picture.height()));
    resample(picture, &Axis::area(picture.width(), width, factor), &Axis::area(picture.height(), height, factor))
}

/// Sums columns first. A row of the result then needs no intermediate picture.
fn resample<T: Pixel>(picture: &Raster<T>, columns: &Axis, rows: &Axis) -> Raster<T> {
    let mut out = Raster::new(columns.len(), rows.len(), T::ZERO);
    let scratch = || vec![T::ZERO; picture.width()];
    out.data_mut().par_chunks_mut(columns.len()).enumerate().for_each_init(scratch, |sum, (y, out_row)| {
        vectorised(
            #[inline(always)]
            || sum_rows(picture, rows.taps(y), T::flat_mut(sum)),
        );
        for (x, out) in out_row.iter_mut().enumerate() {
            let (start, weights) = columns.taps(x);
            let taps = sum[start..start + weights.len()].iter().zip(weights);
            *out = taps.fold(T::ZERO, |total, (&v, &w)| total.plus(w, v));
        }
    });
    out
}

/// The weighted sum of rows from a start on.
#[inline(always)]
fn sum_rows<T: Pixel>(picture: &Raster<T>, (start, weights): (usize, &[f32]), sum: &mut [f32]) {
    for (i, &weight) in weights.iter().enumerate() {
        let row = T::flat(picture.row(start + i));
        if i == 0 {
            sum.iter_mut().zip(row).for_each(|(s, &v)| *s = weight * v);
        } else {
            sum.iter_mut().zip(row).for_each(|(s, &v)| *s += weight * v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The mean over a cell [x0, x1) × [y0, y1), from the area that it shares with each source pixel.
    fn mean_of_area(picture: &Raster<f32>, x: [f64; 2], y: [f64; 2]) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for j in 0..picture.height() {
            for i in 0..picture.width() {
                let w = (x[1].min((i + 1) as f64) - x[0].max(i as f64)).max(0.0);
                let h = (y[1].min((j + 1) as f64) - y[0].max(j as f64)).max(0.0);
                sum += w * h * picture.get(i, j) as f64;
                area += w * h;
            }
        }
        sum / area
    }

    fn bilinear(picture: &Raster<f32>, x: f64, y: f64) -> f64 {
        let (fx, fy) = (x.floor(), y.floor());
        let at = |i: f64, j: f64| picture.clamped(i as isize, j as isize) as f64;
        let top = at(fx, fy) * (1.0 - x + fx) + at(fx + 1.0, fy) * (x - fx);
        let bottom = at(fx, fy + 1.0) * (1.0 - x + fx) + at(fx + 1.0, fy + 1.0) * (x - fx);
        top * (1.0 - y + fy) + bottom * (y - fy)
    }

    fn pictures() -> impl Strategy<Value = Raster<f32>> {
        (1usize..20, 1usize..20).prop_flat_map(|(w, h)| {
            prop::collection::vec(0.0f32..1.0, w * h).prop_map(move |data| Raster::from_vec(w, h, data).unwrap())
        })
    }

    proptest! {
        #[test]
        fn reduction_is_the_mean_of_the_area(picture in pictures(), factor in 1.0f64..9.0, whole: bool) {
            let factor = if whole { factor.round() } else { factor };
            let small = reduce(&picture, factor);
            prop_assert_eq!(small.width(), (picture.width() as f64 / factor - 1e-9).ceil() as usize);
            for y in 0..small.height() {
                for x in 0..small.width() {
                    let cell = |i: usize| [i as f64 * factor, (i + 1) as f64 * factor];
                    let want = mean_of_area(&picture, cell(x), cell(y));
                    prop_assert!((small.get(x, y) as f64 - want).abs() < 1e-5);
                }
            }
        }

        #[test]
        fn shrinking_to_a_size_keeps_the_mean(picture in pictures(), w in 1usize..20, h in 1usize..20) {
            let (w, h) = (w.min(picture.width()), h.min(picture.height()));
            let small = resize(&picture, w, h);
            let mean = |r: &Raster<f32>| r.data().iter().sum::<f32>() / r.data().len() as f32;
            prop_assert!((mean(&small) - mean(&picture)).abs() < 1e-5);
        }

        #[test]
        fn enlargement_is_bilinear(picture in pictures(), w in 0usize..30, h in 0usize..30) {
            let (w, h) = (picture.width() + w, picture.height() + h);
            let large = resize(&picture, w, h);
            for y in 0..h {
                for x in 0..w {
                    let at = |i: usize, from: usize, to: usize| (i as f64 + 0.5) * from as f64 / to as f64 - 0.5;
                    let want = bilinear(&picture, at(x, picture.width(), w), at(y, picture.height(), h));
                    prop_assert!((large.get(x, y) as f64 - want).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn halves_exactly() {
        let picture = Raster::from_fn(4, 2, |x, y| [(x + 4 * y) as f32, 1.0, 0.0]);
        assert_eq!(reduce(&picture, 2.0).data(), [[2.5, 1.0, 0.0], [4.5, 1.0, 0.0]]);
    }

    #[test]
    fn nothing_to_do() {
        let picture = Raster::from_fn(3, 2, |x, _| x as f32);
        assert_eq!(reduce(&picture, 1.0), picture);
        assert_eq!(reduce(&picture, f64::NAN), picture);
        assert_eq!(resize(&picture, 3, 2), picture);
        assert_eq!(resize(&picture, 0, 4).data(), [0.0f32; 0]);
        assert_eq!(reduce(&picture, 1e9).data(), [1.0]);
    }
}
