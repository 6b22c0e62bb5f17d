//! What the tracker computes once from a picture: a pyramid of colours with their gradients.
//!
//! All lengths of the tracker are in **working pixels**: the picture scaled to 540 lines. A level l of the pyramid has
//! pixels of l × l working pixels. It is smoothed by a Gaussian of σ = l/2 before it is reduced; its gradients are
//! Scharr's (weights 3, 10, 3; divided by 32), which turn with the picture better than plain differences.
//!
//! Values are kept as 16-bit fractions of ±1: colours lie in 0 to 1 and a Scharr gradient of such colours within ±0.5,
//! so the step of 3e-5 is far below the noise of 8-bit pictures, and a frame needs 4 MB instead of 8.

use crate::geometry::Point;
use crate::image::gaussian::{self, Border};
use crate::image::resize;
use crate::numeric::vector::vectorised;
use crate::scene::{Colour, Raster};

/// Lines of the picture in working pixels.
pub const WORKING_LINES: f64 = 540.0;

/// Working pixels in a pixel of each level, from coarse to fine.
pub const LEVELS: [usize; 3] = [8, 4, 2];

/// Three values of a colour, and a zero behind them: four are worked on at once.
pub type Padded = glam::Vec4;

/// What is read at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Colour.
    pub colour: Padded,
    /// Its derivatives along x and y, per working pixel.
    pub slopes: [Padded; 2],
}

/// Colour and both slopes of a pixel, each with a zero behind.
type Pixel = [i16; 12];

const UNIT: f32 = 32767.0;

/// Picture pixels in one working pixel.
pub fn working_scale(height: usize) -> f64 {
    height as f64 / WORKING_LINES
}

/// One level of the pyramid.
#[derive(Clone, Debug)]
pub struct Level {
    /// Working pixels in a pixel, across and down: the last row and column reach over the picture's edge.
    size: f64,
    raster: Raster<Pixel>,
}

/// The pyramid of a picture.
#[derive(Clone, Debug)]
pub struct Features {
    levels: [Level; 3],
}

impl Features {
    /// Builds the pyramid of a picture of any size.
    pub fn new(picture: &Raster<Colour>) -> Self {
        let scale = working_scale(picture.height());
        // Each level is made from the finer one: of the wanted variance (l/2)², half of it squared is there already.
        let fine = reduce(&blur(picture, scale), 2.0 * scale);
        let again = 0.75f64.sqrt();
        let middle = reduce(&blur(&fine, again), 2.0);
        let coarse = reduce(&blur(&middle, again), 2.0);
        Self { levels: [Level::new(&coarse, 8.0), Level::new(&middle, 4.0), Level::new(&fine, 2.0)] }
    }

    /// The level of index `index` in [`LEVELS`].
    pub fn level(&self, index: usize) -> &Level {
        &self.levels[index]
    }

    /// Bytes kept.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.raster.data())).sum()
    }
}

