//! The parameters' values at a time.

use super::page;
use super::state::{PartLook, PartSettings, State, blend, falloff};
use crate::ofx::{Failure, Parameters};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageComponentAlpha, kOfxImageComponentRGB, kOfxImageComponentRGBA,
};
use rototoon::render::coverage::MOST_INSTANTS;
use rototoon::scene::{Falloff, FrameNumber};
use std::collections::BTreeMap;
use std::ffi::CStr;

/// By how much a host's time may differ from a frame, in frames: times are sums of floats.
const INEXACT: f64 = 1e-3;

/// A time, or the frame that it stands for.
pub fn on_frame(time: f64) -> f64 {
    if (time - time.round()).abs() < INEXACT { time.round() } else { time }
}

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
    /// A matte of its own in each channel.
    Mattes,
    /// The painted regions.
    Paint,
    /// The source over the painted regions.
    Painted,
    /// The strokes.
    Lines,
    /// The strokes over the painted regions.
    Cel,
}

/// The channels that a matte is written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// All four.
    All,
    /// One of red, green, blue and alpha, by index. The others are those of the source.
    One(usize),
}

/// What a matte does with the source's alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceAlpha {
    /// Nothing.
    Ignore,
    /// It is multiplied by it.
    Multiply,
    /// It joins it.
    Add,
}

/// The rectangle that the effect defines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// That of the shapes.
    Shapes,
    /// That of the source.
    Source,
    /// That of the project's format.
    Format,
}

impl Output {
    /// The chosen output.
    pub fn of(parameters: &Parameters, time: f64) -> Result<Self, Failure> {
        Ok(match parameters.int(c"output", time)? {
            1 => Self::Matte,
            2 => Self::Overlay,
            3 => Self::Ids,
            4 => Self::Mattes,
            5 => Self::Paint,
            6 => Self::Painted,
            7 => Self::Lines,
            8 => Self::Cel,
            _ => Self::Cutout,
        })
    }

    /// Whether it shows parts.
    pub fn shows_parts(self) -> bool {
        !self.shows_regions() && !self.shows_strokes()
    }

    /// Whether it shows painted regions.
    pub fn shows_regions(self) -> bool {
        matches!(self, Self::Paint | Self::Painted | Self::Cel)
    }

    /// Whether it shows strokes.
    pub fn shows_strokes(self) -> bool {
        matches!(self, Self::Lines | Self::Cel)
    }

    /// Whether the source shows where nothing is drawn.
    pub fn passes_source(self) -> bool {
        matches!(self, Self::Cutout | Self::Overlay | Self::Painted)
    }
}

/// The values of the parameters at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The kind of picture that is drawn.
    pub output: Output,
    /// The channels of a matte.
    pub channels: Channels,
    /// What a matte does with the source's alpha.
    pub source_alpha: SourceAlpha,
    /// Whether a matte in alpha multiplies the source's colours.
    pub premultiply: bool,
    /// Whether the input Mask is used.
    pub use_mask: bool,
    /// The rectangle that the effect defines.
    pub extent: Extent,
    /// The time in the document, in frames.
    pub document_time: f64,
    /// Whether parts are drawn at this time.
    pub shown: bool,
    /// Names of parts, as a list with commas.
    pub parts: String,
    /// Names of parts for red, green, blue and alpha.
    pub channel_parts: [String; 4],
    /// Names of painted regions and strokes, as a list with commas.
    pub drawn_names: String,
    /// Settings of parts by name. Other parts have the defaults.
    pub looks: BTreeMap<String, PartLook>,
    /// Whether snapped paths are used.
    pub curves: bool,
    /// Whether cutout and matte are inverted.
    pub invert: bool,
    /// By how many pixels at full size the mask grows.
    pub grow: f64,
    /// Pixels at full size over which the mask fades, on each side of its edge.
    pub feather: f64,
    /// How the border of all parts falls off.
    pub falloff: Falloff,
    /// How long the shutter is open, in frames.
    pub shutter: f64,
    /// When it opens, in shares of its opening before or after the frame.
    pub phase: f64,
    /// Number of times within the shutter's opening.
    pub samples: usize,
    /// Width of lines in pixels at full size.
    pub line_width: f64,
    /// RGB and opacity of lines.
    pub line_colour: [f32; 4],
}

impl Settings {
    /// The frame of the document that is nearest to the time.
    pub fn frame(&self) -> FrameNumber {
        self.document_time.round() as FrameNumber
    }

