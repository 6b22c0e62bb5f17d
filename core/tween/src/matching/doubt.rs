//! Doubt about strokes for which another assignment is nearly as good.
//!
//! A lock of hair is surely this one as long as its neighbours are these. But all of them may be shifted by one: each then has the right neighbours
//! again, and no single lock shows the mistake. So the assignments that were found under other movements of the drawing are compared with the one that is taken
//! (`movement`). What the other one costs more is shared among the strokes that it sees otherwise: this is by how much each of them is sure.

use super::movement::Other;
use super::relaxation::{Chosen, margin};

/// Lowers the confidence of strokes of which another assignment says something else. `others` cost more than what is taken by their `more`.
/// `firsts` has for each counterpart the first one that is the same.
pub(super) fn lower(found: &mut [Option<Chosen>], others: &[Other], firsts: &[usize]) {
    for other in others {
        let differs = |(choice, to): (&Option<Chosen>, &Option<usize>)| {
            choice.as_ref().zip(*to).is_some_and(|(choice, to)| firsts[choice.to] != firsts[to])
        };
        let differing: Vec<usize> =
            found.iter().zip(&other.to).enumerate().filter(|(_, pair)| differs(*pair)).map(|(i, _)| i).collect();
        let sure = margin(other.more.max(0.0) / differing.len().max(1) as f64);
        for i in differing {
            if let Some(choice) = &mut found[i] {
                choice.confidence = choice.confidence.min(sure);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::outline::Way;
    use super::*;

    #[test]
    fn a_shift_by_one_that_costs_little_more_is_doubted() {
        let way = Way { residual: 0.0, turn: 0.0, reversed: false, start: 0.0, exact: false };
        let taken = || (0..4).map(|to| Some(Chosen { to, way, confidence: 0.97 })).collect::<Vec<_>>();
        let lowered = |more: f64, to: [usize; 4]| -> Vec<f64> {
            let mut found = taken();
            lower(&mut found, &[Other { more, to: to.map(Some).to_vec() }], &[0, 1, 2, 3]);
            found.into_iter().flatten().map(|choice| choice.confidence).collect()
        };
        let shifted = lowered(0.2, [0, 2, 3, 1]);
        assert!(shifted[0] == 0.97 && shifted[1..].iter().all(|sure| (0.5..0.7).contains(sure)), "{shifted:?}");
        assert_eq!(lowered(9.0, [0, 2, 3, 1]), [0.97; 4], "it costs much more");
        assert_eq!(lowered(0.0, [0, 1, 2, 3]), [0.97; 4], "it says the same");
    }
}
