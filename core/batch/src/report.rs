//! The report: a JSON object in each line, written while the batch runs.
//!
//! `event` is `begin`, `wait`, `start`, `step`, `shot`, `stop` or `end`. Each line says when it was written, and by whom: `time` (UTC, RFC 3339), `host` and `pid`, the
//! worker's process. So a wrangler sees which worker has which step since when, and finds the one that hangs: a `start` without its `step`, whose worker wrote no
//! `stop` or `end` after it. Lines of one worker, that is, of one host and pid, are in order. Those of two need not be: clocks of a farm's machines differ by seconds,
//! and of two workers on one machine either may write first. Results have no times, so their bytes are the same on each run.
//!
//! Several workers may write to one file; each line is written at once. If somebody opened the file in another program and saved it
//! without a line end, a new line is begun first. Nothing is ever read back from it.
//!
//! Lines are added to a report only, never to another file. A report is known by how its first line begins. Spreadsheets
//! put a mark before it and double its quotes, so these are not looked at.

use crate::host;
use rototoon::project::WriteError;
use serde_json::{Value, json};
use std::fs::{File, OpenOptions};
use std::io::{Error, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

/// What the first line of a report begins with, without quotes.
const BEGIN: &str = "{event:";
/// Number of bytes that are read of a file to know it as a report.
const LOOKED_AT: u64 = 64;

/// Checks that a file may get the lines of a report: it is one, it is empty, or nothing is there.
///
/// # Errors
///
/// It is another file.
pub fn check(path: &Path) -> Result<(), WriteError> {
    // Pipes and devices have no lines. What cannot be read is found when it is opened.
    let regular = std::fs::metadata(path).is_ok_and(|data| data.is_file());
    let Some(file) = regular.then(|| File::open(path).ok()).flatten() else { return Ok(()) };
    let mut begin = Vec::new();
    let failed = |source| WriteError { path: path.to_owned(), source };
    file.take(LOOKED_AT).read_to_end(&mut begin).map_err(failed)?;
    let text = String::from_utf8_lossy(&begin).replace(['\u{feff}', '"'], "");
    if begin.is_empty() || text.starts_with(BEGIN) {
        return Ok(());
    }
    Err(failed(Error::other("found a file that is no report of a batch, expected one or a name that is free")))
}

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
    /// The file is no report, or cannot be opened for writing.
    pub fn open(path: &Path) -> Result<Self, WriteError> {
        check(path)?;
        let failed = |source| WriteError { path: path.to_owned(), source };
        let mut file = OpenOptions::new().create(true).append(true).read(true).open(path).map_err(failed)?;
        if !ends_with_line(&mut file) {
            file.write_all(b"\n").map_err(failed)?;
        }
        Ok(Self { path: path.to_owned(), file: Mutex::new(file) })
    }

    /// Writes a line, with the time, the host and the process at its end.
    ///
    /// # Errors
    ///
    /// The disk is full or gone.
    pub fn line(&self, mut value: Value) -> Result<(), WriteError> {
        // The time is taken when it is this line's turn, so that the lines of a worker are in order.
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        for (name, what) in [
            ("time", json!(host::time(SystemTime::now()))),
            ("host", json!(host::name())),
            ("pid", json!(std::process::id())),
        ] {
            value[name] = what;
        }
        file.write_all(format!("{value}\n").as_bytes()).map_err(|source| WriteError { path: self.path.clone(), source })
    }
}

/// A number of a report: three places are enough for seconds and for confidence.
pub fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
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
        Report::open(&path).unwrap().line(json!({"event": 1})).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("{\"event\":1,\"time\":\"2") && text.ends_with("}\n"), "{text}");
        let line: Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&line["host"], &line["pid"]), (&json!(host::name()), &json!(std::process::id())));
        std::fs::write(&path, "\"{\"\"event\"\":1}\"").unwrap();
        let report = Report::open(&path).unwrap();
        std::thread::scope(|scope| {
            for k in 0..4 {
                let report = &report;
                scope.spawn(move || (0..50).for_each(|n| report.line(json!({"k": k, "n": n})).unwrap()));
            }
        });
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!((lines[0], lines.len()), ("\"{\"\"event\"\":1}\"", 201));
        let times = lines[1..].iter().map(|line| serde_json::from_str::<Value>(line).unwrap()["time"].to_string());
        assert!(times.is_sorted(), "{text}");
    }

    #[test]
    fn files_that_are_no_report_get_no_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        for bytes in [&b"\x89PNG\r\n\x1a\n"[..], b"{\"rototoon_batch\": 1}", b"[]", b"\n"] {
            std::fs::write(&path, bytes).unwrap();
            let error = Report::open(&path).unwrap_err().to_string();
            assert!(error.contains("frame.png") && error.contains("no report"), "{error}");
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
        }
        std::fs::write(&path, "").unwrap();
        assert!(Report::open(&path).is_ok());
    }
}
