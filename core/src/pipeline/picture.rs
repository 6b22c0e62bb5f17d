//! What is to be rendered of a document.
//!
//! What is wrong with a job in itself is told apart from what does not fit a document, because a batch asks for the former long
//! before there is a document to draw.

use super::PipelineError;
use crate::render::form::Form;
use crate::render::{Format, OverlayOptions};
use crate::scene::{FrameNumber, FramePattern, PatternError};
use std::ops::RangeInclusive;
use std::path::Path;

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
    /// What is added to the number of a frame in the name of its file.
    pub offset: FrameNumber,
    /// Names of the parts; `None` takes all.
    pub parts: Option<Vec<String>>,
    /// Size of the picture as a multiple of the footage's. Other than 1 only for [`Picture::Paint`], [`Picture::Lines`] and
    /// [`Picture::Cel`], which are drawn without the footage.
    pub scale: f64,
    /// The form of OpenEXR files.
    pub form: Form,
    /// The output path, ending in `.png` or `.exr`: a pattern with one `%d` or `%0Nd`, or a plain path for a single
    /// frame.
    pub output: String,
}

impl RenderJob {
    /// Checks what holds for every document: whether name, kind of file and size fit the picture.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Request`] or [`PipelineError::Option`].
    pub fn check(&self) -> Result<(), PipelineError> {
        self.format()?;
        // Without a range the document says how many frames there are.
        self.pattern(self.frames.as_ref().is_none_or(|range| range.start() == range.end()))?;
        self.check_scale()
    }

    /// The kind of file, by the end of its name.
    pub(super) fn format(&self) -> Result<Format, PipelineError> {
        let expected =
            |what: &str| PipelineError::Request(format!("{}: expected a name that ends in {what}", self.output));
        let format = Format::of(Path::new(&self.output)).ok_or_else(|| expected(".png or .exr"))?;
        match (format, self.picture) {
            (Format::Png, Picture::Layers) => Err(expected(".exr for layers")),
            (Format::Png, Picture::Parts) => Err(expected(".exr for several parts")),
            (Format::Png, _) => Ok(format),
            (Format::Exr(_), _) => Ok(Format::Exr(self.form)),
        }
    }

    /// The pattern of the files; `None` for a plain name, which is enough for `one` frame.
    pub(super) fn pattern(&self, one: bool) -> Result<Option<FramePattern>, PipelineError> {
        match FramePattern::parse(&self.output) {
            Ok(pattern) => Ok(Some(pattern)),
            Err(PatternError::NoNumber { .. }) if one => Ok(None),
            Err(error) => Err(PipelineError::Request(format!("output {error}"))),
        }
    }

    /// Whether the picture can have the size.
    pub(super) fn check_scale(&self) -> Result<(), PipelineError> {
        if self.scale == 1.0 || self.picture.has_any_size() {
            return Ok(());
        }
        let reason = format!("found {}, expected 1: only paint, lines and cel are drawn in other sizes", self.scale);
        Err(PipelineError::option("scale", reason))
    }
}
