//! Points of contours with handles, as formats with Bézier shapes have them.

use rototoon_base::geometry::Point;

/// A point of a contour, with handles relative to it. Handles of 0 make straight sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// The point, in pixels.
    pub at: Point,
    /// The handle before it.
    pub before: Point,
    /// The handle after it.
    pub after: Point,
}

impl Knot {
    /// A point without handles.
    pub fn bare(at: Point) -> Self {
        Self { at, before: Point::ZERO, after: Point::ZERO }
    }

    /// The places of the handles before and after the point.
    pub fn handles(&self) -> [Point; 2] {
        [self.at + self.before, self.at + self.after]
    }
}
