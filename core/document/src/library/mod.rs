//! A library of skeleton clips: a folder with a file for each clip, and an index.
//!
//! The index `library.json` lists `{"file", "character", "motion", "frames", "fps", "source"}` for each clip. The file
//! of a clip is a file of clips ([`super::clips`]) with one clip. The index makes searching fast; the files are
//! authoritative. Clip files that the index does not list are found as well, so a file may simply be copied into the
//! folder. Hidden files are no clips.
//!
//! **Damage.** A file that is damaged, missing or of a later version does not affect the others. It is reported as a
//! [`Trouble`], and the rest is used. Without a usable index the clip files of the folder are read instead.
//!
//! **Changes.** [`Library::add`] loses nothing:
//!
//! - Only one process changes a library at a time: the file `library.lock` is locked, and the index is read again under
//!   the lock. A library on a disk without locks works too, but only one process may change it at a time.
//! - Fields of the index that this version does not know are kept.
//! - A damaged index gets the name `library.damaged-1.json`, or the next free number, before a new one is written.
//! - An index of a later version is never changed: that is an error.
//! - A clip is replaced only if the caller says so ([`Existing`]). Otherwise nothing is added.
//! - A clip file is replaced only by a clip of the same character and motion. If the index names a file with another
//!   content, the clip gets a file of its own.
//!
//! The threads of the caller's pool read the clip files. Results and their order do not depend on the threads.

mod add;
mod index;
mod trouble;

#[cfg(test)]
mod tests;

pub use add::{Added, Addition, Existing};
pub use index::{ENDING, VERSION};
pub use trouble::{AddError, Taken, Trouble};

use super::clips::Clips;
use index::Index;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::scene::Clip;
use serde::Serialize;
use serde_json::Map;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// File name of the index.
pub const INDEX: &str = "library.json";

/// The index entry of a clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    /// The file's name within the folder.
    pub file: String,
    /// The character that moves.
    pub character: String,
    /// The motion.
    pub motion: String,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub fps: f64,
    /// Source of the clip; may be empty.
    pub source: String,
}

/// An open library.
#[derive(Clone, Debug)]
pub struct Library {
    folder: PathBuf,
    index: Index,
}

impl Library {
    /// Opens a folder. A folder that is empty or does not exist is an empty library. If the index is valid, only the
    /// index and files that it does not list are read.
    pub fn open(folder: &Path) -> Self {
        let mut library = Self { folder: folder.to_owned(), index: Index::read(folder) };
        library.find_files();
        library
    }

    /// The parts of the library that cannot be used.
    pub fn troubles(&self) -> &[Trouble] {
        &self.index.troubles
    }

    /// All clips, in the order in which they were added.
    pub fn entries(&self) -> &[Entry] {
        &self.index.entries
    }

