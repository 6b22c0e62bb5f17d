//! Sides of polygons, with heights as integers.

use rototoon_base::geometry::{Point, polyline};

/// Steps in a row: the unit of heights and of the area of a pixel.
pub const ROW: i64 = 1 << 24;

/// A side of a polygon, from its upper to its lower end.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Height of the upper end, in steps of [`ROW`].
    pub top: i64,
    /// Height of the lower end, in steps; greater than `top`.
    pub bottom: i64,
    x: f64,
    slope: f64,
    /// Index of the polygon.
    pub polygon: usize,
    /// Change of the polygon's winding number from left to right.
    pub winding: i32,
    /// The ends of the side before rounding.
    pub ends: [Point; 2],
}

impl Edge {
    fn new(polygon: usize, a: Point, b: Point) -> Option<Self> {
        let height = |p: Point| (p.y * ROW as f64).round() as i64;
        let (a_y, b_y) = (height(a), height(b));
        let ((upper, top), (lower, bottom), winding) =
            if a_y < b_y { ((a, a_y), (b, b_y), 1) } else { ((b, b_y), (a, a_y), -1) };
        let slope = (lower.x - upper.x) / (bottom - top) as f64;
        (top < bottom).then_some(Self { top, bottom, x: upper.x, slope, polygon, winding, ends: [upper, lower] })
    }

    /// Its x at a height.
    pub fn at(&self, height: i64) -> f64 {
        self.x + (height - self.top) as f64 * self.slope
    }

    /// Its least and greatest x between two heights.
    pub fn range(&self, top: i64, bottom: i64) -> (f64, f64) {
        let (above, below) = (self.at(top.max(self.top)), self.at(bottom.min(self.bottom)));
        (above.min(below), above.max(below))
    }
}

/// Polygons at one instant.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Sides in the order of their upper ends.
    pub edges: Vec<Edge>,
    /// Number of polygons.
    pub polygons: usize,
}

impl Instant {
    /// The sides of closed polygons. A polygon with a coordinate that is not finite has none.
    pub fn new(polygons: &[Vec<Point>]) -> Self {
        let mut edges = Vec::new();
        for (index, points) in polygons.iter().enumerate().filter(|(_, points)| points.iter().all(|p| p.is_finite())) {
            edges.extend(polyline::segments(points, true).filter_map(|(a, b)| Edge::new(index, a, b)));
        }
        edges.sort_by_key(|edge| edge.top);
        Self { edges, polygons: polygons.len() }
    }
}
