//! `rototoon trace`: line drawings as strokes, the same on every frame.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches, Command};
use rototoon::lines::{Options, Style};
use rototoon::pipeline::{self, Kept};
use rototoon::project::Document;
use rototoon::scene::FrameNumber;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// The subcommand.
pub fn command() -> Command {
    let styles = PossibleValuesParser::new([
        PossibleValue::new("auto").help("Found from each drawing"),
        PossibleValue::new("clean").help("Each line is drawn once"),
        PossibleValue::new("rough").help("Lines are sketched with several strokes of the pencil, which become one"),
    ]);
    Command::new("trace")
        .about(
            "Traces the lines of the first drawing as strokes and carries them to every frame. Strokes in the document's \
             drawings are followed instead. With --drawings, traces drawings on keys for `rototoon tween`",
        )
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write, with traced strokes"))
        .arg(arguments::frames())
        .arg(arguments::drawings(
            "Traces each of these frames for itself, such as 0,8,16, and adds it to the document's drawings. Pictures are needed \
             on these frames only",
        ))
        .arg(
            Arg::new("line_style")
                .long("style")
                .value_name("style")
                .help("The kind of drawing")
                .default_value("auto")
                .value_parser(styles),
        )
        .arg(arguments::sensitivity())
        .arg(arguments::leave_out())
        .arg(
            arguments::switch(
                "keep-first",
                "Says that an earlier run traced the first frame, which stays as it is. The frames from there to the document's first drawing \
                 follow both. A document that has the strokes of that run needs no such option",
            )
            .conflicts_with("drawings"),
        )
        .arg(arguments::cache(
            "Folder where strokes are kept. Steps from drawing to drawing with the same strokes and pictures as before come from it",
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
    let style = match arguments::choice(given, "line_style") {
        "clean" => Style::Clean,
        "rough" => Style::Rough,
        _ => Style::Auto,
    };
    let sensitivity = given.get_one::<f64>("sensitivity").copied().unwrap_or(1.0);
    let lines = Options { style, sensitivity, leave_out: arguments::left_out(given) };
    if let Some(keys) = given.get_many::<FrameNumber>("drawings") {
        return on_keys(given, document, &keys.copied().collect(), &lines);
    }
    let frames = given.get_one::<RangeInclusive<FrameNumber>>("frames").cloned();
    let options = pipeline::TraceOptions { lines, keep_first: arguments::is_on(given, "keep-first") };
    let cache = arguments::cached(given);
    let (document, earlier) = progress::run(given, from, |bar| {
        let kept = Kept { cache: cache.as_ref().map(|cache| cache as _), memory: None };
        let earlier = pipeline::trace(&mut document, &home, frames, &options, kept, bar);
        Ok((document, earlier.map_err(|error| Failure::of(error, from))?))
    })?;
    project::say_gaps(&document, from)?;
    let failed = |error: rototoon::project::FieldError| Failure::Other(error.to_string());
    let mut traced = document.traced().map_err(failed)?;
    // That the artist emptied a frame is no matter of faint ink.
    let emptied =
        document.drawings().map_err(failed)?.drawings.into_iter().filter(|drawing| drawing.strokes.is_empty());
    let emptied: BTreeSet<FrameNumber> = emptied.map(|drawing| drawing.frame).collect();
    traced.retain(|drawing| !emptied.contains(&drawing.frame));
    if earlier.known > 0 {
        line("note", &format!("{earlier} steps have the strokes and the pictures of an earlier run"));
    }
    let told = pipeline::traced_lines(&traced, &document.scene.footage);
    project::save(document, from, to)?;
    told.iter().for_each(|text| line("note", text));
    Ok(())
}

/// Traces drawings on keys.
fn on_keys(
    given: &ArgMatches,
    mut document: Document,
    keys: &BTreeSet<FrameNumber>,
    options: &Options,
) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let home = project::home(&document, from);
    let cache = arguments::cached(given);
    let (document, empty) = progress::run(given, from, |bar| {
        let cache = cache.as_ref().map(|cache| cache as _);
        let empty = pipeline::trace_drawings(&mut document, &home, keys, options, cache, bar);
        Ok((document, empty.map_err(|error| Failure::of(error, from))?))
    })?;
    project::say_gaps(&document, from)?;
    project::save(document, from, to)?;
    for frame in empty {
        line("note", &format!("frame {frame}: no line was found, so its drawing is empty"));
    }
    Ok(())
}
