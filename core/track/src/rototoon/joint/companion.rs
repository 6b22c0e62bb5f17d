//! Companions: parts that moved as one body from key to key stay together between the keys.
//!
//! **Why.** A hinge ([`super::tie`]) holds one place. An eye that hangs on its hinge may still look for itself on the hair,
//! and small parts on noisy lines do. That eye and head keep their places to each other is known from the keys.
//!
//! **How.** Let M be the similarity that best takes one part's contour from key to key. If M takes another part's contour to
//! within 4 px plus 8 % of that part's size of its second key (mean distance), the other part goes with the first one. It
//! goes with at most [`MOST`] parts, those with the least distance. They are near it, and not much smaller.
//!
//! A hypothesis of the first part gives a similarity from each of its keys. These take the other part's keys to two
//! contours, and their blend, weighted by time, is where the other part is expected. So parts that drift apart slowly
//! are companions too. A hypothesis of the other part costs [`COST`] times its mean distance from there over [`APART`], at most
//! [`COST`]: the cost of a torn joint.
//!
//! **Limits.** Only parts with the same keys are companions. What moves with the body at both keys may move by itself
//! between them: the cost has an upper limit for its sake.

use super::contender::{Contender, State};
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon};

/// Most parts that a part goes with.
const MOST: usize = 3;
/// Largest distance at the second key: working pixels, and share of the part's size.
const LOOSE: (f64, f64) = (4.0, 0.08);
/// Largest gap between the bounds of companions at the first key, in working pixels.
const GAP: f64 = 40.0;
/// Least size of the part that another one goes with, as a share of the other one's.
const SMALL: f64 = 0.5;
/// Cost of a part that is [`APART`] working pixels or more from where it is expected.
const COST: f64 = 0.06;
const APART: f64 = 25.0;
/// About so many of a part's points are compared with where they are expected.
const COMPARED: usize = 8;

/// The motions of a part from both of its keys to a hypothesis.
pub type Motions = [Similarity; 2];

/// A part and one that it goes with: indices of contenders.
pub type Pair = [usize; 2];

/// The companions among all contenders.
pub fn find(contenders: &[Contender]) -> Vec<Pair> {
    let of = |c: usize| {
        let apart = |b: usize| Some((apart(&contenders[b], &contenders[c])?, b));
        let mut found: Vec<(f64, usize)> = (0..contenders.len()).filter(|&b| b != c).filter_map(apart).collect();
        found.sort_by(|x, y| x.0.total_cmp(&y.0));
        found.truncate(MOST);
        found.into_iter().map(move |(_, b)| [c, b])
    };
    (0..contenders.len()).flat_map(of).collect()
}

/// How far a part is at the second key from where the motion of `body` takes it. `None` if it does not go with it.
fn apart(body: &Contender, part: &Contender) -> Option<f64> {
    let (of_body, of_part) = (body.keys(), part.keys());
    let shaped = of_body[0].len() > 2 && of_part[0].len() > 2;
    if !shaped || body.part == part.part || body.span != part.span {
        return None;
    }
    let bounds = [of_body[0], of_part[0]].map(|points| polygon::bounds(points).unwrap_or_default());
    let [size_of_body, size] = bounds.map(|(low, high)| low.distance(high));
    let [(a, b), (c, d)] = bounds;
    let near = a.x - GAP < d.x && c.x - GAP < b.x && a.y - GAP < d.y && c.y - GAP < b.y;
    if !near || size_of_body < SMALL * size {
        return None;
    }
    let motion = Similarity::fit(of_body[0], of_body[1]);
    let off = mean(of_part[0].iter().zip(of_part[1]).map(|(&p, &q)| motion.apply(p).distance(q)));
    (off <= LOOSE.0 + LOOSE.1 * size).then_some(off)
}

/// The companions of a choice, with the motions of the hypotheses of the parts that others go with.
pub struct Companions<'a> {
    contenders: &'a [Contender<'a>],
    /// The pairs.
    pub pairs: &'a [Pair],
    /// By contender, drawing and hypothesis; empty for contenders with which no part goes.
    motions: Vec<Vec<Vec<Motions>>>,
}

impl<'a> Companions<'a> {
    /// The companions `pairs` of contenders.
    pub fn new(contenders: &'a [Contender<'a>], pairs: &'a [Pair]) -> Self {
        let of = |b: usize| {
            let all = if pairs.iter().any(|pair| pair[1] == b) { &contenders[b].pools[..] } else { &[] };
            let keys = contenders[b].keys();
            let motions = |there: &[Point]| keys.map(|key| Similarity::fit(key, there));
            all.iter().map(|pool| pool.iter().map(|hypothesis| motions(&hypothesis.points)).collect()).collect()
        };
        Self { contenders, pairs, motions: (0..contenders.len()).map(of).collect() }
    }

    /// The motions of a state of a part that others go with.
    pub fn motions(&self, body: usize, (d, h): State) -> Motions {
        self.motions[body][d][h]
    }

    /// How far a state of a pair's first part is from where a state of its second part takes it, in working pixels.
    pub fn apart(&self, [part, body]: Pair, (d, h): State, there: State) -> f64 {
        let (part, motions) = (&self.contenders[part], self.motions(body, there));
        let (keys, points) = (part.keys(), &part.pools[d][h].points);
        let share = part.drawings[d].first as f64 / f64::from((part.span.last - part.span.first).max(1));
        let off = |j: usize| {
            let expected = motions[0].apply(keys[0][j]).lerp(motions[1].apply(keys[1][j]), share);
            expected.distance(points[j])
        };
        mean((0..points.len()).step_by((points.len() / COMPARED).max(1)).map(off))
    }

    /// Cost of the states of a pair.
    pub fn cost(&self, pair: Pair, part: State, body: State) -> f64 {
        COST * (self.apart(pair, part, body) / APART).min(1.0)
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}
