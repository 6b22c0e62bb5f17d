//! The colour that the paper has behind each pixel, estimated from the picture itself.
//!
//! Ink is thin: where a window wider than a line moves over the picture, its lightest place is paper. The lightest value of
//! the windows around a pixel, of which the darkest is taken (a closing with a square), removes every dark line narrower
//! than the window and keeps larger regions: shade, creases, and the colours of a painted drawing. Light lines on dark
//! paper are the same with light and dark exchanged; which of both they are is found before ([`super::polarity`]).
//!
//! The closing runs on a reduced picture. A pixel of it is the mean of a block's lighter half, so that a line in the block
//! counts little and grain is averaged. Each colour channel is closed by itself: a red line darkens green and blue.
//!
//! **Limits.** A dark region narrower than the window counts as ink. Where the paper is plain ([`plain`]), a window eight
//! times as wide is used where it finds much lighter paper, so that broad strokes and solid blacks are ink there.

use super::polarity::is_dark;
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::gaussian::{Border, blur};

/// Pixels of a block, along each side.
pub const BLOCK: usize = 4;
/// Half the window, as a share of the picture's height.
const WINDOW: f64 = 1.0 / 24.0;
/// Factor of the window on plain paper.
const WIDE: usize = 8;
/// The paper is plain if fewer than this share of its blocks differ from the wide window's paper.
const PAINTED: f32 = 0.25;
/// Difference of a channel from which a block of plain paper is solid ink.
const SOLID: f32 = 0.3;
/// Difference of a channel from which a block counts as painted.
const DIFFERS: f32 = 0.12;

/// The paper of a picture, one value for each block.
pub struct Paper {
    /// Colours, with light and dark exchanged where `dark`.
    pub blocks: Raster<Colour>,
    /// Whether the lines are light on dark paper.
    pub dark: bool,
}

/// Estimates the paper.
pub fn estimate(picture: &Raster<Colour>) -> Paper {
    let dark = is_dark(picture);
    let blocks = lighter_halves(picture, dark);
    let radius = ((WINDOW * picture.height() as f64) as usize / BLOCK).max(3);
    let narrow = closed(&blocks, radius);
    let wide = closed(&blocks, radius * WIDE);
    let chosen = if plain(&narrow, &wide) { with_solids(&narrow, &wide) } else { narrow };
    Paper { blocks: blur(&chosen, 1.5, Border::Replicate), dark }
}

/// Whether the wide window finds the same paper nearly everywhere.
fn plain(narrow: &Raster<Colour>, wide: &Raster<Colour>) -> bool {
    let differs = |(a, b): (&Colour, &Colour)| (0..3).any(|c| b[c] - a[c] > DIFFERS);
    let count = narrow.data().iter().zip(wide.data()).filter(|&pair| differs(pair)).count();
    (count as f32) < PAINTED * narrow.data().len() as f32
}

/// The narrow window's paper, and the wide window's where that is much lighter: what is there is solid ink, not shade.
fn with_solids(narrow: &Raster<Colour>, wide: &Raster<Colour>) -> Raster<Colour> {
    let solid = |a: Colour, b: Colour| (0..3).any(|c| b[c] - a[c] > SOLID);
    Raster::from_fn(narrow.width(), narrow.height(), |x, y| {
        let (a, b) = (narrow.get(x, y), wide.get(x, y));
        if solid(a, b) { b } else { a }
    })
}

/// The mean of each block's lighter half, channel by channel.
fn lighter_halves(picture: &Raster<Colour>, dark: bool) -> Raster<Colour> {
    let (width, height) = (picture.width(), picture.height());
    let mut values = [[0.0f32; BLOCK * BLOCK]; 3];
    Raster::from_fn(width.div_ceil(BLOCK), height.div_ceil(BLOCK), |bx, by| {
        let mut count = 0;
        for y in by * BLOCK..((by + 1) * BLOCK).min(height) {
            for &colour in &picture.row(y)[bx * BLOCK..((bx + 1) * BLOCK).min(width)] {
                for c in 0..3 {
                    values[c][count] = if dark { 1.0 - colour[c] } else { colour[c] };
                }
                count += 1;
            }
        }
        [0, 1, 2].map(|c| {
            let own = &mut values[c][..count];
            own.sort_unstable_by(f32::total_cmp);
            let half = &own[count / 2..];
            half.iter().sum::<f32>() / half.len() as f32
        })
    })
}

