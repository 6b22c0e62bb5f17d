//! Points along lines, evenly spaced, with directions.

use crate::drawing::Drawing;
use rototoon_base::geometry::{Point, polyline};
use std::collections::BTreeMap;

/// A point of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Place in pixels.
    pub place: Point,
    /// Unit vector along the line; its sign says nothing.
    pub along: Point,
}

/// Samples of a polyline, about `step` pixels apart; an open one keeps both ends.
pub fn of_line(points: &[Point], closed: bool, step: f64) -> Vec<Sample> {
    let length = polyline::length(points, closed);
    let count = ((length / step).round() as usize).max(if closed { 3 } else { 1 }) + usize::from(!closed);
    let places = polyline::resample(points, closed, count.max(2));
    let n = places.len();
    let along = |i: usize| {
        let (a, b) = if closed { ((i + n - 1) % n, (i + 1) % n) } else { (i.saturating_sub(1), (i + 1).min(n - 1)) };
        (places[b] - places[a]).normalize_or(Point::X)
    };
    (0..n).map(|i| Sample { place: places[i], along: along(i) }).collect()
}

/// As [`of_line`], but a line shorter than `step` has its middle only.
pub fn of_short_line(points: &[Point], closed: bool, step: f64) -> Vec<Sample> {
    let all = of_line(points, closed, step);
    match &all[..] {
        [a, b] if a.place.distance(b.place) < step => vec![Sample { place: a.place.midpoint(b.place), along: a.along }],
        _ => all,
    }
}

/// Samples of the outlines of a drawing's solid shapes.
pub fn of_solids(drawing: &Drawing, step: f64) -> Vec<Sample> {
    let solids = drawing.graph.branches.iter().filter(|branch| branch.fill);
    solids.flat_map(|branch| of_line(&branch.points, branch.closed, step)).collect()
}

/// Samples of all ink of a drawing, through its junctions. With `few`, branches shorter than `step` have a single one.
pub fn of_ink(drawing: &Drawing, step: f64, few: bool) -> Vec<Sample> {
    let graph = &drawing.graph;
    let line = |branch: &crate::graph::Branch| {
        let mut points = branch.points.clone();
        if let Some(junction) = branch.ends[0] {
            points.insert(0, graph.junctions[junction].place);
        }
        if let Some(junction) = branch.ends[1] {
            points.push(graph.junctions[junction].place);
        }
        if few { of_short_line(&points, branch.closed, step) } else { of_line(&points, branch.closed, step) }
    };
    graph.branches.iter().flat_map(line).collect()
}

/// Points in square cells, to find those near a place.
pub struct Cells {
    size: f64,
    cells: BTreeMap<(i32, i32), Vec<u32>>,
}

impl Cells {
    /// The cells of points; `size` is the usual distance of searches in pixels.
    pub fn new(places: impl Iterator<Item = Point>, size: f64) -> Self {
        let mut found = Self { size: size.max(1e-3), cells: BTreeMap::new() };
        places.enumerate().for_each(|(k, p)| found.add(k, p));
        found
    }

    /// Adds the point of index `k`.
    pub fn add(&mut self, k: usize, p: Point) {
        self.cells.entry(Self::cell(p, self.size)).or_default().push(k as u32);
    }

    fn cell(p: Point, size: f64) -> (i32, i32) {
        ((p.x / size).floor() as i32, (p.y / size).floor() as i32)
    }

    /// Indices of the points in the cells within `reach` of a place, and of some farther ones, in a fixed order.
    pub fn near(&self, p: Point, reach: f64) -> impl Iterator<Item = usize> + '_ {
        let (low, high) =
            (Self::cell(p - Point::splat(reach), self.size), Self::cell(p + Point::splat(reach), self.size));
        (low.1..=high.1)
            .flat_map(move |y| (low.0..=high.0).map(move |x| (x, y)))
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .map(|&k| k as usize)
    }
}
