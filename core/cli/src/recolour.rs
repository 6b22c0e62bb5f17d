//! `rototoon recolour`: a colour of paint that becomes another one from a drawing on.

use crate::failure::{Failure, line};
use crate::{arguments, project};
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use rototoon::pipeline;
use rototoon::project::Document;
use rototoon::project::fills::Hue;
use rototoon::project::recolours::Recolour;
use rototoon::scene::{Colour, FrameError, FrameNumber};
use std::path::Path;

/// The subcommand.
pub fn command() -> Command {
    let frame = |name: &'static str, help: &'static str| {
        Arg::new(name)
            .long(name)
            .value_name("N")
            .help(help)
            .allow_negative_numbers(true)
            .value_parser(value_parser!(FrameNumber))
    };
    let colour = |name: &'static str, help: &'static str| {
        Arg::new(name).long(name).value_name("COLOUR").help(help).required(true)
    };
    Command::new("recolour")
        .about(
            "Makes a colour of paint another one from a frame on, up to a frame or between two, on all regions that have it: a coat that gets wet. \
             Painted regions change at once, and `fill` keeps it",
        )
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write"))
        .arg(colour("from", "The old colour: its name, or #rrggbb if it has none"))
        .arg(colour("to", "The new colour: its name, or #rrggbb for one without a name"))
        .arg(
            Arg::new("look")
                .long("look")
                .value_name("#rrggbb")
                .help("How the new colour looks, if it is a name that the document does not know")
                .value_parser(|text: &str| look(text).ok_or("expected a colour as #rrggbb")),
        )
        .arg(frame("first", "The first frame [default: that of the footage]"))
        .arg(frame("last", "The last frame [default: that of the footage]"))
        .arg(
            Arg::new("remove")
                .long("remove")
                .help("Removes such entries instead: those with these colours, and with these frames if some are given. Run `fill` afterwards")
                .conflicts_with("look")
                .action(ArgAction::SetTrue),
        )
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let mut document = project::load_drawn(from)?;
    project::inputs(&document, from).check(to)?;
    project::check_output(&document, from, to)?;
    let told = if given.get_flag("remove") { remove(given, &mut document)? } else { add(given, &mut document)? };
    project::save(document, from, to)?;
    line("note", &told);
    Ok(())
}

fn wrong(given: &ArgMatches, option: &str, why: &str) -> Failure {
    Failure::Use(format!("{}: --{option}: {why}", arguments::path(given, "project").display()))
}

/// Adds an entry, and says what it has changed.
fn add(given: &ArgMatches, document: &mut Document) -> Result<String, Failure> {
    let path = arguments::path(given, "project");
    let known = pipeline::colours(document).map_err(|error| Failure::of(error, path))?;
    let text = arguments::choice(given, "from");
    let from = find(&known, text).ok_or_else(|| {
        let expected = format!("found {text:?}, expected a colour of the paint: {}", pipeline::named_colours(&known));
        wrong(given, "from", &expected)
    })?;
    let to = new(given, document, &known, path)?;
    if from.is_same(&to) {
        return Err(wrong(given, "to", &format!("found {to}, expected another colour than that of --from")));
    }
    let [first, last] = ["first", "last"].map(|name| given.get_one::<FrameNumber>(name).copied());
    let footage = &document.scene.footage;
    for (option, frame) in [("first", first), ("last", last)] {
        if let Some(frame) = frame.filter(|frame| !(footage.first..=footage.last).contains(frame)) {
            let outside = FrameError::Outside { frame, first: footage.first, last: footage.last };
            return Err(wrong(given, option, &outside.to_string()));
        }
    }
    if let (Some(first), Some(last)) = (first, last)
        && first > last
    {
        return Err(wrong(given, "last", &format!("found {last}, expected at least {first}, the first frame")));
    }
    let entry = Recolour { from, to, first, last };
    let changed = pipeline::recolour(document, &entry).map_err(|error| Failure::of(error, path))?;
    Ok(match changed {
        0 => format!("{entry}: no region is painted so yet; `rototoon fill` paints them"),
        1 => format!("{entry}: 1 painted region"),
        more => format!("{entry}: {more} painted regions"),
    })
}

