//! `rototoon propose`: the frames that are worth keying.

use crate::failure::Failure;
use crate::{arguments, progress, project};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::pipeline;
use rototoon::scene::parameters::Stage;
use std::io::Write;

/// The subcommand.
pub fn command() -> Command {
    let count = Arg::new("count")
        .long("count")
        .value_name("N")
        .help("Number of key frames, those that are keyed already among them [default: as many as seem worth it]")
        .value_parser(value_parser!(u32).range(1..));
    Command::new("propose")
        .about("Prints the frames that are worth keying, one a line; frames keyed already are among them")
        .arg(arguments::project())
        .arg(count)
        .args(arguments::of_stage(Stage::Run))
}

/// Runs it.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let path = arguments::path(given, "project");
    let count = given.get_one::<u32>("count").map(|&n| n as usize);
    let document = project::load(path)?;
    let frames = progress::run(arguments::threads(given), |bar| {
        Ok(pipeline::propose(&document, project::folder(path), count, bar)?)
    })?;
    let lines: String = frames.iter().map(|frame| format!("{frame}\n")).collect();
    std::io::stdout().write_all(lines.as_bytes()).map_err(|error| Failure::Other(format!("cannot print: {error}")))
}
