//! Ink: which pixels of a picture belong to drawn lines, and how certainly.
//!
//! 1. `paper` estimates the paper's colour behind each pixel. A pixel's *darkness* is the largest difference between the
//!    paper and the pixel over the colour channels, so that coloured lines count as much as black ones. Pencils that a user
//!    does not want are [left out](left_out) before.
//! 2. The *level* that separates ink from paper is Otsu's (1979): the split of the darknesses into two groups that differ
//!    most. A user moves it with one number, the [sensitivity](measure). It is not below a few times the grain, which is
//!    measured where the paper is empty.
//! 3. A pixel is ink if its darkness is above the level. A pixel slightly below it is ink too if it joins ink that is well
//!    above (hysteresis, Canny 1986). So faint ends of pencil lines stay, and specks of grain do not.
//! 4. Components smaller than a dot are dropped.
//!
//! **Limits.** A photograph has no paper; what is found then are its dark details.

pub mod discs;
pub mod distance;
mod left_out;
mod paper;
mod polarity;

use crate::stroke::Options;
use left_out::{Pencil, without};
use paper::{BLOCK, Paper};
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSliceMut};
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::gaussian::{Border, blur};

/// Blur before the threshold, in pixels. It takes the staircase out of lines without joining neighbours.
const BLUR: f64 = 0.6;
/// Share of Otsu's level that is used: the edge of a line is lighter than its centre.
const LOWER: f32 = 0.8;
/// Least darkness of ink.
const LEAST: f32 = 0.07;
/// Level in units of the grain's standard deviation, at least.
const GRAIN: f32 = 4.0;
/// Darkness of certain ink, and of ink that only continues it, in units of the level.
const CERTAIN: f32 = 1.25;
const FAINT: f32 = 0.85;
/// Least area of a component in pixels at 540 lines; it grows with the number of lines.
const DOT: f64 = 10.0;
/// Share of the ink that may be darker than what is taken to be the darkest.
const SPECKS: f64 = 0.02;
const BINS: usize = 256;

/// The ink of a picture.
#[derive(Clone, Debug)]
pub struct Ink {
    /// How much darker than the paper each pixel is, 0 to 1, slightly blurred. Light lines on dark paper count as dark.
    pub darkness: Raster<f32>,
    /// The darkness from which a pixel is ink.
    pub level: f32,
    /// How dark the darkest ink of the picture is, without the blur. A few darker specks do not count.
    pub darkest: f32,
    /// The pixels of ink.
    pub mask: Raster<bool>,
    /// Distance of each pixel of ink from the nearest pixel without ink.
    pub depth: Raster<f32>,
}

impl Ink {
    /// The probability that pixel (`x`, `y`) is ink: 1/2 at the level.
    pub fn probability(&self, x: usize, y: usize) -> f32 {
        let ratio = self.darkness.get(x, y) / self.level;
        ratio.powi(4) / (1.0 + ratio.powi(4))
    }

    /// The ink of a changed mask.
    pub fn with_mask(self, mask: Raster<bool>) -> Self {
        Self { depth: distance::inside(&mask), mask, ..self }
    }
}

/// Whether lines of a colour can be left out. A grey cannot: it has no hue by which it could be told from the lines that are wanted.
pub fn can_leave_out(colour: Colour) -> bool {
    colour.iter().all(|value| value.is_finite()) && Pencil::new(colour, false).is_some()
}

/// Finds the ink of a picture. A sensitivity of 1 takes the level as it is found; 2 halves it. Pencils that are left out count for
/// nothing.
pub fn measure(picture: &Raster<Colour>, options: &Options) -> Ink {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        let (darkness, mask) = (Raster::new(0, 0, 0.0), Raster::new(0, 0, false));
        return Ink { depth: darkness.clone(), darkness, level: 1.0, darkest: 1.0, mask };
    }
    let paper = paper::estimate(picture);
    let pencils: Vec<Pencil> = options.leave_out.iter().filter_map(|&own| Pencil::new(own, paper.dark)).collect();
    let hard = darkness(picture, &paper, &pencils);
    drop(paper);
    let sharp = histogram(&hard);
    let darkness = blur(&hard, BLUR, Border::Replicate);
    drop(hard);
    let level = (level(&darkness) / options.sensitivity.max(1e-3) as f32).clamp(1e-3, 10.0);
    let mut mask = hysteresis(&darkness, level);
    let area = (DOT * height as f64 / 540.0).clamp(4.0, 60.0) as usize;
    without_specks(&mut mask, area);
    Ink { depth: distance::inside(&mask), darkness, level, darkest: darkest(&sharp, level), mask }
}

