//! The fewest nodes with which a section keeps the limit.
//!
//! The profile foretells about how many. From there the number rises while fits fail (where few pieces fail, by
//! doubling the nodes of those) and falls while they succeed, in steps that grow with the number, until the border
//! between success and failure is one node wide. Each fit refines the profile.
//!
//! Then nodes are taken out of the best fit itself, which gets along with a fifth fewer than even starts do. Which of
//! them can be missed is asked of a few least-squares steps near each, on some of the points (its *promise*); the most
//! promising are tried in full, in long sections several far apart at once.

use super::feet::wrapped;
use super::profile::Profile;
use super::section::{End, Ends, Slot};
use super::trial::{Effort, Given, Trial};
use rototoon_base::geometry::Point;

/// Work of a trial.
const EFFORT: Effort = Effort { squares: 4, excess: 24 };

/// Fewer points a node are too few for a smooth curve to be told from noise.
const DENSE: usize = 3;
/// Most nodes that are tried: this multiple of those foretold, and so many more.
const AMPLE: f64 = 1.6;
const SPARE: usize = 5;
/// Fits that may be spent on going below the border.
const BELOW: usize = 16;
/// Nodes that are left out in turn at each step below, the most promising first.
const PROMISING: usize = 4;
/// Nodes whose promise is below this multiple of the limit, so many pieces apart, are left out together.
const PROMISED: f64 = 1.0;
const APART: usize = 6;
const LEAST_TOGETHER: usize = 3;
/// A start is hopeless if its error stays above this multiple of the limit.
const UNPROMISING: f64 = 1.6;

/// Why a section has no fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unfit {
    /// It is wrong at this point even with many nodes.
    At(usize),
    /// It needs about as many nodes as there are points.
    Noise,
}

/// The fit with the fewest nodes found, starting from the profile of the points.
pub(super) fn fewest(given: &Given, grown: Profile) -> Result<Trial, Unfit> {
    let found = border(given, grown)?;
    Ok(below(given, found))
}

/// A fit with this many nodes, if one keeps the limit.
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

/// Falls while fits succeed and rises while they fail.
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

/// Other starts with one node less than the best fit has, as long as one of them succeeds.
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

    /// Pieces whose node could be left out.
    fn movable<'t>(&'t self, trial: &'t Trial) -> impl Iterator<Item = usize> + 't {
        let pieces = trial.slots.len();
        let inner = move |i: usize| self.ends == Ends::Periodic || (i > 0 && i + 1 < pieces);
        (0..pieces).filter(move |&i| {
            let slot = trial.slots[i].nodes;
            inner(i) && slot[0] != slot[1] && slot[1] != slot[2] && !self.ends.fixed(slot[1], trial.nodes.len())
        })
    }

    /// Without the nodes of all very promising pieces that are far from each other; `None` where those are few.
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

    /// The same with the parameters of the strided points alone; the others stay.
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

    /// Where a parameter goes when the node of a piece is left out.
    fn shorter(&self, trial: &Trial, piece: usize) -> impl Fn(f64) -> f64 + use<> {
        let periodic = self.ends == Ends::Periodic;
        // The three pieces about the node and its neighbours become two.
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

    /// A fit's nodes and parameters with the nodes of failing pieces doubled; `None` where more than `most` pieces
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
        // Of neighbours that fail, the worse.
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
