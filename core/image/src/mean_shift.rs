//! The mean-shift filter: it flattens colours and keeps edges.
//!
//! Every pixel starts a walk in position and colour together. It looks at the pixels in the window around it whose
//! colours are nearer than the range, and moves to their mean place and mean colour. This repeats until it stands
//! still. The pixel then takes the colour where the walk ends. Noise of paint and compression disappears, ink stays.
//! Source: Comaniciu & Meer, "Mean shift: a robust approach toward feature space analysis", PAMI 2002, §3 and the
//! filtering of §4.1, with the flat kernel.
//!
//! **From coarse to fine.** The walk is done on a picture halved `levels` times, and the result is enlarged. On the
//! next finer level only the pixels near a colour border walk again, because inside a flat colour the enlarged result
//! is already right. Steps, rounding and the stopping rule are those of OpenCV's `pyrMeanShiftFiltering`, so its
//! parameters (`sp`, `sr`, `maxLevel`) have the same meaning here. Three things differ. The number of pixels near a
//! colour border is the same on both sides of it. The pixels at the border of the picture are included. On a coarser
//! level the halved radius is rounded once, so all windows have the same size.
//!
//! **Speed.** The colours are 8-bit integers in three planes of `i16`. The planes have a frame with a colour far from
//! every other colour. A window is therefore read in complete rows of 16 pixels without a test for the border of the
//! picture. Its sums are lanes of 16-bit integers, which are exact in any order. Rows of the picture are independent
//! and run in parallel.
//!
//! Limits: colours are rounded to 8 bits, and values outside 0 to 1 are clamped. The range is at most 100 levels and
//! the radius at most 60 pixels, because 16 bits have no room for more. Larger values are reduced to these limits.

use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSlice, ParallelSliceMut};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::{Colour, Raster};

/// Options of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeanShiftOptions {
    /// Half the side of the window in pixels, 1 to 60: the window has 2 · `radius` + 1 pixels on each side.
    pub radius: usize,
    /// Largest Euclidean distance of near colours, in 8-bit levels, 0 to 100.
    pub range: usize,
    /// Number of times that the picture is halved first. With 0 every pixel walks at full size.
    pub levels: usize,
    /// Largest number of steps of a walk.
    pub steps: usize,
}

impl Default for MeanShiftOptions {
    /// Radius 5, range 20, one halving, 5 steps: OpenCV's defaults for the last two.
    fn default() -> Self {
        Self { radius: 5, range: 20, levels: 1, steps: 5 }
    }
}

/// A colour in 8-bit levels.
type Levels = [u8; 3];

/// A walk stands still when its change is at most this: the squared change of colour plus the steps in position.
const REST: i32 = 1;

/// Smallest squared distance that makes a colour border between neighbours on the coarser level.
const LEAST_BORDER: i32 = 16;

/// The picture filtered, rounded to 8 bits per channel. Colours are sRGB-encoded, 0 to 1.
pub fn mean_shift(picture: &Raster<Colour>, options: &MeanShiftOptions) -> Raster<Colour> {
    let round = |v: f32| (255.0 * v.clamp(0.0, 1.0) + 0.5) as i32 as u8;
    let levels = converted(picture, round);
    converted(&mean_shift_levels(&levels, options), |v| v as f32 / 255.0)
}

/// Converts every channel of every pixel.
fn converted<A, B>(picture: &Raster<[A; 3]>, convert: impl Fn(A) -> B + Sync) -> Raster<[B; 3]>
where
    A: Copy + Sync,
    B: Copy + Default + Send,
{
    let mut out = Raster::new(picture.width(), picture.height(), [B::default(); 3]);
    let pieces = out.data_mut().par_chunks_mut(PIECE).zip(picture.data().par_chunks(PIECE));
    pieces.for_each(|(out, pixels)| {
        vectorised(
            #[inline(always)]
            || {
                for (out, &value) in out.as_flattened_mut().iter_mut().zip(pixels.as_flattened()) {
                    *out = convert(value);
                }
            },
        );
    });
    out
}

