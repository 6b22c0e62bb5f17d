//! A part's contour with the same number of points on every frame, as formats with animated shapes require it.
//!
//! Snapped paths are resampled by arc length, and each segment gets the number of points that its longest path requires; or they
//! become Bézier curves of few points (`bezier`). Without snapped paths the points are the control points, and the sides are straight.

use super::bezier::Curves;
use super::knot::Knot;
use crate::between::{Key, on_way};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{FrameNumber, Part};

/// How contours follow snapped paths. A number is a spacing in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// By points this far apart, in pixels, with straight sides; at least 0.25.
    Spacing(f64),
    /// By Bézier curves within this many pixels of them, with as few points as that needs; at least 0.05.
    Bezier(f64),
}

impl From<f64> for Detail {
    fn from(spacing: f64) -> Self {
        Self::Spacing(spacing)
    }
}

/// How shapes are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeOptions {
    /// How contours follow snapped paths.
    pub detail: Detail,
    /// Width of a pixel of the footage divided by its height.
    pub pixel_aspect: f64,
}

impl From<Detail> for ShapeOptions {
    fn from(detail: Detail) -> Self {
        Self { detail, pixel_aspect: 1.0 }
    }
}

impl From<f64> for ShapeOptions {
    fn from(spacing: f64) -> Self {
        Detail::Spacing(spacing).into()
    }
}

/// Contours with their frames.
pub type Keys = Vec<(FrameNumber, Vec<Knot>)>;

/// Greatest number of points of one segment.
const MOST_POINTS: f64 = 2000.0;
/// Least distance between points, in pixels.
const LEAST_SPACING: f64 = 0.25;
/// Least distance that Bézier curves may have from paths, in pixels.
const LEAST_TOLERANCE: f64 = 0.05;

/// The contours of one part.
#[derive(Clone, Debug)]
pub struct Outlines<'a> {
    part: &'a Part,
    /// Number of control points on every frame.
    points: usize,
    followed: Followed,
}

/// What the contours of a part follow.
#[derive(Clone, Debug)]
enum Followed {
    /// The control points.
    Points,
    /// Snapped paths, by points: the number of points of each segment, its end left out.
    Paths(Vec<usize>),
    /// Snapped paths, by Bézier curves.
    Curves(Curves),
}

impl<'a> Outlines<'a> {
    /// Prepares the contours of a part.
    pub fn new(part: &'a Part, detail: impl Into<Detail>) -> Self {
        let points = part.keys.values().chain(part.tracks.values()).next().map_or(0, Vec::len);
        let followed = match detail.into() {
            Detail::Spacing(spacing) => paths(part, spacing.max(LEAST_SPACING)),
            Detail::Bezier(tolerance) => {
                let curves = Curves::new(part, tolerance.max(LEAST_TOLERANCE), |frame| control(part, points, frame));
                curves.map_or(Followed::Points, Followed::Curves)
            }
        };
        Self { part, points, followed }
    }

    /// Whether the sides are curves, on all frames alike.
    pub fn bent(&self) -> bool {
        matches!(self.followed, Followed::Curves(_))
    }

    /// The contour on a frame, in pixels; `None` if the part has no points there.
    pub fn at(&self, frame: FrameNumber) -> Option<Vec<Knot>> {
        let points = control(self.part, self.points, frame)?;
        let counts = match &self.followed {
            Followed::Points => return Some(points.iter().copied().map(Knot::bare).collect()),
            Followed::Curves(curves) => return Some(curves.at(frame, points, self.part.closed)),
            Followed::Paths(counts) => counts,
        };
        let n = points.len();
        let curves = self.part.complete_curves(frame);
        let mut line = Vec::new();
        for (i, &count) in counts.iter().enumerate().take(n) {
            let straight = [points[i], points[(i + 1) % n]];
            let segment = curves.and_then(|paths| paths.get(i)).map_or(&straight[..], Vec::as_slice);
            line.extend(&polyline::resample(segment, false, count + 1)[..count]);
        }
        if !self.part.closed {
            line.extend(points.last());
        }
        Some(line.into_iter().map(Knot::bare).collect())
    }

    /// The contour that a frame shows, for formats that have one on every frame: a part that has nothing but keys goes evenly from one to the
    /// next, as other programs move it, except where the artist hides it. `None` if the part is not there.
    pub fn shown(&self, frame: FrameNumber) -> Option<Vec<Knot>> {
        if let Some(own) = self.at(frame) {
            return Some(own);
        }
        if !self.part.tracks.is_empty() || self.part.is_absent(frame) {
            return None;
        }
        let is_contour = |(_, points): &Key| is_contour(points, self.points);
        let before = self.part.keys.range(..frame).rev().find(is_contour)?;
        let after = self.part.keys.range(frame..).find(is_contour)?;
        Some(on_way(before, after, frame).into_iter().map(Knot::bare).collect())
    }

