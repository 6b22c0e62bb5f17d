//! Paths as documents hold them.
//!
//! Documents have forward slashes in their paths on every system, so that a document is the same bytes wherever it is
//! written, and one written on Windows can be read on Linux.

use std::io;
use std::path::{Path, PathBuf};

/// A path as documents hold it: with forward slashes on every system.
///
/// On Windows a path that the system resolved begins with `\\?\`. That prefix is left out, since other programs do not
/// know it, and forward slashes are plain letters behind it. On other systems a backslash is a letter of a name and stays.
pub fn slashed(path: &Path) -> String {
    let text = path.to_string_lossy();
    if cfg!(windows) { from_windows(&text) } else { text.into_owned() }
}

/// A path of Windows with forward slashes and without the prefix of resolved paths.
fn from_windows(text: &str) -> String {
    let text = text.replace('\\', "/");
    match (text.strip_prefix("//?/UNC/"), text.strip_prefix("//?/")) {
        (Some(share), _) => format!("//{share}"),
        (None, Some(drive)) => drive.to_owned(),
        (None, None) => text,
    }
}

/// The real path of a file that is there. Links are followed. On Windows it has the prefix `\\?\`, without which a path may
/// not be longer than 260 characters.
///
/// Some disks of Windows cannot say where a file really is: memory disks, drives of some networks, and Wine's where a path is
/// long. There the path is made absolute by its text alone.
///
/// # Errors
///
/// The file is not there, or its folder may not be entered.
pub fn real(path: &Path) -> io::Result<PathBuf> {
    match std::fs::canonicalize(path) {
        Err(error) if cfg!(windows) && error.kind() != io::ErrorKind::NotFound => {
            std::fs::metadata(path)?;
            let whole = std::path::absolute(path)?;
            whole.to_str().map(|text| PathBuf::from(unlimited(text))).ok_or(error)
        }
        found => found,
    }
}

/// A whole path of Windows with the prefix that lifts the limit of its length.
fn unlimited(text: &str) -> String {
    match text.strip_prefix(r"\\") {
        Some(rest) if rest.starts_with(r"?\") => text.to_owned(),
        Some(share) => format!(r"\\?\UNC\{share}"),
        None => format!(r"\\?\{text}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_of_windows_get_forward_slashes() {
        for (path, expected) in [
            (r"frames\f_%03d.png", "frames/f_%03d.png"),
            (r"C:\shots\a b/f_%d.png", "C:/shots/a b/f_%d.png"),
            (r"\\server\share\f_%d.png", "//server/share/f_%d.png"),
            (r"\\?\D:\shots\f_%d.png", "D:/shots/f_%d.png"),
            (r"\\?\UNC\server\share\f_%d.png", "//server/share/f_%d.png"),
        ] {
            assert_eq!(from_windows(path), expected);
        }
        let kept = if cfg!(windows) { "a/b" } else { r"a\b" };
        assert_eq!(slashed(Path::new(r"a\b")), kept);
    }

    #[test]
    fn long_paths_get_the_prefix_once() {
        for (path, expected) in [
            (r"C:\shots\a.json", r"\\?\C:\shots\a.json"),
            (r"\\server\share\a.json", r"\\?\UNC\server\share\a.json"),
            (r"\\?\D:\a.json", r"\\?\D:\a.json"),
        ] {
            assert_eq!(unlimited(path), expected);
            assert_eq!(from_windows(&unlimited(path)), from_windows(path));
        }
    }

    #[test]
    fn the_real_path_is_that_of_the_system() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        assert_eq!(real(&path).unwrap_err().kind(), io::ErrorKind::NotFound);
        std::fs::write(&path, "").unwrap();
        assert_eq!(real(&path).unwrap(), std::fs::canonicalize(&path).unwrap());
    }
}
