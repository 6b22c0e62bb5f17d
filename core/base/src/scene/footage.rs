//! Footage: the range of frames, and the source of their pictures.
//!
//! Footage is a numbered sequence of pictures of one size. Frame numbers are those of the artist's time line and may be
//! negative.

use super::raster::{Colour, Raster};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The number of a frame, as the artist's time line shows it.
pub type FrameNumber = i32;

/// Frames `first` to `last` of a picture sequence, both included.
#[derive(Clone, Debug, PartialEq)]
pub struct Footage {
    /// Path with one `%d` or `%0Nd` for the frame number, relative to the document's folder or absolute.
    pub pattern: String,
    /// First frame.
    pub first: FrameNumber,
    /// Last frame, included.
    pub last: FrameNumber,
    /// Frames per second.
    pub fps: f64,
    /// Width of every frame, in pixels.
    pub width: usize,
    /// Height of every frame, in pixels.
    pub height: usize,
    /// Whether a frame without a file shows the nearest earlier frame that has one, as exposure numbers mean it: A0001, A0003, A0005 are
    /// drawings on twos. Otherwise it is an error.
    pub held: bool,
}

/// The hash of a picture.
pub type Mark = [u8; 32];

/// Gives access to the pictures of a footage. An implementation keeps few of them in memory, so callers request
/// pictures repeatedly.
pub trait FrameSource: Sync {
    /// The picture of a frame, sRGB-encoded, in the footage's size.
    ///
    /// # Errors
    ///
    /// A [`FrameError`] names the frame and the file.
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError>;

    /// A mark of the picture of a frame: pictures with the same mark have the same pixels. `None` if the source has no marks. Then
    /// nothing that was made of its pictures is kept beyond the program.
    ///
    /// # Errors
    ///
    /// As for [`FrameSource::picture`].
    fn mark(&self, _frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        Ok(None)
    }
}

/// What may be wrong with the path of a file that does not exist: it may come from another system, or from a shell.
fn hint(path: &Path) -> &'static str {
    let text = path.to_string_lossy();
    if !cfg!(windows) && text.contains('\\') {
        "; the path looks like one of Windows: write / for \\, and a folder of this system or one relative to the document"
    } else if text.split('/').any(|name| name.starts_with('$') || name == "~") {
        "; ~ and variables such as $SHOW are not replaced in documents"
    } else {
        ""
    }
}

/// Why the picture of a frame is not available.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// The file does not exist.
    #[error("frame {frame}: no file {path:?}{}", hint(path))]
    Missing {
        /// The requested frame.
        frame: FrameNumber,
        /// The path of the file.
        path: PathBuf,
    },
    /// The file does not exist, but the first file of the footage does: the gap may be a held drawing.
    #[error(
        "frame {frame}: no file {path:?}; if the drawing before it is held, write \"gaps\": \"held\" in the document's footage"
    )]
    Gap {
        /// The requested frame.
        frame: FrameNumber,
        /// The path of the file.
        path: PathBuf,
    },
    /// The file exists but cannot be decoded.
    #[error("frame {frame}: cannot read {path:?}: {reason}")]
    Unreadable {
        /// The requested frame.
        frame: FrameNumber,
        /// The file.
        path: PathBuf,
        /// The message of the decoder or the system.
        reason: String,
    },
    /// The picture does not have the footage's size.
    #[error("frame {frame}: {path:?} is {found_width}x{found_height} pixels, but the footage is {width}x{height}")]
    WrongSize {
        /// The requested frame.
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
    /// The frame is outside of the footage.
    #[error("frame {frame} is outside the footage, which has frames {first} to {last}")]
    Outside {
        /// The requested frame.
        frame: FrameNumber,
        /// First frame of the footage.
        first: FrameNumber,
        /// Last frame of the footage.
        last: FrameNumber,
    },
}
