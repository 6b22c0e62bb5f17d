//! How a call ended, and the failures behind the codes.

use rototoon::scene::Cancelled;

/// How a call ended.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RototoonStatus {
    /// Done; out parameters are set.
    Ok = 0,
    /// Failed; the error text says which file, field or frame, what was found and what was expected.
    Error = 1,
    /// The progress callback asked to stop; nothing was changed.
    Cancelled = 2,
    /// A defect of the library, caught; the handle may still be used.
    Panic = 3,
    /// An argument is null, misaligned, too long, or not UTF-8.
    BadArgument = 4,
    /// Another call on the same handle is still running.
    Busy = 5,
}

/// Why a call did not do what it was asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The caller's input or its surroundings.
    #[error("{0}")]
    Error(String),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// An argument that no memory or text can be read from.
    #[error("{0}")]
    BadArgument(String),
    /// Two calls at once.
    #[error("the session is in use by another call; a session may be used from one thread at a time")]
    Busy,
}

impl Failure {
    /// A failure with the text of an error of the core.
    pub fn error(error: impl std::fmt::Display) -> Self {
        Self::Error(error.to_string())
    }

    /// The code that the caller sees.
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
