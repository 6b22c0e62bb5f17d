//! The manifest: shots and the steps to take for each.
//!
//! ```json
//! {
//!   "rototoon_batch": 1,
//!   "steps": [{"do": "track"}, {"do": "render", "what": "matte", "to": "matte_%04d.exr"}],
//!   "shots": [{"name": "sh010", "project": "sh010/project.json"}]
//! }
//! ```
//!
//! `project` and `blend` are relative to the manifest's folder. A shot may have `steps` of its own.

use crate::names::{RESERVED, safe_name};
use crate::step::{self, Step};
use crate::strict;
use rototoon::file;
use rototoon::project::{Document, described};
use rototoon::scene::Footage;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// Version of the format.
pub const VERSION: u64 = 1;
/// Greatest number of shots.
pub const MOST_SHOTS: usize = 100_000;
/// Number of problems that are listed.
const MOST_PROBLEMS: usize = 20;

/// Shots with their steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// The shots in the order of the manifest.
    pub shots: Vec<Shot>,
}

/// A shot.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// Unique name, also that of its folder.
    pub name: String,
    /// Its project document.
    pub project: PathBuf,
    /// The Blender file in which a person corrects it.
    pub blend: Option<PathBuf>,
    /// What to do.
    pub steps: Vec<Step>,
}

/// What is wrong with a manifest.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct ManifestError {
    /// Path of the manifest.
    pub path: PathBuf,
    /// One line for each problem: place, what was found, and what was expected.
    pub problems: Vec<String>,
}

impl fmt::Display for ManifestError {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        for (k, problem) in self.problems.iter().take(MOST_PROBLEMS).enumerate() {
            let end = if k == 0 { "" } else { "\n" };
            write!(out, "{end}{}: {problem}", self.path.display())?;
        }
        match self.problems.len().saturating_sub(MOST_PROBLEMS) {
            0 => Ok(()),
            more => write!(out, "\n{}: and {more} more problems", self.path.display()),
        }
    }
}

/// Says what is wrong with the words of a subcommand.
pub type CheckWords<'a> = &'a dyn Fn(&[String]) -> Result<(), String>;

impl Manifest {
    /// Reads a manifest. `check` is asked about the words of each step.
    ///
    /// # Errors
    ///
    /// A [`ManifestError`] with every problem: the file cannot be read, is no manifest or one of a later version; a step
    /// or an option is unknown; names are missing, unsafe or used twice; two steps of a shot write the same file; the pictures
    /// of a shot would get one name.
    pub fn load(path: &Path, check: CheckWords) -> Result<Self, ManifestError> {
        let failed = |problems| ManifestError { path: path.to_owned(), problems };
        let text = file::text(path).map_err(|error| failed(vec![error.to_string()]))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(&text, folder, check).map_err(failed)
    }

    /// Reads the text of a manifest in `folder`.
    ///
    /// # Errors
    ///
    /// All problems, a line each.
    pub fn parse(text: &str, folder: &Path, check: CheckWords) -> Result<Self, Vec<String>> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value = strict::parse(text).map_err(|problem| vec![problem])?;
        let Value::Object(fields) = value else {
            return Err(vec![format!("found {}, expected an object", described(Some(&value)))]);
        };
        let version = fields.get("rototoon_batch");
        // Some programs write whole numbers as 1.0.
        if version.and_then(Value::as_f64) != Some(VERSION as f64) {
            let found = described(version);
            return Err(vec![format!("rototoon_batch: found {found}, expected the version {VERSION}")]);
        }
        let mut reader = Reader { folder, check, problems: Vec::new(), names: BTreeMap::new() };
        reader.unknown("", &fields, &["rototoon_batch", "steps", "shots"]);
        let common = fields.get("steps").map(|steps| reader.steps("steps", steps)).unwrap_or_default();
        // Where a step of all shots cannot be read, the shots are not told that they have none.
        let has_steps = fields.get("steps").is_some_and(|steps| steps.as_array().is_none_or(|steps| !steps.is_empty()));
        let shots = reader.shots(fields.get("shots"), has_steps.then_some(&common));
        if reader.problems.is_empty() { Ok(Self { shots }) } else { Err(reader.problems) }
    }
}

struct Reader<'a> {
    folder: &'a Path,
    check: CheckWords<'a>,
    problems: Vec<String>,
    /// Names in small letters, with the index of their shot.
    names: BTreeMap<String, usize>,
}

