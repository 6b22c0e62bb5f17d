//! A piece of a parabola as a quadratic Bézier curve.
//!
//! B(u) = (1−u)² p0 + 2u(1−u) p1 + u² p2 = p0 + 2b u + a u², with b = p1 − p0 and a = p0 − 2p1 + p2. Then
//! B′ = 2(b + a u) and B″ = 2a. The vector a is the direction of the parabola's axis. |a × b| is twice the area of the
//! control triangle and vanishes where the piece is straight.
//!
//! **Box.** A coordinate is extreme at an end or where its derivative vanishes, at u = −b/a.
//! **Area.** ½∫ B × B′ du is the integral of a polynomial. The area between the piece and its chord is two thirds of
//! the control triangle (Archimedes).

use crate::geometry::Point;

/// A quadratic Bézier piece, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic {
    /// Start.
    pub p0: Point,
    /// Middle control point: the intersection of the tangents at both ends.
    pub p1: Point,
    /// End.
    pub p2: Point,
}

impl Quadratic {
    /// The piece with these three control points.
    pub const fn new(p0: Point, p1: Point, p2: Point) -> Self {
        Self { p0, p1, p2 }
    }

    /// The coefficients a, b of B(u) = p0 + 2b u + a u².
    pub fn coefficients(&self) -> (Point, Point) {
        ((self.p0 - self.p1) + (self.p2 - self.p1), self.p1 - self.p0)
    }

    /// The point at parameter `u`, 0 at the start and 1 at the end; exact at both.
    pub fn point(&self, u: f64) -> Point {
        let v = 1.0 - u;
        self.p0 * (v * v) + self.p1 * (2.0 * u * v) + self.p2 * (u * u)
    }

    /// Derivative with respect to the parameter.
    pub fn derivative(&self, u: f64) -> Point {
        ((self.p1 - self.p0) * (1.0 - u) + (self.p2 - self.p1) * u) * 2.0
    }

    /// Second derivative with respect to the parameter; it is constant.
    pub fn second_derivative(&self) -> Point {
        self.coefficients().0 * 2.0
    }

    /// Unit direction of travel at `u`. Where the speed is zero (at a corner), it is the direction of arrival or
    /// departure. It is zero for a piece that is a point.
    pub fn direction(&self, u: f64) -> Point {
        let here = self.derivative(u).normalize_or_zero();
        if here != Point::ZERO {
            return here;
        }
        let towards = if u > 0.5 { -self.second_derivative() } else { self.second_derivative() };
        towards.normalize_or_zero()
    }

    /// Signed curvature in 1/px, positive where the piece turns from x towards y. It is infinite or not a number where
    /// the speed is zero.
    pub fn curvature(&self, u: f64) -> f64 {
        let first = self.derivative(u);
        first.perp_dot(self.second_derivative()) / first.length().powi(3)
    }

    /// The part between two parameters as a piece; it is reversed where `to` is less than `from`.
    pub fn part(&self, from: f64, to: f64) -> Self {
        let middle = self.p0 * ((1.0 - from) * (1.0 - to))
            + self.p1 * (from * (1.0 - to) + to * (1.0 - from))
            + self.p2 * (from * to);
        Self::new(self.point(from), middle, self.point(to))
    }

    /// The parts before and after `u`.
    pub fn split(&self, u: f64) -> (Self, Self) {
        let (left, right) = (self.p0.lerp(self.p1, u), self.p1.lerp(self.p2, u));
        let middle = left.lerp(right, u);
        (Self::new(self.p0, left, middle), Self::new(middle, right, self.p2))
    }

    /// The same piece in the opposite direction.
    pub fn reversed(&self) -> Self {
        Self::new(self.p2, self.p1, self.p0)
    }

    /// Smallest and largest coordinates of the control points: a box that contains the piece.
    pub fn control_box(&self) -> (Point, Point) {
        (self.p0.min(self.p1).min(self.p2), self.p0.max(self.p1).max(self.p2))
    }

    /// Smallest and largest coordinates of the piece itself.
    pub fn bounds(&self) -> (Point, Point) {
        let (a, b) = self.coefficients();
        let (mut low, mut high) = (self.p0.min(self.p2), self.p0.max(self.p2));
        for axis in 0..2 {
            let u = -b[axis] / a[axis];
            if u > 0.0 && u < 1.0 {
                let extreme = self.point(u)[axis];
                low[axis] = low[axis].min(extreme);
                high[axis] = high[axis].max(extreme);
            }
        }
        (low, high)
    }

