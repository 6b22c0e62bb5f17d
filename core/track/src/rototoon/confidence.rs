//! Confidence of a tracked point: the probability that it is within 2 working pixels of the drawn contour.
//!
//! Two measurements predict it:
//!
//! - e, the mean squared colour difference of the samples around the point, weighted by nearness: how well the key's
//!   colours fit the picture there.
//! - d, the distance in working pixels between the places that the models of the two keys give the point.
//!
//! Each fails in its own way, so the two together predict better than either alone. The model is a logistic regression
//! on their logarithms: logit p = A + B ln(e + 0.001) + C ln(d + 0.5).
//!
//! A, B and C are fitted by weighted maximum likelihood; every sequence has the same weight. Cross-validation on six
//! sequences (five to fit, one to test): of the points with a confidence of 0.85 to 0.95 (mean 0.91), 93 % are within 2
//! px; of the points above that (mean 0.99), 97 %. Below 0.5 the confidence is too low by 0.2.

use super::lattice::texture::{Cover, UNSEEN, WORST, in_picture};
use super::pool::Hypothesis;
use super::propagate::Model;
use crate::shared::features::{Features, difference};

/// A, B and C of the module's formula: the intercept, the slope of ln(e + 0.001) and the slope of ln(d + 0.5).
const INTERCEPT: f64 = -1.28;
const LOOK_SLOPE: f64 = -1.02;
const AGREEMENT_SLOPE: f64 = -0.84;
/// Upper limit of d, in working pixels: a larger distance adds no information.
const FURTHEST_APART: f64 = 50.0;
/// Weight of a sample under a nearer part.
const COVERED_WEIGHT: f64 = 0.2;
/// Level (index in `LEVELS`) whose samples are compared.
const LEVEL: usize = 2;

/// Confidence of each control point of the hypothesis `chosen` of a drawing's `pool`, 0 to 1.
pub fn of_drawing(
    models: &[Model; 2],
    features: &Features,
    cover: &Cover,
    pool: &[Hypothesis],
    chosen: usize,
) -> Vec<f64> {
    let own = &pool[chosen];
    let errors = local_errors(&models[own.model], features, cover, own);
    let apart = |j: usize| {
        let others = pool.iter().filter(|h| h.model != own.model);
        others.map(|h| h.points[j].distance(own.points[j])).fold(FURTHEST_APART, f64::min)
    };
    let probability = |(j, error): (usize, f64)| {
        let logit = INTERCEPT + LOOK_SLOPE * (error + 0.001).ln() + AGREEMENT_SLOPE * (apart(j) + 0.5).ln();
        1.0 / (1.0 + (-logit).exp())
    };
    errors.into_iter().enumerate().map(probability).collect()
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
