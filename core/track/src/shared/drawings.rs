//! The distinct drawings of a span. Animation often holds a drawing for two or three frames; the tracker solves it
//! once. Which frames show the same drawing is the question of [`held`](super::held).

use crate::contract::job::Job;

/// Neighbouring frames of a span that show one drawing, as frame indices in the span. A drawing has at least one frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    /// Index of the first frame.
    pub first: usize,
    /// Index of the last frame.
    pub last: usize,
}

/// Groups the frames of a job into drawings. `same(i)` says whether frame i + 1 shows the same drawing as frame i.
///
/// The first key is in the first group and the second key in the last, each with the frames held from it. A corrected
/// frame begins a group of its own if the group before has a different correction or contains the first key. The second
/// key begins a group of its own if the group before is corrected or contains the first key.
pub fn group(job: &Job, same: impl Fn(usize) -> bool) -> Vec<Drawing> {
    let last = job.span.len() - 1;
    let mut drawings = vec![Drawing { first: 0, last: 0 }];
    for index in 1..=last {
        let current = drawings.len() - 1;
        let begins = &drawings[current];
        let corrected = (begins.first..index).rev().find_map(|i| job.corrections.get(&i));
        let contradicts = job
            .corrections
            .get(&index)
            .is_some_and(|own| begins.first == 0 || corrected.is_some_and(|before| before != own));
        let released = index == last && (begins.first == 0 || corrected.is_some());
        if same(index - 1) && !contradicts && !released {
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
    use std::collections::BTreeMap;

    fn job(corrected: &[(usize, f64)]) -> Job {
        let correction = |x: f64| Correction { pins: BTreeMap::from([(0, Point::new(x, 0.0))]), center: None };
        Job {
            name: "part".into(),
            closed: true,
            span: Span { first: 10, last: 16 },
            keys: [vec![Point::ZERO], vec![Point::ONE]],
            corrections: corrected.iter().map(|&(i, x)| (i, correction(x))).collect(),
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
}
