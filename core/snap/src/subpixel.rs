//! From a chain of pixels to a path along the ink with sub-pixel places.
//!
//! 1. Each pixel on an edge or line is moved across the feature's direction to the feature's own place. For an edge
//!    that is the vertex of a parabola through the gradient magnitude, for a line the middle between both edges.
//! 2. Pixels without a feature are left out where the way across them is nearly straight. Elsewhere they stay at their
//!    centres.
//! 3. Binomial smoothing along the path removes the staircase of those pixels. It also joins fixed ends that are a
//!    pixel or two beside the ink without a kink. It moves a curve of radius r by about 1/2r px, less than a tenth of a
//!    pixel for radii above 5.
//!
//! A path along an edge stays on its side of an ink line: a gradient that changes its sign is expensive, and each pixel
//! moves to the extremum of its own gradient.

use super::corridor::Corridor;
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::nearest_on_segment;

/// Number of binomial passes (¼, ½, ¼). Each adds ½ px² of variance on a path of one point per pixel.
const PASSES: usize = 2;

/// A run of pixels without a feature is left out if all of them are at most this far from the straight way across the
/// run, in pixels.
const STRAIGHT: f64 = 1.0;

/// The same limit as a share of the length of the straight way; the larger limit counts. On flat areas, chains of
/// horizontal and diagonal steps that bulge by up to a fifth (½ tan 22.5°) are as short as any.
const BULGE: f64 = 0.25;

/// Points nearer than this to their predecessor or to the end are dropped, in pixels.
const LEAST_STEP: f64 = 0.3;

/// The path through `pixels`, given by index in the strip's box, from exactly `a` to exactly `b`. `place` gives the
/// sub-pixel place of the feature that passes through a pixel. All coordinates are pixels of the picture.
pub(super) fn refine(
    pixels: &[usize],
    corridor: &Corridor,
    place: impl Fn(usize) -> Option<Point>,
    a: Point,
    b: Point,
) -> Vec<Point> {
    let inner = pixels.get(1..pixels.len().saturating_sub(1)).unwrap_or_default();
    let places: Vec<Option<Point>> = inner.iter().map(|&i| place(i)).collect();
    let mut path = vec![a];
    let mut i = 0;
    for run in places.chunk_by(|p, q| p.is_some() == q.is_some()) {
        let end = i + run.len();
        if run[0].is_some() {
            path.extend(run.iter().flatten());
        } else {
            let centres: Vec<Point> = inner[i..end].iter().map(|&i| centre(corridor.pixel(i))).collect();
            let (from, to) = (path[path.len() - 1], places.get(end).copied().flatten().unwrap_or(b));
            let near = STRAIGHT.max(BULGE * from.distance(to));
            if centres.iter().any(|&p| p.distance(nearest_on_segment(p, from, to)) > near) {
                path.extend(centres);
            }
        }
        i = end;
    }
    path.push(b);
    let last = path.len() - 1;
    for _ in 0..PASSES {
        let mut before = path[0];
        for k in 1..last {
            let here = path[k];
            path[k] = 0.25 * before + 0.5 * here + 0.25 * path[k + 1];
            before = here;
        }
    }
    thin(&path)
}

fn centre((x, y): (usize, usize)) -> Point {
    Point::new(x as f64 + 0.5, y as f64 + 0.5)
}

/// The path without points that are too near to their predecessor or to the end. Both ends are kept.
fn thin(path: &[Point]) -> Vec<Point> {
    let end = path[path.len() - 1];
    let mut kept = vec![path[0]];
    for &p in &path[1..path.len() - 1] {
        if p.distance(kept[kept.len() - 1]) >= LEAST_STEP && p.distance(end) >= LEAST_STEP {
            kept.push(p);
        }
    }
    kept.push(end);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_kept_and_bunched_points_dropped() {
        let path = [0.0, 0.1, 0.5, 0.6, 1.4, 1.9, 2.0].map(|x| Point::new(x, 0.0));
        let kept: Vec<f64> = thin(&path).iter().map(|p| p.x).collect();
        assert_eq!(kept, [0.0, 0.5, 1.4, 2.0]);
        assert_eq!(thin(&path[..2]).len(), 2);
    }

    #[test]
    fn a_path_of_one_pixel_is_its_two_ends() {
        let (a, b) = (Point::new(3.1, 3.2), Point::new(3.8, 3.7));
        let corridor = Corridor::new(a, b, 4.0, (8, 8));
        assert_eq!(refine(&[corridor.index(a)], &corridor, |_| None, a, b), [a, b]);
    }
}