/// The closing with a square of 2 `radius` + 1 pixels.
fn closed(picture: &Raster<Colour>, radius: usize) -> Raster<Colour> {
    let greatest = |a: f32, b: f32| a.max(b);
    let least = |a: f32, b: f32| a.min(b);
    let grown = swept(&swept(picture, radius, greatest), radius, greatest);
    swept(&swept(&grown, radius, least), radius, least)
}

/// The extreme of each window along the rows, transposed, so that two calls cover both directions.
fn swept(picture: &Raster<Colour>, radius: usize, extreme: impl Fn(f32, f32) -> f32) -> Raster<Colour> {
    let (width, height) = (picture.width(), picture.height());
    let mut out = Raster::new(height, width, [0.0; 3]);
    for y in 0..height {
        let row = picture.row(y);
        for c in 0..3 {
            for (x, value) in extremes(row, c, radius, &extreme).into_iter().enumerate() {
                let mut colour = out.get(y, x);
                colour[c] = value;
                out.set(y, x, colour);
            }
        }
    }
    out
}

/// The extremes of all windows of a row in linear time (van Herk 1992): blocks of a window's length, with running extremes
/// from both of their ends.
fn extremes(row: &[Colour], channel: usize, radius: usize, extreme: &impl Fn(f32, f32) -> f32) -> Vec<f32> {
    let (n, length) = (row.len(), 2 * radius + 1);
    let mut forward: Vec<f32> = row.iter().map(|colour| colour[channel]).collect();
    let mut backward = forward.clone();
    for i in (1..n).filter(|i| i % length != 0) {
        forward[i] = extreme(forward[i], forward[i - 1]);
    }
    for i in (0..n.saturating_sub(1)).rev().filter(|i| (i + 1) % length != 0) {
        backward[i] = extreme(backward[i], backward[i + 1]);
    }
    // A window within one block begins or ends with it, also where the row cuts them.
    let window = |i: usize| {
        let (first, last) = (i.saturating_sub(radius), (i + radius).min(n - 1));
        match (first / length == last / length, first % length) {
            (true, 0) => forward[last],
            (true, _) => backward[first],
            _ => extreme(backward[first], forward[last]),
        }
    };
    (0..n).map(window).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_of_windows_are_those_of_a_plain_search() {
        let row: Vec<Colour> = (0..37u32).map(|i| [(i * 7919 % 101) as f32; 3]).collect();
        for radius in [1, 3, 8, 30, 60] {
            let found = extremes(&row, 0, radius, &f32::max);
            for (i, &value) in found.iter().enumerate() {
                let window = &row[i.saturating_sub(radius)..(i + radius + 1).min(row.len())];
                assert_eq!(value, window.iter().map(|c| c[0]).fold(0.0, f32::max), "{i} {radius}");
            }
        }
    }

    #[test]
    fn paper_with_shade_keeps_it_and_loses_the_line() {
        let shade = |x: usize| 0.9 - 0.4 * x as f32 / 200.0;
        let picture = Raster::from_fn(200, 120, |x, y| if (50..54).contains(&y) { [0.1; 3] } else { [shade(x); 3] });
        let paper = estimate(&picture);
        assert!(!paper.dark);
        for x in [10, 100, 180] {
            let found = paper.blocks.get(x / BLOCK, 52 / BLOCK)[1];
            assert!((found - shade(x)).abs() < 0.06, "{x}: {found}");
        }
    }

    #[test]
    fn a_painted_region_is_paper_of_its_own_colour() {
        let picture = Raster::from_fn(240, 240, |x, y| match (x, y) {
            (98..102, _) => [0.0; 3],
            (0..98, _) => [0.9, 0.5, 0.4],
            _ => [0.3, 0.5, 0.9],
        });
        let paper = estimate(&picture);
        assert!(paper.blocks.get(10, 30)[0] > 0.85 && paper.blocks.get(50, 30)[0] < 0.35);
    }
}
