//! A simulated artist, who measures how many corrections tracks still need.
//!
//! The artist knows the truth and corrects the tracks in rounds until [`Rules::enough`] of the points are good
//! ([`crate::measure`]). In each round at most a quarter of the frames get one correction each: those with most bad points,
//! but no two neighbouring frames, because a correction also helps the frames around it. On each of these frames the artist
//! takes the part whose bad points have the largest sum of distances. If the part's centre is off by more than 8 px and more
//! than a quarter of the part's size, and is not fixed yet, the artist fixes the centre. Otherwise the artist pins the worst
//! of the part's bad points that has no pin. Then the tracker runs again. The measure is that of Zhou & Xiao 2011: the
//! number of corrections as a share of all control points of the frames between keys (Table 1: 3.6 %, 5.8 % and 9.3 %).
//!
//! Of equally bad frames and parts the first one is taken.

use crate::measure::{Figures, Row, between_keys, figures, rows};
use crate::truth::Truth;
use anyhow::{Result, ensure};
use rototoon::geometry::polygon;
use rototoon::scene::{FrameNumber, Scene};
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Least error of a centre, in pixels, at which the artist fixes it.
const CENTER_OFF: f64 = 8.0;

/// When the artist stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Share of good points at which the artist stops.
    pub enough: f64,
    /// Share of corrections at which no further round begins, of all control points between keys.
    pub cap: f64,
    /// Most rounds.
    pub rounds: usize,
}

impl Default for Rules {
    fn default() -> Self {
        Self { enough: 0.95, cap: 0.10, rounds: 200 }
    }
}

/// The artist's corrections, and the figures before and after.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Work {
    /// Number of fixed centres.
    pub centers: usize,
    /// Number of pins.
    pub pins: usize,
    /// Number of control points of the frames between keys, with hidden ones.
    pub total: usize,
    /// Rounds of correcting and tracking again.
    pub rounds: usize,
    /// Figures before the first correction.
    pub first: Figures,
    /// Figures after the last one.
    pub last: Figures,
}

impl Work {
    /// The number of corrections.
    pub fn edits(&self) -> usize {
        self.centers + self.pins
    }

    /// The corrections as a share of all control points of the frames between keys.
    pub fn share(&self) -> f64 {
        self.edits() as f64 / self.total as f64
    }
}

/// Corrects a scene until the rules say to stop. `track` tracks the scene, first without corrections, then once per round.
/// `told` is called after each track.
///
/// Errors are those of `track`, and those of [`rows`] if the truth does not fit the scene.
pub fn correct(
    scene: &mut Scene,
    truth: &Truth,
    rules: &Rules,
    mut track: impl FnMut(&mut Scene) -> Result<()>,
    mut told: impl FnMut(&Work),
) -> Result<Work> {
    let height = scene.footage.height as f64;
    track(scene)?;
    let mut seen = rows(scene, truth)?;
    let first = figures(&seen, height);
    ensure!(first.points > 0, "the truth scores no point of the frames between keys");
    let total = scene.parts.iter().map(|part| between_keys(part, &scene.footage).len() * part.point_count()).sum();
    let mut work = Work { centers: 0, pins: 0, total, rounds: 0, first, last: first };
    told(&work);
    while work.last.good < rules.enough && work.share() < rules.cap && work.rounds < rules.rounds {
        work.rounds += 1;
        let before = work.edits();
        for frame in chosen_frames(&seen, height) {
            adjust(scene, truth, &seen, frame, &mut work);
        }
        if work.edits() == before {
            break;
        }
        track(scene)?;
        seen = rows(scene, truth)?;
        work.last = figures(&seen, height);
        told(&work);
    }
    Ok(work)
}

/// The frames with most bad points, but no two neighbouring ones, at most a quarter of all.
fn chosen_frames(rows: &[Row], height: f64) -> Vec<FrameNumber> {
    let mut counts = BTreeMap::<FrameNumber, usize>::new();
    rows.iter().filter(|row| row.bad(height)).for_each(|row| *counts.entry(row.frame).or_default() += 1);
    let mut frames: Vec<FrameNumber> = counts.keys().copied().collect();
    // The sort is stable, so the first of equally bad frames comes first.
    frames.sort_by_key(|frame| Reverse(counts[frame]));
    let most = rows.iter().map(|row| row.frame).collect::<BTreeSet<_>>().len().div_ceil(4);
    let mut chosen: Vec<FrameNumber> = Vec::new();
    for frame in frames {
        if chosen.len() < most && chosen.iter().all(|other| frame.abs_diff(*other) > 1) {
            chosen.push(frame);
        }
    }
    chosen
}

