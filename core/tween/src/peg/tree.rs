//! What hangs on what: a tree of groups that reaches out from the largest one.
//!
//! A hand hangs on its forearm, that on the upper arm, and that on the body, though the forearm with its hand may be drawn with more lines than the upper
//! arm. So the tree grows from its root: of all groups outside, the one that is nearest to the tree comes next, and hangs on the group to which it is
//! nearest (the minimum spanning tree, Prim 1957). A group carries only what is not much longer than itself: a single short line shows a turn badly.

use rototoon_base::geometry::Point;
use std::collections::BTreeMap;

/// Where a group meets another one: the largest distance on any key, and the place on the first one.
pub(super) type Meeting = (f64, Point);

/// A group, and the group on which it hangs with their meeting.
pub(super) type Hanging = (usize, Option<(usize, Meeting)>);

/// The tree of groups from 0 to `count`, in the order in which they join it. `near[g]` are groups near group `g`; `carries(parent, child)` says
/// whether one may hang on the other; `meeting` finds where two meet, if they do.
pub(super) fn grown(
    count: usize,
    near: &[Vec<usize>],
    carries: impl Fn(usize, usize) -> bool,
    meeting: impl Fn(usize, usize) -> Option<Meeting>,
) -> Vec<Hanging> {
    let mut known: BTreeMap<(usize, usize), Option<Meeting>> = BTreeMap::new();
    let mut met =
        |a: usize, b: usize| *known.entry((a.min(b), a.max(b))).or_insert_with(|| meeting(a.min(b), a.max(b)));
    let mut best: Vec<Option<(usize, Meeting)>> = vec![None; count];
    let mut found: Vec<Hanging> = Vec::with_capacity(count);
    let mut inside = vec![false; count];
    while found.len() < count {
        let outside = (0..count).filter(|&g| !inside[g]);
        let nearest = outside
            .filter(|&g| best[g].is_some())
            .min_by(|&a, &b| gap(&best[a]).total_cmp(&gap(&best[b])).then(a.cmp(&b)));
        // What is near no group of the tree hangs on the nearest of those that carry it.
        let Some(next) = nearest.or_else(|| (0..count).find(|&g| !inside[g])) else { break };
        if best[next].is_none() {
            let parents = found.iter().map(|hanging| hanging.0).filter(|&parent| carries(parent, next));
            let all = parents.filter_map(|parent| Some((parent, met(parent, next)?)));
            best[next] = all.min_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.0.cmp(&b.0)));
        }
        inside[next] = true;
        found.push((next, best[next]));
        let beside = (0..count).filter(|&g| !inside[g] && (near[next].contains(&g) || near[g].contains(&next)));
        for g in beside.filter(|&g| carries(next, g)).collect::<Vec<_>>() {
            let meets = met(next, g).map(|meeting| (next, meeting));
            if meets.is_some() && gap(&meets) < gap(&best[g]) {
                best[g] = meets;
            }
        }
    }
    found
}

fn gap(best: &Option<(usize, Meeting)>) -> f64 {
    best.map_or(f64::INFINITY, |(_, (gap, _))| gap)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tree of groups at places along a line.
    fn along(
        places: &[f64],
        near: &[Vec<usize>],
        carries: impl Fn(usize, usize) -> bool,
    ) -> Vec<(usize, Option<usize>)> {
        let meeting = |a: usize, b: usize| Some(((places[a] - places[b]).abs(), Point::ZERO));
        let found = grown(places.len(), near, carries, meeting);
        found.into_iter().map(|(g, on)| (g, on.map(|on| on.0))).collect()
    }

    #[test]
    fn a_forearm_hangs_on_a_shorter_upper_arm() {
        // Body, forearm, upper arm, hand.
        let all: Vec<Vec<usize>> = vec![(0..4).collect(); 4];
        let places = [0.0, 20.0, 10.0, 29.0];
        assert_eq!(along(&places, &all, |_, _| true), [(0, None), (2, Some(0)), (1, Some(2)), (3, Some(1))]);
        let short = |parent: usize, _: usize| parent != 2;
        assert_eq!(along(&places, &all, short), [(0, None), (2, Some(0)), (1, Some(0)), (3, Some(1))]);
    }

    #[test]
    fn what_is_near_nothing_hangs_on_the_nearest() {
        let none: Vec<Vec<usize>> = vec![Vec::new(); 3];
        assert_eq!(along(&[0.0, 5.0, 7.0], &none, |_, _| true), [(0, None), (1, Some(0)), (2, Some(1))]);
        assert!(along(&[], &[], |_, _| true).is_empty());
    }
}
