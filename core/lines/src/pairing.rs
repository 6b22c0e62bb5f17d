//! Which branch goes on in which: through crossings, past T-junctions, around corners, and over gaps of the pen.
//!
//! Where branches meet, each two may be one line. The cost is the angle by which the line would turn, and the differences of
//! width and colour. A branch may also end there, at a price. All pairings of a cluster of junctions ([`crate::cluster`]) are
//! compared, and the one of least cost is taken (where very many branches meet, the best pair is taken again and again). So
//! at a crossing both lines go straight on, and at a T the bar does.
//!
//! Among three branches there is more to know. The pair that goes on bounds one region on its side without the third. That
//! region is in front of what the third separates, and the paper around the drawing is never in front
//! ([`crate::outside`]). So the outline of a figure is less one line than the outlines of its parts, where these overlap.
//!
//! Two branches that meet alone are one line whatever their angle: a corner. Other corners: [`crate::corner`].
//!
//! Afterwards free ends of the ink that point at each other over a short gap are joined. A dot points nowhere: it may lie in the gap of a line, but two dots
//! are no line.

use crate::cluster::{Cluster, clusters, points};
use crate::corner;
use crate::direction::{End, angle, outward, place, radius};
use crate::graph::{Branch, Graph};
use crate::outside::Outside;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::Colour;
use std::collections::BTreeMap;

/// Price of an end at a junction, in radians for each of two branches that might be one line.
const END: f64 = 0.9;
/// Price of a pair that bounds the paper around the drawing, in radians.
const AROUND: f64 = 0.4;
/// Weight of the logarithm of the ratio of widths, and of the difference of hues.
const WIDTH: f64 = 0.35;
const COLOUR: f64 = 1.5;
/// Distance of two ends from which the way between them counts, in widths.
const FAR: f64 = 1.5;
/// Branches that meet up to which all pairings are compared.
const MOST: usize = 8;
/// A gap of the pen is at most this many widths and pixels long.
const GAP_WIDTHS: f64 = 2.5;
const GAP_PIXELS: f64 = 2.0;
/// Largest turn at each end of a gap, in radians.
pub const GAP_TURN: f64 = 0.6;
/// Two lines that cross at a sharp angle run together for at most this many widths.
const TOGETHER: f64 = 5.0;
/// Largest sum of the turns of two such lines, in radians.
const CROSSING: f64 = 0.5;
/// Distance in which the region beside a junction is looked for, in widths.
const BESIDE: f64 = 3.0;

/// What decides which branch goes on in which.
pub struct Evidence<'a> {
    /// The branches.
    pub graph: &'a Graph,
    /// The paper around the drawing.
    pub outside: &'a Outside,
    /// The colours of the branches.
    pub colours: &'a [Colour],
    /// Branches shorter than this, in pixels, are no lines of their own.
    pub stub: f64,
}

/// The end that follows on each end of each branch.
pub struct Pairing {
    next: Vec<[Option<End>; 2]>,
    /// Branches that lie within strokes, or belong to two that cross, and make none of their own.
    shared: Vec<bool>,
    /// What lies between an end and the one that follows.
    between: BTreeMap<End, Vec<(Point, f64)>>,
}

impl Pairing {
    /// Pairs the branches of a graph. Branches that end free and are short are paired only where nothing else is: they are
    /// blots or overshoots, and lines do not turn into them.
    pub fn new(evidence: &Evidence) -> Self {
        let graph = evidence.graph;
        let count = graph.branches.len();
        let mut pairing = Self { next: vec![[None; 2]; count], shared: vec![false; count], between: BTreeMap::new() };
        pairing.cross(graph);
        for cluster in clusters(graph, evidence.stub) {
            pairing.decide(evidence, &cluster);
        }
        pairing.bridge(graph);
        pairing
    }

    /// The end that follows.
    pub fn next(&self, (branch, side): End) -> Option<End> {
        self.next[branch][side]
    }

    /// Whether a branch is a part of other strokes.
    pub fn is_shared(&self, branch: usize) -> bool {
        self.shared[branch]
    }

    /// Points between an end and the one that follows, with half the widths.
    pub fn between(&self, end: End) -> &[(Point, f64)] {
        self.between.get(&end).map_or(&[], Vec::as_slice)
    }

