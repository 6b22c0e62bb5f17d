//! Which new frame shows which old drawing: the cheapest way through both footages in their order.
//!
//! | step | cost |
//! | --- | --- |
//! | the next new frame shows the next old one | d, if the drawing is the same |
//! | it shows the last old one again: a drawing is held longer | d + 0.02, if the drawing is the same |
//! | it is drawn anew | 0.6 + 0.08 min(d, 2.5) |
//! | it is new | 0.5 |
//! | an old frame is left out | 0.5; 0.05 if a neighbour shows the same |
//!
//! A drawing in place of another one is so cheaper than a new one and one left out, and among several the one that differs least is taken.
//! Two frames show the same drawing if d is at most 0.25. On footage with much grain each d is larger. So the bound is three times
//! the median over the new frames of the least d of each, if that is more, but at most 0.6.
//!
//! This is the edit distance of two texts (Wagner & Fischer 1974), with letters that are alike by degrees.
//!
//! Limits: drawings that come in another order are new ones.

use rototoon_base::scene::Raster;

/// Difference up to which two frames always show the same drawing.
const SAME: f32 = 0.25;
/// Greatest bound for the difference of the same drawing.
const MOST: f32 = 0.6;
/// The bound in multiples of the usual difference.
const TIMES: f32 = 3.0;
const AGAIN: f32 = 0.02;
const REDRAWN: f32 = 0.6;
const REDRAWN_BY: f32 = 0.08;
const FARTHEST: f32 = 2.5;
const NEW: f32 = 0.5;
const LEFT_OUT: f32 = 0.5;
const LEFT_OUT_OF_HOLD: f32 = 0.05;

/// What a new frame shows, by the index of the old frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The drawing of the old frame.
    Same(usize),
    /// A drawing in place of that of the old frame.
    Redrawn(usize),
    /// A drawing of its own.
    New,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Step {
    Next,
    Again,
    Redrawn,
    New,
    LeftOut,
}

/// The bound of the difference for frames that show the same drawing. Column i, row j of `differences` is that of old frame i and new frame j.
pub fn bound(differences: &Raster<f32>) -> f32 {
    let least = |j: usize| differences.row(j).iter().copied().fold(f32::INFINITY, f32::min);
    let mut all: Vec<f32> = (0..differences.height()).map(least).collect();
    all.sort_by(f32::total_cmp);
    let usual = all.get(all.len() / 2).copied().unwrap_or(0.0);
    (TIMES * usual).clamp(SAME, MOST)
}

/// What each new frame shows. `held[i]` says whether the old frame i shows the same as a neighbour.
pub fn align(differences: &Raster<f32>, held: &[bool], bound: f32) -> Vec<Shown> {
    let (old, new) = (differences.width(), differences.height());
    let mut steps = Raster::new(old + 1, new + 1, Step::New);
    let mut row: Vec<f32> = Vec::with_capacity(old + 1);
    for j in 0..=new {
        let above = std::mem::take(&mut row);
        for i in 0..=old {
            let (cost, step) = cheapest(differences, held, bound, [i, j], &above, &row);
            row.push(cost);
            steps.set(i, j, step);
        }
    }
    followed(&steps)
}

/// The least cost of getting to i old and j new frames, and its last step. `above` has the costs with one new frame less.
fn cheapest(
    differences: &Raster<f32>,
    held: &[bool],
    bound: f32,
    [i, j]: [usize; 2],
    above: &[f32],
    row: &[f32],
) -> (f32, Step) {
    let mut best = if (i, j) == (0, 0) { (0.0, Step::New) } else { (f32::INFINITY, Step::New) };
    let mut take = |cost: f32, step| {
        if cost < best.0 {
            best = (cost, step);
        }
    };
    if i > 0 && j > 0 {
        let d = differences.get(i - 1, j - 1);
        if d <= bound {
            take(above[i - 1] + d, Step::Next);
            take(above[i] + d + AGAIN, Step::Again);
        }
        take(above[i - 1] + REDRAWN + REDRAWN_BY * d.min(FARTHEST), Step::Redrawn);
    }
    if j > 0 {
        take(above[i] + NEW, Step::New);
    }
    if i > 0 {
        take(row[i - 1] + if held[i - 1] { LEFT_OUT_OF_HOLD } else { LEFT_OUT }, Step::LeftOut);
    }
    best
}

