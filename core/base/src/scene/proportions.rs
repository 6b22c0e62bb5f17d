//! Proportions of a character, and postures converted from one character to another (Liang et al. 2012, eq. 4).
//!
//! W_char of the paper is local: each limb is scaled along its own direction, and the key points beyond it move with
//! it. Here the scale is the ratio of two typical lengths of the limb: the template's and the character's
//! ([`Proportions::unify`]), or those of any two characters ([`Proportions::to`]). A limb that looks shorter because it
//! points towards the viewer stays shorter by the same share.

use super::skeleton::{COUNT, LIMBS, PARENTS, Posture, limb_lengths, torso};

/// Limbs shorter than this share of the torso have no direction along which to scale them.
const NO_LENGTH: f64 = 1e-6;

/// Typical lengths of the limbs in any unit. Entry `k − 1` belongs to key point `k`.
#[derive(Clone, Debug, PartialEq)]
pub struct Proportions(pub [f64; LIMBS]);

/// The template's proportions in torso lengths: an adult figure seen from the side, between front and profile.
pub const TEMPLATE: Proportions =
    Proportions([0.55, 0.45, 0.2, 0.3, 0.22, 0.5, 0.45, 0.22, 0.5, 0.45, 0.15, 0.8, 0.75, 0.15, 0.8, 0.75]);

impl Proportions {
    /// The median length of each limb.
    pub fn of(postures: &[Posture]) -> Self {
        let lengths: Vec<[f64; LIMBS]> = postures.iter().map(limb_lengths).collect();
        Self(std::array::from_fn(|limb| median(lengths.iter().map(|all| all[limb]).collect())))
    }

    /// Length of the torso.
    pub fn torso(&self) -> f64 {
        self.0[0] + self.0[1]
    }

    /// Converts a posture of a character with these proportions to those of `other`. The pelvis stays.
    pub fn to(&self, other: &Self, posture: &Posture) -> Posture {
        let size = other.torso() / self.torso().max(f64::MIN_POSITIVE);
        let mut moved = *posture;
        for k in 1..COUNT {
            let (own, wanted) = (self.0[k - 1], other.0[k - 1]);
            let ratio = if own > NO_LENGTH * self.torso() { wanted / own } else { size };
            moved[k] = moved[PARENTS[k]] + (posture[k] - posture[PARENTS[k]]) * ratio;
        }
        moved
    }

    /// A posture in the template's proportions, with torso length 1. The pelvis stays.
    pub fn unify(&self, posture: &Posture) -> Posture {
        self.to(&TEMPLATE, posture)
    }
}

/// The median torso length of some postures.
pub fn typical_torso(postures: &[Posture]) -> f64 {
    median(postures.iter().map(torso).collect())
}

/// The median; 0 for an empty list.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 { 0.0 } else { 0.5 * (values[(n - 1) / 2] + values[n / 2]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    fn posture(seed: f64) -> Posture {
        std::array::from_fn(|k| Point::new((k as f64 * 1.7 + seed).sin() * 9.0, (k as f64 * 0.9 + seed).cos() * 7.0))
    }

    #[test]
    fn unified_and_back_is_the_same() {
        let own = Proportions::of(&[posture(0.0), posture(1.0), posture(2.0)]);
        let there = own.unify(&posture(5.0));
        let back = TEMPLATE.to(&own, &there);
        assert!(back.iter().zip(&posture(5.0)).all(|(a, b)| a.distance(*b) < 1e-12));
        assert_eq!(there[0], posture(5.0)[0]);
    }

    #[test]
    fn a_typical_posture_gets_the_template_s_lengths() {
        let own = Proportions::of(&[posture(3.0)]);
        let lengths = limb_lengths(&own.unify(&posture(3.0)));
        assert!(lengths.iter().zip(&TEMPLATE.0).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!((TEMPLATE.torso() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn limbs_without_length_are_scaled_as_the_torso() {
        let mut flat = posture(1.0);
        flat[13] = flat[12];
        let own = Proportions::of(&[flat]);
        assert!(own.unify(&flat).iter().all(|p| p.is_finite()));
        assert_eq!(own.unify(&flat)[13], own.unify(&flat)[12]);
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(typical_torso(&[]), 0.0);
    }
}
