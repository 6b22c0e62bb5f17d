//! The parameters of Rototoon Lines.

use super::{EffectKind, EffectParameter, parameter};

const fn line_parameter(
    id: &'static str,
    label: &'static str,
    kind: EffectKind,
    help: &'static str,
) -> EffectParameter {
    parameter(id, label, kind, None, help)
}

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
