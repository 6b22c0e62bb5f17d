//! The reasons why a file gives no picture.

use std::io;

/// The reason why a file gives no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The file does not exist.
    #[error("no such file")]
    Missing,
    /// The file cannot be read as a picture. The text is the reason given by the decoder or the system.
    #[error("{0}")]
    Unreadable(String),
    /// The picture does not have the expected size.
    #[error("the picture is {width}x{height} pixels")]
    WrongSize {
        /// Width of the picture in the file.
        width: usize,
        /// Height of the picture in the file.
        height: usize,
    },
}

impl From<io::Error> for DecodeError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::Missing,
            _ => Self::Unreadable(error.to_string()),
        }
    }
}

impl From<image::ImageError> for DecodeError {
    fn from(error: image::ImageError) -> Self {
        Self::Unreadable(error.to_string())
    }
}