/// The new colour.
fn new(given: &ArgMatches, document: &Document, known: &[Hue], path: &Path) -> Result<Hue, Failure> {
    let text = arguments::choice(given, "to");
    let asked = given.get_one::<Colour>("look").copied();
    let palette = document.palette().map_err(|error| Failure::Other(format!("{}: {error}", path.display())))?;
    let own = find(known, text)
        .or_else(|| palette.get(text).map(|&colour| Hue { name: Some(text.to_owned()), colour }))
        .or_else(|| look(text).map(|colour| Hue { name: None, colour }));
    match (own, asked) {
        (Some(own), None) => Ok(own),
        (None, Some(colour)) if !text.is_empty() => Ok(Hue { name: Some(text.to_owned()), colour }),
        (Some(own), Some(_)) => {
            Err(wrong(given, "look", &format!("{own} has a look already: change it in the document's palette")))
        }
        (None, _) => {
            let known = pipeline::named_colours(known);
            Err(wrong(
                given,
                "to",
                &format!("found {text:?}, expected a colour of the paint ({known}), or a new name with --look"),
            ))
        }
    }
}

/// Removes entries, and says which.
fn remove(given: &ArgMatches, document: &mut Document) -> Result<String, Failure> {
    let path = arguments::path(given, "project").display().to_string();
    let failed = |error| Failure::Other(format!("{path}: {error}"));
    let all = document.recolours().map_err(failed)?;
    let [first, last] = ["first", "last"].map(|name| given.get_one::<FrameNumber>(name).copied());
    let same = |hue: &Hue, option: &str| find(std::slice::from_ref(hue), arguments::choice(given, option)).is_some();
    let meant = |own: &Recolour| {
        let framed = (first.is_none() || own.first == first) && (last.is_none() || own.last == last);
        framed && same(&own.from, "from") && same(&own.to, "to")
    };
    let (places, told): (Vec<usize>, Vec<String>) =
        all.list().iter().enumerate().filter(|(_, own)| meant(own)).map(|(k, own)| (k, own.to_string())).unzip();
    if places.is_empty() {
        let there: Vec<String> = all.list().iter().map(ToString::to_string).collect();
        let there = if there.is_empty() { "the document has none".to_owned() } else { there.join("; ") };
        return Err(wrong(given, "remove", &format!("found no such entry: {there}")));
    }
    document.remove_recolours(&places).map_err(failed)?;
    Ok(format!("removed: {}; run `rototoon fill` to paint the old colour again", told.join("; ")))
}

/// The colour that a text means: one of this name, or one without a name that looks so.
fn find(known: &[Hue], text: &str) -> Option<Hue> {
    let named = known.iter().find(|own| own.name.as_deref() == Some(text));
    let bytes = |colour: Colour| colour.map(|channel| (channel * 255.0).round() as u8);
    let alike = |own: &&Hue| own.name.is_none() && look(text).is_some_and(|look| bytes(look) == bytes(own.colour));
    named.or_else(|| known.iter().find(alike)).cloned()
}

/// Reads `#rrggbb`.
fn look(text: &str) -> Option<Colour> {
    let digits = text
        .strip_prefix('#')
        .filter(|digits| digits.len() == 6 && digits.bytes().all(|byte| byte.is_ascii_hexdigit()))?;
    let number = u32::from_str_radix(digits, 16).ok()?;
    Some([16, 8, 0].map(|shift| f32::from((number >> shift) as u8) / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_found_by_name_or_look() {
        let hue = |name: Option<&str>, colour| Hue { name: name.map(Into::into), colour };
        let known = [hue(Some("#00ff00"), [1.0, 0.0, 0.0]), hue(None, [0.2, 0.4, 0.9]), hue(Some("coat"), [0.0; 3])];
        assert_eq!(find(&known, "#3366e6"), Some(known[1].clone()), "to the nearest of 256 steps");
        assert_eq!(find(&known, "#00ff00"), Some(known[0].clone()), "a name counts first");
        assert_eq!(find(&known, "coat"), Some(known[2].clone()));
        assert_eq!((find(&known, "#000000"), find(&known, "#00000"), look("#+12345")), (None, None, None));
    }
}
