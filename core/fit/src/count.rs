//! The smallest number of nodes with which a section keeps the limit.
//!
//! The profile predicts the number approximately. From there the number rises while fits fail and falls while they
//! succeed, in steps proportional to the number, until the border between failure and success is one node wide. Where
//! only few pieces fail, the nodes of these pieces are doubled instead. Each fit refines the profile.
//!
//! Then nodes are removed from the best fit. This gives about a fifth fewer nodes than even starts. A few least-squares
//! steps near each node, on some of the points, estimate whether it can be removed (its *promise*). The most promising
//! ones are tried in full. In long sections several nodes far from each other are removed at once.
//!
//! Limits: the search is local, so the number found may not be the smallest.

use super::feet::wrapped;
use super::profile::Profile;
use super::section::{End, Ends, Slot};
use super::trial::{Effort, Given, Trial};
use rototoon_base::geometry::Point;

/// Work of a trial.
const EFFORT: Effort = Effort { squares: 4, excess: 24 };

/// With fewer points per node, a smooth curve cannot be distinguished from noise.
const DENSE: usize = 3;
/// Largest number of nodes tried: this multiple of the predicted number, plus [`SPARE`].
const AMPLE: f64 = 1.6;
const SPARE: usize = 5;
/// The stricter limit, as a share of the limit.
const STRICT: f64 = 0.7;
/// Number of fits that may be spent on removing nodes.
const BELOW: usize = 16;
/// Number of nodes that are tried one by one for removal in each step, the most promising first.
const PROMISING: usize = 4;
/// Nodes whose promise is below this multiple of the limit are removed together, if they are [`APART`] pieces apart and
/// at least [`LEAST_TOGETHER`] in number.
const PROMISED: f64 = 1.0;
const APART: usize = 6;
const LEAST_TOGETHER: usize = 3;
/// A start whose promise is above this multiple of the limit is not tried.
const UNPROMISING: f64 = 1.6;

/// The reason why a section has no fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unfit {
    /// It fails at this point even with many nodes.
    At(usize),
    /// It needs about as many nodes as it has points.
    Noise,
}

/// The fit with the fewest nodes found, starting from the profile of the points.
pub(super) fn fewest(given: &Given, grown: Profile) -> Result<Trial, Unfit> {
    let found = border(given, grown).map(|trial| below(given, trial));
    match &found {
        Err(Unfit::Noise) => return found,
        Ok(trial) if trial.nodes.len() == given.ends.least() => return found,
        _ if STRICT * given.limit < given.floor => return found,
        _ => {}
    }
    // A second search begins where a stricter limit ends. It often ends lower, and it may succeed where the first fails.
    let strict = Given { limit: STRICT * given.limit, ..given.clone() };
    let again = border(&strict, Profile::grown(given.points, given.lengths, strict.limit));
    let again = again.map(|trial| below(given, below(&strict, trial)));
    match (found, again) {
        (Ok(found), Ok(again)) if again.nodes.len() < found.nodes.len() => Ok(again),
        (Err(_), Ok(again)) => Ok(again),
        (found, _) => found,
    }
}

/// A fit with this number of nodes, if one keeps the limit.
pub(super) fn exactly(given: &Given, nodes: usize) -> Option<Trial> {
    let mut profile = Profile::grown(given.points, given.lengths, given.limit);
    for _ in 0..3 {
        let trial = given.run(given.start(nodes, &profile), EFFORT, true);
        if given.fault(&trial).is_none() {
            return Some(trial);
        }
        profile = given.profile(&trial);
    }
    None
}

