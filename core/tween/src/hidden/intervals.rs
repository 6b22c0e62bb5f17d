//! Sets of parameters as rising, separate intervals.

use super::path::Path;

/// From a parameter to a larger one.
pub type Interval = (f64, f64);

/// Unrolling an interval rounds. Ends closer than this are equal.
const SAME: f64 = 1e-9;

/// The union of intervals in any order. Intervals closer than `gap` in the parameter are joined.
pub(super) fn union(mut intervals: Vec<Interval>, gap: f64) -> Vec<Interval> {
    intervals.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut joined: Vec<Interval> = Vec::with_capacity(intervals.len());
    for (from, to) in intervals {
        match joined.last_mut() {
            Some(last) if from <= last.1 + gap => last.1 = last.1.max(to),
            _ => joined.push((from, to)),
        }
    }
    joined
}

/// The part of `0..end` outside the intervals.
pub(super) fn complement(intervals: &[Interval], end: f64) -> Vec<Interval> {
    let starts = std::iter::once(0.0).chain(intervals.iter().map(|i| i.1));
    let ends = intervals.iter().map(|i| i.0).chain([end]);
    starts.zip(ends).filter(|(from, to)| to > from).collect()
}

/// Joins the last interval of a closed path with the first where they meet at the seam. The result may reach beyond
/// `end`.
pub(super) fn over_seam(mut intervals: Vec<Interval>, end: f64) -> Vec<Interval> {
    let (Some(first), Some(last)) = (intervals.first().copied(), intervals.last().copied()) else { return intervals };
    if intervals.len() > 1 && first.0 == 0.0 && last.1 == end {
        intervals.remove(0);
        if let Some(last) = intervals.last_mut() {
            last.1 = end + first.1;
        }
    }
    intervals
}

/// Removes slivers from hidden intervals. First, visible stretches shorter than `sliver` pixels become hidden. Then
/// hidden stretches shorter than that become visible. A path that is entirely hidden or visible stays so.
pub(super) fn without_slivers(path: &Path, hidden: Vec<Interval>, sliver: f64) -> Vec<Interval> {
    let end = path.end();
    let short = |path: &Path, (from, to): Interval| path.length_between(from, to) < sliver;
    if hidden.is_empty() || hidden == [(0.0, end)] {
        return hidden;
    }
    let rounds = |intervals: Vec<Interval>| if path.is_closed() { over_seam(intervals, end) } else { intervals };
    let gaps = rounds(complement(&hidden, end)).into_iter().filter(|&gap| short(path, gap));
    let filled = union(hidden.iter().copied().chain(gaps.flat_map(|gap| unrolled(gap, end))).collect(), SAME);
    if filled == [(0.0, end)] {
        return filled;
    }
    let kept = rounds(filled).into_iter().filter(|&interval| !short(path, interval));
    union(kept.flat_map(|interval| unrolled(interval, end)).collect(), SAME)
}

/// Splits an interval that may run over the seam into one or two that do not.
fn unrolled((from, to): Interval, end: f64) -> impl Iterator<Item = Interval> {
    let over = to > end;
    [Some((from, to.min(end))), over.then_some((0.0, to - end))].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::geometry::Point;

    #[test]
    fn unions_and_complements() {
        assert_eq!(union(vec![(3.0, 4.0), (0.0, 1.0), (0.5, 2.0)], 0.0), [(0.0, 2.0), (3.0, 4.0)]);
        assert_eq!(complement(&[(0.0, 2.0), (3.0, 4.0)], 5.0), [(2.0, 3.0), (4.0, 5.0)]);
        assert_eq!(complement(&[], 5.0), [(0.0, 5.0)]);
        assert_eq!(complement(&[(0.0, 5.0)], 5.0), []);
        assert_eq!(over_seam(vec![(0.0, 1.0), (2.0, 3.0), (4.0, 5.0)], 5.0), [(2.0, 3.0), (4.0, 6.0)]);
        assert_eq!(over_seam(vec![(0.0, 5.0)], 5.0), [(0.0, 5.0)]);
    }

    #[test]
    fn slivers_follow_their_neighbours() {
        let line = Path::of_polyline(&[Point::ZERO, Point::X * 10.0], false).unwrap();
        let clean = |hidden: &[Interval]| without_slivers(&line, hidden.to_vec(), 0.1);
        assert_eq!(clean(&[(0.2, 0.4), (0.405, 0.6)]), [(0.2, 0.6)]);
        assert_eq!(clean(&[(0.2, 0.205)]), []);
        assert_eq!(clean(&[(0.005, 0.5)]), [(0.0, 0.5)]);
        // Many slivers next to each other make one line.
        assert_eq!(clean(&[(0.2, 0.205), (0.206, 0.21), (0.211, 0.216)]), [(0.2, 0.216)]);
    }

    #[test]
    fn a_sliver_over_the_seam_is_one() {
        let square: Vec<_> = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)].map(Point::from).into();
        let square = Path::of_polyline(&square, true).unwrap();
        assert_eq!(without_slivers(&square, vec![(0.0, 0.25), (3.75, 4.0)], 0.1), [(0.0, 0.25), (3.75, 4.0)]);
        assert_eq!(without_slivers(&square, vec![(0.0, 0.005), (3.995, 4.0)], 0.1), []);
        assert_eq!(without_slivers(&square, vec![(0.004, 3.996)], 0.1), [(0.0, 4.0)]);
    }

    proptest! {
        #[test]
        fn a_set_and_its_complement_are_everything(ends in prop::collection::vec(0.0f64..9.0, 0..20)) {
            let set = union(ends.chunks_exact(2).map(|p| (p[0].min(p[1]), p[0].max(p[1]))).collect(), 0.0);
            let rest = complement(&set, 9.0);
            let sum: f64 = set.iter().chain(&rest).map(|(a, b)| b - a).sum();
            prop_assert!((sum - 9.0).abs() < 1e-9);
        }
    }
}
