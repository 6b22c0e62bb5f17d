//! Uniform quadratic B-splines, given by their guiding points (Yang et al. 1986, §2).
//!
//! **Closed curves** have guiding points G_0 … G_{n−1}, with indices modulo n. Piece i is the parabola P_i, G_i,
//! P_{i+1} with P_i = (G_{i−1} + G_i)/2. So n guiding points make n pieces.
//!
//! **Open curves** start at their first guiding point and end at their last one. Piece i is the parabola about G_{i+1};
//! the ends of the curve replace the first and the last midpoint. So n ≥ 3 guiding points make n − 2 pieces: three of
//! them are one Bézier parabola. Two guiding points make a line, and one makes a point. This is the uniform B-spline of
//! order three with clamped ends (other programs call it a NURBS curve of order 3 with end points). A doubled end
//! guiding point makes the straight start that the paper draws.
//!
//! **Corners** are guiding points that are given twice. Such a point is on the curve. The curve arrives and leaves
//! along straight halves of the polygon's legs and may turn by any angle (Pavlidis 1982). Repeating the point three
//! times or more does not change the shape.
//!
//! The parameter t runs from 0 to the number of pieces. It means piece ⌊t⌋ at u = t − ⌊t⌋.

use super::Quadratic;
use crate::geometry::Point;

/// Points that cannot make a spline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// There are no points.
    #[error("a spline needs at least one guiding point")]
    Empty,
    /// A coordinate is infinite or not a number.
    #[error("guiding point {index} is ({x}, {y}), expected finite coordinates")]
    NotFinite {
        /// Index of the point.
        index: usize,
        /// The x found.
        x: f64,
        /// The y found.
        y: f64,
    },
}

/// A uniform quadratic B-spline. It has at least one guiding point, and all are finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    guides: Vec<Point>,
    closed: bool,
}

impl Spline {
    /// The spline of these guiding points.
    ///
    /// # Errors
    ///
    /// No guiding points; a coordinate that is not finite.
    pub fn new(guides: Vec<Point>, closed: bool) -> Result<Self, SplineError> {
        if guides.is_empty() {
            return Err(SplineError::Empty);
        }
        if let Some(index) = guides.iter().position(|g| !g.is_finite()) {
            return Err(SplineError::NotFinite { index, x: guides[index].x, y: guides[index].y });
        }
        Ok(Self { guides, closed })
    }

    /// The same without the checks, for points known to be finite and at least one.
    pub fn of_finite(guides: Vec<Point>, closed: bool) -> Self {
        debug_assert!(!guides.is_empty() && guides.iter().all(|g| g.is_finite()));
        Self { guides, closed }
    }

    /// The guiding points. Those of corners are repeated.
    pub fn guides(&self) -> &[Point] {
        &self.guides
    }

    /// Whether the end joins the start.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Number of pieces; at least one.
    pub fn piece_count(&self) -> usize {
        if self.closed { self.guides.len() } else { self.guides.len().saturating_sub(2).max(1) }
    }

    /// Indices of the guiding points of piece `i`: before, about and after it.
    ///
    /// # Panics
    ///
    /// If there is no piece `i`.
    pub fn support(&self, i: usize) -> [usize; 3] {
        assert!(i < self.piece_count(), "piece {i} of {}", self.piece_count());
        support(i, self.guides.len(), self.closed)
    }

    /// Piece `i`.
    ///
    /// # Panics
    ///
    /// If there is no piece `i`.
    pub fn piece(&self, i: usize) -> Quadratic {
        let support = self.support(i);
        let [before, about, after] = support.map(|k| self.guides[k]);
        let last = self.piece_count() - 1;
        if !self.closed && self.guides.len() < 3 {
            return Quadratic::new(before, 0.5 * (before + after), after);
        }
        let p0 = if !self.closed && i == 0 { before } else { 0.5 * (before + about) };
        let p2 = if !self.closed && i == last { after } else { 0.5 * (about + after) };
        Quadratic::new(p0, about, p2)
    }

