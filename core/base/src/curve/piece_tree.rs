//! The nearest point of a spline for many points.
//!
//! [`Spline::nearest`] looks at every piece, so a query costs as much as the spline has pieces. A [`PieceTree`] has a
//! box around each piece, a box around each two neighbouring boxes, and so on up to one box. Neighbouring pieces lie
//! near each other, so these boxes are small. A query goes to the nearer of two boxes first and leaves out boxes that
//! are farther away than the best point so far. It then costs about the logarithm of the number of pieces.
//!
//! The result is that of [`Spline::nearest`], bit for bit, ties included.

use super::nearest::box_distance;
use super::{Nearest, Spline};
use crate::geometry::Point;

type Box = (Point, Point);

/// A spline prepared for nearest points.
#[derive(Clone, Debug)]
pub struct PieceTree<'a> {
    spline: &'a Spline,
    /// The boxes of each level. The first level has one for each piece, the last has one for all.
    levels: Vec<Vec<Box>>,
}

impl<'a> PieceTree<'a> {
    /// Prepares a spline.
    pub fn new(spline: &'a Spline) -> Self {
        let mut levels = vec![spline.pieces().map(|piece| piece.control_box()).collect::<Vec<_>>()];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            let joined = last.chunks(2).map(|pair| match *pair {
                [(low, high), (other_low, other_high)] => (low.min(other_low), high.max(other_high)),
                _ => pair[0],
            });
            let joined = joined.collect();
            levels.push(joined);
        }
        Self { spline, levels }
    }

    /// The point nearest to `p`. Among several the one with the smallest parameter counts.
    pub fn nearest(&self, p: Point) -> Nearest {
        let mut best = Nearest { parameter: f64::INFINITY, point: p, distance: f64::INFINITY };
        self.search(self.levels.len() - 1, 0, p, &mut best);
        best
    }

    fn search(&self, level: usize, index: usize, p: Point, best: &mut Nearest) {
        if level == 0 {
            let found = self.spline.piece(index).nearest(p);
            let parameter = index as f64 + found.parameter;
            // A piece before the best one wins a tie, whatever the order of the search.
            let before = (index as f64) < best.parameter.floor();
            if found.distance < best.distance || (found.distance == best.distance && before) {
                *best = Nearest { parameter, ..found };
            }
            return;
        }
        let below = &self.levels[level - 1];
        let away = |child: usize| box_distance(p, below[child]);
        let (first, second) = (2 * index, 2 * index + 1);
        let mut visit = |child: usize, distance: f64| {
            if distance <= best.distance {
                self.search(level - 1, child, p, best);
            }
        };
        if second >= below.len() {
            return visit(first, away(first));
        }
        let (near, far) = (away(first), away(second));
        let order = if near <= far { [(first, near), (second, far)] } else { [(second, far), (first, near)] };
        order.into_iter().for_each(|(child, distance)| visit(child, distance));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_tree_finds_what_all_pieces_have(
            guides in prop::collection::vec((-9i32..9, -9i32..9), 1..40), closed: bool,
            x in -24i32..24, y in -24i32..24,
        ) {
            // Whole numbers make ties.
            let guides = guides.into_iter().map(|(x, y)| Point::new(f64::from(x), f64::from(y))).collect();
            let spline = Spline::new(guides, closed).unwrap();
            let p = 0.5 * Point::new(f64::from(x), f64::from(y));
            prop_assert_eq!(PieceTree::new(&spline).nearest(p), spline.nearest(p));
        }
    }
}
