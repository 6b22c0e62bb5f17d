//! How sure a point is when there is one key, and whether a part can be trusted on a drawing.
//!
//! Between two keys the models of both keys contradict each other where one is wrong ([`crate::track::confidence`]). Here
//! there is one. What tells instead: how well the key's colours fit around the point (e, mean squared colour difference)
//! and over the whole part (E), how far the dense flow from the drawing before would have put the point from where it was
//! put (a, working pixels), and how many drawings lie between (n), since what was drawn changes with time:
//!
//! logit p = β₀ + β₁ ln(e + 0.001) + β₂ ln(E + 0.001) + β₃ ln(a + 0.5) + β₄ ln(1 + n).
//!
//! β is fitted by maximum likelihood, each sequence counting the same, to "within 2 px of the contour at 540 lines".
//!
//! A part is trusted on a drawing by the mean of p over its points that are seen; it is lost where it is not trusted on
//! [`PATIENCE`] drawings in a row. A part of which next to nothing is seen cannot be trusted.

use super::arm::Seen;
use crate::geometry::Point;
use crate::track::confidence::local_errors;
use crate::track::lattice::texture::{Texel, in_picture};
use crate::track::pool::Hypothesis;
use crate::track::propagate::Model;

/// β of the module's formula.
const BETA: [f64; 5] = [-1.28, -1.0, 0.0, -0.6, 0.0];

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
    pub dump: Vec<[f64; 4]>,
}

impl Sureness {
    /// Of a hypothesis on a drawing; `expected` is where the flow from the drawing before puts the control points, `age`
    /// the number of drawings from the key.
    pub fn of(
        model: &Model,
        seen: &Seen,
        hypothesis: &Hypothesis,
        expected: Option<&[Point]>,
        age: usize,
        width: f64,
    ) -> Self {
        let errors = local_errors(model, &seen.features, &seen.cover, hypothesis);
        let whole = hypothesis.pose.energy.max(0.0);
        let apart = |j: usize| expected.map_or(0.0, |e| e[j].distance(hypothesis.points[j]));
        let points: Vec<f64> = (0..errors.len()).map(|j| probability(errors[j], whole, apart(j), age)).collect();
        let shown: Vec<bool> = hypothesis.points.iter().map(|&p| !seen.cover.hides(p)).collect();
        let count = shown.iter().filter(|s| **s).count();
        let sum: f64 = points.iter().zip(&shown).filter(|(_, s)| **s).map(|(p, _)| p).sum();
        let share = |is: &dyn Fn(Point) -> bool| share_of(model.texture.measured(), &hypothesis.pose.nodes, is);
        let seen_share = share(&|p| !seen.cover.hides(p));
        let trust = if count > 0 && seen_share >= LEAST_SEEN { sum / count as f64 } else { 0.0 };
        let dump = (0..errors.len()).map(|j| [errors[j], whole, apart(j), age as f64]).collect();
        Self { dump, points, trust, seen: seen_share, inside: share(&|p| in_picture(p, width)) }
    }

    /// Whether the part is trusted.
    pub fn trusted(&self) -> bool {
        self.trust >= TRUSTED
    }
}

fn probability(error: f64, whole: f64, apart: f64, age: usize) -> f64 {
    let [b0, b1, b2, b3, b4] = BETA;
    let logit = b0
        + b1 * (error + 0.001).ln()
        + b2 * (whole + 0.001).ln()
        + b3 * (apart + 0.5).ln()
        + b4 * (age as f64).ln_1p();
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
    fn worse_colours_and_contradicting_flow_are_less_sure() {
        let sure = probability(0.001, 0.003, 0.2, 1);
        assert!(sure > probability(0.02, 0.003, 0.2, 1));
        assert!(sure > probability(0.001, 0.003, 9.0, 1));
    }
}