    /// All pieces in order.
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = Quadratic> + '_ {
        (0..self.piece_count()).map(|i| self.piece(i))
    }

    /// The index of the piece at parameter `t`, and the parameter on that piece, 0 to 1. An open spline clamps `t` to
    /// its ends. A closed one wraps around.
    pub fn locate(&self, t: f64) -> (usize, f64) {
        let count = self.piece_count();
        let t = if self.closed && !(0.0..=count as f64).contains(&t) { t.rem_euclid(count as f64) } else { t };
        let t = t.clamp(0.0, count as f64);
        let i = (t as usize).min(count - 1);
        (i, t - i as f64)
    }

    /// The point at parameter `t`.
    pub fn point(&self, t: f64) -> Point {
        let (i, u) = self.locate(t);
        self.piece(i).point(u)
    }

    /// Derivative with respect to the parameter. It is continuous except at corners, where it vanishes.
    pub fn derivative(&self, t: f64) -> Point {
        let (i, u) = self.locate(t);
        self.piece(i).derivative(u)
    }

    /// Second derivative with respect to the parameter. At a joint it is that of the piece that starts there.
    pub fn second_derivative(&self, t: f64) -> Point {
        let (i, _) = self.locate(t);
        self.piece(i).second_derivative()
    }

    /// The guiding points that affect the point at `t`, with their weights, which sum to one. The same weights blend
    /// other values at the guiding points (a radius, a colour).
    pub fn weights(&self, t: f64) -> [(usize, f64); 3] {
        let (i, u) = self.locate(t);
        let [before, about, after] = self.support(i);
        if !self.closed && self.guides.len() < 3 {
            return [(before, 1.0 - u), (about, 0.0), (after, u)];
        }
        let clamped = |end: bool| if end && !self.closed { 1.0 } else { 0.5 };
        let first = clamped(i == 0) * (1.0 - u) * (1.0 - u);
        let last = clamped(i + 1 == self.piece_count()) * u * u;
        [(before, first), (about, 1.0 - first - last), (after, last)]
    }

    /// Blends values given at the guiding points, at parameter `t`.
    pub fn blend(&self, values: &[f64], t: f64) -> f64 {
        self.weights(t).iter().map(|&(k, weight)| weight * values[k]).sum()
    }

    /// Unit direction of travel at `t`; zero where a piece is a point.
    pub fn direction(&self, t: f64) -> Point {
        let (i, u) = self.locate(t);
        self.piece(i).direction(u)
    }

    /// Length in pixels. For many lengths and parameters use [`super::ArcLengths`].
    pub fn length(&self) -> f64 {
        self.pieces().map(|piece| piece.length()).sum()
    }

    /// Smallest and largest coordinates of the curve.
    pub fn bounds(&self) -> (Point, Point) {
        let first = self.piece(0).bounds();
        self.pieces().skip(1).fold(first, |(low, high), piece| {
            let (l, h) = piece.bounds();
            (low.min(l), high.max(h))
        })
    }

    /// Exact signed area in px², positive where the curve runs clockwise on the screen (x to the right, y down). An
    /// open curve is closed by a straight line.
    pub fn area(&self) -> f64 {
        // Computing relative to a point of the curve keeps precision far from the origin.
        let origin = self.guides[0];
        let swept = self.pieces().map(|p| Quadratic::new(p.p0 - origin, p.p1 - origin, p.p2 - origin).swept_area());
        let (start, end) = (self.piece(0).p0 - origin, self.piece(self.piece_count() - 1).p2 - origin);
        swept.sum::<f64>() + 0.5 * end.perp_dot(start)
    }

    /// Index of the first guiding point of each corner: a guiding point that is repeated and is not an end of an open
    /// curve.
    pub fn corners(&self) -> Vec<usize> {
        let n = self.guides.len();
        let same = |i: usize| self.guides[i] == self.guides[(i + 1) % n];
        let last = if self.closed { n } else { n - 1 };
        let inner =
            |i: usize| self.closed || (self.guides[i] != self.guides[0] && self.guides[i] != self.guides[n - 1]);
        let begins = |i: usize| if i > 0 { !same(i - 1) } else { !self.closed || !same(n - 1) };
        (0..last).filter(|&i| same(i) && begins(i) && inner(i)).collect()
    }

    /// The pieces before and after parameter `t`, without those of zero length in the parameter. The result is Bézier
    /// pieces, because a part of a piece is not a piece of a uniform spline. A closed curve is cut at its start too.
    pub fn split(&self, t: f64) -> (Vec<Quadratic>, Vec<Quadratic>) {
        let (cut, u) = self.locate(t);
        let mut pieces = self.pieces();
        let mut before: Vec<_> = pieces.by_ref().take(cut).collect();
        let mut after = Vec::with_capacity(self.piece_count() - cut);
        if let Some(piece) = pieces.next() {
            let (left, right) = piece.split(u);
            before.extend((u > 0.0).then_some(left));
            after.extend((u < 1.0).then_some(right));
        }
        after.extend(pieces);
        (before, after)
    }

    /// The same curve with each piece halved (knot insertion; Chaikin 1974). It has twice the number of pieces, so each
    /// parameter doubles.
    pub fn refined(&self) -> Self {
        let (g, n) = (&self.guides, self.guides.len());
        let quarters = |i: usize| [g[i].lerp(g[(i + 1) % n], 0.25), g[i].lerp(g[(i + 1) % n], 0.75)];
        let guides = if self.closed {
            // Piece 0 starts half way along the last leg.
            std::iter::once(n - 1).chain(0..n - 1).flat_map(quarters).skip(1).chain([quarters(n - 1)[0]]).collect()
        } else if n < 3 {
            let (a, b) = (g[0], g[n - 1]);
            [0.0, 0.25, 0.75, 1.0].map(|u| a.lerp(b, u)).into()
        } else {
            // The leg at a clamped end belongs to one piece only, so it is halved.
            let start = [g[0], g[0].lerp(g[1], 0.5)];
            let end = [g[n - 2].lerp(g[n - 1], 0.5), g[n - 1]];
            start.into_iter().chain((1..n - 2).flat_map(quarters)).chain(end).collect()
        };
        Self { guides, closed: self.closed }
    }

    /// The same curve in the opposite direction.
    pub fn reversed(&self) -> Self {
        Self { guides: self.guides.iter().rev().copied().collect(), closed: self.closed }
    }

    /// Points at `per_piece` even parameter steps of each piece, for display. On an open curve both ends are included.
    pub fn flattened(&self, per_piece: usize) -> Vec<Point> {
        let step = 1.0 / per_piece.max(1) as f64;
        let mut points: Vec<_> =
            self.pieces().flat_map(|piece| (0..per_piece.max(1)).map(move |k| piece.point(k as f64 * step))).collect();
        if !self.closed {
            points.push(self.piece(self.piece_count() - 1).p2);
        }
        points
    }
}

