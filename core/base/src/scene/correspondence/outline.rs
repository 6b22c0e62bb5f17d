//! Contours reduced to the features by which shapes are compared, and the alignment of two of them.
//!
//! Both curves are sampled evenly by arc length and centred. As complex numbers p and q of unit mean square their best
//! similarity is r = mean(conj(p) q), and the share 1 − |r|² of the variance remains (as in `geometry::similarity`).
//! For closed curves all starting points are tried. An open curve may be drawn in either direction. A closed curve has
//! the same orientation on both drawings, so its direction follows from the sign of the area, unless it encloses hardly
//! any.

use super::DrawnContour;
use crate::geometry::{Point, polygon, polyline};

/// Number of samples of a curve.
pub(super) const SAMPLES: usize = 48;

/// Smallest radius, in pixels. A dot counts as that large.
const LEAST_RADIUS: f64 = 0.5;

/// Area relative to the squared length above which a closed curve has an orientation (a circle has 0.08).
const LEAST_AREA: f64 = 0.005;

/// A contour prepared for comparison.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// Mean of the samples.
    pub centre: Point,
    /// Root mean square distance of the samples from the centre, in pixels; at least [`LEAST_RADIUS`].
    pub radius: f64,
    /// Length in pixels.
    pub length: f64,
    /// Evenly spaced samples, centred and divided by the radius.
    samples: Vec<Point>,
    /// Sign of the area; 0 for open and for thin curves.
    turning: i8,
    closed: bool,
}

/// One alignment of a curve with another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Alignment {
    /// Unexplained share of the variance, 0 to 1.
    pub residual: f64,
    /// Rotation in radians, from x towards y.
    pub turn: f64,
    /// Whether the other curve is traversed backwards.
    pub reversed: bool,
    /// Position of the first sample on the other curve, as a share of its length from its first point.
    pub start: f64,
}

impl Outline {
    /// The outline of a contour, taken as closed or open. `None` if it has no points.
    pub fn new(contour: &DrawnContour, closed: bool) -> Option<Self> {
        let points = as_curve(contour, closed);
        let samples = polyline::resample(&points, closed, SAMPLES);
        let centre = if samples.is_empty() { return None } else { polygon::center(&samples) };
        let square = samples.iter().map(|p| p.distance_squared(centre)).sum::<f64>() / SAMPLES as f64;
        let radius = square.sqrt().max(LEAST_RADIUS);
        let length = polyline::length(&points, closed);
        let area = if closed { polygon::signed_area(&points) } else { 0.0 };
        let turning = if area.abs() > LEAST_AREA * length * length { area.signum() as i8 } else { 0 };
        let samples = samples.iter().map(|&p| (p - centre) / radius).collect();
        Some(Self { centre, radius, length, samples, turning, closed })
    }

    /// All alignments of this curve with `other`. Both are closed or both are open.
    pub fn alignments(&self, other: &Self) -> Vec<Alignment> {
        let mut result = Vec::new();
        for reversed in [false, true] {
            let turned_round = self.turning * other.turning == -1;
            if self.turning * other.turning != 0 && reversed != turned_round {
                continue;
            }
            let starts = if self.closed { SAMPLES } else { 1 };
            result.extend((0..starts).map(|start| self.align(other, start, reversed)));
        }
        result
    }

    fn align(&self, other: &Self, start: usize, reversed: bool) -> Alignment {
        let first = if reversed && !self.closed { SAMPLES - 1 } else { start };
        let mut factor = Point::ZERO;
        for (k, p) in self.samples.iter().enumerate() {
            let index = if reversed { first + SAMPLES - k } else { first + k } % SAMPLES;
            let q = other.samples[index];
            factor += Point::new(p.dot(q), p.perp_dot(q));
        }
        factor /= SAMPLES as f64;
        // Two dots have no shape that could differ.
        let flat = |outline: &Self| outline.samples.iter().all(|p| *p == Point::ZERO);
        let residual = if flat(self) && flat(other) { 0.0 } else { (1.0 - factor.length_squared()).clamp(0.0, 1.0) };
        let steps = if self.closed { SAMPLES } else { SAMPLES - 1 };
        Alignment { residual, turn: factor.to_angle(), reversed, start: first as f64 / steps as f64 }
    }
}

/// The points of a contour as a closed or an open curve. A closed contour taken as open ends at its first point.
pub(super) fn as_curve(contour: &DrawnContour, closed: bool) -> Vec<Point> {
    let mut points = contour.points.clone();
    if contour.closed && !closed && points.len() > 2 {
        points.push(points[0]);
    }
    points
}

/// The equivalent angle from −π to π.
pub(super) fn wrap(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hook(closed: bool) -> DrawnContour {
        let points = [(0.0, 0.0), (30.0, 0.0), (30.0, 12.0), (9.0, 15.0)];
        DrawnContour { points: points.map(|(x, y)| Point::new(x, y)).into(), closed, ..Default::default() }
    }

    #[test]
    fn a_turned_and_reversed_curve_is_laid_upon_exactly() {
        for closed in [false, true] {
            let original = hook(closed);
            let turn = Point::from_angle(0.8) * 1.5;
            let mut moved = original.clone();
            moved.points = original.points.iter().rev().map(|&p| turn.rotate(p) + Point::new(50.0, 9.0)).collect();
            let (a, b) = (Outline::new(&original, closed).unwrap(), Outline::new(&moved, closed).unwrap());
            let best = a.alignments(&b).into_iter().min_by(|a, b| a.residual.total_cmp(&b.residual)).unwrap();
            assert!(best.reversed);
            assert!(best.residual < 0.01, "{best:?}");
            assert!((best.turn - 0.8).abs() < 0.05, "{best:?}");
            assert!((b.radius / a.radius - 1.5).abs() < 1e-2);
        }
    }

    #[test]
    fn angles_wrap() {
        assert!((wrap(3.5 * std::f64::consts::PI) + 0.5 * std::f64::consts::PI).abs() < 1e-12);
    }
}
