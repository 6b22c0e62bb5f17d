//! Why the pipeline stopped.

use crate::fit::FitError;
use crate::import::ImportError;
use crate::memory::TooMuch;
use crate::project::WriteError;
use crate::render::EncodeError;
use crate::scene::{Cancelled, FrameError, FrameNumber, PatternError};
use crate::snap::SnapError;
use crate::track::TrackError;

/// Why the pipeline stopped. The document is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The footage's pattern is invalid.
    #[error("footage: {0}")]
    Pattern(#[from] PatternError),
    /// Tracking failed.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// Snapping failed.
    #[error(transparent)]
    Snap(#[from] SnapError),
    /// A frame could not be read.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// Frames of one of two footages could not be read.
    #[error("{which} footage: {source}")]
    Footage {
        /// `old` or `new`.
        which: &'static str,
        /// The frames and why.
        source: Box<PipelineError>,
    },
    /// Frames have no picture.
    #[error("{}", super::gaps::told(gaps, *drawn))]
    Gaps {
        /// All of them, in their order.
        gaps: Vec<(FrameNumber, FrameError)>,
        /// How many frames were drawn nevertheless, and how many were asked for; `None` if no work was done.
        drawn: Option<[usize; 2]>,
    },
    /// The caller cancelled the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The pictures are larger than the memory allows.
    #[error("footage.width, height: found {width}x{height} pixels: {source}")]
    Memory {
        /// Width of the footage in pixels.
        width: usize,
        /// Height of the footage in pixels.
        height: usize,
        /// The memory that is needed.
        source: TooMuch,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A picture could not be encoded.
    #[error("frame {frame}: {source}")]
    Encode {
        /// The frame.
        frame: FrameNumber,
        /// The error of the encoder.
        source: EncodeError,
    },
    /// A curve could not be fitted.
    #[error("curves[{curve}].{}", fit_place(source))]
    Fit {
        /// Index of the curve.
        curve: usize,
        /// The error of the fit.
        source: FitError,
    },
    /// Shapes of another program cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The drawings cannot be tweened.
    #[error("{0}")]
    Tween(String),
    /// Clips or limbs do not fit the request.
    #[error("{0}")]
    Style(String),
    /// An option does not fit the document or the clips.
    #[error("{option}: {reason}")]
    Option {
        /// The option's name.
        option: &'static str,
        /// What was found and what was expected.
        reason: String,
    },
    /// A field of the document cannot be read.
    #[error("{0}")]
    Field(String),
    /// The output cannot be written as requested.
    #[error("{0}")]
    Request(String),
}

impl PipelineError {
    /// The error of an option.
    pub(super) fn option(option: &'static str, reason: impl std::fmt::Display) -> Self {
        Self::Option { option, reason: reason.to_string() }
    }
}

/// The place of an error within its curve, and the error.
fn fit_place(error: &FitError) -> String {
    match error {
        FitError::Point { index, x, y } => {
            format!("points[{index}]: found ({x}, {y}), expected numbers between -1e9 and 1e9")
        }
        other => format!("points: {other}"),
    }
}
