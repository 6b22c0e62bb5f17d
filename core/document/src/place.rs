//! The folder that a document's footage is relative to, where the document is reached through a symbolic link.
//!
//! A link may stand for a document in two ways. One stands beside the frames, and the document lies elsewhere. Another leads
//! into the folder of a shot, and the frames lie beside the document. So frames are looked for beside the link first, as other programs do
//! with the name that they are given, and beside the real file if no frame is there.
//!
//! Limit: only a link of the document itself counts. Links of folders are followed by the system.

use crate::path::real;
use rototoon_base::scene::{Footage, FrameNumber, FramePattern};
use std::path::{Path, PathBuf};

/// The folder that the footage of the document at `path` is relative to.
pub fn folder_of(path: &Path, footage: &Footage) -> PathBuf {
    let beside = parent(path);
    let pattern = FramePattern::parse(&footage.pattern).ok().filter(|_| Path::new(&footage.pattern).is_relative());
    let (Some(pattern), Some(real)) = (pattern, behind_link(path)) else { return beside };
    let within = |frame: &FrameNumber| (footage.first..=footage.last).contains(frame);
    let has_frames = |folder: &Path| pattern.existing(folder).is_ok_and(|found| found.iter().any(within));
    if !has_frames(&beside) && has_frames(&real) { real } else { beside }
}

/// The folder that the footage of a document is to be relative to when it is written at `path`. Its frames are relative to `from` so far.
/// If a link leads to a file there, that folder stays.
pub fn folder_for(path: &Path, from: &Path) -> PathBuf {
    let same = |folder: PathBuf| real(here(from)).is_ok_and(|from| from == folder);
    if behind_link(path).is_some_and(same) { from.to_owned() } else { parent(path) }
}

/// The folder of the file that a link leads to; `None` if there is no link, or nothing behind it.
fn behind_link(path: &Path) -> Option<PathBuf> {
    let is_link = path.symlink_metadata().is_ok_and(|data| data.is_symlink());
    is_link.then(|| real(path).ok())?.map(|file| parent(&file))
}

fn parent(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

/// The folder where no name means the present one.
fn here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    #[test]
    fn frames_are_looked_for_beside_the_link_and_then_beside_the_real_file() {
        let root = tempfile::tempdir().unwrap();
        let root = real(root.path()).unwrap();
        let at = |name: &str| root.join(name);
        for folder in ["shot/frames", "desk/far"] {
            fs::create_dir_all(at(folder)).unwrap();
        }
        fs::write(at("shot/p.json"), "").unwrap();
        fs::write(at("shot/frames/f_2.png"), "").unwrap();
        symlink("../../shot/p.json", at("desk/far/link.json")).unwrap();
        symlink("far/link.json", at("desk/again.json")).unwrap();
        let footage = |pattern: &str, first| Footage {
            pattern: pattern.into(),
            first,
            last: 5,
            fps: 12.0,
            width: 4,
            height: 4,
            held: false,
        };
        let relative = footage("frames/f_%d.png", 1);
        let of = |name: &str| folder_of(&at(name), &relative);
        assert_eq!(
            [of("shot/p.json"), of("desk/far/link.json"), of("desk/again.json")],
            [at("shot"), at("shot"), at("shot")]
        );
        // Another range, and a pattern that needs no folder.
        assert_eq!(folder_of(&at("desk/again.json"), &footage("frames/f_%d.png", 3)), at("desk"));
        let whole = at("shot/frames/f_%d.png");
        assert_eq!(folder_of(&at("desk/again.json"), &footage(whole.to_str().unwrap(), 1)), at("desk"));
        fs::create_dir(at("desk/frames")).unwrap();
        fs::write(at("desk/frames/f_5.png"), "").unwrap();
        assert_eq!(of("desk/again.json"), at("desk"), "frames beside the link are the ones that were named");
        symlink("nothing.json", at("desk/lost.json")).unwrap();
        assert_eq!(of("desk/lost.json"), at("desk"));
        // Where it is written.
        assert_eq!(folder_for(&at("desk/far/link.json"), &at("shot")), at("shot"));
        assert_eq!(folder_for(&at("desk/far/link.json"), &at("desk")), at("desk/far"));
        assert_eq!(folder_for(&at("desk/new.json"), &at("shot")), at("desk"));
    }
}
