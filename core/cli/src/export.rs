//! `rototoon export`: writes files for other programs.

use crate::failure::{Failure, line};
use crate::{arguments, project};
use clap::{Arg, ArgMatches, Command};
use rototoon::export::{Detail, Motion, ShapeOptions, SvgOptions, svg};
use rototoon::import::too_large;
use rototoon::pipeline::{self, Excerpt};
use rototoon::project::output::check_writable;
use rototoon::project::seen::Made;
use rototoon::project::{Document, Inputs, write_whole};
use rototoon::scene::parameters::Stage;
use rototoon::scene::{FrameNumber, FramePattern};
use std::path::Path;

/// The subcommand.
pub fn command() -> Command {
    Command::new("export")
        .about("Writes the result as animated SVG, as shapes for Nuke, Natron, After Effects, Silhouette or Fusion, or as a document")
        .arg(arguments::project())
        .arg(arguments::output(
            "FILE",
            "FILE.svg, FILE_%04d.svg (a file for each frame), FILE.nk (Nuke RotoPaint), FILE.ntp (project of Natron), FILE.py (script for Natron), FILE.jsx (script for After Effects), FILE.fxs (Silhouette), FILE.setting (Fusion) or FILE.json",
        ))
        .args(arguments::of_stage(Stage::Export))
        .arg(
            Arg::new("bezier")
                .long("bezier")
                .value_name("PX")
                .help("Writes snapped parts as Bézier curves with handles, within this many pixels of their paths: few points, the same ones on every frame. Instead of --spacing; 0.5 is a good start")
                .conflicts_with("spacing")
                .value_parser(arguments::within(0.05, 100.0)),
        )
        .arg(arguments::frames())
        .arg(arguments::frame_offset(
            "What is added to the numbers of the frames: with 1000, frame 1 becomes 1001. Not for an animated .svg and for .jsx, which count from their own beginning",
        ))
        .arg(arguments::parts("Writes only the part of this name; may be given several times"))
}

/// The kind of file: the end of the output's name in small letters.
fn extension(given: &ArgMatches) -> Result<String, Failure> {
    let to = arguments::path(given, "output");
    let extension = to.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_ascii_lowercase();
    if !["svg", "nk", "ntp", "py", "jsx", "fxs", "setting", "json"].contains(&extension.as_str()) {
        return Err(Failure::Use(format!(
            "{}: expected a name that ends in .svg, .nk, .ntp, .py, .jsx, .fxs, .setting or .json",
            to.display()
        )));
    }
    let numbered = pattern(to);
    if numbered.is_some() && extension != "svg" {
        return Err(Failure::Use(format!(
            "{}: found a frame number, expected a plain name: a .{extension} file holds all frames",
            to.display()
        )));
    }
    let unused: &[&str] = match extension.as_str() {
        "svg" if numbered.is_none() => &[],
        "json" => &["motion", "spacing"],
        _ => &["motion"],
    };
    arguments::without(given, unused, &format!("for a .{extension} file"))?;
    if let Some(bezier) = bezier(given).filter(|_| extension == "json") {
        return Err(Failure::Use(format!(
            "found --bezier {bezier}: expected no such option for a .json file, which keeps the snapped paths"
        )));
    }
    let offset = arguments::offset(given);
    if offset != 0 && numbered.is_none() && ["svg", "jsx"].contains(&extension.as_str()) {
        return Err(Failure::Use(format!(
            "found --frame-offset {offset}: expected no such option for a .{extension} file, which counts from its own beginning"
        )));
    }
    if extension == "json" && excerpt(given) != Excerpt::default() {
        return Err(Failure::Use(
            "found --frames, --parts or --frame-offset: expected no such option for a .json file, which has the whole document".into(),
        ));
    }
    Ok(extension)
}

/// The pattern of the names of files for each frame; `None` where all frames go into one file. Percent signs of folders are themselves.
fn pattern(to: &Path) -> Option<FramePattern> {
    FramePattern::parse(to.file_name()?.to_str()?).ok()
}

/// How far Bézier curves may be from snapped paths; `None` for points with straight sides.
fn bezier(given: &ArgMatches) -> Option<f64> {
    given.get_one::<f64>("bezier").copied()
}

/// What is asked for of the document.
fn excerpt(given: &ArgMatches) -> Excerpt {
    Excerpt { parts: arguments::names(given), frames: arguments::range(given), offset: arguments::offset(given) }
}

