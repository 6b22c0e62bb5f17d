//! Whether two pictures show the same drawing: a test of how likely their difference is noise.
//!
//! A drawing that is held for two or three frames is the same ink. Its pictures still differ: by the specks of a GIF, the
//! grain of a scan, the blocks of a video codec. No bound on the largest difference tells these from a drawing that has
//! moved, because a codec changes a single pixel by more than a slow movement does. What tells them apart is how the
//! differences hang together.
//!
//! **Movement.** Where ink moves by v, the difference is D = −∇I·v (Lucas & Kanade 1981), with one v for a whole
//! neighbourhood. Noise has another sign at every edge. So in each window of [`WIDE`] the least-squares v is fitted. A
//! window has *moved* if v explains more than half of the energy ΣD², is longer than [`LEAST_STEP`], and the explained
//! energy stands out from the noise. M is the explained energy of the moved windows per pixel of ink.
//!
//! **Change.** A blink or a new line is no movement, but much change in a small connected area. B is the largest energy in
//! a window of [`NARROW`]. A single stray pixel stays far below a small pupil.
//!
//! **Noise** is measured in the pair itself, in two ways. σ, from the median difference, is that of grain; its energy is
//! subtracted everywhere. U is what no movement explains, per pixel of ink, without the strongest window. Both bounds
//! grow with U, up to a limit: from there on, the change is no noise whatever the rest looks like.
//!
//! All is computed on the finest level (pixels of two working pixels, smoothed by σ = 1 working pixel).
//!
//! **Limits.** A part of about 40 working pixels that alone moves by half a pixel counts as held if the noise is as strong
//! as H.264 at crf 35. So a frame is compared with the first one of its drawing, and slow movement does not add up.

use super::features::{Features, Level, UNIT};

/// Radius of the windows in which a movement is fitted, in pixels of the level: 13 × 13 pixels.
const WIDE: usize = 6;
/// Radius of the windows in which a change is measured: 5 × 5 pixels.
const NARROW: usize = 2;
/// Largest change of a colour (0 to 1) that needs no further test: ink that moves by a tenth of a working pixel exceeds it.
const NOTHING: f32 = 0.012;
/// A change of a colour that no noise makes in more than [`MANY`] pixels.
const STRONG: f32 = 0.3;
const MANY: usize = 400;
/// Share of a window's energy that its movement must explain.
const EXPLAINED: f64 = 0.5;
/// Least movement of a window, in pixels of the level.
const LEAST_STEP: f64 = 0.05;
/// Least explained energy of a window, plus this many times the variance of the grain.
const LEAST_ENERGY: f64 = 0.01;
const ABOVE_GRAIN: f64 = 6.0;
/// Least squared slope, summed over a window of [`WIDE`], for its pixel to count as ink.
const INK: f64 = 0.1;
/// Least number of pixels of ink, so that a single dot on paper is judged like one in a drawing.
const LEAST_INK: f64 = 2000.0;
/// Bound on M: the first number without noise, plus the second one times U, at most the third one.
const MOVED: [f64; 3] = [3e-6, 1.4, 60e-6];
/// Bound on B: the first number without noise, plus the second one times U, at most the third one.
const CHANGED: [f64; 3] = [0.2, 2e4, 0.6];
/// Added to the squared slopes, so that a window without ink has no movement.
const DAMPING: f64 = 1e-3;

/// Whether two pictures show the same drawing.
pub fn same_drawing(a: &Features, b: &Features) -> bool {
    let (a, b) = (a.level(2), b.level(2));
    if a.dimensions() != b.dimensions() {
        return false;
    }
    if a.largest_colour_change(b) <= NOTHING {
        return true;
    }
    let difference = Difference::new(a, b);
    difference.strong <= MANY && difference.measure(LEAST_INK).is_noise()
}

/// The difference of two pictures, as sums over the channels of products by pixel.
pub(super) struct Difference {
    width: usize,
    height: usize,
    /// Squared slopes along x, along y and their product; slope times difference along x and along y; squared difference.
    products: [Vec<f32>; 6],
    /// Variance of the grain in a channel.
    grain: f64,
    /// Number of pixels with a [`STRONG`] change.
    strong: usize,
}

