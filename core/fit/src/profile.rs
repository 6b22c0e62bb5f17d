//! The lengths of pieces along a section: a first guess, and its improvement.
//!
//! **Guess.** Along the points, each parabola grows as long as a least-squares parabola stays within the tolerance.
//! (This is the first step of Yang et al. 1986, with least squares instead of slopes from noisy neighbours.) Its length
//! shows how long a piece may be there: short where the curvature changes fast, long where it is even. The pieces of a
//! uniform spline cannot change their length suddenly, so the cuts are smoothed.
//!
//! **Improvement.** The error of a parabola grows with the third to fourth power of its length. A piece with the error
//! e therefore uses the share (e / tolerance)^¼ of its allowed length. Cuts at even sums of these shares even out the
//! errors (equidistribution; de Boor 1973).

use super::grow::grow;
use nalgebra::{Matrix3, Matrix3x2};
use rototoon_base::geometry::Point;

/// Exponent from the error to the share of the allowed length.
const SHARE: f64 = 0.25;
/// Errors are clamped to these multiples of the tolerance.
const SHARE_RANGE: (f64, f64) = (0.1, 8.0);
/// Rounds of smoothing of the cuts.
const SMOOTHING: usize = 2;

/// Cuts along a section by arc length of its points, and the weight of each stretch between two cuts.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    pub cuts: Vec<f64>,
    pub weights: Vec<f64>,
}

impl Profile {
    /// Grows parabolas over the points. `lengths` are their arc lengths.
    pub fn grown(points: &[Point], lengths: &[f64], tolerance: f64) -> Self {
        let mut cuts = vec![lengths[0]];
        let mut start = 0;
        while start + 1 < points.len() {
            start = farthest(points, lengths, start, tolerance);
            cuts.push(lengths[start]);
        }
        let weights = vec![1.0; cuts.len() - 1];
        Self { cuts, weights }
    }

    /// The profile of the pieces of a fit with their largest errors.
    pub fn measured(cuts: Vec<f64>, errors: &[f64], tolerance: f64) -> Self {
        let share = |e: &f64| (e / tolerance).clamp(SHARE_RANGE.0, SHARE_RANGE.1).powf(SHARE);
        let weights = errors.iter().map(share).collect();
        Self { cuts, weights }
    }

    /// Sum of the weights: approximately the number of pieces needed.
    pub fn total(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// `pieces` + 1 cuts at even sums of the weights, smoothed.
    pub fn cut(&self, pieces: usize) -> Vec<f64> {
        let total = self.total();
        let mut cuts = Vec::with_capacity(pieces + 1);
        let (mut k, mut before) = (0, 0.0);
        for i in 0..=pieces {
            let target = total * i as f64 / pieces as f64;
            while k + 1 < self.weights.len() && before + self.weights[k] < target {
                before += self.weights[k];
                k += 1;
            }
            let share = ((target - before) / self.weights[k]).clamp(0.0, 1.0);
            cuts.push(self.cuts[k] + (self.cuts[k + 1] - self.cuts[k]) * share);
        }
        for _ in 0..SMOOTHING {
            let old = cuts.clone();
            for i in 1..pieces {
                cuts[i] = 0.25 * (old[i - 1] + 2.0 * old[i] + old[i + 1]);
            }
        }
        cuts
    }
}

/// Index of the last point that one parabola from `start` reaches within the tolerance; at least the next point.
fn farthest(points: &[Point], lengths: &[f64], start: usize, tolerance: f64) -> usize {
    let last = points.len() - 1;
    let fits = |end: usize| parabola_error(&points[start..=end], &lengths[start..=end]) <= tolerance;
    grow(start, last, 4, |good| 1 + (good - start) / 32, fits)
}

/// Largest distance across the curve from the least-squares parabola in arc length, in pixels.
fn parabola_error(points: &[Point], lengths: &[f64]) -> f64 {
    let (n, first) = (points.len(), lengths[0]);
    let span = lengths[n - 1] - first;
    if n < 4 || span <= 0.0 {
        return 0.0;
    }
    let at = |j: usize| 2.0 * (lengths[j] - first) / span - 1.0;
    let (mut m, mut sums) = ([0.0; 5], [Point::ZERO; 3]);
    for j in 0..n {
        let s = at(j);
        let powers = [1.0, s, s * s];
        for (i, power) in powers.into_iter().enumerate() {
            m[i] += power;
            sums[i] += power * (points[j] - points[0]);
        }
        m[3] += powers[2] * s;
        m[4] += powers[2] * powers[2];
    }
    let Some([c0, c1, c2]) = solve(m, sums) else { return 0.0 };
    (0..n).fold(0.0, |worst: f64, j| {
        let s = at(j);
        let error = c0 + (c1 + c2 * s) * s - (points[j] - points[0]);
        let across = (c1 + 2.0 * s * c2).normalize_or_zero();
        worst.max(if across == Point::ZERO { error.length() } else { across.perp_dot(error).abs() })
    })
}

/// Solves the moment equations of a quadratic. `None` where they are singular to working precision.
fn solve(m: [f64; 5], sums: [Point; 3]) -> Option<[Point; 3]> {
    let moments = Matrix3::new(m[0], m[1], m[2], m[1], m[2], m[3], m[2], m[3], m[4]);
    let sums = Matrix3x2::from_fn(|i, axis| sums[i][axis]);
    let factor = moments.cholesky()?;
    let pivots = factor.l_dirty().diagonal().map(|root| root * root);
    (pivots.min() > 1e-12 * m[0]).then(|| {
        let found = factor.solve(&sums);
        [0, 1, 2].map(|i| Point::new(found[(i, 0)], found[(i, 1)]))
    })
}
