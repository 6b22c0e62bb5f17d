//! The command line of Rototoon. Each subcommand has its own module.
//!
//! - [`arguments`]: options made from the core's list of parameters
//! - [`project`]: reads and writes documents
//! - [`progress`]: threads of long work
//! - [`stop`]: Ctrl-C and the signals that end the program in order
//! - [`tell`]: how progress is told
//! - [`failure`]: errors and exit statuses
//! - [`track`], [`snap`], [`trace`], [`fill`], [`recolour`], [`render`], [`sheet`], [`absent`], [`export`], [`import`], [`conform`], [`check`], [`fit`], [`tween`], [`style`], [`batch`], [`job`], [`steps`]: the
//!   subcommands
//! - [`usage`]: the memory that the program takes
//!
//! The exit status is 0 for success, 1 for failure, 2 for wrong arguments, and 3 for a batch whose shots want keys. A command that a signal
//! stopped ends by that signal.

#![forbid(unsafe_code)]

mod absent;
mod arguments;
mod batch;
mod check;
mod conform;
mod export;
mod failure;
mod fill;
mod fit;
mod import;
mod job;
mod progress;
mod project;
mod recolour;
mod render;
mod sheet;
mod signals;
mod snap;
mod steps;
mod stop;
mod style;
mod tell;
mod trace;
mod track;
mod tween;
mod unchanged;
mod usage;

use clap::{ArgMatches, Command};
use failure::Failure;
use std::process::ExitCode;

/// The function that runs a subcommand with its arguments.
type Run = fn(&ArgMatches) -> Result<(), Failure>;

/// Each subcommand with the function that runs it.
fn subcommands() -> [(Command, Run); 18] {
    [
        (track::command(), track::run),
        (snap::command(), snap::run),
        (trace::command(), trace::run),
        (fill::command(), fill::run),
        (recolour::command(), recolour::run),
        (render::command(), render::run),
        (sheet::command(), sheet::run),
        (absent::command(), absent::run),
        (export::command(), export::run),
        (import::command(), import::run),
        (conform::command(), conform::run),
        (check::command(), check::run),
        (fit::command(), fit::run),
        (tween::command(), tween::run),
        (style::command(), style::run),
        (batch::command(), batch::run),
        (job::command(), job::run),
        (steps::command(), steps::run),
    ]
}

/// The program with its subcommands.
fn program() -> Command {
    Command::new("rototoon")
        .about("Tracks drawn contours from key frames to every frame")
        .version(env!("CARGO_PKG_VERSION"))
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommands(subcommands().into_iter().map(|(command, _)| command))
}

/// Runs the subcommand that was given, and returns the exit status.
fn execute(matches: &ArgMatches) -> u8 {
    let Some((name, arguments)) = matches.subcommand() else { return failure::WRONG_USE };
    let known = subcommands().into_iter().find(|(command, _)| command.get_name() == name);
    match known.map_or(Ok(()), |(_, run)| run(arguments)) {
        Ok(()) => 0,
        Err(failure) => match stop::signal() {
            Some(signal) => stop::status(failure, signal),
            None => failure.report(),
        },
    }
}

fn main() -> ExitCode {
    let matches = program().get_matches();
    let status = match stop::catch_signals() {
        Ok(()) => execute(&matches),
        Err(failure) => failure.report(),
    };
    match stop::signal() {
        Some(signal) if status != 0 => stop::end(signal),
        _ => ExitCode::from(status),
    }
}
