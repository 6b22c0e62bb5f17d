//! Ink as places along lines, and how far one drawing's ink is from another's.

use super::grid::Grid;
use rototoon_base::geometry::{Point, polyline};

/// Distance of the places along a line, as a share of the size of a drawing.
const STEP: f64 = 1.0 / 100.0;
/// Largest number of places of a line.
const MOST: f64 = 256.0;

/// A line: its points, and whether it is closed.
pub(super) type Line<'a> = (&'a [Point], bool);

/// The distance of places along the lines of a drawing.
pub(super) fn step<'a>(points: impl Iterator<Item = &'a Point>) -> f64 {
    (STEP * size(points)).max(1e-6)
}

/// The size of a drawing: the diagonal of the box around its points, 0 without points.
pub(super) fn size<'a>(points: impl Iterator<Item = &'a Point>) -> f64 {
    let (low, high) = points.fold((Point::INFINITY, Point::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
    if low.x <= high.x { low.distance(high) } else { 0.0 }
}

/// Places along lines, `step` apart.
pub(super) fn places<'a>(lines: impl Iterator<Item = Line<'a>>, step: f64) -> Vec<Point> {
    lines.flat_map(|(points, closed)| along(points, closed, step)).collect()
}

fn along(points: &[Point], closed: bool, step: f64) -> Vec<Point> {
    let length = polyline::length(points, closed);
    if points.len() < 2 || length <= 0.0 {
        return points.first().copied().into_iter().collect();
    }
    polyline::resample(points, closed, (length / step).ceil().clamp(2.0, MOST) as usize)
}

/// The mean distance from places to the nearest of others, in pixels. `grid` has the others.
pub(super) fn apart(from: &[Point], to: &[Point], grid: &Grid) -> f64 {
    let nearest = |p: &Point| grid.nearest(*p, 1).first().map_or(0.0, |&i| to[i].distance(*p));
    from.iter().map(nearest).sum::<f64>() / from.len() as f64
}

/// The mean of [`apart`] both ways.
pub(super) fn both_ways(a: &[Point], b: &[Point]) -> f64 {
    0.5 * (apart(a, b, &Grid::new(b)) + apart(b, a, &Grid::new(a)))
}
