//! A film that this package draws: the sample character's twelve drawings in lines and in flat colours, from the same shapes.
//!
//! A boy walks past a tree, jumps and turns round; a ball flies through the picture, and a cloud leaves it. Limbs cross, eyes close, a mouth opens,
//! and the ball has a colour that the first drawing does not show. Every line is closed. What is in front covers what is behind, in
//! lines and in colours alike. The truth of a drawing is read from its pictures, as for other films ([`super::truth`]).

use super::shapes::{Picture, Shape, WHITE, disc, ellipse};
use crate::sample::character::PARTS;
use crate::sample::outline::Outline;
use crate::sample::pose::DRAWINGS;
use crate::sample::rig::Rig;
use crate::sample::{HEIGHT, WIDTH};
use rototoon::geometry::Point;

/// Number of drawings of the film that the benchmark draws.
pub const COUNT: usize = DRAWINGS.len();

/// The sky's colour, and that of the paper.
const SKY: u32 = 0xcfe6f2;
const CREAM: u32 = 0xfff1d8;

/// The first `count` drawings, at most [`COUNT`].
pub fn drawings(count: usize) -> Vec<Picture> {
    let poses = DRAWINGS.iter().take(count).enumerate();
    poses.map(|(k, pose)| Picture { shapes: shapes(&Rig::new(pose), k), paper: SKY, size: [WIDTH, HEIGHT] }).collect()
}

/// All shapes of drawing `k`, the farthest first.
fn shapes(rig: &Rig, k: usize) -> Vec<Shape> {
    let mut shapes = scenery(k);
    for (paint, outline) in PARTS.iter().zip(&rig.outlines) {
        let mut part = Shape::new(outline.clone(), paint.colour);
        if paint.name == "coat" {
            part.creases.push(front(rig));
        }
        shapes.push(part);
        match paint.name {
            "coat" => shapes.extend([-66.0, -38.0, -10.0].map(|y| Shape::new(button(rig, y), 0xf6c04a))),
            "scarf tail" => shapes.push(Shape::new(across(outline, [0.15, 0.65]), 0xd9702b)),
            "near arm" | "far arm" => shapes.push(Shape::new(across(outline, [0.35, 1.0]), CREAM)),
            "head" => shapes.extend(face(rig)),
            _ => {}
        }
    }
    if BALL_IN_FRONT.contains(&k) {
        shapes.extend(ball(k));
    }
    shapes
}

/// The drawings on which the ball is in front of the boy. On others it is behind him.
const BALL_IN_FRONT: std::ops::Range<usize> = 6..COUNT;

/// What is behind the boy: sun, cloud, hill, ground, tree, and the ball before it comes near.
fn scenery(k: usize) -> Vec<Shape> {
    let (w, h) = (f64::from(WIDTH), f64::from(HEIGHT));
    let land = |top: &[(f64, f64)]| {
        let mut points: Vec<Point> = top.iter().map(|&(x, y)| Point::new(x, y)).collect();
        let last = points.len() - 1;
        points.extend([Point::new(w + 40.0, h + 40.0), Point::new(-40.0, h + 40.0)]);
        Outline::closed(points).with_corners(&[0, last, last + 1, last + 2])
    };
    let drift = Point::new(190.0 - 42.0 * k as f64, 92.0);
    let cloud = [(-78.0, 22.0), (-62.0, -8.0), (-22.0, -30.0), (22.0, -34.0), (58.0, -10.0), (80.0, 20.0), (0.0, 30.0)];
    let cloud = Outline::closed(cloud.map(|(x, y)| drift + Point::new(x, y)).to_vec()).with_corners(&[0, 5]);
    let trunk = [(786.0, 470.0), (794.0, 330.0), (822.0, 330.0), (834.0, 470.0)].map(|(x, y)| Point::new(x, y));
    let mut shapes = vec![
        Shape::new(disc(Point::new(560.0, 92.0), 46.0), 0xf9dc6b),
        Shape::new(cloud, 0xf7f7fb),
        Shape::new(land(&[(-40.0, 380.0), (200.0, 318.0), (520.0, 352.0), (760.0, 300.0), (1000.0, 340.0)]), 0x8fb5a0),
        Shape::new(land(&[(-40.0, 452.0), (300.0, 440.0), (640.0, 452.0), (1000.0, 436.0)]), 0xb5cf74),
        Shape::new(Outline::closed(trunk.to_vec()).with_corners(&[0, 1, 2, 3]), 0x8a6247),
        Shape::new(disc(Point::new(808.0, 262.0), 92.0), 0x6fa653),
    ];
    if !BALL_IN_FRONT.contains(&k) {
        shapes.extend(ball(k));
    }
    shapes
}

