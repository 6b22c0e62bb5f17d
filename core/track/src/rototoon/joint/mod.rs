//! Chooses the hypothesis of each part on each drawing, for all parts together.
//!
//! A part alone cannot know that the leg it fits so well is another part's leg. Occlusion tells them apart. A sample of
//! a part under a nearer part is unseen. It costs [`shadow::HIDDEN`], which is less than a wrong colour and more than a
//! right one. So if two equal legs both choose the same drawn leg, that costs more than one on each. And a part that is
//! really hidden is not pulled out to a place that happens to have its colour.
//!
//! The energy is E = Σ_parts [ Σ_drawings √U + smoothness ] plus the cost of torn joints ([`tie`]), of companions that
//! come apart ([`companion`]), and of what the picture shows of the figure and no part explains ([`figure`](mod@figure)). U is the visible energy of a hypothesis, given the choices of the nearer parts. The
//! smoothness is that of [`super::select`].
//!
//! E is lowered by moves. A move changes the paths of one part, or of two parts of which one hides the other, on all
//! drawings. Dynamic programming finds the best paths of a move, and the move is made only if E falls. Moves of two
//! parts let crossing twins swap places.
//!
//! What moves reach depends on which part moves first. So all moves are made twice from the same start, from the nearest part to
//! the farthest and the other way round, and the paths of less energy are taken. The contenders come in an order of their own
//! ([`Contender::order`]), so the choice does not depend on the order in which a document lists its parts.
//!
//! Limits: the result is a local minimum with respect to these moves. Parts that are keyed on different frames move
//! singly only.

pub mod companion;
mod contender;
pub mod cost;
pub mod figure;
pub mod jumps;
pub mod lead;
pub mod lengths;
pub mod margin;
mod masks;
mod moves;
pub mod pairs;
#[cfg(test)]
mod reference;
pub mod shadow;
mod tables;
#[cfg(test)]
mod tests;
pub mod tie;
mod twins;

pub use contender::Contender;

use companion::{Companions, Pair};
use figure::Figure;
use figure::canvas::Canvas;
use moves::{Changes, LEAST_GAIN, Move, Proposal, Table};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use shadow::{Memory, Shadows};
use std::collections::BTreeMap;
use std::sync::Arc;
use tie::Tie;

/// Largest number of rounds over all parts and pairs.
const ROUNDS: usize = 4;
/// Number of moves computed in parallel.
const AT_ONCE: usize = 8;

/// What holds contenders together.
#[derive(Default)]
pub struct Bonds {
    /// Their joints.
    pub ties: Vec<Tie>,
    /// Parts that go with others.
    pub companions: Vec<Pair>,
    /// The figure that they explain together. None where colours do not tell.
    pub canvas: Option<Arc<Canvas>>,
}

/// The hypothesis that each contender follows on each of its drawings; `bonds` hold them together, `jump` is how far
/// drawings jump ([`jumps`]), and `paths` is where to start from. Contenders that are not `free` keep their paths.
pub fn choose(
    contenders: &[Contender],
    bonds: &Bonds,
    jump: f64,
    (start, free): (Vec<Vec<usize>>, &[bool]),
    memory: &mut Memory,
) -> Vec<Vec<usize>> {
    let shadows = Shadows::cast(contenders, memory);
    let figure = bonds.canvas.as_ref().map(|canvas| Figure::new(canvas, contenders, memory));
    if shadows.none() && bonds.ties.is_empty() && bonds.companions.is_empty() && jump == 0.0 && figure.is_none() {
        return start;
    }
    let companions = Companions::new(contenders, &bonds.companions);
    let (ties, figure) = (&bonds.ties[..], figure.as_ref());
    let lengths = &memory.lengths(contenders);
    let scene = cost::Scene { contenders, shadows: &shadows, ties, companions: &companions, jump, lengths, figure };
    let pairs = shadows.pairs();
    let same = |a: usize, b: usize| {
        contenders[a].drawings == contenders[b].drawings && contenders[a].span == contenders[b].span
    };
    let moves = (0..contenders.len())
        .map(|c| vec![c])
        .chain(pairs.into_iter().filter(|&(far, near)| same(far, near)).map(|(far, near)| vec![far, near]))
        .filter(|who| who.iter().all(|&c| free[c]));
    let moves: Vec<Vec<usize>> = moves.collect();
    let [forwards, backwards] = [false, true].map(|reverse| {
        let mut order = moves.clone();
        if reverse {
            // Moves of one part still come before those of two.
            order.reverse();
            order.sort_by_key(Vec::len);
        }
        moved(&scene, order, start.clone())
    });
    if scene.gain(&forwards, &backwards) > LEAST_GAIN { backwards } else { forwards }
}

/// The paths after rounds of moves in this order.
fn moved(scene: &cost::Scene, order: Vec<Vec<usize>>, mut paths: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut moves: Vec<Move> = order.into_iter().map(|who| Move::new(scene, who)).collect();
    let mut changed = Changes::none(&paths);
    for _ in 0..ROUNDS {
        let before = changed.count;
        round(scene, &mut moves, &mut paths, &mut changed);
        if changed.count == before {
            break;
        }
    }
    paths
}

/// By contender and drawing: how much energy the paths have to spare against another place ([`margin`]). Empty for
/// contenders that are not `free`.
pub fn margins(
    contenders: &[Contender],
    bonds: &Bonds,
    jump: f64,
    (paths, free): (&[Vec<usize>], &[bool]),
    memory: &mut Memory,
) -> Vec<Vec<f64>> {
    let shadows = Shadows::cast(contenders, memory);
    let companions = Companions::new(contenders, &bonds.companions);
    let figure = bonds.canvas.as_ref().map(|canvas| Figure::new(canvas, contenders, memory));
    let (ties, figure) = (&bonds.ties[..], figure.as_ref());
    let lengths = &memory.lengths(contenders);
    let scene = cost::Scene { contenders, shadows: &shadows, ties, companions: &companions, jump, lengths, figure };
    margin::margins(&scene, paths, free)
}

/// Tries all moves in their order. Most moves gain nothing, so the next few are computed in parallel. If one of these
/// few changes a path, the moves of the few that depend on it are computed again.
fn round(scene: &cost::Scene, moves: &mut [Move], paths: &mut [Vec<usize>], changed: &mut Changes) {
    let mut next = 0;
    while next < moves.len() {
        let due = |&m: &usize| moves[m].tried.is_none_or(|tried| changed.seen(&moves[m], tried));
        let few: Vec<usize> = (next..moves.len()).filter(due).take(AT_ONCE).collect();
        let Some(last) = few.last() else { return };
        let found: Vec<_> = few.par_iter().map(|&m| (m, scene.proposal(&moves[m], paths, changed))).collect();
        let keep = |(m, (proposal, tables)): (usize, (Option<Proposal>, Vec<Arc<Table>>))| {
            moves[m].tables = tables;
            (m, proposal)
        };
        let mut found: BTreeMap<usize, Option<Proposal>> = found.into_iter().map(keep).collect();
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
