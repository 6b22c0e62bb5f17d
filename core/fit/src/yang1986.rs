//! The two-step fitting procedure of Yang et al. 1986. Both steps get half of the tolerance, ε₁ = ε₂ = ε/2.
//!
//! **Step 1, parabolas** ([`arcs`]). From each knot, a parabola with the slopes of the knots is tried up to the third
//! point and farther, as long as no point is farther from it than ε₁. The last good one is kept. The slope at a point
//! is the mean of the slopes to its neighbours (eq. 8). At a corner, where the turn exceeds a threshold, each side has
//! its own slope.
//!
//! **Step 2, guiding points** ([`guides`]). The first guiding points are the intersections of the tangents of
//! neighbouring knots, one for each parabola. As long as the spline misses a parabola by more than ε₂, the parabola
//! with the largest miss gets one more guiding point. A parabola with n guiding points has them at the intersections of
//! n + 1 tangents at even parameter steps (eq. D.1). On a Bézier parabola these are its blossom values at neighbouring
//! parameters. Corners get double guiding points.
//!
//! **Differences from the print.** Slopes are infinite on vertical tangents, so directions are used, and the mean of
//! two slopes is the bisector. The tangents at the ends of an S-shaped stretch meet behind a knot or nowhere. No
//! parabola with these tangents stays between the knots, so the stretch ends earlier. If even the shortest stretch has
//! no parabola, the middle of its chord is the guiding point, which gives a straight line. The discrepancies printed in
//! the paper's Table 2 could not be reproduced. The procedure and its result could (see the test).
//!
//! **Guarantee.** The paper guarantees ε for the points only, and so does step 1 here. The returned error is measured
//! as for all fits. It may exceed the tolerance between points or at the straight legs of corners. Then the shares of ε
//! are halved and both steps run again. If six halvings do not help, the default method takes over. This happens on a
//! staircase of pixels, where the slopes of neighbours make every step a corner.

use super::clean::Cleaned;
use super::corners::Corner;
use super::whole::Whole;
use rototoon_base::curve::{PieceTree, Quadratic, Spline};
use rototoon_base::geometry::Point;
use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

/// Smallest turn of a corner: 60°. (The paper leaves the threshold to the user.)
const CORNER: f64 = std::f64::consts::FRAC_PI_3;
/// Number of intervals on each parabola between the points at which the spline's distance is measured.
const SAMPLES: usize = 32;
/// Farthest point, counted from the start, up to which a first parabola is tried ("starting at the third data point").
const TRIED: usize = 4;
/// Largest number of guiding points of a parabola.
const MOST: usize = 64;
/// Number of parabolas on each side of a parabola that are assembled with it. The pieces around its guiding points and
/// their neighbours take two guiding points beyond them, and the third parabola keeps the ends of the chain away.
const NEARBY: usize = 3;
/// Number of times that the shares of the tolerance may be halved.
const STRICTER: usize = 6;

/// A knot between parabolas: its place, and the directions in which the curve arrives and leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// Position, in pixels.
    pub place: Point,
    /// Direction of arrival, of any length but zero.
    pub arrival: Point,
    /// Direction of departure; equal to the arrival except at a corner.
    pub departure: Point,
}

impl Knot {
    /// A knot with one direction.
    pub fn smooth(place: Point, direction: Point) -> Self {
        Self { place, arrival: direction, departure: direction }
    }

    fn is_corner(&self) -> bool {
        self.arrival != self.departure
    }
}

/// The parabola between two knots. Its guiding point is the intersection of their tangents. If the tangents do not meet
/// ahead of the first knot and behind the second, it is a straight line.
pub fn parabola(from: &Knot, to: &Knot) -> Quadratic {
    let middle = meeting(from, to).unwrap_or(0.5 * (from.place + to.place));
    Quadratic::new(from.place, middle, to.place)
}

/// The intersection of the tangents of two knots, if it is ahead of the first and behind the second.
fn meeting(from: &Knot, to: &Knot) -> Option<Point> {
    let (a, b, chord) = (from.departure, to.arrival, to.place - from.place);
    let cross = a.perp_dot(b);
    let (ahead, behind) = (chord.perp_dot(b) / cross, a.perp_dot(chord) / cross);
    // Almost parallel tangents meet too far away for a stretch of a drawn line.
    let far = 1e3 * chord.length();
    let place = from.place + a * ahead;
    (ahead > 0.0 && behind > 0.0 && place.distance(from.place) < far).then_some(place)
}

