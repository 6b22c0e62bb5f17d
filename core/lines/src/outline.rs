//! The outline of a region: marching squares (Lorensen & Cline 1987, in two dimensions).
//!
//! A field has a value at the centre of each pixel. Between a pixel above 0 and a neighbour that is not lies a point of the
//! outline, where the straight line between both values is 0. So the outline of soft ink is exact to a fraction of a pixel.
//! Where two pixels above 0 touch by a corner only, they are apart, and so each loop is simple.

use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use std::collections::BTreeMap;

/// An edge between the centres of two neighbours: the first one, and whether the other is below it (or to its right).
type Edge = (usize, usize, bool);

/// The loops in which a field is 0, in pixels (a pixel's centre at +0.5). Outer outlines have a positive
/// [area](rototoon_base::geometry::polygon::signed_area), holes a negative one. The border of the field counts as not above 0.
pub fn outlines(field: &Raster<f32>) -> Vec<Vec<Point>> {
    let mut next = steps(field);
    let mut loops = Vec::new();
    while let Some((&first, _)) = next.first_key_value() {
        let mut at = first;
        let mut own = Vec::new();
        while let Some(to) = next.remove(&at) {
            own.push(place(field, at));
            at = to;
        }
        loops.push(own);
    }
    loops
}

/// The edge that follows on each edge that the outline crosses. Inside is on the right of the way, as seen on the screen.
fn steps(field: &Raster<f32>) -> BTreeMap<Edge, Edge> {
    let (width, height) = (field.width(), field.height());
    let mut next = BTreeMap::new();
    for (y, x) in (0..height.saturating_sub(1)).flat_map(|y| (0..width.saturating_sub(1)).map(move |x| (y, x))) {
        let above = |u: usize, v: usize| {
            let inner = u > 0 && v > 0 && u + 1 < width && v + 1 < height;
            inner && field.get(u, v) > 0.0
        };
        let corners = [above(x, y), above(x + 1, y), above(x + 1, y + 1), above(x, y + 1)];
        let (top, right, bottom, left) = ((x, y, false), (x + 1, y, true), (x, y + 1, false), (x, y, true));
        // Each corner that is above is cut off by its own two edges, unless its neighbours are above too.
        let sides = [top, right, bottom, left];
        for k in 0..4 {
            // A side from a corner outside to one inside, clockwise, is where the outline leaves the square.
            if corners[k] || !corners[(k + 1) % 4] {
                continue;
            }
            // The way came in where the run of corners inside ends.
            let run = (1..4).take_while(|&n| corners[(k + n) % 4]).count();
            next.insert(sides[(k + run) % 4], sides[k]);
        }
    }
    next
}

/// Where a field is 0 on an edge.
fn place(field: &Raster<f32>, (x, y, down): Edge) -> Point {
    let (u, v) = if down { (x, y + 1) } else { (x + 1, y) };
    let (a, b) = (f64::from(field.get(x, y)), f64::from(field.get(u, v)));
    // At the border of the field both values may be above 0.
    let share = if (a > 0.0) == (b > 0.0) { 0.5 } else { (a / (a - b)).clamp(0.0, 1.0) };
    let at = |x: usize, y: usize| Point::new(x as f64 + 0.5, y as f64 + 0.5);
    at(x, y).lerp(at(u, v), share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::polygon::{contains, signed_area};

    #[test]
    fn a_disc_with_a_hole_has_two_exact_outlines() {
        let centre = Point::new(30.3, 29.6);
        let away = |x: usize, y: usize| Point::new(x as f64 + 0.5, y as f64 + 0.5).distance(centre);
        let field = Raster::from_fn(60, 60, |x, y| (20.0 - away(x, y)).min(away(x, y) - 8.0) as f32);
        let mut loops = outlines(&field);
        loops.sort_by(|a, b| signed_area(b).total_cmp(&signed_area(a)));
        assert_eq!(loops.len(), 2);
        for (points, radius) in loops.iter().zip([20.0, 8.0]) {
            assert!(points.iter().all(|p| (p.distance(centre) - radius).abs() < 0.05), "{radius}");
        }
        assert!(signed_area(&loops[0]) > 0.0 && signed_area(&loops[1]) < 0.0);
    }

    #[test]
    fn the_outlines_of_any_mask_hold_the_centres_of_its_pixels() {
        let mut seed = 3u32;
        for _ in 0..40 {
            let mask = Raster::from_fn(12, 9, |x, y| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                x > 0 && y > 0 && x < 11 && y < 8 && seed >> 31 == 1
            });
            let loops = outlines(&mask.map(|on| if on { 1.0 } else { -1.0 }));
            for (x, y) in (0..9).flat_map(|y| (0..12).map(move |x| (x, y))) {
                let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                let inside = loops.iter().filter(|own| contains(own, p)).count() % 2 == 1;
                assert_eq!(inside, mask.get(x, y), "{x} {y}");
            }
        }
    }
}
