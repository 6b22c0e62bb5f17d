//! The folders that a benchmark is given, with a name for each.

use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Names sets after their folders, each differently, after `check` has looked at the folder as it was given.
pub fn named(dirs: &[PathBuf], check: impl Fn(&Path) -> Result<()>) -> Result<Vec<(String, PathBuf)>> {
    let mut sets: Vec<(String, PathBuf)> = Vec::new();
    for dir in dirs {
        let folder = dir.canonicalize().with_context(|| format!("{dir:?}: found no folder, expected that of a set"))?;
        check(dir)?;
        let name = folder.file_name().map_or("set".into(), |name| name.to_string_lossy().into_owned());
        let taken = |name: &str| sets.iter().any(|(other, _)| other == name);
        let names = std::iter::once(name.clone()).chain((2..).map(|n| format!("{name}-{n}")));
        let name = names.into_iter().find(|name| !taken(name)).unwrap_or_default();
        sets.push((name, folder));
    }
    Ok(sets)
}
