//! Features of a picture: a pyramid of colours with their gradients, computed once per picture.
//!
//! All lengths of the default tracker are in **working pixels**: the picture scaled to 540 lines. A pixel of level l of
//! the pyramid is l × l working pixels. A level is smoothed by a Gaussian of σ = l/2 before it is reduced. The
//! gradients use Scharr's filter (weights 3, 10, 3; divided by 32), which is closer to rotation invariant than plain
//! differences.
//!
//! Values are stored as 16-bit fractions of ±1. Colours are within 0 to 1 and Scharr gradients of such colours within
//! ±0.5. The quantisation step of 3e-5 is far below the noise of 8-bit pictures, and a frame needs 4 MB instead of 8.

use rototoon_base::geometry::Point;
use rototoon_base::numeric::lanes::{LANES, Lanes};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::gaussian::{self, Border};
use rototoon_image::resize;

/// Lines of a picture in working pixels.
pub const WORKING_LINES: f64 = 540.0;

/// Working pixels per pixel of each level, from coarse to fine.
pub const LEVELS: [usize; 3] = [8, 4, 2];

/// The three values of a colour and a zero: four values are processed at once.
pub type Padded = glam::Vec4;

/// Colour and slopes at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Colour, with channels 0 to 1.
    pub colour: Padded,
    /// Its derivatives along x and y, per working pixel.
    pub slopes: [Padded; 2],
}

/// Colour and both slopes of a pixel, each followed by a zero.
pub(super) type Pixel = [i16; 12];

/// The number that is stored for the value 1.
pub(super) const UNIT: f32 = 32767.0;

/// Picture pixels per working pixel, for a picture of `height` lines.
pub fn working_scale(height: usize) -> f64 {
    height as f64 / WORKING_LINES
}

/// One level of the pyramid.
#[derive(Clone, Debug)]
pub struct Level {
    /// Working pixels per pixel. The last row and column may reach beyond the picture's edge.
    size: f64,
    /// 1 / `size`.
    inverse: f32,
    /// Factor from a stored number to a slope per working pixel.
    slope: f32,
    /// The pixels. The last pixel of each row and column is stored twice, so that every place has four pixels around
    /// it.
    raster: Raster<Pixel>,
}

/// The pyramid of a picture.
#[derive(Clone, Debug)]
pub struct Features {
    levels: [Level; 3],
}

impl Features {
    /// Builds the pyramid of a picture of any size with at least one pixel.
    pub fn new(picture: &Raster<Colour>) -> Self {
        let scale = working_scale(picture.height());
        // A level needs the variance (l/2)². The finer level has a quarter of it, (l/4)²; 3/4 of its own squared pixels
        // is missing.
        let fine = reduce(&blur(picture, scale), 2.0 * scale);
        let again = 0.75f64.sqrt();
        let middle = reduce(&blur(&fine, again), 2.0);
        let coarse = reduce(&blur(&middle, again), 2.0);
        Self { levels: [Level::new(&coarse, 8.0), Level::new(&middle, 4.0), Level::new(&fine, 2.0)] }
    }

    /// The level at index `index` of [`LEVELS`].
    pub fn level(&self, index: usize) -> &Level {
        &self.levels[index]
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.raster.data())).sum()
    }
}

