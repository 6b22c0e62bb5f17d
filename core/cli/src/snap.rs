//! `rototoon snap`: snaps contours to the drawn ink.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::{ArgMatches, Command};
use rototoon::pipeline;
use rototoon::scene::parameters::Stage;
use rototoon::snap::{CorridorWidth, Follow, SnapOptions};

/// The subcommand.
pub fn command() -> Command {
    Command::new("snap")
        .about("Snaps every contour to the drawn ink")
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write, with curves"))
        .args(arguments::of_stage(Stage::Snap))
        .args(arguments::of_run())
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let options = options(given)?;
    let mut document = project::load(from)?;
    let home = project::home(&document, from);
    project::inputs(&document, from).check(to)?;
    project::check_output(&document, from, to)?;
    let document = progress::run(given, from, |bar| {
        pipeline::snap(&mut document, &home, &options, bar).map_err(|error| Failure::of(error, from))?;
        Ok(document)
    })?;
    project::say_gaps(&document, from)?;
    let scene = &document.scene;
    for warning in [pipeline::untracked(scene), pipeline::outdated(scene)].into_iter().flatten() {
        line("warning", &format!("{}: {warning}", from.display()));
    }
    project::save(document, from, to)
}

fn options(given: &ArgMatches) -> Result<SnapOptions, Failure> {
    let follow = match arguments::choice(given, "follow") {
        "auto" => Follow::Auto,
        "edge" => Follow::Edge,
        "line" => Follow::Line,
        other => return Err(Failure::Use(format!("--follow: found {other:?}, expected auto, edge or line"))),
    };
    let corridor = CorridorWidth {
        share: arguments::number(given, "corridor_share"),
        least: arguments::number(given, "corridor_least"),
        most: arguments::number(given, "corridor_most"),
    };
    Ok(SnapOptions { follow, corridor })
}