/// Guides of piece `i` of a spline with `n` of them, which may coincide.
pub fn support(i: usize, n: usize, closed: bool) -> [usize; 3] {
    match (closed, n) {
        (true, _) => [(i + n - 1) % n, i, (i + 1) % n],
        (false, 1) => [0; 3],
        (false, 2) => [0, 0, 1],
        (false, _) => [i, i + 1, i + 2],
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(crate) fn any_spline() -> impl Strategy<Value = Spline> {
        (prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 1..10), any::<bool>(), any::<bool>()).prop_map(
            |(guides, closed, doubled)| {
                let mut guides: Vec<Point> = guides.into_iter().map(Point::from).collect();
                if doubled {
                    guides.insert(guides.len() / 2, guides[guides.len() / 2]);
                }
                Spline::new(guides, closed).unwrap()
            },
        )
    }

    fn square() -> Spline {
        let corners = [(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)];
        Spline::new(corners.map(Point::from).into(), true).unwrap()
    }

    #[test]
    fn the_curve_passes_the_midpoints_along_the_polygon() {
        let spline = square();
        assert_eq!(spline.point(0.0), Point::new(0.0, 4.0));
        assert_eq!(spline.point(1.0), Point::new(4.0, 0.0));
        assert_eq!(spline.direction(1.0), Point::X);
        assert_eq!(spline.point(1.5), Point::new(7.0, 1.0));
        assert_eq!(spline.point(4.0), spline.point(0.0));
        assert_eq!(spline.point(-0.5), spline.point(3.5));
        assert_eq!(spline.bounds(), (Point::ZERO, Point::splat(8.0)));
        // The square without four corners, each a third of its triangle of 8.
        assert!((spline.area() - (64.0 - 4.0 * 8.0 / 3.0)).abs() < 1e-12);
    }

    #[test]
    fn an_open_curve_starts_and_ends_at_its_end_guides() {
        let guides: Vec<Point> = [(0.0, 0.0), (4.0, 8.0), (8.0, 0.0), (12.0, 4.0)].map(Point::from).into();
        let spline = Spline::new(guides.clone(), false).unwrap();
        assert_eq!(spline.piece_count(), 2);
        assert_eq!((spline.point(0.0), spline.point(2.0)), (guides[0], guides[3]));
        assert_eq!(spline.point(1.0), Point::new(6.0, 4.0));
        assert_eq!(spline.point(9.0), guides[3]);
        assert_eq!(Spline::new(guides[..2].into(), false).unwrap().point(0.5), Point::new(2.0, 4.0));
        assert_eq!(Spline::new(guides[..1].into(), false).unwrap().length(), 0.0);
    }

    #[test]
    fn a_doubled_guide_is_a_corner_on_the_curve() {
        let guides: Vec<Point> = [(0.0, 0.0), (8.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)].map(Point::from).into();
        let spline = Spline::new(guides, true).unwrap();
        assert_eq!(spline.corners(), [1]);
        assert_eq!(spline.point(2.0), Point::new(8.0, 0.0));
        assert_eq!((spline.direction(1.9), spline.direction(2.1)), (Point::X, Point::Y));
        assert_eq!(spline.point(1.5).y, 0.0);
    }

    #[test]
    fn corners_are_found_across_the_start_and_not_at_open_ends() {
        let p = Point::new;
        let around = vec![p(1.0, 0.0), p(5.0, 0.0), p(3.0, 3.0), p(1.0, 0.0)];
        assert_eq!(Spline::new(around, true).unwrap().corners(), [3]);
        let ends = vec![p(1.0, 0.0), p(1.0, 0.0), p(3.0, 3.0), p(3.0, 3.0), p(3.0, 3.0), p(9.0, 0.0), p(9.0, 0.0)];
        assert_eq!(Spline::new(ends, false).unwrap().corners(), [2]);
    }

    #[test]
    fn points_that_make_no_spline_are_named() {
        assert_eq!(Spline::new(vec![], true), Err(SplineError::Empty));
        let error = Spline::new(vec![Point::ZERO, Point::new(f64::NAN, 1.0)], false).unwrap_err();
        assert_eq!(error.to_string(), "guiding point 1 is (NaN, 1), expected finite coordinates");
    }

    proptest! {
        #[test]
        fn pieces_join_smoothly(spline in any_spline()) {
            for i in 0..spline.piece_count() - usize::from(!spline.is_closed()) {
                let (here, next) = (spline.piece(i), spline.piece((i + 1) % spline.piece_count()));
                prop_assert_eq!(here.p2, next.p0);
                let both_inner = spline.is_closed() || (i > 0 && i + 2 < spline.piece_count());
                prop_assert!(!both_inner || here.derivative(1.0).distance(next.derivative(0.0)) < 1e-12);
            }
        }

        #[test]
        fn the_weights_blend_the_guides_to_the_point(spline in any_spline(), share in 0.0f64..=1.0) {
            let t = share * spline.piece_count() as f64;
            let coordinate = |axis: usize| spline.guides().iter().map(|g| g[axis]).collect::<Vec<_>>();
            let blended = Point::new(spline.blend(&coordinate(0), t), spline.blend(&coordinate(1), t));
            prop_assert!(blended.distance(spline.point(t)) < 1e-11);
        }

        #[test]
        fn refining_changes_nothing(spline in any_spline(), share in 0.0f64..=1.0) {
            let fine = spline.refined();
            prop_assert_eq!(fine.piece_count(), 2 * spline.piece_count());
            let t = share * spline.piece_count() as f64;
            prop_assert!(fine.point(2.0 * t).distance(spline.point(t)) < 1e-10);
        }

        #[test]
        fn both_sides_of_a_cut_make_the_whole(spline in any_spline(), share in 0.0f64..=1.0) {
            let t = share * spline.piece_count() as f64;
            let (before, after) = spline.split(t);
            let sum: f64 = before.iter().chain(&after).map(Quadratic::length).sum();
            prop_assert!((sum - spline.length()).abs() < 1e-9);
            if let Some(last) = before.last() {
                prop_assert!(last.p2.distance(spline.point(t)) < 1e-9);
            }
        }

        #[test]
        fn the_area_is_that_of_the_flattened_curve(spline in any_spline()) {
            let flat = spline.flattened(400);
            let polygon = crate::geometry::polygon::signed_area(&flat);
            prop_assert!((polygon - spline.area()).abs() < 0.5);
            prop_assert!((spline.reversed().area() + spline.area()).abs() < 1e-9);
        }
    }
}
