//! What is wrong with a library.

use super::index::VERSION;
use crate::clips::ClipsError;
use crate::output::WriteError;
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

/// Clips could not be added. The library is as it was, or has some of the clips.
#[derive(Debug, thiserror::Error)]
pub enum AddError {
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
