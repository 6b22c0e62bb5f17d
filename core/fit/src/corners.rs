//! Corners, found by the turning angle over a stretch of arc length.
//!
//! **Where.** The direction before a point is that of the straight line that fits the points best within a reach of arc
//! length before it. The direction after it is found in the same way. A corner turns by at least [`LEAST_TURN`], turns more
//! than its surroundings, and turns suddenly: on a round bend, a wider reach sees proportionally more of the turn; at a
//! corner it sees hardly more. The reach comes from the grain of the line ([`super::grain`]) and from the spacing of its
//! points. Over the reach, the steps of a pixel staircase average out. It does not depend on the tolerance: the crest of a
//! wave is round, however large the tolerance is.
//!
//! **How large.** A tolerance as large as a corner makes the corner invisible. The size of a corner is half of its height
//! over the chord between its legs' ends: a straight line through the middle of a zigzag is that far from its tips. A leg
//! ends at the next corner, or where the line has turned back. The smallest corner is dropped first, which makes the
//! legs of its neighbours longer, until all that are left are larger than the tolerance. The order of dropping does not
//! depend on the tolerance. So the corners of a larger tolerance are among those of a smaller one.
//!
//! **Place.** The place of the corner is the intersection of both lines if that is near the point, because the point
//! itself is rounded. Otherwise it is the point. This applies to sharp tips, whose nearly parallel lines may meet anywhere.

use super::clean::Cleaned;
use super::grain::Grain;
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::nearest_on_segment;
use std::collections::BTreeSet;

/// Reach to each side, in standard deviations of the noise.
const REACH: f64 = 34.0;
/// Least reach, in mean steps between points.
const STEPS: f64 = 4.0;
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
/// The lines that meet in a corner's place have this length and leave out this stretch on each side of the tip, both as
/// multiples of the reach.
const LINE: f64 = 1.4;
const SKIP: f64 = 0.26;
/// Legs of this turn, as a share of [`LEAST_TURN`], still belong to the corner.
const STILL: f64 = 0.7;
/// Ratio of the leg lengths at which the height of a corner is measured.
const LONGER: f64 = std::f64::consts::SQRT_2;
/// Longest leg, as a share of the complete line.
const LEG: f64 = 0.25;

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

/// The corners of a line as given, larger than the tolerance, in order. Their indices are those of `data`, the same line
/// as it is fitted; `fine` is the same line with its gaps filled.
pub(super) fn corners(data: &Cleaned, fine: &Cleaned, closed: bool, grain: Grain, tolerance: f64) -> Vec<Corner> {
    let found = found(fine, closed, grain.noise, tolerance);
    let last = data.points.len() - 1;
    let index = |s: f64| {
        let after = data.lengths.partition_point(|&l| l < s).min(last);
        let before = after.saturating_sub(1);
        if s - data.lengths[before] < data.lengths[after] - s { before } else { after }
    };
    let mut all: Vec<Corner> =
        found.into_iter().map(|corner| Corner { index: index(fine.lengths[corner.index]), ..corner }).collect();
    all.dedup_by_key(|corner| corner.index);
    all
}

