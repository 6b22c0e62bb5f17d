//! Bézier paths as contours.
//!
//! The contour of an animated path has the same number of points on every key. Each segment is cut into equal steps of
//! its parameter; its most curved key determines their number. With second differences of at most D between control
//! points the second derivative of a cubic is at most 6 D. Over a step h of the parameter the curve is at most h² ∕ 8
//! of that from its chord. So n steps stay within ¾ D ∕ n². A straight segment stays one step.

use rototoon_base::geometry::{Point, polyline};

/// Greatest distance between a contour and its path, in pixels.
const TOLERANCE: f64 = 0.1;
/// A segment whose handles are closer than this to its chord is straight, in pixels.
const STRAIGHT: f64 = 1e-3;
/// Greatest number of points of one segment.
const MOST_STEPS: f64 = 200.0;

/// A path of cubic segments.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Its start.
    pub start: Point,
    /// Two handles and the end of each segment. The last segment of a closed path leads back to the start.
    pub segments: Vec<[Point; 3]>,
    /// Whether it is closed.
    pub closed: bool,
}

impl Path {
    /// A path without segments.
    pub fn new(start: Point) -> Self {
        Self { start, segments: Vec::new(), closed: false }
    }

    /// Its end.
    pub fn end(&self) -> Point {
        self.segments.last().map_or(self.start, |segment| segment[2])
    }

    /// Adds a straight segment to a point.
    pub fn line(&mut self, to: Point) {
        let from = self.end();
        self.segments.push([from.lerp(to, 1.0 / 3.0), from.lerp(to, 2.0 / 3.0), to]);
    }

    /// Adds a cubic segment to a point.
    pub fn cubic(&mut self, first: Point, second: Point, to: Point) {
        self.segments.push([first, second, to]);
    }

    /// Adds a straight segment to the start and closes the path.
    pub fn close(&mut self) {
        self.line(self.start);
        self.closed = true;
    }

    /// The path through knots: a point, the handle after it, the handle before it.
    ///
    /// # Panics
    ///
    /// If there is no knot.
    pub fn through(knots: &[[Point; 3]], closed: bool) -> Self {
        let mut path = Self::new(knots[0][0]);
        for pair in knots.windows(2) {
            path.cubic(pair[0][1], pair[1][2], pair[1][0]);
        }
        if let (true, [first, .., last]) = (closed, knots) {
            path.cubic(last[1], first[2], first[0]);
        }
        path.closed = closed;
        path
    }

    /// A uniform cubic B-spline. The ends of an open one count three times, so the curve reaches them.
    ///
    /// # Panics
    ///
    /// If there is no guide.
    pub fn spline(guides: &[Point], closed: bool) -> Self {
        let mut guides = guides.to_vec();
        if !closed {
            let (first, last) = (guides[0], guides[guides.len() - 1]);
            guides.splice(0..0, [first, first]);
            guides.extend([last, last]);
        }
        let n = guides.len();
        let knot = |k: usize| {
            let (before, own, after) = (guides[(k + n - 1) % n], guides[k], guides[(k + 1) % n]);
            let (on, back) = (own.lerp(after, 1.0 / 3.0), own.lerp(before, 1.0 / 3.0));
            [on.midpoint(back), on, back]
        };
        let inner = if closed { 0..n } else { 1..n - 1 };
        Self::through(&inner.map(knot).collect::<Vec<_>>(), closed)
    }

    /// All its points, to change them.
    pub fn points_mut(&mut self) -> impl Iterator<Item = &mut Point> {
        std::iter::once(&mut self.start).chain(self.segments.iter_mut().flatten())
    }

