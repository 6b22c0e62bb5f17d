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
    /// A whole number that the effect itself sets with keys, which are marks in the host's timeline. The picture does not
    /// depend on it.
    Mark,
    /// A number: default, least, greatest, and the ends of the slider.
    Number(f64, [f64; 2], [f64; 2]),
    /// One of several, by index: labels.
    Choice(&'static [&'static str]),
    /// One of the choices of a parameter in [`super::parameters`], by its id.
    Shared(&'static str),
    /// A colour with opacity.
    Colour([f64; 4]),
    /// Two numbers, x and y.
    Pair([f64; 2]),
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
const DRAW: Option<&str> = Some("draw");
const PART: Option<&str> = Some("selectedPart");
const PICTURE: Option<&str> = Some("picture");
const OVERLAY: Option<&str> = Some("lines");
const TRACKING: Option<&str> = Some("tracking");
const MARKS: Option<&str> = Some("marks");
const MOTION: Option<&str> = Some("motion");
const FRAMES: [i32; 2] = [-1_000_000, 1_000_000];
const PLANE: [f64; 2] = [-1_000_000.0, 1_000_000.0];

/// Rototoon Roto: every parameter in order.
pub const ROTO: [EffectParameter; 79] = [
    parameter("shapes", "Shapes", EffectKind::Group(true), None, "Where the shapes come from."),
    parameter(
        "project",
        "Project",
        EffectKind::File,
        SHAPES,
        "A Rototoon project document, or shapes of Nuke (.nk), Natron (.ntp), Silhouette (.fxs) or SVG. Choosing a file loads it.",
    ),
    parameter("load", "Load", EffectKind::Button, SHAPES, "Loads the project's shapes into the composition."),
    parameter("save", "Save", EffectKind::Button, SHAPES, "Writes the composition's shapes to the project's file."),
    parameter("document", "Document", EffectKind::Hidden, SHAPES, "The shapes as the text of a project document."),
    parameter(
        "state",
        "State",
        EffectKind::Hidden,
        SHAPES,
        "The settings of the parts, and what their tracks were made from.",
    ),
    parameter(
        "frameOffset",
        "Frame offset",
        EffectKind::Integer(0, FRAMES, FRAMES),
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
    parameter(
        "draw",
        "Draw and edit",
        EffectKind::Group(true),
        None,
        "Keys and corrections with the pen in the viewer.",
    ),
    parameter(
        "tool",
        "Tool",
        EffectKind::Choice(&["Select", "Draw contour", "Draw freehand", "Off"]),
        DRAW,
        "What the pen does in the viewer: it selects and moves points, sets the points of a contour one by one, draws a contour in one stroke, or nothing.",
    ),
    parameter(
        "drawClosed",
        "Closed",
        EffectKind::Flag(true),
        DRAW,
        "Whether a new contour is closed. An open contour draws lines only.",
    ),
    parameter(
        "part",
        "Part",
        EffectKind::Text,
        DRAW,
        "Name of the selected part. A contour that is drawn becomes its key on this frame. Empty makes a new part.",
    ),
    parameter(
        "newPart",
        "New part",
        EffectKind::Button,
        DRAW,
        "Selects no part, so that the next contour that is drawn becomes a new part.",
    ),
    parameter(
        "newKey",
        "New key here",
        EffectKind::Button,
        DRAW,
        "Makes the shape of the selected part on this frame its key; without a selected part, the shapes of all parts.",
    ),
    parameter(
        "deleteKey",
        "Delete key here",
        EffectKind::Button,
        DRAW,
        "Deletes the selected part's key on this frame.",
    ),
    parameter(
        "insertPoints",
        "Insert points",
        EffectKind::Button,
        DRAW,
        "Inserts a point in the middle between neighbouring selected points, on every key and frame.",
    ),
    parameter(
        "deletePoints",
        "Delete points",
        EffectKind::Button,
        DRAW,
        "Deletes the selected points on every key and frame.",
    ),
    parameter(
        "smoothPoints",
        "Smooth points",
        EffectKind::Button,
        DRAW,
        "Moves the selected points on this frame towards the middle of their neighbours.",
    ),
    parameter(
        "deletePart",
        "Delete part",
        EffectKind::Button,
        DRAW,
        "Deletes the selected part with all of its keys, corrections and tracks.",
    ),
    parameter(
        "hideHere",
        "Hidden here",
        EffectKind::Button,
        DRAW,
        "Says that the footage does not show the selected part on this frame: it has no contour here. Press again, and it is there again.",
    ),
    parameter(
        "hideStretch",
        "Hidden while lost",
        EffectKind::Button,
        DRAW,
        "The same on all frames around this one on which the selected part is lost, or hidden already.",
    ),
    parameter(
        "selectedPart",
        "Selected part",
        EffectKind::Group(false),
        None,
        "Settings of the part that is named in Part. Each part has its own, with its own keys.",
    ),
    parameter("partOn", "On", EffectKind::Flag(true), PART, "Whether the part is drawn."),
    parameter(
        "partMode",
        "Mode",
        EffectKind::Choice(&["Add", "Subtract", "Intersect"]),
        PART,
        "How the part changes the matte of the parts behind it.",
    ),
    parameter(
        "partInvert",
        "Invert",
        EffectKind::Flag(false),
        PART,
        "Whether the part is what lies outside of its outline.",
    ),
    parameter(
        "partOpacity",
        "Opacity",
        EffectKind::Number(1.0, [0.0, 1.0], [0.0, 1.0]),
        PART,
        "Opacity of the part in cutout and matte.",
    ),
    parameter(
        "partGrow",
        "Grow",
        EffectKind::Number(0.0, [-1000.0, 1000.0], [-20.0, 20.0]),
        PART,
        "Distance in pixels by which the part's outline moves outward, beside that of all parts.",
    ),
    parameter(
        "partFeather",
        "Feather",
        EffectKind::Number(0.0, [0.0, 500.0], [0.0, 50.0]),
        PART,
        "Width in pixels over which the part's border fades, beside that of all parts.",
    ),
    parameter(
        "partLock",
        "Lock",
        EffectKind::Flag(false),
        PART,
        "Whether the part can be neither selected nor changed with the pen.",
    ),
    parameter("picture", "Picture", EffectKind::Group(true), None, "The picture made from the shapes."),
    parameter(
        "output",
        "Output",
        EffectKind::Choice(&["Cutout", "Matte", "Overlay", "Ids", "Mattes"]),
        PICTURE,
        "The source cut out by the parts, the matte of the parts, their outlines over the source, a colour for each part, or a matte of its own in each channel.",
    ),
    parameter(
        "matteChannel",
        "Matte channel",
        EffectKind::Choice(&["All", "Alpha", "Red", "Green", "Blue"]),
        PICTURE,
        "The channel of the matte. The other channels are those of the source.",
    ),
    parameter(
        "sourceAlpha",
        "Source alpha",
        EffectKind::Choice(&["Ignore", "Multiply", "Add"]),
        PICTURE,
        "What the matte does with the alpha of the source.",
    ),
    parameter(
        "premultiply",
        "Premultiply",
        EffectKind::Flag(false),
        PICTURE,
        "Whether a matte in alpha multiplies the colours of the source.",
    ),
    parameter(
        "redParts",
        "Red parts",
        EffectKind::Text,
        PICTURE,
        "Mattes: the parts in red, as in Parts. Empty draws none.",
    ),
    parameter("greenParts", "Green parts", EffectKind::Text, PICTURE, "Mattes: the parts in green."),
    parameter("blueParts", "Blue parts", EffectKind::Text, PICTURE, "Mattes: the parts in blue."),
    parameter("alphaParts", "Alpha parts", EffectKind::Text, PICTURE, "Mattes: the parts in alpha."),
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
        "Time during which the shutter is open, in frames.",
    ),
    parameter(
        "shutterPhase",
        "Shutter phase",
        EffectKind::Number(-180.0, [-360.0, 360.0], [-180.0, 180.0]),
        PICTURE,
        "When the shutter opens, in degrees of its opening before or after the frame: -180 is centred on the frame, 0 begins at it, -360 ends at it.",
    ),
    parameter(
        "motionBlurSamples",
        "Samples",
        EffectKind::Integer(16, [1, 64], [1, 64]),
        PICTURE,
        "Number of times within the shutter interval at which the outline is drawn.",
    ),
    parameter(
        "useMask",
        "Use mask",
        EffectKind::Flag(false),
        PICTURE,
        "Whether the alpha of the input Mask limits the matte and the cutout.",
    ),
    parameter(
        "region",
        "Region",
        EffectKind::Choice(&["Shapes", "Source", "Format"]),
        PICTURE,
        "The rectangle that the node defines: that of the shapes, of the source, or of the project's format.",
    ),
    parameter(
        "limitFrames",
        "Limit frames",
        EffectKind::Flag(false),
        PICTURE,
        "Whether the parts are drawn on some frames only.",
    ),
    parameter("shownFirst", "First shown", EffectKind::Integer(1, FRAMES, FRAMES), PICTURE, "First of these frames."),
    parameter("shownLast", "Last shown", EffectKind::Integer(100, FRAMES, FRAMES), PICTURE, "Last of these frames."),
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
        EffectKind::Integer(0, FRAMES, FRAMES),
        TRACKING,
        "First frame to track. The complete source is tracked if it is not before the last frame.",
    ),
    parameter("lastFrame", "Last frame", EffectKind::Integer(0, FRAMES, FRAMES), TRACKING, "Last frame to track."),
    parameter(
        "track",
        "Track",
        EffectKind::Button,
        TRACKING,
        "Tracks the keys through the source's frames and stores the result in the composition.",
    ),
    parameter(
        "previousLost",
        "Previous lost",
        EffectKind::Button,
        TRACKING,
        "Goes to the nearest earlier frame on which a part begins to be lost.",
    ),
    parameter(
        "nextLost",
        "Next lost",
        EffectKind::Button,
        TRACKING,
        "Goes to the nearest later frame on which a part begins to be lost.",
    ),
    parameter(
        "weakest",
        "Weakest frame",
        EffectKind::Button,
        TRACKING,
        "Goes to the frame on which the next key helps most.",
    ),
    parameter(
        "marks",
        "Timeline marks",
        EffectKind::Group(false),
        None,
        "Keys that the node sets itself, so that the host's timeline shows the key frames of the shapes and where parts are lost.",
    ),
    parameter(
        "keyMarks",
        "Key frames",
        EffectKind::Mark,
        MARKS,
        "Has a key on each key frame of the shapes: the number of parts that are keyed there.",
    ),
    parameter(
        "lostMarks",
        "Lost parts",
        EffectKind::Mark,
        MARKS,
        "The number of parts that are probably wrong, with keys where it changes.",
    ),
    parameter(
        "doubtfulMarks",
        "Doubtful parts",
        EffectKind::Mark,
        MARKS,
        "The number of parts that deserve a look, with keys where it changes.",
    ),
    parameter(
        "hiddenMarks",
        "Hidden parts",
        EffectKind::Mark,
        MARKS,
        "The number of parts that the footage does not show, with keys where it changes.",
    ),
    parameter("motion", "Motion and export", EffectKind::Group(false), None, "Takes motions and shapes out."),
    parameter(
        "writeMotion",
        "Write motion",
        EffectKind::Button,
        MOTION,
        "Sets keys for the motion of the selected part on all of its frames, to which parameters of other nodes can be linked.",
    ),
    parameter("center", "Centre", EffectKind::Pair([0.0; 2]), MOTION, "Middle of the part's control points."),
    parameter(
        "translate",
        "Translate",
        EffectKind::Pair([0.0; 2]),
        MOTION,
        "How far the part has moved since its first frame.",
    ),
    parameter(
        "rotate",
        "Rotate",
        EffectKind::Number(0.0, PLANE, [-180.0, 180.0]),
        MOTION,
        "How far it has turned, in degrees anticlockwise about its centre.",
    ),
    parameter(
        "scale",
        "Scale",
        EffectKind::Number(1.0, [0.0, 1000.0], [0.0, 4.0]),
        MOTION,
        "How much it has grown, as a factor.",
    ),
    parameter(
        "corner1",
        "Corner 1",
        EffectKind::Pair([0.0; 2]),
        MOTION,
        "Where the lower left corner of its first rectangle has moved.",
    ),
    parameter("corner2", "Corner 2", EffectKind::Pair([0.0; 2]), MOTION, "Where the lower right corner has moved."),
    parameter("corner3", "Corner 3", EffectKind::Pair([0.0; 2]), MOTION, "Where the upper right corner has moved."),
    parameter("corner4", "Corner 4", EffectKind::Pair([0.0; 2]), MOTION, "Where the upper left corner has moved."),
    parameter(
        "exportFile",
        "Export file",
        EffectKind::File,
        MOTION,
        "File of the shapes for other programs: .nk for Nuke, .py for Natron, .jsx for After Effects, .fxs for Silhouette, .svg for browsers.",
    ),
    parameter("export", "Export", EffectKind::Button, MOTION, "Writes the shapes to the export file."),
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
