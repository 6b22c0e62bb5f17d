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
//! stopped ends by that signal. One that came to its end all the same, good or bad, has its own status.

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
use std::path::PathBuf;
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
        .version(rototoon::VERSION)
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommands(subcommands().into_iter().map(|(command, _)| command))
}

/// How a subcommand came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ended {
    /// By itself, with this exit status.
    With(u8),
    /// This signal stopped it.
    By(i32),
}

impl Ended {
    /// The exit status, as a shell gives it.
    fn status(self) -> u8 {
        match self {
            Self::With(status) => status,
            Self::By(signal) => signals::status(signal),
        }
    }
}

/// Runs the subcommand that was given.
fn execute(matches: &ArgMatches) -> Ended {
    let Some((name, arguments)) = matches.subcommand() else { return Ended::With(failure::WRONG_USE) };
    let known = subcommands().into_iter().find(|(command, _)| command.get_name() == name);
    if let Some(project) = project_of(arguments) {
        stop::begin(project.display().to_string());
    }
    ended(known.map_or(Ok(()), |(_, run)| run(arguments)), stop::signal())
}

/// The project that a subcommand, or one within it, works on.
fn project_of(arguments: &ArgMatches) -> Option<&PathBuf> {
    match arguments.subcommand() {
        Some((_, inner)) => project_of(inner),
        None => arguments.try_get_one("project").ok().flatten(),
    }
}

/// How a subcommand with this result came to its end, where this signal asked it to end. It is said too. A signal may come when the work is all but done: a
/// batch whose shots want keys, or a check that found errors, then ends as it does without the signal.
fn ended(result: Result<(), Failure>, signal: Option<i32>) -> Ended {
    match (result, signal) {
        (Ok(()), _) => Ended::With(0),
        (Err(failure), Some(signal)) if failure.is_cancelled() => {
            stop::say(signal);
            Ended::By(signal)
        }
        (Err(failure), _) => Ended::With(failure.report()),
    }
}

fn main() -> ExitCode {
    let matches = program().get_matches();
    let ended = match stop::catch_signals() {
        Ok(()) => execute(&matches),
        Err(failure) => Ended::With(failure.report()),
    };
    match ended {
        Ended::With(status) => ExitCode::from(status),
        Ended::By(signal) => stop::end(signal),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::Cancelled;

    #[test]
    fn the_project_of_any_subcommand_is_known() {
        let of = |words: &str| {
            let matches = program().try_get_matches_from(words.split(' ')).unwrap();
            project_of(&matches).map(|path| path.display().to_string())
        };
        for (words, project) in [
            ("rototoon check a.json", Some("a.json")),
            ("rototoon import a.json b.svg -o c.json", Some("a.json")),
            ("rototoon style clip a.json -o c.json --character x --motion y", Some("a.json")),
            ("rototoon style library list a", None),
            ("rototoon job m.json -o c.json", None),
        ] {
            assert_eq!(of(words).as_deref(), project, "{words}");
        }
    }

    #[test]
    fn work_that_was_done_when_a_signal_came_keeps_its_status() {
        for signal in [None, Some(15)] {
            for (result, status) in [
                (Ok(()), 0),
                (Err(Failure::WantsKeys), 3),
                (Err(Failure::Reported), 1),
                (Err(Failure::Use("a: found b".into())), 2),
            ] {
                assert_eq!(ended(result, signal), Ended::With(status));
            }
        }
        let named = Failure::Other(format!("a.json: {Cancelled}"));
        assert_eq!([named, Cancelled.into()].map(|failure| ended(Err(failure), Some(15))), [Ended::By(15); 2]);
        assert_eq!([Ended::With(3), Ended::By(15)].map(Ended::status), [3, 143]);
    }
}
