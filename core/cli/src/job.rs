//! `rototoon job`: writes the template of a batch for a render farm.

use crate::batch;
use crate::failure::{Failure, line};
use crate::{arguments, project};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::project::output::moved_pattern;
use rototoon::project::{Document, Inputs, write_whole};
use rototoon_batch::jobs::{OnFailure, flamenco, opencue, openjd};
use rototoon_batch::manifest::Manifest;
use std::collections::BTreeSet;
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
        .arg(arguments::output(
            "FILE",
            "The job template (OpenJD), the job type (Flamenco), or the script that sends the job (OpenCue)",
        ))
        .arg(
            Arg::new("for")
                .long("for")
                .value_name("ENGINE")
                .help("The farm's engine")
                .default_value("openjd")
                .value_parser(PossibleValuesParser::new(["openjd", "flamenco", "opencue"])),
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
        .arg(
            Arg::new("failed-shots")
                .long("failed-shots")
                .value_name("WAY")
                .help("What a worker tells the farm when a shot fails")
                .default_value("go-on")
                .value_parser(PossibleValuesParser::new([
                    PossibleValue::new("go-on").help("Status 0: the others and the page are made all the same"),
                    PossibleValue::new("fail")
                        .help("Status 1: the farm may try the shots again, and holds the page back"),
                ])),
        )
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (path, to) = (arguments::path(given, "manifest"), arguments::path(given, "output"));
    let manifest = batch::load(path)?;
    // Commonly nothing is there yet, and the frames of a season are many.
    if to.exists() {
        frames(&manifest, batch::named(path, &manifest)).check(to)?;
    }
    let name = path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let (count, chunk) = (manifest.shots.len(), given.get_one::<u16>("chunk").map_or(1, |chunk| usize::from(*chunk)));
    let strict = arguments::choice(given, "failed-shots") == "fail";
    let failure = if strict { OnFailure::Fail } else { OnFailure::GoOn };
    let text = match arguments::choice(given, "for") {
        "flamenco" => {
            line("note", &format!("the manifest has {count} shots: give this number with the job"));
            flamenco::job_type(failure)
        }
        "opencue" => opencue::outline(&name, count, chunk, failure),
        _ => {
            let results = arguments::path(given, "results");
            let (place, results) = (from_template(path, to), from_template(results, to));
            let (place, results) = (place.as_deref(), results.as_deref());
            format!("{:#}\n", openjd::template(&name, (count, chunk), failure, place, results))
        }
    };
    Ok(write_whole(to, text.as_bytes())?)
}

/// Adds the frames of all footage. Those of a document that cannot be read are not known.
fn frames(manifest: &Manifest, inputs: Inputs) -> Inputs {
    let projects: BTreeSet<&Path> = manifest.shots.iter().map(|shot| shot.project.as_path()).collect();
    projects.into_iter().fold(inputs, |inputs, project| match Document::load(project) {
        Ok(document) => inputs.footage(&document.scene.footage, &project::home(&document, project)),
        Err(_) => inputs,
    })
}

/// A path relative to the folder of the template, with forward slashes; `None` if there is none.
fn from_template(path: &Path, template: &Path) -> Option<String> {
    let text = path.to_str()?;
    let moved = if path.is_absolute() {
        let folder = std::path::absolute(template).ok()?;
        path.strip_prefix(folder.parent()?).ok()?.to_str()?.to_owned()
    } else {
        moved_pattern(text, Path::new(""), project::folder(template)).ok()?
    };
    Path::new(&moved).is_relative().then(|| moved.replace('\\', "/"))
}