impl Reader<'_> {
    fn shots(&mut self, value: Option<&Value>, common: Option<&Vec<Step>>) -> Vec<Shot> {
        let Some(Value::Array(list)) = value else {
            self.problems.push(format!("shots: found {}, expected a list of shots", described(value)));
            return Vec::new();
        };
        if list.is_empty() || list.len() > MOST_SHOTS {
            self.problems.push(format!("shots: found {} shots, expected 1 to {MOST_SHOTS}", list.len()));
            return Vec::new();
        }
        let shots: Vec<_> =
            list.iter().enumerate().filter_map(|(index, value)| self.shot(index, value, common)).collect();
        self.problems.extend(shots.iter().find_map(one_name_for_many));
        shots
    }

    fn shot(&mut self, index: usize, value: &Value, common: Option<&Vec<Step>>) -> Option<Shot> {
        let place = format!("shots[{index}]");
        let Value::Object(fields) = value else {
            self.problems.push(format!("{place}: found {}, expected an object", described(Some(value))));
            return None;
        };
        self.unknown(&format!("{place}."), fields, &["name", "project", "blend", "steps"]);
        let name = self.name(index, fields.get("name"));
        let project = self.path(&format!("{place}.project"), fields.get("project"));
        let blend = match fields.get("blend") {
            None => None,
            value => self.path(&format!("{place}.blend"), value),
        };
        let steps = match fields.get("steps") {
            Some(steps) => self.steps(&format!("{place}.steps"), steps),
            None => common.cloned().unwrap_or_default(),
        };
        if common.is_none() && fields.get("steps").is_none() {
            self.problems.push(format!("{place}: found no steps, expected `steps` here or for all shots"));
        }
        Some(Shot { name: name?, project: project?, blend, steps })
    }

    fn name(&mut self, index: usize, value: Option<&Value>) -> Option<String> {
        let place = format!("shots[{index}].name");
        let name = value.and_then(Value::as_str).unwrap_or_default();
        if let Err(expected) = safe_name(name) {
            self.problems.push(format!("{place}: found {name:?}, expected {expected}"));
            return None;
        }
        if RESERVED.iter().any(|reserved| name.eq_ignore_ascii_case(reserved)) {
            self.problems
                .push(format!("{place}: found {name:?}, expected another name: this one belongs to the batch"));
            return None;
        }
        // Some systems do not tell large letters from small ones.
        if let Some(before) = self.names.insert(name.to_lowercase(), index) {
            self.problems
                .push(format!("{place}: found {name:?}, which shots[{before}] has too; both would write one folder"));
            return None;
        }
        Some(name.to_owned())
    }

    fn path(&mut self, place: &str, value: Option<&Value>) -> Option<PathBuf> {
        match value.and_then(Value::as_str) {
            Some(text) if !text.is_empty() && !text.contains('\0') => Some(self.folder.join(text)),
            _ => {
                self.problems.push(format!("{place}: found {}, expected the path of a file", described(value)));
                None
            }
        }
    }

    fn steps(&mut self, place: &str, value: &Value) -> Vec<Step> {
        let Value::Array(list) = value else {
            self.problems.push(format!("{place}: found {}, expected a list of steps", described(Some(value))));
            return Vec::new();
        };
        let mut steps: Vec<Step> = Vec::new();
        for (index, value) in list.iter().enumerate() {
            let place = format!("{place}[{index}]");
            match Step::read(value).and_then(|step| (self.check)(&step.words("a.json", "")).map(|()| step)) {
                Ok(step) => {
                    if let Some(file) = steps.iter().find_map(|other| step::same_output(other, &step)) {
                        self.problems.push(format!(
                            "{place}: found a second step that writes {file:?}, expected another name in `to`"
                        ));
                    }
                    steps.push(step);
                }
                Err(problem) => self.problems.push(format!("{place}: {problem}")),
            }
        }
        steps
    }

    fn unknown(&mut self, place: &str, fields: &Map<String, Value>, known: &[&str]) {
        for name in fields.keys().filter(|name| !known.contains(&name.as_str())) {
            self.problems.push(format!("{place}{name}: not a field of a manifest; known are {}", known.join(", ")));
        }
    }
}

