//! Inverse kinematics: a chain of bones whose end reaches for a place.
//!
//! Two bones have one solution on each side, by the law of cosines; the joint stays on its side. More bones are solved by
//! FABRIK (Aristidou & Lasenby 2011): from the end to the root and back, each joint is drawn onto the line to its
//! neighbour at the bone's length. It begins with the posture as it is, so joints stay near it, and for short ways they bend to their sides.
//! One bone can only turn. All bones keep their lengths. What is too far away is not reached: the chain is then straight.

use rototoon_base::geometry::Point;

/// Rounds of FABRIK. Its error falls by more than half in each.
const ROUNDS: usize = 32;
/// It ends where the end is this near to its goal, as a share of the chain's length.
const NEAR: f64 = 1e-9;

/// Moves the end of a chain by a shift; its root stays. `chain` are the indices of its joints in the posture, at least two.
pub fn reach(posture: &mut [Point], chain: &[usize], shift: Point) {
    if shift == Point::ZERO {
        return;
    }
    let joints: Vec<Point> = chain.iter().map(|&k| posture[k]).collect();
    let found = match joints[..] {
        [root, middle, end] => two_bones([root, middle, end], end + shift),
        _ => fabrik(&joints, joints[joints.len() - 1] + shift),
    };
    for (&k, p) in chain.iter().zip(found) {
        posture[k] = p;
    }
}

/// Two bones by the law of cosines.
fn two_bones([root, middle, end]: [Point; 3], goal: Point) -> Vec<Point> {
    let (upper, lower) = (root.distance(middle), middle.distance(end));
    let way = goal - root;
    let distance = way.length().clamp((upper - lower).abs(), upper + lower);
    if distance < 1e-9 || way.length() < 1e-9 {
        return vec![root, middle, end];
    }
    let direction = way.normalize();
    let along = (distance * distance + upper * upper - lower * lower) / (2.0 * distance);
    let across = (upper * upper - along * along).max(0.0).sqrt();
    let side = if (end - root).perp_dot(middle - root) >= 0.0 { 1.0 } else { -1.0 };
    vec![root, root + direction * along + direction.perp() * (side * across), root + direction * distance]
}

/// Any number of bones.
fn fabrik(joints: &[Point], goal: Point) -> Vec<Point> {
    let bones: Vec<f64> = joints.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
    let (whole, root, last) = (bones.iter().sum::<f64>(), joints[0], joints.len() - 1);
    let direction = (goal - root).normalize_or_zero();
    if direction == Point::ZERO || whole <= 0.0 {
        return joints.to_vec();
    }
    let mut made = joints.to_vec();
    if root.distance(goal) >= whole {
        for k in 1..=last {
            made[k] = made[k - 1] + direction * bones[k - 1];
        }
        return made;
    }
    // A straight chain would only be pushed along its line; a hair's breadth to one side lets it bend.
    let straight = made.iter().all(|p| (*p - root).perp_dot(direction).abs() <= NEAR * whole);
    if straight && last > 1 {
        made[1] += direction.perp() * (1e-3 * whole);
    }
    let at = |from: Point, to: Point, length: f64| from + (to - from).normalize_or(direction) * length;
    for _ in 0..ROUNDS {
        made[last] = goal;
        for k in (0..last).rev() {
            made[k] = at(made[k + 1], made[k], bones[k]);
        }
        made[0] = root;
        for k in 1..=last {
            made[k] = at(made[k - 1], made[k], bones[k - 1]);
        }
        if made[last].distance(goal) <= NEAR * whole {
            break;
        }
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    fn lengths(joints: &[Point]) -> Vec<f64> {
        joints.windows(2).map(|pair| pair[0].distance(pair[1])).collect()
    }

    #[test]
    fn the_end_is_where_it_is_wanted_and_bones_keep_their_lengths() {
        let human = vec![v(0.0, 0.0), v(6.0, 40.0), v(0.0, 80.0)];
        let hind = vec![v(0.0, 0.0), v(15.0, 30.0), v(-10.0, 60.0), v(-5.0, 85.0)];
        let five = vec![v(3.0, 0.0), v(9.0, 10.0), v(1.0, 22.0), v(8.0, 33.0), v(2.0, 40.0)];
        for leg in [human, hind, five] {
            let chain: Vec<usize> = (0..leg.len()).collect();
            for shift in [v(0.0, -7.0), v(5.0, -3.0), v(-4.0, -1.0)] {
                let mut made = leg.clone();
                reach(&mut made, &chain, shift);
                assert_eq!(made[0], leg[0]);
                assert!(made[leg.len() - 1].distance(leg[leg.len() - 1] + shift) < 1e-3, "{made:?}");
                assert!(lengths(&made).iter().zip(lengths(&leg)).all(|(a, b)| (a - b).abs() < 1e-9));
                let bend = |joints: &[Point], k: usize| {
                    (joints[k] - joints[k - 1]).perp_dot(joints[k + 1] - joints[k]).signum()
                };
                assert!((1..leg.len() - 1).all(|k| bend(&made, k) == bend(&leg, k)), "{made:?} bends as {leg:?}");
            }
        }
    }

    #[test]
    fn what_is_too_far_away_makes_the_leg_straight() {
        for leg in
            [vec![v(0.0, 0.0), v(5.0, 10.0), v(0.0, 20.0)], vec![v(0.0, 0.0), v(4.0, 8.0), v(0.0, 16.0), v(1.0, 22.0)]]
        {
            let chain: Vec<usize> = (0..leg.len()).collect();
            let mut made = leg.clone();
            reach(&mut made, &chain, v(0.0, 400.0));
            let whole: f64 = lengths(&leg).iter().sum();
            assert!((made[leg.len() - 1].distance(leg[0]) - whole).abs() < 1e-9);
        }
    }

    #[test]
    fn one_bone_turns_and_a_point_stays() {
        let mut bone = vec![v(0.0, 0.0), v(0.0, 10.0)];
        reach(&mut bone, &[0, 1], v(10.0, -10.0));
        assert!(bone[1].distance(v(10.0, 0.0)) < 1e-9);
        let mut point = vec![v(1.0, 1.0); 4];
        reach(&mut point, &[0, 1, 2, 3], v(3.0, 0.0));
        assert_eq!(point, vec![v(1.0, 1.0); 4]);
    }

    #[test]
    fn a_straight_leg_can_bend() {
        let mut leg = vec![v(0.0, 0.0), v(0.0, 10.0), v(0.0, 20.0), v(0.0, 30.0)];
        reach(&mut leg, &[0, 1, 2, 3], v(0.0, -6.0));
        assert!(leg[3].distance(v(0.0, 24.0)) < 0.1, "{leg:?}");
        assert!(lengths(&leg).iter().all(|length| (length - 10.0).abs() < 1e-9));
    }
}
