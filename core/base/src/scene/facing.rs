//! To which side the body of a clip looks, and clips mirrored to look to the other.
//!
//! **A body that lies along the ground**, such as a four-legged one, looks to where its torso leads.
//!
//! **A standing body** has no such direction in its skeleton. Its joints tell its side: in profile a knee bends one way only,
//! and an elbow the other ([`of_joints`]). Which way a joint bends is that of the template's typical posture. Where that is
//! straight and the chain has two bones, a leg's joint is in front, as a knee is, and a limb's behind, as an elbow is. The
//! mean of the bends decides, if it is clear and most bends agree. From the front joints bend to both sides: that side is
//! not told.
//!
//! Templates look right, as the built-in animals do, unless a torso that lies leads to the left.
//!
//! Limits: a body that turns round in a clip has no side for the clip as a whole. Heads are not looked at, since a
//! skeleton's head has no nose.

use super::template::{Role, Template};
use crate::geometry::Point;

/// A body lies along the ground if its torso is at least this many times as long along x as along y.
const LIES: f64 = 1.0;
/// A joint of the typical posture is straight if the sine of its bend is smaller.
const STRAIGHT: f64 = 0.02;
/// The mean sine of the bends must be at least this for a side: a bend of 3 degrees.
const BENT: f64 = 0.05;
/// The bends to one side must exceed those to the other by this share of all.
const AGREE: f64 = 0.5;

/// A side of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// x decreases.
    Left,
    /// x increases.
    Right,
}

