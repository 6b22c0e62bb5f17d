//! A library of skeleton clips: a folder with a file for each clip, and an index.
//!
//! The index `library.json` lists `{"file", "character", "motion", "frames", "fps", "source"}` for each clip. The file
//! of a clip is a file of clips ([`super::clips`]) with one clip. The index makes searching fast; the files are
//! authoritative.
//!
//! A file that is damaged, missing or of a later version does not affect the others. It is reported as a [`Trouble`],
//! and the rest is used. If the index is damaged, the clip files of the folder are read instead. Clip files that the
//! index does not list are found in the same way, so a file may simply be copied into the folder.
//!
//! The threads of the caller's pool read the clip files. Results and their order do not depend on the threads.

use super::clips::{Clips, ClipsError};
use super::output::{WriteError, write_whole};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::scene::Clip;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Version of the index format.
pub const VERSION: u64 = 1;
/// File name of the index.
pub const INDEX: &str = "library.json";
/// Ending of the names of clip files.
pub const ENDING: &str = ".clip.json";

/// The index entry of a clip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    #[serde(default)]
    pub source: String,
}

#[derive(Deserialize)]
struct Index {
    rototoon_library: u64,
    clips: Vec<Entry>,
}

#[derive(Serialize)]
struct WrittenIndex<'a> {
    rototoon_library: u64,
    clips: &'a [Entry],
}

/// A part of a library that cannot be used. The rest can.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Trouble {
    /// The index is damaged.
    #[error("{origin}: not an index of clips: {reason}; the clip files are read instead")]
    Index {
        /// Path of the index.
        origin: String,
        /// The message of the parser.
        reason: String,
    },
    /// The index is of a later version.
    #[error("{origin}: found version {found}, expected {VERSION} or less; the clip files are read instead")]
    Later {
        /// Path of the index.
        origin: String,
        /// The version of the index.
        found: u64,
    },
    /// A clip file cannot be used.
    #[error(transparent)]
    Clip(#[from] ClipsError),
    /// A clip file does not contain exactly one clip.
    #[error("{origin}: found {found} clips, expected one clip for each file")]
    Count {
        /// Path of the file.
        origin: String,
        /// Number of clips.
        found: usize,
    },
    /// A file name in the index leads out of the folder.
    #[error("{origin}: found file {found:?}, expected a name within the folder")]
    Name {
        /// Path of the index.
        origin: String,
        /// The file name.
        found: String,
    },
    /// Another file already has the clip of this character and motion.
    #[error("{origin}: found another clip of {character:?}, {motion:?}; the one of {first} is used")]
    Twice {
        /// Path of the file.
        origin: String,
        /// The file that was found first.
        first: String,
        /// The character.
        character: String,
        /// The motion.
        motion: String,
    },
}

/// An open library.
#[derive(Clone, Debug)]
pub struct Library {
    folder: PathBuf,
    entries: Vec<Entry>,
    troubles: Vec<Trouble>,
}

impl Library {
    /// Opens a folder. A folder that is empty or does not exist is an empty library. If the index is valid, only the
    /// index and files that it does not list are read.
    pub fn open(folder: &Path) -> Self {
        let mut library = Self { folder: folder.to_owned(), entries: Vec::new(), troubles: Vec::new() };
        let index = folder.join(INDEX);
        let origin = index.display().to_string();
        if let Ok(text) = fs::read_to_string(&index) {
            match serde_json::from_str::<Index>(&text) {
                Ok(read) if read.rototoon_library > VERSION => {
                    library.troubles.push(Trouble::Later { origin, found: read.rototoon_library });
                }
                Ok(read) => read.clips.into_iter().for_each(|entry| library.take(entry)),
                Err(error) => library.troubles.push(Trouble::Index { origin, reason: error.to_string() }),
            }
        }
        library.find_files();
        library
    }

    /// The parts of the library that cannot be used.
    pub fn troubles(&self) -> &[Trouble] {
        &self.troubles
    }

