//! Where a branch would go on behind its end.
//!
//! Good continuation is a matter of direction and of curvature. So a parabola is laid through the last stretch of a branch
//! (least squares, what is near to the end counting most), and its direction is taken half a width behind the end, where the
//! lines of a junction meet. A stretch of a few widths is long enough to average the grain and short enough not to see the
//! next bend.

use crate::graph::Graph;
use rototoon_base::geometry::Point;

/// Length of the stretch, in widths and pixels.
const STRETCH_WIDTHS: f64 = 2.5;
const STRETCH_PIXELS: f64 = 4.0;
/// How much less the far end of the stretch counts.
const FADE: f64 = 0.7;
/// Points of the shortest stretch that has a curve.
const LEAST: usize = 4;

/// An end of a branch: its index, and 0 for the first point or 1 for the last.
pub type End = (usize, usize);

/// The place of an end.
pub fn place(graph: &Graph, (branch, side): End) -> Point {
    let points = &graph.branches[branch].points;
    if side == 0 { points[0] } else { points[points.len() - 1] }
}

/// Half the width of a branch near its end.
pub fn radius(graph: &Graph, (branch, side): End) -> f64 {
    let radii = &graph.branches[branch].radii;
    let count = radii.len().min(8);
    let near = if side == 0 { &radii[..count] } else { &radii[radii.len() - count..] };
    near.iter().sum::<f64>() / count as f64
}

/// The direction in which a branch would go on behind its end; zero for a branch of one point.
pub fn outward(graph: &Graph, end: End) -> Point {
    let points = &graph.branches[end.0].points;
    let at = |k: usize| if end.1 == 0 { points[k] } else { points[points.len() - 1 - k] };
    let own = radius(graph, end);
    let reach = 2.0 * STRETCH_WIDTHS * own + STRETCH_PIXELS;
    let mut stretch = vec![(0.0, Point::ZERO)];
    for k in 1..points.len() {
        let far = stretch[k - 1].0 + at(k).distance(at(k - 1));
        stretch.push((far, at(k) - at(0)));
        if far >= reach {
            break;
        }
    }
    let (length, last) = stretch[stretch.len() - 1];
    let chord = (-last).normalize_or_zero();
    if stretch.len() < LEAST {
        return chord;
    }
    match parabola(&stretch, |far| 1.0 - FADE * far / length) {
        Some((slope, curve)) => (2.0 * own * curve - slope).normalize_or(chord),
        None => chord,
    }
}

/// The angle between two directions; half a radian where one is unknown.
pub fn angle(a: Point, b: Point) -> f64 {
    if a == Point::ZERO || b == Point::ZERO { 0.5 } else { a.angle_to(b).abs() }
}

/// Slope and curve of `p + slope s + curve s²`, the parabola of least squares through places at the arc lengths `s`.
fn parabola(stretch: &[(f64, Point)], weight: impl Fn(f64) -> f64) -> Option<(Point, Point)> {
    let mut sums = [0.0f64; 5];
    let mut right = [Point::ZERO; 3];
    for &(s, place) in stretch {
        let mut power = weight(s);
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += power;
            if k < 3 {
                right[k] += power * place;
            }
            power *= s;
        }
    }
    // Cramer's rule for a symmetric system of three.
    let ([a, b, c, d, e], [u, v, w]) = (sums, right);
    let determinant = a * (c * e - d * d) - b * (b * e - c * d) + c * (b * d - c * c);
    if determinant.abs() < 1e-9 {
        return None;
    }
    let slope = u * (c * d - b * e) + v * (a * e - c * c) + w * (b * c - a * d);
    let curve = u * (b * d - c * c) + v * (b * c - a * d) + w * (a * c - b * b);
    Some((slope / determinant, curve / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_found_exactly() {
        let (slope, curve) = (Point::new(0.8, -0.3), Point::new(-0.02, 0.05));
        let at = |s: f64| (s, Point::new(3.0, 1.0) + slope * s + curve * s * s);
        let stretch: Vec<(f64, Point)> = (0..9).map(|k| at(1.3 * f64::from(k))).collect();
        let (found, bent) = parabola(&stretch, |s| 1.0 - 0.05 * s).unwrap();
        assert!(found.distance(slope) < 1e-9 && bent.distance(curve) < 1e-9, "{found} {bent}");
    }
}
