//! Confidence of a point with a single key, and whether a part can be trusted on a drawing.
//!
//! Between two keys the models of both keys disagree if one of them is wrong ([`confidence`](super::super::confidence)). With a
//! single key three other measurements are used:
//!
//! - e, the mean squared colour difference around the point: how well the key's colours fit there.
//! - E, the energy of the complete part.
//! - R, the least energy of any other place in the key's own picture, at most [`WORST`]: how well a wrong place can
//!   fit. A leg that looks like its twin cannot be identified by its appearance.
//!
//! The model is logit p = β₀ + β₁ ln(e + 0.001) + β₂ ln((E + 0.001) / (R + 0.001)).
//!
//! β is fitted by maximum likelihood to "within 2 px of the contour at 540 lines" on seven sequences of equal weight.
//! In cross-validation (six to fit, one to test) the mean loss is 0.385 per point; without R it is 0.395. Three more
//! inputs were tried: the distance of a point from its place by dense flow, the number of drawings from the key, and
//! the largest jump so far. They help some sequences and harm others more (0.40 to 0.43).
//!
//! A part is trusted on a drawing if the mean of p over its visible points is large enough. It is lost if it is not
//! trusted on [`PATIENCE`] drawings in a row. A part of which almost nothing is visible is not trusted.

use crate::rototoon::confidence::local_errors;
use crate::rototoon::lattice::texture::{Texel, WORST, in_picture};
use crate::rototoon::pool::Hypothesis;
use crate::rototoon::propagate::{Model, Scenery};
use rototoon_base::geometry::Point;

/// β of the module's formula.
const BETA: [f64; 3] = [-3.71, -1.0, -0.595];

/// Least mean probability of a trusted part.
pub const TRUSTED: f64 = 0.5;
/// Largest probability of a point of a part that is on the place of another one.
const TAKEN: f64 = 0.3;
/// Number of untrusted drawings in a row after which a part is lost.
pub const PATIENCE: usize = 4;
/// Least share of visible samples of a trusted part.
pub const LEAST_SEEN: f64 = 0.1;
/// Share of samples in the picture below which the part has left the picture.
pub const LEAST_INSIDE: f64 = 0.08;

/// Confidence of a part on a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Sureness {
    /// Confidence by point, 0 to 1.
    pub points: Vec<f64>,
    /// Mean confidence of the visible points; 0 if too few samples are visible.
    pub trust: f64,
    /// Share of visible samples.
    pub seen: f64,
    /// Share of samples in the picture.
    pub inside: f64,
}

impl Sureness {
    /// Of a hypothesis of the key's model on a drawing; `rival` is R of the module's formula.
    pub(super) fn of(model: &Model, rival: f64, seen: &Scenery, hypothesis: &Hypothesis) -> Self {
        let errors = local_errors(model, seen.features, seen.cover, hypothesis);
        let whole = hypothesis.pose.energy.max(0.0);
        let points: Vec<f64> = errors.iter().map(|&error| probability(error, whole, rival)).collect();
        let shown: Vec<bool> = hypothesis.points.iter().map(|&p| !seen.cover.hides(p)).collect();
        let count = shown.iter().filter(|s| **s).count();
        let sum: f64 = points.iter().zip(&shown).filter(|(_, s)| **s).map(|(p, _)| p).sum();
        let share = |is: &dyn Fn(Point) -> bool| share_of(model.texture.measured(), &hypothesis.pose.nodes, is);
        let seen_share = share(&|p| !seen.cover.hides(p));
        let trust = if count > 0 && seen_share >= LEAST_SEEN { sum / count as f64 } else { 0.0 };
        Self { points, trust, seen: seen_share, inside: share(&|p| in_picture(p, seen.cover.width())) }
    }

    /// The same of a part that is on the place of another one: probably wrong, whatever fits.
    pub fn untrusted(mut self) -> Self {
        self.points.iter_mut().for_each(|point| *point = point.min(TAKEN));
        self.trust = 0.0;
        self
    }

    /// Whether the part is trusted on the drawing.
    pub fn trusted(&self) -> bool {
        self.trust >= TRUSTED
    }
}

fn probability(error: f64, whole: f64, rival: f64) -> f64 {
    let rival = rival.min(f64::from(WORST));
    let logit = BETA[0] + BETA[1] * (error + 0.001).ln() + BETA[2] * ((whole + 0.001) / (rival + 0.001)).ln();
    1.0 / (1.0 + (-logit).exp())
}

/// Weighted share of the samples whose places meet the condition `is`.
fn share_of(texels: &[Texel], nodes: &[Point], is: &dyn Fn(Point) -> bool) -> f64 {
    let (mut sum, mut weights) = (0.0, 1e-9);
    for texel in texels {
        let weight = f64::from(texel.weight);
        sum += if is(texel.binding.at(nodes)) { weight } else { 0.0 };
        weights += weight;
    }
    sum / weights
}

/// Index of the last drawing to keep: the last trusted one before the part is lost, and at least `least`. `trusted`
/// begins with the key's drawing.
pub fn last_trusted(trusted: &[bool], least: usize) -> usize {
    let mut last = 0;
    for (index, &is) in trusted.iter().enumerate() {
        if is || index <= least {
            last = index;
        } else if index - last >= PATIENCE {
            break;
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_lost_when_it_is_not_trusted_for_good() {
        let of = |marks: &str| marks.chars().map(|c| c == '1').collect::<Vec<_>>();
        assert_eq!(last_trusted(&of("1111"), 0), 3);
        assert_eq!(last_trusted(&of("110011"), 0), 5, "it comes back");
        assert_eq!(last_trusted(&of("11000011"), 0), 1, "too late");
        assert_eq!(last_trusted(&of("11000011"), 5), 7, "a correction extends trust");
        assert_eq!(last_trusted(&of("1000"), 0), 0);
    }

    #[test]
    fn worse_colours_and_likelier_rivals_are_less_sure() {
        let sure = probability(0.001, 0.003, 0.05);
        assert!(sure > 0.9);
        assert!(sure > probability(0.02, 0.003, 0.05));
        assert!(sure > probability(0.001, 0.003, 0.004));
        assert!((probability(0.001, 0.003, f64::INFINITY) - probability(0.001, 0.003, 0.15)).abs() < 1e-6);
    }
}
