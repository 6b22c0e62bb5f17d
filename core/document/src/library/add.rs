//! Adds clips to a library, one process at a time.
//!
//! **What is there.** A clip of the same character and motion may be another shot's, or a colleague's. So
//! [`Existing::Refuse`] writes nothing if one of the clips is there. The look and the writing are under one lock: of two
//! processes that add the same clip at once, one gets the error. An entry whose file is gone is no clip that could be
//! lost; an entry whose file is damaged may be one.

use super::index::ENDING;
use super::{AddError, Content, Entry, INDEX, Index, Library, Taken, Trouble};
use crate::clips::Clips;
use crate::output::{WriteError, write_whole};
use rototoon_base::file;
use rototoon_base::scene::Clip;
use serde_json::Map;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// File name of the lock. The file stays: if it were removed, two processes could hold two locks.
const LOCK: &str = "library.lock";

/// Rights on the lock's file: it is empty, and who changes the library is decided by the rights on the folder.
#[cfg(unix)]
const FOR_ALL: u32 = 0o666;

/// Longest time to wait for another process. Adding a clip takes milliseconds.
const WAIT: Duration = Duration::from_secs(30);

/// Greatest number of letters of each label in the name of a clip file. Most systems allow 255 bytes for a name.
const MOST_LETTERS: usize = 80;

/// What happens to clips of the library that have the character and the motion of a clip that is added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// They stay, and nothing is added.
    #[default]
    Refuse,
    /// They are replaced.
    Replace,
}

/// Clips of one source that are added.
#[derive(Clone, Copy, Debug)]
pub struct Addition<'a> {
    /// The clips. No two of all that is added have the same character and motion.
    pub clips: &'a Clips,
    /// Source of the clips; may be empty.
    pub source: &'a str,
}

/// What was done beside adding clips.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Added {
    /// The entries of clips that were there and have been replaced, as they were.
    pub replaced: Vec<Entry>,
    /// Path of a damaged index that was set aside.
    pub aside: Option<PathBuf>,
    /// Whether the disk knows no locks, so that nothing kept other programs from changing the library at the same time.
    pub unlocked: bool,
}

impl Library {
    /// Adds clips, all or none of them. The index is written once.
    ///
    /// # Errors
    ///
    /// An [`AddError`] if a clip is there and must not be replaced, if two of the added clips are of the same character
    /// and motion, if the index is of a later version or cannot be read, if another process holds the library for too
    /// long, or if a file cannot be written.
    pub fn add(&mut self, added: &[Addition<'_>], existing: Existing) -> Result<Added, AddError> {
        let folder = self.folder.clone();
        fs::create_dir_all(&folder).map_err(|source| WriteError { path: folder.clone(), source })?;
        let lock = lock(&folder.join(LOCK))?;
        // Another process may have added clips since this library was opened.
        *self = Self::open(&folder);
        changeable(&self.index, folder.join(INDEX))?;
        self.correct();
        let clips = || added.iter().flat_map(|one| one.clips.clips.iter().map(move |clip| (clip, one)));
        once(clips().map(|(clip, _)| clip))?;
        let replaced: Vec<Entry> = clips().filter_map(|(clip, _)| self.existing(clip)).cloned().collect();
        if let (Existing::Refuse, Some(first)) = (existing, replaced.first()) {
            let taken = Taken { folder, first: first.clone(), more: replaced.len() - 1 };
            return Err(AddError::Taken(Box::new(taken)));
        }
        for (clip, one) in clips() {
            self.put(clip, one.clips.fps, one.source)?;
        }
        let aside = if self.index.damaged() { set_aside(&folder)? } else { None };
        write_whole(&folder.join(INDEX), self.index.text().as_bytes())?;
        Ok(Added { replaced, aside, unlocked: lock.is_none() })
    }

    /// Brings the entries to what their files say: names may have been changed in a file. An entry whose file has the clip of another
    /// one stays as it is, with the fields that others have added to it.
    fn correct(&mut self) {
        let found = self.read_files(self.index.entries.iter()).clips;
        let mut found: BTreeMap<String, Entry> =
            found.into_iter().map(|(entry, _)| (entry.file.clone(), entry)).collect();
        for entry in &mut self.index.entries {
            *entry = found.remove(&entry.file).unwrap_or_else(|| entry.clone());
        }
    }

    /// The entry of a clip of the same character and motion whose file has it, or may have it.
    fn existing(&self, clip: &Clip) -> Option<&Entry> {
        let (k, content) = self.entry_of(clip)?;
        (content != Content::Other).then(|| &self.index.entries[k])
    }

    /// Writes the file of a clip, and its entry in memory.
    fn put(&mut self, clip: &Clip, fps: f64, source: &str) -> Result<(), WriteError> {
        let known = self.entry_of(clip).map(|(k, _)| k);
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
        !is_there(&path) || Content::of(&path, clip) == Content::Same
    }

    /// A free file name made of letters and digits of both labels, with a number if necessary.
    fn free_name(&self, clip: &Clip) -> String {
        let stem = stem(clip);
        // Some systems do not tell large letters from small ones.
        let listed = |name: &str| self.index.entries.iter().any(|e| e.file.eq_ignore_ascii_case(name));
        let taken = |name: &String| listed(name) || is_there(&self.folder.join(name));
        let numbered = (2..).map(|n| format!("{stem}-{n}{ENDING}"));
        std::iter::once(format!("{stem}{ENDING}")).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
    }
}

/// Refuses clips of which one would replace another.
fn once<'a>(clips: impl Iterator<Item = &'a Clip>) -> Result<(), AddError> {
    let mut seen = BTreeSet::new();
    for clip in clips {
        if !seen.insert((&clip.character, &clip.motion)) {
            let (character, motion) = (clip.character.clone(), clip.motion.clone());
            return Err(AddError::Twice { character, motion });
        }
    }
    Ok(())
}

