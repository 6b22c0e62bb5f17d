//! A document for a composition that has none yet: the source as its footage, and no parts.

use super::{rectangles, shot};
use crate::description::{OUTPUT, SOURCE};
use crate::ofx::{Effect, Failure};
use openfx::sys::image_effect_v1::image_effect::kOfxImageEffectPropFrameRate;
use rototoon::project::Document;
use rototoon::project::schema::MAX_FRAME_NUMBER;
use rototoon::scene::{Footage, FrameNumber, Scene};

/// Stands for the frames of the source, which the host has and not a folder.
pub const PATTERN: &str = "source_%04d.png";

/// Whether footage stands for the frames of the source.
pub fn is_own(footage: &Footage) -> bool {
    footage.pattern == PATTERN
}

/// Frame numbers of documents are not farther from 0.
const FARTHEST: f64 = MAX_FRAME_NUMBER as f64;

/// An empty document for the source, made at a time of the composition.
pub fn document(effect: &Effect, time: f64) -> Result<Document, Failure> {
    let source = effect.clip(SOURCE)?;
    let told = |text: &str| Failure::Told(text.into());
    let missing = || told("connect the footage to the input Source first");
    let range = shot::frames(effect, time)?.ok_or_else(missing)?;
    let region = rectangles::whole(effect, range)?.ok_or_else(missing)?;
    let offset = effect.parameters()?.int(c"frameOffset", 0.0)?;
    let aspect = effect.clip(OUTPUT)?.pixel_aspect();
    let size = |from: f64, to: f64| ((to - from).round().max(1.0)) as usize;
    let frame = |time: f64| (time - f64::from(offset)).clamp(-FARTHEST, FARTHEST) as FrameNumber;
    let fps = source.properties.double(kOfxImageEffectPropFrameRate, 0).ok();
    let footage = Footage {
        pattern: PATTERN.into(),
        first: frame(range[0].ceil()),
        last: frame(range[1].floor()),
        fps: fps.filter(|fps| fps.is_finite() && (1.0..=1000.0).contains(fps)).unwrap_or(24.0),
        width: size(region.x1 / aspect, region.x2 / aspect),
        height: size(region.y1, region.y2),
        held: false,
    };
    let document = Document::new(Scene { footage, parts: Vec::new() });
    let problems = document.problems();
    if problems.error_count() > 0 {
        return Err(Failure::Told(problems.to_string()));
    }
    Ok(document)
}
