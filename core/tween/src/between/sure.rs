//! Pairs that are carried out: those that are sure, and those that agree with the sure pairs around them.
//!
//! A wrong pair lets a stroke fly across the drawing. Its counterpart lies where nothing around it went. So each pair is
//! compared with its neighbourhood: the similarity that fits the nearest evident pairs best (those by hand, and those with a
//! high confidence) says where the stroke should have gone. A pair that is not sure and goes elsewhere is not carried
//! out. Its two strokes are exchanged half way instead, each going with the rigid group around it. Strokes of a matching in
//! pieces are not touched, and neither are pairs made by hand.
//!
//! A pair can also be right as a whole and wrong place by place: automatic tracing draws a body and a leg in one go on one
//! key, and the body alone on the other. Then points that lie on the counterpart already, once they have moved with their
//! neighbourhood, have their own counterparts far away along it. Such a pair is not carried out either, however sure it is.
//!
//! A pair far below certainty is judged by its place alone; the surer a pair is, the farther it may go its own way: an arm
//! that swings is sure, because it looks like itself.
//!
//! The only evident pair that moves is carried out: a ball that falls is not judged by the ground line.

use super::super::grid::Grid;
use super::super::ink;
use super::super::line::Line;
use super::super::matching::{Matching, Pair};
use super::super::stroke::Stroke;
use super::correspond::Places;
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon, polyline};

/// A pair is carried out wherever it goes from this confidence on.
const SURE: f64 = 0.95;
/// A pair shows where its neighbours go from this confidence on.
const EVIDENT: f64 = 0.6;
/// Number of nearest evident pairs that show where a stroke should have gone.
const NEIGHBOURS: usize = 5;
/// A pair without any confidence may end its own size, and this share of its way, away from where it should have gone.
const OWN: f64 = 1.0;
const WAY: f64 = 0.25;
/// Least distance that is allowed, and the largest of a stroke that stands, in pixels.
const LEAST: f64 = 3.0;
/// Number of samples of a stroke.
const SAMPLES: usize = 8;
/// Distance from the counterpart, as a share of the drawing's size, of a place that lies on it, and of one that lies at its own
/// counterpart.
const ON: f64 = 0.008;
const AT: f64 = 0.03;
/// Share of the places that may lie on the counterpart without lying at their own counterparts.
const ASTRAY: f64 = 0.35;
/// A movement that shrinks more than this does not lead back.
const LEAST_SCALE: f64 = 1e-6;
/// Root mean square that the similarity of a stroke that keeps its shape leaves, as a share of the stroke's own.
const RIGID: f64 = 0.15;
/// Number of samples of the counterpart, and of the places that are tried.
const DENSE: usize = 256;
const TRIED: usize = 64;

/// A pair with samples of both strokes.
struct Known {
    from: Vec<Point>,
    to: Vec<Point>,
    middle: Point,
    evident: bool,
    stands: bool,
}

/// What is carried out between two drawings.
#[derive(Debug, PartialEq)]
pub(super) struct CarriedOut {
    /// The matching without the pairs that should not be carried out. Their strokes are among the vanished and the appeared.
    pub matching: Matching,
    /// The strokes of these pairs, rising: on the first and on the second drawing.
    pub exchanged: [Vec<usize>; 2],
}

/// The pairs that should be carried out.
pub(super) fn carried_out(first: &[Stroke], second: &[Stroke], matching: &Matching) -> CarriedOut {
    let known: Vec<Known> = matching.pairs.iter().map(|pair| known(first, second, pair)).collect();
    let size = ink::size(first.iter().chain(second).flat_map(|s| &s.points));
    let keeps = |k: &usize| {
        let pair = &matching.pairs[*k];
        let around = around(&known, *k);
        let (a, b) = (&first[pair.from], &second[pair.to]);
        let sure = pair.confidence >= SURE || is_only_mover(&known, *k) || agrees(&known[*k], &around, pair.confidence);
        pair.by_hand || (sure && !goes_astray(a, b, pair, &around, size))
    };
    let (kept, flying): (Vec<usize>, Vec<usize>) = (0..known.len()).partition(keeps);
    let mut result = matching.clone();
    result.pairs = kept.into_iter().map(|k| matching.pairs[k]).collect();
    let mut exchanged: [Vec<usize>; 2] = [
        flying.iter().map(|&k| matching.pairs[k].from).collect(),
        flying.iter().map(|&k| matching.pairs[k].to).collect(),
    ];
    exchanged.iter_mut().for_each(|strokes| strokes.sort_unstable());
    result.vanished.extend(&exchanged[0]);
    result.appeared.extend(&exchanged[1]);
    result.vanished.sort_unstable();
    result.appeared.sort_unstable();
    CarriedOut { matching: result, exchanged }
}

