//! Renders the effect's pixels.

use crate::description::{OUTPUT, SOURCE};
use crate::encoding::Encoding;
use crate::ground::Ground;
use crate::ofx::entry::Action;
use crate::ofx::{Bounds, Failure, Image, Parameters};
use crate::pixels::{CLEAR, Pixel};
use openfx::sys::generic::core::kOfxPropTime;
use openfx::sys::image_effect_v1::image_effect::{kOfxImageEffectPropRenderScale, kOfxImageEffectPropRenderWindow};
use rototoon::image::canny::{CannyOptions, canny};
use rototoon::image::distance_transform::manhattan;
use rototoon::image::mean_shift::{MeanShiftOptions, mean_shift};
use rototoon::pictures::backdrop::GREY;
use rototoon::scene::{Colour, Raster};

/// Renders a window.
pub fn render(action: &Action) -> Result<(), Failure> {
    let effect = &action.effect;
    let time = action.input.double(kOfxPropTime, 0)?;
    let [_, scale] = action.input.doubles(kOfxImageEffectPropRenderScale).unwrap_or([1.0; 2]);
    let [x1, y1, x2, y2] = action.input.ints(kOfxImageEffectPropRenderWindow)?;
    let mut output = effect
        .clip(OUTPUT)?
        .image(time)?
        .ok_or_else(|| Failure::Told("the host has no image for the output".into()))?;
    let clip = effect.clip(SOURCE)?;
    let source = if clip.connected() { clip.image(time)? } else { None };
    let seen = match &source {
        Some(source) => Some((source.bounds, seen(source, &effect.parameters()?, time, scale)?)),
        None => None,
    };
    if effect.aborted() {
        return Err(Failure::Aborted);
    }
    for mut rows in output.bands(Bounds { x1, y1, x2, y2 }, i32::MAX) {
        let (window, format) = (rows.window, rows.format());
        let mut pixels = vec![CLEAR; window.width()];
        for y in window.y1..window.y2 {
            pixels.fill(CLEAR);
            if let Some((bounds, picture)) = &seen {
                copy(picture, bounds, &window, y, &mut pixels);
            }
            if let Some(bytes) = rows.row(y) {
                format.write(&pixels, bytes);
            }
        }
    }
    Ok(())
}

/// Copies row `y` of a picture with these bounds, as far as it is in the window, into the window's row `pixels`.
fn copy(picture: &Raster<Pixel>, bounds: &Bounds, window: &Bounds, y: i32, pixels: &mut [Pixel]) {
    let shared = bounds.shared(window);
    if shared.is_empty() || y < shared.y1 || y >= shared.y2 {
        return;
    }
    let row = picture.row((bounds.y2 - 1 - y) as usize);
    let from = &row[(shared.x1 - bounds.x1) as usize..(shared.x2 - bounds.x1) as usize];
    pixels[(shared.x1 - window.x1) as usize..][..from.len()].copy_from_slice(from);
}

/// The chosen image of the source, with rows from the top. Where the source is transparent, its [`Ground`] shows.
fn seen(source: &Image, parameters: &Parameters, time: f64, scale: f64) -> Result<Raster<Pixel>, Failure> {
    let bounds = source.bounds;
    let mut pixels = Raster::new(bounds.width(), (bounds.y2 - bounds.y1) as usize, CLEAR);
    for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
        if let Some(bytes) = source.row(y, bounds.x1, bounds.x2) {
            source.format.read(bytes, pixels.row_mut(row));
        }
    }
    let encoding = Encoding::of(&source.format);
    let ground = Ground::of(&pixels, encoding).unwrap_or(Ground::Grey(GREY));
    let picture: Raster<Colour> = pixels.map(|pixel| ground.colour(pixel, encoding));
    let radius = (f64::from(parameters.int(c"filterRadius", time)?) * scale).round().clamp(1.0, 60.0) as usize;
    let range = parameters.int(c"filterRange", time)?.clamp(0, 100) as usize;
    let filtered = mean_shift(&picture, &MeanShiftOptions { radius, range, ..MeanShiftOptions::default() });
    let output = parameters.int(c"output", time)?;
    if output == 0 {
        for (pixel, colour) in pixels.data_mut().iter_mut().zip(filtered.data()) {
            let [r, g, b] = colour.map(|value| encoding.held(value));
            *pixel = [r, g, b, if ground == Ground::Unused { pixel[3] } else { 1.0 }];
        }
        return Ok(pixels);
    }
    let number = |id, least: f64, most: f64| {
        parameters.double(id, time).map(|v| if v.is_finite() { v.clamp(least, most) } else { least })
    };
    let options = CannyOptions {
        sigma: number(c"sigma", 0.0, 10.0)? * scale,
        low: number(c"lowThreshold", 0.0, 1e4)?,
        high: number(c"highThreshold", 0.0, 1e4)?,
        ..CannyOptions::default()
    };
    let edges = canny(&filtered, &options);
    if output == 1 {
        return Ok(edges.map(|edge| if edge { [1.0; 4] } else { CLEAR }));
    }
    let whole = (number(c"distanceRange", 1.0, 1e6)? * scale) as f32;
    Ok(manhattan(&edges).map(|distance| {
        let value = distance / whole;
        [value, value, value, 1.0]
    }))
}
