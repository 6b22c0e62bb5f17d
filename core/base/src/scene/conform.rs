//! Conforming: where the frames and the places of one footage are in another one.
//!
//! A plate comes back at another size, with handles, or with drawings that were added, dropped, held longer or drawn anew. A [`Conform`]
//! says of each frame of the new footage which frame of the old one it shows, and where the old picture lies in the new one.
//!
//! Two questions are asked of it. *Where does it go?* is asked of what the artist made: each key goes to one frame, [`FrameMap::made`].
//! *Where is it shown?* is asked of results: a track goes to all frames that show its drawing, [`FrameMap::shown`], and to none
//! that was drawn anew.

use super::FrameNumber;
use crate::geometry::Point;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Where the old picture lies in the new one: a place p of the old one is at `scale` · p + `shift`, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Pixels of the new picture for each pixel of the old one.
    pub scale: f64,
    /// The place of the old picture's corner, in pixels of the new one.
    pub shift: Point,
}

impl Placement {
    /// Both pictures lie on each other.
    pub const SAME: Self = Self { scale: 1.0, shift: Point::ZERO };

    /// Whether nothing moves.
    pub fn is_same(&self) -> bool {
        *self == Self::SAME
    }

    /// The new place of an old place. It is the same to the last bit if nothing moves.
    pub fn place(&self, old: Point) -> Point {
        if self.is_same() { old } else { old * self.scale + self.shift }
    }

    /// The old place of a new place.
    pub fn old_place(&self, new: Point) -> Point {
        (new - self.shift) / self.scale
    }
}

/// What a frame of the new footage shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The drawing of this old frame.
    Same(FrameNumber),
    /// A drawing in place of that of this old frame.
    Redrawn(FrameNumber),
    /// A drawing that the old footage does not have.
    New,
}

/// Which frames of the old footage the frames of the new one show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameMap {
    old: RangeInclusive<FrameNumber>,
    sources: BTreeMap<FrameNumber, Source>,
    /// For each old frame that goes somewhere, the first new frame to which it goes.
    first: BTreeMap<FrameNumber, FrameNumber>,
    /// The first and the last old frame of each drawing that is held.
    held: Vec<[FrameNumber; 2]>,
}

impl FrameMap {
    /// The map of all frames of an old footage by what each new frame shows. `held` has the first and the last frame of each old drawing
    /// that is held, ascending.
    pub fn new(
        old: RangeInclusive<FrameNumber>,
        sources: BTreeMap<FrameNumber, Source>,
        held: Vec<[FrameNumber; 2]>,
    ) -> Self {
        let mut first = BTreeMap::new();
        for (&new, source) in &sources {
            if let Source::Same(at) | Source::Redrawn(at) = source {
                first.entry(*at).or_insert(new);
            }
        }
        Self { old, sources, first, held }
    }

    /// The map that adds a number to each frame. `new` has the frames of the new footage; those that are none of the old footage are new.
    pub fn offset(old: RangeInclusive<FrameNumber>, new: RangeInclusive<FrameNumber>, by: FrameNumber) -> Self {
        let source = |frame: FrameNumber| match frame.checked_sub(by).filter(|at| old.contains(at)) {
            Some(at) => Source::Same(at),
            None => Source::New,
        };
        let sources = new.map(|frame| (frame, source(frame))).collect();
        Self::new(old, sources, Vec::new())
    }

    /// What the new frames show, by frame.
    pub fn sources(&self) -> &BTreeMap<FrameNumber, Source> {
        &self.sources
    }

    /// The frames of the old footage.
    pub fn old(&self) -> RangeInclusive<FrameNumber> {
        self.old.clone()
    }

