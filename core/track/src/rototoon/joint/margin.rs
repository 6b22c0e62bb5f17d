//! How sure the joint choice is of each part's place: its margin.
//!
//! **Why.** A wrong place may fit as well as the right one. What the choice knows beyond the fit (who hides whom, what hangs
//! together, how things move) is in the joint energy. If the part could be elsewhere for little more energy, it is not known
//! where it is.
//!
//! **How.** The other parts stay where they are. The margin of a part on a drawing is the energy that its best path through
//! another place on that drawing costs more than the chosen path. It is a difference of min-marginals ([`through`]). On each
//! drawing the path has the choice between the chosen hypothesis and the [`STATES`] hypotheses of least energy at other
//! places.
//!
//! **Limits.** A part that is wrong for the whole span has a large margin if everything fits there. Two parts that
//! could change places count one by one: an exchange that costs little is not seen if each half of it costs much.
//!
//! Source: min-marginals as a measure of confidence are by Kohli & Torr, "Measuring uncertainty in graph cut solutions",
//! 2008. For paths they are sums of a forward and a backward pass.

use super::contender::Paths;
use super::cost::Scene;
use crate::rototoon::select::Candidate;
use crate::rototoon::through::through;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

/// Hypotheses at other places that a path may take on a drawing.
const STATES: usize = 6;
/// A hypothesis is at another place if its mean distance exceeds the first number (working pixels) plus this share of the
/// part's size.
pub const ELSEWHERE: (f64, f64) = (3.0, 0.15);
/// Upper limit of a margin. A larger one adds no information.
pub const LARGEST: f64 = 1.0;

/// By contender and drawing: the margin, from 0 to [`LARGEST`]. The largest where there is no other place. Only contenders that
/// are `free` have margins.
pub fn margins(scene: &Scene, paths: &Paths, free: &[bool]) -> Vec<Vec<f64>> {
    let of = |c: usize| if free[c] { of_contender(scene, c, paths) } else { Vec::new() };
    (0..scene.contenders.len()).into_par_iter().with_max_len(1).map(of).collect()
}

fn of_contender(scene: &Scene, c: usize, paths: &Paths) -> Vec<f64> {
    let pools = scene.contenders[c].pools;
    let candidates: Vec<Vec<Candidate>> = (0..pools.len())
        .map(|d| {
            let own = paths[c][d];
            let states: Vec<usize> = std::iter::once(own).chain(elsewhere(scene, c, d, own)).collect();
            scene.candidates((c, d), &states, paths)
        })
        .collect();
    let (smoothness, gaps) = (scene.smoothness(c), &scene.contenders[c].gaps()[..]);
    let chosen: Vec<&[_]> = candidates.iter().map(|states| states[0].points).collect();
    let present = candidates.iter().map(|states| states[0].cost).sum::<f64>() + smoothness.of_path(&chosen, gaps);
    // A move of one part finds its best path among all hypotheses, so a negative margin is a rounding error, or the
    // path is one that only a move of two parts can leave.
    let margin = |costs: &Vec<f64>| costs[1..].iter().map(|cost| (cost - present).max(0.0)).fold(LARGEST, f64::min);
    through(&candidates, smoothness, gaps).iter().map(margin).collect()
}

/// The hypotheses of least energy at other places than the hypothesis `own` of a drawing.
fn elsewhere(scene: &Scene, c: usize, d: usize, own: usize) -> Vec<usize> {
    let contender = &scene.contenders[c];
    let (pool, size) = (&contender.pools[d], contender.models[0].texture.mesh.size);
    let far = |h: &usize| pool[*h].distance(&pool[own]) > ELSEWHERE.0 + ELSEWHERE.1 * size;
    let mut found: Vec<usize> = (0..pool.len()).filter(far).collect();
    found.sort_by(|&a, &b| pool[a].pose.energy.total_cmp(&pool[b].pose.energy));
    found.truncate(STATES);
    found
}
