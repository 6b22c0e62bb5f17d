//! Smooths the motion of parts of one body together.
//!
//! The centre of a head that nods is uneven, and so is that of its eye. Their difference is even, and its second differences
//! are small, but for noise. So the smoothness of [`super::smooth`] is asked of the differences of pairs of parts, each pair
//! with the variance of its own motion, and the series of all parts are found at once. Where many parts hang together this is
//! nearly the mean of their errors. Parts that do not hang together have a large variance, and leave each other alone. The same
//! holds for how parts turn and grow.
//!
//! A part has pairs with the few parts against which it moves most evenly. Pairs have the same keys. Drawings that only one
//! of them has, because a correction divides a held drawing, are left out.

use super::Member;
use super::noise::{Differences, weights};
use super::smooth::{STAYS, mean_square, tension};
use rototoon_base::numeric::banded::BandMatrix;
use rototoon_base::scene::Span;
use std::collections::{BTreeMap, BTreeSet};

/// The variance of the motion of pairs of parts, which are named by their keys.
pub type Pairs = BTreeMap<[(String, Span); 2], f64>;

/// How many standard deviations a second difference may have before it counts as drawn.
const USUAL: f64 = 2.0;
/// Number of times that the weights are computed.
const ROUNDS: usize = 6;
/// Least variance of a pair's motion, as a multiple of the mean noise of both parts.
const LEAST: f64 = 1.0;

/// A pair of parts: their indices in the group, the mean variance of their noise, and that of their motion.
struct Pair {
    parts: [usize; 2],
    noise: f64,
    motion: f64,
}

/// Three drawings in a row that both parts of a pair have: the pair, the indices of the first drawings, and the weights.
struct Triple {
    pair: usize,
    first: [usize; 2],
    weights: [f64; 3],
}

/// A series of each part of a group: by part, by drawing, two numbers.
pub type Series = Vec<Vec<Vec<f64>>>;

/// The pairs of a group, at least `most` with each part, each with the variance of its motion.
pub fn found(group: &[Member], series: &Series, most: usize) -> Pairs {
    let mut measured: BTreeMap<[usize; 2], Differences> = BTreeMap::new();
    for a in 0..group.len() {
        for b in a + 1..group.len() {
            if let Some(differences) = between([&group[a], &group[b]], [&series[a], &series[b]]) {
                measured.insert([a, b], differences);
            }
        }
    }
    let mut chosen = BTreeSet::new();
    for a in 0..group.len() {
        let of_part = measured.iter().filter(|(pair, _)| pair.contains(&a));
        let mut own: Vec<(f64, [usize; 2])> = of_part.map(|(pair, found)| (found.variance(), *pair)).collect();
        own.sort_by(|x, y| x.0.total_cmp(&y.0));
        chosen.extend(own.iter().take(most).map(|(_, pair)| *pair));
    }
    let motion = |pair: &[usize; 2]| measured[pair].split().motion;
    chosen.iter().map(|pair| (pair.map(|m| group[m].key.clone()), motion(pair))).collect()
}

/// The second differences of the difference of two parts' series. `None` if the parts have different drawings, or few.
fn between(members: [&Member; 2], series: [&[Vec<f64>]; 2]) -> Option<Differences> {
    let [a, b] = members;
    if a.key.1 != b.key.1 || a.times != b.times || a.times.len() < 5 {
        return None;
    }
    let apart: Vec<Vec<f64>> = series[0].iter().zip(series[1]).map(|(a, b)| vec![a[0] - b[0], a[1] - b[1]]).collect();
    let mut differences = Differences::default();
    differences.add(&a.times, &apart);
    Some(differences)
}

/// The series of all parts of a group, smoothed. `noise` has the variance of each part's noise.
pub fn smoothed(group: &[Member], start: Series, noise: &[f64], pairs: &Pairs) -> Series {
    let index = |key: &(String, Span)| group.iter().position(|member| member.key == *key);
    let pair = |([a, b], &motion): (&[(String, Span); 2], &f64)| {
        let parts = [index(a)?, index(b)?];
        let noise = (noise[parts[0]] + noise[parts[1]]) / 2.0;
        Some(Pair { parts, noise, motion: motion.max(LEAST * noise) })
    };
    let pairs: Vec<Pair> = pairs.iter().filter_map(pair).collect();
    let triples: Vec<Triple> = (0..pairs.len()).flat_map(|p| triples(group, pairs[p].parts, p)).collect();
    if noise.iter().any(|&noise| noise <= 0.0) || triples.is_empty() {
        return start;
    }
    let system = System::new(group, &pairs, &triples, noise);
    let mut found = start.clone();
    for round in 0..ROUNDS {
        let Some(next) = system.solved(&start, &found, round == 0) else { return start };
        found = next;
    }
    found
}