    /// ½ ∫ B × B′ du: the signed area swept by the line from the origin to the point, in px².
    pub fn swept_area(&self) -> f64 {
        let (p, q, r) = (self.p0, self.p1, self.p2);
        (2.0 * p.perp_dot(q) + p.perp_dot(r) + 2.0 * q.perp_dot(r)) / 6.0
    }

    /// Half the length of the second difference, in pixels. It measures the bend of the piece: no point is farther than
    /// half of this from the point of the chord with the same parameter.
    pub fn bend(&self) -> f64 {
        0.5 * self.coefficients().0.length()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Any piece within a picture. One in three is degenerate in some way.
    pub(crate) fn any_piece() -> impl Strategy<Value = Quadratic> {
        let coordinate = -100.0f64..100.0;
        let point = (coordinate.clone(), coordinate).prop_map(|(x, y)| Point::new(x, y));
        (point.clone(), point.clone(), point, 0..9, -1.0f64..2.0).prop_map(|(p, q, r, kind, along)| match kind {
            0 => Quadratic::new(p, p.lerp(r, along), r),
            1 => Quadratic::new(p, p, r),
            2 => Quadratic::new(p, p.lerp(r, 0.5) + (q - p) * 1e-9, r),
            _ => Quadratic::new(p, q, r),
        })
    }

    #[test]
    fn the_box_reaches_the_turning_points() {
        let arch = Quadratic::new(Point::new(0.0, 0.0), Point::new(2.0, 4.0), Point::new(4.0, 0.0));
        assert_eq!(arch.bounds(), (Point::ZERO, Point::new(4.0, 2.0)));
        assert_eq!(arch.control_box(), (Point::ZERO, Point::new(4.0, 4.0)));
    }

    #[test]
    fn a_piece_without_speed_still_has_a_direction() {
        let p = Quadratic::new(Point::ZERO, Point::new(3.0, 0.0), Point::new(3.0, 0.0));
        assert_eq!(p.direction(1.0), Point::X);
        assert_eq!(p.reversed().direction(0.0), -Point::X);
        assert_eq!(Quadratic::new(Point::ONE, Point::ONE, Point::ONE).direction(0.5), Point::ZERO);
    }

    proptest! {
        #[test]
        fn parts_are_on_the_piece(piece in any_piece(), from in 0.0f64..1.0, to in 0.0f64..1.0, u in 0.0f64..1.0) {
            let inside = piece.part(from, to).point(u);
            prop_assert!(inside.distance(piece.point(from + (to - from) * u)) < 1e-11 * 100.0);
            let (left, right) = piece.split(from);
            prop_assert!(left.point(u).distance(piece.point(from * u)) < 1e-11 * 100.0);
            prop_assert!(right.point(u).distance(piece.point(from + (1.0 - from) * u)) < 1e-11 * 100.0);
        }

        #[test]
        fn the_box_is_that_of_dense_samples(piece in any_piece()) {
            let (low, high) = piece.bounds();
            let samples = (0..=2000).map(|i| piece.point(i as f64 / 2000.0));
            let (least, most) = samples.fold((piece.p0, piece.p0), |(l, h), p| (l.min(p), h.max(p)));
            prop_assert!(low.cmple(least + 1e-9).all() && high.cmpge(most - 1e-9).all());
            // The samples are at most this far from an extreme.
            let gap = piece.second_derivative().length() / 8.0 / 2000.0f64.powi(2) + 1e-9;
            prop_assert!(least.cmple(low + gap).all() && most.cmpge(high - gap).all());
        }

        #[test]
        fn the_area_is_that_of_many_triangles(piece in any_piece()) {
            let n = 1000;
            let at = |i: usize| piece.point(i as f64 / n as f64);
            let triangles: f64 = (0..n).map(|i| 0.5 * at(i).perp_dot(at(i + 1))).sum();
            // Each chord misses two thirds of its control triangle.
            prop_assert!((triangles - piece.swept_area()).abs() < 1e5 / (n * n) as f64);
        }

        #[test]
        fn derivatives_match_differences(piece in any_piece(), u in 0.1f64..0.9) {
            let h = 1e-4;
            let difference = (piece.point(u + h) - piece.point(u - h)) / (2.0 * h);
            prop_assert!(difference.distance(piece.derivative(u)) < 1e-6);
        }
    }
}
