//! All steps of a shot, in its folder.

mod files;

use crate::child::{Ended, Program};
use crate::digest::{self, Frames};
use crate::findings::Findings;
use crate::lock::Lock;
use crate::manifest::Shot;
use crate::page;
use crate::record::{Done, Record, RecordError};
use crate::step::Step;
use rototoon::memory::Bytes;
use rototoon::pipeline;
use rototoon::project::place::folder_of;
use rototoon::project::seen::Made;
use rototoon::project::{Document, WriteError};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// What the names of files begin with until they enter the record.
const NEW: &str = ".new-";
/// Time in which a signal reaches all processes of a group.
const SOON: Duration = Duration::from_millis(500);

/// What shots share.
pub struct Worker<'a> {
    /// The command line program.
    pub program: &'a Path,
    /// Threads of a step; 0 for one a core.
    pub threads: usize,
    /// Bytes of decoded frames that are kept from one step to the next.
    pub keep: u64,
    /// Whether the batch was asked to end.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Is told of each step.
    pub told: &'a (dyn Fn(&Shot, &News) + Sync),
}

/// What is told of the steps of a shot while they run.
#[derive(Clone, Debug, PartialEq)]
pub enum News<'a> {
    /// A step begins; steps that are found done do not.
    Begins {
        /// The subcommand.
        step: &'static str,
        /// The number of the program that takes it.
        program: u32,
    },
    /// How far a step is.
    At {
        /// The steps before it.
        before: usize,
        /// The share of it that is done.
        share: f64,
        /// What it does.
        doing: &'a str,
    },
    /// A step ended.
    Ends(StepEnd),
}

/// The end of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepEnd {
    /// The subcommand.
    pub step: &'static str,
    /// Whether it was done, found done, or failed.
    pub outcome: StepOutcome,
    /// Seconds that it took.
    pub seconds: f64,
    /// Seconds of processors that it took.
    pub processor_seconds: f64,
    /// The most memory that it held, in bytes.
    pub peak_bytes: u64,
    /// Bytes of decoded frames among them, kept for later steps.
    pub kept_bytes: u64,
    /// Warnings, notes and errors.
    pub messages: Vec<String>,
}

/// What became of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepOutcome {
    /// It was done.
    Done,
    /// It was done before, and nothing that it reads has changed.
    Unchanged,
    /// It failed.
    Failed,
}

impl StepOutcome {
    /// As in the report.
    pub fn id(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Unchanged => "unchanged",
            Self::Failed => "failed",
        }
    }
}

/// Why a shot did not come to its end.
#[derive(Debug, thiserror::Error)]
pub enum ShotError {
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The record cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A file cannot be read or renamed.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A file of the same name is not the batch's.
    #[error("{}: found a file that the batch did not write, or that was changed since; move it away or choose another name in `to`", .0.display())]
    Foreign(PathBuf),
    /// A step failed.
    #[error("{0}")]
    Step(String),
    /// The batch was stopped.
    #[error("stopped")]
    Stopped,
}

/// A shot while its steps run.
struct Work<'a> {
    shot: &'a Shot,
    worker: &'a Worker<'a>,
    folder: PathBuf,
    lock: &'a Lock,
    record: Record,
    /// Takes the steps; started for the first one that is not done.
    program: Option<Program>,
    /// Names of the steps that this run did for the first time.
    fresh: Vec<&'static str>,
    /// Files with a first name that were there before and that no step of the batch writes.
    foreign: Vec<String>,
}

/// Runs the steps of a shot that are not done, in `folder`. The record then says how it went. What is wrong with the shot
/// is in the record's `failure`; only what concerns the record itself is an error.
///
/// # Errors
///
/// The record cannot be read or written; the batch was stopped.
pub fn run(shot: &Shot, folder: &Path, lock: &Lock, worker: &Worker) -> Result<Record, ShotError> {
    let (record, aside) = Record::read(folder)?;
    let mut work = Work {
        shot,
        worker,
        folder: absolute(folder),
        lock,
        record,
        program: None,
        fresh: Vec::new(),
        foreign: Vec::new(),
    };
    let result = work.steps();
    work.program = None;
    work.record.failure = match result {
        Ok(()) => String::new(),
        Err(ShotError::Stopped) => return Err(ShotError::Stopped),
        Err(error) => error.to_string(),
    };
    if let Some(aside) = aside {
        let note = format!("the damaged record is now {}", aside.display());
        work.record.failure =
            [work.record.failure, note].into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join("; ");
    }
    work.record.asked = Some(digest::of_steps(&shot.steps));
    work.record.write(folder)?;
    Ok(work.record)
}