/// The `n` guiding points of a parabola: its blossom at neighbouring ones of n + 1 even parameters.
fn guides_of(arc: &Quadratic, n: usize) -> impl Iterator<Item = Point> + '_ {
    (0..n).map(move |i| {
        let (s, t) = (i as f64 / n as f64, (i + 1) as f64 / n as f64);
        arc.p0 * ((1.0 - s) * (1.0 - t)) + arc.p1 * (s * (1.0 - t) + t * (1.0 - s)) + arc.p2 * (s * t)
    })
}

/// Step 2, for parabolas that follow each other. `corners[i]` says whether parabola `i` starts at a corner (ignored at
/// the start of an open curve). `tolerance` is ε₂ in pixels. Returns the spline, the number of guiding points of each
/// parabola, and the number of iterations.
pub fn guides(arcs: &[Quadratic], corners: &[bool], closed: bool, tolerance: f64) -> (Spline, Vec<usize>, usize) {
    let n = arcs.len();
    let mut growing = Growing { arcs, corners, closed, counts: vec![1; n] };
    let mut missed: Vec<f64> = (0..n).map(|i| growing.missed(i)).collect();
    let mut queue: BinaryHeap<Miss> = (0..n).map(|arc| Miss { by: missed[arc], arc }).collect();
    let mut iterations = 1;
    while let Some(Miss { by, arc }) = queue.pop() {
        if by <= tolerance {
            break;
        }
        // A miss that a later one replaced stays in the queue.
        if by != missed[arc] || growing.counts[arc] == MOST {
            continue;
        }
        growing.counts[arc] += 1;
        iterations += 1;
        // One more guiding point moves the joints with the neighbours, and nothing beyond them.
        let touched = BTreeSet::from([(arc + n - 1) % n, arc, (arc + 1) % n]);
        for i in touched {
            missed[i] = growing.missed(i);
            queue.push(Miss { by: missed[i], arc: i });
        }
    }
    let (spline, _) = assembled(arcs, corners, closed, &growing.counts);
    (spline, growing.counts, iterations)
}

/// How far the spline misses a parabola. The queue gives the largest miss first, and of equal ones the first parabola.
#[derive(Clone, Copy, Debug)]
struct Miss {
    by: f64,
    arc: usize,
}

impl Ord for Miss {
    fn cmp(&self, other: &Self) -> Ordering {
        self.by.total_cmp(&other.by).then(other.arc.cmp(&self.arc))
    }
}

impl PartialOrd for Miss {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Miss {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Miss {}

/// Parabolas whose numbers of guiding points grow.
struct Growing<'a> {
    arcs: &'a [Quadratic],
    corners: &'a [bool],
    closed: bool,
    counts: Vec<usize>,
}

impl Growing<'_> {
    /// How far the spline misses parabola `i`. The spline around it depends on the parabolas nearby only, so only
    /// those are assembled.
    fn missed(&self, i: usize) -> f64 {
        let n = self.arcs.len();
        if n <= 2 * NEARBY + 1 {
            let (spline, starts) = assembled(self.arcs, self.corners, self.closed, &self.counts);
            return discrepancy(&self.arcs[i], &spline, starts[i], self.counts[i]);
        }
        let (first, end) = if self.closed {
            (i + n - NEARBY, i + n + NEARBY + 1)
        } else {
            (i.saturating_sub(NEARBY), (i + NEARBY + 1).min(n))
        };
        let place = if self.closed { NEARBY } else { i - first };
        let nearby = || (first..end).map(|k| k % n);
        let arcs: Vec<Quadratic> = nearby().map(|k| self.arcs[k]).collect();
        let corners: Vec<bool> = nearby().map(|k| self.corners[k]).collect();
        let counts: Vec<usize> = nearby().map(|k| self.counts[k]).collect();
        let (spline, starts) = assembled(&arcs, &corners, false, &counts);
        discrepancy(&self.arcs[i], &spline, starts[place], self.counts[i])
    }
}

