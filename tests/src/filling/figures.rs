//! Figures whose parts, sizes and colours are made by chance, for films that differ from each other.
//!
//! A figure has a body with bands, limbs in front of it and behind it, a head with ears, eyes, a mouth and perhaps a hat, and a tail. Limbs swing
//! and cross. When the figure turns, what is on the head and the body slides over it. The parts are the same on every drawing.

use super::shapes::{Shape, WHITE, disc, ellipse};
use crate::sample::outline::{Outline, strip};
use crate::tweening::matching::Chance;
use rototoon::geometry::Point;
use std::f64::consts::{PI, TAU};

/// Colours that are told apart easily, 0xRRGGBB.
pub const COLOURS: [u32; 16] = [
    0xd94b3a, 0xf08a3c, 0xf6c04a, 0xf3e48a, 0x9ac34d, 0x3f9b57, 0x2f7f86, 0x5bb7d4, 0x3a6fc0, 0x564aa3, 0x9b4fb0,
    0xd972a8, 0xf7c9b0, 0xb07a4a, 0x6b4632, 0x8d9299,
];

/// Control points on each side of a strip.
const SIDES: usize = 5;

/// A figure: what is the same on all drawings. Lengths are in pixels at 540 lines.
#[derive(Clone, Debug)]
pub struct Figure {
    body: Strip,
    limbs: Vec<Limb>,
    tail: Option<Limb>,
    head: Head,
    buttons: Vec<(f64, u32)>,
}

/// A strip and its bands: from and to, as shares of its length, and their colours.
#[derive(Clone, Debug)]
struct Strip {
    length: f64,
    widths: [f64; 2],
    colour: u32,
    bands: Vec<([f64; 2], u32)>,
}

#[derive(Clone, Debug)]
struct Limb {
    strip: Strip,
    /// Where it begins on the body: across, and down from 0 to 1.
    root: [f64; 2],
    /// Its angle from straight down, how far it swings, and when.
    rest: f64,
    swing: f64,
    offset: f64,
    /// The size and colour of the hand or foot.
    end: (f64, u32),
    front: bool,
}

#[derive(Clone, Debug)]
struct Head {
    size: Point,
    skin: u32,
    hair: Option<u32>,
    hat: Option<Strip>,
    ears: Option<u32>,
    iris: u32,
    mouth: u32,
}

/// How a figure is on a drawing.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// The middle of the body.
    pub at: Point,
    /// Turn in the plane of the picture, in radians.
    pub lean: f64,
    /// Size, 1 for that of the figure.
    pub scale: f64,
    /// Time within a step, in radians.
    pub phase: f64,
    /// Where it looks: -1 to 1.
    pub facing: f64,
}

/// A number from `low` to `high`.
pub fn between(chance: &mut Chance, low: f64, high: f64) -> f64 {
    low + (high - low) * chance.below(4096) as f64 / 4095.0
}

/// Whether something happens in `percent` of a hundred cases.
pub fn happens(chance: &mut Chance, percent: usize) -> bool {
    chance.below(100) < percent
}

/// One of the colours.
pub fn colour(chance: &mut Chance) -> u32 {
    COLOURS[chance.below(COLOURS.len())]
}

impl Figure {
    /// A figure with a number of pairs of limbs.
    pub fn new(pairs: usize, chance: &mut Chance) -> Self {
        let body = Strip::new([110.0, 150.0], [34.0, 58.0], 3, chance);
        let mut limbs = Vec::new();
        for pair in 0..pairs {
            let down = if pairs == 1 { 0.1 } else { 0.08 + 0.87 * pair as f64 / (pairs - 1) as f64 };
            let kind = Limb::new(down, chance);
            let alike = happens(chance, 70);
            for side in [-1.0, 1.0] {
                let mut limb = kind.clone();
                limb.front = side < 0.0;
                limb.root[0] *= side;
                limb.offset += if side < 0.0 { PI } else { 0.0 };
                if !alike {
                    limb.strip.colour = colour(chance);
                    limb.end.1 = colour(chance);
                }
                limbs.push(limb);
            }
        }
        let tail = happens(chance, 60).then(|| Limb { front: false, ..Limb::new(0.8, chance) });
        let head = Head::new(chance);
        let gold = colour(chance);
        let buttons = (0..chance.below(4)).map(|k| (-0.25 + 0.22 * k as f64, gold)).collect();
        Self { body, limbs, tail, head, buttons }
    }