/// The corners of a line with even gaps.
fn found(fine: &Cleaned, closed: bool, noise: f64, tolerance: f64) -> Vec<Corner> {
    let Cleaned { points, lengths, total, .. } = fine;
    let (n, total) = (points.len(), *total);
    if n < 2 * LEAST_POINTS {
        return Vec::new();
    }
    let sums = Sums::new(points, lengths, total, closed);
    // The reach must contain a few points and must leave most of the curve outside.
    let reach = (REACH * noise).max(STEPS * total / n as f64).min(0.2 * total);
    let mut tips = sums.tips(reach);
    sums.drop_small(&mut tips, reach, tolerance);
    tips.into_iter().map(|tip| Corner { index: tip, place: sums.meeting(tip, reach, tolerance) }).collect()
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

    /// The indices of the points that are corners of any size.
    fn tips(&self, reach: f64) -> Vec<usize> {
        let n = self.points.len();
        let turns: Vec<f64> = (0..n).map(|j| self.turn(j, reach).abs()).collect();
        let wider = (WIDER * reach).min(0.3 * self.total);
        let is_corner = |&j: &usize| {
            turns[j] >= LEAST_TURN && self.is_peak(&turns, j, reach) && turns[j] >= SUDDEN * self.turn(j, wider).abs()
        };
        let mut tips: Vec<usize> = (0..n).filter(is_corner).map(|j| self.tip(j, reach)).collect();
        tips.sort_unstable();
        // Peaks with the same tip, or with tips that noise moved apart by a step, are one corner.
        tips.dedup_by(|next, kept| self.lengths[*next] - self.lengths[*kept] < TIP * reach);
        if let (true, [first, .., last]) = (self.closed, &tips[..])
            && self.lengths[*first] + self.total - self.lengths[*last] < TIP * reach
        {
            tips.pop();
        }
        tips
    }

    /// Drops the smallest tip until all are larger than the tolerance.
    fn drop_small(&self, tips: &mut Vec<usize>, reach: f64, tolerance: f64) {
        let count = tips.len();
        let mut around: Vec<[Option<usize>; 2]> = (0..count)
            .map(|k| match self.closed {
                true if count > 1 => [Some((k + count - 1) % count), Some((k + 1) % count)],
                true => [None; 2],
                false => [k.checked_sub(1), Some(k + 1).filter(|&k| k < count)],
            })
            .collect();
        let size = |k: usize, around: &[Option<usize>; 2]| {
            let legs = [0, 1].map(|side| self.leg(tips[k], around[side].map(|other| tips[other]), side));
            self.size(tips[k], legs, reach)
        };
        let mut sizes: Vec<f64> = (0..count).map(|k| size(k, &around[k])).collect();
        let mut order: BTreeSet<(u64, usize)> = (0..count).map(|k| (sizes[k].to_bits(), k)).collect();
        let mut kept = vec![true; count];
        while let Some(&(_, k)) = order.first()
            && sizes[k] <= tolerance
        {
            order.pop_first();
            kept[k] = false;
            let [before, after] = around[k];
            for (side, at, other) in [(1, before, after), (0, after, before)] {
                let Some(at) = at.filter(|&at| kept[at]) else { continue };
                around[at][side] = other.filter(|&other| other != at);
                order.remove(&(sizes[at].to_bits(), at));
                sizes[at] = size(at, &around[at]);
                order.insert((sizes[at].to_bits(), at));
            }
        }
        let mut left = kept.into_iter();
        tips.retain(|_| left.next().unwrap_or(false));
    }

    /// The length of a tip's leg to the tip before it (side 0) or after it (side 1), or to the end.
    fn leg(&self, tip: usize, other: Option<usize>, side: usize) -> f64 {
        let s = self.lengths[tip];
        let length = match (other, self.closed) {
            (Some(other), _) => {
                let apart = if side == 0 { s - self.lengths[other] } else { self.lengths[other] - s };
                if apart <= 0.0 { apart + self.total } else { apart }
            }
            (None, true) => self.total,
            (None, false) if side == 0 => s,
            (None, false) => self.total - s,
        };
        length.min(LEG * self.total)
    }

    /// Half of the height of a tip over the chord between its legs' ends, in pixels; the largest over leg lengths up to
    /// the given ones, as long as the legs turn.
    fn size(&self, tip: usize, legs: [f64; 2], reach: f64) -> f64 {
        let (p, s) = (self.points[tip], self.lengths[tip]);
        let (mut reached, mut height) = (reach, 0.0f64);
        loop {
            let [before, after] = legs.map(|leg| leg.min(reached));
            let (Some(arriving), Some(leaving)) = (self.line(s - before, s), self.line(s, s + after)) else { break };
            if arriving.direction.angle_to(leaving.direction).abs() < STILL * LEAST_TURN {
                break;
            }
            let (a, b) = (self.at(s - before), self.at(s + after));
            height = height.max(p.distance(nearest_on_segment(p, a, b)));
            if reached >= legs[0].max(legs[1]) {
                break;
            }
            reached *= LONGER;
        }
        0.5 * height
    }

    /// The place at an arc length, which may be beyond the ends of a closed curve.
    fn at(&self, s: f64) -> Point {
        let s = if self.closed { s.rem_euclid(self.total) } else { s };
        let n = self.points.len();
        let k = self.lengths.partition_point(|&l| l <= s).saturating_sub(1);
        let (next, end) =
            if k + 1 < n { (k + 1, self.lengths[k + 1]) } else { (if self.closed { 0 } else { k }, self.total) };
        let width = end - self.lengths[k];
        let share = if width > 0.0 { ((s - self.lengths[k]) / width).clamp(0.0, 1.0) } else { 0.0 };
        self.points[k].lerp(self.points[next], share)
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
        let (p, s, skip) = (self.points[j], self.lengths[j], SKIP * reach);
        let (from, to) = (s - skip - LINE * reach, s + skip + LINE * reach);
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
    use super::super::clean;
    use super::*;

    fn found(points: &[Point], closed: bool) -> Vec<Corner> {
        larger_than(1.0, points, closed)
    }

    fn larger_than(tolerance: f64, points: &[Point], closed: bool) -> Vec<Corner> {
        let (data, fine) = (clean::cleaned(points, closed, tolerance), clean::filled(points, closed));
        corners(&data, &fine, closed, Grain::of(points, &fine), tolerance)
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
