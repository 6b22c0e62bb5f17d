//! Which sub-paths of a filled path bound holes.
//!
//! A path may have several sub-paths, and its fill rule says what they enclose together: a ring is two circles. A part is one contour
//! without holes, so a sub-path around a hole is no part.
//!
//! **How.** A sub-path is walked along at equal steps. At each the fill just inside of it is compared with the fill just outside. Where
//! only the outside is filled, it bounds a hole, and where only the inside is, an area. The greater number says what it is. Where sub-paths cross
//! each other, one may be both; it is an area with a hole then if it bounds more area. Where both sides are filled, it changes nothing, and counts as an area.
//!
//! Source: W3C, Scalable Vector Graphics (SVG) 2, chapter on painting, "Winding rule".

use rototoon_base::geometry::{Point, polygon, polyline};

/// Number of places at which a sub-path is asked.
const PLACES: usize = 16;
/// How far beside a sub-path the fill is asked, in pixels, and as a share of its length.
const BESIDE: (f64, f64) = (1e-3, 1e-4);
/// Greatest number of sub-paths, and of steps along their sides for all questions.
const MOST: (usize, usize) = (4000, 400_000_000);

/// What a sub-path bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bound {
    /// An area, or nothing.
    Area,
    /// An area, and holes in places.
    Both,
    /// A hole.
    Hole,
}

/// What each of these closed contours bounds in a path of all of them; `None` if there are too many to say.
pub(super) fn bounds(contours: &[&[Point]], is_even_odd: bool) -> Option<Vec<Bound>> {
    if contours.len() > MOST.0 {
        return None;
    }
    let boxes: Vec<[Point; 2]> = contours.iter().map(|contour| bounding(contour)).collect();
    let near = |k: usize| {
        let (boxes, [low, high]) = (&boxes, boxes[k]);
        (0..contours.len()).filter(move |&other| boxes[other][0].cmple(high).all() && boxes[other][1].cmpge(low).all())
    };
    let steps: usize = (0..contours.len()).flat_map(|k| near(k).map(|other| contours[other].len())).sum();
    if steps.saturating_mul(2 * PLACES) > MOST.1 {
        return None;
    }
    let one = |k: usize| {
        let others: Vec<&[Point]> = near(k).map(|other| contours[other]).collect();
        bound(contours[k], &others, is_even_odd)
    };
    Some((0..contours.len()).map(one).collect())
}

fn bounding(contour: &[Point]) -> [Point; 2] {
    let start = [Point::INFINITY, Point::NEG_INFINITY];
    contour.iter().fold(start, |[low, high], p| [low.min(*p), high.max(*p)])
}

/// What a contour bounds among those near it, itself too.
fn bound(contour: &[Point], near: &[&[Point]], is_even_odd: bool) -> Bound {
    let length = polyline::length(contour, true);
    let beside = BESIDE.0.min(BESIDE.1 * length);
    let inward = polygon::signed_area(contour).signum();
    let is_filled = |p: Point| {
        let (turns, crossings) = near.iter().map(|other| around(p, other)).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        if is_even_odd { crossings % 2 != 0 } else { turns != 0 }
    };
    let (mut areas, mut holes) = (0, 0);
    for (at, along) in places(contour, length) {
        let side = Point::new(-along.y, along.x) * inward * beside;
        match (is_filled(at + side), is_filled(at - side)) {
            (true, false) => areas += 1,
            (false, true) => holes += 1,
            _ => {}
        }
    }
    match (areas, holes) {
        (areas, holes) if holes > areas => Bound::Hole,
        (_, 0) => Bound::Area,
        _ => Bound::Both,
    }
}

/// Places at equal steps along a contour, each with the direction there.
fn places(contour: &[Point], length: f64) -> Vec<(Point, Point)> {
    let step = length / PLACES as f64;
    let (mut found, mut done, mut next) = (Vec::new(), 0.0, 0.5 * step);
    for (k, &from) in contour.iter().enumerate() {
        let to = contour[(k + 1) % contour.len()];
        let side = from.distance(to);
        while found.len() < PLACES && next < done + side {
            found.push((from.lerp(to, (next - done) / side), (to - from) / side));
            next += step;
        }
        done += side;
    }
    found
}

/// How often a contour goes around a point, and how often it crosses the line from the point to the right.
fn around(p: Point, contour: &[Point]) -> (i64, i64) {
    let (mut turns, mut crossings) = (0, 0);
    let mut from = contour[contour.len() - 1];
    for &to in contour {
        if (from.y > p.y) != (to.y > p.y) {
            let side = (to - from).perp_dot(p - from);
            let down = to.y > from.y;
            if (side > 0.0) == down {
                turns += if down { 1 } else { -1 };
                crossings += 1;
            }
        }
        from = to;
    }
    (turns, crossings)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, side: f64) -> Vec<Point> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(dx, dy)| Point::new(x + dx, y + dy)).to_vec()
    }

    fn back(mut contour: Vec<Point>) -> Vec<Point> {
        contour.reverse();
        contour
    }

    fn both_rules(contours: &[Vec<Point>]) -> [Vec<Bound>; 2] {
        let all: Vec<&[Point]> = contours.iter().map(Vec::as_slice).collect();
        [true, false].map(|is_even_odd| bounds(&all, is_even_odd).unwrap())
    }

    #[test]
    fn the_fill_rule_says_what_is_a_hole() {
        use Bound::{Area, Both, Hole};
        let (outer, inner, island) = (square(0.0, 0.0, 30.0), square(5.0, 5.0, 20.0), square(10.0, 10.0, 9.0));
        assert_eq!(both_rules(&[outer.clone(), inner.clone()]), [vec![Area, Hole], vec![Area, Area]]);
        for outer in [outer.clone(), back(outer.clone())] {
            let hole = if polygon::signed_area(&outer) > 0.0 { back(inner.clone()) } else { inner.clone() };
            assert_eq!(both_rules(&[hole, outer.clone()]), [vec![Hole, Area], vec![Hole, Area]]);
        }
        let target = [outer.clone(), back(inner.clone()), island];
        assert_eq!(both_rules(&target), [vec![Area, Hole, Area], vec![Area, Hole, Area]]);
        // Beside each other, and over each other at a corner.
        assert_eq!(both_rules(&[outer.clone(), square(40.0, 0.0, 9.0)]), [vec![Area; 2], vec![Area; 2]]);
        assert_eq!(both_rules(&[outer.clone(), square(20.0, 20.0, 30.0)]), [vec![Both; 2], vec![Area; 2]]);
        // A hole that touches the outline.
        assert_eq!(both_rules(&[outer, back(square(0.0, 5.0, 20.0))])[0], [Area, Hole]);
    }

    #[test]
    fn holes_among_too_many_sub_paths_are_not_looked_for() {
        let many: Vec<Vec<Point>> = (0..=MOST.0).map(|k| square(3.0 * k as f64, 0.0, 2.0)).collect();
        let all: Vec<&[Point]> = many.iter().map(Vec::as_slice).collect();
        assert_eq!(bounds(&all, true), None);
        assert_eq!(bounds(&all[1..], true), Some(vec![Bound::Area; MOST.0]));
        let long: Vec<Point> = (0..20_000).map(|k| Point::from_angle(f64::from(k) * 1e-3)).collect();
        assert_eq!(bounds(&vec![&long[..]; 300], true), None);
    }
}
