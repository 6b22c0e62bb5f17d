//! What the records of all shots together say: `summary.json`.

use crate::digest;
use crate::findings::WantedKey;
use crate::manifest::{Manifest, Shot};
use crate::names::SUMMARY;
use crate::record::{Found, Record};
use crate::report::rounded;
use rototoon::file;
use rototoon::project::{WriteError, write_whole};
use serde_json::{Value, json};
use std::path::Path;

/// How a shot came out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// No key would make a contour or more right.
    Good,
    /// Some keys would each make a contour or more right.
    WantsKeys,
    /// A step failed, for this reason.
    Failed(String),
    /// No worker has ended it with the steps of the manifest.
    NotRun,
}

impl Outcome {
    /// The outcome of a shot by its record.
    pub fn of(record: &Record) -> Self {
        if !record.failure.is_empty() {
            Self::Failed(record.failure.clone())
        } else if record.findings.wanted.is_empty() {
            Self::Good
        } else {
            Self::WantsKeys
        }
    }

    /// Why it failed; empty if it did not.
    pub fn failure(&self) -> &str {
        if let Self::Failed(reason) = self { reason } else { "" }
    }

    /// As in reports.
    pub fn id(&self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::WantsKeys => "wants_keys",
            Self::Failed(_) => "failed",
            Self::NotRun => "not_run",
        }
    }
}

/// A shot with its record.
#[derive(Clone, Debug)]
pub struct Entry<'a> {
    /// The shot.
    pub shot: &'a Shot,
    /// How it came out.
    pub outcome: Outcome,
    /// Its record; empty if it was not run.
    pub record: Record,
}

/// All shots of a manifest.
#[derive(Clone, Debug)]
pub struct Summary<'a> {
    /// The shots in the order of the manifest.
    pub entries: Vec<Entry<'a>>,
}

impl<'a> Summary<'a> {
    /// Reads the records of all shots in the folder of a batch. Nothing is changed.
    pub fn read(manifest: &'a Manifest, folder: &Path) -> Self {
        let entry = |shot: &'a Shot| match read_record(&folder.join(&shot.name)) {
            Ok(Some(record)) if finished(shot, &record) => Entry { shot, outcome: Outcome::of(&record), record },
            Ok(Some(record)) => Entry { shot, outcome: Outcome::NotRun, record },
            Ok(None) => Entry { shot, outcome: Outcome::NotRun, record: Record::default() },
            Err(reason) => Entry { shot, outcome: Outcome::Failed(reason), record: Record::default() },
        };
        Self { entries: manifest.shots.iter().map(entry).collect() }
    }

    /// Takes the failures of a run of all shots, in their order. A shot whose folder cannot be written has them nowhere else.
    #[must_use]
    pub fn after(mut self, outcomes: &[Outcome]) -> Self {
        for (entry, outcome) in self.entries.iter_mut().zip(outcomes).filter(|(_, outcome)| outcome.id() == "failed") {
            entry.outcome = outcome.clone();
        }
        self
    }

    /// Number of shots that came out so.
    pub fn count(&self, id: &str) -> usize {
        self.entries.iter().filter(|entry| entry.outcome.id() == id).count()
    }

    /// The wanted keys of all shots, the most valuable first.
    pub fn wanted(&self) -> Vec<(&Entry<'a>, &WantedKey)> {
        let keys = |entry: &'_ Entry<'a>| entry.outcome.id() != "failed";
        let mut wanted: Vec<_> = self
            .entries
            .iter()
            .filter(|entry| keys(entry))
            .flat_map(|entry| entry.record.findings.wanted.iter().map(move |key| (entry, key)))
            .collect();
        wanted.sort_by(|a, b| b.1.worth.total_cmp(&a.1.worth));
        wanted
    }

    /// The summary as JSON.
    pub fn json(&self) -> Value {
        let shot = |entry: &Entry| {
            let (record, findings) = (&entry.record, &entry.record.findings);
            json!({
                "shot": entry.shot.name, "outcome": entry.outcome.id(), "failure": entry.outcome.failure(),
                "seconds": rounded(record.seconds()),
                "processor_seconds": rounded(record.processor_seconds()), "peak_bytes": record.peak_bytes(),
                "confidence": findings.confidence, "parts": findings.parts
            })
        };
        let wanted = |(entry, key): &(&Entry, &WantedKey)| json!({"shot": entry.shot.name, "part": key.part, "frame": key.frame, "worth": key.worth, "lost": key.lost});
        json!({
            "rototoon_summary": 1,
            "good": self.count("good"), "wants_keys": self.count("wants_keys"),
            "failed": self.count("failed"), "not_run": self.count("not_run"),
            "wanted": self.wanted().iter().map(wanted).collect::<Vec<_>>(),
            "shots": self.entries.iter().map(shot).collect::<Vec<_>>()
        })
    }

    /// Writes the summary into the folder of a batch.
    ///
    /// # Errors
    ///
    /// The file cannot be written, or is not one of a batch.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        write_own(&folder.join(SUMMARY), format!("{:#}\n", self.json()).as_bytes(), "\"rototoon_summary\"")
    }
}

/// Writes a file of the batch. A file of the same name without `mark` in it is somebody else's and stays.
///
/// # Errors
///
/// The file cannot be written, or is somebody else's.
pub fn write_own(path: &Path, bytes: &[u8], mark: &str) -> Result<(), WriteError> {
    // A pipe or a device is no file of the batch, and might never end.
    let own = match file::bytes(path) {
        Ok(found) => found.windows(mark.len()).any(|part| part == mark.as_bytes()),
        Err(error) => error.kind() == std::io::ErrorKind::NotFound,
    };
    if own {
        return write_whole(path, bytes);
    }
    let source = std::io::Error::other("found a file that the batch did not write; move it away");
    Err(WriteError { path: path.to_owned(), source })
}

/// Whether a record is of a shot that came to its end with the steps that the manifest has now: all are done, or one failed.
fn finished(shot: &Shot, record: &Record) -> bool {
    let asked = record.asked.as_ref().is_none_or(|asked| *asked == digest::of_steps(&shot.steps));
    asked && (!record.failure.is_empty() || (record.steps.len() == shot.steps.len() && record.pending.is_empty()))
}

/// The record of a shot, if there is one; the reason if it cannot be used. Nothing is changed: the next worker sets a damaged
/// one aside.
pub(crate) fn read_record(folder: &Path) -> Result<Option<Record>, String> {
    match Record::find(folder) {
        Ok(Found::Record(record)) => Ok(Some(*record)),
        Ok(Found::None | Found::Damaged) => Ok(None),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let summary = Summary { entries: vec![] };
        summary.write(folder.path()).unwrap();
        summary.write(folder.path()).unwrap();
        std::fs::write(folder.path().join(SUMMARY), "mine").unwrap();
        let error = summary.write(folder.path()).unwrap_err().to_string();
        assert!(error.contains("summary.json") && error.contains("did not write"), "{error}");
        assert_eq!(std::fs::read_to_string(folder.path().join(SUMMARY)).unwrap(), "mine");
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(SUMMARY);
        let summary = Summary { entries: vec![] };
        let refused = || summary.write(folder.path()).unwrap_err().to_string().contains("did not write");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        assert!(refused());
        std::fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        assert!(refused());
    }
}
