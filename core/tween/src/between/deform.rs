//! Change from one shape to another, as rigid as possible along the line.
//!
//! Each edge between neighbouring points turns by an angle, and changes its length and direction in its own turned
//! frame. At share s it has turned by s times the angle. The angle is that of the best rotation of the edges around it.
//! It continues from edge to edge without jumps, so a line that curls up by half a turn or more curls all the way
//! (Sederberg et al. 1993 interpolate turning angles and lengths in a similar way). The edges are then added up. On a
//! closed line a gap remains; it is spread over the edges in proportion to their lengths, which is least squares. Both
//! end shapes are met exactly.
//!
//! Limits: a closed line whose turning number changes, such as a circle that becomes a figure eight, moves along
//! straight lines.

use rototoon_base::geometry::Point;
use rototoon_base::geometry::polygon;

/// Number of edges on each side that decide an edge's turn, as a share of all edges.
const WINDOW: f64 = 1.0 / 24.0;
/// A turn in radians so small that its effect is below a rounding error of single precision.
const NO_TURN: f64 = 1e-9;
/// Share of the edges' products that must agree for their turn to count.
const AGREEMENT: f64 = 0.2;

/// A change of shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Deform {
    from: Vec<Point>,
    to: Vec<Point>,
    closed: bool,
    /// For each edge its turn, its vector in the first shape, and its vector in the second shape turned back. `None`
    /// for straight movement.
    turns: Option<Vec<(f64, Point, Point)>>,
}

impl Deform {
    /// The change from `from` to `to`, which must have the same number of points.
    pub fn new(from: &[Point], to: &[Point], closed: bool, rigid: bool) -> Self {
        assert_eq!(from.len(), to.len(), "the two shapes must have the same number of points");
        let (a, b) = (edges(from, closed), edges(to, closed));
        let turns = if rigid && from.len() > 2 { turns(&a, &b, closed) } else { None };
        let back = |(turn, (a, b)): (f64, (&Point, &Point))| (turn, *a, Point::from_angle(-turn).rotate(*b));
        let turns = turns.map(|turns| turns.into_iter().zip(a.iter().zip(&b)).map(back).collect());
        Self { from: from.into(), to: to.into(), closed, turns }
    }

    /// The points at a share. The share may be outside 0..1.
    pub fn at(&self, s: f64) -> Vec<Point> {
        let straight = || self.from.iter().zip(&self.to).map(|(p, q)| p.lerp(*q, s));
        let Some(turns) = &self.turns else { return straight().collect() };
        let mut steps: Vec<Point> = turns.iter().map(|(turn, a, b)| turned(a.lerp(*b, s), s * turn)).collect();
        if self.closed {
            let gap = steps.iter().sum::<Point>();
            let total = steps.iter().map(|e| e.length()).sum::<f64>().max(f64::MIN_POSITIVE);
            steps.iter_mut().for_each(|e| *e -= gap * (e.length() / total));
        }
        let mut place = Point::ZERO;
        let mut points = vec![place];
        for step in &steps[..self.from.len() - 1] {
            place += *step;
            points.push(place);
        }
        let middle = polygon::center(&self.from).lerp(polygon::center(&self.to), s);
        let shift = middle - polygon::center(&points);
        points.iter_mut().for_each(|p| *p += shift);
        points
    }

    /// The vectors from the first shape to the second, x and y of each point in turn.
    pub fn way(&self) -> Vec<f64> {
        self.from.iter().zip(&self.to).flat_map(|(p, q)| (*q - *p).to_array()).collect()
    }
}

/// A vector turned by an angle. Most edges of a rigid shape do not turn, so zero is handled without work.
fn turned(v: Point, angle: f64) -> Point {
    if angle.abs() < NO_TURN { v } else { Point::from_angle(angle).rotate(v) }
}

fn edges(points: &[Point], closed: bool) -> Vec<Point> {
    let n = points.len();
    (0..if closed { n } else { n.saturating_sub(1) }).map(|i| points[(i + 1) % n] - points[i]).collect()
}

/// The turn of each edge. `None` where a closed line does not return to the turn with which it began.
fn turns(a: &[Point], b: &[Point], closed: bool) -> Option<Vec<f64>> {
    let n = a.len();
    let reach = ((n as f64 * WINDOW) as usize).max(1);
    let products: Vec<(Point, f64)> =
        a.iter().zip(b).map(|(p, q)| (Point::new(p.dot(*q), p.perp_dot(*q)), p.length() * q.length())).collect();
    let sums = Running::new(&products);
    let around = |i: usize| sums.around(i, reach.min((n - 1) / 2), closed);
    let mut turns = Vec::with_capacity(n);
    let mut last = 0.0f64;
    let mut first = None;
    for i in 0..n {
        let (sum, size) = around(i);
        if sum.length() > AGREEMENT * size && size > 0.0 {
            last = nearest_turn(sum.to_angle(), last);
            first.get_or_insert(last);
        }
        turns.push(last);
    }
    let first = first?;
    // Edges before the first one with a clear turn take its turn.
    turns.iter_mut().take_while(|turn| **turn == 0.0).for_each(|turn| *turn = first);
    if closed && (nearest_turn(turns[0], turns[n - 1]) - turns[0]).abs() > 1e-9 {
        return None;
    }
    let mean = turns.iter().sum::<f64>() / n as f64;
    let whole = std::f64::consts::TAU * (mean / std::f64::consts::TAU).round();
    turns.iter_mut().for_each(|turn| *turn -= whole);
    Some(turns)
}

