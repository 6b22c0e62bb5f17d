//! Why an action did not do its work.

use openfx::sys::generic::core::{
    OfxStatus, kOfxStatErrFormat, kOfxStatErrMemory, kOfxStatErrMissingHostFeature, kOfxStatFailed,
    kOfxStatReplyDefault,
};

/// Why an action did not do its work.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// The host is to do what it does by default.
    #[error("left to the host")]
    Default,
    /// The host wants the work no more.
    #[error("aborted")]
    Aborted,
    /// A host's function failed.
    #[error("the host's {function} failed with status {status}")]
    Host {
        /// Name of the function.
        function: &'static str,
        /// What it returned.
        status: OfxStatus,
    },
    /// The host lacks what the plugin cannot do without.
    #[error("the host has no {0}")]
    Missing(&'static str),
    /// An image is of a kind that was not asked for.
    #[error("{0}")]
    Format(String),
    /// What the user is to know.
    #[error("{0}")]
    Told(String),
}

impl Failure {
    /// The status that the host is given.
    pub fn status(&self) -> OfxStatus {
        match self {
            Self::Default => kOfxStatReplyDefault,
            // What was rendered is not whole, and a host that aborted does not use it.
            Self::Aborted | Self::Told(_) => kOfxStatFailed,
            Self::Host { status, .. } if *status == kOfxStatErrMemory => kOfxStatErrMemory,
            Self::Host { .. } => kOfxStatFailed,
            Self::Missing(_) => kOfxStatErrMissingHostFeature,
            Self::Format(_) => kOfxStatErrFormat,
        }
    }
}
