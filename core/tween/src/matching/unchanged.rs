//! Strokes that are on both drawings, point by point.
//!
//! An artist copies a drawing and moves some of its strokes. The others stand where they stood, to the last digit. No stroke
//! that is drawn anew does that, so these are pairs beyond doubt. They are fixed before anything is compared: an arm that is most of
//! the drawing would otherwise take a head for the body where its own turn would bring it.
//!
//! A pair made by hand may send such a stroke elsewhere: two dots have changed places. Then standing still proves nothing, and no
//! stroke is fixed.

use super::super::stroke::Stroke;
use super::{Fixed, Matching};
use std::collections::BTreeMap;

/// Fixes free strokes to the strokes of the other drawing that have the same points and look. Of several the first one is taken.
/// Returns which strokes of the first drawing were fixed, rising.
pub(super) fn fix(first: &[Stroke], second: &[Stroke], fixed: &mut [Fixed]) -> Vec<usize> {
    let mut there: BTreeMap<(usize, [u64; 4]), Vec<usize>> = BTreeMap::new();
    for (j, stroke) in second.iter().enumerate().filter(|(_, stroke)| !stroke.points.is_empty()) {
        there.entry(mark(stroke)).or_default().push(j);
    }
    let same = |i: usize| {
        let alike = there.get(&mark(&first[i])).map_or(&[][..], Vec::as_slice);
        alike.iter().copied().filter(move |&j| is_same(&first[i], &second[j]))
    };
    let mut free = vec![true; second.len()];
    for (i, fixed) in fixed.iter().enumerate() {
        if let Fixed::To(to) = fixed {
            if same(i).next().is_some() && !same(i).any(|j| j == *to) {
                return Vec::new();
            }
            free[*to] = false;
        }
    }
    let mut found = Vec::new();
    for i in (0..first.len()).filter(|&i| fixed[i] == Fixed::Free).collect::<Vec<_>>() {
        if let Some(j) = same(i).find(|&j| free[j]) {
            (fixed[i], free[j]) = (Fixed::To(j), false);
            found.push(i);
        }
    }
    found
}

/// What strokes with the same points have in common, and few others.
fn mark(stroke: &Stroke) -> (usize, [u64; 4]) {
    let ends = [stroke.points.first(), stroke.points.last()];
    let [a, b] = ends.map(|p| p.map_or([0; 2], |p| [p.x.to_bits(), p.y.to_bits()]));
    (stroke.points.len(), [a[0], a[1], b[0], b[1]])
}

fn is_same(a: &Stroke, b: &Stroke) -> bool {
    let look = |s: &Stroke| (s.closed, s.colour, s.material, s.layer);
    look(a) == look(b) && a.points == b.points && a.may_be(b)
}

/// Says of the pairs of these strokes that they were found, not made by hand.
pub(super) fn found(matching: &mut Matching, fixed: &[usize]) {
    for pair in matching.pairs.iter_mut().filter(|pair| fixed.binary_search(&pair.from).is_ok()) {
        (pair.by_hand, pair.confidence) = (false, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{HandPair, Options, match_strokes};
    use super::*;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Silent;

    fn ring(x: f64, y: f64, radius: f64) -> Stroke {
        let at = |k: i32| Point::new(x, y) + Point::from_angle(f64::from(k) * 0.2) * radius;
        Stroke::new((0..31).map(at).collect(), true)
    }

    fn bar(from: Point, way: f64, length: f64) -> Stroke {
        Stroke::new((0..20).map(|k| from + Point::from_angle(way) * (length * f64::from(k) / 19.0)).collect(), false)
    }

    /// A head, a body like it, and an arm of many strokes about a shoulder between the two.
    fn figure(way: f64) -> Vec<Stroke> {
        let shoulder = Point::new(100.0, 100.0);
        let side = Point::from_angle(way + 1.5) * 4.0;
        let arm = (0..9).map(|k| bar(shoulder + side * f64::from(k), way, 60.0 + 4.0 * f64::from(k)));
        [ring(100.0, 60.0, 22.0), ring(100.0, 140.0, 24.0)].into_iter().chain(arm).collect()
    }

    fn pairs(matching: &Matching) -> Vec<(usize, usize)> {
        matching.pairs.iter().map(|pair| (pair.from, pair.to)).collect()
    }

    #[test]
    fn what_stands_still_is_itself_beside_an_arm_that_swings() {
        let (first, mut second) = (figure(0.2), figure(2.8));
        second.rotate_left(1);
        let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
        assert_eq!(pairs(&found)[..2], [(0, 10), (1, 0)]);
        assert!(found.pairs[..2].iter().all(|pair| pair.confidence == 1.0 && !pair.by_hand && !pair.reversed));
    }

    #[test]
    fn decisions_by_hand_come_first() {
        let (first, second) = (figure(0.2), figure(0.2));
        let matched = |hand| match_strokes(&first, &second, &[hand], &Options::default(), &Silent).unwrap();
        let crossed = matched(HandPair { from: 0, to: Some(1) });
        assert_eq!((pairs(&crossed)[0], crossed.pairs[0].by_hand), ((0, 1), true));
        let alone = matched(HandPair { from: 2, to: None });
        assert!(alone.vanished.contains(&2) && alone.appeared.contains(&2), "{alone:?}");
        assert_eq!(pairs(&alone)[0], (0, 0));
    }

    #[test]
    fn of_strokes_with_the_same_points_the_one_with_the_same_colour_is_taken() {
        let painted = |colour: f32| Stroke { colour: Some([colour; 3]), ..ring(50.0, 50.0, 20.0) };
        let (first, second) = ([painted(0.1), painted(0.9)], [painted(0.9), painted(0.1)]);
        let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
        assert_eq!(pairs(&found), [(0, 1), (1, 0)]);
    }
}
