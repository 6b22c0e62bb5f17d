//! `rototoon export`: writes files for other programs.

use crate::failure::{Failure, line};
use crate::{arguments, project};
use clap::{ArgMatches, Command};
use rototoon::export::{Motion, SvgOptions};
use rototoon::import::too_large;
use rototoon::pipeline;
use rototoon::project::write_whole;
use rototoon::scene::parameters::Stage;

/// The subcommand.
pub fn command() -> Command {
    Command::new("export")
        .about("Writes the result as animated SVG, as shapes for Nuke, Natron, After Effects or Silhouette, or as a document")
        .arg(arguments::project())
        .arg(arguments::output(
            "FILE",
            "FILE.svg, FILE.nk (Nuke RotoPaint), FILE.ntp (project of Natron), FILE.py (script for Natron), FILE.jsx (script for After Effects), FILE.fxs (Silhouette) or FILE.json",
        ))
        .args(arguments::of_stage(Stage::Export))
}

/// The kind of file: the end of the output's name in small letters.
fn extension(given: &ArgMatches) -> Result<String, Failure> {
    let to = arguments::path(given, "output");
    let extension = to.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_ascii_lowercase();
    if !["svg", "nk", "ntp", "py", "jsx", "fxs", "json"].contains(&extension.as_str()) {
        return Err(Failure::Use(format!(
            "{}: expected a name that ends in .svg, .nk, .ntp, .py, .jsx, .fxs or .json",
            to.display()
        )));
    }
    let unused: &[&str] = match extension.as_str() {
        "svg" => &[],
        "json" => &["motion", "spacing"],
        _ => &["motion"],
    };
    arguments::without(given, unused, &format!("for a .{extension} file"))?;
    Ok(extension)
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
    inputs.file(from).check(to)?;
    if let Some(nothing) = pipeline::nothing_for(&document, &extension) {
        return Err(Failure::Other(format!("{}: {nothing}", from.display())));
    }
    let id = arguments::choice(given, "motion");
    let motion = Motion::from_id(id).ok_or_else(|| Failure::Use(format!("no motion {id:?}")))?;
    let spacing = arguments::number(given, "spacing");
    let text = match extension.as_str() {
        "nk" => pipeline::export_nuke(&document, spacing),
        "ntp" => pipeline::export_natron_project(&document, spacing),
        "py" => pipeline::export_natron(&document, spacing),
        "jsx" => pipeline::export_after_effects(&document, spacing),
        "fxs" => pipeline::export_silhouette(&document, spacing),
        _ => pipeline::export_svg(&document, &SvgOptions { motion, spacing })
            .map_err(|error| Failure::of(error, from))?,
    };
    write_whole(to, text.as_bytes())?;
    let large = if ["ntp", "fxs", "svg"].contains(&extension.as_str()) { too_large(&text) } else { None };
    let warnings = [pipeline::left_out_of_shapes(&document, &extension), pipeline::untracked(&document.scene), large];
    warnings.iter().flatten().for_each(|warning| line("warning", &format!("{}: {warning}", to.display())));
    Ok(())
}
