//! A cache of files: tracks, strokes and regions that are kept beyond the program, in a folder.
//!
//! Each entry is a file whose name is the mark of everything that it was made from ([`Cache`]). So an entry is right or it is not there: nothing has to be
//! thrown away because a key, a picture or the program has changed. A file begins with the hash of what follows, and one that is damaged counts as missing. So nobody waits until it is on the disk.
//!
//! Several programs may use one folder, also on several machines: files appear whole. An entry that cannot be written is not kept, and nobody is
//! told: what was computed is right without it.
//!
//! The folder is the user's one for caches, or the one that the environment variable `ROTOTOON_CACHE` names; `none` is no cache. It holds at most [`MOST`]
//! bytes. Beyond that the entries that were not used for the longest time go. Only files with names of entries are removed.

use crate::project::{write_unflushed, write_whole};
use crate::track::Cache;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The environment variable that names the folder.
pub const VARIABLE: &str = "ROTOTOON_CACHE";
/// The word for no cache.
pub const NONE: &str = "none";
/// Bytes that a folder holds at most. A second of twelve parts takes about 300 kB, a traced drawing of 100 strokes half a MB.
const MOST: u64 = 256 << 20;
/// Share of that which is left when entries are removed.
const LEFT: u64 = 4;
/// Bytes of the hash at the beginning of an entry.
const HASH: usize = 32;
/// A file by which programs for backups know the folder, and what it says (<https://bford.info/cachedir/>).
const TAG: (&str, &str) = (
    "CACHEDIR.TAG",
    "Signature: 8a477f597d28d172789f06886806bc55\n# What Rototoon found in pictures. It finds it again if it is gone.\n",
);

/// A folder of entries.
#[derive(Debug)]
pub struct FileCache {
    folder: PathBuf,
    most: u64,
}

impl FileCache {
    /// The entries in a folder. It is made when there is something to keep.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.into(), most: MOST }
    }

    /// The cache that the user asks for: the folder `asked`, or else that of the environment variable, or else the user's own.
    /// `None` for the word [`NONE`], or if nobody knows the user's folder.
    pub fn of_user(asked: Option<&OsStr>) -> Option<Self> {
        let named = asked.map(OsStr::to_owned).or_else(|| std::env::var_os(VARIABLE)).filter(|name| !name.is_empty());
        match named {
            Some(name) if name == NONE => None,
            Some(name) => Some(Self::new(Path::new(&name))),
            None => Some(Self::new(&dirs::cache_dir()?.join("rototoon"))),
        }
    }

    fn path(&self, mark: &[u8; 32]) -> PathBuf {
        let name = blake3::Hash::from(*mark).to_hex();
        self.folder.join(&name[..2]).join(name.as_str())
    }

    /// Removes the entries that were not used for the longest time, if there are too many bytes.
    fn trim(&self) {
        let mut entries = self.entries();
        let mut bytes: u64 = entries.iter().map(|(_, _, long)| long).sum();
        if bytes <= self.most {
            return;
        }
        entries.sort();
        for (_, path, long) in entries {
            if bytes <= self.most / LEFT * (LEFT - 1) {
                return;
            }
            // Another program may have removed it.
            let _ = fs::remove_file(path);
            bytes -= long;
        }
    }

    /// The entries: when each was used, its file, and its length.
    fn entries(&self) -> Vec<(SystemTime, PathBuf, u64)> {
        let listed = |folder: &Path| fs::read_dir(folder).into_iter().flatten().flatten();
        let groups = listed(&self.folder).filter(|entry| is_hex(&entry.file_name(), 2));
        let files = groups.flat_map(|group| listed(&group.path())).filter(|entry| is_hex(&entry.file_name(), 2 * HASH));
        let found = files.filter_map(|entry| {
            let data = entry.metadata().ok().filter(fs::Metadata::is_file)?;
            Some((data.modified().ok()?, entry.path(), data.len()))
        });
        found.collect()
    }
}

/// Whatever was kept, too much does not stay: also not after an error, or at the end of a long session.
impl Drop for FileCache {
    fn drop(&mut self) {
        self.trim();
    }
}

impl Cache for FileCache {
    fn get(&self, mark: &[u8; 32]) -> Option<Vec<u8>> {
        let path = self.path(mark);
        // A link may lead to anything, and no entry is longer than all may be.
        let is_entry = |found: &fs::Metadata| found.is_file() && found.len() <= self.most;
        fs::symlink_metadata(&path).ok().filter(is_entry)?;
        let bytes = crate::file::bytes(&path).ok()?;
        let (hash, value) = bytes.split_at_checked(HASH)?;
        if blake3::hash(value).as_bytes() != hash {
            return None;
        }
        // The time tells what was used last. A folder that cannot be written does no harm.
        let _ = File::options().append(true).open(&path).and_then(|file| file.set_modified(SystemTime::now()));
        Some(value.to_vec())
    }

