//! `rototoon check`: lists every problem of a document and its frames.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::{ArgMatches, Command};
use rototoon::pipeline;
use rototoon::project::{Document, Severity};
use rototoon::scene::parameters::Stage;

/// The subcommand.
pub fn command() -> Command {
    Command::new("check")
        .about("Lists every problem of a document and its frames; the exit status is 0 if there are no errors")
        .arg(arguments::project())
        .args(arguments::of_stage(Stage::Run))
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let path = arguments::path(given, "project");
    let document = Document::load(path)?;
    let problems =
        progress::run(arguments::threads(given), |bar| Ok(pipeline::check(&document, project::folder(path), bar)?))?;
    for problem in problems.iter() {
        let kind = if problem.severity == Severity::Error { "error" } else { "warning" };
        line(kind, &format!("{}: {problem}", path.display()));
    }
    for (count, kind) in [(problems.left_off().0, "error"), (problems.left_off().1, "warning")] {
        if count > 0 {
            line(kind, &format!("{}: and {count} more {kind}s", path.display()));
        }
    }
    if problems.error_count() > 0 { Err(Failure::Reported) } else { Ok(()) }
}
