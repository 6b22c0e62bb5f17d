//! The regions that are drawn, the regions of the source that they need, and the format of the output.

use super::parts::selected;
use super::picture::Picture;
use super::placement::{Placement, window};
use super::settings::{Channels, Extent, Output, Settings};
use super::state::State;
use super::{cels, instance, rectangles};
use crate::description::{MASK, SOURCE};
use crate::ofx::effect::Region;
use crate::ofx::entry::Action;
use crate::ofx::{Bounds, Clip, Effect, Failure, host};
use openfx::sys::generic::core::{kOfxPropName, kOfxPropTime};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageClipPropUnmappedComponents, kOfxImageComponentRGB, kOfxImageEffectFrameVarying,
    kOfxImageEffectPropComponents, kOfxImageEffectPropPreMultiplication, kOfxImageEffectPropRegionOfDefinition,
    kOfxImageEffectPropRegionOfInterest, kOfxImageEffectPropRenderScale, kOfxImageEffectPropRenderWindow,
    kOfxImageEffectPropSupportsMultiResolution, kOfxImageOpaque, kOfxImagePreMultiplied, kOfxImageUnPreMultiplied,
};
use rototoon::scene::{NoSuchPart, Part};

/// The picture to draw at the time of an action.
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// The placement of the footage.
    pub placement: Placement,
    /// The parameters' values.
    pub settings: Settings,
}

/// The picture to draw; `None` if no document is set. Warns the user about possible mistakes.
pub fn drawn(effect: &Effect, time: f64, render_scale: [f64; 2]) -> Result<Option<Drawn>, Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let state = instance.state(&parameters).inspect_err(|failure| {
        instance.note(effect, &failure.to_string(), true);
    })?;
    let settings = Settings::read(&parameters, time, &state)?;
    let document = instance.document(&parameters).inspect_err(|failure| {
        instance.note(effect, &failure.to_string(), true);
    })?;
    let Some(document) = document else { return Ok(None) };
    let footage = &document.scene.footage;
    let placement = Placement::of(effect, footage, time, render_scale)?;
    if !placement.matches {
        let (width, height) = (footage.width, footage.height);
        let text =
            format!("the project is made for {width}x{height} pixels and is stretched over footage of another size");
        instance.note(effect, &text, false);
    }
    let (parts, drawn) = if settings.output.shows_parts() {
        (shown_parts(effect, &document.scene.parts, &settings.parts)?, Vec::new())
    } else {
        (Vec::new(), cels::shown(effect, &document, &settings, &placement)?)
    };
    let named = |names: &str| selected(&document.scene.parts, names).0;
    let picture = Picture::new(&document.scene, &parts, &named, drawn, &settings, &placement);
    Ok(Some(Drawn { picture, placement, settings }))
}

/// The indices of the parts that a list names.
fn shown_parts(effect: &Effect, parts: &[Part], names: &str) -> Result<Vec<usize>, Failure> {
    let instance = instance(effect)?;
    let (shown, missing) = selected(parts, names);
    for name in missing {
        instance.note(effect, &format!("Parts: {}", NoSuchPart::of(parts, name)), false);
    }
    if !parts.iter().any(|part| !part.tracks.is_empty()) {
        instance.note(effect, "the project is not tracked, so its parts are drawn on their key frames only", false);
    }
    Ok(shown)
}

fn time_and_scale(action: &Action) -> Result<(f64, [f64; 2]), Failure> {
    let scale: [f64; 2] = action.input.doubles(kOfxImageEffectPropRenderScale).unwrap_or([1.0; 2]);
    let usable = scale.iter().all(|s| s.is_finite() && *s > 0.0);
    Ok((action.input.double(kOfxPropTime, 0)?, if usable { scale } else { [1.0; 2] }))
}

/// The region in which the source has pixels, if it is connected.
fn source_region(effect: &Effect, time: f64) -> Result<Option<Region>, Failure> {
    let source = effect.clip(SOURCE)?;
    Ok(if source.connected() { source.region(time) } else { None })
}

/// Sets the region of definition: the region that is drawn.
pub fn definition(action: &Action) -> Result<(), Failure> {
    let (time, scale) = time_and_scale(action)?;
    // If the host supports only one image size, it must get the default region.
    if host::properties()?.int(kOfxImageEffectPropSupportsMultiResolution, 0).is_ok_and(|multi| multi == 0) {
        return Err(Failure::Default);
    }
    let drawn = drawn(&action.effect, time, scale).ok().flatten().ok_or(Failure::Default)?;
    let whole = match drawn.settings.extent {
        Extent::Shapes => None,
        Extent::Source => source_region(&action.effect, time)?,
        Extent::Format => rectangles::format(&action.effect),
    };
    if let Some(whole) = whole {
        return action.output.set_doubles(kOfxImageEffectPropRegionOfDefinition, &whole.to_array());
    }
    let (bounds, elsewhere) = drawn.picture.bounds();
    if elsewhere {
        return Err(Failure::Default);
    }
    let mut region = bounds.map(|bounds| drawn.placement.canonical(&bounds));
    if drawn.settings.output == Output::Cutout {
        let source = source_region(&action.effect, time)?;
        region = region.zip(source).and_then(|(region, source)| region.shared(&source));
    }
    if drawn.settings.output == Output::Matte && drawn.settings.shows_source() {
        // The matte is beside the source's channels, or joins its alpha.
        let both = [region, source_region(&action.effect, time)?];
        region = both.into_iter().flatten().reduce(|a, b| a.united(&b));
    }
    let region = region.unwrap_or_default();
    action.output.set_doubles(kOfxImageEffectPropRegionOfDefinition, &region.to_array())
}

