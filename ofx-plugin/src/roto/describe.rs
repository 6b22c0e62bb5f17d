//! Clips and parameters of the effect.

use super::overlay_entry;
use crate::description::{self, About};
use crate::ofx::entry::Action;
use crate::ofx::{Failure, host};
use crate::parameters;
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectPluginPropOverlayInteractV1, kOfxImageEffectPluginPropOverlayInteractV2,
    kOfxImageEffectPropSupportsOverlays,
};
use rototoon::scene::effects::ROTO;

const ABOUT: About = About {
    label: "Rototoon Roto",
    description: "Contours of drawn characters, tracked by Rototoon, as cutouts, mattes, lines and ids.",
    tiles: true,
};

/// What the effect can do.
pub fn describe(action: &Action) -> Result<(), Failure> {
    description::effect(&action.effect, &ABOUT)?;
    let properties = action.effect.properties()?;
    // A host without overlays may have no place for them.
    if host::properties()?.int(kOfxImageEffectPropSupportsOverlays, 0).is_ok_and(|supported| supported != 0) {
        let _ = properties.set_pointer(kOfxImageEffectPluginPropOverlayInteractV1, 0, overlay_entry::of_host(false));
    }
    if host::draws() {
        let _ = properties.set_pointer(kOfxImageEffectPluginPropOverlayInteractV2, 0, overlay_entry::of_host(true));
    }
    Ok(())
}

/// Clips and parameters in a context.
pub fn describe_in_context(action: &Action) -> Result<(), Failure> {
    description::clips(action, &ABOUT)?;
    parameters::define(&ROTO, &action.effect.parameters()?)
}
