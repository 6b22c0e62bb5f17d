//! How sure a tracked point is.

use super::features::Features;
use super::lattice::texture::{Cover, WORST, difference};
use super::propagate::Model;
use super::rototoon::Hypothesis;

/// Confidence of each control point of a chosen hypothesis, 0 to 1.
pub fn of_drawing(
    models: &[Model; 2],
    features: &Features,
    cover: &Cover,
    pool: &[Hypothesis],
    chosen: usize,
) -> Vec<f64> {
    let own = &pool[chosen];
    let texture = &models[own.model].texture;
    let level = features.level(2);
    let count = own.points.len();
    let reach = texture.mesh.side.max(6.0);
    let mut look = vec![(0.0f64, 0.0f64); count];
    for texel in &texture.texels[2] {
        let place = texel.binding.at(&own.pose.nodes);
        let error = f64::from(difference(&level.colour(place), &texel.key).min(WORST));
        let seen = if cover.hides(place) { 0.2 } else { 1.0 };
        for (j, p) in own.points.iter().enumerate() {
            let w = seen * (-place.distance_squared(*p) / (reach * reach)).exp();
            look[j].0 += w * error;
            look[j].1 += w;
        }
    }
    let apart = |j: usize| {
        let others = pool.iter().filter(|h| h.model != own.model);
        others.map(|h| h.points[j].distance(own.points[j])).fold(f64::INFINITY, f64::min).min(50.0)
    };
    (0..count)
        .map(|j| {
            let error = if look[j].1 > 1e-6 { look[j].0 / look[j].1 } else { f64::from(WORST) };
            1.0 / (1.0 + (error / 0.02).powi(2) + (apart(j) / 4.0).powi(2) * 0.5)
        })
        .collect()
}
