//! The character's parts, their colours, and the details on them: face, buttons, stripes.

use super::ink::Canvas;
use super::outline::Outline;
use super::rig::Rig;
use rototoon::geometry::Point;
use tiny_skia::Color;

/// A part's name, colour and shadow colour.
#[derive(Clone, Copy, Debug)]
pub struct Paint {
    /// The part's name in the documents.
    pub name: &'static str,
    /// Its colour, 0xRRGGBB.
    pub colour: u32,
    /// The colour of its shadow side, or the same colour if it has none.
    pub shade: u32,
}

const fn paint(name: &'static str, colour: u32, shade: u32) -> Paint {
    Paint { name, colour, shade }
}

const INK: u32 = 0x2b1a22;
const WHITE: u32 = 0xfffdf6;

/// The parts in the order in which they are painted, the farthest first. The depth of a part is its index here.
pub const PARTS: [Paint; 16] = [
    paint("far arm", 0x25688f, 0x25688f),
    paint("far mitten", 0xb8402e, 0xb8402e),
    paint("far leg", 0x4a3d63, 0x4a3d63),
    paint("far boot", 0x77402a, 0x77402a),
    paint("near leg", 0x63527f, 0x544570),
    paint("near boot", 0x9a5733, 0x824626),
    paint("coat", 0x3389bb, 0x2a75a6),
    paint("scarf tail", 0xf3b53a, 0xf3b53a),
    paint("scarf", 0xf6c04a, 0xe6a531),
    paint("head", 0xfbd7b2, 0xf2bf98),
    paint("hair", 0xc9652b, 0xc9652b),
    paint("hat", 0xdb4b3a, 0xc23a31),
    paint("brim", 0xfff1d8, 0xecd9bb),
    paint("bobble", 0xfff1d8, 0xecd9bb),
    paint("near arm", 0x3f98ca, 0x3389bb),
    paint("near mitten", 0xe0533f, 0xc9432f),
];

/// Paints one drawing of the character.
pub fn draw(canvas: &mut Canvas, rig: &Rig) {
    for (paint, outline) in PARTS.iter().zip(&rig.outlines) {
        canvas.fill(outline, colour(paint.colour));
        if paint.shade != paint.colour {
            canvas.shade(outline, colour(paint.colour), colour(paint.shade));
        }
        match paint.name {
            "coat" => coat_details(canvas, rig, outline),
            "scarf tail" => stripes(canvas, outline),
            "scarf" => folds(canvas, rig, outline),
            "near boot" | "far boot" => sole(canvas, outline),
            "head" => face(canvas, rig, outline),
            "near arm" | "far arm" => cuff(canvas, outline),
            _ => {}
        }
        canvas.ink(outline, colour(INK));
    }
}

fn colour(rgb: u32) -> Color {
    let [_, r, g, b] = rgb.to_be_bytes();
    Color::from_rgba8(r, g, b, 255)
}

fn coat_details(canvas: &mut Canvas, rig: &Rig, outline: &Outline) {
    let front = |y: f64| {
        let half = 47.0 + 8.0 * (y + 60.0) / 70.0;
        rig.body.at(half * (0.75 * rig.pose.facing).sin() + rig.pose.sway * ((y + 60.0) / 70.0).clamp(0.0, 1.0), y)
    };
    let line = Outline::open([-92.0, -60.0, -28.0, 0.0, 17.0].map(front).to_vec());
    canvas.line(&line, 2.0, colour(INK), Some(outline));
    let across = if rig.pose.facing >= 0.0 { -9.0 } else { 9.0 };
    for y in [-68.0, -44.0, -20.0] {
        let at = front(y) + Point::new(across, 0.0);
        canvas.disc(at, 4.6, colour(INK), Some(outline));
        canvas.disc(at, 3.2, colour(0xf6c04a), Some(outline));
    }
    let pocket = |longitude: f64| {
        let x = 52.0 * (longitude + 0.75 * rig.pose.facing).clamp(-1.5, 1.5).sin();
        Outline::open(vec![rig.body.at(x - 9.0, -19.0), rig.body.at(x, -16.0), rig.body.at(x + 9.0, -19.0)])
    };
    for longitude in [-0.85, 0.85] {
        canvas.line(&pocket(longitude), 2.2, colour(INK), Some(outline));
    }
}

fn stripes(canvas: &mut Canvas, outline: &Outline) {
    let p = &outline.points;
    for (t, width) in [(0.28, 5.0), (0.62, 5.0)] {
        let line = Outline::open(vec![p[3].lerp(p[4], t), p[7].lerp(p[6], t)]);
        canvas.line(&line, width, colour(0xd9702b), Some(outline));
    }
}

