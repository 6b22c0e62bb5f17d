//! Files that are written completely or not at all.
//!
//! The bytes go to a temporary file in the same folder and are flushed to the disk. Only then the temporary file takes
//! the name of the target. After a full disk, a crash or a cancelled run the old file is still there. A target that is
//! not a regular file (a pipe, a device) is written directly, since renaming would replace it. A symbolic link stays a
//! link, also where its target does not exist yet.
//!
//! A process that ends early removes its temporary files where it can ([`crate::unfinished`]). One that is killed while it
//! writes leaves its temporary file. The first write of a later process into the folder
//! removes such files if they are more than an hour old.

use crate::path::{real, slashed};
use crate::rights;
use crate::unfinished::Unfinished;
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// First letters of the names of temporary files.
const PREFIX: &str = ".rototoon-";

/// Number of random letters and digits that follow the prefix.
const RANDOM: usize = 6;

/// Most UTF-16 letters in the name of a file of Windows.
const MOST_LETTERS: usize = 255;

/// Age after which a temporary file is left over from a process that was killed. No write takes that long.
const LEFT_OVER: Duration = Duration::from_secs(3600);

/// How long a process waits for others that look at a file of the folder and write it. That takes them far less.
const ALONE: Duration = Duration::from_secs(2);

/// A file could not be written. An earlier file is unchanged.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot write: {source}", path.display())]
pub struct WriteError {
    /// Path of the file.
    pub path: PathBuf,
    /// The error of the system.
    pub source: io::Error,
}

/// Writes `bytes` as the file `path`, completely or not at all.
///
/// # Errors
///
/// A [`WriteError`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_whole_unless(path, bytes, &|| false).map(drop)
}

/// As [`write_whole`], unless the file `is_changed` when the bytes are on the disk, directly before the file gets its name. Returns whether it was
/// written. Of several processes that write files of a folder in this way, one after the other looks and writes, where the disk knows locks.
///
/// # Errors
///
/// A [`WriteError`].
pub fn write_whole_unless(path: &Path, bytes: &[u8], is_changed: &dyn Fn() -> bool) -> Result<bool, WriteError> {
    write(path, bytes, true, is_changed).map_err(|source| WriteError { path: path.to_owned(), source })
}

/// As [`write_whole`], for a file whose loss costs time alone: nothing waits for the disk. After a crash of the system the file may have other bytes, so
/// who reads it must check them.
///
/// # Errors
///
/// A [`WriteError`].
pub fn write_unflushed(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write(path, bytes, false, &|| false).map(drop).map_err(|source| WriteError { path: path.to_owned(), source })
}

fn write(path: &Path, bytes: &[u8], flush: bool, is_changed: &dyn Fn() -> bool) -> io::Result<bool> {
    let existing = fs::metadata(path).ok();
    match &existing {
        Some(data) if data.is_dir() => return Err(io::Error::other("it is a folder, expected a file")),
        Some(data) if !data.is_file() => {
            return OpenOptions::new().write(true).open(path)?.write_all(bytes).map(|()| true);
        }
        _ => {}
    }
    let target = if existing.is_some() { real(path)? } else { resolved(&end_of_links(path)?)? };
    if let Some(data) = &existing {
        rights::check(&target, data)?;
    }
    let folder = parent(&target);
    there(folder)?;
    remove_left_over(folder);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666)); // reduced by the user's mask, as for any new file
    }
    let file = Unfinished::new(&builder, folder).map_err(nameless)?;
    file.as_file().write_all(bytes)?;
    if let Some(data) = existing {
        rights::keep(file.as_file(), &data)?;
    }
    if flush {
        file.as_file().sync_all()?;
    }
    {
        let _alone = flush.then(|| alone(folder)).flatten();
        if is_changed() {
            return Ok(false);
        }
        file.persist(&target)?;
    }
    // The new name is on the disk only after the folder is flushed. On systems that cannot open folders, the system
    // does this.
    if let Some(folder) = flush.then(|| File::open(folder).ok()).flatten() {
        let _ = folder.sync_all();
    }
    Ok(true)
}

/// A lock of the folder for as long as it is kept. `None` where folders cannot be locked, or another process keeps the lock for too long.
fn alone(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    let start = Instant::now();
    loop {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) if start.elapsed() < ALONE => sleep(Duration::from_millis(1)),
            Err(_) => return None,
        }
    }
}

/// The error of the system without the name of the temporary file, which nobody knows.
fn nameless(error: io::Error) -> io::Error {
    let inner = error.get_ref().and_then(|inner| inner.source()).and_then(|inner| inner.downcast_ref::<io::Error>());
    match inner.and_then(io::Error::raw_os_error) {
        Some(code) => io::Error::from_raw_os_error(code),
        None => error,
    }
}

