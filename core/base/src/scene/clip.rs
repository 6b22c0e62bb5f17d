//! Skeleton clips: a character's motion as key points over time.
//!
//! A clip is a list of postures in any one unit, with x right and y down. Between frames postures are interpolated
//! linearly, key point by key point. This shortens a fast swinging limb a little; callers that need exact lengths
//! restore them.

use super::skeleton::Posture;
use super::template::Template;
use crate::geometry::Point;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Share by which frame rates may differ and count as equal: 24 and 23.976, or a rate from a rounded time of a frame.
const SAME_RATE: f64 = 0.0011;
/// Greatest number of frames of a clip at another frame rate.
const MOST_FRAMES: f64 = 1e6;

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
    /// By key point the first and the last frame of each time, from 0 and rising, on which nothing told its place, so that it
    /// was filled in.
    pub guessed: Guessed,
}

/// Times in frames by key point.
pub type Guessed = BTreeMap<usize, Vec<[usize; 2]>>;

/// Frames as times: each run of `true` is one.
pub fn times(frames: &[bool]) -> Vec<[usize; 2]> {
    let on: Vec<usize> = (0..frames.len()).filter(|&frame| frames[frame]).collect();
    let runs = on.chunk_by(|a, b| *b == a + 1);
    runs.filter_map(|run| Some([*run.first()?, *run.last()?])).collect()
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
        let (character, motion) = (character.into(), motion.into());
        Self { character, motion, template, postures, deviation: Vec::new(), guessed: Guessed::new() }
    }

    /// Whether a key point's place was filled in on a frame.
    pub fn is_guessed(&self, point: usize, frame: usize) -> bool {
        self.guessed
            .get(&point)
            .is_some_and(|times| times.iter().any(|[first, last]| (*first..=*last).contains(&frame)))
    }

    /// The key points that were filled in, each with the number of frames.
    pub fn guesses(&self) -> Vec<(usize, usize)> {
        let count = |times: &Vec<[usize; 2]>| times.iter().map(|[first, last]| last - first + 1).sum();
        self.guessed.iter().map(|(point, times)| (*point, count(times))).collect()
    }

    /// The postures of a human clip; none if the body is another.
    pub fn human(&self) -> Option<Vec<Posture>> {
        if !self.template.is_human() {
            return None;
        }
        self.postures.iter().map(|posture| Posture::try_from(posture.as_slice()).ok()).collect()
    }

    /// The clip at another frame rate over the same time. Rates that differ as 24 and 23.976 do count as equal. A clip that would
    /// have more than a million frames stays as it is.
    #[must_use]
    pub fn at_rate(self, own: f64, wanted: f64) -> Self {
        let last = self.postures.len().saturating_sub(1) as f64;
        // A number of frames that misses an integer only by rounding counts as that integer.
        let frames = (last * wanted / own + 1e-6).floor() + 1.0;
        let possible = wanted > 0.0 && (1.0..=MOST_FRAMES).contains(&frames);
        if (wanted - own).abs() <= SAME_RATE * own || self.postures.is_empty() || !possible {
            return self;
        }
        let times: Vec<f64> = (0..frames as usize).map(|frame| (frame as f64 * own / wanted).min(last)).collect();
        let at = |time: f64| (time.floor() as usize, time.ceil() as usize, time.fract());
        let posture = |(a, b, share): (usize, usize, f64)| {
            rows(&self.postures[a], &self.postures[b], |p: &Point, q| p.lerp(*q, share))
        };
        let spread = |(a, b, share): (usize, usize, f64)| {
            rows(&self.deviation[a], &self.deviation[b], |p: &f64, q| p + (q - p) * share)
        };
        let postures = times.iter().map(|time| posture(at(*time))).collect();
        let complete = self.deviation.len() == self.postures.len();
        let deviation = if complete { times.iter().map(|time| spread(at(*time))).collect() } else { Vec::new() };
        // A posture between two frames is a guess if one of them is.
        let guess = |point: usize| {
            let on = |time: &f64| self.is_guessed(point, at(*time).0) || self.is_guessed(point, at(*time).1);
            super::clip::times(&times.iter().map(on).collect::<Vec<_>>())
        };
        let guessed = self.guessed.keys().map(|&point| (point, guess(point)));
        let guessed = guessed.filter(|(_, times)| !times.is_empty()).collect();
        Self { postures, deviation, guessed, ..self }
    }
}

/// Two rows combined, value by value.
fn rows<T>(first: &[T], second: &[T], combine: impl Fn(&T, &T) -> T) -> Vec<T> {
    first.iter().zip(second).map(|(a, b)| combine(a, b)).collect()
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
    fn another_frame_rate_keeps_the_time() {
        let mut clip = Clip::new("a", "walk", (0..5).map(|frame| at(f64::from(frame))).collect());
        clip.deviation = (0..5).map(|frame| vec![f64::from(frame); 3]).collect();
        let half = clip.clone().at_rate(24.0, 12.0);
        assert_eq!(half.human().unwrap(), [at(0.0), at(2.0), at(4.0)]);
        assert_eq!(half.deviation[1], [2.0; 3]);
        clip.guessed = Guessed::from([(7, vec![[0, 1], [4, 4]])]);
        assert_eq!(clip.clone().at_rate(24.0, 12.0).guessed, Guessed::from([(7, vec![[0, 0], [2, 2]])]));
        assert_eq!(clip.clone().at_rate(24.0, 48.0).guessed, Guessed::from([(7, vec![[0, 3], [7, 8]])]));
        assert_eq!(clip.guesses(), [(7, 3)]);
        clip.guessed.clear();
        let twice = clip.clone().at_rate(24.0, 48.0);
        assert_eq!((twice.postures.len(), twice.human().unwrap()[3]), (9, at(1.5)));
        // The rest of a frame at the end is left out: nothing is known after the last one.
        assert_eq!(clip.clone().at_rate(24.0, 18.0).postures.len(), 4);
        for wanted in [24.0, 23.976, 23.999_808, 1e9, f64::NAN, 0.0] {
            assert_eq!(clip.clone().at_rate(24.0, wanted), clip, "{wanted}");
        }
        assert_eq!(Clip::new("a", "b", Vec::new()).at_rate(1.0, 2.0).postures.len(), 0);
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
