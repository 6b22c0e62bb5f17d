//! The parameters for users, described once. The command line, the add-on and other hosts read [`ALL`] and build their
//! options and panels from it.
//!
//! An id is unique among all stages and is never reused for another parameter.

use serde::Serialize;

/// The stage to which a parameter belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Every long computation.
    Run,
    /// Tracking.
    Track,
    /// Snapping to the ink lines.
    Snap,
    /// Rendered pictures of the result.
    Render,
    /// Files for other programs.
    Export,
}

/// One of the values of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// The value in options and files.
    pub id: &'static str,
    /// Name that people see.
    pub label: &'static str,
}

/// The values that a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Kind {
    /// One of the choices.
    Choice {
        /// Id of the default choice.
        default: &'static str,
        /// All choices.
        choices: &'static [Choice],
    },
    /// An integer.
    Integer {
        /// Default.
        default: i64,
        /// Least value.
        min: i64,
        /// Greatest value.
        max: i64,
    },
    /// A number.
    Number {
        /// Default.
        default: f64,
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
        /// Unit that people see; may be empty.
        unit: &'static str,
    },
    /// On or off.
    Flag {
        /// Default.
        default: bool,
    },
}

/// A parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Id, unique among all parameters.
    pub id: &'static str,
    /// Name that people see.
    pub label: &'static str,
    /// Help text of one sentence.
    pub help: &'static str,
    /// The stage to which it belongs.
    pub stage: Stage,
    /// The values that it takes.
    #[serde(flatten)]
    pub kind: Kind,
}

const fn choice(id: &'static str, label: &'static str) -> Choice {
    Choice { id, label }
}

