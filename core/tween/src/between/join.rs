//! Movements between several keys in a row, joined with one velocity unless there is a corner in time or a hold.
//!
//! Between two keys a movement follows a path. Its progress along the path is a cubic of time. At a key, the direction
//! is the mean of the directions of both paths. The speed is their weighted harmonic mean (Fritsch & Butland 1984). It
//! shrinks as the directions differ more, and is zero where the movement turns back, so nothing overshoots a key. The
//! part of this velocity that does not point along a path is added to it as a cubic that vanishes at both keys. With
//! [`Asked::rest`], everything starts from rest at the first key and comes to rest at the last one.

use super::super::peg::Timing;
use super::super::peg::{hermite, monotone_slope};
use super::Spacing;

/// The progress of a movement between two keys.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    spacing: Option<Spacing>,
    slopes: (f64, f64),
    /// Velocities across the path at both ends, in units of the path per span.
    beside: Option<(Vec<f64>, Vec<f64>)>,
}

/// Derivatives of the paths of one movement at the ends of a span, with respect to the share 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ends {
    pub start: Vec<f64>,
    pub end: Vec<f64>,
}

/// The requirements for the spans and keys.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<'a> {
    /// Durations of the spans in frames.
    pub durations: &'a [f64],
    /// Spacing of each span.
    pub spacings: &'a [Spacing],
    /// For each key, whether velocities may break there.
    pub corners: &'a [bool],
    /// Whether movements start from rest at the first key and end at rest at the last one.
    pub rest: bool,
}

impl Run {
    /// The share of the way at `u`, the share of the span's time, 0 to 1.
    pub fn share(&self, u: f64) -> f64 {
        match &self.spacing {
            Some(spacing) => spacing.at(u),
            None => hermite(0.0, 1.0, self.slopes, u),
        }
    }

    /// The amount added to value `i` of the path at `u`.
    pub fn beside(&self, i: usize, u: f64) -> f64 {
        match &self.beside {
            Some((start, end)) => u * (1.0 - u) * ((1.0 - u) * start[i] - u * end[i]),
            None => 0.0,
        }
    }
}

/// The runs of a movement, one for each span. A span where the movement does not exist is `None` in `ends`.
pub(super) fn runs(ends: &[Option<Ends>], asked: &Asked) -> Vec<Run> {
    let mut runs: Vec<Run> = (0..ends.len())
        .map(|k| {
            let own = &asked.spacings[k];
            let spacing = (*own != Spacing::Smooth).then(|| own.clone());
            Run { spacing, slopes: (end_slope(asked, k, k), end_slope(asked, k, k + 1)), beside: None }
        })
        .collect();
    for k in 1..ends.len() {
        let smooth = asked.spacings[k - 1] == Spacing::Smooth && asked.spacings[k] == Spacing::Smooth;
        let (Some(before), Some(after)) = (&ends[k - 1], &ends[k]) else { continue };
        if smooth && !asked.corners[k] {
            let (first, second) = runs.split_at_mut(k);
            join(
                &mut first[k - 1],
                &before.end,
                asked.durations[k - 1],
                &mut second[0],
                &after.start,
                asked.durations[k],
            );
        }
    }
    runs
}

/// Slope of a smooth span at one of its keys, where nothing joins there.
fn end_slope(asked: &Asked, span: usize, key: usize) -> f64 {
    let outer = if key == span { span.checked_sub(1) } else { Some(span + 1).filter(|&k| k < asked.spacings.len()) };
    match outer.map(|k| &asked.spacings[k]) {
        None => f64::from(u8::from(!asked.rest)),
        Some(Spacing::Timing(Timing::Constant)) => 0.0,
        Some(_) => 1.0,
    }
}

