//! A contact sheet of the drawings with most wrong regions: what was painted on the left, the truth on the right. Wrong regions
//! are hatched, with a ring around each.

use super::paint::Pixel;
use super::set::{Drawing, Tone};
use super::truth::Truth;
use crate::sheet;
use anyhow::{Context, Result};
use image::imageops::overlay;
use image::{Rgba, RgbaImage};
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
/// Distance of hatch lines and width of rings, in pixels at 540 lines.
const HATCH: f64 = 8.0;
const RING: f64 = 3.0;

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
    let (hatch, ring) = (((HATCH * unit) as usize).max(3), (RING * unit).max(1.5));
    let wrong = own.truth.regions.iter().zip(&own.marks).filter(|(_, right)| !**right);
    for (region, _) in wrong {
        for &at in region.pixels.iter().filter(|&&at| (at % width + at / width) % hatch < hatch.div_ceil(3)) {
            tones[at] = MARK;
        }
        let middle = own.truth.deepest(region);
        let radius = (region.pixels.len() as f64 / std::f64::consts::PI).sqrt() + 12.0 * unit;
        for (at, tone) in tones.iter_mut().enumerate() {
            let place = Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
            if (place.distance(middle) - radius).abs() < ring / 2.0 {
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
    let small = sheet::shrunk(&whole);
    let mut cell = RgbaImage::from_pixel(small.width(), small.height(), Rgba([255; 4]));
    overlay(&mut cell, &small, 0, 0);
    sheet::captioned(&cell, caption)
}
