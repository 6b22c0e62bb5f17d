//! Measures one preset on one set.
//!
//! The first track starts with cold caches: it includes reading the document and decoding the pictures. All rounds of
//! corrections use the same tracker, so the time of a later track is the time that an artist waits after pressing Track
//! again. Tracks are rounded as in a saved document before they are measured.

use crate::artist::{Rules, Work, correct};
use crate::measure::{Row, percentile, rows};
use crate::memory::peak_mb;
use crate::truth::Truth;
use anyhow::Result;
use rototoon::pictures::Sequence;
use rototoon::pipeline::{frames, in_effect, store};
use rototoon::project::Document;
use rototoon::project::save::DECIMALS;
use rototoon::scene::{FrameNumber, FrameSource, Scene, Silent};
use rototoon::track::{TrackOptions, Tracker};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::Instant;

/// The results of a run.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the set.
    pub set: String,
    /// Id of the preset, and the mechanism that was left out.
    pub preset: String,
    /// Number of threads.
    pub threads: usize,
    /// The figures and the artist's corrections.
    pub work: Work,
    /// Whether the artist made corrections.
    pub corrected: bool,
    /// Seconds of the first track, from opening the document on.
    pub seconds: f64,
    /// Seconds of each track after corrections.
    pub again: Vec<f64>,
    /// Peak memory of the first track in MB.
    pub peak_mb: Option<f64>,
    /// Peak memory of the complete run in MB, with the artist's data.
    pub peak_all_mb: Option<f64>,
    /// Errors of the first track by frame.
    pub frames: Vec<FrameErrors>,
    /// Frames with keys, each with the share of parts that have a key there.
    pub keys: Vec<(FrameNumber, f64)>,
}

/// Errors on one frame, over the scored points of the parts without a key there.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct FrameErrors {
    /// The frame.
    pub frame: FrameNumber,
    /// Number of scored points; at least one.
    pub points: usize,
    /// Median distance to the contour in pixels.
    pub median: f64,
    /// 90th percentile of the distance to the contour in pixels.
    pub p90: f64,
    /// Share of good points.
    pub good: f64,
}

/// A run with the data that pictures of it need.
pub struct Run {
    /// The figures.
    pub outcome: Outcome,
    /// The scene with the first tracks.
    pub tracked: Scene,
    /// The truth.
    pub truth: Truth,
    /// Errors of the first tracks.
    pub rows: Vec<Row>,
    /// The pictures.
    pub frames: Box<dyn FrameSource>,
}

/// Tracks the set in `folder`, and lets the artist correct it if there are rules. `id` names the preset in the results.
/// `told` is called after each track. Runs on the caller's rayon pool.
pub fn run(
    set: &str,
    folder: &Path,
    (options, id): (TrackOptions, &str),
    rules: Option<&Rules>,
    told: impl FnMut(&Work),
) -> Result<Run> {
    let start = Instant::now();
    let mut tracker = Tracker::new(options);
    let (mut scene, pictures) = first(&mut tracker, folder)?;
    let (seconds, peak) = (start.elapsed().as_secs_f64(), peak_mb());

    let truth = Truth::load(&folder.join("truth.json"))?;
    let tracked = scene.clone();
    let mut times = Vec::new();
    let again = |scene: &mut Scene| {
        // Without corrections the scene already has the tracks of the first track.
        let corrected = scene.parts.iter().any(|part| !part.pins.is_empty() || !part.centers.is_empty());
        if corrected {
            times.push(track(&mut tracker, scene, &pictures)?);
        }
        Ok(())
    };
    let none = Rules { rounds: 0, ..Rules::default() };
    let work = correct(&mut scene, &truth, rules.unwrap_or(&none), again, told)?;
    let rows = rows(&tracked, &truth)?;
    let outcome = Outcome {
        set: set.to_owned(),
        preset: id.to_owned(),
        threads: rayon::current_num_threads(),
        work,
        corrected: rules.is_some(),
        seconds,
        again: times,
        peak_mb: peak,
        peak_all_mb: peak_mb(),
        frames: by_frame(&rows, tracked.footage.height as f64),
        keys: keys(&tracked),
    };
    Ok(Run { outcome, tracked, truth, rows, frames: Box::new(pictures) })
}

/// Reads the set's document and tracks it.
pub(super) fn first(tracker: &mut Tracker, folder: &Path) -> Result<(Scene, Sequence)> {
    let mut document = Document::load(&folder.join("project.json"))?;
    let pictures = frames(&document, folder)?;
    track(tracker, &mut document.scene, &pictures)?;
    Ok((document.scene, pictures))
}

/// Tracks the scene and stores the tracks. Returns the seconds of tracking only.
pub(super) fn track(tracker: &mut Tracker, scene: &mut Scene, pictures: &dyn FrameSource) -> Result<f64> {
    let start = Instant::now();
    let tracking = tracker.track(&in_effect(scene), pictures, &Silent)?;
    let seconds = start.elapsed().as_secs_f64();
    store(scene, &tracking);
    let scale = 10f64.powi(DECIMALS);
    for part in &mut scene.parts {
        let (keys, pins) = (&part.keys, &part.pins);
        for (frame, points) in part.tracks.iter_mut().filter(|(frame, _)| !keys.contains_key(frame)) {
            for (index, point) in points.iter_mut().enumerate() {
                if pins.get(frame).and_then(|pins| pins.get(&index)) != Some(point) {
                    *point = (*point * scale).round() / scale;
                }
            }
        }
    }
    Ok(seconds)
}

fn by_frame(rows: &[Row], height: f64) -> Vec<FrameErrors> {
    let mut frames: BTreeMap<FrameNumber, Vec<&Row>> = BTreeMap::new();
    rows.iter().filter(|row| row.scored).for_each(|row| frames.entry(row.frame).or_default().push(row));
    let errors = |(frame, rows): (FrameNumber, Vec<&Row>)| {
        let contour = |q: f64| percentile(rows.iter().map(|row| row.contour).collect(), q);
        let good = rows.iter().filter(|row| row.good(height)).count() as f64 / rows.len() as f64;
        FrameErrors { frame, points: rows.len(), median: contour(0.5), p90: contour(0.9), good }
    };
    frames.into_iter().map(errors).collect()
}

fn keys(scene: &Scene) -> Vec<(FrameNumber, f64)> {
    let frames: BTreeSet<FrameNumber> = scene.parts.iter().flat_map(|part| part.keys.keys().copied()).collect();
    let share = |frame: FrameNumber| {
        let keyed = scene.parts.iter().filter(|part| part.keys.contains_key(&frame)).count();
        keyed as f64 / scene.parts.len() as f64
    };
    frames.into_iter().map(|frame| (frame, share(frame))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_frame_has_its_own_figures() {
        let row =
            |frame: i32, contour: f64, scored: bool| Row { part: 0, frame, index: 0, contour, point: contour, scored };
        let rows = [row(1, 0.0, true), row(1, 4.0, true), row(1, 99.0, false), row(2, 99.0, false), row(3, 1.0, true)];
        let found = by_frame(&rows, 540.0);
        assert_eq!(found.iter().map(|f| (f.frame, f.points)).collect::<Vec<_>>(), [(1, 2), (3, 1)]);
        assert_eq!((found[0].median, found[0].p90, found[0].good), (2.0, 3.6, 0.5));
        assert_eq!((found[1].median, found[1].good), (1.0, 1.0));
    }
}
