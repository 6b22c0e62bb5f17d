//! `rototoon job`: writes the template of a batch for a render farm.

use crate::arguments;
use crate::batch;
use crate::failure::{Failure, line};
use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::project::{Inputs, write_whole};
use rototoon_batch::jobs::{flamenco, openjd};
use std::path::{Path, PathBuf};

/// The subcommand.
pub fn command() -> Command {
    Command::new("job")
        .about("Writes a batch as a job for a render farm")
        .arg(
            Arg::new("manifest")
                .value_name("MANIFEST")
                .help("The file that names shots and steps")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(arguments::output("FILE", "The job template (OpenJD), or the job type (Flamenco)"))
        .arg(
            Arg::new("for")
                .long("for")
                .value_name("ENGINE")
                .help("The farm's engine")
                .default_value("openjd")
                .value_parser(PossibleValuesParser::new(["openjd", "flamenco"])),
        )
        .arg(
            Arg::new("results")
                .long("results")
                .value_name("DIR")
                .help("The folder of the results")
                .default_value("results")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("chunk")
                .long("chunk")
                .value_name("N")
                .help("Shots that a worker gets at a time")
                .default_value("4")
                .value_parser(value_parser!(u16).range(1..)),
        )
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (path, to) = (arguments::path(given, "manifest"), arguments::path(given, "output"));
    let manifest = batch::load(path)?;
    let inputs = manifest.shots.iter().fold(Inputs::default().file(path), |inputs, shot| inputs.file(&shot.project));
    inputs.check(to)?;
    let text = match arguments::choice(given, "for") {
        "flamenco" => {
            line("note", &format!("the manifest has {} shots: give this number with the job", manifest.shots.len()));
            flamenco::job_type()
        }
        _ => {
            let results = arguments::path(given, "results");
            let name = path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            let chunk = given.get_one::<u16>("chunk").map_or(1, |chunk| usize::from(*chunk));
            let (manifest_path, results) = (whole(path), whole(results));
            format!("{:#}\n", openjd::template(&name, manifest.shots.len(), chunk, &manifest_path, &results))
        }
    };
    Ok(write_whole(to, text.as_bytes())?)
}

/// A path that means the same in any folder.
fn whole(path: &Path) -> String {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).to_string_lossy().into_owned()
}
