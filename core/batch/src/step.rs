//! The steps of a shot. Each is a subcommand of the command line program, described once: as its words.
//!
//! A step reads the newest document of its shot: the project, or what an earlier step wrote. The fields of a step in the
//! manifest are the options of the subcommand, with `_` for `-`. `to` is the name of what it writes, without a folder; so is
//! `report` of `track`. A step writes nothing else, so that no file is written that the record does not know. Which
//! folder keeps what was found is said by the worker's machine and not by the manifest, which may come from somebody else.

use crate::names::safe_name;
use rototoon::project::described;
use rototoon::scene::{FramePattern, PatternError};
use serde_json::Value;

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Lists problems; writes nothing.
    Check,
    /// Tracks contours.
    Track,
    /// Snaps contours to the ink.
    Snap,
    /// Traces drawn lines as strokes.
    Trace,
    /// Paints line drawings by clicks.
    Fill,
    /// Makes in-betweens.
    Tween,
    /// Draws pictures.
    Render,
    /// Writes shapes for other programs.
    Export,
}

/// Each kind with its subcommand and the document that it writes; those without one need `to` or write nothing.
const KINDS: [(Kind, &str, Option<&str>); 8] = [
    (Kind::Check, "check", None),
    (Kind::Track, "track", Some("tracked.json")),
    (Kind::Snap, "snap", Some("snapped.json")),
    (Kind::Trace, "trace", Some("traced.json")),
    (Kind::Fill, "fill", Some("painted.json")),
    (Kind::Tween, "tween", Some("tweened.json")),
    (Kind::Render, "render", None),
    (Kind::Export, "export", None),
];

/// Names that belong to the batch.
const RESERVED: [&str; 2] = ["batch.json", "log.txt"];

/// A step of a shot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// What it does.
    pub kind: Kind,
    /// Name or pattern of what it writes.
    pub output: Option<String>,
    /// Name of the report that `track` also writes.
    pub report: Option<String>,
    /// Options of the subcommand, as words.
    pub options: Vec<String>,
}

impl Step {
    /// Reads a step of a manifest.
    ///
    /// # Errors
    ///
    /// Field, what was found and what was expected.
    pub fn read(value: &Value) -> Result<Self, String> {
        let Value::Object(fields) = value else {
            return Err(format!("found {}, expected an object such as {{\"do\": \"track\"}}", described(Some(value))));
        };
        let name = fields.get("do").and_then(Value::as_str).unwrap_or_default();
        let Some((kind, _, default)) = KINDS.into_iter().find(|(_, known, _)| *known == name) else {
            let known: Vec<_> = KINDS.iter().map(|(_, name, _)| *name).collect();
            return Err(format!("do: found {name:?}, expected one of {}", known.join(", ")));
        };
        let output = output(kind, default, fields.get("to"))?;
        let report =
            fields.get("report").filter(|_| kind == Kind::Track).map(|name| report(name, &output)).transpose()?;
        let known = |name: &str| name == "do" || name == "to" || (name == "report" && report.is_some());
        let mut options = Vec::new();
        for (name, value) in fields.iter().filter(|(name, _)| !known(name)) {
            add_option(&mut options, name, value)?;
        }
        Ok(Self { kind, output, report, options })
    }

