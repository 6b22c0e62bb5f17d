//! The files of a shot's folder: those of a step get their names, and old ones go.

use super::{NEW, ShotError, Work};
use crate::digest;
use std::fs;
use std::path::PathBuf;

impl Work<'_> {
    /// Whether a file of the folder has a hash.
    pub(super) fn has(&self, name: &str, hash: &str) -> bool {
        digest::of_file(&self.folder.join(name)).is_ok_and(|found| found == hash)
    }

    /// Looks which files with a first name no step writes. They are somebody else's, and stay.
    pub(super) fn look(&mut self) -> Result<(), ShotError> {
        let is_own = |name: &String| {
            let name = name.strip_prefix(NEW).unwrap_or(name);
            self.record.pending.contains_key(name)
                || self.record.files.contains_key(name)
                || self.shot.steps.iter().any(|step| step.writes(name))
        };
        self.foreign = self.new_files()?.into_iter().filter(|name| !is_own(name)).collect();
        Ok(())
    }

    /// Removes what a step left that did not come to its end.
    pub(super) fn clear(&self) -> Result<(), ShotError> {
        for name in self.new_files()? {
            let path = self.folder.join(&name);
            fs::remove_file(&path).map_err(|source| ShotError::File { path, source })?;
        }
        Ok(())
    }

    /// Files of the batch with their first names, sorted.
    pub(super) fn new_files(&self) -> Result<Vec<String>, ShotError> {
        let failed = |source| ShotError::File { path: self.folder.clone(), source };
        let mut names = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(failed)? {
            let name = entry.map_err(failed)?.file_name().into_string().ok();
            names.extend(name.filter(|name| name.starts_with(NEW) && !self.foreign.contains(name)));
        }
        names.sort();
        Ok(names)
    }

    /// Gives pending files their names. A file that is there must be one of the batch: the first one that is not is returned, and what should
    /// get its name stays pending.
    pub(super) fn place(&mut self) -> Result<Option<PathBuf>, ShotError> {
        if self.record.pending.is_empty() {
            return Ok(None);
        }
        let mut foreign = None;
        for (name, hash) in self.record.pending.clone() {
            let (from, to) = (self.folder.join(format!("{NEW}{name}")), self.folder.join(&name));
            let found = digest::of_file(&to).ok();
            let own =
                found.is_none() || found.as_ref() == Some(&hash) || found.as_ref() == self.record.files.get(&name);
            if !own || (found.is_none() && fs::symlink_metadata(&to).is_ok()) {
                foreign.get_or_insert(to);
                continue;
            }
            let is_new = self.has(&format!("{NEW}{name}"), &hash);
            if is_new {
                fs::rename(&from, &to).map_err(|source| ShotError::File { path: to, source })?;
            }
            self.record.pending.remove(&name);
            // Where the new file is gone, what is there now keeps its own hash.
            if is_new || found.as_ref() == Some(&hash) {
                self.record.files.insert(name, hash);
            }
        }
        self.record.write(&self.folder)?;
        Ok(foreign)
    }

    /// The file that keeps a step from its name, if the step was done with the same input. Nothing is done again before somebody moves it.
    pub(super) fn kept_out(&self, reads: &str) -> Option<PathBuf> {
        let is_pending = |name: &&String| {
            let new = format!("{NEW}{name}");
            self.record.pending.get(*name).is_some_and(|hash| self.has(&new, hash))
        };
        let steps = self.record.steps.iter().filter(|done| done.reads == reads);
        let name = steps.flat_map(|done| &done.outputs).find(is_pending)?;
        Some(self.folder.join(name))
    }

    /// Gives up what is still pending, with the steps that wrote it: the manifest does not ask for them any more, or they read something else now.
    pub(super) fn give_up_pending(&mut self) -> Result<(), ShotError> {
        let pending = std::mem::take(&mut self.record.pending);
        if pending.is_empty() {
            return Ok(());
        }
        self.record.steps.retain(|done| !done.outputs.iter().any(|name| pending.contains_key(name)));
        self.record.write(&self.folder)?;
        self.clear()
    }

    /// Removes files of an earlier run that no step writes any more, if nobody changed them.
    pub(super) fn remove_old(&mut self, names: &[String]) -> Result<(), ShotError> {
        for name in names {
            if self.record.steps.iter().any(|done| done.outputs.contains(name)) {
                continue;
            }
            let Some(hash) = self.record.files.remove(name) else { continue };
            if self.has(name, &hash) {
                let path = self.folder.join(name);
                fs::remove_file(&path).map_err(|source| ShotError::File { path, source })?;
            }
        }
        Ok(self.record.write(&self.folder)?)
    }
}