/// The spline, and for each parabola the index of the piece around its first guiding point.
fn assembled(arcs: &[Quadratic], corners: &[bool], closed: bool, counts: &[usize]) -> (Spline, Vec<usize>) {
    let mut guides = Vec::new();
    let mut starts = Vec::with_capacity(arcs.len());
    if !closed {
        guides.push(arcs[0].p0);
    }
    for (i, arc) in arcs.iter().enumerate() {
        if corners[i] && (closed || i > 0) {
            guides.extend([arc.p0; 2]);
        }
        starts.push(guides.len() - usize::from(!closed));
        guides.extend(guides_of(arc, counts[i]));
    }
    if !closed {
        guides.push(arcs[arcs.len() - 1].p2);
    }
    (Spline::of_finite(guides, closed), starts)
}

/// Largest distance of a parabola's points from the pieces around its own guiding points and their neighbours.
fn discrepancy(arc: &Quadratic, spline: &Spline, start: usize, count: usize) -> f64 {
    let pieces = spline.piece_count();
    let around = |k: isize| {
        let k = start as isize + k;
        let k = if spline.is_closed() { k.rem_euclid(pieces as isize) } else { k.clamp(0, pieces as isize - 1) };
        k as usize
    };
    let near: Vec<Quadratic> = (-1..=count as isize).map(|k| spline.piece(around(k))).collect();
    let distance = |p: Point| near.iter().map(|piece| piece.nearest(p).distance).fold(f64::INFINITY, f64::min);
    (0..=SAMPLES).map(|k| distance(arc.point(k as f64 / SAMPLES as f64))).fold(0.0, f64::max)
}

/// Step 1: the parabolas along points, and for each parabola whether it starts at a corner. `tolerance` is ε₁ in
/// pixels.
pub fn arcs(points: &[Point], closed: bool, tolerance: f64) -> (Vec<Quadratic>, Vec<bool>) {
    let n = points.len();
    let line: Vec<Point> = if closed { points.iter().chain([&points[0]]).copied().collect() } else { points.to_vec() };
    let knots: Vec<Knot> = (0..line.len()).map(|i| knot(points, i % n, closed, i == line.len() - 1)).collect();
    // For each point the first corner from it on.
    let mut next_corner = vec![line.len(); line.len() + 1];
    for k in (0..line.len()).rev() {
        next_corner[k] = if knots[k].is_corner() { k } else { next_corner[k + 1] };
    }
    let (mut arcs, mut corners, mut start) = (Vec::new(), Vec::new(), 0);
    while start + 1 < line.len() {
        let fits = |end: usize| {
            let arc = parabola(&knots[start], &knots[end]);
            let curved = end == start + 1
                || meeting(&knots[start], &knots[end]).is_some()
                || is_straight(&line[start..=end], tolerance);
            curved && line[start + 1..end].iter().all(|&p| arc.nearest(p).distance < tolerance)
        };
        let corner = next_corner[start + 1];
        let (mut end, mut step) = (start + 1, 1);
        while end < corner.min(line.len() - 1) {
            // Long stretches grow by a sixteenth at a time, because each test of them takes long.
            let next = (end + step).min(corner).min(line.len() - 1);
            // The shortest parabola may fail where a longer one, past a step of the pixels, succeeds.
            if !fits(next) && end > start + 1 {
                break;
            }
            if fits(next) {
                end = next;
            } else {
                let longer = (next + 1..=(start + TRIED).min(corner).min(line.len() - 1)).find(|&k| fits(k));
                let Some(longer) = longer else { break };
                end = longer;
            }
            step = ((end - start) / 16).max(1);
        }
        arcs.push(parabola(&knots[start], &knots[end]));
        corners.push(knots[start].is_corner());
        start = end;
    }
    (arcs, corners)
}

fn is_straight(points: &[Point], tolerance: f64) -> bool {
    let chord = points[points.len() - 1] - points[0];
    points.iter().all(|&p| chord.perp_dot(p - points[0]).abs() < tolerance * chord.length())
}