    /// All its points.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        std::iter::once(self.start).chain(self.segments.iter().flatten().copied())
    }

    /// Moves its points a share of the way to those of another path.
    pub fn go(&mut self, to: &Self, share: f64) {
        self.start = self.start.lerp(to.start, share);
        let segments = self.segments.iter_mut().flatten().zip(to.segments.iter().flatten());
        segments.for_each(|(own, to)| *own = own.lerp(*to, share));
    }

    /// Points among which are those that are farthest along each axis: its ends, and where the curves turn back along x or y.
    pub fn extremes(&self) -> impl Iterator<Item = Point> + '_ {
        let turns = |cubic: [Point; 4]| {
            let [x, y] = [cubic.map(|p| p.x), cubic.map(|p| p.y)].map(turns);
            x.into_iter().chain(y).flatten().map(move |t| at(&cubic, t)).chain([cubic[3]])
        };
        std::iter::once(self.start).chain(self.cubics().flat_map(turns))
    }

    fn cubics(&self) -> impl Iterator<Item = [Point; 4]> + '_ {
        let mut from = self.start;
        self.segments.iter().map(move |&[first, second, to]| [std::mem::replace(&mut from, to), first, second, to])
    }
}

/// Why keys of a path have no contours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoContours<E> {
    /// The keys differ in their number of segments or in being closed.
    Unequal,
    /// The caller refused the number of points.
    Refused(E),
}

/// The contours of the keys of a path. `allowed` gets the number of points of all contours together before they are
/// made.
///
/// # Errors
///
/// [`NoContours`].
pub fn contours<E>(
    keys: &[Path],
    allowed: impl FnOnce(usize) -> Result<(), E>,
) -> Result<Vec<Vec<Point>>, NoContours<E>> {
    let Some(first) = keys.first() else { return Err(NoContours::Unequal) };
    let mut count = first.segments.len();
    if keys.iter().any(|key| key.segments.len() != count || key.closed != first.closed) {
        return Err(NoContours::Unequal);
    }
    // A drawing program may end a closed path at its start before it closes it.
    let returns = |key: &Path| key.cubics().last().is_some_and(|[from, .., to]| from.distance(to) < STRAIGHT);
    if first.closed && count > 1 && keys.iter().all(returns) {
        count -= 1;
    }
    let mut most = vec![1; count];
    for key in keys {
        most.iter_mut().zip(key.cubics()).for_each(|(most, cubic)| *most = steps(cubic).max(*most));
    }
    let steps = most;
    let points = steps.iter().sum::<usize>() + 1;
    allowed(points.saturating_mul(keys.len())).map_err(NoContours::Refused)?;
    let contour = |key: &Path| {
        let mut points = Vec::new();
        for (cubic, &steps) in key.cubics().zip(&steps) {
            points.extend((0..steps).map(|k| at(&cubic, k as f64 / steps as f64)));
        }
        if !first.closed || count == 0 {
            points.push(key.end());
        }
        points
    };
    Ok(keys.iter().map(contour).collect())
}

/// The number of steps that a cubic needs.
fn steps(cubic: [Point; 4]) -> usize {
    let [a, b, c, d] = cubic;
    let off = |p: Point| polyline::nearest_on_segment(p, a, d).distance(p);
    if off(b) < STRAIGHT && off(c) < STRAIGHT {
        return 1;
    }
    let bend = (a - 2.0 * b + c).length().max((b - 2.0 * c + d).length());
    (0.75 * bend / TOLERANCE).sqrt().ceil().clamp(1.0, MOST_STEPS) as usize
}

/// The parameters at which a cubic of one coordinate turns back.
fn turns([a, b, c, d]: [f64; 4]) -> [Option<f64>; 2] {
    let (square, middle, constant) = (d - 3.0 * c + 3.0 * b - a, c - 2.0 * b + a, b - a);
    // Zeros of square t² + 2 middle t + constant, without the difference of nearly equal numbers.
    let root = (middle * middle - square * constant).max(0.0).sqrt();
    let sum = -(middle + root.copysign(middle));
    [sum / square, constant / sum].map(|t| (t > 0.0 && t < 1.0).then_some(t))
}

