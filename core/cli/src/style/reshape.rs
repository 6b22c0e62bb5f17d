//! `rototoon style reshape`: makes a drawing follow a skeleton clip.

use super::load;
use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use rototoon::pipeline::{self, Mirror, PipelineError, ReshapeJob, Reshaped, Side, Sides};
use rototoon::project::clips::Clips;
use rototoon::project::{Document, WriteError};
use rototoon::reshape::puppet::Options;
use rototoon::scene::{Clip, FrameNumber};
use std::path::{Path, PathBuf};

/// Most sub-key points of a limb.
const MOST_SUB_KEYS: i64 = 100;

/// The subcommand.
pub fn command() -> Command {
    let word = |id: &'static str, help: &'static str| Arg::new(id).long(id).value_name("NAME").help(help);
    Command::new("reshape")
        .about("Makes a drawing follow a skeleton clip: moves its contours and strokes on every frame")
        .arg(arguments::project())
        .arg(
            Arg::new("clips")
                .value_name("CLIPS")
                .help("The motion: a file of clips, or the folder of a library")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(word("character", "Character of the clip; needed if there are clips of several characters"))
        .arg(word("motion", "Motion of the clip; needed if there are clips of several motions"))
        .arg(
            Arg::new("rest")
                .long("rest")
                .value_name("FRAME")
                .help("The frame of the drawing [default: the first one on which every part has a contour]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(i32)),
        )
        .arg(
            Arg::new("over")
                .long("over")
                .value_name("PROJECT")
                .help("The document whose footage is behind the result [default: the drawing's document]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("sub_keys")
                .long("sub-keys")
                .value_name("N")
                .help("Number of points along each limb, between its key points. They let a limb curve; with 0 it stays nearly straight")
                .default_value("5")
                .value_parser(value_parser!(i64).range(0..=MOST_SUB_KEYS)),
        )
        .arg(
            Arg::new("chain")
                .long("chain")
                .value_name("CLIP=DRAWING")
                .help("For a clip of another skeleton: a chain of the clip's that moves a chain of the drawing's, such as l_arm=l_foreleg. Chains of equal names need none")
                .action(ArgAction::Append)
                .value_parser(pair),
        )
        .arg(mirror())
        .arg(arguments::output("OUT", "The document to write, with tracks, depths and strokes on every frame"))
        .args(arguments::of_run())
}

/// `--mirror auto|on|off`.
fn mirror() -> Arg {
    Arg::new("mirror")
        .long("mirror")
        .help("Whether the clip is mirrored, left for right")
        .default_value("auto")
        .value_parser(PossibleValuesParser::new([
            PossibleValue::new("auto").help("If drawing and clip look to different sides"),
            PossibleValue::new("on").help("Yes"),
            PossibleValue::new("off").help("No"),
        ]))
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let mut document = project::load(from)?;
    let clips = load(arguments::path(given, "clips"), |character, motion| is_asked(given, character, motion))?;
    let clip = chosen(&clips, arguments::path(given, "clips"), given)?;
    let inputs = project::inputs(&document, from).clips(arguments::path(given, "clips"));
    let over =
        given.get_one::<PathBuf>("over").map(|path| Ok::<_, Failure>((path, Document::load(path)?))).transpose()?;
    let inputs = over.iter().fold(inputs, |inputs, (path, other)| {
        inputs.file(path).footage(&other.scene.footage, &project::home(other, path))
    });
    inputs.check(to)?;
    project::check_output(&document, from, to)?;
    let over = match over {
        Some((path, mut other)) => {
            let (home, own) = (project::home(&other, path), project::home(&document, from));
            pipeline::relocate(&mut other, &home, &own).map_err(|source| WriteError { path: to.to_owned(), source })?;
            Some(other.scene.footage)
        }
        None => None,
    };
    let sub_keys = given.get_one::<i64>("sub_keys").and_then(|n| usize::try_from(*n).ok());
    let options = sub_keys.map_or_else(Options::default, |sub_keys| Options { sub_keys, ..Options::default() });
    let rest = given.get_one::<FrameNumber>("rest").copied();
    let chains = given.get_many::<(String, String)>("chain").into_iter().flatten().cloned().collect();
    let mirror = Mirror::from_id(arguments::choice(given, "mirror")).unwrap_or_default();
    let footage = over.as_ref().unwrap_or(&document.scene.footage);
    let (clip, rate) = pipeline::at_rate_of(footage, clip, clips.fps);
    let fps = footage.fps;
    let job = ReshapeJob { clip: &clip, fps, rest, over, chains, mirror, options, points: Default::default() };
    let (document, made) = progress::run(given, from, |bar| {
        let made = pipeline::reshape(&mut document, &job, bar).map_err(|error| failed(error, from))?;
        Ok((document, made))
    })?;
    if let Some(text) = rate {
        line("note", &format!("{}: {text}", from.display()));
    }
    report(&made, from);
    project::save(document, from, to)
}

/// The failure of the work. Each pair of chains is an option of its own.
fn failed(error: PipelineError, from: &Path) -> Failure {
    let error = match error {
        PipelineError::Option { option: "chains", reason } => PipelineError::Option { option: "chain", reason },
        other => other,
    };
    Failure::of(error, from)
}

/// Says what the artist should know about a result.
fn report(made: &Reshaped, from: &Path) {
    let say = |kind: &str, text: &str| line(kind, &format!("{}: {text}", from.display()));
    for (part, given) in &made.given {
        say("warning", &format!("part {part:?}: no limb carries it, so {given}"));
    }
    made.notes.iter().for_each(|text| say("warning", text));
    made.remarks.iter().for_each(|text| say("note", text));
    for chain in &made.still {
        say("warning", &format!("chain {chain:?}: no chain of the clip belongs to it, so it stays still (--chain)"));
    }
    if let Some(text) = made.sides.and_then(|sides| about_sides(sides, made.mirrored)) {
        say("note", &text);
    }
}

/// Whether the clip was mirrored, if that is worth a note.
fn about_sides(sides: Sides, mirrored: bool) -> Option<String> {
    let looks = |side: Option<Side>| side.map_or("to a side that cannot be told", Side::id);
    let (drawing, clip) = (looks(sides.drawing), looks(sides.clip));
    if mirrored {
        return Some(format!(
            "the drawing looks {drawing} and the clip {clip}, so the clip is mirrored (--mirror off)"
        ));
    }
    let untold = sides.drawing.is_none() || sides.clip.is_none();
    untold
        .then(|| format!("the drawing looks {drawing} and the clip {clip}, so the clip is not mirrored (--mirror on)"))
}

/// Two names with `=` between them.
fn pair(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').filter(|(a, b)| !a.is_empty() && !b.is_empty());
    pair.map(|(a, b)| (a.to_owned(), b.to_owned()))
        .ok_or_else(|| format!("found {text:?}, expected two names of chains with = between them"))
}

/// Whether the arguments select the clips of a character and a motion.
fn is_asked(given: &ArgMatches, character: &str, motion: &str) -> bool {
    let fits = |id: &str, value: &str| given.get_one::<String>(id).is_none_or(|wanted| wanted == value);
    fits("character", character) && fits("motion", motion)
}

/// The clip that the arguments select.
fn chosen<'a>(clips: &'a Clips, from: &Path, given: &ArgMatches) -> Result<&'a Clip, Failure> {
    let mut found = clips.clips.iter().filter(|c| is_asked(given, &c.character, &c.motion));
    match (found.next(), found.next()) {
        (Some(only), None) => Ok(only),
        (first, _) => {
            let known: Vec<_> = clips.clips.iter().map(|c| format!("({:?}, {:?})", c.character, c.motion)).collect();
            let count = if first.is_none() { "no clip" } else { "several clips" };
            let value = |id| given.get_one::<String>(id).map_or("any".to_owned(), |name| format!("{name:?}"));
            let (from, known) = (from.display(), known.join(", "));
            let (character, motion) = (value("character"), value("motion"));
            Err(Failure::Use(format!(
                "{from}: --character {character}, --motion {motion}: found {count}, expected one of {known}"
            )))
        }
    }
}
