//! Joints: parts that are connected stay together at a hinge, a place that both parts carry along.
//!
//! Between two keys each part has a motion of its own: its lattice moved from one contour to the other. In the overlap
//! of two parts, the place that both motions take to nearly the same spot is their joint. For a limb that rotates
//! against the body it is the pivot. For parts that move alike every place of the overlap fits, and the place nearest
//! to the middle is taken. Hypotheses that tear a joint cost more than hypotheses that keep it. The cost has an upper
//! limit, because the joint is a guess.
//!
//! Limit: a joint is found only between parts that are keyed on the same frames.

use super::contender::Contender;
use crate::rototoon::lattice::mesh::Binding;
use rototoon_base::geometry::{Point, polygon, polyline};

/// A place within this distance of a part's contour still belongs to the part, in working pixels.
const MARGIN: f64 = 6.0;
/// Cost of a joint that is torn by [`TORN`] working pixels or more. Below that the cost is proportional.
const COST_OF_TORN: f64 = 0.06;
const TORN: f64 = 25.0;

/// A joint between two contenders.
pub struct Tie {
    /// Indices of the contenders.
    pub parts: [usize; 2],
    /// The hinge in the lattice of each model (second index) of each part (first index).
    bindings: [[Binding; 2]; 2],
}

impl Tie {
    /// The contender at the other end of the joint, and the end (0 or 1) at which `c` is. `None` if the joint is not
    /// one of `c`.
    pub fn other(&self, c: usize) -> Option<(usize, usize)> {
        let end = self.parts.iter().position(|&p| p == c)?;
        Some((self.parts[1 - end], end))
    }

    /// Where a pose of contender `c` puts the hinge, in working pixels. `nodes` are the nodes of the pose.
    pub fn place(&self, c: usize, model: usize, nodes: &[Point]) -> Option<Point> {
        let (_, end) = self.other(c)?;
        Some(self.bindings[end][model].at(nodes))
    }

    /// Cost of a joint whose two ends are at these places, in working pixels.
    pub fn cost(a: Point, b: Point) -> f64 {
        COST_OF_TORN * (a.distance(b) / TORN).min(1.0)
    }
}

/// The joints of all contenders: for each part the joint that fits best.
pub fn find(contenders: &[Contender]) -> Vec<Tie> {
    let mut ties: Vec<Tie> = Vec::new();
    for c in 0..contenders.len() {
        let hinge = |b: usize| hinge(&contenders[c], &contenders[b]).map(|(tear, places)| (tear, b, places));
        let others = (0..contenders.len()).filter(|&b| b != c && contenders[b].span == contenders[c].span);
        let Some((_, b, places)) = others.filter_map(hinge).min_by(|x, y| x.0.total_cmp(&y.0)) else { continue };
        if ties.iter().any(|t| t.parts == [b, c]) {
            continue;
        }
        let bind = |of: usize| [0, 1].map(|m: usize| contenders[of].models[m].texture.mesh.bind(places[m]));
        ties.push(Tie { parts: [c, b], bindings: [bind(c), bind(b)] });
    }
    ties
}

/// The place at both keys where two parts are joined, and a score that is smaller for a better joint.
fn hinge(a: &Contender, b: &Contender) -> Option<(f64, [Point; 2])> {
    let (mesh_a, mesh_b) = (&a.models[0].texture.mesh, &b.models[0].texture.mesh);
    let belongs = |c: &Contender, key: usize, p: Point| {
        let contour = &c.pools[if key == 0 { 0 } else { c.pools.len() - 1 }][0].points;
        (c.hides && polygon::contains(contour, p)) || polyline::distance(p, contour, c.hides) <= MARGIN
    };
    let contour = &a.pools[0][0].points;
    let inner = mesh_a.rest.iter().copied();
    let shared: Vec<Point> =
        contour.iter().copied().chain(inner).filter(|&p| belongs(a, 0, p) && belongs(b, 0, p)).collect();
    if shared.is_empty() {
        return None;
    }
    let middle = polygon::center(&shared);
    let tear = |&p: &Point| {
        let to = [mesh_a.bind(p).at(&a.models[0].there), mesh_b.bind(p).at(&b.models[0].there)];
        let apart = to[0].distance(to[1]);
        (apart + 0.1 * p.distance(middle), apart, [p, to[0].midpoint(to[1])])
    };
    let (score, apart, places) = shared.iter().map(tear).min_by(|x, y| x.0.total_cmp(&y.0))?;
    let fits = apart <= 4.0 + 0.05 * mesh_a.size && belongs(a, 1, places[1]) && belongs(b, 1, places[1]);
    fits.then_some((score, places))
}

/// Places of a part's joint on the drawings on which the part is in doubt and the part at the other end is surer. They
/// lead the part.
#[derive(Clone, Debug, PartialEq)]
pub struct Lead {
    /// The joint in the lattices of the part's models.
    pub bindings: [Binding; 2],
    /// Place of the joint in working pixels, by drawing of the part.
    pub places: Vec<Option<Point>>,
}

/// A part is in doubt if the first hypotheses of its two models, or the ends of its torn joint, are further apart than
/// this, in working pixels.
const DOUBT: f64 = 4.0;

/// The leads of each contender. `paths` are the present choices.
pub fn leads(contenders: &[Contender], ties: &[Tie], paths: &[Vec<usize>]) -> Vec<Vec<Lead>> {
    let of = |c: usize| {
        let lead = |tie: &Tie| {
            let (other, end) = tie.other(c)?;
            let place = |d: usize| {
                let near = contenders[other].drawing_at(contenders[c].frame_of(d))?;
                let pool = &contenders[c].pools[d];
                let (own, theirs) = (&pool[paths[c][d]], &contenders[other].pools[near][paths[other][near]]);
                let there = tie.place(other, theirs.model, &theirs.pose.nodes)?;
                let torn = tie.place(c, own.model, &own.pose.nodes)?.distance(there) > DOUBT;
                let unsure = pool.len() < 2 || pool[0].distance(&pool[1]) > DOUBT;
                (theirs.pose.energy < own.pose.energy && (torn || unsure)).then_some(there)
            };
            let places: Vec<Option<Point>> = (0..contenders[c].pools.len()).map(place).collect();
            let any = places.iter().any(Option::is_some);
            any.then(|| Lead { bindings: tie.bindings[end], places })
        };
        ties.iter().filter_map(lead).collect()
    };
    (0..contenders.len()).map(of).collect()
}
