//! Renders the effect's pixels.
//!
//! The window is divided into bands of rows, which the host's threads draw. Neither bands nor threads change a pixel. Each row
//! begins with a check whether the host has aborted.

use super::measured;
use super::mixing::Mixing;
use super::placement::window;
use super::regions::{Drawn, drawn, passes_source};
use crate::description::{MASK, OUTPUT, SOURCE};
use crate::ofx::entry::Action;
use crate::ofx::image::Rows;
use crate::ofx::{Bounds, Effect, Failure, Image, threads};
use crate::pixels::{CLEAR, Layout, Pixel};
use openfx::sys::generic::core::kOfxPropTime;
use openfx::sys::image_effect_v1::image_effect::{kOfxImageEffectPropRenderScale, kOfxImageEffectPropRenderWindow};
use rototoon::scene::Raster;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Least number of rows of a band. Neighbouring bands repeat some work at their border, so bands must not be low.
const BAND: i32 = 64;
/// Least height of a band as a multiple of the reach of soft borders, which neighbouring bands repeat.
const REACHES: usize = 3;

/// Renders a window.
pub fn render(action: &Action) -> Result<(), Failure> {
    let effect = &action.effect;
    let time = action.input.double(kOfxPropTime, 0)?;
    let scale = action.input.doubles(kOfxImageEffectPropRenderScale).unwrap_or([1.0; 2]);
    let [x1, y1, x2, y2] = action.input.ints(kOfxImageEffectPropRenderWindow)?;
    let asked = Bounds { x1, y1, x2, y2 };
    if asked.is_empty() {
        return Ok(());
    }
    let Some(mut output) = effect.clip(OUTPUT)?.image(time)? else {
        // An aborted render may have no image to write to.
        return Err(if effect.aborted() {
            Failure::Aborted
        } else {
            Failure::Told("the host has no image for the output".into())
        });
    };
    let fetched = Sources::fetch(effect, time)?;
    let clips = (effect.clip(OUTPUT)?, effect.clip(SOURCE)?);
    let source = fetched.source.as_ref().map(|image| (&clips.1, image));
    let scale = measured::of_render((&clips.0, &output), source, asked, time, scale);
    let drawn = drawn(effect, time, scale)?;
    let reach = drawn.as_ref().map_or(0, |drawn| drawn.picture.reach());
    let rows = BAND.max(i32::try_from(REACHES * reach).unwrap_or(i32::MAX));
    let bands: Vec<Mutex<Rows>> = output.bands(asked, rows).into_iter().map(Mutex::new).collect();
    let aborted = AtomicBool::new(false);
    threads::each(effect, bands.len(), &|index| {
        let mut rows = bands[index].lock().unwrap_or_else(PoisonError::into_inner);
        if draw(effect, drawn.as_ref(), &fetched, &mut rows, &aborted).is_none() {
            aborted.store(true, Ordering::Relaxed);
        }
    });
    if aborted.into_inner() { Err(Failure::Aborted) } else { Ok(()) }
}

/// The input images of a render.
struct Sources<'a> {
    source: Option<Image<'a>>,
    mask: Option<Image<'a>>,
}

impl<'a> Sources<'a> {
    /// Fetches the images that the picture needs.
    fn fetch(effect: &Effect<'a>, time: f64) -> Result<Self, Failure> {
        let parameters = effect.parameters()?;
        // Without a document the output is the unchanged source, or an empty matte.
        let shown = passes_source(effect, time)? || Mixing::read(&parameters, time)?.needs_source();
        let masked = parameters.int(c"useMask", time)? != 0;
        let image = |name| match effect.clip(name) {
            Ok(clip) if clip.connected() => clip.image(time),
            _ => Ok(None),
        };
        Ok(Self { source: if shown { image(SOURCE)? } else { None }, mask: if masked { image(MASK)? } else { None } })
    }
}

/// Draws a band. Returns `None` if the render was aborted.
fn draw(
    effect: &Effect,
    drawn: Option<&Drawn>,
    sources: &Sources,
    rows: &mut Rows,
    aborted: &AtomicBool,
) -> Option<()> {
    let (bounds, area) = (rows.window, window(&rows.window));
    let mut go_on = || !aborted.load(Ordering::Relaxed) && !effect.aborted();
    let mixing = drawn.map(|drawn| Mixing::of(&drawn.settings));
    let raw = mixing.as_ref().is_some_and(Mixing::is_raw);
    let mut pixels = Raster::new(area.width(), area.height(), CLEAR);
    for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
        if !go_on() {
            return None;
        }
        if let Some(source) = &sources.source {
            read(source, raw, &bounds, y, pixels.row_mut(row));
        }
    }
    if let (Some(drawn), Some(mixing)) = (drawn, mixing) {
        let below = mixing.needs_source().then(|| pixels.clone());
        drawn.picture.paint(area, &mut pixels, &mut go_on)?;
        let limit = sources.mask.as_ref().map(|mask| limits(mask, &bounds));
        mixing.finish(&mut pixels, below.as_ref(), limit.as_ref(), &rows.format());
    }
    let format = if raw { rows.format().raw() } else { rows.format() };
    for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
        if let Some(bytes) = rows.row(y) {
            format.write(pixels.row(row), bytes);
        }
    }
    Some(())
}

/// The values of the input Mask in a band. It is 0 where the mask has no pixels.
fn limits(mask: &Image, bounds: &Bounds) -> Raster<f32> {
    let mut limits = Raster::new(bounds.width(), (bounds.y2 - bounds.y1) as usize, 0.0f32);
    let mut pixels = vec![CLEAR; bounds.width()];
    for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
        pixels.fill(CLEAR);
        read(mask, true, bounds, y, &mut pixels);
        for (limit, pixel) in limits.row_mut(row).iter_mut().zip(&pixels) {
            // An image without alpha limits by its red.
            let value = if mask.format.layout == Layout::Rgb { pixel[0] } else { pixel[3] };
            *limit = if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
        }
    }
    limits
}

/// Reads row `y` of an image, as it is if `raw`, otherwise premultiplied. The image may be smaller than the window; pixels
/// outside of it stay as they are.
fn read(image: &Image, raw: bool, bounds: &Bounds, y: i32, pixels: &mut [Pixel]) {
    let shared = bounds.shared(&image.bounds);
    if shared.is_empty() {
        return;
    }
    let (first, last) = ((shared.x1 - bounds.x1) as usize, (shared.x2 - bounds.x1) as usize);
    if let Some(bytes) = image.row(y, shared.x1, shared.x2) {
        let format = if raw { image.format.raw() } else { image.format };
        format.read(bytes, &mut pixels[first..last]);
    }
}
