//! Outlines: smooth curves through control points, with corners and a varying ink width.
//!
//! The curve is the centripetal Catmull–Rom spline (Barry & Goldman 1988, "A recursive evaluation algorithm for a class
//! of Catmull–Rom splines"). It passes through every control point, so the control points are exact truth for points of the
//! drawn line. The centripetal parameter prevents loops between unevenly spaced points. At a corner the spline is cut: each
//! side continues with a mirrored neighbour.

use rototoon::geometry::Point;

/// Number of samples of one segment between neighbouring control points. The polyline stays within 0.05 px of the curve.
const SAMPLES: usize = 10;

/// A contour: its control points in order, which of them are corners, and the ink's width at each.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Control points in pixels of the picture.
    pub points: Vec<Point>,
    /// Whether the line turns sharply at each control point.
    pub corners: Vec<bool>,
    /// Width of the ink in pixels at each control point; 0 for no line.
    pub ink: Vec<f64>,
    /// Whether the last control point joins the first.
    pub closed: bool,
}

/// A point of the dense line and the ink's width there, both in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Position.
    pub at: Point,
    /// Width of the ink.
    pub ink: f64,
}

impl Outline {
    /// A closed outline without corners or ink.
    pub fn closed(points: Vec<Point>) -> Self {
        let n = points.len();
        Self { points, corners: vec![false; n], ink: vec![0.0; n], closed: true }
    }

    /// An open outline without corners or ink.
    pub fn open(points: Vec<Point>) -> Self {
        Self { closed: false, ..Self::closed(points) }
    }

    /// Makes the control points of these indices corners.
    pub fn with_corners(mut self, corners: &[usize]) -> Self {
        for &i in corners {
            self.corners[i] = true;
        }
        self
    }

    /// The dense line. Samples 0, 10, 20, … are the control points. A closed line does not repeat its first point.
    pub fn dense(&self) -> Vec<Sample> {
        let n = self.points.len();
        let segments = if self.closed { n } else { n - 1 };
        let mut line: Vec<Sample> = (0..segments).flat_map(|i| self.segment(i)).collect();
        if !self.closed {
            line.push(Sample { at: self.points[n - 1], ink: self.ink[n - 1] });
        }
        line
    }

    /// The dense line without the ink.
    pub fn line(&self) -> Vec<Point> {
        self.dense().iter().map(|s| s.at).collect()
    }

    fn segment(&self, i: usize) -> Vec<Sample> {
        let n = self.points.len();
        let j = (i + 1) % n;
        let (p1, p2) = (self.points[i], self.points[j]);
        let cut_before = self.corners[i] || (!self.closed && i == 0);
        let cut_after = self.corners[j] || (!self.closed && j == n - 1);
        let p0 = if cut_before { 2.0 * p1 - p2 } else { self.points[(i + n - 1) % n] };
        let p3 = if cut_after { 2.0 * p2 - p1 } else { self.points[(j + 1) % n] };
        (0..SAMPLES)
            .map(|k| {
                let t = k as f64 / SAMPLES as f64;
                Sample { at: catmull_rom([p0, p1, p2, p3], t), ink: self.ink[i] + t * (self.ink[j] - self.ink[i]) }
            })
            .collect()
    }
}

/// The centripetal Catmull–Rom spline between the second and the third point, `t` from 0 to 1.
fn catmull_rom([p0, p1, p2, p3]: [Point; 4], t: f64) -> Point {
    let knot = |from: f64, a: Point, b: Point| from + a.distance(b).sqrt().max(1e-6);
    let t0 = 0.0;
    let t1 = knot(t0, p0, p1);
    let t2 = knot(t1, p1, p2);
    let t3 = knot(t2, p2, p3);
    let t = t1 + t * (t2 - t1);
    let mix = |a: Point, b: Point, from: f64, to: f64| ((to - t) * a + (t - from) * b) / (to - from);
    let (a1, a2, a3) = (mix(p0, p1, t0, t1), mix(p1, p2, t1, t2), mix(p2, p3, t2, t3));
    let (b1, b2) = (mix(a1, a2, t0, t2), mix(a2, a3, t1, t3));
    mix(b1, b2, t1, t2)
}

/// The boundary of a limb or ribbon: a strip of half-width `radius(t)` around a quadratic Bézier curve. The curve goes from
/// the first to the last joint and is pulled towards the middle joint. `caps` are the lengths of the round ends.
///
/// The boundary has `2 * sides + 2` control points: the left side (seen along the strip) from start to end, the end's cap,
/// the right side back, the start's cap.
pub fn strip(joints: [Point; 3], sides: usize, caps: [f64; 2], radius: impl Fn(f64) -> f64) -> Vec<Point> {
    let [a, b, c] = joints;
    let control = b + 0.45 * (b - (a + c) / 2.0);
    let at = |t: f64| (1.0 - t) * (1.0 - t) * a + 2.0 * t * (1.0 - t) * control + t * t * c;
    let along = |t: f64| (2.0 * (1.0 - t) * (control - a) + 2.0 * t * (c - control)).normalize_or_zero();
    let side = |i: usize, sign: f64| {
        let t = i as f64 / (sides - 1) as f64;
        at(t) - sign * radius(t) * along(t).perp()
    };
    let mut points: Vec<Point> = (0..sides).map(|i| side(i, 1.0)).collect();
    points.push(c + caps[1] * along(1.0));
    points.extend((0..sides).rev().map(|i| side(i, -1.0)));
    points.push(a - caps[0] * along(0.0));
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_passes_through_its_control_points() {
        let points = vec![Point::new(0.0, 0.0), Point::new(40.0, 3.0), Point::new(50.0, 30.0), Point::new(2.0, 20.0)];
        let line = Outline::closed(points.clone()).with_corners(&[1]).line();
        assert_eq!(line.len(), 4 * SAMPLES);
        for (i, p) in points.iter().enumerate() {
            assert!(line[i * SAMPLES].distance(*p) < 1e-9);
        }
    }

    #[test]
    fn an_open_line_ends_at_its_last_point() {
        let points = vec![Point::new(0.0, 0.0), Point::new(10.0, 5.0), Point::new(20.0, 0.0)];
        let line = Outline::open(points.clone()).line();
        assert_eq!(line.len(), 2 * SAMPLES + 1);
        assert_eq!(line[2 * SAMPLES], points[2]);
    }

    #[test]
    fn a_straight_strip_has_its_width() {
        let joints = [Point::ZERO, Point::new(50.0, 0.0), Point::new(100.0, 0.0)];
        let points = strip(joints, 3, [0.0, 4.0], |_| 10.0);
        let expected = [
            (0.0, -10.0),
            (50.0, -10.0),
            (100.0, -10.0),
            (104.0, 0.0),
            (100.0, 10.0),
            (50.0, 10.0),
            (0.0, 10.0),
            (0.0, 0.0),
        ];
        for (p, (x, y)) in points.iter().zip(expected) {
            assert!(p.distance(Point::new(x, y)) < 1e-9, "{p} is not ({x}, {y})");
        }
    }
}