    /// The frames from `first` to `last` that show a contour, each with it.
    pub fn shown_within(&self, first: FrameNumber, last: FrameNumber) -> Keys {
        (first..=last).filter_map(|frame| Some((frame, self.shown(frame)?))).collect()
    }

    /// The frames from `first` to `last` on which there is a contour, each with its contour.
    pub fn within(&self, first: FrameNumber, last: FrameNumber) -> Keys {
        (first..=last).filter_map(|frame| Some((frame, self.at(frame)?))).collect()
    }
}

/// The control points of a part on a frame.
fn control(part: &Part, count: usize, frame: FrameNumber) -> Option<&Vec<Point>> {
    part.points_at(frame).filter(|points| is_contour(points, count))
}

/// Whether these are a contour of a part of `count` control points. A document may hold a frame with none, or with another number.
fn is_contour(points: &[Point], count: usize) -> bool {
    !points.is_empty() && points.len() == count
}

/// Points of snapped paths about `spacing` pixels apart.
fn paths(part: &Part, spacing: f64) -> Followed {
    let mut counts = Vec::new();
    for &frame in part.curves.keys() {
        let Some(paths) = part.complete_curves(frame) else { continue };
        counts.resize(paths.len(), 1);
        for (count, path) in counts.iter_mut().zip(paths) {
            let wanted = (polyline::length(path, false) / spacing).ceil().clamp(1.0, MOST_POINTS);
            *count = (*count).max(wanted as usize);
        }
    }
    if counts.is_empty() { Followed::Points } else { Followed::Paths(counts) }
}

/// Keys without those that say nothing in a format that goes evenly from one to the next: a contour that is the same as before and
/// after is held.
pub fn turning<T: Clone + PartialEq>(keys: &[(FrameNumber, T)]) -> Vec<(FrameNumber, T)> {
    let held = |k: usize| k > 0 && k + 1 < keys.len() && keys[k - 1].1 == keys[k].1 && keys[k].1 == keys[k + 1].1;
    keys.iter().enumerate().filter(|(k, _)| !held(*k)).map(|(_, key)| key.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_with_another_number_of_points_has_no_contour() {
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)].map(Point::from).to_vec();
        let mut part = Part { closed: true, ..Part::default() };
        part.keys.insert(0, square.clone());
        part.tracks.insert(0, square.clone());
        part.tracks.insert(1, square[..2].to_vec());
        part.tracks.insert(2, square.clone());
        let frames: Vec<_> = Outlines::new(&part, 1.0).within(0, 2).into_iter().map(|(frame, _)| frame).collect();
        assert_eq!(frames, [0, 2]);
    }

    #[test]
    fn keys_that_are_no_contour_lead_nowhere() {
        let line = [(0.0, 0.0), (4.0, 0.0)].map(Point::from).to_vec();
        let shown = |keys: [Vec<Point>; 3]| {
            let part = Part { keys: [0, 4, 8].into_iter().zip(keys).collect(), ..Part::default() };
            Outlines::new(&part, 1.0).shown_within(0, 8)
        };
        assert!(shown([const { Vec::new() }; 3]).is_empty(), "no points are no contour");
        assert!(
            shown([vec![], line.clone(), line.clone()]).is_empty(),
            "the first key says how many points a part has"
        );
        let bent = shown([line.clone(), vec![Point::new(9.0, 9.0); 3], line]);
        assert_eq!(bent.len(), 9, "the way goes past a key with another number of points");
        assert!(bent.iter().all(|(_, knots)| knots.len() == 2 && knots[1].at == Point::new(4.0, 0.0)));
    }

    #[test]
    fn held_contours_have_keys_at_their_ends() {
        let keys = [0, 0, 1, 1, 1, 1, 2, 2].map(|x| vec![Point::new(f64::from(x), 0.0)]);
        let keys: Vec<(FrameNumber, Vec<Point>)> = (3..).zip(keys).collect();
        let frames = |keys: &[_]| turning(keys).iter().map(|(frame, _)| *frame).collect::<Vec<FrameNumber>>();
        assert_eq!(frames(&keys), [3, 4, 5, 8, 9, 10]);
        assert_eq!(frames(&keys[2..5]), [5, 7]);
        assert_eq!((frames(&keys[..1]), frames(&[])), (vec![3], vec![]));
    }
}
