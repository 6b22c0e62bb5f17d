//! Leads: where a part in doubt is, by what a surer part says.
//!
//! - At a **hinge** ([`super::tie`]) the surer part gives one place. The part may turn about it.
//! - A **body** with which the part goes ([`super::companion`]) gives its whole motion.

use super::Bonds;
use super::companion::{Companions, Motions};
use super::contender::{Contender, Paths};
use super::tie::Tie;
use crate::rototoon::lattice::mesh::Binding;
use rototoon_base::geometry::Point;

/// A part is in doubt if the first hypotheses of its two models, the ends of its torn joint, or it and the place to which its
/// body takes it are further apart than this, in working pixels.
const DOUBT: f64 = 4.0;

/// What a surer part says about a part, by drawing of the part. `None` where the part is not in doubt.
#[derive(Clone, Debug, PartialEq)]
pub enum Lead {
    /// Places of the joint.
    Hinge {
        /// The joint in the lattices of the part's models.
        bindings: [Binding; 2],
        /// Its places in working pixels.
        places: Vec<Option<Point>>,
    },
    /// Motions from both keys.
    Body(Vec<Option<Motions>>),
}

impl Lead {
    /// The place of the joint on a drawing, if it is a joint that leads there.
    pub fn place(&self, d: usize) -> Option<Point> {
        match self {
            Self::Hinge { places, .. } => places[d],
            Self::Body(_) => None,
        }
    }

    /// Whether it says anything about a drawing.
    fn leads_on(&self, d: usize) -> bool {
        match self {
            Self::Hinge { places, .. } => places[d].is_some(),
            Self::Body(motions) => motions[d].is_some(),
        }
    }

    /// Whether another lead says the same about a drawing.
    fn same_on(&self, other: &Self, d: usize) -> bool {
        match (self, other) {
            (Self::Hinge { bindings, places }, Self::Hinge { bindings: theirs, places: there }) => {
                bindings == theirs && places[d] == there[d]
            }
            (Self::Body(motions), Self::Body(theirs)) => motions[d] == theirs[d],
            _ => false,
        }
    }
}

/// Whether leads say the same about a drawing.
pub fn same_on(a: &[Lead], b: &[Lead], d: usize) -> bool {
    let on = |leads: &[Lead]| leads.iter().filter(|lead| lead.leads_on(d)).count();
    let [mine, theirs] = [a, b].map(|leads| leads.iter().filter(move |lead| lead.leads_on(d)));
    on(a) == on(b) && mine.zip(theirs).all(|(a, b)| a.same_on(b, d))
}

/// The leads of each contender. `paths` are the present choices.
pub fn leads(contenders: &[Contender], bonds: &Bonds, paths: &Paths) -> Vec<Vec<Lead>> {
    let companions = Companions::new(contenders, &bonds.companions);
    let of = |c: usize| {
        let hinges = bonds.ties.iter().filter_map(|tie| hinge(contenders, tie, c, paths));
        let bodies = (0..bonds.companions.len()).filter(|&k| bonds.companions[k].parts[0] == c);
        hinges.chain(bodies.filter_map(|k| body(contenders, &companions, k, paths))).collect()
    };
    (0..contenders.len()).map(of).collect()
}

/// What the part at the other end of a joint of `c` says.
fn hinge(contenders: &[Contender], tie: &Tie, c: usize, paths: &Paths) -> Option<Lead> {
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
    any.then(|| Lead::Hinge { bindings: tie.bindings[end], places })
}

/// What the second part of the pair with an index says about the first. It need not be the surer one: small parts fit anything.
fn body(contenders: &[Contender], companions: &Companions, index: usize, paths: &Paths) -> Option<Lead> {
    let [part, body] = companions.pairs[index].parts;
    let motions = |d: usize| {
        let near = contenders[body].drawing_at(contenders[part].frame_of(d))?;
        let there = (near, paths[body][near]);
        let apart = companions.apart(index, (d, paths[part][d]), there);
        companions.carry(index, there, paths).filter(|_| apart > DOUBT)
    };
    let motions: Vec<Option<Motions>> = (0..contenders[part].pools.len()).map(motions).collect();
    motions.iter().any(Option::is_some).then_some(Lead::Body(motions))
}