fn folds(canvas: &mut Canvas, rig: &Rig, outline: &Outline) {
    let x = 3.0 * rig.pose.facing;
    for (from, to) in [(-20.0, -6.0), (8.0, 22.0)] {
        let line = Outline::open(vec![
            rig.body.at(x + from, -106.0),
            rig.body.at(x + (from + to) / 2.0, -99.0),
            rig.body.at(x + to, -95.0),
        ]);
        canvas.line(&line, 1.8, colour(INK), Some(outline));
    }
}

fn sole(canvas: &mut Canvas, outline: &Outline) {
    let p = &outline.points;
    let rise = |i: usize, j: usize| p[i].lerp(p[j], 0.35);
    canvas.line(&Outline::open(vec![rise(4, 3), rise(8, 9)]), 1.8, colour(INK), Some(outline));
}

fn cuff(canvas: &mut Canvas, outline: &Outline) {
    let p = &outline.points;
    let line = Outline::open(vec![p[3].lerp(p[4], 0.35), p[7].lerp(p[6], 0.35)]);
    canvas.line(&line, 1.8, colour(INK), Some(outline));
}

/// Paints eyes, brows, nose, mouth and cheeks on a ball that turns.
fn face(canvas: &mut Canvas, rig: &Rig, outline: &Outline) {
    let yaw = 0.62 * rig.pose.facing;
    let on_ball = |longitude: f64, y: f64| {
        let reach = 66.0 * (1.0 - (y / 66.0) * (y / 66.0)).max(0.0).sqrt();
        rig.head.at(reach * (longitude + yaw).sin(), y)
    };
    for side in [-1.0, 1.0] {
        let narrow = (0.4 * side + yaw).cos();
        let cheek = on_ball(0.72 * side, 26.0);
        canvas.ellipse(
            cheek,
            Point::new(11.0 * (0.72 * side + yaw).cos().max(0.1), 7.5),
            Color::from_rgba8(240, 120, 95, 120),
            Some(outline),
        );
        eye(canvas, on_ball(0.4 * side, 6.0), narrow, rig, outline);
        let lift = -27.0 - 4.0 * rig.pose.mouth;
        let brow = [0.27, 0.42, 0.57].map(|a| on_ball(a * side, lift - if a == 0.42 { 3.0 } else { 0.0 }));
        canvas.line(&Outline::open(brow.to_vec()), 3.4, colour(0x7d3a1c), None);
    }
    let nose = on_ball(0.1 * rig.pose.facing, 19.0);
    canvas.ellipse(nose, Point::new(7.5, 6.0), colour(INK), None);
    canvas.ellipse(nose, Point::new(5.6, 4.2), colour(0xf09a78), None);
    mouth(canvas, rig.pose.mouth, on_ball);
}

fn eye(canvas: &mut Canvas, at: Point, narrow: f64, rig: &Rig, outline: &Outline) {
    let open = rig.pose.eyes;
    let size = Point::new(11.5 * narrow, 16.0 * open);
    if open < 0.3 {
        let arc = [(-1.0, -1.0), (0.0, 4.0), (1.0, -1.0)].map(|(x, y)| at + Point::new(11.5 * narrow * x, y));
        canvas.line(&Outline::open(arc.to_vec()), 3.4, colour(INK), None);
        return;
    }
    canvas.ellipse(at, size + Point::splat(1.6), colour(INK), Some(outline));
    canvas.ellipse(at, size, colour(WHITE), Some(outline));
    let pupil = at + Point::new(3.2 * rig.pose.facing * narrow, 1.5);
    canvas.ellipse(pupil, Point::new(5.6 * narrow, 8.6 * open.sqrt()), colour(INK), Some(outline));
    canvas.ellipse(
        pupil + Point::new(-1.8 * narrow, -3.6 * open),
        Point::new(2.3 * narrow, 2.6),
        colour(WHITE),
        Some(outline),
    );
}

fn mouth(canvas: &mut Canvas, open: f64, on_ball: impl Fn(f64, f64) -> Point) {
    let corner = |side: f64| on_ball(0.3 * side, 30.0);
    let upper = [corner(-1.0), on_ball(-0.15, 33.5), on_ball(0.0, 34.5), on_ball(0.15, 33.5), corner(1.0)];
    if open > 0.1 {
        let depth = 34.5 + 17.0 * open;
        let mut line = upper.to_vec();
        line.extend([on_ball(0.19, 34.0 + 12.0 * open), on_ball(0.0, depth), on_ball(-0.19, 34.0 + 12.0 * open)]);
        let shape = Outline::closed(line).with_corners(&[0, 4]);
        canvas.fill(&shape, colour(0x7a2630));
        if open > 0.35 {
            canvas.ellipse(on_ball(0.02, depth - 2.0), Point::new(8.0, 6.0 * open), colour(0xe8786c), Some(&shape));
        }
        canvas.line(&shape, 2.4, colour(INK), None);
    } else {
        canvas.line(&Outline::open(upper.to_vec()), 2.8, colour(INK), None);
    }
}
