//! Where each place of a drawing is on another one, from places on its lines.
//!
//! Lines say where they went, and what is between them follows: a shift is the mean of those of the eight nearest places
//! on lines, each with the weight 1 / (d + 2 px)² of its distance d. Shifts are worked out at nodes and are
//! bilinear between them.
//!
//! Nodes are looked at in squares. If D is how far the eighth place is from the middle of a square, and r how far its nodes are, then the eight places of a
//! node are within D + r of it, and within D + 2r of the middle. So the others are dropped once for all nodes of the square, and the shifts stay the same to the
//! last bit.

use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use std::f64::consts::SQRT_2;

/// Places of which the mean is taken.
const NEAREST: usize = 8;
/// Added to each distance, in pixels at 540 lines.
const SOFT: f64 = 2.0;
/// Nodes along a side of a square.
const SQUARE: usize = 8;

/// Shifts of all places of a picture.
pub struct Shifts {
    nodes: Vec<Point>,
    across: usize,
    down: usize,
    every: f64,
}

impl Shifts {
    /// The shifts in a picture of `width` × `height` pixels. `places` are places on lines with their shifts; `unit` is the
    /// size of a pixel of 540 lines, and nodes are four of them apart. Without places nothing moves.
    pub fn new(places: &[(Point, Point)], width: usize, height: usize, unit: f64) -> Self {
        let every = (4.0 * unit).max(1.0);
        let count = |length: usize| (length as f64 / every).ceil() as usize + 2;
        let (across, down) = (count(width), count(height));
        let squares = |band: usize| -> Vec<Point> {
            let rows = band * SQUARE..down.min((band + 1) * SQUARE);
            let lists: Vec<_> = (0..across.div_ceil(SQUARE)).map(|k| near_square(places, k, band, every)).collect();
            let node =
                |u: usize, v: usize| mean(&lists[u / SQUARE], Point::new(u as f64, v as f64) * every, SOFT * unit);
            rows.flat_map(|v| (0..across).map(move |u| (u, v))).map(|(u, v)| node(u, v)).collect()
        };
        let nodes = (0..down.div_ceil(SQUARE)).into_par_iter().flat_map_iter(squares).collect();
        Self { nodes, across, down, every }
    }

    /// Where a place of the picture is.
    pub fn carry(&self, place: Point) -> Point {
        let at = place / self.every;
        let (u, v) = (self.cell(at.x, self.across), self.cell(at.y, self.down));
        let (x, y) = (at.x - u as f64, at.y - v as f64);
        let node = |u: usize, v: usize| self.nodes[v * self.across + u];
        let above = node(u, v).lerp(node(u + 1, v), x);
        let below = node(u, v + 1).lerp(node(u + 1, v + 1), x);
        place + above.lerp(below, y)
    }

    fn cell(&self, at: f64, count: usize) -> usize {
        (at.max(0.0) as usize).min(count - 2)
    }
}

/// The places that may be among the nearest ones of a node of a square, in their order. `every` is the distance of the nodes.
fn near_square(places: &[(Point, Point)], u: usize, v: usize, every: f64) -> Vec<(Point, Point)> {
    let half = 0.5 * (SQUARE - 1) as f64;
    let middle = (Point::new((u * SQUARE) as f64, (v * SQUARE) as f64) + Point::splat(half)) * every;
    let mut away: Vec<f64> = places.iter().map(|(place, _)| place.distance_squared(middle)).collect();
    let farthest = if away.len() > NEAREST {
        away.select_nth_unstable_by(NEAREST - 1, f64::total_cmp).1.sqrt()
    } else {
        f64::INFINITY
    };
    // A little more, for what is rounded.
    let reach = (farthest + 2.0 * half * every * SQRT_2) * (1.0 + 1e-9);
    places.iter().copied().filter(|(place, _)| place.distance_squared(middle) <= reach * reach).collect()
}

/// The mean shift at a place.
fn mean(places: &[(Point, Point)], at: Point, soft: f64) -> Point {
    let mut near = [(f64::INFINITY, Point::ZERO); NEAREST];
    for &(place, shift) in places {
        let away = place.distance_squared(at);
        if away < near[NEAREST - 1].0 {
            let k = near.partition_point(|found| found.0 <= away);
            near[k..].rotate_right(1);
            near[k] = (away, shift);
        }
    }
    let (mut sum, mut total) = (Point::ZERO, 0.0);
    for (away, shift) in near.into_iter().filter(|found| found.0.is_finite()) {
        let weight = (away.sqrt() + soft).powi(-2);
        sum += weight * shift;
        total += weight;
    }
    if total > 0.0 { sum / total } else { Point::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    #[test]
    fn one_shift_everywhere_is_that_shift_everywhere() {
        let places: Vec<(Point, Point)> =
            (0..20).map(|k| (Point::new(f64::from(5 * k), f64::from(k * k % 31)), Point::new(3.0, -1.5))).collect();
        let shifts = Shifts::new(&places, 100, 60, 1.0);
        for place in [Point::new(0.5, 0.5), Point::new(99.5, 59.5), Point::new(33.2, 17.9)] {
            assert!(shifts.carry(place).distance(place + Point::new(3.0, -1.5)) < 1e-9);
        }
    }

    proptest! {
        #[test]
        fn squares_give_what_all_places_give(
            places in vec(((0i32..120, 0i32..70), (-9.0..9.0f64, -9.0..9.0f64)), 0..90),
            spread in 0.1..1.0f64,
        ) {
            // On a grid many places are equally far.
            let place = |&((x, y), shift): &((i32, i32), (f64, f64))| {
                (Point::new(f64::from(x / 4 * 4), f64::from(y / 4 * 4)) * spread, Point::new(shift.0, shift.1))
            };
            let places: Vec<(Point, Point)> = places.iter().map(place).collect();
            let shifts = Shifts::new(&places, 130, 80, 1.0);
            for (k, node) in shifts.nodes.iter().enumerate() {
                let at = Point::new((k % shifts.across) as f64, (k / shifts.across) as f64) * shifts.every;
                prop_assert_eq!(*node, mean(&places, at, SOFT));
            }
        }
    }

    #[test]
    fn without_lines_nothing_moves() {
        assert_eq!(Shifts::new(&[], 20, 20, 1.0).carry(Point::new(7.5, 3.5)), Point::new(7.5, 3.5));
    }

    #[test]
    fn a_place_goes_with_the_lines_near_it() {
        let line =
            |x: f64, shift: f64| (0..8).map(move |y| (Point::new(x, 5.0 * f64::from(y)), Point::new(shift, 0.0)));
        let places: Vec<(Point, Point)> = line(10.0, 4.0).chain(line(90.0, -4.0)).collect();
        let shifts = Shifts::new(&places, 100, 40, 1.0);
        assert!((shifts.carry(Point::new(12.0, 20.0)).x - 16.0).abs() < 0.1);
        assert!((shifts.carry(Point::new(88.0, 20.0)).x - 84.0).abs() < 0.1);
    }
}
