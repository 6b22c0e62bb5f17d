//! The character's model sheet: makes the outlines of all parts from a drawing's pose.
//!
//! Every outline is a formula of the pose. So a control point keeps its meaning (a heel, a cuff, the left of the jaw) on
//! every drawing, which makes the truth exact. When a round body turns, its silhouette stays, and the details on it slide
//! (yaw). Only parts that stick out (toes, belly, cheek) grow on the side that the character faces.

use super::outline::{Outline, strip};
use super::pose::Drawing;
use rototoon::geometry::Point;

/// Pixels per unit of the model sheet.
const SCALE: f64 = 0.93;
/// y of the ground, in pixels.
pub const GROUND: f64 = 478.0;
/// x of the ground's origin, in pixels.
const ORIGIN: f64 = 228.0;
/// Length of thigh and of shin.
const LEG: [f64; 2] = [66.0, 62.0];
/// Length of upper arm and of forearm.
const ARM: [f64; 2] = [50.0, 42.0];
/// Height of the ankle over the sole.
const ANKLE: f64 = 20.0;

/// A coordinate frame on a drawing: its origin, x axis and y axis (down).
#[derive(Clone, Copy, Debug)]
pub struct Place {
    origin: Point,
    x: Point,
    y: Point,
}

impl Place {
    fn new(origin: Point, degrees: f64, scale: Point) -> Self {
        let x = Point::from_angle(degrees.to_radians());
        Self { origin, x: scale.x * x, y: scale.y * x.perp() }
    }

    /// Converts a point of this frame to picture coordinates.
    pub fn at(&self, x: f64, y: f64) -> Point {
        self.origin + x * self.x + y * self.y
    }

    fn all(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Point> {
        points.into_iter().map(|(x, y)| self.at(x, y)).collect()
    }
}

/// The outlines of one drawing, and the frames for details of face and coat.
#[derive(Clone, Debug)]
pub struct Rig {
    /// The frame of the head, with its origin at the centre.
    pub head: Place,
    /// The frame of the body, with its origin at the hips.
    pub body: Place,
    /// The drawing's pose.
    pub pose: Drawing,
    /// Outlines in the order of [`super::character::PARTS`], from the farthest to the nearest.
    pub outlines: Vec<Outline>,
}

impl Rig {
    /// Makes the outlines of a pose.
    pub fn new(pose: &Drawing) -> Self {
        let wide = pose.squash.powf(-0.7);
        let hip = ground(pose.hip[0], pose.hip[1]);
        let body = Place::new(hip, pose.lean, SCALE * Point::new(wide, pose.squash));
        // The head is squashed less than the body.
        let firm = pose.squash.powf(0.6);
        let head_scale = SCALE * Point::new(firm.powf(-0.7), firm);
        let neck = body.at(3.0 * pose.facing, -104.0);
        let turn = pose.lean + pose.tilt;
        let head = Place::new(neck, turn, head_scale);
        let head = Place { origin: head.at(5.0 * pose.facing, -50.0), ..head };
        let mut rig = Self { head, body, pose: *pose, outlines: Vec::new() };
        rig.outlines = rig.solve();
        rig
    }

    fn solve(&self) -> Vec<Outline> {
        let pose = &self.pose;
        let (far_arm, far_hand) = self.arm(30.0, pose.far_arm, -1.0);
        let (far_leg, far_boot) = self.leg(15.0, pose.far_foot);
        let (near_leg, near_boot) = self.leg(-13.0, pose.near_foot);
        let (near_arm, near_hand) = self.arm(-30.0, pose.near_arm, 1.0);
        let (hat, bobble) = self.hat();
        vec![
            far_arm,
            far_hand,
            far_leg,
            far_boot,
            near_leg,
            near_boot,
            self.coat(),
            self.scarf_tail(),
            self.scarf(),
            self.head_outline(),
            self.hair(),
            hat,
            self.brim(),
            bobble,
            near_arm,
            near_hand,
        ]
    }

    /// Sleeve and mitten. `thumb` is the side of the thumb, 1 or -1.
    fn arm(&self, shoulder: f64, angles: [f64; 2], thumb: f64) -> (Outline, Outline) {
        let across = shoulder - 4.0 * self.pose.facing;
        let shoulder = self.body.at(across, -86.0);
        let elbow = shoulder + SCALE * ARM[0] * hanging(angles[0]);
        let wrist = elbow + SCALE * ARM[1] * hanging(angles[1]);
        let mut sleeve = Outline::closed(strip([shoulder, elbow, wrist], 5, [9.0, 1.0], |t| SCALE * (14.5 + 2.5 * t)));
        sleeve = sleeve.with_corners(&[4, 6]);
        // There is no line across the shoulder, because the sleeve continues the coat.
        let ends = [0, 10, 11];
        let hand = Place::new(wrist, -angles[1], Point::splat(SCALE));
        let mitten = hand.all(
            [
                (-10.0, -3.0),
                (-13.0, 5.0),
                (-17.0, 16.0),
                (-14.0, 28.0),
                (-4.0, 35.0),
                (7.0, 32.0),
                (13.0, 23.0),
                (17.0, 25.0),
                (23.0, 20.0),
                (22.0, 11.0),
                (14.0, 5.0),
                (10.0, -3.0),
            ]
            .map(|(x, y)| (thumb * x, y)),
        );
        let mut mitten = Outline::closed(mitten).with_corners(&[0, 6, 11]);
        ink(&mut sleeve, 1.0, &ends);
        ink(&mut mitten, 0.95, &[]);
        (sleeve, mitten)
    }

