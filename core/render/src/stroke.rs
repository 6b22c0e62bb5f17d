//! Strokes of varying width as areas.
//!
//! At each point of a stroke lies a disc with half of the stroke's width there as its radius. Between two points the radius
//! grows evenly, so what the disc sweeps is the convex hull of both discs. The stroke is the union of these hulls: its joins and
//! ends are round, and where it crosses itself it is as dense as elsewhere. Discs are polygons that are at most [`FLAT`] pixels
//! inside of the circle.
//!
//! Two discs of radii r and s whose centres are d apart have outer tangents that touch them in the directions at ±acos((r − s) / d) from the way
//! from the first to the second. If one disc contains the other, it is the hull.

use rototoon_base::geometry::Point;
use std::f64::consts::{PI, TAU};

/// Greatest distance of a polygon from its circle, in pixels.
const FLAT: f64 = 0.02;
/// Greatest number of sides of a circle, which a stroke of any width has.
const SIDES: f64 = 256.0;

/// The hulls of a stroke, whose union is its area. `radii` are half of the width at each point, in pixels. A stroke may run out to a point of radius 0. Points
/// that are not finite, or have no such radius, give a stroke without area there.
pub fn areas(points: &[Point], radii: &[f64], closed: bool) -> Vec<Vec<Point>> {
    let disc = |k: usize| {
        let radius = radii.get(k).copied().filter(|radius| radius.is_finite() && *radius >= 0.0)?;
        points[k].is_finite().then_some((points[k], radius))
    };
    if let [_] = points {
        return disc(0).filter(|(_, radius)| *radius > 0.0).map(|(at, r)| arc(at, r, 0.0, TAU)).into_iter().collect();
    }
    let pieces = if closed { points.len() } else { points.len().saturating_sub(1) };
    let ends = (0..pieces).filter_map(|k| Some((disc(k)?, disc((k + 1) % points.len())?)));
    ends.filter(|(a, b)| a.1 > 0.0 || b.1 > 0.0).map(|(a, b)| hull(a, b)).collect()
}

/// The convex hull of two discs.
fn hull((a, r): (Point, f64), (b, s): (Point, f64)) -> Vec<Point> {
    let away = a.distance(b);
    if away <= (r - s).abs() {
        let (at, radius) = if r >= s { (a, r) } else { (b, s) };
        return arc(at, radius, 0.0, TAU);
    }
    let along = (b - a).to_angle();
    let touch = ((r - s) / away).acos();
    let mut around = arc(b, s, along - touch, along + touch);
    around.extend(arc(a, r, along + touch, along - touch + TAU));
    around
}

