//! The parameters' values at a time.

use crate::ofx::{Failure, Parameters};
use rototoon::render::coverage::MOST_INSTANTS;

/// The kind of picture that is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// The source inside the parts.
    Cutout,
    /// The coverage of the parts.
    Matte,
    /// Outlines over the source.
    Overlay,
    /// The parts, each in a colour of its own.
    Ids,
}

impl Output {
    /// The chosen output.
    pub fn of(parameters: &Parameters, time: f64) -> Result<Self, Failure> {
        Ok(match parameters.int(c"output", time)? {
            1 => Self::Matte,
            2 => Self::Overlay,
            3 => Self::Ids,
            _ => Self::Cutout,
        })
    }

    /// Whether the source is in the picture.
    pub fn shows_source(self) -> bool {
        matches!(self, Self::Cutout | Self::Overlay)
    }
}

/// The values of the parameters at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The kind of picture that is drawn.
    pub output: Output,
    /// The time in the document, in frames.
    pub document_time: f64,
    /// Names of parts, as a list with commas.
    pub parts: String,
    /// Whether snapped paths are used.
    pub curves: bool,
    /// Whether cutout and matte are inverted.
    pub invert: bool,
    /// By how many pixels at full size the mask grows.
    pub grow: f64,
    /// Pixels at full size over which the mask fades, on each side of its edge.
    pub feather: f64,
    /// How long the shutter is open, in frames.
    pub shutter: f64,
    /// Number of times within the shutter's opening.
    pub samples: usize,
    /// Width of lines in pixels at full size.
    pub line_width: f64,
    /// RGB and opacity of lines.
    pub line_colour: [f32; 4],
}

impl Settings {
    /// Reads the values. A number that is not finite counts as 0.
    pub fn read(parameters: &Parameters, time: f64) -> Result<Self, Failure> {
        let number = |id| parameters.double(id, time).map(|v| if v.is_finite() { v } else { 0.0 });
        let [r, g, b, a] = parameters.colour(c"lineColor", time)?;
        let alpha = (a * number(c"opacity")?).clamp(0.0, 1.0);
        Ok(Self {
            output: Output::of(parameters, time)?,
            document_time: time - f64::from(parameters.int(c"frameOffset", time)?),
            parts: parameters.text(c"parts")?,
            curves: parameters.int(c"useCurves", time)? != 0,
            invert: parameters.int(c"invert", time)? != 0,
            grow: number(c"grow")?,
            feather: number(c"feather")?.max(0.0),
            shutter: number(c"motionBlur")?.max(0.0),
            samples: parameters.int(c"motionBlurSamples", time)?.clamp(1, MOST_INSTANTS as i32) as usize,
            line_width: number(c"lineWidth")?.max(0.0),
            line_colour: [r, g, b, alpha].map(|v| v as f32),
        })
    }
}
