//! How tangled a line is: the places where it crosses itself, and the side on which its inside is.
//!
//! Segments are sorted by their least x. Each is tested against those that begin before it ends. On the lines of a drawing
//! few segments share a stretch of x, so this is much less than all pairs. Limits: segments that only touch, or that lie
//! on each other, count as not crossing.

use rototoon_base::geometry::{Point, polygon};

/// A closed line whose area is below this share of the square of its length has no clear inside.
const THIN: f64 = 1e-3;

/// The number of places where a line crosses itself.
pub(super) fn crossings(points: &[Point], closed: bool) -> usize {
    let n = points.len();
    let segments = if closed { n } else { n.saturating_sub(1) };
    if segments < 3 {
        return 0;
    }
    let ends = |i: usize| (points[i], points[(i + 1) % n]);
    let mut order: Vec<(f64, usize)> = (0..segments).map(|i| (ends(i).0.x.min(ends(i).1.x), i)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut count = 0;
    for (k, &(_, i)) in order.iter().enumerate() {
        let (a, b) = ends(i);
        let (right, low, high) = (a.x.max(b.x), a.y.min(b.y), a.y.max(b.y));
        for &(left, j) in &order[k + 1..] {
            if left > right {
                break;
            }
            let (c, d) = ends(j);
            let apart = i.abs_diff(j).min(if closed { segments - i.abs_diff(j) } else { usize::MAX });
            if apart > 1 && c.y.min(d.y) <= high && c.y.max(d.y) >= low && cross(a, b, c, d) {
                count += 1;
            }
        }
    }
    count
}

/// Whether two segments cross inside both.
fn cross(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |a: Point, b: Point, p: Point| (b - a).perp_dot(p - a);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// 1 or −1 by the direction in which a closed line runs round its inside; 0 where it has no clear inside.
pub(super) fn orientation(points: &[Point]) -> i8 {
    let length: f64 = points.iter().zip(points.iter().cycle().skip(1)).map(|(p, q)| p.distance(*q)).sum();
    let area = polygon::signed_area(points);
    if area.abs() <= THIN * length * length {
        0
    } else if area > 0.0 {
        1
    } else {
        -1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_eight_crosses_itself_once() {
        let at = |k: i32| (f64::from(k) + 0.3) * std::f64::consts::TAU / 41.0;
        let eight: Vec<Point> = (0..41).map(|k| Point::new(at(k).sin(), (2.0 * at(k)).sin())).collect();
        assert_eq!(crossings(&eight, true), 1);
        let circle: Vec<Point> = (0..41).map(|k| Point::from_angle(at(k))).collect();
        assert_eq!((crossings(&circle, true), orientation(&circle)), (0, 1));
        let back: Vec<Point> = circle.iter().rev().copied().collect();
        assert_eq!((orientation(&back), orientation(&[Point::ZERO, Point::X, Point::X])), (-1, 0));
    }

    proptest! {
        #[test]
        fn the_sweep_finds_what_all_pairs_show(
            points in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0), 0..30), closed: bool,
        ) {
            let points: Vec<Point> = points.into_iter().map(Point::from).collect();
            let n = points.len();
            let segments = if closed { n } else { n.saturating_sub(1) };
            let mut count = 0;
            for i in 0..segments {
                for j in i + 2..segments {
                    let neighbours = closed && i == 0 && j + 1 == segments;
                    let [a, b, c, d] = [i, i + 1, j, j + 1].map(|k| points[k % n]);
                    count += usize::from(!neighbours && cross(a, b, c, d));
                }
            }
            prop_assert_eq!(crossings(&points, closed), count);
        }
    }
}
