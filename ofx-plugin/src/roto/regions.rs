//! Where something is drawn, what of the source that needs, and of what kind the output is.

use super::instance;
use super::parts::selected;
use super::picture::Picture;
use super::placement::{Placement, window};
use super::settings::{Output, Settings};
use crate::description::SOURCE;
use crate::ofx::effect::Region;
use crate::ofx::entry::Action;
use crate::ofx::{Bounds, Effect, Failure, host};
use openfx::sys::generic::core::{kOfxPropName, kOfxPropTime};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectFrameVarying, kOfxImageEffectPropPreMultiplication, kOfxImageEffectPropRegionOfDefinition,
    kOfxImageEffectPropRegionOfInterest, kOfxImageEffectPropRenderScale, kOfxImageEffectPropRenderWindow,
    kOfxImageEffectPropSupportsMultiResolution, kOfxImageOpaque, kOfxImagePreMultiplied,
};

/// What is drawn at the time of an action, and where.
pub struct Drawn {
    /// What is drawn.
    pub picture: Picture,
    /// Where the footage is.
    pub placement: Placement,
    /// The parameters' values.
    pub settings: Settings,
}

/// What is drawn; none where no document is set. What is doubtful about it is told.
pub fn drawn(effect: &Effect, time: f64, render_scale: [f64; 2]) -> Result<Option<Drawn>, Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let settings = Settings::read(&parameters, time)?;
    let document = instance.document(&parameters).inspect_err(|failure| {
        instance.note(effect, &failure.to_string(), true);
    })?;
    let Some(document) = document else { return Ok(None) };
    let footage = &document.scene.footage;
    let placement = Placement::of(effect, footage, time, render_scale)?;
    if !placement.matches {
        let (width, height) = (footage.width, footage.height);
        let text = format!("the project is made for {width}x{height} pixels, and stretched over other footage");
        instance.note(effect, &text, false);
    }
    let (parts, missing) = selected(&document.scene.parts, &settings.parts);
    for name in missing {
        instance.note(effect, &format!("parts: no part is called {name:?}"), false);
    }
    if !document.scene.parts.iter().any(|part| !part.tracks.is_empty()) {
        instance.note(effect, "the project is not tracked: its parts are drawn on their key frames only", false);
    }
    let picture = Picture::new(&document.scene, &parts, &settings, &placement);
    Ok(Some(Drawn { picture, placement, settings }))
}

fn time_and_scale(action: &Action) -> Result<(f64, [f64; 2]), Failure> {
    let scale: [f64; 2] = action.input.doubles(kOfxImageEffectPropRenderScale).unwrap_or([1.0; 2]);
    let usable = scale.iter().all(|s| s.is_finite() && *s > 0.0);
    Ok((action.input.double(kOfxPropTime, 0)?, if usable { scale } else { [1.0; 2] }))
}

/// Where the source has pixels, if it is connected.
fn source_region(effect: &Effect, time: f64) -> Result<Option<Region>, Failure> {
    let source = effect.clip(SOURCE)?;
    Ok(if source.connected() { source.region(time) } else { None })
}

/// The region of definition: no more than what is drawn.
pub fn definition(action: &Action) -> Result<(), Failure> {
    let (time, scale) = time_and_scale(action)?;
    // A host whose images are all of one size has to be given that.
    if host::properties()?.int(kOfxImageEffectPropSupportsMultiResolution, 0).is_ok_and(|multi| multi == 0) {
        return Err(Failure::Default);
    }
    let drawn = drawn(&action.effect, time, scale).ok().flatten().ok_or(Failure::Default)?;
    let (bounds, elsewhere) = drawn.picture.bounds();
    if elsewhere {
        return Err(Failure::Default);
    }
    let mut region = bounds.map(|bounds| drawn.placement.canonical(&bounds));
    if drawn.settings.output == Output::Cutout {
        let source = source_region(&action.effect, time)?;
        region = region.zip(source).and_then(|(region, source)| region.shared(&source));
    }
    let region = region.unwrap_or_default();
    action.output.set_doubles(kOfxImageEffectPropRegionOfDefinition, &region.to_array())
}

/// The region of the source that a region of the output needs.
pub fn interest(action: &Action) -> Result<(), Failure> {
    let (time, scale) = time_and_scale(action)?;
    let [x1, y1, x2, y2] = action.input.doubles(kOfxImageEffectPropRegionOfInterest)?;
    let wanted = Region { x1, y1, x2, y2 };
    let nothing = Region { x2: x1, y2: y1, ..wanted };
    let Some(drawn) = drawn(&action.effect, time, scale).ok().flatten() else { return Err(Failure::Default) };
    let needed = match (drawn.settings.output.shows_source(), drawn.picture.bounds()) {
        (false, _) => nothing,
        (true, (_, true)) => wanted,
        (true, (bounds, false)) => {
            bounds.and_then(|bounds| drawn.placement.canonical(&bounds).shared(&wanted)).unwrap_or(nothing)
        }
    };
    action.output.set_doubles(c"OfxImageClipPropRoI_Source", &needed.to_array())
}

/// The frames of the source that a frame needs: itself. Motion blur is made of the outlines alone.
pub fn frames_needed(action: &Action) -> Result<(), Failure> {
    let time = action.input.double(kOfxPropTime, 0)?;
    action.output.set_doubles(c"OfxImageClipPropFrameRange_Source", &[time, time])
}

/// Whether the output is the source.
pub fn identity(action: &Action) -> Result<(), Failure> {
    let (time, scale) = time_and_scale(action)?;
    let effect = &action.effect;
    let [x1, y1, x2, y2] = action.input.ints(kOfxImageEffectPropRenderWindow)?;
    let output = Output::of(&effect.parameters()?, time)?;
    if !output.shows_source() || !effect.clip(SOURCE)?.connected() {
        return Err(Failure::Default);
    }
    // What fails is told by render.
    let same = match drawn(effect, time, scale) {
        Ok(None) => true,
        Ok(Some(drawn)) => drawn.picture.changes_nothing(window(&Bounds { x1, y1, x2, y2 })),
        Err(_) => false,
    };
    if !same {
        return Err(Failure::Default);
    }
    action.output.set_name(kOfxPropName, 0, SOURCE)?;
    action.output.set_double(kOfxPropTime, 0, time)
}

/// Of what kind the output is: a matte, ids and what is cut out of an opaque source are premultiplied, the rest is as the
/// source. Frames differ although nothing is animated.
pub fn clip_preferences(action: &Action) -> Result<(), Failure> {
    let effect = &action.effect;
    let output = Output::of(&effect.parameters()?, 0.0)?;
    let source = effect.clip(SOURCE)?;
    let premultiplication = source.properties.text(kOfxImageEffectPropPreMultiplication, 0).unwrap_or_default();
    let opaque = !source.connected() || premultiplication.as_bytes() == kOfxImageOpaque.to_bytes();
    if !output.shows_source() || output == Output::Cutout && opaque {
        action.output.set_name(kOfxImageEffectPropPreMultiplication, 0, kOfxImagePreMultiplied)?;
    }
    action.output.set_int(kOfxImageEffectFrameVarying, 0, 1)
}
