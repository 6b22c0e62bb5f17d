//! When a part is there, for formats whose shapes are there on all frames unless they are told otherwise.
//!
//! Before its first and after its last contour a part is not there. Between two contours it is not there where the artist
//! said that the picture does not show it, and, once the part is tracked, wherever it has no contour. Other programs move
//! shapes from key to key: a part that has nothing but keys is there between them.

use rototoon_base::scene::{Footage, FrameNumber, Part};

/// The frames on which a part comes or goes, each with whether it is there from then on. The first one is that of the
/// footage. `keys` are its contours on frames of the footage. Only one frame if the part is always there; none without contours.
pub fn presence<T>(part: &Part, keys: &[(FrameNumber, T)], footage: &Footage) -> Vec<(FrameNumber, bool)> {
    let (Some((begin, _)), Some((end, _))) = (keys.first(), keys.last()) else { return Vec::new() };
    let mut changes = Vec::new();
    if footage.first < *begin {
        put(&mut changes, footage.first, false);
    }
    put(&mut changes, *begin, true);
    for pair in keys.windows(2) {
        let (from, to) = (pair[0].0 + 1, pair[1].0);
        for [first, after] in away(part, from, to) {
            put(&mut changes, first, false);
            put(&mut changes, after, true);
        }
    }
    if *end < footage.last {
        put(&mut changes, end + 1, false);
    }
    changes
}

/// The stretches of a gap between two contours on which the part is not there. Each has its first frame and the one after it.
fn away(part: &Part, from: FrameNumber, to: FrameNumber) -> Vec<[FrameNumber; 2]> {
    if from >= to {
        return Vec::new();
    }
    if !part.tracks.is_empty() {
        return vec![[from, to]];
    }
    let within = |&[first, last]: &[FrameNumber; 2]| [first.max(from), last.saturating_add(1).min(to)];
    let mut found: Vec<_> = part.absent.iter().map(within).filter(|[first, after]| first < after).collect();
    found.sort_unstable();
    let mut joined: Vec<[FrameNumber; 2]> = Vec::new();
    for [first, after] in found {
        match joined.last_mut() {
            Some([_, end]) if first <= *end => *end = after.max(*end),
            _ => joined.push([first, after]),
        }
    }
    joined
}

/// Adds a change. Of two on one frame the later one counts, and what stays as it was is no change.
fn put(changes: &mut Vec<(FrameNumber, bool)>, frame: FrameNumber, there: bool) {
    while changes.last().is_some_and(|(earlier, _)| *earlier >= frame) {
        changes.pop();
    }
    if changes.last().is_none_or(|(_, before)| *before != there) {
        changes.push((frame, there));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;
    use std::collections::BTreeMap;

    fn changes(tracked: bool, frames: &[FrameNumber], absent: &[[FrameNumber; 2]]) -> Vec<(FrameNumber, bool)> {
        let keys: Vec<_> = frames.iter().map(|&frame| (frame, vec![Point::ONE])).collect();
        let tracks = if tracked { keys.iter().cloned().collect() } else { BTreeMap::new() };
        let part = Part { tracks, absent: absent.to_vec(), ..Part::default() };
        let footage = Footage { pattern: "%d".into(), first: 1, last: 9, fps: 12.0, width: 4, height: 4, held: false };
        presence(&part, &keys, &footage)
    }

    #[test]
    fn a_part_is_there_from_its_first_contour_to_its_last() {
        assert_eq!(changes(true, &[], &[]), []);
        for tracked in [false, true] {
            assert_eq!(changes(tracked, &[1, 2, 3, 4, 5, 6, 7, 8, 9], &[]), [(1, true)]);
            assert_eq!(changes(tracked, &[3, 4], &[]), [(1, false), (3, true), (5, false)]);
            assert_eq!(changes(tracked, &[1, 2], &[]), [(1, true), (3, false)]);
            assert_eq!(changes(tracked, &[9], &[]), [(1, false), (9, true)]);
        }
    }

    #[test]
    fn a_tracked_part_is_not_there_where_it_has_no_contour() {
        assert_eq!(
            changes(true, &[1, 2, 5, 6, 9], &[[3, 4]]),
            [(1, true), (3, false), (5, true), (7, false), (9, true)]
        );
    }

    #[test]
    fn a_part_of_keys_alone_is_there_between_them_but_where_it_is_hidden() {
        assert_eq!(changes(false, &[1, 9], &[]), [(1, true)]);
        assert_eq!(changes(false, &[1, 9], &[[4, 5]]), [(1, true), (4, false), (6, true)]);
        // Ranges that touch, overlap, or reach over the keys.
        assert_eq!(
            changes(false, &[1, 7, 9], &[[6, 8], [2, 3], [4, 4], [3, 4]]),
            [(1, true), (2, false), (5, true), (6, false), (7, true), (8, false), (9, true)]
        );
    }

    #[test]
    fn times_within_each_other_are_one() {
        let keys: Vec<(FrameNumber, ())> = vec![(1, ()), (10, ())];
        let part = Part { absent: vec![[3, 8], [5, 6], [8, 8]], ..Part::default() };
        assert_eq!(away(&part, 2, 10), [[3, 9]]);
        let footage = Footage { pattern: "%d".into(), first: 1, last: 10, fps: 1.0, width: 9, height: 9, held: false };
        assert_eq!(presence(&part, &keys, &footage), [(1, true), (3, false), (9, true)]);
    }
}
