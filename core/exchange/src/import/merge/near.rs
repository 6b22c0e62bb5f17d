//! How far the points of one line are from another one, one point after the other.
//!
//! **Why.** Outlines have thousands of points, and each may be nearest to any side of the other line. For a film that takes minutes.
//!
//! **How.** Points that follow each other are nearest to sides that do. So the search begins where the last one ended, and goes on to both sides. It ends as soon as
//! what is asked is known. The answers are those of [`polyline::distance`].

use rototoon_base::geometry::{Point, polyline};

/// A line from which distances are taken.
pub(super) struct Near<'a> {
    line: &'a [Point],
    /// Number of sides.
    sides: usize,
    /// The side at which the last search ended.
    at: usize,
}

impl<'a> Near<'a> {
    pub fn new(line: &'a [Point], closed: bool) -> Self {
        let n = line.len();
        let sides = if closed && n > 1 { n } else { n.saturating_sub(1) };
        Self { line, sides, at: 0 }
    }

    /// Whether a point is within a distance of the line, in pixels.
    pub fn is_within(&mut self, p: Point, distance: f64) -> bool {
        self.search(p, distance) <= distance
    }

    /// The distance of a point from the line if it is greater than `most`, otherwise `most`, in pixels.
    pub fn at_least(&mut self, p: Point, most: f64) -> f64 {
        self.search(p, most).max(most)
    }

    /// The distance of a point from the line, or any that is not greater than `enough`.
    fn search(&mut self, p: Point, enough: f64) -> f64 {
        if let [only] = self.line {
            return p.distance(*only);
        }
        let (mut least, from) = (f64::INFINITY, self.at);
        for k in 0..self.sides {
            // 0, 1, -1, 2, -2, …
            let step = k.div_ceil(2);
            let side = (from + if k % 2 == 1 { step } else { self.sides - step }) % self.sides;
            let [a, b] = [self.line[side], self.line[(side + 1) % self.line.len()]];
            let distance = p.distance(polyline::nearest_on_segment(p, a, b));
            if distance < least {
                (least, self.at) = (distance, side);
                if least <= enough {
                    break;
                }
            }
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_the_whole_line() {
        let line: Vec<Point> =
            (0..40).map(|k| Point::from_angle(0.3 * f64::from(k)) * f64::from(5 + (k * k * 7) % 30)).collect();
        let points: Vec<Point> =
            (0..60).map(|k| Point::new(f64::from((k * 37) % 80), f64::from((k * k * 11) % 70)) - 35.0).collect();
        for (line, closed) in
            [(&line[..], true), (&line[..], false), (&line[..2], true), (&line[..1], true), (&[], true)]
        {
            let mut near = Near::new(line, closed);
            for &p in &points {
                let own = polyline::distance(p, line, closed);
                assert_eq!(near.at_least(p, 0.0), own);
                assert_eq!((near.at_least(p, own), near.at_least(p, 200.0)), (own, own.max(200.0)));
                assert_eq!(
                    (near.is_within(p, own), near.is_within(p, 0.999 * own)),
                    (own < f64::INFINITY || line.is_empty(), own == 0.0 || line.is_empty())
                );
            }
        }
    }
}
