//! Pegs found from strokes that moved: rigid groups, and the hinges between them.
//!
//! Each stroke and each pair of neighbouring keys keeps the sums from which a least-squares similarity follows
//! ([`rototoon_base::geometry::similarity`]). The sums of two groups add up to the sums of both together, so the residual of a
//! joint movement is cheap to compute. The search begins with single strokes. It repeatedly joins the two groups whose
//! joint movement explains both best. It ends when every join would leave more than a small share of their size
//! unexplained.
//!
//! The largest group is the root, and every other group hangs on one to which it stays near, as a tree ([`tree`]). A group that no
//! two neighbouring keys have hangs on the nearest one whose movement is known, so that it goes with what is around it. If a group
//! turns relative to its parent, its hinge is the fixed point of this relative turn, provided that the point is near
//! the strokes of both. Otherwise the hinge is the place where the two groups meet, or the middle of the group if they
//! are far apart. A group that the turn of its parent would carry far off its own way does not hang on it: a shadow that
//! lies still does not swing with the leg above it.
//!
//! Limits: among few strokes, those that happen to move alike become one group, however far apart they are. With more
//! than [`ALL_PAIRS`] strokes only near ones are joined.

use super::{Peg, PegKey, PegTree, Timing, tree};
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polyline};
use std::collections::{BTreeSet, BinaryHeap};

/// Number of samples of a stroke.
const SAMPLES: usize = 16;
/// Up to this number of strokes, any two may be joined.
pub const ALL_PAIRS: usize = 200;
/// Number of neighbours with which a stroke may be joined in larger drawings.
const NEAREST: usize = 8;
/// Number of nearest groups that are tried as a parent.
const PARENTS: usize = 16;
/// A group carries what is up to this share's inverse longer than itself.
const CARRIES: f64 = 0.25;
/// Largest number of samples of a group from which its distance from others is computed.
const MOST_PLACES: usize = 640;
/// Root mean square, in pixels, that a join may always leave unexplained.
const LEAST_TOLERANCE: f64 = 1.0;
/// Root mean square that a join may leave unexplained, as a share of the smaller group's radius.
const TOLERANCE: f64 = 0.06;
/// Smallest turn, in radians, that shows a hinge.
const HINGE_TURN: f64 = 0.1;
/// Largest distance of a hinge from the strokes of the two groups, in radii of the child.
const HINGE_REACH: f64 = 0.7;

/// Half way a group may be this far, in pixels and in shares of its own way, from the middle of that way.
const OFF_WAY: (f64, f64) = (2.0, 0.5);

/// A stroke on several keys. It has the same number of points on each key; `None` where it does not exist.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// Its points on each key, in pixels.
    pub places: &'a [Option<Vec<Point>>],
    /// Whether the last point joins the first.
    pub closed: bool,
}

/// Strokes that move together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Indices of the strokes, rising.
    pub members: Vec<usize>,
    /// Index of the group on which it hangs.
    pub parent: Option<usize>,
    /// Its hinge on the parent, or its middle, in pixels on the first key.
    pub pivot: Point,
}

/// The sums from which a least-squares similarity from places p to places q follows.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: f64,
    p: Point,
    q: Point,
    pq: Point,
    pp: f64,
    qq: f64,
}

impl Sums {
    fn of(from: &[Point], to: &[Point]) -> Self {
        let mut sums = Self::default();
        for (&p, &q) in from.iter().zip(to) {
            sums.count += 1.0;
            sums.p += p;
            sums.q += q;
            sums.pq += Point::new(p.dot(q), p.perp_dot(q));
            sums.pp += p.length_squared();
            sums.qq += q.length_squared();
        }
        sums
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            p: self.p + other.p,
            q: self.q + other.q,
            pq: self.pq + other.pq,
            pp: self.pp + other.pp,
            qq: self.qq + other.qq,
        }
    }

    /// Centred sums of conj(p) q, |p|² and |q|².
    fn centred(&self) -> (Point, f64, f64) {
        let n = self.count.max(1.0);
        let pq = self.pq - Point::new(self.p.dot(self.q), self.p.perp_dot(self.q)) / n;
        (pq, (self.pp - self.p.length_squared() / n).max(0.0), (self.qq - self.q.length_squared() / n).max(0.0))
    }

    /// Sum of the squared distances that remain after the best similarity.
    fn unexplained(&self) -> f64 {
        let (pq, pp, qq) = self.centred();
        if pp > 1e-12 { (qq - pq.length_squared() / pp).max(0.0) } else { qq }
    }

    fn similarity(&self) -> Similarity {
        let (pq, pp, _) = self.centred();
        let n = self.count.max(1.0);
        Similarity { factor: if pp > 1e-12 { pq / pp } else { Point::X }, source: self.p / n, target: self.q / n }
    }

    fn radius(&self) -> f64 {
        (self.centred().1 / self.count.max(1.0)).sqrt()
    }
}

