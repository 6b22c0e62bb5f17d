//! The session behind a session handle: a document, its pictures, and the results that tracking keeps for reuse.

use crate::conformed;
use crate::filled::{self, RototoonFilled};
use crate::naming::without_part;
use crate::options::Options;
use crate::status::Failure;
use crate::traced::{Asked, RototoonTraced};
use crate::work::{self, GoOn};
use rototoon::pictures::sequence::Sequence;
use rototoon::pipeline::cache::FileCache;
use rototoon::pipeline::unchanged::Known;
use rototoon::pipeline::{self, Kept, Noted, PipelineError, TraceMemory};
use rototoon::project::fills::FillClicks;
use rototoon::project::place::{folder_for, folder_of};
use rototoon::project::seen::Seen;
use rototoon::project::{Document, Inputs, WriteError};
use rototoon::scene::parameters::Stage;
use rototoon::scene::{FrameNumber, Part, Progress, Scene};
use rototoon::snap::{CorridorWidth, Follow, SnapError, SnapOptions, snap_scene};
use rototoon::track::{Preset, Termination, TrackEnd, TrackError, TrackOptions, Tracker, Tracking, weakest_frame};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex};

/// The name of a document without a file, for messages.
const ORIGIN: &str = "document";

/// Traced spans of all sessions: hosts such as the Blender extension make a new session for each run.
static TRACED: LazyLock<Mutex<TraceMemory>> = LazyLock::new(Mutex::default);

/// A session.
pub struct Session {
    document: Document,
    folder: PathBuf,
    known: Known,
    pictures: Option<Sequence>,
    /// Whether files of the footage have changed since the pictures were read, and no track has said so yet.
    pictures_changed: bool,
    trackers: BTreeMap<&'static str, Tracker>,
    /// The marks of the pictures that were read for tracking.
    looked: BTreeMap<FrameNumber, Seen>,
}

/// The summary of tracking, as callers read it.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    jobs: Vec<JobSummary<'a>>,
    ends: Vec<EndSummary<'a>>,
    exchanges: Vec<ExchangeSummary<'a>>,
    unseen: Vec<UnseenSummary<'a>>,
    footage_changed: bool,
}

#[derive(Debug, Serialize)]
struct ExchangeSummary<'a> {
    parts: [&'a str; 2],
    frames: &'a [FrameNumber],
}

#[derive(Debug, Serialize)]
struct UnseenSummary<'a> {
    part: &'a str,
    frames: Vec<FrameNumber>,
}

#[derive(Debug, Serialize)]
struct EndSummary<'a> {
    part: &'a str,
    frame: FrameNumber,
    reason: &'static str,
}

#[derive(Debug, Serialize)]
struct JobSummary<'a> {
    part: &'a str,
    first: FrameNumber,
    last: FrameNumber,
    solved: bool,
    termination: &'static str,
    iterations: usize,
    initial_cost: f64,
    final_cost: f64,
}

impl Session {
    /// Creates a session from the JSON text of a document. A relative footage pattern is relative to `folder`.
    pub fn new(json: &str, folder: &Path) -> Result<Self, Failure> {
        let document = Document::parse(json, ORIGIN).map_err(Failure::error)?;
        Ok(Self::of(document, folder))
    }

