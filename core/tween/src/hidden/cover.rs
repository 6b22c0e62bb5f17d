//! A filled shape: the points inside it, and the points on its border.
//!
//! The winding number decides what is **inside**: the number of times that the outline goes round a point. It is the
//! sum of the crossings of the outline with a ray to the right, +1 where the outline runs down and −1 where it runs up.
//! Each piece is split where it turns in y. A part crosses the ray if one of its ends is on or above the ray and the
//! other one is below it. Neighbouring parts share exactly the same end, so rounding cannot make the outline leak. The
//! number is exact for every point off the border. On the border it is one of the neighbouring values.

use super::path::Path;
use super::tree::{Bounds, Tree, meet};
use rototoon_base::curve::Quadratic;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::roots::roots_in;

/// The rule for the points that an outline which crosses itself, or several outlines, enclose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FillRule {
    /// A point is inside if the winding number is not zero: both loops of a figure eight, all of a doubly wound ring.
    #[default]
    NonZero,
    /// A point is inside if the winding number is odd: an outline within another one is a hole, whichever way it runs.
    EvenOdd,
}

/// A cover, prepared for queries.
pub(super) struct Shape {
    pub(super) pieces: Vec<Quadratic>,
    pub(super) tree: Tree,
    rule: FillRule,
}

impl Shape {
    /// The shape enclosed by outlines. Open ones are closed by a straight line.
    pub(super) fn new(outlines: &[Path], rule: FillRule) -> Self {
        let mut pieces = Vec::new();
        for outline in outlines {
            pieces.extend_from_slice(outline.pieces());
            let (start, end) = (outline.pieces()[0].p0, outline.pieces()[outline.pieces().len() - 1].p2);
            if start != end {
                pieces.push(Quadratic::new(end, 0.5 * (start + end), start));
            }
        }
        let tree = Tree::new(pieces.iter().map(Quadratic::bounds).collect());
        Self { pieces, tree, rule }
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.tree.bounds()
    }

    /// Whether a point is inside.
    pub(super) fn contains(&self, p: Point) -> bool {
        if !meet(self.bounds(), (p, p)) {
            return false;
        }
        let ray = (p, Point::new(f64::INFINITY, p.y));
        let mut winding = 0;
        self.tree.query(ray, |i| winding += crossings(&self.pieces[i], p));
        match self.rule {
            FillRule::NonZero => winding != 0,
            FillRule::EvenOdd => winding % 2 != 0,
        }
    }

    /// Whether a point is no farther than `distance` from the outline.
    pub(super) fn is_near(&self, p: Point, distance: f64) -> bool {
        let mut near = false;
        self.tree.query((p - distance, p + distance), |i| {
            near = near || self.pieces[i].nearest(p).distance <= distance;
        });
        near
    }
}

/// Signed number of crossings of a piece with the ray from `p` to the right.
fn crossings(piece: &Quadratic, p: Point) -> i32 {
    let (a, b) = piece.coefficients();
    let turn = -b.y / a.y;
    if turn > 0.0 && turn < 1.0 {
        let top = piece.point(turn).y;
        return crossing(piece, (0.0, piece.p0.y), (turn, top), p) + crossing(piece, (turn, top), (1.0, piece.p2.y), p);
    }
    crossing(piece, (0.0, piece.p0.y), (1.0, piece.p2.y), p)
}

