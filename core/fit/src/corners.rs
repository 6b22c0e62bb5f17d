//! Corners, found by the turning angle over a stretch of arc length.
//!
//! The direction before a point is that of the straight line that fits the points best within a reach of arc length
//! before it. The direction after it is found in the same way. Over the reach, the steps of a pixel staircase average
//! out; the directions between neighbouring points would be multiples of 45°. A corner turns by at least
//! [`LEAST_TURN`], turns more than its surroundings, and turns suddenly: on a round bend, a wider reach sees
//! proportionally more of the turn; at a corner it sees hardly more.
//!
//! The place of the corner is the intersection of both lines if that is near the point, because the point itself is
//! rounded. Otherwise it is the point. This applies to sharp tips, whose nearly parallel lines may meet anywhere.

use rototoon_base::geometry::Point;

/// Reach to each side, in tolerances.
const REACH: f64 = 8.0;
/// Smallest number of points on a side.
const LEAST_POINTS: usize = 3;
/// Smallest turn of a corner in radians: 40°.
const LEAST_TURN: f64 = 0.7;
/// A wider reach, as a multiple of the reach, and the share of its turn that the reach must see. (Half the reach would
/// see mainly noise.)
const WIDER: f64 = 1.75;
const SUDDEN: f64 = 0.76;
/// The intersection of the lines counts within this many tolerances of the point.
const NEAR: f64 = 0.8;
/// The tip is searched within this share of the reach.
const TIP: f64 = 0.6;
/// Stretch on each side of the tip that its lines leave out, in tolerances.
const SKIP: f64 = 1.5;

/// A corner of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// Index of its point.
    pub index: usize,
    /// Place of the corner, in pixels.
    pub place: Point,
}

/// Points with running sums, so that a line through any stretch needs constant time.
struct Sums<'a> {
    points: &'a [Point],
    lengths: &'a [f64],
    total: f64,
    closed: bool,
    /// Sums over the points before each index of x, y, xx, xy, yy relative to the first point.
    sums: Vec<[f64; 5]>,
}

/// A straight line through points: their mean, and the unit direction in the order of the points.
#[derive(Clone, Copy)]
struct Line {
    center: Point,
    direction: Point,
}

/// The corners in order. `lengths` are the arc lengths of the points, `total` is that of the complete line.
pub(super) fn corners(points: &[Point], lengths: &[f64], total: f64, closed: bool, tolerance: f64) -> Vec<Corner> {
    let n = points.len();
    if n < 2 * LEAST_POINTS {
        return Vec::new();
    }
    let sums = Sums::new(points, lengths, total, closed);
    // The reach must contain a few points and must leave most of the curve outside.
    let spacing = total / n as f64;
    let reach = (REACH * tolerance).max(4.0 * spacing).min(0.2 * total);
    let turns: Vec<f64> = (0..n).map(|j| sums.turn(j, reach).abs()).collect();
    let mut found = Vec::new();
    for j in 0..n {
        if turns[j] < LEAST_TURN || !sums.is_peak(&turns, j, reach) {
            continue;
        }
        if turns[j] >= SUDDEN * sums.turn(j, (WIDER * reach).min(0.3 * total)).abs() {
            let tip = sums.tip(j, reach);
            found.push(Corner { index: tip, place: sums.meeting(tip, reach, tolerance) });
        }
    }
    found.sort_by_key(|corner| corner.index);
    // Peaks with the same tip, or with tips that noise moved apart by a step, are one corner.
    found.dedup_by(|next, kept| lengths[next.index] - lengths[kept.index] < TIP * reach);
    if let (true, [first, .., last]) = (closed, &found[..])
        && lengths[first.index] + total - lengths[last.index] < TIP * reach
    {
        found.pop();
    }
    found
}

impl<'a> Sums<'a> {
    fn new(points: &'a [Point], lengths: &'a [f64], total: f64, closed: bool) -> Self {
        let mut sums = Vec::with_capacity(points.len() + 1);
        let mut sum = [0.0; 5];
        sums.push(sum);
        for &p in points {
            let q = p - points[0];
            for (to, value) in sum.iter_mut().zip([q.x, q.y, q.x * q.x, q.x * q.y, q.y * q.y]) {
                *to += value;
            }
            sums.push(sum);
        }
        Self { points, lengths, total, closed, sums }
    }

    /// The line through the points at arc lengths `from ..= to`, which may be beyond the ends of a closed curve.
    fn line(&self, from: f64, to: f64) -> Option<Line> {
        let n = self.points.len();
        let turn = if !self.closed { 0.0 } else { (0.5 * (from + to) / self.total).floor() * self.total };
        let (from, to) = (from - turn, to - turn);
        let first = |s: f64| self.lengths.partition_point(|&l| l < s);
        let past = |s: f64| self.lengths.partition_point(|&l| l <= s);
        let range = |a: usize, b: usize| -> [f64; 5] { std::array::from_fn(|k| self.sums[b][k] - self.sums[a][k]) };
        let (count, sum, ends) = if from < 0.0 && self.closed {
            let (a, b) = (first(from + self.total), past(to));
            let (x, y) = (range(a, n), range(0, b));
            (n - a + b, std::array::from_fn(|k| x[k] + y[k]), (a % n, (b + n - 1) % n))
        } else if to > self.total && self.closed {
            let (a, b) = (first(from), past(to - self.total));
            let (x, y) = (range(a, n), range(0, b));
            (n - a + b, std::array::from_fn(|k| x[k] + y[k]), (a % n, (b + n - 1) % n))
        } else {
            let (a, b) = (first(from), past(to));
            if b < a + LEAST_POINTS {
                return None;
            }
            (b - a, range(a, b), (a, b - 1))
        };
        if count < LEAST_POINTS {
            return None;
        }
        let m = count as f64;
        let mean = Point::new(sum[0] / m, sum[1] / m);
        let (xx, xy, yy) = (sum[2] / m - mean.x * mean.x, sum[3] / m - mean.x * mean.y, sum[4] / m - mean.y * mean.y);
        let direction = Point::from_angle(0.5 * (2.0 * xy).atan2(xx - yy));
        let along = self.points[ends.1] - self.points[ends.0];
        let direction = if direction.dot(along) < 0.0 { -direction } else { direction };
        Some(Line { center: self.points[0] + mean, direction })
    }

