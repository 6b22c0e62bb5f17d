//! One worker a shot.
//!
//! The lock is one of the system on a file in the shot's folder. It ends with the processes that hold it, however they
//! end, so a dead worker holds nothing. A step's program gets the same lock as its standard input: if the worker is
//! killed but not the program, the shot stays locked until the program has ended.
//!
//! Limits: on a network disk the locks of a machine that fell silent end when the server gives them up, commonly after
//! some 90 seconds. On a disk without locks, two workers at one shot write the same bytes twice.

use rototoon::file;
use rototoon::project::WriteError;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

/// Name of the file. It stays: if it were removed, two workers could hold two locks.
pub const LOCK: &str = ".lock";

/// A lock on a shot's folder.
#[derive(Debug)]
pub struct Lock(File);

impl Lock {
    /// Takes the folder; `None` if another worker has it.
    ///
    /// # Errors
    ///
    /// The file cannot be made.
    pub fn take(folder: &Path) -> Result<Option<Self>, WriteError> {
        let path = folder.join(LOCK);
        let failed = |source: io::Error| WriteError { path: path.clone(), source };
        let file =
            OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Self(file))),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) if file::knows_no_locks(&error) => Ok(Some(Self(file))),
            Err(TryLockError::Error(error)) => Err(failed(error)),
        }
    }

    /// The lock once more, for a program that shall hold it too.
    ///
    /// # Errors
    ///
    /// The system has no more handles.
    pub fn shared(&self) -> io::Result<File> {
        self.0.try_clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_free_when_every_handle_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let first = Lock::take(folder.path()).unwrap().unwrap();
        assert!(Lock::take(folder.path()).unwrap().is_none());
        let shared = first.shared().unwrap();
        drop(first);
        assert!(Lock::take(folder.path()).unwrap().is_none(), "the program still runs");
        drop(shared);
        assert!(Lock::take(folder.path()).unwrap().is_some());
        assert!(Lock::take(&folder.path().join("none")).is_err());
    }
}
