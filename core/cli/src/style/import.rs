//! `rototoon style import`: makes skeleton clips from motion capture.

use crate::arguments;
use crate::failure::{Failure, line};
use crate::render;
use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use rototoon::file;
use rototoon::import::bvh::{JointMap, MotionError, Options, Up, View, seen};
use rototoon::project::Inputs;
use rototoon::project::clips::Clips;
use rototoon::project::output::check_writable;
use rototoon::scene::{Clip, FrameNumber};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// The subcommand.
pub fn command() -> Command {
    let option =
        |id: &'static str, value: &'static str, help: &'static str| Arg::new(id).long(id).value_name(value).help(help);
    Command::new("import")
        .about("Makes skeleton clips from motion capture (BVH files), seen from one direction")
        .arg(
            Arg::new("files")
                .value_name("FILE.bvh")
                .help("The motion files")
                .required(true)
                .num_args(1..)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(option("motion", "NAME", "Name of the motion [default: the file's name without its ending]"))
        .arg(option("character", "NAME", "Name of the character [default: the name of the file's folder]"))
        .arg(
            option(
                "view",
                "VIEW",
                "The direction of the view: front, side, three-quarter, auto (shows most of the motion), or degrees about \
                 the vertical (0 front, 90 side)",
            )
            .default_value("auto")
            .allow_hyphen_values(true)
            .value_parser(view),
        )
        .arg(
            option("up", "AXIS", "The axis that points up; auto takes the axis along which the character is tallest")
                .default_value("auto")
                .value_parser(PossibleValuesParser::new(["auto", "y", "z"])),
        )
        .arg(
            option("joints", "MAP.json", "Joints that are not recognised by their names: {\"l_wrist\": \"Hand.L\", …}")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("frames", "A-B", "First and last frame of the file, counted from 0 [default: all]")
                .allow_hyphen_values(true)
                .value_parser(render::range),
        )
        .arg(
            option("fps", "NUMBER", "Frames per second of the clips [default: those of the first file]")
                .value_parser(value_parser!(f64)),
        )
        .arg(
            Arg::new("way")
                .long("way")
                .help("Lets the pelvis move through the picture; otherwise it stays at the origin")
                .action(ArgAction::SetTrue),
        )
        .arg(arguments::output("CLIPS", "The file of clips to write"))
}

fn view(text: &str) -> Result<View, String> {
    Ok(match text {
        "auto" => View::Auto,
        "front" => View::Front,
        "side" => View::Side,
        "three-quarter" => View::ThreeQuarter,
        degrees => match degrees.parse::<f64>() {
            Ok(degrees) if degrees.is_finite() => View::Yaw(degrees),
            _ => return Err("expected front, side, three-quarter, auto or degrees".into()),
        },
    })
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let to = arguments::path(given, "output");
    let read = given.get_many::<PathBuf>("files").into_iter().flatten().chain(given.get_one("joints"));
    read.fold(Inputs::default(), |inputs, path| inputs.file(path)).check(to)?;
    check_writable(to)?;
    let mut options = options(given)?;
    let mut clips: Vec<Clip> = Vec::new();
    let files: Vec<&PathBuf> = given.get_many("files").into_iter().flatten().collect();
    for (k, file) in files.iter().enumerate() {
        let failed = |error: &dyn std::fmt::Display| Failure::Other(format!("{}: {error}", file.display()));
        // Names of joints may be in any encoding of their country; nothing else is beyond ASCII.
        let bytes = file::bytes(file).map_err(|error| failed(&format!("cannot read: {error}")))?;
        let text = String::from_utf8_lossy(&bytes);
        let made = seen(&text, &options).map_err(|error| match error {
            // What the file does not have is asked for by an option.
            MotionError::Frames { .. } | MotionError::Rate { .. } => {
                Failure::Use(format!("{}: {}", file.display(), as_option(&error, options.fps.is_some())))
            }
            other => failed(&other),
        })?;
        let (character, motion) = labels(given, file)?;
        if let Some(twin) = clips.iter().position(|clip| clip.character == character && clip.motion == motion) {
            let twin = files[twin].display();
            return Err(failed(&format!(
                "found {motion:?} by {character:?}, expected each motion of a character once; {twin} has it too"
            )));
        }
        if options.view == View::Auto {
            line("view", &format!("{}: {:.0} degrees", file.display(), made.yaw));
        }
        made.notes.iter().for_each(|note| line("note", &format!("{}: {note}", file.display())));
        if k == 0 {
            options.fps = Some(made.fps);
        }
        clips.push(Clip::new(character, motion, made.postures));
    }
    Ok(Clips { clips, fps: options.fps.unwrap_or(1.0) }.save(to)?)
}

/// An error that begins with what was asked for, with the option's name in its place. `rated` says whether a rate was given, or the file's own one counts.
fn as_option(error: &MotionError, rated: bool) -> String {
    let text = error.to_string();
    let reason = text.split_once(": ").map_or(text.as_str(), |(_, reason)| reason);
    match error {
        MotionError::Rate { .. } if rated => format!("--fps: {reason}"),
        MotionError::Rate { .. } => format!("Frame Time, as frames a second: {reason}; --fps gives another rate"),
        _ => format!("--frames: {reason}"),
    }
}

fn options(given: &ArgMatches) -> Result<Options, Failure> {
    let joints = match given.get_one::<PathBuf>("joints") {
        None => JointMap::default(),
        Some(path) => {
            let failed = |error: &dyn std::fmt::Display| Failure::Other(format!("{}: {error}", path.display()));
            let text = file::text(path).map_err(|error| failed(&format!("cannot read: {error}")))?;
            JointMap::parse(&text).map_err(|error| failed(&error))?
        }
    };
    let up = match arguments::choice(given, "up") {
        "y" => Up::Y,
        "z" => Up::Z,
        _ => Up::Auto,
    };
    let frames = match given.get_one::<RangeInclusive<FrameNumber>>("frames") {
        None => None,
        Some(frames) => match (usize::try_from(*frames.start()), usize::try_from(*frames.end())) {
            (Ok(first), Ok(last)) => Some(first..=last),
            _ => return Err(Failure::Use("--frames: found a negative frame, expected frames from 0".into())),
        },
    };
    let view = given.get_one::<View>("view").copied().unwrap_or_default();
    let fps = given.get_one::<f64>("fps").copied();
    Ok(Options { view, up, joints, way: given.get_flag("way"), frames, fps })
}

/// The names of the character and of the motion of a file.
fn labels(given: &ArgMatches, file: &Path) -> Result<(String, String), Failure> {
    let whole = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let folder = whole.parent().map(|parent| match parent.file_name() {
        Some(_) => parent.to_owned(),
        // The path ends in "..", whose folder has a name all the same.
        None => parent.canonicalize().unwrap_or_else(|_| parent.to_owned()),
    });
    let folder = folder.as_deref().and_then(Path::file_name);
    let label = |id: &str, own: Option<&std::ffi::OsStr>| {
        let own = || own.map(|name| name.to_string_lossy().into_owned());
        match given.get_one::<String>(id).cloned().or_else(own) {
            Some(name) if !name.is_empty() => Ok(name),
            _ => Err(Failure::Use(format!("{}: found no {id}, expected --{id} NAME", file.display()))),
        }
    };
    Ok((label("character", folder)?, label("motion", whole.file_stem())?))
}
