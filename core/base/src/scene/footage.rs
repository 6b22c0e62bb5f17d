//! Which frames there are, and where their pictures come from.

use super::raster::{Colour, Raster};
use std::path::PathBuf;
use std::sync::Arc;

/// The number of a frame, as the artist's time line shows it.
pub type FrameNumber = i32;

/// Frames `first` to `last` of a picture sequence, both included.
#[derive(Clone, Debug, PartialEq)]
pub struct Footage {
    /// Path with one `%d` or `%0Nd` for the frame number; relative to the document's folder, or absolute.
    pub pattern: String,
    /// First frame.
    pub first: FrameNumber,
    /// Last frame, included.
    pub last: FrameNumber,
    /// Frames a second.
    pub fps: f64,
    /// Width of every frame, in pixels.
    pub width: usize,
    /// Height of every frame, in pixels.
    pub height: usize,
}

/// Hands out the pictures of a footage. Implementations keep few of them in memory: callers ask again.
pub trait FrameSource: Sync {
    /// The picture of a frame, all of the footage's size.
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError>;
}

/// Why a frame's picture could not be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// No file where the pattern says.
    #[error("frame {frame}: no file {path:?}")]
    Missing {
        /// The frame asked for.
        frame: FrameNumber,
        /// Where it should be.
        path: PathBuf,
    },
    /// The file is there but cannot be read as a picture.
    #[error("frame {frame}: cannot read {path:?}: {reason}")]
    Unreadable {
        /// The frame asked for.
        frame: FrameNumber,
        /// The file.
        path: PathBuf,
        /// What the decoder or the system said.
        reason: String,
    },
    /// The picture is not of the footage's size.
    #[error("frame {frame}: {path:?} is {found_width}x{found_height} pixels, but the footage is {width}x{height}")]
    WrongSize {
        /// The frame asked for.
        frame: FrameNumber,
        /// The file.
        path: PathBuf,
        /// Width of the file's picture.
        found_width: usize,
        /// Height of the file's picture.
        found_height: usize,
        /// Width of the footage.
        width: usize,
        /// Height of the footage.
        height: usize,
    },
    /// The frame lies outside the footage.
    #[error("frame {frame} is outside the footage, which has frames {first} to {last}")]
    Outside {
        /// The frame asked for.
        frame: FrameNumber,
        /// First frame of the footage.
        first: FrameNumber,
        /// Last frame of the footage.
        last: FrameNumber,
    },
}