    /// Creates a session from a project file.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let mut known = Known::new();
        known.remember(path);
        let document = Document::load(path).map_err(Failure::error)?;
        let folder = folder_of(path, &document.scene.footage);
        Ok(Self { known, ..Self::of(document, &folder) })
    }

    fn of(document: Document, folder: &Path) -> Self {
        // An absolute folder does not depend on later changes of the working directory. A bare file name has no folder, which is the present one.
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        Self {
            document,
            folder,
            known: Known::new(),
            pictures: None,
            pictures_changed: false,
            trackers: BTreeMap::new(),
            looked: BTreeMap::new(),
        }
    }

    /// The document as JSON.
    pub fn document(&self) -> String {
        self.document.to_json()
    }

    /// Writes the document. If `path` is not in the session's folder, a relative footage pattern is rewritten so that it
    /// names the same files. A frame of the footage is refused as `path`; the project file may be written over, unless another program wrote it after it was
    /// opened or saved here.
    pub fn save(&mut self, path: &Path) -> Result<(), Failure> {
        let inputs = Inputs::default().footage(&self.document.scene.footage, &self.folder);
        inputs.check(path).map_err(Failure::error)?;
        let target = std::path::absolute(path).map_err(Failure::error)?;
        let mut document = self.document.clone();
        pipeline::relocate(&mut document, &self.folder, &folder_for(&target, &self.folder))
            .map_err(|source| Failure::error(WriteError { path: path.to_owned(), source }))?;
        self.known.save(&document, path).map_err(Failure::error)
    }

    /// Replaces the document. Keeps solved spans, and the pictures if the footage is the same.
    pub fn set_document(&mut self, json: &str) -> Result<(), Failure> {
        let document = Document::parse(json, ORIGIN).map_err(Failure::error)?;
        self.put(document);
        Ok(())
    }

    fn put(&mut self, document: Document) {
        if document.scene.footage != self.document.scene.footage {
            // Without the pictures nobody knows whether the files are still those that the spans were solved with.
            self.forget();
        }
        self.document = document;
    }

    /// Replaces the footage, given as JSON.
    pub fn set_footage(&mut self, json: &str) -> Result<(), Failure> {
        let footage = value(json, "footage")?;
        self.rewrite(|document| {
            document["footage"] = footage;
        })
    }

    /// Adds a part, given as JSON, at the end.
    pub fn add_part(&mut self, json: &str) -> Result<(), Failure> {
        let part = value(json, "part")?;
        self.rewrite(|document| {
            if let Some(parts) = document["parts"].as_array_mut() {
                parts.push(part);
            }
        })
    }

    /// Changes the document's JSON. So the new fields pass the same checks as a file, and fields that this version does
    /// not know are kept. Existing parts are copied from memory, because JSON rounds results.
    fn rewrite(&mut self, change: impl FnOnce(&mut Value)) -> Result<(), Failure> {
        let mut json = value(&self.document.to_json(), ORIGIN)?;
        change(&mut json);
        let mut document = Document::parse(&json.to_string(), ORIGIN).map_err(Failure::error)?;
        let (parts, before) = (&mut document.scene.parts, &self.document.scene.parts);
        for (part, same) in parts.iter_mut().zip(before) {
            part.clone_from(same);
        }
        self.put(document);
        Ok(())
    }

    /// Removes a part with its keys, corrections and results, and [what names it](without_part).
    pub fn remove_part(&mut self, name: &str) -> Result<(), Failure> {
        let index = self.document.scene.part_index(name).map_err(Failure::error)?;
        self.rewrite(|document| without_part(document, name))?;
        self.document.scene.parts.remove(index);
        Ok(())
    }

    /// The parts' names as a JSON list.
    pub fn part_names(&self) -> String {
        let names: Vec<&str> = self.document.scene.parts.iter().map(|part| part.name.as_str()).collect();
        json!(names).to_string()
    }

    /// A part by name.
    pub fn part(&self, name: &str) -> Result<&Part, Failure> {
        let index = self.document.scene.part_index(name).map_err(Failure::error)?;
        Ok(&self.document.scene.parts[index])
    }

    /// The scene, for editing.
    pub fn scene_mut(&mut self) -> &mut Scene {
        &mut self.document.scene
    }

    /// The frame on which the next key helps most, as JSON `{"frame", "score"}`, or `null`.
    pub fn weakest_frame(&self) -> String {
        let found = weakest_frame(&self.document.scene.parts);
        found.map_or(Value::Null, |w| json!({"frame": w.frame, "score": w.score})).to_string()
    }

    /// The parts that can probably not be seen on some frames, by the tracks of the document, as JSON.
    pub fn unseen(&self) -> String {
        json!(unseen(&self.document.scene)).to_string()
    }

    /// Tracks the parts. Returns the summary as JSON.
    pub fn track(&mut self, options: &str, go_on: GoOn<'_>) -> Result<String, Failure> {
        let options = Options::parse(options, Stage::Track)?;
        let (preset, id) = preset(options.choice("preset"))?;
        self.forget_old_pictures();
        let pictures = pictures(&mut self.pictures, &self.document, &self.folder)?;
        pipeline::memory::to_follow(&self.document.scene.footage).map_err(Failure::error)?;
        let scene = pipeline::in_effect(&self.document.scene);
        let tracker =
            self.trackers.entry(id).or_insert_with(|| tracker(TrackOptions { preset, ..TrackOptions::default() }));
        let noted = Noted::knowing(pictures, self.looked.clone());
        let tracking = work::run(options.number("threads") as usize, go_on, |progress: &dyn Progress| {
            tracker.track(&scene, &noted, progress).map_err(|error| match error {
                TrackError::Cancelled(_) => Failure::Cancelled,
                other => Failure::error(other),
            })
        });
        // Cancelled work keeps the pictures that it has read, and they are not read again.
        self.looked = noted.seen();
        let tracking = tracking?;
        pipeline::store_seen(&mut self.document, &tracking, self.looked.clone()).map_err(Failure::error)?;
        let footage_changed = std::mem::take(&mut self.pictures_changed);
        Ok(summary(&self.document.scene, &tracking, footage_changed))
    }

    /// Snaps the contours to the ink. Returns a summary as JSON.
    pub fn snap(&mut self, options: &str, go_on: GoOn<'_>) -> Result<String, Failure> {
        let options = Options::parse(options, Stage::Snap)?;
        let snapping = snap_options(&options)?;
        self.forget_old_pictures();
        let pictures = pictures(&mut self.pictures, &self.document, &self.folder)?;
        pipeline::memory::to_follow(&self.document.scene.footage).map_err(Failure::error)?;
        let scene = &self.document.scene;
        let found = work::run(options.number("threads") as usize, go_on, |progress: &dyn Progress| {
            snap_scene(scene, pictures, &snapping, progress).map_err(|error| match error {
                SnapError::Cancelled(_) => Failure::Cancelled,
                other => Failure::error(other),
            })
        })?;
        let frames: usize = found.iter().map(|curves| curves.len()).sum();
        for (part, curves) in self.document.scene.parts.iter_mut().zip(found) {
            part.curves = curves;
        }
        Ok(json!({"frames": frames}).to_string())
    }

    /// Traces the lines of the footage, and stores the strokes in the document. Returns those of all frames.
    pub fn trace(&mut self, options: &str, go_on: GoOn<'_>) -> Result<RototoonTraced, Failure> {
        let asked = Asked::parse(options)?;
        let mut document = self.document.clone();
        let traced = work::run(asked.threads, go_on, |progress: &dyn Progress| {
            // Another session that traces at the same time has the memory; this one does without.
            let mut memory = TRACED.try_lock().ok();
            let cache = FileCache::of_user(None);
            let kept = Kept { memory: memory.as_deref_mut(), cache: cache.as_ref().map(|cache| cache as _) };
            let (frames, options) = (asked.frames(), asked.options());
            pipeline::trace(&mut document, &self.folder, frames, &options, kept, progress).map_err(
                |error| match error {
                    PipelineError::Cancelled(cancelled) => cancelled.into(),
                    other => Failure::error(other),
                },
            )?;
            RototoonTraced::of(&document.traced().map_err(Failure::error)?)
        })?;
        self.document = document;
        Ok(traced)
    }

    /// The traced strokes of the document.
    pub fn traced(&self) -> Result<RototoonTraced, Failure> {
        RototoonTraced::of(&self.document.traced().map_err(Failure::error)?)
    }

    /// The clicks of the painter as JSON, in the form of the document's `fills`.
    pub fn fills(&self) -> Result<String, Failure> {
        let fills = self.document.fills().map_err(Failure::error)?;
        Ok(filled::fills_to_json(&fills))
    }

    /// Replaces the clicks of the painter by some in the form of the document's `fills`.
    pub fn set_fills_json(&mut self, json: &str) -> Result<(), Failure> {
        let fills = self.document.read_fills(json).map_err(Failure::error)?;
        self.document.set_fills(&fills);
        Ok(())
    }

    /// The colours of paint that become others, as JSON.
    pub fn recolours(&self) -> Result<String, Failure> {
        let recolours = self.document.recolours().map_err(Failure::error)?;
        Ok(filled::recolours_to_json(recolours.list()))
    }

    /// Replaces the colours of paint that become others by some in the form of the document's `recolours`.
    pub fn set_recolours_json(&mut self, json: &str) -> Result<(), Failure> {
        self.document.set_recolours_json(json).map_err(Failure::error)
    }

    /// Replaces the clicks of the painter.
    pub fn set_fills(&mut self, fills: &[FillClicks]) {
        self.document.set_fills(fills);
    }

    /// Paints the regions of the footage, and stores them in the document. Returns those of all frames, and a report as JSON.
    pub fn fill(&mut self, options: &str, go_on: GoOn<'_>) -> Result<(RototoonFilled, String), Failure> {
        let asked = filled::Asked::parse(options)?;
        let mut document = self.document.clone();
        let found = work::run(asked.threads, go_on, |progress: &dyn Progress| {
            let cache = FileCache::of_user(None);
            let cache = cache.as_ref().map(|cache| cache as _);
            let report = pipeline::fill(&mut document, &self.folder, asked.frames(), &asked.options(), cache, progress)
                .map_err(|error| match error {
                    PipelineError::Cancelled(cancelled) => cancelled.into(),
                    other => Failure::error(other),
                })?;
            let filled = RototoonFilled::of(&document.filled().map_err(Failure::error)?)?;
            Ok((filled, filled::report_to_json(&report)))
        })?;
        self.document = document;
        Ok(found)
    }

    /// The painted regions of the document.
    pub fn filled(&self) -> Result<RototoonFilled, Failure> {
        RototoonFilled::of(&self.document.filled().map_err(Failure::error)?)
    }

    /// Moves the document to footage that was delivered again. Returns what became of the frames as JSON.
    pub fn conform(&mut self, options: &str, go_on: GoOn<'_>) -> Result<String, Failure> {
        let asked = conformed::Asked::parse(options)?;
        let conformed = work::run(asked.threads, go_on, |progress: &dyn Progress| {
            let new = asked.footage(&self.folder);
            pipeline::conform(&self.document, &self.folder, &new, progress).map_err(|error| match error {
                PipelineError::Cancelled(cancelled) => cancelled.into(),
                other => Failure::error(other),
            })
        })?;
        let report = conformed.report().to_string();
        self.put(conformed.document);
        Ok(report)
    }

    /// Drops pictures and solved spans if files of the footage have changed since they were read.
    fn forget_old_pictures(&mut self) {
        if self.pictures.as_ref().is_some_and(Sequence::has_changed) {
            self.forget();
            self.pictures_changed = true;
        }
    }

    /// Drops pictures and solved spans. After a panic they may be half-written.
    pub fn forget(&mut self) {
        self.pictures = None;
        self.trackers.clear();
        self.looked.clear();
    }
}