    /// Pairs the branches that leave a cluster of junctions.
    fn decide(&mut self, evidence: &Evidence, cluster: &Cluster) {
        let graph = evidence.graph;
        let open = |end: &&End| !self.shared[end.0] && self.next(**end).is_none();
        let ends: Vec<End> = cluster.ends.iter().filter(open).copied().collect();
        // Two ends that a crossing left over are no corner.
        if ends.len() == 2 && cluster.ends.len() > 2 {
            return;
        }
        if let Some((a, b, tail)) = corner::tip(graph, &ends, evidence.stub) {
            self.join(a, b);
            self.shared[tail.0] = true;
            self.put_between(a, b, vec![(corner::top(graph, tail), radius(graph, tail))]);
            return;
        }
        let long: Vec<End> = ends.iter().filter(|end| !is_stub(graph, end.0, evidence.stub)).copied().collect();
        let mut chosen = pairs(evidence, if long.len() > 1 { &long } else { &ends });
        chosen.extend(corner::touch(graph, &long, &chosen));
        for (a, b) in chosen {
            self.join(a, b);
            let way = cluster.way(graph, a, b);
            way.iter().for_each(|link| self.shared[link.0] = true);
            self.put_between(a, b, points(graph, &way));
        }
    }

    fn put_between(&mut self, a: End, b: End, mut points: Vec<(Point, f64)>) {
        if points.is_empty() {
            return;
        }
        self.between.insert(a, points.clone());
        points.reverse();
        self.between.insert(b, points);
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
            for side in (0..2).filter(|&side| free(branch, side) && !self.shared[k]) {
                let end = (k, side);
                let direction = if is_dot(branch) { Point::ZERO } else { outward(graph, end) };
                ends.push((end, place(graph, end), direction, radius(graph, end)));
            }
        }
        ends.sort_by(|a, b| a.1.x.total_cmp(&b.1.x));
        let widest = ends.iter().map(|end| end.3).fold(0.0, f64::max);
        let mut found = Vec::new();
        for (i, a) in ends.iter().enumerate() {
            let near = |b: &&(End, Point, Point, f64)| b.1.x - a.1.x <= 2.0 * GAP_WIDTHS * widest + GAP_PIXELS;
            for b in ends[i + 1..].iter().take_while(near).filter(|b| b.0.0 != a.0.0) {
                // Two dots point nowhere: the eyes of a face are no line.
                if a.2 == Point::ZERO && b.2 == Point::ZERO {
                    continue;
                }
                let way = b.1 - a.1;
                let reach = gap(2.0 * a.3.min(b.3)) + (a.3 - b.3).abs();
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

/// The longest gap of a pen between the middles of lines of this width, which is joined.
pub fn gap(width: f64) -> f64 {
    (GAP_WIDTHS + 1.0) * width + GAP_PIXELS
}

/// Whether a branch ends free and is short.
fn is_stub(graph: &Graph, branch: usize, most: f64) -> bool {
    let branch = &graph.branches[branch];
    branch.ends.contains(&None) && !branch.closed && polyline::length(&branch.points, false) < most
}

/// Whether a branch is a mark that is hardly longer than broad. The direction of its skeleton is that of its grain.
fn is_dot(branch: &Branch) -> bool {
    let radius = branch.radii.iter().copied().fold(0.0, f64::max);
    branch.ends == [None; 2] && polyline::length(&branch.points, false) < radius + 1.0
}

/// The pairs of ends that meet.
fn pairs(evidence: &Evidence, ends: &[End]) -> Vec<(End, End)> {
    // A corner.
    if let [a, b] = ends[..] {
        return vec![(a, b)];
    }
    let Evidence { graph, outside, colours, .. } = *evidence;
    let directions: Vec<(Point, f64)> = ends.iter().map(|&end| (outward(graph, end), radius(graph, end))).collect();
    let cost = |i: usize, j: usize| {
        let ((a, r), (b, s)) = (directions[i], directions[j]);
        let width = 2.0 * r.max(s);
        let way = place(graph, ends[j]) - place(graph, ends[i]);
        // Near to each other, the way between both says little about a direction.
        let far = (way.length() / width - FAR).clamp(0.0, 1.0);
        let turn = angle(a, -b);
        let turn = turn + far * (angle(a, way) + angle(b, -way) - turn).max(0.0);
        let around = match <&[End; 3]>::try_from(ends) {
            Ok(three) if outside.is_beside(graph, three, [i, j], BESIDE * width) => AROUND,
            _ => 0.0,
        };
        let colour = COLOUR * hues(colours[ends[i].0], colours[ends[j].0]);
        turn + around + WIDTH * (r / s).ln().abs() + colour - 2.0 * END
    };
    let chosen = if ends.len() <= MOST {
        best(&(0..ends.len()).collect::<Vec<_>>(), &cost).1
    } else {
        greedy(ends.len(), &cost)
    };
    chosen.into_iter().map(|(i, j)| (ends[i], ends[j])).collect()
}

/// How far apart the hues of two colours are: 0 for greys, 1 for red and cyan. A pencil line gets lighter and darker, but
/// not red.
fn hues(a: Colour, b: Colour) -> f64 {
    let hue = |colour: Colour| colour.map(|value| value - (colour[0] + colour[1] + colour[2]) / 3.0);
    let (a, b) = (hue(a), hue(b));
    f64::from((0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max))
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
