//! A stroke reduced to the data by which shapes are compared, and the ways to lay one shape on another.
//!
//! Both curves are sampled evenly by arc length and centred. Their samples are read as complex numbers p and q of unit
//! mean square. The best similarity from p to q has the factor r = mean(conj(p) q). It leaves the share 1 − |r|² of the
//! variance unexplained. This measure does not depend on size, place, turn or number of points.
//!
//! Both directions are tried, and for closed curves all starting points. A closed curve keeps its sense of rotation
//! from drawing to drawing. The sign of the area therefore decides the direction, unless the curve is too thin to have
//! a clear sign.

use super::super::angle::wrap;
use super::super::stroke::Stroke;
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon, polyline};

/// Number of samples of a curve.
pub(super) const SAMPLES: usize = 32;
/// Smallest size, in pixels, that is distinguished. A dot counts as this large.
const LEAST_RADIUS: f64 = 0.5;
/// Share of the squared length that the area must exceed to give a closed curve a sense of rotation (a circle has
/// 0.08).
const LEAST_AREA: f64 = 0.005;
/// Number of ways kept for a pair of curves.
const WAYS: usize = 3;

/// A stroke in the form in which it is compared.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// Mean of the samples.
    pub centre: Point,
    /// Root mean square distance of the samples from the centre in pixels; at least [`LEAST_RADIUS`].
    pub radius: f64,
    /// Length in pixels.
    pub length: f64,
    /// Samples in pixels.
    pub places: Vec<Point>,
    /// Samples relative to the centre, divided by the radius.
    shape: Vec<Point>,
    /// Sign of the area; 0 for open and for thin curves.
    turning: i8,
    pub closed: bool,
}

/// One way to lay a curve on another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    /// Share of the variance that the similarity does not explain, 0 to 1.
    pub residual: f64,
    /// Turn in radians, from x towards y.
    pub turn: f64,
    /// Whether the other curve is read backwards.
    pub reversed: bool,
    /// Position of this curve's first sample on the other curve, as a share of that curve's length from its first point
    /// forwards.
    pub start: f64,
    /// Whether the start is a point of the other curve, and no sample near it.
    pub exact: bool,
}

impl Outline {
    /// The outline of a stroke taken as closed or open; `None` where it has no points.
    pub fn new(stroke: &Stroke, closed: bool) -> Option<Self> {
        let places = polyline::resample(&stroke.points, closed, SAMPLES);
        if places.is_empty() {
            return None;
        }
        let centre = polygon::center(&places);
        let square = places.iter().map(|p| p.distance_squared(centre)).sum::<f64>() / SAMPLES as f64;
        let radius = square.sqrt().max(LEAST_RADIUS);
        let length = polyline::length(&stroke.points, closed);
        let area = if closed { polygon::signed_area(&places) } else { 0.0 };
        let turning = if area.abs() > LEAST_AREA * length * length { area.signum() as i8 } else { 0 };
        let shape = places.iter().map(|&p| (p - centre) / radius).collect();
        Some(Self { centre, radius, length, places, shape, turning, closed })
    }

    /// All ways to lay this curve on `other`. Both must be closed or both open. The outer list is by direction, the
    /// inner one by start.
    pub fn all_ways(&self, other: &Self) -> Vec<Vec<Way>> {
        let ways = |reversed| if self.closed { self.around(other, reversed) } else { vec![self.lay(other, reversed)] };
        self.directions(other).into_iter().map(ways).collect()
    }

    /// Whether the other curve may be read backwards: no, yes, or both.
    pub fn directions(&self, other: &Self) -> Vec<bool> {
        match self.turning * other.turning {
            0 => vec![false, true],
            turning => vec![turning == -1],
        }
    }

    /// This closed curve's samples, read as the counterpart of another one in a way.
    pub fn read(&self, way: &Way) -> Vec<Point> {
        let first = (way.start * SAMPLES as f64).round() as usize;
        let at = |k: usize| if way.reversed { first + SAMPLES - k } else { first + k };
        (0..SAMPLES).map(|k| self.places[at(k) % SAMPLES]).collect()
    }

