//! Which hypothesis each part follows, decided for all parts together.
//!
//! A part alone cannot know that the leg it fits so well is another part's. What is said by all: nearer parts hide
//! farther ones. A sample of a part that lies under a nearer part is unseen, and costs [`shadow::HIDDEN`], less than a
//! wrong colour, more than a right one. So of two equal legs, both on one drawn leg is dearer than one on each, and a
//! part that is really hidden is not driven out to where its colour happens to be.
//!
//! E = Σ_parts [ Σ_drawings √U + smoothness ], U the visible energy of a hypothesis given the nearer parts' choices, the
//! smoothness as in [`super::select`], plus what torn joints cost ([`tie`]). It is lowered by moves, each found by dynamic
//! programming and taken only if E falls: all drawings of one part, or all drawings of two parts of which one hides the
//! other. Moves of two are what lets crossing twins change places.
//!
//! Limits: a local minimum of moves of two; parts that are keyed on different frames move singly only.

mod contender;
pub mod cost;
mod moves;
pub mod pairs;
pub mod shadow;
#[cfg(test)]
mod tests;
pub mod tie;

pub use contender::Contender;

use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use shadow::{Memory, Shadows};
use std::collections::BTreeMap;
use tie::Tie;

/// Rounds over all parts and pairs at the most.
const ROUNDS: usize = 4;
/// Moves found at once.
const AT_ONCE: usize = 8;

/// The hypothesis that each contender follows on each of its drawings; `ties` are their hinges ([`tie::find`]), `paths` is
/// where to start from.
pub fn choose(
    contenders: &[Contender],
    ties: &[Tie],
    mut paths: Vec<Vec<usize>>,
    memory: &mut Memory,
) -> Vec<Vec<usize>> {
    let shadows = Shadows::cast(contenders, memory);
    if shadows.none() && ties.is_empty() {
        return paths;
    }
    let scene = cost::Scene { contenders, shadows: &shadows, ties };
    let pairs = shadows.pairs();
    let same = |a: usize, b: usize| {
        contenders[a].drawings == contenders[b].drawings && contenders[a].span == contenders[b].span
    };
    let moves = (0..contenders.len())
        .map(|c| vec![c])
        .chain(pairs.into_iter().filter(|&(far, near)| same(far, near)).map(|(far, near)| vec![far, near]));
    let mut moves: Vec<Move> = moves.map(|who| Move { seen: scene.seen_by(&who), who, tried: None }).collect();
    let mut changed = Changes { count: 0, last: vec![0; contenders.len()] };
    for _ in 0..ROUNDS {
        let before = changed.count;
        round(&scene, &mut moves, &mut paths, &mut changed);
        if changed.count == before {
            break;
        }
    }
    paths
}

/// Tries all moves in their order. Most gain nothing, so that the next few are found at once; what sees a change that one
/// of these few has just made is found anew.
fn round(scene: &cost::Scene, moves: &mut [Move], paths: &mut [Vec<usize>], changed: &mut Changes) {
    let mut next = 0;
    while next < moves.len() {
        let due = |&m: &usize| moves[m].tried.is_none_or(|tried| changed.seen(&moves[m], tried));
        let few: Vec<usize> = (next..moves.len()).filter(due).take(AT_ONCE).collect();
        let Some(last) = few.last() else { return };
        let found = few.par_iter().map(|&m| (m, scene.proposal(&moves[m].who, paths)));
        let mut found: BTreeMap<usize, _> = found.collect();
        let (start, end) = (changed.count, last + 1);
        let stale = (next..end).find(|&m| {
            let stale = changed.seen(&moves[m], start);
            if let Some(proposal) = found.remove(&m).filter(|_| !stale) {
                moves[m].tried = Some(changed.count);
                proposal.into_iter().for_each(|new| changed.make(new, paths));
            }
            stale
        });
        next = stale.unwrap_or(end);
    }
}

/// When the contenders' paths changed, counted in changes.
struct Changes {
    count: usize,
    last: Vec<usize>,
}

impl Changes {
    /// Whether something that a move sees has changed since a moment. If not, it would find the same again.
    fn seen(&self, by: &Move, since: usize) -> bool {
        by.seen.iter().any(|&c| self.last[c] > since)
    }

    fn make(&mut self, new: Vec<(usize, Vec<usize>)>, paths: &mut [Vec<usize>]) {
        self.count += 1;
        for (c, path) in new {
            paths[c] = path;
            self.last[c] = self.count;
        }
    }
}

/// A move to try: new paths for one contender or for two.
struct Move {
    who: Vec<usize>,
    /// Those whose choices its outcome depends on, itself included.
    seen: Vec<usize>,
    /// The number of changes before it was tried last.
    tried: Option<usize>,
}
