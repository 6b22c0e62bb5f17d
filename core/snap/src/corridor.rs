//! The strip of pixels around a segment that its path may use.
//!
//! It contains all pixels whose centre is within the half width of the segment: a rectangle with a half disc at each
//! end.
//!
//! The half width is a share of the segment's length, because the drawn curve bulges from its chord by a share of the
//! length (an arc of 120° by 0.29 of the chord). It has limits, which grow with the picture's height. The lower limit
//! gives short segments room for imprecise ends. The upper limit keeps the paths of long segments from running away
//! along another line.

use super::cost::REFERENCE_LINES;
use rototoon_base::geometry::{Point, polyline};

/// Pixels that a path may use, in a bounding box within the picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Corridor {
    /// Left column of the box.
    pub x: usize,
    /// Top row of the box.
    pub y: usize,
    /// Columns of the box.
    pub width: usize,
    /// Rows of the box.
    pub height: usize,
    /// By pixel of the box, row by row: the squared distance from the segment, divided by the squared half width. It is
    /// 0 on the segment, 1 on the border of the strip and infinite outside.
    pub remoteness: Vec<f32>,
}

/// How wide the strip around a segment is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorridorWidth {
    /// Half width as a share of the segment's length.
    pub share: f64,
    /// Least half width in pixels at 540 lines. It grows with the picture's height.
    pub least: f64,
    /// Greatest half width in pixels at 540 lines. It grows with the picture's height.
    pub most: f64,
}

impl Default for CorridorWidth {
    fn default() -> Self {
        Self { share: 0.3, least: 4.0, most: 40.0 }
    }
}

impl CorridorWidth {
    /// Half width in pixels for a segment of `length` pixels in a picture of `lines` rows. It is never below 1.5 px at
    /// 540 lines.
    pub fn half_width(&self, length: f64, lines: usize) -> f64 {
        let scale = (lines as f64 / REFERENCE_LINES).max(1.0);
        let least = if self.least >= 1.5 { self.least } else { 1.5 } * scale;
        let wanted = (self.share * length).min(self.most * scale);
        // A NaN fails each comparison, so the result is the lower limit.
        if wanted > least { wanted } else { least }
    }
}

impl Corridor {
    /// The strip around the segment `a`–`b`, in pixels. Both ends must be in the picture, which has the width and
    /// height `size`.
    pub fn new(a: Point, b: Point, half_width: f64, size: (usize, usize)) -> Self {
        let low = (a.min(b) - half_width).floor().max(Point::ZERO);
        let high = (a.max(b) + half_width).ceil().min(Point::new(size.0 as f64, size.1 as f64));
        let (x, y) = (low.x as usize, low.y as usize);
        let (width, height) = (high.x as usize - x, high.y as usize - y);
        let mut remoteness = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let p = Point::new((x + column) as f64 + 0.5, (y + row) as f64 + 0.5);
                let away = p.distance_squared(polyline::nearest_on_segment(p, a, b)) / (half_width * half_width);
                remoteness.push(if away <= 1.0 { away as f32 } else { f32::INFINITY });
            }
        }
        Self { x, y, width, height, remoteness }
    }

    /// Index in the box of the pixel that contains `p`, a point of the picture.
    pub fn index(&self, p: Point) -> usize {
        let column = (p.x as usize - self.x).min(self.width - 1);
        let row = (p.y as usize - self.y).min(self.height - 1);
        row * self.width + column
    }

    /// Column and row in the picture of a pixel of the box.
    pub fn pixel(&self, index: usize) -> (usize, usize) {
        (self.x + index % self.width, self.y + index / self.width)
    }

    /// Whether a pixel of the box belongs to the strip.
    pub fn contains(&self, index: usize) -> bool {
        self.remoteness[index].is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corridor_is_the_pixels_near_the_segment() {
        let (a, b) = (Point::new(10.2, 8.4), Point::new(30.9, 17.0));
        let corridor = Corridor::new(a, b, 5.0, (35, 60));
        for y in 0..60usize {
            for x in 0..35usize {
                let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                let near = polyline::distance(p, &[a, b], false) <= 5.0;
                let (column, row) = (x.wrapping_sub(corridor.x), y.wrapping_sub(corridor.y));
                let inside = column < corridor.width
                    && row < corridor.height
                    && corridor.contains(row * corridor.width + column);
                assert_eq!(near, inside, "{x} {y}");
            }
        }
        assert_eq!(corridor.pixel(corridor.index(a)), (10, 8));
    }

    #[test]
    fn the_width_has_limits() {
        let width = CorridorWidth::default();
        assert_eq!(width.half_width(1.0, 540), 4.0);
        assert_eq!(width.half_width(50.0, 540), 15.0);
        assert_eq!(width.half_width(1000.0, 540), 40.0);
        assert_eq!(width.half_width(1000.0, 1080), 80.0);
        let broken = CorridorWidth { share: f64::NAN, least: f64::NAN, most: 3.0 };
        assert!(broken.half_width(10.0, 540) >= 1.5);
    }
}
