//! How sure a point is when there is one key, and whether a part can be trusted on a drawing.
//!
//! Between two keys the models of both keys contradict each other where one is wrong ([`crate::rototoon::confidence`]). Here
//! there is one. What tells instead: how well the key's colours fit around the point (e, mean squared colour difference),
//! and how well they fit over the whole part (E) beside how well they can fit where the part is not (R, the least energy
//! of any other place in the key's own picture, at most [`WORST`]): a leg that its twin resembles is not known by its
//! look. So
//!
//! logit p = β₀ + β₁ ln(e + 0.001) + β₂ ln((E + 0.001) / (R + 0.001)).
//!
//! β is fitted by maximum likelihood to "within 2 px of the contour at 540 lines", each of seven sequences counting the
//! same. Fitted to six and tried on the seventh the mean loss is 0.385 a point; without R it is 0.395. The distance of a
//! point from where dense flow would put it, the number of drawings from the key, and the largest jump so far were tried
//! too: they help some sequences and cost others more (0.40 to 0.43).
//!
//! A part is trusted on a drawing by the mean of p over its points that are seen; it is lost where it is not trusted on
//! [`PATIENCE`] drawings in a row. A part of which next to nothing is seen cannot be trusted.

use crate::rototoon::confidence::local_errors;
use crate::rototoon::lattice::texture::{Texel, WORST, in_picture};
use crate::rototoon::pool::Hypothesis;
use crate::rototoon::propagate::{Model, Scenery};
use rototoon_base::geometry::Point;

/// β of the module's formula.
const BETA: [f64; 3] = [-3.71, -1.0, -0.595];

/// Mean probability from which on a part is trusted.
pub const TRUSTED: f64 = 0.5;
/// Drawings in a row that are not trusted before a part is lost.
pub const PATIENCE: usize = 4;
/// Share of the samples that must be seen.
pub const LEAST_SEEN: f64 = 0.1;
/// Share of the samples in the picture below which a part has left it.
pub const LEAST_INSIDE: f64 = 0.08;

/// How sure a part is on a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Sureness {
    /// By point, 0 to 1.
    pub points: Vec<f64>,
    /// Mean over the points that are seen.
    pub trust: f64,
    /// Share of the samples that are seen.
    pub seen: f64,
    /// Share of the samples in the picture.
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

    /// Whether the part is trusted.
    pub fn trusted(&self) -> bool {
        self.trust >= TRUSTED
    }
}

fn probability(error: f64, whole: f64, rival: f64) -> f64 {
    let rival = rival.min(f64::from(WORST));
    let logit = BETA[0] + BETA[1] * (error + 0.001).ln() + BETA[2] * ((whole + 0.001) / (rival + 0.001)).ln();
    1.0 / (1.0 + (-logit).exp())
}

/// Weighted share of samples whose places fulfil a condition.
fn share_of(texels: &[Texel], nodes: &[Point], is: &dyn Fn(Point) -> bool) -> f64 {
    let (mut sum, mut weights) = (0.0, 1e-9);
    for texel in texels {
        let weight = f64::from(texel.weight);
        sum += if is(texel.binding.at(nodes)) { weight } else { 0.0 };
        weights += weight;
    }
    sum / weights
}

/// Index of the last of some drawings to keep: the last trusted one before the part is lost, at least `least`.
/// `trusted` begins with the key's drawing.
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
