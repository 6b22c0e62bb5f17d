//! The error of a fit: an upper bound that is valid on the complete continuous curve, in both directions.
//!
//! **From points to curve.** The distance from a point to any foot on the curve is an upper bound of its distance from
//! the curve. The bound is tight because each foot is computed exactly on its piece and the neighbouring pieces.
//!
//! **From curve to line.** The distance to a segment is a convex function. On a part of a parabola it is therefore
//! nowhere larger than at the part's three control points. The curve is cut at the feet. Each part is compared with the
//! segments around its points, and halved as long as its bound is above the largest error found elsewhere, at most
//! [`HALVINGS`] times. The result is never below the true distance. It exceeds it by no more than the bend of the last
//! halves.

use rototoon_base::curve::{Quadratic, Spline};
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::nearest_on_segment;

/// Largest number of times that a part of the curve is halved.
const HALVINGS: usize = 10;
/// Number of segments on each side of its own with which a part is compared.
const REACH: usize = 4;

/// The line of the points, with the parameters of its points on the spline.
pub(super) struct Line<'a> {
    pub points: &'a [Point],
    pub closed: bool,
    pub parameters: &'a [f64],
}

/// The largest distance, in pixels, of a point from the curve and of the curve from the line of the points, with the
/// index of a point there. It writes the exact parameters of the points to `feet`.
pub(super) fn error(spline: &Spline, line: &Line, feet: &mut [f64]) -> (f64, usize) {
    let pieces: Vec<Quadratic> = spline.pieces().collect();
    let mut worst = (0.0, 0);
    for (j, &p) in line.points.iter().enumerate() {
        let (t, distance) = foot(spline, &pieces, p, line.parameters[j]);
        feet[j] = t;
        if distance > worst.0 {
            worst = (distance, j);
        }
    }
    curve_error(spline, &pieces, line, worst)
}

/// The parameter and the distance of the point nearest to `p` on the piece at parameter `t` and its neighbours.
fn foot(spline: &Spline, pieces: &[Quadratic], p: Point, t: f64) -> (f64, f64) {
    let count = pieces.len();
    let (i, u) = spline.locate(t);
    let mut best = (i as f64 + u, pieces[i].point(u).distance(p));
    let neighbours = [i.checked_sub(1), Some(i), Some(i + 1)];
    for k in neighbours {
        let k = match k {
            Some(k) if k < count => k,
            _ if !spline.is_closed() => continue,
            Some(_) => 0,
            None => count - 1,
        };
        let nearest = pieces[k].nearest(p);
        if nearest.distance < best.1 {
            best = (k as f64 + nearest.parameter, nearest.distance);
        }
    }
    best
}

/// Raises `worst` to the distance of the curve from the line of points.
fn curve_error(spline: &Spline, pieces: &[Quadratic], line: &Line, mut worst: (f64, usize)) -> (f64, usize) {
    let (n, count, closed) = (line.points.len(), pieces.len() as f64, spline.is_closed());
    // The curve is followed once from the first point on, along parameters that never fall.
    let first = if closed { line.parameters[0] } else { 0.0 };
    let mut reached = first;
    for j in 0..n {
        let end = match line.parameters.get(j + 1) {
            Some(&t) => ahead(t, reached, closed.then_some(count)),
            None if closed => first + count,
            None => count,
        };
        while reached < end {
            let t = if closed { reached.rem_euclid(count) } else { reached };
            let i = (t as usize).min(pieces.len() - 1);
            let from = t - i as f64;
            let to = (from + (end - reached)).min(1.0);
            let bound = part_error(&pieces[i].part(from, to), line, j, worst.0, HALVINGS);
            if bound > worst.0 {
                worst = (bound, j);
            }
            reached = if to == 1.0 { (reached - from).round() + 1.0 } else { end };
        }
    }
    worst
}

/// Parameter `t`, raised to at least `reached`. On a closed curve of `count` pieces it is first moved by full rounds.
fn ahead(mut t: f64, reached: f64, count: Option<f64>) -> f64 {
    if let Some(count) = count {
        t += ((reached - t) / count).round() * count;
    }
    t.max(reached)
}

fn part_error(part: &Quadratic, line: &Line, j: usize, floor: f64, halvings: usize) -> f64 {
    let n = line.points.len();
    let segment = |k: usize| (line.points[k % n], line.points[(k + 1) % n]);
    let bound = |k: usize| {
        let (a, b) = segment(k);
        [part.p0, part.p1, part.p2].into_iter().map(|p| p.distance(nearest_on_segment(p, a, b))).fold(0.0, f64::max)
    };
    let around = if line.closed {
        (j + n - REACH.min(n - 1), j + n + REACH.min(n - 1))
    } else {
        (j.saturating_sub(REACH), (j + REACH).min(n.saturating_sub(2)))
    };
    let mut best = bound(if line.closed || j + 1 < n { j } else { j.saturating_sub(1) });
    for k in around.0..=around.1 {
        if best <= floor {
            return best;
        }
        best = best.min(bound(k));
    }
    if best <= floor || halvings == 0 {
        return best;
    }
    let (left, right) = part.split(0.5);
    let error = part_error(&left, line, j, floor, halvings - 1);
    // The error of the first half is a floor for the second half.
    error.max(part_error(&right, line, j, floor.max(error), halvings - 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::geometry::polyline;

    proptest! {
        #[test]
        fn the_bound_is_never_below_dense_samples(
            guides in prop::collection::vec((-20.0f64..20.0, -20.0f64..20.0), 3..9), closed: bool,
            jitter in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0), 60),
        ) {
            let guides: Vec<Point> = guides.into_iter().map(Point::from).collect();
            let spline = Spline::new(guides, closed).unwrap();
            let count = spline.piece_count() as f64;
            let steps = if closed { 60.0 } else { 59.0 };
            let parameters: Vec<f64> = (0..60).map(|j| count * j as f64 / steps).collect();
            let points: Vec<Point> =
                parameters.iter().zip(&jitter).map(|(&t, &by)| spline.point(t) + Point::from(by)).collect();
            let line = Line { points: &points, closed, parameters: &parameters };
            let (bound, _) = error(&spline, &line, &mut parameters.clone());
            let to_curve = points.iter().map(|&p| spline.nearest(p).distance).fold(0.0, f64::max);
            let samples = spline.flattened(60);
            let to_line = samples.iter().map(|&p| polyline::distance(p, &points, closed)).fold(0.0, f64::max);
            prop_assert!(bound >= to_curve.max(to_line) - 1e-9, "{bound} {to_curve} {to_line}");
            // The bound is also not much too large: the points are within √2 of their own places, and the places of a
            // segment are within that of the curve between, apart from the bow of the curve.
            let bow = spline.pieces().map(|p| p.length()).fold(0.0, f64::max) * count / 60.0;
            prop_assert!(bound <= 2f64.sqrt() + bow + 1e-9, "{bound} {bow}");
        }
    }
}
