//! What is wrong with a library.

use super::Entry;
use super::index::VERSION;
use crate::clips::ClipsError;
use crate::output::WriteError;
use std::fmt;
use std::path::PathBuf;

/// A part of a library that cannot be used. The rest can.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Trouble {
    /// The index cannot be read at all.
    #[error("{origin}: cannot read the index: {reason}; the clip files are read instead")]
    Unreadable {
        /// Path of the index.
        origin: String,
        /// The message of the system.
        reason: String,
    },
    /// The index is damaged.
    #[error("{origin}: not an index of clips: {reason}; the clip files are read instead")]
    Index {
        /// Path of the index.
        origin: String,
        /// The message of the parser.
        reason: String,
    },
    /// The index has bytes that are not UTF-8 text.
    #[error("{origin}: byte {byte} is not UTF-8 text; entries with such bytes are left out")]
    Bytes {
        /// Path of the index.
        origin: String,
        /// The first such byte.
        byte: usize,
    },
    /// The index is of a later version.
    #[error("{origin}: found version {found}, expected {VERSION} or less; the clip files are read instead")]
    Later {
        /// Path of the index.
        origin: String,
        /// The version of the index.
        found: u64,
    },
    /// An entry of the index cannot be used.
    #[error("{origin}: clips[{entry}]{field}: found {found}, expected {expected}; the entry is left out")]
    Entry {
        /// Path of the index.
        origin: String,
        /// Number of the entry.
        entry: usize,
        /// The field, with a dot before it, or nothing.
        field: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
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
    /// Another file already has the clip of this character and motion.
    #[error(
        "{origin}: found a second clip of character {character:?} and motion {motion:?}; the clip in {first} is used"
    )]
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

/// Clips that must not be replaced. The text of it names the first of them, without what is to be done: each host asks for
/// replacing in its own way.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// The library's folder.
    pub folder: PathBuf,
    /// The first clip that is there.
    pub first: Entry,
    /// How many more of the added clips are there.
    pub more: usize,
}

impl fmt::Display for Taken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Entry { file, character, motion, frames, source, .. } = &self.first;
        write!(f, "{}: found {motion:?} by {character:?} already", self.folder.display())?;
        let noun = if *frames == 1 { "frame" } else { "frames" };
        write!(f, " ({file}, {frames} {noun}")?;
        if !source.is_empty() {
            write!(f, ", from {source:?}")?;
        }
        f.write_str(")")?;
        if self.more > 0 {
            write!(f, ", and {} more of these clips", self.more)?;
        }
        Ok(())
    }
}

/// Clips could not be added. The library is as it was, except that after a [`Self::Write`] it may have some of the clips.
#[derive(Debug, thiserror::Error)]
pub enum AddError {
    /// Clips of the same character and motion are there, and must not be replaced.
    #[error("{0}, expected another character or motion, or \"replace\"")]
    Taken(Box<Taken>),
    /// One of the added clips would replace another.
    #[error("found two clips {motion:?} by {character:?} to add, expected each motion of a character once")]
    Twice {
        /// The character.
        character: String,
        /// The motion.
        motion: String,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The index is of a later version, which this one must not change.
    #[error("{}: found an index of version {found}, expected {VERSION} or less: a newer Rototoon wrote it", path.display())]
    Later {
        /// Path of the index.
        path: PathBuf,
        /// Its version.
        found: u64,
    },
    /// The index cannot be read, so it cannot be changed without loss.
    #[error("{}: cannot read the index: {reason}", path.display())]
    Unreadable {
        /// Path of the index.
        path: PathBuf,
        /// The message of the system.
        reason: String,
    },
    /// Another process holds the library.
    #[error("{}: another program has locked the library for {seconds} s, expected it to be free; close that program or try again later", path.display())]
    Locked {
        /// Path of the lock file.
        path: PathBuf,
        /// How long this one waited.
        seconds: u64,
    },
}