impl Difference {
    fn new(a: &Level, b: &Level) -> Self {
        let (width, height) = a.dimensions();
        let mut products = [(); 6].map(|()| Vec::with_capacity(width * height));
        let mut sizes = Vec::with_capacity(3 * width * height);
        let mut strong = 0;
        for y in 0..height {
            for (p, q) in a.row(y).iter().zip(b.row(y)).take(width) {
                let mut sums = [0f32; 6];
                let mut largest = 0;
                for k in 0..3 {
                    let change = i32::from(q[k]) - i32::from(p[k]);
                    largest = largest.max(change.abs());
                    sizes.push(change.unsigned_abs() as u16);
                    let mean = |k: usize| (f32::from(p[k]) + f32::from(q[k])) / (2.0 * UNIT);
                    let (gx, gy, d) = (mean(k + 4), mean(k + 8), change as f32 / UNIT);
                    let own = [gx * gx, gx * gy, gy * gy, gx * d, gy * d, d * d];
                    sums.iter_mut().zip(own).for_each(|(sum, value)| *sum += value);
                }
                strong += usize::from(largest as f32 > STRONG * UNIT);
                products.iter_mut().zip(sums).for_each(|(plane, sum)| plane.push(sum));
            }
        }
        Self { strong, ..Self::of((width, height), products, &mut sizes) }
    }

    /// From the products, and the sizes of the changes in units of a stored colour. Strong changes are not counted.
    pub(super) fn of((width, height): (usize, usize), products: [Vec<f32>; 6], sizes: &mut [u16]) -> Self {
        Self { width, height, products, grain: variance(sizes), strong: 0 }
    }

    /// `least` is the number of pixels of ink that are counted at least.
    pub(super) fn measure(&self, least: f64) -> Measured {
        let wide = self.products.each_ref().map(|plane| self.summed(plane, WIDE));
        let area = ((2 * WIDE + 1) * (2 * WIDE + 1)) as f64;
        let (mut moved, mut rest, mut ink) = (0.0, 0.0, 0.0f64);
        for i in 0..self.width * self.height {
            let [xx, xy, yy, xt, yt, tt] = wide.each_ref().map(|plane| f64::from(plane[i]));
            ink += if xx + yy > INK { 1.0 } else { 0.0 };
            let (xx, yy) = (xx + DAMPING, yy + DAMPING);
            let determinant = xx * yy - xy * xy;
            let step = [(xy * yt - yy * xt) / determinant, (xy * xt - xx * yt) / determinant];
            let explained = -(step[0] * xt + step[1] * yt);
            let energy = (tt - 3.0 * area * self.grain).max(1e-4);
            let is = explained > EXPLAINED * energy
                && step[0].hypot(step[1]) > LEAST_STEP
                && explained > LEAST_ENERGY + ABOVE_GRAIN * self.grain;
            moved += if is { explained } else { 0.0 };
            rest += if is { (energy - explained).max(0.0) } else { energy };
        }
        let narrow = self.summed(&self.products[5], NARROW).into_iter().fold(0.0, f32::max);
        let share = ((2 * NARROW + 1) * (2 * NARROW + 1)) as f64;
        let change = f64::from(narrow) - 3.0 * share * self.grain;
        let ink = ink.max(least);
        Measured { moved: moved / area / ink, change, rest: (rest / area - change).max(0.0) / ink }
    }

    /// Sums over windows of a radius around each pixel. There is nothing outside of the picture.
    fn summed(&self, plane: &[f32], radius: usize) -> Vec<f32> {
        let along = windows(plane, self.width, 1, radius);
        windows(&along, self.height, self.width, radius)
    }
}

/// Sums over windows of a radius along the lines of `length` values that are `stride` apart.
fn windows(values: &[f32], length: usize, stride: usize, radius: usize) -> Vec<f32> {
    let mut sums = vec![0f32; values.len()];
    for first in (0..values.len()).filter(|i| (i / stride).is_multiple_of(length)) {
        let at = |i: usize| f64::from(values[first + i * stride]);
        let mut sum: f64 = (0..radius.min(length)).map(at).sum();
        for i in 0..length {
            sum += if i + radius < length { at(i + radius) } else { 0.0 };
            sums[first + i * stride] = sum as f32;
            sum -= if i >= radius { at(i - radius) } else { 0.0 };
        }
    }
    sums
}

