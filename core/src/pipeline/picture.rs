//! What is to be rendered of a document.

use crate::render::OverlayOptions;
use crate::scene::FrameNumber;
use std::ops::RangeInclusive;

/// The picture to render of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Picture {
    /// Contours over the footage.
    Overlay(OverlayOptions),
    /// The matte of the closed parts.
    Matte,
    /// The footage cut out by the closed parts.
    Cutout,
    /// The matte of the closed parts, and in a layer for each part its complete matte; OpenEXR only.
    Layers,
    /// The same mattes as the parts of one file; OpenEXR only.
    Parts,
    /// A colour for each part, nearer parts over farther ones. An OpenEXR file also has Cryptomatte layers.
    Ids,
    /// The painted regions, on nothing. An OpenEXR file also has Cryptomatte layers.
    Paint,
    /// The footage over the painted regions, by the mode *multiply*.
    Painted,
    /// The traced strokes, on nothing. An OpenEXR file also has Cryptomatte layers.
    Lines,
    /// The traced strokes over the painted regions. An OpenEXR file also has Cryptomatte layers.
    Cel,
}

impl Picture {
    /// Whether it shows painted regions.
    pub fn shows_regions(&self) -> bool {
        matches!(self, Self::Paint | Self::Painted | Self::Cel)
    }

    /// Whether it shows strokes.
    pub fn shows_strokes(&self) -> bool {
        matches!(self, Self::Lines | Self::Cel)
    }

    /// Whether it is drawn from outlines alone, and so can have any size.
    pub fn has_any_size(&self) -> bool {
        matches!(self, Self::Paint | Self::Lines | Self::Cel)
    }
}

/// What to render and where.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderJob {
    /// The picture.
    pub picture: Picture,
    /// The frames; `None` renders the complete footage.
    pub frames: Option<RangeInclusive<FrameNumber>>,
    /// Names of the parts; `None` takes all.
    pub parts: Option<Vec<String>>,
    /// Size of the picture as a multiple of the footage's. Other than 1 only for [`Picture::Paint`], [`Picture::Lines`] and
    /// [`Picture::Cel`], which are drawn without the footage.
    pub scale: f64,
    /// The output path, ending in `.png` or `.exr`: a pattern with one `%d` or `%0Nd`, or a plain path for a single
    /// frame.
    pub output: String,
}