impl Level {
    fn new(colours: &Raster<Colour>, size: f64) -> Self {
        let (width, height) = (colours.width(), colours.height());
        let lines: Vec<Vec<f32>> = (0..height).map(|y| bordered(colours.row(y))).collect();
        let mut raster = Raster::new(width + 1, height + 1, [0; 12]);
        vectorised(
            #[inline(always)]
            || {
                let mut planes = [(); 3].map(|()| vec![0i16; 3 * width]);
                for y in 0..height {
                    let near = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| &lines[y][..]);
                    quantise(near, &mut planes);
                    interleave(&planes, raster.row_mut(y));
                }
                let last = raster.row(height - 1).to_vec();
                raster.row_mut(height).copy_from_slice(&last);
            },
        );
        let inverse = 1.0 / size as f32;
        Self { size, inverse, slope: inverse / UNIT, raster }
    }

    /// Reads colour and slopes bilinearly at `p` in working pixels. Outside the picture it reads the nearest edge.
    #[inline(always)]
    pub fn sample(&self, p: Point) -> Sample {
        let ([above, below], weights) = self.around(p);
        let pair = |row: &[i16], first: usize| row[first..].first_chunk().map_or(Lanes::splat(0.0), Lanes::of_integers);
        let [colour, along] = (weights[0] * pair(above, 0)
            + weights[1] * pair(above, 12)
            + (weights[2] * pair(below, 0) + weights[3] * pair(below, 12)))
        .fours();
        let down = mixed(above, below, &weights, 8);
        Sample { colour: colour * (1.0 / UNIT), slopes: [along * self.slope, down * self.slope] }
    }

    /// The values of the two pixels above and the two below `p`, and the bilinear weights of the four.
    #[inline(always)]
    fn around(&self, p: Point) -> ([&[i16]; 2], [f32; 4]) {
        let (width, height) = self.dimensions();
        let (x, fx) = split(p.x as f32 * self.inverse, width);
        let (y, fy) = split(p.y as f32 * self.inverse, height);
        let first = y * (width + 1) + x;
        let data = self.raster.data();
        let rows = [&data[first..first + 2], &data[first + width + 1..first + width + 3]];
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        ([rows[0].as_flattened(), rows[1].as_flattened()], weights)
    }

    /// Colour at `p` in working pixels, as [`Level::sample`] reads it.
    #[inline(always)]
    pub fn colour(&self, p: Point) -> Padded {
        let ([above, below], weights) = self.around(p);
        mixed(above, below, &weights, 0) * (1.0 / UNIT)
    }

    /// Colours at equidistant places on a straight line, from `first` on with the step `step` (working pixels), into
    /// one plane each for red, green and blue. The planes have one value per place.
    #[inline(always)]
    pub fn colours_along(&self, first: Point, step: Point, [red, green, blue]: [&mut [f32]; 3]) {
        let (width, height) = self.dimensions();
        let inverse = 1.0 / self.size;
        let (first, step) = ((first * inverse).as_vec2(), (step * inverse).as_vec2());
        let data = self.raster.data();
        let groups = red.chunks_mut(LANES).zip(green.chunks_mut(LANES)).zip(blue.chunks_mut(LANES));
        for (group, ((red, green), blue)) in groups.enumerate() {
            let count = Lanes::splat((group * LANES) as f32) + Lanes::count();
            let (x, fx) = split_lanes(Lanes::splat(first.x) + step.x * count, width);
            let (y, fy) = split_lanes(Lanes::splat(first.y) + step.y * count, height);
            for v in 0..red.len() {
                let first = y[v] * (width + 1) + x[v];
                let (above, below) = (&data[first..first + 2], &data[first + width + 1..first + width + 3]);
                let (ex, ey) = (1.0 - fx[v], 1.0 - fy[v]);
                let weights = [ex * ey, fx[v] * ey, ex * fy[v], fx[v] * fy[v]];
                let colour = mixed(above.as_flattened(), below.as_flattened(), &weights, 0) * (1.0 / UNIT);
                (red[v], green[v], blue[v]) = (colour.x, colour.y, colour.z);
            }
        }
    }

    /// Working pixels per pixel of this level.
    pub fn pixel(&self) -> f64 {
        self.size
    }

    /// Width and height in pixels of this level.
    pub fn dimensions(&self) -> (usize, usize) {
        (self.raster.width() - 1, self.raster.height() - 1)
    }

    /// A row of pixels; the last pixel is stored twice.
    pub(super) fn row(&self, y: usize) -> &[Pixel] {
        self.raster.row(y)
    }

    /// The largest difference of a colour value from another picture's level; infinite if their sizes differ.
    pub fn largest_colour_change(&self, other: &Self) -> f32 {
        if self.dimensions() != other.dimensions() {
            return f32::INFINITY;
        }
        let change =
            |(a, b): (&Pixel, &Pixel)| (0..3).map(|k| (i32::from(a[k]) - i32::from(b[k])).abs()).max().unwrap_or(0);
        let largest = self.raster.data().iter().zip(other.raster.data()).map(change).max();
        largest.unwrap_or(0) as f32 / UNIT
    }

    /// Luma of each pixel, 0 to 1 (Rec. 601 weights).
    pub fn luma(&self) -> Raster<f32> {
        let (width, height) = self.dimensions();
        Raster::from_fn(width, height, |x, y| {
            let [r, g, b, ..] = self.raster.get(x, y).map(f32::from);
            (0.299 * r + 0.587 * g + 0.114 * b) / UNIT
        })
    }
}

