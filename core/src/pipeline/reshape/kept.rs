//! What the artist corrected on frames that reshaping made: it stays as it is.
//!
//! Whoever reshapes a drawing again, with another clip, keeps the corrections of the earlier result, as in Blender. They are exact:
//!
//! - a key stays, and is the contour of its frame
//! - pins stay. The contour of their frame stays as it was, with the pins in their places: the rest of another clip's contour would not fit
//!   those points that were moved
//! - a centre stays. The new clip's contour is moved there
//! - where a part was marked as absent, it stays absent
//!
//! They also stay on frames that the clip does not reach; the footage then goes on to the last of them.
//!
//! Which of a document's keys the artist made, it says itself ([`Document::reshaped`]). A part that has no key but that of the drawing
//! was not tracked towards other keys, so its pins and centres are corrections of such a result too. The other keys, pins and centres of
//! a shot are those of the shot's own motion, and would tear another motion apart. So is where its parts are absent, unless the part was
//! reshaped before. The result does not have them; what it then lacks is said.

use super::{PipelineError, wrong};
use crate::geometry::Point;
use crate::pipeline::outdated;
use crate::pipeline::report::{ranges, runs};
use crate::pipeline::untracked::named;
use crate::project::Document;
use crate::scene::{Footage, FrameNumber, Part};
use std::collections::{BTreeMap, BTreeSet};

/// Documents are written with rounded numbers, so this near, in pixels, is the same place.
const SAME: f64 = 0.01;

/// The corrections of a document, in the order of its parts.
pub(super) struct Corrections {
    kept: Vec<Part>,
    left: Vec<Part>,
}

impl Corrections {
    /// Those of a document whose drawing is at rest on a frame.
    pub fn of(document: &Document, rest: FrameNumber) -> Result<Self, PipelineError> {
        let reshaped = document.reshaped().map_err(wrong)?;
        let (mut kept, mut left) = (Vec::new(), Vec::new());
        for part in &document.scene.parts {
            let mut own = part.clone();
            let stays = match reshaped.get(&part.name) {
                Some(made) => {
                    own.keys.retain(|frame, key| !made.get(frame).is_some_and(|made| same(made, key)));
                    true
                }
                None => {
                    own.keys.remove(&rest);
                    own.keys.is_empty()
                }
            };
            let none = Part { name: part.name.clone(), ..Part::default() };
            let (mut stay, mut go) = if stays { (own, none) } else { (none, own) };
            if !reshaped.contains_key(&part.name) {
                go.absent.extend(std::mem::take(&mut stay.absent));
            }
            kept.push(stay);
            left.push(go);
        }
        Ok(Self { kept, left })
    }

    /// What is said of keys that were changed after tracking, so that the drawing's old contours are used. Keys that stay are not among them,
    /// but for those of the drawing at rest.
    pub fn outdated(&self, document: &Document, rest: FrameNumber) -> Option<String> {
        let mut scene = document.scene.clone();
        for (part, kept) in scene.parts.iter_mut().zip(&self.kept) {
            part.keys.retain(|frame, _| *frame == rest || !kept.keys.contains_key(frame));
        }
        outdated(&scene)
    }

    /// The footage of a result, long enough for what stays. What would be before its first frame cannot stay.
    pub fn lengthened(&mut self, mut footage: Footage) -> Footage {
        for (kept, left) in self.kept.iter_mut().zip(&mut self.left) {
            let late = kept.keys.split_off(&footage.first);
            left.keys.extend(std::mem::replace(&mut kept.keys, late));
            let late = kept.pins.split_off(&footage.first);
            left.pins.extend(std::mem::replace(&mut kept.pins, late));
            let late = kept.centers.split_off(&footage.first);
            left.centers.extend(std::mem::replace(&mut kept.centers, late));
            footage.last = frames_of(kept).last().copied().unwrap_or(footage.last).max(footage.last);
        }
        footage
    }

    /// Puts what stays into the parts of a result.
    pub fn put(&self, parts: &mut [Part]) {
        parts.iter_mut().zip(&self.kept).for_each(|(part, kept)| put(part, kept));
    }

    /// What is said: of what stays, with the last frame of the clip, and of what the result does not have.
    pub fn said(&self, result: &[Part], last: FrameNumber) -> (Option<String>, Vec<String>) {
        let stays = |part: &Part| {
            let frames: Vec<FrameNumber> = frames_of(part).into_iter().collect();
            let corrected = (!frames.is_empty()).then(|| format!("on {}", runs(&frames)));
            let absent = (!part.absent.is_empty()).then(|| format!("absent on {}", absence(part)));
            let list: Vec<String> = corrected.into_iter().chain(absent).collect();
            (!list.is_empty()).then(|| format!("{:?} {}", part.name, list.join(" and ")))
        };
        let list: Vec<String> = self.kept.iter().filter_map(stays).collect();
        let beyond = self.kept.iter().flat_map(frames_of).any(|frame| frame > last);
        let beyond = if beyond { format!("; the clip ends on {last}") } else { String::new() };
        let stay = (!list.is_empty()).then(|| format!("your corrections stay: {}{beyond}", list.join(", ")));
        (stay, self.said_of_left(result).into_iter().chain(self.said_of_absence()).collect())
    }

