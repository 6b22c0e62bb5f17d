//! One cubic along a path between two points that are fixed.
//!
//! **How.** Samples of the path get parameters by arc length. The handles with the least squares of distances between samples and
//! cubic solve a linear system of at most four unknowns: two for a free handle, one for a handle along a line. Then each sample moves
//! to the parameter of the nearest point of the cubic by a step of Newton's method, and both are repeated (Schneider 1990). From the second
//! round on, distances along the cubic count little: a sample may slide along it (Wang et al. 2006). Without that the rounds creep. The
//! best of all rounds counts.
//!
//! **The error** is the greatest distance of a sample, or of the middle between two, from the point of the cubic with its parameter. Parameters
//! never fall, so this bounds the distance of the two lines in both directions. It is what callers compare with their tolerance.
//!
//! **Why a pull.** Along a nearly straight path the lengths of handles hardly change the distances. A weak pull toward a third of the path, where
//! even motion puts them, keeps them from jumping between frames.
//!
//! Sources: P. Schneider, "An algorithm for automatically fitting digitized curves", Graphics Gems, 1990; W. Wang, H. Pottmann and Y. Liu, "Fitting
//! B-spline curves to point clouds by curvature-based squared distance minimization", ACM Transactions on Graphics, 2006.

use glam::{DMat4, DVec4};
use rototoon_base::geometry::{Point, polyline};

/// A path that is this close to the line between its ends is straight, in pixels.
const STRAIGHT: f64 = 0.02;
/// Rounds of handles and parameters.
const ROUNDS: usize = 10;
/// Steps into which a path is divided beside those at its own points.
const STEPS: f64 = 32.0;
/// Least length of a step, in pixels.
const LEAST_STEP: f64 = 0.125;
/// Weight of the pull toward even handles, relative to the samples.
const PULL: f64 = 3e-4;
/// Weight of squares of distances along the cubic, relative to those across it.
const SLIDE: f64 = 0.02;

/// What is known of the handle at an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// Nothing.
    Free,
    /// Its direction, a unit vector into the path.
    Along(Point),
    /// That it is 0.
    Bare,
}

/// A cubic between two fixed points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fitted {
    /// The handles at both ends, relative to them.
    pub handles: [Point; 2],
    /// Bound of the distance from the path, in pixels.
    pub error: f64,
}

/// Whether a path is the line between its ends.
pub(super) fn is_straight(path: &[Point]) -> bool {
    let chord = [path[0], path[path.len() - 1]];
    path.iter().all(|p| polyline::distance(*p, &chord, false) <= STRAIGHT)
}

/// The cubic along a path. It is no more sought once it is much closer than `enough`. The path has at least one point.
pub(super) fn fit(path: &[Point], ends: [End; 2], enough: f64) -> Fitted {
    let samples = Samples::new(path);
    let chord = Fitted { handles: [Point::ZERO; 2], error: samples.off_chord() };
    if chord.error <= STRAIGHT {
        return chord;
    }
    let found = samples.fitted(ends, enough);
    if found.error <= enough || found.error <= chord.error { found } else { chord }
}

/// A path as points with weights, the lengths for which they stand.
struct Samples {
    points: Vec<Point>,
    weights: Vec<f64>,
    /// Arc length up to each point, as a share of the whole.
    shares: Vec<f64>,
    total: f64,
}

impl Samples {
    fn new(path: &[Point]) -> Self {
        let total = polyline::length(path, false);
        let step = (total / STEPS).max(LEAST_STEP);
        let mut points = vec![path[0]];
        let mut walked = vec![0.0];
        for (a, b) in polyline::segments(path, false) {
            let length = a.distance(b);
            let (count, before) = ((length / step).ceil() as usize, walked[walked.len() - 1]);
            for k in 1..=count {
                let share = k as f64 / count as f64;
                points.push(a.lerp(b, share));
                walked.push(before + share * length);
            }
        }
        let n = points.len();
        let weight = |k: usize| 0.5 * (walked[(k + 1).min(n - 1)] - walked[k.saturating_sub(1)]);
        let weights = (0..n).map(weight).collect();
        let shares = walked.iter().map(|at| if total > 0.0 { at / total } else { 0.0 }).collect();
        Self { points, weights, shares, total }
    }

    fn ends(&self) -> [Point; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }

