//! Companions: parts that moved as one body from key to key stay together between the keys.
//!
//! **Why.** A hinge ([`super::tie`]) holds one place. An eye that hangs on its hinge may still look for itself on the hair,
//! and small parts on noisy lines do. That eye and head keep their places to each other is known from the keys.
//!
//! **How.** Let M be the similarity that best takes one part's contour from key to key. The **drift** of another part is how
//! far M leaves it from its second key (mean distance). If that is within 10 px plus 8 % of the part's size, the part goes
//! with the first one. It goes with at most [`MOST`] parts, those with the least drift. They are near it, and not much
//! smaller.
//!
//! A hypothesis of the first part gives a similarity from each of its keys. These take the other part's keys to two
//! contours, and their blend, weighted by time, is where the other part is expected. Parts drift slowly, so this is nearer
//! than either: on six films with truth the blend was off by 4 px in the median where the drift was 8 to 12 px. A hypothesis
//! of the other part costs [`COST`] times its mean distance from there, over [`APART`] plus the drift, at most [`COST`]: the
//! cost of a torn joint.
//!
//! A part may have further keys between two that both parts have. Then these two are meant here by its keys, as for joints.
//!
//! An artist's correction may put a part far from where its body takes it. Then the part moves by itself, and it is nobody's
//! companion.
//!
//! **Limits.** What moves with the body at both keys may move by itself between them: the cost has an upper limit for its
//! sake. A further key of a part does not change where its body is expected to take it.

use super::contender::{Contender, Paths, State};
use super::tie::{overlap, shared};
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon};

/// Most parts that a part goes with.
const MOST: usize = 3;
/// Largest drift: working pixels, and share of the part's size.
const LOOSE: (f64, f64) = (10.0, 0.08);
/// Largest gap between the bounds of companions at the first key, in working pixels.
const GAP: f64 = 40.0;
/// Least size of the part that another one goes with, as a share of the other one's.
const SMALL: f64 = 0.5;
/// Cost of a part that is [`APART`] working pixels plus its drift, or more, from where it is expected.
const COST: f64 = 0.06;
const APART: f64 = 25.0;
/// A part that a correction puts further from where its body takes it than this moves by itself, in working pixels.
const BY_ITSELF: f64 = 10.0;
/// About so many of a part's points are compared with where they are expected.
const COMPARED: usize = 8;

/// The motions of a part from both keys to a hypothesis.
pub type Motions = [Similarity; 2];

/// A part and one that it goes with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The contenders: the part, and the one that it goes with.
    pub parts: [usize; 2],
    /// By part: the contenders that begin and end with the keys that both parts have.
    ends: [[usize; 2]; 2],
    /// How far at the second key the part is from where the other one's motion takes it, in working pixels.
    drift: f64,
}

impl Pair {
    /// The contender beside `c`. `None` if `c` is not of the pair.
    pub fn other(&self, c: usize) -> Option<usize> {
        let end = self.parts.iter().position(|&p| p == c)?;
        Some(self.parts[1 - end])
    }

    /// The control points of a part at both keys, in working pixels.
    fn keys<'a>(&self, contenders: &'a [Contender], which: usize) -> [&'a [Point]; 2] {
        keys(contenders, self.ends[which])
    }
}

/// The companions among all contenders. `paths` are their choices so far, and `corrected` says whether a drawing of a
/// contender is corrected.
pub fn find(contenders: &[Contender], paths: &Paths, corrected: &dyn Fn(usize, usize) -> bool) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = (0..contenders.len()).flat_map(|c| of(contenders, c)).collect();
    let companions = Companions::new(contenders, &pairs);
    let moves_by_itself = |k: usize| {
        let [part, body] = pairs[k].parts;
        let away = |d: usize| {
            let near = contenders[body].drawing_at(contenders[part].frame_of(d))?;
            Some(companions.apart(k, (d, paths[part][d]), (near, paths[body][near])) > BY_ITSELF)
        };
        (0..contenders[part].pools.len()).any(|d| corrected(part, d) && away(d) == Some(true))
    };
    let alone: Vec<usize> = (0..pairs.len()).filter(|&k| moves_by_itself(k)).map(|k| pairs[k].parts[0]).collect();
    pairs.retain(|pair| !alone.contains(&pair.parts[0]));
    pairs
}

