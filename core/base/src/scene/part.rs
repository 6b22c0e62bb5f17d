//! A part: one contour of a character, followed through the frames.
//!
//! A part contains the artist's input (keys, pins, corrected centres, depths, absence, feather, colour) and the results of tracking and snapping.
//! Points are in pixels of the footage, x right and y down.

use super::spelling::letters_apart;
use super::{Colour, Falloff, FrameNumber, palette};
use crate::geometry::Point;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// A contour with its keys, the artist's corrections, and the results of tracking and snapping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Unique name.
    pub name: String,
    /// Whether the last control point joins the first.
    pub closed: bool,
    /// Depth; larger is nearer to the viewer. Parts of equal depth have no order.
    pub depth: f64,
    /// The artist's control points by frame. Their number is the same on each frame.
    pub keys: BTreeMap<FrameNumber, Vec<Point>>,
    /// Control points that the artist moved on frames between keys, by frame and point index.
    pub pins: BTreeMap<FrameNumber, BTreeMap<usize, Point>>,
    /// Part centres (mean of the control points) that the artist corrected, by frame.
    pub centers: BTreeMap<FrameNumber, Point>,
    /// Tracked control points by frame. A part with several keys has them on every frame from the first to the last
    /// key, keys included. A part with one key has them on the frames around it on which the track is trusted.
    pub tracks: BTreeMap<FrameNumber, Vec<Point>>,
    /// Confidence of each tracked point by frame, 0 to 1.
    pub confidence: BTreeMap<FrameNumber, Vec<f64>>,
    /// Snapped pixel paths: by frame, one path for each segment.
    pub curves: BTreeMap<FrameNumber, Vec<Vec<Point>>>,
    /// For a tracked part with one key: the frames before and after its track on which it was lost. They need a key.
    pub wants_key: Vec<FrameNumber>,
    /// Depths of single frames that differ from `depth`.
    pub depths: BTreeMap<FrameNumber, f64>,
    /// First and last frame of each time in which the part is not there. It has no track there, except on a key.
    pub absent: Vec<[FrameNumber; 2]>,
    /// Widths in pixels, one for each control point, over which the border fades on each side of the contour, on all frames.
    /// Between control points the width changes evenly along the contour. Empty if the border is sharp.
    pub feather: Vec<f64>,
    /// How the border falls off where it is soft.
    pub falloff: Falloff,
    /// The colour that distinguishes the part: red, green, blue, sRGB-encoded, 0 to 1. `None` takes that of its index
    /// ([`super::palette::distinct`]).
    pub colour: Option<[f64; 3]>,
}

/// Number of parts of which a message lists all names.
const LISTED: usize = 12;
/// Number of nearest names that it lists of more.
const NEAREST: usize = 5;

/// A name that no part has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no part {name:?}; the document has {known}")]
pub struct NoSuchPart {
    /// The requested name.
    pub name: String,
    /// The names of the parts, as a list for people; of many parts those whose names are nearest.
    pub known: String,
}

impl NoSuchPart {
    /// The error for these parts.
    pub fn of(parts: &[Part], name: &str) -> Self {
        let listed = |parts: &[&Part]| parts.iter().map(|p| format!("{:?}", p.name)).collect::<Vec<_>>().join(", ");
        let mut nearest: Vec<&Part> = parts.iter().collect();
        let known = match parts.len() {
            0 => "no parts".to_owned(),
            1..=LISTED => listed(&nearest),
            all => {
                // The order of the document stays among names that are equally near.
                nearest.sort_by_key(|part| letters_apart(&part.name.to_lowercase(), &name.to_lowercase()));
                format!("{all} parts, of which the nearest names are {}", listed(&nearest[..NEAREST]))
            }
        };
        Self { name: name.into(), known }
    }
}

/// The frames between two neighbouring keys of a part, keys included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Span {
    /// Frame of the earlier key.
    pub first: FrameNumber,
    /// Frame of the later key.
    pub last: FrameNumber,
}

impl Span {
    /// All frames, keys included.
    pub fn frames(&self) -> impl DoubleEndedIterator<Item = FrameNumber> + use<> {
        self.first..=self.last
    }

    /// Number of frames, keys included.
    pub fn len(&self) -> usize {
        (self.last - self.first + 1) as usize
    }

