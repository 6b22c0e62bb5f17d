//! Skeleton clips, their library, and drawings that follow them, with JSON arguments and results. The functions of
//! [`crate::style_abi`] document the JSON.

use crate::choosing::chosen;
use crate::status::Failure;
use crate::work::{GoOn, run};
use rototoon::geometry::Point;
use rototoon::import::bvh::{self, JointMap, Up, View};
use rototoon::pipeline::{self, ClipJob, Mirror, PipelineError, ReshapeJob, Side};
use rototoon::project::Document;
use rototoon::project::clips::{Clips, parse_key_poses};
use rototoon::project::library::{Addition, Checked, Entry, Existing, Library, Trouble};
use rototoon::project::skeleton as bodies;
use rototoon::reshape::contacts::Contacts;
use rototoon::reshape::{facing, puppet};
use rototoon::scene::{Clip, FrameNumber};
use rototoon::style::{KeyPose, Options, Pace, Preset, Request};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Most sub-key points of a limb.
const MOST_SUB_KEYS: usize = 100;

fn options<T: DeserializeOwned>(json: &str) -> Result<T, Failure> {
    serde_json::from_str(json).map_err(|error| Failure::Error(format!("options: {error}")))
}

fn failed(error: PipelineError) -> Failure {
    match error {
        PipelineError::Cancelled(cancelled) => cancelled.into(),
        other => Failure::error(other),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CaptureOptions {
    character: String,
    motion: String,
    first: Option<FrameNumber>,
    last: Option<FrameNumber>,
}

/// Makes a clip from a document's contours.
pub fn capture(document: &str, json: &str) -> Result<String, Failure> {
    let given: CaptureOptions = options(json)?;
    let document = Document::parse(document, "document").map_err(Failure::error)?;
    let footage = &document.scene.footage;
    let frames = given.first.unwrap_or(footage.first)..=given.last.unwrap_or(footage.last);
    let job = ClipJob { character: given.character, motion: given.motion, frames: Some(frames) };
    let made = pipeline::clip(&document, &job).map_err(failed)?;
    let guessed: serde_json::Map<String, Value> =
        made.guessed.iter().map(|(name, count)| ((*name).to_owned(), json!(count))).collect();
    let guessed = Value::Object(guessed);
    let (clips, first, doubts) =
        (made.clips.text(), made.first, json!(made.doubts.iter().chain(&made.outdated).collect::<Vec<_>>()));
    let clips = clips.trim_end();
    Ok(format!(r#"{{"clips": {clips}, "first": {first}, "guessed": {guessed}, "doubts": {doubts}}}"#))
}

/// The complete definition of a body that is named or defined.
pub fn skeleton(json: &str) -> Result<String, Failure> {
    let given: Value = serde_json::from_str(json).map_err(|error| Failure::Error(format!("skeleton: {error}")))?;
    let template = bodies::read(Some(&given)).map_err(Failure::error)?;
    Ok(bodies::whole(&template).to_string())
}

/// To which side the body of a clip looks, and when it is in the air.
pub fn stance(clips: &str) -> Result<String, Failure> {
    let clips = Clips::parse(clips, "clips").map_err(Failure::error)?;
    let [clip] = &clips.clips[..] else {
        return Err(Failure::Error(format!("clips: found {} clips, expected one", clips.clips.len())));
    };
    let looks = facing::of_clip(&clip.template, &clip.postures).map(Side::id);
    let air = Contacts::of_clip(&clip.template, &clip.postures).air;
    Ok(json!({"looks": looks, "air": air}).to_string())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImportOptions {
    character: String,
    motion: String,
    #[serde(default)]
    view: Option<Value>,
    #[serde(default)]
    up: Option<String>,
    #[serde(default)]
    joints: Option<Value>,
    #[serde(default)]
    way: bool,
    #[serde(default)]
    first: Option<usize>,
    #[serde(default)]
    last: Option<usize>,
    #[serde(default)]
    fps: Option<f64>,
}

impl ImportOptions {
    fn read(&self) -> Result<bvh::Options, Failure> {
        let wrong = |field: &str, found: &dyn std::fmt::Display, expected: &str| {
            Failure::Error(format!("options.{field}: found {found}, expected {expected}"))
        };
        let view = match &self.view {
            None => View::Auto,
            Some(value) => match (value.as_str(), value.as_f64()) {
                (Some("auto"), _) => Some(View::Auto),
                (Some("front"), _) => Some(View::Front),
                (Some("side"), _) => Some(View::Side),
                (Some("three-quarter"), _) => Some(View::ThreeQuarter),
                (_, degrees) => degrees.map(View::Yaw),
            }
            .ok_or_else(|| wrong("view", value, "auto, front, side, three-quarter or degrees"))?,
        };
        let up = match self.up.as_deref() {
            None | Some("auto") => Up::Auto,
            Some("y") => Up::Y,
            Some("z") => Up::Z,
            Some(other) => return Err(wrong("up", &other, "auto, y or z")),
        };
        let joints = match &self.joints {
            None | Some(Value::Null) => JointMap::default(),
            Some(map) => JointMap::parse(&map.to_string()).map_err(Failure::error)?,
        };
        let frames = match (self.first, self.last) {
            (None, None) => None,
            (Some(first), Some(last)) => Some(first..=last),
            _ => return Err(Failure::Error("options: found one of first and last, expected both or none".into())),
        };
        Ok(bvh::Options { view, up, joints, way: self.way, frames, fps: self.fps })
    }
}

/// Makes a clip from the text of a BVH file.
pub fn import(text: &str, json: &str) -> Result<String, Failure> {
    let given: ImportOptions = options(json)?;
    if given.character.is_empty() || given.motion.is_empty() {
        return Err(Failure::Error("options: found an empty name, expected a character and a motion".into()));
    }
    let made = bvh::seen(text, &given.read()?).map_err(Failure::error)?;
    let clips = Clips { clips: vec![Clip::new(given.character, given.motion, made.postures)], fps: made.fps };
    Ok(format!(r#"{{"clips": {}, "yaw": {}, "notes": {}}}"#, clips.text().trim_end(), made.yaw, json!(made.notes)))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TranslateOptions {
    style: String,
    motion: String,
    content: String,
    #[serde(default)]
    preset: Option<String>,
    #[serde(default)]
    timing: Option<String>,
    #[serde(default)]
    strength: Option<f64>,
    #[serde(default)]
    limb_lengths: Option<bool>,
    #[serde(default)]
    contacts: Option<bool>,
    #[serde(default)]
    keys: Option<Value>,
    #[serde(default)]
    notes: bool,
    #[serde(default)]
    threads: usize,
}

impl TranslateOptions {
    fn read(&self) -> Result<Options, Failure> {
        let wrong = |field: &str, found: &str, expected: &str| {
            Failure::Error(format!("options.{field}: found {found}, expected {expected}"))
        };
        let own = Options::default();
        let preset = match self.preset.as_deref() {
            None => own.preset,
            Some(id) => Preset::from_id(id).ok_or_else(|| {
                let known: Vec<&str> = Preset::ALL.iter().map(|(id, _, _)| *id).collect();
                wrong("preset", &format!("{id:?}"), &format!("one of {}", known.join(", ")))
            })?,
        };
        let pace = match self.timing.as_deref() {
            None | Some("content") => Pace::Content,
            Some("style") => Pace::Style,
            Some(other) => return Err(wrong("timing", &format!("{other:?}"), "content or style")),
        };
        let strength = self.strength.unwrap_or(own.strength);
        if !(0.0..=3.0).contains(&strength) {
            return Err(wrong("strength", &strength.to_string(), "a number from 0 to 3"));
        }
        let keep_lengths = self.limb_lengths.unwrap_or(own.keep_lengths);
        let keep_contacts = self.contacts.unwrap_or(own.keep_contacts);
        Ok(Options { preset, pace, strength, keep_lengths, keep_contacts, ..own })
    }
}

/// Makes a motion in the style of another character.
pub fn translate(clips: &str, json: &str, go_on: GoOn<'_>) -> Result<String, Failure> {
    let given: TranslateOptions = options(json)?;
    let how = given.read()?;
    let clips = Clips::parse(clips, "clips").map_err(Failure::error)?;
    let keys: Vec<KeyPose> = match &given.keys {
        None | Some(Value::Null) => Vec::new(),
        Some(value) => parse_key_poses(&value.to_string(), "options.keys")
            .map_err(Failure::error)?
            .into_iter()
            .map(|key| KeyPose { frame: key.frame, posture: key.posture })
            .collect(),
    };
    let request = Request { style: &given.style, motion: &given.motion, content: &given.content, keys: &keys };
    run(given.threads, go_on, |progress| {
        let (made, grounds) = pipeline::translate_and_judge(&clips, &request, &how, progress).map_err(failed)?;
        let text = made.text();
        let guessed = made.clips.iter().filter_map(pipeline::guessed_translation);
        let notes: Vec<String> = grounds.notes().into_iter().chain(guessed).collect();
        Ok(if given.notes { format!(r#"{{"clips": {}, "notes": {}}}"#, text.trim_end(), json!(notes)) } else { text })
    })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReshapeOptions {
    #[serde(default)]
    character: Option<String>,
    #[serde(default)]
    motion: Option<String>,
    #[serde(default)]
    rest: Option<FrameNumber>,
    #[serde(default)]
    sub_keys: Option<usize>,
    #[serde(default)]
    chains: Vec<(String, String)>,
    #[serde(default)]
    mirror: Option<String>,
    #[serde(default)]
    points: BTreeMap<String, Vec<[f64; 2]>>,
    #[serde(default)]
    threads: usize,
}

/// Makes a drawing follow a clip on every frame.
pub fn reshape(document: &str, clips: &str, json: &str, go_on: GoOn<'_>) -> Result<String, Failure> {
    let given: ReshapeOptions = options(json)?;
    let mut document = Document::parse(document, "document").map_err(Failure::error)?;
    let clips = Clips::parse(clips, "clips").map_err(Failure::error)?;
    let clip = chosen(&clips.clips, given.character.as_deref(), given.motion.as_deref())?;
    let sub_keys = given.sub_keys.unwrap_or(puppet::Options::default().sub_keys);
    if sub_keys > MOST_SUB_KEYS {
        return Err(Failure::Error(format!("options.sub_keys: found {sub_keys}, expected 0 to {MOST_SUB_KEYS}")));
    }
    let how = puppet::Options { sub_keys, ..puppet::Options::default() };
    let (clip, rate) = pipeline::at_rate_of(&document.scene.footage, clip, clips.fps);
    let job = ReshapeJob {
        clip: &clip,
        fps: document.scene.footage.fps,
        rest: given.rest,
        over: None,
        chains: given.chains.clone(),
        mirror: given.mirror()?,
        options: how,
        points: given.points(),
    };
    run(given.threads, go_on, |progress| {
        let made = pipeline::reshape(&mut document, &job, progress).map_err(failed)?;
        let loose: Vec<Value> =
            made.given.iter().map(|(part, given)| json!({"part": part, "follows": given.to_string()})).collect();
        let (given, rigid, still) = (Value::Array(loose), json!(made.rigid), json!(made.still));
        let looks =
            made.sides.map(|sides| json!({"drawing": sides.drawing.map(Side::id), "clip": sides.clip.map(Side::id)}));
        let (mirrored, looks) = (made.mirrored, json!(looks));
        let pair = |p: &Point| [p.x, p.y];
        let frames = |frames: &Vec<Vec<Point>>| {
            json!(frames.iter().map(|f| f.iter().map(pair).collect()).collect::<Vec<Vec<_>>>())
        };
        let notes = json!(rate.iter().chain(&made.notes).chain(&made.remarks).collect::<Vec<_>>());
        let points: serde_json::Map<String, Value> =
            made.points.iter().map(|(part, f)| (part.clone(), frames(f))).collect();
        let points = Value::Object(points);
        let document = document.to_json();
        Ok(format!(
            r#"{{"document": {}, "given": {given}, "rigid": {rigid}, "still": {still}, "mirrored": {mirrored}, "looks": {looks}, "notes": {notes}, "points": {points}}}"#,
            document.trim_end()
        ))
    })
}

impl ReshapeOptions {
    fn mirror(&self) -> Result<Mirror, Failure> {
        let Some(found) = &self.mirror else { return Ok(Mirror::default()) };
        Mirror::from_id(found).ok_or_else(|| {
            let known = Mirror::ALL.map(|(id, _)| format!("{id:?}")).join(", ");
            Failure::Error(format!("options.mirror: found {found:?}, expected one of {known}"))
        })
    }

    fn points(&self) -> BTreeMap<String, Vec<Point>> {
        self.points
            .iter()
            .map(|(part, points)| (part.clone(), points.iter().map(|p| Point::new(p[0], p[1])).collect()))
            .collect()
    }
}

/// Adds clips to the library in a folder, and replaces none.
pub fn library_add(folder: &str, clips: &str, source: &str) -> Result<(), Failure> {
    let clips = Clips::parse(clips, "clips").map_err(Failure::error)?;
    let mut library = Library::open(Path::new(folder));
    library.add(&[Addition { clips: &clips, source }], Existing::Refuse).map(drop).map_err(Failure::error)
}

/// Adds files of clips to the library in a folder, all or none.
pub fn library_add_files(folder: &str, files: &str, json: &str) -> Result<String, Failure> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Given {
        clips: Value,
        #[serde(default)]
        source: String,
    }
    #[derive(Deserialize, Default)]
    #[serde(deny_unknown_fields, default)]
    struct Wanted {
        replace: bool,
    }
    let wanted: Wanted = if json.is_empty() { Wanted::default() } else { options(json)? };
    let given: Vec<Given> = serde_json::from_str(files).map_err(|error| Failure::Error(format!("files: {error}")))?;
    let read = given.iter().enumerate().map(|(k, file)| {
        let clips = Clips::parse(&file.clips.to_string(), &format!("files[{k}].clips")).map_err(Failure::error)?;
        Ok((clips, file.source.as_str()))
    });
    let read: Vec<(Clips, &str)> = read.collect::<Result<_, Failure>>()?;
    let added: Vec<Addition<'_>> = read.iter().map(|(clips, source)| Addition { clips, source }).collect();
    let existing = if wanted.replace { Existing::Replace } else { Existing::Refuse };
    let done = Library::open(Path::new(folder)).add(&added, existing).map_err(Failure::error)?;
    let aside = done.aside.map(|path| path.display().to_string());
    Ok(json!({"replaced": done.replaced, "aside": aside}).to_string())
}

/// Finds the clips of a library whose character and motion contain given words or have given names, and reads them if requested.
pub fn library_find(folder: &str, json: &str) -> Result<String, Failure> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields, default)]
    #[derive(Default)]
    struct Wanted {
        character: String,
        motion: String,
        read: bool,
        exact: bool,
        rate_of: Option<(String, String)>,
    }
    let wanted: Wanted = options(json)?;
    let library = Library::open(Path::new(folder));
    let mut troubles: Vec<String> = library.troubles().iter().map(ToString::to_string).collect();
    let (entries, clips) = if wanted.read || wanted.exact {
        let found = if wanted.exact {
            library.named(&wanted.character, &wanted.motion)
        } else {
            library.checked(|entry| entry.has(&wanted.character, &wanted.motion))
        };
        troubles.extend(found.troubles().map(ToString::to_string));
        let leads = |entry: &Entry| {
            wanted.rate_of.as_ref().is_some_and(|(who, what)| entry.character == *who && entry.motion == *what)
        };
        let leading = found.clips.iter().map(|(entry, _)| entry).find(|entry| leads(entry));
        let usual = || Library::usual_rate(found.clips.iter().map(|(entry, _)| entry));
        let fps = leading.map_or_else(usual, |entry| entry.fps);
        let entries = json!(in_order(&library, &found));
        (entries, wanted.read.then(|| found.at_rate(fps).text()))
    } else {
        (json!(library.search(&wanted.character, &wanted.motion).collect::<Vec<_>>()), None)
    };
    let (troubles, clips) = (json!(troubles), clips.as_deref().unwrap_or("null").trim_end());
    Ok(format!(r#"{{"entries": {entries}, "troubles": {troubles}, "clips": {clips}}}"#))
}

/// The entries of clips and of unusable files in the order of the library. Of files with one clip, one has an entry.
fn in_order<'a>(library: &Library, found: &'a Checked) -> Vec<&'a Entry> {
    let unusable = found.unusable.iter().filter(|(_, trouble)| !matches!(trouble, Trouble::Twice { .. }));
    let mut entries: Vec<&Entry> =
        found.clips.iter().map(|(entry, _)| entry).chain(unusable.map(|(entry, _)| entry)).collect();
    let order: BTreeMap<&str, usize> =
        library.entries().iter().enumerate().map(|(k, entry)| (entry.file.as_str(), k)).collect();
    entries.sort_by_key(|entry| order.get(entry.file.as_str()));
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(json: &str) -> String {
        match import("HIERARCHY", json) {
            Err(Failure::Error(message)) => message,
            other => panic!("found {:?}", other.is_ok()),
        }
    }

    #[test]
    fn errors_of_a_motion_and_its_options_are_reported() {
        let with = |more: &str| said(&format!(r#"{{"character": "a", "motion": "walk"{more}}}"#));
        assert!(with("").starts_with("line 1: found the end of the file"));
        assert!(with(r#", "view": 30, "up": "z", "way": true, "first": 0, "last": 4"#).starts_with("line 1:"));
        assert!(with(r#", "view": "above""#).contains("options.view: found \"above\", expected auto, front, side"));
        assert!(with(r#", "up": "x""#).contains("options.up: found x, expected auto, y or z"));
        assert!(with(r#", "first": 3"#).contains("found one of first and last"));
        assert!(with(r#", "joints": {"tail": "x"}"#).contains("found no such key point"));
        assert!(with(r#", "more": 1"#).starts_with("options: unknown field"));
        assert!(said(r#"{"character": "", "motion": "walk"}"#).contains("found an empty name"));
    }
}
