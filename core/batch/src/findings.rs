//! What a tracked document says: confidence over time, doubtful and lost parts, and the keys that would help most.
//!
//! The doubt about a part on a frame is the mean of 1 − confidence over its points. Which contours are doubtful or lost, the
//! core says ([`Outcome`]). Lost frames that follow each other are a *stretch*. A key in a stretch corrects most of it, so one key is proposed for each:
//! on the frame with the greatest doubt, of equals on the one nearest to the middle. What the key is worth is the sum of
//! the stretch's doubt: the number of contours that are expected to become right. A stretch worth less than one contour
//! is no reason to disturb a person.
//!
//! Where a part with one key was lost, the key is worth the frames from there to the end of the footage: none of them
//! has a contour.
//!
//! Limits: the worth trusts the confidence. Two keys in one long stretch may be better than one; after the first, the
//! next run proposes the second.

use rototoon::scene::outcome::confidence;
use rototoon::scene::{Footage, FrameNumber, Outcome, Part, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Least worth of a key, in contours.
const WORTH: f64 = 1.0;

/// What a document says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Mean confidence of all contours; 1 if nothing was tracked.
    pub confidence: f64,
    /// The least mean confidence of any part, by frame.
    pub least: BTreeMap<FrameNumber, f64>,
    /// Each part.
    pub parts: Vec<PartFindings>,
    /// Keys that would help, the most valuable first.
    pub wanted: Vec<WantedKey>,
}

/// What was found about a part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PartFindings {
    /// Its name.
    pub name: String,
    /// Mean confidence; 1 if it was not tracked.
    pub confidence: f64,
    /// Frames with a contour.
    pub frames: usize,
    /// Frames on which it is doubtful.
    pub doubtful: Vec<FrameNumber>,
    /// Frames on which it is probably wrong, or was lost and has no contour.
    pub lost: Vec<FrameNumber>,
}

/// A key that would help.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WantedKey {
    /// The part.
    pub part: String,
    /// The frame.
    pub frame: FrameNumber,
    /// Number of contours that are expected to become right.
    pub worth: f64,
    /// Whether the part has no contour there, and not only one that is probably wrong.
    pub lost: bool,
}

impl Findings {
    /// What a scene says.
    pub fn of(scene: &Scene) -> Self {
        let mut found = Self::default();
        let (mut sum, mut count) = (0.0, 0);
        for part in &scene.parts {
            let (doubts, outcome) = (doubts(part), Outcome::of(part));
            for (&frame, doubt) in &doubts {
                let least = found.least.entry(frame).or_insert(1.0);
                *least = least.min(1.0 - doubt);
                sum += 1.0 - doubt;
                count += 1;
            }
            found.wanted.extend(stretches(part, &doubts, &outcome));
            found.parts.push(of_part(part, &doubts, outcome));
            found.wanted.extend(lost(part, &scene.footage));
        }
        found.confidence = if count > 0 { sum / f64::from(count) } else { 1.0 };
        // The order of parts and frames decides between equals.
        found.wanted.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        found
    }
}

fn of_part(part: &Part, doubts: &BTreeMap<FrameNumber, f64>, outcome: Outcome) -> PartFindings {
    let sum: f64 = doubts.values().map(|doubt| 1.0 - doubt).sum();
    PartFindings {
        name: part.name.clone(),
        confidence: if doubts.is_empty() { 1.0 } else { sum / doubts.len() as f64 },
        frames: part.tracks.len().max(part.keys.len()),
        doubtful: outcome.doubtful,
        lost: outcome.lost,
    }
}

/// The doubt about a part by frame. The artist's own keys are beyond doubt.
fn doubts(part: &Part) -> BTreeMap<FrameNumber, f64> {
    // A confidence that is no number is a lost contour, as everywhere.
    confidence(part).into_iter().map(|(frame, sure)| (frame, if sure.is_nan() { 1.0 } else { 1.0 - sure })).collect()
}

