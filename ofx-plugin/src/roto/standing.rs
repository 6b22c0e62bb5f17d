//! How a part stands on a frame: fine, doubtful, lost or hidden.
//!
//! The bounds are those of the core ([`rototoon::scene::outcome`]), so the node says the same as the command line and
//! Blender. One thing is added: a part with one key that was lost is lost on all frames from there to the end of the
//! footage, because it has no shape on any of them.

use rototoon::scene::{Footage, FrameNumber, Outcome, Part, Verdict};
use std::collections::BTreeMap;

/// How a part stands on a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// A key, a sure contour, or nothing to say.
    Fine,
    /// The footage does not show it.
    Hidden,
    /// A look at it is worth while.
    Doubtful,
    /// It is probably wrong, or was not found.
    Lost,
}

/// First and last frame of a stretch.
pub type Stretch = [FrameNumber; 2];

/// How a part stands on a frame.
pub fn on(part: &Part, frame: FrameNumber, footage: &Footage) -> Standing {
    if part.keys.contains_key(&frame) {
        return Standing::Fine;
    }
    if part.is_absent(frame) {
        return Standing::Hidden;
    }
    if let Some(verdict) = Verdict::on(part, frame) {
        return match verdict {
            Verdict::Sure => Standing::Fine,
            Verdict::Doubtful => Standing::Doubtful,
            Verdict::Lost => Standing::Lost,
        };
    }
    let without = unfound(part, footage);
    if without.iter().any(|[first, last]| (*first..=*last).contains(&frame)) { Standing::Lost } else { Standing::Fine }
}

/// The stretches beyond the track of a part with one key that was lost.
fn unfound(part: &Part, footage: &Footage) -> Vec<Stretch> {
    let beyond = |frame: &FrameNumber| {
        let later = part.keys.range(frame..).next().is_none();
        if later { [*frame, footage.last] } else { [footage.first, *frame] }
    };
    part.wants_key.iter().map(beyond).filter(|[first, last]| first <= last).collect()
}

/// The stretches on which a part stands like this, in time order. They do not touch each other.
pub fn stretches(part: &Part, standing: Standing, footage: &Footage) -> Vec<Stretch> {
    let single = |frames: Vec<FrameNumber>| frames.into_iter().map(|frame| [frame, frame]).collect();
    let found: Vec<Stretch> = match standing {
        Standing::Fine => Vec::new(),
        Standing::Hidden => part.absent.clone(),
        Standing::Doubtful => single(Outcome::of(part).doubtful),
        Standing::Lost => {
            let mut found: Vec<Stretch> = single(Outcome::of(part).lost);
            found.extend(unfound(part, footage));
            found
        }
    };
    // The core's own unions and differences of stretches.
    let mut bare = Part::default();
    found.into_iter().for_each(|[first, last]| bare.set_absent(first, last));
    part.keys.keys().for_each(|&key| bare.clear_absent(key, key));
    if standing != Standing::Hidden {
        part.absent.iter().for_each(|&[first, last]| bare.clear_absent(first, last));
    }
    bare.clear_absent(FrameNumber::MIN, footage.first.saturating_sub(1));
    bare.clear_absent(footage.last.saturating_add(1), FrameNumber::MAX);
    bare.absent
}

/// The number of parts that stand like this, by frame, where it changes: the frame before the change and the frame after
/// it. Between these frames the number is even, so any interpolation that passes through the keys shows it. Empty if it is
/// always zero.
pub fn counts(parts: &[Part], standing: Standing, footage: &Footage) -> BTreeMap<FrameNumber, i32> {
    let mut steps: BTreeMap<FrameNumber, i32> = BTreeMap::new();
    for [first, last] in parts.iter().flat_map(|part| stretches(part, standing, footage)) {
        *steps.entry(first).or_default() += 1;
        *steps.entry(last.saturating_add(1)).or_default() -= 1;
    }
    let (mut counts, mut count) = (BTreeMap::new(), 0);
    for (frame, step) in steps.into_iter().filter(|(_, step)| *step != 0) {
        counts.entry(frame.saturating_sub(1)).or_insert(count);
        count += step;
        counts.insert(frame, count);
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon::geometry::Point;

    fn footage() -> Footage {
        Footage { pattern: "%d.png".into(), first: 0, last: 19, fps: 24.0, width: 8, height: 8, held: false }
    }

    fn part(keys: &[FrameNumber], shares: &[(FrameNumber, f64)]) -> Part {
        Part {
            keys: keys.iter().map(|frame| (*frame, vec![Point::ZERO; 2])).collect(),
            confidence: shares.iter().map(|(frame, share)| (*frame, vec![*share; 2])).collect(),
            ..Part::default()
        }
    }

    #[test]
    fn a_lost_part_with_one_key_is_lost_to_the_ends_of_the_footage() {
        let mut part = part(&[10], &[(9, 0.9), (11, 0.6)]);
        part.wants_key = vec![7, 13];
        part.absent = vec![[15, 400]];
        let all = |standing| stretches(&part, standing, &footage());
        assert_eq!(all(Standing::Lost), [[0, 7], [13, 14]]);
        assert_eq!((all(Standing::Doubtful), all(Standing::Hidden)), (vec![[11, 11]], vec![[15, 19]]));
        assert_eq!([8, 10, 11, 13, 15].map(|frame| on(&part, frame, &footage())), {
            use Standing::{Doubtful, Fine, Hidden, Lost};
            [Fine, Fine, Doubtful, Lost, Hidden]
        });
    }

    #[test]
    fn counts_have_a_key_on_each_side_of_a_change() {
        let low = |frames: std::ops::RangeInclusive<FrameNumber>| frames.map(|frame| (frame, 0.1)).collect::<Vec<_>>();
        let parts = [part(&[0, 19], &low(3..=5)), part(&[0, 19], &low(5..=6)), part(&[0, 19], &[])];
        let expected = [(2, 0), (3, 1), (4, 1), (5, 2), (6, 1), (7, 0)];
        assert_eq!(counts(&parts, Standing::Lost, &footage()), expected.into());
        assert!(counts(&parts[2..], Standing::Lost, &footage()).is_empty());
    }

    proptest! {
        #[test]
        fn stretches_are_the_frames_that_stand_so(
            keys in prop::collection::btree_set(0..20i32, 1..4),
            shares in prop::collection::btree_map(0..20i32, 0.0..1.0f64, 0..20),
            absent in prop::collection::vec((-3..25i32, 0..6i32), 0..3),
            wanted in prop::collection::vec(0..20i32, 0..2),
        ) {
            let mut part = part(&keys.into_iter().collect::<Vec<_>>(), &shares.into_iter().collect::<Vec<_>>());
            absent.into_iter().for_each(|(first, count)| part.set_absent(first, first + count));
            part.forget_where_absent();
            // Beyond a track there is no confidence.
            part.wants_key = wanted;
            let unfound = super::unfound(&part, &footage());
            part.confidence.retain(|frame, _| !unfound.iter().any(|[a, b]| (*a..=*b).contains(frame)));
            for standing in [Standing::Hidden, Standing::Doubtful, Standing::Lost] {
                let naive: Vec<FrameNumber> = (0..20).filter(|&frame| on(&part, frame, &footage()) == standing).collect();
                let found: Vec<FrameNumber> =
                    stretches(&part, standing, &footage()).into_iter().flat_map(|[a, b]| a..=b).collect();
                prop_assert_eq!(found, naive, "{:?}", standing);
            }
        }
    }
}