    /// The clips whose character and motion contain these words, ignoring case. An empty word matches all.
    pub fn search<'a>(&'a self, character: &str, motion: &str) -> impl Iterator<Item = &'a Entry> {
        let (character, motion) = (character.to_lowercase(), motion.to_lowercase());
        self.index.entries.iter().filter(move |entry| {
            entry.character.to_lowercase().contains(&character) && entry.motion.to_lowercase().contains(&motion)
        })
    }

    /// Reads the clips of some entries as they are. Files that cannot be used are reported and left out.
    pub fn read<'a>(&self, entries: impl Iterator<Item = &'a Entry>) -> (Vec<Clip>, Vec<Trouble>) {
        self.read_all(entries, |clip, _| clip)
    }

    /// As [`Library::read`], with all clips at one frame rate: styles are learned frame by frame.
    pub fn read_at<'a>(&self, entries: impl Iterator<Item = &'a Entry>, fps: f64) -> (Vec<Clip>, Vec<Trouble>) {
        self.read_all(entries, |clip, own| clip.at_rate(own, fps))
    }

    /// Some entries as their files are, with their clips, without those whose files cannot be used. These are reported.
    pub fn checked<'a>(&self, entries: impl Iterator<Item = &'a Entry>) -> (Vec<(Entry, Clip)>, Vec<Trouble>) {
        let (mut good, mut troubles) = (Vec::new(), Vec::new());
        let entries: Vec<&Entry> = entries.collect();
        let read: Vec<_> = entries.par_iter().map(|entry| one_clip(&self.folder.join(&entry.file))).collect();
        for (entry, result) in entries.into_iter().zip(read) {
            match result {
                Ok((clip, fps)) => {
                    let (character, motion) = (clip.character.clone(), clip.motion.clone());
                    let found = Entry { character, motion, frames: clip.postures.len(), fps, ..entry.clone() };
                    good.push((found, clip));
                }
                Err(trouble) => troubles.push(trouble),
            }
        }
        (good, troubles)
    }

    fn read_all<'a>(
        &self,
        entries: impl Iterator<Item = &'a Entry>,
        made: impl Fn(Clip, f64) -> Clip,
    ) -> (Vec<Clip>, Vec<Trouble>) {
        let (mut clips, mut troubles) = (Vec::new(), Vec::new());
        let files: Vec<PathBuf> = entries.map(|entry| self.folder.join(&entry.file)).collect();
        let read: Vec<_> = files.par_iter().map(|file| one_clip(file)).collect();
        for result in read {
            match result {
                Ok((clip, own)) => clips.push(made(clip, own)),
                Err(trouble) => troubles.push(trouble),
            }
        }
        (clips, troubles)
    }

    /// The frame rate that most of some entries have, and the highest of several; 25 without entries.
    pub fn usual_rate<'a>(entries: impl Iterator<Item = &'a Entry>) -> f64 {
        let mut rates: Vec<f64> = entries.map(|entry| entry.fps).collect();
        rates.sort_by(f64::total_cmp);
        let runs = rates.chunk_by(|a, b| a == b);
        runs.max_by_key(|run| run.len()).and_then(|run| run.first().copied()).unwrap_or(25.0)
    }

    /// Adds the clip files that no entry names, in the order of their names, those with a name that the library gives first.
    fn find_files(&mut self) {
        let Ok(listed) = fs::read_dir(&self.folder) else { return };
        let known: BTreeSet<&str> = self.index.entries.iter().map(|entry| entry.file.as_str()).collect();
        let mut names: Vec<String> = listed
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| index::is_clip_file(name) && !is_hidden(name) && !known.contains(name.as_str()))
            .collect();
        names.sort();
        let paths: Vec<PathBuf> = names.iter().map(|name| self.folder.join(name)).collect();
        let read: Vec<_> = paths.par_iter().map(|path| one_clip(path)).collect();
        let mut found: Vec<(String, PathBuf, Clip, f64)> = Vec::new();
        for ((file, path), result) in names.into_iter().zip(paths).zip(read) {
            match result {
                Ok((clip, fps)) => found.push((file, path, clip, fps)),
                Err(trouble) => self.index.troubles.push(trouble),
            }
        }
        // Of files with one clip the one with the library's own name counts, whatever copies are called.
        found.sort_by_key(|(file, _, clip, _)| add::strangeness(file, clip));
        for (file, path, clip, fps) in found {
            let Clip { character, motion, postures, .. } = clip;
            match self.index.entries.iter().find(|entry| entry.character == character && entry.motion == motion) {
                Some(first) => {
                    let first = first.file.clone();
                    self.index.troubles.push(Trouble::Twice {
                        origin: path.display().to_string(),
                        first,
                        character,
                        motion,
                    });
                }
                None => {
                    let (frames, source) = (postures.len(), String::new());
                    self.index.push(Entry { file, character, motion, frames, fps, source }, Map::new());
                }
            }
        }
    }
}

/// Whether systems hide a file of this name. A Mac keeps more about a file `a` in `._a` on disks of other systems.
fn is_hidden(name: &str) -> bool {
    name.starts_with('.')
}

fn one_clip(path: &Path) -> Result<(Clip, f64), Trouble> {
    let mut read = Clips::load(path)?;
    let found = read.clips.len();
    match read.clips.pop() {
        Some(clip) if found == 1 => Ok((clip, read.fps)),
        _ => Err(Trouble::Count { origin: path.display().to_string(), found }),
    }
}
