//! Exact Euclidean distances to the pixels outside of a mask (Felzenszwalb & Huttenlocher 2012).
//!
//! First each column gets the distance to the nearest pixel outside, in two sweeps. Then each row takes the lower envelope
//! of the parabolas of its columns. Time is linear in the number of pixels. The picture's border counts as outside.

use rayon::prelude::{ParallelIterator, ParallelSliceMut};
use rototoon_base::scene::Raster;

/// The distance in pixels from the centre of each pixel of the mask to the nearest centre outside of it; 0 outside.
pub fn inside(mask: &Raster<bool>) -> Raster<f32> {
    let (width, height) = (mask.width(), mask.height());
    let mut columns = Raster::new(width, height, 0.0f32);
    if width == 0 || height == 0 {
        return columns;
    }
    let data = columns.data_mut();
    for y in 0..height {
        for x in 0..width {
            let above = if y == 0 { 0.0 } else { data[(y - 1) * width + x] };
            data[y * width + x] = if mask.get(x, y) { above + 1.0 } else { 0.0 };
        }
    }
    for y in (0..height).rev() {
        for x in 0..width {
            let below = if y + 1 == height { 0.0 } else { data[(y + 1) * width + x] };
            let here = &mut data[y * width + x];
            *here = here.min(below + 1.0);
        }
    }
    data.par_chunks_mut(width).for_each_init(|| Envelope::new(width), |envelope, row| envelope.row(row));
    columns
}

/// The lower envelope of the parabolas of a row, with its memory.
struct Envelope {
    /// Columns of the parabolas, from left to right. Column -1 and the column behind the row are outside.
    at: Vec<f32>,
    height: Vec<f32>,
    /// Where each parabola begins to be the lowest.
    from: Vec<f32>,
}

impl Envelope {
    fn new(width: usize) -> Self {
        let room = || Vec::with_capacity(width + 2);
        Self { at: room(), height: room(), from: room() }
    }

    fn row(&mut self, row: &mut [f32]) {
        if row.iter().all(|&d| d == 0.0) {
            return;
        }
        self.at.clear();
        self.height.clear();
        self.from.clear();
        self.add(-1.0, 0.0);
        for (x, &d) in row.iter().enumerate() {
            self.add(x as f32, d * d);
        }
        self.add(row.len() as f32, 0.0);
        let mut k = 0;
        for (x, out) in row.iter_mut().enumerate() {
            let x = x as f32;
            while k + 1 < self.from.len() && self.from[k + 1] <= x {
                k += 1;
            }
            *out = ((x - self.at[k]).powi(2) + self.height[k]).sqrt();
        }
    }

    fn add(&mut self, x: f32, height: f32) {
        let mut from = f32::NEG_INFINITY;
        while let (Some(&at), Some(&own), Some(&start)) = (self.at.last(), self.height.last(), self.from.last()) {
            from = 0.5 * ((height - own) / (x - at) + x + at);
            if from > start {
                break;
            }
            self.at.pop();
            self.height.pop();
            self.from.pop();
            from = f32::NEG_INFINITY;
        }
        self.at.push(x);
        self.height.push(height);
        self.from.push(from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_a_search_over_all_pixels() {
        let (width, height) = (23i32, 17i32);
        let mut seed = 7u32;
        let mask = Raster::from_fn(width as usize, height as usize, |_, _| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 28 > 1
        });
        let outside =
            |x: i32, y: i32| !(0..width).contains(&x) || !(0..height).contains(&y) || !mask.get(x as usize, y as usize);
        let found = inside(&mask);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let all = (-1..=height).flat_map(|v| (-1..=width).map(move |u| (u, v)));
            let least =
                all.filter(|&(u, v)| outside(u, v)).map(|(u, v)| (u - x).pow(2) + (v - y).pow(2)).min().unwrap();
            let (got, expected) = (found.get(x as usize, y as usize), (least as f32).sqrt());
            assert!((got - expected).abs() < 1e-4, "{x} {y}: {got}, expected {expected}");
        }
    }
}
