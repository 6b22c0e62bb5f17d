//! Joints: parts that are connected stay together at a hinge, a place that both parts carry along.
//!
//! Between two keys each part has a motion of its own: its lattice moved from one contour to the other. In the overlap
//! of two parts, the place that both motions take to nearly the same spot is their joint. For a limb that rotates
//! against the body it is the pivot. For parts that move alike every place of the overlap fits, and the place nearest
//! to the middle is taken. Hypotheses that tear a joint cost more than hypotheses that keep it. The cost has an upper
//! limit, because the joint is a guess.
//!
//! A part may have more keys than its neighbour. Its spans between two keys that both parts have are taken as one motion: the
//! place is carried from span to span. So a further key of one part does not take its joints away.
//!
//! Limit: a joint is found only between parts that have two keys on the same frames.

use super::contender::Contender;
use crate::rototoon::lattice::mesh::Binding;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::Span;

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
    pub(super) bindings: [[Binding; 2]; 2],
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
        let own = &contenders[c];
        let others =
            (0..contenders.len()).filter(|&b| contenders[b].part != own.part && overlap(own.span, contenders[b].span));
        let hinges = others.filter_map(|b| {
            let chains = shared(contenders, c, b)?;
            hinge(&chains).map(|(tear, places)| (tear, chains, places))
        });
        let Some((_, chains, places)) = hinges.min_by(|x, y| x.0.total_cmp(&y.0)) else { continue };
        for &b in chains[1].links.iter().filter(|&&b| overlap(own.span, contenders[b].span)) {
            if !ties.iter().any(|t| t.parts == [b, c]) {
                ties.push(Tie {
                    parts: [c, b],
                    bindings: [chains[0].bindings(c, places), chains[1].bindings(b, places)],
                });
            }
        }
    }
    ties
}

/// Whether two spans have a frame between keys in common.
pub(super) fn overlap(a: Span, b: Span) -> bool {
    a.first < b.last && b.first < a.last
}

/// Spans of one part that follow each other.
pub(super) struct Chain<'a> {
    contenders: &'a [Contender<'a>],
    pub(super) links: Vec<usize>,
}

/// The spans of the parts of two contenders between the nearest keys that both parts have around them.
pub(super) fn shared<'a>(contenders: &'a [Contender<'a>], c: usize, b: usize) -> Option<[Chain<'a>; 2]> {
    let of = |k: usize| {
        let mut links: Vec<usize> =
            (0..contenders.len()).filter(|&i| contenders[i].part == contenders[k].part).collect();
        links.sort_by_key(|&i| contenders[i].span.first);
        links
    };
    let all = [of(c), of(b)];
    let spans = [contenders[c].span, contenders[b].span];
    let (low, high) = (spans[0].first.min(spans[1].first), spans[0].last.max(spans[1].last));
    let firsts = |links: &[usize]| links.iter().map(|&i| contenders[i].span.first).collect::<Vec<_>>();
    let lasts = |links: &[usize]| links.iter().map(|&i| contenders[i].span.last).collect::<Vec<_>>();
    let theirs = [firsts(&all[1]), lasts(&all[1])];
    let first = firsts(&all[0]).into_iter().filter(|f| *f <= low && theirs[0].contains(f)).max()?;
    let last = lasts(&all[0]).into_iter().filter(|f| *f >= high && theirs[1].contains(f)).min()?;
    let within = |links: &[usize]| -> Option<Chain<'a>> {
        let inside = |&i: &usize| first <= contenders[i].span.first && contenders[i].span.last <= last;
        let links: Vec<usize> = links.iter().copied().filter(inside).collect();
        let whole = links.windows(2).all(|pair| contenders[pair[0]].span.last == contenders[pair[1]].span.first);
        whole.then_some(Chain { contenders, links })
    };
    Some([within(&all[0])?, within(&all[1])?])
}

impl Chain<'_> {
    fn ends(&self) -> [&Contender<'_>; 2] {
        [&self.contenders[self.links[0]], &self.contenders[self.links[self.links.len() - 1]]]
    }

    /// Where the motion takes a place of the first key, up to the end of each link.
    fn carried(&self, p: Point) -> Vec<Point> {
        let along = self.links.iter().scan(p, |at, &link| {
            let model = &self.contenders[link].models[0];
            *at = model.texture.mesh.bind(*at).at(&model.there);
            Some(*at)
        });
        along.collect()
    }

    /// The hinge in the lattices of a link's models. `places` are those at the ends of the chain.
    fn bindings(&self, link: usize, places: [Point; 2]) -> [Binding; 2] {
        let k = self.links.iter().position(|&l| l == link).unwrap_or(0);
        let along = self.carried(places[0]);
        let from = if k == 0 { places[0] } else { along[k - 1] };
        let to = if k + 1 == self.links.len() { places[1] } else { along[k] };
        let models = self.contenders[link].models;
        [models[0].texture.mesh.bind(from), models[1].texture.mesh.bind(to)]
    }
}

/// The place at both ends of the chains where two parts are joined, and a score that is smaller for a better joint.
fn hinge([a, b]: &[Chain; 2]) -> Option<(f64, [Point; 2])> {
    let (ends_a, ends_b) = (a.ends(), b.ends());
    let mesh_a = &ends_a[0].models[0].texture.mesh;
    let belongs = |ends: [&Contender; 2], key: usize, p: Point| {
        let c = ends[key];
        let contour = &c.pools[if key == 0 { 0 } else { c.pools.len() - 1 }][0].points;
        (c.hides && polygon::contains(contour, p)) || polyline::distance(p, contour, c.hides) <= MARGIN
    };
    let contour = &ends_a[0].pools[0][0].points;
    let inner = mesh_a.rest.iter().copied();
    let shared: Vec<Point> =
        contour.iter().copied().chain(inner).filter(|&p| belongs(ends_a, 0, p) && belongs(ends_b, 0, p)).collect();
    if shared.is_empty() {
        return None;
    }
    let middle = polygon::center(&shared);
    let tear = |&p: &Point| {
        let to = [a, b].map(|chain| chain.carried(p).last().copied().unwrap_or(p));
        let apart = to[0].distance(to[1]);
        (apart + 0.1 * p.distance(middle), apart, [p, to[0].midpoint(to[1])])
    };
    let (score, apart, places) = shared.iter().map(tear).min_by(|x, y| x.0.total_cmp(&y.0))?;
    let fits = apart <= 4.0 + 0.05 * mesh_a.size && belongs(ends_a, 1, places[1]) && belongs(ends_b, 1, places[1]);
    fits.then_some((score, places))
}
