//! `rototoon style`: makes skeleton clips, makes motions in another character's style, and makes drawings follow clips.
//!
//! - [`clip`]: makes clips from tracked contours
//! - [`import`]: makes clips from motion capture
//! - [`library`]: keeps clips in a folder
//! - [`translate`]: makes a motion in another character's style
//! - [`reshape`]: makes a drawing follow a clip

mod clip;
mod import;
mod library;
mod reshape;
mod translate;

use crate::failure::{Failure, line};
use clap::{Arg, ArgMatches, Command};
use rototoon::project::clips::Clips;
use rototoon::project::library::Library;
use std::path::Path;

/// The subcommand.
pub fn command() -> Command {
    Command::new("style")
        .about("Makes skeleton clips, makes motions in another character's style, and makes drawings follow clips")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommands([clip::command(), import::command(), library::command(), translate::command(), reshape::command()])
}

/// Runs the subcommand.
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

/// The clips of a file, or of a library. Those of a library are brought to one frame rate: that of the first clip of which
/// `leads` is true, else that of most clips. Unusable files of a library give warnings.
fn load(from: &Path, leads: impl Fn(&str, &str) -> bool) -> Result<Clips, Failure> {
    if !from.is_dir() {
        return Clips::load(from).map_err(|e| Failure::Other(e.to_string()));
    }
    let library = Library::open(from);
    let found = library.checked(|_| true);
    library.troubles().iter().chain(found.troubles()).for_each(|trouble| line("warning", &trouble.to_string()));
    let entries = || found.clips.iter().map(|(entry, _)| entry);
    let leading = entries().find(|entry| leads(&entry.character, &entry.motion));
    let fps = leading.map_or_else(|| Library::usual_rate(entries()), |entry| entry.fps);
    Ok(found.at_rate(fps))
}
