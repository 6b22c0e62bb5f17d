//! Clips and parameters of the effect.

use crate::ofx::entry::Action;
use crate::ofx::{Effect, Failure};
use crate::parameters::{Kind, Parameter};
use openfx::sys::generic::core::{
    kOfxBitDepthByte, kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort, kOfxPropLabel, kOfxPropLongLabel,
    kOfxPropPluginDescription, kOfxPropShortLabel,
};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageClipPropOptional, kOfxImageComponentAlpha, kOfxImageComponentRGB, kOfxImageComponentRGBA,
    kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral, kOfxImageEffectOutputClipName,
    kOfxImageEffectPluginPropGrouping, kOfxImageEffectPluginPropHostFrameThreading,
    kOfxImageEffectPluginRenderThreadSafety, kOfxImageEffectPropClipPreferencesSlaveParam,
    kOfxImageEffectPropContext, kOfxImageEffectPropSupportedComponents, kOfxImageEffectPropSupportedContexts,
    kOfxImageEffectPropSupportedPixelDepths, kOfxImageEffectPropSupportsMultiResolution,
    kOfxImageEffectPropSupportsMultipleClipDepths, kOfxImageEffectPropSupportsTiles,
    kOfxImageEffectPropTemporalClipAccess, kOfxImageEffectRenderFullySafe, kOfxImageEffectSimpleSourceClipName,
};
use std::ffi::CStr;

/// The input.
pub const SOURCE: &CStr = kOfxImageEffectSimpleSourceClipName;
/// The output.
pub const OUTPUT: &CStr = kOfxImageEffectOutputClipName;

const fn parameter(
    id: &'static CStr,
    label: &'static str,
    kind: Kind,
    group: Option<&'static CStr>,
    help: &'static str,
) -> Parameter {
    Parameter { id, label, help, kind, group }
}

const SHAPES: Option<&CStr> = Some(c"shapes");
const PICTURE: Option<&CStr> = Some(c"picture");
const LINES: Option<&CStr> = Some(c"lines");
const TRACKING: Option<&CStr> = Some(c"tracking");
const FRAMES: [i32; 2] = [-1_000_000, 1_000_000];

/// Every parameter in order; ids are fixed for ever.
pub const PARAMETERS: [Parameter; 24] = [
    parameter(c"shapes", "Shapes", Kind::Group(true), None, "Where the shapes come from."),
    parameter(c"project", "Project", Kind::File, SHAPES, "A Rototoon project document; choosing one loads it."),
    parameter(c"load", "Load", Kind::Button, SHAPES, "Takes the project's shapes into the composition."),
    parameter(c"save", "Save", Kind::Button, SHAPES, "Writes the composition's shapes to the project's file."),
    parameter(c"document", "Document", Kind::Hidden, SHAPES, "The shapes themselves, as a project document."),
    parameter(
        c"frameOffset",
        "Frame offset",
        Kind::Integer(0, FRAMES, [-100, 100]),
        SHAPES,
        "The composition's frame on which frame 0 of the project lies.",
    ),
    parameter(
        c"parts",
        "Parts",
        Kind::Text,
        SHAPES,
        "Names of the parts, separated by commas; * stands for any text. All parts where it is empty.",
    ),
    parameter(
        c"useCurves",
        "Snapped lines",
        Kind::Flag(true),
        SHAPES,
        "Whether the outline follows lines snapped to the drawing where there are any, and not the control points.",
    ),
    parameter(c"picture", "Picture", Kind::Group(true), None, "What is made of them."),
    parameter(
        c"output",
        "Output",
        Kind::Choice(&["Cutout", "Matte", "Overlay", "Ids"]),
        PICTURE,
        "The source cut out by the parts, their matte, their outlines over the source, or a colour for each part.",
    ),
    parameter(c"invert", "Invert", Kind::Flag(false), PICTURE, "Whether cutout and matte are of what is not in a part."),
    parameter(
        c"grow",
        "Grow",
        Kind::Number(0.0, [-1000.0, 1000.0], [-20.0, 20.0]),
        PICTURE,
        "Pixels by which the outline is moved outward, or inward where negative.",
    ),
    parameter(
        c"feather",
        "Feather",
        Kind::Number(0.0, [0.0, 500.0], [0.0, 50.0]),
        PICTURE,
        "Pixels over which the border fades on each side.",
    ),
    parameter(
        c"motionBlur",
        "Motion blur",
        Kind::Number(0.0, [0.0, 10.0], [0.0, 1.0]),
        PICTURE,
        "Frames that the shutter is open, around the frame.",
    ),
    parameter(
        c"motionBlurSamples",
        "Samples",
        Kind::Integer(16, [1, 64], [1, 64]),
        PICTURE,
        "Times within the shutter at which the outline is drawn.",
    ),
    parameter(c"lines", "Lines", Kind::Group(false), None, "How the overlay draws outlines."),
    parameter(
        c"lineWidth",
        "Line width",
        Kind::Number(2.0, [0.0, 200.0], [0.0, 20.0]),
        LINES,
        "Pixels across a line.",
    ),
    parameter(c"lineColor", "Line colour", Kind::Colour([1.0, 0.3, 0.1, 1.0]), LINES, "Colour of the lines."),
    parameter(c"opacity", "Opacity", Kind::Number(1.0, [0.0, 1.0], [0.0, 1.0]), LINES, "Opacity of the lines."),
    parameter(c"tracking", "Tracking", Kind::Group(false), None, "Following the keys through the source's frames."),
    parameter(c"preset", "Method", Kind::Shared("preset"), TRACKING, "The method that tracks."),
    parameter(
        c"firstFrame",
        "First frame",
        Kind::Integer(0, FRAMES, [0, 1000]),
        TRACKING,
        "First frame that is tracked. The whole source where it is not before the last.",
    ),
    parameter(
        c"lastFrame",
        "Last frame",
        Kind::Integer(0, FRAMES, [0, 1000]),
        TRACKING,
        "Last frame that is tracked.",
    ),
    parameter(
        c"track",
        "Track",
        Kind::Button,
        TRACKING,
        "Follows the keys through the source's frames and keeps the result in the composition.",
    ),
];

