//! A document that another program wrote while somebody worked on it is not written over.
//!
//! `rototoon track shot.json -o shot.json` may take minutes, and a session in Python or a file in Blender stays open for days. Meanwhile an artist saves the
//! document, or another command marks a part as absent. Written over, that work would be gone. So whoever reads a document remembers what the file held
//! ([`Mark`]). If the file holds something else when the result is ready, the file stays as it is, the result goes into a new file beside it, and the caller
//! gets an error with the names of both.
//!
//! The command line and the C ABI keep a [`Known`] of what they read and wrote. A host that keeps documents itself, such as Blender or a compositor, keeps
//! marks as text in its own file, and calls [`replace`].
//!
//! The last look comes when the result is on the disk and has only to get its name. Programs of Rototoon on one machine do that one after the other, so none of
//! them misses what another one wrote.
//!
//! Limits: another program may still write between that look and the new name. So may Rototoon on another machine, or where the disk knows no locks. Pipes and devices are not compared. A file that nobody
//! read here is replaced: the user chose its name.

use crate::project::path::real;
use crate::project::{Document, SaveError, WriteError, write_whole, write_whole_unless};
use blake3::Hash;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// What a file held, as a hash. It is the same on all machines, so files may keep it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark(Hash);

/// The marks of files that were read or written, by their real paths.
#[derive(Clone, Debug, Default)]
pub struct Known(BTreeMap<PathBuf, Mark>);

/// Why the file itself does not hold the result.
#[derive(Debug, thiserror::Error)]
pub enum ReplaceError {
    /// Another program wrote the file. The result is in another one.
    #[error(
        "{}: found another content than was read, so another program wrote the file meanwhile; it stays as it is, and the result is in {}",
        path.display(), beside.display()
    )]
    Changed {
        /// The file as it was given.
        path: PathBuf,
        /// The new file beside it, which has the result.
        beside: PathBuf,
    },
    /// The document cannot be saved.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Mark {
    /// The mark of what a file holds now. `None` of what is no file, or cannot be read.
    pub fn of(path: &Path) -> Option<Self> {
        is_file(path).then(|| fs::read(path).ok().map(|bytes| Self::of_bytes(&bytes)))?
    }

    /// The mark of a text that [`fmt::Display`] wrote. `None` if it is no mark.
    pub fn parse(text: &str) -> Option<Self> {
        Hash::from_hex(text).ok().map(Self)
    }

    fn of_bytes(bytes: &[u8]) -> Self {
        Self(blake3::hash(bytes))
    }
}

impl fmt::Display for Mark {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{}", self.0.to_hex())
    }
}

impl Known {
    /// Nothing is known yet.
    pub const fn new() -> Self {
        Self(BTreeMap::new())
    }

    /// Remembers what a file holds. To be called before it is read: then what is written in between counts as a change.
    pub fn remember(&mut self, path: &Path) {
        if let (Ok(file), Some(mark)) = (real(path), Mark::of(path)) {
            self.0.insert(file, mark);
        }
    }

    /// Writes a document over a file, unless another program wrote the file after it was read or written here.
    ///
    /// # Errors
    ///
    /// A [`ReplaceError`].
    pub fn save(&mut self, document: &Document, to: &Path) -> Result<(), ReplaceError> {
        let text = document.to_save(to)?;
        let read = real(to).ok().and_then(|file| self.0.get(&file).copied());
        let mark = replace(to, &text, read.as_slice())?;
        if let (Ok(file), true) = (real(to), is_file(to)) {
            self.0.insert(file, mark);
        }
        Ok(())
    }
}

/// Writes a text over a file, completely or not at all, unless the file holds something else than when one of the marks `read` was taken. Without marks the
/// file is replaced. Returns the mark of the text.
///
/// # Errors
///
/// A [`ReplaceError`].
pub fn replace(path: &Path, text: &str, read: &[Mark]) -> Result<Mark, ReplaceError> {
    let result = Mark::of_bytes(text.as_bytes());
    // Where another program wrote the same result, nothing would be lost.
    let is_changed = || is_file(path) && Mark::of(path).is_none_or(|found| found != result && !read.contains(&found));
    if write_whole_unless(path, text.as_bytes(), &|| !read.is_empty() && is_changed())? {
        return Ok(result);
    }
    let beside = beside(path)?;
    write_whole(&beside, text.as_bytes()).inspect_err(|_| drop(fs::remove_file(&beside)))?;
    Err(ReplaceError::Changed { path: path.to_owned(), beside })
}

fn is_file(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| found.is_file())
}

/// A new, empty file beside another one: `shot (2).json` for `shot.json`.
fn beside(path: &Path) -> Result<PathBuf, WriteError> {
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
            Err(source) => return Err(WriteError { path, source }),
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
        let mut known = Known::new();
        known.remember(&path);
        let document = Document::load(&path).unwrap();
        known.save(&document, &path).unwrap();
        // What was written here is known too. Meanwhile an artist saves.
        known.save(&document, &path).unwrap();
        let theirs = TEXT.replace("24", "25");
        fs::write(&path, &theirs).unwrap();
        for number in [2, 3] {
            let error = known.save(&document, &path).unwrap_err().to_string();
            let own = folder.path().join(format!("shot.a ({number}).json"));
            assert!(error.ends_with(&format!("the result is in {}", own.display())), "{error}");
            assert_eq!(Document::load(&own).unwrap(), document);
            assert_eq!(fs::read_to_string(&path).unwrap(), theirs);
        }
        fs::remove_file(&path).unwrap();
        known.save(&document, &path).unwrap();
    }

    #[test]
    fn a_file_that_was_not_read_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = ["a.json", "b.json"].map(|name| folder.path().join(name));
        fs::write(&from, TEXT).unwrap();
        fs::write(&to, "old").unwrap();
        let mut known = Known::new();
        known.remember(&from);
        known.save(&Document::load(&from).unwrap(), &to).unwrap();
        assert!(Document::load(&to).is_ok());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn the_same_result_of_another_program_is_no_change() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shot.json");
        fs::write(&path, "old").unwrap();
        let read = Mark::of(&path).unwrap();
        fs::write(&path, "new").unwrap();
        let mark = replace(&path, "new", &[read]).unwrap();
        assert_eq!(Mark::parse(&mark.to_string()), Mark::of(&path));
        assert!(replace(&path, "newer", &[read]).is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_can_no_longer_be_read_counts_as_changed() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shot.json");
        fs::write(&path, "old").unwrap();
        let read = Mark::of(&path).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o200)).unwrap();
        // The superuser reads every file.
        if fs::read(&path).is_err() {
            assert!(matches!(replace(&path, "new", &[read]), Err(ReplaceError::Changed { .. })));
        }
    }

    #[test]
    fn a_mark_is_a_text_of_its_own() {
        assert!(Mark::parse("").is_none() && Mark::parse("00").is_none() && Mark::parse("not a mark").is_none());
        assert!(Mark::of(Path::new("no such file")).is_none() && Mark::of(&std::env::temp_dir()).is_none());
    }
}
