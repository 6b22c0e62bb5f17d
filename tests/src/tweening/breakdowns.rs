//! Measures what breakdowns gain: the true drawings of one or two frames between two keys are keys too.
//!
//! The frames are even, or those that `Suggest Breakdown` marks by the pictures of the set, or those that turn out best.

use super::Set;
use super::between::{drawings, off, points, sequence};
use anyhow::{Context, Result};
use rototoon::geometry::Point;
use rototoon::pictures::Sequence;
use rototoon::pipeline::suggest_breakdown;
use rototoon::scene::Silent;
use rototoon::tween::Stroke;
use rototoon::tween::between::{InBetween, Options};
use rototoon::tween::breakdown::Shown;

/// Sums of distances in pixels of in-betweens with breakdowns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BreakdownErrors {
    /// Of linear interpolation of the two keys.
    pub linear: f64,
    /// Of the earlier key, held.
    pub held: f64,
    /// Of Rototoon with no breakdown, with one, and with two, at even distances.
    pub even: [f64; 3],
    /// Of Rototoon with one and with two breakdowns on the frames that are suggested by the pictures, one after the other.
    pub suggested: [f64; 2],
    /// Of Rototoon with one and with two breakdowns on the frames that turn out best.
    pub best: [f64; 2],
    /// Number of points.
    pub count: usize,
}

impl BreakdownErrors {
    /// Adds other sums.
    pub fn add(&mut self, other: Self) {
        self.linear += other.linear;
        self.held += other.held;
        self.even = std::array::from_fn(|k| self.even[k] + other.even[k]);
        self.suggested = std::array::from_fn(|k| self.suggested[k] + other.suggested[k]);
        self.best = std::array::from_fn(|k| self.best[k] + other.best[k]);
        self.count += other.count;
    }
}

/// The errors of the frames between two keys when the true drawings of one or two frames between are keys too.
pub fn measure_breakdowns(set: &Set, (from, to): (i32, i32), options: &Options) -> Result<BreakdownErrors> {
    let (parts, keys) = drawings(set, &[from, to]);
    let inner: Vec<i32> =
        (from + 1..to).filter(|f| parts.iter().all(|&i| set.parts[i].points.contains_key(f))).collect();
    let truth = |frame: i32| -> Vec<&Vec<Point>> { parts.iter().map(|&i| &set.parts[i].points[&frame]).collect() };
    let with = |frames: &[i32]| [&[from][..], frames, &[to]].concat();
    let of = |frames: &[i32]| -> Result<f64> {
        let (_, ours) = sequence(set, &with(frames), options)?;
        let wrong = inner.iter().filter(|f| !frames.contains(f)).map(|&f| off(&points(ours.at(f)), &truth(f)));
        Ok(wrong.sum())
    };
    let mut errors = BreakdownErrors::default();
    for &frame in &inner {
        let u = f64::from(frame - from) / f64::from(to - from);
        let strokes = keys[0].strokes.iter().zip(&keys[1].strokes);
        let linear: Vec<Vec<Point>> =
            strokes.map(|(a, b)| a.points.iter().zip(&b.points).map(|(p, q)| p.lerp(*q, u)).collect()).collect();
        let held: Vec<Vec<Point>> = keys[0].strokes.iter().map(|s| s.points.clone()).collect();
        errors.linear += off(&linear, &truth(frame));
        errors.held += off(&held, &truth(frame));
        errors.count += truth(frame).iter().map(|p| p.len()).sum::<usize>();
    }
    let at = |k: usize, of: usize| inner[(inner.len() * k / of).min(inner.len() - 1)];
    errors.even = [of(&[])?, of(&[at(1, 2)])?, of(&[at(1, 3), at(2, 3)])?];
    let first = suggested(set, &with(&[]), options)?;
    let second = suggested(set, &with(&[first]), options)?;
    errors.suggested = [of(&[first])?, of(&[first.min(second), first.max(second)])?];
    errors.best = best(&inner, of)?;
    Ok(errors)
}

/// The least errors with one and with two breakdowns.
fn best(inner: &[i32], of: impl Fn(&[i32]) -> Result<f64>) -> Result<[f64; 2]> {
    let mut least = [f64::INFINITY; 2];
    for (k, &first) in inner.iter().enumerate() {
        least[0] = least[0].min(of(&[first])?);
        for &second in &inner[k + 1..] {
            least[1] = least[1].min(of(&[first, second])?);
        }
    }
    Ok(least)
}

/// The frame that is suggested for a breakdown between these keys, by the pictures of the set.
fn suggested(set: &Set, keys: &[i32], options: &Options) -> Result<i32> {
    let (_, ours) = sequence(set, keys, options)?;
    let stroke = |drawn: InBetween| (drawn.opacity > 0.0).then_some(drawn.stroke);
    let shown = |frame: i32| {
        let strokes: Vec<Stroke> = ours.at(frame).into_iter().filter_map(stroke).collect();
        Shown { frame, key: keys.contains(&frame), strokes, apart: None }
    };
    let drawings = (keys[0]..=keys[keys.len() - 1]).map(shown).collect();
    let pictures = Sequence::new(&set.footage, &set.folder)?;
    let found = suggest_breakdown(drawings, Some(&pictures), &Silent)?;
    Ok(found.context("nothing lies between the keys")?.breakdown.frame)
}
