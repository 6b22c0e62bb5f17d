//! `rototoon style clip`: makes a skeleton clip from a document's tracked contours.

use super::name;
use crate::arguments;
use crate::failure::{Failure, line};
use crate::{project, render};
use clap::{Arg, ArgMatches, Command};
use rototoon::pipeline::{self, ClipJob};
use rototoon::project::output::check_writable;
use rototoon::scene::FrameNumber;
use std::ops::RangeInclusive;

/// The subcommand.
pub fn command() -> Command {
    Command::new("clip")
        .about("Makes a skeleton clip from tracked contours and the document's limbs")
        .arg(arguments::project())
        .arg(name("character", "Name of the character"))
        .arg(name("motion", "Name of the motion, such as walk"))
        .arg(
            Arg::new("frames")
                .long("frames")
                .value_name("A-B")
                .help("First and last frame [default: all frames of the footage]")
                .allow_hyphen_values(true)
                .value_parser(render::range),
        )
        .arg(arguments::output("CLIPS", "The file of clips to write"))
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let document = project::load(from)?;
    project::inputs(&document, from).file(from).check(to)?;
    check_writable(to)?;
    let job = ClipJob {
        character: arguments::choice(given, "character").to_owned(),
        motion: arguments::choice(given, "motion").to_owned(),
        frames: given.get_one::<RangeInclusive<FrameNumber>>("frames").cloned(),
    };
    let made = pipeline::clip(&document, &job).map_err(|error| Failure::of(error, from))?;
    let frames = made.clips.clips.first().map_or(0, |clip| clip.postures.len());
    for (point, count) in &made.guessed {
        line("warning", &format!("{}: {point}: filled in on {count} of {frames} frames", from.display()));
    }
    if let Some(outdated) = &made.outdated {
        line("warning", &format!("{}: {outdated}", from.display()));
    }
    for doubt in &made.doubts {
        line("warning", &format!("{}: {doubt}; the clip has what the contours show there", from.display()));
    }
    if frames == 1 {
        let text = format!("found contours on frame {} only, so the clip has one posture and no motion", made.first);
        line("note", &format!("{}: {text}", from.display()));
    }
    Ok(made.clips.save(to)?)
}
