//! To which side a drawing looks.
//!
//! A body that lies along the ground looks to where its torso leads, and the joints of a standing one tell its side, in a
//! drawing as in a clip ([`rototoon_base::scene::facing`]). A drawing shows more: its shoes reach farther in front of the
//! ankle than behind it ([`of_feet`]). They count before the joints. Shoes from the front point to both sides or to none.

use super::foot::Foot;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;
pub use rototoon_base::scene::facing::{Side, mirrored, of_clip, typical};
use rototoon_base::scene::facing::{lying, of_joints};

/// A foot must reach farther to one side by this share of its length.
const POINTS: f64 = 0.2;

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
    fn a_drawing_without_shoes_looks_as_its_body_leads_or_its_joints_bend() {
        let left = flipped(&Template::quadruped().typical());
        assert_eq!(of_drawing(&Template::quadruped(), &[left], |_| true, &[]), Some(Side::Left));
        let right = [bent([0.4, 0.3], [-0.3, -0.3])];
        assert_eq!(of_drawing(&Template::human(), &right, |_| true, &[]), Some(Side::Right));
        assert_eq!(of_drawing(&Template::human(), &right, |k| k < 5, &[]), None, "joints that no contour tells");
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