impl Side {
    /// Its name.
    pub fn id(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// The side of a value's sign; none for 0.
    pub fn of(value: f64) -> Option<Self> {
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        Some(if value > 0.0 { Self::Right } else { Self::Left })
    }

    /// 1 for right, −1 for left.
    pub fn sign(self) -> f64 {
        if self == Self::Right { 1.0 } else { -1.0 }
    }
}

/// The way of the torso along the ground in postures; `None` for a body that stands.
pub fn lying(template: &Template, postures: &[Vec<Point>]) -> Option<f64> {
    let torso = template.torso();
    let way = |p: &[Point]| p[torso[torso.len() - 1]] - p[0];
    let typical = way(&template.typical());
    (typical.x.abs() > LIES * typical.y.abs()).then(|| postures.iter().map(|p| way(p).x).sum())
}

/// The side to which a template's typical posture looks.
pub fn typical(template: &Template) -> Side {
    lying(template, &[template.typical()]).and_then(Side::of).unwrap_or(Side::Right)
}

/// The side to which a body looks in the postures of a clip; `None` if they do not tell it.
pub fn of_clip(template: &Template, postures: &[Vec<Point>]) -> Option<Side> {
    match lying(template, postures) {
        Some(way) => Side::of(way),
        None => of_joints(template, postures, |_| true),
    }
}

/// The joints of legs and limbs: their key points, and the sign of the bend of a body that looks right.
fn joints(template: &Template) -> Vec<([usize; 3], f64)> {
    let (posture, looks) = (template.typical(), typical(template).sign());
    let mut found = Vec::new();
    for chain in template.chains().iter().filter(|chain| matches!(chain.role, Role::Leg | Role::Limb)) {
        for joint in chain.points.windows(3) {
            let (joint, bend) = ([joint[0], joint[1], joint[2]], bend(&posture, joint));
            match chain.role {
                _ if bend.abs() >= STRAIGHT => found.push((joint, bend.signum() * looks)),
                Role::Leg if chain.points.len() == 3 => found.push((joint, 1.0)),
                Role::Limb if chain.points.len() == 3 => found.push((joint, -1.0)),
                _ => {}
            }
        }
    }
    found
}

/// The sine of the turn from a joint's first bone to its second.
fn bend(posture: &[Point], joint: &[usize]) -> f64 {
    let way = |a: usize, b: usize| (posture[b] - posture[a]).normalize_or_zero();
    way(joint[0], joint[1]).perp_dot(way(joint[1], joint[2]))
}

/// The side of the bends of all joints whose key points are told.
pub fn of_joints(template: &Template, postures: &[Vec<Point>], told: impl Fn(usize) -> bool) -> Option<Side> {
    let joints = joints(template);
    let known = joints.iter().filter(|(joint, _)| joint.iter().all(|k| told(*k)));
    let bends: Vec<f64> = known.flat_map(|(joint, sign)| postures.iter().map(move |p| sign * bend(p, joint))).collect();
    let (sum, all) = bends.iter().fold((0.0, 0.0), |(sum, all), b| (sum + b, all + b.abs()));
    Side::of(sum).filter(|_| sum.abs() >= BENT * bends.len() as f64 && sum.abs() >= AGREE * all)
}

/// Postures mirrored about the root of the first. Each key point keeps its name.
pub fn mirrored(postures: &[Vec<Point>]) -> Vec<Vec<Point>> {
    let about = postures.first().and_then(|p| p.first()).map_or(0.0, |root| root.x);
    let mirrored = |p: &Vec<Point>| p.iter().map(|q| Point::new(2.0 * about - q.x, q.y)).collect();
    postures.iter().map(mirrored).collect()
}

/// Postures mirrored about the root of the first, left and right exchanged: the limb that was nearer to the viewer is nearer to
/// him again. It is what the picture of the body shows in a mirror.
pub fn in_a_mirror(template: &Template, postures: &[Vec<Point>]) -> Vec<Vec<Point>> {
    let exchanged = |p: Vec<Point>| (0..p.len()).map(|k| p[template.mirror(k)]).collect();
    mirrored(postures).into_iter().map(exchanged).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flipped(posture: &[Point]) -> Vec<Point> {
        posture.iter().map(|p| Point::new(-p.x, p.y)).collect()
    }

    /// A human that stands, its joints bent by the given angles: knees, elbows; left, right.
    fn bent(knees: [f64; 2], elbows: [f64; 2]) -> Vec<Point> {
        let mut p = Template::human().typical();
        for (joint, angle) in [(12, knees[0]), (15, knees[1]), (6, elbows[0]), (9, elbows[1])] {
            p[joint + 1] = p[joint] + Point::from_angle(angle).rotate(p[joint + 1] - p[joint]);
        }
        p
    }

    #[test]
    fn an_animal_looks_to_where_its_torso_leads() {
        for template in [Template::quadruped(), Template::bird()] {
            let right = vec![template.typical(); 2];
            let left: Vec<Vec<Point>> = right.iter().map(|p| flipped(p)).collect();
            assert_eq!(typical(&template), Side::Right);
            let sides = [&right, &left].map(|p| of_clip(&template, p));
            assert_eq!(sides, [Some(Side::Right), Some(Side::Left)]);
        }
    }

    #[test]
    fn a_human_looks_to_where_its_knees_are_and_its_elbows_are_not() {
        let human = Template::human();
        let right = [bent([0.4, 0.1], [-0.3, -0.2]), bent([0.0, 0.7], [-0.3, 0.1])].to_vec();
        let left: Vec<Vec<Point>> = right.iter().map(|p| flipped(p)).collect();
        assert_eq!([&right, &left].map(|p| of_clip(&human, p)), [Some(Side::Right), Some(Side::Left)]);
        // From the front joints bend to both sides, or hardly at all.
        for front in [bent([0.4, -0.4], [0.5, -0.5]), bent([0.02, 0.03], [-0.01, 0.0]), human.typical()] {
            assert_eq!(of_clip(&human, &[front]), None);
        }
        // Joints that are not told do not count.
        assert_eq!(of_joints(&human, &right, |k| k < 5), None);
    }

    #[test]
    fn in_a_mirror_the_near_arm_stays_near_and_the_way_turns_round() {
        let human = Template::human();
        let step = |p: Vec<Point>, x: f64| p.iter().map(|q| *q + Point::new(x, 0.0)).collect();
        let clip: Vec<Vec<Point>> = vec![bent([0.4, 0.1], [-0.3, -0.2]), step(bent([0.1, 0.4], [-0.2, -0.3]), 0.5)];
        let other = in_a_mirror(&human, &clip);
        assert_eq!([&clip, &other].map(|p| of_clip(&human, p)), [Some(Side::Right), Some(Side::Left)]);
        let [left, right] = ["l_wrist", "r_wrist"].map(|name| human.index(name).unwrap());
        for (a, b) in clip.iter().zip(&other) {
            assert!((a[left].x + b[right].x - 2.0 * clip[0][0].x).abs() < 1e-12 && a[left].y == b[right].y);
        }
        assert!((other[1][0].x - other[0][0].x + 0.5).abs() < 1e-12);
        let back = in_a_mirror(&human, &other);
        assert!(back.iter().flatten().zip(clip.iter().flatten()).all(|(a, b)| a.distance(*b) < 1e-12));
    }
}