/// Checks, as far as possible, whether a file can be written at `path`, so that long work fails before it starts.
///
/// # Errors
///
/// A [`WriteError`] if the file certainly cannot be written.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let length = path.file_name().map_or(0, |name| name.to_string_lossy().encode_utf16().count());
    if cfg!(windows) && length > MOST_LETTERS {
        // Wine and some disks find such a name only when the file is made.
        let source = io::Error::new(
            io::ErrorKind::InvalidFilename,
            format!("the name has {length} letters, expected at most {MOST_LETTERS}"),
        );
        return Err(WriteError { path: path.to_owned(), source });
    }
    let probe = || match fs::metadata(path) {
        Ok(data) if data.is_dir() => Err(io::Error::other("it is a folder, expected a file")),
        Ok(data) if !data.is_file() => Ok(()),
        Ok(data) => {
            rights::check(path, &data)?;
            tempfile::tempfile_in(parent(&real(path)?)).map(drop)
        }
        // A name that is too long, or a folder that may not be entered.
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        Err(_) => {
            let target = end_of_links(path)?;
            there(parent(&target))?;
            tempfile::tempfile_in(parent(&target)).map(drop)
        }
    };
    probe().map_err(|source| WriteError { path: path.to_owned(), source })
}

/// An error that names the folder, if there is none. That of the system would name a temporary file in it.
fn there(folder: &Path) -> io::Result<()> {
    match fs::metadata(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let message = format!("there is no folder \"{}\"", folder.display());
            Err(io::Error::new(io::ErrorKind::NotFound, message))
        }
        _ => Ok(()),
    }
}

/// The path that symbolic links at `path` lead to, also where no file is there.
fn end_of_links(path: &Path) -> io::Result<PathBuf> {
    /// Most links on the way, as on Linux.
    const MOST: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MOST {
        match fs::read_link(&path) {
            // A relative link starts in the folder of the link; joining an absolute one replaces the folder.
            Ok(to) => path = parent(&path).join(to),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("found a loop of symbolic links, expected a file"))
}

/// A path whose folder the system has resolved. On Windows only such a path may be longer than 260 characters: the crate
/// that renames temporary files hands paths to the system as they are.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    match path.file_name() {
        Some(name) if cfg!(windows) => Ok(real(parent(path))?.join(name)),
        _ => Ok(path.to_owned()),
    }
}

/// Removes the temporary files of processes that were killed, once for each folder: a folder may have thousands of
/// frames, and each is written.
fn remove_left_over(folder: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if !SEEN.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.to_owned()) {
        return;
    }
    let old = |entry: &fs::DirEntry| {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
        let ours = random.is_some_and(|rest| rest.len() == RANDOM && rest.bytes().all(|b| b.is_ascii_alphanumeric()));
        let age = || entry.metadata().ok().filter(|data| data.is_file())?.modified().ok()?.elapsed().ok();
        ours && age().is_some_and(|age| age > LEFT_OVER)
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten().filter(old) {
        // What cannot be removed stays: it does no harm.
        let _ = fs::remove_file(entry.path());
    }
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Converts a frame pattern relative to folder `from` into one relative to folder `to`; absolute if there is no
/// relative path. The result has forward slashes.
///
/// # Errors
///
/// A folder on the way has a name that no document can hold.
pub fn moved_pattern(pattern: &str, from: &Path, to: &Path) -> io::Result<String> {
    let real = |folder: &Path| {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        real(folder).or_else(|_| std::path::absolute(folder)).unwrap_or_else(|_| folder.to_owned())
    };
    let pattern = slashed(Path::new(pattern));
    let (from, to) = (real(from), real(to));
    if from == to {
        return Ok(pattern);
    }
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let way: PathBuf = match shared {
        // Two drives of Windows.
        0 => from,
        _ => {
            let up = to.components().skip(shared).map(|_| std::path::Component::ParentDir);
            up.chain(from.components().skip(shared)).collect()
        }
    };
    // A percent sign in a folder's name must not become a place for the frame number.
    let way = text(&way)?.replace('%', "%%");
    Ok(format!("{}/{pattern}", way.trim_end_matches('/')))
}

/// A frame pattern relative to a folder as an absolute one, with forward slashes.
///
/// # Errors
///
/// A folder on the way has a name that no document can hold.
pub fn absolute_pattern(pattern: &str, folder: &Path) -> io::Result<String> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let folder = real(folder).or_else(|_| std::path::absolute(folder)).unwrap_or_else(|_| folder.to_owned());
    // A percent sign in a folder's name must not become a place for the frame number.
    let way = text(&folder)?.replace('%', "%%");
    Ok(format!("{}/{}", way.trim_end_matches('/'), slashed(Path::new(pattern))))
}

