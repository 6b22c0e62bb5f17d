//! Refinement of rough contours on a drawn shape.

use super::{Frame, Key, PASSES, Refiner};
use crate::rototoon::lattice::texture::Cover;
use crate::shared::features::Features;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::{Colour, Raster};
use std::collections::BTreeMap;

const LINES: usize = 540;

/// A boot of two colours with an ink line.
fn boot() -> Vec<Point> {
    let outline = [
        (0.0, 0.0),
        (40.0, 0.0),
        (42.0, 30.0),
        (44.0, 60.0),
        (75.0, 66.0),
        (95.0, 74.0),
        (95.0, 92.0),
        (60.0, 94.0),
        (25.0, 94.0),
        (0.0, 92.0),
        (2.0, 60.0),
        (3.0, 30.0),
    ];
    outline.map(|(x, y)| Point::new(x, y)).to_vec()
}

fn placed(degrees: f64, to: Point) -> Vec<Point> {
    let turn = Point::from_angle(f64::to_radians(degrees));
    boot().into_iter().map(|p| turn.rotate(p - Point::new(40.0, 50.0)) + to).collect()
}

const WALL: Colour = [0.8, 0.9, 0.95];

fn drawn(contour: &[Point], ground: Colour) -> Features {
    let (low, high) = polygon::bounds(contour).unwrap();
    let colour = |p: Point| -> Colour {
        let near = p.x > low.x - 4.0 && p.y > low.y - 4.0 && p.x < high.x + 4.0 && p.y < high.y + 4.0;
        if near && polyline::distance(p, contour, true) <= 1.5 {
            [0.1, 0.05, 0.1]
        } else if near && polygon::contains(contour, p) {
            [0.6, 0.35, 0.2]
        } else {
            ground
        }
    };
    Features::new(&Raster::from_fn(LINES, LINES, |x, y| colour(Point::new(x as f64 + 0.5, y as f64 + 0.5))))
}

#[test]
fn a_rough_contour_comes_back_to_the_ink() {
    let keys = [placed(0.0, Point::new(150.0, 200.0)), placed(40.0, Point::new(330.0, 260.0))];
    let middle = placed(20.0, Point::new(250.0, 240.0));
    let (pictures, cover) = ([drawn(&keys[0], WALL), drawn(&keys[1], WALL)], Cover::none(LINES as f64));
    let key = |k: usize| Key { points: &keys[k], picture: &pictures[k], cover: &cover };
    let refiner = Refiner::new([key(0), key(1)], true).unwrap();
    let picture = drawn(&middle, WALL);
    let frame = |pins| Frame { picture: &picture, cover: &cover, share: 0.5, pins };
    let wobble = |j: usize| Point::new((1.7 * j as f64).sin(), (2.9 * j as f64).cos()) * 1.5;
    let rough: Vec<Point> =
        placed(24.0, Point::new(254.0, 237.0)).into_iter().enumerate().map(|(j, p)| p + wobble(j)).collect();
    let off = |points: &[Point]| points.iter().map(|&p| polyline::distance(p, &middle, true)).fold(0.0, f64::max);
    let mean =
        |points: &[Point]| points.iter().zip(&middle).map(|(p, q)| p.distance(*q)).sum::<f64>() / points.len() as f64;
    let (fine, before) = refiner.refine(&frame(BTreeMap::new()), &rough, &PASSES, &refiner.templates);
    assert!(off(&rough) > 5.0 && off(&fine) < 1.0, "{} from {}", off(&fine), off(&rough));
    assert!(mean(&rough) > 5.0 && mean(&fine) < 2.0, "{} from {}", mean(&fine), mean(&rough));
    let free = frame(BTreeMap::new());
    assert!((before - refiner.cost(&free, &rough)).abs() < 1e-6);
    assert!(refiner.cost(&free, &fine) < 0.5 * before);
    let pin = middle[5] + Point::new(9.0, -4.0);
    let (pinned, _) = refiner.refine(&frame(BTreeMap::from([(5, pin)])), &rough, &PASSES, &refiner.templates);
    assert!(pinned[5].distance(pin) < 0.05);
}

#[test]
fn another_background_costs_little_and_the_parts_own_colour_much() {
    let at = |x: f64| placed(0.0, Point::new(x, 200.0));
    let keys = [at(150.0), at(330.0)];
    let (pictures, cover) = (keys.each_ref().map(|key| drawn(key, WALL)), Cover::none(LINES as f64));
    let refiner = || {
        let key = |k: usize| Key { points: &keys[k], picture: &pictures[k], cover: &cover };
        Refiner::new([key(0), key(1)], true).unwrap()
    };
    let (mut plain, refiner) = (refiner(), refiner());
    plain.forget_figure();
    let picture = drawn(&at(240.0), [0.1, 0.5, 0.3]);
    let frame = Frame { picture: &picture, cover: &cover, share: 0.5, pins: BTreeMap::new() };
    let (right, inwards) = (at(240.0), {
        let middle = at(240.0).iter().sum::<Point>() / 12.0;
        at(240.0).iter().map(|&p| p + (middle - p) * 0.2).collect::<Vec<_>>()
    });
    let costs = |refiner: &Refiner| [&right, &inwards].map(|points| refiner.cost(&frame, points));
    let ([right, inwards], [right_plain, inwards_plain]) = (costs(&refiner), costs(&plain));
    assert!(right < 0.7 * right_plain, "{right} for {right_plain}");
    let (told, told_plain) = (inwards - right, inwards_plain - right_plain);
    assert!(told > 1.3 * told_plain, "{told} for {told_plain}");
}

