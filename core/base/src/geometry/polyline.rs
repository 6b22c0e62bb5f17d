//! Polylines: length, resampling by arc length, distance of a point.

use super::Point;

/// Largest coordinate accepted in drawings, in pixels. Beyond it, differences and squares of coordinates would lose
/// details smaller than a pixel.
pub const FARTHEST: f64 = 1e9;

/// Index of the first point with a coordinate that is not a number or beyond [`FARTHEST`].
pub fn first_unusable(points: &[Point]) -> Option<usize> {
    points.iter().position(|p| p.is_nan() || p.abs().max_element() > FARTHEST)
}

/// Length in pixels of a polyline. For a closed one the segment from the last point to the first counts too.
pub fn length(points: &[Point], closed: bool) -> f64 {
    segments(points, closed).map(|(a, b)| a.distance(b)).sum()
}

/// The segments of a polyline in order. A closed one ends with the segment from the last point to the first.
pub fn segments(points: &[Point], closed: bool) -> impl Iterator<Item = (Point, Point)> + '_ {
    let n = points.len();
    let count = if closed && n > 1 { n } else { n.saturating_sub(1) };
    (0..count).map(move |i| (points[i], points[(i + 1) % n]))
}

/// `count` points evenly spaced by arc length. An open polyline keeps both ends, a closed one its first point.
///
/// A polyline without length (or of one point) gives `count` copies of its first point. An empty one gives no points.
pub fn resample(points: &[Point], closed: bool, count: usize) -> Vec<Point> {
    let Some(&first) = points.first() else { return Vec::new() };
    let total = length(points, closed);
    if total <= 0.0 || count < 2 {
        return vec![first; count];
    }
    let steps = if closed { count } else { count - 1 };
    let mut result = Vec::with_capacity(count);
    let mut walked = 0.0;
    let mut pieces = segments(points, closed).peekable();
    for k in 0..count {
        let target = total * k as f64 / steps as f64;
        while let Some(&(a, b)) = pieces.peek() {
            let step = a.distance(b);
            if walked + step >= target && step > 0.0 {
                break;
            }
            walked += step;
            pieces.next();
        }
        result.push(match pieces.peek() {
            Some(&(a, b)) => a.lerp(b, ((target - walked) / a.distance(b)).clamp(0.0, 1.0)),
            None => {
                if closed {
                    first
                } else {
                    points[points.len() - 1]
                }
            }
        });
    }
    result
}

/// The point of segment `a`–`b` nearest to `p`.
pub fn nearest_on_segment(p: Point, a: Point, b: Point) -> Point {
    let d = b - a;
    let length_squared = d.length_squared();
    if length_squared <= f64::MIN_POSITIVE {
        return a;
    }
    a + d * ((p - a).dot(d) / length_squared).clamp(0.0, 1.0)
}

/// Distance in pixels from `p` to the polyline; infinite where the polyline is empty.
pub fn distance(p: Point, points: &[Point], closed: bool) -> f64 {
    if let [only] = points {
        return p.distance(*only);
    }
    segments(points, closed).map(|(a, b)| p.distance(nearest_on_segment(p, a, b))).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Point> {
        vec![Point::new(0.0, 0.0), Point::new(4.0, 0.0), Point::new(4.0, 4.0), Point::new(0.0, 4.0)]
    }

    #[test]
    fn length_counts_the_closing_segment_of_closed_lines_only() {
        assert_eq!(length(&square(), false), 12.0);
        assert_eq!(length(&square(), true), 16.0);
        assert_eq!(length(&[], true), 0.0);
    }

    #[test]
    fn resampling_keeps_the_ends_and_the_spacing() {
        let open = resample(&square(), false, 5);
        assert_eq!(open[0], Point::new(0.0, 0.0));
        assert_eq!(open[4], Point::new(0.0, 4.0));
        assert_eq!(open[1], Point::new(3.0, 0.0));
        let closed = resample(&square(), true, 8);
        assert_eq!(closed[1], Point::new(2.0, 0.0));
        assert_eq!(closed[7], Point::new(0.0, 2.0));
    }

    #[test]
    fn a_line_without_length_resamples_to_copies() {
        assert_eq!(resample(&[Point::ONE, Point::ONE], false, 3), vec![Point::ONE; 3]);
        assert!(resample(&[], true, 3).is_empty());
    }

    #[test]
    fn distance_is_to_the_nearest_segment() {
        assert_eq!(distance(Point::new(-1.0, 2.0), &square(), false), 5f64.sqrt());
        assert_eq!(distance(Point::new(-1.0, 2.0), &square(), true), 1.0);
    }
}
