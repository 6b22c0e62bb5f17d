//! A document that another program wrote while a command worked on it is not written over.
//!
//! `rototoon track shot.json -o shot.json` may take minutes, in which an artist saves the document or another command marks a part as absent. Written over,
//! that work would be gone. So a command remembers what it read. If the file holds something else when the result is ready, the file stays as it is, the
//! result goes into a new file beside it, and the command fails with the names of both.
//!
//! Limits: between the last look and the writing another program may still write, within milliseconds. Pipes and devices are not compared.

use crate::failure::Failure;
use rototoon::project::Document;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// By file a hash of what this command read in it.
static READ: Mutex<BTreeMap<PathBuf, u64>> = Mutex::new(BTreeMap::new());

/// Remembers what a file holds. To be called before it is read: then what is written in between counts as a change.
pub fn remember(path: &Path) {
    if let Some((file, held)) = held(path) {
        READ.lock().unwrap_or_else(PoisonError::into_inner).insert(file, held);
    }
}

/// Writes a document over a file, unless another program wrote the file after this command read it.
///
/// # Errors
///
/// The file was changed: the result is in a new file, which the error names. The document cannot be written.
pub fn save(document: &Document, to: &Path) -> Result<(), Failure> {
    let now = held(to);
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    let is_changed = now.is_some_and(|(file, held)| read.get(&file).is_some_and(|read| *read != held));
    drop(read);
    if !is_changed {
        document.save(to)?;
        remember(to);
        return Ok(());
    }
    let beside = beside(to)?;
    document.save(&beside).inspect_err(|_| drop(fs::remove_file(&beside)))?;
    let (to, beside) = (to.display(), beside.display());
    Err(Failure::Other(format!(
        "{to}: found another content than this command read, so another program wrote the file meanwhile; it stays as it is, and the result is in {beside}"
    )))
}

/// The real path of a file, and a hash of what it holds. None of what is no file, or cannot be read.
fn held(path: &Path) -> Option<(PathBuf, u64)> {
    let file = fs::canonicalize(path).ok().filter(|file| file.is_file())?;
    let mut hasher = DefaultHasher::new();
    fs::read(&file).ok()?.hash(&mut hasher);
    Some((file, hasher.finish()))
}

/// A new, empty file beside another one: `shot (2).json` for `shot.json`.
fn beside(path: &Path) -> Result<PathBuf, Failure> {
    for number in 2.. {
        let mut name = OsString::from(path.file_stem().unwrap_or_default());
        name.push(format!(" ({number})"));
        if let Some(extension) = path.extension() {
            name.push(".");
            name.push(extension);
        }
        let path = path.with_file_name(name);
        match File::create_new(&path) {
            Ok(_) => return Ok(path),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(Failure::Other(format!("{}: {error}", path.display()))),
        }
    }
    unreachable!("a folder does not hold a file for each number")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{"rototoon": 1, "footage": {"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 24, "width": 8, "height": 8}, "parts": []}"#;

    #[test]
    fn what_another_program_wrote_meanwhile_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shot.a.json");
        fs::write(&path, TEXT).unwrap();
        remember(&path);
        let document = Document::load(&path).unwrap();
        save(&document, &path).unwrap();
        // A later command reads it, and meanwhile an artist saves.
        remember(&path);
        let theirs = TEXT.replace("24", "25");
        fs::write(&path, &theirs).unwrap();
        for number in [2, 3] {
            let error = save(&document, &path).unwrap_err().to_string();
            let own = folder.path().join(format!("shot.a ({number}).json"));
            assert!(error.ends_with(&format!("the result is in {}", own.display())), "{error}");
            assert_eq!(Document::load(&own).unwrap(), document);
            assert_eq!(fs::read_to_string(&path).unwrap(), theirs);
        }
    }

    #[test]
    fn a_file_that_was_not_read_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = ["a.json", "b.json"].map(|name| folder.path().join(name));
        fs::write(&from, TEXT).unwrap();
        fs::write(&to, "old").unwrap();
        remember(&from);
        save(&Document::load(&from).unwrap(), &to).unwrap();
        assert!(Document::load(&to).is_ok());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