/// What is wrong with the options, whatever the document.
pub fn check(given: &ArgMatches) -> Result<(), String> {
    extension(given).map(drop).map_err(|failure| failure.to_string())
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let extension = extension(given)?;
    let document = project::load_either(from)?;
    let inputs = project::inputs(&document, from);
    if extension == "json" {
        inputs.check(to)?;
        return project::save(document, from, to);
    }
    let (inputs, asked) = (inputs.file(from), excerpt(given));
    if let Some(pattern) = pattern(to) {
        return numbered(given, &document, &pattern, &inputs);
    }
    inputs.check(to)?;
    let whole = document.scene.footage.clone();
    // Before frames are left out or get other numbers.
    let changed = changed(given, &document)?;
    let outside = outside(&document, &asked);
    let pixel_aspect = pipeline::pixel_aspect(&document, &project::home(&document, from));
    let mut document = pipeline::excerpt(&document, &asked).map_err(|error| Failure::of(error, from))?;
    if let Some(nothing) = pipeline::nothing_for(&document, &extension) {
        let chosen =
            if asked.parts.is_some() || asked.frames.is_some() { "of the parts and frames asked for: " } else { "" };
        return Err(Failure::Other(format!("{}: {chosen}{nothing}", from.display())));
    }
    if extension == "jsx" {
        // Its masks go to the layer of the whole footage.
        document.scene.footage = whole;
    }
    let text = written(given, &document, pixel_aspect)?;
    write_whole(to, text.as_bytes())?;
    let large = if ["ntp", "fxs", "svg"].contains(&extension.as_str()) { too_large(&text) } else { None };
    let (left_out, scene) = (pipeline::left_out_of_shapes(&document, &extension), &document.scene);
    let squeezed = pipeline::squeezed(pixel_aspect, &extension);
    let warnings = [outside, left_out, pipeline::untracked(scene), pipeline::outdated(scene), squeezed, large];
    warn(to, warnings.iter().flatten().chain(&changed));
    Ok(())
}

/// The text of the file.
fn written(given: &ArgMatches, document: &Document, pixel_aspect: f64) -> Result<String, Failure> {
    let id = arguments::choice(given, "motion");
    let motion = Motion::from_id(id).ok_or_else(|| Failure::Use(format!("no motion {id:?}")))?;
    let (spacing, bezier) = (arguments::number(given, "spacing"), bezier(given));
    let detail = bezier.map_or(Detail::Spacing(spacing), Detail::Bezier);
    let options = ShapeOptions { detail, pixel_aspect };
    Ok(match extension(given)?.as_str() {
        "nk" => pipeline::export_nuke(document, options),
        "ntp" => pipeline::export_natron_project(document, detail),
        "py" => pipeline::export_natron(document, detail),
        "jsx" => pipeline::export_after_effects(document, options),
        "fxs" => pipeline::export_silhouette(document, options),
        "setting" => pipeline::export_fusion(document, options),
        _ => drawn(given, document, &SvgOptions { motion, spacing, bezier })?,
    })
}

/// What is told of contours that no frame of the footage has. Whoever asks for frames knows that others are left out.
fn outside(document: &Document, asked: &Excerpt) -> Option<String> {
    asked.frames.is_none().then(|| pipeline::outside(&document.scene)).flatten()
}

/// What is told of pictures that are others than when they were looked at.
fn changed(given: &ArgMatches, document: &Document) -> Result<Vec<String>, Failure> {
    let (from, asked) = (arguments::path(given, "project"), excerpt(given));
    let draws = extension(given)? == "svg" && asked.parts.is_none();
    let made = if draws { &Made::ALL[..] } else { &[Made::Tracks] };
    pipeline::changed(document, &project::home(document, from), made, asked.frames.as_ref())
        .map_err(|error| Failure::of(error, from))
}

fn warn<'a>(to: &Path, warnings: impl Iterator<Item = &'a String>) {
    warnings.for_each(|warning| line("warning", &format!("{}: {warning}", to.display())));
}

/// SVG of a document. Regions and strokes belong to no part.
fn drawn(given: &ArgMatches, document: &Document, options: &SvgOptions) -> Result<String, Failure> {
    if arguments::names(given).is_some() {
        return Ok(svg(&document.scene, options));
    }
    pipeline::export_svg(document, options).map_err(|error| Failure::of(error, arguments::path(given, "project")))
}

/// Writes an SVG file for each frame, for programs that play no animations.
fn numbered(given: &ArgMatches, document: &Document, pattern: &FramePattern, inputs: &Inputs) -> Result<(), Failure> {
    let (from, to, asked) = (arguments::path(given, "project"), arguments::path(given, "output"), excerpt(given));
    let of = |asked: &Excerpt| pipeline::excerpt(document, asked).map_err(|error| Failure::of(error, from));
    // Both say which numbers the files have, and whether there is anything to write.
    let named = of(&asked)?.scene.footage;
    let complete = of(&Excerpt { offset: 0, ..asked.clone() })?;
    if let Some(nothing) = pipeline::nothing_for(&complete, "svg") {
        return Err(Failure::Other(format!("{}: {nothing}", from.display())));
    }
    let file = |number| to.with_file_name(pattern.path(number));
    (named.first..=named.last).try_for_each(|number| inputs.check(&file(number)))?;
    check_writable(&file(named.first))?;
    let options =
        SvgOptions { motion: Motion::Hold, spacing: arguments::number(given, "spacing"), bezier: bezier(given) };
    let written = |frame: FrameNumber| -> Result<(), Failure> {
        let one = of(&Excerpt { frames: Some(frame..=frame), offset: 0, parts: asked.parts.clone() })?;
        let number = frame - complete.scene.footage.first + named.first;
        Ok(write_whole(&file(number), drawn(given, &one, &options)?.as_bytes())?)
    };
    (complete.scene.footage.first..=complete.scene.footage.last).try_for_each(written)?;
    let (left_out, scene) = (pipeline::left_out_of_shapes(&complete, "svg"), &complete.scene);
    let outside = outside(document, &asked);
    let squeezed = pipeline::squeezed(pipeline::pixel_aspect(document, &project::home(document, from)), "svg");
    let warnings = [outside, left_out, squeezed, pipeline::untracked(scene), pipeline::outdated(scene)];
    warn(to, warnings.iter().flatten().chain(&changed(given, document)?));
    Ok(())
}
