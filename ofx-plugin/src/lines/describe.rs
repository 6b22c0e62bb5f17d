//! Clips and parameters of the effect.

use crate::description::{self, About};
use crate::ofx::Failure;
use crate::ofx::entry::Action;
use crate::parameters;
use openfx::sys::image_effect_v1::image_effect::{kOfxImageEffectPropPreMultiplication, kOfxImagePreMultiplied};
use rototoon::scene::effects::LINES;

const ABOUT: About = About {
    label: "Rototoon Lines",
    description: "What a tracker of edges sees of a drawing: filtered colours, edges, distances to them.",
    tiles: false,
};

/// What the effect can do.
pub fn describe(action: &Action) -> Result<(), Failure> {
    description::effect(&action.effect, &ABOUT)
}

/// Clips and parameters in a context.
pub fn describe_in_context(action: &Action) -> Result<(), Failure> {
    description::clips(action, &ABOUT)?;
    parameters::define(&LINES, &action.effect.parameters()?)
}

/// Edges are white premultiplied by what they cover; the rest is as the source.
pub fn clip_preferences(action: &Action) -> Result<(), Failure> {
    if action.effect.parameters()?.int(c"output", 0.0)? == 0 {
        return Err(Failure::Default);
    }
    action.output.set_name(kOfxImageEffectPropPreMultiplication, 0, kOfxImagePreMultiplied)
}