/// A tracker that finds what earlier sessions and the command line have tracked.
fn tracker(options: TrackOptions) -> Tracker {
    match FileCache::of_user(None) {
        Some(cache) => Tracker::with_cache(options, Arc::new(cache)),
        None => Tracker::new(options),
    }
}

/// The footage's pictures, opened at first use.
fn pictures<'a>(slot: &'a mut Option<Sequence>, document: &Document, folder: &Path) -> Result<&'a Sequence, Failure> {
    if slot.is_none() {
        *slot = Some(Sequence::new(&document.scene.footage, folder).map_err(Failure::error)?);
    }
    slot.as_ref().ok_or_else(|| Failure::Error("no pictures".into()))
}

fn value(json: &str, what: &str) -> Result<Value, Failure> {
    serde_json::from_str(json).map_err(|error| Failure::Error(format!("{what}: not JSON: {error}")))
}

fn snap_options(options: &Options) -> Result<SnapOptions, Failure> {
    let follow = match options.choice("follow") {
        "auto" => Follow::Auto,
        "edge" => Follow::Edge,
        "line" => Follow::Line,
        other => return Err(Failure::Error(format!("options: follow: found {other:?}, expected auto, edge or line"))),
    };
    let corridor = CorridorWidth {
        share: options.number("corridor_share"),
        least: options.number("corridor_least"),
        most: options.number("corridor_most"),
    };
    Ok(SnapOptions { follow, corridor })
}