/// The picture of 8-bit levels, filtered.
pub fn mean_shift_levels(picture: &Raster<Levels>, options: &MeanShiftOptions) -> Raster<Levels> {
    if picture.data().is_empty() {
        return picture.clone();
    }
    let mut halves: Vec<Raster<Levels>> = Vec::new();
    while halves.len() < options.levels {
        let last = halves.last().unwrap_or(picture);
        if last.width() < 2 || last.height() < 2 {
            break;
        }
        let half = halve(last);
        halves.push(half);
    }
    let range = options.range.min(100) as i32;
    let walk = |level: usize, source| {
        let radius = (options.radius as f64 / (1u64 << level.min(60)) as f64).round_ties_even() as usize;
        Walk::new(source, radius.clamp(1, 60), range, options.steps)
    };
    let top = halves.len();
    let mut result = walk(top, halves.last().unwrap_or(picture)).filter(None);
    for level in (0..top).rev() {
        let source = if level == 0 { picture } else { &halves[level - 1] };
        let near = near_borders(&result, source.width(), source.height(), range);
        let enlarged = double(&result, source.width(), source.height());
        result = walk(level, source).filter(Some((enlarged, &near)));
    }
    result
}

/// Number of pixels in one conversion task.
const PIECE: usize = 1 << 14;

/// Number of pixels in a lane group.
const LANES: usize = 16;

/// A value far from every colour, for any range.
const FAR: i16 = -1000;

/// A picture prepared for walks.
struct Walk<'a> {
    source: &'a Raster<Levels>,
    planes: [Vec<i16>; 3],
    stride: usize,
    radius: usize,
    range: i32,
    steps: usize,
}

/// Sums over the near pixels of a window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Sums {
    count: i32,
    colour: [i32; 3],
    /// Relative to the window's left column.
    x: i32,
    /// Relative to the window's top row.
    y: i32,
}

impl<'a> Walk<'a> {
    fn new(source: &'a Raster<Levels>, radius: usize, range: i32, steps: usize) -> Self {
        let groups = (2 * radius + 1).div_ceil(LANES);
        let stride = source.width() + groups * LANES;
        let mut planes = [0, 1, 2].map(|_| vec![FAR; stride * (source.height() + 2 * radius)]);
        for y in 0..source.height() {
            for (x, colour) in source.row(y).iter().enumerate() {
                for (plane, &value) in planes.iter_mut().zip(colour) {
                    plane[(y + radius) * stride + x + radius] = value as i16;
                }
            }
        }
        Self { source, planes, stride, radius, range, steps }
    }

    /// Walks from every pixel, or from the marked pixels only. The others keep the given colour.
    fn filter(&self, known: Option<(Raster<Levels>, &Raster<bool>)>) -> Raster<Levels> {
        let (mut out, marked) = match known {
            Some((colours, marked)) => (colours, Some(marked)),
            None => (self.source.clone(), None),
        };
        out.data_mut().par_chunks_mut(self.source.width()).enumerate().for_each(|(y, row)| {
            vectorised(
                #[inline(always)]
                || {
                    for (x, colour) in row.iter_mut().enumerate() {
                        if marked.is_none_or(|marked| marked.get(x, y)) {
                            *colour = self.end_of(x, y);
                        }
                    }
                },
            );
        });
        out
    }

    /// The colour where the walk from a pixel ends.
    #[inline(always)]
    fn end_of(&self, x: usize, y: usize) -> Levels {
        let (mut x, mut y) = (x as i32, y as i32);
        let mut colour = self.source.get(x as usize, y as usize).map(i32::from);
        for _ in 0..self.steps {
            let sums = self.window(x as usize, y as usize, colour);
            if sums.count == 0 {
                break;
            }
            let share = 1.0 / sums.count as f64;
            let mean = |sum: i32| (sum as f64 * share).round_ties_even() as i32;
            // Means are rounded as places in the picture; a half goes to the even number.
            let from_window = |sum: i32, at: i32| mean(sum + sums.count * (at - self.radius as i32));
            let (to_x, to_y) = (from_window(sums.x, x), from_window(sums.y, y));
            let to = sums.colour.map(mean);
            let moved = (to_x - x).abs() + (to_y - y).abs();
            let changed: i32 = to.iter().zip(colour).map(|(a, b)| (a - b) * (a - b)).sum();
            (x, y, colour) = (to_x, to_y, to);
            if moved == 0 || moved + changed <= REST {
                break;
            }
        }
        colour.map(|v| v as u8)
    }