    /// Its shapes on a drawing, the farthest first.
    pub fn shapes(&self, pose: &Pose) -> Vec<Shape> {
        let x = Point::from_angle(pose.lean) * pose.scale;
        let at = |p: Point| pose.at + p.x * x + p.y * x.perp();
        let half = 0.5 * self.body.length;
        let placed = |limb: &Limb| {
            let root = Point::new(limb.root[0] * self.body.width(limb.root[1]), half * (2.0 * limb.root[1] - 1.0));
            limb.shapes(at(root), pose)
        };
        let mut shapes: Vec<Shape> = self.tail.iter().flat_map(placed).collect();
        shapes.extend(self.limbs.iter().filter(|limb| !limb.front).flat_map(placed));
        let bend = 8.0 * pose.phase.sin();
        let joints = [Point::new(0.0, -half), Point::new(bend, 0.0), Point::new(0.0, half)];
        shapes.extend(self.body.shapes(joints.map(at), pose.scale));
        for &(down, gold) in &self.buttons {
            let along = 0.6 * self.body.width(0.5 + 0.5 * down) * (0.9 * pose.facing).sin();
            shapes.push(Shape::new(disc(at(Point::new(along, down * self.body.length)), 7.0 * pose.scale), gold));
        }
        shapes.extend(self.head.shapes(&at, -half - 0.75 * self.head.size.y, pose));
        shapes.extend(self.limbs.iter().filter(|limb| limb.front).flat_map(placed));
        shapes
    }
}

impl Strip {
    fn new(length: [f64; 2], width: [f64; 2], most: usize, chance: &mut Chance) -> Self {
        let length = between(chance, length[0], length[1]);
        let widths = [0, 1].map(|_| between(chance, width[0], width[1]));
        let mut bands = Vec::new();
        let mut from = 0.12;
        for _ in 0..chance.below(most + 1) {
            let to = from + between(chance, 0.15, 0.3);
            if to < 0.95 {
                bands.push(([from, to], colour(chance)));
            }
            from = to + between(chance, 0.0, 0.2);
        }
        Self { length, widths, colour: colour(chance), bands }
    }

    /// Half its width at a share of its length.
    fn width(&self, t: f64) -> f64 {
        self.widths[0] + t * (self.widths[1] - self.widths[0])
    }

    fn shapes(&self, joints: [Point; 3], scale: f64) -> Vec<Shape> {
        let whole = Outline::closed(strip(joints, SIDES, [9.0 * scale, 7.0 * scale], |t| scale * self.width(t)));
        let bands = self.bands.iter().map(|&(range, colour)| Shape::new(band(&whole, range), colour));
        std::iter::once(Shape::new(whole.clone(), self.colour)).chain(bands).collect()
    }
}

/// What is between two shares of a strip's length.
fn band(strip: &Outline, [from, to]: [f64; 2]) -> Outline {
    let p = &strip.points;
    let side = |t: f64, index: &dyn Fn(usize) -> usize| {
        let u = t * (SIDES - 1) as f64;
        let k = (u as usize).min(SIDES - 2);
        p[index(k)].lerp(p[index(k + 1)], u - k as f64)
    };
    let steps = [0.0, 0.5, 1.0].map(|share| from + share * (to - from));
    let mut points: Vec<Point> = steps.iter().map(|&t| side(t, &|k| k)).collect();
    points.extend(steps.iter().rev().map(|&t| side(t, &|k| 2 * SIDES - k)));
    Outline::closed(points).with_corners(&[0, 2, 3, 5])
}

impl Limb {
    fn new(down: f64, chance: &mut Chance) -> Self {
        Self {
            strip: Strip::new([80.0, 130.0], [9.0, 17.0], 2, chance),
            root: [between(chance, 0.45, 0.85), down],
            rest: between(chance, -0.2, 0.9) * (1.0 - down),
            swing: between(chance, 0.35, 0.95),
            offset: between(chance, 0.0, TAU),
            end: (between(chance, 11.0, 20.0), colour(chance)),
            front: true,
        }
    }

    fn shapes(&self, root: Point, pose: &Pose) -> Vec<Shape> {
        let hanging = |angle: f64| Point::new(angle.sin(), angle.cos());
        let side = if self.root[0] < 0.0 { -1.0 } else { 1.0 };
        let swing = self.swing * (pose.phase + self.offset).sin();
        let upper = side * self.rest + swing - pose.lean;
        let lower = upper + 0.5 + 0.5 * (pose.phase + self.offset + 0.8).sin();
        let half = 0.5 * self.strip.length * pose.scale;
        let middle = root + half * hanging(upper);
        let end = middle + half * hanging(lower);
        let mut shapes = self.strip.shapes([root, middle, end], pose.scale);
        let (size, colour) = self.end;
        let hand = end + 0.5 * size * pose.scale * hanging(lower);
        shapes.push(Shape::new(ellipse(hand, pose.scale * Point::new(1.15 * size, 0.9 * size)), colour));
        shapes
    }
}

impl Head {
    fn new(chance: &mut Chance) -> Self {
        let size = Point::new(between(chance, 36.0, 58.0), between(chance, 36.0, 52.0));
        Self {
            size,
            skin: colour(chance),
            hair: happens(chance, 60).then(|| colour(chance)),
            hat: happens(chance, 50).then(|| Strip::new([50.0, 90.0], [16.0, 36.0], 2, chance)),
            ears: happens(chance, 50).then(|| colour(chance)),
            iris: colour(chance),
            mouth: colour(chance),
        }
    }

