//! A library of skeleton clips: a folder with a file for each clip, and an index.
//!
//! The index `library.json` lists `{"file", "character", "motion", "frames", "fps", "source"}` for each clip. The file
//! of a clip is a file of clips ([`super::clips`]) with one clip. The index makes searching fast; the files are
//! authoritative: where clips are read, entries get the names, the length and the rate of their files. Clip files that the index
//! does not list are found as well, so a file may simply be copied into the folder. Hidden files are no clips.
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
use std::collections::{BTreeMap, BTreeSet};
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

impl Entry {
    /// Whether character and motion contain these words, ignoring case. An empty word is in every name.
    pub fn has(&self, character: &str, motion: &str) -> bool {
        let contains = |name: &str, word: &str| name.to_lowercase().contains(&word.to_lowercase());
        contains(&self.character, character) && contains(&self.motion, motion)
    }

    fn is_of(&self, clip: &Clip) -> bool {
        self.character == clip.character && self.motion == clip.motion
    }
}

/// What the files of entries have. No two clips have the same character and motion.
#[derive(Clone, Debug, Default)]
pub struct Checked {
    /// The clips, each with its entry as the file is.
    pub clips: Vec<(Entry, Clip)>,
    /// The entries whose files cannot be used, with the reason.
    pub unusable: Vec<(Entry, Trouble)>,
}

impl Checked {
    /// The clips at one frame rate: styles are learned frame by frame.
    pub fn at_rate(self, fps: f64) -> Clips {
        let clips = self.clips.into_iter().map(|(entry, clip)| clip.at_rate(entry.fps, fps)).collect();
        Clips { clips, fps }
    }

    /// The reasons why files cannot be used.
    pub fn troubles(&self) -> impl Iterator<Item = &Trouble> {
        self.unusable.iter().map(|(_, trouble)| trouble)
    }
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

    /// The clips whose character and motion contain these words by the index alone, ignoring case. An empty word matches all.
    pub fn search<'a>(&'a self, character: &'a str, motion: &'a str) -> impl Iterator<Item = &'a Entry> {
        self.index.entries.iter().filter(move |entry| entry.has(character, motion))
    }

    /// Reads all clip files, and returns those that are asked for by what the file or the index says.
    pub fn checked(&self, asked: impl Fn(&Entry) -> bool) -> Checked {
        let mut all = self.read_files(self.index.entries.iter());
        all.clips.retain(|(entry, _)| asked(entry));
        all.unusable.retain(|(entry, trouble)| asked(entry) || matches!(trouble, Trouble::Twice { .. }));
        all
    }

    /// The clips with exactly these names; an empty name is any. Only their own files are read, if the index has them right.
    pub fn named(&self, character: &str, motion: &str) -> Checked {
        let is = |asked: &str, own: &str| asked.is_empty() || asked == own;
        let is = |entry: &Entry| is(character, &entry.character) && is(motion, &entry.motion);
        if !character.is_empty() && !motion.is_empty() {
            let mut found = self.read_files(self.index.entries.iter().filter(|entry| is(entry)));
            found.clips.retain(|(entry, _)| is(entry));
            if !found.clips.is_empty() {
                return found;
            }
        }
        self.checked(is)
    }

    /// Reads the files of some entries. Of files with one clip, that one is used which the index has under the clip's names, else the
    /// one whose name the library gives.
    fn read_files<'a>(&self, entries: impl Iterator<Item = &'a Entry>) -> Checked {
        let entries: Vec<&Entry> = entries.collect();
        let read: Vec<_> = entries.par_iter().map(|entry| one_clip(&self.folder.join(&entry.file))).collect();
        let mut done = Checked::default();
        let mut used: BTreeMap<(String, String), ((bool, usize), String)> = BTreeMap::new();
        for (entry, result) in entries.into_iter().zip(read) {
            let (clip, fps) = match result {
                Ok(read) => read,
                Err(trouble) => {
                    done.unusable.push((entry.clone(), trouble));
                    continue;
                }
            };
            let rank = (!entry.is_of(&clip), add::strangeness(&entry.file, &clip));
            let best =
                used.entry((clip.character.clone(), clip.motion.clone())).or_insert_with(|| (rank, entry.file.clone()));
            if rank < best.0 {
                *best = (rank, entry.file.clone());
            }
            let (character, motion) = (clip.character.clone(), clip.motion.clone());
            let found = Entry { character, motion, frames: clip.postures.len(), fps, ..entry.clone() };
            done.clips.push((found, clip));
        }
        let twin = |(entry, _): &mut (Entry, Clip)| {
            used.get(&(entry.character.clone(), entry.motion.clone())).is_some_and(|(_, file)| *file != entry.file)
        };
        for (entry, _) in done.clips.extract_if(.., twin) {
            let first = &used[&(entry.character.clone(), entry.motion.clone())].1;
            let trouble = self.twice(&entry, first.clone());
            done.unusable.push((entry, trouble));
        }
        done
    }

    fn twice(&self, entry: &Entry, first: String) -> Trouble {
        let (character, motion) = (entry.character.clone(), entry.motion.clone());
        Trouble::Twice { origin: self.folder.join(&entry.file).display().to_string(), first, character, motion }
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
        let read: Vec<_> = names.par_iter().map(|name| one_clip(&self.folder.join(name))).collect();
        let mut found: Vec<(String, Clip, f64)> = Vec::new();
        for (file, result) in names.into_iter().zip(read) {
            match result {
                Ok((clip, fps)) => found.push((file, clip, fps)),
                Err(trouble) => self.index.troubles.push(trouble),
            }
        }
        // Of files with one clip the one with the library's own name counts, whatever copies are called.
        found.sort_by_key(|(file, clip, _)| add::strangeness(file, clip));
        for (file, clip, fps) in found {
            let first = self.entry_of(&clip).filter(|(_, content)| *content == Content::Same);
            let first = first.map(|(k, _)| self.index.entries[k].file.clone());
            let Clip { character, motion, postures, .. } = clip;
            let entry = Entry { file, character, motion, frames: postures.len(), fps, source: String::new() };
            match first {
                Some(first) => self.index.troubles.push(self.twice(&entry, first)),
                None => self.index.push(entry, Map::new()),
            }
        }
    }

    /// The index of the entry of a clip's character and motion, and what its file has; of several that which has it.
    fn entry_of(&self, clip: &Clip) -> Option<(usize, Content)> {
        let of_same = self.index.entries.iter().enumerate().filter(|(_, entry)| entry.is_of(clip));
        let read = of_same.map(|(k, entry)| (k, Content::of(&self.folder.join(&entry.file), clip)));
        read.min_by_key(|(_, content)| *content)
    }
}

/// What the file of an entry has, beside the clip whose names the entry has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Content {
    /// A clip of these names.
    Same,
    /// Something that cannot be read, and may be a clip of these names.
    Unreadable,
    /// Another clip, or there is no such file.
    Other,
}

impl Content {
    fn of(path: &Path, clip: &Clip) -> Self {
        match one_clip(path) {
            Ok((found, _)) if found.character == clip.character && found.motion == clip.motion => Self::Same,
            Err(_) if fs::symlink_metadata(path).is_ok() => Self::Unreadable,
            _ => Self::Other,
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
