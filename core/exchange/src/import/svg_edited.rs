//! What a drawing program has changed in an animated path that Rototoon has written.
//!
//! Such a program shows the path of the attribute `d`, and keeps the animation in it without a look at it. An export writes into `d` the form of
//! the first frame on which the part is there. If they differ, the path was edited, and the edit is of that frame.
//!
//! This is asked of Rototoon's own films alone. In other files the two may differ on purpose: by the rules of SMIL the animation is what
//! counts while it runs, and `d` is for readers without animation.
//!
//! An edit with other points cannot be a key beside the other frames, which have the old ones. To take it would replace the part on all frames.

use super::path::{NoContours, Path, contours};

/// Distance within which points are the same, in pixels of the footage: programs round numbers.
const SAME: f64 = 0.01;

/// What became of the first form of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edit {
    /// Nothing.
    None,
    /// Its points have moved.
    Moved,
    /// It has other points.
    Other,
}

/// Compares the sub-paths on all keys with those that a program shows in place of the first ones.
pub(super) fn edit(keys: &[&[Path]], shown: &[Path]) -> Edit {
    let Some(first) = keys.first() else { return Edit::None };
    let kind = |paths: &[Path]| paths.iter().map(|path| (path.segments.len(), path.closed)).collect::<Vec<_>>();
    if kind(first) != kind(shown) {
        return Edit::Other;
    }
    let ends = |path: &Path| path.points().collect::<Vec<_>>();
    let same = |(own, shown): (&Path, &Path)| ends(own).iter().zip(ends(shown)).all(|(a, b)| a.distance(b) <= SAME);
    if first.iter().zip(shown).all(same) {
        return Edit::None;
    }
    let as_many = (0..shown.len()).all(|number| {
        let with = |first: &Path| {
            let others = keys.iter().skip(1).filter_map(|paths| paths.get(number).cloned());
            count(&std::iter::once(first.clone()).chain(others).collect::<Vec<_>>())
        };
        with(&first[number]) == with(&shown[number])
    });
    if as_many { Edit::Moved } else { Edit::Other }
}

/// The number of points of the contours of a sub-path; `None` if its keys are of several kinds.
fn count(keys: &[Path]) -> Option<usize> {
    match contours(keys, Err::<(), usize>) {
        Err(NoContours::Refused(count)) => Some(count),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    fn path(corners: &[(f64, f64)]) -> Path {
        let mut path = Path::new(corners[0].into());
        corners[1..].iter().for_each(|&corner| path.line(corner.into()));
        path.close();
        path
    }

    #[test]
    fn an_edit_is_told_from_rounding_and_from_other_points() {
        let one = [path(&[(0.0, 0.0), (9.0, 0.0), (0.0, 9.0)])];
        let two = [path(&[(1.0, 0.0), (9.0, 0.0), (0.0, 9.0)])];
        let found = |shown: &[Path]| edit(&[&one, &two], shown);
        assert_eq!(found(&one), Edit::None);
        assert_eq!(found(&[path(&[(0.004, 0.0), (9.0, 0.004), (0.0, 9.0)])]), Edit::None);
        assert_eq!(found(&two), Edit::Moved);
        assert_eq!(found(&[path(&[(0.0, 0.0), (9.0, 0.0)])]), Edit::Other);
        assert_eq!(found(&[]), Edit::Other);
        // A side that is bent needs more points than the straight ones of the other frames.
        let mut bent = one.clone();
        bent[0].segments[1][0] += Point::new(8.0, 8.0);
        assert_eq!(found(&bent), Edit::Other);
        assert_eq!(edit(&[], &one), Edit::None);
    }
}
