//! A movement that is locally a similarity: nodes on a lattice, each with the similarity that fits the pairs around it.
//!
//! Between the nodes the places to which the four nodes around take a point are blended. At a share of the way each
//! similarity has that share of its turn, of the logarithm of its scale, and of the shift of its middle.

use super::partners::{Pair, Place};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};

/// Distance of the nodes, as a share of their reach.
const SPACING: f64 = 0.5;
/// Largest change of scale, either way.
const SCALE: f64 = 1.5;
/// Length along a line by which its direction is carried, as a share of the distance of the nodes.
const ALONG: f64 = 0.05;
/// Weight of the pairs around a node below which it says nothing.
const LEAST: f64 = 1e-9;

/// A movement.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    origin: Point,
    spacing: f64,
    columns: usize,
    rows: usize,
    nodes: Vec<Option<Node>>,
}

/// A similarity: q = factor (p − source) + target, with factor = e^(growth + i turn).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    source: Point,
    target: Point,
    turn: f64,
    growth: f64,
}

impl Node {
    fn at(&self, p: Point, share: f64) -> Point {
        let factor = Point::from_angle(self.turn * share) * (self.growth * share).exp();
        factor.rotate(p - self.source) + self.source.lerp(self.target, share)
    }

    /// The least-squares similarity of weighted pairs.
    fn fit(pairs: impl Iterator<Item = (Pair, f64)> + Clone) -> Option<Self> {
        let mut sums = (0.0, Point::ZERO, Point::ZERO);
        for (pair, weight) in pairs.clone() {
            sums = (sums.0 + weight, sums.1 + pair.from * weight, sums.2 + pair.to * weight);
        }
        if sums.0 < LEAST {
            return None;
        }
        let (source, target) = (sums.1 / sums.0, sums.2 / sums.0);
        let mut numerator = Point::ZERO;
        let mut square = 0.0;
        for (pair, weight) in pairs {
            let (p, q) = (pair.from - source, pair.to - target);
            numerator += Point::new(p.dot(q), p.perp_dot(q)) * weight;
            square += p.length_squared() * weight;
        }
        let factor = if square > LEAST { numerator / square } else { Point::X };
        let growth = factor.length().clamp(1.0 / SCALE, SCALE).ln();
        Some(Self { source, target, turn: factor.to_angle(), growth })
    }
}

impl Field {
    /// The same shift everywhere.
    pub fn shift(by: Point) -> Self {
        let node = Node { source: Point::ZERO, target: by, turn: 0.0, growth: 0.0 };
        Self { origin: Point::ZERO, spacing: 1.0, columns: 1, rows: 1, nodes: vec![Some(node)] }
    }

    /// The movement that fits pairs. A node counts the pairs within its reach, in pixels, the nearer the more.
    pub fn fit(pairs: &[Pair], reach: f64) -> Self {
        let from: Vec<Point> = pairs.iter().map(|pair| pair.from).collect();
        let (low, high) = polygon::bounds(&from).unwrap_or((Point::ZERO, Point::ZERO));
        let spacing = SPACING * reach;
        let cells = (high - low) / spacing;
        let (columns, rows) = (cells.x.ceil() as usize + 1, cells.y.ceil() as usize + 1);
        let node = |index: usize| {
            let at = low + Point::new((index % columns) as f64, (index / columns) as f64) * spacing;
            let near = pairs.iter().filter_map(|pair| {
                let share = 1.0 - pair.from.distance_squared(at) / (reach * reach);
                (share > 0.0).then_some((*pair, pair.weight * share * share))
            });
            let near: Vec<(Pair, f64)> = near.collect();
            Node::fit(near.iter().copied())
        };
        let nodes = (0..columns * rows).into_par_iter().map(node).collect();
        Self { origin: low, spacing, columns, rows, nodes }
    }

    /// A point at a share of the way.
    pub fn at(&self, p: Point, share: f64) -> Point {
        let place = (p - self.origin) / self.spacing;
        let inside = place.clamp(Point::ZERO, Point::new((self.columns - 1) as f64, (self.rows - 1) as f64));
        let (x, y) = (inside.x.floor() as usize, inside.y.floor() as usize);
        let within = inside - Point::new(x as f64, y as f64);
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let (mut sum, mut total) = (Point::ZERO, 0.0);
        for (dx, dy) in corners {
            let weight =
                (if dx == 1 { within.x } else { 1.0 - within.x }) * (if dy == 1 { within.y } else { 1.0 - within.y });
            let node = self.node(x + dx, y + dy).filter(|_| weight > 0.0);
            if let Some(node) = node {
                sum += node.at(p, share) * weight;
                total += weight;
            }
        }
        if total > 0.0 { sum / total } else { self.nearest(inside).map_or(p, |node| node.at(p, share)) }
    }

    /// A place with its direction, at the end of the way.
    pub fn carry(&self, place: &Place) -> Place {
        let half = 0.5 * ALONG * self.spacing;
        let [before, after] = [-half, half].map(|by| self.at(place.at + place.along * by, 1.0));
        Place { at: self.at(place.at, 1.0), along: (after - before).normalize_or(place.along) }
    }

    fn node(&self, x: usize, y: usize) -> Option<&Node> {
        if x < self.columns && y < self.rows { self.nodes[y * self.columns + x].as_ref() } else { None }
    }

    /// The node nearest to a place on the lattice.
    fn nearest(&self, place: Point) -> Option<&Node> {
        let far = |index: usize| {
            place.distance_squared(Point::new((index % self.columns) as f64, (index / self.columns) as f64))
        };
        let there = (0..self.nodes.len()).filter(|&index| self.nodes[index].is_some());
        there.min_by(|&i, &j| far(i).total_cmp(&far(j))).and_then(|index| self.nodes[index].as_ref())
    }
}