/// The same for a part of the piece that does not turn in y. `(u, from)` and `(v, to)` are the parameter and the y at
/// its ends.
fn crossing(piece: &Quadratic, (u, from): (f64, f64), (v, to): (f64, f64), p: Point) -> i32 {
    let sign = match (from <= p.y, to <= p.y) {
        (true, false) => 1,
        (false, true) => -1,
        _ => return 0,
    };
    let (low, high) = piece.control_box();
    if low.x > p.x {
        return sign;
    }
    if high.x <= p.x {
        return 0;
    }
    let (a, b) = piece.coefficients();
    let found = roots_in(&[piece.p0.y - p.y, 2.0 * b.y, a.y], u, v);
    // The sign changes, so there is a root. If rounding hides it, the end nearer to the ray stands for it.
    let nearer_end = if (from - p.y).abs() < (to - p.y).abs() { u } else { v };
    let at = found.first().copied().unwrap_or(nearer_end);
    if piece.point(at).x > p.x { sign } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::curve::Spline;

    fn shape(points: &[(f64, f64)], rule: FillRule) -> Shape {
        let points: Vec<_> = points.iter().copied().map(Point::from).collect();
        Shape::new(&[Path::of_polyline(&points, true).unwrap()], rule)
    }

    #[test]
    fn both_loops_of_an_eight_are_inside() {
        let eight = [(0.0, 0.0), (8.0, 8.0), (8.0, 0.0), (0.0, 8.0)];
        for rule in [FillRule::NonZero, FillRule::EvenOdd] {
            let eight = shape(&eight, rule);
            assert!(eight.contains(Point::new(1.0, 4.0)) && eight.contains(Point::new(7.0, 4.0)));
            assert!(!eight.contains(Point::new(4.0, 1.0)) && !eight.contains(Point::new(4.0, 7.0)));
        }
    }

    #[test]
    fn a_doubly_wound_ring_is_full_or_hollow_by_rule() {
        let twice = [
            (0.0, 0.0),
            (9.0, 0.0),
            (9.0, 9.0),
            (0.0, 9.0),
            (0.0, 0.0),
            (3.0, 3.0),
            (6.0, 3.0),
            (6.0, 6.0),
            (3.0, 6.0),
            (3.0, 3.0),
        ];
        assert!(shape(&twice, FillRule::NonZero).contains(Point::splat(4.5)));
        assert!(!shape(&twice, FillRule::EvenOdd).contains(Point::splat(4.5)));
        assert!(shape(&twice, FillRule::EvenOdd).contains(Point::splat(1.5)));
    }

    #[test]
    fn rays_through_corners_and_along_edges_are_counted_once() {
        let stairs = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (8.0, 4.0), (8.0, 8.0), (0.0, 8.0)];
        let shape = shape(&stairs, FillRule::NonZero);
        for (p, inside) in
            [((2.0, 4.0), true), ((6.0, 6.0), true), ((6.0, 2.0), false), ((-1.0, 4.0), false), ((-1.0, 0.0), false)]
        {
            assert_eq!(shape.contains(Point::from(p)), inside, "{p:?}");
        }
    }

    #[test]
    fn an_open_outline_is_closed_by_a_line() {
        let arch = Spline::new([(0.0, 0.0), (4.0, 8.0), (8.0, 0.0)].map(Point::from).into(), false).unwrap();
        let shape = Shape::new(&[Path::of_spline(&arch).unwrap()], FillRule::NonZero);
        assert!(shape.contains(Point::new(4.0, 1.0)) && !shape.contains(Point::new(4.0, 4.5)));
        assert!(shape.is_near(Point::new(2.0, 0.01), 0.02) && !shape.is_near(Point::new(4.0, 1.0), 0.9));
    }

    #[test]
    fn shapes_without_area_contain_nothing() {
        for points in [&[(1.0, 1.0)][..], &[(0.0, 0.0), (4.0, 4.0)], &[(2.0, 2.0); 5]] {
            let shape = shape(points, FillRule::NonZero);
            for p in [(1.0, 1.0), (2.0, 2.0), (3.0, 3.0), (0.0, 0.0)] {
                assert!(!shape.contains(Point::from(p)));
            }
        }
    }

    proptest! {
        #[test]
        fn the_winding_number_is_the_sum_of_angles(
            guides in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 1..12), x in -50.0f64..50.0, y in -50.0f64..50.0,
        ) {
            let spline = Spline::new(guides.into_iter().map(Point::from).collect(), true).unwrap();
            let p = Point::new(x, y);
            prop_assume!(spline.nearest(p).distance > 0.01);
            // Naive reference: the angle by which the direction from the point to the outline turns in one round.
            let flat = spline.flattened(2000);
            let turned: f64 = (0..flat.len()).map(|i| (flat[i] - p).angle_to(flat[(i + 1) % flat.len()] - p)).sum();
            let winding = (turned / std::f64::consts::TAU).round() as i64;
            for (rule, inside) in [(FillRule::NonZero, winding != 0), (FillRule::EvenOdd, winding % 2 != 0)] {
                prop_assert_eq!(Shape::new(&[Path::of_spline(&spline).unwrap()], rule).contains(p), inside);
            }
        }
    }
}
