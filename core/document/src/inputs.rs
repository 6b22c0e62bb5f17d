//! The files that a command reads, so that it does not write over one of them.
//!
//! Two paths may name one file: by `..`, by symbolic or hard links, by letters of another case. Paths are compared after
//! the system has resolved them, and files by device and inode, on Windows by volume and file index. A path where no file is names none.

use crate::library::{ENDING, INDEX};
use rototoon_base::scene::{Footage, FramePattern};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// What a command reads.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    files: Vec<(PathBuf, Identity)>,
}

/// A command was asked to write over a file that it reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: found a file that the command reads ({}), expected another name for the output", output.display(), input.display())]
pub struct OverwritesInput {
    /// The output as it was given.
    pub output: PathBuf,
    /// The input as it was given.
    pub input: PathBuf,
}

impl Inputs {
    /// Adds a file; nothing where there is none.
    pub fn file(mut self, path: &Path) -> Self {
        self.files.extend(Identity::of(path).map(|identity| (path.to_owned(), identity)));
        self
    }

    /// Adds the clips at a path: a file, or the index and all clips of a library's folder.
    pub fn clips(mut self, path: &Path) -> Self {
        let is_clip = |name: &str| name == INDEX || name.ends_with(ENDING);
        let Ok(entries) = std::fs::read_dir(path) else { return self.file(path) };
        for entry in entries.flatten().filter(|entry| entry.file_name().to_str().is_some_and(is_clip)) {
            self = self.file(&entry.path());
        }
        self
    }

    /// Adds every frame of a footage that exists; its pattern is relative to `folder`.
    pub fn footage(mut self, footage: &Footage, folder: &Path) -> Self {
        let Ok(pattern) = FramePattern::parse(&footage.pattern) else { return self };
        let frames = pattern.existing(folder).unwrap_or_default();
        for frame in frames.into_iter().filter(|frame| (footage.first..=footage.last).contains(frame)) {
            self = self.file(&folder.join(pattern.path(frame)));
        }
        self
    }

    /// An error where `output` is one of the files.
    pub fn check(&self, output: &Path) -> Result<(), OverwritesInput> {
        let Some(own) = Identity::of(output) else { return Ok(()) };
        match self.files.iter().find(|(_, identity)| identity.same(&own)) {
            Some((input, _)) => Err(OverwritesInput { output: output.to_owned(), input: input.clone() }),
            None => Ok(()),
        }
    }
}

/// Whether two paths name one file, or would if they were written.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    match (Identity::of(one), Identity::of(other)) {
        (Some(one), Some(other)) => one.same(&other),
        (None, None) => place_of(one) == place_of(other),
        _ => false,
    }
}

/// Where a file will be: its folder as the system resolves it, and its name.
fn place_of(path: &Path) -> Option<(PathBuf, OsString)> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Some((crate::path::real(folder).ok()?, path.file_name()?.to_owned()))
}

/// What tells a file from others.
#[derive(Clone, Debug)]
struct Identity {
    path: PathBuf,
    /// Device and inode; on Windows volume and file index, `None` where the file system has none.
    place: Option<(u64, u64)>,
}

impl Identity {
    /// The identity of the file at a path; `None` where there is no file.
    fn of(path: &Path) -> Option<Self> {
        let real = crate::path::real(path).ok()?;
        // Pipes and devices may be read and written.
        real.is_file().then(|| Self { place: place(&real), path: real })
    }

    fn same(&self, other: &Self) -> bool {
        self.path == other.path || (self.place.is_some() && self.place == other.place)
    }
}

#[cfg(unix)]
fn place(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    let data = std::fs::metadata(path).ok()?;
    Some((data.dev(), data.ino()))
}

#[cfg(windows)]
fn place(path: &Path) -> Option<(u64, u64)> {
    let handle = winapi_util::Handle::from_path(path).ok()?;
    let data = winapi_util::file::information(&handle).ok()?;
    Some((data.volume_serial_number(), data.file_index())).filter(|(_, index)| *index != 0)
}

#[cfg(not(any(unix, windows)))]
fn place(_: &Path) -> Option<(u64, u64)> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn other_names_of_a_file_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("frames")).unwrap();
        for name in ["frames/f_1.png", "frames/f_2.png", "frames/f_9.png", "clips.json"] {
            fs::write(at(name), name).unwrap();
        }
        fs::hard_link(at("frames/f_2.png"), at("hard.png")).unwrap();
        let footage = Footage {
            pattern: "frames/f_%d.png".into(),
            first: 1,
            last: 5,
            fps: 12.0,
            width: 1,
            height: 1,
            held: false,
        };
        let inputs = Inputs::default().file(&at("clips.json")).footage(&footage, folder.path());
        let refused = ["clips.json", "frames/../clips.json", "frames/f_1.png", "frames/f_2.png", "hard.png"];
        for name in refused {
            let error = inputs.check(&at(name)).unwrap_err();
            assert_eq!(error.output, at(name));
        }
        // Frame 9 is not of the footage; the others are no files.
        for name in ["frames/f_9.png", "frames/f_3.png", "new.json", "frames"] {
            assert_eq!(inputs.check(&at(name)), Ok(()), "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_lead_to_their_file() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("a.svg"), folder.path().join("b.svg"));
        fs::write(&file, "").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert!(Inputs::default().file(&file).check(&link).is_err());
        assert!(Inputs::default().file(&link).check(&file).is_err());
    }
}