    /// The ways to lay this closed curve on another one, by start. All starts are computed side by side for vector
    /// instructions.
    fn around(&self, other: &Self, reversed: bool) -> Vec<Way> {
        let twice = |axis: fn(&Point) -> f64| -> Vec<f64> {
            other.shape.iter().chain(&other.shape).chain(&other.shape[..1]).map(axis).collect()
        };
        let (xs, ys) = (twice(|p| p.x), twice(|p| p.y));
        let (mut along, mut across) = ([0.0; SAMPLES], [0.0; SAMPLES]);
        for (k, p) in self.shape.iter().enumerate() {
            let first = if reversed { SAMPLES - k } else { k };
            let others = xs[first..first + SAMPLES].iter().zip(&ys[first..first + SAMPLES]);
            for ((along, across), (x, y)) in along.iter_mut().zip(&mut across).zip(others) {
                *along += p.x * x + p.y * y;
                *across += p.x * y - p.y * x;
            }
        }
        let way = |start: usize| self.way(other, Point::new(along[start], across[start]), start, reversed);
        (0..SAMPLES).map(way).collect()
    }

    /// The most likely ways to lay this curve on `other`. A turn away from the expected one costs `stiffness` in units
    /// of the residual for each rad².
    pub fn ways(&self, other: &Self, expected: f64, stiffness: f64) -> Vec<Way> {
        likely(&self.all_ways(other), expected, stiffness)
    }

    /// The way to lay this open curve on another one in a direction.
    fn lay(&self, other: &Self, reversed: bool) -> Way {
        let first = if reversed { SAMPLES - 1 } else { 0 };
        let mut factor = Point::ZERO;
        for (k, p) in self.shape.iter().enumerate() {
            let q = other.shape[if reversed { first - k } else { k }];
            factor += Point::new(p.dot(q), p.perp_dot(q));
        }
        self.way(other, factor, first, reversed)
    }

    /// The way that belongs to `sum`, the sum of conj(p) q over the samples.
    fn way(&self, other: &Self, sum: Point, first: usize, reversed: bool) -> Way {
        let factor = sum / SAMPLES as f64;
        // Two dots have no shape that could differ.
        let flat = |outline: &Self| outline.shape.iter().all(|p| *p == Point::ZERO);
        let residual = if flat(self) && flat(other) { 0.0 } else { (1.0 - factor.length_squared()).clamp(0.0, 1.0) };
        let steps = if self.closed { SAMPLES } else { SAMPLES - 1 };
        Way { residual, turn: factor.to_angle(), reversed, start: first as f64 / steps as f64, exact: false }
    }

    /// The similarity that lays this curve on `other` in the given way.
    pub fn movement(&self, other: &Self, way: &Way) -> Similarity {
        let factor = Point::from_angle(way.turn) * (other.radius / self.radius);
        Similarity { factor, source: self.centre, target: other.centre }
    }
}

/// The most likely of all ways, cheapest first. A turn away from the expected one costs `stiffness` in units of the
/// residual for each rad². Of neighbouring starts only the cheapest counts.
pub(super) fn likely(all: &[Vec<Way>], expected: f64, stiffness: f64) -> Vec<Way> {
    let mut found: Vec<(f64, Way)> = Vec::new();
    for ways in all {
        let costs: Vec<f64> =
            ways.iter().map(|way| way.residual + stiffness * wrap(way.turn - expected).powi(2)).collect();
        let n = ways.len();
        let lowest = |k: usize| n == 1 || (costs[k] <= costs[(k + n - 1) % n] && costs[k] <= costs[(k + 1) % n]);
        found.extend((0..n).filter(|&k| lowest(k)).map(|k| (costs[k], ways[k])));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().take(WAYS).map(|(_, way)| way).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_and_reversed_curve_is_laid_upon_exactly() {
        for closed in [false, true] {
            let points = [(0.0, 0.0), (30.0, 0.0), (30.0, 12.0), (9.0, 15.0)].map(Point::from);
            let turn = Point::from_angle(0.8) * 1.5;
            let moved = points.iter().rev().map(|&p| turn.rotate(p) + Point::new(50.0, 9.0)).collect();
            let (a, b) = (Stroke::new(points.into(), closed), Stroke::new(moved, closed));
            let (a, b) = (Outline::new(&a, closed).unwrap(), Outline::new(&b, closed).unwrap());
            let way = a.ways(&b, 0.0, 0.0)[0];
            assert!(way.reversed && way.residual < 0.01 && (way.turn - 0.8).abs() < 0.06, "{way:?}");
            let centre = a.movement(&b, &way).apply(Point::new(15.0, 6.0));
            assert!(centre.distance(turn.rotate(Point::new(15.0, 6.0)) + Point::new(50.0, 9.0)) < 1.5, "{centre}");
        }
    }
}
