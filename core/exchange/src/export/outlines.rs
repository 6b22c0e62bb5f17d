//! A part's contour with the same number of points on every frame, as formats with animated shapes require it.
//!
//! Snapped paths are resampled by arc length. Each segment gets the number of points that its longest path requires.
//! Without snapped paths the points are the control points.

use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{FrameNumber, Part};

/// Greatest number of points of one segment.
const MOST_POINTS: f64 = 2000.0;
/// Least distance between points, in pixels.
const LEAST_SPACING: f64 = 0.25;

/// The contours of one part.
#[derive(Clone, Debug)]
pub struct Outlines<'a> {
    part: &'a Part,
    /// Number of control points on every frame.
    points: usize,
    /// Number of points of each segment, its end left out; nothing where the part has no snapped paths.
    counts: Vec<usize>,
}

impl<'a> Outlines<'a> {
    /// Prepares the contours of a part. Points of snapped paths are about `spacing` pixels apart.
    pub fn new(part: &'a Part, spacing: f64) -> Self {
        let spacing = spacing.max(LEAST_SPACING);
        let mut counts = Vec::new();
        for &frame in part.curves.keys() {
            let Some(paths) = part.complete_curves(frame) else { continue };
            counts.resize(paths.len(), 1);
            for (count, path) in counts.iter_mut().zip(paths) {
                let wanted = (polyline::length(path, false) / spacing).ceil().clamp(1.0, MOST_POINTS);
                *count = (*count).max(wanted as usize);
            }
        }
        let points = part.keys.values().chain(part.tracks.values()).next().map_or(0, Vec::len);
        Self { part, points, counts }
    }

    /// The contour on a frame, in pixels; `None` if the part has no points there.
    pub fn at(&self, frame: FrameNumber) -> Option<Vec<Point>> {
        // A document may hold a frame with another number of points: it is no contour of this part.
        let points = self.part.points_at(frame).filter(|points| !points.is_empty() && points.len() == self.points)?;
        if self.counts.is_empty() {
            return Some(points.clone());
        }
        let n = points.len();
        let curves = self.part.complete_curves(frame);
        let mut line = Vec::new();
        for (i, &count) in self.counts.iter().enumerate().take(n) {
            let straight = [points[i], points[(i + 1) % n]];
            let segment = curves.and_then(|paths| paths.get(i)).map_or(&straight[..], Vec::as_slice);
            line.extend(&polyline::resample(segment, false, count + 1)[..count]);
        }
        if !self.part.closed {
            line.extend(points.last());
        }
        Some(line)
    }

    /// The frames from `first` to `last` on which there is a contour, each with its contour.
    pub fn within(&self, first: FrameNumber, last: FrameNumber) -> Vec<(FrameNumber, Vec<Point>)> {
        (first..=last).filter_map(|frame| Some((frame, self.at(frame)?))).collect()
    }
}

/// Keys without those that say nothing in a format that goes evenly from one to the next: a contour that is the same as before and
/// after is held.
pub fn turning(keys: &[(FrameNumber, Vec<Point>)]) -> Vec<(FrameNumber, Vec<Point>)> {
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
    fn held_contours_have_keys_at_their_ends() {
        let keys = [0, 0, 1, 1, 1, 1, 2, 2].map(|x| vec![Point::new(f64::from(x), 0.0)]);
        let keys: Vec<(FrameNumber, Vec<Point>)> = (3..).zip(keys).collect();
        let frames = |keys: &[_]| turning(keys).iter().map(|(frame, _)| *frame).collect::<Vec<FrameNumber>>();
        assert_eq!(frames(&keys), [3, 4, 5, 8, 9, 10]);
        assert_eq!(frames(&keys[2..5]), [5, 7]);
        assert_eq!((frames(&keys[..1]), frames(&[])), (vec![3], vec![]));
    }
}
