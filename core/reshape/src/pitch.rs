//! The pitch of a foot: how far it is turned on each frame.
//!
//! - **While it stands** its sole lies flat, also if it is drawn tilted.
//! - **After a contact** the heel comes off first: the foot turns about its toe as far as the ankle has risen, φ = asin(h / l), with l the
//!   way from the ankle to the toe.
//! - **In the air** it takes a share of the shin's turn ([`Foot::swing`]). Before a contact the forward shin has the toe up, so the heel
//!   comes down first.
//! - **Where the document shows it** in the drawing's own motion, its turn is the drawn one. On the few frames beside such a frame the
//!   difference fades, but not from the air into a contact or back.
//!
//! The end of a leg without a shoe turns with its bone on every frame.
//!
//! Angles are in radians, from the drawing at rest; x right, y down.

use super::foot::{Foot, foot_of};
use rototoon_base::geometry::Point;
use std::ops::Range;

/// Frames over which corrections fade.
pub(crate) const FADE: usize = 3;
/// A heel comes off until the ankle has risen by this share of the way from ankle to toe.
const TOE: f64 = 0.8;
/// After a contact the ankle may be lower than it stood by this share of that way: the frame on which a foot leaves the ground is found
/// to a frame.
const FLAT: f64 = 0.1;

/// The turns of a foot on all frames. `leg` are the key points of its leg; `runs` are its contacts with the ground, which is at
/// `ground`. `drawn` is empty, or has for each frame the turn where the document shows it.
pub(crate) fn pitches(
    foot: &Foot,
    leg: &[usize],
    postures: &[Vec<Point>],
    (runs, ground): (&[Range<usize>], f64),
    drawn: &[Option<f64>],
) -> Vec<f64> {
    let mut turns: Vec<f64> = postures.iter().map(|posture| foot.swing(leg, posture)).collect();
    if foot.turn.is_some() {
        for run in runs {
            let after = postures[run.end..].iter().map(|posture| posture[foot_of(leg)].y);
            let rolled = roll(foot, after, ground);
            set_contact(&mut turns, run, foot.level, &rolled);
        }
        fade_from_drawn(&mut turns, runs, drawn);
    }
    for (turn, drawn) in turns.iter_mut().zip(drawn) {
        *turn = drawn.unwrap_or(*turn);
    }
    turns
}

/// The turns of a contact, of the heel that comes off after it, and of the frames on which they go over into those in the air.
fn set_contact(turns: &mut [f64], run: &Range<usize>, level: f64, rolled: &[f64]) {
    turns[run.clone()].fill(level);
    let end = run.end + rolled.len();
    turns[run.end..end].copy_from_slice(rolled);
    let last = rolled.last().copied().unwrap_or(level);
    for k in 0..FADE.min(turns.len() - end) {
        let share = (k + 1) as f64 / (FADE + 1) as f64;
        turns[end + k] = last + (turns[end + k] - last) * share;
    }
    for k in 0..(FADE - 1).min(run.start) {
        let share = (k + 1) as f64 / FADE as f64;
        let at = run.start - 1 - k;
        turns[at] = level + (turns[at] - level) * share;
    }
}

/// The turns after a contact while the toe still stands. `after` is the ankle's y on the frames after it.
fn roll(foot: &Foot, after: impl Iterator<Item = f64>, ground: f64) -> Vec<f64> {
    let (toe, stood) = (foot.toe(), ground - foot.depth(foot.level));
    let length = toe.x.abs();
    let mut found: Vec<f64> = Vec::new();
    let mut before = -FLAT * length;
    for ankle in after {
        let risen = stood - ankle;
        if !(risen > before && risen < TOE * length) {
            break;
        }
        found.push(foot.level + toe.x.signum() * (risen.max(0.0) / length).asin());
        before = risen;
    }
    found
}