/// Sets the region of the source that a region of the output needs.
pub fn interest(action: &Action) -> Result<(), Failure> {
    let (time, scale) = time_and_scale(action)?;
    let [x1, y1, x2, y2] = action.input.doubles(kOfxImageEffectPropRegionOfInterest)?;
    let wanted = Region { x1, y1, x2, y2 };
    let nothing = Region { x2: x1, y2: y1, ..wanted };
    let Some(drawn) = drawn(&action.effect, time, scale).ok().flatten() else { return Err(Failure::Default) };
    if drawn.settings.use_mask && action.effect.clip(MASK).is_ok() {
        action.output.set_doubles(c"OfxImageClipPropRoI_Mask", &wanted.to_array())?;
    }
    if !host::tiles() && drawn.settings.shows_source() {
        // The host gives whole images. Its idea of a region may be wrong, as that of the scale may be.
        let whole = source_region(&action.effect, time)?.unwrap_or(wanted);
        return action.output.set_doubles(c"OfxImageClipPropRoI_Source", &whole.to_array());
    }
    let needed = match (drawn.settings.shows_source(), drawn.picture.bounds()) {
        (false, _) => nothing,
        (true, _) if drawn.settings.output == Output::Matte => wanted,
        (true, (_, true)) => wanted,
        (true, (bounds, false)) => {
            bounds.and_then(|bounds| drawn.placement.canonical(&bounds).shared(&wanted)).unwrap_or(nothing)
        }
    };
    action.output.set_doubles(c"OfxImageClipPropRoI_Source", &needed.to_array())
}

/// Sets the frames of the source that a frame needs: only itself, because motion blur uses only the outlines.
pub fn frames_needed(action: &Action) -> Result<(), Failure> {
    let time = action.input.double(kOfxPropTime, 0)?;
    if action.effect.clip(MASK).is_ok() {
        action.output.set_doubles(c"OfxImageClipPropFrameRange_Mask", &[time, time])?;
    }
    action.output.set_doubles(c"OfxImageClipPropFrameRange_Source", &[time, time])
}

/// Whether the output is the source where nothing is drawn.
pub fn passes_source(effect: &Effect, time: f64) -> Result<bool, Failure> {
    Ok(Output::of(&effect.parameters()?, time)?.passes_source())
}

/// Reports that the output is the source, if it is.
pub fn identity(action: &Action) -> Result<(), Failure> {
    let (time, scale) = time_and_scale(action)?;
    let effect = &action.effect;
    let [x1, y1, x2, y2] = action.input.ints(kOfxImageEffectPropRenderWindow)?;
    if !passes_source(effect, time)? || !effect.clip(SOURCE)?.connected() {
        return Err(Failure::Default);
    }
    // Rendering reports errors.
    let same = match drawn(effect, time, scale) {
        Ok(None) => true,
        Ok(Some(Drawn { settings, .. })) if settings.use_mask && settings.output == Output::Cutout => false,
        Ok(Some(drawn)) => {
            let asked = window(&Bounds { x1, y1, x2, y2 });
            // A host without tiles gives whole pictures, and may say a wrong scale of them.
            let whole = if host::tiles() { None } else { source_region(effect, time)? };
            let looked_at = whole.map_or(asked, |whole| asked.united(drawn.placement.window(&whole)));
            drawn.picture.changes_nothing(looked_at)
        }
        Err(_) => false,
    };
    if !same {
        return Err(Failure::Default);
    }
    action.output.set_name(kOfxPropName, 0, SOURCE)?;
    action.output.set_double(kOfxPropTime, 0, time)
}

/// The components of what is connected to a clip; empty if nothing is.
fn components(clip: &Clip) -> String {
    let read = |name| clip.properties.text(name, 0).ok();
    let connected = clip.connected();
    let read = || read(kOfxImageClipPropUnmappedComponents).or_else(|| read(kOfxImageEffectPropComponents));
    connected.then(read).flatten().unwrap_or_default()
}

/// Sets the format of the output. It has alpha where the picture does, also over a source without. Mattes, ids, paint and strokes alone, and a cutout of an opaque source are premultiplied; other
/// outputs are as the source. Frames are declared to vary, because they differ although no parameter is animated.
pub fn clip_preferences(action: &Action) -> Result<(), Failure> {
    let effect = &action.effect;
    let settings = Settings::read(&effect.parameters()?, 0.0, &State::default())?;
    let output = settings.output;
    let source = effect.clip(SOURCE)?;
    let premultiplication = source.properties.text(kOfxImageEffectPropPreMultiplication, 0).unwrap_or_default();
    let components = components(&source);
    let opaque = !source.connected()
        || premultiplication.as_bytes() == kOfxImageOpaque.to_bytes()
        || components.as_bytes() == kOfxImageComponentRGB.to_bytes();
    if let Some(needed) = settings.components(components.as_bytes()) {
        // A host that refuses gives other pictures, and rendering says what is missing there.
        let _ = action.output.set_name(c"OfxImageClipPropComponents_Output", 0, needed);
    }
    // Where there is no source, its paint shows alone.
    let transparent = output == Output::Cutout && opaque || output == Output::Painted && !source.connected();
    if output == Output::Matte && settings.channels == Channels::One(3) {
        let result = if settings.premultiply { kOfxImagePreMultiplied } else { kOfxImageUnPreMultiplied };
        action.output.set_name(kOfxImageEffectPropPreMultiplication, 0, result)?;
    } else if !settings.shows_source() || transparent {
        action.output.set_name(kOfxImageEffectPropPreMultiplication, 0, kOfxImagePreMultiplied)?;
    }
    action.output.set_int(kOfxImageEffectFrameVarying, 0, 1)
}
