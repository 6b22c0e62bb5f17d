//! The graph of a drawing: branches of ink between junctions.
//!
//! A skeleton tells where ink is, but not quite how lines meet. Where two lines cross, it has two forks with a short piece
//! between. Near a fork it bends towards the middle of the blot. A bump of the line's edge gives it a spur. Here
//!
//! - forks that lie in each other's blot become one junction (`contract`),
//! - spurs that do not leave the blot they grow from are dropped,
//! - branches end where they leave the blot of their junction; what lies within the blot is drawn later, when it is known
//!   which branch goes on in which ([`crate::pairing`]).
//!
//! The blot of a junction is the largest disc of ink around it.

mod contract;
mod skeleton;

use crate::ink::Ink;
use crate::thin::thinned;
use contract::Contracted;
use rototoon_base::geometry::{Point, polyline};
use skeleton::{Chain, Skeleton};

/// A spur is dropped if it is not longer than this many radii of its junction's blot, and [`SPUR_PIXELS`].
const SPUR: f64 = 1.5;
const SPUR_PIXELS: f64 = 1.5;

/// Ink between two junctions or ends.
#[derive(Clone, Debug)]
pub struct Branch {
    /// Centres of pixels.
    pub points: Vec<Point>,
    /// Half the width of the ink at each point.
    pub radii: Vec<f64>,
    /// The junctions at the first and at the last point; `None` for an end of the ink.
    pub ends: [Option<usize>; 2],
    /// Whether it is a ring.
    pub closed: bool,
    /// Whether it is the outline of a solid shape ([`crate::solid`]), not a line.
    pub fill: bool,
}

/// A place where branches meet.
#[derive(Clone, Debug)]
pub struct Junction {
    /// The middle of the blot.
    pub place: Point,
    /// Radius of the blot.
    pub radius: f64,
    /// The branches that end here, each with its side: 0 for the first point, 1 for the last.
    pub branches: Vec<(usize, usize)>,
}

/// The branches and junctions of a drawing.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// Branches.
    pub branches: Vec<Branch>,
    /// Junctions.
    pub junctions: Vec<Junction>,
}

impl Graph {
    /// The graph of a drawing's ink.
    pub fn new(ink: &Ink) -> Self {
        let skeleton = Skeleton::new(&thinned(&ink.mask));
        let mut chains = skeleton.chains();
        // Forks merge when a spur between them goes, so this is done until nothing changes.
        loop {
            let contracted = Contracted::new(&skeleton, &chains, &ink.depth);
            let before = chains.len();
            chains.retain(|chain| !contracted.is_spur(chain));
            if chains.len() == before {
                return Self::of(&skeleton, &chains, &contracted, ink);
            }
            chains = merged(chains);
        }
    }

    /// The usual width of lines in pixels: the middle one of all points.
    pub fn width(&self) -> f64 {
        let lines = self.branches.iter().filter(|branch| !branch.fill);
        let mut radii: Vec<f64> = lines.flat_map(|branch| branch.radii.iter().copied()).collect();
        radii.sort_unstable_by(f64::total_cmp);
        radii.get(radii.len() / 2).map_or(1.0, |radius| 2.0 * radius)
    }

    /// The length of all lines in pixels.
    pub fn length(&self) -> f64 {
        self.branches
            .iter()
            .filter(|branch| !branch.fill)
            .map(|branch| polyline::length(&branch.points, branch.closed))
            .sum()
    }

    /// Adds the outlines of solid shapes. What ends at a shape meets its outline.
    pub fn add_solids(&mut self, outlines: Vec<Vec<Point>>) {
        let branch = |points: Vec<Point>| Branch {
            radii: vec![0.5; points.len()],
            points,
            ends: [None; 2],
            closed: true,
            fill: true,
        };
        self.branches.extend(outlines.into_iter().map(branch));
    }

    fn of(skeleton: &Skeleton, chains: &[Chain], contracted: &Contracted, ink: &Ink) -> Self {
        let mut junctions: Vec<Junction> = contracted.junctions();
        let mut branches = Vec::new();
        for chain in chains.iter().filter(|chain| !contracted.is_inner(chain)) {
            let (mut points, mut radii): (Vec<Point>, Vec<f64>) =
                chain.pixels.iter().map(|&pixel| contracted.place(skeleton, pixel, &ink.depth)).unzip();
            let ends = if chain.closed { [None; 2] } else { contracted.ends(chain) };
            trim(&mut points, &mut radii, ends.map(|end| end.map(|j| &junctions[j])));
            for (side, junction) in ends.iter().enumerate() {
                if let Some(junction) = *junction {
                    junctions[junction].branches.push((branches.len(), side));
                }
            }
            branches.push(Branch { points, radii, ends, closed: chain.closed, fill: false });
        }
        Self { branches, junctions }
    }
}

/// Cuts what lies within the blots at both ends. At least the middle is left.
fn trim(points: &mut Vec<Point>, radii: &mut Vec<f64>, ends: [Option<&Junction>; 2]) {
    let within = |p: &Point, end: Option<&Junction>| end.is_some_and(|j| p.distance(j.place) < j.radius);
    let middle = points.len() / 2;
    let first = points[..middle].iter().take_while(|p| within(p, ends[0])).count();
    let last = points[middle + 1..].iter().rev().take_while(|p| within(p, ends[1])).count();
    let kept = first..points.len() - last;
    *points = points[kept.clone()].to_vec();
    *radii = radii[kept].to_vec();
}

/// Joins the chains at pixels where only two are left.
fn merged(chains: Vec<Chain>) -> Vec<Chain> {
    use std::collections::BTreeMap;
    let mut at: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (k, chain) in chains.iter().enumerate().filter(|(_, chain)| !chain.closed && chain.pixels.len() > 1) {
        for pixel in [chain.pixels[0], chain.pixels[chain.pixels.len() - 1]] {
            at.entry(pixel).or_default().push(k);
        }
    }
    let mut chains: Vec<Option<Chain>> = chains.into_iter().map(Some).collect();
    // `at` names a chain by its first index; a joined chain lives on at the index of its first part.
    let mut now: Vec<usize> = (0..chains.len()).collect();
    fn find(now: &[usize], mut k: usize) -> usize {
        while now[k] != k {
            k = now[k];
        }
        k
    }
    for (pixel, ends) in at {
        let [a, b] = ends[..] else { continue };
        let (a, b) = (find(&now, a), find(&now, b));
        if a == b {
            if let Some(chain) = chains[a].as_mut().filter(|chain| chain.pixels.len() > 3) {
                chain.pixels.pop();
                chain.closed = true;
            }
            continue;
        }
        let (Some(mut first), Some(mut second)) = (chains[a].take(), chains[b].take()) else { continue };
        if first.pixels.last() != Some(&pixel) {
            first.pixels.reverse();
        }
        if second.pixels[0] != pixel {
            second.pixels.reverse();
        }
        first.pixels.extend(second.pixels.drain(1..));
        chains[a] = Some(first);
        now[b] = a;
    }
    chains.into_iter().flatten().collect()
}