/// Makes one correction on a frame, of its worst part. Does nothing if all bad points of the part have pins.
fn adjust(scene: &mut Scene, truth: &Truth, rows: &[Row], frame: FrameNumber, work: &mut Work) {
    let height = scene.footage.height as f64;
    let mut bad: Vec<&Row> = rows.iter().filter(|row| row.frame == frame && row.bad(height)).collect();
    let Some(k) = worst_part(&bad) else { return };
    bad.retain(|row| row.part == k);
    bad.sort_by(|a, b| b.point.total_cmp(&a.point));
    let (part, want) = (&mut scene.parts[k], &truth.parts[k].points[&frame]);
    let size = polygon::bounds(want).map_or(0.0, |(low, high)| (high - low).max_element());
    let center = polygon::center(want);
    let off = polygon::center(&part.tracks[&frame]).distance(center);
    if off > CENTER_OFF.max(size / 4.0) && !part.centers.contains_key(&frame) {
        part.centers.insert(frame, center);
        work.centers += 1;
        return;
    }
    let pinned = |index: usize| part.pins.get(&frame).is_some_and(|pins| pins.contains_key(&index));
    if let Some(worst) = bad.iter().map(|row| row.index).find(|&index| !pinned(index)) {
        part.pins.entry(frame).or_default().insert(worst, want[worst]);
        work.pins += 1;
    }
}

