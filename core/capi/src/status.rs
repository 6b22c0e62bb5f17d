//! The status of a call, and the failures behind it.

use rototoon::scene::Cancelled;

/// The result of a call.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RototoonStatus {
    /// Success. The out parameters are set.
    Ok = 0,
    /// The call failed. The error text names the file, field or frame, what was found and what was expected.
    Error = 1,
    /// The progress callback cancelled the work. Nothing was changed.
    Cancelled = 2,
    /// The library has a defect and panicked. The handle may still be used.
    Panic = 3,
    /// An argument is null, misaligned, too long, or not UTF-8.
    BadArgument = 4,
    /// Another call on the same handle is still running.
    Busy = 5,
}

/// Why a call failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The input is wrong, or a file cannot be read or written.
    #[error("{0}")]
    Error(String),
    /// The caller cancelled the work.
    #[error("cancelled")]
    Cancelled,
    /// An argument is null, misaligned, too long, or not UTF-8.
    #[error("{0}")]
    BadArgument(String),
    /// Another call on the same session is running.
    #[error("the session is in use by another call; a session may be used from one thread at a time")]
    Busy,
}

impl Failure {
    /// A failure with the text of an error.
    pub fn error(error: impl std::fmt::Display) -> Self {
        Self::Error(error.to_string())
    }

    /// The status that the caller gets.
    pub fn status(&self) -> RototoonStatus {
        match self {
            Self::Error(_) => RototoonStatus::Error,
            Self::Cancelled => RototoonStatus::Cancelled,
            Self::BadArgument(_) => RototoonStatus::BadArgument,
            Self::Busy => RototoonStatus::Busy,
        }
    }
}

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
