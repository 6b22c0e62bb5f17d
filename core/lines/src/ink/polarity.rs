//! Whether the lines of a picture are lighter than the paper: chalk on a blackboard, white ink on a blueprint.
//!
//! How dark the picture is does not tell. The paper of a dim photograph is dark, and its pencil lines are darker; a blueprint is
//! not dark, and its lines are lighter. But lines are thin: the median of a window much wider than lines is the paper around
//! them, whatever side they are on. So the lines are light if more of the picture is lighter than this median than darker,
//! both weighted by the difference. What is wider than lines, such as shade, creases, painted regions and solid blacks, is the median of
//! its own surroundings, and counts for neither.
//!
//! A difference is the largest one over the channels, as for ink. It counts beyond what grain and the edges of paint leave. Where hardly anything counts,
//! the picture is blank, and more dark than light pixels make it dark.
//!
//! The window is the same part of each picture, and so is the number of readings in it. Larger pictures take no longer, but for one
//! look at each pixel.

use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::scene::{Colour, Raster};

/// Blocks along the picture's height.
const ROWS: usize = 90;
/// Half the window, in blocks. The window is wider than twice the broadest lines.
const RADIUS: usize = 5;
/// Readings along each side of a block.
const READINGS: usize = 4;
/// Difference from the paper beyond which a pixel counts, and the mean of what counts from which the picture is not blank.
const LEAST: f32 = 0.1;
const BLANK: f64 = 1e-5;
/// Value below which a pixel of a blank picture is dark.
const DARK: f32 = 0.35;

/// Whether the lines are light on dark paper.
pub fn is_dark(picture: &Raster<Colour>) -> bool {
    let (width, height) = (picture.width(), picture.height());
    let side = height.div_ceil(ROWS).max(1);
    let blocks = medians(picture, side);
    let paper = around(&blocks);
    let row = |y: usize| {
        picture.row(y).iter().enumerate().fold([0.0f64; 2], |[darker, lighter], (x, own)| {
            let behind = paper.get(x / side, y / side);
            let most = |sign: f32| (0..3).map(|c| sign * (behind[c] - own[c])).fold(0.0, f32::max) - LEAST;
            [darker + f64::from(most(1.0).max(0.0)), lighter + f64::from(most(-1.0).max(0.0))]
        })
    };
    let rows: Vec<[f64; 2]> = (0..height).into_par_iter().map(row).collect();
    // Added in the order of the rows, on any number of threads.
    let [darker, lighter] = rows.iter().fold([0.0; 2], |sum, row| [sum[0] + row[0], sum[1] + row[1]]);
    if darker.max(lighter) > BLANK * (width * height) as f64 { lighter > darker } else { is_mostly_dark(picture) }
}

fn is_mostly_dark(picture: &Raster<Colour>) -> bool {
    let dark = picture.data().iter().filter(|c| c[0].max(c[1]).max(c[2]) < DARK).count();
    2 * dark > picture.data().len()
}

/// The median of readings in each block, channel by channel.
fn medians(picture: &Raster<Colour>, side: usize) -> Raster<Colour> {
    let (width, height) = (picture.width(), picture.height());
    let readings = READINGS.min(side);
    let place =
        |block: usize, k: usize, length: usize| (block * side + (2 * k + 1) * side / (2 * readings)).min(length - 1);
    let (columns, rows) = (width.div_ceil(side), height.div_ceil(side));
    let read = |x: usize, y: usize| {
        let places = (0..readings * readings).map(|k| (place(x, k % readings, width), place(y, k / readings, height)));
        median(places.map(|(u, v)| picture.get(u, v)).collect())
    };
    collected(columns, rows, read)
}

/// The median of each block's window.
fn around(blocks: &Raster<Colour>) -> Raster<Colour> {
    let (columns, rows) = (blocks.width(), blocks.height());
    let span = |at: usize, length: usize| at.saturating_sub(RADIUS)..(at + RADIUS + 1).min(length);
    collected(columns, rows, |x, y| {
        median(span(y, rows).flat_map(|v| blocks.row(v)[span(x, columns)].iter().copied()).collect())
    })
}

fn collected(width: usize, height: usize, value: impl Fn(usize, usize) -> Colour + Sync) -> Raster<Colour> {
    let rows: Vec<Vec<Colour>> =
        (0..height).into_par_iter().map(|y| (0..width).map(|x| value(x, y)).collect()).collect();
    Raster::from_fn(width, height, |x, y| rows[y][x])
}

fn median(colours: Vec<Colour>) -> Colour {
    [0, 1, 2].map(|c| {
        let mut values: Vec<f32> = colours.iter().map(|colour| colour[c]).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f32::total_cmp).1
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring and a bar of a width in a picture of a height.
    fn drawing(height: usize, line: f64, ink: Colour, paper: impl Fn(f64, f64) -> Colour) -> Raster<Colour> {
        let scale = height as f64 / 300.0;
        Raster::from_fn(height * 4 / 3, height, |x, y| {
            let (u, v) = ((x as f64 + 0.5) / scale, (y as f64 + 0.5) / scale);
            let away = ((u - 150.0).hypot(v - 150.0) - 80.0).abs().min((v - 260.0).abs());
            if away < 0.5 * line { ink } else { paper(u, v) }
        })
    }

    #[test]
    fn light_lines_are_found_on_any_paper() {
        let papers = [[0.0; 3], [0.2; 3], [0.4; 3], [0.6; 3], [0.12, 0.24, 0.6], [0.08, 0.43, 0.24]];
        for (paper, height, line) in papers.into_iter().flat_map(|p| [(p, 300, 3.0), (p, 1000, 1.0), (p, 60, 6.0)]) {
            assert!(is_dark(&drawing(height, line, [0.95; 3], |_, _| paper)), "{paper:?} {height}");
        }
    }

    #[test]
    fn dark_lines_are_found_on_any_paper() {
        let papers = [[1.0; 3], [0.6; 3], [0.33; 3], [0.28, 0.28, 0.33], [0.3, 0.45, 0.2]];
        for (paper, height, line) in papers.into_iter().flat_map(|p| [(p, 300, 3.0), (p, 1000, 1.0), (p, 60, 6.0)]) {
            assert!(!is_dark(&drawing(height, line, [0.06; 3], |_, _| paper)), "{paper:?} {height}");
        }
    }

    #[test]
    fn shade_paint_and_solids_do_not_count() {
        // A paper from light to dark, a drawing with more black than paper, and paint in night colours with dark lines.
        let shade = drawing(300, 3.0, [0.05; 3], |u, _| [0.9 - 0.6 * (u / 400.0) as f32; 3]);
        let black = drawing(300, 3.0, [0.0; 3], |u, _| if u > 120.0 { [0.0; 3] } else { [1.0; 3] });
        let night = drawing(300, 3.0, [0.0; 3], |u, v| match (u > 200.0, v > 120.0) {
            (true, true) => [0.1, 0.15, 0.3],
            (true, false) => [0.3, 0.2, 0.15],
            (false, true) => [0.18; 3],
            _ => [0.12, 0.25, 0.2],
        });
        for (name, picture) in [("shade", shade), ("black", black), ("night", night)] {
            assert!(!is_dark(&picture), "{name}");
        }
    }

    #[test]
    fn a_blank_picture_is_as_dark_as_it_is() {
        assert!(!is_dark(&Raster::new(40, 30, [0.9; 3])));
        assert!(is_dark(&Raster::new(40, 30, [0.1; 3])));
        assert!(!is_dark(&Raster::new(0, 0, [0.0; 3])));
    }
}
