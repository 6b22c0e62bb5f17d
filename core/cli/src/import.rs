//! `rototoon import`: reads shapes of other programs as keys.

use crate::failure::{Failure, line};
use crate::{arguments, project};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::file;
use rototoon::import::ImportError;
use rototoon::pipeline::{self, PipelineError, ShapeFormat};
use rototoon::scene::FrameNumber;
use std::path::PathBuf;

/// The subcommand.
pub fn command() -> Command {
    Command::new("import")
        .about("Adds shapes of Nuke, Natron, Silhouette, Fusion or SVG to a document, as keys of parts")
        .arg(arguments::project())
        .arg(
            Arg::new("shapes")
                .value_name("SHAPES")
                .help("FILE.nk (Nuke), FILE.ntp (Natron), FILE.fxs (Silhouette), FILE.setting or FILE.comp (Fusion), or FILE.svg; a shape changes the part of the same name where it is another one")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(arguments::output("OUT", "The document to write"))
        .arg(
            Arg::new("frame")
                .long("frame")
                .value_name("N")
                .help("The frame of shapes that are not animated [default: the first frame of the footage]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(FrameNumber)),
        )
        .arg(arguments::frame_offset(
            "How far the file's frames are ahead of the document's: with 1000, 1001 becomes frame 1. Not for .svg, which counts from its own beginning",
        ))
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let [from, shapes, to] = ["project", "shapes", "output"].map(|id| arguments::path(given, id));
    let extension = shapes.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_ascii_lowercase();
    // Warnings about this document are not printed, because the import changes it.
    let mut document = project::read(from)?;
    let footage = &document.scene.footage;
    let still = given.get_one::<FrameNumber>("frame").copied().unwrap_or(footage.first);
    if !(footage.first..=footage.last).contains(&still) {
        let own = format!("{} to {}", footage.first, footage.last);
        let from = from.display();
        return Err(Failure::Use(format!("{from}: --frame: found {still}, expected a frame of the footage, {own}")));
    }
    let Some(format) = ShapeFormat::of(&extension, still) else {
        let message =
            format!("{}: expected a name that ends in .nk, .ntp, .fxs, .setting, .comp or .svg", shapes.display());
        return Err(Failure::Use(message));
    };
    let offset = arguments::offset(given);
    if offset != 0 && matches!(format, ShapeFormat::Svg { .. }) {
        return Err(Failure::Use(format!(
            "found --frame-offset {offset}: expected no such option for a .svg file, which counts from its own beginning"
        )));
    }
    let failed = |error: &dyn std::fmt::Display| Failure::Other(format!("{}: {error}", shapes.display()));
    let text = file::text(shapes).map_err(|error| failed(&format!("cannot read the shapes: {error}")))?;
    let imported = pipeline::import_shifted(&mut document, &text, format, offset).map_err(|error| match error {
        PipelineError::Import(ImportError::Beyond(_)) => {
            failed(&format!("{error}; --frame-offset says how far the file's frames are ahead of the document's"))
        }
        PipelineError::Import(error) => failed(&error),
        other => Failure::of(other, from),
    })?;
    for warning in &imported.warnings {
        line("warning", &format!("{}: {warning}", shapes.display()));
    }
    project::inputs(&document, from).file(shapes).check(to)?;
    project::save(document, from, to)?;
    if let Some(told) = imported.told() {
        line("note", &format!("{}: {told}", shapes.display()));
    }
    Ok(())
}