const COMPONENTS: [&CStr; 3] = [kOfxImageComponentRGBA, kOfxImageComponentRGB, kOfxImageComponentAlpha];

/// What the effect can do.
pub fn describe(action: &Action) -> Result<(), Failure> {
    let properties = action.effect.properties()?;
    for name in [kOfxPropLabel, kOfxPropShortLabel, kOfxPropLongLabel] {
        properties.set_text(name, 0, "Rototoon Roto")?;
    }
    properties.set_text(kOfxImageEffectPluginPropGrouping, 0, "Rototoon")?;
    // Hosts before 1.2 have no place for a description.
    let _ = properties.set_text(
        kOfxPropPluginDescription,
        0,
        "Contours of drawn characters, tracked by Rototoon, as cutouts, mattes, lines and ids.",
    );
    for (index, context) in [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral].into_iter().enumerate() {
        properties.set_name(kOfxImageEffectPropSupportedContexts, index as i32, context)?;
    }
    let depths = [kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort, kOfxBitDepthByte];
    for (index, depth) in depths.into_iter().enumerate() {
        properties.set_name(kOfxImageEffectPropSupportedPixelDepths, index as i32, depth)?;
    }
    properties.set_int(kOfxImageEffectPropSupportsMultiResolution, 0, 1)?;
    properties.set_int(kOfxImageEffectPropSupportsTiles, 0, 1)?;
    properties.set_int(kOfxImageEffectPropTemporalClipAccess, 0, 1)?;
    properties.set_int(kOfxImageEffectPropSupportsMultipleClipDepths, 0, 0)?;
    properties.set_name(kOfxImageEffectPluginRenderThreadSafety, 0, kOfxImageEffectRenderFullySafe)?;
    // Rows are shared among the host's threads by the effect itself, which prepares the outlines once.
    properties.set_int(kOfxImageEffectPluginPropHostFrameThreading, 0, 0)?;
    properties.set_name(kOfxImageEffectPropClipPreferencesSlaveParam, 0, c"output")
}

/// Clips and parameters in a context.
pub fn describe_in_context(action: &Action) -> Result<(), Failure> {
    let context = action.input.text(kOfxImageEffectPropContext, 0)?;
    let source = clip(&action.effect, SOURCE)?;
    source.set_int(kOfxImageEffectPropTemporalClipAccess, 0, 1)?;
    if context.as_bytes() != kOfxImageEffectContextFilter.to_bytes() {
        source.set_int(kOfxImageClipPropOptional, 0, 1)?;
    }
    clip(&action.effect, OUTPUT)?;
    let parameters = action.effect.parameters()?;
    PARAMETERS.iter().try_for_each(|parameter| parameter.define(&parameters))
}

fn clip<'a>(effect: &Effect<'a>, name: &CStr) -> Result<crate::ofx::Properties<'a>, Failure> {
    let properties = effect.define_clip(name)?;
    for (index, component) in COMPONENTS.into_iter().enumerate() {
        properties.set_name(kOfxImageEffectPropSupportedComponents, index as i32, component)?;
    }
    properties.set_int(kOfxImageEffectPropSupportsTiles, 0, 1)?;
    Ok(properties)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn ids_are_unique_and_groups_come_before_what_they_hold() {
        let mut known = BTreeSet::new();
        for parameter in &PARAMETERS {
            assert!(known.insert(parameter.id), "{:?}", parameter.id);
            assert!(parameter.group.is_none_or(|group| known.contains(group)), "{:?}", parameter.id);
            match parameter.kind {
                Kind::Integer(default, [low, high], [from, to]) => {
                    assert!((low..=high).contains(&default) && low <= from && from < to && to <= high);
                }
                Kind::Number(default, [low, high], [from, to]) => {
                    assert!((low..=high).contains(&default) && low <= from && from < to && to <= high);
                }
                Kind::Shared(id) => assert!(!crate::parameters::shared(id).0.is_empty(), "{id}"),
                _ => {}
            }
        }
    }
}