/// Whether many places lie on the counterpart once they have moved, but far from their own counterparts. The movement is
/// that of the neighbourhood, or the one that fits the pair itself best. Both directions are tried. A stroke that keeps its
/// shape may slide along itself.
fn goes_astray(a: &Stroke, b: &Stroke, pair: &Pair, around: &Similarity, size: f64) -> bool {
    if [a, b].iter().any(|stroke| stroke.points.len() < 2 || stroke.length() <= 0.0) {
        return false;
    }
    let own = Places::all(&Stroke::new(polyline::resample(&a.points, a.closed, TRIED), a.closed));
    let resampled = Stroke::new(own.points.clone(), a.closed);
    let there = own.on(&resampled, b, pair).points;
    let fitted = Similarity::fit(&own.points, &there);
    let middle = polygon::center(&there);
    let (left, spread) = own.points.iter().zip(&there).fold((0.0, 0.0), |(left, spread), (p, q)| {
        (left + fitted.apply(*p).distance_squared(*q), spread + middle.distance_squared(*q))
    });
    if left <= RIGID * RIGID * spread {
        return false;
    }
    let dense = |s: &Stroke| polyline::resample(&s.points, s.closed, DENSE);
    let (on_a, on_b) = (dense(a), dense(b));
    let (grid_a, grid_b) = (Grid::new(&on_a), Grid::new(&on_b));
    let astray = |from: &[Point], to: &[Point], map: &Similarity, ink: &[Point], grid: &Grid| {
        let is = |(p, q): (&Point, &Point)| {
            let p = map.apply(*p);
            let near = grid.nearest(p, 1).first().is_some_and(|&i| ink[i].distance(p) <= ON * size);
            near && p.distance(*q) > AT * size
        };
        from.iter().zip(to).filter(|&(p, q)| is((p, q))).count() as f64 > ASTRAY * from.len() as f64
    };
    let usable = |map: &&Similarity| map.scale().is_finite() && map.scale() > LEAST_SCALE;
    [*around, fitted].iter().filter(usable).any(|map| {
        astray(&own.points, &there, map, &on_b, &grid_b) || astray(&there, &own.points, &map.inverse(), &on_a, &grid_a)
    })
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
    let to = samples(b, &on_other);
    let stands = from.iter().zip(&to).all(|(p, q)| p.distance(*q) <= LEAST);
    let evident = pair.by_hand || pair.confidence >= EVIDENT;
    Known { middle: polygon::center(&from), from, to, evident, stands }
}

/// Whether a pair is the only evident one that moves. Nothing shows then where it should have gone.
fn is_only_mover(known: &[Known], k: usize) -> bool {
    let moves = |known: &Known| known.evident && !known.stands;
    (0..known.len()).all(|j| moves(&known[j]) == (j == k))
}

/// Whether a pair ends near the place where its neighbourhood went.
fn agrees(own: &Known, around: &Similarity, confidence: f64) -> bool {
    if own.from.is_empty() || own.to.is_empty() {
        return true;
    }
    let (middle, end) = (around.apply(own.middle), polygon::center(&own.to));
    let size = (own.from.iter().map(|p| p.distance_squared(own.middle)).sum::<f64>() / own.from.len() as f64).sqrt();
    let allowed = LEAST.max(OWN * size + WAY * middle.distance(own.middle));
    middle.distance(end) * (1.0 - confidence / SURE).max(0.0) <= allowed
}

