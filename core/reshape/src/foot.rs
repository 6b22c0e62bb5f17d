//! A foot of a drawing: its sole, and how far it is turned.
//!
//! A foot is drawn once, so its drawing does not say how its ankle bends. On the ground the ground forces the foot flat, and in a
//! stride the two shins lie differently. The angle between shin and foot that a stride shows is therefore not that of a foot in
//! the air. Two rules follow:
//!
//! - **A shoe** is level ([`flat`]) when the leg's last bone has its typical direction: a human's shin is upright. In the
//!   air the shoe takes a share of the bone's turn from there. Both feet then have the same pitch in the same posture, however the legs are
//!   drawn.
//! - **The end of a leg** without a shoe turns with its bone, from where it is drawn.
//!
//! Where the document shows a shoe on a further frame, its turn is measured there ([`turned`]).
//!
//! Angles are in radians, from the drawing at rest; x right, y down.
//!
//! Limits: a skeleton has no toes, so how a clip's ankles bend is not known. A foot that is drawn pointed becomes level too.

use rototoon_base::geometry::Point;

/// Points of a sole are on the ground if they are no higher than this share of the foot's size above its lowest point.
const TOUCHES: f64 = 0.06;
/// A foot is laid flatter if each radian of turn adds this share of its size to what touches the ground.
const FLATTER: f64 = 0.35;
/// A turn must gain this share of the foot's size over the foot as drawn: a drawn curve is a polygon.
const CLEARLY: f64 = 0.15;
/// Largest turn that lays a sole flat, in radians.
const MOST_TILT: f64 = 1.0;

/// A foot of a drawing at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Foot {
    /// Which of the template's legs has it.
    pub leg: usize,
    /// Points of its outline relative to the ankle, at rest.
    pub shape: Vec<Point>,
    /// For a shoe the share of the last bone's turn that it takes in the air; `None` for the end of a leg, which turns with
    /// the bone.
    pub turn: Option<f64>,
    /// The turn that lays its sole flat; 0 for the end of a leg.
    pub level: f64,
    /// Direction of the leg's last bone in which a shoe is level, and the end of a leg as drawn.
    bone: Point,
}

impl Foot {
    /// A shoe. `upright` is the typical direction of the leg's last bone, `turn` the share of the bone's turn that the shoe takes
    /// in the air.
    pub fn shoe(leg: usize, shape: Vec<Point>, upright: Point, turn: f64) -> Self {
        let level = flat(&shape);
        Self { leg, shape, turn: Some(turn), level, bone: upright }
    }

    /// The end of a leg without a shoe. `bone` is the leg's last bone at rest: of a human the shin, from knee to ankle.
    pub fn end(leg: usize, shape: Vec<Point>, bone: Point) -> Self {
        Self { leg, shape, turn: None, level: 0.0, bone }
    }

    /// The foot's turn in the air. `leg` are the key points of its leg.
    pub fn swing(&self, leg: &[usize], posture: &[Point]) -> f64 {
        let now = posture[foot_of(leg)] - posture[leg[leg.len() - 2]];
        let known = now.length_squared() > 0.0 && self.bone.length_squared() > 0.0;
        self.level + if known { self.turn.unwrap_or(1.0) * self.bone.angle_to(now) } else { 0.0 }
    }

    /// How far the foot reaches below the ankle, turned by an angle.
    pub fn depth(&self, turn: f64) -> f64 {
        let turn = Point::from_angle(turn);
        self.shape.iter().map(|p| turn.rotate(*p).y).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The point of the flat sole farthest to the side to which the foot points.
    pub(crate) fn toe(&self) -> Point {
        let touching = on_ground(&turned_by(&self.shape, self.level));
        touching.into_iter().max_by(|a, b| a.x.abs().total_cmp(&b.x.abs())).unwrap_or(Point::X)
    }

    /// How much farther the level foot reaches to one side of the ankle than to the other, as a share of its length: 0 for a foot
    /// from the front, about 0.5 for a shoe that points right, −0.5 for one that points left.
    pub(crate) fn points(&self) -> f64 {
        let xs = turned_by(&self.shape, self.level);
        let (left, right) = xs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), p| (l.min(p.x), r.max(p.x)));
        if right > left { (right + left) / (right - left) } else { 0.0 }
    }
}

/// The key point of a leg's foot: its last.
pub(crate) fn foot_of(leg: &[usize]) -> usize {
    leg[leg.len() - 1]
}

fn turned_by(shape: &[Point], angle: f64) -> Vec<Point> {
    let turn = Point::from_angle(angle);
    shape.iter().map(|p| turn.rotate(*p)).collect()
}

/// The rotation that fits the points of an outline to those of another drawing of it by least squares, whatever the shift;
/// `None` if they are not the same points.
pub fn turned(from: &[Point], to: &[Point]) -> Option<f64> {
    if from.len() != to.len() || from.len() < 2 {
        return None;
    }
    let middle = |of: &[Point]| of.iter().sum::<Point>() / of.len() as f64;
    let (a, b) = (middle(from), middle(to));
    let (cosine, sine) = from.iter().zip(to).fold((0.0, 0.0), |(cosine, sine), (p, q)| {
        let (p, q) = (*p - a, *q - b);
        (cosine + p.dot(q), sine + p.perp_dot(q))
    });
    (cosine != 0.0 || sine != 0.0).then(|| sine.atan2(cosine))
}

