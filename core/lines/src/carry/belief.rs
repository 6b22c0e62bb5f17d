//! A joint choice: each point takes one of its candidates, so that the choices agree with each other.
//!
//! The sum of the costs of all choices and of all pairs of neighbours is made small by sequential min-sum belief
//! propagation: points are visited in their order and back, and each tells its neighbours what every choice of theirs would
//! cost. Neighbours on one stroke form chains, on which this is exact; between strokes it is approximate, and good where
//! neighbours agree. The order is fixed, so the result is too.

use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

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
    let net = Net::new(own, ties, pair);
    let mut messages = net.no_messages();
    for round in 0..2 * rounds {
        let forth = round % 2 == 0;
        for k in 0..own.len() {
            let i = if forth { k } else { own.len() - 1 - k };
            let sum = net.belief(&messages, i);
            for &(t, second) in &net.around[i] {
                let other = if second { ties[t].a } else { ties[t].b };
                // Forth, points tell those behind them; back, those before them.
                if (other > i) == forth {
                    net.tell(&sum, (t, second), &mut messages[t]);
                }
            }
        }
    }
    let least = |i: usize| {
        let sum = net.belief(&messages, i);
        (0..sum.len()).min_by(|&a, &b| sum[a].total_cmp(&sum[b])).unwrap_or(0)
    };
    (0..own.len()).map(least).collect()
}

/// Messages along a tie: to its first and to its second point, one value for each candidate there.
type Messages = [Vec<f32>; 2];

/// Points and their ties.
struct Net<'a> {
    own: &'a [Vec<f32>],
    ties: &'a [Tie],
    /// The ties of each point, and whether it is the tie's second point.
    around: Vec<Vec<(usize, bool)>>,
    /// The weighted costs of each tie, twice: a row for each candidate of its first point, and one for each of its second point. So whichever point tells,
    /// costs that are read one after the other lie beside each other.
    tables: Vec<[Vec<f32>; 2]>,
}

impl<'a> Net<'a> {
    fn new(own: &'a [Vec<f32>], ties: &'a [Tie], pair: &(impl Fn(usize, usize, usize) -> f32 + Sync)) -> Self {
        let mut around: Vec<Vec<(usize, bool)>> = vec![Vec::new(); own.len()];
        for (t, tie) in ties.iter().enumerate() {
            around[tie.a].push((t, false));
            around[tie.b].push((t, true));
        }
        let table = |(t, tie): (usize, &Tie)| {
            let (m, n) = (own[tie.a].len(), own[tie.b].len());
            let rows: Vec<f32> = (0..m * n).map(|k| tie.weight * pair(t, k / n, k % n)).collect();
            let columns = (0..m * n).map(|k| rows[k % m * n + k / m]).collect();
            [rows, columns]
        };
        let tables = ties.par_iter().enumerate().map(table).collect();
        Self { own, ties, around, tables }
    }

    fn no_messages(&self) -> Vec<Messages> {
        let zeros = |i: usize| vec![0.0f32; self.own[i].len()];
        self.ties.iter().map(|tie| [zeros(tie.a), zeros(tie.b)]).collect()
    }

    /// What each candidate of a point costs, with all that its neighbours tell it.
    fn belief(&self, messages: &[Messages], i: usize) -> Vec<f32> {
        let mut sum = self.own[i].clone();
        for &(t, second) in &self.around[i] {
            sum.iter_mut().zip(&messages[t][usize::from(second)]).for_each(|(s, m)| *s += m);
        }
        sum
    }

    /// Tells the other point of a tie what each choice of it would cost. `sum` is the belief of the point that tells, which
    /// is the tie's second one if `second`. What the other point told before is taken out of it.
    fn tell(&self, sum: &[f32], (t, second): (usize, bool), messages: &mut Messages) {
        let [first, last] = messages;
        let (mine, theirs) = if second { (last, first) } else { (first, last) };
        let without: Vec<f32> = sum.iter().zip(mine.iter()).map(|(s, m)| s - m).collect();
        let rows = self.tables[t][usize::from(second)].chunks_exact(theirs.len().max(1));
        theirs.fill(f32::INFINITY);
        for (w, row) in without.iter().zip(rows) {
            theirs.iter_mut().zip(row).for_each(|(out, cost)| *out = out.min(w + cost));
        }
        let least = theirs.iter().copied().fold(f32::INFINITY, f32::min);
        theirs.iter_mut().for_each(|m| *m -= least);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A made-up cost.
    fn cost(seed: usize) -> f32 {
        (seed.wrapping_mul(2_654_435_761) % 1009) as f32 / 100.0
    }

    #[test]
    fn on_a_chain_the_choice_is_the_best_of_all() {
        for seed in 0..40 {
            let counts = [3, 1, 4, 2, 5];
            let own: Vec<Vec<f32>> =
                (0..5).map(|i| (0..counts[i]).map(|c| cost(seed + 31 * i + c)).collect()).collect();
            // A tie may name the later point first.
            let tie = |i: usize| if (i + seed).is_multiple_of(2) { (i, i + 1) } else { (i + 1, i) };
            let ties: Vec<Tie> = (0..4).map(tie).map(|(a, b)| Tie { a, b, weight: 0.5 }).collect();
            let pair = |t: usize, c: usize, d: usize| cost(7 * seed + 97 * t + 13 * c + 5 * d);
            let sum = |chosen: &[usize]| -> f32 {
                let single: f32 = chosen.iter().enumerate().map(|(i, &c)| own[i][c]).sum();
                let both = |(t, tie): (usize, &Tie)| tie.weight * pair(t, chosen[tie.a], chosen[tie.b]);
                single + ties.iter().enumerate().map(both).sum::<f32>()
            };
            let all = (0..counts.iter().product()).map(|mut k: usize| {
                counts.map(|count| {
                    let c = k % count;
                    k /= count;
                    c
                })
            });
            let best = all.map(|chosen| sum(&chosen)).fold(f32::INFINITY, f32::min);
            let found = sum(&choose(&own, &ties, &pair, 2));
            assert!((found - best).abs() < 1e-3, "{seed}: {found} {best}");
        }
    }
}
