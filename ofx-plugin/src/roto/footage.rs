//! The path of a document's footage, where the document moves between a file and the composition, which has no folder of its own.

use rototoon::project::Document;
use rototoon::project::path::slashed;
use std::path::{Path, PathBuf};

/// The folder of a file.
pub fn folder(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    whole.parent().map_or_else(PathBuf::new, Path::to_path_buf)
}

/// Makes the footage of a file's document absolute, so that the composition can have it.
pub fn make_absolute(document: &mut Document, path: &Path) {
    let pattern = &mut document.scene.footage.pattern;
    if Path::new(pattern.as_str()).is_relative()
        && let Some(folder) = folder(path).to_str()
    {
        *pattern = slashed(&Path::new(&folder.replace('%', "%%")).join(&*pattern));
    }
}

/// Makes footage below the folder of a file relative to it.
pub fn make_relative(document: &mut Document, path: &Path) {
    let pattern = &mut document.scene.footage.pattern;
    if let Some(folder) = folder(path).to_str()
        && let Ok(relative) = Path::new(pattern.as_str()).strip_prefix(folder.replace('%', "%%"))
    {
        *pattern = slashed(relative);
    }
}
