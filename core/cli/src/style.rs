//! `rototoon style`: skeleton clips, and a motion re-made in another character's manner.

use crate::failure::{Failure, line};
use crate::{arguments, progress};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::project::clips::{Clips, load_key_poses};
use rototoon::project::library::Library;
use rototoon::project::output::check_writable;
use rototoon::scene::parameters::Stage;
use rototoon::style::{KeyPose, Options, Pace, Preset, Request, translate};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The subcommand.
pub fn command() -> Command {
    Command::new("style")
        .about("Skeleton clips: a motion re-made in another character's manner")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(translate_command())
        .subcommand(library_command())
}

/// Runs it.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    match given.subcommand() {
        Some(("translate", given)) => run_translate(given),
        Some(("library", given)) => run_library(given),
        _ => Err(Failure::Use("expected a subcommand of style".into())),
    }
}

fn name(id: &'static str, help: &'static str) -> Arg {
    Arg::new(id).long(id).value_name("NAME").help(help).required(true)
}

fn on_or_off(id: &'static str, help: &'static str) -> Arg {
    let values = PossibleValuesParser::new(["on", "off"]);
    Arg::new(id)
        .long(id)
        .value_name("on|off")
        .hide_possible_values(true)
        .help(help)
        .default_value("on")
        .value_parser(values)
}

fn translate_command() -> Command {
    let presets = Preset::ALL.iter().map(|(id, help, _)| PossibleValue::new(*id).help(*help));
    let paces = PossibleValuesParser::new([
        PossibleValue::new("content").help("That of the content's clip, frame by frame"),
        PossibleValue::new("style").help("Slower or faster, as the style's other clips are beside the content's"),
    ]);
    Command::new("translate")
        .about("Re-makes a motion in another character's manner")
        .arg(
            Arg::new("clips")
                .value_name("CLIPS")
                .help("The clips to learn from: a file of clips, or the folder of a library")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(name("style", "The character in whose manner"))
        .arg(name("motion", "The motion to make; a clip of it by that character is left out of account"))
        .arg(name("content", "The character whose motion it was: gives length, timing and the way"))
        .arg(
            Arg::new("key_pose")
                .long("key-pose")
                .value_name("FILE")
                .help("Postures drawn for the result: one for its first frame, or a list of {\"frame\", \"points\"}")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("style_preset")
                .long("preset")
                .help("The method that translates")
                .default_value("rototoon")
                .value_parser(PossibleValuesParser::new(presets)),
        )
        .arg(Arg::new("timing").long("timing").help("Whose timing").default_value("content").value_parser(paces))
        .arg(
            Arg::new("strength")
                .long("strength")
                .value_name("NUMBER")
                .help("Factor on what the style adds to the motion, 0 to 3 (default preset)")
                .default_value("1.1")
                .allow_negative_numbers(true)
                .value_parser(|text: &str| match text.parse::<f64>() {
                    Ok(value) if (0.0..=3.0).contains(&value) => Ok(value),
                    _ => Err("expected a number from 0 to 3"),
                }),
        )
        .arg(on_or_off("limb-lengths", "Whether limbs keep within the lengths of the style's own clips"))
        .arg(on_or_off("contacts", "Whether feet that stand in the content's clip stay where they stand"))
        .arg(arguments::output("OUT", "The file to write: one clip, with the standard deviation of each key point"))
        .args(arguments::of_stage(Stage::Run))
}

fn run_translate(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "clips"), arguments::path(given, "output"));
    let text = |id: &str| arguments::choice(given, id);
    let other = |error: &dyn std::fmt::Display| Failure::Other(error.to_string());
    let clips = load(from)?;
    let keys = match given.get_one::<PathBuf>("key_pose") {
        Some(path) => load_key_poses(path).map_err(|e| other(&e))?,
        None => Vec::new(),
    };
    let keys: Vec<KeyPose> = keys.into_iter().map(|key| KeyPose { frame: key.frame, posture: key.posture }).collect();
    check_writable(to)?;
    let preset = text("style_preset");
    let options = Options {
        preset: Preset::from_id(preset).ok_or_else(|| Failure::Use(format!("no preset {preset:?}")))?,
        pace: if text("timing") == "style" { Pace::Style } else { Pace::Content },
        strength: given.get_one::<f64>("strength").copied().unwrap_or(Options::default().strength),
        keep_lengths: text("limb-lengths") == "on",
        keep_contacts: text("contacts") == "on",
    };
    let request = Request { style: text("style"), motion: text("motion"), content: text("content"), keys: &keys };
    let clip = progress::run(arguments::threads(given), |_| {
        translate(&clips.clips, &request, &options).map_err(|e| Failure::Other(format!("{}: {e}", from.display())))
    })?;
    Ok(Clips { clips: vec![clip], fps: clips.fps }.save(to)?)
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

fn library_command() -> Command {
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
        .about("Adds the clips of a file; those of the same character and motion are replaced")
        .arg(folder())
        .arg(
            Arg::new("clips").value_name("CLIPS").help("The clips").required(true).value_parser(value_parser!(PathBuf)),
        )
        .arg(word("source", "Where the clips come from"));
    let list = Command::new("list")
        .about("Lists clips: character, motion, frames, frames a second, file, source")
        .arg(folder())
        .arg(word("character", "Only characters whose names hold this"))
        .arg(word("motion", "Only motions whose names hold this"));
    Command::new("library")
        .about("A folder of clips with an index")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommands([add, list])
}

fn run_library(given: &ArgMatches) -> Result<(), Failure> {
    let Some((what, given)) = given.subcommand() else { return Err(Failure::Use("expected add or list".into())) };
    let mut library = Library::open(arguments::path(given, "folder"));
    library.troubles().iter().for_each(|trouble| line("warning", &trouble.to_string()));
    if what == "add" {
        let from = arguments::path(given, "clips");
        let read = Clips::load(from).map_err(|e| Failure::Other(e.to_string()))?;
        for clip in &read.clips {
            library.add(clip, read.fps, arguments::choice(given, "source"))?;
        }
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    let found = library.search(arguments::choice(given, "character"), arguments::choice(given, "motion"));
    for e in found {
        // A reader that has gone away is no failure.
        let fields = format!("{}\t{}\t{}\t{}\t{}\t{}", e.character, e.motion, e.frames, e.fps, e.file, e.source);
        if writeln!(out, "{fields}").is_err() {
            break;
        }
    }
    Ok(())
}
