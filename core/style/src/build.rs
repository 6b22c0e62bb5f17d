//! Builds: how long a character's limbs are beside the content's.
//!
//! Two characters that move alike, one with long legs and one with short ones, have their key points in different places.
//! Where a manner is learned from places, that difference would be taken for manner. Therefore every clip is brought to the
//! content's build before anything is learned: each limb keeps its direction, and gets the content's length. The result gets
//! the style's build at the end, limb by limb in the same way.
//!
//! A limb's length in the picture changes with its direction to the viewer. What a limb is long is therefore a high
//! quantile of its lengths ([`LONG`]), and foreshortening stays: lengths are multiplied, not set. Two characters are
//! compared in the motions that both show, since a motion towards the viewer shortens the limbs of both.
//!
//! Limits: collar bones and hips count as manner. In the picture they are as wide as the body is turned, and in profile
//! they have hardly a length.

use rototoon_base::scene::skeleton::{LIMBS, PARENTS, Posture, limb_lengths};

/// The quantile of a limb's lengths that counts as its length.
const LONG: f64 = 0.9;
/// Limbs shorter than this, in torso lengths, have no build.
const SHORT: f64 = 0.02;
/// Limbs by their outer key point whose lengths are the body's turn: collar bones and hips.
const TURNS: [usize; 4] = [5, 8, 11, 14];

/// For each limb the factor from the content's length to a character's.
pub(super) type Build = [f64; LIMBS];

/// The build of a character beside the content's, from pairs of clips of the same motions, theirs first.
pub(super) fn of(pairs: &[(&[Posture], &[Posture])]) -> Build {
    std::array::from_fn(|limb| {
        if TURNS.contains(&(limb + 1)) {
            return 1.0;
        }
        let ratio = |(theirs, content): &(&[Posture], &[Posture])| {
            let (a, b) = (long(theirs, limb), long(content, limb));
            (a > SHORT && b > SHORT).then(|| (a / b).ln())
        };
        let mut found: Vec<f64> = pairs.iter().filter_map(ratio).collect();
        found.sort_by(f64::total_cmp);
        found.get(found.len() / 2).copied().unwrap_or(0.0).exp()
    })
}

/// What a limb is long in a clip.
pub(super) fn long(postures: &[Posture], limb: usize) -> f64 {
    let mut lengths: Vec<f64> = postures.iter().map(|p| limb_lengths(p)[limb]).collect();
    lengths.sort_by(f64::total_cmp);
    let at = (lengths.len().saturating_sub(1) as f64 * LONG).round() as usize;
    lengths.get(at).copied().unwrap_or(0.0)
}

/// A posture of the content's build as one of another.
pub(super) fn given(posture: &Posture, build: &Build) -> Posture {
    scaled(posture, |limb| build[limb])
}

/// A posture of a build as one of the content's.
pub(super) fn taken(posture: &Posture, build: &Build) -> Posture {
    scaled(posture, |limb| 1.0 / build[limb])
}

fn scaled(posture: &Posture, factor: impl Fn(usize) -> f64) -> Posture {
    let mut made = *posture;
    for k in 1..made.len() {
        let parent = PARENTS[k];
        made[k] = made[parent] + (posture[k] - posture[parent]) * factor(k - 1);
    }
    made
}