impl Work<'_> {
    fn steps(&mut self) -> Result<(), ShotError> {
        self.look()?;
        // First of all, so that what a killed worker renamed is known as the batch's own. What cannot get its name may not be wanted any more.
        self.place()?;
        let mut document = absolute(&self.shot.project);
        let frames = self.frames(&document)?;
        for (index, step) in self.shot.steps.iter().enumerate() {
            if (self.worker.stop)() {
                return Err(ShotError::Stopped);
            }
            let hash =
                digest::of_file(&document).map_err(|source| ShotError::File { path: document.clone(), source })?;
            self.step(index, step, &document, &digest::of_step(step, &hash, &frames))?;
            if let (true, Some(output)) = (step.writes_document(), &step.output) {
                document = self.folder.join(output);
            }
        }
        self.give_up_pending()?;
        self.forget()?;
        self.record.ended_bytes = 0;
        // Its memory is free from here on.
        self.program = None;
        self.find(&document, &frames.hash)
    }

    /// The frames of the shot's project.
    fn frames(&self, project: &Path) -> Result<Frames, ShotError> {
        let mut document = Document::load(project).map_err(|error| ShotError::Step(error.lines().join("; ")))?;
        let home = folder_of(project, &document.scene.footage);
        let steps = &self.shot.steps;
        let depends = steps.iter().any(Step::depends_on_footage);
        // An export alone looks at the pictures only if the document knows what they were.
        let is_read = steps.iter().any(Step::reads_footage) || (depends && knows_pictures(&document));
        let hash = match (is_read, depends) {
            (true, _) => digest::of_footage(&document.scene.footage, &home),
            (false, true) => pipeline::pixel_aspect(&document, &home).to_string(),
            (false, false) => String::new(),
        };
        pipeline::relocate(&mut document, &home, &self.folder)
            .map_err(|source| WriteError { path: self.folder.clone(), source })?;
        Ok(Frames { hash, pattern: document.scene.footage.pattern })
    }

    /// Reads what the newest document says, and draws its contact sheet.
    fn find(&mut self, path: &Path, frames: &str) -> Result<(), ShotError> {
        let hash = digest::of_file(path).map_err(|source| ShotError::File { path: path.to_owned(), source })?;
        let seen = format!("{hash} {frames}");
        if self.record.seen == seen && !page::sheet::read(&self.folder).is_empty() {
            return Ok(());
        }
        let document = Document::load(path).map_err(|error| ShotError::Step(error.lines().join("; ")))?;
        let findings = Findings::of(&document.scene);
        let folder = folder_of(path, &document.scene.footage);
        page::sheet::write(&document, &folder, &findings, &self.folder, self.worker.threads)?;
        (self.record.findings, self.record.seen) = (findings, seen);
        Ok(())
    }

    fn step(&mut self, index: usize, step: &Step, document: &Path, reads: &str) -> Result<(), ShotError> {
        if self.settle(index, reads) {
            self.tell(step, StepOutcome::Unchanged, None);
            return Ok(());
        }
        if let Some(path) = self.kept_out(reads) {
            return Err(ShotError::Foreign(path));
        }
        self.begin()?;
        let ended = self.start(index, step, document)?;
        if ended.stopped || (ended.interrupted && self.is_stopped_soon()) {
            self.clear()?;
            return Err(ShotError::Stopped);
        }
        if ended.status != Some(0) {
            self.clear()?;
            if ended.status.is_none() && !ended.interrupted {
                self.record.ended_bytes = self.record.ended_bytes.max(ended.peak_bytes);
            }
            self.tell(step, StepOutcome::Failed, Some(&ended));
            return Err(ShotError::Step(failure(step, &ended)));
        }
        self.finish(index, step, reads, &ended)?;
        self.tell(step, StepOutcome::Done, Some(&ended));
        Ok(())
    }

    /// Makes ready for a step that is not done. What the last run came to holds no longer, also if this one is stopped or killed.
    fn begin(&mut self) -> Result<(), ShotError> {
        self.give_up_pending()?;
        self.clear()?;
        if self.record.asked.as_deref() == Some("") && self.record.failure.is_empty() {
            return Ok(());
        }
        (self.record.asked, self.record.failure) = (Some(String::new()), String::new());
        Ok(self.record.write(&self.folder)?)
    }

    /// Whether the batch is asked to end now or in a moment. A signal to a group of processes, such as Ctrl-C, may reach the program of the steps first.
    fn is_stopped_soon(&self) -> bool {
        let start = Instant::now();
        while !(self.worker.stop)() && start.elapsed() < SOON {
            sleep(SOON / 20);
        }
        (self.worker.stop)()
    }

    /// Whether a step was done with the same input, and its files are as they were written. The manifest may have been edited
    /// since: the record of the step then moves to its present place.
    fn settle(&mut self, index: usize, reads: &str) -> bool {
        let own = |name: &String| self.record.files.get(name).is_some_and(|hash| self.has(name, hash));
        let is_done = |done: &&Done| done.reads == reads && done.outputs.iter().all(own);
        let Some(at) = self.record.steps.iter().skip(index).position(|done| is_done(&done)) else { return false };
        self.record.steps[index..=index + at].rotate_right(1);
        true
    }

    fn start(&mut self, index: usize, step: &Step, document: &Path) -> Result<Ended, ShotError> {
        let prefix = format!("{}{NEW}", folder_text(&self.folder));
        let mut words = step.words(&document.to_string_lossy(), &prefix);
        if step.reads_footage() {
            words.extend(["--threads".to_owned(), self.worker.threads.to_string()]);
        }
        let failed = |source| ShotError::File { path: self.worker.program.to_owned(), source };
        let mut program = match self.program.take() {
            Some(program) => program,
            None => {
                let lock = self.lock.shared().map_err(failed)?;
                Program::start(self.worker.program, &self.folder, lock, self.worker.keep).map_err(failed)?
            }
        };
        let (shot, told) = (self.shot, self.worker.told);
        told(shot, &News::Begins { step: step.name(), program: program.id() });
        let at = |share: f64, doing: &str| told(shot, &News::At { before: index, share, doing });
        let mut ended = program.step(&words, &self.worker.stop, &at).map_err(failed)?;
        ended.messages.iter_mut().for_each(|message| *message = with_final_names(message));
        self.program = Some(program);
        Ok(ended)
    }

    /// Enters a step into the record, and gives its files their names.
    fn finish(&mut self, index: usize, step: &Step, reads: &str, ended: &Ended) -> Result<(), ShotError> {
        let mut pending = BTreeMap::new();
        for new in self.new_files()? {
            let path = self.folder.join(&new);
            let hash = digest::of_file(&path).map_err(|source| ShotError::File { path, source })?;
            pending.insert(new[NEW.len()..].to_owned(), hash);
        }
        let outputs: Vec<String> = pending.keys().cloned().collect();
        self.record.pending = pending;
        let done = Done {
            step: step.name().into(),
            reads: reads.into(),
            outputs,
            seconds: ended.seconds,
            processor_seconds: ended.processor_seconds,
            peak_bytes: ended.peak_bytes,
            kept_bytes: ended.kept_bytes,
            messages: ended.messages.clone(),
        };
        let before = self.enter(index, done);
        if before.is_none() {
            self.fresh.push(step.name());
        }
        self.record.write(&self.folder)?;
        if let Some(path) = self.place()? {
            return Err(ShotError::Foreign(path));
        }
        self.remove_old(&before.unwrap_or_default())
    }

    /// Puts a step into its place in the record. Returns the files of the earlier run of this step, if there was one.
    fn enter(&mut self, index: usize, done: Done) -> Option<Vec<String>> {
        // Later steps stay: if they read what has changed, their hashes say so. Files tell which one is the same step.
        let same = |old: &Done| {
            if done.outputs.is_empty() {
                old.step == done.step
            } else {
                old.outputs.iter().any(|name| done.outputs.contains(name))
            }
        };
        let before = self.record.steps.iter().skip(index).position(same).map(|at| self.record.steps.remove(index + at));
        self.record.steps.insert(index, done);
        before.map(|old| old.outputs)
    }

    /// Forgets the steps that the manifest no longer has. Their files stay, but not those of a step that now writes others: for each that is
    /// forgotten there is a new one with the same subcommand.
    fn forget(&mut self) -> Result<(), ShotError> {
        let old = self.record.steps.split_off(self.shot.steps.len().min(self.record.steps.len()));
        let is_renamed = |own: &&Done| {
            let forgotten = old.iter().filter(|old| old.step == own.step).count();
            forgotten <= self.fresh.iter().filter(|name| **name == own.step).count()
        };
        let names: Vec<String> = old.iter().filter(is_renamed).flat_map(|old| old.outputs.clone()).collect();
        if names.is_empty() { Ok(()) } else { self.remove_old(&names) }
    }

    fn tell(&self, step: &Step, outcome: StepOutcome, ended: Option<&Ended>) {
        let end = StepEnd {
            step: step.name(),
            outcome,
            seconds: ended.map_or(0.0, |ended| ended.seconds),
            processor_seconds: ended.map_or(0.0, |ended| ended.processor_seconds),
            peak_bytes: ended.map_or(0, |ended| ended.peak_bytes),
            kept_bytes: ended.map_or(0, |ended| ended.kept_bytes),
            messages: ended.map(|ended| ended.messages.clone()).unwrap_or_default(),
        };
        (self.worker.told)(self.shot, &News::Ends(end));
    }
}