/// 2²³: from here on neighbouring f32 numbers are 1 apart. Adding it rounds a number to a whole one, which is then in
/// the lower bits. (A conversion would also handle NaN and overflow, and is slower.)
const WHOLE: f32 = 8_388_608.0;
/// Mask of these bits.
const WHOLE_BITS: u32 = 0x7f_ffff;

/// Index of the pixel (of `count`) with the last centre at or before a place, and the distance of the place after that
/// centre, 0 to 1 pixel. The place is measured in pixels from the picture's edge. A place outside is moved to the
/// nearest centre.
#[inline(always)]
fn split(at: f32, count: usize) -> (usize, f32) {
    let at = (at - 0.5).clamp(0.0, (count - 1) as f32);
    let low = (at - 0.5).max(0.0) + WHOLE;
    ((low.to_bits() & WHOLE_BITS) as usize, at - (low - WHOLE))
}

/// The same as [`split`] for several places.
#[inline(always)]
fn split_lanes(at: Lanes, count: usize) -> ([usize; LANES], [f32; LANES]) {
    let (zero, whole) = (Lanes::splat(0.0), Lanes::splat(WHOLE));
    let at = (at - Lanes::splat(0.5)).max(zero).min(Lanes::splat((count - 1) as f32));
    let low = (at - Lanes::splat(0.5)).max(zero) + whole;
    let mut pixels = [0; LANES];
    for (pixel, low) in pixels.iter_mut().zip(low.to_array()) {
        *pixel = (low.to_bits() & WHOLE_BITS) as usize;
    }
    (pixels, (at - (low - whole)).to_array())
}

/// Bilinear mix of the four pixels around a place, for the four values of each pixel from index `first` on.
#[inline(always)]
fn mixed(above: &[i16], below: &[i16], weights: &[f32; 4], first: usize) -> Padded {
    let value = |row: &[i16], first: usize| {
        let [a, b, c, d] = *row[first..].first_chunk().unwrap_or(&[0; 4]);
        Padded::new(f32::from(a), f32::from(b), f32::from(c), f32::from(d))
    };
    (value(above, first) * weights[0] + value(above, first + 12) * weights[1])
        + (value(below, first) * weights[2] + value(below, first + 12) * weights[3])
}

/// Sum of the four values.
#[inline(always)]
pub fn total(values: Padded) -> f32 {
    (values.x + values.y) + (values.z + values.w)
}

/// Squared difference of two colours, summed over the channels.
#[inline(always)]
pub fn difference(a: Padded, b: Padded) -> f32 {
    total((a - b) * (a - b))
}

/// The values of a row of pixels, with its first and last pixel repeated.
fn bordered(row: &[Colour]) -> Vec<f32> {
    let (first, last) = (row.first().copied().unwrap_or_default(), row.last().copied().unwrap_or_default());
    [&[first], row, &[last]].concat().into_flattened()
}

/// Colours and Scharr slopes of the middle one of three bordered rows, value by value.
#[inline(always)]
fn quantise([above, here, below]: [&[f32]; 3], [colours, along, down]: &mut [Vec<i16>; 3]) {
    let count = colours.len();
    let [above, here, below] = [above, here, below].map(|row| &row[..count + 6]);
    let (along, down) = (&mut along[..count], &mut down[..count]);
    for (i, colour) in colours.iter_mut().enumerate() {
        let column = |i: usize| 3.0 * above[i] + 10.0 * here[i] + 3.0 * below[i];
        let across = |row: &[f32]| 3.0 * row[i] + 10.0 * row[i + 3] + 3.0 * row[i + 6];
        *colour = fraction(here[i + 3]);
        along[i] = fraction((column(i + 6) - column(i)) / 32.0);
        down[i] = fraction((across(below) - across(above)) / 32.0);
    }
}

/// Rounds half away from zero. The standard `round` would be a function call per value.
#[inline(always)]
fn fraction(value: f32) -> i16 {
    let scaled = value * UNIT;
    (scaled + 0.5f32.copysign(scaled)) as i16
}

/// The pixels of a row from their values, with the last one repeated.
#[inline(always)]
fn interleave(planes: &[Vec<i16>; 3], pixels: &mut [Pixel]) {
    let [colours, along, down] = planes.each_ref().map(|plane| plane.as_chunks::<3>().0);
    for (pixel, ((c, x), y)) in pixels.iter_mut().zip(colours.iter().zip(along).zip(down)) {
        *pixel = [c[0], c[1], c[2], 0, x[0], x[1], x[2], 0, y[0], y[1], y[2], 0];
    }
    if let [.., last, behind] = pixels {
        *behind = *last;
    }
}