    /// The subcommand.
    pub fn name(&self) -> &'static str {
        KINDS.iter().find(|(kind, ..)| *kind == self.kind).map_or("", |(_, name, _)| name)
    }

    /// Whether it works on the frames of the footage.
    pub fn reads_footage(&self) -> bool {
        !matches!(self.kind, Kind::Export | Kind::Tween)
    }

    /// Whether other frames may give another result. An export has the shape of their pixels, and says whether they are those that were tracked.
    pub fn depends_on_footage(&self) -> bool {
        self.kind != Kind::Tween
    }

    /// Whether what it writes may name the frames of the footage.
    pub fn names_footage(&self) -> bool {
        self.writes_document() || self.kind == Kind::Export
    }

    /// Whether it draws all frames of the document under a plain name, which is enough for one.
    pub fn names_one_picture(&self) -> bool {
        let plain = |name: &String| matches!(FramePattern::parse(name), Err(PatternError::NoNumber { .. }));
        let all = !self.options.iter().any(|option| option.starts_with("--frames="));
        self.kind == Kind::Render && all && self.output.as_ref().is_some_and(plain)
    }

    /// Whether it writes a file of this name. Numbers count as the same.
    pub fn writes(&self, name: &str) -> bool {
        self.output.iter().chain(&self.report).any(|own| shape(own) == shape(name))
    }

    /// Whether it writes a document that later steps read.
    pub fn writes_document(&self) -> bool {
        matches!(self.kind, Kind::Track | Kind::Snap | Kind::Trace | Kind::Fill | Kind::Tween)
    }

    /// The words of the command that reads `document`. The output's name gets `prefix` before it.
    pub fn words(&self, document: &str, prefix: &str) -> Vec<String> {
        let mut words = vec![self.name().to_owned(), document.to_owned()];
        if let Some(output) = &self.output {
            // Pictures are named by a pattern as a whole, and the folder is no part of the artist's.
            let prefix = if self.kind == Kind::Render { prefix.replace('%', "%%") } else { prefix.to_owned() };
            words.extend(["-o".to_owned(), format!("{prefix}{output}")]);
        }
        words.extend(self.report.iter().map(|report| format!("--report={prefix}{report}")));
        words.extend(self.options.iter().cloned());
        words
    }
}

fn output(kind: Kind, default: Option<&str>, to: Option<&Value>) -> Result<Option<String>, String> {
    let example = match kind {
        Kind::Check if to.is_some() => return Err("to: found a name, expected none: `check` writes nothing".into()),
        Kind::Check => return Ok(None),
        Kind::Render => "matte_%04d.exr",
        Kind::Export => "shapes.svg",
        Kind::Track | Kind::Snap | Kind::Trace | Kind::Fill | Kind::Tween => "result.json",
    };
    let Some(name) = to.map_or(default, Value::as_str) else {
        return Err(format!("to: found {}, expected the name of what is written, such as {example:?}", described(to)));
    };
    let is_document = name.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("json"));
    if !matches!(kind, Kind::Render | Kind::Export) && !is_document {
        return Err(format!(
            "to: found {name:?}, expected a name that ends with \".json\": the step writes a document"
        ));
    }
    own_name("to", name).map(Some)
}

/// The name of a report, beside the output of the same step.
fn report(name: &Value, output: &Option<String>) -> Result<String, String> {
    let example = "report.json";
    let Some(text) = name.as_str() else {
        let found = described(Some(name));
        return Err(format!("report: found {found}, expected the name of what is written, such as {example:?}"));
    };
    if output.as_ref().is_some_and(|output| shape(output) == shape(text)) {
        return Err(format!("report: found {text:?}, expected another name: the step writes its document there"));
    }
    own_name("report", text)
}

/// Checks the name of a file that a step writes into the shot's folder.
fn own_name(field: &str, name: &str) -> Result<String, String> {
    if let Err(expected) = safe_name(name) {
        return Err(format!("{field}: found {name:?}, expected {expected}: it is written into the shot's folder"));
    }
    if RESERVED.iter().any(|reserved| name.eq_ignore_ascii_case(reserved)) {
        return Err(format!("{field}: found {name:?}, expected another name: this one belongs to the batch"));
    }
    Ok(name.to_owned())
}

fn add_option(words: &mut Vec<String>, name: &str, value: &Value) -> Result<(), String> {
    let word = format!("--{}", name.replace('_', "-"));
    if ["--output", "--threads", "--progress", "--help", "--cache"].contains(&word.as_str()) {
        return Err(format!("{name}: not an option of a step"));
    }
    let text = match value {
        Value::Bool(on) => if *on { "on" } else { "off" }.to_owned(),
        Value::Number(number) => number.to_string(),
        Value::String(text) => text.clone(),
        Value::Array(list) => return list.iter().try_for_each(|value| add_option(words, name, value)),
        _ => {
            let found = described(Some(value));
            return Err(format!("{name}: found {found}, expected a text, a number, true or false, or a list of them"));
        }
    };
    // One word: a value may begin with a dash.
    words.push(format!("{word}={text}"));
    Ok(())
}

/// The name of a file that two steps write, as the first has it. Patterns of different text can meet too: those whose names
/// agree outside of their numbers are taken as the same.
pub fn same_output<'a>(a: &'a Step, b: &Step) -> Option<&'a str> {
    let shapes: Vec<String> = b.output.iter().chain(&b.report).map(|name| shape(name)).collect();
    a.output.iter().chain(&a.report).find(|name| shapes.contains(&shape(name))).map(String::as_str)
}