    /// Trouser leg and boot, by two-bone inverse kinematics from hip to ankle, with the knee to the front.
    fn leg(&self, side: f64, [x, height, turn]: [f64; 3]) -> (Outline, Outline) {
        let facing = self.pose.facing;
        let hip = self.body.at(side * (1.0 - 0.45 * facing.abs()), -6.0);
        let boot = Place::new(ground(x, height + ANKLE), turn, Point::splat(SCALE));
        let ankle = boot.origin;
        // Knees point forward. In a crouch each knee points to its own side.
        let forward = if self.pose.squash < 0.85 { ankle.x - hip.x } else { facing };
        let bend = if forward >= 0.0 { 1.0 } else { -1.0 };
        let knee = knee(hip, ankle, LEG.map(|l| SCALE * l), bend);
        let mut leg = Outline::closed(strip([hip, knee, ankle], 5, [8.0, 3.0], |t| SCALE * (18.0 - 3.0 * t)));
        ink(&mut leg, 1.0, &[]);
        let right: [(f64, f64, f64); 7] = [
            (0.0, -15.0, 0.0),
            (17.0, -14.0, 0.0),
            (16.0, -3.0, 7.0),
            (18.0, 8.0, 22.0),
            (19.0, 18.0, 23.0),
            (8.0, 20.0, 10.0),
            (0.0, 20.0, 2.0),
        ];
        let left = right[1..6].iter().rev().map(|&(x, y, toe)| (-x - toe * (-facing).max(0.0), y));
        let outline = right.iter().map(|&(x, y, toe)| (x + toe * facing.max(0.0), y)).chain(left);
        let mut outline = Outline::closed(boot.all(outline)).with_corners(&[1, 4, 8, 11]);
        ink(&mut outline, 1.1, &[]);
        (leg, outline)
    }

    fn coat(&self) -> Outline {
        let (facing, sway) = (self.pose.facing, self.pose.sway);
        let right: [(f64, f64, f64); 9] = [
            (0.0, -106.0, 0.0),
            (24.0, -103.0, 0.0),
            (41.0, -88.0, 0.0),
            (45.0, -66.0, 2.0),
            (48.0, -42.0, 5.0),
            (52.0, -18.0, 5.0),
            (56.0, 10.0, 1.0),
            (29.0, 17.0, 0.0),
            (0.0, 19.0, 0.0),
        ];
        let swing = |y: f64| sway * ((y + 60.0) / 70.0).clamp(0.0, 1.0);
        let left = right[1..8].iter().rev().map(|&(x, y, belly)| (-x - belly * (-facing).max(0.0) + swing(y), y));
        let outline = right.iter().map(|&(x, y, belly)| (x + belly * facing.max(0.0) + swing(y), y)).chain(left);
        let mut coat = Outline::closed(self.body.all(outline)).with_corners(&[6, 10]);
        ink(&mut coat, 1.05, &[]);
        coat
    }