/// The pairs of a part with those that it goes with.
fn of(contenders: &[Contender], c: usize) -> Vec<Pair> {
    let own = &contenders[c];
    let mut found: Vec<(f64, Vec<Pair>)> = Vec::new();
    for b in (0..contenders.len()).filter(|&b| contenders[b].part != own.part && overlap(own.span, contenders[b].span))
    {
        let known = |(_, pairs): &(f64, Vec<Pair>)| pairs.iter().any(|pair| pair.parts[1] == b);
        let Some(chains) = shared(contenders, c, b).filter(|_| !found.iter().any(known)) else { continue };
        let ends = chains.each_ref().map(|chain| [chain.links[0], chain.links[chain.links.len() - 1]]);
        if let Some(drift) = drift(keys(contenders, ends[1]), keys(contenders, ends[0])) {
            let links = chains[1].links.iter().filter(|&&b| overlap(own.span, contenders[b].span));
            found.push((drift, links.map(|&b| Pair { parts: [c, b], ends, drift }).collect()));
        }
    }
    found.sort_by(|x, y| x.0.total_cmp(&y.0));
    found.into_iter().take(MOST).flat_map(|(_, pairs)| pairs).collect()
}

/// The control points at both ends of a part, in working pixels: `ends` are the contenders that begin and end there.
fn keys<'a>(contenders: &'a [Contender], ends: [usize; 2]) -> [&'a [Point]; 2] {
    [0, 1].map(|k: usize| contenders[ends[k]].keys()[k])
}

/// The drift of a part beside a body. `None` if it does not go with it.
fn drift(body: [&[Point]; 2], part: [&[Point]; 2]) -> Option<f64> {
    if body[0].len() <= 2 || part[0].len() <= 2 {
        return None;
    }
    let bounds = [body[0], part[0]].map(|points| polygon::bounds(points).unwrap_or_default());
    let [size_of_body, size] = bounds.map(|(low, high)| low.distance(high));
    let [(a, b), (c, d)] = bounds;
    let near = a.x - GAP < d.x && c.x - GAP < b.x && a.y - GAP < d.y && c.y - GAP < b.y;
    if !near || size_of_body < SMALL * size {
        return None;
    }
    let motion = Similarity::fit(body[0], body[1]);
    let drift = mean(part[0].iter().zip(part[1]).map(|(&p, &q)| motion.apply(p).distance(q)));
    (drift <= LOOSE.0 + LOOSE.1 * size).then_some(drift)
}

/// The companions of a choice, with the motions of the hypotheses of the parts that others go with.
pub struct Companions<'a> {
    contenders: &'a [Contender<'a>],
    /// The pairs.
    pub pairs: &'a [Pair],
    /// By pair, drawing and hypothesis of the second part.
    motions: Vec<Vec<Vec<Motions>>>,
}

impl<'a> Companions<'a> {
    /// The companions `pairs` of contenders.
    pub fn new(contenders: &'a [Contender<'a>], pairs: &'a [Pair]) -> Self {
        let of = |pair: &Pair| {
            let keys = pair.keys(contenders, 1);
            let motions = |there: &[Point]| keys.map(|key| Similarity::fit(key, there));
            let pools = contenders[pair.parts[1]].pools.iter();
            pools.map(|pool| pool.iter().map(|hypothesis| motions(&hypothesis.points)).collect()).collect()
        };
        Self { contenders, pairs, motions: pairs.iter().map(of).collect() }
    }

    /// How far a state of a pair's first part is from where a state of its second part takes it, in working pixels. The pair
    /// is given by its index.
    pub fn apart(&self, index: usize, (d, h): State, there: State) -> f64 {
        let (pair, motions) = (&self.pairs[index], &self.motions[index][there.0][there.1]);
        let (keys, part) = (pair.keys(self.contenders, 0), &self.contenders[pair.parts[0]]);
        let [first, last] = [self.contenders[pair.ends[0][0]].span.first, self.contenders[pair.ends[0][1]].span.last];
        let share = f64::from(part.frame_of(d) - first) / f64::from((last - first).max(1));
        let points = &part.pools[d][h].points;
        let off = |j: usize| {
            let expected = motions[0].apply(keys[0][j]).lerp(motions[1].apply(keys[1][j]), share);
            expected.distance(points[j])
        };
        mean((0..points.len()).step_by((points.len() / COMPARED).max(1)).map(off))
    }

    /// Cost of the states of a pair.
    pub fn cost(&self, index: usize, part: State, body: State) -> f64 {
        COST * (self.apart(index, part, body) / (APART + self.pairs[index].drift)).min(1.0)
    }

    /// The motions that a state of a pair's second part gives the first one from the keys of its own span. `paths` say where
    /// the second part is at these keys. `None` if it is not there.
    pub fn carry(&self, index: usize, there: State, paths: &Paths) -> Option<Motions> {
        let span = self.contenders[self.pairs[index].parts[0]].span;
        let at = |frame| {
            let mut links = self.pairs.iter().enumerate().filter(|(_, pair)| pair.ends == self.pairs[index].ends);
            links.find_map(|(k, pair)| {
                let d = self.contenders[pair.parts[1]].drawing_at(frame)?;
                Some(self.motions[k][d][paths[pair.parts[1]][d]])
            })
        };
        let now = self.motions[index][there.0][there.1];
        let keys = [at(span.first)?, at(span.last)?];
        Some([0, 1].map(|k: usize| now[k].after(&keys[k][k].inverse())))
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}
