//! Which forks of a skeleton are one junction, and which chains are spurs.
//!
//! Two forks joined by a chain are one junction if the chain is covered by the discs of ink around them: the lines that
//! meet there have not parted yet.

use super::skeleton::{Chain, Skeleton};
use super::{Junction, SPUR, SPUR_PIXELS};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use std::collections::BTreeMap;

/// Share of the sum of the two radii that a chain may be longer.
const REACH: f64 = 1.1;
/// Forks nearer than this are one junction, in pixels.
const TOUCH: f64 = 2.0;

/// The forks of a skeleton in groups.
pub(super) struct Contracted {
    /// The group of each fork.
    group: BTreeMap<u32, usize>,
    place: Vec<Point>,
    radius: Vec<f64>,
}

impl Contracted {
    pub fn new(skeleton: &Skeleton, chains: &[Chain], depth: &Raster<f32>) -> Self {
        let mut degree: BTreeMap<u32, usize> = BTreeMap::new();
        for chain in chains.iter().filter(|chain| !chain.closed && chain.pixels.len() > 1) {
            for pixel in [chain.pixels[0], chain.pixels[chain.pixels.len() - 1]] {
                *degree.entry(pixel).or_default() += 1;
            }
        }
        let forks: Vec<u32> = degree.iter().filter(|&(_, &degree)| degree > 1).map(|(&pixel, _)| pixel).collect();
        let index: BTreeMap<u32, usize> = forks.iter().enumerate().map(|(k, &pixel)| (pixel, k)).collect();
        let at = |pixel: u32| skeleton.pixels[pixel as usize];
        let point = |pixel: u32| Point::new(at(pixel).0 as f64 + 0.5, at(pixel).1 as f64 + 0.5);
        let radius = |pixel: u32| f64::from(depth.get(at(pixel).0, at(pixel).1));
        let mut parent: Vec<usize> = (0..forks.len()).collect();
        for chain in chains.iter().filter(|chain| !chain.closed) {
            let (a, b) = (chain.pixels[0], chain.pixels[chain.pixels.len() - 1]);
            let (Some(&i), Some(&j)) = (index.get(&a), index.get(&b)) else { continue };
            let length = length(skeleton, chain);
            if i != j && length <= (REACH * (radius(a) + radius(b)) - 1.0).max(TOUCH) {
                let (i, j) = (find(&mut parent, i), find(&mut parent, j));
                parent[i.max(j)] = i.min(j);
            }
        }
        let mut groups: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for (k, &fork) in forks.iter().enumerate() {
            groups.entry(find(&mut parent, k)).or_default().push(fork);
        }
        let mut found = Self { group: BTreeMap::new(), place: Vec::new(), radius: Vec::new() };
        for (k, members) in groups.into_values().enumerate() {
            let centre = members.iter().map(|&fork| point(fork)).sum::<Point>() / members.len() as f64;
            let reach = members.iter().map(|&fork| radius(fork) + point(fork).distance(centre)).fold(0.0, f64::max);
            found.place.push(centre);
            found.radius.push(reach);
            for fork in members {
                found.group.insert(fork, k);
            }
        }
        found
    }

    /// Whether a chain lies within one junction.
    pub fn is_inner(&self, chain: &Chain) -> bool {
        let [Some(a), Some(b)] = self.ends(chain) else { return false };
        !chain.closed && a == b && (chain.pixels.len() as f64) < 2.0 * self.radius[a] + 2.0
    }

    /// Whether a chain with one free end is a bump of a line's edge.
    pub fn is_spur(&self, chain: &Chain) -> bool {
        let junction = match self.ends(chain) {
            [Some(junction), None] | [None, Some(junction)] => junction,
            _ => return false,
        };
        !chain.closed && chain.pixels.len() as f64 - 1.0 <= SPUR * self.radius[junction] + SPUR_PIXELS
    }

    /// The junctions at both ends.
    pub fn ends(&self, chain: &Chain) -> [Option<usize>; 2] {
        [0, chain.pixels.len() - 1].map(|k| self.group.get(&chain.pixels[k]).copied())
    }

    /// All junctions, without branches.
    pub fn junctions(&self) -> Vec<Junction> {
        let all = self.place.iter().zip(&self.radius);
        all.map(|(&place, &radius)| Junction { place, radius, branches: Vec::new() }).collect()
    }

    /// The centre of a pixel, and half the width of the ink there.
    pub fn place(&self, skeleton: &Skeleton, pixel: u32, depth: &Raster<f32>) -> (Point, f64) {
        let (x, y) = skeleton.pixels[pixel as usize];
        (Point::new(x as f64 + 0.5, y as f64 + 0.5), (f64::from(depth.get(x, y)) - 0.5).max(0.5))
    }
}

fn length(skeleton: &Skeleton, chain: &Chain) -> f64 {
    let at = |k: usize| skeleton.pixels[chain.pixels[k] as usize];
    let diagonal = |k: &usize| at(*k).0 != at(k - 1).0 && at(*k).1 != at(k - 1).1;
    let diagonals = (1..chain.pixels.len()).filter(diagonal).count();
    (chain.pixels.len() - 1) as f64 + diagonals as f64 * (std::f64::consts::SQRT_2 - 1.0)
}

fn find(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}
