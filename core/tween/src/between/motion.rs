//! The movement of groups of strokes from key to key.
//!
//! Least-squares similarities carry each group ([`super::super::peg::propose`]) from key to key. Their product from the
//! first key on is the pose of the group: its turn, the logarithm of its scale, and the place of its pivot. The pose of
//! a group that hangs on another one is relative to that one, so a limb turns about its joint while the body moves.
//!
//! Between keys the turn and the logarithm change evenly along the path. The pivot of a root moves along an arc: at
//! full strength, a body that turns by φ on its way from A to B goes round the fixed point of that movement. A drawing
//! seldom shows the true pivot, so the arc is weaker by default ([`super::Options::arcs`]). Where it does show it, the arc is full
//! (`joint`). Given pegs replace groups and move as given.

use super::super::angle::wrap;
use super::super::peg::PegTree;
use super::super::peg::propose::{Group, Moving};
use super::join::{Asked, Ends, Run, runs};
use super::joint;
use super::tracks::Track;
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon};

/// Smallest and largest scale from one key to the next.
const SCALES: (f64, f64) = (0.05, 20.0);

/// The given pegs, and for each track the peg on which it hangs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hung {
    pub tree: PegTree,
    pub pegs: Vec<Option<usize>>,
}

/// A pose relative to the parent: turn in radians, logarithm of the scale, place of the pivot in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    turn: f64,
    growth: f64,
    at: Point,
}

/// A group's movement.
#[derive(Clone, Debug, PartialEq)]
struct Mover {
    parent: Option<usize>,
    anchor: Point,
    /// Factor, in pixels, that makes turns and growths comparable with shifts.
    radius: f64,
    /// Pose on each key.
    poses: Vec<Pose>,
    /// Strength of the arc in each span.
    arcs: Vec<f64>,
    /// Progress in each span.
    runs: Vec<Run>,
}

/// The movements of all groups.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Motion {
    movers: Vec<Mover>,
    /// Indices of the groups, parents before children.
    order: Vec<usize>,
    /// The group or given peg that carries each track.
    pub carriers: Vec<Carrier>,
    tree: PegTree,
}

/// The group or given peg that carries a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Carrier {
    Group(usize),
    Peg(usize),
}

/// The places of each track on each key.
pub(super) fn by_key(tracks: &[Track], keys: usize) -> Vec<Vec<Option<Vec<Point>>>> {
    tracks.iter().map(|track| (0..keys).map(|k| track.points(k).cloned()).collect()).collect()
}

impl Motion {
    /// Fits the movements of the groups. `places` is by track and key.
    pub fn new(
        tracks: &[Track],
        places: &[Vec<Option<Vec<Point>>>],
        groups: &[Group],
        hung: &Hung,
        asked: &Asked,
        arcs: f64,
    ) -> Self {
        let moving: Vec<Moving> =
            tracks.iter().zip(places).map(|(t, places)| Moving { places, closed: t.closed }).collect();
        let keys = asked.corners.len();
        let mut carriers = vec![Carrier::Group(0); tracks.len()];
        for (g, group) in groups.iter().enumerate() {
            group.members.iter().for_each(|&i| carriers[i] = Carrier::Group(g));
        }
        for (carrier, peg) in carriers.iter_mut().zip(&hung.pegs) {
            if let Some(peg) = peg {
                *carrier = Carrier::Peg(*peg);
            }
        }
        let order = order(groups);
        let mut motion = Self { movers: Vec::new(), order, carriers, tree: hung.tree.clone() };
        motion.movers = poses(&moving, groups, keys, &motion.order, arcs);
        for g in 0..motion.movers.len() {
            let ends: Vec<_> = (0..keys.saturating_sub(1)).map(|k| Some(motion.ends(g, k))).collect();
            motion.movers[g].runs = runs(&ends, asked);
        }
        motion
    }

