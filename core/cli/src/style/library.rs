//! `rototoon style library`: fills and lists a library, which is a folder of clips with an index.

use crate::arguments;
use crate::failure::{Failure, line};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::project::clips::Clips;
use rototoon::project::library::Library;
use std::io::Write;
use std::path::PathBuf;

/// The subcommand.
pub fn command() -> Command {
    let folder = || {
        Arg::new("folder")
            .value_name("FOLDER")
            .help("The library's folder")
            .required(true)
            .value_parser(value_parser!(PathBuf))
    };
    let word =
        |id: &'static str, help: &'static str| Arg::new(id).long(id).value_name("WORD").help(help).default_value("");
    let add = Command::new("add")
        .about("Adds the clips of a file; they replace clips of the same character and motion")
        .arg(folder())
        .arg(
            Arg::new("clips")
                .value_name("CLIPS")
                .help("The file of clips")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(word("source", "Where the clips come from"));
    let list = Command::new("list")
        .about("Lists clips: character, motion, frames, frames per second, file, source")
        .arg(folder())
        .arg(word("character", "Only characters whose names contain this word"))
        .arg(word("motion", "Only motions whose names contain this word"));
    Command::new("library")
        .about("Fills and lists a library, a folder of clips with an index")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommands([add, list])
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let Some((what, given)) = given.subcommand() else { return Err(Failure::Use("expected add or list".into())) };
    let folder = arguments::path(given, "folder");
    // Only `add` makes a library. A folder that is not there is most likely a slip of the pen.
    if what == "list" && !folder.is_dir() {
        return Err(Failure::Other(format!("{}: found no folder, expected that of a library", folder.display())));
    }
    let mut library = Library::open(folder);
    library.troubles().iter().for_each(|trouble| line("warning", &trouble.to_string()));
    if what == "add" {
        let from = arguments::path(given, "clips");
        let read = Clips::load(from).map_err(|e| Failure::Other(e.to_string()))?;
        let aside = library.add_all(&read.clips, read.fps, arguments::choice(given, "source"));
        if let Some(path) = aside.map_err(|e| Failure::Other(e.to_string()))? {
            line("note", &format!("the damaged index is kept as {}", path.display()));
        }
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    let found = library.search(arguments::choice(given, "character"), arguments::choice(given, "motion"));
    for e in found {
        // A closed standard output, such as of `head`, is no error.
        let fields = format!("{}\t{}\t{}\t{}\t{}\t{}", e.character, e.motion, e.frames, e.fps, e.file, e.source);
        if writeln!(out, "{fields}").is_err() {
            break;
        }
    }
    Ok(())
}
