//! In-betweens of fragmented drawings: each contour is cut into pieces, differently on each key, as automatic tracing does.
//!
//! The strokes are matched, nothing is told about which piece is which. The in-betweens are compared with the true ink on each
//! frame, as is a rival that draws nothing: it holds the earlier key.

use super::Set;
use super::matching::Chance;
use anyhow::Result;
use rototoon::geometry::{Point, polyline};
use rototoon::scene::Silent;
use rototoon::tween::Stroke;
use rototoon::tween::between::{GivenPegs, Key, Options, Sequence};
use rototoon::tween::matching::{self, match_strokes};

/// Distance of the samples along the ink, in pixels.
const STEP: f64 = 4.0;
/// Distances above this count as this, in pixels: the ink is missing.
const MOST: f64 = 24.0;

/// Sums of the distances between drawn and true ink, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InkErrors {
    /// Number of frames.
    pub frames: usize,
    /// Of the earlier key, held.
    pub held: f64,
    /// Of Rototoon.
    pub ours: f64,
    /// Spans, and those on which Rototoon is farther from the truth than holding.
    pub spans: (usize, usize),
    /// Right and wrong pairs.
    pub pairs: (usize, usize),
}

impl InkErrors {
    /// Adds other sums.
    pub fn add(&mut self, other: Self) {
        self.frames += other.frames;
        self.held += other.held;
        self.ours += other.ours;
        self.spans = (self.spans.0 + other.spans.0, self.spans.1 + other.spans.1);
        self.pairs = (self.pairs.0 + other.pairs.0, self.pairs.1 + other.pairs.1);
    }
}

/// Measures the frames between two keys. `cuts` is the greatest number of pieces of a contour.
pub fn measure(set: &Set, (from, to): (i32, i32), cuts: usize, chance: &mut Chance) -> Result<InkErrors> {
    let there: Vec<usize> = (0..set.parts.len())
        .filter(|&i| (from..=to).all(|f| set.parts[i].points.get(&f).is_some_and(|p| p.len() > 3)))
        .collect();
    let mut drawn = |frame: i32| -> Vec<(usize, Stroke)> {
        let pieces = there.iter().flat_map(|&i| {
            let part = &set.parts[i];
            pieces(&part.points[&frame], part.closed, cuts, chance).into_iter().map(move |stroke| (i, stroke))
        });
        let pieces: Vec<(usize, Stroke)> = pieces.collect();
        let order = chance_order(pieces.len(), frame);
        order.into_iter().map(|k| pieces[k].clone()).collect()
    };
    let (first, second) = (drawn(from), drawn(to));
    let strokes = |of: &[(usize, Stroke)]| of.iter().map(|(_, stroke)| stroke.clone()).collect::<Vec<_>>();
    let (a, b) = (strokes(&first), strokes(&second));
    let matching = match_strokes(&a, &b, &[], &matching::Options::default(), &Silent)?;
    let mut errors = InkErrors::default();
    for pair in &matching.pairs {
        let right = first[pair.from].0 == second[pair.to].0;
        *(if right { &mut errors.pairs.0 } else { &mut errors.pairs.1 }) += 1;
        if std::env::var_os("BENCH_TWEEN_WRONG").is_some() {
            println!("  confidence {:.3} {right}", pair.confidence);
        }
    }
    let held = ink(a.iter().map(|s| (&s.points[..], s.closed)));
    let keys = vec![Key { frame: from, strokes: a, ..Key::default() }, Key { frame: to, strokes: b, ..Key::default() }];
    let sequence = Sequence::new(keys, &[matching], &GivenPegs::default(), &Options::default())?;
    for frame in from + 1..to {
        let truth = ink(there.iter().map(|&i| (&set.parts[i].points[&frame][..], set.parts[i].closed)));
        let between = sequence.at(frame);
        let ours = ink(between.iter().map(|d| (&d.stroke.points[..], d.stroke.closed)));
        errors.frames += 1;
        errors.held += apart(&held, &truth);
        errors.ours += apart(&ours, &truth);
    }
    errors.spans = (1, usize::from(errors.ours > errors.held));
    Ok(errors)
}

fn chance_order(count: usize, frame: i32) -> Vec<usize> {
    Chance(u64::from(frame.unsigned_abs()) + 77).order(count)
}

/// A contour in one to `most` pieces, with gaps of up to an eighth of a piece between them.
fn pieces(points: &[Point], closed: bool, most: usize, chance: &mut Chance) -> Vec<Stroke> {
    let count = 1 + chance.below(most);
    if count == 1 {
        return vec![Stroke::new(points.to_vec(), closed)];
    }
    let dense = polyline::resample(points, closed, 48 * count);
    let shift = if closed { chance.below(dense.len()) } else { 0 };
    let mut turned = dense;
    turned.rotate_left(shift);
    let ends: Vec<usize> =
        (0..=count).map(|k| if k == 0 || k == count { 48 * k } else { 48 * k + chance.below(25) - 12 }).collect();
    ends.windows(2)
        .map(|pair| {
            let gap = chance.below(7);
            let mut piece: Vec<Point> = turned[pair[0]..pair[1] - gap.min(pair[1] - pair[0] - 8)].to_vec();
            if chance.below(2) == 0 {
                piece.reverse();
            }
            Stroke::new(piece, false)
        })
        .collect()
}

/// Points at even distances along lines.
fn ink<'a>(lines: impl Iterator<Item = (&'a [Point], bool)>) -> Vec<Point> {
    let samples = |(points, closed): (&[Point], bool)| {
        let count = (polyline::length(points, closed) / STEP).ceil().max(2.0) as usize;
        if points.len() < 2 { points.to_vec() } else { polyline::resample(points, closed, count) }
    };
    lines.flat_map(samples).collect()
}

/// The mean distance from each of two inks to the other, in pixels.
fn apart(a: &[Point], b: &[Point]) -> f64 {
    let one_way = |a: &[Point], b: &[Point]| {
        let nearest = |p: &Point| b.iter().map(|q| p.distance_squared(*q)).fold(MOST * MOST, f64::min).sqrt();
        a.iter().map(nearest).sum::<f64>() / a.len().max(1) as f64
    };
    0.5 * (one_way(a, b) + one_way(b, a))
}
