//! Errors and exit statuses.

use rototoon::pipeline::PipelineError;
use rototoon::pipeline::unchanged::ReplaceError;
use rototoon::project::{LoadError, OverwritesInput, SaveError, WriteError};
use rototoon::scene::Cancelled;
use std::io::Write;
use std::path::Path;

/// The work failed.
pub const FAILED: u8 = 1;
/// The arguments are wrong.
pub const WRONG_USE: u8 = 2;
/// All shots of a batch came out, and some want keys.
const WANTS_KEYS: u8 = 3;

/// Why a subcommand failed.
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
    /// The document could not be written over what was read.
    #[error(transparent)]
    Replace(#[from] ReplaceError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The output is a file that the command reads.
    #[error(transparent)]
    Overwrites(#[from] OverwritesInput),
    /// The arguments are wrong.
    #[error("{0}")]
    Use(String),
    /// Any other error.
    #[error("{0}")]
    Other(String),
    /// The program was asked to end.
    #[error(transparent)]
    Stopped(#[from] Cancelled),
    /// The subcommand has already printed its errors.
    #[error("failed")]
    Reported,
    /// Some shots of a batch want keys. They have already been named.
    #[error("some shots want keys")]
    WantsKeys,
}

impl Failure {
    /// The failure of work on a file. It names the file, and the option that does not fit it.
    pub fn of(error: PipelineError, path: &Path) -> Self {
        let from = path.display();
        match error {
            PipelineError::Option { option, reason } => Self::Use(format!("{from}: --{option}: {reason}")),
            // These name the file to write, or are told in another way.
            PipelineError::Request(_) | PipelineError::Write(_) | PipelineError::Cancelled(_) => error.into(),
            other => Self::Other(named(&other, path)),
        }
    }

    /// Whether the work was cancelled, and nothing else is wrong.
    pub fn is_cancelled(&self) -> bool {
        // It is within errors of all stages, and these add the name of a file before it.
        self.to_string().ends_with(&Cancelled.to_string())
    }

    /// Prints the errors, one per line, and returns the exit status.
    pub fn report(self) -> u8 {
        match &self {
            Self::Reported => {}
            Self::WantsKeys => return WANTS_KEYS,
            Self::Load(error) => error.lines().iter().for_each(|text| line("error", text)),
            other => other.to_string().lines().for_each(|text| line("error", text)),
        }
        let request = matches!(self, Self::Use(_) | Self::Overwrites(_) | Self::Pipeline(PipelineError::Request(_)));
        if request { WRONG_USE } else { FAILED }
    }
}

/// An error with the name of the file that was worked on before each of its lines, because a log may have many files.
pub fn named(error: &PipelineError, from: &Path) -> String {
    let lines = error.to_string();
    lines.lines().map(|text| format!("{}: {text}", from.display())).collect::<Vec<_>>().join("\n")
}

/// Prints a line to standard error. A closed standard error is ignored.
pub fn line(kind: &str, text: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {text}");
}