    fn put(&self, mark: &[u8; 32], bytes: &[u8]) {
        let path = self.path(mark);
        let Some(group) = path.parent() else { return };
        // A link would be followed, and a pipe would wait for a reader for ever.
        if fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file()) {
            return;
        }
        // A folder that holds something else is not only ours: backups are to take it.
        let is_ours = fs::read_dir(&self.folder).map_or(true, |mut found| found.next().is_none());
        if fs::create_dir_all(group).is_err() {
            return;
        }
        if is_ours {
            let _ = write_whole(&self.folder.join(TAG.0), TAG.1.as_bytes());
        }
        let _ = write_unflushed(&path, &[blake3::hash(bytes).as_bytes(), bytes].concat());
    }
}

/// Whether a name is so many hexadecimal digits.
fn is_hex(name: &OsStr, digits: usize) -> bool {
    let Some(name) = name.to_str() else { return false };
    name.len() == digits && name.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn files(cache: &FileCache) -> Vec<u64> {
        let mut long: Vec<u64> = cache.entries().into_iter().map(|(_, _, long)| long).collect();
        long.sort_unstable();
        long
    }

    #[test]
    fn entries_come_back_and_damaged_ones_do_not() {
        let folder = tempfile::tempdir().unwrap();
        let cache = FileCache::new(&folder.path().join("new/folder"));
        assert_eq!(cache.get(&[1; 32]), None);
        cache.put(&[1; 32], b"tracks");
        cache.put(&[2; 32], b"");
        assert_eq!(cache.get(&[1; 32]).unwrap(), b"tracks");
        assert_eq!(cache.get(&[2; 32]).unwrap(), b"");
        assert_eq!(cache.get(&[3; 32]), None);
        let path = cache.path(&[1; 32]);
        let whole = fs::read(&path).unwrap();
        for damaged in [&whole[..whole.len() - 1], &whole[..20], b"", &[&whole[..], b"x"].concat()] {
            fs::write(&path, damaged).unwrap();
            assert_eq!(cache.get(&[1; 32]), None, "{} bytes", damaged.len());
        }
        cache.put(&[1; 32], b"tracks");
        assert_eq!(cache.get(&[1; 32]).unwrap(), b"tracks");
        assert!(cache.folder.join("CACHEDIR.TAG").is_file());
    }

    #[test]
    fn what_was_not_used_for_long_goes_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let mut cache = FileCache::new(folder.path());
        cache.most = 1000;
        let other = folder.path().join("01").join("shot.json");
        for (k, long) in [(1, 300), (2, 301), (3, 302)] {
            cache.put(&[k; 32], &vec![0; long]);
            let used = SystemTime::now() - Duration::from_secs(1000 - 10 * u64::from(k));
            File::options().append(true).open(cache.path(&[k; 32])).unwrap().set_modified(used).unwrap();
        }
        fs::write(&other, vec![0; 5000]).unwrap();
        cache.trim();
        assert_eq!(files(&cache), [332, 333, 334], "999 bytes are not too many");
        assert!(cache.get(&[1; 32]).is_some(), "it is the one that was used last now");
        cache.put(&[4; 32], b"x");
        cache.trim();
        assert_eq!(files(&cache), [33, 332, 334]);
        assert!(cache.get(&[2; 32]).is_none() && other.is_file());
    }

    #[test]
    fn a_folder_that_cannot_be_written_keeps_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let cache = FileCache::new(&file);
        cache.put(&[1; 32], b"tracks");
        assert_eq!(cache.get(&[1; 32]), None);
        cache.trim();
        assert!(file.is_file());
    }

    #[test]
    fn a_folder_of_the_user_stays_in_backups() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("shot.json"), "work").unwrap();
        let cache = FileCache::new(folder.path());
        cache.put(&[1; 32], b"tracks");
        assert_eq!(cache.get(&[1; 32]).unwrap(), b"tracks");
        assert!(!folder.path().join(TAG.0).exists());
    }

    #[cfg(unix)]
    #[test]
    fn links_in_place_of_entries_are_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (cache, other) = (FileCache::new(&folder.path().join("cache")), folder.path().join("shot.json"));
        fs::write(&other, [&blake3::hash(b"x").as_bytes()[..], b"x"].concat()).unwrap();
        let path = cache.path(&[1; 32]);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::os::unix::fs::symlink(&other, &path).unwrap();
        assert_eq!(cache.get(&[1; 32]), None);
        cache.put(&[1; 32], b"tracks");
        assert_eq!(fs::read(&other).unwrap().last(), Some(&b'x'));
    }

    #[test]
    fn the_user_chooses_the_folder_or_none() {
        let of = |asked: &str| FileCache::of_user(Some(OsStr::new(asked)));
        assert!(of("none").is_none());
        assert_eq!(of("some/folder").unwrap().folder, Path::new("some/folder"));
    }
}
