//! The command line of Rototoon. Each subcommand has its own module.
//!
//! - [`arguments`]: options made from the core's list of parameters
//! - [`project`]: reads and writes documents
//! - [`progress`]: threads, the progress bar, and Ctrl-C
//! - [`failure`]: errors and exit statuses
//! - [`track`], [`snap`], [`trace`], [`render`], [`export`], [`import`], [`check`], [`fit`], [`tween`], [`style`], [`batch`], [`job`]: the
//!   subcommands
//! - [`usage`]: the memory that the program took
//!
//! The exit status is 0 for success, 1 for failure, 2 for wrong arguments, and 3 for a batch whose shots want keys.

#![forbid(unsafe_code)]

mod arguments;
mod batch;
mod check;
mod export;
mod failure;
mod fit;
mod import;
mod job;
mod progress;
mod project;
mod render;
mod snap;
mod style;
mod trace;
mod track;
mod tween;
mod usage;

use clap::{ArgMatches, Command};
use failure::Failure;
use std::process::ExitCode;

/// The function that runs a subcommand with its arguments.
type Run = fn(&ArgMatches) -> Result<(), Failure>;

/// Each subcommand with the function that runs it.
fn subcommands() -> [(Command, Run); 12] {
    [
        (track::command(), track::run),
        (snap::command(), snap::run),
        (trace::command(), trace::run),
        (render::command(), render::run),
        (export::command(), export::run),
        (import::command(), import::run),
        (check::command(), check::run),
        (fit::command(), fit::run),
        (tween::command(), tween::run),
        (style::command(), style::run),
        (batch::command(), batch::run),
        (job::command(), job::run),
    ]
}

fn main() -> ExitCode {
    let commands = subcommands();
    let top = Command::new("rototoon")
        .about("Tracks drawn contours from key frames to every frame")
        .version(env!("CARGO_PKG_VERSION"))
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommands(commands.iter().map(|(command, _)| command.clone()));
    let matches = top.get_matches();
    let Some((name, arguments)) = matches.subcommand() else { return ExitCode::from(failure::WRONG_USE) };
    let run = commands.iter().find(|(command, _)| command.get_name() == name).map(|(_, run)| run);
    let work = || run.map_or(Ok(()), |run| run(arguments));
    let result = progress::catch_signals().and_then(|()| work());
    usage::tell();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