    /// All clips, in the order in which they were added.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The clips whose character and motion contain these words, ignoring case. An empty word matches all.
    pub fn search<'a>(&'a self, character: &str, motion: &str) -> impl Iterator<Item = &'a Entry> {
        let (character, motion) = (character.to_lowercase(), motion.to_lowercase());
        self.entries.iter().filter(move |entry| {
            entry.character.to_lowercase().contains(&character) && entry.motion.to_lowercase().contains(&motion)
        })
    }

    /// Reads the clips of some entries. Files that cannot be used are reported and left out.
    pub fn read<'a>(&self, entries: impl Iterator<Item = &'a Entry>) -> (Vec<Clip>, Vec<Trouble>) {
        let (mut clips, mut troubles) = (Vec::new(), Vec::new());
        let files: Vec<PathBuf> = entries.map(|entry| self.folder.join(&entry.file)).collect();
        let read: Vec<_> = files.par_iter().map(|file| one_clip(file)).collect();
        for result in read {
            match result {
                Ok((clip, _)) => clips.push(clip),
                Err(trouble) => troubles.push(trouble),
            }
        }
        (clips, troubles)
    }

    /// Adds a clip. It replaces an earlier clip of the same character and motion.
    ///
    /// # Errors
    ///
    /// A [`WriteError`] if the folder, the clip file or the index cannot be written.
    pub fn add(&mut self, clip: &Clip, fps: f64, source: &str) -> Result<(), WriteError> {
        let same = |entry: &Entry| entry.character == clip.character && entry.motion == clip.motion;
        let known = self.entries.iter().position(same);
        let file = match known {
            Some(k) => self.entries[k].file.clone(),
            None => self.free_name(clip),
        };
        fs::create_dir_all(&self.folder).map_err(|source| WriteError { path: self.folder.clone(), source })?;
        Clips { clips: vec![clip.clone()], fps }.save(&self.folder.join(&file))?;
        let entry = Entry {
            file,
            character: clip.character.clone(),
            motion: clip.motion.clone(),
            frames: clip.postures.len(),
            fps,
            source: source.to_owned(),
        };
        match known {
            Some(k) => self.entries[k] = entry,
            None => self.entries.push(entry),
        }
        let index = WrittenIndex { rototoon_library: VERSION, clips: &self.entries };
        let text = serde_json::to_string_pretty(&index).unwrap_or_default() + "\n";
        write_whole(&self.folder.join(INDEX), text.as_bytes())
    }

    /// Takes an entry of the index, unless its file name leads out of the folder.
    fn take(&mut self, entry: Entry) {
        if Path::new(&entry.file).components().count() == 1 && !entry.file.contains("..") {
            self.entries.push(entry);
        } else {
            let origin = self.folder.join(INDEX).display().to_string();
            self.troubles.push(Trouble::Name { origin, found: entry.file });
        }
    }

    /// Adds the clip files that no entry names, in the order of their names.
    fn find_files(&mut self) {
        let Ok(listed) = fs::read_dir(&self.folder) else { return };
        let known: BTreeSet<&str> = self.entries.iter().map(|entry| entry.file.as_str()).collect();
        let mut names: Vec<String> = listed
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| name.ends_with(ENDING) && !known.contains(name.as_str()))
            .collect();
        names.sort();
        let paths: Vec<PathBuf> = names.iter().map(|name| self.folder.join(name)).collect();
        let read: Vec<_> = paths.par_iter().map(|path| one_clip(path)).collect();
        for ((file, path), result) in names.into_iter().zip(paths).zip(read) {
            let (clip, fps) = match result {
                Ok(found) => found,
                Err(trouble) => {
                    self.troubles.push(trouble);
                    continue;
                }
            };
            let Clip { character, motion, postures, .. } = clip;
            match self.entries.iter().find(|entry| entry.character == character && entry.motion == motion) {
                Some(first) => {
                    let first = first.file.clone();
                    self.troubles.push(Trouble::Twice { origin: path.display().to_string(), first, character, motion });
                }
                None => {
                    self.entries.push(Entry {
                        file,
                        character,
                        motion,
                        frames: postures.len(),
                        fps,
                        source: String::new(),
                    });
                }
            }
        }
    }

    /// A free file name made of letters and digits of both labels, with a number if necessary.
    fn free_name(&self, clip: &Clip) -> String {
        let plain = |text: &str| -> String {
            text.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect()
        };
        let stem = format!("{}-{}", plain(&clip.character), plain(&clip.motion));
        let taken = |name: &String| self.entries.iter().any(|e| e.file == *name) || self.folder.join(name).exists();
        let numbered = (2..).map(|n| format!("{stem}-{n}{ENDING}"));
        std::iter::once(format!("{stem}{ENDING}")).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
    }
}