/// The points of a foot that touch the ground.
fn on_ground(shape: &[Point]) -> Vec<Point> {
    let low = shape.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    let size = diameter(shape);
    shape.iter().filter(|p| p.y >= low - TOUCHES * size).copied().collect()
}

fn diameter(shape: &[Point]) -> f64 {
    shape.iter().flat_map(|p| shape.iter().map(|q| p.distance(*q))).fold(0.0, f64::max)
}

/// The turn that lays a sole flat on the ground; 0 if it is drawn flat, or has no flat side.
///
/// Of the turns that lay an edge of the lower hull level, the one with which most of the width touches the ground.
pub fn flat(shape: &[Point]) -> f64 {
    let size = diameter(shape);
    let touching = |angle: f64| {
        let on = on_ground(&turned_by(shape, angle));
        let (left, right) = on.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), p| (l.min(p.x), r.max(p.x)));
        (right - left) / size.max(f64::MIN_POSITIVE) - FLATTER * angle.abs()
    };
    let mut best = (0.0, touching(0.0));
    for (a, b) in lower_hull(shape) {
        let angle = -(b - a).to_angle();
        let gain = touching(angle);
        if angle.abs() <= MOST_TILT && gain > best.1 + if best.0 == 0.0 { CLEARLY } else { 0.0 } {
            best = (angle, gain);
        }
    }
    best.0
}

/// The edges of the convex hull's lower side (y down), from left to right (Andrew's monotone chain).
fn lower_hull(points: &[Point]) -> Vec<(Point, Point)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull: Vec<Point> = Vec::new();
    for p in sorted {
        while let [.., a, b] = hull[..] {
            if (b - a).perp_dot(p - a) < 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    }
    hull.windows(2).map(|pair| (pair[0], pair[1])).filter(|(a, b)| a.x < b.x).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A shoe that points right, turned by an angle about its ankle.
    pub(crate) fn shoe(tilt: f64) -> Vec<Point> {
        let turn = Point::from_angle(tilt);
        [(-6.0, 4.0), (-5.0, 8.0), (4.0, 8.0), (14.0, 8.0), (15.0, 5.0), (4.0, -2.0), (-4.0, -3.0)]
            .map(|(x, y)| turn.rotate(Point::new(x, y)))
            .to_vec()
    }

    fn ball() -> Vec<Point> {
        (0..24).map(|k| Point::from_angle(0.2618 * f64::from(k)) * 9.0).collect()
    }

    #[test]
    fn a_tilted_sole_is_laid_flat_and_a_ball_is_left_as_drawn() {
        for tilt in [0.0, 0.5, -0.4] {
            assert!((flat(&shoe(tilt)) + tilt).abs() < 1e-9, "{tilt}: {}", flat(&shoe(tilt)));
        }
        assert_eq!(flat(&ball()), 0.0);
        assert_eq!(flat(&[]), 0.0);
    }

    #[test]
    fn in_the_air_feet_do_not_keep_the_stride_in_which_they_are_drawn() {
        let (leg, down) = ([0, 1, 2], Point::new(0.0, 40.0));
        let posture = |shin: f64| vec![Point::ZERO, down, down + Point::from_angle(shin).rotate(down)];
        // One shoe is drawn flat, the other with its heel up by half a radian.
        let (front, back) = (Foot::shoe(0, shoe(0.0), down, 1.0), Foot::shoe(1, shoe(0.5), down, 1.0));
        for shin in [-0.6, 0.0, 1.0] {
            let pitch = [front.swing(&leg, &posture(shin)), back.swing(&leg, &posture(shin)) + 0.5];
            assert!(pitch.iter().all(|p| (p - shin).abs() < 1e-9), "{shin}: {pitch:?}");
        }
        assert!((Foot::shoe(0, shoe(0.0), down, 0.3).swing(&leg, &posture(1.0)) - 0.3).abs() < 1e-9);
        // The end of a leg is drawn with its bone.
        let end = Foot::end(0, shoe(0.0), Point::from_angle(0.4).rotate(down));
        assert!((end.swing(&leg, &posture(1.0)) - 0.6).abs() < 1e-9);
    }

    #[test]
    fn the_side_to_which_a_foot_points() {
        let of = |shape: Vec<Point>| Foot::shoe(0, shape, Point::Y, 1.0).points();
        let left = shoe(0.0).iter().map(|p| Point::new(-p.x, p.y)).collect();
        assert!(of(shoe(0.3)) > 0.4 && of(left) < -0.4 && of(ball()).abs() < 0.05, "{}", of(ball()));
    }

    #[test]
    fn the_turn_between_two_drawings_is_measured() {
        let moved: Vec<Point> = shoe(0.7).iter().map(|p| *p + Point::new(40.0, -3.0)).collect();
        assert!((turned(&shoe(0.0), &moved).unwrap() - 0.7).abs() < 1e-9);
        assert_eq!((turned(&shoe(0.0), &moved[1..]), turned(&[], &[])), (None, None));
        assert_eq!(turned(&[Point::ONE; 3], &[Point::ONE; 3]), None);
    }
}
