//! Confidence of a tracked point: the probability that it is good, which is within 2 working pixels of the drawn contour
//! and within 10 of its own place along it.
//!
//! The model is a logistic regression on the seven measurements of [`evidence`](super::evidence):
//! logit p = B₀ − C + Σ Bᵢ xᵢ. It is monotone in each: a worse measurement never gives more confidence.
//!
//! B is fitted by maximum likelihood with a small ridge, on 37 runs over nine characters: vector animation, a child's
//! drawing, a hand-drawn run, and the same under airbrush, in pencil and in double lines, with keys at different distances.
//! Every character has the same weight. C is caution: footage that nobody has seen is harder than footage of the fit.
//!
//! Cross-validation leaves out all runs of a character at once. `docs/src/methods/confidence.md` has the figures, and what
//! was tried. Of the points given 0.9 or more 98.9 % are good. Of lost parts (more than a quarter of their size away) 92 %
//! get less than ½ in the mean with the films' own keys, and 84 % with far too few keys among them.
//!
//! A frame held from a key shows the key's drawing and gets [`HELD`].

use super::evidence::{COUNT, Evidence};
use super::lattice::texture::{Cover, UNSEEN, WORST, in_picture};
use super::pool::Hypothesis;
use super::propagate::Model;
use crate::shared::features::{Features, difference};

/// B₀ of the module's formula.
const INTERCEPT: f64 = 1.96;
/// C of the module's formula.
const CAUTION: f64 = 0.8;
/// B₁ to B₇, in the order of the evidence.
const SLOPES: [f64; COUNT] = [-0.519, -0.578, -0.516, -0.647, 3.934, 1.282, 0.362];
/// Confidence on frames held from a key: all 3374 points of such frames in the fit were good.
pub const HELD: f64 = 0.995;
/// Weight of a sample under a nearer part.
const COVERED_WEIGHT: f64 = 0.2;
/// Level (index in `LEVELS`) whose samples are compared.
const LEVEL: usize = 2;

/// The probability that a point with this evidence is good.
pub fn probability(evidence: &Evidence) -> f64 {
    let sum: f64 = SLOPES.iter().zip(evidence).map(|(slope, x)| slope * x).sum();
    1.0 / (1.0 + (CAUTION - INTERCEPT - sum).exp())
}

/// Mean squared colour difference around each control point; [`WORST`] where no sample is near.
pub(super) fn local_errors(model: &Model, features: &Features, cover: &Cover, hypothesis: &Hypothesis) -> Vec<f64> {
    let level = features.level(LEVEL);
    let reach = model.texture.mesh.side.max(6.0);
    let mut sums = vec![(0.0f64, 0.0f64); hypothesis.points.len()];
    for texel in &model.texture.texels[LEVEL] {
        let place = texel.binding.at(&hypothesis.pose.nodes);
        let outside = !in_picture(place, cover.width());
        let difference = difference(level.colour(place), texel.key.colour).min(WORST);
        let error = f64::from(if outside { UNSEEN } else { difference });
        let seen = if cover.hides(place) { COVERED_WEIGHT } else { 1.0 };
        for (sum, p) in sums.iter_mut().zip(&hypothesis.points) {
            let weight = seen * (-place.distance_squared(*p) / (reach * reach)).exp();
            *sum = (sum.0 + weight * error, sum.1 + weight);
        }
    }
    sums.into_iter().map(|(sum, weight)| if weight > 1e-6 { sum / weight } else { f64::from(WORST) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of a part that fits twice as well as any rival, and as well as from key to key.
    const FAIR: Evidence = [-2.0, 0.0, -2.5, 0.5, 0.05, 0.0, -1.5];

    #[test]
    fn a_worse_measurement_never_gives_more_confidence() {
        let fair = probability(&FAIR);
        assert!((0.8..0.99).contains(&fair), "{fair}");
        for (index, worse) in [1.0, 1.0, 1.0, 1.0, -0.1, -1.0, -1.5].into_iter().enumerate() {
            let mut evidence = FAIR;
            evidence[index] += worse;
            assert!(probability(&evidence) < fair - 0.01, "measurement {index}");
        }
    }

    #[test]
    fn a_part_that_fits_as_well_elsewhere_and_on_no_edge_is_lost() {
        assert!(probability(&[0.0, 1.0, -1.2, 3.0, 0.0, -1.0, -4.5]) < 0.1);
        assert!(probability(&[-3.5, -0.5, -3.5, -0.5, 0.2, 0.1, 0.0]) > 0.98);
    }
}
