//! The report: a JSON object in each line, written while the batch runs.
//!
//! `event` is `begin`, `step`, `shot` or `end`. A line has no date: machines of a farm disagree about it. Several workers
//! may write to one file; each line is written at once. If somebody opened the file in another program and saved it
//! without a line end, a new line is begun first. Nothing is ever read back from it.

use rototoon::project::WriteError;
use serde_json::Value;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Where the lines go.
#[derive(Debug)]
pub struct Report {
    path: PathBuf,
    file: Mutex<File>,
}

impl Report {
    /// Opens a report; lines that are there stay.
    ///
    /// # Errors
    ///
    /// The file cannot be opened for writing.
    pub fn open(path: &Path) -> Result<Self, WriteError> {
        let failed = |source| WriteError { path: path.to_owned(), source };
        let mut file = OpenOptions::new().create(true).append(true).read(true).open(path).map_err(failed)?;
        if !ends_with_line(&mut file) {
            file.write_all(b"\n").map_err(failed)?;
        }
        Ok(Self { path: path.to_owned(), file: Mutex::new(file) })
    }

    /// Writes a line.
    ///
    /// # Errors
    ///
    /// The disk is full or gone.
    pub fn line(&self, value: &Value) -> Result<(), WriteError> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(format!("{value}\n").as_bytes()).map_err(|source| WriteError { path: self.path.clone(), source })
    }
}

fn ends_with_line(file: &mut File) -> bool {
    let mut last = [b'\n'];
    // An empty file has no last byte.
    if file.seek(SeekFrom::End(-1)).is_ok() {
        let _ = file.read_exact(&mut last);
    }
    last == [b'\n']
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn lines_are_added_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.jsonl");
        Report::open(&path).unwrap().line(&json!({"a": 1})).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "{\"a\":1}\n");
        std::fs::write(&path, "a;1").unwrap();
        let report = Report::open(&path).unwrap();
        std::thread::scope(|scope| {
            for k in 0..4 {
                let report = &report;
                scope.spawn(move || (0..50).for_each(|n| report.line(&json!({"k": k, "n": n})).unwrap()));
            }
        });
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!((lines[0], lines.len()), ("a;1", 201));
        assert!(lines[1..].iter().all(|line| serde_json::from_str::<Value>(line).is_ok()));
    }
}