fn stretches(part: &Part, doubts: &BTreeMap<FrameNumber, f64>, outcome: &Outcome) -> Vec<WantedKey> {
    let mut found: Vec<Vec<(FrameNumber, f64)>> = Vec::new();
    for (frame, doubt) in outcome.lost.iter().filter_map(|&frame| Some((frame, *doubts.get(&frame)?))) {
        match found.last_mut() {
            Some(stretch) if stretch.last().is_some_and(|(last, _)| frame.checked_sub(1) == Some(*last)) => {
                stretch.push((frame, doubt))
            }
            _ => found.push(vec![(frame, doubt)]),
        }
    }
    found.iter().map(|stretch| wanted(part, stretch)).filter(|key| key.worth >= WORTH).collect()
}

/// The key of a stretch.
fn wanted(part: &Part, stretch: &[(FrameNumber, f64)]) -> WantedKey {
    let middle = (stretch.len() - 1) / 2;
    let better = |&(a, _): &(usize, f64), &(b, _): &(usize, f64)| b.abs_diff(middle).cmp(&a.abs_diff(middle));
    let doubts = stretch.iter().map(|(_, doubt)| *doubt).enumerate();
    let best = doubts.max_by(|a, b| a.1.total_cmp(&b.1).then(better(a, b))).map_or(0, |(index, _)| index);
    let worth = stretch.iter().map(|(_, doubt)| doubt).sum();
    WantedKey { part: part.name.clone(), frame: stretch[best].0, worth, lost: false }
}

/// The keys of frames on which a part was lost.
fn lost(part: &Part, footage: &Footage) -> Vec<WantedKey> {
    let tracked = part.tracks.keys().next().copied();
    let worth = |frame: FrameNumber| {
        let before = tracked.is_some_and(|first| frame < first);
        let (from, to) = if before { (footage.first, frame) } else { (frame, footage.last) };
        (i64::from(to) - i64::from(from) + 1).max(1) as f64
    };
    let key = |&frame: &FrameNumber| WantedKey { part: part.name.clone(), frame, worth: worth(frame), lost: true };
    part.wants_key.iter().map(key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;

    fn scene(parts: Vec<Part>) -> Scene {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 8, height: 8, held: false };
        Scene { footage, parts }
    }

    fn part(name: &str, confidence: &[f64]) -> Part {
        let frames = || 0..confidence.len() as FrameNumber;
        Part {
            name: name.into(),
            keys: [(0, vec![Point::ZERO]), (frames().end - 1, vec![Point::ZERO])].into(),
            tracks: frames().map(|frame| (frame, vec![Point::ZERO])).collect(),
            confidence: frames().zip(confidence).map(|(frame, &c)| (frame, vec![c, c])).collect(),
            ..Part::default()
        }
    }

    #[test]
    fn one_key_is_wanted_for_each_bad_stretch_the_most_valuable_first() {
        let arm = part("arm", &[0.0, 0.5, 0.25, 0.25, 1.0, 0.25, 0.25, 0.25, 0.25, 1.0, 0.0]);
        let found = Findings::of(&scene(vec![arm, part("leg", &[1.0, 0.25, 1.0])]));
        let wanted: Vec<_> = found.wanted.iter().map(|key| (key.part.as_str(), key.frame, key.worth)).collect();
        assert_eq!(wanted, [("arm", 6, 3.0), ("arm", 2, 1.5)], "0.75 of a contour is not worth a key");
        assert_eq!((&found.parts[0].doubtful[..], &found.parts[0].lost[..]), (&[1][..], &[2, 3, 5, 6, 7, 8][..]));
        assert_eq!(found.least[&1], 0.25);
        assert!(!found.least.contains_key(&0), "keys are beyond doubt");
    }

    #[test]
    fn a_lost_part_wants_keys_worth_all_frames_without_it() {
        let mut arm = part("arm", &[1.0]);
        (arm.keys, arm.tracks) = ([(5, vec![])].into(), [(5, vec![]), (6, vec![])].into());
        arm.confidence.clear();
        arm.wants_key = vec![4, 7];
        let found = Findings::of(&scene(vec![arm]));
        let wanted: Vec<_> = found.wanted.iter().map(|key| (key.frame, key.worth, key.lost)).collect();
        assert_eq!(wanted, [(4, 5.0, true), (7, 3.0, true)]);
        assert_eq!(found.confidence, 1.0);
    }

    #[test]
    fn an_empty_scene_wants_nothing() {
        let found = Findings::of(&scene(vec![]));
        assert_eq!((found.confidence, found.wanted.len(), found.least.len()), (1.0, 0, 0));
    }
}
