//! Which branch goes on in which: through crossings, past T-junctions, and over gaps of the pen.
//!
//! At a junction each two branches may be one line. The cost is the angle by which the line would turn, plus the difference
//! of widths. A branch may also end there, at a price. All pairings of a junction are compared, and the one of least cost is
//! taken (at junctions with very many branches the best pair is taken again and again). So at a crossing both lines go
//! straight on, and at a T the bar does.
//!
//! Two branches that meet alone are one line whatever their angle: a corner.
//!
//! Afterwards free ends of the ink that point at each other over a short gap are joined.

use crate::graph::{Branch, Graph};
use rototoon_base::geometry::{Point, polyline};

/// Price of an end at a junction, in radians for each of two branches that might be one line.
const END: f64 = 0.8;
/// Weight of the logarithm of the ratio of widths.
const WIDTH: f64 = 0.35;
/// Branches of a junction up to which all pairings are compared.
const MOST: usize = 8;
/// Length over which a branch's direction is measured, in widths and pixels.
const CHORD_WIDTHS: f64 = 4.0;
const CHORD_PIXELS: f64 = 4.0;
/// Share of the bend along the last stretch that goes on behind the end.
const BEND: f64 = 0.5;
/// A gap of the pen is at most this many widths and pixels long.
const GAP_WIDTHS: f64 = 2.5;
const GAP_PIXELS: f64 = 2.0;
/// Largest turn at each end of a gap, in radians.
const GAP_TURN: f64 = 0.6;

/// Two lines that cross at a sharp angle run together for at most this many widths.
const TOGETHER: f64 = 5.0;
/// Largest sum of the turns of two such lines, in radians.
const CROSSING: f64 = 0.5;

/// An end of a branch: its index, and 0 for the first point or 1 for the last.
pub type End = (usize, usize);

/// The end that follows on each end of each branch.
pub struct Pairing {
    next: Vec<[Option<End>; 2]>,
    /// Branches that belong to two strokes that cross, and make none of their own.
    shared: Vec<bool>,
}

impl Pairing {
    /// Pairs the branches of a graph. Branches that end free and are shorter than `stub` pixels are paired only where
    /// nothing else is: they are blots or overshoots, and lines do not turn into them.
    pub fn new(graph: &Graph, stub: f64) -> Self {
        let count = graph.branches.len();
        let mut pairing = Self { next: vec![[None; 2]; count], shared: vec![false; count] };
        pairing.cross(graph);
        for junction in &graph.junctions {
            let open = |end: &&End| !pairing.shared[end.0] && pairing.next(**end).is_none();
            let ends: Vec<End> = junction.branches.iter().filter(open).copied().collect();
            // Two ends that a crossing left over are no corner.
            if ends.len() == 2 && junction.branches.len() > 2 {
                continue;
            }
            let long: Vec<End> = ends.iter().filter(|end| !is_stub(graph, end.0, stub)).copied().collect();
            for (a, b) in pairs(graph, if long.len() > 1 { &long } else { &ends }) {
                pairing.join(a, b);
            }
        }
        pairing.bridge(graph);
        pairing
    }

    /// The end that follows.
    pub fn next(&self, (branch, side): End) -> Option<End> {
        self.next[branch][side]
    }

    /// Whether a branch is shared by two strokes that cross.
    pub fn is_shared(&self, branch: usize) -> bool {
        self.shared[branch]
    }

    /// Joins the lines that cross at a sharp angle. Their ink runs together for a stretch, which has a fork at both ends.
    fn cross(&mut self, graph: &Graph) {
        for (k, branch) in graph.branches.iter().enumerate() {
            let [Some(first), Some(second)] = branch.ends else { continue };
            let others = |junction: usize| -> Vec<End> {
                let ends =
                    graph.junctions[junction].branches.iter().filter(|end| end.0 != k && self.next(**end).is_none());
                ends.copied().collect()
            };
            let length = place(graph, (k, 0)).distance(place(graph, (k, 1)));
            if first == second || branch.closed || length > 2.0 * TOGETHER * radius(graph, (k, 0)) {
                continue;
            }
            let ([a, b], [c, d]) = (&others(first)[..], &others(second)[..]) else { continue };
            let turn = |a: End, b: End| {
                let way = place(graph, b) - place(graph, a);
                angle(outward(graph, a), way).max(angle(outward(graph, b), -way))
            };
            let straight = turn(*a, *c) + turn(*b, *d);
            let crossed = turn(*a, *d) + turn(*b, *c);
            if straight.min(crossed) < CROSSING && straight != crossed {
                let (x, y) = if straight < crossed { (*c, *d) } else { (*d, *c) };
                self.join(*a, x);
                self.join(*b, y);
                self.shared[k] = true;
            }
        }
    }

    fn join(&mut self, a: End, b: End) {
        self.next[a.0][a.1] = Some(b);
        self.next[b.0][b.1] = Some(a);
    }

