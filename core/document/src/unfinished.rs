//! Temporary files that are being written, and their removal when the process ends early.
//!
//! A temporary file removes itself when it is dropped. `std::process::exit` drops nothing. So every temporary file is
//! listed here from its creation until it has its final name, and [`remove_all`] removes those that are listed. The list
//! is locked during creation and renaming, so that no file can be on the disk and not on the list.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::Duration;
use tempfile::{Builder, TempPath};

/// The temporary files of this process.
static OPEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Number of times that [`remove_all`] asks for the list, and the pause between. A disk that does not answer may hold
/// the list for ever.
const ATTEMPTS: usize = 20;
const PAUSE: Duration = Duration::from_millis(10);

/// Number of times that a file is renamed where another program holds the target, and the pause between: half a second.
const RENAMES: usize = 10;
const RENAME_PAUSE: Duration = Duration::from_millis(50);

/// A temporary file that is on the list.
pub(crate) struct Unfinished {
    file: File,
    /// Removes the file when it is dropped. There is none once the file has its final name.
    path: Option<TempPath>,
}

impl Unfinished {
    /// Makes a temporary file in a folder.
    pub fn new(builder: &Builder<'_, '_>, folder: &Path) -> io::Result<Self> {
        let mut open = list();
        let (file, path) = builder.tempfile_in(folder)?.into_parts();
        open.insert(path.to_path_buf());
        Ok(Self { file, path: Some(path) })
    }

    /// The file, for writing.
    pub fn as_file(&self) -> &File {
        &self.file
    }

    /// Gives the file its final name. If that fails, the file is removed.
    pub fn persist(mut self, target: &Path) -> io::Result<()> {
        let mut open = list();
        let Some(path) = self.path.take() else { return Ok(()) };
        open.remove(path.as_ref() as &Path);
        renamed(path, target)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Some(path) = self.path.take() {
            let mut open = list();
            open.remove(path.as_ref() as &Path);
        }
    }
}

/// Renames a temporary file. On Windows the target may be held open for a moment, by an indexer or a virus scanner: the
/// system then says that access is denied. So it is asked some more times, and at last the error tells the likely reason.
fn renamed(mut path: TempPath, target: &Path) -> io::Result<()> {
    let mut attempt = 1;
    loop {
        let error = match path.persist(target) {
            Ok(()) => return Ok(()),
            Err(error) => error,
        };
        if !cfg!(windows) || error.error.kind() != io::ErrorKind::PermissionDenied {
            return Err(error.error);
        }
        if attempt == RENAMES {
            let told = "another program has the file open, expected it to be free; close it there";
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, format!("{told} ({})", error.error)));
        }
        attempt += 1;
        path = error.path;
        sleep(RENAME_PAUSE);
    }
}

fn list() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all temporary files of this process. Call it right before the process ends: from then on a write waits for
/// ever.
pub fn remove_all() {
    for _ in 0..ATTEMPTS {
        let open = match OPEN.try_lock() {
            Ok(open) => open,
            Err(TryLockError::Poisoned(error)) => error.into_inner(),
            Err(TryLockError::WouldBlock) => {
                sleep(PAUSE);
                continue;
            }
        };
        for path in open.iter() {
            // What cannot be removed stays: a later process removes it.
            let _ = fs::remove_file(path);
        }
        // No other thread may begin a file now.
        std::mem::forget(open);
        return;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_listed_until_it_has_its_name_or_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let listed = || list().iter().filter(|path| path.starts_with(folder.path())).count();
        let file = Unfinished::new(&Builder::new(), folder.path()).unwrap();
        assert_eq!(listed(), 1);
        drop(file);
        assert_eq!((listed(), fs::read_dir(folder.path()).unwrap().count()), (0, 0));
        let file = Unfinished::new(&Builder::new(), folder.path()).unwrap();
        file.persist(&folder.path().join("a")).unwrap();
        assert_eq!((listed(), fs::read_dir(folder.path()).unwrap().count()), (0, 1));
        let file = Unfinished::new(&Builder::new(), folder.path()).unwrap();
        assert!(file.persist(&folder.path().join("none/a")).is_err());
        assert_eq!((listed(), fs::read_dir(folder.path()).unwrap().count()), (0, 1));
    }
}
