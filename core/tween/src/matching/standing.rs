//! Strokes that stand together where they stood, drawn again by hand.
//!
//! An artist who draws a figure again whose arm swings draws the rest of it nearly where it was, but no line lies on its counterpart to the last
//! digit. Such lines must be known before anything else is compared: an arm of many lines that swings by 150° is most of what moves, and
//! where its turn would bring the body, a wrong line may lie.
//!
//! A stroke stands if its places lie within 0.006 of the drawing's size, and 0.15 of its own, of those of one stroke of the other drawing that looks the same,
//! and both ways no other stroke lies nearly as near. One such stroke may stand by chance, where a leg comes to lie where the other one was. So two of the six
//! strokes nearest to it must stand as well, or a quarter of the drawing, three strokes at least.
//!
//! Limit: as in [`unchanged`](super::unchanged), legs that have changed places stand.

use super::super::grid::Grid;
use super::super::ink;
use super::super::stroke::Stroke;
use super::Fixed;
use super::unchanged::{Unchanged, bounds, farthest, laid, looks_alike};
use rototoon_base::geometry::{Point, polygon};
use std::collections::BTreeMap;

/// Largest distance of a place from the counterpart, as a share of the drawings' size.
const NEAR: f64 = 0.006;
/// The same as a share of the stroke's own size.
const OWN: f64 = 0.15;
/// Every other stroke is farther by this factor.
const CLEARLY: f64 = 2.5;
/// Largest difference of lengths, as a share of the longer one.
const LONGER: f64 = 0.15;
/// Number of nearest strokes, and how many of them must stand too. They are few: strokes of an arm that swings lie among those of a body.
const NEIGHBOURS: usize = 6;
const LEAST: usize = 2;
/// Where this share of the drawing stands, that is no chance, and neighbours are not asked: an arm may lie across all of it.
const MANY: f64 = 0.25;
/// Confidence in such a pair.
const CONFIDENCE: f64 = 0.99;

/// Fixes free strokes to those on which they stand. `stand` are those that are fixed so already.
pub(super) fn fix(first: &[Stroke], second: &[Stroke], fixed: &mut [Fixed], stand: &[Unchanged]) -> Vec<Unchanged> {
    let near = NEAR * ink::size(first.iter().chain(second).flat_map(|s| &s.points));
    let taken: Vec<usize> = fixed.iter().filter_map(|f| if let Fixed::To(j) = f { Some(*j) } else { None }).collect();
    let free: Vec<usize> = (0..second.len()).filter(|j| !taken.contains(j)).collect();
    let own: Vec<usize> = (0..first.len()).filter(|&i| fixed[i] == Fixed::Free).collect();
    let mut pairs = mutual(first, second, (&own, &free), near);
    keep_together(first, &mut pairs, stand);
    let found = pairs.into_iter().map(|(i, j)| laid(i, j, &first[i], &second[j], CONFIDENCE)).collect::<Vec<_>>();
    found.iter().for_each(|found| fixed[found.from] = Fixed::To(found.to));
    found
}

/// The pairs of strokes that lie on each other, and on no other stroke.
fn mutual(first: &[Stroke], second: &[Stroke], (own, free): (&[usize], &[usize]), near: f64) -> BTreeMap<usize, usize> {
    let limit = |own: &[Point; 2]| near.min(OWN * own[0].distance(own[1]));
    let boxes: Vec<[Point; 2]> = free.iter().map(|&j| bounds(&second[j])).collect();
    let mut all: Vec<(f64, usize, usize)> = Vec::new();
    for &i in own.iter().filter(|&&i| !first[i].points.is_empty()) {
        let mine = bounds(&first[i]);
        let reach = CLEARLY * limit(&mine);
        for (&j, other) in free.iter().zip(&boxes) {
            if (0..2).all(|k| mine[k].distance(other[k]) <= 2.0 * reach) && looks_alike(&first[i], &second[j]) {
                all.push((farthest(&first[i], &second[j]), i, j));
            }
        }
    }
    let stands = |&&(apart, i, j): &&(f64, usize, usize)| {
        let other = |&(d, a, b): &(f64, usize, usize)| (a == i) != (b == j) && d < CLEARLY * apart;
        let lengths = [first[i].length(), second[j].length()];
        let alike = (lengths[0] - lengths[1]).abs() <= LONGER * lengths[0].max(lengths[1]);
        apart <= limit(&bounds(&first[i])) && alike && !all.iter().any(other)
    };
    all.iter().filter(stands).map(|&(_, i, j)| (i, j)).collect()
}

/// Leaves out strokes beside which too few stand.
fn keep_together(first: &[Stroke], pairs: &mut BTreeMap<usize, usize>, stand: &[Unchanged]) {
    let there: Vec<usize> = (0..first.len()).filter(|&i| !first[i].points.is_empty()).collect();
    let middles: Vec<Point> = there.iter().map(|&i| polygon::center(&first[i].points)).collect();
    let grid = Grid::new(&middles);
    let all = pairs.len() + stand.len();
    if all > LEAST && all as f64 >= MANY * there.len() as f64 {
        return;
    }
    loop {
        let stands = |i: usize| pairs.contains_key(&i) || stand.iter().any(|unchanged| unchanged.from == i);
        let alone = |i: &usize| {
            let near = grid.nearest(polygon::center(&first[*i].points), NEIGHBOURS + 1);
            near.into_iter().map(|k| there[k]).filter(|k| k != i && stands(*k)).count() < LEAST
        };
        let gone: Vec<usize> = pairs.keys().copied().filter(alone).collect();
        if gone.is_empty() {
            return;
        }
        gone.iter().for_each(|i| _ = pairs.remove(i));
    }
}

