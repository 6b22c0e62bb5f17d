//! Works through the shots, several at a time.

use crate::ahead::Ahead;
use crate::budget::{Budget, estimate, kept};
use crate::lock::Lock;
use crate::manifest::{Manifest, Shot};
use crate::queue::{Place, Queue};
use crate::record::Record;
use crate::report::{Report, rounded};
use crate::shot::{self, News, ShotError, StepEnd, Worker};
use crate::step::Step;
use crate::summary::{Outcome, read_record};
use rototoon::project::place::folder_of;
use rototoon::project::{Document, WriteError};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::Duration;

/// Time between two attempts at shots that other workers have.
const PAUSE: Duration = Duration::from_millis(50);

/// How to run a batch.
pub struct Options<'a> {
    /// Folder of the results. Each shot gets a folder in it.
    pub folder: PathBuf,
    /// Indices of the shots.
    pub shots: Vec<usize>,
    /// Shots at a time.
    pub jobs: usize,
    /// Threads of each step.
    pub threads: usize,
    /// Bytes that all shots together may take.
    pub memory: Budget,
    /// The command line program.
    pub program: PathBuf,
    /// Where the report is written.
    pub report: PathBuf,
    /// Whether the batch was asked to end.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Is told of each shot that another worker has when no other is left.
    pub waits: &'a (dyn Fn(&Shot) + Sync),
    /// Is told of each shot that ended, with the number of shots that have.
    pub told: &'a (dyn Fn(&Shot, &Outcome, usize) + Sync),
    /// Is told how far all shots together are, as a share of 1, and what is done.
    pub at: &'a (dyn Fn(f64, &str) + Sync),
}

/// Why a batch could not go on.
#[derive(Debug, thiserror::Error)]
pub enum BatchError {
    /// The folder or the report cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The batch was stopped. Shots that were done stay done.
    #[error("the batch was stopped; start it again to go on")]
    Stopped,
}

/// Works through the shots of a manifest. A shot that fails does not stop the others, nor does one that another worker has.
///
/// # Errors
///
/// A [`BatchError`].
pub fn run(manifest: &Manifest, options: &Options) -> Result<Vec<Outcome>, BatchError> {
    make_folder(&options.folder)?;
    let report = Report::open(&options.report)?;
    let count = options.shots.len();
    report.line(json!({
        "event": "begin", "shots": count, "jobs": options.jobs, "memory_bytes": options.memory.bytes()
    }))?;
    let run = Run {
        manifest,
        options,
        report,
        queue: Queue::new(count),
        ended: AtomicUsize::new(0),
        ahead: Ahead::new(count),
        outcomes: Mutex::new(vec![None; count]),
        trouble: Mutex::new(None),
    };
    std::thread::scope(|scope| (0..options.jobs.max(1)).for_each(|_| drop(scope.spawn(|| run.work()))));
    match locked(&run.trouble).take() {
        None | Some(BatchError::Stopped) => {}
        Some(error) => return Err(error),
    }
    let outcomes: Vec<Outcome> = locked(&run.outcomes).drain(..).flatten().collect();
    if outcomes.len() < count {
        run.report.line(json!({"event": "stop", "ended": outcomes.len(), "shots": count}))?;
        return Err(BatchError::Stopped);
    }
    run.report.line(end(&outcomes))?;
    Ok(outcomes)
}

/// What the threads of a run share.
struct Run<'a> {
    manifest: &'a Manifest,
    options: &'a Options<'a>,
    report: Report,
    queue: Queue,
    /// Number of shots that ended.
    ended: AtomicUsize,
    ahead: Ahead,
    outcomes: Mutex<Vec<Option<Outcome>>>,
    trouble: Mutex<Option<BatchError>>,
}

