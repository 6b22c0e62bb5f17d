//! `rototoon sheet`: draws a contact sheet of the result.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::{ArgMatches, Command};
use rototoon::pipeline;
use rototoon::project::output::check_writable;
use rototoon::project::seen::Made;
use rototoon::project::write_whole;
use rototoon::render::{Format, encode};

/// The subcommand.
pub fn command() -> Command {
    Command::new("sheet")
        .about(
            "Draws a contact sheet: the frames with their contours, strokes and paint, those with something lost in red borders, \
             those with something doubtful in amber ones. A frame whose picture cannot be read is hatched, and one without a file that \
             holds an earlier one says which. Of more than 48 frames it shows the worst ones and some between",
        )
        .arg(arguments::project())
        .arg(arguments::output("SHEET", "The picture to write, such as sheet.png"))
        .args(arguments::of_run())
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    if Format::of(to) != Some(Format::Png) {
        return Err(Failure::Use(format!("{}: expected a name that ends in .png", to.display())));
    }
    let document = project::load_either(from)?;
    let home = project::home(&document, from);
    project::inputs(&document, from).check(to)?;
    check_writable(to)?;
    let sheet = progress::run(given, from, |bar| {
        pipeline::sheet(&document, &home, bar).map_err(|error| Failure::of(error, from))
    })?;
    let bytes = encode::colours(&sheet.picture, Format::Png).map_err(|error| Failure::Other(error.to_string()))?;
    write_whole(to, &bytes)?;
    let changed = pipeline::changed(&document, &home, &Made::ALL, None).map_err(|error| Failure::of(error, from))?;
    for warning in pipeline::outdated(&document.scene).iter().chain(&pipeline::outside(&document.scene)).chain(&changed)
    {
        line("warning", &format!("{}: {warning}", from.display()));
    }
    // As `render` does: what can be drawn is drawn, and the status says that something is missing.
    sheet.gaps.map_or(Ok(()), |gaps| Err(Failure::of(gaps, from)))
}