/// A group during the joining.
#[derive(Clone, Debug)]
struct Growing {
    members: Vec<usize>,
    /// One entry for each pair of neighbouring keys.
    sums: Vec<Sums>,
    neighbours: BTreeSet<usize>,
    length: f64,
}

impl Growing {
    fn radius(&self) -> f64 {
        self.sums.iter().find(|sums| sums.count > 0.0).map_or(0.0, Sums::radius)
    }

    /// Whether two neighbouring keys show its movement.
    fn moves(&self) -> bool {
        self.sums.iter().any(|sums| sums.count > 0.0)
    }

    /// Distance of a place from the group's samples, each stroke on the first key that has it.
    fn distance(&self, p: Point, samples: &[Vec<Option<Vec<Point>>>]) -> f64 {
        let places = self.members.iter().filter_map(|&i| samples[i].iter().flatten().next()).flatten();
        places.map(|q| q.distance(p)).fold(f64::INFINITY, f64::min)
    }
}

/// A possible join. `excess` is the share of the tolerance that it uses.
#[derive(PartialEq)]
struct Join {
    excess: f64,
    pair: (usize, usize),
}

impl Eq for Join {}
impl Ord for Join {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        // The heap returns the greatest element first, so the order is reversed.
        other.excess.total_cmp(&self.excess).then(other.pair.cmp(&self.pair))
    }
}
impl PartialOrd for Join {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// The groups of strokes that move rigidly together, as trees. Each parent comes before its children.
pub fn groups(strokes: &[Moving]) -> Vec<Group> {
    let samples: Vec<Vec<Option<Vec<Point>>>> = strokes.iter().map(sampled).collect();
    let keys = strokes.iter().map(|s| s.places.len()).max().unwrap_or(0);
    let mut all: Vec<Growing> = samples.iter().enumerate().map(|(i, s)| single(i, s, keys)).collect();
    link_neighbours(&mut all, &samples);
    join_all(&mut all);
    all.retain(|group| !group.members.is_empty());
    // Groups whose movement no drawing shows come last: they hang on those that move, however long they are.
    let order = |a: &Growing, b: &Growing| {
        let longer = b.length.total_cmp(&a.length).then(a.members[0].cmp(&b.members[0]));
        b.moves().cmp(&a.moves()).then(longer)
    };
    all.sort_by(order);
    hung(&all, &samples)
}

fn sampled(stroke: &Moving) -> Vec<Option<Vec<Point>>> {
    // Samples are taken by index, not by length, so they are the same points on every key.
    let pick = |points: &Vec<Point>| {
        let n = points.len();
        (0..SAMPLES).filter_map(|k| points.get(if n < 2 { 0 } else { k * (n - 1) / (SAMPLES - 1) }).copied()).collect()
    };
    stroke.places.iter().map(|places| places.as_ref().map(pick)).collect()
}

fn single(i: usize, samples: &[Option<Vec<Point>>], keys: usize) -> Growing {
    let both = |k: usize| match (samples.get(k), samples.get(k + 1)) {
        (Some(Some(a)), Some(Some(b))) => Sums::of(a, b),
        _ => Sums::default(),
    };
    let sums = (0..keys.saturating_sub(1)).map(both).collect();
    let length = samples.iter().flatten().next().map_or(0.0, |points| polyline::length(points, false));
    Growing { members: vec![i], sums, neighbours: BTreeSet::new(), length }
}

fn middle(samples: &[Option<Vec<Point>>]) -> Point {
    samples.iter().flatten().next().map_or(Point::ZERO, |points| rototoon_base::geometry::polygon::center(points))
}

fn link_neighbours(all: &mut [Growing], samples: &[Vec<Option<Vec<Point>>>]) {
    let n = all.len();
    if n <= ALL_PAIRS {
        all.iter_mut().enumerate().for_each(|(i, group)| group.neighbours = (0..n).filter(|&j| j != i).collect());
        return;
    }
    let centres: Vec<Point> = samples.iter().map(|s| middle(s)).collect();
    let grid = super::super::grid::Grid::new(&centres);
    for i in 0..n {
        for j in grid.nearest(centres[i], NEAREST + 1).into_iter().filter(|&j| j != i) {
            all[i].neighbours.insert(j);
            all[j].neighbours.insert(i);
        }
    }
}

/// The unexplained root mean square of a join relative to the tolerance, on the worst pair of keys. `None` where the
/// groups share no pair of keys.
fn excess(a: &Growing, b: &Growing) -> Option<f64> {
    let spans = a.sums.iter().zip(&b.sums).filter(|(x, y)| x.count > 0.0 && y.count > 0.0);
    let of = |(x, y): (&Sums, &Sums)| {
        let both = x.with(y);
        let more = (both.unexplained() - x.unexplained() - y.unexplained()).max(0.0) / x.count.min(y.count);
        let tolerance = LEAST_TOLERANCE.max(TOLERANCE * x.radius().min(y.radius()));
        more.sqrt() / tolerance
    };
    spans.map(of).reduce(f64::max)
}

fn join_all(all: &mut [Growing]) {
    let mut heap = BinaryHeap::new();
    let offer = |heap: &mut BinaryHeap<Join>, all: &[Growing], i: usize, j: usize| {
        if let Some(excess) = excess(&all[i], &all[j]).filter(|&e| e <= 1.0) {
            heap.push(Join { excess, pair: (i.min(j), i.max(j)) });
        }
    };
    for i in 0..all.len() {
        all[i].neighbours.clone().into_iter().filter(|&j| j > i).for_each(|j| offer(&mut heap, all, i, j));
    }
    while let Some(Join { excess: offered, pair: (i, j) }) = heap.pop() {
        let alive = !all[i].members.is_empty() && !all[j].members.is_empty();
        if !alive || excess(&all[i], &all[j]) != Some(offered) {
            continue;
        }
        let gone = std::mem::replace(
            &mut all[j],
            Growing { members: Vec::new(), sums: Vec::new(), neighbours: BTreeSet::new(), length: 0.0 },
        );
        all[i].members.extend(gone.members);
        all[i].members.sort_unstable();
        all[i].length += gone.length;
        all[i].sums.iter_mut().zip(&gone.sums).for_each(|(a, b)| *a = a.with(b));
        for k in gone.neighbours {
            all[k].neighbours.remove(&j);
            if k != i {
                all[k].neighbours.insert(i);
                all[i].neighbours.insert(k);
            }
        }
        all[i].neighbours.remove(&j);
        all[i].neighbours.clone().into_iter().for_each(|k| offer(&mut heap, all, i, k));
    }
}

/// The place where two groups are nearest on a key, with their distance.
fn meeting(a: &[usize], b: &[usize], samples: &[Vec<Option<Vec<Point>>>], key: usize) -> Option<(f64, Point)> {
    let places = |members: &[usize]| -> Vec<Point> {
        let step = (members.len() * SAMPLES).div_ceil(MOST_PLACES);
        members.iter().filter_map(|&i| samples[i].get(key)?.as_ref()).flatten().copied().step_by(step).collect()
    };
    let (a, b) = (places(a), places(b));
    let mut best: Option<(f64, Point)> = None;
    for &p in &a {
        for &q in &b {
            let d = p.distance_squared(q);
            if best.is_none_or(|(least, _)| d < least) {
                best = Some((d, p.midpoint(q)));
            }
        }
    }
    best.map(|(d, place)| (d.sqrt(), place))
}

/// Makes groups hang on each other, as a tree that begins with the first of them.
fn hung(all: &[Growing], samples: &[Vec<Option<Vec<Point>>>]) -> Vec<Group> {
    let keys = samples.iter().map(Vec::len).max().unwrap_or(0);
    let middles: Vec<Point> = all
        .iter()
        .map(|g| g.members.iter().map(|&i| middle(&samples[i])).sum::<Point>() / g.members.len() as f64)
        .collect();
    let grid = super::super::grid::Grid::new(&middles);
    let near: Vec<Vec<usize>> = middles.iter().map(|middle| grid.nearest(*middle, PARENTS + 1)).collect();
    // What no drawing shows moving hangs on what moves, however long it is.
    let some_move = all.iter().any(Growing::moves);
    let carries = |parent: usize, child: usize| {
        let (parent, child) = (&all[parent], &all[child]);
        if child.moves() {
            parent.moves() && parent.length >= CARRIES * child.length
        } else {
            parent.moves() || !some_move
        }
    };
    let meets = |a: usize, b: usize| -> Option<(f64, Point)> {
        let met: Vec<(f64, Point)> =
            (0..keys).filter_map(|key| meeting(&all[a].members, &all[b].members, samples, key)).collect();
        Some((met.iter().map(|met| met.0).reduce(f64::max)?, met.first()?.1))
    };
    let grown = tree::grown(all.len(), &near, carries, meets);
    let mut place = vec![0; all.len()];
    grown.iter().enumerate().for_each(|(k, &(g, _))| place[g] = k);
    let group = |(g, on): tree::Hanging| {
        let group = &all[g];
        let on = on.filter(|&(parent, _)| !group.moves() || goes_along(group, &all[parent]));
        let pivot = on.map_or(middles[g], |(parent, (gap, place))| {
            let reach = HINGE_REACH * group.radius().max(1.0);
            let on_both = |p: Point| [group, &all[parent]].into_iter().all(|g| g.distance(p, samples) <= reach + gap);
            hinge(group, &all[parent]).filter(|&p| on_both(p)).unwrap_or(if gap <= reach { place } else { middles[g] })
        });
        Group { members: group.members.clone(), parent: on.map(|on| place[on.0]), pivot }
    };
    grown.into_iter().map(group).collect()
}

/// Whether a group stays near its own way if it hangs on a parent, between all neighbouring keys that show both. Half way
/// the parent has turned by half, and the group's middle is half way between its places in the parent's frame.
fn goes_along(child: &Growing, parent: &Growing) -> bool {
    let mut spans = child.sums.iter().zip(&parent.sums).filter(|(own, on)| own.count > 0.0 && on.count > 0.0);
    spans.all(|(own, on)| {
        let (own, on) = (own.similarity(), on.similarity());
        let (from, to) = (own.source, own.target);
        let local = from.midpoint(on.inverse().apply(to)) - on.source;
        let half = Point::from_angle(0.5 * on.angle()) * on.scale().sqrt();
        let hung = on.source.midpoint(on.target) + half.rotate(local);
        hung.distance(from.midpoint(to)) <= OFF_WAY.0 + OFF_WAY.1 * from.distance(to)
    })
}

/// The fixed point of a group's turn relative to its parent.
fn hinge(child: &Growing, parent: &Growing) -> Option<Point> {
    let (own, on) = child.sums.iter().zip(&parent.sums).find(|(a, b)| a.count > 0.0 && b.count > 0.0)?;
    let relative = on.similarity().inverse().after(&own.similarity());
    if relative.angle().abs() < HINGE_TURN { None } else { relative.fixed_point() }
}

/// Turns groups into pegs with keys on the frames of the drawings. On the first key all pegs are at rest.
pub fn pegs(strokes: &[Moving], frames: &[i32], groups: &[Group], timing: &Timing) -> Vec<Peg> {
    let samples: Vec<Vec<Option<Vec<Point>>>> = strokes.iter().map(sampled).collect();
    let mut worlds: Vec<Vec<(Similarity, f64)>> = Vec::new();
    for group in groups {
        let mut map = (Similarity::IDENTITY, 0.0);
        let mut by_key = vec![map];
        for k in 1..frames.len() {
            let mut sums = Sums::default();
            for &i in &group.members {
                if let (Some(Some(a)), Some(Some(b))) = (samples[i].get(k - 1), samples[i].get(k)) {
                    sums = sums.with(&Sums::of(a, b));
                }
            }
            if sums.count > 0.0 {
                let step = bounded(sums.similarity());
                map = (step.after(&map.0), map.1 + step.angle());
            }
            by_key.push(map);
        }
        worlds.push(by_key);
    }
    let peg = |(g, group): (usize, &Group)| {
        let key = |(k, &frame): (usize, &i32)| {
            let (own, turn) = worlds[g][k];
            let (on, on_turn) = group.parent.map_or((Similarity::IDENTITY, 0.0), |parent| worlds[parent][k]);
            let local = on.inverse().after(&own);
            let shift = local.apply(group.pivot) - group.pivot;
            PegKey { frame, shift, turn: turn - on_turn, scale: local.scale(), timing: timing.clone() }
        };
        let keys = frames.iter().enumerate().map(key).collect();
        Peg { name: format!("group {}", g + 1), parent: group.parent, pivot: group.pivot, keys }
    };
    groups.iter().enumerate().map(peg).collect()
}

/// The similarity with its scale limited to 1/20 to 20.
fn bounded(mut map: Similarity) -> Similarity {
    const MOST: f64 = 20.0;
    let scale = map.scale();
    map.factor = if scale > 1e-9 { map.factor * (scale.clamp(1.0 / MOST, MOST) / scale) } else { Point::X };
    map
}

/// The pegs of strokes on several drawings. See [`groups`] and [`pegs`].
pub fn proposed(strokes: &[Moving], frames: &[i32], timing: &Timing) -> PegTree {
    PegTree::new(pegs(strokes, frames, &groups(strokes), timing)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bone(from: Point, angle: f64, length: f64) -> Vec<Point> {
        let along = Point::from_angle(angle);
        (0..12)
            .map(|k| from + along * (length * k as f64 / 11.0) + along.perp() * (k as f64 * 0.7).sin() * 2.0)
            .collect()
    }

    /// A body of three strokes and an arm of two bones in a pose.
    fn pose(shift: Point, arm: f64, hand: f64) -> Vec<Vec<Point>> {
        let (shoulder, reach) = (Point::new(40.0, 0.0) + shift, 50.0);
        let elbow = shoulder + Point::from_angle(arm) * reach;
        vec![
            bone(shift, 0.0, 80.0),
            bone(shift, 1.5, 90.0),
            bone(Point::new(80.0, 0.0) + shift, 1.6, 90.0),
            bone(shoulder, arm, reach),
            bone(elbow, arm + hand, 35.0),
        ]
    }

    #[test]
    fn rigid_groups_and_their_hinges_are_found() {
        let keys = [pose(Point::ZERO, 0.3, 0.2), pose(Point::new(12.0, -5.0), 1.1, 1.0)];
        let places: Vec<Vec<Option<Vec<Point>>>> =
            (0..5).map(|i| keys.iter().map(|key| Some(key[i].clone())).collect()).collect();
        let strokes: Vec<Moving> = places.iter().map(|places| Moving { places, closed: false }).collect();
        let found = groups(&strokes);
        let members: Vec<_> = found.iter().map(|g| g.members.clone()).collect();
        assert_eq!(members, [vec![0, 1, 2], vec![3], vec![4]]);
        assert_eq!(found.iter().map(|g| g.parent).collect::<Vec<_>>(), [None, Some(0), Some(1)]);
        let shoulder = Point::new(40.0, 0.0);
        assert!(found[1].pivot.distance(shoulder) < 0.5, "{:?}", found[1]);
        assert!(found[2].pivot.distance(shoulder + Point::from_angle(0.3) * 50.0) < 0.5, "{:?}", found[2]);
        let tree = proposed(&strokes, &[10, 18], &Timing::Linear);
        let maps = tree.at(18.0);
        for (g, group) in found.iter().enumerate() {
            for &i in &group.members {
                for (p, q) in keys[0][i].iter().zip(&keys[1][i]) {
                    assert!(maps[g].apply(*p).distance(*q) < 0.2, "{g} {i}");
                }
            }
        }
        // Half way, the elbow is at the end of the half-turned arm.
        let half = tree.at(14.0)[1].apply(shoulder + Point::from_angle(0.3) * 50.0);
        let expected = shoulder + Point::new(6.0, -2.5) + Point::from_angle(0.7) * 50.0;
        assert!(half.distance(expected) < 0.5, "{half} {expected}");
    }

    #[test]
    fn strokes_that_are_not_there_or_are_points() {
        let places: [Vec<Option<Vec<Point>>>; 4] = [
            vec![Some(vec![Point::ONE]); 2],
            vec![None, Some(vec![Point::X])],
            vec![None, None],
            vec![Some(vec![]); 2],
        ];
        let strokes: Vec<Moving> = places.iter().map(|places| Moving { places, closed: true }).collect();
        let members: usize = groups(&strokes).iter().map(|g| g.members.len()).sum();
        assert_eq!(members, 4);
        assert_eq!(proposed(&strokes, &[0, 1], &Timing::Linear).at(0.5).len(), groups(&strokes).len());
        assert!(groups(&[]).is_empty());
    }
}