/// The movement of the evident pairs nearest to a pair.
fn around(known: &[Known], k: usize) -> Similarity {
    let own = &known[k];
    let mut near: Vec<(f64, usize)> = (0..known.len())
        .filter(|&j| j != k && known[j].evident && !known[j].from.is_empty() && !known[j].to.is_empty())
        .map(|j| (gap(&own.from, &known[j].from), j))
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.truncate(NEIGHBOURS);
    let pick = |of: fn(&Known) -> &[Point]| near.iter().flat_map(|&(_, j)| of(&known[j]).to_vec()).collect::<Vec<_>>();
    // One neighbour shows a shift. Without any, the drawing is taken to stay where it is.
    match near.len() {
        0 => Similarity::IDENTITY,
        1 => shift(&known[near[0].1]),
        _ => Similarity::fit(&pick(|known| &known.from), &pick(|known| &known.to)),
    }
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
        let as_given = |second: &[Stroke], given: &Matching| carried_out(&first, second, given).matching == *given;
        assert!(as_given(&near, &pairs(0.1, all)));
        assert!(as_given(&far, &pairs(0.96, all)));
        let dropped = carried_out(&first, &far, &pairs(0.1, all));
        let of = &dropped.matching;
        assert_eq!((of.pairs.len(), &of.vanished[..], &of.appeared[..]), (4, &[4][..], &[4][..]));
        assert_eq!(dropped.exchanged, [vec![4], vec![4]]);
        let mut by_hand = pairs(0.1, all);
        by_hand.pairs[4].by_hand = true;
        assert!(as_given(&far, &by_hand));
    }

    #[test]
    fn what_stands_does_not_judge_the_only_stroke_that_moves() {
        let ground: Vec<Stroke> = (0..4).map(|k| bar(0.0, 15.0 * f64::from(k))).collect();
        let with = |last: Stroke| ground.iter().cloned().chain([last]).collect::<Vec<_>>();
        let (first, second) = (with(bar(0.0, 60.0)), with(bar(220.0, -80.0)));
        let matching = pairs(0.7, [0, 1, 2, 3, 4]);
        assert_eq!(carried_out(&first, &second, &matching).matching, matching);
        let unsure = pairs(0.5, [0, 1, 2, 3, 4]);
        assert_eq!(carried_out(&first, &second, &unsure).exchanged, [vec![4], vec![4]]);
        // A line of the ground that was drawn anew, four pixels beside, does show where things go.
        let drawn_anew = with(bar(220.0, -80.0)).into_iter().enumerate();
        let second: Vec<Stroke> = drawn_anew.map(|(k, s)| if k == 3 { bar(4.0, 45.0) } else { s }).collect();
        assert_eq!(carried_out(&first, &second, &matching).exchanged, [vec![4], vec![4]]);
    }

    /// A box whose outline goes on as a tail on the first drawing only.
    #[test]
    fn a_sure_pair_whose_places_slide_along_the_counterpart_is_not_carried_out() {
        let line = |corners: &[(f64, f64)]| {
            let corners: Vec<Point> = corners.iter().copied().map(Point::from).collect();
            Stroke::new(polyline::resample(&corners, false, 120), false)
        };
        let outline = [(0.0, 0.0), (40.0, 0.0), (40.0, 90.0), (0.0, 90.0), (0.0, 2.0)];
        let tail =
            [&[(120.0, 160.0), (60.0, 150.0), (0.0, 90.0)][..], &[(0.0, 0.0), (40.0, 0.0), (40.0, 90.0), (2.0, 90.0)]];
        let (whole, other) = (line(&outline), line(&tail.concat()));
        let pair = Pair { from: 0, to: 0, reversed: false, start: 0.0, confidence: 0.99, by_hand: false };
        let matching = Matching { pairs: vec![pair], ..Matching::default() };
        let [first, second] = [&whole, &other].map(std::slice::from_ref);
        assert_eq!(carried_out(first, second, &matching).exchanged, [vec![0], vec![0]]);
        assert_eq!(carried_out(first, first, &matching).matching, matching);
    }
}
