//! Drawn characters whose strokes are known on every drawing: outlines of parts, of which the nearer hide the farther ones.
//!
//! The truth of a stroke is the part of its outline that is visible, found by the parts in front of it. The measure is the
//! share of the strokes' length that lies on the stroke with the right number.

use super::common::{Line, covered, draw_onto};
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::{Colour, Raster};
use rototoon_lines::{Drawing, Options, Stroke, Tracked};
use std::sync::Arc;

/// Width and height of the drawings.
pub const SIZE: (usize, usize) = (480, 360);
const PAPER: Colour = [0.98, 0.97, 0.94];
/// Points of an outline: the same material points on every drawing.
const POINTS: usize = 160;

/// How a character is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Manner {
    /// One clean line.
    Clean,
    /// Two grey pencil lines that wander.
    Rough,
    /// One line that is drawn anew each time, a little differently.
    Boil,
}

/// A part: an outline, which hides what is behind it, or an open line.
pub struct Part {
    pub points: Vec<Point>,
    pub closed: bool,
}

/// A character at a time, parts from the farthest to the nearest.
pub type Character = fn(f64) -> Vec<Part>;

fn turned(points: Vec<Point>, about: Point, angle: f64) -> Vec<Point> {
    points.into_iter().map(|p| about + Point::from_angle(angle).rotate(p - about)).collect()
}

fn oval(centre: Point, across: f64, up: f64) -> Vec<Point> {
    let at = |k: usize| Point::from_angle(k as f64 * std::f64::consts::TAU / 60.0) * Point::new(across, up);
    (0..60).map(|k| centre + at(k)).collect()
}

