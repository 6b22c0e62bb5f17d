//! `rototoon track`: contours from the keys to every frame.

use crate::failure::Failure;
use crate::{arguments, progress, project};
use clap::{ArgMatches, Command};
use rototoon::pipeline;
use rototoon::project::output::check_writable;
use rototoon::scene::parameters::Stage;
use rototoon::track::{Preset, TrackOptions};

/// The subcommand.
pub fn command() -> Command {
    Command::new("track")
        .about("Tracks every part from its first key to its last")
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write, with tracks and confidence"))
        .args(arguments::of_stage(Stage::Track))
        .args(arguments::of_stage(Stage::Run))
}

/// Runs it.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let id = arguments::choice(given, "preset");
    let preset = Preset::from_id(id).ok_or_else(|| Failure::Use(format!("no preset {id:?}")))?;
    let mut document = project::load(from)?;
    check_writable(to)?;
    let options = TrackOptions { preset };
    let document = progress::run(arguments::threads(given), |bar| {
        pipeline::track(&mut document, project::folder(from), &options, bar)?;
        Ok(document)
    })?;
    project::save(document, from, to)
}
