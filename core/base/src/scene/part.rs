//! A part: one contour of a character, followed through the frames.
//!
//! A part contains the artist's input (keys, pins, corrected centres, depths, absence) and the results of tracking and snapping.
//! Points are in pixels of the footage, x right and y down.

use super::FrameNumber;
use crate::geometry::Point;
use std::collections::BTreeMap;

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
}

/// The frames between two neighbouring keys of a part, keys included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
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
    /// The spans between neighbouring keys, in time order. Empty if there are fewer than two keys.
    pub fn spans(&self) -> Vec<Span> {
        let frames: Vec<_> = self.keys.keys().copied().collect();
        frames.windows(2).map(|pair| Span { first: pair[0], last: pair[1] }).collect()
    }

    /// The control points on a frame: the tracked ones, otherwise the artist's key.
    pub fn points_at(&self, frame: FrameNumber) -> Option<&Vec<Point>> {
        self.tracks.get(&frame).or_else(|| self.keys.get(&frame))
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

    /// Depth on a frame.
    pub fn depth_at(&self, frame: FrameNumber) -> f64 {
        self.depths.get(&frame).copied().unwrap_or(self.depth)
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
