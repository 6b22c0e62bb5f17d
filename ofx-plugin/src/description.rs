//! The parts of an effect's description that all effects share.

use crate::ofx::entry::Action;
use crate::ofx::{Effect, Failure, Properties};
use openfx::sys::generic::core::{
    kOfxBitDepthByte, kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort, kOfxPropLabel, kOfxPropLongLabel,
    kOfxPropPluginDescription, kOfxPropShortLabel,
};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageClipPropIsMask, kOfxImageClipPropOptional, kOfxImageComponentAlpha, kOfxImageComponentRGB,
    kOfxImageComponentRGBA, kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral, kOfxImageEffectOutputClipName,
    kOfxImageEffectPluginPropGrouping, kOfxImageEffectPluginPropHostFrameThreading,
    kOfxImageEffectPluginRenderThreadSafety, kOfxImageEffectPropClipPreferencesSlaveParam, kOfxImageEffectPropContext,
    kOfxImageEffectPropSupportedComponents, kOfxImageEffectPropSupportedContexts,
    kOfxImageEffectPropSupportedPixelDepths, kOfxImageEffectPropSupportsMultiResolution,
    kOfxImageEffectPropSupportsMultipleClipDepths, kOfxImageEffectPropSupportsTiles,
    kOfxImageEffectPropTemporalClipAccess, kOfxImageEffectRenderFullySafe, kOfxImageEffectSimpleSourceClipName,
};
use std::ffi::CStr;

/// Name of the input clip.
pub const SOURCE: &CStr = kOfxImageEffectSimpleSourceClipName;
/// Name of the output clip.
pub const OUTPUT: &CStr = kOfxImageEffectOutputClipName;

/// Name of the optional input clip that limits a matte.
pub const MASK: &CStr = c"Mask";

const COMPONENTS: [&CStr; 3] = [kOfxImageComponentRGBA, kOfxImageComponentRGB, kOfxImageComponentAlpha];
const DEPTHS: [&CStr; 4] = [kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort, kOfxBitDepthByte];

/// The parts of an effect's description that differ between effects.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// The name that the user sees.
    pub label: &'static str,
    /// One sentence that says what the effect does.
    pub description: &'static str,
    /// Whether a piece of the picture can be rendered by itself.
    pub tiles: bool,
    /// Whether the general context has an input that limits a matte.
    pub mask: bool,
}

/// Describes an effect: labels, contexts, pixel depths and abilities.
pub fn effect(effect: &Effect, about: &About) -> Result<(), Failure> {
    let properties = effect.properties()?;
    for name in [kOfxPropLabel, kOfxPropShortLabel, kOfxPropLongLabel] {
        properties.set_text(name, 0, about.label)?;
    }
    properties.set_text(kOfxImageEffectPluginPropGrouping, 0, "Rototoon")?;
    // Hosts before OpenFX 1.2 do not have this property.
    let _ = properties.set_text(kOfxPropPluginDescription, 0, about.description);
    for (index, context) in [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral].into_iter().enumerate() {
        properties.set_name(kOfxImageEffectPropSupportedContexts, index as i32, context)?;
    }
    for (index, depth) in DEPTHS.into_iter().enumerate() {
        properties.set_name(kOfxImageEffectPropSupportedPixelDepths, index as i32, depth)?;
    }
    properties.set_int(kOfxImageEffectPropSupportsMultiResolution, 0, 1)?;
    properties.set_int(kOfxImageEffectPropSupportsTiles, 0, about.tiles.into())?;
    properties.set_int(kOfxImageEffectPropTemporalClipAccess, 0, 1)?;
    properties.set_int(kOfxImageEffectPropSupportsMultipleClipDepths, 0, 0)?;
    properties.set_name(kOfxImageEffectPluginRenderThreadSafety, 0, kOfxImageEffectRenderFullySafe)?;
    // The effects distribute rows over the host's threads themselves, because that prepares shared data only once.
    properties.set_int(kOfxImageEffectPluginPropHostFrameThreading, 0, 0)?;
    properties.set_name(kOfxImageEffectPropClipPreferencesSlaveParam, 0, c"output")
}

/// Describes the input and output clips in the action's context. The input is optional except in the filter context.
pub fn clips(action: &Action, about: &About) -> Result<(), Failure> {
    let context = action.input.text(kOfxImageEffectPropContext, 0)?;
    let source = clip(&action.effect, SOURCE, about)?;
    source.set_int(kOfxImageEffectPropTemporalClipAccess, 0, 1)?;
    if context.as_bytes() != kOfxImageEffectContextFilter.to_bytes() {
        source.set_int(kOfxImageClipPropOptional, 0, 1)?;
        if about.mask {
            let mask = clip(&action.effect, MASK, about)?;
            mask.set_int(kOfxImageClipPropOptional, 0, 1)?;
            mask.set_int(kOfxImageClipPropIsMask, 0, 1)?;
        }
    }
    clip(&action.effect, OUTPUT, about).map(|_| ())
}

fn clip<'a>(effect: &Effect<'a>, name: &CStr, about: &About) -> Result<Properties<'a>, Failure> {
    let properties = effect.define_clip(name)?;
    for (index, component) in COMPONENTS.into_iter().enumerate() {
        properties.set_name(kOfxImageEffectPropSupportedComponents, index as i32, component)?;
    }
    properties.set_int(kOfxImageEffectPropSupportsTiles, 0, about.tiles.into())?;
    Ok(properties)
}
