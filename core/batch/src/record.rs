//! What was done for a shot: `batch.json` in the shot's folder.
//!
//! The record knows each file that a worker wrote, by its hash. So a file of the same name that somebody else wrote, or
//! changed afterwards, is recognised and never replaced.

use crate::findings::Findings;
use rototoon::project::{WriteError, write_whole};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Name of the file.
pub const RECORD: &str = "batch.json";
/// Version of the format.
const VERSION: u64 = 1;

/// What was done for a shot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the format.
    pub rototoon_record: u64,
    /// The steps that are done, in their order.
    pub steps: Vec<Done>,
    /// Hash of each file that a worker wrote.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
    /// Hash of each file that still has its first name.
    #[serde(default)]
    pub pending: BTreeMap<String, String>,
    /// The most memory that a step held which the system ended; 0 if the shot came to its end since.
    #[serde(default)]
    pub ended_bytes: u64,
    /// Why the shot failed; empty if it did not.
    #[serde(default)]
    pub failure: String,
    /// Hash of the steps that the last run came to its end with; empty while one has begun and not ended. Records of earlier versions have none.
    #[serde(default)]
    pub asked: Option<String>,
    /// Hash of what the findings and the contact sheet were made of.
    #[serde(default)]
    pub seen: String,
    /// What the newest document says.
    #[serde(default)]
    pub findings: Findings,
}

/// A step that is done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Done {
    /// The subcommand.
    pub step: String,
    /// Hash of what it read.
    pub reads: String,
    /// The files that it wrote.
    pub outputs: Vec<String>,
    /// Seconds that it took.
    pub seconds: f64,
    /// Seconds of processors that it took; 0 where the system does not say it.
    #[serde(default)]
    pub processor_seconds: f64,
    /// The most memory that it held, in bytes; 0 where the system does not say it.
    pub peak_bytes: u64,
    /// Bytes of decoded frames among them, kept for later steps.
    #[serde(default)]
    pub kept_bytes: u64,
    /// Its warnings and notes.
    pub messages: Vec<String>,
}

/// Why a record cannot be used. It stays as it is.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// It cannot be read, at least not now or not by this user.
    #[error("{}: cannot read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A later version of the program wrote it.
    #[error("{}: found a record of version {version}, expected {VERSION}: a later version of the program wrote it", path.display())]
    Later {
        /// The file.
        path: PathBuf,
        /// The version of its format.
        version: u64,
    },
    /// It is damaged, and cannot be renamed.
    #[error(transparent)]
    Aside(#[from] WriteError),
}

/// What is found in the place of a record.
pub(crate) enum Found {
    /// No file.
    None,
    /// A record.
    Record(Box<Record>),
    /// A file that is no record.
    Damaged,
}

impl Record {
    /// Reads the record of a folder. What was read and is none is set aside under another name: its path is returned too.
    ///
    /// # Errors
    ///
    /// A record that cannot be read, or is of a later version; a damaged one that cannot be renamed.
    pub fn read(folder: &Path) -> Result<(Self, Option<PathBuf>), RecordError> {
        let empty = Self { rototoon_record: VERSION, ..Self::default() };
        match Self::find(folder)? {
            Found::Record(record) => Ok((*record, None)),
            Found::None => Ok((empty, None)),
            Found::Damaged => Ok((empty, Some(set_aside(folder, &folder.join(RECORD))?))),
        }
    }

    /// Looks for the record of a folder. Nothing is changed.
    pub(crate) fn find(folder: &Path) -> Result<Found, RecordError> {
        let path = folder.join(RECORD);
        let text = match rototoon::file::text(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Found::None),
            Err(error) if error.kind() == ErrorKind::InvalidData => return Ok(Found::Damaged),
            Err(source) => return Err(RecordError::Read { path, source }),
        };
        let Ok(value) = serde_json::from_str::<Value>(&text) else { return Ok(Found::Damaged) };
        match value.get("rototoon_record").and_then(Value::as_u64) {
            Some(version) if version > VERSION => return Err(RecordError::Later { path, version }),
            Some(VERSION) => {}
            _ => return Ok(Found::Damaged),
        }
        Ok(serde_json::from_value(value).map_or(Found::Damaged, |record| Found::Record(Box::new(record))))
    }

    /// Writes the record.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        let text = serde_json::to_string_pretty(self).unwrap_or_default() + "\n";
        write_whole(&folder.join(RECORD), text.as_bytes())
    }

    /// The most memory that any step held.
    pub fn peak_bytes(&self) -> u64 {
        self.steps.iter().map(|done| done.peak_bytes).max().unwrap_or(0).max(self.ended_bytes)
    }

    /// The most memory that any step held for itself, without the frames that were kept.
    pub fn own_bytes(&self) -> u64 {
        self.steps.iter().map(|done| done.peak_bytes.saturating_sub(done.kept_bytes)).max().unwrap_or(0)
    }

    /// Seconds of processors of all steps.
    pub fn processor_seconds(&self) -> f64 {
        sum(self.steps.iter().map(|done| done.processor_seconds))
    }

    /// Seconds of all steps.
    pub fn seconds(&self) -> f64 {
        sum(self.steps.iter().map(|done| done.seconds))
    }
}

/// A sum that is 0 for nothing; that of the standard library is −0, which shows in a report.
fn sum(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}

fn set_aside(folder: &Path, path: &Path) -> Result<PathBuf, WriteError> {
    let free = |path: &PathBuf| fs::symlink_metadata(path).is_err();
    let to = (1..u32::MAX).map(|n| folder.join(format!("batch.damaged-{n}.json"))).find(free).unwrap_or_default();
    fs::rename(path, &to).map_err(|source| WriteError { path: path.to_owned(), source })?;
    Ok(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Record::read(folder.path()).unwrap().0.steps, []);
        let done = Done {
            step: "track".into(),
            reads: "1".into(),
            outputs: vec!["a".into()],
            seconds: 0.1,
            ..Done::default()
        };
        let record = Record { rototoon_record: 1, steps: vec![done], failure: "no".into(), ..Record::default() };
        record.write(folder.path()).unwrap();
        assert_eq!(Record::read(folder.path()).unwrap(), (record, None));
    }

    #[test]
    fn a_damaged_record_is_kept_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let whole = r#"{"rototoon_record": 1, "steps": []}"#;
        for text in ["{", "", r#"{"rototoon_record": 0, "steps": []}"#, &whole[..20], r#"{"rototoon_record": 1}"#] {
            fs::write(folder.path().join(RECORD), text).unwrap();
            let (record, aside) = Record::read(folder.path()).unwrap();
            assert_eq!(record.steps, []);
            assert_eq!(fs::read_to_string(aside.unwrap()).unwrap(), text);
        }
    }

    #[test]
    fn a_record_of_a_later_version_or_out_of_reach_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RECORD);
        let later = r#"{"rototoon_record": 9, "stages": []}"#;
        fs::write(&path, later).unwrap();
        let error = Record::read(folder.path()).unwrap_err().to_string();
        assert!(error.contains("found a record of version 9, expected 1"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), later);
        fs::remove_file(&path).unwrap();
        fs::create_dir(&path).unwrap();
        let error = Record::read(folder.path()).unwrap_err().to_string();
        assert!(error.contains("batch.json: cannot read: "), "{error}");
        assert!(path.is_dir());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