/// Points of a circle from one angle to a greater one. The first and the last are points of it, but for a full turn. One of radius 0 is a point.
fn arc(middle: Point, radius: f64, from: f64, to: f64) -> Vec<Point> {
    if radius == 0.0 {
        return vec![middle];
    }
    // The middle of a side is radius · (1 − cos(angle / 2)) inside of the circle.
    let step = 2.0 * (1.0 - FLAT / radius).clamp(-1.0, 1.0).acos();
    let step = step.clamp(TAU / SIDES, 0.5 * PI);
    let sides = ((to - from) / step).ceil().max(1.0);
    let last = if to - from < TAU { sides as usize } else { sides as usize - 1 };
    (0..=last).map(|k| middle + radius * Point::from_angle(from + (to - from) * k as f64 / sides)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matte::coverage;
    use proptest::prelude::*;

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn a_stroke_is_as_wide_as_it_should_be_and_its_ends_are_round() {
        let area = |points: &[Point], radii: &[f64], closed| {
            coverage(&areas(points, radii, closed), 60, 40).data().iter().map(|v| f64::from(*v)).sum::<f64>()
        };
        let line = [p(10.3, 20.2), p(40.1, 20.2)];
        let expected = 29.8 * 5.0 + PI * 6.25;
        assert!((area(&line, &[2.5; 2], false) - expected).abs() < 0.5);
        // A back and forth is no wider or denser.
        assert!((area(&[line[0], line[1], line[0]], &[2.5; 3], false) - expected).abs() < 0.5);
        // A point alone is a disc, and so is one that contains its neighbour.
        assert!((area(&line[..1], &[3.0], false) - PI * 9.0).abs() < 0.5);
        assert!((area(&[line[0], p(11.0, 20.0)], &[6.0, 1.0], false) - PI * 36.0).abs() < 0.8);
        // A closed square has its fourth side.
        let square = [p(10.0, 10.0), p(30.0, 10.0), p(30.0, 30.0), p(10.0, 30.0)];
        assert!((area(&square, &[0.5; 4], true) - (80.0 - 4.0 + 3.0 + PI * 0.25)).abs() < 0.5);
    }

    #[test]
    fn a_stroke_runs_out_to_a_point() {
        let area = |points: &[Point], radii: &[f64]| {
            coverage(&areas(points, radii, false), 60, 40).data().iter().map(|v| f64::from(*v)).sum::<f64>()
        };
        // A triangle between the point and where its sides touch the circle, and the rest of the disc.
        let cone = |r: f64, away: f64| {
            let touch = (r / away).acos();
            r * away * touch.sin() + r * r * (PI - touch)
        };
        let line = [p(10.0, 20.0), p(30.0, 20.0), p(50.0, 20.0)];
        assert!((area(&line[..2], &[4.0, 0.0]) - cone(4.0, 20.0)).abs() < 0.5);
        assert!((area(&line[..2], &[0.0, 4.0]) - cone(4.0, 20.0)).abs() < 0.5);
        assert!((area(&line, &[0.0, 4.0, 0.0]) - (2.0 * cone(4.0, 20.0) - PI * 16.0)).abs() < 0.5);
        // A disc that contains the point.
        assert!((area(&[line[0], p(11.0, 20.0)], &[6.0, 0.0]) - PI * 36.0).abs() < 0.8);
    }

    #[test]
    fn what_has_no_width_or_place_has_no_area() {
        assert!(areas(&[], &[], false).is_empty());
        assert!(areas(&[p(1.0, 1.0), p(5.0, 1.0)], &[0.0, 0.0], false).is_empty());
        assert!(areas(&[p(1.0, 1.0), p(5.0, 1.0)], &[-1.0, 1.0], false).is_empty());
        assert!(areas(&[p(1.0, 1.0)], &[0.0], false).is_empty());
        assert!(areas(&[p(1.0, 1.0), p(5.0, 1.0)], &[1.0], false).is_empty(), "a radius is missing");
        assert!(areas(&[p(f64::NAN, 1.0)], &[1.0], false).is_empty());
        let all = areas(&[p(0.0, 0.0), p(1.0, 0.0), p(f64::INFINITY, 0.0), p(3.0, 0.0), p(4.0, 0.0)], &[1.0; 5], false);
        assert_eq!(all.len(), 2, "the others stay");
        // Same place twice, and a radius beyond any picture.
        assert_eq!(areas(&[p(1.0, 1.0), p(1.0, 1.0)], &[1.0, 1.0], false).len(), 1);
        assert!(areas(&[p(1.0, 1.0)], &[1e9], false)[0].len() <= 257);
    }

    proptest! {
        #[test]
        fn a_hull_contains_what_the_disc_sweeps_and_no_more(
            ends in prop::array::uniform4(0.0f64..20.0), radii in prop::array::uniform2(0.3f64..6.0),
            share in 0.0f64..1.0, angle in 0.0f64..TAU,
        ) {
            let (a, b) = (p(ends[0], ends[1]), p(ends[2], ends[3]));
            let around = areas(&[a, b], &radii, false).pop().unwrap();
            let (middle, radius) = (a.lerp(b, share), radii[0] + share * (radii[1] - radii[0]));
            let within = middle + (radius - 1.1 * FLAT).max(0.0) * Point::from_angle(angle);
            prop_assert!(rototoon_base::geometry::polygon::contains(&around, within));
            for q in around {
                let nearest = (0..=400).map(|k| f64::from(k) / 400.0).map(|share| {
                    q.distance(a.lerp(b, share)) - (radii[0] + share * (radii[1] - radii[0]))
                });
                prop_assert!(nearest.fold(f64::INFINITY, f64::min) < 0.01);
            }
        }
    }
}
