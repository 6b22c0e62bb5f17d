//! A line as a sequence of parabola pieces: the common form of splines, polylines and Bézier chains.

use super::tree::{Bounds, around};
use rototoon_base::curve::{Quadratic, Spline};
use rototoon_base::geometry::{Point, polyline};

/// Points that cannot make a path.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PathError {
    /// There are no points.
    #[error("found no points, expected at least one")]
    Empty,
    /// A coordinate is not a number, or outside −1e9 to 1e9.
    #[error("point {index} is ({x}, {y}), expected numbers between -1e9 and 1e9")]
    Point {
        /// Its index among the points of a polyline, the guiding points of a spline, or the control points of the
        /// pieces in turn.
        index: usize,
        /// The x found.
        x: f64,
        /// The y found.
        y: f64,
    },
}

/// A line of parabola pieces, in pixels. Each piece begins where the one before it ends. There is at least one piece,
/// and all are finite.
///
/// The parameter t runs from 0 to the number of pieces. It means piece ⌊t⌋ at u = t − ⌊t⌋.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    pieces: Vec<Quadratic>,
    closed: bool,
}

impl Path {
    /// The pieces of a spline, with the same parameter.
    ///
    /// # Errors
    ///
    /// A guiding point that cannot be used.
    pub fn of_spline(spline: &Spline) -> Result<Self, PathError> {
        checked(spline.guides())?;
        Ok(Self { pieces: spline.pieces().collect(), closed: spline.is_closed() })
    }

    /// Straight pieces between points: at t = i + u the point (1 − u) pᵢ + u pᵢ₊₁. A closed polyline returns to its
    /// first point.
    ///
    /// # Errors
    ///
    /// No points; a point that cannot be used.
    pub fn of_polyline(points: &[Point], closed: bool) -> Result<Self, PathError> {
        checked(points)?;
        let line = |a: Point, b: Point| Quadratic::new(a, 0.5 * (a + b), b);
        let mut pieces: Vec<_> = points.windows(2).map(|pair| line(pair[0], pair[1])).collect();
        if closed || pieces.is_empty() {
            pieces.push(line(points[points.len() - 1], points[0]));
        }
        Ok(Self { pieces, closed })
    }

    /// A chain of Bézier parabolas. A piece that does not begin at the end of the one before it is changed to begin
    /// there.
    ///
    /// # Errors
    ///
    /// No pieces; a control point that cannot be used.
    pub fn of_pieces(mut pieces: Vec<Quadratic>, closed: bool) -> Result<Self, PathError> {
        let points: Vec<_> = pieces.iter().flat_map(|piece| [piece.p0, piece.p1, piece.p2]).collect();
        checked(&points)?;
        for i in 1..pieces.len() {
            pieces[i].p0 = pieces[i - 1].p2;
        }
        if closed {
            let start = pieces[0].p0;
            let last = pieces.len() - 1;
            pieces[last].p2 = start;
        }
        Ok(Self { pieces, closed })
    }

    /// The pieces, in order.
    pub fn pieces(&self) -> &[Quadratic] {
        &self.pieces
    }

    /// Whether the end joins the start.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The largest parameter: the number of pieces.
    pub fn end(&self) -> f64 {
        self.pieces.len() as f64
    }

    /// The index of the piece at a parameter, and the parameter on that piece, 0 to 1.
    pub fn locate(&self, t: f64) -> (usize, f64) {
        let end = self.end();
        let t = if self.closed && t > end { t - end } else { t }.clamp(0.0, end);
        let i = (t as usize).min(self.pieces.len() - 1);
        (i, t - i as f64)
    }

    /// The point at a parameter, in pixels.
    pub fn point(&self, t: f64) -> Point {
        let (i, u) = self.locate(t);
        self.pieces[i].point(u)
    }

    /// Unit direction of travel at a parameter; zero where a piece is a point.
    pub fn direction(&self, t: f64) -> Point {
        let (i, u) = self.locate(t);
        self.pieces[i].direction(u)
    }

