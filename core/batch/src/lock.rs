//! One worker a shot.
//!
//! The lock is one of the system on a file in the shot's folder. It ends with the processes that hold it, however they
//! end, so a dead worker holds nothing. A step's program gets the same lock as its standard input: if the worker is
//! killed but not the program, the shot stays locked until the program has ended.
//!
//! Limits: on a network disk the locks of a machine that fell silent end when the server gives them up, commonly after
//! some 90 seconds. On a disk without locks, two workers at one shot write the same bytes twice.

use rototoon::project::WriteError;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

/// Name of the file. It stays: if it were removed, two workers could hold two locks.
pub const LOCK: &str = ".lock";
/// Time between two attempts.
const PAUSE: Duration = Duration::from_millis(50);

/// A lock on a shot's folder.
#[derive(Debug)]
pub struct Lock(File);

impl Lock {
    /// Waits until no other worker holds the folder, or until `stop` is true. `waiting` is called once before a wait.
    ///
    /// # Errors
    ///
    /// The file cannot be made. `None` if stopped.
    pub fn wait(folder: &Path, stop: &dyn Fn() -> bool, waiting: &dyn Fn()) -> Result<Option<Self>, WriteError> {
        let path = folder.join(LOCK);
        let failed = |source: io::Error| WriteError { path: path.clone(), source };
        let file =
            OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path).map_err(failed)?;
        let mut told = false;
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Some(Self(file))),
                Err(TryLockError::WouldBlock) if stop() => return Ok(None),
                Err(TryLockError::WouldBlock) => {
                    if !told {
                        waiting();
                    }
                    told = true;
                    sleep(PAUSE);
                }
                Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
                    return Ok(Some(Self(file)));
                }
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
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
    fn a_second_worker_waits_until_every_handle_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let never = || false;
        let at_once = || true;
        let first = Lock::wait(folder.path(), &never, &|| panic!("nobody holds it")).unwrap().unwrap();
        let shared = first.shared().unwrap();
        drop(first);
        assert!(Lock::wait(folder.path(), &at_once, &|| {}).unwrap().is_none(), "the program still runs");
        drop(shared);
        assert!(Lock::wait(folder.path(), &at_once, &|| {}).unwrap().is_some());
        assert!(Lock::wait(&folder.path().join("none"), &never, &|| {}).is_err());
    }
}