/// A name in small letters with one sign for each number and each place of a number.
fn shape(name: &str) -> String {
    let mut shape = String::new();
    let mut letters = name.chars().peekable();
    while let Some(letter) = letters.next() {
        let number = letter.is_ascii_digit()
            || (letter == '%' && letters.peek().is_some_and(|c| c.is_ascii_digit() || *c == 'd'));
        if !number {
            shape.extend(letter.to_lowercase());
            continue;
        }
        while letters.peek().is_some_and(char::is_ascii_digit) {
            letters.next();
        }
        if letter == '%' && letters.peek() == Some(&'d') {
            letters.next();
        }
        shape.push('#');
    }
    shape
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn words(value: &Value) -> String {
        Step::read(value)
            .map_or_else(|error| format!("error: {error}"), |step| step.words("in.json", ".new-").join(" "))
    }

    #[test]
    fn a_step_is_a_command() {
        for (value, expected) in [
            (json!({"do": "check"}), "check in.json"),
            (json!({"do": "track", "preset": "zhou2011"}), "track in.json -o .new-tracked.json --preset=zhou2011"),
            (
                json!({"do": "render", "to": "m_%04d.exr", "what": "matte", "layers": true, "parts": ["a", "-b"], "line_width": 1.5}),
                "render in.json -o .new-m_%04d.exr --what=matte --layers=on --parts=a --parts=-b --line-width=1.5",
            ),
            (
                json!({"do": "track", "report": "r.json", "preset": "zhou2011"}),
                "track in.json -o .new-tracked.json --report=.new-r.json --preset=zhou2011",
            ),
            (json!({"do": "fill", "sensitivity": 2}), "fill in.json -o .new-painted.json --sensitivity=2"),
            (json!({"do": "export", "to": "a.nk"}), "export in.json -o .new-a.nk"),
        ] {
            assert_eq!(words(&value), expected);
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (value, begin) in [
            (json!(3), "found 3, expected an object"),
            (json!({}), "do: found \"\""),
            (json!({"do": "render"}), "to: found nothing, expected the name"),
            (json!({"do": "check", "to": "a"}), "to: found a name, expected none"),
            (json!({"do": "export", "to": "../a.svg"}), "to: found \"../a.svg\""),
            (json!({"do": "track", "to": "Batch.json"}), "to: found \"Batch.json\", expected another"),
            (
                json!({"do": "track", "report": "../../notes.txt"}),
                "report: found \"../../notes.txt\", expected a name without",
            ),
            (json!({"do": "track", "report": "batch.json"}), "report: found \"batch.json\", expected another"),
            (json!({"do": "track", "report": "Tracked.json"}), "report: found \"Tracked.json\", expected another"),
            (json!({"do": "track", "report": 7}), "report: found 7, expected the name"),
            (json!({"do": "track", "output": "x"}), "output: not an option"),
            (json!({"do": "track", "threads": 9}), "threads: not an option"),
            (json!({"do": "track", "cache": "../../elsewhere"}), "cache: not an option"),
            (json!({"do": "track", "progress": "json"}), "progress: not an option"),
            (json!({"do": "track", "preset": {}}), "preset: found an object, expected a text"),
        ] {
            assert!(words(&value).starts_with(&format!("error: {begin}")), "{}", words(&value));
        }
    }

    #[test]
    fn names_that_may_meet_are_the_same() {
        let step = |to: &str| Step::read(&json!({"do": "render", "to": to})).unwrap();
        for (a, b, same) in [
            ("a_%04d.png", "a_%d.png", true),
            ("a_%04d.png", "A_0007.png", true),
            ("a_%04d.png", "b_%04d.png", false),
            ("a_%04d.png", "a_%04d.exr", false),
            ("100%.png", "100%.png", true),
        ] {
            assert_eq!(same_output(&step(a), &step(b)), same.then_some(a), "{a} {b}");
        }
        let step = |value| Step::read(&value).unwrap();
        let (check, track) = (step(json!({"do": "check"})), step(json!({"do": "track", "report": "r.json"})));
        assert_eq!(same_output(&check, &check), None);
        assert_eq!(same_output(&track, &step(json!({"do": "export", "to": "R.json"}))), Some("r.json"));
    }
}
