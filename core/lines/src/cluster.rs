//! Junctions that hang together by links too short to be lines: one decision is made for all of them.
//!
//! Where several lines meet, the skeleton seldom has one fork. It has several, with links of a pixel or two between them,
//! and such links have no direction of their own. So junctions joined by links that nobody would draw are a cluster. The
//! branches that leave it are paired with each other ([`crate::pairing`]), and the way from one to the other leads through
//! the links.

use crate::direction::End;
use crate::graph::{Branch, Graph};
use rototoon_base::geometry::{Point, polyline};
use std::collections::BTreeMap;

/// Junctions that are decided together.
#[derive(Clone, Debug, Default)]
pub struct Cluster {
    /// The ends of branches that leave it.
    pub ends: Vec<End>,
    /// Branches within it.
    pub links: Vec<usize>,
}

/// The clusters of a graph. Links are branches between junctions, shorter than `stub` pixels.
pub fn clusters(graph: &Graph, stub: f64) -> Vec<Cluster> {
    let is_link: Vec<bool> = graph.branches.iter().map(|branch| is_link(branch, stub)).collect();
    let mut parent: Vec<usize> = (0..graph.junctions.len()).collect();
    for branch in graph.branches.iter().zip(&is_link).filter(|(_, is_link)| **is_link).map(|(branch, _)| branch) {
        if let [Some(a), Some(b)] = branch.ends {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut found: BTreeMap<usize, Cluster> = BTreeMap::new();
    for (k, junction) in graph.junctions.iter().enumerate() {
        let cluster = found.entry(root(&mut parent, k)).or_default();
        for &end in &junction.branches {
            if !is_link[end.0] {
                cluster.ends.push(end);
            } else if end.1 == 0 {
                cluster.links.push(end.0);
            }
        }
    }
    found.into_values().collect()
}

fn is_link(branch: &Branch, stub: f64) -> bool {
    !branch.closed && branch.ends.iter().all(Option::is_some) && polyline::length(&branch.points, false) < stub
}

fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

impl Cluster {
    /// The shortest way through the links from one end to another: each link with the side at which it is entered.
    pub fn way(&self, graph: &Graph, from: End, to: End) -> Vec<End> {
        let junction = |end: End| graph.branches[end.0].ends[end.1];
        let (Some(start), Some(goal)) = (junction(from), junction(to)) else { return Vec::new() };
        let mut least: BTreeMap<usize, (f64, Vec<End>)> = BTreeMap::from([(start, (0.0, Vec::new()))]);
        // Clusters are small: ways are made shorter until none becomes so.
        loop {
            let mut changed = false;
            for &link in &self.links {
                for side in 0..2 {
                    let (Some(here), Some(there)) = (junction((link, side)), junction((link, 1 - side))) else {
                        continue;
                    };
                    let Some((far, way)) = least.get(&here) else { continue };
                    let step = graph.junctions[here].place.distance(graph.junctions[there].place);
                    if least.get(&there).is_none_or(|known| far + step < known.0 - 1e-9) {
                        let longer = (far + step, way.iter().copied().chain([(link, side)]).collect());
                        least.insert(there, longer);
                        changed = true;
                    }
                }
            }
            if !changed {
                break;
            }
        }
        least.remove(&goal).map(|(_, way)| way).unwrap_or_default()
    }
}

/// The points of a way, with half the widths.
pub fn points(graph: &Graph, way: &[End]) -> Vec<(Point, f64)> {
    let mut out = Vec::new();
    for &(link, side) in way {
        let branch = &graph.branches[link];
        let mut own: Vec<(Point, f64)> = branch.points.iter().copied().zip(branch.radii.iter().copied()).collect();
        if side == 1 {
            own.reverse();
        }
        out.extend(own);
    }
    out
}
