//! Frames without a file that hold the drawing before them.
//!
//! Scans of a film on twos are often numbered by their exposure: A0001, A0003, A0005. If the document says so, a frame without a file shows
//! the nearest earlier frame of the footage that has one. Each file is asked for at most once, when a frame needs the answer; no folder is
//! listed, because a file system may find a file under another spelling of its name.
//!
//! Only a file that is not there makes a hold. One that cannot be read is an error of its frame.

use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// By frame the frame whose file it shows, as far as it is known; nothing if neither it nor an earlier frame has a file.
type Known = BTreeMap<FrameNumber, Option<FrameNumber>>;

/// What frames without a file show, as far as it is known.
#[derive(Debug, Default)]
pub(super) struct Holds {
    known: Mutex<Known>,
}

impl Holds {
    /// The frame whose file `frame` shows, with `first` as the earliest; itself if no file is there. `there` says whether a frame has a file.
    pub fn shown(&self, frame: FrameNumber, first: FrameNumber, there: impl Fn(FrameNumber) -> bool) -> FrameNumber {
        let mut asked = Vec::new();
        let found = (first..=frame).rev().find_map(|at| {
            let known = self.locked().get(&at).copied();
            known.or_else(|| {
                asked.push(at);
                there(at).then_some(Some(at))
            })
        });
        // Also that there is no file is an answer. Else each frame of a footage without files would ask for all before it.
        let found = found.flatten();
        self.locked().extend(asked.into_iter().map(|at| (at, found)));
        found.unwrap_or(frame)
    }

    /// Whether a frame that held the drawing before it, or had none before it, has a file now.
    pub fn has_changed(&self, there: impl Fn(FrameNumber) -> bool) -> bool {
        let known = self.locked().clone();
        known.into_iter().any(|(frame, shown)| shown != Some(frame) && there(frame))
    }

    /// Forgets everything, because files may have changed.
    pub fn forget(&self) {
        self.locked().clear();
    }

    /// Nothing panics between two changes of the map.
    fn locked(&self) -> std::sync::MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether there is a file, even if it cannot be read.
pub(super) fn is_there(path: &Path) -> bool {
    !std::fs::metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    #[test]
    fn each_file_is_asked_for_once() {
        let (holds, asked) = (Holds::default(), RefCell::new(Vec::new()));
        let there = |frame: FrameNumber| {
            asked.borrow_mut().push(frame);
            [3, 5, 9].contains(&frame)
        };
        let shown: Vec<_> = [8, 6, 5, 9, 8, 4, 3].iter().map(|&frame| holds.shown(frame, 1, there)).collect();
        assert_eq!(shown, [5, 5, 5, 9, 5, 3, 3]);
        assert_eq!(asked.take(), [8, 7, 6, 5, 9, 4, 3]);
        holds.forget();
        assert_eq!(holds.shown(6, 1, |frame| frame == 4), 4);
    }

    #[test]
    fn a_frame_before_every_file_shows_itself() {
        let holds = Holds::default();
        assert_eq!(holds.shown(2, 1, |frame| frame > 2), 2);
        assert!(holds.has_changed(|frame| frame == 1) && !holds.has_changed(|_| false));
        holds.forget();
        assert_eq!(holds.shown(2, 1, |frame| frame == 1), 1, "a file that has come is found");
        assert_eq!(holds.shown(0, 1, |_| true), 0, "outside of the footage nothing is held");
    }

    #[test]
    fn each_file_is_asked_for_once_if_none_is_there() {
        let (holds, asked) = (Holds::default(), RefCell::new(Vec::new()));
        let there = |frame: FrameNumber| {
            asked.borrow_mut().push(frame);
            frame == 9
        };
        let shown: Vec<_> = [1, 2, 3, 6, 5, 8, 9, 7].iter().map(|&frame| holds.shown(frame, 1, there)).collect();
        assert_eq!(shown, [1, 2, 3, 6, 5, 8, 9, 7]);
        assert_eq!(asked.take(), [1, 2, 3, 6, 5, 4, 8, 7, 9]);
        assert_eq!(holds.shown(10, 1, |_| false), 9);
    }
}