    /// The old frames that no new frame shows or stands for. A frame of a held drawing is none of them if another frame of it is shown.
    pub fn removed(&self) -> impl Iterator<Item = FrameNumber> + '_ {
        self.old.clone().filter(|&frame| self.made(frame).is_none())
    }

    /// The new frame of what was made on an old frame; `None` if its drawing is gone. Beyond the old footage it goes with the end of it.
    pub fn made(&self, old: FrameNumber) -> Option<FrameNumber> {
        let end = old.clamp(*self.old.start(), *self.old.end());
        if end != old {
            return self.made(end)?.checked_add(old.checked_sub(end)?);
        }
        let own = self.first.get(&old).copied();
        own.or_else(|| {
            let [from, to] = *self.held.iter().find(|[from, to]| (*from..=*to).contains(&old))?;
            let before = self.first.range(from..=old).next_back();
            before.or_else(|| self.first.range(old..=to).next()).map(|(_, &new)| new)
        })
    }

    /// Whether a frame goes to a frame of its own, and not to another frame of its drawing.
    pub fn has_own(&self, old: FrameNumber) -> bool {
        !self.old.contains(&old) || self.first.contains_key(&old)
    }

    /// The new frames that show the drawing of an old frame as it was, ascending.
    pub fn shown(&self, old: FrameNumber) -> impl Iterator<Item = FrameNumber> + '_ {
        // A drawing that is held longer shows one old frame on neighbouring new frames.
        let from = self.first.get(&old).copied();
        let near = from.into_iter().flat_map(|from| self.sources.range(from..));
        near.take_while(move |(_, source)| !matches!(source, Source::Same(at) | Source::Redrawn(at) if *at > old))
            .filter(move |(_, source)| **source == Source::Same(old))
            .map(|(&new, _)| new)
    }

    /// Whether a new frame shows a drawing that was drawn anew.
    pub fn is_redrawn(&self, new: FrameNumber) -> bool {
        matches!(self.sources.get(&new), Some(Source::Redrawn(_)))
    }

    /// The new frames that stand for the old frames `first` to `last`, which may be without limit: those from the first that does to the last.
    pub fn range(&self, first: FrameNumber, last: FrameNumber) -> Option<[FrameNumber; 2]> {
        let within = |source: &Source| match source {
            Source::Same(at) | Source::Redrawn(at) => (first..=last).contains(at),
            Source::New => false,
        };
        let mut frames = self.sources.iter().filter(|(_, source)| within(source)).map(|(&new, _)| new);
        let from = frames.next()?;
        Some([from, frames.next_back().unwrap_or(from)])
    }

    /// Whether each new frame shows the drawing that lies the same number of frames before it: only the numbers of frames have changed.
    pub fn only_renumbers(&self) -> bool {
        let by = |(new, source): (&FrameNumber, &Source)| match source {
            Source::Same(at) => Some(i64::from(*new) - i64::from(*at)),
            _ => None,
        };
        let first = self.sources.iter().next().and_then(by);
        first.is_some() && self.sources.iter().all(|entry| by(entry) == first) && self.removed().next().is_none()
    }
}

/// Where the frames and the places of an old footage are in a new one.
#[derive(Clone, Debug, PartialEq)]
pub struct Conform {
    /// Where the old picture lies in the new one.
    pub placement: Placement,
    /// Which frames show which.
    pub frames: FrameMap,
}

#[cfg(test)]
mod tests {
    use super::*;
    use Source::{New, Redrawn, Same};

    /// Old frames 1 to 6, of which 3 and 4 show one drawing. In the new footage 1 is gone, 3 is gone but its drawing is there twice, 5 was
    /// drawn anew and a drawing was added.
    fn map() -> FrameMap {
        let sources = [Same(2), Same(4), Same(4), New, Redrawn(5), Same(6)];
        FrameMap::new(1..=6, (1001..).zip(sources).collect(), vec![[3, 4]])
    }

    #[test]
    fn what_was_made_goes_to_one_frame_and_results_to_all_that_show_it() {
        let map = map();
        let made: Vec<_> = (1..=6).map(|old| map.made(old)).collect();
        assert_eq!(made, [None, Some(1001), Some(1002), Some(1002), Some(1005), Some(1006)]);
        assert_eq!((map.has_own(3), map.has_own(4)), (false, true));
        assert_eq!(map.shown(4).collect::<Vec<_>>(), [1002, 1003]);
        assert_eq!((map.shown(5).count(), map.shown(3).count(), map.shown(1).count()), (0, 0, 0));
        assert_eq!(map.removed().collect::<Vec<_>>(), [1]);
        assert!(map.is_redrawn(1005) && !map.is_redrawn(1004));
    }

    #[test]
    fn beyond_the_footage_frames_go_with_its_end() {
        assert_eq!((map().made(8), map().made(0)), (Some(1008), None));
        assert!(map().has_own(8));
    }

    #[test]
    fn ranges_reach_from_the_first_frame_that_stands_for_them_to_the_last() {
        assert_eq!(map().range(FrameNumber::MIN, 4), Some([1001, 1003]));
        assert_eq!(map().range(4, 6), Some([1002, 1006]));
        assert_eq!(map().range(3, 3), None);
    }

    #[test]
    fn an_offset_only_renumbers_unless_frames_are_left_out() {
        let moved = FrameMap::offset(1..=3, 1001..=1003, 1000);
        assert!(moved.only_renumbers());
        assert_eq!(moved.made(2), Some(1002));
        assert!(!FrameMap::offset(1..=3, 1000..=1003, 1000).only_renumbers());
        assert!(!FrameMap::offset(1..=3, 1001..=1002, 1000).only_renumbers());
        assert!(!map().only_renumbers());
    }

    #[test]
    fn a_placement_that_moves_nothing_keeps_each_bit() {
        let odd = Point::new(0.1 + 0.2, -1e-300);
        assert_eq!(Placement::SAME.place(odd), odd);
        let moved = Placement { scale: 2.0, shift: Point::new(64.0, 36.0) };
        assert_eq!(moved.place(Point::new(10.0, 20.0)), Point::new(84.0, 76.0));
        assert_eq!(moved.old_place(Point::new(84.0, 76.0)), Point::new(10.0, 20.0));
    }
}
