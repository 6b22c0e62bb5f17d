//! Closed strokes that are squashed with the strokes around them.
//!
//! A patch on a sack that falls is squashed with the sack. Seen against the page it changes its proportions so much that a turn by a right angle
//! explains it as well; seen against the sack it hardly changes. And shares of its length tell nothing: what was a fifth of it is a third. So a closed
//! stroke is squashed as the strokes around it are, and then laid on its counterpart: by the way that fits best, and turns it least against them. An
//! affine map is fitted to their middles, the nearest counting most. It counts only where it explains them nearly: the strokes of an arm and a body go
//! their own ways.
//!
//! Only strokes that change their proportions are asked: the others show themselves how they turn.

use super::super::grid::Grid;
use super::super::stroke::Stroke;
use super::costs::Figure;
use super::outline::{Outline, SAMPLES, Way};
use super::relaxation::Chosen;
use super::squash::RIGID;
use super::start;
use crate::affine::{Affine, elongation};
use crate::angle::wrap;
use rototoon_base::geometry::Point;

/// Largest number of neighbours, and how many show a squash at least.
const NEIGHBOURS: usize = 12;
const LEAST: usize = 5;
/// Distance, in radii of the drawing, at which a neighbour has half the weight of one at distance zero.
const NEAR: f64 = 0.4;
/// Largest share of the variance of the middles that a squash leaves unexplained.
const EXPLAINED: f64 = 0.05;
/// Middles that lie along a line show nothing across it: largest logarithm of the ratio of their extents.
const ALONG: f64 = 1.5;
/// Price of a turn, in radians, in shares of the shape's variance.
const TURN: f64 = 0.06;
/// A way is replaced by one that is cheaper by this: less is noise in shapes that were drawn freely.
const CHEAPER: f64 = 0.03;

/// A linear map, by the images of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Squash {
    x: Point,
    y: Point,
}

impl Squash {
    fn apply(self, p: Point) -> Point {
        self.x * p.x + self.y * p.y
    }

    /// The turn of the map, in radians.
    fn turn(self) -> f64 {
        Point::new(self.x.x + self.y.y, self.x.y - self.y.x).to_angle()
    }

    /// A better way to lay a closed stroke, which is squashed as this map says, on its counterpart than its `own` one.
    pub fn way_of(self, one: &Stroke, p: &Outline, (other, q): (&Stroke, &Outline), own: &Way) -> Option<Way> {
        if Affine::fit(&p.places, &q.read(own))?.stretch < RIGID {
            return None;
        }
        let carried = Stroke::new(one.points.iter().map(|&p| self.apply(p)).collect(), true);
        let price = |way: &Way| way.residual + TURN * wrap(way.turn).abs();
        let step = |way: &Way| (way.start * SAMPLES as f64).round() as usize % SAMPLES;
        let all: Vec<Way> = Outline::new(&carried, true)?.all_ways(q).into_iter().flatten().collect();
        let now = all.iter().find(|way| (way.reversed, step(way)) == (own.reversed, step(own)))?;
        let best = all.iter().min_by(|x, y| price(x).total_cmp(&price(y)))?;
        (price(best) < price(now) - CHEAPER).then(|| Way {
            start: start::refined(&carried, other, best.start, best.reversed),
            turn: wrap(best.turn + self.turn()),
            exact: true,
            ..*best
        })
    }

    /// The map that fits weighted pairs of places best, where it explains them.
    fn fit(pairs: &[(f64, Point, Point)]) -> Option<Self> {
        let total: f64 = pairs.iter().map(|pair| pair.0).sum();
        let source = pairs.iter().map(|pair| pair.0 * pair.1).sum::<Point>() / total;
        let target = pairs.iter().map(|pair| pair.0 * pair.2).sum::<Point>() / total;
        let (mut xx, mut xy, mut yy, mut spread) = (0.0, 0.0, 0.0, 0.0);
        let (mut along_x, mut along_y) = (Point::ZERO, Point::ZERO);
        for &(weight, p, q) in pairs {
            let (p, q) = (p - source, q - target);
            xx += weight * p.x * p.x;
            xy += weight * p.x * p.y;
            yy += weight * p.y * p.y;
            spread += weight * q.length_squared();
            along_x += q * (weight * p.x);
            along_y += q * (weight * p.y);
        }
        let det = xx * yy - xy * xy;
        let map = Self { x: (along_x * yy - along_y * xy) / det, y: (along_y * xx - along_x * xy) / det };
        let left = spread - map.x.dot(along_x) - map.y.dot(along_y);
        (left <= EXPLAINED * spread && map.x.perp_dot(map.y) > 0.0).then_some(map)
    }
}

