//! Clips and parameters of the effect.

use crate::description::{self, About};
use crate::ofx::Failure;
use crate::ofx::entry::Action;
use crate::parameters::{Kind, Parameter};
use openfx::sys::image_effect_v1::image_effect::{kOfxImageEffectPropPreMultiplication, kOfxImagePreMultiplied};
use std::ffi::CStr;

const ABOUT: About = About {
    label: "Rototoon Lines",
    description: "What a tracker of edges sees of a drawing: filtered colours, edges, distances to them.",
    tiles: false,
};

const fn parameter(id: &'static CStr, label: &'static str, kind: Kind, help: &'static str) -> Parameter {
    Parameter { id, label, help, kind, group: None }
}

/// Every parameter in order; ids are fixed for ever.
pub const PARAMETERS: [Parameter; 7] = [
    parameter(
        c"output",
        "Output",
        Kind::Choice(&["Colours", "Edges", "Distances"]),
        "The filtered colours, the edges found in them, or the distance to the nearest edge.",
    ),
    parameter(
        c"filterRadius",
        "Filter radius",
        Kind::Integer(5, [1, 60], [1, 20]),
        "Half the filter's side, in pixels.",
    ),
    parameter(
        c"filterRange",
        "Filter range",
        Kind::Integer(20, [0, 100], [0, 60]),
        "Distance of colours, in levels of 255, that the filter makes one.",
    ),
    parameter(c"sigma", "Sigma", Kind::Number(0.0, [0.0, 10.0], [0.0, 4.0]), "Blur before edges are found, in pixels."),
    parameter(
        c"lowThreshold",
        "Low threshold",
        Kind::Number(50.0, [0.0, 2000.0], [0.0, 500.0]),
        "Gradient above which an edge goes on.",
    ),
    parameter(
        c"highThreshold",
        "High threshold",
        Kind::Number(120.0, [0.0, 2000.0], [0.0, 500.0]),
        "Gradient above which an edge begins.",
    ),
    parameter(
        c"distanceRange",
        "Distance range",
        Kind::Number(20.0, [1.0, 10_000.0], [1.0, 200.0]),
        "Distance in pixels that is shown as white.",
    ),
];

/// What the effect can do.
pub fn describe(action: &Action) -> Result<(), Failure> {
    description::effect(&action.effect, &ABOUT)
}

/// Clips and parameters in a context.
pub fn describe_in_context(action: &Action) -> Result<(), Failure> {
    description::clips(action, &ABOUT)?;
    let parameters = action.effect.parameters()?;
    PARAMETERS.iter().try_for_each(|parameter| parameter.define(&parameters))
}

/// Edges are white premultiplied by what they cover; the rest is as the source.
pub fn clip_preferences(action: &Action) -> Result<(), Failure> {
    if action.effect.parameters()?.int(c"output", 0.0)? == 0 {
        return Err(Failure::Default);
    }
    action.output.set_name(kOfxImageEffectPropPreMultiplication, 0, kOfxImagePreMultiplied)
}
