//! The parameters of the effects for compositing hosts, described once: the plugin makes its parameters from these lists.
//!
//! An id is fixed for ever: compositions of users name it. What the command line and the add-on have too is shared with
//! [`super::parameters`].

/// Which values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EffectKind {
    /// The path of a file.
    File,
    /// A line of text.
    Text,
    /// Text that the user does not see.
    Hidden,
    /// A button.
    Button,
    /// On or off.
    Flag(bool),
    /// A whole number: default, least, greatest, and the ends of the slider.
    Integer(i32, [i32; 2], [i32; 2]),
    /// A number: default, least, greatest, and the ends of the slider.
    Number(f64, [f64; 2], [f64; 2]),
    /// One of several, by index: labels.
    Choice(&'static [&'static str]),
    /// One of the choices of a parameter in [`super::parameters`], by its id.
    Shared(&'static str),
    /// A colour with opacity.
    Colour([f64; 4]),
    /// A group, open or not.
    Group(bool),
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Its id, that of no other parameter of the effect.
    pub id: &'static str,
    /// A few words, for people.
    pub label: &'static str,
    /// A sentence, for people.
    pub help: &'static str,
    /// Which values it takes.
    pub kind: EffectKind,
    /// The group that shows it.
    pub group: Option<&'static str>,
}

const fn parameter(
    id: &'static str,
    label: &'static str,
    kind: EffectKind,
    group: Option<&'static str>,
    help: &'static str,
) -> EffectParameter {
    EffectParameter { id, label, help, kind, group }
}

const fn line_parameter(
    id: &'static str,
    label: &'static str,
    kind: EffectKind,
    help: &'static str,
) -> EffectParameter {
    parameter(id, label, kind, None, help)
}

const SHAPES: Option<&str> = Some("shapes");
const PICTURE: Option<&str> = Some("picture");
const OVERLAY: Option<&str> = Some("lines");
const TRACKING: Option<&str> = Some("tracking");
const FRAMES: [i32; 2] = [-1_000_000, 1_000_000];

/// Rototoon Roto: every parameter in order.
pub const ROTO: [EffectParameter; 24] = [
    parameter("shapes", "Shapes", EffectKind::Group(true), None, "Where the shapes come from."),
    parameter("project", "Project", EffectKind::File, SHAPES, "A Rototoon project document. Choosing a file loads it."),
    parameter("load", "Load", EffectKind::Button, SHAPES, "Loads the project's shapes into the composition."),
    parameter("save", "Save", EffectKind::Button, SHAPES, "Writes the composition's shapes to the project's file."),
    parameter("document", "Document", EffectKind::Hidden, SHAPES, "The shapes as the text of a project document."),
    parameter(
        "frameOffset",
        "Frame offset",
        EffectKind::Integer(0, FRAMES, [-100, 100]),
        SHAPES,
        "The composition's frame that shows frame 0 of the project.",
    ),
    parameter(
        "parts",
        "Parts",
        EffectKind::Text,
        SHAPES,
        "Names of the parts, separated by commas; * stands for any text. Empty takes all parts.",
    ),
    parameter(
        "useCurves",
        "Snapped lines",
        EffectKind::Flag(true),
        SHAPES,
        "Whether outlines follow the snapped lines where they exist. Otherwise they follow the control points.",
    ),
    parameter("picture", "Picture", EffectKind::Group(true), None, "The picture made from the shapes."),
    parameter(
        "output",
        "Output",
        EffectKind::Choice(&["Cutout", "Matte", "Overlay", "Ids"]),
        PICTURE,
        "The source cut out by the parts, the matte of the parts, their outlines over the source, or a colour for each part.",
    ),
    parameter(
        "invert",
        "Invert",
        EffectKind::Flag(false),
        PICTURE,
        "Whether cutout and matte show the area outside of the parts.",
    ),
    parameter(
        "grow",
        "Grow",
        EffectKind::Number(0.0, [-1000.0, 1000.0], [-20.0, 20.0]),
        PICTURE,
        "Distance in pixels by which the outline moves outward; a negative distance moves it inward.",
    ),
    parameter(
        "feather",
        "Feather",
        EffectKind::Number(0.0, [0.0, 500.0], [0.0, 50.0]),
        PICTURE,
        "Width in pixels over which the border fades, on each side of the outline.",
    ),
    parameter(
        "motionBlur",
        "Motion blur",
        EffectKind::Number(0.0, [0.0, 10.0], [0.0, 1.0]),
        PICTURE,
        "Time during which the shutter is open, in frames, centred on the frame.",
    ),
    parameter(
        "motionBlurSamples",
        "Samples",
        EffectKind::Integer(16, [1, 64], [1, 64]),
        PICTURE,
        "Number of times within the shutter interval at which the outline is drawn.",
    ),
    parameter("lines", "Lines", EffectKind::Group(false), None, "How the overlay draws outlines."),
    parameter(
        "lineWidth",
        "Line width",
        EffectKind::Number(2.0, [0.0, 200.0], [0.0, 20.0]),
        OVERLAY,
        "Width of the lines in pixels.",
    ),
    parameter("lineColor", "Line colour", EffectKind::Colour([1.0, 0.3, 0.1, 1.0]), OVERLAY, "Colour of the lines."),
    parameter("opacity", "Opacity", EffectKind::Number(1.0, [0.0, 1.0], [0.0, 1.0]), OVERLAY, "Opacity of the lines."),
    parameter("tracking", "Tracking", EffectKind::Group(false), None, "Tracks the keys through the source's frames."),
    parameter("preset", "Method", EffectKind::Shared("preset"), TRACKING, "The tracking method."),
    parameter(
        "firstFrame",
        "First frame",
        EffectKind::Integer(0, FRAMES, [0, 1000]),
        TRACKING,
        "First frame to track. The complete source is tracked if it is not before the last frame.",
    ),
    parameter("lastFrame", "Last frame", EffectKind::Integer(0, FRAMES, [0, 1000]), TRACKING, "Last frame to track."),
    parameter(
        "track",
        "Track",
        EffectKind::Button,
        TRACKING,
        "Tracks the keys through the source's frames and stores the result in the composition.",
    ),
];

