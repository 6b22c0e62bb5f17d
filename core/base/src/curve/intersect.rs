//! The meetings of two parabola pieces (Yang et al. 1986, Appendix E).
//!
//! **Boxes first.** Pieces with separate boxes do not meet.
//!
//! **The quartic.** For X on the piece p0 + 2b v + a v², the cross products with a and b isolate v and v²:
//! a × (X − p0) = 2D v and b × (X − p0) = −D v², with D = a × b. So the parabola is the set of X with
//!
//! (a × (X − p0))² + 4 D (b × (X − p0)) = 0.
//!
//! If X is the point of the other piece, a quadratic in u, this is a quartic in u. Its roots are the crossings, and v
//! follows from the first equation. Newton's method on B₁(u) = B₂(v) polishes both. The more bent piece is the one made
//! implicit, because D is a divisor.
//!
//! **Degenerate cases.**
//! - Straight pieces (D is zero relative to the size): see [`super::straight`].
//! - Pieces of one parabola: the quartic vanishes. The shared stretch is reported as an overlap.
//! - Tangents: a double root, reported once. Curves closer than the rounding of the coefficients count as touching.
//!
//! Limits: two crossings closer together than about 1e-6 of the pieces' parameters may be reported as one.

use super::meeting::{MERGE, Meeting, SAME};
use super::straight::{line_and_parabola, lines};
use super::{Quadratic, Spline};
use crate::geometry::Point;
use crate::numeric::roots::roots_in;

/// A piece is straight if its control triangle's height is below this share of the pieces' size.
const STRAIGHT: f64 = 1e-9;

impl Quadratic {
    /// All meetings with another piece, in the order of this piece's parameter.
    pub fn intersect(&self, other: &Self) -> Vec<Meeting> {
        let (low, high) = self.control_box();
        let (other_low, other_high) = other.control_box();
        let size = (high.max(other_high) - low.min(other_low)).max_element();
        let gap = (low - other_high).max(other_low - high).max_element();
        if gap > SAME * size {
            return Vec::new();
        }
        // Computing relative to a nearby origin keeps precision far from the true one.
        let moved = |q: &Self| Self::new(q.p0 - low, q.p1 - low, q.p2 - low);
        let (mine, theirs) = (moved(self), moved(other));
        let mut found = match (mine.straight(size), theirs.straight(size)) {
            (true, true) => lines(&mine, &theirs, size),
            (false, true) => line_and_parabola(&theirs, &mine, size).into_iter().map(Meeting::swapped).collect(),
            (true, false) => line_and_parabola(&mine, &theirs, size),
            (false, false) if mine.flatness() > theirs.flatness() => {
                parabolas(&theirs, &mine, size).into_iter().map(Meeting::swapped).collect()
            }
            (false, false) => parabolas(&mine, &theirs, size),
        };
        found.sort_by(|a, b| a.start().total_cmp(&b.start()));
        merged(found)
    }

    /// Height of the control triangle over its longest side, in pixels.
    fn flatness(&self) -> f64 {
        let (a, b) = self.coefficients();
        let longest = self.p0.distance(self.p1).max(self.p1.distance(self.p2)).max(self.p0.distance(self.p2));
        if longest > 0.0 { a.perp_dot(b).abs() / longest } else { 0.0 }
    }

    fn straight(&self, size: f64) -> bool {
        self.flatness() <= STRAIGHT * size
    }
}

/// One of each group of meetings that are the same; points on an overlap are part of it.
fn merged(sorted: Vec<Meeting>) -> Vec<Meeting> {
    let overlaps: Vec<_> = sorted.iter().filter(|m| matches!(m, Meeting::Overlap { .. })).copied().collect();
    let mut kept: Vec<Meeting> = Vec::with_capacity(sorted.len());
    for meeting in sorted {
        if let Meeting::Point { first: u, second: v } = meeting {
            let near = |x: f64, y: f64| (x - y).abs() < MERGE;
            let within = |x: f64, (a, b): (f64, f64)| x > a.min(b) - MERGE && x < a.max(b) + MERGE;
            let repeated = kept
                .iter()
                .any(|k| matches!(*k, Meeting::Point { first, second } if near(first, u) && near(second, v)));
            let covered = overlaps
                .iter()
                .any(|o| matches!(*o, Meeting::Overlap { first, second } if within(u, first) && within(v, second)));
            if repeated || covered {
                continue;
            }
        }
        kept.push(meeting);
    }
    kept
}

