//! Distances of pixels to segments, and lines of a given width drawn with them.
//!
//! The distance of a pixel is that of its centre. Distances are computed only up to a reach, so the cost is
//! proportional to the number of pixels near the segments. The coverage of a pixel by a line is ½ plus half the line's
//! width minus the distance, clamped to 0 and 1. It is exact for straight vertical and horizontal lines wider than a
//! pixel, and within 0.1 for others.

use super::coverage::Window;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::Raster;

/// A piece of a segment, between two shares of the way from its first to its second end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// The segment's ends.
    pub ends: [Point; 2],
    /// Share at which the piece begins.
    pub from: f64,
    /// Share at which the piece ends.
    pub to: f64,
}

impl Stretch {
    fn at(&self, share: f64) -> Point {
        self.ends[0].lerp(self.ends[1], share)
    }

    /// The squared distance of a point to the piece.
    pub fn distance_squared(&self, p: Point) -> f64 {
        let along = self.ends[1] - self.ends[0];
        let size = along.length_squared();
        let share = if size > 0.0 { (p - self.ends[0]).dot(along) / size } else { 0.0 };
        self.at(share.clamp(self.from, self.to)).distance_squared(p)
    }

    /// The range of x within `reach` of the piece, in the row whose centre is at `y`; `None` if the row is too far
    /// away.
    fn columns(&self, y: f64, reach: f64) -> Option<(f64, f64)> {
        let (a, b) = (self.at(self.from), self.at(self.to));
        let (low, high) = (y - reach, y + reach);
        let (upper, lower) = if a.y <= b.y { (a, b) } else { (b, a) };
        if upper.y > high || lower.y < low {
            return None;
        }
        let at = |height: f64| {
            let share = if lower.y > upper.y { (height - upper.y) / (lower.y - upper.y) } else { 0.0 };
            upper.x + share.clamp(0.0, 1.0) * (lower.x - upper.x)
        };
        let level = lower.y <= upper.y;
        let (x0, x1) = if level { (upper.x, lower.x) } else { (at(low.max(upper.y)), at(high.min(lower.y))) };
        Some((x0.min(x1) - reach, x0.max(x1) + reach))
    }
}

/// Squared distances of the pixels of a window to the nearest piece; infinite beyond the reach. `None` if `go_on`,
/// called for each row, returns false.
pub(super) fn squared_distances(
    stretches: &[Stretch],
    reach: f64,
    window: Window,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Raster<f32>> {
    let mut result = Raster::new(window.width(), window.height(), f32::INFINITY);
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); window.height()];
    for (index, stretch) in stretches.iter().enumerate() {
        let (a, b) = (stretch.at(stretch.from).y, stretch.at(stretch.to).y);
        let first = ((a.min(b) - reach).floor() as i64).max(window.top);
        let last = ((a.max(b) + reach).ceil() as i64).min(window.bottom);
        for y in first..last {
            rows[(y - window.top) as usize].push(index as u32);
        }
    }
    for (y, near) in rows.iter().enumerate() {
        if !go_on() {
            return None;
        }
        let height = (window.top + y as i64) as f64 + 0.5;
        let row = result.row_mut(y);
        for stretch in near.iter().map(|&index| &stretches[index as usize]) {
            let Some((x0, x1)) = stretch.columns(height, reach) else { continue };
            let first = ((x0 - 0.5).floor() as i64).max(window.left);
            let last = ((x1 + 0.5).ceil() as i64).min(window.right);
            for x in first..last {
                let value = &mut row[(x - window.left) as usize];
                *value = value.min(stretch.distance_squared(Point::new(x as f64 + 0.5, height)) as f32);
            }
        }
    }
    Some(result)
}

/// Coverage, 0 to 1, of lines along polylines in a window. Each polyline comes with whether it is closed; `width` is in
/// pixels. `None` if `go_on`, called for each row, returns false.
pub fn lines(
    polylines: &[(Vec<Point>, bool)],
    width: f64,
    window: Window,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Raster<f32>> {
    // A line thinner than a pixel is drawn one pixel wide, with its width as opacity.
    let (half, strength) = (0.5 * width.max(1.0), width.clamp(0.0, 1.0) as f32);
    let stretches: Vec<Stretch> = polylines
        .iter()
        .filter(|(points, _)| points.iter().all(|p| p.is_finite()))
        .flat_map(|(points, closed)| polyline::segments(points, *closed))
        .map(|(a, b)| Stretch { ends: [a, b], from: 0.0, to: 1.0 })
        .collect();
    let distances = squared_distances(&stretches, half + 0.5, window, go_on)?;
    Some(distances.map(|d| strength * (0.5 + half as f32 - d.sqrt()).clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn an_upright_line_is_as_wide_as_it_should_be() {
        let window = Window { left: 0, top: 0, right: 9, bottom: 3 };
        for width in [0.5, 1.0, 2.5, 4.0] {
            let line = vec![(vec![p(4.3, -9.0), p(4.3, 9.0)], false)];
            let picture = lines(&line, width, window, &mut || true).unwrap();
            let sum: f32 = picture.row(1).iter().sum();
            assert!((f64::from(sum) - width).abs() < 1e-5, "{width}: {sum}");
        }
    }

    #[test]
    fn distances_are_those_to_the_nearest_segment() {
        let points = [p(2.0, 3.0), p(11.0, 5.5), p(4.0, 12.0), p(4.0, 12.0)];
        let stretches: Vec<Stretch> =
            polyline::segments(&points, true).map(|(a, b)| Stretch { ends: [a, b], from: 0.0, to: 1.0 }).collect();
        let window = Window { left: -3, top: -2, right: 17, bottom: 16 };
        let picture = squared_distances(&stretches, 3.0, window, &mut || true).unwrap();
        for y in 0..window.height() {
            for x in 0..window.width() {
                let centre = p(x as f64 - 2.5, y as f64 - 1.5);
                let wanted = polyline::distance(centre, &points, true);
                let found = f64::from(picture.get(x, y)).sqrt();
                assert!((wanted - found).abs() < 1e-4 || wanted > 3.0 && found > 3.0, "{x} {y}: {found} {wanted}");
            }
        }
        assert_eq!(squared_distances(&stretches, 3.0, window, &mut || false), None);
    }
}
