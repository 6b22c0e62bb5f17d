//! Change from one shape to another, as rigid as possible along the line.
//!
//! Each edge between neighbouring points turns by an angle, and changes its length and direction in its own turned
//! frame. At share s it has turned by s times the angle. The angle is that of the best rotation of the edges around it.
//! It continues from edge to edge without jumps, so a line that curls up by half a turn or more curls all the way
//! (Sederberg et al. 1993 interpolate turning angles and lengths in a similar way). The edges are then added up. On a
//! closed line a gap remains; it is spread over the edges in proportion to their lengths, which is least squares. Both
//! end shapes are met exactly.
//!
//! **Tangles.** A limb that bends the other way turns its edges against each other, and the spread gap may push one side
//! of it through the other. So the shapes between are tried. If they cross themselves where neither end shape does, or
//! turn inside out, other changes are tried: turns over shorter stretches (a knee that swings through more than half a
//! turn turns the right way only if its own edges are seen), turns that are smoothed over longer ones, then one turn for the
//! complete line with straight movement in the turned frame, then straight movement. The first without a tangle is taken,
//! or else the one with the fewest crossings.
//!
//! Limits: a closed line whose turning number changes, such as a circle that becomes a figure eight, moves along
//! straight lines. A joint that swings through more than half a turn may be taken to swing the other way round, and then
//! every change that is tried may tangle.

use super::tangle;
use rototoon_base::geometry::{Point, polygon};

/// Number of edges on each side that decide an edge's turn, as a share of all edges: usually, and where the line would
/// tangle.
const WINDOW: f64 = 1.0 / 24.0;
const OTHERS: [f64; 8] = [1.0 / 96.0, 1.0 / 48.0, 1.0 / 16.0, 1.0 / 12.0, 1.0 / 8.0, 1.0 / 6.0, 1.0 / 4.0, 1.0 / 3.0];
/// Number of equal parts of the change between which the shapes are tried.
const TRIED: usize = 32;
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
        let with = |turns: Option<Vec<f64>>| {
            let back = |(turn, (a, b)): (f64, (&Point, &Point))| (turn, *a, Point::from_angle(-turn).rotate(*b));
            let turns = turns.map(|turns| turns.into_iter().zip(a.iter().zip(&b)).map(back).collect());
            Self { from: from.into(), to: to.into(), closed, turns }
        };
        if !rigid || from.len() < 3 {
            return with(None);
        }
        let usual = with(turns(&a, &b, closed, WINDOW));
        let given = Shape::of_keys(from, to, closed);
        let mut least = usual.tangles(&given);
        if least == 0 {
            return usual;
        }
        let others = OTHERS.into_iter().filter_map(|window| turns(&a, &b, closed, window)).map(Some);
        let mut best = usual;
        for turns in others.chain([one_turn(&a, &b), None]) {
            let next = with(turns);
            let tangles = next.tangles(&given);
            if tangles < least {
                (best, least) = (next, tangles);
            }
            if least == 0 {
                break;
            }
        }
        best
    }

    /// The number of places where the shapes between are tangled more than the keys.
    fn tangles(&self, given: &Shape) -> usize {
        let more = |k: usize| {
            let points = self.at(k as f64 / TRIED as f64);
            let shape = Shape::of(&points, self.closed);
            let inside_out = given.orientation != 0 && shape.orientation != given.orientation;
            shape.crossings.saturating_sub(given.crossings) + usize::from(inside_out)
        };
        (1..TRIED).map(more).sum()
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

/// How tangled a line is.
struct Shape {
    crossings: usize,
    /// The direction round its inside; 0 where that is not clear, or differs between the keys.
    orientation: i8,
}

impl Shape {
    fn of(points: &[Point], closed: bool) -> Self {
        let orientation = if closed { tangle::orientation(points) } else { 0 };
        Self { crossings: tangle::crossings(points, closed), orientation }
    }

    fn of_keys(from: &[Point], to: &[Point], closed: bool) -> Self {
        let (a, b) = (Self::of(from, closed), Self::of(to, closed));
        let orientation = if a.orientation == b.orientation { a.orientation } else { 0 };
        Self { crossings: a.crossings.max(b.crossings), orientation }
    }
}

/// The same turn for all edges: that of the best rotation of the complete line.
fn one_turn(a: &[Point], b: &[Point]) -> Option<Vec<f64>> {
    let sum: Point = a.iter().zip(b).map(|(p, q)| Point::new(p.dot(*q), p.perp_dot(*q))).sum();
    (sum != Point::ZERO).then(|| vec![sum.to_angle(); a.len()])
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
fn turns(a: &[Point], b: &[Point], closed: bool, window: f64) -> Option<Vec<f64>> {
    let n = a.len();
    let reach = ((n as f64 * window) as usize).max(1);
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

    /// The outline of a leg of two bones with a knee, `width` px wide.
    fn leg(hip: f64, knee: f64, width: f64) -> Vec<Point> {
        let at = |s: f64| {
            let (thigh, shin) = (Point::from_angle(hip), Point::from_angle(hip + knee));
            // The knee is round, so that the outline has no spikes.
            let bend = ((s - 45.0) / 10.0).clamp(0.0, 1.0);
            let straight = thigh * s.min(50.0) + shin * (s - 50.0).max(0.0);
            (straight, Point::from_angle(hip + knee * bend).perp())
        };
        let place = |k: i32, side: f64| at(2.0 * f64::from(k)).0 + at(2.0 * f64::from(k)).1 * (side * width * 0.5);
        (0..=50).map(|k| place(k, 1.0)).chain((0..=50).rev().map(|k| place(k, -1.0))).collect()
    }

    #[test]
    fn legs_that_bend_the_other_way_do_not_tangle() {
        let wide: &[f64] = &[6.0, 14.0, 20.0];
        for (hips, knees, widths) in [
            ((0.6, 1.9), (1.2, -1.2), wide),
            ((1.0, 2.2), (0.9, -1.9), wide),
            // A knee that is bent by 115° has no room for a wide leg: its outline crosses itself on the keys.
            ((0.3, 2.8), (2.0, -2.0), &wide[..1]),
        ] {
            for &width in widths {
                let (a, b) = (leg(hips.0, knees.0, width), leg(hips.1, knees.1, width));
                let deform = Deform::new(&a, &b, true, true);
                let most = tangle::crossings(&a, true).max(tangle::crossings(&b, true));
                for k in 1..32 {
                    let points = deform.at(f64::from(k) / 32.0);
                    assert!(tangle::crossings(&points, true) <= most, "{hips:?} {knees:?} {width}: {k}/32");
                    assert_eq!(
                        tangle::orientation(&points),
                        tangle::orientation(&a),
                        "{hips:?} {knees:?} {width}: {k}/32"
                    );
                }
            }
        }
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