fn preset(id: &str) -> Result<(Preset, &'static str), Failure> {
    Preset::ALL.iter().copied().find(|(_, known)| *known == id).ok_or_else(|| {
        let known: Vec<&str> = Preset::ALL.iter().map(|(_, id)| *id).collect();
        Failure::Error(format!("options: preset: found {id:?}, expected one of {}", known.join(", ")))
    })
}

/// The summary of what was tracked and stored in the scene. `footage_changed` says whether all was tracked anew because files of the footage have changed.
fn summary(scene: &Scene, tracking: &Tracking, footage_changed: bool) -> String {
    let jobs = tracking.jobs.iter().map(|job| JobSummary {
        part: &scene.parts[job.part].name,
        first: job.span.first,
        last: job.span.last,
        solved: job.solved,
        termination: termination_id(job.summary.termination),
        iterations: job.summary.iterations,
        initial_cost: job.summary.initial_cost,
        final_cost: job.summary.final_cost,
    });
    let ends = scene.parts.iter().zip(&tracking.parts).flat_map(|(part, track)| {
        let end = |end: &TrackEnd| EndSummary { part: &part.name, frame: end.frame, reason: end.reason.id() };
        track.ends.iter().map(end)
    });
    let exchanges = tracking.exchanges.iter().map(|found| ExchangeSummary {
        parts: found.parts.map(|part| scene.parts[part].name.as_str()),
        frames: &found.frames,
    });
    let (jobs, ends, exchanges) = (jobs.collect(), ends.collect(), exchanges.collect());
    json!(Summary { jobs, ends, exchanges, unseen: unseen(scene), footage_changed }).to_string()
}

