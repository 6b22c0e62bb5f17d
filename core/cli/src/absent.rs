//! `rototoon absent`: says on which frames the picture does not show a part.

use crate::failure::{Failure, line};
use crate::{arguments, project, render};
use clap::{Arg, ArgAction, ArgMatches, Command};
use rototoon::scene::{FrameError, FrameNumber};
use std::ops::RangeInclusive;

/// The subcommand.
pub fn command() -> Command {
    Command::new("absent")
        .about(
            "Marks a part as hidden on some frames: it has no contour there, and its results on them are removed. Keys stay",
        )
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write"))
        .arg(Arg::new("part").long("part").value_name("NAME").help("The name of the part").required(true))
        .arg(
            Arg::new("frames")
                .long("frames")
                .value_name("A-B")
                .help("First and last frame, or one frame")
                .required(true)
                .allow_hyphen_values(true)
                .value_parser(render::range),
        )
        .arg(
            Arg::new("there")
                .long("there")
                .help("Marks the part as there again instead")
                .action(ArgAction::SetTrue),
        )
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let mut document = project::load(from)?;
    project::inputs(&document, from).check(to)?;
    project::check_output(&document, from, to)?;
    let name = arguments::choice(given, "part");
    let footage = document.scene.footage.clone();
    let index = document.scene.part_index(name);
    let index = index.map_err(|error| Failure::Use(format!("{}: --part: {error}", from.display())))?;
    let Some(frames) = given.get_one::<RangeInclusive<FrameNumber>>("frames") else { return Ok(()) };
    let (first, last) = (*frames.start(), *frames.end());
    if let Some(frame) = [first, last].into_iter().find(|frame| !(footage.first..=footage.last).contains(frame)) {
        let outside = FrameError::Outside { frame, first: footage.first, last: footage.last };
        return Err(Failure::Use(format!("{}: --frames: {outside}", from.display())));
    }
    let part = &mut document.scene.parts[index];
    if given.get_flag("there") {
        part.clear_absent(first, last);
    } else {
        part.set_absent(first, last);
        part.forget_where_absent();
        for frame in part.keys.range(frames.clone()).map(|(frame, _)| frame) {
            line(
                "warning",
                &format!("part {name:?} has a key on frame {frame}, so it is there: remove the key to hide it"),
            );
        }
    }
    project::save(document, from, to)
}
