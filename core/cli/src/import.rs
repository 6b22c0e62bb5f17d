//! `rototoon import`: reads shapes of other programs as keys.

use crate::failure::{Failure, line};
use crate::{arguments, project};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::file;
use rototoon::import::ImportError;
use rototoon::pipeline::{self, Imported, PipelineError, ShapeFormat};
use rototoon::project::Document;
use rototoon::scene::{FrameNumber, FramePattern};
use std::path::{Path, PathBuf};

/// The subcommand.
pub fn command() -> Command {
    Command::new("import")
        .about("Adds shapes of Nuke, Natron, Silhouette, Fusion or SVG to a document, as keys of parts")
        .arg(arguments::project())
        .arg(
            Arg::new("shapes")
                .value_name("SHAPES")
                .help("FILE.nk (Nuke), FILE.ntp (Natron), FILE.fxs (Silhouette), FILE.setting or FILE.comp (Fusion), FILE.svg, or FILE_%04d.svg (a file for each frame); a shape changes the part of the same name where it is another one")
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
            "How far the file's frames are ahead of the document's: with 1000, 1001 becomes frame 1. Not for one .svg file, which counts from its own beginning",
        ))
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let [from, to] = ["project", "output"].map(|id| arguments::path(given, id));
    // Warnings about this document are not printed, because the import changes it.
    let mut document = project::read(from)?;
    let files = files(given, &document)?;
    let mut imported = Imported::default();
    let mut empty = None;
    for file in &files {
        let found = match read(given, &mut document, file)? {
            Ok(found) => found,
            Err(nothing) => {
                empty = Some(nothing);
                continue;
            }
        };
        for warning in &found.warnings {
            line("warning", &format!("{}: {warning}", file.path.display()));
        }
        imported.join(found);
    }
    // A file for a frame on which no part is shown has no shape.
    if let Some(nothing) = empty.filter(|_| imported.merged.taken.is_empty()) {
        return Err(nothing);
    }
    let inputs = files.iter().fold(project::inputs(&document, from), |inputs, file| inputs.file(&file.path));
    inputs.check(to)?;
    project::save(document, from, to)?;
    if let Some(told) = imported.told() {
        line("note", &format!("{}: {told}", arguments::path(given, "shapes").display()));
    }
    Ok(())
}

/// A file with shapes.
struct Shapes {
    path: PathBuf,
    format: ShapeFormat,
    /// How far its frames are ahead of the document's.
    offset: FrameNumber,
}

/// The files to read: one, or one for each frame of the footage that has one.
fn files(given: &ArgMatches, document: &Document) -> Result<Vec<Shapes>, Failure> {
    let (shapes, offset) = (arguments::path(given, "shapes"), arguments::offset(given));
    let extension = shapes.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_ascii_lowercase();
    let still = still(given, document)?;
    let Some(format) = ShapeFormat::of(&extension, still) else {
        let message =
            format!("{}: expected a name that ends in .nk, .ntp, .fxs, .setting, .comp or .svg", shapes.display());
        return Err(Failure::Use(message));
    };
    let format = match format {
        ShapeFormat::Svg { still, .. } => ShapeFormat::Svg { still, asked: given.contains_id("frame") },
        other => other,
    };
    let is_svg = matches!(format, ShapeFormat::Svg { .. });
    // A file whose own name has a percent sign is itself.
    let name = shapes.file_name().and_then(|name| name.to_str()).filter(|_| is_svg && !shapes.exists());
    if let Some(pattern) = name.and_then(|name| FramePattern::parse(name).ok()) {
        return numbered(given, document, &pattern);
    }
    if offset != 0 && is_svg {
        return Err(Failure::Use(format!(
            "found --frame-offset {offset}: expected no such option for one .svg file, which counts from its own beginning"
        )));
    }
    Ok(vec![Shapes { path: shapes.to_owned(), format, offset }])
}

/// The frame of shapes that are not animated.
fn still(given: &ArgMatches, document: &Document) -> Result<FrameNumber, Failure> {
    let footage = &document.scene.footage;
    let still = given.get_one::<FrameNumber>("frame").copied().unwrap_or(footage.first);
    if (footage.first..=footage.last).contains(&still) {
        return Ok(still);
    }
    let own = format!("{} to {}", footage.first, footage.last);
    let from = arguments::path(given, "project").display();
    Err(Failure::Use(format!("{from}: --frame: found {still}, expected a frame of the footage, {own}")))
}

/// One SVG file for each frame, as `export` writes them. The number of a file is that of its frame, and further by the offset.
fn numbered(given: &ArgMatches, document: &Document, pattern: &FramePattern) -> Result<Vec<Shapes>, Failure> {
    let (shapes, offset) = (arguments::path(given, "shapes"), arguments::offset(given));
    if let Some(frame) = given.get_one::<FrameNumber>("frame") {
        return Err(Failure::Use(format!(
            "found --frame {frame}: expected no such option for a file for each frame, whose numbers say it"
        )));
    }
    let folder = shapes.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let existing = pattern.existing(folder);
    let existing = existing.map_err(|error| Failure::Other(format!("{}: {error}", folder.display())))?;
    let footage = &document.scene.footage;
    let within = |number: FrameNumber| {
        let frame = FrameNumber::try_from(i64::from(number) - i64::from(offset)).ok()?;
        (footage.first..=footage.last).contains(&frame).then_some((number, frame))
    };
    let found: Vec<_> = existing.iter().filter_map(|&number| within(number)).collect();
    if found.is_empty() {
        let (first, last) = (i64::from(footage.first) + i64::from(offset), i64::from(footage.last) + i64::from(offset));
        return Err(Failure::Other(format!(
            "{}: found no file with a number from {first} to {last}, expected one for a frame of the footage",
            shapes.display()
        )));
    }
    let of = |(number, still)| Shapes {
        path: shapes.with_file_name(pattern.path(number)),
        format: ShapeFormat::Svg { still, asked: true },
        offset: 0,
    };
    Ok(found.into_iter().map(of).collect())
}

/// Puts the shapes of a file into the document. The inner error is that of a file without any shape.
fn read(given: &ArgMatches, document: &mut Document, shapes: &Shapes) -> Result<Result<Imported, Failure>, Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::Other(format!("{}: {error}", shapes.path.display()));
    let text = file::text(&shapes.path).map_err(|error| failed(&format!("cannot read the shapes: {error}")))?;
    match pipeline::import_shifted(document, &text, shapes.format, shapes.offset) {
        Ok(imported) => Ok(Ok(imported)),
        Err(PipelineError::Import(error @ ImportError::Nothing(_))) => Ok(Err(failed(&error))),
        Err(error @ PipelineError::Import(ImportError::Beyond(_))) => {
            Err(failed(&format!("{error}; --frame-offset says how far the file's frames are ahead of the document's")))
        }
        Err(PipelineError::Import(error)) => Err(failed(&error)),
        Err(other) => Err(Failure::of(other, arguments::path(given, "project"))),
    }
}