fn one_clip(path: &Path) -> Result<(Clip, f64), Trouble> {
    let mut read = Clips::load(path)?;
    let found = read.clips.len();
    match read.clips.pop() {
        Some(clip) if found == 1 => Ok((clip, read.fps)),
        _ => Err(Trouble::Count { origin: path.display().to_string(), found }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    fn clip(character: &str, motion: &str, frames: usize) -> Clip {
        Clip::new(character, motion, (0..frames).map(|f| [Point::new(f as f64, 1.0); 17]).collect())
    }

    fn filled() -> (tempfile::TempDir, Library) {
        let folder = tempfile::tempdir().unwrap();
        let mut library = Library::open(&folder.path().join("clips"));
        library.add(&clip("Ann", "walk", 3), 12.0, "shot 7").unwrap();
        library.add(&clip("Ann", "run", 2), 12.0, "").unwrap();
        library.add(&clip("Bo/b", "walk", 4), 24.0, "").unwrap();
        (folder, library)
    }

    #[test]
    fn what_is_added_is_found_again() {
        let (folder, _) = filled();
        let library = Library::open(&folder.path().join("clips"));
        assert!(library.troubles().is_empty());
        assert_eq!(library.entries().len(), 3);
        assert_eq!((library.entries()[0].frames, library.entries()[0].source.as_str()), (3, "shot 7"));
        assert_eq!(library.search("", "WALK").count(), 2);
        let (clips, troubles) = library.read(library.search("ann", "run"));
        assert_eq!((clips, troubles), (vec![clip("Ann", "run", 2)], vec![]));
    }

    #[test]
    fn a_clip_takes_the_place_of_the_same() {
        let (folder, mut library) = filled();
        library.add(&clip("Ann", "walk", 9), 12.0, "").unwrap();
        let library = Library::open(&folder.path().join("clips"));
        assert_eq!(library.entries().iter().map(|e| e.frames).collect::<Vec<_>>(), [9, 2, 4]);
    }

    #[test]
    fn of_a_damaged_library_the_rest_is_used() {
        let (folder, library) = filled();
        let folder = folder.path().join("clips");
        fs::write(folder.join(&library.entries()[1].file), "{").unwrap();
        let reopened = Library::open(&folder);
        let (clips, troubles) = reopened.read(reopened.entries().iter());
        assert_eq!((clips.len(), troubles.len()), (2, 1));
        assert!(troubles[0].to_string().contains("ann-run.clip.json: not JSON"), "{}", troubles[0]);
        let later = "{\"rototoon_clips\": 9, \"clips\": [], \"more\": {}}";
        fs::write(folder.join(&library.entries()[1].file), later).unwrap();
        let (clips, troubles) = reopened.read(reopened.entries().iter());
        assert_eq!(clips.iter().map(|clip| clip.character.as_str()).collect::<Vec<_>>(), ["Ann", "Bo/b"]);
        assert!(troubles[0].to_string().contains("found version 9, expected 1 or less"), "{}", troubles[0]);
        for (index, said) in
            [("[", "not an index of clips"), ("{\"rototoon_library\": 2, \"clips\": []}", "found version 2")]
        {
            fs::write(folder.join(INDEX), index).unwrap();
            let rebuilt = Library::open(&folder);
            assert_eq!(rebuilt.entries().len(), 2);
            assert!(rebuilt.troubles().iter().any(|t| t.to_string().contains(said)));
        }
    }

    #[test]
    fn files_put_into_the_folder_are_found_and_twins_told() {
        let (folder, library) = filled();
        let folder = folder.path().join("clips");
        fs::copy(folder.join(&library.entries()[0].file), folder.join("copy.clip.json")).unwrap();
        Clips { clips: vec![clip("Cy", "bow", 1)], fps: 8.0 }.save(&folder.join("new.clip.json")).unwrap();
        let reopened = Library::open(&folder);
        assert_eq!(reopened.entries().last().map(|e| (e.character.as_str(), e.fps)), Some(("Cy", 8.0)));
        assert!(matches!(reopened.troubles(), [Trouble::Twice { .. }]));
    }

    #[test]
    fn names_that_lead_elsewhere_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let entry = r#"{"file": "../x.clip.json", "character": "a", "motion": "b", "frames": 1, "fps": 1}"#;
        fs::write(folder.path().join(INDEX), format!(r#"{{"rototoon_library": 1, "clips": [{entry}]}}"#)).unwrap();
        let library = Library::open(folder.path());
        assert!(library.entries().is_empty());
        assert!(matches!(library.troubles(), [Trouble::Name { .. }]));
    }
}
