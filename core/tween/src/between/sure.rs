//! Pairs that are carried out: those that are sure, and those that agree with the sure pairs around them.
//!
//! A wrong pair lets a stroke fly across the drawing. Its counterpart lies where nothing around it went. So each pair is
//! compared with its neighbourhood: the similarity that fits the nearest evident pairs best (those by hand, and those with a
//! high confidence) says where the stroke should have gone. A pair that is not sure and goes elsewhere is not carried
//! out. Its two strokes vanish and appear instead, each with the rigid group around it. Strokes of a matching in pieces
//! are not touched, and neither are pairs made by hand.
//!
//! A pair far below certainty is judged by its place alone; the surer a pair is, the farther it may go its own way: an arm
//! that swings is sure, because it looks like itself.

use super::super::line::Line;
use super::super::matching::{Matching, Pair};
use super::super::stroke::Stroke;
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polygon;
use rototoon_base::geometry::similarity::Similarity;

/// A pair is carried out wherever it goes from this confidence on.
const SURE: f64 = 0.95;
/// A pair shows where its neighbours go from this confidence on.
const EVIDENT: f64 = 0.6;
/// Number of nearest evident pairs that show where a stroke should have gone.
const NEIGHBOURS: usize = 5;
/// A pair without any confidence may end its own size, and this share of its way, away from where it should have gone.
const OWN: f64 = 1.0;
const WAY: f64 = 0.25;
/// Least distance that is allowed, in pixels.
const LEAST: f64 = 3.0;
/// Number of samples of a stroke.
const SAMPLES: usize = 8;

/// A pair with samples of both strokes.
struct Known {
    from: Vec<Point>,
    to: Vec<Point>,
    middle: Point,
    evident: bool,
}

/// The matching without the pairs that should not be carried out.
pub(super) fn carried_out(first: &[Stroke], second: &[Stroke], matching: &Matching) -> Matching {
    let known: Vec<Known> = matching.pairs.iter().map(|pair| known(first, second, pair)).collect();
    let keeps = |k: &usize| {
        let pair = &matching.pairs[*k];
        pair.by_hand || pair.confidence >= SURE || agrees(&known, *k, pair.confidence)
    };
    let (kept, flying): (Vec<usize>, Vec<usize>) = (0..known.len()).partition(keeps);
    let mut result = matching.clone();
    result.pairs = kept.into_iter().map(|k| matching.pairs[k]).collect();
    result.vanished.extend(flying.iter().map(|&k| matching.pairs[k].from));
    result.appeared.extend(flying.iter().map(|&k| matching.pairs[k].to));
    result.vanished.sort_unstable();
    result.appeared.sort_unstable();
    result
}

fn known(first: &[Stroke], second: &[Stroke], pair: &Pair) -> Known {
    let samples = |stroke: &Stroke, share: &dyn Fn(f64) -> f64| -> Vec<Point> {
        if stroke.points.is_empty() {
            return Vec::new();
        }
        let line = Line::new(stroke);
        (0..SAMPLES).map(|k| line.at(share(k as f64 / (SAMPLES - 1) as f64))).collect()
    };
    let (a, b) = (&first[pair.from], &second[pair.to]);
    let on_other = |s: f64| match (pair.reversed, a.closed && b.closed) {
        (false, true) => (pair.start + s).rem_euclid(1.0),
        (true, true) => (pair.start - s).rem_euclid(1.0),
        (false, false) => s,
        (true, false) => 1.0 - s,
    };
    let from = samples(a, &|s| s);
    let evident = pair.by_hand || pair.confidence >= EVIDENT;
    Known { middle: polygon::center(&from), from, to: samples(b, &on_other), evident }
}

/// Whether a pair ends near the place where its neighbourhood went.
fn agrees(known: &[Known], k: usize, confidence: f64) -> bool {
    let own = &known[k];
    if own.from.is_empty() || own.to.is_empty() {
        return true;
    }
    let mut near: Vec<(f64, usize)> = (0..known.len())
        .filter(|&j| j != k && known[j].evident && !known[j].from.is_empty() && !known[j].to.is_empty())
        .map(|j| (gap(&own.from, &known[j].from), j))
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.truncate(NEIGHBOURS);
    let pick = |of: fn(&Known) -> &[Point]| near.iter().flat_map(|&(_, j)| of(&known[j]).to_vec()).collect::<Vec<_>>();
    // One neighbour shows a shift. Without any, the drawing is taken to stay where it is.
    let map = match near.len() {
        0 => Similarity::IDENTITY,
        1 => shift(&known[near[0].1]),
        _ => Similarity::fit(&pick(|known| &known.from), &pick(|known| &known.to)),
    };
    let (middle, end) = (map.apply(own.middle), polygon::center(&own.to));
    let size = (own.from.iter().map(|p| p.distance_squared(own.middle)).sum::<f64>() / own.from.len() as f64).sqrt();
    let allowed = LEAST.max(OWN * size + WAY * middle.distance(own.middle));
    middle.distance(end) * (1.0 - confidence / SURE).max(0.0) <= allowed
}

/// The shift of a pair's middle.
fn shift(known: &Known) -> Similarity {
    Similarity { source: known.middle, target: polygon::center(&known.to), ..Similarity::IDENTITY }
}

/// Least distance between samples.
fn gap(a: &[Point], b: &[Point]) -> f64 {
    let to = |p: &Point| b.iter().map(|q| p.distance_squared(*q)).fold(f64::INFINITY, f64::min);
    a.iter().map(to).fold(f64::INFINITY, f64::min).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(x: f64, y: f64) -> Stroke {
        Stroke::new((0..6).map(|k| Point::new(x + 4.0 * f64::from(k), y)).collect(), false)
    }

    fn pairs(confidence: f64, to: [usize; 5]) -> Matching {
        let pair = |i: usize| Pair {
            from: i,
            to: to[i],
            reversed: false,
            start: 0.0,
            confidence: if i == 4 { confidence } else { 1.0 },
            by_hand: false,
        };
        Matching { pairs: (0..5).map(pair).collect(), ..Matching::default() }
    }

    #[test]
    fn an_unsure_pair_that_flies_is_not_carried_out() {
        let first: Vec<Stroke> = (0..5).map(|k| bar(0.0, 15.0 * f64::from(k))).collect();
        let moved = |k: i32| bar(20.0, 15.0 * f64::from(k));
        let near: Vec<Stroke> = (0..5).map(moved).collect();
        let mut far = near.clone();
        far[4] = bar(220.0, -80.0);
        let all = [0, 1, 2, 3, 4];
        assert_eq!(carried_out(&first, &near, &pairs(0.1, all)), pairs(0.1, all));
        assert_eq!(carried_out(&first, &far, &pairs(0.96, all)), pairs(0.96, all));
        let dropped = carried_out(&first, &far, &pairs(0.1, all));
        assert_eq!((dropped.pairs.len(), dropped.vanished, dropped.appeared), (4, vec![4], vec![4]));
        let mut by_hand = pairs(0.1, all);
        by_hand.pairs[4].by_hand = true;
        assert_eq!(carried_out(&first, &far, &by_hand), by_hand);
    }
}
