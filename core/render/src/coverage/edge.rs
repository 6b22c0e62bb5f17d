//! Sides of polygons, with heights as integers.

use rototoon_base::geometry::{Point, polyline};

/// Steps in a row: the unit of heights and of the area of a pixel.
pub const ROW: i64 = 1 << 24;

/// The index of no side.
const NONE: u32 = u32::MAX;

/// A side of a polygon, from its upper to its lower end. It is small, so that the sides of a row stay in the processor's cache.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Height of the upper end, in steps of [`ROW`].
    pub top: i64,
    /// Height of the lower end, in steps; greater than `top`.
    pub bottom: i64,
    x: f64,
    slope: f64,
    polygon: u32,
    /// Change of the polygon's winding number from left to right.
    pub winding: i32,
    /// The side that begins at the lower end and continues downward, or [`NONE`].
    next: u32,
}

impl Edge {
    fn new(polygon: usize, a: Point, b: Point) -> Option<(Self, [Point; 2])> {
        let height = |p: Point| (p.y * ROW as f64).round() as i64;
        let (a_y, b_y) = (height(a), height(b));
        let ((upper, top), (lower, bottom), winding) =
            if a_y < b_y { ((a, a_y), (b, b_y), 1) } else { ((b, b_y), (a, a_y), -1) };
        let slope = (lower.x - upper.x) / (bottom - top) as f64;
        let edge = Self { top, bottom, x: upper.x, slope, polygon: polygon as u32, winding, next: NONE };
        (top < bottom).then_some((edge, [upper, lower]))
    }

    /// Index of the polygon.
    #[inline]
    pub fn polygon(&self) -> usize {
        self.polygon as usize
    }

    /// The side that begins at the lower end and continues downward.
    #[inline]
    pub fn next(&self) -> Option<usize> {
        (self.next != NONE).then_some(self.next as usize)
    }

    /// Its x at a height.
    pub fn at(&self, height: i64) -> f64 {
        self.x + (height - self.top) as f64 * self.slope
    }

    /// Its least and greatest x between two heights.
    pub fn range(&self, top: i64, bottom: i64) -> (f64, f64) {
        let (above, below) = (self.at(top.max(self.top)), self.at(bottom.min(self.bottom)));
        (above.min(below), above.max(below))
    }
}

/// Polygons at one instant.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Sides in the order of their upper ends.
    pub edges: Vec<Edge>,
    /// For each of them its upper and lower end, before heights are rounded.
    pub ends: Vec<[Point; 2]>,
    /// The sides that continue no other one, in the same order. With those that follow they are chains that go downward.
    pub heads: Vec<usize>,
    /// Number of polygons.
    pub polygons: usize,
}

impl Instant {
    /// The sides of closed polygons. A polygon with a coordinate that is not finite has none.
    pub fn new(polygons: &[Vec<Point>]) -> Self {
        let mut sides: Vec<Whole> = Vec::new();
        // For each side the one that continues it, as numbers in the order of `sides` before sorting.
        let mut links = Vec::new();
        for (index, points) in polygons.iter().enumerate().filter(|(_, points)| points.iter().all(|p| p.is_finite())) {
            let own: Vec<_> = polyline::segments(points, true).map(|(a, b)| Edge::new(index, a, b)).collect();
            link(&own, sides.len(), &mut links);
            sides.extend(own.into_iter().flatten());
        }
        sorted(&sides, &links, polygons.len())
    }
}

/// A side with its ends.
type Whole = (Edge, [Point; 2]);

/// Adds for each side of a polygon the number of the side that continues it downward. The first side has the number `first`.
fn link(sides: &[Option<Whole>], first: usize, links: &mut Vec<Option<usize>>) {
    let mut number = first;
    let numbers: Vec<usize> = sides
        .iter()
        .map(|side| {
            number += usize::from(side.is_some());
            number.wrapping_sub(1)
        })
        .collect();
    let count = sides.len();
    for (k, side) in sides.iter().enumerate() {
        let Some((side, _)) = side else { continue };
        // The polygon runs downward on one side and upward on the other.
        let beyond = if side.winding > 0 { (k + 1) % count } else { (k + count - 1) % count };
        let continues = sides[beyond].as_ref().is_some_and(|(other, _)| other.winding == side.winding && beyond != k);
        links.push(continues.then(|| numbers[beyond]));
    }
}

/// The instant of sides, sorted by their upper ends.
fn sorted(sides: &[Whole], links: &[Option<usize>], polygons: usize) -> Instant {
    let mut order: Vec<usize> = (0..sides.len()).collect();
    order.sort_by_key(|&number| sides[number].0.top);
    let mut place = vec![0; sides.len()];
    for (at, &number) in order.iter().enumerate() {
        place[number] = at;
    }
    let mut continued = vec![false; sides.len()];
    links.iter().flatten().for_each(|&number| continued[place[number]] = true);
    let at = |&number: &usize| {
        let next = links[number].map_or(NONE, |next| place[next] as u32);
        Edge { next, ..sides[number].0 }
    };
    Instant {
        edges: order.iter().map(at).collect(),
        ends: order.iter().map(|&number| sides[number].1).collect(),
        heads: (0..sides.len()).filter(|&side| !continued[side]).collect(),
        polygons,
    }
}
