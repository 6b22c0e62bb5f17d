//! `rototoon tween`: makes the in-betweens of drawings on key frames.

use crate::failure::{Failure, line};
use crate::progress::{self, Part};
use crate::{arguments, project};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches, Command};
use rototoon::geometry::Point;
use rototoon::pipeline;
use rototoon::tween::between::{Leaving, Options};

/// The subcommand.
pub fn command() -> Command {
    Command::new("tween")
        .about("Matches the strokes of drawings on key frames and makes the in-betweens")
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write, with matches and in-betweens"))
        .args(of_movement())
        .arg(arguments::switch(
            "suggest",
            "Says on which frame a breakdown, one more drawing, helps most: the frame that brings the in-betweens \
             nearest to the footage, or else the middle of the span that moves most",
        ))
        .args(arguments::of_run())
}

/// How strokes move.
fn of_movement() -> [Arg; 4] {
    let leaving = PossibleValuesParser::new([
        PossibleValue::new("grow").help("They shrink into their middle, or grow out of it"),
        PossibleValue::new("fade").help("They become transparent"),
        PossibleValue::new("leave").help("They move out of the picture"),
    ]);
    let ends = PossibleValuesParser::new([
        PossibleValue::new("rest").help("Everything rests before the first and after the last drawing"),
        PossibleValue::new("move")
            .help("Everything moves with constant speed before the first and after the last drawing"),
    ]);
    let captured = PossibleValuesParser::new([
        PossibleValue::new("follow").help("Strokes that lie on a tracked part move with it"),
        PossibleValue::new("ignore").help("The drawings alone decide how strokes move"),
    ]);
    [
        Arg::new("arcs")
            .long("arcs")
            .value_name("NUMBER")
            .help("Strength of arcs, from 0 (straight ways) to 1 (turns about the fixed point of a movement)")
            .default_value("0.5")
            .allow_negative_numbers(true)
            .value_parser(arguments::within(0.0, 1.0)),
        Arg::new("leaving")
            .long("leaving")
            .help("How strokes disappear or appear that only one of two drawings has")
            .default_value("grow")
            .value_parser(leaving),
        Arg::new("ends").long("ends").help("How movements begin and end").default_value("rest").value_parser(ends),
        Arg::new("captured")
            .long("captured")
            .help("Whether strokes follow tracked parts of the document")
            .default_value("follow")
            .value_parser(captured),
    ]
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let mut document = project::read(from)?;
    let home = project::home(&document, from);
    project::inputs(&document, from).check(to)?;
    project::check_output(&document, from, to)?;
    let footage = &document.scene.footage;
    let leaving = match arguments::choice(given, "leaving") {
        "fade" => Leaving::Fade,
        "leave" => Leaving::Leave { size: Point::new(footage.width as f64, footage.height as f64) },
        _ => Leaving::Grow,
    };
    let arcs = given.get_one::<f64>("arcs").copied().unwrap_or(Options::default().arcs);
    let options = Options { arcs, leaving, rest: arguments::choice(given, "ends") == "rest", ..Options::default() };
    let follow = arguments::choice(given, "captured") == "follow";
    let (document, notes, suggested) = progress::run(given, from, |bar| {
        let failed = |error| Failure::of(error, from);
        let is_asked = arguments::is_on(given, "suggest");
        let first = Part::first(bar, is_asked);
        let done = pipeline::tween(&mut document, &options, follow, &first).map_err(failed)?;
        let notes = [done.holding(), done.exchanging()];
        if !is_asked {
            return Ok((document, notes, None));
        }
        let pictures = pipeline::frames(&document, &home).map_err(failed)?;
        let found = pipeline::suggest_breakdown(done.shown, Some(&pictures), &Part::second(bar)).map_err(failed)?;
        let nothing = || "no breakdown: nothing lies between the keys".to_owned();
        Ok((document, notes, Some(found.map_or_else(nothing, |found| format!("breakdown: {}", found.sentence())))))
    })?;
    project::save(document, from, to)?;
    notes.iter().flatten().chain(&suggested).for_each(|text| line("note", text));
    Ok(())
}