    /// Greatest distance from the line between the ends.
    fn off_chord(&self) -> f64 {
        let chord = self.ends();
        self.points.iter().map(|p| polyline::distance(*p, &chord, false)).fold(0.0, f64::max)
    }

    fn fitted(&self, ends: [End; 2], enough: f64) -> Fitted {
        let mut best = Fitted { handles: [Point::ZERO; 2], error: f64::INFINITY };
        let mut shares = self.shares.clone();
        // The direction of the cubic at each sample; 0 where it is not known.
        let mut ways = vec![Point::ZERO; shares.len()];
        for _ in 0..ROUNDS {
            let handles = self.handles((&shares, &ways), ends);
            let cubic = Cubic::new(self.ends(), handles);
            let error = self.error(&cubic, &shares);
            if error < best.error {
                best = Fitted { handles, error };
            }
            if best.error <= 0.5 * enough {
                break;
            }
            self.nearer(&cubic, &mut shares);
            ways = shares.iter().map(|&t| cubic.slope(t).normalize_or_zero()).collect();
        }
        best
    }

    /// The handles with the least squares of distances. One that would point backward along its line is 0.
    fn handles(&self, feet: (&[f64], &[Point]), ends: [End; 2]) -> [Point; 2] {
        let (unknown, found) = self.solved(feet, ends);
        let mut handles = [Point::ZERO; 2];
        for (slot, value) in unknown.iter().zip(found.to_array()) {
            if let Some((side, direction)) = slot {
                handles[*side] += value * *direction;
            }
        }
        let backward = |side: usize| matches!(ends[side], End::Along(way) if handles[side].dot(way) < 0.0);
        if backward(0) || backward(1) {
            let kept = [0, 1].map(|side| if backward(side) { End::Bare } else { ends[side] });
            return self.handles(feet, kept);
        }
        handles.map(|handle| handle.clamp_length_max(self.total))
    }

    /// The unknowns, each with its end and its direction, and their values.
    fn solved(&self, (shares, ways): (&[f64], &[Point]), ends: [End; 2]) -> ([Option<(usize, Point)>; 4], DVec4) {
        let mut unknown = [None; 4];
        for (side, end) in ends.into_iter().enumerate() {
            match end {
                End::Free => {
                    (unknown[2 * side], unknown[2 * side + 1]) = (Some((side, Point::X)), Some((side, Point::Y)))
                }
                End::Along(way) => unknown[2 * side] = Some((side, way)),
                End::Bare => {}
            }
        }
        let [from, to] = self.ends();
        let (mut matrix, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
        let mut add = |weights: [f64; 2], wanted: Point, weight: f64, along: Point| {
            let times = |a: Point, b: Point| a.dot(b) - (1.0 - SLIDE) * a.dot(along) * b.dot(along);
            for (row, one) in unknown.iter().enumerate() {
                let Some((side, way)) = *one else { continue };
                let own = weight * weights[side];
                right[row] += own * times(way, wanted);
                for (column, other) in unknown.iter().enumerate() {
                    let Some((side, other)) = *other else { continue };
                    matrix[row][column] += own * weights[side] * times(way, other);
                }
            }
        };
        for (k, (p, &t)) in self.points.iter().zip(shares).enumerate() {
            let [a, b, c, d] = bernstein(t);
            add([b, c], *p - (a + b) * from - (c + d) * to, self.weights[k], ways[k]);
        }
        let pull = PULL * self.total;
        for (side, even) in self.even(ends).into_iter().enumerate() {
            add([[1.0, 0.0], [0.0, 1.0]][side], even, pull, Point::ZERO);
        }
        for (row, one) in unknown.iter().enumerate() {
            if one.is_none() {
                matrix[row][row] = 1.0;
            }
        }
        (unknown, DMat4::from_cols_array_2d(&matrix).inverse() * DVec4::from_array(right))
    }

    /// Handles as even motion has them, a third of the path long.
    fn even(&self, ends: [End; 2]) -> [Point; 2] {
        let third = |share: f64| self.points[self.shares.partition_point(|at| *at < share).min(self.points.len() - 1)];
        let [from, to] = self.ends();
        let own = [third(1.0 / 3.0) - from, third(2.0 / 3.0) - to];
        std::array::from_fn(|side| match ends[side] {
            End::Along(way) => way * (self.total / 3.0),
            _ => own[side],
        })
    }

    /// Moves parameters to the nearest points by one step each. They never fall.
    fn nearer(&self, cubic: &Cubic, shares: &mut [f64]) {
        let last = shares.len() - 1;
        let mut least = 0.0;
        for (t, p) in shares[..last].iter_mut().zip(&self.points).skip(1) {
            *t = cubic.nearer(*p, *t).clamp(least, 1.0);
            least = *t;
        }
    }

    fn error(&self, cubic: &Cubic, shares: &[f64]) -> f64 {
        let at = |p: Point, t: f64| cubic.at(t).distance_squared(p);
        let own = self.points.iter().zip(shares).map(|(p, &t)| at(*p, t));
        let between = self.points.windows(2).zip(shares.windows(2));
        let between = between.map(|(p, t)| at(p[0].midpoint(p[1]), 0.5 * (t[0] + t[1])));
        own.chain(between).fold(0.0, f64::max).sqrt()
    }
}

fn bernstein(t: f64) -> [f64; 4] {
    let u = 1.0 - t;
    [u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t]
}

/// A cubic by its four points.
struct Cubic([Point; 4]);

impl Cubic {
    fn new([from, to]: [Point; 2], [after, before]: [Point; 2]) -> Self {
        Self([from, from + after, to + before, to])
    }

