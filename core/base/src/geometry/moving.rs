//! Deformation of the plane that follows a line: every point of the line goes to its image, and the surroundings
//! follow.
//!
//! The method is moving least squares (Schaefer, McPhail & Warren 2006, "Image Deformation Using Moving Least Squares",
//! §2.2). For each place v, the similarity is fitted that maps the line's points p best to their images q. Points near
//! v count most: w = ℓ / |p − v|². This similarity is then applied to v. If the complete line moves by one similarity,
//! so does the plane. ℓ is the length of line that a point represents, so the density of the points does not matter.
//!
//! Limits: a place nearer to another stretch of the line than to its own follows that stretch, unless the caller says
//! to which stretch it belongs ([`Moving::apply_by`]).

use super::Point;

/// Squared distance, in px², below which a place is equal to a point of the line.
const SAME_PLACE: f64 = 1e-12;
/// Smallest and largest scale beside the line. A stretch that has collapsed does not show the scale of its
/// surroundings.
const SCALES: (f64, f64) = (0.25, 4.0);

/// The deformation that maps one line to another with the same number of points.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    from: &'a [Point],
    to: &'a [Point],
    closed: bool,
}

impl<'a> Moving<'a> {
    /// The deformation from the points of a line to their images, paired by index.
    ///
    /// # Panics
    ///
    /// If the numbers of points differ.
    pub fn new(from: &'a [Point], to: &'a [Point], closed: bool) -> Self {
        assert_eq!(from.len(), to.len(), "both lines must have the same number of points");
        Self { from, to, closed }
    }

    /// The image of a place. Without a line it stays.
    pub fn apply(&self, v: Point) -> Point {
        self.apply_by(v, |_| 1.0)
    }

    /// Like [`Self::apply`], with an additional weight for each point of the line by its index. With it the caller
    /// chooses the stretch to which a place near several stretches belongs.
    pub fn apply_by(&self, v: Point, counts: impl Fn(usize) -> f64) -> Point {
        let weight = |i: usize| counts(i) * self.length(i) / v.distance_squared(self.from[i]);
        let same = |&i: &usize| counts(i) > 0.0 && v.distance_squared(self.from[i]) < SAME_PLACE;
        if let Some(i) = (0..self.from.len()).find(same) {
            return self.to[i];
        }
        let weights: Vec<f64> = (0..self.from.len()).map(|i| if counts(i) > 0.0 { weight(i) } else { 0.0 }).collect();
        let (mut sum, mut source, mut target) = (0.0, Point::ZERO, Point::ZERO);
        for (i, &w) in weights.iter().enumerate() {
            sum += w;
            source += self.from[i] * w;
            target += self.to[i] * w;
        }
        if sum <= 0.0 {
            return v;
        }
        (source, target) = (source / sum, target / sum);
        let (mut factor, mut norm) = (Point::ZERO, 0.0);
        for (i, &w) in weights.iter().enumerate() {
            let (p, q) = (self.from[i] - source, self.to[i] - target);
            factor += Point::new(p.dot(q), p.perp_dot(q)) * w;
            norm += p.length_squared() * w;
        }
        let factor = if norm > SAME_PLACE * sum { factor / norm } else { Point::X };
        let scale = factor.length();
        let factor = if scale > 1e-9 { factor * (scale.clamp(SCALES.0, SCALES.1) / scale) } else { Point::X };
        factor.rotate(v - source) + target
    }

    /// Half of the length of the segments at a point. A small extra makes coincident points count too.
    fn length(&self, i: usize) -> f64 {
        let (n, at) = (self.from.len(), |i: usize| self.from[i]);
        let before = if i > 0 || self.closed { at(i).distance(at((i + n - 1) % n)) } else { 0.0 };
        let after = if i + 1 < n || self.closed { at(i).distance(at((i + 1) % n)) } else { 0.0 };
        0.5 * (before + after) + 1e-9
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::similarity::Similarity;

    fn outline() -> Vec<Point> {
        (0..20)
            .map(|k| Point::from_angle(f64::from(k) * 0.314).rotate(Point::new(40.0 + f64::from(k % 3), 5.0)))
            .collect()
    }

    #[test]
    fn a_line_that_moves_as_one_takes_the_plane_with_it() {
        let from = outline();
        let map =
            Similarity { factor: Point::new(0.3, 1.2), source: Point::new(3.0, 4.0), target: Point::new(100.0, 9.0) };
        let to: Vec<Point> = from.iter().map(|&p| map.apply(p)).collect();
        let moving = Moving::new(&from, &to, true);
        for v in [Point::ZERO, Point::new(41.0, 0.3), Point::new(300.0, -80.0)] {
            assert!(moving.apply(v).distance(map.apply(v)) < 1e-9);
        }
    }

    #[test]
    fn points_of_the_line_go_to_their_images() {
        let from = outline();
        let to: Vec<Point> =
            from.iter().enumerate().map(|(k, p)| *p + Point::new((k as f64).sin() * 9.0, 4.0)).collect();
        let moving = Moving::new(&from, &to, true);
        for (p, q) in from.iter().zip(&to) {
            assert_eq!(moving.apply(*p), *q);
            let beside = moving.apply(*p + Point::new(1e-3, 0.0));
            assert!(beside.distance(*q) < 0.05, "no jump beside a point: {beside} for {q}");
        }
    }

    #[test]
    fn a_limb_that_bends_turns_what_is_drawn_on_it() {
        // A bar whose right half turns by 90° about its middle.
        let bar: Vec<Point> = (-20..=20).map(|k| Point::new(f64::from(k) * 5.0, 0.0)).collect();
        let bent: Vec<Point> = bar.iter().map(|p| if p.x > 0.0 { p.perp() } else { *p }).collect();
        let moving = Moving::new(&bar, &bent, false);
        let (left, right) = (moving.apply(Point::new(-80.0, 6.0)), moving.apply(Point::new(80.0, 6.0)));
        // If it only moved along without a turn, the right point would be 8 px off.
        assert!(left.distance(Point::new(-80.0, 6.0)) < 2.5, "{left}");
        assert!(right.distance(Point::new(-6.0, 80.0)) < 2.5, "{right}");
    }

    #[test]
    fn nothing_and_a_single_point_are_no_trouble() {
        let v = Point::new(1.0, 2.0);
        assert_eq!(Moving::new(&[], &[], true).apply(v), v);
        let (p, q) = (Point::new(5.0, 5.0), Point::new(8.0, 4.0));
        assert!(Moving::new(&[p], &[q], true).apply(v).distance(v + q - p) < 1e-12);
        assert!(Moving::new(&[p, p], &[q, q], false).apply(v).distance(v + q - p) < 1e-12);
    }
}
