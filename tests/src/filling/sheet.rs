//! A contact sheet of the drawings with most wrong regions: what was painted on the left, the truth on the right. Wrong regions
//! are hatched, and small ones have a ring around them.

use super::paint::Pixel;
use super::set::{Drawing, Tone};
use super::truth::Truth;
use crate::sheet;
use anyhow::{Context, Result};
use image::RgbaImage;
use rototoon::geometry::Point;
use rototoon::scene::Raster;
use std::cmp::Reverse;

/// Most drawings on a sheet.
const DRAWINGS: usize = 8;
/// The colour of the marks.
const MARK: Tone = [255, 0, 200];
const INK: Tone = [0; 3];
/// The colour of what is not painted.
const BARE: Tone = [255; 3];
/// Distance of hatch lines, and width of hatch lines and rings, in pixels at 540 lines.
const HATCH: f64 = 16.0;
const WIDTH: f64 = 4.0;
/// Area up to which a region has a ring, in pixels at 540 lines: its hatching would be overlooked.
const SMALL: f64 = 600.0;

/// A drawing with what was painted on it.
#[derive(Clone, Debug)]
pub struct Scored {
    /// Its number, from 0.
    pub number: usize,
    /// The drawing.
    pub drawing: Drawing,
    /// Its true regions.
    pub truth: Truth,
    /// Its paint.
    pub paint: Raster<Option<Pixel>>,
    /// Whether each of its regions is right.
    pub marks: Vec<bool>,
}

impl Scored {
    fn wrong(&self) -> usize {
        self.marks.iter().filter(|right| !**right).count()
    }
}

/// Keeps the drawings that a sheet shows: those with most wrong regions, the worst first.
pub fn keep_worst(scored: &mut Vec<Scored>) {
    scored.sort_by_key(|own| (Reverse(own.wrong()), own.number));
    scored.truncate(DRAWINGS);
}

/// Draws the sheet.
pub fn draw(scored: &[Scored]) -> Result<RgbaImage> {
    sheet::arrange(&scored.iter().flat_map(|own| [painted(own), truth(own)]).collect::<Result<Vec<_>>>()?)
}

fn painted(own: &Scored) -> Result<RgbaImage> {
    let (width, height) = (own.paint.width(), own.paint.height());
    let colour = |at: usize| match own.paint.data()[at] {
        _ if own.truth.ink.data()[at] => INK,
        Some(pixel) => pixel.colour.map(|value| value.round() as u8),
        None => BARE,
    };
    let mut tones: Vec<Tone> = (0..width * height).map(colour).collect();
    let unit = height as f64 / 540.0;
    for (region, _) in own.truth.regions.iter().zip(&own.marks).filter(|(_, right)| !**right) {
        let hatched = |at: usize| ((at % width + at / width) as f64).rem_euclid(HATCH * unit) < WIDTH * unit;
        region.pixels.iter().filter(|&&at| hatched(at)).for_each(|&at| tones[at] = MARK);
        if region.pixels.len() as f64 > SMALL * unit * unit {
            continue;
        }
        let middle = own.truth.deepest(region);
        let radius = (region.pixels.len() as f64 / std::f64::consts::PI).sqrt() + 12.0 * unit;
        for (at, tone) in tones.iter_mut().enumerate() {
            let place = Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
            if (place.distance(middle) - radius).abs() < WIDTH * unit / 2.0 {
                *tone = MARK;
            }
        }
    }
    let caption = format!("drawing {} · {} of {} wrong", own.number, own.wrong(), own.marks.len());
    cell(&tones, (width, height), &caption)
}

fn truth(own: &Scored) -> Result<RgbaImage> {
    let colour = &own.drawing.colour;
    cell(colour.data(), (colour.width(), colour.height()), "truth")
}

fn cell(tones: &[Tone], (width, height): (usize, usize), caption: &str) -> Result<RgbaImage> {
    let data = tones.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    let whole = RgbaImage::from_raw(width as u32, height as u32, data).context("a picture of another size")?;
    sheet::captioned(&sheet::shrunk(&whole), caption)
}

#[cfg(test)]
mod tests {
    use super::super::truth::tests::drawing;
    use super::*;

    const RED: Tone = [200, 30, 20];

    /// A drawing of two boxes that are painted in their colour. `marks` says which regions count as right.
    fn scored(number: usize, marks: [bool; 3]) -> Scored {
        let drawing = drawing(&[([20, 20, 80, 80], RED), ([120, 300, 160, 340], RED)]);
        let paint = drawing.colour.map(|tone| Some(Pixel { colour: tone.map(f32::from), confidence: 1.0 }));
        Scored { number, truth: Truth::of(&drawing), drawing, paint, marks: marks.to_vec() }
    }

    #[test]
    fn the_worst_drawings_come_first() {
        let mut all: Vec<Scored> = (0..9).map(|k| scored(k, [true, k != 5, k != 5 && k != 7])).collect();
        keep_worst(&mut all);
        let numbers: Vec<usize> = all.iter().map(|own| own.number).collect();
        assert_eq!(numbers, [5, 7, 0, 1, 2, 3, 4, 6]);
    }

    #[test]
    fn wrong_regions_alone_are_marked() {
        let cells = [[true, false, true], [true, true, true]].map(|marks| draw(&[scored(3, marks)]).unwrap());
        let marked = |sheet: &RgbaImage| {
            let pink = |pixel: &image::Rgba<u8>| pixel.0[0] > 180 && pixel.0[1] < 120 && pixel.0[2] > 100;
            sheet.enumerate_pixels().filter(|own| pink(own.2)).map(|own| (own.0, own.1)).collect::<Vec<_>>()
        };
        let (wrong, right) = (marked(&cells[0]), marked(&cells[1]));
        assert!(wrong.len() > 200 && right.is_empty(), "{} and {}", wrong.len(), right.len());
        // The picture of 300 pixels is stretched to 480: the box ends at 80 · 1.6, below the bar with the caption.
        assert!(wrong.iter().all(|&(x, y)| x < 4 + 130 && y < 4 + 28 + 130), "the large box, without a ring");
    }
}