    fn at(&self, t: f64) -> Point {
        bernstein(t).into_iter().zip(self.0).map(|(weight, p)| weight * p).sum()
    }

    fn slope(&self, t: f64) -> Point {
        let ([a, b, c, d], u) = (self.0, 1.0 - t);
        3.0 * (u * u * (b - a) + 2.0 * u * t * (c - b) + t * t * (d - c))
    }

    /// One step of Newton's method toward the parameter of the point nearest to `p`.
    fn nearer(&self, p: Point, t: f64) -> f64 {
        let ([a, b, c, d], u, first) = (self.0, 1.0 - t, self.slope(t));
        let second = 6.0 * (u * (c - 2.0 * b + a) + t * (d - 2.0 * c + b));
        let off = self.at(t) - p;
        let slope = first.length_squared() + off.dot(second);
        // Where the distance is bent the wrong way, the step of Gauss and Newton goes the right way.
        let slope = if slope > 0.0 { slope } else { first.length_squared() };
        if slope > f64::MIN_POSITIVE { t - off.dot(first) / slope } else { t }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(cubic: [Point; 4], count: usize) -> Vec<Point> {
        (0..=count).map(|k| Cubic(cubic).at(k as f64 / count as f64)).collect()
    }

    #[test]
    fn the_handles_of_a_drawn_cubic_are_found() {
        let cubic = [(0.0, 0.0), (6.0, 9.0), (22.0, 9.0), (30.0, 0.0)].map(Point::from);
        let found = fit(&drawn(cubic, 60), [End::Free; 2], 0.02);
        assert!(found.error < 0.1, "{found:?}");
        let way = Point::new(6.0, 9.0).normalize();
        let along = fit(&drawn(cubic, 60), [End::Along(way), End::Free], 0.02);
        assert!(along.error < 0.1 && along.handles[0].perp_dot(way).abs() < 1e-9, "{along:?}");
        assert!(along.handles[0].distance(Point::new(6.0, 9.0)) < 1.0, "{along:?}");
    }

    #[test]
    fn a_straight_path_has_no_handles() {
        let line: Vec<Point> = (0..9).map(|k| Point::new(f64::from(k * k), 2.0 * f64::from(k * k))).collect();
        assert_eq!(fit(&line, [End::Free; 2], 0.25).handles, [Point::ZERO; 2]);
        for still in [vec![Point::ONE], vec![Point::ONE; 4]] {
            assert_eq!(fit(&still, [End::Free; 2], 0.25), Fitted { handles: [Point::ZERO; 2], error: 0.0 });
        }
    }

    #[test]
    fn a_handle_along_a_line_never_points_backward() {
        let hook = drawn([(0.0, 0.0), (-8.0, 4.0), (10.0, 9.0), (14.0, 0.0)].map(Point::from), 40);
        let found = fit(&hook, [End::Along(Point::X), End::Bare], 0.1);
        assert!(found.handles[0].y == 0.0 && found.handles[0].x >= 0.0, "{found:?}");
        assert_eq!(found.handles[1], Point::ZERO);
    }
}
