//! Finds the frame where the next key helps most.
//!
//! The doubt about a part on a frame is the mean of 1 − confidence over its points. Doubt comes in stretches: once the
//! tracker has lost a part, it stays lost until the next key. A key in the middle of such a stretch corrects most of
//! it. So each part's doubt is smoothed over time between its keys, and then the parts are added up. Smoothing moves the
//! maximum from a single bad frame towards the middle of a bad stretch.
//!
//! A part with one key is followed on both sides of it, and smoothed there in the same way. Where it was lost there is
//! no contour at all: the first frame beyond its track counts as one whole doubt.
//!
//! The keys of a part are not proposed for it. The frames beside them are proposed only if there are no others, because
//! another key there would correct almost nothing.
//!
//! The kernel is the binomial 1 4 6 4 1. It is about two drawings wide for animation on twos. Beyond the keys it meets
//! zeros, because nothing is in doubt there.

use rototoon_base::scene::outcome::confidence;
use rototoon_base::scene::{FrameNumber, Part};
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

/// The frame with the most doubt, the earliest of equals. `None` if there is no tracked frame but the keys.
pub fn weakest_frame(parts: &[Part]) -> Option<WeakestFrame> {
    let (mut doubts, mut beside) = (BTreeMap::new(), BTreeMap::new());
    for part in parts {
        add_doubt(part, &mut doubts, &mut beside);
    }
    let best = |doubts: BTreeMap<FrameNumber, f64>| {
        let candidates = doubts.into_iter().map(|(frame, score)| WeakestFrame { frame, score });
        candidates.reduce(|best, next| if next.score > best.score { next } else { best })
    };
    best(doubts).or_else(|| best(beside))
}

/// Adds the smoothed doubts of a part: to `doubts`, and on the frames beside a key to `beside`.
fn add_doubt(part: &Part, doubts: &mut BTreeMap<FrameNumber, f64>, beside: &mut BTreeMap<FrameNumber, f64>) {
    let sure = confidence(part);
    let is_key = |frame: FrameNumber| part.keys.contains_key(&frame);
    for &frame in sure.keys() {
        // What is beyond the next key on either side belongs to another span.
        let reach = |step: FrameNumber| (1..=2).take_while(|k| !is_key(frame + step * k)).last().unwrap_or(0);
        let near = frame - reach(-1)..=frame + reach(1);
        let doubt = |at: FrameNumber| sure.get(&at).map_or(0.0, |confidence| 1.0 - confidence);
        let smoothed: f64 =
            KERNEL.iter().zip(frame - 2..).filter(|(_, at)| near.contains(at)).map(|(w, at)| w * doubt(at)).sum();
        let chosen = if is_key(frame - 1) || is_key(frame + 1) { &mut *beside } else { &mut *doubts };
        *chosen.entry(frame).or_default() += smoothed;
    }
    for frame in part.wants_key.iter().filter(|frame| !sure.contains_key(frame)) {
        *doubts.entry(*frame).or_default() += 1.0;
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
    fn neighbours_of_keys_are_proposed_only_if_there_is_nothing_else() {
        assert_eq!(weakest_frame(&[part(&[1.0, 0.9, 0.0, 1.0])]).unwrap().frame, 2);
        assert_eq!(weakest_frame(&[part(&[1.0, 1.0])]), None);
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
    fn a_part_with_one_key_wants_one_where_it_was_lost() {
        let mut single = part(&[1.0, 0.9, 0.8, 0.7, 0.6]);
        single.keys.remove(&4);
        assert_eq!(weakest_frame(&[single.clone()]).unwrap().frame, 3, "the kernel meets nothing beyond the track");
        single.wants_key = vec![5];
        assert_eq!(weakest_frame(&[single]), Some(WeakestFrame { frame: 5, score: 1.0 }));
    }

    #[test]
    fn doubt_beyond_a_key_does_not_count() {
        let mut two = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.5, 1.0, 1.0, 1.0]);
        two.keys.insert(6, vec![Point::ZERO]);
        assert_eq!(weakest_frame(&[two]).unwrap(), WeakestFrame { frame: 4, score: 4.0 / 16.0 });
    }

    #[test]
    fn untracked_parts_are_ignored() {
        let mut untracked = part(&[1.0; 9]);
        untracked.confidence.clear();
        assert_eq!(weakest_frame(&[untracked]), None);
        assert_eq!(weakest_frame(&[]), None);
    }
}