/// The squash of what is around each stroke of the first drawing.
pub(super) fn squashes(a: &Figure, b: &Figure, found: &[Option<Chosen>]) -> Vec<Option<Squash>> {
    let middle = |(i, choice): (usize, &Option<Chosen>)| {
        let to = choice.as_ref()?.to;
        Some((i, a.outlines[i].as_ref()?.centre, b.outlines[to].as_ref()?.centre))
    };
    let known: Vec<(usize, Point, Point)> = found.iter().enumerate().filter_map(middle).collect();
    let places: Vec<Point> = known.iter().map(|known| known.1).collect();
    let grid = Grid::new(&places);
    let near = (NEAR * a.radius).powi(2);
    let of = |i: usize| {
        let own = a.outlines[i].as_ref()?.centre;
        let others = grid.nearest(own, NEIGHBOURS + 1).into_iter().map(|k| known[k]).filter(|known| known.0 != i);
        let pairs: Vec<_> = others.map(|(_, p, q)| (near / (own.distance_squared(p) + near), p, q)).collect();
        let around: Vec<Point> = pairs.iter().map(|pair| pair.1).collect();
        let shows = pairs.len() >= LEAST && elongation(&around) <= ALONG;
        if shows { Squash::fit(&pairs) } else { None }
    };
    (0..found.len()).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::line::Line;
    use super::super::{HandPair, Options, match_strokes};
    use super::*;
    use rototoon_base::geometry::polyline;
    use rototoon_base::scene::Silent;
    use std::f64::consts::TAU;

    fn places() -> Vec<Point> {
        [(0.0, 0.0), (40.0, 5.0), (35.0, 60.0), (-10.0, 50.0), (12.0, 21.0)].map(Point::from).to_vec()
    }

    fn fitted(to: impl Fn(Point) -> Point) -> Option<Squash> {
        Squash::fit(&places().into_iter().map(|p| (1.0, p, to(p) + Point::new(90.0, 7.0))).collect::<Vec<_>>())
    }

    #[test]
    fn a_patch_that_was_drawn_anew_is_squashed_with_its_sack() {
        let at = |x: f64, y: f64, s: &Stroke| {
            Stroke::new(s.points.iter().map(|p| *p + Point::new(x, y)).collect(), s.closed)
        };
        let stitch = |x: f64, y: f64| Stroke::new(vec![Point::new(x, y), Point::new(x + 4.0, y + 18.0)], false);
        let sack = |count: usize, first: usize| -> Vec<Stroke> {
            let mut corners = polyline::resample(
                &[(-45.0, -42.0), (45.0, -42.0), (45.0, 42.0), (-45.0, 42.0)].map(Point::from),
                true,
                count,
            );
            corners.rotate_left(first);
            let patch = at(5.0, 60.0, &Stroke::new(corners, true));
            let ring = (0..8).map(|k| Point::from_angle(0.3 + TAU * f64::from(k) / 8.0) * Point::new(130.0, 180.0));
            [patch]
                .into_iter()
                .chain(ring.map(|p| stitch(p.x, p.y)))
                .chain((0..4).map(|k| stitch(18.0 * f64::from(k) - 40.0, 14.0)))
                .collect()
        };
        let squashed = |strokes: Vec<Stroke>, wide: f64, high: f64, turn: f64| -> Vec<Stroke> {
            let to = |p: &Point| Point::from_angle(turn).rotate(*p * Point::new(wide, high));
            strokes.iter().map(|s| Stroke::new(s.points.iter().map(to).collect(), s.closed)).collect()
        };
        let (first, second) = (squashed(sack(41, 0), 0.8, 1.3, -0.25), squashed(sack(33, 7), 1.35, 0.66, 0.1));
        let by_hand: Vec<HandPair> = (0..first.len()).map(|k| HandPair { from: k, to: Some(k) }).collect();
        let pair = match_strokes(&first, &second, &by_hand, &Options::default(), &Silent).unwrap().pairs[0];
        let start = Line::new(&second[0]).at(pair.start);
        let wanted =
            squashed(vec![Stroke::new(vec![sack(41, 0)[0].points[0]], true)], 1.35, 0.66, 0.1).remove(0).points[0];
        assert!(start.distance(wanted) < 8.0, "{start} is not {wanted}");
    }

    #[test]
    fn what_goes_its_own_ways_and_a_mirror_image_show_no_squash() {
        assert!(fitted(|p| p * 2.0).is_some());
        assert_eq!(fitted(|p| if p.x > 30.0 { p + Point::new(-90.0, 40.0) } else { p }), None);
        assert_eq!(fitted(|p| Point::new(-p.x, p.y)), None);
    }
}