/// Adds how far drawn turns differ from the computed ones to the frames beside them, less with each frame.
fn fade_from_drawn(turns: &mut [f64], runs: &[Range<usize>], drawn: &[Option<f64>]) {
    let stands = |t: usize| runs.iter().any(|run| run.contains(&t));
    let off: Vec<Option<f64>> = drawn.iter().zip(&*turns).map(|(drawn, turn)| Some((*drawn)? - turn)).collect();
    // The difference at the nearest drawn frame among those at the given distances, and its weight.
    let beside = |t: usize, at: &dyn Fn(usize) -> Option<usize>| {
        for k in 1..=FADE {
            let Some(frame) = at(k).filter(|&frame| frame < off.len() && stands(frame) == stands(t)) else { break };
            if let Some(off) = off[frame] {
                return (off, 1.0 - k as f64 / (FADE + 1) as f64);
            }
        }
        (0.0, 0.0)
    };
    for t in (0..off.len()).filter(|&t| off[t].is_none()) {
        let ((a, v), (b, w)) = (beside(t, &|k| t.checked_sub(k)), beside(t, &|k| t.checked_add(k)));
        turns[t] += (a * v + b * w) / (v + w).max(1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::foot::tests::shoe;
    use super::*;

    const LEG: [usize; 3] = [0, 1, 2];

    fn foot() -> Foot {
        Foot::shoe(0, shoe(0.0), Point::Y, 1.0)
    }

    /// A leg whose shin is turned by 0.5 on every frame, with its ankle at a height.
    fn postures(ankles: &[f64]) -> Vec<Vec<Point>> {
        let shin = Point::from_angle(0.5).rotate(Point::new(0.0, 40.0));
        ankles
            .iter()
            .map(|y| [-80.0, -40.0, 0.0].map(|_| Point::new(0.0, *y) - shin).to_vec())
            .map(|mut p: Vec<Point>| {
                p[2] = p[1] + shin;
                p
            })
            .collect()
    }

    #[test]
    fn a_foot_is_flat_then_rolls_off_then_swings() {
        let ankles = [0.0, 0.0, 0.0, 0.0, -4.0, -9.0, -30.0, -30.0, -30.0, -30.0, -30.0];
        let turns = pitches(&foot(), &LEG, &postures(&ankles), (std::slice::from_ref(&(1..4)), 8.0), &[]);
        assert_eq!(turns[1..4], [0.0; 3]);
        for (t, risen) in [(4, 4.0f64), (5, 9.0)] {
            assert!((turns[t] - (risen / 14.0).asin()).abs() < 1e-9, "frame {t}: {}", turns[t]);
        }
        assert!(turns[9..].iter().all(|turn| (turn - 0.5).abs() < 1e-9), "{turns:?}");
    }

    #[test]
    fn drawn_turns_are_kept_and_fade_but_never_into_a_contact() {
        let ankles = [0.0; 12];
        let mut drawn = vec![None; 12];
        drawn[8] = Some(1.3);
        let turns = pitches(&foot(), &LEG, &postures(&ankles), (std::slice::from_ref(&(0..5)), -100.0), &drawn);
        let plain = pitches(&foot(), &LEG, &postures(&ankles), (std::slice::from_ref(&(0..5)), -100.0), &[]);
        assert_eq!(turns[8], 1.3);
        let off: Vec<f64> = turns.iter().zip(&plain).map(|(a, b)| a - b).collect();
        assert!(off[..5].iter().all(|off| *off == 0.0), "the contact stays flat: {off:?}");
        assert!(off[5..8].windows(2).all(|pair| pair[0] < pair[1]) && off[5] > 0.0, "{off:?}");
        assert!(off[9..].windows(2).all(|pair| pair[0] > pair[1]) && off[11] > 0.0, "{off:?}");
        // In a contact it fades within the contact.
        drawn[8] = None;
        drawn[4] = Some(0.4);
        let turns = pitches(&foot(), &LEG, &postures(&ankles), (std::slice::from_ref(&(0..5)), -100.0), &drawn);
        assert!(turns[4] == 0.4 && turns[3] > turns[2] && turns[1] > 0.0 && turns[0] == 0.0, "{turns:?}");
        assert_eq!(turns[5..], plain[5..]);
    }
}