/// The way back from the end.
fn followed(steps: &Raster<Step>) -> Vec<Shown> {
    let (mut i, mut j) = (steps.width() - 1, steps.height() - 1);
    let mut shown = Vec::with_capacity(j);
    while i > 0 || j > 0 {
        let step = steps.get(i, j);
        match step {
            Step::Next | Step::Again => shown.push(Shown::Same(i - 1)),
            Step::Redrawn => shown.push(Shown::Redrawn(i - 1)),
            Step::New => shown.push(Shown::New),
            Step::LeftOut => {}
        }
        i -= usize::from(matches!(step, Step::Next | Step::Redrawn | Step::LeftOut));
        j -= usize::from(step != Step::LeftOut);
    }
    shown.reverse();
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use Shown::{New, Redrawn, Same};

    /// The alignment of two texts. The same letters are the same drawing, neighbours in the alphabet are like each other.
    fn texts(old: &str, new: &str) -> Vec<Shown> {
        let (old, new): (Vec<char>, Vec<char>) = (old.chars().collect(), new.chars().collect());
        let apart = |a: char, b: char| match (a as i32 - b as i32).abs() {
            0 => 0.01,
            1 => 0.8,
            _ => 2.0,
        };
        let differences = Raster::from_fn(old.len(), new.len(), |i, j| apart(old[i], new[j]));
        let same = |i: usize, k: usize| old.get(i).is_some() && old.get(i) == old.get(k);
        let held: Vec<bool> = (0..old.len()).map(|i| same(i, i + 1) || (i > 0 && same(i, i - 1))).collect();
        align(&differences, &held, bound(&differences))
    }

    #[test]
    fn the_same_film_is_aligned_frame_by_frame_also_where_it_is_held() {
        assert_eq!(texts("aabbccdd", "aabbccdd"), (0..8).map(Same).collect::<Vec<_>>());
        assert_eq!(texts("abcabc", "abcabc"), (0..6).map(Same).collect::<Vec<_>>());
    }

    #[test]
    fn drawings_are_added_left_out_and_drawn_anew() {
        assert_eq!(texts("abcd", "abxcd"), [Same(0), Same(1), New, Same(2), Same(3)]);
        assert_eq!(texts("abcde", "abde"), [Same(0), Same(1), Same(3), Same(4)]);
        assert_eq!(texts("amcz", "anczz"), [Same(0), Redrawn(1), Same(2), Same(3), Same(3)]);
    }

    #[test]
    fn a_drawing_stands_for_the_one_that_it_is_like() {
        // One of two drawings is gone, and the other one was drawn anew.
        assert_eq!(texts("agtz", "afz"), [Same(0), Redrawn(1), Same(3)]);
        assert_eq!(texts("agtz", "asz"), [Same(0), Redrawn(2), Same(3)]);
    }

    #[test]
    fn handles_and_other_exposures_are_found() {
        assert_eq!(texts("cde", "xycdez"), [New, New, Same(0), Same(1), Same(2), New]);
        let letters = |old: &str, new: &str| -> String {
            let letter = |shown| match shown {
                Same(i) => old.chars().nth(i),
                _ => None,
            };
            texts(old, new).into_iter().map(|shown| letter(shown).unwrap_or('?')).collect()
        };
        assert_eq!(letters("aabb", "aaabbb"), "aaabbb");
        assert_eq!(letters("aaabbb", "ab"), "ab");
    }

    #[test]
    fn nothing_in_common_is_new_or_drawn_anew_and_empty_footage_is_allowed() {
        assert!(texts("abc", "xyz").iter().all(|shown| !matches!(shown, Same(_))));
        assert_eq!(texts("", "ab"), [New, New]);
        assert_eq!(texts("ab", ""), []);
    }

    #[test]
    fn much_grain_raises_the_bound() {
        let grainy = Raster::from_fn(9, 9, |i, j| if i == j { 0.15 } else { 2.0 });
        assert!((bound(&grainy) - 0.45).abs() < 1e-6);
        assert_eq!(bound(&grainy.map(|_| 2.0)), MOST);
        assert_eq!(bound(&grainy.map(|_| 0.0)), SAME);
    }
}
