//! Finds the frame where the next key helps most.
//!
//! The doubt about a part on a frame is the mean of 1 − confidence over its points. Doubt comes in stretches: once the
//! tracker has lost a part, it stays lost until the next key. A key in the middle of such a stretch corrects most of
//! it. So each part's doubt is smoothed over time within a span, and then the parts are added up. Smoothing moves the
//! maximum from a single bad frame towards the middle of a bad stretch. The keys of a part and the frames beside them
//! are not proposed for it, because another key there would correct almost nothing.
//!
//! The kernel is the binomial 1 4 6 4 1. It is about two drawings wide for animation on twos. Beyond the keys it meets
//! zeros, because nothing is in doubt there.

use rototoon_base::scene::{FrameNumber, Part, Span};
use std::collections::BTreeMap;

/// Binomial weights around a frame. Their sum is 1.
const KERNEL: [f64; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// A frame with its doubt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeakestFrame {
    /// The frame.
    pub frame: FrameNumber,
    /// Sum over the parts of the smoothed mean of 1 − confidence: from 0, if everything is sure, to the number of
    /// parts.
    pub score: f64,
}

/// The frame with the most doubt, the earliest of equals. `None` if nothing was tracked or every frame is a key or
/// beside one.
pub fn weakest_frame(parts: &[Part]) -> Option<WeakestFrame> {
    let mut doubts = BTreeMap::<FrameNumber, f64>::new();
    for part in parts {
        for span in part.spans() {
            add_doubt(part, span, &mut doubts);
        }
    }
    let candidates = doubts.into_iter().map(|(frame, score)| WeakestFrame { frame, score });
    candidates.reduce(|best, next| if next.score > best.score { next } else { best })
}

fn add_doubt(part: &Part, span: Span, doubts: &mut BTreeMap<FrameNumber, f64>) {
    let doubt = |frame: FrameNumber| match part.confidence.get(&frame) {
        Some(points) if span.first < frame && frame < span.last && !points.is_empty() => {
            points.iter().map(|confidence| 1.0 - confidence).sum::<f64>() / points.len() as f64
        }
        _ => 0.0,
    };
    for frame in span.first + 2..=span.last - 2 {
        if part.confidence.contains_key(&frame) {
            let smoothed: f64 = KERNEL.iter().zip(frame - 2..).map(|(weight, near)| weight * doubt(near)).sum();
            *doubts.entry(frame).or_default() += smoothed;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    /// A part of one point, keyed on the first and last frame, with the given confidence from frame 0 on.
    fn part(confidence: &[f64]) -> Part {
        let last = confidence.len() as FrameNumber - 1;
        Part {
            keys: [(0, vec![Point::ZERO]), (last, vec![Point::ZERO])].into(),
            confidence: (0..).zip(confidence.iter().map(|&c| vec![c])).collect(),
            ..Part::default()
        }
    }

    #[test]
    fn one_doubt_is_smoothed_by_the_middle_of_the_kernel() {
        let found = weakest_frame(&[part(&[1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0])]);
        assert_eq!(found, Some(WeakestFrame { frame: 3, score: 6.0 / 16.0 }));
    }

    #[test]
    fn middle_of_a_bad_stretch_beats_a_single_worse_frame() {
        let found = weakest_frame(&[part(&[1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.4, 0.4, 0.4, 1.0, 1.0, 1.0])]);
        assert_eq!(found.unwrap().frame, 7);
    }

    #[test]
    fn neighbours_of_keys_are_never_proposed() {
        assert_eq!(weakest_frame(&[part(&[1.0, 0.0, 0.0, 1.0])]), None);
        assert_eq!(weakest_frame(&[part(&[1.0, 0.0, 0.9, 0.0, 1.0])]).unwrap().frame, 2);
    }

    #[test]
    fn parts_add_up_and_the_earliest_of_equals_wins() {
        let sure = [1.0; 9];
        let early = part(&[1.0, 1.0, 1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let late = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 1.0, 1.0, 1.0]);
        assert_eq!(weakest_frame(&[part(&sure), late.clone()]).unwrap().frame, 5);
        assert_eq!(weakest_frame(&[early.clone(), late.clone(), late.clone()]).unwrap().frame, 5);
        assert_eq!(weakest_frame(&[part(&sure)]).unwrap(), WeakestFrame { frame: 2, score: 0.0 });
    }

    #[test]
    fn untracked_parts_are_ignored() {
        let mut untracked = part(&[1.0; 9]);
        untracked.confidence.clear();
        assert_eq!(weakest_frame(&[untracked]), None);
        assert_eq!(weakest_frame(&[]), None);
    }
}