    /// Its shapes, with its middle `up` from that of the body.
    fn shapes(&self, at: &dyn Fn(Point) -> Point, up: f64, pose: &Pose) -> Vec<Shape> {
        let (w, h) = (self.size.x, self.size.y);
        let own = |x: f64, y: f64| at(Point::new(x, up + y));
        let round = |x: f64, y: f64, size: Point| {
            let place = |k: usize| size * Point::from_angle(TAU * k as f64 / 12.0);
            Outline::closed((0..12).map(|k| own(x + place(k).x, y + place(k).y)).collect())
        };
        let mut shapes = Vec::new();
        for (side, tone) in [-1.0, 1.0].into_iter().zip(self.ears.iter().cycle()) {
            shapes.push(Shape::new(round(0.92 * side * w, -0.45 * h, Point::splat(0.3 * w)), *tone));
        }
        shapes.push(Shape::new(round(0.0, 0.0, self.size), self.skin));
        // What is on the ball slides over it.
        let on = |longitude: f64| w * (longitude + 0.7 * pose.facing).clamp(-1.4, 1.4).sin();
        for side in [-0.4, 0.4] {
            let narrow = (side + 0.7 * pose.facing).cos().max(0.25);
            shapes.push(Shape::new(round(on(side), -2.0, Point::new(0.24 * w * narrow, 0.28 * h)), WHITE));
            shapes.push(Shape::new(round(on(side), 0.0, Point::new(0.13 * w * narrow, 0.16 * h)), self.iris));
        }
        let open = 0.5 + 0.5 * (1.7 * pose.phase).cos();
        if open > 0.3 {
            shapes.push(Shape::new(round(on(0.0), 0.55 * h, Point::new(0.3 * w, 0.2 * h * open)), self.mouth));
        }
        if let Some(hair) = self.hair {
            let spikes = (0..5).map(|k| own(on(-1.0 + 0.5 * k as f64), if k % 2 == 0 { -0.3 * h } else { -0.55 * h }));
            let top =
                (0..5).map(|k| own(1.03 * w * (0.6 - 0.3 * k as f64), -(1.03 - 0.06 * (k as f64 - 2.0).powi(2)) * h));
            let corners: Vec<usize> = (0..5).chain([5, 9]).collect();
            shapes.push(Shape::new(Outline::closed(spikes.chain(top).collect()).with_corners(&corners), hair));
        }
        if let Some(hat) = &self.hat {
            let tip = 22.0 * pose.phase.sin();
            let (low, high) = (-0.7 * h, -0.7 * h - hat.length);
            let joints = [own(0.0, low), own(0.0, 0.5 * (low + high)), own(tip, high)];
            shapes.extend(hat.shapes(joints, pose.scale));
        }
        shapes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSE: Pose = Pose { at: Point::new(300.0, 300.0), lean: 0.0, scale: 1.0, phase: 0.4, facing: 0.5 };

    #[test]
    fn a_figure_has_the_same_parts_in_every_pose_but_for_its_mouth() {
        let figure = Figure::new(3, &mut Chance(11));
        let colours = |pose: &Pose| figure.shapes(pose).iter().map(|shape| shape.colour).collect::<Vec<_>>();
        let (one, other) = (colours(&POSE), colours(&Pose { lean: 0.7, phase: 0.5, ..POSE }));
        assert_eq!(one, other);
        let shut = Pose { phase: std::f64::consts::PI / 1.7, ..POSE };
        assert_eq!(colours(&shut).len(), one.len() - 1);
        // Six limbs with a hand each, a head, two eyes with their irises, and a body.
        assert!(one.len() > 6 * 2 + 1 + 4, "{}", one.len());
    }

    #[test]
    fn limbs_swing_about_a_body_that_stays() {
        let figure = Figure::new(2, &mut Chance(3));
        let moved = |from: &Pose, to: &Pose| {
            let (a, b) = (figure.shapes(from), figure.shapes(to));
            let pairs = a.iter().zip(&b);
            pairs.map(|(a, b)| a.outline.points[0].distance(b.outline.points[0])).fold(0.0, f64::max)
        };
        assert!(moved(&POSE, &Pose { phase: 1.6, ..POSE }) > 20.0);
        assert!(moved(&POSE, &POSE) == 0.0);
    }

    #[test]
    fn a_band_is_within_its_strip() {
        let points = strip([Point::ZERO, Point::new(0.0, 50.0), Point::new(0.0, 100.0)], SIDES, [5.0; 2], |_| 10.0);
        let band = band(&Outline::closed(points), [0.25, 0.5]);
        let (low, high) = rototoon::geometry::polygon::bounds(&band.points).unwrap();
        assert!((low - Point::new(-10.0, 25.0)).length() < 1.0 && (high - Point::new(10.0, 50.0)).length() < 1.0);
    }
}