    /// Joins free ends over gaps, the best first.
    fn bridge(&mut self, graph: &Graph) {
        let free = |branch: &Branch, side: usize| !branch.closed && branch.ends[side].is_none();
        let mut ends: Vec<(End, Point, Point, f64)> = Vec::new();
        for (k, branch) in graph.branches.iter().enumerate() {
            for side in (0..2).filter(|&side| free(branch, side)) {
                let end = (k, side);
                ends.push((end, place(graph, end), outward(graph, end), radius(graph, end)));
            }
        }
        ends.sort_by(|a, b| a.1.x.total_cmp(&b.1.x));
        let widest = ends.iter().map(|end| end.3).fold(0.0, f64::max);
        let mut found = Vec::new();
        for (i, a) in ends.iter().enumerate() {
            let near = |b: &&(End, Point, Point, f64)| b.1.x - a.1.x <= 2.0 * GAP_WIDTHS * widest + GAP_PIXELS;
            for b in ends[i + 1..].iter().take_while(near).filter(|b| b.0.0 != a.0.0) {
                let way = b.1 - a.1;
                let reach = 2.0 * GAP_WIDTHS * a.3.min(b.3) + GAP_PIXELS + a.3 + b.3;
                let turn = angle(a.2, way).max(angle(b.2, -way));
                if way.length() <= reach && turn < GAP_TURN {
                    found.push((turn + way.length() / reach, a.0, b.0));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for (_, a, b) in found {
            if self.next(a).is_none() && self.next(b).is_none() {
                self.join(a, b);
            }
        }
    }
}

/// Whether a branch ends free and is short.
fn is_stub(graph: &Graph, branch: usize, most: f64) -> bool {
    let branch = &graph.branches[branch];
    branch.ends.contains(&None) && !branch.closed && polyline::length(&branch.points, false) < most
}

/// The place of an end.
pub fn place(graph: &Graph, (branch, side): End) -> Point {
    let points = &graph.branches[branch].points;
    if side == 0 { points[0] } else { points[points.len() - 1] }
}

fn radius(graph: &Graph, (branch, side): End) -> f64 {
    let radii = &graph.branches[branch].radii;
    let count = radii.len().min(8);
    let near = if side == 0 { &radii[..count] } else { &radii[radii.len() - count..] };
    near.iter().sum::<f64>() / count as f64
}

/// The direction in which a branch would go on behind its end: that of its last stretch, turned on by its bend.
pub fn outward(graph: &Graph, end: End) -> Point {
    let points = &graph.branches[end.0].points;
    let reach = 2.0 * CHORD_WIDTHS * radius(graph, end) + CHORD_PIXELS;
    let at = |k: usize| if end.1 == 0 { points[k] } else { points[points.len() - 1 - k] };
    let first = at(0);
    let far = |reach: f64| (1..points.len()).find(|&k| first.distance(at(k)) >= reach).unwrap_or(points.len() - 1);
    let (half, whole) = (at(far(0.5 * reach)), at(far(reach)));
    let (near, before) = ((first - half).normalize_or_zero(), (half - whole).normalize_or_zero());
    match before == Point::ZERO {
        true => near,
        false => ((1.0 + BEND) * near - BEND * before).normalize_or(near),
    }
}

fn angle(a: Point, b: Point) -> f64 {
    if a == Point::ZERO || b == Point::ZERO { 0.5 } else { a.angle_to(b).abs() }
}

/// The pairs of a junction.
fn pairs(graph: &Graph, ends: &[End]) -> Vec<(End, End)> {
    // A corner.
    if let [a, b] = ends[..] {
        return vec![(a, b)];
    }
    let directions: Vec<(Point, f64)> = ends.iter().map(|&end| (outward(graph, end), radius(graph, end))).collect();
    let cost = |i: usize, j: usize| {
        let ((a, r), (b, s)) = (directions[i], directions[j]);
        // A short link between two junctions says little about its direction.
        angle(a, -b) + WIDTH * (r / s).ln().abs() - 2.0 * END
    };
    let chosen = if ends.len() <= MOST {
        best(&(0..ends.len()).collect::<Vec<_>>(), &cost).1
    } else {
        greedy(ends.len(), &cost)
    };
    chosen.into_iter().map(|(i, j)| (ends[i], ends[j])).collect()
}

/// The pairing of least cost; a cost is negative where a pair is better than two ends.
fn best(left: &[usize], cost: &impl Fn(usize, usize) -> f64) -> (f64, Vec<(usize, usize)>) {
    let Some((&first, rest)) = left.split_first() else { return (0.0, Vec::new()) };
    let mut found = best(rest, cost);
    for (k, &other) in rest.iter().enumerate() {
        let own = cost(first, other);
        if own < 0.0 {
            let others: Vec<usize> = rest.iter().enumerate().filter(|&(i, _)| i != k).map(|(_, &i)| i).collect();
            let (sum, mut pairs) = best(&others, cost);
            if own + sum < found.0 {
                pairs.push((first, other));
                found = (own + sum, pairs);
            }
        }
    }
    found
}

fn greedy(count: usize, cost: &impl Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
    let mut all: Vec<(f64, usize, usize)> =
        (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j))).map(|(i, j)| (cost(i, j), i, j)).collect();
    all.retain(|pair| pair.0 < 0.0);
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = vec![false; count];
    let free = |&(_, i, j): &(f64, usize, usize)| {
        let free = !taken[i] && !taken[j];
        if free {
            (taken[i], taken[j]) = (true, true);
        }
        free
    };
    all.into_iter().filter(free).map(|(_, i, j)| (i, j)).collect()
}