/// The knot at a point, from its neighbours (eq. 8 and 9).
fn knot(points: &[Point], i: usize, closed: bool, last: bool) -> Knot {
    let n = points.len();
    let (has_before, has_after) = (closed || i > 0, closed || i + 1 < n);
    let before = if has_before { (points[i] - points[(i + n - 1) % n]).normalize_or_zero() } else { Point::ZERO };
    let after = if has_after { (points[(i + 1) % n] - points[i]).normalize_or_zero() } else { Point::ZERO };
    let mean = before + after;
    let corner = has_before && has_after && before.angle_to(after).abs() > CORNER;
    debug_assert!(closed || !last || i + 1 == n);
    if corner || mean.length_squared() < 1e-12 {
        return Knot { place: points[i], arrival: before, departure: after };
    }
    Knot::smooth(points[i], mean)
}

/// Both steps, repeated with smaller shares of the tolerance until the measured error keeps it.
pub(super) fn fit(data: &Cleaned, closed: bool, tolerance: f64) -> Whole {
    let mut share = 0.5 * tolerance;
    let mut best: Option<Whole> = None;
    for _ in 0..=STRICTER {
        let (arcs, corners) = arcs(&data.points, closed, share);
        let (spline, ..) = guides(&arcs, &corners, closed, share);
        let tree = PieceTree::new(&spline);
        let parameters: Vec<f64> = data.points.iter().map(|&p| tree.nearest(p).parameter).collect();
        let whole = Whole::of(spline, data, &parameters);
        if best.as_ref().is_none_or(|old| whole.error < old.error) {
            best = Some(whole);
        }
        if best.as_ref().is_some_and(|found| found.error <= tolerance) {
            break;
        }
        share *= 0.5;
    }
    match best {
        Some(whole) if whole.error <= tolerance => whole,
        _ => super::whole::fit(data, closed, &[] as &[Corner], tolerance),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 1 of the paper with its signs restored: knots and slopes.
    const TABLE_1: [(f64, f64, f64); 11] = [
        (9.50, 8.90, -0.649),
        (10.1, 6.50, 0.300),
        (8.50, 3.70, -5.000),
        (6.85, 2.10, -0.500),
        (5.50, 5.50, 8.500),
        (4.10, 6.20, 0.152),
        (1.90, 7.30, 1.467),
        (1.85, 8.70, -1.640),
        (4.20, 10.1, -0.411),
        (5.60, 11.2, 6.438),
        (8.10, 11.3, -8.000),
    ];

    /// Parabola i of the paper (i from 1) runs from knot i − 1 to knot i.
    fn table() -> Vec<Quadratic> {
        let knot = |k: usize| {
            let (x, y, slope) = TABLE_1[k % 11];
            (Point::new(x, y), Point::new(1.0, slope))
        };
        (0..11)
            .map(|i| {
                let ((p, d), (q, e)) = (knot(i + 10), knot(i));
                let ahead = (q - p).perp_dot(e) / d.perp_dot(e);
                Quadratic::new(p, p + d * ahead, q)
            })
            .collect()
    }

    fn near(a: Point, x: f64, y: f64) -> bool {
        // The paper prints two decimals of values computed from rounded slopes.
        (a.x - x).abs() < 0.02 && (a.y - y).abs() < 0.04
    }

    #[test]
    fn the_first_guiding_points_are_those_of_table_1() {
        // As printed, except for lost signs and for G(2): its second coordinate is 7.2 there and 7.0 in Table 2.
        let printed =
            [(8.30, 9.60), (12.0, 7.0), (8.0, 6.0), (9.0, 1.0), (5.0, 3.0), (5.4, 6.4), (0.8, 5.7), (2.3, 7.9)];
        let rest = [(-0.2, 12.0), (5.4, 9.7), (7.0, 20.0)];
        for (arc, (x, y)) in table().iter().zip(printed.into_iter().chain(rest)) {
            assert!(arc.p1.distance(Point::new(x, y)) < 0.3, "{:?} {x} {y}", arc.p1);
        }
    }

    #[test]
    fn the_example_ends_at_the_eighth_iteration_with_eighteen_guiding_points() {
        let (spline, counts, iterations) = guides(&table(), &[false; 11], true, 0.2);
        assert_eq!((iterations, spline.guides().len()), (8, 18));
        let of = |i: usize| {
            let at = counts[..i - 1].iter().sum::<usize>();
            &spline.guides()[at..at + counts[i - 1]]
        };
        // Table 3, and the new points of the second iteration.
        assert!(near(of(9)[0], 0.89, 10.28) && near(of(7)[0], 2.45, 5.95), "{:?} {:?}", of(9), of(7));
        assert!(of(11)[0].distance(Point::new(6.296, 15.681)) < 1e-3, "{:?}", of(11));
    }

    #[test]
    fn the_first_iteration_misses_parabola_ten_most() {
        let (arcs, ones) = (table(), [1; 11]);
        let (spline, starts) = assembled(&arcs, &[false; 11], true, &ones);
        let missed: Vec<f64> = (0..11).map(|i| discrepancy(&arcs[i], &spline, starts[i], 1)).collect();
        let worst = (0..11).max_by(|&a, &b| missed[a].total_cmp(&missed[b])).unwrap();
        assert_eq!(worst, 9);
        assert!((missed[worst] - 0.957).abs() < 2e-3, "{missed:?}");
    }

    #[test]
    fn smooth_lines_and_corners_are_fitted_within_the_tolerance() {
        let outline: Vec<Point> = (0..400)
            .map(|i| {
                let t = i as f64 / 400.0 * std::f64::consts::TAU;
                let radius = 60.0 + 12.0 * (3.0 * t).cos();
                Point::from_angle(t) * radius + 100.0
            })
            .collect();
        let square: Vec<Point> = (0..160)
            .map(|i| match (i / 40, (i % 40) as f64) {
                (0, x) => Point::new(x, 0.0),
                (1, x) => Point::new(40.0, x),
                (2, x) => Point::new(40.0 - x, 40.0),
                (_, x) => Point::new(0.0, 40.0 - x),
            })
            .collect();
        for (points, closed) in [(&outline, true), (&outline, false), (&square, true)] {
            let options = super::super::Options { tolerance: 2.0, preset: super::super::Preset::Yang1986 };
            let fitted = super::super::fit(points, closed, &options).unwrap();
            let count = fitted.spline.guides().len();
            assert!(fitted.max_error <= 2.0 && count < points.len() / 8, "{} {count}", fitted.max_error);
        }
    }

    /// Step 2 with the complete spline in each iteration.
    fn guides_naive(arcs: &[Quadratic], corners: &[bool], closed: bool, tolerance: f64) -> (Vec<usize>, usize) {
        let n = arcs.len();
        let (mut counts, mut iterations) = (vec![1; n], 1);
        let miss = |counts: &[usize], i: usize| {
            let (spline, starts) = assembled(arcs, corners, closed, counts);
            discrepancy(&arcs[i], &spline, starts[i], counts[i])
        };
        let mut missed: Vec<f64> = (0..n).map(|i| miss(&counts, i)).collect();
        loop {
            let open = (0..n).filter(|&i| counts[i] < MOST);
            let Some(worst) = open.max_by(|&a, &b| missed[a].total_cmp(&missed[b]).then(b.cmp(&a))) else { break };
            if missed[worst] <= tolerance {
                break;
            }
            counts[worst] += 1;
            iterations += 1;
            for i in [(worst + n - 1) % n, worst, (worst + 1) % n] {
                missed[i] = miss(&counts, i);
            }
        }
        (counts, iterations)
    }

    #[test]
    fn parts_of_the_spline_say_what_the_complete_one_says() {
        let wave: Vec<Point> = (0..240)
            .map(|i| Point::new(f64::from(i), 30.0 * (0.23 * f64::from(i)).sin() + f64::from(i * 7 % 5)))
            .collect();
        for (points, closed) in [(&wave[..], false), (&wave[..], true), (&wave[..40], true), (&wave[..9], false)] {
            let (arcs, corners) = arcs(points, closed, 2.0);
            for tolerance in [1.0, 0.2, 0.01] {
                let (_, counts, iterations) = guides(&arcs, &corners, closed, tolerance);
                assert_eq!((counts, iterations), guides_naive(&arcs, &corners, closed, tolerance));
            }
        }
    }

    #[test]
    fn guiding_points_of_a_parabola_make_it_again() {
        let arc = table()[8];
        let chain: Vec<Point> = guides_of(&arc, 5).collect();
        // Inner midpoints are on the parabola at even parameters, and the pieces between them are its parts.
        for i in 1..5 {
            let joint = 0.5 * (chain[i - 1] + chain[i]);
            assert!(joint.distance(arc.point(i as f64 / 5.0)) < 1e-12);
        }
    }
}
