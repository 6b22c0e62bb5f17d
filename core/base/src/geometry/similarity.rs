//! Least-squares similarity (rotation, scale, shift) between two point sets of equal length.
//!
//! The solution has a closed form with complex numbers: with both sets centred, the best factor is r = Σ w conj(p) q /
//! Σ w |p|². All weights w are 1 here.

use super::Point;

/// q = rotate-and-scale(p − source) + target, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Complex factor: its length is the scale, its argument the turn from x towards y.
    pub factor: Point,
    /// Centre of the source points.
    pub source: Point,
    /// Centre of the target points.
    pub target: Point,
}

impl Similarity {
    /// The map that does not move any point.
    pub const IDENTITY: Self = Self { factor: Point::X, source: Point::ZERO, target: Point::ZERO };

    /// The similarity that best maps `from` to `to` (paired by index). A set without extent gives a pure shift.
    ///
    /// # Panics
    ///
    /// If the numbers of points differ.
    pub fn fit(from: &[Point], to: &[Point]) -> Self {
        assert_eq!(from.len(), to.len(), "both sets must have the same number of points");
        let (source, target) = (super::polygon::center(from), super::polygon::center(to));
        let mut numerator = Point::ZERO;
        let mut denominator = 0.0;
        for (&p, &q) in from.iter().zip(to) {
            let (p, q) = (p - source, q - target);
            numerator += Point::new(p.dot(q), p.perp_dot(q));
            denominator += p.length_squared();
        }
        let factor = if denominator > 1e-12 { numerator / denominator } else { Point::X };
        Self { factor, source, target }
    }

    /// Image of a point.
    pub fn apply(&self, p: Point) -> Point {
        self.factor.rotate(p - self.source) + self.target
    }

    /// The inverse map. A map that takes everything to one place has no inverse; then it is the shift back from the
    /// target centre to the source centre.
    pub fn inverse(&self) -> Self {
        let norm = self.factor.length_squared();
        let factor = if norm > 1e-12 { Point::new(self.factor.x, -self.factor.y) / norm } else { Point::X };
        Self { factor, source: self.target, target: self.source }
    }

    /// The map that applies `first`, then this one.
    pub fn after(&self, first: &Self) -> Self {
        Self { factor: self.factor.rotate(first.factor), source: first.source, target: self.apply(first.target) }
    }

    /// The point that the map does not move; `None` for a map that hardly turns or scales.
    pub fn fixed_point(&self) -> Option<Point> {
        let rest = Point::X - self.factor;
        let norm = rest.length_squared();
        // p = factor (p − source) + target, as complex numbers.
        let shift = self.target - self.factor.rotate(self.source);
        (norm > 1e-12).then(|| Point::new(rest.x, -rest.y).rotate(shift) / norm)
    }

    /// Scale factor (≥ 0).
    pub fn scale(&self) -> f64 {
        self.factor.length()
    }

    /// Turn in radians, from x towards y.
    pub fn angle(&self) -> f64 {
        self.factor.to_angle()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_similarity_is_recovered() {
        let from = [Point::new(1.0, 2.0), Point::new(5.0, -1.0), Point::new(3.0, 7.0)];
        let turn = Point::from_angle(2.5) * 1.7;
        let to = from.map(|p| turn.rotate(p) + Point::new(10.0, -4.0));
        let fitted = Similarity::fit(&from, &to);
        assert!((fitted.angle() - 2.5).abs() < 1e-12);
        assert!((fitted.scale() - 1.7).abs() < 1e-12);
        for (&p, &q) in from.iter().zip(&to) {
            assert!(fitted.apply(p).distance(q) < 1e-12);
        }
    }

    #[test]
    fn maps_follow_each_other_and_keep_a_point() {
        let p = Point::new(3.0, -7.0);
        let first =
            Similarity { factor: Point::from_angle(0.7) * 1.3, source: Point::ONE, target: Point::new(4.0, 5.0) };
        let second = Similarity { factor: Point::from_angle(-1.9) * 0.4, source: Point::X, target: Point::Y };
        assert!(second.after(&first).apply(p).distance(second.apply(first.apply(p))) < 1e-12);
        let fixed = first.fixed_point().unwrap();
        assert!(first.apply(fixed).distance(fixed) < 1e-12);
        assert_eq!(Similarity { factor: Point::X, ..first }.fixed_point(), None);
    }

    #[test]
    fn coincident_points_give_a_shift() {
        let fitted = Similarity::fit(&[Point::ONE; 3], &[Point::new(4.0, 0.0); 3]);
        assert_eq!(fitted.apply(Point::ONE), Point::new(4.0, 0.0));
        assert_eq!(fitted.scale(), 1.0);
    }
}
