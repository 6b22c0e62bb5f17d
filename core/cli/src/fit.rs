//! `rototoon fit`: fits quadratic B-splines with few guiding points to lines of points.

use crate::failure::Failure;
use crate::{arguments, progress};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::fit::{Options, Preset};
use rototoon::pipeline;
use rototoon::project::curves::Curves;
use rototoon::project::output::check_writable;
use rototoon::project::{Inputs, write_whole};
use std::path::PathBuf;

/// The subcommand.
pub fn command() -> Command {
    Command::new("fit")
        .about("Fits quadratic B-splines with few guiding points to lines of points, within a tolerance")
        .arg(
            Arg::new("curves")
                .value_name("CURVES")
                .help("The lines: {\"curves\": [{\"closed\": true, \"points\": [[x, y], …]}]}")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(arguments::output("OUT", "The file to write: the same curves with guides, corners and max_error"))
        .arg(
            Arg::new("tolerance")
                .long("tolerance")
                .value_name("PX")
                .help("Largest distance in pixels from the line to the curve and from the curve to the line")
                .required(true)
                .allow_negative_numbers(true)
                .value_parser(tolerance),
        )
        .arg(
            Arg::new("fit_preset")
                .long("preset")
                .value_name("preset")
                .help("The method that fits")
                .default_value("rototoon")
                .value_parser(PossibleValuesParser::new([
                    PossibleValue::new("rototoon").help("Fewest guiding points"),
                    PossibleValue::new("yang1986").help("Yang et al. 1986"),
                ])),
        )
        .args(arguments::of_run())
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("expected a positive number of pixels".into()),
    }
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "curves"), arguments::path(given, "output"));
    let id = arguments::choice(given, "fit_preset");
    let preset = Preset::from_id(id).ok_or_else(|| Failure::Use(format!("no preset {id:?}")))?;
    let tolerance = given.get_one::<f64>("tolerance").copied().unwrap_or(0.0);
    let curves = Curves::load(from).map_err(|error| Failure::Other(error.to_string()))?;
    Inputs::default().file(from).check(to)?;
    check_writable(to)?;
    let options = Options { tolerance, preset };
    let text = progress::run(given, from, |bar| {
        pipeline::fit_curves(&curves, &options, bar).map_err(|error| Failure::of(error, from))
    })?;
    Ok(write_whole(to, text.as_bytes())?)
}
