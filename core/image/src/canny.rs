//! Canny's edge detector on the luma.
//!
//! 1. The luma is rounded to 8 bits and blurred by a Gaussian of the chosen σ.
//! 2. Sobel's 3×3 derivatives give the gradient and its magnitude, L1 (|gx| + |gy|) or L2.
//! 3. Non-maximum suppression: a pixel stays if its magnitude is not exceeded by its two neighbours along the gradient.
//!    The direction of the gradient is one of four sectors of 45°.
//! 4. Hysteresis: edges are the pixels above the high threshold, and all pixels above the low one that are connected
//!    with them through any of the eight neighbours.
//!
//! Source: Canny, "A computational approach to edge detection", PAMI 1986. Units are those of OpenCV's `Canny`: 8-bit
//! luma times the weights of the Sobel kernel, so a step of 1 level has the magnitude 4. The same thresholds apply.
//!
//! **Equivariance.** A mirrored or turned picture gives the mirrored or turned edges, bit by bit. Two things usually
//! break this. The first is rounding. Here everything up to the magnitude is exact integer arithmetic (the blur uses
//! [`Kernel::exact`]), rounded only once, pixel by pixel, to sixteenths of a level. The second is ties. A sharp step
//! has the same magnitude on both sides, and the usual rule (greater than one neighbour, not less than the other) takes
//! the left or the upper side. Here the darker side wins, which in a drawing is the side of the ink. If both are
//! equally dark, both stay.
//!
//! Limits: the border of the picture is no edge, because the picture continues beyond it (mirrored for the blur,
//! repeated for the derivative). A σ above about 10 px is coarse, see [`Kernel::exact`].

use super::colour::luma;
use super::gaussian::{Border, Kernel, convolve_row};
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSliceMut};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::{Colour, Raster};
use std::ops::Range;

/// Length of the gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GradientNorm {
    /// |gx| + |gy|.
    #[default]
    L1,
    /// √(gx² + gy²).
    L2,
}

/// Options of the edge detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CannyOptions {
    /// Standard deviation of the blur in pixels; 0 for no blur.
    pub sigma: f64,
    /// Magnitude above which a pixel continues an edge, in 8-bit levels times the weights of the Sobel kernel.
    pub low: f64,
    /// Magnitude above which a pixel starts an edge, in the same unit.
    pub high: f64,
    /// The norm of the gradient.
    pub norm: GradientNorm,
}

impl Default for CannyOptions {
    fn default() -> Self {
        Self { sigma: 1.0, low: 50.0, high: 100.0, norm: GradientNorm::L1 }
    }
}

/// Parts of a level in which the blurred luma is stored.
const PARTS: f64 = 16.0;

/// The result of non-maximum suppression for a pixel.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// No edge.
    None,
    /// An edge if it is connected with a strong pixel.
    Weak,
    /// An edge.
    Strong,
}

/// The edges of a picture, from its luma.
pub fn canny(picture: &Raster<Colour>, options: &CannyOptions) -> Raster<bool> {
    edges_of(
        picture,
        options,
        #[inline(always)]
        |colour| ((255.0 * luma(colour)).clamp(0.0, 255.0) + 0.5).floor(),
    )
}

/// The edges of an 8-bit grey picture.
pub fn canny_luma(grey: &Raster<u8>, options: &CannyOptions) -> Raster<bool> {
    edges_of(grey, options, f32::from)
}

/// Number of pixels that are skipped together where none is strong enough.
const GROUP: usize = 32;

/// Number of rows in one task, from the picture to the marks, so that the data between stays in the cache.
const BAND: usize = 64;

/// Number of rows beyond the band that its magnitudes need: one for the neighbours and one for their derivatives.
const HALO: usize = 2;

