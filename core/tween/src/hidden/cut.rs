//! The points of a part of a stroke as blends of the stroke's own points. Whatever else the points carry (a radius, a
//! third coordinate) can then be cut with the same weights.

use super::intervals::Interval;
use super::path::{Path, PathError};
use rototoon_base::curve::{Quadratic, Spline};
use rototoon_base::geometry::Point;

/// The meaning of the points of a stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Corners of straight lines.
    #[default]
    Polyline,
    /// Guiding points of a uniform quadratic B-spline.
    Spline,
    /// A chain of Bézier parabolas: start, middle, joint, middle, joint, … A closed one ends with a middle.
    Chain,
}

/// A point as a weighted sum of at most three points of the stroke: index and weight of each. The weights sum to 1.
pub type Blend = [(usize, f64); 3];

impl Form {
    /// The path through or along a stroke's points.
    ///
    /// # Errors
    ///
    /// No points; a point that cannot be used.
    pub fn path(self, points: &[Point], closed: bool) -> Result<Path, PathError> {
        match self {
            Self::Polyline => Path::of_polyline(points, closed),
            Self::Spline if points.is_empty() => Err(PathError::Empty),
            Self::Spline => match Spline::new(points.to_vec(), closed) {
                Ok(spline) => Path::of_spline(&spline),
                // Reports the reason in the words of a path.
                Err(_) => Path::of_polyline(points, closed),
            },
            Self::Chain => {
                Path::of_polyline(points, closed)?;
                let controls = |i: usize| self.controls(i, points.len(), closed);
                let place = |blend: Blend| blend.iter().map(|&(k, weight)| points[k] * weight).sum::<Point>();
                let pieces = (0..self.piece_count(points.len(), closed)).map(|i| {
                    let [p0, p1, p2] = controls(i).map(place);
                    Quadratic::new(p0, p1, p2)
                });
                Path::of_pieces(pieces.collect(), closed)
            }
        }
    }

    /// Number of pieces of the path of this many points; at least one.
    fn piece_count(self, points: usize, closed: bool) -> usize {
        match (self, closed) {
            (Self::Polyline, true) if points > 1 => points,
            (Self::Polyline, _) => points.saturating_sub(1).max(1),
            (Self::Spline, true) => points,
            (Self::Spline, false) => points.saturating_sub(2).max(1),
            (Self::Chain, true) => points.div_ceil(2),
            (Self::Chain, false) => (points / 2).max(1),
        }
    }

    /// The Bézier control points of piece `i`, as blends of the stroke's points.
    fn controls(self, i: usize, points: usize, closed: bool) -> [Blend; 3] {
        let wrapped = |k: usize| if closed { k % points } else { k.min(points - 1) };
        let only = |k: usize| [(wrapped(k), 1.0), (wrapped(k), 0.0), (wrapped(k), 0.0)];
        let half = |a: usize, b: usize| [(wrapped(a), 0.5), (wrapped(b), 0.5), (wrapped(b), 0.0)];
        let last = i + 1 == self.piece_count(points, closed);
        match self {
            Self::Polyline => [only(i), half(i, i + 1), only(i + 1)],
            Self::Chain => [only(2 * i), only(2 * i + 1), only(if closed && last { 0 } else { 2 * i + 2 })],
            Self::Spline if closed => [half(i + points - 1, i), only(i), half(i, i + 1)],
            Self::Spline if points < 3 => [only(0), half(0, 1), only(1)],
            Self::Spline => [
                if i == 0 { only(0) } else { half(i, i + 1) },
                only(i + 1),
                if last { only(i + 2) } else { half(i + 1, i + 2) },
            ],
        }
    }

    /// The meaning of the points of a cut stroke. A part of a uniform spline is not uniform, so it becomes a chain.
    pub fn of_cut(self) -> Self {
        if self == Self::Polyline { self } else { Self::Chain }
    }