#[test]
fn contours_without_a_shape_are_not_refined() {
    let picture = Features::new(&Raster::new(40, LINES, [0.5f32; 3]));
    let cover = Cover::none(40.0);
    let two = [Point::ZERO, Point::ONE];
    let key = || Key { points: &two, picture: &picture, cover: &cover };
    assert!(Refiner::new([key(), key()], false).is_none());
}

#[test]
fn a_line_that_is_drawn_anew_has_noisy_pulls_and_points_slide_less() {
    let keys = [placed(0.0, Point::new(150.0, 200.0)), placed(0.0, Point::new(330.0, 260.0))];
    let middle = placed(0.0, Point::new(250.0, 240.0));
    let cover = Cover::none(LINES as f64);
    // Marks on the contour, at other places on each drawing, as a rough pencil leaves them.
    let marked = |contour: &[Point], shift: f64| {
        let marks: Vec<Point> = (0..24).map(|k| along(contour, 15.0 * f64::from(k) + shift)).collect();
        inked(contour, &marks)
    };
    let slid = |shifts: [f64; 3]| {
        let pictures = [marked(&keys[0], shifts[0]), marked(&keys[1], shifts[1])];
        let key = |k: usize| Key { points: &keys[k], picture: &pictures[k], cover: &cover };
        let mut refiner = Refiner::new([key(0), key(1)], true).unwrap();
        let along = refiner.noise.iter().map(|variance| variance[0]).sum::<f64>() / refiner.noise.len() as f64;
        let picture = marked(&middle, shifts[2]);
        let frame = Frame { picture: &picture, cover: &cover, share: 0.5, pins: BTreeMap::new() };
        let off = |points: Vec<Point>| points.iter().zip(&middle).map(|(p, q)| p.distance(*q)).sum::<f64>() / 12.0;
        let with = off(refiner.refine(&frame, &middle, &PASSES, &refiner.templates).0);
        refiner.forget_noise();
        (along, with, off(refiner.refine(&frame, &middle, &PASSES, &refiner.templates).0))
    };
    let (clean, ..) = slid([0.0; 3]);
    let (noisy, with, without) = slid([0.0, 5.0, 9.0]);
    assert!(clean < 0.1 && noisy > 20.0 * clean.max(0.02), "{clean} {noisy}");
    assert!(with < 0.7 * without, "{with} {without}");
}

#[test]
fn a_limb_that_is_drawn_longer_is_reached_by_the_wide_templates() {
    let limb = |length: f64, at: Point| -> Vec<Point> {
        let edge = |y: f64| [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| Point::new((share - 0.5) * length, y) + at);
        edge(0.0).into_iter().chain(edge(16.0).into_iter().rev()).collect()
    };
    let keys = [limb(120.0, Point::new(150.0, 200.0)), limb(120.0, Point::new(330.0, 260.0))];
    let (rough, truth) = (limb(120.0, Point::new(240.0, 230.0)), limb(146.0, Point::new(240.0, 230.0)));
    let (pictures, cover) = (keys.each_ref().map(|key| drawn(key, WALL)), Cover::none(LINES as f64));
    let picture = drawn(&truth, WALL);
    let frame = Frame { picture: &picture, cover: &cover, share: 0.5, pins: BTreeMap::new() };
    let key = |k: usize| Key { points: &keys[k], picture: &pictures[k], cover: &cover };
    let mut refiner = Refiner::new([key(0), key(1)], true).unwrap();
    let worst = |points: Vec<Point>| points.iter().zip(&truth).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
    let with = worst(refiner.improved(&frame, rough.clone()));
    refiner.forget_wide();
    let without = worst(refiner.improved(&frame, rough));
    assert!(with < 3.0 && without > 8.0, "{with} {without}");
}

/// The place at a length along a closed contour.
fn along(contour: &[Point], mut length: f64) -> Point {
    for (k, &p) in contour.iter().enumerate().cycle() {
        let q = contour[(k + 1) % contour.len()];
        if length <= p.distance(q) {
            return p.lerp(q, length / p.distance(q));
        }
        length -= p.distance(q);
    }
    Point::ZERO
}

/// A thin line on paper with dark marks.
fn inked(contour: &[Point], marks: &[Point]) -> Features {
    let (low, high) = polygon::bounds(contour).unwrap();
    let colour = |p: Point| -> Colour {
        let near = p.x > low.x - 6.0 && p.y > low.y - 6.0 && p.x < high.x + 6.0 && p.y < high.y + 6.0;
        if near && marks.iter().any(|m| m.distance(p) <= 3.0) {
            [0.2; 3]
        } else if near && polyline::distance(p, contour, true) <= 1.5 {
            [0.5; 3]
        } else {
            [0.95; 3]
        }
    };
    Features::new(&Raster::from_fn(LINES, LINES, |x, y| colour(Point::new(x as f64 + 0.5, y as f64 + 0.5))))
}
