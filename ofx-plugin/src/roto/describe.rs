//! Clips and parameters of the effect.

use crate::description::{self, About};
use crate::ofx::entry::Action;
use crate::ofx::{Failure, host};
use crate::parameters::{Kind, Parameter};
use crate::plugins;
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectPluginPropOverlayInteractV1, kOfxImageEffectPluginPropOverlayInteractV2,
    kOfxImageEffectPropSupportsOverlays,
};
use std::ffi::CStr;

const ABOUT: About = About {
    label: "Rototoon Roto",
    description: "Contours of drawn characters, tracked by Rototoon, as cutouts, mattes, lines and ids.",
    tiles: true,
};

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
    parameter(
        c"invert",
        "Invert",
        Kind::Flag(false),
        PICTURE,
        "Whether cutout and matte are of what is not in a part.",
    ),
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
    parameter(c"lineWidth", "Line width", Kind::Number(2.0, [0.0, 200.0], [0.0, 20.0]), LINES, "Pixels across a line."),
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
    parameter(c"lastFrame", "Last frame", Kind::Integer(0, FRAMES, [0, 1000]), TRACKING, "Last frame that is tracked."),
    parameter(
        c"track",
        "Track",
        Kind::Button,
        TRACKING,
        "Follows the keys through the source's frames and keeps the result in the composition.",
    ),
];

/// What the effect can do.
pub fn describe(action: &Action) -> Result<(), Failure> {
    description::effect(&action.effect, &ABOUT)?;
    let properties = action.effect.properties()?;
    // A host without overlays may have no place for them.
    if host::properties()?.int(kOfxImageEffectPropSupportsOverlays, 0).is_ok_and(|supported| supported != 0) {
        let _ = properties.set_pointer(kOfxImageEffectPluginPropOverlayInteractV1, 0, plugins::roto_overlay(false));
    }
    if host::draws() {
        let _ = properties.set_pointer(kOfxImageEffectPluginPropOverlayInteractV2, 0, plugins::roto_overlay(true));
    }
    Ok(())
}

/// Clips and parameters in a context.
pub fn describe_in_context(action: &Action) -> Result<(), Failure> {
    description::clips(action, &ABOUT)?;
    let parameters = action.effect.parameters()?;
    PARAMETERS.iter().try_for_each(|parameter| parameter.define(&parameters))
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