/// The problem of a shot whose pictures would all get one name. Its document is read only where a step has such a name, to know
/// how many pictures there are.
fn one_name_for_many(shot: &Shot) -> Option<String> {
    let step = shot.steps.iter().find(|step| step.names_one_picture())?;
    // A document that cannot be read is the shot's failure, and told there.
    let Footage { first, last, .. } = Document::load(&shot.project).ok()?.scene.footage;
    let (name, file) = (&shot.name, step.output.as_deref().unwrap_or_default());
    let expected = "a place for the frame's number, such as %04d";
    (first != last)
        .then(|| format!("shot {name:?}: render: to: found {file:?} for frames {first} to {last}, expected {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fine(_: &[String]) -> Result<(), String> {
        Ok(())
    }

    fn problems(text: &str) -> Vec<String> {
        Manifest::parse(text, Path::new("in"), &fine).err().unwrap_or_default()
    }

    #[test]
    fn shots_take_the_common_steps_or_their_own() {
        let text = r#"{"rototoon_batch": 1, "steps": [{"do": "track"}], "shots": [
            {"name": "a", "project": "a/p.json"}, {"name": "b", "project": "/b.json", "blend": "b.blend", "steps": [{"do": "check"}]}]}"#;
        let manifest = Manifest::parse(text, Path::new("in"), &fine).unwrap();
        let steps: Vec<_> = manifest.shots.iter().map(|shot| shot.steps[0].name()).collect();
        assert_eq!(steps, ["track", "check"]);
        assert_eq!(manifest.shots[0].project, Path::new("in/a/p.json"));
        assert_eq!(manifest.shots[1].project, Path::new("/b.json"));
        assert_eq!(manifest.shots[1].blend.as_deref(), Some(Path::new("in/b.blend")));
    }

    #[test]
    fn each_problem_has_a_line() {
        assert_eq!(problems("[]"), ["found [], expected an object"]);
        assert_eq!(problems("{}"), ["rototoon_batch: found nothing, expected the version 1"]);
        for (version, found) in [("2", "2"), ("1.5", "1.5"), ("\"1\"", "\"1\""), ("null", "null")] {
            let problems = problems(&format!("{{\"rototoon_batch\": {version}}}"));
            assert_eq!(problems, [format!("rototoon_batch: found {found}, expected the version 1")]);
        }
        assert!(
            problems(r#"{"rototoon_batch": 1, "steps": [], "steps": []}"#)[0]
                .starts_with("found the field \"steps\" twice")
        );
        let text = r#"{"rototoon_batch": 1, "step": 1, "steps": [{"do": "fly"}, {"do": "track"}, {"do": "track"}], "shots": [
            {"name": "a/b", "project": "p"}, {"name": "x", "project": "p"}, {"name": "X", "project": ""}, 7]}"#;
        let found = problems(text);
        let begins = [
            "step: not a field",
            "steps[0]: do: found \"fly\"",
            "steps[2]: found a second step that writes \"tracked.json\"",
            "shots[0].name: found \"a/b\"",
            "shots[2].name: found \"X\", which shots[1] has too",
            "shots[2].project: found \"\", expected the path",
            "shots[3]: found 7, expected an object",
        ];
        assert_eq!(found.len(), begins.len(), "{found:#?}");
        for (found, begin) in found.iter().zip(begins) {
            assert!(found.starts_with(begin), "{found} / {begin}");
        }
    }

    #[test]
    fn a_mark_before_the_text_and_a_version_with_a_point_are_fine() {
        let text = r#"{"rototoon_batch": 1.0, "steps": [{"do": "check"}], "shots": [{"name": "a", "project": "p"}]}"#;
        assert!(problems(&format!("\u{feff}{text}")).is_empty());
        for name in ["index.html", "Summary.json", "report.jsonl"] {
            let found = problems(&text.replace("\"a\"", &format!("{name:?}")));
            assert_eq!(
                found,
                [format!("shots[0].name: found {name:?}, expected another name: this one belongs to the batch")]
            );
        }
    }

    #[test]
    fn words_are_checked() {
        let refuse = |words: &[String]| Err(format!("unknown {}", words.len()));
        let text = r#"{"rototoon_batch": 1, "steps": [{"do": "snap"}], "shots": [{"name": "a", "project": "p"}]}"#;
        let found = Manifest::parse(text, Path::new(""), &refuse).unwrap_err();
        assert_eq!(found[0], "steps[0]: unknown 4");
    }
}