/// The parts that can probably not be seen on some frames.
fn unseen(scene: &Scene) -> Vec<UnseenSummary<'_>> {
    let all = (0..scene.parts.len()).map(|k| (k, pipeline::unseen(scene, k))).filter(|(_, frames)| !frames.is_empty());
    all.map(|(k, frames)| UnseenSummary { part: &scene.parts[k].name, frames }).collect()
}

fn termination_id(termination: Termination) -> &'static str {
    match termination {
        Termination::NothingToSolve => "nothing_to_solve",
        Termination::CostConverged => "cost_converged",
        Termination::StepConverged => "step_converged",
        Termination::NoDescent => "no_descent",
        Termination::IterationLimit => "iteration_limit",
        Termination::PathChosen => "path_chosen",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
    use rototoon::track::Exchange;

    #[test]
    fn the_summary_names_parts_that_may_have_changed_places() {
        let part = |name: &str| Part { name: name.into(), ..Part::default() };
        let mut scene = empty_scene();
        scene.parts = ["near leg", "head", "far leg"].map(part).into();
        let tracking =
            Tracking { exchanges: vec![Exchange { parts: [0, 2], frames: vec![3, 4, 7] }], ..Tracking::default() };
        let summary: Value = serde_json::from_str(&summary(&scene, &tracking, true)).unwrap();
        assert_eq!(summary["exchanges"], json!([{"parts": ["near leg", "far leg"], "frames": [3, 4, 7]}]));
        assert_eq!((&summary["unseen"], &summary["footage_changed"]), (&json!([]), &json!(true)));
    }

    #[test]
    fn the_summary_names_parts_that_can_probably_not_be_seen() {
        let part = |name: &str, side: f64, depth: f64| {
            let corners =
                [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Point::new(30.0 + x, 10.0 + y));
            let (tracks, confidence) = ([(3, corners.to_vec())].into(), [(3, vec![0.1; 4])].into());
            Part { name: name.into(), closed: true, depth, tracks, confidence, ..Part::default() }
        };
        let mut scene = empty_scene();
        scene.parts = vec![part("hand", 6.0, 0.0), part("coat", 30.0, 1.0)];
        let summary: Value = serde_json::from_str(&summary(&scene, &Tracking::default(), false)).unwrap();
        assert_eq!(summary["unseen"], json!([{"part": "hand", "frames": [3]}]));
    }

    fn empty_scene() -> Scene {
        let text = r#"{"rototoon": 1, "footage": {"pattern": "%d.png", "first": 0, "last": 9, "fps": 25, "width": 64, "height": 48}, "parts": []}"#;
        Document::parse(text, ORIGIN).unwrap().scene
    }
}