    /// Reads the values. A number that is not finite counts as 0. A time that differs from a frame by rounding is that frame.
    pub fn read(parameters: &Parameters, time: f64, state: &State) -> Result<Self, Failure> {
        let time = on_frame(time);
        let number = |id| parameters.double(id, time).map(|v| if v.is_finite() { v } else { 0.0 });
        let flag = |id| Ok::<bool, Failure>(parameters.int(id, time)? != 0);
        let [r, g, b, a] = parameters.colour(c"lineColor", time)?;
        let alpha = (a * number(c"opacity")?).clamp(0.0, 1.0);
        let limits = [parameters.int(c"shownFirst", time)?, parameters.int(c"shownLast", time)?].map(f64::from);
        let text = |id| parameters.text(id);
        Ok(Self {
            output: Output::of(parameters, time)?,
            channels: channels(parameters.int(c"matteChannel", time)?),
            source_alpha: match parameters.int(c"sourceAlpha", time)? {
                1 => SourceAlpha::Multiply,
                2 => SourceAlpha::Add,
                _ => SourceAlpha::Ignore,
            },
            premultiply: flag(c"premultiply")?,
            use_mask: flag(c"useMask")?,
            extent: match parameters.int(c"region", time)? {
                1 => Extent::Source,
                2 => Extent::Format,
                _ => Extent::Shapes,
            },
            document_time: time - f64::from(parameters.int(c"frameOffset", time)?),
            shown: !flag(c"limitFrames")? || (limits[0]..=limits[1]).contains(&time),
            parts: text(c"parts")?,
            channel_parts: [text(c"redParts")?, text(c"greenParts")?, text(c"blueParts")?, text(c"alphaParts")?],
            drawn_names: text(c"drawnNames")?,
            looks: looks(parameters, time, state)?,
            curves: flag(c"useCurves")?,
            invert: flag(c"invert")?,
            grow: number(c"grow")?,
            feather: number(c"feather")?.max(0.0),
            falloff: falloff(number(c"falloff")?, curve(parameters, c"falloffCurve", time)? + 1),
            shutter: number(c"motionBlur")?.max(0.0),
            phase: number(c"shutterPhase")? / 360.0,
            samples: parameters.int(c"motionBlurSamples", time)?.clamp(1, MOST_INSTANTS as i32) as usize,
            line_width: number(c"lineWidth")?.max(0.0),
            line_colour: [r, g, b, alpha].map(|v| v as f32),
        })
    }

    /// The settings of a part.
    pub fn look(&self, name: &str) -> PartLook {
        self.looks.get(name).copied().unwrap_or_default()
    }

    /// Whether the picture says something with its alpha that the source's does not.
    pub fn has_alpha(&self) -> bool {
        match self.output {
            Output::Matte => matches!(self.channels, Channels::All | Channels::One(3)),
            output => !matches!(output, Output::Overlay | Output::Painted),
        }
    }

    /// What a picture without alpha lacks; `None` if nothing is missing in it.
    pub fn missing_without_alpha(&self) -> Option<&'static str> {
        match self.output {
            Output::Cutout => Some("a cutout is black where it is transparent"),
            Output::Matte if self.channels == Channels::One(3) => Some("the matte in alpha is missing"),
            Output::Mattes if !self.channel_parts[3].trim().is_empty() => Some("the matte of Alpha parts is missing"),
            _ => None,
        }
    }

    /// Whether the picture has colours of its own, beside those of the source.
    fn has_colours(&self) -> bool {
        !matches!(self.output, Output::Cutout | Output::Matte)
    }

    /// The components that the output needs, over a source with these; `None` if those do.
    pub fn components(&self, source: &[u8]) -> Option<&'static CStr> {
        let has_none = source == kOfxImageComponentRGB.to_bytes();
        let has_nothing_else = source == kOfxImageComponentAlpha.to_bytes();
        let needed = self.has_alpha() && (has_none || has_nothing_else && self.has_colours());
        needed.then_some(kOfxImageComponentRGBA)
    }

    /// Whether the source is in the picture.
    pub fn shows_source(&self) -> bool {
        match self.output {
            Output::Matte => self.channels != Channels::All || self.source_alpha != SourceAlpha::Ignore,
            output => output.passes_source(),
        }
    }
}

fn channels(index: i32) -> Channels {
    match index {
        1 => Channels::One(3),
        2..=4 => Channels::One(index as usize - 2),
        _ => Channels::All,
    }
}

/// The index of a curve of the falloff.
fn curve(parameters: &Parameters, id: &CStr, time: f64) -> Result<usize, Failure> {
    Ok(parameters.int(id, time)?.max(0) as usize)
}

/// The colours that the user has chosen, by the names of parts.
pub fn colours(parameters: &Parameters, state: &State) -> Result<BTreeMap<String, [f64; 3]>, Failure> {
    let own = |(name, settings): (&String, &PartSettings)| Some((name.clone(), settings.colour?));
    let mut colours: BTreeMap<String, [f64; 3]> = state.parts.iter().filter_map(own).collect();
    if !state.page.is_empty() {
        colours.remove(&state.page);
        colours.extend(page::colour(parameters)?.map(|colour| (state.page.clone(), colour)));
    }
    Ok(colours)
}

/// The settings of all parts that have some. The page's own parameters have those of its part, with the host's own
/// interpolation.
fn looks(parameters: &Parameters, time: f64, state: &State) -> Result<BTreeMap<String, PartLook>, Failure> {
    let mut looks: BTreeMap<String, PartLook> =
        state.parts.iter().map(|(name, settings)| (name.clone(), settings.at(time))).collect();
    if !state.page.is_empty() {
        let number = |id| parameters.double(id, time).map(|v| if v.is_finite() { v } else { 0.0 });
        let look = PartLook {
            on: parameters.int(c"partOn", time)? != 0,
            invert: parameters.int(c"partInvert", time)? != 0,
            opacity: number(c"partOpacity")?.clamp(0.0, 1.0),
            grow: number(c"partGrow")?,
            feather: number(c"partFeather")?.max(0.0),
            blend: blend(parameters.int(c"partMode", time)?.max(0) as usize),
            falloff: falloff(number(c"partFalloff")?, curve(parameters, c"partFalloffCurve", time)?),
        };
        looks.insert(state.page.clone(), look);
    }
    Ok(looks)
}
