//! Errors and exit statuses.

use rototoon::pipeline::PipelineError;
use rototoon::project::{LoadError, SaveError, WriteError};
use std::io::Write;
use std::process::ExitCode;

/// The work failed.
pub const FAILED: u8 = 1;
/// The command was not used as it must be.
pub const WRONG_USE: u8 = 2;

/// Why a subcommand ended early.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The document could not be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A stage failed.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// The document could not be written.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The command was not used as it must be.
    #[error("{0}")]
    Use(String),
    /// Anything else.
    #[error("{0}")]
    Other(String),
    /// All has been said.
    #[error("failed")]
    Reported,
}

impl Failure {
    /// Says what went wrong, one line each, and gives the exit status.
    pub fn report(self) -> ExitCode {
        match &self {
            Self::Reported => {}
            Self::Load(error) => error.lines().iter().for_each(|text| line("error", text)),
            other => other.to_string().lines().for_each(|text| line("error", text)),
        }
        let request = matches!(self, Self::Use(_) | Self::Pipeline(PipelineError::Request(_)));
        ExitCode::from(if request { WRONG_USE } else { FAILED })
    }
}

/// One line on standard error. That nobody reads it is no reason to fail.
pub fn line(kind: &str, text: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {text}");
}
