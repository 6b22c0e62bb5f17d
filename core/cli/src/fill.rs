//! `rototoon fill`: line drawings painted by clicks on one of them.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::{Arg, ArgMatches, Command};
use rototoon::lines::{Options, Style};
use rototoon::pipeline::{self, FillOptions};
use rototoon::scene::FrameNumber;
use std::ops::RangeInclusive;

/// The subcommand.
pub fn command() -> Command {
    Command::new("fill")
        .about(
            "Paints line drawings: a painter clicked into the regions of one frame or more, and every region of all other \
             frames gets its colour",
        )
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write, with painted regions in its field \"filled\""))
        .arg(arguments::frames())
        .arg(arguments::sensitivity())
        .arg(arguments::leave_out())
        .arg(
            Arg::new("least_confidence")
                .long("confidence")
                .value_name("NUMBER")
                .help("Regions whose colour has a lower confidence stay unpainted, from 0 to 1")
                .default_value("0")
                .value_parser(arguments::within(0.0, 1.0)),
        )
        .arg(arguments::cache(
            "Folder where regions are kept, and where the lines of drawings are on each other. What has the same pictures as before comes from it",
        ))
        .args(arguments::of_run())
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let mut document = project::load_drawn(from)?;
    let home = project::home(&document, from);
    project::inputs(&document, from).check(to)?;
    project::check_output(&document, from, to)?;
    let sensitivity = given.get_one::<f64>("sensitivity").copied().unwrap_or(1.0);
    let frames = given.get_one::<RangeInclusive<FrameNumber>>("frames").cloned();
    let confidence = given.get_one::<f64>("least_confidence").copied().unwrap_or(0.0);
    let lines = Options { style: Style::Auto, sensitivity, leave_out: arguments::left_out(given) };
    let options = FillOptions { lines, confidence };
    let cache = arguments::cached(given);
    let (document, report) = progress::run(given, from, |bar| {
        let cache = cache.as_ref().map(|cache| cache as _);
        let report = pipeline::fill(&mut document, &home, frames, &options, cache, bar);
        Ok((document, report.map_err(|error| Failure::of(error, from))?))
    })?;
    project::say_gaps(&document, from)?;
    project::save(document, from, to)?;
    if report.earlier.known > 0 {
        line("note", &format!("{} steps have the pictures of an earlier run", report.earlier));
    }
    report.lines().iter().for_each(|text| line("note", text));
    Ok(())
}
