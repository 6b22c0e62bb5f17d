//! Describes the effect's clips and parameters.

use super::overlay_entry;
use crate::description::{self, About};
use crate::ofx::entry::Action;
use crate::ofx::{Failure, host};
use crate::parameters;
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectPluginPropOverlayInteractV1, kOfxImageEffectPluginPropOverlayInteractV2,
    kOfxImageEffectPropClipPreferencesSlaveParam, kOfxImageEffectPropSupportsOverlays,
};
use rototoon::scene::effects::ROTO;

const ABOUT: About = About {
    label: "Rototoon Roto",
    description: "Draws contours of drawn characters, tracked by Rototoon, as cutouts, mattes, lines or ids, and painted and traced drawings.",
    tiles: true,
    mask: true,
};

/// Describes the effect.
pub fn describe(action: &Action) -> Result<(), Failure> {
    description::effect(&action.effect, &ABOUT)?;
    let properties = action.effect.properties()?;
    // The format of the output depends on these parameters, beside the one that all effects have.
    for (index, id) in [c"matteChannel", c"sourceAlpha", c"premultiply"].into_iter().enumerate() {
        properties.set_name(kOfxImageEffectPropClipPreferencesSlaveParam, index as i32 + 1, id)?;
    }
    // A host without overlays may lack the property for their entry point.
    if host::properties()?.int(kOfxImageEffectPropSupportsOverlays, 0).is_ok_and(|supported| supported != 0) {
        let _ = properties.set_pointer(kOfxImageEffectPluginPropOverlayInteractV1, 0, overlay_entry::of_host(false));
    }
    if host::draws() {
        let _ = properties.set_pointer(kOfxImageEffectPluginPropOverlayInteractV2, 0, overlay_entry::of_host(true));
    }
    Ok(())
}

/// Describes the clips and parameters in a context.
pub fn describe_in_context(action: &Action) -> Result<(), Failure> {
    description::clips(action, &ABOUT)?;
    parameters::define(&ROTO, &action.effect.parameters()?)
}
