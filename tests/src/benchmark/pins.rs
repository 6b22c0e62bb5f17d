//! Times of tracking a film again after a pin.
//!
//! An artist pins one point and wants to see what becomes of it. On each part, in the middle of each of its spans, the control
//! point that is farthest from its true place is pinned to it, and stays pinned. Nothing else is edited, so the times are those
//! of a tracker that knows the film. What a tracker remembers must not change what it finds: on request each track is compared
//! with that of a new tracker.

use super::run::{first, track};
use crate::measure::percentile;
use crate::truth::Truth;
use anyhow::{Result, ensure};
use rototoon::scene::{FrameNumber, Scene};
use rototoon::track::{TrackOptions, Tracker};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::Path;

/// A pin, and how long the track after it took.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Pinned {
    /// Name of the part.
    pub part: String,
    /// The frame.
    pub frame: FrameNumber,
    /// Distance from the tracked place to the pin, in pixels.
    pub moved: f64,
    /// Seconds of the track.
    pub seconds: f64,
}

/// Pins points of the set in `folder`, one after the other. Runs on the caller's rayon pool.
///
/// Errors are those of reading and tracking the set. With `check` it is an error if a new tracker finds other tracks.
pub fn pins(folder: &Path, options: TrackOptions, check: bool) -> Result<Vec<Pinned>> {
    let mut tracker = Tracker::new(options);
    let (mut scene, pictures) = first(&mut tracker, folder)?;
    let truth = Truth::load(&folder.join("truth.json"))?;
    let mut found = Vec::new();
    for (p, frame) in middles(&scene) {
        let part = &scene.parts[p];
        let (Some(tracked), Some(truth)) = (part.tracks.get(&frame), truth.parts[p].points.get(&frame)) else {
            continue;
        };
        let far = |k: &usize| tracked[*k].distance(truth[*k]);
        let Some(index) = (0..truth.len()).max_by(|a, b| far(a).total_cmp(&far(b))) else { continue };
        let (moved, place) = (far(&index), truth[index]);
        scene.parts[p].pins.entry(frame).or_default().insert(index, place);
        let seconds = track(&mut tracker, &mut scene, &pictures)?;
        if check {
            let mut anew = scene.clone();
            track(&mut Tracker::new(options), &mut anew, &pictures)?;
            ensure!(
                anew == scene,
                "a new tracker finds other tracks with the pin of {:?} on frame {frame}",
                scene.parts[p].name
            );
        }
        found.push(Pinned { part: scene.parts[p].name.clone(), frame, moved, seconds });
    }
    Ok(found)
}

/// The part and the frame of each pin: the middle of each span that has drawings between its keys.
fn middles(scene: &Scene) -> Vec<(usize, FrameNumber)> {
    let of_part = |p: usize| {
        let keys: Vec<FrameNumber> = scene.parts[p].keys.keys().copied().collect();
        let spans = keys.windows(2).filter(|keys| keys[1] - keys[0] > 1).map(|keys| keys[0].midpoint(keys[1]));
        spans.map(|frame| (p, frame)).collect::<Vec<_>>()
    };
    (0..scene.parts.len()).flat_map(of_part).collect()
}

/// A table of the times, by set.
pub fn markdown(found: &[(String, Vec<Pinned>)]) -> String {
    let mut text = String::from("| set | pins | median | longest |\n| --- | ---: | ---: | ---: |\n");
    for (set, pins) in found.iter().filter(|(_, pins)| !pins.is_empty()) {
        let milliseconds = |q: f64| 1e3 * percentile(pins.iter().map(|pin| pin.seconds).collect(), q);
        let (median, longest) = (milliseconds(0.5), milliseconds(1.0));
        let _ = writeln!(text, "| {set} | {} | {median:.0} ms | {longest:.0} ms |", pins.len());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::{Footage, Part};

    #[test]
    fn pins_are_in_the_middle_of_spans_with_drawings_between_their_keys() {
        let part = |keys: &[FrameNumber]| Part {
            keys: keys.iter().map(|&frame| (frame, Vec::new())).collect(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 4, height: 4, held: false };
        let scene = Scene { footage, parts: vec![part(&[0, 5, 6]), part(&[3]), part(&[0, 2, 9])] };
        assert_eq!(middles(&scene), [(0, 2), (2, 1), (2, 5)]);
    }

    #[test]
    fn the_table_has_the_median_and_the_longest_time() {
        let pin = |seconds: f64| Pinned { part: "arm".into(), frame: 1, moved: 2.0, seconds };
        let found = [("walk".to_owned(), [0.02, 0.9, 0.03].map(pin).to_vec()), ("none".to_owned(), Vec::new())];
        assert_eq!(
            markdown(&found).lines().collect::<Vec<_>>(),
            ["| set | pins | median | longest |", "| --- | ---: | ---: | ---: |", "| walk | 3 | 30 ms | 900 ms |"]
        );
    }
}
