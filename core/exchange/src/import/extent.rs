//! Of which frames of the footage a file speaks.
//!
//! A file is often a part of a film: a range of frames that was sent to someone, or one drawing. Its shapes are held before their first and after
//! their last key, because formats know no other way, and that says nothing of the frames there. What the artist drew on them must stay. So:
//!
//! - From a shape's first to its last key a file speaks of every frame, also of those on which it hides the shape.
//! - Before the first key it speaks only if it says from when on the shape is shown, and that is not just the first key. An export writes
//!   the time of its keys, so that time says nothing; another one was set by hand. The same holds after the last key.
//! - A shape that stands still, without any key on a frame, speaks of the frames on which the file says that it is shown. If the file says nothing of that, it
//!   speaks of all frames of a part that stands still too, and of its own frame otherwise.
//! - A drawing that is no film speaks of its own frame.

use super::hidden::joined;
use rototoon_base::scene::{Footage, FrameNumber};

/// What a file says of when a shape is shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extent {
    /// The first and the last frame with a key in the file, also a hidden one.
    keys: [FrameNumber; 2],
    /// The frames of the footage on which the file does not show it, as the first and the last of each time.
    away: Vec<[FrameNumber; 2]>,
    /// Whether the file says when it is shown.
    stated: bool,
    /// Whether it is a drawing of one frame and no film.
    drawing: bool,
    /// Whether its keys stand on frames, also if there is only one.
    keyed: bool,
    /// The first and the last frame of the footage.
    footage: [FrameNumber; 2],
}

impl Extent {
    /// The extent of a shape that has its first and last key on the frames `keys`. `hidden` are the times in which the file does not show it; none if it
    /// says nothing of that.
    pub(super) fn new(keys: [FrameNumber; 2], hidden: &[[f64; 2]], footage: &Footage) -> Self {
        let (away, footage) = (joined(hidden, footage), [footage.first, footage.last]);
        let never = away == [footage];
        let (away, stated) = if never { (Vec::new(), false) } else { (away, !hidden.is_empty()) };
        Self { keys, away, stated, drawing: false, keyed: keys[0] < keys[1], footage }
    }

    /// The same for a shape whose keys stand on frames, or do not.
    pub(super) fn of_keys(self, keyed: bool) -> Self {
        Self { keyed: keyed || self.keyed, ..self }
    }

    /// The same for a drawing of one frame.
    pub(super) fn of_drawing(self) -> Self {
        Self { drawing: true, ..self }
    }

    /// Moves all of it in time by a number of frames.
    pub(super) fn move_by(&mut self, frames: FrameNumber) {
        let all = [&mut self.keys, &mut self.footage].into_iter().chain(&mut self.away);
        all.flatten().for_each(|frame| *frame = frame.saturating_add(frames));
    }

    /// Whether the file hides the shape on a frame.
    pub(super) fn hides(&self, frame: FrameNumber) -> bool {
        self.away.iter().any(|[first, last]| (*first..=*last).contains(&frame))
    }

    /// Whether a frame lies on or between the keys of the file.
    pub(super) fn has_between_keys(&self, frame: FrameNumber) -> bool {
        (self.keys[0]..=self.keys[1]).contains(&frame)
    }

    /// The frames on which a shape with one key is shown in a film; none in a drawing.
    pub(super) fn shown(&self) -> Vec<FrameNumber> {
        if self.drawing {
            return Vec::new();
        }
        (self.footage[0]..=self.footage[1]).filter(|&frame| !self.hides(frame)).collect()
    }

    /// Whether the file speaks of a frame of a part, which stands `still` or does not.
    pub(super) fn speaks_of(&self, frame: FrameNumber, still: bool) -> bool {
        if self.has_between_keys(frame) {
            return true;
        }
        let Some([first, last]) = self.span().filter(|_| !self.drawing) else { return false };
        if !self.keyed {
            return (self.stated || still) && (first..=last).contains(&frame);
        }
        let (begin, end) = (first > self.footage[0], last < self.footage[1]);
        let [from, to] = self.shown_keys();
        if frame < self.keys[0] { begin && first != from } else { end && last != to }
    }