fn edges_of<T: Copy + Sync>(
    picture: &Raster<T>,
    options: &CannyOptions,
    grey: impl Fn(T) -> f32 + Copy + Sync,
) -> Raster<bool> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Raster::new(width, height, false);
    }
    let kernel = Kernel::exact(options.sigma);
    let thresholds = Thresholds::new(options);
    let mut marks = vec![Mark::None; width * height];
    marks.par_chunks_mut(width * BAND).enumerate().for_each(|(band, marks)| {
        vectorised(
            #[inline(always)]
            || {
                let first = band * BAND;
                let from = first.saturating_sub(HALO);
                let to = (first + marks.len() / width + HALO).min(height);
                let levels = blurred_levels(picture, from..to, &kernel, grey);
                suppress_band(&levels, options.norm, &thresholds, first - from, marks);
            },
        );
    });
    hysteresis(width, height, marks)
}

/// Some rows of the blurred grey levels, in sixteenths.
#[inline(always)]
fn blurred_levels<T: Copy>(
    picture: &Raster<T>,
    rows: Range<usize>,
    kernel: &Kernel,
    grey: impl Fn(T) -> f32,
) -> Raster<i16> {
    const BORDER: Border = Border::Reflect101;
    let (width, radius) = (picture.width(), kernel.radius());
    // The rows that the kernel reaches are included, so it sees only the border of the picture.
    let mut source = Raster::new(width, rows.len() + 2 * radius, 0.0f32);
    for j in 0..source.height() {
        let y = BORDER.index((rows.start + j) as isize - radius as isize, picture.height());
        for (out, &pixel) in source.row_mut(j).iter_mut().zip(picture.row(y)) {
            *out = grey(pixel);
        }
    }
    let total = kernel.total() * kernel.total();
    let scale = PARTS as f32 / total;
    let mut levels = Raster::new(width, rows.len(), 0i16);
    let mut padded = vec![0.0f32; width + 2 * radius];
    let mut blurred = vec![0.0f32; width];
    for j in 0..rows.len() {
        convolve_row(&source, kernel, BORDER, j + radius, &mut padded, &mut blurred);
        for (level, &b) in levels.row_mut(j).iter_mut().zip(&blurred) {
            *level = (b * scale + 0.5) as i32 as i16;
        }
    }
    levels
}

/// The thresholds in the unit of the magnitudes. A magnitude must be greater.
struct Thresholds {
    low: i32,
    high: i32,
}

impl Thresholds {
    fn new(options: &CannyOptions) -> Self {
        let (low, high) = (options.low.min(options.high), options.low.max(options.high));
        let unit = |t: f64| {
            let t = t.max(0.0) * PARTS;
            (if options.norm == GradientNorm::L1 { t } else { t * t }).floor().min(i32::MAX as f64) as i32
        };
        Self { low: unit(low), high: unit(high) }
    }
}

/// Gradient and magnitude of one row. The magnitude has an additional zero at each end.
struct GradientRow {
    gx: Vec<i16>,
    gy: Vec<i16>,
    magnitude: Vec<i32>,
}

impl GradientRow {
    fn new(width: usize) -> Self {
        Self { gx: vec![0; width], gy: vec![0; width], magnitude: vec![0; width + 2] }
    }

    /// Computes row `y`. Outside the picture the magnitude is 0.
    #[inline(always)]
    fn fill(&mut self, levels: &Raster<i16>, norm: GradientNorm, y: isize, scratch: &mut [Vec<i16>; 2]) {
        if y < 0 || y >= levels.height() as isize {
            self.magnitude.fill(0);
            return;
        }
        let width = levels.width();
        let row = |y: isize| levels.row(y.clamp(0, levels.height() as isize - 1) as usize);
        let (above, here, below) = (row(y - 1), row(y), row(y + 1));
        let [smooth, slope] = scratch;
        for x in 0..width {
            smooth[x + 1] = above[x] + 2 * here[x] + below[x];
            slope[x + 1] = below[x] - above[x];
        }
        for line in [&mut *smooth, &mut *slope] {
            line[0] = line[1];
            line[width + 1] = line[width];
        }
        let (gx, gy) = (&mut self.gx[..width], &mut self.gy[..width]);
        let (smooth, slope) = (&smooth[..width + 2], &slope[..width + 2]);
        for x in 0..width {
            gx[x] = smooth[x + 2] - smooth[x];
            gy[x] = slope[x] + 2 * slope[x + 1] + slope[x + 2];
        }
        let magnitude = &mut self.magnitude[1..=width];
        match norm {
            GradientNorm::L1 => {
                for x in 0..width {
                    magnitude[x] = gx[x].abs() as i32 + gy[x].abs() as i32;
                }
            }
            GradientNorm::L2 => {
                for x in 0..width {
                    magnitude[x] = gx[x] as i32 * gx[x] as i32 + gy[x] as i32 * gy[x] as i32;
                }
            }
        }
    }
}

