//! The fewest nodes with which a section keeps the limit.
//!
//! The profile foretells about how many; from there the number falls while fits succeed and rises while they fail, in steps
//! that grow with the number, until the border between success and failure is one node wide. Every fit refines the profile.
//! At the border a node is taken out of the best fit itself, where it is missed least: a start of its own, which sometimes
//! gets along with one node less than the even start does.

use super::profile::Profile;
use super::section::{Ends, End};
use super::trial::{Effort, Given, Trial};

/// Work of a trial.
const EFFORT: Effort = Effort { squares: 8, excess: 10 };

/// The fit with the fewest nodes found; `None` where none of up to `most` nodes keeps the limit.
pub(super) fn fewest(given: &Given, most: usize) -> Option<Trial> {
    let least = given.ends.least();
    let mut profile = Profile::grown(given.points, given.lengths, given.limit);
    let extra = nodes_beyond_pieces(given.ends);
    let foretold = (profile.total().round() as isize + extra).max(least as isize) as usize;
    let mut nodes = foretold.min(most.max(least));
    let (mut failed, mut best): (usize, Option<Trial>) = (least - 1, None);
    loop {
        let trial = given.run(given.start(nodes, &profile), EFFORT, true);
        let (cuts, errors) = given.measure(&trial);
        let keeps = trial.errors.largest <= given.limit;
        if std::env::var("FIT_DEBUG").is_ok() { eprintln!("  nodes {nodes}: {:.3} rms {:.3}", trial.errors.largest, (trial.errors.squares / given.points.len() as f64).sqrt()); }
        profile = Profile::measured(cuts, &errors, given.limit);
        let step = (nodes / 12).max(1);
        if keeps {
            best = Some(trial);
            if nodes <= failed + 1 {
                break;
            }
            nodes = (nodes - step).max(failed + 1);
        } else {
            failed = nodes;
            match &best {
                Some(found) if found.nodes.len() <= nodes + 1 => break,
                Some(found) => nodes = (nodes + found.nodes.len()).div_ceil(2),
                None if nodes >= most => break,
                None => nodes = (nodes + step).min(most),
            }
        }
    }
    best
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