impl Run<'_> {
    /// Takes shots until none is left.
    fn work(&self) {
        let options = self.options;
        while let Some(place) = self.queue.take() {
            let shot = options.shots.get(place.at).and_then(|&index| self.manifest.shots.get(index));
            let Some(shot) = shot.filter(|_| !(options.stop)() && locked(&self.trouble).is_none()) else { return };
            match self.one(place.at, shot) {
                Ok(Some(outcome)) => {
                    (options.at)(self.ahead.end(place.at), &shot.name);
                    (options.told)(shot, &outcome, self.ended.fetch_add(1, Ordering::Relaxed) + 1);
                    locked(&self.outcomes)[place.at] = Some(outcome);
                }
                Ok(None) => {
                    wait(shot, place, options, &self.report);
                    self.queue.put_back(place);
                }
                Err(error) => {
                    locked(&self.trouble).get_or_insert(error);
                }
            }
        }
    }

    /// Works on a shot; `None` if another worker has it. `at` is its place among the shots to work on.
    fn one(&self, at: usize, shot: &Shot) -> Result<Option<Outcome>, BatchError> {
        let folder = self.options.folder.join(&shot.name);
        let told = |shot: &Shot, news: &News| self.tell(at, shot, news);
        let outcome = match in_folder(shot, &folder, self.options, &told) {
            Ok(Some(record)) => Outcome::of(&record),
            Ok(None) => return Ok(None),
            Err(ShotError::Stopped) => return Err(BatchError::Stopped),
            // A folder that vanished concerns this shot alone.
            Err(error) => Outcome::Failed(error.to_string()),
        };
        let record = read_record(&folder).ok().flatten().unwrap_or_default();
        self.report.line(line(shot, &outcome, &record))?;
        Ok(Some(outcome))
    }

    /// Enters what a shot does into the report, and tells how far all are. A report that cannot be written is found at the end of the shot.
    fn tell(&self, at: usize, shot: &Shot, news: &News) {
        match news {
            News::Begins { step, program } => {
                let _ =
                    self.report.line(json!({"event": "start", "shot": shot.name, "step": step, "program": program}));
            }
            News::At { before, share, doing } => {
                let step = shot.steps.get(*before).map_or("", Step::name);
                let all = self.ahead.at(at, (*before, shot.steps.len()), *share);
                let percent = (100.0 * share).floor();
                (self.options.at)(all, &format!("{}: {step}: {doing}, {percent:.0} %", shot.name));
            }
            News::Ends(end) => drop(self.report.line(step_line(shot, end))),
        }
    }
}

/// Waits a moment for a shot that another worker has. At its first try the free shots still come; then it is told once.
fn wait(shot: &Shot, place: Place, options: &Options, report: &Report) {
    if place.locked == 0 {
        return;
    }
    if place.locked == 1 {
        let _ = report.line(json!({"event": "wait", "shot": shot.name}));
        (options.waits)(shot);
    }
    sleep(PAUSE);
}

fn in_folder(
    shot: &Shot,
    folder: &Path,
    options: &Options,
    told: &(dyn Fn(&Shot, &News) + Sync),
) -> Result<Option<Record>, ShotError> {
    make_folder(folder)?;
    // A shot that waits for memory is free for other workers, and no memory is asked for one that another worker has.
    if Lock::take(folder)?.is_none() {
        return Ok(None);
    }
    let need = need(shot, folder, options.threads);
    let part = options.memory.bytes() / options.jobs.max(1) as u64;
    let keep = need.frames.min(part.saturating_sub(need.steps));
    let _share = options.memory.take(need.steps.saturating_add(keep));
    let Some(lock) = Lock::take(folder)? else { return Ok(None) };
    let worker = Worker { program: &options.program, threads: options.threads, keep, stop: options.stop, told };
    shot::run(shot, folder, &lock, &worker).map(Some)
}

/// Bytes that a shot needs.
struct Need {
    /// For its steps: what they took last time, or an estimate.
    steps: u64,
    /// To keep all of its frames decoded.
    frames: u64,
}

fn need(shot: &Shot, folder: &Path, threads: usize) -> Need {
    let record = read_record(folder).ok().flatten().unwrap_or_default();
    // What it held when the system ended it was not enough.
    let before = record.own_bytes().max(record.ended_bytes.saturating_add(record.ended_bytes / 2));
    // A document that cannot be read is the shot's failure, and told there.
    let Ok(document) = Document::load(&shot.project) else { return Need { steps: before, frames: 0 } };
    let scene = &document.scene;
    let frames = kept(&scene.footage, &folder_of(&shot.project, &scene.footage));
    // The steps that are done may have been the small ones.
    let known = before > 0 && record.ended_bytes == 0 && record.steps.len() >= shot.steps.len();
    Need { steps: if known { before } else { before.max(estimate(scene, threads)) }, frames }
}

fn make_folder(folder: &Path) -> Result<(), WriteError> {
    std::fs::create_dir_all(folder).map_err(|source| WriteError { path: folder.to_owned(), source })
}