/// Reduces the number while fits succeed and raises it while they fail.
fn border(given: &Given, mut profile: Profile) -> Result<Trial, Unfit> {
    let least = given.ends.least();
    let foretold = (profile.total().round() as isize + nodes_beyond_pieces(given.ends)).max(least as isize) as usize;
    if foretold > least && foretold * DENSE > given.points.len() {
        return Err(Unfit::Noise);
    }
    let most = ((AMPLE * foretold as f64) as usize + SPARE).min(given.points.len()).max(least);
    let mut nodes = foretold;
    let (mut failed, mut best): (usize, Option<Trial>) = (least - 1, None);
    let mut repaired: Option<Trial> = None;
    loop {
        let trial = match repaired.take() {
            Some(start) => given.run(start, EFFORT, false),
            None => given.run(given.start(nodes, &profile), EFFORT, true),
        };
        profile = given.profile(&trial);
        let step = (nodes / 12).max(1);
        let fault = given.fault(&trial);
        if fault.is_none() {
            best = Some(trial);
            if nodes <= failed + 1 {
                return best.ok_or(Unfit::Noise);
            }
            nodes = (nodes - step).max(failed + 1);
        } else {
            failed = failed.max(nodes);
            match &best {
                Some(found) if found.nodes.len() <= nodes + 1 => return best.ok_or(Unfit::Noise),
                Some(found) => nodes = (nodes + found.nodes.len()).div_ceil(2),
                None if nodes >= most => return Err(Unfit::At(fault.unwrap_or(trial.errors.at))),
                None => {
                    repaired = given.with_more(&trial, (nodes / 8).max(2)).filter(|start| start.nodes.len() <= most);
                    nodes = repaired.as_ref().map_or((nodes + step).min(most), |start| start.nodes.len());
                }
            }
        }
    }
}

/// Removes nodes from the best fit as long as a fit with one node fewer succeeds.
fn below(given: &Given, mut best: Trial) -> Trial {
    let mut left = BELOW;
    'lower: while best.nodes.len() > given.ends.least() {
        let mut starts: Vec<(f64, usize)> = given
            .movable(&best)
            .map(|piece| (given.promise(given.without_in_few(&best, piece), piece.saturating_sub(1)), piece))
            .collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(start) = given.without_several(&best, &starts) {
            left = left.saturating_sub(1);
            let trial = given.run(start, EFFORT, false);
            if given.fault(&trial).is_none() {
                best = trial;
                continue 'lower;
            }
        }
        starts.truncate(PROMISING);
        for (promise, piece) in starts {
            if promise > UNPROMISING * given.limit {
                break;
            }
            if left == 0 {
                return best;
            }
            left -= 1;
            let trial = given.run(given.without(&best, piece), EFFORT, false);
            if given.fault(&trial).is_none() {
                best = trial;
                continue 'lower;
            }
        }
        break;
    }
    best
}

