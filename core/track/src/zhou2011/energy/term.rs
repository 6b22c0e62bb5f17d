//! What a term of the energy reads, and where its residuals go.

use rototoon_base::geometry::Point;

/// The order of the control points in the list of all coordinates: frame by frame, point by point, x before y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Frames of the span, with both keys.
    pub frames: usize,
    /// Control points per frame.
    pub points: usize,
    /// Whether the last point is joined to the first. A contour of fewer than three points is never closed here: its
    /// closing segment would be a segment that it already has.
    pub closed: bool,
}

impl Layout {
    /// A layout. `closed` has an effect from three points on.
    pub fn new(frames: usize, points: usize, closed: bool) -> Self {
        Self { frames, points, closed: closed && points > 2 }
    }

    /// Index of the x coordinate of a point; its y coordinate follows.
    pub fn coordinate(&self, frame: usize, point: usize) -> usize {
        2 * (frame * self.points + point)
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        2 * self.frames * self.points
    }

    /// Pairs of neighbouring points.
    pub fn segments(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let n = self.points;
        (0..self.segment_count()).map(move |j| (j, (j + 1) % n))
    }

    /// Number of segments.
    pub fn segment_count(&self) -> usize {
        if self.closed { self.points } else { self.points.saturating_sub(1) }
    }

    /// Points that have two neighbours, as (previous, point, next).
    pub fn neighbours(&self) -> impl Iterator<Item = (usize, usize, usize)> + use<> {
        let n = self.points;
        let inner = if self.closed { 0..n } else { 1..n.saturating_sub(1).max(1) };
        inner.map(move |j| ((j + n - 1) % n, j, (j + 1) % n))
    }
}

/// The control points of all frames, in the form that the terms read.
#[derive(Clone, Copy, Debug)]
pub struct Curves<'a> {
    /// The order of `points`.
    pub layout: Layout,
    /// All points, frame by frame.
    pub points: &'a [Point],
}

impl Curves<'_> {
    /// A control point.
    pub fn at(&self, frame: usize, point: usize) -> Point {
        self.points[frame * self.layout.points + point]
    }

    /// The control points of a frame.
    pub fn frame(&self, frame: usize) -> &[Point] {
        &self.points[frame * self.layout.points..(frame + 1) * self.layout.points]
    }
}

/// Receives the residuals of a term in order.
pub trait Sink {
    /// A residual and its derivatives by coordinate (index of the layout). A term must name the same coordinates in the
    /// same order for all points. If it names a coordinate more than once the derivatives add up.
    fn residual(&mut self, value: f64, derivatives: impl IntoIterator<Item = (usize, f64)>);
}

/// A sum of squares over the curves of all frames.
pub trait Term {
    /// Passes every residual to the sink.
    fn walk(&self, curves: Curves<'_>, sink: &mut impl Sink);
}

/// The derivative by a point as two coordinates.
pub(super) fn by_point(coordinate: usize, derivative: Point) -> [(usize, f64); 2] {
    [(coordinate, derivative.x), (coordinate + 1, derivative.y)]
}