    /// The maps of the groups from the first key to `u` of span `k`, and the maps of the given pegs at a time in
    /// frames.
    pub fn maps(&self, k: usize, u: f64, time: f64) -> (Vec<Similarity>, Vec<Similarity>) {
        let mut maps = vec![Similarity::IDENTITY; self.movers.len()];
        for &g in &self.order {
            let mover = &self.movers[g];
            let pose = if mover.runs.is_empty() { mover.poses[0] } else { self.pose(g, k, u) };
            let own = pose.map(mover.anchor);
            maps[g] = mover.parent.map_or(own, |parent| maps[parent].after(&own));
        }
        (maps, self.tree.at(time))
    }

    /// Whether a track hangs on a given peg.
    pub fn on_given_peg(&self, track: usize) -> bool {
        matches!(self.carriers[track], Carrier::Peg(_))
    }

    /// The map of a track's carrier, out of those of [`Self::maps`].
    pub fn of_track(&self, track: usize, maps: &(Vec<Similarity>, Vec<Similarity>)) -> Similarity {
        match self.carriers[track] {
            Carrier::Group(g) => maps.0.get(g).copied().unwrap_or(Similarity::IDENTITY),
            Carrier::Peg(p) => maps.1.get(p).copied().unwrap_or(Similarity::IDENTITY),
        }
    }

    fn pose(&self, g: usize, k: usize, u: f64) -> Pose {
        let mover = &self.movers[g];
        let run = &mover.runs[k];
        let (a, b) = (&mover.poses[k], &mover.poses[k + 1]);
        let s = run.share(u);
        let beside = |i: usize| run.beside(i, u);
        Pose {
            turn: a.turn + s * (b.turn - a.turn) + beside(2) / mover.radius,
            growth: a.growth + s * (b.growth - a.growth) + beside(3) / mover.radius,
            at: self.arc(g, k, s) + Point::new(beside(0), beside(1)),
        }
    }

    /// The pivot along its arc in span `k`: A + (B − A) (e^(l s) − 1)/(e^l − 1) with l = growth + i turn.
    fn arc(&self, g: usize, k: usize, s: f64) -> Point {
        let mover = &self.movers[g];
        let (a, b) = (&mover.poses[k], &mover.poses[k + 1]);
        let l = Point::new(b.growth - a.growth, b.turn - a.turn) * mover.arcs[k];
        let way = b.at - a.at;
        let exp = |z: Point| Point::from_angle(z.y) * z.x.exp();
        let whole = exp(l) - Point::X;
        // A full turn has no fixed point. After almost none, the fixed point is too far away.
        if whole.length_squared() < 1e-6 {
            return a.at + way * s;
        }
        let part = exp(l * s) - Point::X;
        let share = Point::new(part.dot(whole), whole.perp_dot(part)) / whole.length_squared();
        a.at + share.rotate(way)
    }

    /// Derivatives of a group's path at both ends of a span.
    fn ends(&self, g: usize, k: usize) -> Ends {
        const STEP: f64 = 1e-5;
        let mover = &self.movers[g];
        let (a, b) = (&mover.poses[k], &mover.poses[k + 1]);
        let slope = |from: f64, to: f64| {
            let way = (self.arc(g, k, to) - self.arc(g, k, from)) / STEP;
            vec![way.x, way.y, mover.radius * (b.turn - a.turn), mover.radius * (b.growth - a.growth)]
        };
        Ends { start: slope(0.0, STEP), end: slope(1.0 - STEP, 1.0) }
    }
}

impl Pose {
    fn map(&self, anchor: Point) -> Similarity {
        Similarity { factor: Point::from_angle(self.turn) * self.growth.exp(), source: anchor, target: self.at }
    }
}

/// Indices of the groups, every parent before its children.
fn order(groups: &[Group]) -> Vec<usize> {
    let depth = |mut g: usize| {
        let mut depth = 0;
        while let Some(parent) = groups[g].parent.filter(|_| depth <= groups.len()) {
            g = parent;
            depth += 1;
        }
        depth
    };
    let mut order: Vec<usize> = (0..groups.len()).collect();
    order.sort_by_key(|&g| (depth(g), g));
    order
}

