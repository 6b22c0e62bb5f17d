//! `rototoon style translate`: makes a motion in another character's style.

use super::{load, name};
use crate::failure::{Failure, line};
use crate::{arguments, progress};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::pipeline;
use rototoon::project::Inputs;
use rototoon::project::clips::load_key_poses;
use rototoon::project::output::check_writable;
use rototoon::style::{KeyPose, Options, Pace, Preset, Request};
use std::path::PathBuf;

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

/// The subcommand.
pub fn command() -> Command {
    Command::new("translate")
        .about("Makes a motion in another character's style")
        .args(of_task())
        .args(of_method())
        .arg(on_or_off("limb-lengths", "Whether limbs keep within the lengths of the style's own clips"))
        .arg(on_or_off("contacts", "Whether feet that stand in the content's clip stay where they stand"))
        .arg(arguments::output("OUT", "The file to write: one clip with the standard deviation of each key point"))
        .args(arguments::of_run())
}

/// What is translated.
fn of_task() -> [Arg; 5] {
    [
        Arg::new("clips")
            .value_name("CLIPS")
            .help("The clips to learn from: a file of clips, or the folder of a library")
            .required(true)
            .value_parser(value_parser!(PathBuf)),
        name("style", "The character whose style the result has"),
        name("motion", "The motion to make; a clip of this motion by the style's character is not used"),
        name("content", "The character whose clip of the motion gives length, timing and way"),
        Arg::new("key_pose")
            .long("key-pose")
            .value_name("FILE")
            .help("Drawn postures for the result: one for its first frame, or a list of {\"frame\", \"points\"}")
            .value_parser(value_parser!(PathBuf)),
    ]
}

/// How it is translated.
fn of_method() -> [Arg; 4] {
    let presets = Preset::ALL.iter().map(|(id, help, _)| PossibleValue::new(*id).help(*help));
    let paces = PossibleValuesParser::new([
        PossibleValue::new("content").help("The timing of the content's clip, frame by frame"),
        PossibleValue::new("style").help("Slower or faster, by how the style's other clips differ from the content's"),
    ]);
    [
        Arg::new("style_preset")
            .long("preset")
            .value_name("preset")
            .help("The method that translates")
            .default_value("rototoon")
            .value_parser(PossibleValuesParser::new(presets)),
        Arg::new("timing").long("timing").help("The timing of the result").default_value("content").value_parser(paces),
        Arg::new("strength")
            .long("strength")
            .value_name("NUMBER")
            .help("Factor on the change that the style makes, 0 to 3; with 0 the result is the content's own motion (only of the default preset)")
            .default_value("1.1")
            .allow_negative_numbers(true)
            .value_parser(arguments::within(0.0, 3.0)),
        Arg::new("rank")
            .long("rank")
            .value_name("N")
            .help("Number of components of the presets bilinear and liang2012 [default: that of the preset]")
            .value_parser(value_parser!(u16).range(1..=1000)),
    ]
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "clips"), arguments::path(given, "output"));
    let text = |id: &str| arguments::choice(given, id);
    let other = |error: &dyn std::fmt::Display| Failure::Other(error.to_string());
    let clips = load(from, |character, motion| character == text("content") && motion == text("motion"))?;
    let keys = match given.get_one::<PathBuf>("key_pose") {
        Some(path) => load_key_poses(path).map_err(|e| other(&e))?,
        None => Vec::new(),
    };
    let keys: Vec<KeyPose> = keys.into_iter().map(|key| KeyPose { frame: key.frame, posture: key.posture }).collect();
    let read = given
        .get_one::<PathBuf>("key_pose")
        .into_iter()
        .fold(Inputs::default().clips(from), |read, path| read.file(path));
    read.check(to)?;
    check_writable(to)?;
    let preset = text("style_preset");
    let options = Options {
        preset: Preset::from_id(preset).ok_or_else(|| Failure::Use(format!("no preset {preset:?}")))?,
        pace: if text("timing") == "style" { Pace::Style } else { Pace::Content },
        strength: given.get_one::<f64>("strength").copied().unwrap_or(Options::default().strength),
        rank: given.get_one::<u16>("rank").map(|rank| usize::from(*rank)),
        keep_lengths: text("limb-lengths") == "on",
        keep_contacts: text("contacts") == "on",
    };
    let request = Request { style: text("style"), motion: text("motion"), content: text("content"), keys: &keys };
    let (made, grounds) = progress::run(given, from, |bar| {
        pipeline::translate_and_judge(&clips, &request, &options, bar).map_err(|error| Failure::of(error, from))
    })?;
    for note in grounds.notes() {
        line("note", &format!("{}: {note}", from.display()));
    }
    for note in made.clips.iter().filter_map(pipeline::guessed_translation) {
        line("warning", &format!("{}: {note}", from.display()));
    }
    Ok(made.save(to)?)
}
