//! The frames that a document takes from the source, where the source has more of them than the footage of the document.
//!
//! A shot may get longer after its first contour. A document that a node has made stands for its source, so its footage becomes as long as
//! the source with the next edit or *Track*. A project from a file has footage of its own. It is widened only where the artist works beyond
//! its ends, by an edit on such a frame or by tracks there, and an edit does so only if the source has all frames of the footage too: otherwise
//! *Frame offset* is probably missing.
//!
//! Footage never gets shorter here: keys on frames that the source has no more stay where they are.

use super::fresh;
use crate::description::SOURCE;
use crate::ofx::{Effect, Failure};
use rototoon::project::schema::{MAX_FRAME_NUMBER, MAX_FRAMES};
use rototoon::scene::{Footage, FrameNumber, Scene};

/// The source's first and last frame, as frames of the document; `None` if nothing is connected, or if its length is unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reach(pub Option<[FrameNumber; 2]>);

impl Reach {
    /// That of an effect's source.
    pub fn of(effect: &Effect) -> Result<Self, Failure> {
        let source = effect.clip(SOURCE)?;
        let offset = f64::from(effect.parameters()?.int(c"frameOffset", 0.0)?);
        let range = source.connected().then(|| source.frame_range()).flatten();
        Ok(Self(range.and_then(|[first, last]| frames(first.ceil() - offset, last.floor() - offset))))
    }

    /// Widens the footage for work on a frame.
    pub fn widen(self, footage: &mut Footage, frame: FrameNumber) {
        let Some([first, last]) = self.0 else { return };
        if fresh::is_own(footage) {
            self.widen_own(footage);
        } else if first <= footage.first && footage.last <= last && (first..=last).contains(&frame) {
            stretch(footage, [frame; 2]);
        }
    }

    /// Widens the footage of a document that a node has made. A source that does not even touch it has other numbers, and is left alone.
    pub fn widen_own(self, footage: &mut Footage) {
        let touches = |[first, last]: &[FrameNumber; 2]| {
            *first <= footage.last.saturating_add(1) && footage.first <= last.saturating_add(1)
        };
        if let Some(frames) = self.0.filter(touches).filter(|_| fresh::is_own(footage)) {
            stretch(footage, frames);
        }
    }
}

/// Widens the footage until it has all frames with tracks.
pub fn widen_to_tracks(scene: &mut Scene) {
    let ends =
        |part: &rototoon::scene::Part| Some([*part.tracks.first_key_value()?.0, *part.tracks.last_key_value()?.0]);
    for frames in scene.parts.iter().filter_map(ends).collect::<Vec<_>>() {
        stretch(&mut scene.footage, frames);
    }
}

/// What is told where the footage of a project from a file has become longer. The file's own frames may end earlier.
pub fn told(before: &Footage, after: &Footage) -> Option<String> {
    let longer = (before.first, before.last) != (after.first, after.last) && !fresh::is_own(after);
    let (first, last) = (after.first, after.last);
    longer.then(|| {
        format!("the project's footage has the frames {first} to {last} now, because there are shapes on them")
    })
}

/// Frames that a document can have; `None` for a clip without an end, such as a still.
fn frames(first: f64, last: f64) -> Option<[FrameNumber; 2]> {
    let most = MAX_FRAME_NUMBER as f64;
    let fits = first >= -most && last <= most && first <= last && last - first < MAX_FRAMES as f64;
    fits.then(|| [first, last].map(|frame| frame as FrameNumber))
}

fn stretch(footage: &mut Footage, [first, last]: [FrameNumber; 2]) {
    let [first, last] = [footage.first.min(first), footage.last.max(last)];
    if i64::from(last) - i64::from(first) < MAX_FRAMES {
        (footage.first, footage.last) = (first, last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn footage(pattern: &str) -> Footage {
        Footage { pattern: pattern.into(), first: 1, last: 20, fps: 24.0, width: 8, height: 8, held: false }
    }

    fn widened(pattern: &str, source: Option<[FrameNumber; 2]>, frame: FrameNumber) -> [FrameNumber; 2] {
        let mut footage = footage(pattern);
        Reach(source).widen(&mut footage, frame);
        [footage.first, footage.last]
    }

    #[test]
    fn a_document_of_the_node_follows_its_source() {
        let own = |source, frame| widened(fresh::PATTERN, source, frame);
        assert_eq!(own(Some([1, 40]), 3), [1, 40]);
        assert_eq!(own(Some([-5, 10]), 30), [-5, 20], "it gets no shorter");
        assert_eq!(own(Some([21, 30]), 21), [1, 30]);
        assert_eq!(own(Some([1001, 1020]), 1003), [1, 20], "other numbers");
        assert_eq!((own(None, 3), own(Some([2, 900_000]), 3)), ([1, 20], [1, 900_000]));
    }

    #[test]
    fn a_project_is_widened_to_the_frame_that_is_worked_on() {
        let project = |source, frame| widened("/film/f_%d.png", source, frame);
        assert_eq!((project(Some([1, 40]), 3), project(Some([1, 40]), 30)), ([1, 20], [1, 30]));
        assert_eq!((project(Some([0, 40]), 0), project(Some([1, 40]), 41)), ([0, 20], [1, 20]));
        assert_eq!(project(Some([2, 40]), 30), [1, 20], "a frame offset is missing");
    }

    #[test]
    fn a_clip_without_an_end_is_of_unknown_length() {
        assert_eq!(frames(-2_147_483_648.0, 2_147_483_647.0), None);
        assert_eq!((frames(f64::NEG_INFINITY, 3.0), frames(5.0, 4.0), frames(f64::NAN, 4.0)), (None, None, None));
        assert_eq!(frames(-3.0, 999_996.0), Some([-3, 999_996]));
        assert_eq!(frames(-3.0, 999_997.0), None);
    }
}