/// Every parameter, in the order of the stages.
pub const ALL: [Parameter; 17] = [
    Parameter {
        id: "threads",
        label: "Threads",
        help: "Number of threads; 0 takes one for each core. The number does not change the result.",
        stage: Stage::Run,
        kind: Kind::Integer { default: 0, min: 0, max: 1024 },
    },
    Parameter {
        id: "preset",
        label: "Method",
        help: "The tracking method.",
        stage: Stage::Track,
        kind: Kind::Choice {
            default: "rototoon",
            choices: &[
                choice("rototoon", "Rototoon"),
                choice("zhou2011", "Zhou & Xiao 2011"),
                choice("agarwala2004", "Agarwala et al. 2004"),
                choice("liang2012", "Liang et al. 2012"),
            ],
        },
    },
    Parameter {
        id: "follow",
        label: "Follow",
        help: "The feature of the drawing that snapped paths follow.",
        stage: Stage::Snap,
        kind: Kind::Choice {
            default: "auto",
            choices: &[
                choice("auto", "Border or ink, whichever the points are on"),
                choice("edge", "Border between two colours"),
                choice("line", "Centre of the ink"),
            ],
        },
    },
    Parameter {
        id: "corridor_share",
        label: "Corridor",
        help: "Greatest distance between a snapped path and its segment, as a share of the segment's length.",
        stage: Stage::Snap,
        kind: Kind::Number { default: 0.3, min: 0.0, max: 2.0, unit: "" },
    },
    Parameter {
        id: "corridor_least",
        label: "Least corridor",
        help: "Lower limit of the distance between a snapped path and its segment, at 540 lines.",
        stage: Stage::Snap,
        kind: Kind::Number { default: 4.0, min: 1.5, max: 100.0, unit: "px" },
    },
    Parameter {
        id: "corridor_most",
        label: "Greatest corridor",
        help: "Upper limit of the distance between a snapped path and its segment, at 540 lines.",
        stage: Stage::Snap,
        kind: Kind::Number { default: 40.0, min: 1.5, max: 500.0, unit: "px" },
    },
    Parameter {
        id: "what",
        label: "What",
        help: "The picture to render: contours over the footage, the matte of the closed parts, \
               the footage cut out by them, a colour for each part, painted regions, \
               the drawing over them, strokes, or strokes over painted regions.",
        stage: Stage::Render,
        kind: Kind::Choice {
            default: "overlay",
            choices: &[
                choice("overlay", "Contours over the footage"),
                choice("matte", "Matte of the closed parts"),
                choice("cutout", "Footage within the closed parts"),
                choice("ids", "A colour for each part; in OpenEXR also Cryptomatte layers"),
                choice("paint", "Painted regions alone; in OpenEXR also Cryptomatte layers"),
                choice("painted", "The drawing over its painted regions"),
                choice("lines", "Strokes alone: traced, of in-betweens, or drawn; in OpenEXR also Cryptomatte layers"),
                choice("cel", "The same strokes over painted regions; in OpenEXR also Cryptomatte layers"),
            ],
        },
    },
    Parameter {
        id: "scale",
        label: "Scale",
        help: "Size of the picture as a multiple of the footage's, for what is drawn without the footage: \
               painted regions and strokes.",
        stage: Stage::Render,
        kind: Kind::Number { default: 1.0, min: 0.1, max: 16.0, unit: "" },
    },
    Parameter {
        id: "layers",
        label: "Layers",
        help: "Whether a matte in OpenEXR also contains the complete matte of each part, in a layer with the part's name.",
        stage: Stage::Render,
        kind: Kind::Flag { default: false },
    },
    Parameter {
        id: "multipart",
        label: "Multi-part",
        help: "Whether a matte in OpenEXR also contains the complete matte of each part, as a part of the file with its name.",
        stage: Stage::Render,
        kind: Kind::Flag { default: false },
    },
    Parameter {
        id: "exr",
        label: "Numbers in OpenEXR",
        help: "The bits of numbers in OpenEXR. Cryptomatte layers have 32 bits always.",
        stage: Stage::Render,
        kind: Kind::Choice { default: "float", choices: &[choice("float", "32 bits"), choice("half", "16 bits")] },
    },
    Parameter {
        id: "compression",
        label: "Compression of OpenEXR",
        help: "How OpenEXR files are compressed. All ways keep every bit.",
        stage: Stage::Render,
        kind: Kind::Choice {
            default: "zip",
            choices: &[
                choice("zip", "Deflate, 16 lines at a time"),
                choice("zips", "Deflate, each line by itself"),
                choice("piz", "Wavelets, for pictures with grain"),
                choice("rle", "Runs of equal bytes"),
                choice("none", "Not compressed"),
            ],
        },
    },
    Parameter {
        id: "line_width",
        label: "Line width",
        help: "Width of the overlay's lines, at 540 lines.",
        stage: Stage::Render,
        kind: Kind::Number { default: 2.0, min: 0.5, max: 50.0, unit: "px" },
    },
    Parameter {
        id: "points",
        label: "Control points",
        help: "Whether the overlay shows the control points.",
        stage: Stage::Render,
        kind: Kind::Flag { default: true },
    },
    Parameter {
        id: "confidence",
        label: "Confidence",
        help: "Whether colour and opacity in the overlay show the confidence of each tracked point.",
        stage: Stage::Render,
        kind: Kind::Flag { default: true },
    },
    Parameter {
        id: "motion",
        label: "Motion",
        help: "Motion of an exported path between frames.",
        stage: Stage::Export,
        kind: Kind::Choice {
            default: "hold",
            choices: &[choice("hold", "Holds each frame"), choice("linear", "Moves evenly")],
        },
    },
    Parameter {
        id: "spacing",
        label: "Spacing",
        help: "Distance between the points of an exported snapped path, in pixels of the footage.",
        stage: Stage::Export,
        kind: Kind::Number { default: 2.0, min: 0.25, max: 100.0, unit: "px" },
    },
];

/// The parameter with this id; `None` if there is none.
pub fn find(id: &str) -> Option<&'static Parameter> {
    ALL.iter().find(|parameter| parameter.id == id)
}

/// The parameters of a stage, in the order of [`ALL`].
pub fn of(stage: Stage) -> impl Iterator<Item = &'static Parameter> {
    ALL.iter().filter(move |parameter| parameter.stage == stage)
}

/// The list as JSON.
pub fn to_json() -> String {
    serde_json::json!(ALL).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn ids_are_unique_and_defaults_are_allowed() {
        let ids: BTreeSet<_> = ALL.iter().map(|parameter| parameter.id).collect();
        assert_eq!(ids.len(), ALL.len());
        for parameter in &ALL {
            match parameter.kind {
                Kind::Choice { default, choices } => assert!(choices.iter().any(|choice| choice.id == default)),
                Kind::Integer { default, min, max } => assert!((min..=max).contains(&default)),
                Kind::Number { default, min, max, .. } => assert!((min..=max).contains(&default)),
                Kind::Flag { .. } => {}
            }
        }
    }

    #[test]
    fn hosts_read_the_list_as_json() {
        let list: serde_json::Value = serde_json::from_str(&to_json()).unwrap();
        let threads = &list[0];
        assert_eq!(
            (&threads["id"], &threads["type"], &threads["max"]),
            (&"threads".into(), &"integer".into(), &1024.into())
        );
        assert_eq!(list[1]["choices"][1]["id"], "zhou2011");
    }
}