impl Level {
    fn new(colours: &Raster<Colour>, size: f64) -> Self {
        let (width, height) = (colours.width(), colours.height());
        let lines: Vec<Vec<f32>> = (0..height).map(|y| bordered(colours.row(y))).collect();
        let mut raster = Raster::new(width, height, [0; 12]);
        vectorised(
            #[inline(always)]
            || {
                let mut planes = [(); 3].map(|()| vec![0i16; 3 * width]);
                for y in 0..height {
                    let near = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| &lines[y][..]);
                    quantise(near, &mut planes);
                    interleave(&planes, raster.row_mut(y));
                }
            },
        );
        Self { size, raster }
    }

    /// Bilinear reading at `p` in working pixels; outside the picture the nearest edge is read.
    #[inline(always)]
    pub fn sample(&self, p: Point) -> Sample {
        let (corners, weights) = self.around(p);
        let slope = weights.map(|w| w * (1.0 / (UNIT * self.size as f32)));
        let slopes = [1, 2].map(|group| mixed(&corners, &slope, group));
        Sample { colour: mixed(&corners, &weights.map(|w| w * (1.0 / UNIT)), 0), slopes }
    }

    /// The four pixels around `p` and their bilinear weights.
    #[inline(always)]
    fn around(&self, p: Point) -> ([&Pixel; 4], [f32; 4]) {
        let (width, height) = (self.raster.width(), self.raster.height());
        // The size is a power of two: to multiply by its inverse is to divide.
        let inverse = 1.0 / self.size;
        let x = (p.x * inverse - 0.5).clamp(0.0, (width - 1) as f64);
        let y = (p.y * inverse - 0.5).clamp(0.0, (height - 1) as f64);
        // Through 32 bits: the processor has one instruction for that.
        let (x0, y0) = (x as i32 as usize, y as i32 as usize);
        let (x1, y1) = ((x0 + 1).min(width - 1), (y0 + 1).min(height - 1));
        let (fx, fy) = ((x - x0 as f64) as f32, (y - y0 as f64) as f32);
        let data = self.raster.data();
        let at = |x: usize, y: usize| &data[y * width + x];
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        ([at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1)], weights)
    }

    /// Colour at `p` in working pixels, as [`Level::sample`] reads it.
    #[inline(always)]
    pub fn colour(&self, p: Point) -> Padded {
        let (corners, weights) = self.around(p);
        mixed(&corners, &weights.map(|w| w * (1.0 / UNIT)), 0)
    }

    /// Working pixels in a pixel of this level.
    pub fn pixel(&self) -> f64 {
        self.size
    }

    /// Width and height in pixels of this level.
    pub fn dimensions(&self) -> (usize, usize) {
        (self.raster.width(), self.raster.height())
    }

    /// The largest difference of a colour value to another picture's level; infinite where their sizes differ.
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
        self.raster.map(|v| (0.299 * f32::from(v[0]) + 0.587 * f32::from(v[1]) + 0.114 * f32::from(v[2])) / UNIT)
    }
}

/// A group of four values of the pixels around a place, in their bilinear mixture.
#[inline(always)]
fn mixed(corners: &[&Pixel; 4], weights: &[f32; 4], group: usize) -> Padded {
    let value = |corner: usize| Padded::from_array(corners[corner].as_chunks::<4>().0[group].map(f32::from));
    let [a, b, c, d] = [0, 1, 2, 3].map(|corner| value(corner) * weights[corner]);
    (a + b) + (c + d)
}

/// Sum of the four values.
#[inline(always)]
pub fn total(values: Padded) -> f32 {
    (values.x + values.y) + (values.z + values.w)
}

/// Squared difference of two colours.
#[inline(always)]
pub fn difference(a: Padded, b: Padded) -> f32 {
    total((a - b) * (a - b))
}

/// The values of a row of pixels, its first and last pixel twice.
fn bordered(row: &[Colour]) -> Vec<f32> {
    let (first, last) = (row.first().copied().unwrap_or_default(), row.last().copied().unwrap_or_default());
    [&[first], row, &[last]].concat().into_flattened()
}

/// Colours and slopes (Scharr's) of the middle one of three bordered rows, value by value.
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

/// Rounded half away from zero; `round` itself would be a call for each value.
#[inline(always)]
fn fraction(value: f32) -> i16 {
    let scaled = value * UNIT;
    (scaled + 0.5f32.copysign(scaled)) as i16
}

/// The pixels of a row from their values.
#[inline(always)]
fn interleave(planes: &[Vec<i16>; 3], pixels: &mut [Pixel]) {
    let [colours, along, down] = planes.each_ref().map(|plane| plane.as_chunks::<3>().0);
    for (pixel, ((c, x), y)) in pixels.iter_mut().zip(colours.iter().zip(along).zip(down)) {
        *pixel = [c[0], c[1], c[2], 0, x[0], x[1], x[2], 0, y[0], y[1], y[2], 0];
    }
}

fn blur(picture: &Raster<Colour>, sigma: f64) -> Raster<Colour> {
    gaussian::blur(picture, sigma, Border::Replicate)
}

/// A picture with pixels `factor` times as large. One of few lines is enlarged.
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

    #[test]
    fn pictures_of_any_size_have_features() {
        for (width, height) in [(1, 1), (3, 700), (1000, 2)] {
            let features = Features::new(&Raster::new(width, height, [1.0, 0.5, 0.0]));
            let s = features.level(0).sample(Point::new(1e6, -1e6));
            assert!((s.colour.x - 1.0).abs() < 1e-3 && s.slopes[0].x.abs() < 1e-3);
        }
    }
}
