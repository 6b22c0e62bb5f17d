//! Strokes as they are handed out, and the options of tracing.

use rototoon_base::geometry::Point;
use rototoon_base::scene::Colour;
use serde::{Deserialize, Serialize};

/// A traced stroke.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    /// Points in pixels (x right, y down, a pixel's centre at +0.5).
    pub points: Vec<Point>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Width in pixels at each point; empty for a fill.
    pub widths: Vec<f64>,
    /// Colour, sRGB-encoded, 0 to 1.
    pub colour: Colour,
    /// Whether it is the outline of a shape filled with the colour, such as a solid black. Then it is closed. A later fill
    /// within another one is a hole in it, with the colour of what shows there.
    pub fill: bool,
    /// Colour of the fill of a stroke that has a line too, as a painter gave it; `None` if it has none. Pictures are not asked
    /// for it: on other drawings the stroke has it too.
    pub fill_colour: Option<Colour>,
}

/// What kind of drawing it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Style {
    /// Each line is drawn once.
    Clean,
    /// A line may be drawn with several strokes of the pencil; they become one.
    Rough,
    /// Found from the drawing.
    #[default]
    Auto,
}

/// Options of tracing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Options {
    /// The kind of drawing.
    pub style: Style,
    /// Sensitivity to faint ink; 1 takes the level that is found in the picture.
    pub sensitivity: f64,
    /// Colours of pencils whose lines are left out, as they look on white paper, such as non-photo blue.
    pub leave_out: Vec<Colour>,
}

impl Default for Options {
    fn default() -> Self {
        Self { style: Style::Auto, sensitivity: 1.0, leave_out: Vec::new() }
    }
}

/// A stroke with its number, which is the same on all drawings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tracked {
    /// The number.
    pub track: usize,
    /// The stroke.
    pub stroke: Stroke,
    /// The probability that it is the stroke of its number, 0 to 1.
    pub confidence: f64,
}

impl Tracked {
    /// A stroke that is beyond doubt, as where it was drawn or traced.
    pub fn sure(track: usize, stroke: Stroke) -> Self {
        Self { track, stroke, confidence: 1.0 }
    }
}
