//! Measures matching on the strokes of two frames of a set, of which the second is drawn in another way.
//!
//! The second drawing has another order of strokes. Half of its strokes run in the other direction, closed ones start
//! elsewhere, and all have another number of points. A tenth of the strokes is missing on one of the two drawings.

use super::Set;
use anyhow::Result;
use rototoon::geometry::{Point, polyline};
use rototoon::scene::Silent;
use rototoon::tween::Stroke;
use rototoon::tween::matching::{Options, match_strokes};

/// Counts of correct and wrong pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Strokes that are on both drawings.
    pub there: usize,
    /// Correct pairs.
    pub right: usize,
    /// Wrong pairs.
    pub wrong: usize,
    /// Correct pairs of pairing by index.
    pub by_index: usize,
    /// Correct pairs of closed strokes whose start was found within 5 % of the length.
    pub starts: usize,
    /// Correct pairs of closed strokes.
    pub closed: usize,
}

impl Score {
    /// Adds the counts of another score.
    pub fn add(&mut self, other: Self) {
        self.there += other.there;
        self.right += other.right;
        self.wrong += other.wrong;
        self.by_index += other.by_index;
        self.starts += other.starts;
        self.closed += other.closed;
    }
}

/// Pseudo-random numbers, the same on every machine (Steele, Lea & Flood 2014, SplitMix64).
pub struct Chance(pub u64);

impl Chance {
    /// The next number below `bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % bound.max(1) as u64) as usize
    }

    /// The numbers below `count` in a random order.
    pub fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            order.swap(k, self.below(k + 1));
        }
        order
    }
}

/// Largest distance from the true start of a closed stroke that counts as found, as a share of the stroke's length.
const NEAR_START: f64 = 0.05;

/// A stroke of a drawing, and the part that it draws.
struct Known {
    part: usize,
    stroke: Stroke,
    /// The position of the contour's first point, as a share of the stroke's length.
    start: f64,
}

/// Matches the strokes of two frames. `paints` are the colours of the parts, or empty.
pub fn measure(set: &Set, frames: (i32, i32), paints: &[Option<[f32; 3]>], chance: &mut Chance) -> Result<Score> {
    let (first, second, there) = drawings(set, frames, chance);
    let painted = |k: &Known| Stroke { colour: paints.get(k.part).copied().flatten(), ..k.stroke.clone() };
    let strokes = |known: &[Known]| known.iter().map(painted).collect::<Vec<_>>();
    let found = match_strokes(&strokes(&first), &strokes(&second), &[], &Options::default(), &Silent)?;
    let tell = |part: usize, what: &str| {
        if std::env::var_os("BENCH_TWEEN_WRONG").is_some() {
            println!("  {} {}-{}: {:?} {what}", set.name, frames.0, frames.1, set.parts[part].name);
        }
    };
    let by_index = first.iter().zip(&second).filter(|(a, b)| a.part == b.part).count();
    let mut score = Score { there, by_index, ..Score::default() };
    for pair in &found.pairs {
        let (a, b) = (&first[pair.from], &second[pair.to]);
        if a.part != b.part {
            score.wrong += 1;
            tell(a.part, &format!("as {:?}", set.parts[b.part].name));
            continue;
        }
        score.right += 1;
        if a.stroke.closed {
            let off = pair.start - b.start;
            let off = off - off.round();
            score.closed += 1;
            score.starts += usize::from(off.abs() < NEAR_START);
            if off.abs() >= NEAR_START {
                tell(a.part, &format!("start off by {off:.2}"));
            }
        }
    }
    let alone = |&&i: &&usize| second.iter().any(|k| k.part == first[i].part);
    found.vanished.iter().filter(alone).for_each(|&i| tell(first[i].part, "alone"));
    Ok(score)
}

/// The strokes of two frames in random orders, those of the second frame drawn in another way. A tenth of the parts is
/// missing on one of them. Also returns the number of parts on both.
fn drawings(set: &Set, (from, to): (i32, i32), chance: &mut Chance) -> (Vec<Known>, Vec<Known>, usize) {
    let there: Vec<usize> =
        (0..set.parts.len()).filter(|&i| [from, to].iter().all(|f| set.parts[i].points.contains_key(f))).collect();
    let away = if there.len() < 4 { 0 } else { there.len().div_ceil(10) };
    let first_loses = chance.below(2) == 0;
    let mut kept = chance.order(there.len());
    let lost: Vec<usize> = kept.split_off(there.len() - away).into_iter().map(|k| there[k]).collect();
    let missing = |part: usize, first: bool| first == first_loses && lost.contains(&part);
    let as_is = |i: usize| {
        let stroke = Stroke::new(set.parts[i].points[&from].clone(), set.parts[i].closed);
        Known { part: i, stroke, start: 0.0 }
    };
    let order = chance.order(there.len());
    let first = order.into_iter().map(|k| there[k]).filter(|&i| !missing(i, true)).map(as_is).collect();
    let order = chance.order(there.len());
    let kept = order.into_iter().map(|k| there[k]).filter(|&i| !missing(i, false));
    let second = kept.map(|i| redrawn(set, i, to, chance)).collect();
    (first, second, there.len() - away)
}

/// A contour with another start, direction and number of points.
fn redrawn(set: &Set, i: usize, frame: i32, chance: &mut Chance) -> Known {
    let part = &set.parts[i];
    let points = &part.points[&frame];
    let count = (points.len() * (50 + chance.below(150)) / 100).max(6);
    let total = polyline::length(points, part.closed);
    let shift = if part.closed { chance.below(points.len()) } else { 0 };
    let walked = polyline::length(&points[..=shift], false);
    let mut rotated: Vec<Point> = points.clone();
    rotated.rotate_left(shift);
    let mut start = if part.closed { (1.0 - walked / total.max(1e-9)).fract() } else { 0.0 };
    if chance.below(2) == 0 {
        rotated.reverse();
        if part.closed {
            rotated.rotate_right(1);
        }
        start = (1.0 - start).fract();
    }
    Known { part: i, stroke: Stroke::new(polyline::resample(&rotated, part.closed, count), part.closed), start }
}