fn poses(strokes: &[Moving], groups: &[Group], keys: usize, order: &[usize], arcs: f64) -> Vec<Mover> {
    let worlds = worlds(strokes, groups, keys, order);
    let mover = |(g, group): (usize, &Group)| {
        let own: Vec<Point> = group
            .members
            .iter()
            .filter_map(|&i| strokes[i].places.iter().flatten().next())
            .flatten()
            .copied()
            .collect();
        let middle = polygon::center(&own);
        let square = own.iter().map(|p| p.distance_squared(middle)).sum::<f64>() / own.len().max(1) as f64;
        let anchor = if group.parent.is_some() { group.pivot } else { middle };
        let pose = |k: usize| {
            let (world, turn) = worlds[g][k];
            let (on, on_turn) = group.parent.map_or((Similarity::IDENTITY, 0.0), |parent| worlds[parent][k]);
            let local = on.inverse().after(&world);
            Pose { turn: turn - on_turn, growth: local.scale().max(1e-12).ln(), at: local.apply(anchor) }
        };
        let poses =
            (0..keys.max(1)).map(|k| if k < keys { pose(k) } else { Pose { turn: 0.0, growth: 0.0, at: anchor } });
        let strength = |k: usize| {
            let step = |g: usize| worlds[g][k + 1].0.after(&worlds[g][k].0.inverse());
            let against = group.parent.map_or(Similarity::IDENTITY, |parent| step(parent).inverse());
            match group.parent {
                _ if joint::is_about(&against.after(&step(g)), g, k, groups, strokes) => 1.0,
                // A group whose pivot is its hinge moves straight in its parent's frame.
                Some(_) => 0.0,
                None => arcs,
            }
        };
        let arcs = (0..keys.saturating_sub(1)).map(strength).collect();
        let (poses, runs) = (poses.collect(), Vec::new());
        Mover { parent: group.parent, anchor, radius: square.sqrt().max(1.0), poses, arcs, runs }
    };
    groups.iter().enumerate().map(mover).collect()
}

/// The movement of each group from the first key to each key, with its total turn.
fn worlds(strokes: &[Moving], groups: &[Group], keys: usize, order: &[usize]) -> Vec<Vec<(Similarity, f64)>> {
    let places = |group: &Group, k: usize, both: usize| -> Vec<Point> {
        let there = |&&i: &&usize| strokes[i].places[k].is_some() && strokes[i].places[both].is_some();
        group.members.iter().filter(there).filter_map(|&i| strokes[i].places[k].clone()).flatten().collect()
    };
    let mut worlds: Vec<Vec<(Similarity, f64)>> = vec![Vec::new(); groups.len()];
    for &g in order {
        let group = &groups[g];
        let mut by_key = vec![(Similarity::IDENTITY, 0.0)];
        for k in 1..keys {
            let (from, to) = (places(group, k - 1, k), places(group, k, k - 1));
            let (last, turn) = by_key[k - 1];
            let on = group.parent.map(|parent| (worlds[parent][k - 1], worlds[parent][k]));
            by_key.push(if from.is_empty() {
                // No stroke shows the movement, so the group moves with its parent.
                on.map_or((last, turn), |(before, after)| {
                    (after.0.after(&before.0.inverse()).after(&last), turn + after.1 - before.1)
                })
            } else {
                let step = bounded(Similarity::fit(&from, &to));
                let carried = on.map_or(0.0, |(before, after)| after.1 - before.1);
                // The shorter way round as the parent sees it: where a body turns by 170°, a mouth on it that was drawn at 181° does
                // not go round the other way.
                (step.after(&last), turn + carried + wrap(step.angle() - carried))
            });
        }
        worlds[g] = by_key;
    }
    worlds
}

/// The similarity with its scale limited to [`SCALES`].
fn bounded(mut map: Similarity) -> Similarity {
    let scale = map.scale();
    map.factor = if scale > 1e-9 { map.factor * (scale.clamp(SCALES.0, SCALES.1) / scale) } else { Point::X };
    map
}
