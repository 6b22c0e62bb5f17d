//! Skeleton clips.

use super::{name, number, point};
use arbitrary::{Result, Unstructured};
use rototoon::geometry::Point;
use rototoon::project::clips::Clips;
use rototoon::scene::Clip;
use rototoon::scene::skeleton::{COUNT, PARENTS, Posture};
use std::f64::consts::{FRAC_PI_4, PI};

/// The characters, of whom a request names two.
pub const CHARACTERS: [&str; 3] = ["anna", "bert", "carl"];
/// The motions.
pub const MOTIONS: [&str; 3] = ["walk", "run", "jump"];

/// A few clips. Most are of an upright figure that bends a little, and a few of its points are anywhere.
pub fn clips(u: &mut Unstructured, most: usize, frames: usize) -> Result<Clips> {
    let mut found: Vec<Clip> = Vec::new();
    for k in 0..u.int_in_range(0..=most)? {
        let named = u.ratio(1u8, 16)?;
        let character = if named { name(u)? } else { CHARACTERS[k % 3].to_owned() };
        let motion = if named { name(u)? } else { MOTIONS[k / 3 % 3].to_owned() };
        let count = u.int_in_range(1..=frames)?;
        let postures = (0..count).map(|_| posture(u)).collect::<Result<_>>()?;
        found.push(Clip::new(character, motion, postures));
    }
    let fps = if u.ratio(1u8, 8)? { number(u)? } else { 12.0 };
    Ok(Clips { clips: found, fps })
}

/// A posture.
pub fn posture(u: &mut Unstructured) -> Result<Posture> {
    let (lean, swing) = (signed(u)?, signed(u)?);
    let mut posture = [Point::ZERO; COUNT];
    if u.ratio(1u8, 8)? {
        posture[0] = point(u)?;
    }
    for k in 1..COUNT {
        let (angle, length) = match k {
            1..=4 => (PI - lean, 0.5),
            5 | 8 | 11 | 14 => (0.0, 0.1),
            6 | 7 | 15 | 16 => (swing, 0.5),
            _ => (-swing, 0.5),
        };
        posture[k] = posture[PARENTS[k]] + length * Point::new(angle.sin(), angle.cos());
    }
    if u.ratio(1u8, 4)? {
        for _ in 0..u.int_in_range(0..=3u8)? {
            let k = u.int_in_range(0..=COUNT - 1)?;
            posture[k] = point(u)?;
        }
    }
    Ok(posture)
}

/// An angle of at most an eighth turn.
fn signed(u: &mut Unstructured) -> Result<f64> {
    Ok(f64::from(u.arbitrary::<i8>()?) / 128.0 * FRAC_PI_4)
}
