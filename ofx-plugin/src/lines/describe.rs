//! Describes the effect's clips and parameters.

use crate::description::{self, About};
use crate::ofx::Failure;
use crate::ofx::entry::Action;
use crate::parameters;
use openfx::sys::image_effect_v1::image_effect::{kOfxImageEffectPropPreMultiplication, kOfxImagePreMultiplied};
use rototoon::scene::effects::LINES;

const ABOUT: About = About {
    label: "Rototoon Lines",
    description: "Shows the images that a tracker of edges uses: filtered colours, edges, distances to the edges.",
    tiles: false,
    mask: false,
};

/// Describes the effect.
pub fn describe(action: &Action) -> Result<(), Failure> {
    description::effect(&action.effect, &ABOUT)
}

/// Describes the clips and parameters in a context.
pub fn describe_in_context(action: &Action) -> Result<(), Failure> {
    description::clips(action, &ABOUT)?;
    parameters::define(&LINES, &action.effect.parameters()?)
}

/// Sets the premultiplication of the output: edges and distances are premultiplied, filtered colours are as the source.
pub fn clip_preferences(action: &Action) -> Result<(), Failure> {
    if action.effect.parameters()?.int(c"output", 0.0)? == 0 {
        return Err(Failure::Default);
    }
    action.output.set_name(kOfxImageEffectPropPreMultiplication, 0, kOfxImagePreMultiplied)
}