/// The ball with its band. It comes from the right on the third drawing, bounces twice and leaves.
fn ball(k: usize) -> Vec<Shape> {
    if k < 2 {
        return Vec::new();
    }
    let t = (k - 2) as f64;
    let bounce = (std::f64::consts::PI * (t / 3.5).fract()).sin();
    let at = Point::new(930.0 - 92.0 * t, 440.0 - 150.0 * bounce);
    let along = Point::from_angle(-0.5 * t);
    let band = [(-33.0, -9.0), (33.0, -9.0), (33.0, 9.0), (-33.0, 9.0)];
    let band = band.map(|(x, y)| at + x * along + y * along.perp()).to_vec();
    let whole = Shape::new(disc(at, 34.0), 0x9b4fb0);
    vec![whole, Shape::new(Outline::closed(band).with_corners(&[0, 1, 2, 3]), CREAM)]
}

/// The line down the front of the coat.
fn front(rig: &Rig) -> Outline {
    Outline::open([-110.0, -70.0, -28.0, 0.0, 24.0].map(|y| on_front(rig, y, 0.0)).to_vec())
}

fn button(rig: &Rig, y: f64) -> Outline {
    let beside = if rig.pose.facing >= 0.0 { -16.0 } else { 16.0 };
    disc(on_front(rig, y, beside), 7.5)
}

/// A place on the coat's front, which slides over the body as it turns.
fn on_front(rig: &Rig, y: f64, beside: f64) -> Point {
    rig.body.at(36.0 * (0.75 * rig.pose.facing).sin() + beside, y)
}

/// A stripe across the end of a strip of five control points a side, between two shares of its last segment.
fn across(strip: &Outline, [from, to]: [f64; 2]) -> Outline {
    let p = &strip.points;
    let left = |t: f64| p[3].lerp(p[4], t);
    let right = |t: f64| p[7].lerp(p[6], t);
    Outline::closed(vec![left(from), left(to), right(to), right(from)]).with_corners(&[0, 1, 2, 3])
}

/// Eyes and mouth on a ball that turns.
fn face(rig: &Rig) -> Vec<Shape> {
    let yaw = 0.62 * rig.pose.facing;
    let on_ball = |longitude: f64, y: f64| {
        let reach = 66.0 * (1.0 - (y / 66.0) * (y / 66.0)).max(0.0).sqrt();
        rig.head.at(reach * (longitude + yaw).sin(), y)
    };
    let mut shapes = Vec::new();
    for side in [-0.4, 0.4] {
        let (at, narrow) = (on_ball(side, 8.0), (side + yaw).cos());
        if rig.pose.eyes > 0.3 {
            let size = Point::new(13.0 * narrow, 17.0 * rig.pose.eyes);
            shapes.push(Shape::new(ellipse(at, size), WHITE));
            let pupil = at + Point::new(3.0 * rig.pose.facing * narrow, 2.0);
            shapes.push(Shape::new(ellipse(pupil, 0.55 * size), 0x3f7a4a));
        }
    }
    let open = rig.pose.mouth;
    if open > 0.1 {
        let corner = |side: f64| on_ball(0.34 * side, 31.0);
        let mut line = vec![corner(-1.0), on_ball(0.0, 35.0), corner(1.0)];
        line.extend([0.22, 0.0, -0.22].map(|a| on_ball(a, 38.0 + 14.0 * open - 30.0 * a.abs() * open.min(0.5))));
        shapes.push(Shape::new(Outline::closed(line).with_corners(&[0, 2]), 0x7a2630));
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::super::set::Set;
    use super::super::shapes::{LINES, write};
    use super::super::truth::Truth;
    use super::*;

    #[test]
    fn regions_move_appear_and_vanish() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), LINES, &drawings(COUNT)).unwrap();
        let set = Set::find(folder.path()).unwrap();
        assert_eq!((set.lines.len(), set.size), (COUNT, (WIDTH as usize, HEIGHT as usize)));
        let drawings: Vec<Truth> = (0..COUNT).map(|k| Truth::of(&set.drawing(k).unwrap())).collect();
        let has = |k: usize, colour: u32| {
            let [_, r, g, b] = colour.to_be_bytes();
            drawings[k].regions.iter().filter(|region| region.colour == [r, g, b]).count()
        };
        assert!(drawings.iter().all(|drawing| (20..60).contains(&drawing.regions.len())));
        assert_eq!([has(0, SKY), has(0, WHITE), has(0, 0x9b4fb0)], [1, 2, 0], "sky, eyes, no ball");
        assert_eq!(has(5, 0x9b4fb0), 2, "both halves of the ball");
        assert_eq!(has(4, WHITE), 0, "closed eyes");
        assert_eq!(has(0, 0xf7f7fb), 1, "a cloud");
        assert_eq!(has(COUNT - 1, 0xf7f7fb), 0, "the cloud has left");
    }
}
