//! Position of a closed stroke's first point on its counterpart, finer than the samples of `outline` allow.
//!
//! Several starts around the rough one are tried. The best start is the one at which the best similarity explains most
//! of the shape. The reach of 8/256 of the length is one step of the rough search.

use super::super::line::Line;
use super::super::stroke::Stroke;
use rototoon_base::geometry::Point;

/// Number of samples of a stroke.
const SAMPLES: usize = 64;
/// Number of starts tried on each side, and the distance between them as a share of the length.
const STARTS: (i32, f64) = (8, 1.0 / 256.0);

/// The position of `stroke`'s first point on `other`, as a share of `other`'s length, near a rough one. Both are
/// closed.
pub(super) fn refined(stroke: &Stroke, other: &Stroke, rough: f64, reversed: bool) -> f64 {
    if stroke.points.is_empty() || other.points.is_empty() {
        return rough;
    }
    let (a, b) = (Line::new(stroke), Line::new(other));
    let from: Vec<Point> = (0..SAMPLES).map(|k| a.at(k as f64 / SAMPLES as f64)).collect();
    let centre = rototoon_base::geometry::polygon::center(&from);
    let sign = if reversed { -1.0 } else { 1.0 };
    let likeness = |start: f64| {
        let to = (0..SAMPLES).map(|k| b.at((start + sign * k as f64 / SAMPLES as f64).rem_euclid(1.0)));
        let mut sum = Point::ZERO;
        for (p, q) in from.iter().zip(to) {
            let p = *p - centre;
            sum += Point::new(p.dot(q), p.perp_dot(q));
        }
        sum.length()
    };
    let (reach, step) = STARTS;
    let mut best = (likeness(rough) * (1.0 + 1e-6), rough);
    for k in (1..=reach).flat_map(|k| [-k, k]) {
        let start = (rough + f64::from(k) * step).rem_euclid(1.0);
        let found = likeness(start);
        if found > best.0 {
            best = (found, start);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rough_start_is_refined() {
        let blob = |t: f64| Point::from_angle(t) * (30.0 + 6.0 * (2.0 * t).cos() + 4.0 * (3.0 * t).sin());
        let around = |count: usize, shift: f64| {
            let at = |k: usize| blob(std::f64::consts::TAU * (k as f64 / count as f64 + shift));
            Stroke::new((0..count).map(at).collect(), true)
        };
        let (a, b) = (around(200, 0.0), around(150, 0.3));
        let exact = refined(&a, &b, 0.7, false);
        assert!((refined(&a, &b, exact + 0.025, false) - exact).abs() < 0.005, "{exact}");
        let start = Line::new(&b).at(exact);
        assert!(start.distance(a.points[0]) < 1.5, "{start}");
    }
}