/// Rototoon Lines: every parameter in order.
pub const LINES: [EffectParameter; 7] = [
    line_parameter(
        "output",
        "Output",
        EffectKind::Choice(&["Colours", "Edges", "Distances"]),
        "The filtered colours, the edges detected in them, or the distance to the nearest edge.",
    ),
    line_parameter(
        "filterRadius",
        "Filter radius",
        EffectKind::Integer(5, [1, 60], [1, 20]),
        "Half the side of the filter's window, in pixels.",
    ),
    line_parameter(
        "filterRange",
        "Filter range",
        EffectKind::Integer(20, [0, 100], [0, 60]),
        "Colour distance below which the filter merges colours, in levels of 255.",
    ),
    line_parameter(
        "sigma",
        "Sigma",
        EffectKind::Number(0.0, [0.0, 10.0], [0.0, 4.0]),
        "Standard deviation of the blur before edge detection, in pixels.",
    ),
    line_parameter(
        "lowThreshold",
        "Low threshold",
        EffectKind::Number(50.0, [0.0, 2000.0], [0.0, 500.0]),
        "Gradient above which an edge continues.",
    ),
    line_parameter(
        "highThreshold",
        "High threshold",
        EffectKind::Number(120.0, [0.0, 2000.0], [0.0, 500.0]),
        "Gradient above which an edge starts.",
    ),
    line_parameter(
        "distanceRange",
        "Distance range",
        EffectKind::Number(20.0, [1.0, 10_000.0], [1.0, 200.0]),
        "Distance in pixels that is displayed as white.",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parameters::{self, Kind};
    use std::collections::BTreeSet;

    #[test]
    fn ids_are_unique_and_groups_come_before_what_they_hold() {
        for list in [&ROTO[..], &LINES[..]] {
            let mut known = BTreeSet::new();
            for parameter in list {
                assert!(known.insert(parameter.id), "{}", parameter.id);
                assert!(parameter.group.is_none_or(|group| known.contains(group)), "{}", parameter.id);
                match parameter.kind {
                    EffectKind::Integer(default, [low, high], [from, to]) => {
                        assert!((low..=high).contains(&default) && low <= from && from < to && to <= high);
                    }
                    EffectKind::Number(default, [low, high], [from, to]) => {
                        assert!((low..=high).contains(&default) && low <= from && from < to && to <= high);
                    }
                    EffectKind::Shared(id) => {
                        let shared = parameters::find(id).map(|parameter| parameter.kind);
                        assert!(matches!(shared, Some(Kind::Choice { .. })), "{id}");
                    }
                    _ => {}
                }
            }
        }
    }
}
