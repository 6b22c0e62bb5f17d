//! The failures of actions.

use openfx::sys::generic::core::{
    OfxStatus, kOfxStatErrFormat, kOfxStatErrMemory, kOfxStatErrMissingHostFeature, kOfxStatFailed,
    kOfxStatReplyDefault,
};

/// Why an action failed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// The plugin leaves the action to the host's default behaviour.
    #[error("left to the host")]
    Default,
    /// The host or the user aborted the work.
    #[error("aborted")]
    Aborted,
    /// A host's function failed.
    #[error("the host's {function} failed with status {status}")]
    Host {
        /// Name of the function.
        function: &'static str,
        /// The status that it returned.
        status: OfxStatus,
    },
    /// The host lacks a function or a suite that the plugin needs.
    #[error("the host has no {0}")]
    Missing(&'static str),
    /// An image has a format that the plugin does not support.
    #[error("{0}")]
    Format(String),
    /// An error whose text is shown to the user.
    #[error("{0}")]
    Told(String),
}

impl Failure {
    /// The status that is returned to the host.
    pub fn status(&self) -> OfxStatus {
        match self {
            Self::Default => kOfxStatReplyDefault,
            // An aborted picture is incomplete. A host that aborted does not use it.
            Self::Aborted | Self::Told(_) => kOfxStatFailed,
            Self::Host { status, .. } if *status == kOfxStatErrMemory => kOfxStatErrMemory,
            Self::Host { .. } => kOfxStatFailed,
            Self::Missing(_) => kOfxStatErrMissingHostFeature,
            Self::Format(_) => kOfxStatErrFormat,
        }
    }
}