    /// Sums over the pixels around (`x`, `y`) whose colours are near `colour`.
    #[inline(always)]
    fn window(&self, x: usize, y: usize, colour: [i32; 3]) -> Sums {
        let side = 2 * self.radius + 1;
        let colour = colour.map(|v| v as i16);
        let mut sums = Sums::default();
        for start in (0..side).step_by(LANES) {
            let lanes = LaneSums::over(self, y * self.stride + x + start, side.min(start + LANES) - start, colour);
            lanes.add_to(&mut sums, start as i32);
        }
        sums
    }
}

/// Sums of a column of lane groups, one for each lane.
#[derive(Default)]
struct LaneSums {
    count: [i16; LANES],
    colour: [[i16; LANES]; 3],
    y: [i16; LANES],
}

impl LaneSums {
    /// Sums over `columns` columns from index `at` of the planes, and over all rows of the window. A lane sums at most
    /// 121 values of 255, for which 16 bits are enough.
    #[inline(always)]
    fn over(walk: &Walk, at: usize, columns: usize, colour: [i16; 3]) -> Self {
        let mut sums = Self::default();
        let cap = (walk.range + 1) as i16;
        let limit = (walk.range * walk.range) as i16;
        let mut inside = [0i16; LANES];
        inside[..columns].fill(-1);
        for row in 0..2 * walk.radius + 1 {
            let from = at + row * walk.stride;
            let [p0, p1, p2] = [0, 1, 2].map(|c| &walk.planes[c][from..from + LANES]);
            // Plain loops and choices are used, because with little optimisation, as in tests, ranges and `min` are
            // function calls.
            let mut i = 0;
            while i < LANES {
                // Distances are clamped just beyond the range, so that three squares fit 16 bits.
                let square = |v: i16, c: i16| {
                    let d = if v > c { v - c } else { c - v };
                    let d = if d < cap { d } else { cap };
                    d * d
                };
                let distance = square(p0[i], colour[0]) + square(p1[i], colour[1]) + square(p2[i], colour[2]);
                let near = inside[i] & -i16::from(distance <= limit);
                sums.count[i] -= near;
                sums.colour[0][i] += near & p0[i];
                sums.colour[1][i] += near & p1[i];
                sums.colour[2][i] += near & p2[i];
                sums.y[i] += near & row as i16;
                i += 1;
            }
        }
        sums
    }

    #[inline(always)]
    fn add_to(&self, sums: &mut Sums, start: i32) {
        for i in 0..LANES {
            let count = self.count[i] as i32;
            sums.count += count;
            sums.x += count * (start + i as i32);
            sums.y += self.y[i] as i32;
            for c in 0..3 {
                sums.colour[c] += self.colour[c][i] as i32;
            }
        }
    }
}

/// Burt & Adelson's kernel for picture pyramids, times 16.
const KERNEL: [i32; 5] = [1, 4, 6, 4, 1];

/// The index mirrored at the border pixels.
fn mirrored(index: isize, len: usize) -> usize {
    super::gaussian::Border::Reflect101.index(index, len)
}

/// Half the size, rounded up, after filtering with the pyramid's kernel.
fn halve(picture: &Raster<Levels>) -> Raster<Levels> {
    let (width, height) = (picture.width(), picture.height());
    let mut out = Raster::new(width.div_ceil(2), height.div_ceil(2), [0; 3]);
    let small = out.width();
    // Two more pixels at each end, mirrored.
    let scratch = || vec![[0i32; 3]; width + 4];
    out.data_mut().par_chunks_mut(small).enumerate().for_each_init(scratch, |sums, (y, out)| {
        let rows = [-2, -1, 0, 1, 2].map(|k| picture.row(mirrored(2 * y as isize + k, height)).as_flattened());
        vectorised(
            #[inline(always)]
            || {
                let middle = &mut sums[2..width + 2];
                for (i, sum) in middle.as_flattened_mut().iter_mut().enumerate() {
                    *sum = (0..5).map(|k| KERNEL[k] * rows[k][i] as i32).sum();
                }
                for i in [-2, -1, width as isize, width as isize + 1] {
                    sums[(i + 2) as usize] = sums[2 + mirrored(i, width)];
                }
                for (taps, out) in sums.windows(5).step_by(2).zip(out) {
                    for c in 0..3 {
                        let sum: i32 = (0..5).map(|k| KERNEL[k] * taps[k][c]).sum();
                        out[c] = ((sum + 128) >> 8) as u8;
                    }
                }
            },
        );
    });
    out
}

