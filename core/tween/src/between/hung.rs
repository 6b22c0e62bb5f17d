//! Strokes on given pegs, as matching sees them.
//!
//! A peg says how its strokes move. So the strokes of the earlier drawing are compared where their pegs bring them on the later key: an
//! arm that turns by 140° lies on its counterpart then, and needs no guess. Strokes of different pegs are no pairs
//! ([`Stroke::peg`]). A stroke without a peg may be the counterpart of any.

use super::super::stroke::Stroke;
use super::{GivenPegs, Key};
use rototoon_base::geometry::similarity::Similarity;

impl GivenPegs {
    /// The strokes of key `k` and of the next one for [`match_strokes`](crate::matching::match_strokes): those of key `k` where their pegs
    /// bring them on the next one. Points are in pixels of the screen.
    pub fn compared(&self, k: usize, [from, to]: [&Key; 2]) -> [Vec<Stroke>; 2] {
        let maps = [from, to].map(|key| self.tree.at(f64::from(key.frame)));
        let peg = |key: usize, stroke: usize| {
            self.of.get(key)?.get(stroke).copied().flatten().filter(|&peg| peg < maps[0].len())
        };
        let hung = |stroke: &Stroke, peg: Option<usize>| Stroke {
            peg: peg.and_then(|peg| u32::try_from(peg).ok()),
            ..stroke.clone()
        };
        let moved = |(i, stroke): (usize, &Stroke)| {
            let mut own = hung(stroke, peg(k, i));
            if let Some(peg) = peg(k, i).filter(|&peg| maps[0][peg] != maps[1][peg]) {
                let map: Similarity = maps[1][peg].after(&maps[0][peg].inverse());
                own.points.iter_mut().for_each(|point| *point = map.apply(*point));
            }
            own
        };
        let first = from.strokes.iter().enumerate().map(moved).collect();
        let second = to.strokes.iter().enumerate().map(|(j, stroke)| hung(stroke, peg(k + 1, j))).collect();
        [first, second]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::{Options, match_strokes};
    use crate::peg::{Peg, PegKey, PegTree};
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Silent;

    /// An arm of two bars on two pegs, which turn on frame 8 by these angles.
    fn arm(turns: [f64; 2]) -> GivenPegs {
        let keys = |turn: f64| vec![PegKey::rest(0), PegKey { turn, ..PegKey::rest(8) }];
        let peg = |name: &str, parent, x: f64, turn| Peg {
            name: name.into(),
            parent,
            pivot: Point::new(x, 100.0),
            keys: keys(turn),
        };
        let pegs = vec![peg("upper", None, 100.0, turns[0]), peg("fore", Some(0), 160.0, turns[1])];
        GivenPegs { tree: PegTree::new(pegs).unwrap(), of: vec![vec![Some(0), Some(1)], vec![Some(1), Some(0)]] }
    }

    fn key(frame: i32, strokes: Vec<Stroke>) -> Key {
        Key { frame, strokes, ..Key::default() }
    }

    fn bar(from: f64, to: f64) -> Stroke {
        let at = |k: u32| Point::new(from + (to - from) * f64::from(k) / 12.0, 100.0);
        Stroke::new((0..=12).map(at).collect(), false)
    }

    #[test]
    fn pegs_say_which_stroke_is_which_at_any_turn() {
        for turn in [0.5, 1.7, 2.4, 3.1, 4.5] {
            let pegs = arm([turn, -0.4]);
            let bars = [bar(102.0, 158.0), bar(162.0, 218.0)];
            let maps = pegs.tree.at(8.0);
            let on = |peg: usize| {
                let points = bars[peg].points.iter().map(|p| maps[peg].apply(*p)).collect();
                Stroke::new(points, false)
            };
            let (from, to) = (key(0, bars.to_vec()), key(8, vec![on(1), on(0)]));
            let [first, second] = pegs.compared(0, [&from, &to]);
            assert!(first[0].points[3].distance(second[1].points[3]) < 1e-9, "it lies on its counterpart");
            let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
            let pairs: Vec<_> = found.pairs.iter().map(|p| (p.from, p.to, p.reversed)).collect();
            assert_eq!(pairs, [(0, 1, false), (1, 0, false)], "{turn}");
        }
    }

    #[test]
    fn strokes_of_different_pegs_are_no_pairs() {
        let mut pegs = arm([0.0, 0.0]);
        pegs.of[1] = vec![Some(0), None];
        let strokes = vec![bar(162.0, 218.0), bar(102.0, 158.0)];
        let (from, to) = (key(0, vec![bar(102.0, 158.0), bar(162.0, 218.0)]), key(8, strokes));
        let [first, second] = pegs.compared(0, [&from, &to]);
        let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
        assert!(found.pairs.iter().all(|p| (p.from, p.to) != (1, 0)), "{found:?}");
        let without = [&from, &to].map(|key| key.strokes.clone());
        assert_eq!(GivenPegs::default().compared(0, [&from, &to]), without);
    }
}