fn join(first: &mut Run, incoming: &[f64], before: f64, second: &mut Run, outgoing: &[f64], after: f64) {
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (a, b) = (norm(incoming) / before, norm(outgoing) / after);
    let dot = incoming.iter().zip(outgoing).map(|(x, y)| x * y).sum::<f64>() / (before * after);
    if dot.is_nan() || dot <= 0.0 {
        (first.slopes.1, second.slopes.0) = (0.0, 0.0);
        return;
    }
    let speed = dot / (a * b) * monotone_slope(a, b, before, after);
    (first.slopes.1, second.slopes.0) = (speed / a, speed / b);
    let along: Vec<f64> = incoming.iter().zip(outgoing).map(|(x, y)| x / (before * a) + y / (after * b)).collect();
    let length = norm(&along).max(f64::MIN_POSITIVE);
    let rest = |own: &[f64], slope: f64, duration: f64| -> Vec<f64> {
        own.iter().zip(&along).map(|(v, d)| d / length * speed * duration - slope * v).collect()
    };
    let count = incoming.len();
    first.beside.get_or_insert_with(|| (vec![0.0; count], vec![0.0; count])).1 = rest(incoming, speed / a, before);
    second.beside.get_or_insert_with(|| (vec![0.0; count], vec![0.0; count])).0 = rest(outgoing, speed / b, after);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn straight(ways: &[[f64; 2]]) -> Vec<Option<Ends>> {
        ways.iter().map(|way| Some(Ends { start: way.to_vec(), end: way.to_vec() })).collect()
    }

    /// The place on a chain of straight paths at a time.
    fn place(runs: &[Run], ways: &[[f64; 2]], durations: &[f64], time: f64) -> [f64; 2] {
        let (mut start, mut k, mut at) = (0.0, 0, [0.0; 2]);
        while k + 1 < ways.len() && time >= start + durations[k] {
            start += durations[k];
            at = [at[0] + ways[k][0], at[1] + ways[k][1]];
            k += 1;
        }
        let u = (time - start) / durations[k];
        [0, 1].map(|i| at[i] + ways[k][i] * runs[k].share(u) + runs[k].beside(i, u))
    }

    proptest! {
        #[test]
        fn velocity_is_continuous_at_keys(
            ways in prop::collection::vec([-20.0f64..20.0, -20.0f64..20.0], 2..5),
            durations in prop::collection::vec(1.0f64..20.0, 5),
            rest in any::<bool>(),
        ) {
            let spacings = vec![Spacing::Smooth; ways.len()];
            let corners = vec![false; ways.len() + 1];
            let asked = Asked { durations: &durations[..ways.len()], spacings: &spacings, corners: &corners, rest };
            let runs = runs(&straight(&ways), &asked);
            let mut key = 0.0;
            for k in 1..ways.len() {
                key += durations[k - 1];
                let h = 1e-6;
                let [a, b, c] = [-h, 0.0, h].map(|d| place(&runs, &ways, &durations, key + d));
                for i in 0..2 {
                    prop_assert!(((b[i] - a[i]) - (c[i] - b[i])).abs() / h < 1e-3, "{:?} {:?} {:?}", a, b, c);
                }
            }
            if rest {
                let start = place(&runs, &ways, &durations, 1e-6);
                prop_assert!(start[0].hypot(start[1]) < 1e-9);
            }
        }
    }

    #[test]
    fn corners_and_turns_and_holds() {
        let ways = [[10.0, 0.0], [10.0, 0.0]];
        let run = |spacings: [Spacing; 2], corner: bool, ways: &[[f64; 2]]| {
            let asked =
                Asked { durations: &[10.0, 10.0], spacings: &spacings, corners: &[false, corner, false], rest: false };
            runs(&straight(ways), &asked)
        };
        let even = run([Spacing::Smooth, Spacing::Smooth], false, &ways);
        assert!((place(&even, &ways, &[10.0, 10.0], 7.0)[0] - 7.0).abs() < 1e-12);
        let turned = run([Spacing::Smooth, Spacing::Smooth], false, &[[10.0, 0.0], [-10.0, 1.0]]);
        assert_eq!((turned[0].slopes, turned[1].slopes), ((1.0, 0.0), (0.0, 1.0)));
        let corner = run([Spacing::Smooth, Spacing::Smooth], true, &[[10.0, 0.0], [-10.0, 1.0]]);
        assert_eq!((corner[0].slopes, corner[1].slopes), ((1.0, 1.0), (1.0, 1.0)));
        let held = run([Spacing::Smooth, Spacing::Timing(Timing::Constant)], false, &ways);
        assert_eq!((held[0].slopes.1, held[1].share(0.9)), (0.0, 0.0));
    }
}
