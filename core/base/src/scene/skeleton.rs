//! The template skeleton: 17 key points in a fixed order, and the limbs between them.
//!
//! A posture is a position for each key point (Liang et al. 2012, section 3). Sixteen limbs lead from a parent to a
//! child, outward from the pelvis. Some points belong to the left or the right side of the body and mirror each other.
//! Lengths are given in torso lengths; the torso leads from the pelvis over the chest to the neck.

use crate::geometry::Point;

/// Number of key points.
pub const COUNT: usize = 17;

/// Number of limbs.
pub const LIMBS: usize = COUNT - 1;

/// A position for each key point, in the order of [`NAMES`].
pub type Posture = [Point; COUNT];

/// Names of the key points.
pub const NAMES: [&str; COUNT] = [
    "pelvis",
    "chest",
    "neck",
    "head",
    "head_top",
    "l_shoulder",
    "l_elbow",
    "l_wrist",
    "r_shoulder",
    "r_elbow",
    "r_wrist",
    "l_hip",
    "l_knee",
    "l_ankle",
    "r_hip",
    "r_knee",
    "r_ankle",
];

/// Parent of each key point; the pelvis is its own. A parent comes before its children.
pub const PARENTS: [usize; COUNT] = [0, 0, 1, 2, 3, 2, 5, 6, 2, 8, 9, 0, 11, 12, 0, 14, 15];

/// The point on the other side of the body; points in the middle map to themselves.
pub const MIRROR: [usize; COUNT] = [0, 1, 2, 3, 4, 8, 9, 10, 5, 6, 7, 14, 15, 16, 11, 12, 13];

/// Hip, knee and ankle of both legs.
pub const LEGS: [[usize; 3]; 2] = [[11, 12, 13], [14, 15, 16]];

/// Length of the torso: pelvis to chest to neck.
pub fn torso(posture: &Posture) -> f64 {
    posture[0].distance(posture[1]) + posture[1].distance(posture[2])
}

/// Lengths of the limbs. Entry `k − 1` belongs to key point `k`.
pub fn limb_lengths(posture: &Posture) -> [f64; LIMBS] {
    std::array::from_fn(|limb| posture[limb + 1].distance(posture[PARENTS[limb + 1]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_is_in_order_and_its_sides_match() {
        for k in 1..COUNT {
            assert!(PARENTS[k] < k);
            assert_eq!(MIRROR[MIRROR[k]], k);
            assert_eq!(MIRROR[PARENTS[k]], PARENTS[MIRROR[k]]);
            assert_eq!(NAMES[MIRROR[k]].replace("l_", "r_"), NAMES[k].replace("l_", "r_"));
        }
    }

    #[test]
    fn the_torso_is_measured_along_the_spine() {
        let mut posture = [Point::ZERO; COUNT];
        posture[1] = Point::new(3.0, -4.0);
        posture[2] = Point::new(3.0, -6.0);
        assert_eq!(torso(&posture), 7.0);
        assert_eq!(limb_lengths(&posture)[..2], [5.0, 2.0]);
    }
}