/// The coarser rows that make a finer row, with the kernel's weights, which sum to 8. A finer row on a coarse row takes
/// the one before it, the row itself and the next. A finer row between two coarse rows takes these two; the first of
/// them is listed twice, once with weight 0. The same is valid for columns.
fn taps(index: usize, coarse: usize) -> [(usize, i32); 3] {
    let centre = (index / 2).min(coarse - 1);
    let next = (centre + 1).min(coarse - 1);
    if index % 2 == 1 {
        return [(centre, 0), (centre, 4), (next, 4)];
    }
    [(mirrored(centre as isize - 1, coarse), 1), (centre, 6), (next, 1)]
}

/// Enlarges to the given size, which is twice its own or one less, with the pyramid's kernel.
fn double(picture: &Raster<Levels>, width: usize, height: usize) -> Raster<Levels> {
    let coarse = picture.width();
    let mut out = Raster::new(width, height, [0; 3]);
    // One more pixel at each end.
    let scratch = || vec![[0i32; 3]; coarse + 2];
    out.data_mut().par_chunks_mut(width).enumerate().for_each_init(scratch, |sums, (y, out)| {
        let rows = taps(y, picture.height()).map(|(row, weight)| (picture.row(row).as_flattened(), weight));
        vectorised(
            #[inline(always)]
            || {
                let middle = &mut sums[1..=coarse];
                for (i, sum) in middle.as_flattened_mut().iter_mut().enumerate() {
                    *sum = rows.iter().map(|(row, weight)| weight * row[i] as i32).sum();
                }
                sums[0] = sums[1 + mirrored(-1, coarse)];
                sums[coarse + 1] = sums[coarse];
                for (near, pair) in sums.windows(3).zip(out.chunks_mut(2)) {
                    for c in 0..3 {
                        let on = near[0][c] + 6 * near[1][c] + near[2][c];
                        let between = 4 * (near[1][c] + near[2][c]);
                        for (out, sum) in pair.iter_mut().zip([on, between]) {
                            out[c] = ((sum + 32) >> 6) as u8;
                        }
                    }
                }
            },
        );
    });
    out
}

/// The pixels of the finer level near a colour border of the coarser one. They are around coarse pixels that differ
/// from one of their eight neighbours by at least the range.
fn near_borders(coarse: &Raster<Levels>, width: usize, height: usize, range: i32) -> Raster<bool> {
    let limit = (range * range).max(LEAST_BORDER);
    let mut marked = Raster::new(width, height, false);
    for y in 0..coarse.height() {
        for x in 0..coarse.width() {
            // Each pair of neighbours is visited once.
            for (i, j) in [(x + 1, y), (x.wrapping_sub(1), y + 1), (x, y + 1), (x + 1, y + 1)] {
                if i < coarse.width() && j < coarse.height() && distance(coarse.get(x, y), coarse.get(i, j)) >= limit {
                    mark_around(&mut marked, 2 * x, 2 * y);
                    mark_around(&mut marked, 2 * i, 2 * j);
                }
            }
        }
    }
    marked
}

/// Squared Euclidean distance of two colours.
fn distance(a: Levels, b: Levels) -> i32 {
    (0..3).map(|c| (a[c] as i32 - b[c] as i32).pow(2)).sum()
}

/// Marks the finer pixel at the place of a coarse pixel, and its eight neighbours.
fn mark_around(marked: &mut Raster<bool>, x: usize, y: usize) {
    let columns = x.saturating_sub(1)..(x + 2).min(marked.width());
    for j in y.saturating_sub(1)..(y + 2).min(marked.height()) {
        marked.row_mut(j)[columns.clone()].fill(true);
    }
}

#[cfg(test)]
mod tests;
