//! `rototoon style`: skeleton clips, a motion re-made in another character's manner, and drawings that follow it.
//!
//! - [`clip`]: clips of tracked contours
//! - [`import`]: clips of motion capture
//! - [`library`]: a folder of clips
//! - [`translate`]: another character's manner
//! - [`reshape`]: a drawing that follows a clip

mod clip;
mod import;
mod library;
mod reshape;
mod translate;

use crate::failure::{Failure, line};
use clap::{Arg, ArgMatches, Command};
use rototoon::pipeline::PipelineError;
use rototoon::project::clips::Clips;
use rototoon::project::library::Library;
use std::path::Path;

/// The subcommand.
pub fn command() -> Command {
    Command::new("style")
        .about("Skeleton clips: captured, re-made in another character's manner, followed by a drawing")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommands([clip::command(), import::command(), library::command(), translate::command(), reshape::command()])
}

/// Runs it.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    match given.subcommand() {
        Some(("clip", given)) => clip::run(given),
        Some(("import", given)) => import::run(given),
        Some(("library", given)) => library::run(given),
        Some(("translate", given)) => translate::run(given),
        Some(("reshape", given)) => reshape::run(given),
        _ => Err(Failure::Use("expected a subcommand of style".into())),
    }
}

fn name(id: &'static str, help: &'static str) -> Arg {
    Arg::new(id).long(id).value_name("NAME").help(help).required(true)
}

/// An error of clips or limbs, with the file that it is about.
fn named(error: PipelineError, from: &Path) -> Failure {
    match error {
        PipelineError::Style(reason) => Failure::Other(format!("{}: {reason}", from.display())),
        other => other.into(),
    }
}

/// Clips of a file, or of a library as far as it can be used.
fn load(from: &Path) -> Result<Clips, Failure> {
    if !from.is_dir() {
        return Clips::load(from).map_err(|e| Failure::Other(e.to_string()));
    }
    let library = Library::open(from);
    let (clips, troubles) = library.read(library.entries().iter());
    library.troubles().iter().chain(&troubles).for_each(|trouble| line("warning", &trouble.to_string()));
    let fps = library.entries().first().map_or(25.0, |entry| entry.fps);
    Ok(Clips { clips, fps })
}