    /// Always false: a span has at least its two keys.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The frames between the keys.
    pub fn between(&self) -> impl DoubleEndedIterator<Item = FrameNumber> + use<> {
        self.first + 1..self.last
    }
}

impl Part {
    /// Whether it has no contour on any frame.
    pub fn is_bare(&self) -> bool {
        self.keys.is_empty() && self.tracks.is_empty()
    }

    /// The spans between neighbouring keys, in time order. Empty if there are fewer than two keys.
    pub fn spans(&self) -> Vec<Span> {
        let frames: Vec<_> = self.keys.keys().copied().collect();
        frames.windows(2).map(|pair| Span { first: pair[0], last: pair[1] }).collect()
    }

    /// The control points on a frame: the tracked ones, otherwise the artist's key. None where the part is not there, also if
    /// an earlier track has a contour there.
    pub fn points_at(&self, frame: FrameNumber) -> Option<&Vec<Point>> {
        let tracked = self.tracks.get(&frame).filter(|_| !self.is_absent(frame));
        tracked.or_else(|| self.keys.get(&frame))
    }

    /// Frames on which the key is another contour than the tracked one: it was changed after tracking, so the track is out of date.
    pub fn outdated(&self) -> impl Iterator<Item = FrameNumber> + '_ {
        /// Documents are written with rounded numbers, and some programs have 32 bits for a coordinate.
        const SAME: f64 = 0.01;
        let differs = |key: &[Point], tracked: &[Point]| {
            key.len() != tracked.len() || key.iter().zip(tracked).any(|(a, b)| a.distance(*b) > SAME)
        };
        self.keys.iter().filter_map(move |(&frame, key)| {
            let tracked = self.tracks.get(&frame)?;
            differs(key, tracked).then_some(frame)
        })
    }

    /// The contour on a frame as a polyline: the joined snapped paths if they are complete, otherwise the control
    /// points. The last point of a closed part does not repeat the first.
    pub fn outline(&self, frame: FrameNumber) -> Option<Vec<Point>> {
        let points = self.points_at(frame)?;
        let Some(paths) = self.complete_curves(frame) else { return Some(points.clone()) };
        let mut outline: Vec<Point> = paths.concat();
        outline.dedup();
        if self.closed && outline.len() > 1 && outline.first() == outline.last() {
            outline.pop();
        }
        Some(outline)
    }

    /// The snapped paths of a frame, if each segment between control points has one that is not empty.
    pub fn complete_curves(&self, frame: FrameNumber) -> Option<&Vec<Vec<Point>>> {
        let paths = self.curves.get(&frame)?;
        (!paths.is_empty() && paths.len() == self.segment_count() && paths.iter().all(|path| !path.is_empty()))
            .then_some(paths)
    }

    /// Whether the part is not there on a frame. On a key it always is.
    pub fn is_absent(&self, frame: FrameNumber) -> bool {
        let within = |&[first, last]: &[FrameNumber; 2]| (first..=last).contains(&frame);
        !self.keys.contains_key(&frame) && self.absent.iter().any(within)
    }

    /// Marks the part as not there from `first` to `last`. Ranges that touch become one. Nothing happens if `first` is
    /// after `last`.
    pub fn set_absent(&mut self, first: FrameNumber, last: FrameNumber) {
        if first > last {
            return;
        }
        self.absent.push([first, last]);
        self.absent.sort_unstable();
        let mut merged: Vec<[FrameNumber; 2]> = Vec::with_capacity(self.absent.len());
        for &[first, last] in &self.absent {
            match merged.last_mut() {
                Some([_, end]) if first <= end.saturating_add(1) => *end = last.max(*end),
                _ => merged.push([first, last]),
            }
        }
        self.absent = merged;
    }

    /// Removes the results on frames on which the part is not there.
    pub fn forget_where_absent(&mut self) {
        let bare = Self { keys: std::mem::take(&mut self.keys), absent: self.absent.clone(), ..Self::default() };
        self.tracks.retain(|&frame, _| !bare.is_absent(frame));
        self.confidence.retain(|&frame, _| !bare.is_absent(frame));
        self.curves.retain(|&frame, _| !bare.is_absent(frame));
        self.wants_key.retain(|&frame| !bare.is_absent(frame));
        self.keys = bare.keys;
    }

    /// Marks the part as there again from `first` to `last`.
    pub fn clear_absent(&mut self, first: FrameNumber, last: FrameNumber) {
        let rest = |&[from, to]: &[FrameNumber; 2]| {
            if last < from || first > to {
                return vec![[from, to]];
            }
            let before = (from < first).then(|| [from, first - 1]);
            let after = (to > last).then(|| [last + 1, to]);
            before.into_iter().chain(after).collect()
        };
        if first <= last {
            self.absent = self.absent.iter().flat_map(rest).collect();
        }
    }

    /// Adds a number to the frames of everything that the part has. What would be beyond the numbers of frames is left out; times of
    /// absence end there.
    pub fn shift(&mut self, by: FrameNumber) {
        fn moved<T>(map: &mut BTreeMap<FrameNumber, T>, by: FrameNumber) {
            let old = std::mem::take(map).into_iter();
            *map = old.filter_map(|(frame, value)| Some((frame.checked_add(by)?, value))).collect();
        }
        moved(&mut self.keys, by);
        moved(&mut self.pins, by);
        moved(&mut self.centers, by);
        moved(&mut self.tracks, by);
        moved(&mut self.confidence, by);
        moved(&mut self.curves, by);
        moved(&mut self.depths, by);
        self.wants_key = self.wants_key.iter().filter_map(|frame| frame.checked_add(by)).collect();
        self.absent.iter_mut().flatten().for_each(|frame| *frame = frame.saturating_add(by));
    }

    /// Depth on a frame.
    pub fn depth_at(&self, frame: FrameNumber) -> f64 {
        self.depths.get(&frame).copied().unwrap_or(self.depth)
    }

    /// The depth on all these frames, if it is one.
    pub fn depth_in(&self, mut frames: RangeInclusive<FrameNumber>) -> Option<f64> {
        let depth = self.depth_at(*frames.start());
        (self.depths.is_empty() || frames.all(|frame| self.depth_at(frame) == depth)).then_some(depth)
    }

    /// The widths of the soft border, if there is one for each control point and one of them is above 0.
    pub fn soft_widths(&self) -> Option<&[f64]> {
        let soft = self.feather.iter().any(|width| *width > 0.0) && self.feather.len() == self.point_count();
        soft.then_some(&self.feather)
    }

    /// The colour that distinguishes the part, which has an index in its scene.
    pub fn shown_colour(&self, index: usize) -> Colour {
        self.colour.map_or_else(|| palette::distinct(index), |own| own.map(|value| value as f32))
    }

    /// Number of control points; 0 without a key.
    pub fn point_count(&self) -> usize {
        self.keys.values().next().map_or(0, Vec::len)
    }

    /// Number of segments between neighbouring control points.
    pub fn segment_count(&self) -> usize {
        let n = self.point_count();
        if self.closed && n > 1 { n } else { n.saturating_sub(1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_parts_the_nearest_names_are_told() {
        let parts = |count: usize| (0..count).map(|k| Part { name: format!("limb {k}"), ..Part::default() });
        let told = |parts: Vec<Part>, name: &str| NoSuchPart::of(&parts, name).to_string();
        assert_eq!(told(parts(2).collect(), "arm"), "no part \"arm\"; the document has \"limb 0\", \"limb 1\"");
        let mut many: Vec<Part> = parts(30).collect();
        many.push(Part { name: "left arm".into(), ..Part::default() });
        let said = told(many, "Left arn");
        assert!(said.contains("the document has 31 parts, of which the nearest names are \"left arm\", "), "{said}");
        assert_eq!(said.matches('"').count(), 2 + 2 * NEAREST);
        assert_eq!(told(Vec::new(), "arm"), "no part \"arm\"; the document has no parts");
    }

    #[test]
    fn everything_of_a_part_is_shifted_and_back() {
        let at = |x: f64| vec![Point::new(x, 0.0)];
        let part = Part {
            keys: BTreeMap::from([(0, at(0.0)), (4, at(4.0))]),
            pins: BTreeMap::from([(2, BTreeMap::from([(0, Point::ONE)]))]),
            centers: BTreeMap::from([(3, Point::ONE)]),
            tracks: BTreeMap::from([(0, at(0.0)), (1, at(1.0))]),
            confidence: BTreeMap::from([(1, vec![0.5])]),
            curves: BTreeMap::from([(1, vec![at(1.0)])]),
            wants_key: vec![5],
            depths: BTreeMap::from([(1, 2.0)]),
            absent: vec![[2, 3]],
            ..Part::default()
        };
        let mut there = part.clone();
        there.shift(100);
        assert!(there.keys.keys().eq(&[100, 104]) && there.tracks.keys().eq(&[100, 101]));
        assert!(there.pins.contains_key(&102) && there.centers.contains_key(&103));
        assert!([there.confidence.len(), there.curves.len(), there.depths.len()] == [1; 3]);
        assert!(
            there.confidence.contains_key(&101) && there.curves.contains_key(&101) && there.depths.contains_key(&101)
        );
        assert_eq!((&there.wants_key[..], &there.absent[..]), (&[105][..], &[[102, 103]][..]));
        there.shift(-100);
        assert_eq!(there, part);
        there.shift(FrameNumber::MAX - 2);
        assert!(
            there.keys.keys().eq(&[FrameNumber::MAX - 2]) && there.centers.is_empty() && there.wants_key.is_empty()
        );
        assert_eq!(there.absent, [[FrameNumber::MAX; 2]]);
    }

    #[test]
    fn an_old_track_does_not_show_where_the_part_is_absent() {
        let at = |x: f64| vec![Point::new(x, 0.0)];
        let mut part = Part { keys: BTreeMap::from([(0, at(0.0)), (2, at(2.0))]), ..Part::default() };
        part.tracks = BTreeMap::from([(0, at(0.0)), (1, at(1.0)), (2, at(2.0)), (3, at(3.0))]);
        part.absent = vec![[1, 2]];
        let shown: Vec<_> = (0..5).map(|frame| part.points_at(frame).map(|points| points[0].x)).collect();
        assert_eq!(shown, [Some(0.0), None, Some(2.0), Some(3.0), None]);
        assert!(part.outline(1).is_none());
    }

    #[test]
    fn times_of_absence_are_joined_and_cut() {
        let mut part = Part::default();
        for (first, last) in [(10, 12), (3, 4), (5, 6), (20, 19), (12, 14)] {
            part.set_absent(first, last);
        }
        assert_eq!(part.absent, [[3, 6], [10, 14]]);
        part.clear_absent(5, 11);
        assert_eq!(part.absent, [[3, 4], [12, 14]]);
        part.clear_absent(13, 13);
        assert_eq!(part.absent, [[3, 4], [12, 12], [14, 14]]);
        part.clear_absent(FrameNumber::MIN, FrameNumber::MAX);
        assert!(part.absent.is_empty());
    }

    #[test]
    fn marking_frames_absent_is_the_same_as_marking_each_of_them() {
        let mut part = Part::default();
        let mut naive = [false; 32];
        // A fixed sequence of pseudo-random edits.
        let mut state = 12345u32;
        for _ in 0..500 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (first, last) = ((state >> 8) as i32 % 32, (state >> 16) as i32 % 32);
            let absent = state >> 31 == 1;
            if absent {
                part.set_absent(first, last)
            } else {
                part.clear_absent(first, last)
            }
            (first..=last).for_each(|frame| naive[frame as usize] = absent);
            assert!((0..32).all(|frame| part.is_absent(frame) == naive[frame as usize]));
            assert!(part.absent.windows(2).all(|pair| pair[0][1] + 1 < pair[1][0]), "{:?}", part.absent);
        }
    }

    #[test]
    fn an_outline_joins_snapped_paths_or_takes_the_control_points() {
        let p = |x: f64, y: f64| Point::new(x, y);
        let mut part = Part { closed: true, ..Part::default() };
        part.keys.insert(3, vec![p(0.0, 0.0), p(2.0, 0.0)]);
        assert_eq!(part.outline(2), None);
        assert_eq!(part.outline(3), Some(part.keys[&3].clone()));
        let there = vec![p(0.0, 0.0), p(1.0, 1.0), p(2.0, 0.0)];
        let back = vec![p(2.0, 0.0), p(1.0, -1.0), p(0.0, 0.0)];
        part.curves.insert(3, vec![there.clone(), back]);
        assert_eq!(part.outline(3), Some(vec![p(0.0, 0.0), p(1.0, 1.0), p(2.0, 0.0), p(1.0, -1.0)]));
        part.curves.insert(3, vec![there]);
        assert_eq!(part.outline(3), Some(part.keys[&3].clone()), "a segment has no path");
    }
}