/// Running sums, so that the sum of any window needs two look-ups.
struct Running(Vec<(Point, f64)>);

impl Running {
    fn new(values: &[(Point, f64)]) -> Self {
        let mut sums = vec![(Point::ZERO, 0.0)];
        for (point, length) in values {
            let (p, l) = sums[sums.len() - 1];
            sums.push((p + *point, l + length));
        }
        Self(sums)
    }

    fn between(&self, from: usize, to: usize) -> (Point, f64) {
        (self.0[to].0 - self.0[from].0, self.0[to].1 - self.0[from].1)
    }

    /// The sum of place `i` and `reach` places to each side. Where `closed`, the window wraps around.
    fn around(&self, i: usize, reach: usize, closed: bool) -> (Point, f64) {
        let n = self.0.len() - 1;
        let (low, high) = (i.saturating_sub(reach), (i + reach + 1).min(n));
        let mut sum = self.between(low, high);
        if closed {
            for (from, to) in [(n - reach.saturating_sub(i), n), (0, (i + reach + 1).saturating_sub(n))] {
                let more = self.between(from, to);
                sum = (sum.0 + more.0, sum.1 + more.1);
            }
        }
        sum
    }
}

/// The equivalent angle nearest to another one.
fn nearest_turn(angle: f64, to: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle + turn * ((to - angle) / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spiral(curl: f64) -> Vec<Point> {
        let mut place = Point::ZERO;
        let step = |k: usize| {
            place += Point::from_angle(curl * k as f64 / 60.0) * 2.0;
            place
        };
        (0..60).map(step).collect()
    }

    #[test]
    fn a_shape_that_curls_up_keeps_its_length() {
        let deform = Deform::new(&spiral(0.0), &spiral(7.0), false, true);
        for s in [0.25, 0.5, 0.75] {
            let points = deform.at(s);
            let length = rototoon_base::geometry::polyline::length(&points, false);
            assert!((length - 118.0).abs() < 0.5, "{s}: {length}");
            let (first, last) = (points[1] - points[0], points[59] - points[58]);
            let turned = 7.0 * s * 58.0 / 60.0;
            assert!((first.angle_to(last) - turned).sin().abs() < 0.06, "{s}");
        }
    }

    #[test]
    fn windows_wrap_around() {
        let values: Vec<(Point, f64)> = (0..7).map(|k| (Point::splat(f64::from(1 << k)), f64::from(1 << k))).collect();
        let sums = Running::new(&values);
        assert_eq!(sums.around(0, 2, true).1, 1.0 + 2.0 + 4.0 + 32.0 + 64.0);
        assert_eq!(sums.around(0, 2, false).1, 7.0);
        assert_eq!(sums.around(6, 1, true).1, 32.0 + 64.0 + 1.0);
        assert_eq!(sums.around(3, 3, true).1, 127.0);
    }

    #[test]
    fn a_changed_turning_number_moves_straight() {
        let at = |k: usize| std::f64::consts::TAU * k as f64 / 40.0;
        let circle: Vec<Point> = (0..40).map(|k| Point::from_angle(at(k)) * 10.0).collect();
        let eight: Vec<Point> = (0..40).map(|k| Point::new(at(k).sin(), (2.0 * at(k)).sin()) * 10.0).collect();
        let deform = Deform::new(&circle, &eight, true, true);
        assert_eq!(deform.turns, None);
        assert_eq!(deform.at(0.5)[7], circle[7].midpoint(eight[7]));
    }

    proptest! {
        #[test]
        fn both_ends_are_met(
            points in prop::collection::vec(((-9.0f64..9.0, -9.0f64..9.0), (-9.0f64..9.0, -9.0f64..9.0)), 0..20),
            closed in any::<bool>(),
            still in any::<bool>(),
        ) {
            let from: Vec<Point> = points.iter().map(|p| if still { Point::ONE } else { Point::from(p.0) }).collect();
            let to: Vec<Point> = points.iter().map(|p| Point::from(p.1)).collect();
            let deform = Deform::new(&from, &to, closed, true);
            for (s, expected) in [(0.0, &from), (1.0, &to)] {
                for (p, q) in deform.at(s).iter().zip(expected) {
                    prop_assert!(p.distance(*q) < 1e-9);
                }
            }
            prop_assert!(deform.at(0.4).iter().all(|p| p.is_finite()));
        }
    }
}
