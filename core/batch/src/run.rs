//! Works through the shots, several at a time.

use crate::budget::{Budget, estimate, kept};
use crate::lock::Lock;
use crate::manifest::{Manifest, Shot};
use crate::record::Record;
use crate::report::Report;
use crate::shot::{self, ShotError, StepEnd, Worker};
use crate::summary::Outcome;
use rototoon::project::{Document, WriteError};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};

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
    /// Is told of each shot that ended, with the number of shots that have.
    pub told: &'a (dyn Fn(&Shot, &Outcome, usize) + Sync),
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

/// Works through the shots of a manifest. A shot that fails does not stop the others.
///
/// # Errors
///
/// A [`BatchError`].
pub fn run(manifest: &Manifest, options: &Options) -> Result<Vec<Outcome>, BatchError> {
    make_folder(&options.folder)?;
    let report = Report::open(&options.report)?;
    report.line(&json!({
        "event": "begin", "shots": options.shots.len(), "jobs": options.jobs, "memory_bytes": options.memory.bytes()
    }))?;
    let (next, ended) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let outcomes: Mutex<Vec<Option<Outcome>>> = Mutex::new(vec![None; options.shots.len()]);
    let trouble: Mutex<Option<BatchError>> = Mutex::new(None);
    let work = || {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(shot) = options.shots.get(at).and_then(|&index| manifest.shots.get(index)) else { return };
            if (options.stop)() || locked(&trouble).is_some() {
                return;
            }
            match one(shot, options, &report) {
                Ok(outcome) => {
                    (options.told)(shot, &outcome, ended.fetch_add(1, Ordering::Relaxed) + 1);
                    locked(&outcomes)[at] = Some(outcome);
                }
                Err(error) => {
                    locked(&trouble).get_or_insert(error);
                }
            }
        }
    };
    std::thread::scope(|scope| (0..options.jobs.max(1)).for_each(|_| drop(scope.spawn(work))));
    if let Some(error) = locked(&trouble).take() {
        return Err(error);
    }
    let outcomes: Vec<Outcome> = locked(&outcomes).drain(..).flatten().collect();
    if outcomes.len() < options.shots.len() {
        return Err(BatchError::Stopped);
    }
    report.line(&end(&outcomes))?;
    Ok(outcomes)
}

fn one(shot: &Shot, options: &Options, report: &Report) -> Result<Outcome, BatchError> {
    let folder = options.folder.join(&shot.name);
    let failed = |error: &dyn std::fmt::Display| Outcome::Failed(error.to_string());
    let outcome = match in_folder(shot, &folder, options, report) {
        Ok(record) => Outcome::of(&record),
        Err(ShotError::Stopped) => return Err(BatchError::Stopped),
        // A folder that vanished concerns this shot alone.
        Err(error) => failed(&error),
    };
    let record = Record::read(&folder).map(|(record, _)| record).unwrap_or_default();
    report.line(&line(shot, &outcome, &record))?;
    Ok(outcome)
}

fn in_folder(shot: &Shot, folder: &Path, options: &Options, report: &Report) -> Result<Record, ShotError> {
    make_folder(folder)?;
    let waiting = || drop(report.line(&json!({"event": "wait", "shot": shot.name})));
    let Some(lock) = Lock::wait(folder, options.stop, &waiting)? else { return Err(ShotError::Stopped) };
    let told = |shot: &Shot, end: &StepEnd| drop(report.line(&step_line(shot, end)));
    let need = need(shot, folder);
    let part = options.memory.bytes() / options.jobs.max(1) as u64;
    let keep = need.frames.min(part.saturating_sub(need.steps));
    let _share = options.memory.take(need.steps.saturating_add(keep));
    let worker = Worker { program: &options.program, threads: options.threads, keep, stop: options.stop, told: &told };
    shot::run(shot, folder, &lock, &worker)
}

/// Bytes that a shot needs.
struct Need {
    /// For its steps: what they took last time, or an estimate.
    steps: u64,
    /// To keep all of its frames decoded.
    frames: u64,
}

fn need(shot: &Shot, folder: &Path) -> Need {
    let before = Record::read(folder).map_or(0, |(record, _)| record.own_bytes());
    // A document that cannot be read is the shot's failure, and told there.
    let Ok(document) = Document::load(&shot.project) else { return Need { steps: before, frames: 0 } };
    let footage = &document.scene.footage;
    let frames = kept(footage, shot.project.parent().unwrap_or(Path::new("")));
    Need { steps: if before > 0 { before } else { estimate(footage) }, frames }
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
        "event": "shot", "shot": shot.name, "outcome": outcome.id(), "failure": record.failure,
        "seconds": rounded(record.seconds()), "processor_seconds": rounded(record.processor_seconds()),
        "peak_bytes": record.peak_bytes(),
        "confidence": rounded(findings.confidence), "lost": lost, "wanted": findings.wanted
    })
}

fn end(outcomes: &[Outcome]) -> Value {
    let count = |id: &str| outcomes.iter().filter(|outcome| outcome.id() == id).count();
    json!({"event": "end", "good": count("good"), "wants_keys": count("wants_keys"), "failed": count("failed")})
}

fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