/// Why a step failed, in one line.
fn failure(step: &Step, ended: &Ended) -> String {
    let errors: Vec<&str> = ended.messages.iter().filter_map(|line| line.strip_prefix("error: ")).collect();
    let (how, last) = (&ended.description, last_words(ended));
    let why = match (ended.status, ended.peak_bytes) {
        (None, 0) => format!("ended by the system ({how}){last}"),
        (None, bytes) => format!("ended by the system ({how}) while it held {}{last}", Bytes(bytes)),
        (Some(_), _) if errors.is_empty() => format!("ended with {how}{last}"),
        (Some(_), _) => errors.join("; "),
    };
    format!("{}: {why}", step.name())
}

/// Whether a document has marks of the pictures from which its results were made.
fn knows_pictures(document: &Document) -> bool {
    Made::ALL.iter().any(|made| document.seen(*made).is_ok_and(|seen| !seen.is_empty()))
}

/// What a program said last, after a colon: the words of a panic, or of an allocation that failed. A list of calls may follow.
fn last_words(ended: &Ended) -> String {
    let said =
        |line: &&String| !line.trim().is_empty() && !line.starts_with("warning: ") && !line.starts_with("note: ");
    let words = ended.messages.iter().take_while(|line| *line != "stack backtrace:").filter(said);
    words.last().map_or_else(String::new, |line| format!(": {line}"))
}