    /// The points of the open stroke between two parameters. `points` is the number of points of the complete stroke,
    /// at least one.
    pub fn cut(self, points: usize, closed: bool, (from, to): Interval) -> Vec<Blend> {
        let count = self.piece_count(points, closed);
        let mut found = Vec::new();
        for k in from.max(0.0) as usize..2 * count {
            let (u, v) = ((from - k as f64).clamp(0.0, 1.0), (to - k as f64).clamp(0.0, 1.0));
            if k as f64 >= to {
                break;
            }
            if u >= v {
                continue;
            }
            let controls = self.controls(k % count, points, closed);
            let squared = |u: f64| [(1.0 - u) * (1.0 - u), 2.0 * u * (1.0 - u), u * u];
            if found.is_empty() {
                found.push(blended(&controls, squared(u)));
            }
            if self != Self::Polyline {
                let middle = [(1.0 - u) * (1.0 - v), u * (1.0 - v) + v * (1.0 - u), u * v];
                found.push(blended(&controls, middle));
            }
            found.push(blended(&controls, squared(v)));
        }
        found
    }
}

/// The weighted sum of blends. Together they use at most three different points.
fn blended(controls: &[Blend; 3], weights: [f64; 3]) -> Blend {
    let mut sum: Blend = [(controls[0][0].0, 0.0); 3];
    let mut used = 0;
    for (control, weight) in controls.iter().zip(weights) {
        for &(k, share) in control {
            if share * weight == 0.0 {
                continue;
            }
            match sum[..used].iter().position(|entry| entry.0 == k) {
                Some(at) => sum[at].1 += share * weight,
                None => {
                    sum[used] = (k, share * weight);
                    used += 1;
                }
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place(points: &[Point], blend: &Blend) -> Point {
        blend.iter().map(|&(k, weight)| points[k] * weight).sum()
    }

    proptest! {
        #[test]
        fn cuts_have_the_shape_of_the_part(
            points in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 1..9),
            kind in 0usize..3, closed: bool, a in 0.0f64..1.0, b in 0.0f64..1.0,
        ) {
            let form = [Form::Polyline, Form::Spline, Form::Chain][kind];
            let mut points: Vec<Point> = points.into_iter().map(Point::from).collect();
            if form == Form::Chain && closed == (points.len() % 2 == 1) {
                points.push(points[0]);
            }
            let path = form.path(&points, closed).unwrap();
            let (from, mut to) = (a * path.end(), b * path.end());
            if to < from {
                if closed { to += path.end() } else { return Ok(()) }
            }
            let cut: Vec<Point> = form.cut(points.len(), closed, (from, to)).iter().map(|b| place(&points, b)).collect();
            let part = path.part(from, to);
            prop_assert_eq!(part.is_empty(), cut.is_empty());
            if part.is_empty() {
                return Ok(());
            }
            let again = form.of_cut().path(&cut, false).unwrap();
            prop_assert_eq!(again.pieces().len(), part.len());
            for (mine, theirs) in again.pieces().iter().zip(&part) {
                for u in [0.0, 0.3, 1.0] {
                    prop_assert!(mine.point(u).distance(theirs.point(u)) < 1e-9);
                }
            }
        }
    }

    #[test]
    fn strokes_of_few_points() {
        for form in [Form::Polyline, Form::Spline, Form::Chain] {
            for closed in [false, true] {
                for count in 1..4 {
                    let points: Vec<Point> = (0..count).map(|k| Point::new(k as f64, (k * k) as f64)).collect();
                    let path = form.path(&points, closed).unwrap();
                    assert_eq!(path.end(), form.piece_count(count, closed) as f64, "{form:?} {closed} {count}");
                    let cut = form.cut(count, closed, (0.0, 0.5));
                    assert!(cut.iter().flatten().all(|&(k, _)| k < count));
                }
                assert_eq!(form.path(&[], closed), Err(PathError::Empty));
                assert!(form.path(&[Point::NAN], closed).is_err());
            }
        }
    }
}