/// A limb from `a` to `b`, round at both ends.
fn limb(a: Point, b: Point, r: f64, s: f64) -> Vec<Point> {
    let along = (b - a).to_angle();
    let half = |centre: Point, radius: f64, start: f64| {
        (0..=20).map(move |k| centre + radius * Point::from_angle(start + std::f64::consts::PI * f64::from(k) / 20.0))
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    half(b, s, along - quarter).chain(half(a, r, along + quarter)).collect()
}

fn outline(points: Vec<Point>) -> Part {
    Part { points: polyline::resample(&points, true, POINTS), closed: true }
}

fn open(points: &[(f64, f64)], shift: Point) -> Part {
    let points: Vec<Point> = points.iter().map(|&(x, y)| Point::new(x, y) + shift).collect();
    Part { points: polyline::resample(&points, false, POINTS), closed: false }
}

/// A penguin that waddles: the sample's shapes.
pub fn penguin(time: f64) -> Vec<Part> {
    let step = (time * 0.5).sin();
    let hips = Point::new(190.0 + 9.0 * time, 230.0 - 4.0 * (time * 0.5).cos().abs());
    let lean = 0.08 * step;
    let neck = hips + Point::from_angle(lean).rotate(Point::new(0.0, -92.0));
    let shoulder = hips + Point::from_angle(lean).rotate(Point::new(-14.0, -62.0));
    let leaf = |at: Point, long: f64, wide: f64, angle: f64| {
        turned(oval(at + Point::new(0.0, 0.5 * long - 8.0), wide, 0.5 * long), at, angle)
    };
    let beak: Vec<Point> =
        [(32.0, -6.0), (66.0, 5.0), (32.0, 14.0), (26.0, 4.0)].iter().map(|&p| neck + Point::from(p)).collect();
    vec![
        outline(oval(hips + Point::new(26.0 + 10.0 * step, 66.0 - 8.0 * step.max(0.0)), 26.0, 11.0)),
        outline(oval(hips + Point::new(-12.0 - 10.0 * step, 72.0 - 8.0 * (-step).max(0.0)), 28.0, 12.0)),
        outline(turned(oval(hips - Point::new(0.0, 10.0), 54.0, 80.0), hips, lean)),
        outline(oval(hips + Point::new(14.0, 4.0), 30.0, 46.0)),
        outline(turned(oval(neck, 41.0, 37.0), neck, 1.5 * lean)),
        outline(beak),
        outline(oval(neck + Point::new(14.0, -10.0), 9.0, 9.0)),
        outline(leaf(shoulder, 78.0, 16.0, 0.3 + 0.12 * time)),
    ]
}

/// A walker with limbs of two pieces.
pub fn walker(time: f64) -> Vec<Part> {
    let hips = Point::new(150.0 + 12.0 * time, 205.0 + 3.0 * (time * 0.9).cos());
    // The legs do not pass each other within six drawings.
    let swing = (1.2 - 0.13 * time).sin() * 0.6;
    let reach =
        |from: Point, angle: f64, length: f64| from + length * Point::from_angle(std::f64::consts::FRAC_PI_2 + angle);
    let leg = |angle: f64| {
        let knee = reach(hips, angle, 58.0);
        let foot = reach(knee, angle + 0.35, 60.0);
        [outline(limb(knee, foot, 13.0, 10.0)), outline(limb(hips, knee, 19.0, 13.0))]
    };
    let chest = hips - Point::new(-4.0, 78.0);
    let arm = |angle: f64| {
        let elbow = reach(chest + Point::new(0.0, 8.0), angle, 44.0);
        outline(limb(elbow, reach(elbow, angle - 0.5, 44.0), 9.0, 8.0))
    };
    let head = chest - Point::new(-8.0, 48.0);
    let [back_calf, back_thigh] = leg(-swing);
    let [calf, thigh] = leg(swing);
    let face = |x: f64, y: f64| head + Point::new(x, y);
    let smile = open(&[(6.0, 14.0), (16.0, 19.0), (27.0, 13.0)], head);
    vec![
        arm(swing),
        back_calf,
        back_thigh,
        outline(limb(chest, hips, 30.0, 24.0)),
        calf,
        thigh,
        outline(oval(head, 33.0, 36.0)),
        outline(oval(face(14.0, -6.0), 6.0, 8.0)),
        smile,
        arm(-swing),
    ]
}

/// The head of a cat that turns: ears behind, whiskers and stripes in front.
pub fn cat(time: f64) -> Vec<Part> {
    let head = Point::new(240.0 + 4.0 * time, 190.0 - 3.0 * time);
    let squash = 1.0 + 0.04 * (time * 0.8).sin();
    let side = 5.0 * time - 12.0;
    let ear = |x: f64| {
        let tip = [(x - 34.0, -60.0), (x + 8.0 * x.signum(), -150.0), (x + 34.0, -60.0)];
        outline(tip.iter().map(|&p| head + Point::from(p)).collect())
    };
    let eye = |x: f64| outline(oval(head + Point::new(x + side, -18.0), 19.0, 25.0));
    let pupil = |x: f64| outline(oval(head + Point::new(x + 1.4 * side, -16.0), 7.0, 15.0));
    let nose: Vec<Point> = [(-10.0, 22.0), (10.0, 22.0), (0.0, 33.0)]
        .iter()
        .map(|&p| head + Point::from(p) + Point::new(1.3 * side, 0.0))
        .collect();
    let whisker = |sign: f64, rise: f64| {
        open(
            &[
                (sign * 40.0, 34.0 + 0.3 * rise),
                (sign * 80.0, 30.0 + rise),
                (sign * 128.0, 36.0 + 2.2 * rise + 2.0 * time),
            ],
            head + Point::new(side, 0.0),
        )
    };
    let stripe =
        |x: f64| open(&[(x, -88.0 * squash), (x + 2.0, -70.0), (x - 3.0, -54.0)], head + Point::new(0.6 * side, 0.0));
    let mut parts = vec![
        ear(-62.0),
        ear(62.0),
        outline(oval(head, 118.0 / squash, 102.0 * squash)),
        eye(-42.0),
        eye(42.0),
        pupil(-42.0),
        pupil(42.0),
        outline(nose),
    ];
    parts.extend([
        whisker(-1.0, -9.0),
        whisker(-1.0, 7.0),
        whisker(1.0, -9.0),
        whisker(1.0, 7.0),
        stripe(-22.0),
        stripe(0.0),
        stripe(22.0),
    ]);
    parts
}

/// A flower in a pot: petals that open around a disc, leaves that bend.
pub fn flower(time: f64) -> Vec<Part> {
    let sway = 0.03 * time;
    let root = Point::new(240.0, 300.0);
    let top = root + 165.0 * Point::from_angle(-std::f64::consts::FRAC_PI_2 + sway);
    let bend = Point::new(235.0 + 3.0 * time, 215.0);
    let stem = Part { points: polyline::resample(&[root, bend, top], false, POINTS), closed: false };
    let leaf = |sign: f64| {
        let angle = -0.5 - sign * (1.0 - 0.05 * time);
        let along = Point::from_angle(angle - 1.07);
        outline(turned(oval(bend + 48.0 * along, 44.0, 15.0), bend + 48.0 * along, angle - 1.07))
    };
    let petal = |k: usize| {
        let along = Point::from_angle(k as f64 * std::f64::consts::TAU / 5.0 + 0.3 + sway);
        let long = 30.0 + 1.5 * time;
        outline(turned(oval(top + (22.0 + long) * along, long, 22.0), top + (22.0 + long) * along, along.to_angle()))
    };
    let pot: Vec<Point> =
        [(-48.0, -10.0), (48.0, -10.0), (36.0, 45.0), (-36.0, 45.0)].iter().map(|&p| root + Point::from(p)).collect();
    let mut parts = vec![stem, leaf(-1.0), leaf(1.0)];
    parts.extend((0..5).map(petal));
    parts.extend([outline(oval(top, 27.0, 27.0)), outline(pot)]);
    parts
}

/// The visible stretches of each part, as indices of its points.
fn visible(parts: &[Part]) -> Vec<Vec<bool>> {
    let hidden =
        |k: usize, p: Point| parts[k + 1..].iter().any(|part| part.closed && polygon::contains(&part.points, p));
    parts.iter().enumerate().map(|(k, part)| part.points.iter().map(|&p| !hidden(k, p)).collect()).collect()
}

/// A stroke: a part, and the stretch of its points.
#[derive(Clone, Debug)]
pub struct Known {
    pub part: usize,
    pub stretch: Vec<usize>,
    pub closed: bool,
}

/// The strokes that an artist would draw: the visible stretches of outlines.
pub fn strokes(parts: &[Part]) -> Vec<Known> {
    let mut found = Vec::new();
    for (k, seen) in visible(parts).iter().enumerate() {
        let n = seen.len();
        if parts[k].closed && seen.iter().all(|&s| s) {
            found.push(Known { part: k, stretch: (0..n).collect(), closed: true });
            continue;
        }
        let first = if parts[k].closed { seen.iter().position(|&s| !s).unwrap_or(0) } else { 0 };
        let order: Vec<usize> = (0..n).map(|i| (first + i) % n).collect();
        for run in order.chunk_by(|&a, &b| seen[a] == seen[b]).filter(|run| seen[run[0]] && run.len() > 4) {
            found.push(Known { part: k, stretch: run.to_vec(), closed: false });
        }
    }
    found
}

/// The strokes of an artist's drawing, with numbers from 0.
pub fn drawn(parts: &[Part], known: &[Known]) -> Vec<Tracked> {
    let stroke = |known: &Known| Stroke {
        points: known.stretch.iter().map(|&i| parts[known.part].points[i]).collect(),
        closed: known.closed,
        ..Stroke::default()
    };
    known.iter().enumerate().map(|(track, known)| Tracked::sure(track, stroke(known))).collect()
}

/// The share of the known strokes' visible length that lies on the stroke with the right number.
pub fn right(strokes: &[Tracked], parts: &[Part], known: &[Known], reach: f64) -> f64 {
    let seen = visible(parts);
    let (mut good, mut all) = (0.0, 0.0);
    for (k, known) in known.iter().enumerate() {
        let part = &parts[known.part];
        let found = strokes.iter().find(|s| s.track == k);
        for pair in known.stretch.windows(2).filter(|pair| pair.iter().all(|&i| seen[known.part][i])) {
            let ends = [part.points[pair[0]], part.points[pair[1]]];
            let length = ends[0].distance(ends[1]);
            all += length;
            good += found.map_or(0.0, |f| length * covered(&ends, false, &f.stroke.points, f.stroke.closed, reach));
        }
    }
    good / all
}

/// A picture of the character.
pub fn picture(parts: &[Part], manner: Manner, drawing: u32) -> Arc<Raster<Colour>> {
    let mut found = Raster::new(SIZE.0, SIZE.1, PAPER);
    for (k, part) in parts.iter().enumerate() {
        if part.closed {
            fill(&mut found, &part.points);
        }
        let times: &[u32] = if manner == Manner::Rough { &[1, 2] } else { &[0] };
        for &time in times {
            let (sway, colour, width) = match manner {
                Manner::Clean => (0.0, [0.15, 0.12, 0.17], 3.0),
                Manner::Boil => (0.9, [0.15, 0.12, 0.17], 3.0),
                Manner::Rough => (0.9, [0.4, 0.4, 0.42], 2.2),
            };
            let points = wandering(&part.points, sway, drawing * 97 + k as u32 * 13 + time * 7);
            draw_onto(&mut found, &Line { points, closed: part.closed, width, colour });
        }
    }
    Arc::new(found)
}

/// Points moved by a smooth wave of their own.
fn wandering(points: &[Point], by: f64, seed: u32) -> Vec<Point> {
    let phase = |k: u32| f64::from((seed.wrapping_mul(2_654_435_761).wrapping_add(k * 40_503)) >> 16) * 0.01;
    let n = points.len() as f64;
    let wave = |i: usize| {
        let at = i as f64 / n * std::f64::consts::TAU;
        Point::new(
            (2.0 * at + phase(1)).sin() + 0.6 * (5.0 * at + phase(2)).sin(),
            (3.0 * at + phase(3)).sin() + 0.6 * (4.0 * at + phase(4)).sin(),
        )
    };
    points.iter().enumerate().map(|(i, &p)| p + by * wave(i)).collect()
}

fn fill(picture: &mut Raster<Colour>, points: &[Point]) {
    polygon::for_each_span(points, SIZE.0, SIZE.1, |y, from, to| picture.row_mut(y)[from..to].fill(PAPER));
}

/// The ink of a character's drawing.
pub fn look(parts: &[Part], manner: Manner, drawing: u32) -> Drawing {
    Drawing::new(picture(parts, manner, drawing), &Options::default())
}
