//! Places along the lines of a drawing, and their partners on another one.

use crate::grid::Grid;
use crate::stroke::Stroke;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polyline};

/// Distance of the places along a line, as a share of the drawing's size.
const STEP: f64 = 0.01;
/// Largest number of places of a line.
const MOST: f64 = 256.0;
/// Number of places near a place that are tried as its partners.
pub(super) const TRIED: usize = 6;

/// A place on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub at: Point,
    /// The direction of the line there, of length 1.
    pub along: Point,
}

impl Place {
    /// How far the directions of two places differ: 0 if they are parallel, 1 if they are square.
    pub fn turned(&self, other: &Self) -> f64 {
        1.0 - self.along.dot(other.along).powi(2)
    }
}

/// A place on the first drawing with its partner on the second, and how much it counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    pub from: Point,
    pub to: Point,
    pub weight: f64,
}

/// Places along all lines of a drawing of this size.
pub(super) fn places(strokes: &[Stroke], size: f64) -> Vec<Place> {
    let of = |stroke: &Stroke| {
        let count = (stroke.length() / (STEP * size)).ceil().clamp(3.0, MOST) as usize;
        let usable = stroke.points.len() >= 2 && stroke.length() > 0.0;
        let points = if usable { polyline::resample(&stroke.points, stroke.closed, count) } else { Vec::new() };
        let last = points.len().saturating_sub(1);
        let direction = |k: usize| {
            let (before, after) = if stroke.closed {
                (if k == 0 { last } else { k - 1 }, if k == last { 0 } else { k + 1 })
            } else {
                (k.saturating_sub(1), (k + 1).min(last))
            };
            (points[after] - points[before]).normalize_or(Point::X)
        };
        (0..points.len()).map(|k| Place { at: points[k], along: direction(k) }).collect::<Vec<_>>()
    };
    strokes.iter().flat_map(of).collect()
}

/// Partners, looked for from both drawings. `moved` are the places of the first drawing where they are now. A partner at the
/// distance `trust` counts a quarter.
pub(super) fn pairs(a: &[Place], moved: &[Place], b: &[Place], trust: f64) -> Vec<Pair> {
    let near = |from: &[Place], to: &[Place]| -> Vec<(usize, f64)> {
        let points: Vec<Point> = to.iter().map(|place| place.at).collect();
        let grid = Grid::new(&points);
        let best = |place: &Place| {
            let cost = |j: usize| to[j].at.distance_squared(place.at) + trust * trust * to[j].turned(place);
            let tried = grid.nearest(place.at, TRIED).into_iter().map(|j| (j, cost(j)));
            let (j, cost) = tried.min_by(|x, y| x.1.total_cmp(&y.1)).unwrap_or((0, f64::INFINITY));
            (j, (1.0 / (1.0 + cost / (trust * trust))).powi(2))
        };
        from.par_iter().map(best).collect()
    };
    let ahead = near(moved, b).into_iter().enumerate().map(|(i, (j, weight))| (i, j, weight));
    let back = near(b, moved).into_iter().enumerate().map(|(j, (i, weight))| (i, j, weight));
    ahead.chain(back).map(|(i, j, weight)| Pair { from: a[i].at, to: b[j].at, weight }).collect()
}
