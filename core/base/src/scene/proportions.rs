//! Proportions of a character, and postures converted from one character to another (Liang et al. 2012, eq. 4).
//!
//! W_char of the paper is local: each limb is scaled along its own direction, and the key points beyond it move with
//! it. Here the scale is the ratio of two typical lengths of the limb, those of the two characters. A limb that looks
//! shorter because it points towards the viewer stays shorter by the same share.

use super::skeleton::LIMBS;
use super::template::Template;
use crate::geometry::Point;
use crate::numeric::median::median;

/// Limbs shorter than this share of the torso have no direction along which to scale them.
const NO_LENGTH: f64 = 1e-6;

/// Typical lengths of the limbs in any unit. Entry `k − 1` belongs to key point `k` of a template.
#[derive(Clone, Debug, PartialEq)]
pub struct Proportions(pub Vec<f64>);

/// Human proportions in torso lengths: an adult figure seen from the side, between front and profile.
pub const HUMAN: [f64; LIMBS] =
    [0.55, 0.45, 0.2, 0.3, 0.22, 0.5, 0.45, 0.22, 0.5, 0.45, 0.15, 0.8, 0.75, 0.15, 0.8, 0.75];

impl Proportions {
    /// The median length of each limb.
    pub fn of(template: &Template, postures: &[Vec<Point>]) -> Self {
        let length = |k: usize| median(postures.iter().map(|p| p[k].distance(p[template.parent(k)])).collect());
        Self((1..template.len()).map(length).collect())
    }

    /// Length of a run of key points, each the parent of the next.
    pub fn along(&self, points: &[usize]) -> f64 {
        points.iter().skip(1).map(|&k| self.0[k - 1]).sum()
    }

    /// Length of the torso.
    pub fn torso(&self, template: &Template) -> f64 {
        self.along(template.torso())
    }

    /// Converts a posture of a character with these proportions to those of `other`. The root stays.
    pub fn to(&self, template: &Template, other: &Self, posture: &[Point]) -> Vec<Point> {
        let torso = self.torso(template);
        let size = other.torso(template) / torso.max(f64::MIN_POSITIVE);
        let mut moved = posture.to_vec();
        for k in 1..template.len() {
            let (own, wanted, parent) = (self.0[k - 1], other.0[k - 1], template.parent(k));
            let ratio = if own > NO_LENGTH * torso { wanted / own } else { size };
            moved[k] = moved[parent] + (posture[k] - posture[parent]) * ratio;
        }
        moved
    }
}

/// The median torso length of some postures.
pub fn typical_torso(template: &Template, postures: &[Vec<Point>]) -> f64 {
    median(postures.iter().map(|posture| template.torso_length(posture)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn posture(seed: f64) -> Vec<Point> {
        let at = |k: f64| Point::new((k * 1.7 + seed).sin() * 9.0, (k * 0.9 + seed).cos() * 7.0);
        (0..Template::human().len()).map(|k| at(k as f64)).collect()
    }

    #[test]
    fn there_and_back_is_the_same() {
        let human = Template::human();
        let own = Proportions::of(&human, &[posture(0.0), posture(1.0), posture(2.0)]);
        let other = Proportions(HUMAN.to_vec());
        let there = own.to(&human, &other, &posture(5.0));
        let back = other.to(&human, &own, &there);
        assert!(back.iter().zip(&posture(5.0)).all(|(a, b)| a.distance(*b) < 1e-12));
        assert_eq!(there[0], posture(5.0)[0]);
    }

    #[test]
    fn a_typical_posture_gets_the_other_s_lengths() {
        let human = Template::human();
        let own = Proportions::of(&human, &[posture(3.0)]);
        let made = own.to(&human, &Proportions(HUMAN.to_vec()), &posture(3.0));
        let lengths = Proportions::of(&human, &[made]).0;
        assert!(lengths.iter().zip(&HUMAN).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!((Proportions(HUMAN.to_vec()).torso(&human) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn limbs_without_length_are_scaled_as_the_torso() {
        let human = Template::human();
        let mut flat = posture(1.0);
        flat[13] = flat[12];
        let own = Proportions::of(&human, std::slice::from_ref(&flat));
        let made = own.to(&human, &Proportions(HUMAN.to_vec()), &flat);
        assert!(made.iter().all(|p| p.is_finite()));
        assert_eq!(made[13], made[12]);
    }

    #[test]
    fn no_postures_have_no_torso() {
        assert_eq!(typical_torso(&Template::human(), &[]), 0.0);
    }
}