/// A path as documents hold it, with nothing in the place of signs that are no text: the footage would not be found there.
fn text(way: &Path) -> io::Result<String> {
    if way.to_str().is_some() {
        return Ok(slashed(way));
    }
    let told = "found a folder on the way to the footage whose name is no UTF-8";
    let message = format!(
        "{told}, {}, expected the document in the footage's folder, or a folder of another name",
        way.display()
    );
    Err(io::Error::new(io::ErrorKind::InvalidFilename, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_whole(&path, b"one").unwrap();
        write_whole(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["a.json"]);
    }

    #[test]
    fn of_many_that_look_and_write_at_once_each_sees_what_the_others_wrote() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, b"0").unwrap();
        // Each adds one to the number of the file, and tries again if somebody else was faster.
        let add = || {
            for _ in 0..10 {
                loop {
                    let read = fs::read_to_string(&path).unwrap();
                    let next = (read.parse::<u32>().unwrap() + 1).to_string();
                    let is_changed = || fs::read_to_string(&path).unwrap() != read;
                    if write_whole_unless(&path, next.as_bytes(), &is_changed).unwrap() {
                        break;
                    }
                }
            }
        };
        std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(add))));
        assert_eq!(fs::read(&path).unwrap(), b"40");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn files_left_over_by_killed_processes_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let old = std::time::SystemTime::now() - 2 * LEFT_OVER;
        for name in [".rototoon-a1B2c3", ".rototoon-notes1.json", ".rototoon-ABCDEF"] {
            let file = File::create(folder.path().join(name)).unwrap();
            if name != ".rototoon-ABCDEF" {
                file.set_modified(old).unwrap();
            }
        }
        write_whole(&folder.path().join("a.json"), b"one").unwrap();
        let mut left = names(folder.path());
        left.sort();
        assert_eq!(
            left,
            [".rototoon-ABCDEF", ".rototoon-notes1.json", "a.json"],
            "young files and files of others stay"
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_file_that_does_not_exist_stays_a_link() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("disk")).unwrap();
        symlink("disk/new.json", at("link")).unwrap();
        symlink(at("link"), at("link to link")).unwrap();
        check_writable(&at("link to link")).unwrap();
        write_whole(&at("link to link"), b"one").unwrap();
        assert_eq!(fs::read(at("disk/new.json")).unwrap(), b"one");
        assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());
        symlink("loop", at("loop")).unwrap();
        assert!(check_writable(&at("loop")).is_err());
        assert!(write_whole(&at("loop"), b"one").is_err());
        symlink("none/new.json", at("lost")).unwrap();
        assert!(check_writable(&at("lost")).is_err());
    }

    #[test]
    fn a_name_that_is_too_long_is_found_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_writable(&folder.path().join("n".repeat(300))).is_err());
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_whole(&folder.path().join("none/a.json"), b"one").unwrap_err();
        assert!(error.to_string().contains("a.json: cannot write: "), "{error}");
        assert!(write_whole(folder.path(), b"one").unwrap_err().to_string().contains("it is a folder"));
    }

    #[cfg(unix)]
    #[test]
    fn new_files_may_be_read_by_others_and_links_stay_links() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.json"), folder.path().join("link.json"));
        write_whole(&path, b"one").unwrap();
        let other = folder.path().join("other");
        File::create(&other).unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&other));
        symlink(&path, &link).unwrap();
        write_whole(&link, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error_and_stays_a_device() {
        let error = write_whole(Path::new("/dev/full"), b"one").unwrap_err();
        assert_eq!(error.source.kind(), io::ErrorKind::StorageFull);
        assert!(!fs::metadata("/dev/full").unwrap().is_file());
    }

    #[test]
    fn a_pattern_follows_its_document() {
        let root = tempfile::tempdir().unwrap();
        let (a, b) = (root.path().join("100% a"), root.path().join("b/c"));
        fs::create_dir_all(&a).unwrap();
        fs::create_dir_all(&b).unwrap();
        let moved = |pattern: &str, from: &Path, to: &Path| moved_pattern(pattern, from, to).unwrap();
        assert_eq!(moved("f_%d.png", &a, &a.join("../100% a")), "f_%d.png");
        assert_eq!(moved("f/f_%d.png", &a, &b), "../../100%% a/f/f_%d.png");
        assert_eq!(moved("f_%d.png", &b, root.path()), "b/c/f_%d.png");
        let absolute = absolute_pattern("f/f_%d.png", &a).unwrap();
        assert!(Path::new(&absolute).is_absolute() && absolute.ends_with("/100%% a/f/f_%d.png"), "{absolute}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_whose_name_is_no_text_is_named() {
        use std::os::unix::ffi::OsStrExt;
        let root = tempfile::tempdir().unwrap();
        let odd = root.path().join(std::ffi::OsStr::from_bytes(b"sh\xffot"));
        fs::create_dir_all(odd.join("b")).unwrap();
        assert_eq!(moved_pattern("f_%d.png", &odd, &odd.join("b")).unwrap(), "../f_%d.png");
        assert_eq!(moved_pattern("f_%d.png", root.path(), &odd).unwrap(), "../f_%d.png");
        for refused in [moved_pattern("f_%d.png", &odd, root.path()), absolute_pattern("f_%d.png", &odd)] {
            let told = refused.unwrap_err().to_string();
            assert!(told.contains("whose name is no UTF-8") && told.contains("ot, expected"), "{told}");
        }
    }

    #[test]
    fn what_cannot_be_written_is_known_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_writable(&folder.path().join("a.json")).is_ok());
        assert!(check_writable(&folder.path().join("none/a.json")).is_err());
        assert!(check_writable(folder.path()).is_err());
        assert!(names(folder.path()).is_empty());
    }
}