fn blur(picture: &Raster<Colour>, sigma: f64) -> Raster<Colour> {
    gaussian::blur(picture, sigma, Border::Replicate)
}

/// A picture with pixels `factor` times as large. A factor below 1 enlarges the picture, which happens for few lines.
fn reduce(picture: &Raster<Colour>, factor: f64) -> Raster<Colour> {
    if factor >= 1.0 {
        return resize::reduce(picture, factor);
    }
    let enlarged = |length: usize| (length as f64 / factor).ceil() as usize;
    resize::resize(picture, enlarged(picture.width()), enlarged(picture.height()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_reads_its_value_and_slope_at_every_level() {
        let picture = Raster::from_fn(270, 540, |x, y| [(x as f32 + 0.5) / 600.0, (y as f32 + 0.5) / 600.0, 0.25]);
        let features = Features::new(&picture);
        for level in &features.levels {
            let p = Point::new(130.0, 250.0);
            let s = level.sample(p);
            let slope = 1.0 / 600.0;
            let got = [s.colour, s.slopes[0], s.slopes[1]].map(|v| v.to_array()).concat();
            let want = [130.0 * slope, 250.0 * slope, 0.25, 0.0, slope, 0.0, 0.0, 0.0, 0.0, slope, 0.0, 0.0];
            for k in 0..12 {
                assert!((got[k] - want[k]).abs() < 2e-4, "level {} value {k}: {} for {}", level.size, got[k], want[k]);
            }
        }
    }

    /// A plain version of how a level is read.
    fn read_naively(level: &Level, p: Point) -> [f64; 12] {
        let (width, height) = level.dimensions();
        let at = |length: f64, count: usize| (length / level.size - 0.5).clamp(0.0, (count - 1) as f64);
        let (x, y) = (at(p.x, width), at(p.y, height));
        let pixel = |x: f64, y: f64, k: usize| {
            f64::from(level.raster.get((x as usize).min(width - 1), (y as usize).min(height - 1))[k])
        };
        std::array::from_fn(|k| {
            let row = |y: f64| pixel(x, y, k) * (1.0 - x.fract()) + pixel(x + 1.0, y, k) * x.fract();
            let value = row(y) * (1.0 - y.fract()) + row(y + 1.0) * y.fract();
            value / f64::from(UNIT) / if k < 4 { 1.0 } else { level.size }
        })
    }

    #[test]
    fn all_read_functions_agree() {
        let picture = Raster::from_fn(331, 270, |x, y| [3, 5, 7].map(|k| ((x * k + y * 11) as f32 * 0.1).sin().abs()));
        let features = Features::new(&picture);
        let (first, step) = (Point::new(-31.0, 17.3), Point::new(7.9, 5.1));
        for level in &features.levels {
            let mut planes = [(); 3].map(|()| vec![0.0; 109]);
            level.colours_along(first, step, planes.each_mut().map(|plane| &mut plane[..]));
            for k in 0..109 {
                let p = first + step * k as f64;
                let (want, sample, colour) = (read_naively(level, p), level.sample(p), level.colour(p));
                let got = [sample.colour, sample.slopes[0], sample.slopes[1]].map(|v| v.to_array()).concat();
                let along = planes.each_ref().map(|plane| plane[k]);
                let near = |got: f32, want: f64| (f64::from(got) - want).abs() < 2e-4;
                assert!(got.iter().zip(want).all(|(g, w)| near(*g, w)), "{p}: {got:?} for {want:?}");
                assert!(colour.to_array().iter().zip(want).all(|(g, w)| near(*g, w)), "{p}: {colour} for {want:?}");
                assert!(along.iter().zip(want).all(|(g, w)| near(*g, w)), "{p}: {along:?} for {want:?}");
            }
        }
    }

    #[test]
    fn pictures_of_any_size_have_features() {
        for (width, height) in [(1, 1), (3, 700), (100, 2)] {
            let features = Features::new(&Raster::new(width, height, [1.0, 0.5, 0.0]));
            let s = features.level(0).sample(Point::new(1e6, -1e6));
            assert!((s.colour.x - 1.0).abs() < 1e-3 && s.slopes[0].x.abs() < 1e-3);
        }
    }
}