    /// The pieces between two parameters, without those of zero length in the parameter. On a closed path `to` may be
    /// up to one round beyond the end.
    pub fn part(&self, from: f64, to: f64) -> Vec<Quadratic> {
        let mut found = Vec::new();
        self.for_each_part(from, to, |i, u, v| {
            let whole = u == 0.0 && v == 1.0;
            found.push(if whole { self.pieces[i] } else { self.pieces[i].part(u, v) });
        });
        found
    }

    /// Arc length between two parameters, in pixels.
    pub fn length_between(&self, from: f64, to: f64) -> f64 {
        let mut sum = 0.0;
        self.for_each_part(from, to, |i, u, v| sum += self.pieces[i].length_to(v) - self.pieces[i].length_to(u));
        sum
    }

    /// Calls `part(i, u, v)` for the stretch of each piece between two parameters.
    fn for_each_part(&self, from: f64, to: f64, mut part: impl FnMut(usize, f64, f64)) {
        let n = self.pieces.len();
        let first = from.max(0.0) as usize;
        let mut k = first;
        while (k as f64) < to && k < 2 * n {
            let (u, v) = ((from - k as f64).clamp(0.0, 1.0), (to - k as f64).clamp(0.0, 1.0));
            if u < v {
                part(k % n, u, v);
            }
            k += 1;
        }
    }

    pub(super) fn bounds(&self) -> Bounds {
        around(self.pieces.iter().map(Quadratic::bounds))
    }
}

fn checked(points: &[Point]) -> Result<(), PathError> {
    if points.is_empty() {
        return Err(PathError::Empty);
    }
    match polyline::first_unusable(points) {
        Some(index) => Err(PathError::Point { index, x: points[index].x, y: points[index].y }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Path {
        Path::of_polyline(&[(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)].map(Point::from), true).unwrap()
    }

    #[test]
    fn a_part_may_run_over_the_seam() {
        let part = square().part(3.5, 4.25);
        assert_eq!(part.len(), 2);
        assert_eq!((part[0].p0, part[0].p2, part[1].p2), (Point::new(0.0, 4.0), Point::ZERO, Point::new(2.0, 0.0)));
        assert!((square().length_between(3.5, 4.25) - 6.0).abs() < 1e-12);
        assert_eq!(square().length_between(2.0, 2.0), 0.0);
        assert_eq!(square().point(4.5), Point::new(4.0, 0.0));
    }

    #[test]
    fn paths_of_one_and_two_points() {
        let dot = Path::of_polyline(&[Point::ONE], false).unwrap();
        assert_eq!((dot.end(), dot.point(0.7), dot.direction(0.5)), (1.0, Point::ONE, Point::ZERO));
        let there_and_back = Path::of_polyline(&[Point::ZERO, Point::X], true).unwrap();
        assert_eq!(there_and_back.end(), 2.0);
    }

    #[test]
    fn points_that_make_no_path_are_refused() {
        assert_eq!(Path::of_polyline(&[], true), Err(PathError::Empty));
        assert_eq!(Path::of_pieces(vec![], true), Err(PathError::Empty));
        let error = Path::of_polyline(&[Point::ZERO, Point::new(f64::NAN, 2.0)], false).unwrap_err();
        assert_eq!(error.to_string(), "point 1 is (NaN, 2), expected numbers between -1e9 and 1e9");
        assert!(Path::of_polyline(&[Point::new(1e10, 0.0)], false).is_err());
    }

    #[test]
    fn pieces_are_joined() {
        let line = |a: f64, b: f64| Quadratic::new(Point::X * a, Point::X * 0.5 * (a + b), Point::X * b);
        let path = Path::of_pieces(vec![line(0.0, 1.0), line(1.1, 2.0)], false).unwrap();
        assert_eq!(path.pieces()[1].p0, Point::X);
    }
}