fn darkness(picture: &Raster<Colour>, paper: &Paper, pencils: &[Pencil]) -> Raster<f32> {
    let (width, height) = (picture.width(), picture.height());
    let mut out = Raster::new(width, height, 0.0f32);
    let blocks = &paper.blocks;
    let place = |i: usize, count: usize| {
        let at = ((i as f32 + 0.5) / BLOCK as f32 - 0.5).clamp(0.0, (count - 1) as f32);
        (at as usize, (at as usize + 1).min(count - 1), at.fract())
    };
    out.data_mut().par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let (above, below, v) = place(y, blocks.height());
        let mixed = |a: Colour, b: Colour, t: f32| [0, 1, 2].map(|c| a[c] + t * (b[c] - a[c]));
        let line: Vec<Colour> =
            blocks.row(above).iter().zip(blocks.row(below)).map(|(&a, &b)| mixed(a, b, v)).collect();
        for (x, out) in row.iter_mut().enumerate() {
            let (left, right, u) = place(x, line.len());
            let (behind, own) = (mixed(line[left], line[right], u), picture.get(x, y));
            let mut own = if paper.dark { own.map(|value| 1.0 - value) } else { own };
            if !pencils.is_empty() {
                own = without(pencils, behind, own);
            }
            let channel = |c: usize| behind[c] - own[c];
            let value = channel(0).max(channel(1)).max(channel(2));
            *out = if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        }
    });
    out
}

fn histogram(darkness: &Raster<f32>) -> [u64; BINS] {
    let mut histogram = [0u64; BINS];
    for &d in darkness.data() {
        histogram[(d * (BINS - 1) as f32 + 0.5) as usize] += 1;
    }
    histogram
}

/// The darkness that all but the darkest [`SPECKS`] of the ink do not exceed.
fn darkest(histogram: &[u64; BINS], level: f32) -> f32 {
    let ink = || (0..BINS).map(|i| (i as f32 / (BINS - 1) as f32, histogram[i])).filter(|&(dark, _)| dark > level);
    let most = SPECKS * ink().map(|(_, count)| count).sum::<u64>() as f64;
    let mut seen = 0;
    let found = Vec::from_iter(ink()).into_iter().rev().find(|&(_, count)| (seen += count, seen as f64 > most).1);
    found.map_or(1.0, |(dark, _)| dark)
}

/// The darkness that separates ink from paper.
fn level(darkness: &Raster<f32>) -> f32 {
    let histogram = histogram(darkness);
    (LOWER * otsu(&histogram)).max(LEAST).max(GRAIN * grain(&histogram))
}

/// The split of a histogram with the largest variance between its two sides.
fn otsu(histogram: &[u64; BINS]) -> f32 {
    let count: u64 = histogram.iter().sum();
    let sum: f64 = histogram.iter().enumerate().map(|(i, &n)| i as f64 * n as f64).sum();
    let (mut below, mut below_sum, mut best) = (0u64, 0.0, (0.0, 0usize));
    for (i, &n) in histogram.iter().enumerate() {
        below += n;
        below_sum += i as f64 * n as f64;
        let above = count - below;
        if below == 0 || above == 0 {
            continue;
        }
        let apart = below_sum / below as f64 - (sum - below_sum) / above as f64;
        let between = below as f64 * above as f64 * apart * apart;
        if between > best.0 {
            best = (between, i);
        }
    }
    (best.1 as f32 + 0.5) / (BINS - 1) as f32
}

/// The standard deviation of the empty paper: of the lower half of the darknesses, as of a normal distribution cut at its
/// mean.
fn grain(histogram: &[u64; BINS]) -> f32 {
    let count: u64 = histogram.iter().sum();
    let quantile = |share: f64| {
        let mut seen = 0;
        histogram.iter().position(|&n| (seen += n, seen as f64 >= share * count as f64).1).unwrap_or(0) as f32
    };
    (quantile(0.5) - quantile(0.16)) / (BINS - 1) as f32
}

fn hysteresis(darkness: &Raster<f32>, level: f32) -> Raster<bool> {
    let (width, height) = (darkness.width(), darkness.height());
    let mut mask = darkness.map(|d| d > level * CERTAIN);
    let mut open: Vec<usize> = (0..mask.data().len()).filter(|&i| mask.data()[i]).collect();
    while let Some(i) = open.pop() {
        let (x, y) = (i % width, i / width);
        for v in y.saturating_sub(1)..(y + 2).min(height) {
            for u in x.saturating_sub(1)..(x + 2).min(width) {
                if !mask.get(u, v) && darkness.get(u, v) > level * FAINT {
                    mask.set(u, v, true);
                    open.push(v * width + u);
                }
            }
        }
    }
    mask
}

/// Removes components of fewer than `least` pixels.
fn without_specks(mask: &mut Raster<bool>, least: usize) {
    let (width, height) = (mask.width(), mask.height());
    let mut seen = vec![false; width * height];
    let mut component = Vec::new();
    for start in 0..width * height {
        if seen[start] || !mask.data()[start] {
            continue;
        }
        component.clear();
        component.push(start);
        seen[start] = true;
        let mut next = 0;
        while next < component.len() {
            let (x, y) = (component[next] % width, component[next] / width);
            next += 1;
            for v in y.saturating_sub(1)..(y + 2).min(height) {
                for u in x.saturating_sub(1)..(x + 2).min(width) {
                    let i = v * width + u;
                    if !seen[i] && mask.data()[i] {
                        seen[i] = true;
                        component.push(i);
                    }
                }
            }
        }
        if component.len() < least {
            component.iter().for_each(|&i| mask.data_mut()[i] = false);
        }
    }
}
