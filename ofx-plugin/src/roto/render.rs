//! Renders the effect's pixels.
//!
//! The window is divided into bands of rows, which the host's threads draw. Neither bands nor threads change a pixel. A row is
//! read, drawn and written before the next one, so mattes and cutouts are never in memory as a whole. Each row begins with a
//! check whether the host has aborted.

use super::instance;
use super::measured;
use super::mixing::Mixing;
use super::placement::window;
use super::rectangles;
use super::regions::{Drawn, drawn, passes_source};
use super::watch::Watch;
use crate::description::{MASK, OUTPUT, SOURCE};
use crate::ofx::entry::Action;
use crate::ofx::image::Rows;
use crate::ofx::{Bounds, Clip, Effect, Failure, Image, threads};
use crate::pixels::{CLEAR, Layout, Pixel};
use openfx::sys::generic::core::kOfxPropTime;
use openfx::sys::image_effect_v1::image_effect::{kOfxImageEffectPropRenderScale, kOfxImageEffectPropRenderWindow};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Least number of rows of a band. Neighbouring bands repeat some work at their border, so bands must not be low.
const BAND: i32 = 64;
/// Least height of a band as a multiple of the reach of soft borders, which neighbouring bands repeat.
const REACHES: usize = 3;
/// Number of bands for each thread, so that none waits long for the last.
const BANDS: i32 = 4;

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
    let mut fetched = Sources::fetch(effect, time)?;
    let clips = (effect.clip(OUTPUT)?, effect.clip(SOURCE)?);
    let source = fetched.source.as_ref().map(|image| (&clips.1, image));
    let frame = rectangles::format(effect);
    let scale = measured::of_render((&clips.0, &output), source, frame, asked, time, scale);
    fetched.watch = Watch::of(action, source.map(|(_, image)| image), time, scale);
    let drawn = drawn(effect, time, scale)?;
    if output.format.layout == Layout::Rgb
        && let Some(missing) = drawn.as_ref().and_then(|drawn| drawn.settings.missing_without_alpha())
    {
        let text = format!("the host wants pictures without alpha from this node: {missing}");
        instance(effect)?.note(effect, &text, false);
    }
    let rows = band(drawn.as_ref(), asked, threads::count(effect));
    let bands: Vec<Mutex<Rows>> = output.bands(asked, rows).into_iter().map(Mutex::new).collect();
    let aborted = AtomicBool::new(false);
    threads::each(effect, bands.len(), &|index| {
        let mut rows = bands[index].lock().unwrap_or_else(PoisonError::into_inner);
        if draw(effect, drawn.as_ref(), &fetched, &mut rows, &aborted).is_none() {
            aborted.store(true, Ordering::Relaxed);
        }
    });
    if let Some(watch) = fetched.watch {
        watch.end(effect, time);
    }
    if aborted.into_inner() { Err(Failure::Aborted) } else { Ok(()) }
}

/// The number of rows of a band. What is made row by row needs only as many bands as keep all threads busy; other pictures
/// are in memory while they are drawn, so their bands are low.
fn band(drawn: Option<&Drawn>, asked: Bounds, threads: usize) -> i32 {
    let reach = drawn.map_or(0, |drawn| drawn.picture.reach());
    let least = BAND.max(i32::try_from(REACHES * reach).unwrap_or(i32::MAX));
    if drawn.is_some_and(|drawn| !drawn.picture.is_made_of_rows()) {
        return least;
    }
    let height = asked.y2 - asked.y1;
    let count = if threads > 1 { BANDS.saturating_mul(i32::try_from(threads).unwrap_or(i32::MAX)) } else { 1 };
    least.max(height / count + 1)
}

/// The input images of a render.
struct Sources<'a> {
    source: Option<Image<'a>>,
    mask: Mask<'a>,
    /// Whether the source is still what the last Track saw.
    watch: Option<Watch>,
}

/// What limits the picture.
enum Mask<'a> {
    /// Nothing: the mask is not connected, or not used.
    Unused,
    /// The mask's pixels.
    Of(Image<'a>),
    /// A mask that has no pixels here. By OpenFX its image is then black and transparent.
    Empty,
}

impl<'a> Sources<'a> {
    /// Fetches the images that the picture needs.
    fn fetch(effect: &Effect<'a>, time: f64) -> Result<Self, Failure> {
        let parameters = effect.parameters()?;
        // Without a document the output is the unchanged source, or an empty matte.
        let shown = passes_source(effect, time)? || Mixing::read(&parameters, time)?.needs_source();
        let masked = parameters.int(c"useMask", time)? != 0;
        let connected = |name| effect.clip(name).ok().filter(Clip::connected);
        let source = if shown { connected(SOURCE) } else { None };
        let mask = if masked { connected(MASK) } else { None };
        Ok(Self {
            source: source.map_or(Ok(None), |clip| clip.image(time))?,
            mask: match mask {
                Some(clip) => clip.image(time)?.map_or(Mask::Empty, Mask::Of),
                None => Mask::Unused,
            },
            watch: None,
        })
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
    let over = sources.source.as_ref().map(|image| image.format).unwrap_or_default();
    let mixing = drawn.map(|drawn| Mixing::of(&drawn.settings).over(&over));
    let raw = mixing.as_ref().is_some_and(Mixing::is_raw);
    let source = |y: i32, pixels: &mut [Pixel]| {
        pixels.fill(CLEAR);
        if let Some(source) = &sources.source {
            read(source, raw, &bounds, y, pixels);
        }
    };
    let mut painting = match drawn {
        Some(drawn) => {
            Some(drawn.picture.painting(area, &|row, pixels| source(bounds.y2 - 1 - row as i32, pixels), &mut go_on)?)
        }
        None => None,
    };
    let (mut pixels, mut below) = (vec![CLEAR; area.width()], vec![CLEAR; area.width()]);
    let mut limits = vec![0.0; area.width()];
    let format = rows.format();
    for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
        if !go_on() {
            return None;
        }
        source(y, &mut pixels);
        if let (Some(watch), Some(image)) = (&sources.watch, &sources.source) {
            watch.look(image, &bounds, y);
        }
        if let (Some(painting), Some(mixing)) = (&mut painting, &mixing) {
            let below = mixing.needs_source().then(|| {
                below.copy_from_slice(&pixels);
                &below[..]
            });
            painting.row(row, &mut pixels, &mut go_on)?;
            let limit = match &sources.mask {
                Mask::Unused => None,
                Mask::Empty => Some(&limits[..]),
                Mask::Of(mask) => {
                    limit(mask, &bounds, y, &mut limits);
                    Some(&limits[..])
                }
            };
            mixing.finish(&mut pixels, below, limit, &format);
        }
        if let Some(bytes) = rows.row(y) {
            let format = if raw { format.raw() } else { format };
            format.write(&pixels, bytes);
        }
    }
    Some(())
}

/// The values of the input Mask in row `y` of a band. It is 0 where the mask has no pixels.
fn limit(mask: &Image, bounds: &Bounds, y: i32, limits: &mut [f32]) {
    let mut pixels = vec![CLEAR; limits.len()];
    read(mask, true, bounds, y, &mut pixels);
    for (limit, pixel) in limits.iter_mut().zip(&pixels) {
        // An image without alpha limits by its red.
        let value = if mask.format.layout == Layout::Rgb { pixel[0] } else { pixel[3] };
        *limit = if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
    }
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
