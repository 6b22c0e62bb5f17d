//! Strokes that only one of two drawings has: how they vanish and appear between them.

use rototoon_base::geometry::{Point, polygon};

/// The behaviour of strokes that only one of two drawings has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Leaving {
    /// They shrink into their middle, or grow out of it (Yang et al. 1986).
    #[default]
    Grow,
    /// They become transparent, or appear out of transparency.
    Fade,
    /// They move out of a picture of this size, away from its middle, or into it.
    Leave {
        /// Width and height of the picture, in pixels.
        size: Point,
    },
}

impl Leaving {
    /// The points and the opacity of such a stroke. `there` is 1 where it is all there and 0 where it is gone.
    pub(super) fn drawn(self, points: Vec<Point>, there: f64) -> (Vec<Point>, f64) {
        let middle = polygon::center(&points);
        match self {
            Self::Grow => (points.iter().map(|p| middle.lerp(*p, there)).collect(), 1.0),
            Self::Fade => (points, there),
            Self::Leave { size } => {
                let away = way_out(&points, size) * (1.0 - there);
                (points.iter().map(|p| *p + away).collect(), 1.0)
            }
        }
    }
}

/// The shift that moves points just outside a picture, away from its middle.
fn way_out(points: &[Point], size: Point) -> Point {
    let Some((low, high)) = polygon::bounds(points) else { return Point::ZERO };
    let way = (0.5 * (low + high) - 0.5 * size).normalize_or(Point::X);
    let out = |way: f64, low: f64, high: f64, size: f64| {
        if way > 1e-9 {
            (size - low) / way
        } else if way < -1e-9 {
            high / -way
        } else {
            f64::INFINITY
        }
    };
    way * out(way.x, low.x, high.x, size.x).min(out(way.y, low.y, high.y, size.y)).max(0.0)
}