/// The name of a clip's file without its ending: letters and digits of both labels.
fn stem(clip: &Clip) -> String {
    let plain = |text: &str| -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
        text.chars().take(MOST_LETTERS).map(plain).collect()
    };
    format!("{}-{}", plain(&clip.character), plain(&clip.motion))
}

/// How far a file's name is from the one that the library gives to a clip: 0 for that name, 1 for that name with a number, 2 for
/// another one, such as that of a copy which a program made that keeps folders the same.
pub(super) fn strangeness(file: &str, clip: &Clip) -> usize {
    let rest = file.strip_suffix(ENDING).and_then(|name| name.strip_prefix(&stem(clip)));
    let number =
        |rest: &str| rest.strip_prefix('-').is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()));
    match rest {
        Some("") => 0,
        Some(rest) if number(rest) => 1,
        _ => 2,
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

/// Locks a file. The lock ends when the file is closed, also if the process is killed. `None` on a disk that knows no locks.
fn lock(path: &Path) -> Result<Option<File>, AddError> {
    let failed = |source| WriteError { path: path.to_owned(), source };
    let file = open_for_all(path).map_err(failed)?;
    let start = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(Some(file)),
            Err(TryLockError::WouldBlock) if start.elapsed() < WAIT => sleep(Duration::from_millis(10)),
            Err(TryLockError::WouldBlock) => {
                return Err(AddError::Locked { path: path.to_owned(), seconds: WAIT.as_secs() });
            }
            Err(TryLockError::Error(error)) if file::knows_no_locks(&error) => return Ok(None),
            Err(TryLockError::Error(error)) => return Err(failed(error).into()),
        }
    }
}

/// Opens the file of a lock, which everybody may write who may write into the folder, whatever the mask of whoever came first.
/// A file that must not be written is opened for reading: most disks lock it all the same.
fn open_for_all(path: &Path) -> io::Result<File> {
    // To open a pipe for writing alone would wait for somebody who reads it.
    match OpenOptions::new().create(true).truncate(false).read(true).write(true).open(path) {
        Ok(file) => {
            #[cfg(unix)]
            {
                use std::os::unix::fs::PermissionsExt;
                // Only the owner may do this, and who is not has opened it already.
                let _ = file.set_permissions(fs::Permissions::from_mode(FOR_ALL));
            }
            Ok(file)
        }
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            file::length(path)?;
            File::open(path).map_err(|_| error)
        }
        Err(error) => Err(error),
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