#[cfg(test)]
mod tests {
    use super::super::{HandPair, Options, match_strokes};
    use super::*;
    use rototoon_base::scene::Silent;

    /// A number from -1 to 1 that looks like chance.
    fn chance(k: usize) -> f64 {
        f64::from(((k as u32).wrapping_mul(2_654_435_761) >> 8) % 2001) / 1000.0 - 1.0
    }

    fn line(from: (f64, f64), to: (f64, f64)) -> Vec<Point> {
        (0..=8).map(|k| Point::from(from).lerp(Point::from(to), f64::from(k) / 8.0)).collect()
    }

    fn ring(x: f64, y: f64, radius: f64) -> Vec<Point> {
        (0..16)
            .map(|k| Point::new(x, y) + Point::from_angle(f64::from(k) * std::f64::consts::TAU / 16.0) * radius)
            .collect()
    }

    /// A torso with a face, and an arm of eight lines at an angle, drawn by a hand that is off by up to `off`.
    fn figure(arm: f64, off: f64, seed: usize) -> Vec<Stroke> {
        let torso = [
            (line((-90.0, 20.0), (-80.0, -400.0)), false),
            (line((90.0, 20.0), (80.0, -400.0)), false),
            (line((-90.0, 20.0), (90.0, 20.0)), false),
            (line((-80.0, -400.0), (80.0, -400.0)), false),
            (line((0.0, 40.0), (0.0, -240.0)), false),
            (line((-100.0, -250.0), (100.0, -250.0)), false),
            (ring(0.0, 140.0, 85.0), true),
            (ring(30.0, 150.0, 10.0), true),
            (ring(-20.0, 150.0, 10.0), true),
        ];
        let way = Point::from_angle(arm);
        let bar = |k: i32| {
            let beside = way.perp() * (8.0 * f64::from(k) - 28.0);
            let (from, to) = (way * (20.0 * f64::from(k % 3)) + beside, way * (200.0 + 25.0 * f64::from(k)) + beside);
            (line(from.into(), to.into()), false)
        };
        let drawn = torso.into_iter().chain((0..8).map(bar)).enumerate();
        let shaken = |(n, (points, closed)): (usize, (Vec<Point>, bool))| {
            let by = |k: usize| Point::new(chance(seed + 97 * n + 2 * k), chance(seed + 97 * n + 2 * k + 1)) * off;
            Stroke::new(points.into_iter().enumerate().map(|(k, p)| p + by(k)).collect(), closed)
        };
        drawn.map(shaken).collect()
    }

    #[test]
    fn a_torso_that_was_drawn_again_stands_while_an_arm_swings() {
        for (seed, swing) in [(1, 1.7), (500, 2.1), (900, 2.6), (7000, 2.6)] {
            let (first, mut second) = (figure(-2.2, 1.0, seed), figure(-2.2 + swing, 1.0, seed + 31));
            second.rotate_left(4);
            second.iter_mut().step_by(2).for_each(|stroke| stroke.points.reverse());
            let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
            for (i, stroke) in first.iter().enumerate().take(9) {
                let pair = found.pairs.iter().find(|pair| pair.from == i).unwrap();
                assert_eq!((pair.to, pair.confidence), ((i + 17 - 4) % 17, 0.99), "swing {swing}");
                assert_eq!(pair.reversed, pair.to % 2 == 0);
                let start = super::super::super::line::Line::new(&second[pair.to]).at(pair.start);
                assert!(!stroke.closed || start.distance(stroke.points[0]) < 6.0, "a ring does not turn");
            }
        }
    }

    #[test]
    fn what_stands_alone_or_beside_another_one_is_not_fixed() {
        let fixed =
            |first: &[Stroke], second: &[Stroke]| fix(first, second, &mut vec![Fixed::Free; first.len()], &[]).len();
        let (first, second) = (figure(-2.2, 1.0, 1), figure(0.0, 1.0, 40));
        assert_eq!(fixed(&first, &second), 9);
        assert_eq!(fixed(&first[..2], &second[..2]), 0, "two strokes alone");
        let hatched = |off: f64| {
            (0..9)
                .map(|k| Stroke::new(line((4.0 * f64::from(k) + off, 0.0), (4.0 * f64::from(k) + off, 900.0)), false))
                .collect::<Vec<_>>()
        };
        assert_eq!(fixed(&hatched(0.0), &hatched(1.9)), 0, "each hatch lies between two others");
    }

    #[test]
    fn decisions_by_hand_come_first() {
        let (first, second) = (figure(-2.2, 1.0, 1), figure(0.0, 1.0, 40));
        let alone = HandPair { from: 3, to: None };
        let found = match_strokes(&first, &second, &[alone], &Options::default(), &Silent).unwrap();
        assert!(found.vanished.contains(&3) && found.pairs.iter().any(|pair| (pair.from, pair.to) == (4, 4)));
    }
}
