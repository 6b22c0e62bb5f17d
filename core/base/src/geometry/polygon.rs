//! Polygons: area, centre, inside test, pixel mask.

use super::Point;

/// Area in px² by the shoelace formula; positive where the points run clockwise on the screen (x right, y down).
pub fn signed_area(points: &[Point]) -> f64 {
    let n = points.len();
    0.5 * (0..n).map(|i| points[i].perp_dot(points[(i + 1) % n])).sum::<f64>()
}

/// Mean of the points: the "part centre" of Zhou & Xiao 2011, eq. 9. It is the origin where there are no points.
pub fn center(points: &[Point]) -> Point {
    if points.is_empty() {
        return Point::ZERO;
    }
    points.iter().sum::<Point>() / points.len() as f64
}

/// Smallest and largest coordinates; `None` where there are no points.
pub fn bounds(points: &[Point]) -> Option<(Point, Point)> {
    let &first = points.first()?;
    Some(points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
}

/// Whether `p` is inside, by the even-odd rule.
pub fn contains(points: &[Point], p: Point) -> bool {
    let mut inside = false;
    let mut previous = match points.last() {
        Some(&last) => last,
        None => return false,
    };
    for &current in points {
        if (current.y > p.y) != (previous.y > p.y)
            && p.x < (previous.x - current.x) * (p.y - current.y) / (previous.y - current.y) + current.x
        {
            inside = !inside;
        }
        previous = current;
    }
    inside
}

/// Calls `span(y, x0, x1)` for each run of pixels `x0..x1` of row `y` whose centres are inside the polygon (even-odd),
/// within a picture of `width` × `height` pixels. Rows come in order, and the runs of a row from left to right.
pub fn for_each_span(points: &[Point], width: usize, height: usize, mut span: impl FnMut(usize, usize, usize)) {
    let Some((low, high)) = bounds(points) else { return };
    let first = (low.y - 0.5).ceil().max(0.0);
    let last = (high.y - 0.5).floor().min(height as f64 - 1.0);
    if first > last || width == 0 {
        return;
    }
    let mut crossings = Vec::new();
    for y in first as usize..=last as usize {
        let line = y as f64 + 0.5;
        crossings.clear();
        let n = points.len();
        for i in 0..n {
            let (a, b) = (points[i], points[(i + 1) % n]);
            if (a.y > line) != (b.y > line) {
                crossings.push(a.x + (line - a.y) / (b.y - a.y) * (b.x - a.x));
            }
        }
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let x0 = (pair[0] - 0.5).ceil().clamp(0.0, width as f64) as usize;
            let x1 = (pair[1] - 0.5).ceil().clamp(0.0, width as f64) as usize;
            if x0 < x1 {
                span(y, x0, x1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Vec<Point> {
        vec![Point::new(0.0, 0.0), Point::new(6.0, 0.0), Point::new(0.0, 6.0)]
    }

    #[test]
    fn area_is_signed_by_direction() {
        assert_eq!(signed_area(&triangle()), 18.0);
        let reversed: Vec<_> = triangle().into_iter().rev().collect();
        assert_eq!(signed_area(&reversed), -18.0);
    }

    #[test]
    fn spans_cover_the_pixels_whose_centres_are_inside() {
        let mut covered = [[false; 7]; 7];
        for_each_span(&triangle(), 7, 7, |y, x0, x1| covered[y][x0..x1].fill(true));
        for y in 0..7 {
            for x in 0..7 {
                let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                assert_eq!(covered[y][x], contains(&triangle(), p), "{x} {y}");
            }
        }
    }

    #[test]
    fn spans_are_clipped_to_the_picture() {
        let mut count = 0;
        let big: Vec<_> = triangle().iter().map(|&p| p * 100.0 - Point::splat(50.0)).collect();
        for_each_span(&big, 4, 3, |y, x0, x1| {
            assert!(y < 3 && x1 <= 4);
            count += x1 - x0;
        });
        assert_eq!(count, 12);
    }
}
