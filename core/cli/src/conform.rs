//! `rototoon conform`: moves a document to footage that was delivered again.

use crate::failure::{Failure, line, named};
use crate::{arguments, progress, project, unchanged};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::conform::Given;
use rototoon::geometry::Point;
use rototoon::pipeline::{self, NewFootage, PipelineError};
use rototoon::project::output::check_writable;
use rototoon::project::schema::{MAX_COORDINATE, MAX_FPS, MIN_FPS};
use rototoon::project::{Document, Inputs, write_whole};
use std::path::{Path, PathBuf};

/// The subcommand.
pub fn command() -> Command {
    Command::new("conform")
        .about(
            "Moves a document to footage that was delivered again: of another size, with other frame numbers, with drawings added, left out, held longer or drawn again. Pictures of both footages are compared",
        )
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write"))
        .arg(
            Arg::new("footage")
                .long("footage")
                .value_name("PATTERN")
                .help("The files of the new footage, with %d or %04d for the number")
                .required(true),
        )
        .arg(arguments::frames().help("First and last frame of the new footage [default: all files]"))
        .arg(
            Arg::new("fps")
                .long("fps")
                .value_name("N")
                .help("Frames a second of the new footage [default: as before]")
                .value_parser(arguments::within(MIN_FPS, MAX_FPS)),
        )
        .arg(
            Arg::new("scale")
                .long("scale")
                .value_name("N")
                .help("Pixels of the new picture for each pixel of the old one [default: found by the pictures]")
                .value_parser(arguments::within(0.01, 100.0)),
        )
        .arg(
            Arg::new("shift")
                .long("shift")
                .value_name("X,Y")
                .help("The place of the old picture's corner in the new one, in pixels [default: found by the pictures]")
                .allow_hyphen_values(true)
                .value_parser(place),
        )
        .arg(arguments::frame_offset(
            "What is added to the numbers of frames. Then no pictures are compared, and the old footage may be gone; the scale is that of the sizes and the shift 0, unless they are given",
        ).default_value(None))
        .arg(
            Arg::new("report")
                .long("report")
                .value_name("FILE")
                .help("Also writes what became of each frame as JSON")
                .value_parser(value_parser!(PathBuf)),
        )
        .args(arguments::of_run())
}

/// Reads a place `X,Y`.
fn place(text: &str) -> Result<Point, String> {
    let number = |word: &str| word.trim().parse::<f64>().ok().filter(|value| value.abs() <= MAX_COORDINATE);
    let numbers = text.split_once(',').and_then(|(x, y)| Some(Point::new(number(x)?, number(y)?)));
    numbers.ok_or_else(|| format!("expected two numbers X,Y within ±{MAX_COORDINATE}"))
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let document = project::load_either(from)?;
    let home = project::home(&document, from);
    let new = NewFootage {
        pattern: arguments::choice(given, "footage").to_owned(),
        folder: PathBuf::new(),
        frames: arguments::range(given),
        fps: given.get_one("fps").copied(),
        given: Given { scale: given.get_one("scale").copied(), shift: given.get_one("shift").copied() },
        offset: given.get_one("frame-offset").copied(),
        held: None,
    };
    let report = given.get_one::<PathBuf>("report");
    let inputs = project::inputs(&document, from);
    let check = |inputs: &Inputs| {
        inputs.check(to)?;
        report.map_or(Ok(()), |report| project::check_report(report, inputs, [from, to]))
    };
    check(&inputs)?;
    check_writable(to)?;
    let conformed = progress::run(given, from, |bar| {
        pipeline::conform(&document, &home, &new, bar).map_err(|error| explained(error, from))
    })?;
    // The frames of the new footage are inputs too.
    check(&Inputs::default().footage(&conformed.document.scene.footage, &new.folder))?;
    for text in conformed.told() {
        line("note", &format!("{}: {text}", from.display()));
    }
    for note in &conformed.notes {
        line("warning", &format!("{}: {note}", from.display()));
    }
    let told = format!("{:#}\n", conformed.report());
    save(conformed.document, to)?;
    report.map_or(Ok(()), |path| Ok(write_whole(path, told.as_bytes())?))
}

/// An error, and for frames that cannot be read the way without them.
fn explained(error: PipelineError, from: &Path) -> Failure {
    match error {
        PipelineError::Footage { which: "old", .. } => Failure::Other(format!(
            "{}\n{}: if the old footage is gone, --frame-offset N says how far the new numbers are ahead of the old ones",
            named(&error, from),
            from.display()
        )),
        other => Failure::of(other, from),
    }
}

/// Writes the document. The pattern was given from the current folder.
fn save(mut document: Document, to: &Path) -> Result<(), Failure> {
    project::follow(&mut document, Path::new(""), to)?;
    unchanged::save(&document, to)
}