    fn scarf(&self) -> Outline {
        let mut scarf = Outline::closed(self.body.all((0..12).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 12.0).sin_cos();
            (3.0 * self.pose.facing + 38.0 * cos, -101.0 + 15.0 * sin + 2.5 * cos * cos)
        })));
        ink(&mut scarf, 1.0, &[]);
        scarf
    }

    fn scarf_tail(&self) -> Outline {
        let knot = self.body.at(-27.0 * self.pose.facing, -98.0);
        let middle = knot + SCALE * 50.0 * hanging(self.pose.scarf[0]);
        let end = middle + SCALE * 52.0 * hanging(self.pose.scarf[1]);
        let mut tail = Outline::closed(strip([knot, middle, end], 5, [3.0, 2.0], |t| SCALE * (11.0 + 6.0 * t)))
            .with_corners(&[4, 6]);
        ink(&mut tail, 1.0, &[]);
        tail
    }

    fn head_outline(&self) -> Outline {
        let facing = self.pose.facing;
        let mut head = Outline::closed(self.head.all((0..16).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 16.0).sin_cos();
            // The cheeks are widest below the middle, and wider on the side that the face looks to.
            let cheek = (-((sin - 0.45) / 0.45).powi(2)).exp();
            let side = 5.0 * cheek * (facing * cos).max(0.0) - 3.0 * cheek * (-facing * cos).max(0.0);
            let x = 64.0 * cos + 7.0 * cheek * cos + side * cos.signum();
            (x, 57.0 * sin - if sin > 0.0 { 4.0 * (1.0 - cos * cos) } else { 0.0 })
        })));
        ink(&mut head, 1.1, &[]);
        head
    }

    /// A fringe of four spikes under the brim. It slides over the forehead when the head turns.
    fn hair(&self) -> Outline {
        let yaw = 0.55 * self.pose.facing;
        let place = |longitude: f64, y: f64| {
            let reach = 66.0 * (1.0 - (y / 60.0) * (y / 60.0)).max(0.2).sqrt();
            (reach * (longitude + yaw).clamp(-1.5, 1.5).sin(), y)
        };
        let outline = [
            (-1.15, -30.0),
            (-0.4, -37.0),
            (0.4, -37.0),
            (1.15, -30.0),
            (1.12, -2.0),
            (0.78, -17.0),
            (0.42, -3.0),
            (0.14, -17.0),
            (-0.2, -2.0),
            (-0.5, -17.0),
            (-0.86, -1.0),
            (-1.0, -14.0),
        ];
        let mut hair = Outline::closed(self.head.all(outline.map(|(a, y)| place(a, y))));
        hair = hair.with_corners(&[4, 5, 6, 7, 8, 9, 10, 11]);
        ink(&mut hair, 0.85, &[0, 1, 2, 3]);
        hair
    }

    /// Pointed cap and the bobble at its tip.
    fn hat(&self) -> (Outline, Outline) {
        let [lower, upper] = self.pose.hat;
        let lean = self.pose.lean + self.pose.tilt;
        let base = self.head.at(0.0, -34.0);
        let rising = |degrees: f64| -hanging(-degrees - lean);
        let middle = base + SCALE * 66.0 * rising(lower);
        let tip = middle + SCALE * 62.0 * rising(upper);
        let wide = self.head.x.length() / SCALE;
        let profile = |t: f64| SCALE * wide * (9.0 + 51.0 * (1.0 - t).powf(0.85));
        let mut hat = Outline::closed(strip([base, middle, tip], 6, [0.0, 3.0], profile)).with_corners(&[0, 12]);
        ink(&mut hat, 1.1, &[13]);
        // Six tufts. The notches between them are corners.
        let tufts = (0..12).map(|i| {
            let angle = f64::from(i) * std::f64::consts::TAU / 12.0 + upper.to_radians();
            tip + SCALE * if i % 2 == 0 { 19.5 } else { 16.5 } * Point::from_angle(angle)
        });
        let mut bobble = Outline::closed(tufts.collect()).with_corners(&[1, 3, 5, 7, 9, 11]);
        ink(&mut bobble, 0.95, &[]);
        (hat, bobble)
    }

    fn brim(&self) -> Outline {
        let ends = [self.head.at(-63.0, -25.0), self.head.at(0.0, -44.0), self.head.at(63.0, -25.0)];
        let mut brim = Outline::closed(strip(ends, 6, [9.0, 9.0], |t| SCALE * (12.0 + 8.0 * t * (1.0 - t))));
        ink(&mut brim, 1.0, &[]);
        brim
    }
}

/// Converts x along the ground and height above it to picture coordinates.
fn ground(x: f64, height: f64) -> Point {
    Point::new(ORIGIN + SCALE * x, GROUND - SCALE * height)
}

/// The direction at `degrees` from straight down towards the right.
fn hanging(degrees: f64) -> Point {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Point::new(sin, cos)
}

/// The joint between two bones. An ankle out of reach stretches the leg.
fn knee(hip: Point, ankle: Point, [thigh, shin]: [f64; 2], bend: f64) -> Point {
    let span = ankle - hip;
    let d = span.length().clamp(1.0, thigh + shin);
    let along = (thigh * thigh - shin * shin + d * d) / (2.0 * d);
    let out = (thigh * thigh - along * along).max(0.0).sqrt();
    let direction = span.normalize_or_zero();
    hip + along / d * span.length() * direction - bend * out * direction.perp()
}

/// Sets the ink's width. It is larger below and to the right, as if light came from the upper left, and 0 at `bare` points.
fn ink(outline: &mut Outline, weight: f64, bare: &[usize]) {
    let n = outline.points.len();
    let clockwise = rototoon::geometry::polygon::signed_area(&outline.points) >= 0.0;
    for i in 0..n {
        let along = outline.points[(i + 1) % n] - outline.points[(i + n - 1) % n];
        let outward = if clockwise { -along.perp() } else { along.perp() }.normalize_or_zero();
        let shadow = 0.5 + 0.5 * outward.dot(Point::new(0.5, 0.866));
        outline.ink[i] = if bare.contains(&i) { 0.0 } else { weight * (2.5 + 2.0 * shadow) };
    }
}
