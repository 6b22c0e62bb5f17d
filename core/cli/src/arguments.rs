//! Command-line options made from the core's list of parameters, and functions that read their values.

use crate::failure::Failure;
use crate::tell;
use clap::builder::{PathBufValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, value_parser};
use rototoon::lines::ink;
use rototoon::pipeline::cache::FileCache;
use rototoon::project::schema::MAX_FRAME_NUMBER;
use rototoon::scene::parameters::{Kind, Parameter, Stage, find, of};
use rototoon::scene::{Colour, FrameNumber};
use std::ffi::OsString;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// The argument for the project document.
pub fn project() -> Arg {
    Arg::new("project")
        .value_name("PROJECT")
        .help("The project document")
        .required(true)
        .value_parser(value_parser!(PathBuf))
}

/// The option for the file or files to write.
pub fn output(name: &'static str, help: &'static str) -> Arg {
    Arg::new("output")
        .short('o')
        .long("output")
        .value_name(name)
        .help(help)
        .required(true)
        .value_parser(PathBufValueParser::new().try_map(named))
}

/// A path to write. Files appear whole or not at all, so nothing is written to standard output.
fn named(path: PathBuf) -> Result<PathBuf, &'static str> {
    if path == Path::new("-") { Err("expected a file; for a file of this name write ./-") } else { Ok(path) }
}

/// One option for each parameter of a stage.
pub fn of_stage(stage: Stage) -> impl Iterator<Item = Arg> {
    of(stage).map(option)
}

/// The options of long work: its threads, and how it tells its progress.
pub fn of_run() -> impl Iterator<Item = Arg> {
    of_stage(Stage::Run).chain([tell::option()])
}

fn option(parameter: &'static Parameter) -> Arg {
    let arg = Arg::new(parameter.id).long(parameter.id.replace('_', "-")).help(parameter.help);
    match parameter.kind {
        Kind::Choice { default, choices } => {
            let values = choices.iter().map(|choice| PossibleValue::new(choice.id).help(choice.label));
            arg.default_value(default).value_parser(PossibleValuesParser::new(values))
        }
        Kind::Integer { default, min, max } => {
            arg.value_name("N").default_value(default.to_string()).value_parser(value_parser!(i64).range(min..=max))
        }
        Kind::Number { default, min, max, unit } => {
            let name = if unit.is_empty() { "NUMBER".to_owned() } else { unit.to_uppercase() };
            arg.value_name(name).default_value(default.to_string()).value_parser(within(min, max))
        }
        Kind::Flag { default } => {
            let parser = PossibleValuesParser::new(["on", "off"]).map(|text| text == "on");
            arg.value_name("on|off")
                .hide_possible_values(true)
                .default_value(if default { "on" } else { "off" })
                .value_parser(parser)
                .action(ArgAction::Set)
        }
    }
}

/// Reads a number from `min` to `max`.
pub fn within(min: f64, max: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match text.parse::<f64>() {
        Ok(value) if (min..=max).contains(&value) => Ok(value),
        _ => Err(format!("expected a number from {min} to {max}")),
    }
}

/// The path given for the project or the output.
pub fn path<'a>(arguments: &'a ArgMatches, id: &str) -> &'a Path {
    arguments.get_one::<PathBuf>(id).map_or(Path::new(""), PathBuf::as_path)
}

/// The id of the choice given for a parameter.
pub fn choice<'a>(arguments: &'a ArgMatches, id: &str) -> &'a str {
    arguments.get_one::<String>(id).map_or("", String::as_str)
}

/// The number given for a parameter.
pub fn number(arguments: &ArgMatches, id: &str) -> f64 {
    let default = match find(id).map(|parameter| parameter.kind) {
        Some(Kind::Number { default, .. }) => default,
        _ => 0.0,
    };
    arguments.get_one::<f64>(id).copied().unwrap_or(default)
}

/// An option that is off unless it is given. It may have a value, as in manifests of batches, where each option has one.
pub fn switch(id: &'static str, help: &'static str) -> Arg {
    Arg::new(id)
        .long(id)
        .value_name("WHETHER")
        .help(help)
        .num_args(0..=1)
        .require_equals(true)
        .default_value("off")
        .default_missing_value("on")
        .value_parser(["on", "off"])
}

/// Whether a switch is on.
pub fn is_on(arguments: &ArgMatches, id: &str) -> bool {
    choice(arguments, id) == "on"
}

/// What is wrong with words, in one line: with the values that are expected.
pub fn in_one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default().trim_start_matches("error: ");
    let expected = lines.next().map(str::trim).filter(|line| line.starts_with('['));
    expected.map_or_else(|| first.to_owned(), |expected| format!("{first} {expected}"))
}

/// Whether a flag is on.
pub fn flag(arguments: &ArgMatches, id: &str) -> bool {
    arguments.get_one::<bool>(id).copied().unwrap_or(false)
}

/// An option as it is written, if its value is not the one without it; `None` otherwise.
fn changed(arguments: &ArgMatches, id: &str) -> Option<String> {
    let value = match find(id)?.kind {
        Kind::Flag { default } => {
            Some(flag(arguments, id)).filter(|own| *own != default).map(|on| if on { "on" } else { "off" }.into())
        }
        Kind::Number { default, .. } => {
            Some(number(arguments, id)).filter(|own| *own != default).map(|own| own.to_string())
        }
        Kind::Integer { default, .. } => {
            arguments.get_one::<i64>(id).filter(|own| **own != default).map(i64::to_string)
        }
        Kind::Choice { default, .. } => Some(choice(arguments, id)).filter(|own| *own != default).map(str::to_owned),
    };
    Some(format!("--{} {}", id.replace('_', "-"), value?))
}

