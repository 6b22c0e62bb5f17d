//! The true regions of a drawing, and a click for each.
//!
//! A true region is what ink encloses and one colour fills. It has 40 pixels or more at 540 lines. If ink leaves it open between two colours, it
//! has no true colour and does not count: less than 85 % of its pixels are near their median.

use super::ink::{components, mask};
use super::set::{Drawing, Tone};
use rototoon::geometry::Point;
use rototoon::lines::ink::distance;
use rototoon::project::fills::FillClick;
use rototoon::scene::Raster;

/// Least area of a region in pixels at 540 lines.
const LEAST: f64 = 40.0;
/// Largest difference of a channel from the median at which a pixel still has the region's colour, of 255.
const SPREAD: u8 = 24;
/// Least share of a region's pixels that have its colour.
const PURE: f64 = 0.85;

/// A true region.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The indices of its pixels, without the lines around it.
    pub pixels: Vec<usize>,
    /// Its colour: the median of each channel.
    pub colour: Tone,
}

/// The true regions of a drawing.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The regions, the largest first. The first one is the paper.
    pub regions: Vec<Region>,
    /// Which pixels are ink.
    pub ink: Raster<bool>,
}

impl Truth {
    /// Finds the regions of a drawing.
    pub fn of(drawing: &Drawing) -> Self {
        let ink = mask(&drawing.lines);
        let unit = ink.height() as f64 / 540.0;
        let mut found = components(&ink.map(|inked| !inked), false);
        found.retain(|pixels| pixels.len() as f64 >= LEAST * unit * unit);
        found.sort_by_key(|pixels| std::cmp::Reverse(pixels.len()));
        let region = |pixels: Vec<usize>| {
            let tones: Vec<Tone> = pixels.iter().map(|&at| drawing.colour.data()[at]).collect();
            let colour = median(&tones);
            let near = |tone: &&Tone| (0..3).all(|c| tone[c].abs_diff(colour[c]) <= SPREAD);
            let pure = tones.iter().filter(near).count() as f64 >= PURE * tones.len() as f64;
            pure.then_some(Region { pixels, colour })
        };
        Self { regions: found.into_iter().filter_map(region).collect(), ink }
    }

    /// A click of its colour into each region, at the place that is farthest from the region's border.
    pub fn clicks(&self) -> Vec<FillClick> {
        let click = |region: &Region| FillClick {
            at: self.deepest(region),
            colour: Some(region.colour.map(|value| f32::from(value) / 255.0)),
            name: None,
        };
        self.regions.iter().map(click).collect()
    }

    /// The centre of the pixel that is farthest from a region's border, in pixels of the picture.
    pub fn deepest(&self, region: &Region) -> Point {
        let width = self.ink.width();
        let mut own = self.ink.map(|_| false);
        region.pixels.iter().for_each(|&at| own.data_mut()[at] = true);
        let depth = distance::inside(&own);
        // Of equally deep pixels the first one is taken.
        let deeper = |best: usize, at: usize| if depth.data()[at] > depth.data()[best] { at } else { best };
        let at = region.pixels.iter().copied().reduce(deeper).unwrap_or(0);
        Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5)
    }
}

/// The median of each channel.
fn median(tones: &[Tone]) -> Tone {
    [0, 1, 2].map(|channel| {
        let mut values: Vec<u8> = tones.iter().map(|tone| tone[channel]).collect();
        let middle = values.len() / 2;
        if values.is_empty() { 0 } else { *values.select_nth_unstable(middle).1 }
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// White paper with boxes: left, top, right and bottom edge of the inside, and its colour. The lines around are 3 px wide.
    pub(crate) fn drawing(boxes: &[([usize; 4], Tone)]) -> Drawing {
        let (width, height) = (300, 540);
        let (mut lines, mut colour) = (Raster::new(width, height, 255), Raster::new(width, height, [250, 250, 240]));
        for &([left, top, right, bottom], tone) in boxes {
            for (x, y) in (top - 3..bottom + 3).flat_map(|y| (left - 3..right + 3).map(move |x| (x, y))) {
                let inside = (left..right).contains(&x) && (top..bottom).contains(&y);
                lines.set(x, y, if inside { 255 } else { 0 });
                colour.set(x, y, if inside { tone } else { [0; 3] });
            }
        }
        Drawing { lines, colour }
    }

    const RED: Tone = [200, 30, 20];
    const BLUE: Tone = [20, 60, 200];

    #[test]
    fn regions_have_their_colours_and_small_ones_do_not_count() {
        let size = |side: usize| [20, 20, 20 + side, 20 + side];
        let found = Truth::of(&drawing(&[(size(7), RED), ([100, 50, 140, 90], BLUE)]));
        let seen: Vec<(usize, Tone)> = found.regions.iter().map(|own| (own.pixels.len(), own.colour)).collect();
        let paper = 300 * 540 - 13 * 13 - 46 * 46;
        assert_eq!(seen, [(paper, [250, 250, 240]), (1596, BLUE), (45, RED)], "the corners of a box are ink");
        let smaller = Truth::of(&drawing(&[(size(6), RED), ([100, 50, 140, 90], BLUE)]));
        assert_eq!(smaller.regions.len(), 2, "32 pixels are too few");
    }

    #[test]
    fn a_region_of_two_colours_does_not_count() {
        let mut drawn = drawing(&[([20, 20, 60, 60], RED)]);
        let mut paint = |columns: std::ops::Range<usize>| {
            (20..60).for_each(|y| columns.clone().for_each(|x| drawn.colour.set(x, y, BLUE)));
            Truth::of(&drawn).regions.len()
        };
        assert_eq!(paint(20..25), 2, "an eighth of it");
        assert_eq!(paint(25..35), 1, "three eighths of it");
    }

    #[test]
    fn clicks_are_in_the_middle() {
        let clicks = Truth::of(&drawing(&[([20, 30, 41, 51], RED)])).clicks();
        assert_eq!(clicks.len(), 2);
        assert_eq!((clicks[1].at, clicks[1].colour), (Point::new(30.5, 40.5), Some(RED.map(|v| f32::from(v) / 255.0))));
    }
}
