//! Adds clips to a library, one process at a time.

use super::index::ENDING;
use super::{AddError, Entry, INDEX, Index, Library, Trouble, one_clip};
use crate::clips::Clips;
use crate::output::{WriteError, write_whole};
use rototoon_base::scene::Clip;
use serde_json::Map;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// File name of the lock. The file stays: if it were removed, two processes could hold two locks.
const LOCK: &str = "library.lock";

/// Longest time to wait for another process. Adding a clip takes milliseconds.
const WAIT: Duration = Duration::from_secs(30);

/// Greatest number of letters of each label in the name of a clip file. Most systems allow 255 bytes for a name.
const MOST_LETTERS: usize = 80;

impl Library {
    /// Adds a clip. It replaces an earlier clip of the same character and motion. Returns the path of a damaged index
    /// that was set aside, if there was one.
    ///
    /// # Errors
    ///
    /// An [`AddError`] if the index is of a later version or cannot be read, if another process holds the library for
    /// too long, or if a file cannot be written.
    pub fn add(&mut self, clip: &Clip, fps: f64, source: &str) -> Result<Option<PathBuf>, AddError> {
        self.add_all(std::slice::from_ref(clip), fps, source)
    }

    /// Adds some clips, as [`Self::add`] does. The index is written once.
    ///
    /// # Errors
    ///
    /// As for [`Self::add`].
    pub fn add_all(&mut self, clips: &[Clip], fps: f64, source: &str) -> Result<Option<PathBuf>, AddError> {
        let folder = self.folder.clone();
        fs::create_dir_all(&folder).map_err(|source| WriteError { path: folder.clone(), source })?;
        let _lock = lock(&folder.join(LOCK))?;
        // Another process may have added clips since this library was opened.
        *self = Self::open(&folder);
        changeable(&self.index, folder.join(INDEX))?;
        for clip in clips {
            self.put(clip, fps, source)?;
        }
        let aside = if self.index.damaged() { set_aside(&folder)? } else { None };
        write_whole(&folder.join(INDEX), self.index.text().as_bytes())?;
        Ok(aside)
    }

    /// Writes the file of a clip, and its entry in memory.
    fn put(&mut self, clip: &Clip, fps: f64, source: &str) -> Result<(), WriteError> {
        let same = |entry: &Entry| entry.character == clip.character && entry.motion == clip.motion;
        let known = self.index.entries.iter().position(same);
        let own = known.map(|k| self.index.entries[k].file.clone()).filter(|file| self.may_replace(file, clip));
        let entry = Entry {
            file: own.unwrap_or_else(|| self.free_name(clip)),
            character: clip.character.clone(),
            motion: clip.motion.clone(),
            frames: clip.postures.len(),
            fps,
            source: source.to_owned(),
        };
        Clips { clips: vec![clip.clone()], fps }.save(&self.folder.join(&entry.file))?;
        match known {
            Some(k) => self.index.entries[k] = entry,
            None => self.index.push(entry, Map::new()),
        }
        Ok(())
    }

    /// Whether a file has a clip of the same character and motion, or does not exist.
    fn may_replace(&self, file: &str, clip: &Clip) -> bool {
        let path = self.folder.join(file);
        match one_clip(&path) {
            Ok((found, _)) => found.character == clip.character && found.motion == clip.motion,
            Err(_) => !is_there(&path),
        }
    }

    /// A free file name made of letters and digits of both labels, with a number if necessary.
    fn free_name(&self, clip: &Clip) -> String {
        let plain = |text: &str| -> String {
            let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
            text.chars().take(MOST_LETTERS).map(plain).collect()
        };
        let stem = format!("{}-{}", plain(&clip.character), plain(&clip.motion));
        // Some systems do not tell large letters from small ones.
        let listed = |name: &str| self.index.entries.iter().any(|e| e.file.eq_ignore_ascii_case(name));
        let taken = |name: &String| listed(name) || is_there(&self.folder.join(name));
        let numbered = (2..).map(|n| format!("{stem}-{n}{ENDING}"));
        std::iter::once(format!("{stem}{ENDING}")).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
    }
}

/// Whether something has this name, be it a link that leads nowhere.
fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Refuses to change an index that this version does not understand.
fn changeable(index: &Index, path: PathBuf) -> Result<(), AddError> {
    match index.untouchable() {
        Some(Trouble::Later { found, .. }) => Err(AddError::Later { path, found: *found }),
        Some(Trouble::Unreadable { reason, .. }) => Err(AddError::Unreadable { path, reason: reason.clone() }),
        _ => Ok(()),
    }
}

/// Locks a file. The lock ends when the file is closed, also if the process is killed.
fn lock(path: &Path) -> Result<File, AddError> {
    let failed = |source| WriteError { path: path.to_owned(), source };
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path).map_err(failed)?;
    let start = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) if start.elapsed() < WAIT => sleep(Duration::from_millis(10)),
            Err(TryLockError::WouldBlock) => {
                return Err(AddError::Locked { path: path.to_owned(), seconds: WAIT.as_secs() });
            }
            // A disk that knows no locks, such as some of the network.
            Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => return Ok(file),
            Err(TryLockError::Error(error)) => return Err(failed(error).into()),
        }
    }
}

/// Gives a damaged index another name, and returns the new path.
fn set_aside(folder: &Path) -> Result<Option<PathBuf>, WriteError> {
    let path = folder.join(INDEX);
    let free = (1..).map(|n| folder.join(format!("library.damaged-{n}.json"))).find(|path| !is_there(path));
    if let Some(to) = &free {
        fs::rename(&path, to).map_err(|source| WriteError { path, source })?;
    }
    Ok(free)
}