    /// The first and the last frame on which the file shows the shape.
    fn span(&self) -> Option<[FrameNumber; 2]> {
        let [begin, end] = self.footage;
        let first = match self.away.first() {
            Some([from, to]) if *from <= begin => to.checked_add(1)?,
            _ => begin,
        };
        let last = match self.away.last() {
            Some([from, to]) if *to >= end => from.checked_sub(1)?,
            _ => end,
        };
        (first <= last).then_some([first, last])
    }

    /// The keys' frames, where they are in the footage.
    fn shown_keys(&self) -> [FrameNumber; 2] {
        self.keys.map(|frame| frame.clamp(self.footage[0], self.footage[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The frames of 1 to 12 of which a file speaks.
    fn spoken(keys: [FrameNumber; 2], hidden: &[[f64; 2]], still: bool) -> Vec<FrameNumber> {
        let footage = Footage { pattern: "%d".into(), first: 1, last: 12, fps: 1.0, width: 9, height: 9, held: false };
        let extent = Extent::new(keys, hidden, &footage);
        let drawing: Vec<FrameNumber> =
            (1..=12).filter(|&frame| extent.clone().of_drawing().speaks_of(frame, still)).collect();
        assert_eq!(drawing, (keys[0]..=keys[1]).collect::<Vec<_>>());
        (1..=12).filter(|&frame| extent.speaks_of(frame, still)).collect()
    }

    #[test]
    fn beyond_its_keys_a_file_speaks_only_of_times_that_were_set() {
        let (far, all) = (f64::INFINITY, (1..=12).collect::<Vec<_>>());
        let cut: Vec<_> = (4..=8).collect();
        assert_eq!(spoken([4, 8], &[], false), cut, "keys alone");
        assert_eq!(spoken([4, 8], &[[-far, 3.0], [9.0, far]], false), cut, "the time of an export");
        assert_eq!(spoken([4, 8], &[[-far, 3.0], [6.0, 6.0], [9.0, far]], false), cut);
        assert_eq!(spoken([4, 8], &[[11.0, far]], false), (4..=12).collect::<Vec<_>>(), "hidden from 11 on, by hand");
        assert_eq!(
            spoken([4, 8], &[[-far, 2.0], [9.0, far]], false),
            (1..=8).collect::<Vec<_>>(),
            "hidden up to 2, by hand"
        );
        assert_eq!(spoken([4, 8], &[[-far, 3.0]], false), cut, "it comes within a range that was exported");
        assert_eq!(spoken([4, 8], &[[9.0, far]], false), cut, "it goes within such a range");
        assert_eq!(spoken([1, 12], &[[7.0, far]], false), all, "keys that are hidden now");
        assert_eq!(spoken([4, 8], &[[-far, far]], true), cut, "never shown: only its keys are taken");
    }

    #[test]
    fn a_shape_that_stands_still_speaks_of_the_time_in_which_it_is_shown() {
        let far = f64::INFINITY;
        assert_eq!(spoken([5, 5], &[], false), [5]);
        assert_eq!(spoken([5, 5], &[], true), (1..=12).collect::<Vec<_>>());
        for still in [false, true] {
            assert_eq!(spoken([5, 5], &[[-far, 4.0], [6.0, far]], still), [5], "an export of one frame");
            assert_eq!(spoken([5, 5], &[[-far, 2.0], [4.0, 4.0], [8.0, far]], still), [3, 4, 5, 6, 7]);
            assert_eq!(spoken([5, 5], &[[-far, 0.0], [13.0, far]], still).len(), 12);
        }
    }

    #[test]
    fn one_key_on_a_frame_speaks_of_that_frame() {
        let footage = Footage { pattern: "%d".into(), first: 1, last: 12, fps: 1.0, width: 9, height: 9, held: false };
        for hidden in [&[][..], &[[f64::NEG_INFINITY, 4.0]], &[[6.0, f64::INFINITY]]] {
            let extent = Extent::new([5, 5], hidden, &footage).of_keys(true);
            assert_eq!((1..=12).filter(|&frame| extent.speaks_of(frame, true)).collect::<Vec<_>>(), [5], "{hidden:?}");
        }
    }
}