/// The meetings of two bent pieces. The second one is made implicit.
fn parabolas(one: &Quadratic, two: &Quadratic, size: f64) -> Vec<Meeting> {
    let (a, b) = two.coefficients();
    let d = a.perp_dot(b);
    let (a1, b1) = one.coefficients();
    let c = one.p0 - two.p0;
    let along = [a.perp_dot(c), 2.0 * a.perp_dot(b1), a.perp_dot(a1)];
    let across = [b.perp_dot(c), 2.0 * b.perp_dot(b1), b.perp_dot(a1)];
    let mut quartic = [0.0; 5];
    for i in 0..3 {
        quartic[i] += 4.0 * d * across[i];
        for j in 0..3 {
            quartic[i + j] += along[i] * along[j];
        }
    }
    if let Some(overlap) = same_parabola(one, two, size) {
        return vec![overlap];
    }
    let at = |u: f64| (along[0] + u * (along[1] + u * along[2])) / (2.0 * d);
    let ends = [one.nearest(two.p0).parameter, one.nearest(two.p2).parameter, 0.0, 1.0];
    roots_in(&quartic, 0.0, 1.0)
        .iter()
        .map(|&u| (u, at(u)))
        // Ends that touch may miss the interval because of rounding.
        .chain(ends.map(|u| (u, at(u))))
        .filter_map(|(u, v)| accepted(one, two, (u, v), size))
        .collect()
}