/// Variance of noise from the sizes of differences: their median is 0.6745 σ. Sizes are in units of a stored colour.
pub(super) fn variance(sizes: &mut [u16]) -> f64 {
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable(middle);
    (f64::from(*median) / f64::from(UNIT) / 0.6745).powi(2)
}

/// M, B and U of the module's text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    moved: f64,
    change: f64,
    rest: f64,
}

impl Measured {
    pub(super) fn is_noise(self) -> bool {
        let bound = |[least, slope, most]: [f64; 3]| (least + slope * self.rest).min(most);
        self.moved <= bound(MOVED) && self.change <= bound(CHANGED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Colour, Raster};

    /// A black ring with an eye on white paper, moved by `shift` pixels, with an open or a closed eye.
    fn drawing(shift: f64, open: bool) -> Raster<Colour> {
        let ink = |x: f64, y: f64| {
            let (dx, dy) = (x - 200.0 - shift, y - 270.0);
            let ring = ((dx.hypot(dy) - 120.0).abs() - 2.0).clamp(-0.5, 0.5) + 0.5;
            let eye = if open { (dx - 40.0).hypot(dy + 30.0) - 4.0 } else { 1.0 };
            ring.min(eye.clamp(-0.5, 0.5) + 0.5)
        };
        Raster::from_fn(400, 540, |x, y| [ink(x as f64 + 0.5, y as f64 + 0.5) as f32; 3])
    }

    /// Adds noise of a standard deviation, and stray pixels in the colour of ink.
    fn with_noise(mut picture: Raster<Colour>, seed: u64, sigma: f32, stray: usize) -> Raster<Colour> {
        let mut state = seed;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        let (width, height) = (picture.width(), picture.height());
        for y in 0..height {
            for colour in picture.row_mut(y) {
                let normal: f32 = (0..12).map(|_| random()).sum::<f32>() - 6.0;
                *colour = colour.map(|value| (value + sigma * normal).clamp(0.0, 1.0));
            }
        }
        for _ in 0..stray {
            let (x, y) = ((random() * width as f32) as usize, (random() * height as f32) as usize);
            picture.row_mut(y)[x] = [0.0; 3];
        }
        picture
    }

    fn same(a: &Raster<Colour>, b: &Raster<Colour>) -> bool {
        same_drawing(&Features::new(a), &Features::new(b))
    }

    #[test]
    fn grain_and_stray_pixels_are_noise() {
        let noisy = |seed, sigma, stray| with_noise(drawing(0.0, true), seed, sigma, stray);
        assert!(same(&noisy(1, 0.0, 0), &noisy(2, 0.0, 0)));
        assert!(same(&noisy(1, 4.0 / 255.0, 0), &noisy(2, 4.0 / 255.0, 0)));
        assert!(same(&noisy(1, 0.0, 20), &noisy(2, 0.0, 20)));
    }

    #[test]
    fn half_a_pixel_and_a_blink_are_drawn() {
        for sigma in [0.0, 4.0 / 255.0] {
            let noisy = |seed, shift, open| with_noise(drawing(shift, open), seed, sigma, 20);
            assert!(!same(&noisy(1, 0.0, true), &noisy(2, 0.5, true)), "moved, noise {sigma}");
            assert!(!same(&noisy(1, 0.0, true), &noisy(2, 0.0, false)), "blinked, noise {sigma}");
            assert!(!same(&noisy(1, 0.0, true), &noisy(2, 9.0, true)), "new, noise {sigma}");
        }
    }

    #[test]
    fn pictures_of_other_sizes_are_other_drawings() {
        let plain = |width| Raster::new(width, 20, [0.5; 3]);
        assert!(same(&plain(20), &plain(20)));
        assert!(!same(&plain(20), &plain(40)));
    }

    #[test]
    fn windows_sum_what_is_within_their_radius() {
        let values: Vec<f32> = (0u8..12).map(f32::from).collect();
        for (length, stride, radius) in [(4, 1, 1), (3, 4, 1), (4, 1, 6), (12, 1, 2)] {
            let found = windows(&values, length, stride, radius);
            for (i, sum) in found.into_iter().enumerate() {
                let place = (i / stride) % length;
                let near = (0..length).filter(|k| k.abs_diff(place) <= radius);
                let expected: f32 = near.map(|k| values[i + k * stride - place * stride]).sum();
                assert_eq!(sum, expected, "value {i} of lines of {length}");
            }
        }
    }
}