/// The drawings in a row that both parts of a pair have.
fn triples(group: &[Member], [a, b]: [usize; 2], pair: usize) -> Vec<Triple> {
    let (a, b) = (&group[a].times, &group[b].times);
    let triple = |i: usize| {
        let j = b.iter().position(|time| *time == a[i])?;
        let same = j + 2 < b.len() && a[i..i + 3] == b[j..j + 3];
        same.then(|| Triple { pair, first: [i, j], weights: weights(&a[i..i + 3]) })
    };
    (0..a.len().saturating_sub(2)).filter_map(triple).collect()
}

/// The normal equations of all series.
struct System<'a> {
    group: &'a [Member],
    pairs: &'a [Pair],
    triples: &'a [Triple],
    /// By member: the variance of its noise.
    noise: &'a [f64],
    /// By member and drawing: the number of the unknown. Unknowns are numbered by time, so the matrix is a band.
    number: Vec<Vec<usize>>,
    count: usize,
    half: usize,
}

impl<'a> System<'a> {
    fn new(group: &'a [Member], pairs: &'a [Pair], triples: &'a [Triple], noise: &'a [f64]) -> Self {
        let all = |m: usize| (0..group[m].times.len()).map(move |d| (m, d));
        let mut order: Vec<(usize, usize)> = (0..group.len()).flat_map(all).collect();
        order.sort_by(|x, y| group[x.0].times[x.1].total_cmp(&group[y.0].times[y.1]));
        let mut number: Vec<Vec<usize>> = group.iter().map(|member| vec![0; member.times.len()]).collect();
        order.iter().enumerate().for_each(|(k, &(m, d))| number[m][d] = k);
        let mut system = Self { group, pairs, triples, noise, number, count: order.len(), half: 0 };
        let spread = |triple: &Triple| {
            let entries = system.entries(triple);
            let numbers = || entries.iter().map(|(k, _)| *k);
            numbers().max().unwrap_or(0) - numbers().min().unwrap_or(0)
        };
        system.half = triples.iter().map(spread).max().unwrap_or(0);
        system
    }

    /// The unknowns of a triple's second difference, with their factors.
    fn entries(&self, triple: &Triple) -> [(usize, f64); 6] {
        let ([a, b], [i, j]) = (self.pairs[triple.pair].parts, triple.first);
        let w = triple.weights;
        [
            (self.number[a][i], w[0]),
            (self.number[a][i + 1], w[1]),
            (self.number[a][i + 2], w[2]),
            (self.number[b][j], -w[0]),
            (self.number[b][j + 1], -w[1]),
            (self.number[b][j + 2], -w[2]),
        ]
    }

    /// The weight of a triple at these values.
    fn weight(&self, triple: &Triple, values: &Series, first: bool) -> f64 {
        let Pair { parts: [a, b], noise, motion } = self.pairs[triple.pair];
        let [i, j] = triple.first;
        let apart = |t: usize, k: usize| values[a][i + t][k] - values[b][j + t][k];
        let difference = [0, 1].map(|k| (0..3).map(|t| triple.weights[t] * apart(t, k)).sum::<f64>());
        let usual = USUAL * USUAL * (motion + if first { 12.0 * noise } else { noise });
        tension(mean_square(&difference), usual) / motion
    }