fn step_line(shot: &Shot, end: &StepEnd) -> Value {
    json!({
        "event": "step", "shot": shot.name, "step": end.step, "outcome": end.outcome.id(), "seconds": rounded(end.seconds),
        "processor_seconds": rounded(end.processor_seconds), "peak_bytes": end.peak_bytes, "kept_bytes": end.kept_bytes,
        "messages": end.messages
    })
}

fn line(shot: &Shot, outcome: &Outcome, record: &Record) -> Value {
    let findings = &record.findings;
    let lost: Vec<_> = findings.parts.iter().filter(|part| !part.lost.is_empty()).map(|part| &part.name).collect();
    json!({
        "event": "shot", "shot": shot.name, "outcome": outcome.id(), "failure": outcome.failure(),
        "seconds": rounded(record.seconds()), "processor_seconds": rounded(record.processor_seconds()),
        "peak_bytes": record.peak_bytes(),
        "confidence": rounded(findings.confidence), "lost": lost, "wanted": findings.wanted
    })
}

fn end(outcomes: &[Outcome]) -> Value {
    let count = |id: &str| outcomes.iter().filter(|outcome| outcome.id() == id).count();
    json!({"event": "end", "good": count("good"), "wants_keys": count("wants_keys"), "failed": count("failed")})
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A manifest of one shot, whose project does not exist.
    fn manifest() -> Manifest {
        let steps = vec![Step::read(&json!({"do": "check"})).unwrap()];
        Manifest { shots: vec![Shot { name: "a".into(), project: "none.json".into(), blend: None, steps }] }
    }

    #[test]
    fn a_shot_that_waits_for_memory_is_free_for_others() {
        let folder = tempfile::tempdir().unwrap();
        let (manifest, shot) = (manifest(), folder.path().join("a"));
        // A record says what the shot needs.
        let done = crate::record::Done { peak_bytes: 10, ..Default::default() };
        std::fs::create_dir(&shot).unwrap();
        Record { rototoon_record: 1, steps: vec![done], ..Record::default() }.write(&shot).unwrap();
        let options = Options {
            folder: folder.path().to_owned(),
            shots: vec![0],
            jobs: 1,
            threads: 1,
            memory: Budget::new(10),
            program: "none".into(),
            report: folder.path().join("report.jsonl"),
            stop: &|| false,
            waits: &|_| {},
            told: &|_, _, _| {},
            at: &|_, _| {},
        };
        let all = options.memory.take(10);
        std::thread::scope(|scope| {
            let run = scope.spawn(|| run(&manifest, &options));
            // Long enough to come to the memory; it holds the lock for a moment before.
            let start = std::time::Instant::now();
            while !shot.join(crate::lock::LOCK).exists() && start.elapsed() < Duration::from_secs(60) {
                sleep(PAUSE);
            }
            sleep(Duration::from_millis(300));
            assert!(Lock::take(&shot).unwrap().is_some());
            drop(all);
            assert!(matches!(run.join().unwrap().unwrap()[..], [Outcome::Failed(_)]));
        });
    }

    #[test]
    fn a_shot_that_the_system_ended_gets_more_memory() {
        let folder = tempfile::tempdir().unwrap();
        let (manifest, project) = (manifest(), folder.path().join("project.json"));
        let footage = json!({"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 12, "width": 64, "height": 48});
        std::fs::write(&project, json!({"rototoon": 1, "footage": footage, "parts": []}).to_string()).unwrap();
        let shot = Shot { project, ..manifest.shots[0].clone() };
        let steps = |record: Record| {
            Record { rototoon_record: 1, ..record }.write(folder.path()).unwrap();
            need(&shot, folder.path(), 1).steps
        };
        let done = |bytes| vec![crate::record::Done { peak_bytes: bytes, ..Default::default() }];
        let estimate = steps(Record::default());
        assert!(estimate > 50_000_000);
        assert_eq!(steps(Record { steps: done(9), ..Record::default() }), 9, "what it took");
        assert_eq!(steps(Record { ended_bytes: 2_000_000_000, ..Record::default() }), 3_000_000_000);
        // A small step is done; the one that failed is not known.
        assert_eq!(steps(Record { steps: done(9), ended_bytes: 10, ..Record::default() }), estimate);
    }
}
