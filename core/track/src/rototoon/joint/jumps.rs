//! How far the drawings of a stretch jump.
//!
//! **Why.** A choice prefers even motion. On film with a drawing for every frame that is right. A run of six hand-made
//! drawings has none: a limb swings by more than its own width and back within three drawings, and an even path past the
//! wrong places costs less than the right one.
//!
//! **How.** On each drawing a part's hypothesis of least energy is taken, whatever the motion. Three drawings in a row give
//! a second difference |Δ²|, which is 0 for even motion. Most parts are found rightly in this way, so the median of all says
//! how uneven the motion is. A stretch's jump is three times this median, and the motion cost counts lengths in units of at
//! least that length. Where motion is even, the jump is shorter than the unit that a part has by its size.
//!
//! **Limits.** One restless part among still ones is not noticed.

use super::contender::Contender;
use crate::rototoon::pool::Hypothesis;
use crate::rototoon::select::bends_over;
use rototoon_base::geometry::Point;

/// The jump, in units of the median second difference.
const TIMES: f64 = 3.0;

/// The jump of a stretch in working pixels.
pub fn measured(contenders: &[Contender]) -> f64 {
    let mut found: Vec<f64> = contenders.iter().flat_map(second_differences).collect();
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).map_or(0.0, |median| TIMES * median)
}

/// The second differences of a part's best hypotheses: mean lengths over its points. None across gaps.
fn second_differences(contender: &Contender) -> Vec<f64> {
    let gaps = contender.gaps();
    let best = |pool: &'_ Vec<Hypothesis>| -> Option<Vec<Point>> {
        let least = pool.iter().min_by(|a, b| a.pose.energy.total_cmp(&b.pose.energy));
        least.map(|hypothesis| hypothesis.points.clone())
    };
    let best: Vec<Vec<Point>> = contender.pools.iter().filter_map(best).collect();
    let of = |three: &[Vec<Point>]| {
        let [a, b, c] = [&three[0], &three[1], &three[2]];
        (0..b.len()).map(|k| (a[k] - 2.0 * b[k] + c[k]).length()).sum::<f64>() / b.len().max(1) as f64
    };
    let whole = best.windows(3).enumerate().filter(|(d, _)| !bends_over(&gaps, d + 2));
    whole.map(|(_, three)| of(three)).collect()
}
