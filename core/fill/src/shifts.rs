//! Where each place of a drawing is on another one, from places on its lines.
//!
//! Lines say where they went, and what is between them follows: a shift is the mean of those of the eight nearest places
//! on lines, each with the weight 1 / (d + 2 px)² of its distance d. Shifts are worked out at nodes and are
//! bilinear between them.

use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::Point;

/// Places of which the mean is taken.
const NEAREST: usize = 8;
/// Added to each distance, in pixels at 540 lines.
const SOFT: f64 = 2.0;

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
        let row = |v: usize| -> Vec<Point> {
            (0..across).map(|u| mean(places, Point::new(u as f64, v as f64) * every, SOFT * unit)).collect()
        };
        let nodes = (0..down).into_par_iter().flat_map_iter(row).collect();
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

    #[test]
    fn one_shift_everywhere_is_that_shift_everywhere() {
        let places: Vec<(Point, Point)> =
            (0..20).map(|k| (Point::new(f64::from(5 * k), f64::from(k * k % 31)), Point::new(3.0, -1.5))).collect();
        let shifts = Shifts::new(&places, 100, 60, 1.0);
        for place in [Point::new(0.5, 0.5), Point::new(99.5, 59.5), Point::new(33.2, 17.9)] {
            assert!(shifts.carry(place).distance(place + Point::new(3.0, -1.5)) < 1e-9);
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
