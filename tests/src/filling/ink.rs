//! The lines of a drawing, for its true regions.
//!
//! The benchmark finds lines with code of its own. Where the code under test overlooks a line or a gap, its regions differ from
//! these, and the figures show it.
//!
//! A pixel is ink if it is darker than the paper around it by more than a level: 0.8 times Otsu's (1979), at least 20 of 255. The paper is the median
//! brightness of about 160×160 pixels, the drawing is blurred by 0.7 px first, and specks of fewer than 12 pixels are dropped.

use rototoon::image::gaussian::{Border, blur};
use rototoon::image::resize::resize;
use rototoon::scene::Raster;

/// Side of the blocks in which the paper is estimated, in pixels.
const BLOCK: usize = 4;
/// Blocks to each side that count for the paper's median.
const REACH: isize = 20;
/// Blur of the drawing, in pixels.
const BLUR: f64 = 0.7;
/// Share of Otsu's level that makes ink.
const SHARE: f32 = 0.8;
/// Least level, of 255.
const LEAST: f32 = 20.0;
/// Least area of a line in pixels. What is smaller is a speck.
const SPECK: usize = 12;

/// Which pixels of a line drawing are ink: dark lines on lighter paper.
pub fn mask(lines: &Raster<u8>) -> Raster<bool> {
    let (width, height) = (lines.width(), lines.height());
    if width == 0 || height == 0 {
        return Raster::new(width, height, false);
    }
    let paper = resize(&paper(lines), width, height);
    let soft = blur(&lines.map(f32::from), BLUR, Border::Replicate);
    let dark = Raster::from_fn(width, height, |x, y| (paper.get(x, y) - soft.get(x, y)).clamp(0.0, 255.0));
    let level = (SHARE * otsu(&dark)).max(LEAST);
    let mut mask = dark.map(|value| value > level);
    for speck in components(&mask, true).into_iter().filter(|pixels| pixels.len() < SPECK) {
        speck.into_iter().for_each(|at| mask.data_mut()[at] = false);
    }
    mask
}

/// The sets of pixels of a mask that hang together by their sides, or by sides and corners. Pixels are given by their index.
pub fn components(mask: &Raster<bool>, corners: bool) -> Vec<Vec<usize>> {
    let (width, height) = (mask.width(), mask.height());
    let mut open = mask.data().to_vec();
    let mut found = Vec::new();
    for start in 0..open.len() {
        if !std::mem::take(&mut open[start]) {
            continue;
        }
        let mut pixels = vec![start];
        let mut next = 0;
        while next < pixels.len() {
            let (x, y) = (pixels[next] % width, pixels[next] / width);
            next += 1;
            for v in y.saturating_sub(1)..(y + 2).min(height) {
                for u in x.saturating_sub(1)..(x + 2).min(width) {
                    let beside = corners || u == x || v == y;
                    if beside && std::mem::take(&mut open[v * width + u]) {
                        pixels.push(v * width + u);
                    }
                }
            }
        }
        found.push(pixels);
    }
    found
}

/// The paper's brightness in each block: the median of the blocks around it.
fn paper(lines: &Raster<u8>) -> Raster<f32> {
    let (columns, rows) = (lines.width().div_ceil(BLOCK), lines.height().div_ceil(BLOCK));
    let small = resize(&lines.map(f32::from), columns, rows).map(|value| value.round() as u8);
    let mut paper = Raster::new(columns, rows, 0.0);
    for y in 0..rows {
        // The histogram of the blocks around slides along the row. At the picture's border its last blocks count again.
        let column = |x: isize, histogram: &mut [usize; 256], change: fn(usize) -> usize| {
            for v in y as isize - REACH..=y as isize + REACH {
                let count = &mut histogram[usize::from(small.clamped(x, v))];
                *count = change(*count);
            }
        };
        let mut histogram = [0; 256];
        (-REACH..=REACH).for_each(|x| column(x, &mut histogram, |count| count + 1));
        for x in 0..columns {
            paper.set(x, y, median(&histogram));
            column(x as isize - REACH, &mut histogram, |count| count - 1);
            column(x as isize + REACH + 1, &mut histogram, |count| count + 1);
        }
    }
    paper
}

fn median(histogram: &[usize; 256]) -> f32 {
    let half = histogram.iter().sum::<usize>() / 2;
    let mut seen = 0;
    let reached = |count: &usize| {
        seen += count;
        seen > half
    };
    histogram.iter().position(reached).unwrap_or(0) as f32
}

/// The level that splits values of 0 to 255 into two groups whose means differ most, weighted by their sizes.
fn otsu(values: &Raster<f32>) -> f32 {
    let mut histogram = [0.0f64; 256];
    values.data().iter().for_each(|&value| histogram[value as usize] += 1.0);
    let all: f64 = histogram.iter().sum();
    let sum: f64 = histogram.iter().enumerate().map(|(value, count)| value as f64 * count).sum();
    let (mut below, mut below_sum) = (0.0, 0.0);
    let mut best = (0.0, 0);
    for (value, count) in histogram.iter().enumerate() {
        below += count;
        below_sum += value as f64 * count;
        let above = all - below;
        if below > 0.0 && above > 0.0 {
            let apart = below_sum / below - (sum - below_sum) / above;
            let spread = below * above * apart * apart;
            best = if spread > best.0 { (spread, value) } else { best };
        }
    }
    best.1 as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_ink_and_shaded_paper_and_specks_are_not() {
        // Paper that gets darker to the right by more than faint lines do, with a line of 3 px and a speck of 4 pixels.
        let lines = Raster::from_fn(400, 200, |x, y| {
            let paper = 250.0 - 0.3 * x as f32;
            let ink = (60..63).contains(&y) || ((100..102).contains(&x) && (120..122).contains(&y));
            if ink { paper * 0.3 } else { paper }.round() as u8
        });
        let mask = mask(&lines);
        let inked = |x: usize| (0..200).filter(|&y| mask.get(x, y)).collect::<Vec<_>>();
        for x in [10, 100, 200, 390] {
            let (found, line) = (inked(x), [60, 61, 62]);
            // The blur may add a row on each side.
            let near = found.iter().all(|y| (59..=63).contains(y));
            assert!(near && line.iter().all(|y| found.contains(y)), "column {x}: {found:?}");
        }
    }

    #[test]
    fn corners_join_only_where_they_may() {
        let mask = Raster::from_fn(4, 4, |x, y| x == y);
        assert_eq!(components(&mask, true), [[0, 5, 10, 15]]);
        assert_eq!(components(&mask, false).len(), 4);
    }

    #[test]
    fn an_empty_picture_has_no_ink() {
        assert_eq!(mask(&Raster::new(0, 0, 0)).data().len(), 0);
        assert!(mask(&Raster::new(30, 20, 255)).data().iter().all(|ink| !ink));
    }
}
