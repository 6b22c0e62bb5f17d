//! What became of a part on each frame: sure, doubtful or lost.
//!
//! The confidence of a point is the probability that it is in its place, so the mean over the points of a contour is the
//! share of its points that are expected to be. A contour is *sure* if that share is at least [`SURE`], *lost* if it is
//! below [`LOST`], and *doubtful* between them. Keys are the artist's, and beyond doubt. A key that was changed after tracking
//! is another contour than the track there, which all later stages use: that frame is lost until the part is tracked again. A
//! part with one key is lost on the frames beyond its track where it needs a key. Where a part is absent nothing became of it, whatever an older track says.
//!
//! Everything that speaks of lost parts uses these bounds: the command line, the reports and the Blender add-on.

use super::{FrameNumber, Part};
use std::collections::BTreeMap;

/// Least share of points in place of a contour that needs no look.
pub const SURE: f64 = 0.8;
/// Share of points in place below which a contour is lost.
pub const LOST: f64 = 0.5;

/// What became of a contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It needs no look.
    Sure,
    /// A look at it is worth while.
    Doubtful,
    /// It is probably wrong.
    Lost,
}

/// What became of a part, by frame. Each list rises.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Frames of tracked contours that are sure. Keys are not counted.
    pub sure: Vec<FrameNumber>,
    /// Frames of doubtful contours.
    pub doubtful: Vec<FrameNumber>,
    /// Frames of lost contours, those of keys that were changed after tracking, and those beyond a track where the part needs a key.
    pub lost: Vec<FrameNumber>,
}

impl Verdict {
    /// Of a contour with this share of points in place.
    pub fn of(confidence: f64) -> Self {
        // Written so that NaN is lost.
        if confidence >= SURE {
            Self::Sure
        } else if confidence >= LOST {
            Self::Doubtful
        } else {
            Self::Lost
        }
    }

    /// Of a part's tracked contour on a frame. None on a key, where the part is absent, and where nothing was tracked.
    pub fn on(part: &Part, frame: FrameNumber) -> Option<Self> {
        let points = part.confidence.get(&frame).filter(|_| counts(part, frame))?;
        mean(points).map(Self::of)
    }
}

impl Outcome {
    /// Of a part as it was tracked.
    pub fn of(part: &Part) -> Self {
        let mut outcome = Self::default();
        for (frame, confidence) in confidence(part) {
            outcome.of_verdict(Verdict::of(confidence)).push(frame);
        }
        let wanted = part.wants_key.iter().filter(|frame| !part.confidence.contains_key(frame));
        outcome.lost.extend(wanted.filter(|&&frame| !part.is_absent(frame)));
        outcome.lost.extend(part.outdated());
        outcome.lost.sort_unstable();
        outcome
    }

    fn of_verdict(&mut self, verdict: Verdict) -> &mut Vec<FrameNumber> {
        match verdict {
            Verdict::Sure => &mut self.sure,
            Verdict::Doubtful => &mut self.doubtful,
            Verdict::Lost => &mut self.lost,
        }
    }
}

/// Whether the confidence of a part on a frame says something of it: a key is beyond doubt, and an absent part has no contour.
fn counts(part: &Part, frame: FrameNumber) -> bool {
    !part.keys.contains_key(&frame) && !part.is_absent(frame)
}

/// The mean confidence of a part's tracked contours by frame, without keys and frames on which it is absent.
pub fn confidence(part: &Part) -> BTreeMap<FrameNumber, f64> {
    let tracked = part.confidence.iter().filter(|(frame, _)| counts(part, **frame));
    tracked.filter_map(|(&frame, points)| Some((frame, mean(points)?))).collect()
}

/// The mean confidence of the points of a contour. `None` if it has none.
pub fn mean(points: &[f64]) -> Option<f64> {
    (!points.is_empty()).then(|| points.iter().sum::<f64>() / points.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    #[test]
    fn frames_are_sure_doubtful_or_lost() {
        let mut part = Part::default();
        part.keys.insert(0, vec![Point::ZERO; 2]);
        let shares = [[0.0, 0.0], [1.0, 0.9], [0.9, 0.5], [0.9, 0.0], [f64::NAN, 1.0]];
        part.confidence = (0..).zip(shares.map(|pair| pair.to_vec())).collect();
        part.wants_key = vec![-1, 5];
        let expected = Outcome { sure: vec![1], doubtful: vec![2], lost: vec![-1, 3, 4, 5] };
        assert_eq!(Outcome::of(&part), expected, "the key on frame 0 is beyond doubt");
        assert_eq!(Outcome::of(&Part::default()), Outcome::default());
        part.tracks.insert(0, vec![Point::ZERO; 2]);
        assert_eq!(Outcome::of(&part), expected);
        part.tracks.insert(0, vec![Point::X; 2]);
        let stale = Outcome { lost: vec![-1, 0, 3, 4, 5], ..expected };
        assert_eq!(Outcome::of(&part), stale, "the key on frame 0 was changed after tracking");
        use Verdict::{Doubtful, Lost, Sure};
        let on = [0, 1, 2, 3, 4, 5].map(|frame| Verdict::on(&part, frame));
        assert_eq!(on, [None, Some(Sure), Some(Doubtful), Some(Lost), Some(Lost), None]);
        part.confidence.insert(6, Vec::new());
        assert_eq!(Verdict::on(&part, 6), None, "a contour without points");
    }

    #[test]
    fn nothing_became_of_a_part_where_it_is_absent() {
        let confidence = [(1, vec![0.1]), (2, vec![0.1]), (3, vec![1.0])].into();
        let part = Part { confidence, wants_key: vec![0, 4], absent: vec![[2, 4]], ..Part::default() };
        let expected = Outcome { lost: vec![0, 1], ..Outcome::default() };
        assert_eq!(Outcome::of(&part), expected);
        assert_eq!([1, 2, 3].map(|frame| Verdict::on(&part, frame)), [Some(Verdict::Lost), None, None]);
    }
}