/// Non-maximum suppression on the rows of `levels` from `first` on, as many as `marks` has.
#[inline(always)]
fn suppress_band(levels: &Raster<i16>, norm: GradientNorm, thresholds: &Thresholds, first: usize, marks: &mut [Mark]) {
    let width = levels.width();
    let mut scratch = [vec![0; width + 2], vec![0; width + 2]];
    let mut rows = [0, 1, 2].map(|_| GradientRow::new(width));
    for (row, y) in rows.iter_mut().zip(first as isize - 1..) {
        row.fill(levels, norm, y, &mut scratch);
    }
    for (y, marks) in (first..).zip(marks.chunks_mut(width)) {
        suppress_row(levels, &rows, thresholds, y, marks);
        rows.rotate_left(1);
        rows[2].fill(levels, norm, y as isize + 2, &mut scratch);
    }
}

/// Non-maximum suppression on row `y`. `rows` are the rows above, at and below it.
#[inline(always)]
fn suppress_row(levels: &Raster<i16>, rows: &[GradientRow; 3], thresholds: &Thresholds, y: usize, marks: &mut [Mark]) {
    let width = marks.len();
    let here = &rows[1];
    let (gxs, gys, magnitudes) = (&here.gx[..width], &here.gy[..width], &here.magnitude[1..=width]);
    for (group, some) in magnitudes.chunks(GROUP).enumerate() {
        // Most of a drawing is flat, so complete groups can be skipped.
        if some.iter().fold(0, |most, &m| most.max(m)) <= thresholds.low {
            continue;
        }
        for x in (group * GROUP..).take(some.len()).filter(|&x| magnitudes[x] > thresholds.low) {
            let magnitude = magnitudes[x];
            let (gx, gy) = (gxs[x] as i32, gys[x] as i32);
            let (dx, dy) = direction(gx, gy);
            let level = levels.get(x, y);
            // A neighbour with the same magnitude wins if it is darker.
            let beaten = |dx: isize, dy: isize| {
                let other = rows[(1 + dy) as usize].magnitude[(x as isize + 1 + dx) as usize];
                other > magnitude
                    || (other == magnitude
                        && levels.get((x as isize + dx) as usize, (y as isize + dy) as usize) < level)
            };
            if !beaten(dx, dy) && !beaten(-dx, -dy) {
                marks[x] = if magnitude > thresholds.high { Mark::Strong } else { Mark::Weak };
            }
        }
    }
}

/// The neighbour along the gradient.
///
/// The border between a straight and a diagonal direction is at tan 22.5° = √2 − 1. The condition a ≤ (√2 − 1) b is
/// equivalent to (a + b)² ≤ 2 b². Integers decide this without rounding. Because √2 is irrational, no gradient is
/// exactly on the border.
#[inline]
fn direction(gx: i32, gy: i32) -> (isize, isize) {
    let (ax, ay) = (gx.abs(), gy.abs());
    let square = (ax + ay) * (ax + ay);
    if square < 2 * ax * ax {
        (1, 0)
    } else if square < 2 * ay * ay {
        (0, 1)
    } else if (gx < 0) == (gy < 0) {
        (1, 1)
    } else {
        (1, -1)
    }
}