/// A message as if the files had their names already.
fn with_final_names(message: &str) -> String {
    let named = |text: String, separator| text.replace(&format!("{separator}{NEW}"), separator);
    ["/", "\\"].into_iter().fold(message.to_owned(), named)
}

/// A folder with a separator at its end, as text.
fn folder_text(folder: &Path) -> String {
    folder.join("").to_string_lossy().into_owned()
}

/// A path that means the same in any folder.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn messages_have_the_final_names_of_files() {
        for (said, told) in [
            ("error: /o/sh1/.new-m.fbx: no", "error: /o/sh1/m.fbx: no"),
            ("error: C:\\o\\.new-m.fbx: no", "error: C:\\o\\m.fbx: no"),
            ("note: a.new-b", "note: a.new-b"),
        ] {
            assert_eq!(with_final_names(said), told);
        }
    }

    /// A shot in a folder, with one step, which a shell takes as this script: the program is asked for `steps` there.
    fn shot(folder: &Path, script: &str) -> Shot {
        let project = folder.join("project.json");
        fs::write(folder.join("steps"), script).unwrap();
        let footage = json!({"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 12, "width": 64, "height": 48});
        fs::write(&project, json!({"rototoon": 1, "footage": footage, "parts": []}).to_string()).unwrap();
        let steps = vec![Step::read(&json!({"do": "check"})).unwrap()];
        Shot { name: "a".into(), project, blend: None, steps }
    }

    #[test]
    fn a_step_that_the_system_ends_leaves_its_last_words_and_what_it_held() {
        let folder = tempfile::tempdir().unwrap();
        let script = "read a; echo 'memory allocation of 7 bytes failed' >&2; echo 'note: here' >&2
            echo 'stack backtrace:' >&2; echo '   0: main' >&2; sleep 0.5; kill -9 $$";
        let shot = shot(folder.path(), script);
        let (lock, told) = (Lock::take(folder.path()).unwrap().unwrap(), |_: &Shot, _: &News| {});
        let worker = Worker { program: Path::new("/bin/sh"), threads: 1, keep: 0, stop: &|| false, told: &told };
        let record = run(&shot, folder.path(), &lock, &worker).unwrap();
        let failure = record.failure.as_str();
        assert!(failure.starts_with("check: ended by the system (signal: 9"), "{failure}");
        assert!(failure.ends_with(": memory allocation of 7 bytes failed"), "{failure}");
        if cfg!(target_os = "linux") {
            assert!(record.ended_bytes > 0 && failure.contains(" while it held "), "{failure}");
        }
        assert_eq!(Record::read(folder.path()).unwrap().0.peak_bytes(), record.ended_bytes);
    }

    #[test]
    fn a_run_that_is_stopped_leaves_no_failure_of_an_earlier_one() {
        let folder = tempfile::tempdir().unwrap();
        let shot = shot(folder.path(), "read a; exec sleep 60");
        let asked = Some(digest::of_steps(&shot.steps));
        let old = Record { rototoon_record: 1, failure: "old".into(), asked, ..Record::default() };
        old.write(folder.path()).unwrap();
        let began = AtomicBool::new(false);
        let told = |_: &Shot, _: &News| began.store(true, Ordering::Relaxed);
        let stop = || began.load(Ordering::Relaxed);
        let lock = Lock::take(folder.path()).unwrap().unwrap();
        let worker = Worker { program: Path::new("/bin/sh"), threads: 1, keep: 0, stop: &stop, told: &told };
        assert!(matches!(run(&shot, folder.path(), &lock, &worker), Err(ShotError::Stopped)));
        let (record, _) = Record::read(folder.path()).unwrap();
        assert_eq!((record.failure.as_str(), record.asked.as_deref()), ("", Some("")));
    }
}
