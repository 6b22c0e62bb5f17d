//! A drawing turned, scaled and shifted.

use rototoon_base::geometry::Point;

/// p ↦ scale · rotate(p − source) + target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Movement {
    pub turn: f64,
    pub scale: f64,
    pub source: Point,
    pub target: Point,
}

impl Movement {
    pub fn apply(&self, p: Point) -> Point {
        (Point::from_angle(self.turn) * self.scale).rotate(p - self.source) + self.target
    }
}