/// The strong pixels, and the weak ones connected with them.
fn hysteresis(width: usize, height: usize, mut marks: Vec<Mark>) -> Raster<bool> {
    let mut open: Vec<usize> = (0..marks.len()).filter(|&i| marks[i] == Mark::Strong).collect();
    while let Some(at) = open.pop() {
        let (x, y) = (at % width, at / width);
        for j in y.saturating_sub(1)..=(y + 1).min(height - 1) {
            for i in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                let mark = &mut marks[j * width + i];
                if *mark == Mark::Weak {
                    *mark = Mark::Strong;
                    open.push(j * width + i);
                }
            }
        }
    }
    let mut edges = Raster::new(width, height, false);
    for (edge, mark) in edges.data_mut().iter_mut().zip(marks) {
        *edge = mark == Mark::Strong;
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Step by step from the definitions, on complete pictures, without optimisation.
    fn naive(grey: &Raster<u8>, options: &CannyOptions) -> Raster<bool> {
        let (width, height) = (grey.width(), grey.height());
        let kernel = Kernel::exact(options.sigma);
        let r = kernel.radius() as isize;
        let level = |x: usize, y: usize| {
            let mut sum = 0.0f64;
            let mut total = 0.0f64;
            for j in -r..=r {
                for i in -r..=r {
                    let weight = kernel.weight(i.unsigned_abs()) as f64 * kernel.weight(j.unsigned_abs()) as f64;
                    let column = Border::Reflect101.index(x as isize + i, width);
                    let row = Border::Reflect101.index(y as isize + j, height);
                    sum += weight * grey.get(column, row) as f64;
                    total += weight;
                }
            }
            (sum / total * PARTS + 0.5).floor() as i64
        };
        let levels = Raster::from_fn(width, height, level);
        let gradient = |x: usize, y: usize| {
            let at = |i, j| levels.clamped(x as isize + i, y as isize + j);
            let gx = at(1, -1) + 2 * at(1, 0) + at(1, 1) - at(-1, -1) - 2 * at(-1, 0) - at(-1, 1);
            let gy = at(-1, 1) + 2 * at(0, 1) + at(1, 1) - at(-1, -1) - 2 * at(0, -1) - at(1, -1);
            (gx as f64 / PARTS, gy as f64 / PARTS)
        };
        let gradients = Raster::from_fn(width, height, gradient);
        let length = |(gx, gy): (f64, f64)| match options.norm {
            GradientNorm::L1 => gx.abs() + gy.abs(),
            GradientNorm::L2 => (gx * gx + gy * gy).sqrt(),
        };
        let kept = Raster::from_fn(width, height, |x, y| {
            let (gx, gy) = gradients.get(x, y);
            let here = length((gx, gy));
            let sector = (gy.atan2(gx).to_degrees() / 45.0).round() as i32;
            let (dx, dy) = [(1, 0), (1, 1), (0, 1), (-1, 1)][sector.rem_euclid(4) as usize];
            let wins = |dx: isize, dy: isize| {
                let (i, j) = (x as isize + dx, y as isize + dy);
                if i < 0 || j < 0 || i >= width as isize || j >= height as isize {
                    return true;
                }
                let (i, j) = (i as usize, j as usize);
                let other = length(gradients.get(i, j));
                here > other || (here == other && levels.get(x, y) <= levels.get(i, j))
            };
            if here > options.low && wins(dx, dy) && wins(-dx, -dy) { here } else { 0.0 }
        });
        flooded(&kept, options)
    }

    /// Grows the strong pixels by one neighbourhood until nothing changes.
    fn flooded(kept: &Raster<f64>, options: &CannyOptions) -> Raster<bool> {
        let mut edges = kept.map(|m| m > options.high);
        loop {
            let grown = Raster::from_fn(kept.width(), kept.height(), |x, y| {
                let near = |i: isize, j: isize| edges.clamped(x as isize + i, y as isize + j);
                kept.get(x, y) > options.low && (-1..=1).any(|j| (-1..=1).any(|i| near(i, j)))
            });
            if grown == edges {
                return edges;
            }
            edges = grown;
        }
    }

    fn mirrored<T: Copy>(r: &Raster<T>) -> Raster<T> {
        Raster::from_fn(r.width(), r.height(), |x, y| r.get(r.width() - 1 - x, y))
    }

    fn turned<T: Copy>(r: &Raster<T>) -> Raster<T> {
        Raster::from_fn(r.height(), r.width(), |x, y| r.get(y, r.height() - 1 - x))
    }

    /// Pictures of few levels, so that ties are frequent, or of all levels.
    fn pictures() -> impl Strategy<Value = Raster<u8>> {
        (1usize..24, 1usize..24, prop::sample::select(vec![1u8, 15, 60, 120])).prop_flat_map(|(w, h, step)| {
            let data = prop::collection::vec((0..=255 / step).prop_map(move |v| v * step), w * h);
            data.prop_map(move |data| Raster::from_vec(w, h, data).unwrap())
        })
    }

    fn options() -> impl Strategy<Value = CannyOptions> {
        let sigma = prop::sample::select(vec![0.0, 0.5, 1.0, 1.7]);
        (sigma, 0.0f64..300.0, 1.0f64..4.0, any::<bool>()).prop_map(|(sigma, low, ratio, l2)| CannyOptions {
            sigma,
            low,
            high: low * ratio,
            norm: if l2 { GradientNorm::L2 } else { GradientNorm::L1 },
        })
    }

    proptest! {
        #[test]
        fn equals_the_definition(picture in pictures(), options in options()) {
            prop_assert_eq!(canny_luma(&picture, &options), naive(&picture, &options));
        }

        #[test]
        fn flips_and_turns_with_the_picture(picture in pictures(), options in options()) {
            let edges = canny_luma(&picture, &options);
            prop_assert_eq!(canny_luma(&mirrored(&picture), &options), mirrored(&edges));
            prop_assert_eq!(canny_luma(&turned(&picture), &options), turned(&edges));
        }

        #[test]
        fn colours_count_by_their_luma(picture in pictures(), options in options()) {
            let coloured = picture.map(|v| [v as f32 / 255.0; 3]);
            prop_assert_eq!(canny(&coloured, &options), canny_luma(&picture, &options));
        }
    }

    fn drawn(rows: &[&str]) -> Raster<u8> {
        let digits: Vec<u8> = rows.iter().flat_map(|row| row.bytes()).map(|b| (b - b'0') * 28).collect();
        Raster::from_vec(rows[0].len(), rows.len(), digits).unwrap()
    }

    #[test]
    fn a_step_is_one_pixel_wide_on_its_dark_side() {
        let options = CannyOptions { sigma: 0.0, ..CannyOptions::default() };
        let edges = canny_luma(&drawn(&["000999", "000999", "000999"]), &options);
        assert_eq!(edges, Raster::from_fn(6, 3, |x, _| x == 2));
        let edges = canny_luma(&drawn(&["999000", "999000", "999000"]), &options);
        assert_eq!(edges, Raster::from_fn(6, 3, |x, _| x == 3));
    }

    #[test]
    fn weak_edges_connect_through_all_eight_neighbours() {
        for (dx, dy) in [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)] {
            let mut marks = vec![Mark::None; 25];
            marks[12] = Mark::Strong;
            let at = |steps: i32| (12 + steps * (dx + 5 * dy)) as usize;
            marks[at(1)] = Mark::Weak;
            marks[at(2)] = Mark::Weak;
            let edges = hysteresis(5, 5, marks);
            assert!(edges.data()[at(1)] && edges.data()[at(2)], "{dx} {dy}");
            assert_eq!(edges.data().iter().filter(|&&e| e).count(), 3);
        }
    }

    #[test]
    fn flat_and_empty_pictures_have_no_edges() {
        let options = CannyOptions { low: 0.0, high: 0.0, ..CannyOptions::default() };
        assert_eq!(canny_luma(&Raster::new(5, 4, 77), &options), Raster::new(5, 4, false));
        assert_eq!(canny_luma(&Raster::new(1, 1, 77), &options), Raster::new(1, 1, false));
        assert_eq!(canny_luma(&Raster::new(0, 4, 77), &options), Raster::new(0, 4, false));
    }
}
