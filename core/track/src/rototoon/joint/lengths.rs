//! Lengths of motion between the hypotheses of a contender, kept while its pools are the same.
//!
//! The cost of motion is asked for again and again for the same hypotheses: in each move of a contender alone or with
//! another one, in each round, and in each run. It is a mean over all control points, so a look-up is much quicker. A length
//! is found when it is asked for first: a search for the best path needs few of all triples.
//!
//! **Limits.** Of pools with more than [`MOST`] triples on neighbouring drawings nothing is kept.

use crate::rototoon::pool::Pools;
use crate::rototoon::select::{Motion, Smoothness, bends_over, mean_bend, mean_shift};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Most triples of hypotheses on neighbouring drawings whose lengths are kept.
const MOST: usize = 1 << 15;

/// Lengths of motion between the hypotheses of a contender, in working pixels.
pub struct Lengths {
    pools: Arc<Pools>,
    /// By drawing of the last hypothesis. Empty where nothing is kept.
    shifts: Vec<Vec<Length>>,
    bends: Vec<Vec<Length>>,
    /// The drawings that begin after a gap.
    gaps: Vec<usize>,
}

/// A length that may be unknown yet. Threads may find it at the same time; all find the same.
struct Length(AtomicU64);

impl Length {
    fn unknown() -> Self {
        Self(AtomicU64::new(f64::NAN.to_bits()))
    }

    fn get(&self, find: impl FnOnce() -> f64) -> f64 {
        let known = f64::from_bits(self.0.load(Ordering::Relaxed));
        if !known.is_nan() {
            return known;
        }
        let found = find();
        self.0.store(found.to_bits(), Ordering::Relaxed);
        found
    }
}

impl Lengths {
    /// The lengths of these pools, all unknown. Before these drawings is a gap: across it nothing bends.
    pub fn new(pools: &Arc<Pools>, gaps: Vec<usize>) -> Self {
        let count = |d: usize| pools[d].len();
        let list = |length: usize| (0..length).map(|_| Length::unknown()).collect();
        let shifts = |d: usize| list(if d < 1 { 0 } else { count(d - 1) * count(d) });
        let bends = |d: usize| {
            let triples = if d < 2 { 0 } else { count(d - 2) * count(d - 1) * count(d) };
            list(if triples > MOST { 0 } else { triples })
        };
        let drawings = 0..pools.len();
        Self {
            pools: pools.clone(),
            shifts: drawings.clone().map(shifts).collect(),
            bends: drawings.map(bends).collect(),
            gaps,
        }
    }

    fn shift(&self, d: usize, [g, h]: [usize; 2]) -> f64 {
        let find = || mean_shift(&self.pools[d - 1][g].points, &self.pools[d][h].points);
        self.shifts[d][g * self.pools[d].len() + h].get(find)
    }

    fn bend(&self, d: usize, [f, g, h]: [usize; 3]) -> f64 {
        if bends_over(&self.gaps, d) {
            return 0.0;
        }
        let pools = &self.pools;
        let find = || mean_bend(&pools[d - 2][f].points, &pools[d - 1][g].points, &pools[d][h].points);
        let place = (f * pools[d - 1].len() + g) * pools[d].len() + h;
        self.bends[d].get(place).map_or_else(find, |length| length.get(find))
    }
}

/// The cost of motion of a contender, by its hypotheses.
pub struct Moving<'a> {
    /// The lengths.
    pub lengths: &'a Lengths,
    /// The cost of lengths.
    pub smoothness: Smoothness,
}

impl Motion for Moving<'_> {
    fn speed(&self, d: usize, states: [usize; 2]) -> f64 {
        self.smoothness.of_step(self.lengths.shift(d, states), (d, &self.lengths.gaps))
    }

    fn acceleration(&self, d: usize, states: [usize; 3]) -> f64 {
        self.smoothness.of_bend(self.lengths.bend(d, states))
    }
}

/// The same by places in lists of hypotheses, one list for each drawing.
pub struct Among<'a> {
    /// The cost by hypotheses.
    pub moving: Moving<'a>,
    /// By drawing: the hypotheses.
    pub states: &'a [Vec<usize>],
}

impl Motion for Among<'_> {
    fn speed(&self, d: usize, [g, h]: [usize; 2]) -> f64 {
        self.moving.speed(d, [self.states[d - 1][g], self.states[d][h]])
    }

    fn acceleration(&self, d: usize, [f, g, h]: [usize; 3]) -> f64 {
        self.moving.acceleration(d, [self.states[d - 2][f], self.states[d - 1][g], self.states[d][h]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rototoon::pool::Hypothesis;
    use crate::rototoon::propagate::Pose;
    use crate::rototoon::select::Direct;
    use rototoon_base::geometry::Point;

    /// Three drawings with some hypotheses of two points each.
    fn pools(counts: [usize; 3]) -> Arc<Pools> {
        let hypothesis = |d: usize, h: usize| {
            let place = |k: usize| Point::new((7 * d * d + 3 * h * (k + 1)) as f64, (h * h + 5 * k) as f64);
            let pose = Pose { nodes: Vec::new(), energy: 0.0 };
            Hypothesis::new(0, pose, vec![place(0), place(1)], Vec::new())
        };
        Arc::new((0..3).map(|d| (0..counts[d]).map(|h| hypothesis(d, h)).collect()).collect())
    }

    #[test]
    fn kept_lengths_cost_what_the_points_cost() {
        for counts in [[2, 3, 4], [33, 33, 33]] {
            let pools = pools(counts);
            let lengths = Lengths::new(&pools, Vec::new());
            let candidates: Vec<Vec<_>> =
                pools.iter().map(|pool| pool.iter().map(Hypothesis::candidate).collect()).collect();
            let smoothness = Smoothness::new(30.0);
            let direct = Direct { candidates: &candidates, smoothness, gaps: &[] };
            let moving = Moving { lengths: &lengths, smoothness };
            // Twice: found, then known.
            for _ in 0..2 {
                for (f, g, h) in [(0, 0, 0), (1, 2, 3), (0, 1, 2)] {
                    assert_eq!(moving.speed(1, [f, g]), direct.speed(1, [f, g]));
                    assert_eq!(moving.acceleration(2, [f, g, h]), direct.acceleration(2, [f, g, h]));
                }
            }
            let states = [vec![1], vec![2, 0], vec![3, 1]];
            let among = Among { moving, states: &states };
            assert_eq!(among.speed(2, [0, 1]), direct.speed(2, [2, 1]));
            assert_eq!(among.acceleration(2, [0, 1, 0]), direct.acceleration(2, [1, 0, 3]));
        }
    }
}