    fn sides(&self, j: usize, reach: f64) -> Option<(Line, Line)> {
        let s = self.lengths[j];
        if !self.closed && (s < reach || s > self.total - reach) {
            return None;
        }
        Some((self.line(s - reach, s)?, self.line(s, s + reach)?))
    }

    fn turn(&self, j: usize, reach: f64) -> f64 {
        self.sides(j, reach).map_or(0.0, |(before, after)| before.direction.angle_to(after.direction))
    }

    /// Whether no point within the reach turns more. Among equal turns the first counts.
    fn is_peak(&self, turns: &[f64], j: usize, reach: f64) -> bool {
        self.around(j, reach).all(|k| turns[k] < turns[j] || (turns[k] == turns[j] && k >= j))
    }

    /// Indices of the points within a reach of `j`, the nearest first on each side.
    fn around(&self, j: usize, reach: f64) -> impl Iterator<Item = usize> + '_ {
        let n = self.points.len();
        let apart = move |k: usize| {
            let apart = (self.lengths[k] - self.lengths[j]).abs();
            if self.closed { apart.min(self.total - apart) } else { apart }
        };
        let near = move |k: &usize| apart(*k) <= reach;
        let back = (1..n).map(move |d| (j + n - d) % n).take_while(move |&k| self.closed || k < j).take_while(near);
        let forth = (1..n).map(move |d| (j + d) % n).take_while(move |&k| self.closed || k > j).take_while(near);
        std::iter::once(j).chain(back).chain(forth)
    }

    /// The point near `j` that sticks out most. The turn is nearly the same at a few points, but the tip is unique.
    fn tip(&self, j: usize, reach: f64) -> usize {
        let Some((before, after)) = self.sides(j, reach) else { return j };
        let chord = after.center - before.center;
        let height = |k: usize| chord.perp_dot(self.points[k] - before.center).abs();
        // Among equal heights the nearest to `j` wins.
        self.around(j, TIP * reach).fold(j, |best, k| if height(k) > height(best) { k } else { best })
    }

    fn meeting(&self, j: usize, reach: f64, tolerance: f64) -> Point {
        let (p, s, skip) = (self.points[j], self.lengths[j], SKIP * tolerance);
        let (from, to) = (s - skip - reach, s + skip + reach);
        if !self.closed && (from < 0.0 || to > self.total) {
            return p;
        }
        let (Some(before), Some(after)) = (self.line(from, s - skip), self.line(s + skip, to)) else { return p };
        let cross = before.direction.perp_dot(after.direction);
        let along = (after.center - before.center).perp_dot(after.direction) / cross;
        let place = before.center + before.direction * along;
        if place.is_finite() && place.distance(p) <= NEAR * tolerance { place } else { p }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths(points: &[Point], closed: bool) -> (Vec<f64>, f64) {
        let mut sum = 0.0;
        let mut all = vec![0.0];
        for pair in points.windows(2) {
            sum += pair[0].distance(pair[1]);
            all.push(sum);
        }
        let closing = points[0].distance(points[points.len() - 1]);
        (all, if closed { sum + closing } else { sum })
    }

    fn found(points: &[Point], closed: bool) -> Vec<Corner> {
        let (lengths, total) = lengths(points, closed);
        corners(points, &lengths, total, closed, 1.0)
    }

    /// The centres of the pixels along a dense outline.
    fn staircase(at: impl Fn(f64) -> Point) -> Vec<Point> {
        let mut points: Vec<Point> = (0..20_000).map(|i| at(i as f64 / 20_000.0).floor() + 0.5).collect();
        points.dedup();
        points
    }

    #[test]
    fn a_round_staircase_has_no_corner() {
        for radius in [25.0, 60.0, 200.0] {
            let circle = staircase(|t| Point::from_angle(t * std::f64::consts::TAU) * radius + 250.0);
            assert_eq!(found(&circle, true), [], "radius {radius}");
        }
    }

    #[test]
    fn a_tilted_square_has_four_corners_near_the_true_ones() {
        let turn = Point::from_angle(0.4);
        let tip = |k: usize| turn.rotate(Point::from_angle(k as f64 * std::f64::consts::FRAC_PI_2) * 80.0) + 100.0;
        let square = staircase(|t| {
            let k = (t * 4.0) as usize;
            tip(k).lerp(tip(k + 1), t * 4.0 - k as f64)
        });
        let corners = found(&square, true);
        assert_eq!(corners.len(), 4);
        for corner in corners {
            let off = (0..4).map(|k| tip(k).distance(corner.place)).fold(f64::INFINITY, f64::min);
            assert!(off < 1.2, "{off}");
        }
    }

    #[test]
    fn an_open_bend_has_its_corner_and_its_ends_have_none() {
        let points: Vec<Point> = (0..=60)
            .map(|i| if i <= 30 { Point::new(i as f64, 0.0) } else { Point::new(30.0, (i - 30) as f64) })
            .collect();
        let corners = found(&points, false);
        assert_eq!(corners.len(), 1);
        assert_eq!((corners[0].index, corners[0].place), (30, Point::new(30.0, 0.0)));
    }
}