impl Given<'_> {
    fn profile(&self, trial: &Trial) -> Profile {
        let (cuts, errors) = self.measure(trial);
        Profile::measured(cuts, &errors, self.limit)
    }

    /// The pieces whose node may be removed.
    fn movable<'t>(&'t self, trial: &'t Trial) -> impl Iterator<Item = usize> + 't {
        let pieces = trial.slots.len();
        let inner = move |i: usize| self.ends == Ends::Periodic || (i > 0 && i + 1 < pieces);
        (0..pieces).filter(move |&i| {
            let slot = trial.slots[i].nodes;
            inner(i) && slot[0] != slot[1] && slot[1] != slot[2] && !self.ends.fixed(slot[1], trial.nodes.len())
        })
    }

    /// Removes the nodes of all very promising pieces that are far from each other; `None` where there are too few of
    /// them.
    fn without_several(&self, trial: &Trial, starts: &[(f64, usize)]) -> Option<Trial> {
        let pieces = trial.slots.len();
        let apart = |a: usize, b: usize| {
            let apart = a.abs_diff(b);
            if self.ends == Ends::Periodic { apart.min(pieces - apart) } else { apart }
        };
        let mut chosen: Vec<usize> = Vec::new();
        for (promise, piece) in starts {
            if *promise <= PROMISED * self.limit && chosen.iter().all(|&other| apart(other, *piece) >= APART) {
                chosen.push(*piece);
            }
        }
        if chosen.len() < LEAST_TOGETHER {
            return None;
        }
        chosen.sort_by(|a, b| b.cmp(a));
        let first = self.without(trial, chosen[0]);
        Some(chosen[1..].iter().fold(first, |fewer, &piece| self.without(&fewer, piece)))
    }

    /// A fit's nodes and parameters without the node of a piece.
    fn without(&self, trial: &Trial, piece: usize) -> Trial {
        let (nodes, slots) = self.nodes_without(trial, piece);
        let shorter = self.shorter(trial, piece);
        let parameters = trial.parameters.iter().map(|&t| shorter(t)).collect();
        Trial { nodes, slots, parameters, errors: trial.errors }
    }

    /// The same, with new parameters for the strided points only.
    fn without_in_few(&self, trial: &Trial, piece: usize) -> Trial {
        let (nodes, slots) = self.nodes_without(trial, piece);
        let shorter = self.shorter(trial, piece);
        let mut parameters = trial.parameters.clone();
        for j in self.strided(slots.len()) {
            parameters[j] = shorter(parameters[j]);
        }
        Trial { nodes, slots, parameters, errors: trial.errors }
    }

    fn nodes_without(&self, trial: &Trial, piece: usize) -> (Vec<Point>, Vec<Slot>) {
        let mut nodes = trial.nodes.clone();
        nodes.remove(trial.slots[piece].nodes[1]);
        let slots = self.ends.slots(nodes.len());
        (nodes, slots)
    }

    /// The map from old to new parameters when the node of a piece is removed.
    fn shorter(&self, trial: &Trial, piece: usize) -> impl Fn(f64) -> f64 + use<> {
        let periodic = self.ends == Ends::Periodic;
        // The three pieces around the node become two.
        let (from, count) = (piece as f64 - 1.0, trial.slots.len() as f64);
        move |t: f64| {
            let ahead = if periodic { wrapped(t - from, count) } else { t - from };
            let moved = if ahead < 0.0 {
                ahead
            } else if ahead < 3.0 {
                ahead * 2.0 / 3.0
            } else {
                ahead - 1.0
            };
            let t = moved + from;
            if periodic { wrapped(t, count - 1.0) } else { t }
        }
    }

    /// A fit's nodes and parameters with the nodes of failing pieces doubled. `None` where more than `most` pieces
    /// fail.
    fn with_more(&self, trial: &Trial, most: usize) -> Option<Trial> {
        let (_, errors) = self.measure(trial);
        let movable = |i: usize| {
            let slot = trial.slots[i].nodes;
            slot[0] != slot[1] && slot[1] != slot[2] && !self.ends.fixed(slot[1], trial.nodes.len())
        };
        let failing: Vec<usize> = (0..errors.len()).filter(|&i| errors[i] > self.limit).collect();
        if failing.len() > most {
            return None;
        }
        // Among failing neighbours only the worse one is split.
        let worst = |&&i: &&usize| {
            let above = |k: usize| errors.get(k).is_some_and(|&e| e > errors[i]);
            movable(i) && !above(i + 1) && !(i > 0 && above(i - 1))
        };
        let split: Vec<usize> = failing.iter().filter(worst).copied().collect();
        if split.is_empty() {
            return None;
        }
        let mut nodes = trial.nodes.clone();
        for &i in split.iter().rev() {
            let [before, about, after] = trial.slots[i].nodes;
            let (g, first, second) = (trial.nodes[about], trial.nodes[before], trial.nodes[after]);
            nodes.splice(about..=about, [g.lerp(first, 0.25), g.lerp(second, 0.25)]);
        }
        let shifted = |&t: &f64| {
            let i = t as usize;
            let earlier = split.partition_point(|&k| k < i) as f64;
            if split.binary_search(&i).is_ok() { t + earlier + (t - i as f64) } else { t + earlier }
        };
        let parameters = trial.parameters.iter().map(shifted).collect();
        let slots = self.ends.slots(nodes.len());
        Some(Trial { nodes, slots, parameters, errors: trial.errors })
    }
}

fn nodes_beyond_pieces(ends: Ends) -> isize {
    let of = |end: End| match end {
        End::Free => 1,
        End::Corner => 0,
        End::Joined => 1,
    };
    match ends {
        Ends::Periodic => 0,
        Ends::Open(start, end) => of(start) + of(end),
    }
}