/// The meeting near these parameters, if there is one.
fn accepted(one: &Quadratic, two: &Quadratic, (u, v): (f64, f64), size: f64) -> Option<Meeting> {
    let clamped = |(u, v): (f64, f64)| (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let miss = |(u, v): (f64, f64)| one.point(u).distance(two.point(v));
    let start = clamped((u, v));
    let polished = clamped(polish(one, two, start));
    let best = if miss(polished) <= miss(start) { polished } else { start };
    (miss(best) <= SAME * size).then_some(Meeting::Point { first: best.0, second: best.1 })
}

/// Newton's method on B₁(u) = B₂(v). It stops where the tangents become parallel.
fn polish(one: &Quadratic, two: &Quadratic, (mut u, mut v): (f64, f64)) -> (f64, f64) {
    for _ in 0..4 {
        let error = one.point(u) - two.point(v);
        let (s, t) = (one.derivative(u), two.derivative(v));
        let cross = s.perp_dot(t);
        if cross.abs() <= 1e-9 * s.length() * t.length() {
            break;
        }
        u -= error.perp_dot(t) / cross;
        v -= error.perp_dot(s) / cross;
        (u, v) = (u.clamp(-0.5, 1.5), v.clamp(-0.5, 1.5));
    }
    (u, v)
}

/// The shared stretch of two pieces of one parabola.
fn same_parabola(one: &Quadratic, two: &Quadratic, size: f64) -> Option<Meeting> {
    // Parameters on `one` of both ends of `two`, on the extended parabola. In between they are affine in v.
    let (a, b) = one.coefficients();
    let d = a.perp_dot(b);
    let on_one = |p: Point| a.perp_dot(p - one.p0) / (2.0 * d);
    let (start, end) = (on_one(two.p0), on_one(two.p2));
    // If five points of `two` are on the corresponding points of the other parabola, both parabolas are the same.
    let shared = |v: f64| {
        let u = start + (end - start) * v;
        one.point(u).distance(two.point(v)) <= SAME * size.max(one.point(u).length())
    };
    if ![0.0, 0.25, 0.5, 0.75, 1.0].into_iter().all(shared) {
        return None;
    }
    let (from, to) = (start.min(end).max(0.0), start.max(end).min(1.0));
    if to - from <= MERGE {
        return None;
    }
    let on_two = |u: f64| ((u - start) / (end - start)).clamp(0.0, 1.0);
    Some(Meeting::Overlap { first: (from, to), second: (on_two(from), on_two(to)) })
}

impl Spline {
    /// The meetings of this spline with another: the indices of both pieces, and how they meet. A meeting at a joint is
    /// reported for the pieces on both sides of it.
    pub fn intersect(&self, other: &Self) -> Vec<((usize, usize), Meeting)> {
        let theirs: Vec<_> = other.pieces().map(|piece| (piece, piece.bounds())).collect();
        let mut found = Vec::new();
        for (i, piece) in self.pieces().enumerate() {
            let (low, high) = piece.bounds();
            for (j, (second, (other_low, other_high))) in theirs.iter().enumerate() {
                if low.cmple(*other_high).all() && other_low.cmple(high).all() {
                    found.extend(piece.intersect(second).into_iter().map(|meeting| ((i, j), meeting)));
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::super::quadratic::tests::any_piece;
    use super::*;
    use proptest::prelude::*;

    fn piece(p: [(f64, f64); 3]) -> Quadratic {
        let [a, b, c] = p.map(Point::from);
        Quadratic::new(a, b, c)
    }

    fn points(found: &[Meeting]) -> Vec<(f64, f64)> {
        found
            .iter()
            .map(|m| match *m {
                Meeting::Point { first, second } => (first, second),
                Meeting::Overlap { .. } => panic!("{m:?}"),
            })
            .collect()
    }

    #[test]
    fn two_arches_cross_four_times() {
        let tall = piece([(-2.0, 4.0), (0.0, -4.0), (2.0, 4.0)]);
        let wide = piece([(-1.0, -2.0), (7.0, 1.5), (-1.0, 5.0)]);
        let found = points(&tall.intersect(&wide));
        for &(u, v) in &found {
            assert!(tall.point(u).distance(wide.point(v)) < 1e-12);
        }
        // y = x² against x = 3 − ((y − 1.5)/1.75)²: counted by hand, the left end hides two.
        assert_eq!(found.len(), crossings_by_chords(&tall, &wide, 2000));
        // The same arch on its side crosses all four times.
        let side = piece([(3.0, -3.0), (-5.0, 0.0), (3.0, 3.0)].map(|(x, y)| (x + 0.1, y)));
        let up = piece([(-3.0, 3.0), (0.0, -5.0), (3.0, 3.0)].map(|(x, y)| (x, y + 0.1)));
        assert_eq!(points(&side.intersect(&up)).len(), crossings_by_chords(&side, &up, 2000));
    }

    #[test]
    fn a_tangent_is_met_once() {
        let arch = piece([(-1.0, 1.0), (0.0, -1.0), (1.0, 1.0)]);
        let bowl = piece([(-1.0, -1.0), (0.0, 1.0), (1.0, -1.0)]);
        assert_eq!(points(&arch.intersect(&bowl)), [(0.5, 0.5)]);
        let line = piece([(-1.0, 0.0), (0.0, 0.0), (1.0, 0.0)]);
        assert_eq!(points(&arch.intersect(&line)), [(0.5, 0.5)]);
        assert_eq!(points(&line.intersect(&arch)), [(0.5, 0.5)]);
    }

    #[test]
    fn neighbours_of_a_spline_meet_at_their_joint() {
        let guides = [(0.0, 0.0), (8.0, 0.0), (9.0, 7.0), (1.0, 9.0), (-4.0, 3.0)].map(Point::from);
        let spline = Spline::new(guides.into(), true).unwrap();
        let found = points(&spline.piece(0).intersect(&spline.piece(1)));
        assert_eq!(found.len(), 1);
        assert!((found[0].0 - 1.0).abs() < 1e-9 && found[0].1.abs() < 1e-9);
    }

    #[test]
    fn pieces_of_one_parabola_overlap() {
        let whole = piece([(-2.0, 4.0), (0.0, -4.0), (2.0, 4.0)]);
        let (one, two) = (whole.part(0.0, 0.6), whole.part(0.8, 0.2));
        let found = one.intersect(&two);
        let [Meeting::Overlap { first, second }] = found[..] else { panic!("{found:?}") };
        assert!((first.0 - 0.2 / 0.6).abs() < 1e-9 && (first.1 - 1.0).abs() < 1e-9);
        assert!((second.0 - 1.0).abs() < 1e-9 && (second.1 - 0.2 / 0.6).abs() < 1e-9);
        // Parts that only share an end meet at a point.
        assert_eq!(points(&whole.part(0.0, 0.5).intersect(&whole.part(0.5, 1.0))).len(), 1);
        assert_eq!(whole.part(0.0, 0.4).intersect(&whole.part(0.5, 1.0)), []);
    }

    #[test]
    fn lines_cross_overlap_touch_and_miss() {
        let line = piece([(0.0, 0.0), (2.0, 0.0), (4.0, 0.0)]);
        assert_eq!(points(&line.intersect(&piece([(1.0, -1.0), (1.0, 0.0), (1.0, 1.0)]))), [(0.25, 0.5)]);
        assert_eq!(line.intersect(&piece([(0.0, 1.0), (2.0, 1.0), (4.0, 1.0)])), []);
        assert_eq!(line.intersect(&piece([(5.0, 0.0), (6.0, 0.0), (7.0, 0.0)])), []);
        assert_eq!(points(&line.intersect(&piece([(4.0, 0.0), (6.0, 0.0), (8.0, 0.0)]))), [(1.0, 0.0)]);
        let back = piece([(6.0, 0.0), (4.0, 0.0), (2.0, 0.0)]);
        assert_eq!(line.intersect(&back), [Meeting::Overlap { first: (0.5, 1.0), second: (1.0, 0.5) }]);
        // A corner's straight half is stored with a doubled control point.
        let stopping = piece([(0.0, -4.0), (2.0, 0.0), (2.0, 0.0)]);
        assert_eq!(points(&line.intersect(&stopping)).len(), 1);
    }

    #[test]
    fn points_meet_the_pieces_that_pass_through_them() {
        let dot = piece([(2.0, 0.0); 3]);
        let line = piece([(0.0, 0.0), (2.0, 0.0), (4.0, 0.0)]);
        assert_eq!(points(&line.intersect(&dot)), [(0.5, 0.0)]);
        assert_eq!(points(&dot.intersect(&dot)), [(0.0, 0.0)]);
        assert_eq!(dot.intersect(&piece([(0.0, 0.0), (2.0, 1.0), (4.0, 0.0)])), []);
    }

    #[test]
    fn a_folded_line_is_met_in_both_directions() {
        let folded = piece([(0.0, 0.0), (4.0, 0.0), (0.0, 0.0)]);
        let gate = piece([(1.0, -1.0), (1.0, 0.0), (1.0, 1.0)]);
        assert_eq!(points(&folded.intersect(&gate)).len(), 2);
        let found = folded.intersect(&piece([(0.0, 0.0), (2.0, 0.0), (4.0, 0.0)]));
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|m| matches!(m, Meeting::Overlap { .. })));
    }

    /// Naive reference: the chords of one against the chords of the other.
    fn crossings_by_chords(one: &Quadratic, two: &Quadratic, n: usize) -> usize {
        let chords = |q: &Quadratic| -> Vec<(Point, Point)> {
            (0..n).map(|i| (q.point(i as f64 / n as f64), q.point((i + 1) as f64 / n as f64))).collect()
        };
        let (mine, theirs) = (chords(one), chords(two));
        let side = |a: Point, b: Point, p: Point| (b - a).perp_dot(p - a) > 0.0;
        let cross = |(a, b): (Point, Point), (c, d): (Point, Point)| {
            side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
        };
        mine.iter().map(|&m| theirs.iter().filter(|&&t| cross(m, t)).count()).sum()
    }

    proptest! {
        #[test]
        fn meetings_are_those_of_the_chords(one in any_piece(), two in any_piece()) {
            let found = one.intersect(&two);
            // Pieces that bend by less than a share of their size count as straight.
            let ends = [one, two].map(|piece| piece.control_box());
            let size = (ends[0].1.max(ends[1].1) - ends[0].0.min(ends[1].0)).max_element();
            let most = 1e-7 + STRAIGHT * size;
            for meeting in &found {
                if let Meeting::Point { first, second } = *meeting {
                    prop_assert!((0.0..=1.0).contains(&first) && (0.0..=1.0).contains(&second));
                    prop_assert!(one.point(first).distance(two.point(second)) < most);
                }
            }
            // Chords are slightly off: for pairs that nearly touch, the count may differ by a pair of crossings, or by
            // one at an end.
            let coarse = crossings_by_chords(&one, &two, 150);
            let shaky = found.iter().any(|m| match *m {
                Meeting::Point { first: u, second: v } => {
                    let (s, t) = (one.direction(u), two.direction(v));
                    s.perp_dot(t).abs() < 0.05 || u.min(1.0 - u) < 0.02 || v.min(1.0 - v) < 0.02
                }
                Meeting::Overlap { .. } => true,
            });
            if coarse != found.len() && !shaky {
                prop_assert_eq!(found.len(), crossings_by_chords(&one, &two, 1500));
            }
        }

        #[test]
        fn a_common_point_is_found(one in any_piece(), two in any_piece(), u in 0.0f64..=1.0, v in 0.0f64..=1.0) {
            let shift = one.point(u) - two.point(v);
            let moved = Quadratic::new(two.p0 + shift, two.p1 + shift, two.p2 + shift);
            let found = one.intersect(&moved);
            let place = one.point(u);
            let hit = found.iter().any(|m| match *m {
                Meeting::Point { first, .. } => one.point(first).distance(place) < 1e-3,
                Meeting::Overlap { first, .. } => u >= first.0 - 1e-6 && u <= first.1 + 1e-6,
            });
            prop_assert!(hit, "{found:?}");
        }

        #[test]
        fn the_order_of_the_pieces_does_not_matter(one in any_piece(), two in any_piece()) {
            let (ab, ba) = (one.intersect(&two), two.intersect(&one));
            prop_assert_eq!(ab.len(), ba.len());
        }
    }
}