    fn said_of_left(&self, result: &[Part]) -> Option<String> {
        let lacking: Vec<(&Part, BTreeSet<FrameNumber>)> =
            self.left.iter().zip(result).map(|(left, made)| (left, lacking(left, made))).collect();
        let parts = named(lacking.iter().filter(|(_, frames)| !frames.is_empty()).map(|(part, _)| *part))?;
        let frames: BTreeSet<FrameNumber> = lacking.iter().flat_map(|(_, frames)| frames).copied().collect();
        let frames = runs(&frames.into_iter().collect::<Vec<_>>());
        Some(format!("keys and corrections of the drawing's own motion are not in the result: {parts}, on {frames}"))
    }

    fn said_of_absence(&self) -> Option<String> {
        let absent = |part: &&Part| !part.absent.is_empty();
        let list: Vec<String> =
            self.left.iter().filter(absent).map(|part| format!("{:?} on {}", part.name, absence(part))).collect();
        let list = list.join(", ");
        (!list.is_empty())
            .then(|| format!("the result shows parts that are absent in the drawing's own motion: {list}"))
    }
}

/// The frames on which a part is absent, as text.
fn absence(part: &Part) -> String {
    ranges(part.absent.iter().map(|&[first, last]| (first, last)))
}

/// The frames on which a part is corrected.
fn frames_of(part: &Part) -> BTreeSet<FrameNumber> {
    part.keys.keys().chain(part.pins.keys()).chain(part.centers.keys()).copied().collect()
}

/// The frames on which a result is not as it was corrected.
fn lacking(left: &Part, made: &Part) -> BTreeSet<FrameNumber> {
    let near = |a: &Point, b: &Point| a.distance(*b) <= SAME;
    let at = |frame: &FrameNumber| made.points_at(*frame).map_or(&[][..], Vec::as_slice);
    let key = |(frame, key): (&FrameNumber, &Vec<Point>)| (!same(at(frame), key)).then_some(*frame);
    let pins = |(frame, pins): (&FrameNumber, &BTreeMap<usize, Point>)| {
        let there = at(frame);
        (!pins.iter().all(|(k, p)| there.get(*k).is_some_and(|q| near(p, q)))).then_some(*frame)
    };
    let center = |(frame, center): (&FrameNumber, &Point)| {
        (!mean(at(frame)).is_some_and(|mean| near(&mean, center))).then_some(*frame)
    };
    let keys = left.keys.iter().filter_map(key).chain(left.pins.iter().filter_map(pins));
    keys.chain(left.centers.iter().filter_map(center)).collect()
}

/// Whether two contours are one.
fn same(a: &[Point], b: &[Point]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.distance(*b) <= SAME)
}

/// Puts a part's corrections into its result.
fn put(part: &mut Part, kept: &Part) {
    for (frame, pins) in &kept.pins {
        let Some(mut points) = kept.tracks.get(frame).or_else(|| part.tracks.get(frame)).cloned() else { continue };
        for (k, pin) in pins {
            if let Some(point) = points.get_mut(*k) {
                *point = *pin;
            }
        }
        part.tracks.insert(*frame, points);
    }
    for (frame, center) in &kept.centers {
        let Some(points) = part.tracks.get(frame).or_else(|| kept.tracks.get(frame)) else { continue };
        let moved = centred(points.clone(), *center, kept.pins.get(frame));
        part.tracks.insert(*frame, moved);
    }
    part.tracks.extend(kept.keys.clone());
    part.keys.extend(kept.keys.clone());
    (part.pins, part.centers) = (kept.pins.clone(), kept.centers.clone());
    part.curves.retain(|frame, _| !frames_of(kept).contains(frame));
    part.absent = kept.absent.clone();
    without_made_where_absent(part, kept);
    part.forget_where_absent();
}

/// Where a part is absent it has no key that was made, as it would be there on a key. The first one stays: the drawing is at rest there.
fn without_made_where_absent(part: &mut Part, kept: &Part) {
    let absent = part.absent.clone();
    let within = |frame: FrameNumber| absent.iter().any(|&[first, last]| (first..=last).contains(&frame));
    let first = part.keys.first_key_value().map(|(frame, _)| *frame);
    part.keys.retain(|frame, _| Some(*frame) == first || kept.keys.contains_key(frame) || !within(*frame));
}

/// A contour whose mean is in its place. Pinned points stay where they are.
fn centred(mut points: Vec<Point>, center: Point, pins: Option<&BTreeMap<usize, Point>>) -> Vec<Point> {
    let pinned = |k: usize| pins.is_some_and(|pins| pins.contains_key(&k));
    let free = (0..points.len()).filter(|&k| !pinned(k)).count();
    if let (Some(mean), true) = (mean(&points), free > 0) {
        let shift = (center - mean) * (points.len() as f64 / free as f64);
        points.iter_mut().enumerate().filter(|(k, _)| !pinned(*k)).for_each(|(_, point)| *point += shift);
    }
    points
}

fn mean(points: &[Point]) -> Option<Point> {
    (!points.is_empty()).then(|| points.iter().copied().sum::<Point>() / points.len() as f64)
}
