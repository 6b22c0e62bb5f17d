//! `rototoon style library`: fills and lists a library, which is a folder of clips with an index.

use crate::arguments;
use crate::failure::{Failure, line};
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use rototoon::pipeline;
use rototoon::project::clips::Clips;
use rototoon::project::library::{AddError, Addition, Existing, Library};
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
        .about("Adds the clips of a file, all or none; none if the library has one of the same character and motion")
        .arg(folder())
        .arg(
            Arg::new("clips")
                .value_name("CLIPS")
                .help("The file of clips")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(word("source", "Where the clips come from"))
        .arg(
            Arg::new("replace")
                .long("replace")
                .help("Replaces clips of the same character and motion")
                .action(ArgAction::SetTrue),
        );
    let list = Command::new("list")
        .about("Lists the clips that can be used: character, motion, frames, frames per second, file, source. Damaged and missing files give warnings")
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
        return add(&mut library, given);
    }
    // The index alone does not tell which files are there and whole.
    let (character, motion) = (arguments::choice(given, "character"), arguments::choice(given, "motion"));
    let found = library.checked(|entry| entry.has(character, motion));
    found.troubles().for_each(|trouble| line("warning", &trouble.to_string()));
    let mut out = std::io::stdout().lock();
    for (e, clip) in found.clips {
        let file = folder.join(&e.file);
        if !clip.deviation.is_empty() {
            line("note", &format!("{}: made by translation, not captured", file.display()));
        }
        if let Some(guesses) = pipeline::guesses(&clip) {
            line("note", &format!("{}: guessed, not captured: {guesses}", file.display()));
        }
        // A closed standard output, such as of `head`, is no error.
        let fields = format!("{}\t{}\t{}\t{}\t{}\t{}", e.character, e.motion, e.frames, e.fps, e.file, e.source);
        if writeln!(out, "{fields}").is_err() {
            break;
        }
    }
    Ok(())
}

fn add(library: &mut Library, given: &ArgMatches) -> Result<(), Failure> {
    let read = Clips::load(arguments::path(given, "clips")).map_err(|e| Failure::Other(e.to_string()))?;
    let addition = Addition { clips: &read, source: arguments::choice(given, "source") };
    let existing = if given.get_flag("replace") { Existing::Replace } else { Existing::Refuse };
    let added = library.add(&[addition], existing).map_err(|error| {
        Failure::Other(match error {
            AddError::Taken(taken) => format!("{taken}, expected another character or motion, or --replace"),
            other => other.to_string(),
        })
    })?;
    for e in &added.replaced {
        line("note", &format!("replaced {:?} by {:?} ({})", e.motion, e.character, e.file));
    }
    if added.unlocked {
        let folder = arguments::path(given, "folder").display();
        line("note", &format!("{folder}: the disk knows no locks; let only one program change the library at a time"));
    }
    if let Some(path) = added.aside {
        line("note", &format!("the damaged index is kept as {}", path.display()));
    }
    Ok(())
}
