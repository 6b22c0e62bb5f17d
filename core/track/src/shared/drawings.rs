//! The distinct drawings of a span. Animation often holds a drawing for two or three frames; the tracker solves it
//! once. Which frames show the same drawing is the question of [`held`](super::held).
//!
//! Frames on which the part is absent belong to no drawing. Between the drawings around them is a *gap*: nothing is known about
//! what the part does there.

use crate::contract::job::Job;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Neighbouring frames of a span that show one drawing, as frame indices in the span. A drawing has at least one frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Drawing {
    /// Index of the first frame.
    pub first: usize,
    /// Index of the last frame.
    pub last: usize,
}

/// The indices of the drawings that begin after a gap.
pub fn gaps(drawings: &[Drawing]) -> Vec<usize> {
    (1..drawings.len()).filter(|&d| drawings[d - 1].last + 1 < drawings[d].first).collect()
}

/// The drawings that some of the frames between two frame indices show. `None` if all of them are in a gap.
pub fn shown(drawings: &[Drawing], [first, last]: [usize; 2]) -> Option<RangeInclusive<usize>> {
    let shows = |d: &Drawing| d.first <= last && first <= d.last;
    Some(drawings.iter().position(shows)?..=drawings.iter().rposition(shows)?)
}

/// Groups the frames of a job on which the part is there into drawings. `same(i)` says whether frame i + 1 shows the same drawing as frame i.
///
/// The first key is in the first group and the second key in the last, each with the frames held from it. A corrected
/// frame begins a group of its own if the group before has a different correction or contains the first key. The second
/// key begins a group of its own if the group before is corrected or contains the first key.
pub fn group(job: &Job, same: impl Fn(usize) -> bool) -> Vec<Drawing> {
    let last = job.span.len() - 1;
    let mut drawings = vec![Drawing { first: 0, last: 0 }];
    for index in (1..=last).filter(|index| !job.absent.contains(index)) {
        let current = drawings.len() - 1;
        let begins = &drawings[current];
        let corrected = (begins.first..index).rev().find_map(|i| job.corrections.get(&i));
        let contradicts = job
            .corrections
            .get(&index)
            .is_some_and(|own| begins.first == 0 || corrected.is_some_and(|before| before != own));
        let released = index == last && (begins.first == 0 || corrected.is_some());
        let follows = begins.last + 1 == index;
        if follows && same(index - 1) && !contradicts && !released {
            drawings[current].last = index;
        } else {
            drawings.push(Drawing { first: index, last: index });
        }
    }
    drawings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::job::Correction;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Span;
    use std::collections::{BTreeMap, BTreeSet};

    fn job(corrected: &[(usize, f64)]) -> Job {
        let correction = |x: f64| Correction { pins: BTreeMap::from([(0, Point::new(x, 0.0))]), center: None };
        Job {
            name: "part".into(),
            closed: true,
            span: Span { first: 10, last: 16 },
            keys: [vec![Point::ZERO], vec![Point::ONE]],
            corrections: corrected.iter().map(|&(i, x)| (i, correction(x))).collect(),
            absent: BTreeSet::new(),
            occluders: vec![Vec::new(); 7],
            size: (10, 10),
        }
    }

    fn sizes(job: &Job, same: impl Fn(usize) -> bool) -> Vec<usize> {
        group(job, same).iter().map(|d| d.last - d.first + 1).collect()
    }

    #[test]
    fn drawings_on_twos_make_pairs() {
        assert_eq!(sizes(&job(&[]), |i| i % 2 == 0), [2, 2, 2, 1]);
        assert_eq!(sizes(&job(&[]), |_| false), [1; 7]);
    }

    #[test]
    fn a_span_that_is_held_throughout_keeps_its_second_key() {
        assert_eq!(sizes(&job(&[]), |_| true), [6, 1]);
    }

    #[test]
    fn corrections_begin_drawings_of_their_own() {
        assert_eq!(sizes(&job(&[(1, 5.0)]), |i| i % 2 == 0), [1, 1, 2, 2, 1]);
        // The same correction on both frames of a hold makes one drawing, different corrections make two.
        assert_eq!(sizes(&job(&[(2, 5.0), (3, 5.0)]), |i| i % 2 == 0), [2, 2, 2, 1]);
        assert_eq!(sizes(&job(&[(2, 5.0), (3, 6.0)]), |i| i % 2 == 0), [2, 1, 1, 2, 1]);
    }

    #[test]
    fn frames_on_which_the_part_is_absent_are_in_no_drawing() {
        let absent = |frames: &[usize]| Job { absent: frames.iter().copied().collect(), ..job(&[]) };
        let firsts = |job: &Job| group(job, |_| true).iter().map(|d| [d.first, d.last]).collect::<Vec<_>>();
        assert_eq!(firsts(&absent(&[2, 3])), [[0, 1], [4, 6]]);
        assert_eq!(firsts(&absent(&[1, 4])), [[0, 0], [2, 3], [5, 6]]);
        assert_eq!(firsts(&absent(&[1, 2, 3, 4, 5])), [[0, 0], [6, 6]]);
        let drawings = group(&absent(&[1, 4]), |_| false);
        assert_eq!(gaps(&drawings), [1, 3]);
        assert!(gaps(&group(&job(&[]), |_| false)).is_empty());
        assert_eq!(shown(&drawings, [3, 5]), Some(2..=3));
        assert_eq!(shown(&drawings, [4, 4]), None);
    }
}
