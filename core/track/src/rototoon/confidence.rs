//! How sure a tracked point is: the probability that it lies within 2 working pixels of the drawn contour.
//!
//! Two things tell: how well the key's colours near the point fit the picture (e, mean squared colour difference of the
//! samples around it, near ones counting more), and how far from each other the models of the two keys put the point
//! (d, working pixels). Both fail in their own way, so together they tell more than either. The probability is logistic
//! in their logarithms: logit p = A + B ln(e + 0.001) + C ln(d + 0.5).
//!
//! A, B and C are fitted by weighted maximum likelihood, each sequence counting the same. Fitted to five of six
//! sequences and tried on the sixth, of the points given 0.85 to 0.95 (mean 0.91) 93 % are within 2 px, of those given
//! more (mean 0.99) 97 %; below 0.5 it is too careful by 0.2.

use super::lattice::texture::{Cover, UNSEEN, WORST, in_picture};
use super::pool::Hypothesis;
use super::propagate::Model;
use crate::shared::features::{Features, difference};

/// A, B and C of the module's formula.
const INTERCEPT: f64 = -1.28;
const LOOK_SLOPE: f64 = -1.02;
const AGREEMENT_SLOPE: f64 = -0.84;
/// Distance between the models beyond which more says nothing more, in working pixels.
const FURTHEST_APART: f64 = 50.0;
/// Weight of a sample that lies under a nearer part.
const COVERED_WEIGHT: f64 = 0.2;
/// Level (index in `LEVELS`) whose samples are compared.
const LEVEL: usize = 2;

/// Confidence of each control point of a chosen hypothesis, 0 to 1.
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

/// Mean colour difference around each control point; the worst where no sample is near.
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