    /// The series for the weights that `values` give.
    fn solved(&self, start: &Series, values: &Series, first: bool) -> Option<Series> {
        let mut matrix = BandMatrix::zeros(self.count, self.half);
        let mut sides = [vec![0.0; self.count], vec![0.0; self.count]];
        for (m, member) in self.group.iter().enumerate() {
            for (d, &set) in member.set.iter().enumerate() {
                let (k, trust) = (self.number[m][d], if set { STAYS / self.noise[m] } else { 1.0 / self.noise[m] });
                matrix.add(k, k, trust);
                sides.iter_mut().zip(&start[m][d]).for_each(|(side, x)| side[k] = trust * x);
            }
        }
        for triple in self.triples {
            let (weight, entries) = (self.weight(triple, values, first), self.entries(triple));
            for (n, &(i, a)) in entries.iter().enumerate() {
                entries[n..].iter().for_each(|&(j, b)| matrix.add(i, j, weight * a * b));
            }
        }
        let factor = matrix.factor().ok()?;
        sides.iter_mut().for_each(|side| factor.solve_in_place(side));
        let of_member = |numbers: &Vec<usize>| numbers.iter().map(|&k| vec![sides[0][k], sides[1][k]]).collect();
        Some(self.number.iter().map(of_member).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion::Motion;
    use super::super::tests::{Random, member};
    use super::*;
    use rototoon_base::geometry::Point;

    /// Three parts of a head that nods unevenly, and one that goes its own uneven way, with noise of variance `noise`.
    fn scene(noise: f64, nod: &dyn Fn(usize) -> Point) -> (Vec<Member>, Series) {
        let (mut random, mut own) = (Random::new(11), Random::new(12));
        let mut group = Vec::new();
        for m in 0..4 {
            let mut place = |d: usize| {
                let wobble = Point::new(random.normal(), random.normal()) * noise.sqrt();
                let way = if m == 3 { Point::new(own.normal(), own.normal()) * 20.0 } else { nod(d) };
                way + wobble + Point::new(30.0 * f64::from(m), 0.1 * d as f64)
            };
            group.push(member(&format!("part {m}"), (0..16).map(|d| vec![place(d)]).collect()));
        }
        let centres = group.iter().map(|member| Motion::of(&member.times, &member.points).centres).collect();
        (group, centres)
    }

    fn nod(d: usize) -> Point {
        Point::new(0.0, [0.0, 9.0, -4.0, 7.0, 1.0][d * 7 % 5])
    }

    #[test]
    fn parts_of_one_body_lose_their_noise_and_keep_their_motion() {
        let (group, centres) = scene(1.0, &nod);
        let smooth = smoothed(&group, centres.clone(), &[1.0; 4], &found(&group, &centres, 4));
        let error = |of_part: &dyn Fn(usize, usize) -> Vec<f64>| -> f64 {
            let of = |m: usize, d: usize| {
                let truth = nod(d) + Point::new(30.0 * m as f64, 0.1 * d as f64);
                (of_part(m, d)[0] - truth.x).powi(2) + (of_part(m, d)[1] - truth.y).powi(2)
            };
            (0..3).flat_map(|m| (1..15).map(move |d| (m, d))).map(|(m, d)| of(m, d)).sum()
        };
        let (before, after) = (error(&|m, d| centres[m][d].clone()), error(&|m, d| smooth[m][d].clone()));
        assert!(after < 0.7 * before, "{after} of {before}");
        let moved = (1..15).map(|d| (smooth[3][d][0] - centres[3][d][0]).abs()).fold(0.0, f64::max);
        assert!(moved < 0.5, "a part by itself moved by {moved}");
    }

    #[test]
    fn a_motion_of_all_parts_is_not_smoothed_at_all() {
        let (group, centres) = scene(0.5, &nod);
        let (still_group, still) = scene(0.5, &|_| Point::ZERO);
        // The pairs of the still scene, since the single part's own way is no motion of all.
        let pairs: Pairs = found(&still_group, &still, 4)
            .into_iter()
            .filter(|([a, b], _)| a.0 != "part 3" && b.0 != "part 3")
            .collect();
        let (moving, resting) =
            (smoothed(&group, centres, &[0.5; 4], &pairs), smoothed(&still_group, still, &[0.5; 4], &pairs));
        for m in 0..3 {
            for d in 1..15 {
                let difference = moving[m][d][1] - resting[m][d][1] - nod(d).y;
                assert!(difference.abs() < 1e-4, "part {m}, drawing {d}: {difference}");
            }
        }
    }

    #[test]
    fn parts_with_other_keys_are_no_pairs() {
        let (mut group, centres) = scene(1.0, &nod);
        (0..4).for_each(|m| group[m].key.1.last += m as i32);
        assert!(found(&group, &centres, 4).is_empty());
        assert!(smoothed(&group, centres.clone(), &[1.0; 4], &Pairs::new()) == centres);
    }

    #[test]
    fn a_drawing_that_only_one_part_has_is_left_out() {
        let (mut group, _) = scene(1.0, &nod);
        group[1].times[7] += 0.5;
        let all = triples(&group, [0, 2], 0).len();
        assert_eq!((all, triples(&group, [0, 1], 0).len()), (14, 11));
    }
}
