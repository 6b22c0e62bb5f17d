//! A joint choice: each point takes one of its candidates, so that the choices agree with each other.
//!
//! The sum of the costs of all choices and of all pairs of neighbours is made small by sequential min-sum belief
//! propagation: points are visited in their order and back, and each tells its neighbours what every choice of theirs would
//! cost. Neighbours on one stroke form chains, on which this is exact; between strokes it is approximate, and good where
//! neighbours agree. The order is fixed, so the result is too.

/// Neighbours and the strength of their tie.
#[derive(Clone, Copy, Debug)]
pub struct Tie {
    /// The first point.
    pub a: usize,
    /// The second point.
    pub b: usize,
    /// Factor of the pair's cost.
    pub weight: f32,
}

/// The chosen candidate of each point. `own[i][c]` is the cost of candidate `c` of point `i`; `pair(t, c, d)` that of the
/// candidates of both points of tie `t`.
pub fn choose(
    own: &[Vec<f32>],
    ties: &[Tie],
    pair: &(impl Fn(usize, usize, usize) -> f32 + Sync),
    rounds: usize,
) -> Vec<usize> {
    let mut around: Vec<Vec<(usize, bool)>> = vec![Vec::new(); own.len()];
    for (t, tie) in ties.iter().enumerate() {
        around[tie.a].push((t, false));
        around[tie.b].push((t, true));
    }
    let tables: Vec<Vec<f32>> = {
        use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
        let table = |(t, tie): (usize, &Tie)| {
            let (m, n) = (own[tie.a].len(), own[tie.b].len());
            (0..m * n).map(|k| tie.weight * pair(t, k / n, k % n)).collect()
        };
        ties.par_iter().enumerate().map(table).collect()
    };
    // Messages to the first and to the second point of each tie.
    let zeros = |i: usize| vec![0.0f32; own[i].len()];
    let mut messages: Vec<[Vec<f32>; 2]> = ties.iter().map(|tie| [zeros(tie.a), zeros(tie.b)]).collect();
    let belief = |messages: &[[Vec<f32>; 2]], i: usize| {
        let mut sum = own[i].clone();
        for &(t, second) in &around[i] {
            sum.iter_mut().zip(&messages[t][usize::from(second)]).for_each(|(s, m)| *s += m);
        }
        sum
    };
    for round in 0..2 * rounds {
        for k in 0..own.len() {
            let i = if round % 2 == 0 { k } else { own.len() - 1 - k };
            let sum = belief(&messages, i);
            for &(t, second) in &around[i] {
                let tie = ties[t];
                let other = if second { tie.a } else { tie.b };
                // Forth, points tell those behind them; back, those before them.
                if (other > i) != (round % 2 == 0) {
                    continue;
                }
                let [first, last] = &mut messages[t];
                let (mine, theirs) = if second { (last, first) } else { (first, last) };
                let without: Vec<f32> = sum.iter().zip(mine.iter()).map(|(s, m)| s - m).collect();
                let columns = own[tie.b].len();
                for (d, out) in theirs.iter_mut().enumerate() {
                    let cost =
                        |(c, w): (usize, &f32)| w + tables[t][if second { d * columns + c } else { c * columns + d }];
                    *out = without.iter().enumerate().map(cost).fold(f32::INFINITY, f32::min);
                }
                let least = theirs.iter().copied().fold(f32::INFINITY, f32::min);
                theirs.iter_mut().for_each(|m| *m -= least);
            }
        }
    }
    let least = |i: usize| {
        let sum = belief(&messages, i);
        (0..sum.len()).min_by(|&a, &b| sum[a].total_cmp(&sum[b])).unwrap_or(0)
    };
    (0..own.len()).map(least).collect()
}
