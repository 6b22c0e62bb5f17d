//! Skeleton clips: a character's motion as key points over time.
//!
//! A clip is a list of postures in any one unit, with x right and y down. Between frames postures are interpolated
//! linearly, key point by key point. This shortens a fast swinging limb a little; callers that need exact lengths
//! restore them.

use super::skeleton::Posture;
use super::template::Template;
use crate::geometry::Point;
use std::sync::Arc;

/// One motion of one character.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// The character that moves.
    pub character: String,
    /// Name of the motion. Clips of one motion by several characters show the same content.
    pub motion: String,
    /// The body that moves.
    pub template: Arc<Template>,
    /// A posture for each frame: a place for each key point of the template, x right and y down. All clips of a character
    /// use one unit.
    pub postures: Vec<Vec<Point>>,
    /// Standard deviation of the coordinates of each key point in each frame, in the unit of the points. Empty if
    /// unknown.
    pub deviation: Vec<Vec<f64>>,
}

impl Clip {
    /// A human clip without standard deviations.
    pub fn new(character: impl Into<String>, motion: impl Into<String>, postures: Vec<Posture>) -> Self {
        let postures = postures.into_iter().map(Vec::from).collect();
        Self::of(Template::human(), character, motion, postures)
    }

    /// A clip of any body. Each posture has a place for each key point of the template.
    pub fn of(
        template: Arc<Template>,
        character: impl Into<String>,
        motion: impl Into<String>,
        postures: Vec<Vec<Point>>,
    ) -> Self {
        Self { character: character.into(), motion: motion.into(), template, postures, deviation: Vec::new() }
    }

    /// The postures of a human clip; none if the body is another.
    pub fn human(&self) -> Option<Vec<Posture>> {
        if !self.template.is_human() {
            return None;
        }
        self.postures.iter().map(|posture| Posture::try_from(posture.as_slice()).ok()).collect()
    }
}

/// Postures resampled to `frames` frames; the first and the last are kept. A list of that length is returned unchanged.
pub fn resample(postures: &[Posture], frames: usize) -> Vec<Posture> {
    let Some(last) = postures.len().checked_sub(1) else { return Vec::new() };
    if postures.len() == frames {
        return postures.to_vec();
    }
    let step = last as f64 / frames.saturating_sub(1).max(1) as f64;
    (0..frames).map(|frame| between(postures, frame as f64 * step)).collect()
}

/// The posture at a time in frames, linear between neighbouring frames. Before the first or after the last frame it is
/// constant.
pub fn between(postures: &[Posture], time: f64) -> Posture {
    let last = postures.len() - 1;
    let time = time.clamp(0.0, last as f64);
    let before = (time.floor() as usize).min(last);
    let after = (before + 1).min(last);
    let part = time - before as f64;
    std::array::from_fn(|k| {
        let (a, b): (Point, Point) = (postures[before][k], postures[after][k]);
        if part == 0.0 { a } else { a.lerp(b, part) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Posture {
        [Point::new(x, 0.0); super::super::skeleton::COUNT]
    }

    #[test]
    fn resampling_keeps_ends_and_goes_straight_between() {
        let clip = [at(0.0), at(2.0), at(4.0)];
        assert_eq!(resample(&clip, 5), vec![at(0.0), at(1.0), at(2.0), at(3.0), at(4.0)]);
        assert_eq!(resample(&clip, 3), clip);
        assert_eq!(resample(&clip, 1), vec![at(0.0)]);
        assert_eq!(resample(&[at(3.0)], 2), vec![at(3.0), at(3.0)]);
    }
    #[test]
    fn only_human_clips_have_human_postures() {
        assert_eq!(Clip::new("a", "walk", vec![at(1.0)]).human(), Some(vec![at(1.0)]));
        let bird = Template::bird();
        let posture = bird.typical();
        assert_eq!(Clip::of(bird, "a", "walk", vec![posture]).human(), None);
    }
}
