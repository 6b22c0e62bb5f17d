//! Strokes that are drawn twice, point by point.
//!
//! A stroke that was duplicated by mistake, or inked twice, lies on itself. Which of the two is the counterpart makes no difference, so it is no
//! reason for doubt either: each is as sure as if it were alone.

use super::super::stroke::Stroke;
use super::unchanged::looks_alike;

/// For each stroke the index of the first one that is the same: its own, where it is drawn once.
pub(super) fn firsts(strokes: &[Stroke]) -> Vec<usize> {
    let key = |i: usize| -> (usize, Option<[u64; 2]>) {
        let points = &strokes[i].points;
        (points.len(), points.first().map(|p| [p.x.to_bits(), p.y.to_bits()]))
    };
    let same = |i: usize, j: usize| strokes[i].points == strokes[j].points && looks_alike(&strokes[i], &strokes[j]);
    let mut order: Vec<usize> = (0..strokes.len()).collect();
    order.sort_by_key(|&i| (key(i), i));
    let mut firsts: Vec<usize> = (0..strokes.len()).collect();
    // Those that begin at one place, with as many points.
    for run in order.chunk_by(|&i, &j| key(i) == key(j)) {
        for (n, &i) in run.iter().enumerate() {
            firsts[i] = run[..n].iter().copied().find(|&j| firsts[j] == j && same(i, j)).unwrap_or(i);
        }
    }
    firsts
}

#[cfg(test)]
mod tests {
    use super::super::{Matching, Options, match_strokes};
    use super::*;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Silent;

    fn bar(from: (f64, f64), way: f64, length: f64) -> Stroke {
        let at = |k: i32| Point::from(from) + Point::from_angle(way) * (length * f64::from(k) / 8.0);
        Stroke::new((0..=8).map(at).collect(), false)
    }

    #[test]
    fn the_first_of_equal_strokes_stands_for_them() {
        let (a, b) = (bar((0.0, 0.0), 0.0, 10.0), bar((0.0, 0.0), 1.0, 10.0));
        let painted = Stroke { colour: Some([0.5; 3]), ..a.clone() };
        let nothing = Stroke::new(Vec::new(), false);
        let strokes = [a.clone(), b.clone(), painted, a, nothing.clone(), b, nothing];
        assert_eq!(firsts(&strokes), [0, 1, 2, 0, 4, 1, 4]);
    }

    #[test]
    fn strokes_that_are_drawn_twice_are_as_sure_as_others() {
        let drawing = |turn: f64| -> Vec<Stroke> {
            let arm = bar((0.0, 0.0), turn, 90.0);
            let hand = bar((arm.points[8].x, arm.points[8].y), 2.0 * turn, 25.0);
            vec![bar((0.0, -60.0), 1.5, 200.0), arm, hand, bar((-30.0, 140.0), 0.0, 60.0)]
        };
        let (first, second) = (drawing(0.3), drawing(-0.4));
        let matched = |a: &[Stroke], b: &[Stroke]| -> Matching {
            match_strokes(a, b, &[], &Options::default(), &Silent).unwrap()
        };
        let once = matched(&first, &second);
        let twice = |strokes: &[Stroke]| [strokes, strokes].concat();
        let found = matched(&twice(&first), &twice(&second));
        assert_eq!(found.pairs.len(), 8);
        for pair in &found.pairs {
            let alone = once.pairs[pair.from % 4];
            assert_eq!((alone.from, alone.to), (pair.from % 4, pair.to % 4));
            assert!(pair.confidence > alone.confidence - 0.1, "{pair:?} is less sure than {alone:?}");
        }
    }
}