/// The part whose bad points have the largest sum of distances; the first of equal ones.
fn worst_part(bad: &[&Row]) -> Option<usize> {
    let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
    bad.iter().for_each(|row| *sums.entry(row.part).or_default() += row.point);
    sums.into_iter().reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(part, _)| part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::TruePart;
    use rototoon::geometry::Point;
    use rototoon::scene::{Footage, Part};

    const LAST: FrameNumber = 11;

    fn square() -> Vec<Point> {
        [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)].map(|(x, y)| Point::new(x, y)).to_vec()
    }

    /// Two squares at rest with keys on frames 0 and 11. Between these are ten frames of four points each.
    fn still() -> (Scene, Truth) {
        let keys = BTreeMap::from([0, LAST].map(|frame| (frame, square())));
        let part = |name: &str| Part { name: name.into(), closed: true, keys: keys.clone(), ..Part::default() };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: LAST, fps: 24.0, width: 960, height: 540, held: false };
        let every: BTreeMap<_, _> = (0..=LAST).map(|frame| (frame, square())).collect();
        let scored = (0..=LAST).map(|frame| (frame, "1111".into())).collect();
        let truth = TruePart { points: every.clone(), contour: every, scored, ..TruePart::default() };
        let named = |name: &str| TruePart { name: name.into(), ..truth.clone() };
        (Scene { footage, parts: vec![part("a"), part("b")] }, Truth { parts: vec![named("a"), named("b")] })
    }

    /// A tracker that moves every point of part 0 by `off` on the frames that `on` selects. It obeys pins and centres, each
    /// on its own frame only.
    fn off_by(off: Point, on: impl Fn(FrameNumber) -> bool) -> impl FnMut(&mut Scene) -> Result<()> {
        move |scene| {
            for (k, part) in scene.parts.iter_mut().enumerate() {
                for frame in 0..=LAST {
                    let shift = if k == 0 && on(frame) && frame % LAST != 0 { off } else { Point::ZERO };
                    let shift = if part.centers.contains_key(&frame) { Point::ZERO } else { shift };
                    let mut points: Vec<Point> = square().iter().map(|&p| p + shift).collect();
                    for (&index, &pin) in part.pins.get(&frame).into_iter().flatten() {
                        points[index] = pin;
                    }
                    part.tracks.insert(frame, points);
                }
            }
            Ok(())
        }
    }

    fn pinned(scene: &Scene) -> Vec<(FrameNumber, Vec<usize>)> {
        scene.parts[0].pins.iter().map(|(&frame, pins)| (frame, pins.keys().copied().collect())).collect()
    }

    fn work(rules: Rules, track: impl FnMut(&mut Scene) -> Result<()>) -> (Work, Scene) {
        let (mut scene, truth) = still();
        let work = correct(&mut scene, &truth, &rules, track, |_| ()).unwrap();
        (work, scene)
    }

    #[test]
    fn good_tracks_need_nothing() {
        let (work, _) = work(Rules::default(), off_by(Point::new(1.0, 1.0), |_| true));
        assert_eq!((work.edits(), work.rounds, work.total), (0, 0, 80));
        assert_eq!((work.first.good, work.first), (1.0, work.last));
    }

    #[test]
    fn one_round_pins_a_quarter_of_the_frames_and_no_neighbours() {
        let (work, scene) = work(Rules { rounds: 1, ..Rules::default() }, off_by(Point::new(-7.0, -7.0), |_| true));
        assert_eq!(pinned(&scene), [(1, vec![0]), (3, vec![0]), (5, vec![0])], "three of ten");
        assert_eq!((work.pins, work.centers, work.rounds), (3, 0, 1));
        assert!((work.first.good - 0.5).abs() < 1e-12 && (work.last.good - 43.0 / 80.0).abs() < 1e-12);
    }

    #[test]
    fn the_worst_frames_come_first() {
        // On frame 6 all points are bad. On other frames the shift is along the upper edge, so only two points are bad.
        let mut base = off_by(Point::new(-7.0, 0.0), |_| true);
        let track = |scene: &mut Scene| {
            base(scene)?;
            scene.parts[0].tracks.insert(6, square().iter().map(|&p| p - Point::new(7.0, 7.5)).collect());
            Ok(())
        };
        let (_, scene) = work(Rules { rounds: 1, ..Rules::default() }, track);
        assert_eq!(pinned(&scene).iter().map(|(frame, _)| *frame).collect::<Vec<_>>(), [1, 3, 6]);
    }

    #[test]
    fn a_part_that_is_far_off_gets_its_centre_once() {
        // A quarter of the size is 25.
        let near =
            work(Rules { enough: 1.0, rounds: 1, ..Rules::default() }, off_by(Point::new(24.0, 0.0), |f| f == 4));
        assert_eq!((near.0.pins, near.0.centers), (1, 0));
        let (far, scene) = work(Rules { enough: 1.0, ..Rules::default() }, off_by(Point::new(26.0, 0.0), |f| f == 4));
        assert_eq!((far.pins, far.centers, far.rounds, far.last.good), (0, 1, 1, 1.0));
        assert_eq!(scene.parts[0].centers, BTreeMap::from([(4, Point::new(50.0, 50.0))]));
    }

    #[test]
    fn no_round_begins_beyond_the_cap() {
        let (work, _) = work(Rules::default(), off_by(Point::new(-7.0, -7.0), |_| true));
        assert_eq!((work.edits(), work.rounds), (9, 3), "6 of 80 are below a tenth, 9 are not");
        assert!((work.share() - 9.0 / 80.0).abs() < 1e-12);
    }

    #[test]
    fn it_ends_when_nothing_is_left_to_correct() {
        let all = Rules { enough: 1.0, cap: 1.0, rounds: 200 };
        let mut deaf = off_by(Point::new(-7.0, -7.0), |frame| frame == 2);
        let track = |scene: &mut Scene| {
            let pins = std::mem::take(&mut scene.parts[0].pins);
            deaf(scene)?;
            scene.parts[0].pins = pins;
            Ok(())
        };
        let (work, scene) = work(all, track);
        assert_eq!(pinned(&scene), [(2, vec![0, 1, 2, 3])]);
        assert_eq!((work.edits(), work.rounds), (4, 5));
    }

    #[test]
    fn a_truth_without_scored_points_is_refused() {
        let (mut scene, mut truth) = still();
        truth.parts.iter_mut().for_each(|part| part.scored.values_mut().for_each(|marks| *marks = "0000".into()));
        let result = correct(&mut scene, &truth, &Rules::default(), off_by(Point::ZERO, |_| true), |_| ());
        assert!(result.unwrap_err().to_string().contains("scores no point"));
    }
}
