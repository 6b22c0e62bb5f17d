//! Distances on the screen. The pen picks what is a few screen pixels away, at any zoom, render scale and pixel aspect.

use rototoon::geometry::Point;

/// Converts distances in pixels of the footage to screen pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    scale: Point,
}

impl Lens {
    /// A lens with which a pixel of the footage is `scale` screen pixels wide and high.
    pub fn new(scale: Point) -> Self {
        let usable = |value: f64| if value.is_finite() && value > 0.0 { value } else { 1.0 };
        Self { scale: Point::new(usable(scale.x.abs()), usable(scale.y.abs())) }
    }

    /// The distance of two points in screen pixels.
    pub fn distance(&self, a: Point, b: Point) -> f64 {
        ((a - b) * self.scale).length()
    }

    /// The nearest point of a segment on the screen: its share of the way, and its distance in screen pixels.
    pub fn nearest(&self, p: Point, a: Point, b: Point) -> (f64, f64) {
        let (along, off) = ((b - a) * self.scale, (p - a) * self.scale);
        let size = along.length_squared();
        let share = if size > 0.0 { (off.dot(along) / size).clamp(0.0, 1.0) } else { 0.0 };
        (share, (along * share).distance(off))
    }

    /// A vector of screen pixels in pixels of the footage.
    pub fn footage(&self, screen: Point) -> Point {
        screen / self.scale
    }

    /// A vector of pixels of the footage in screen pixels.
    pub fn screen(&self, footage: Point) -> Point {
        footage * self.scale
    }
}
