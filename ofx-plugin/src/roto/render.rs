//! Renders the effect's pixels.
//!
//! The window is divided into bands of rows, which the host's threads draw. Neither bands nor threads change a pixel. Each row
//! begins with a check whether the host has aborted.

use super::placement::window;
use super::regions::{Drawn, drawn};
use super::settings::Output;
use crate::description::{OUTPUT, SOURCE};
use crate::ofx::entry::Action;
use crate::ofx::image::Rows;
use crate::ofx::{Bounds, Effect, Failure, Image, threads};
use crate::pixels::{CLEAR, Pixel};
use openfx::sys::generic::core::kOfxPropTime;
use openfx::sys::image_effect_v1::image_effect::{kOfxImageEffectPropRenderScale, kOfxImageEffectPropRenderWindow};
use rototoon::scene::Raster;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Rows of a band. Neighbouring bands repeat some work at their border, so bands must not be low.
const BAND: i32 = 64;

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
    let drawn = drawn(effect, time, scale)?;
    let shows_source = match &drawn {
        Some(drawn) => drawn.settings.output.shows_source(),
        // Without a document the output is the unchanged source, or an empty matte.
        None => Output::of(&effect.parameters()?, time)?.shows_source(),
    };
    let source = if shows_source { source(effect, time)? } else { None };
    let aborted = AtomicBool::new(false);
    let bands: Vec<Mutex<Rows>> = output.bands(asked, BAND).into_iter().map(Mutex::new).collect();
    threads::each(effect, bands.len(), &|index| {
        let mut rows = bands[index].lock().unwrap_or_else(PoisonError::into_inner);
        if draw(effect, drawn.as_ref(), source.as_ref(), &mut rows, &aborted).is_none() {
            aborted.store(true, Ordering::Relaxed);
        }
    });
    if aborted.into_inner() { Err(Failure::Aborted) } else { Ok(()) }
}

fn source<'a>(effect: &Effect<'a>, time: f64) -> Result<Option<Image<'a>>, Failure> {
    let source = effect.clip(SOURCE)?;
    if source.connected() { source.image(time) } else { Ok(None) }
}

/// Draws a band. Returns `None` if the render was aborted.
fn draw(
    effect: &Effect,
    drawn: Option<&Drawn>,
    source: Option<&Image>,
    rows: &mut Rows,
    aborted: &AtomicBool,
) -> Option<()> {
    let (bounds, area) = (rows.window, window(&rows.window));
    let mut go_on = || !aborted.load(Ordering::Relaxed) && !effect.aborted();
    let mut pixels = Raster::new(area.width(), area.height(), CLEAR);
    for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
        if !go_on() {
            return None;
        }
        if let Some(source) = source {
            read(source, &bounds, y, pixels.row_mut(row));
        }
    }
    if let Some(drawn) = drawn {
        drawn.picture.paint(area, &mut pixels, &mut go_on)?;
    }
    let format = rows.format();
    for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
        if let Some(bytes) = rows.row(y) {
            format.write(pixels.row(row), bytes);
        }
    }
    Some(())
}

/// Reads row `y` of the source. The source may be smaller than the window; pixels outside of it stay as they are.
fn read(source: &Image, bounds: &Bounds, y: i32, pixels: &mut [Pixel]) {
    let shared = bounds.shared(&source.bounds);
    if shared.is_empty() {
        return;
    }
    let (first, last) = ((shared.x1 - bounds.x1) as usize, (shared.x2 - bounds.x1) as usize);
    if let Some(bytes) = source.row(y, shared.x1, shared.x2) {
        source.format.read(bytes, &mut pixels[first..last]);
    }
}