/// Refuses options that would change nothing. `with` tells what else was given.
pub fn without(arguments: &ArgMatches, ids: &[&str], with: &str) -> Result<(), Failure> {
    match ids.iter().find_map(|id| changed(arguments, id)) {
        None => Ok(()),
        Some(found) => {
            Err(Failure::Use(format!("found {found}: expected no such option {with}, where it changes nothing")))
        }
    }
}

/// `--cache FOLDER`. `help` says what is kept there.
pub fn cache(help: &str) -> Arg {
    let where_else = "By default it is that of the variable ROTOTOON_CACHE, or the user's folder for caches; \"none\" computes everything";
    Arg::new("cache")
        .long("cache")
        .value_name("FOLDER")
        .help(format!("{help}. {where_else}"))
        .value_parser(value_parser!(OsString))
}

/// The cache that was asked for.
pub fn cached(arguments: &ArgMatches) -> Option<FileCache> {
    FileCache::of_user(arguments.get_one::<OsString>("cache").map(OsString::as_os_str))
}

/// `--frames A-B` of work on drawings.
pub fn frames() -> Arg {
    Arg::new("frames")
        .long("frames")
        .value_name("A-B")
        .help("First and last frame, or one frame [default: all frames of the footage]")
        .allow_hyphen_values(true)
        .value_parser(crate::render::range)
}

/// `--parts NAME`, once for each part. `help` says what becomes of it.
pub fn parts(help: &'static str) -> Arg {
    Arg::new("parts").long("parts").value_name("NAME").help(help).action(ArgAction::Append)
}

/// The names of the parts that were asked for; `None` takes all.
pub fn names(arguments: &ArgMatches) -> Option<Vec<String>> {
    arguments.get_many::<String>("parts").map(|names| names.cloned().collect())
}

/// The frames that were asked for; `None` takes all.
pub fn range(arguments: &ArgMatches) -> Option<RangeInclusive<FrameNumber>> {
    arguments.get_one::<RangeInclusive<FrameNumber>>("frames").cloned()
}

/// `--frame-offset N`: what is added to frames of the document. `help` says where.
pub fn frame_offset(help: &'static str) -> Arg {
    let most = MAX_FRAME_NUMBER;
    Arg::new("frame-offset")
        .long("frame-offset")
        .value_name("N")
        .help(help)
        .default_value("0")
        .allow_negative_numbers(true)
        .value_parser(value_parser!(FrameNumber).range(-most..=most))
}

/// The offset that was given.
pub fn offset(arguments: &ArgMatches) -> FrameNumber {
    arguments.get_one::<FrameNumber>("frame-offset").copied().unwrap_or(0)
}

/// `--drawings FRAMES`: the frames of drawings on keys.
pub fn drawings(help: &'static str) -> Arg {
    Arg::new("drawings")
        .long("drawings")
        .value_name("FRAMES")
        .help(help)
        .allow_hyphen_values(true)
        .value_delimiter(',')
        .conflicts_with("frames")
        .value_parser(value_parser!(FrameNumber))
}

/// `--sensitivity NUMBER` of what finds ink.
pub fn sensitivity() -> Arg {
    Arg::new("sensitivity")
        .long("sensitivity")
        .value_name("NUMBER")
        .help("Sensitivity to faint ink, from 0.1 to 10: with 2, ink may be half as dark as usual")
        .default_value("1")
        .value_parser(within(0.1, 10.0))
}

/// `--leave-out COLOURS` of what finds ink.
pub fn leave_out() -> Arg {
    Arg::new("leave-out")
        .long("leave-out")
        .value_name("COLOURS")
        .help(
            "Leaves out lines of a coloured pencil, such as construction lines, in its lighter and darker shades: blue (non-photo blue), red, green, \
             orange, violet, or a colour as #rrggbb, as it looks on white paper. Several are parted by commas",
        )
        .value_delimiter(',')
        .value_parser(pencil)
}

/// The colours of `--leave-out`.
pub fn left_out(given: &ArgMatches) -> Vec<Colour> {
    given.get_many::<Colour>("leave-out").unwrap_or_default().copied().collect()
}

/// A colour with a hue, by name or as `#rrggbb`.
fn pencil(text: &str) -> Result<Colour, String> {
    let named = [
        ("blue", 0xa4_dd_ed),
        ("red", 0xe6_5a_4d),
        ("green", 0x66_b3_66),
        ("orange", 0xff_99_33),
        ("violet", 0xa0_70_d0),
    ];
    let number = match named.iter().find(|(name, _)| *name == text) {
        Some((_, number)) => Some(*number),
        None => text
            .strip_prefix('#')
            .filter(|digits| digits.len() == 6)
            .and_then(|digits| u32::from_str_radix(digits, 16).ok()),
    };
    let expected = "expected blue, red, green, orange, violet, or a colour as #rrggbb";
    let number = number.ok_or_else(|| expected.to_owned())?;
    let colour = [16, 8, 0].map(|shift| f32::from((number >> shift) as u8) / 255.0);
    ink::can_leave_out(colour)
        .then_some(colour)
        .ok_or_else(|| "a grey cannot be told from the lines: expected a colour with a hue".to_owned())
}
