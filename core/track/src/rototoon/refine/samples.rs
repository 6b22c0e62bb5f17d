//! The samples of a contour, the places at which it is compared with the picture: control points and one point between
//! each two.

use rototoon_base::geometry::Point;

/// Weights of the four control points around a segment for its Catmull–Rom midpoint.
const MIDPOINT: [f64; 4] = [-1.0 / 16.0, 9.0 / 16.0, 9.0 / 16.0, -1.0 / 16.0];
/// Weight of a midpoint's pull relative to a control point's.
const MIDPOINT_TRUST: f64 = 0.5;

/// Each sample as a weighted sum of control points, in the order of the contour.
pub struct Samples {
    terms: Vec<Vec<(usize, f64)>>,
    closed: bool,
}

impl Samples {
    /// The samples of a contour with `count` control points.
    pub fn new(count: usize, closed: bool) -> Self {
        let mut terms = Vec::new();
        for j in 0..count {
            terms.push(vec![(j, 1.0)]);
            if !closed && j + 1 == count {
                break;
            }
            let at = |offset: isize| {
                let index = j as isize + offset;
                if closed {
                    index.rem_euclid(count as isize) as usize
                } else {
                    index.clamp(0, count as isize - 1) as usize
                }
            };
            terms.push([-1, 0, 1, 2].map(at).into_iter().zip(MIDPOINT).collect());
        }
        Self { terms, closed }
    }

    /// The control points and weights of a sample.
    pub fn terms(&self, s: usize) -> &[(usize, f64)] {
        &self.terms[s]
    }

    /// Number of samples.
    pub fn count(&self) -> usize {
        self.terms.len()
    }

    /// Weight of a sample's pull.
    pub fn trust(&self, s: usize) -> f64 {
        if self.terms[s].len() == 1 { 1.0 } else { MIDPOINT_TRUST }
    }

    /// Places of the samples for the control points given.
    pub fn places(&self, points: &[Point]) -> Vec<Point> {
        self.terms.iter().map(|terms| terms.iter().map(|&(j, w)| points[j] * w).sum()).collect()
    }

    /// Places and unit tangents of the samples. A tangent is the direction from the sample before to the sample after.
    pub fn frames(&self, points: &[Point]) -> (Vec<Point>, Vec<Point>) {
        let places = self.places(points);
        let count = places.len();
        let tangent = |s: usize| {
            let (before, after) = if self.closed {
                ((s + count - 1) % count, (s + 1) % count)
            } else {
                (s.saturating_sub(1), (s + 1).min(count - 1))
            };
            (places[after] - places[before]).normalize_or(Point::X)
        };
        let tangents = (0..count).map(tangent).collect();
        (places, tangents)
    }
}
