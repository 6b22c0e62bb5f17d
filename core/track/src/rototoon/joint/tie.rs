//! Parts that hang together: a hinge is a place that both parts carry along.
//!
//! Between two keys each part has a motion of its own (its lattice brought from one contour to the other). Where the
//! parts overlap, the place that both motions take to the same spot, or nearly so, is where they are joined: for a limb
//! that turned against the body that is its pivot; for parts that moved alike, any place of the overlap, and the middle
//! is taken. Hypotheses that tear a joint cost more than such that keep it, up to a limit, since the joint is a guess.
//!
//! Limits: a joint shows only where both parts are keyed on the same frames.

use super::contender::Contender;
use crate::rototoon::lattice::mesh::Binding;
use rototoon_base::geometry::{Point, polygon, polyline};

/// Distance from a part within which a place still belongs to it, in working pixels.
const MARGIN: f64 = 6.0;
/// Cost of a joint that is torn by [`TORN`] working pixels or more.
const COST_OF_TORN: f64 = 0.06;
const TORN: f64 = 25.0;

/// A hinge between two contenders.
pub struct Tie {
    /// The contenders.
    pub parts: [usize; 2],
    /// The hinge in the lattice of each model (second index) of each part (first index).
    bindings: [[Binding; 2]; 2],
}

impl Tie {
    /// The contender at the other end, and which end `c` is.
    pub fn other(&self, c: usize) -> Option<(usize, usize)> {
        let end = self.parts.iter().position(|&p| p == c)?;
        Some((self.parts[1 - end], end))
    }

    /// Where a pose of contender `c` puts the hinge.
    pub fn place(&self, c: usize, model: usize, nodes: &[Point]) -> Option<Point> {
        let (_, end) = self.other(c)?;
        Some(self.bindings[end][model].at(nodes))
    }

    /// Cost of a joint whose ends lie at these places.
    pub fn cost(a: Point, b: Point) -> f64 {
        COST_OF_TORN * (a.distance(b) / TORN).min(1.0)
    }
}

/// The hinges of all contenders: of each part, the one that tears least.
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

/// The place at both keys where two parts are joined, and a measure of how badly they are.
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

/// Where a part's joint lies, on the drawings on which the part is in doubt and the one it hangs on is surer.
#[derive(Clone, Debug, PartialEq)]
pub struct Lead {
    /// The joint in the lattices of the part's models.
    pub bindings: [Binding; 2],
    /// Its place by drawing of the part.
    pub places: Vec<Option<Point>>,
}

/// Distance of the models' first hypotheses, or of the torn joint's ends, from which on a part is in doubt.
const DOUBT: f64 = 4.0;

/// The leads of each contender.
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
