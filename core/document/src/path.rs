//! Paths as documents hold them.
//!
//! Documents have forward slashes in their paths on every system, so that a document is the same bytes wherever it is
//! written, and one written on Windows can be read on Linux.

use std::path::Path;

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
}