fn at([a, b, c, d]: &[Point; 4], t: f64) -> Point {
    let u = 1.0 - t;
    u * u * u * *a + 3.0 * u * u * t * *b + 3.0 * u * t * t * *c + t * t * t * *d
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    fn made(keys: &[Path]) -> Result<Vec<Vec<Point>>, NoContours<usize>> {
        contours(keys, |_| Ok(()))
    }

    #[test]
    fn the_number_of_points_is_asked_before_they_are_made() {
        let mut path = Path::new(p(0.0, 0.0));
        path.cubic(p(0.0, 1e7), p(1e7, 1e7), p(1e7, 0.0));
        assert_eq!(contours(&[path.clone(), path], Err), Err(NoContours::Refused(402)));
    }

    #[test]
    fn straight_paths_keep_their_points() {
        let mut path = Path::new(p(1.0, 1.0));
        path.line(p(9.0, 1.0));
        path.line(p(9.0, 7.0));
        assert_eq!(made(&[path.clone()]).unwrap(), [[p(1.0, 1.0), p(9.0, 1.0), p(9.0, 7.0)]]);
        path.close();
        assert_eq!(made(&[path.clone()]).unwrap()[0].len(), 3);
        // Handles at their points, as in Silhouette, also make straight sides.
        path.segments[0] = [path.start, p(9.0, 1.0), p(9.0, 1.0)];
        assert_eq!(made(&[path.clone()]).unwrap()[0].len(), 3);
        let mut twice = Path::new(p(1.0, 1.0));
        for to in [p(9.0, 1.0), p(9.0, 7.0), p(1.0, 1.0)] {
            twice.line(to);
        }
        twice.close();
        assert_eq!(made(&[twice]).unwrap()[0].len(), 3);
    }

    #[test]
    fn curves_are_followed_with_the_same_points_on_every_key() {
        const ROUND: f64 = 0.552_284_75;
        let quarter = |radius: f64| {
            let mut path = Path::new(p(radius, 0.0));
            path.cubic(p(radius, radius * ROUND), p(radius * ROUND, radius), p(0.0, radius));
            path
        };
        let found = made(&[quarter(3.0), quarter(80.0)]).unwrap();
        assert_eq!(found[0].len(), found[1].len());
        for pair in found[1].windows(2) {
            let middle = pair[0].midpoint(pair[1]).length();
            assert!(80.0 - middle < TOLERANCE && middle < 80.1, "{middle}");
        }
        assert!(found[1].len() < 40, "{}", found[1].len());
    }

    #[test]
    fn the_extremes_of_a_path_are_where_its_curves_turn_back() {
        let mut path = Path::new(p(0.0, 0.0));
        path.cubic(p(0.0, 40.0), p(30.0, 40.0), p(30.0, 0.0));
        path.cubic(p(20.0, -7.0), p(50.0, -9.0), p(31.0, 2.0));
        path.line(p(31.0, 5.0));
        let ends: Vec<Point> = path.extremes().collect();
        for axis in [Point::X, Point::Y, -Point::X, -Point::Y] {
            let most = ends.iter().map(|end| end.dot(axis)).fold(f64::NEG_INFINITY, f64::max);
            let dense = path.cubics().flat_map(|cubic| (0..=10_000).map(move |k| at(&cubic, f64::from(k) * 1e-4)));
            let expected = dense.map(|p| p.dot(axis)).fold(f64::NEG_INFINITY, f64::max);
            assert!((most - expected).abs() < 1e-6, "{axis}: {most} {expected}");
        }
    }

    #[test]
    fn keys_that_are_built_differently_are_refused() {
        let mut longer = Path::new(Point::ZERO);
        longer.line(Point::ONE);
        assert_eq!(made(&[Path::new(Point::ZERO), longer]), Err(NoContours::Unequal));
        assert_eq!(made(&[Path::new(Point::ONE)]).unwrap(), [[Point::ONE]]);
    }
}
