//! To which side a body looks, and clips mirrored to look to the other.
//!
//! **A body that lies along the ground**, such as a four-legged one, looks to where its torso leads.
//!
//! **A standing body** has no such direction in its skeleton. Two things tell its side:
//!
//! - *Shoes*, in a drawing: they reach farther in front of the ankle than behind it ([`of_feet`]).
//! - *Joints*: in profile a knee bends one way only, and an elbow the other ([`of_joints`]). Which way a joint bends is that of the
//!   template's typical posture. Where that is straight and the chain has two bones, a leg's joint is in front, as a
//!   knee is, and a limb's behind, as an elbow is. The mean of the bends decides, if it is clear and most bends agree.
//!
//! A body from the front bends its joints to both sides, and its shoes point to both sides or to none: its side is not told.
//!
//! Templates look right, as the built-in animals do, unless a torso that lies leads to the left.
//!
//! Limits: a body that turns round in a clip has no side for the clip as a whole. Heads are not looked at, since a
//! skeleton's head has no nose.

use super::foot::Foot;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;
use rototoon_base::scene::template::Role;

/// A body lies along the ground if its torso is at least this many times as long along x as along y.
const LIES: f64 = 1.0;
/// A joint of the typical posture is straight if the sine of its bend is smaller.
const STRAIGHT: f64 = 0.02;
/// The mean sine of the bends must be at least this for a side: a bend of 3 degrees.
const BENT: f64 = 0.05;
/// The bends to one side must exceed those to the other by this share of all.
const AGREE: f64 = 0.5;
/// A foot must reach farther to one side by this share of its length.
const POINTS: f64 = 0.2;

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
    fn of(value: f64) -> Option<Self> {
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        Some(if value > 0.0 { Self::Right } else { Self::Left })
    }

    fn sign(self) -> f64 {
        if self == Self::Right { 1.0 } else { -1.0 }
    }
}

/// The way of the torso along the ground in postures; `None` for a body that stands.
fn lying(template: &Template, postures: &[Vec<Point>]) -> Option<f64> {
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

/// The side to which a drawing looks, from its postures, the key points that its contours tell, and its feet.
pub fn of_drawing(
    template: &Template,
    postures: &[Vec<Point>],
    told: impl Fn(usize) -> bool,
    feet: &[Foot],
) -> Option<Side> {
    match lying(template, postures) {
        Some(way) => Side::of(way),
        None => of_feet(feet).or_else(|| of_joints(template, postures, told)),
    }
}

/// The side to which shoes point in the mean.
fn of_feet(feet: &[Foot]) -> Option<Side> {
    let shoes: Vec<f64> = feet.iter().filter(|foot| foot.turn.is_some()).map(Foot::points).collect();
    let mean = shoes.iter().sum::<f64>() / shoes.len().max(1) as f64;
    Side::of(mean).filter(|_| mean.abs() >= POINTS)
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
fn of_joints(template: &Template, postures: &[Vec<Point>], told: impl Fn(usize) -> bool) -> Option<Side> {
    let joints = joints(template);
    let known = joints.iter().filter(|(joint, _)| joint.iter().all(|k| told(*k)));
    let bends: Vec<f64> = known.flat_map(|(joint, sign)| postures.iter().map(move |p| sign * bend(p, joint))).collect();
    let (sum, all) = bends.iter().fold((0.0, 0.0), |(sum, all), b| (sum + b, all + b.abs()));
    Side::of(sum).filter(|_| sum.abs() >= BENT * bends.len() as f64 && sum.abs() >= AGREE * all)
}

/// Postures mirrored about the root of the first.
pub fn mirrored(postures: &[Vec<Point>]) -> Vec<Vec<Point>> {
    let about = postures.first().and_then(|p| p.first()).map_or(0.0, |root| root.x);
    let mirrored = |p: &Vec<Point>| p.iter().map(|q| Point::new(2.0 * about - q.x, q.y)).collect();
    postures.iter().map(mirrored).collect()
}

#[cfg(test)]
mod tests {
    use super::super::contacts::tests::walk;
    use super::super::foot::tests::shoe;
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
            assert_eq!(of_drawing(&template, &left, |_| true, &[]), Some(Side::Left));
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
        // Joints that no contour tells do not count.
        assert_eq!(of_drawing(&human, &right, |k| k < 5, &[]), None);
    }

    #[test]
    fn a_walk_has_a_side_and_its_mirror_image_the_other() {
        let (human, clip) = (Template::human(), walk(48, true));
        let side = of_clip(&human, &clip).unwrap();
        let other = mirrored(&clip);
        assert_ne!(of_clip(&human, &other).unwrap(), side);
        let way = |clip: &[Vec<Point>]| clip[47][0].x - clip[0][0].x;
        assert!((way(&clip) + way(&other)).abs() < 1e-9 && other[0][0] == clip[0][0]);
        assert_eq!(mirrored(&other), clip);
    }

    #[test]
    fn shoes_tell_the_side_of_a_drawing_whatever_its_knees_do() {
        let human = Template::human();
        let of = |shapes: [Vec<Point>; 2]| {
            let feet: Vec<Foot> =
                shapes.into_iter().enumerate().map(|(leg, shape)| Foot::shoe(leg, shape, Point::Y, 1.0)).collect();
            of_drawing(&human, &[bent([0.4, 0.3], [-0.3, -0.3])], |_| true, &feet)
        };
        let (to_right, to_left) = (shoe(0.2), flipped(&shoe(0.0)));
        assert_eq!(of([to_left.clone(), to_left.clone()]), Some(Side::Left));
        assert_eq!(of([to_right.clone(), to_right.clone()]), Some(Side::Right));
        assert_eq!(of([to_left, to_right]), Some(Side::Right), "shoes from the front: the joints tell it");
    }
}
