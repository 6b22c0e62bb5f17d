//! A part moved to new footage.

use super::Note;
use crate::schema::MAX_FEATHER;
use rototoon_base::geometry::Point;
use rototoon_base::scene::conform::{Conform, FrameMap, Source};
use rototoon_base::scene::{FrameNumber, Part};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// The part in the new footage.
pub(super) fn moved(part: &Part, conform: &Conform, notes: &mut Vec<Note>) -> Part {
    let place = |points: &Vec<Point>| points.iter().map(|p| conform.placement.place(*p)).collect::<Vec<_>>();
    let frames = &conform.frames;
    let mut met = |what: &str, frame: FrameNumber, by: FrameNumber| {
        notes.push(Note::Met { what: format!("part {:?}: the {what}", part.name), frame, by });
    };
    let mut result = Part {
        keys: made(&part.keys, frames, place, |frame, by| met("key", frame, by)),
        pins: pins(part, conform, |frame, by| met("pin", frame, by)),
        centers: made(&part.centers, frames, |p| conform.placement.place(*p), |frame, by| met("centre", frame, by)),
        tracks: shown(&part.tracks, frames, place),
        confidence: shown(&part.confidence, frames, Vec::clone),
        curves: shown(&part.curves, frames, |paths| paths.iter().map(place).collect()),
        depths: shown(&part.depths, frames, |depth| *depth),
        wants_key: part.wants_key.iter().filter_map(|frame| frames.made(*frame)).collect(),
        feather: part.feather.iter().map(|width| (width * conform.placement.scale).min(MAX_FEATHER)).collect(),
        ..part.clone()
    };
    result.absent.clear();
    for [first, last] in absences(part, frames) {
        result.set_absent(first, last);
    }
    end_keys(part, conform, &mut result, notes);
    noted(part, frames, notes);
    result
}

/// What was made on frames goes to one frame each. Of two that meet on one frame, the one whose own frame it is stays, and `met` gets the old frame of the other one
/// with the new frame.
fn made<T, U: PartialEq>(
    map: &BTreeMap<FrameNumber, T>,
    frames: &FrameMap,
    place: impl Fn(&T) -> U,
    mut met: impl FnMut(FrameNumber, FrameNumber),
) -> BTreeMap<FrameNumber, U> {
    let mut result = BTreeMap::new();
    for own in [true, false] {
        for (&frame, value) in map.iter().filter(|(frame, _)| frames.has_own(**frame) == own) {
            let Some(new) = frames.made(frame) else { continue };
            let value = place(value);
            match result.entry(new) {
                Entry::Vacant(free) => drop(free.insert(value)),
                Entry::Occupied(other) if *other.get() != value => met(frame, new),
                Entry::Occupied(_) => {}
            }
        }
    }
    result
}

/// The pins of a part. Those of several points that meet on one frame all stay.
fn pins(
    part: &Part,
    conform: &Conform,
    mut met: impl FnMut(FrameNumber, FrameNumber),
) -> BTreeMap<FrameNumber, BTreeMap<usize, Point>> {
    let points: BTreeSet<usize> = part.pins.values().flat_map(BTreeMap::keys).copied().collect();
    let mut result: BTreeMap<FrameNumber, BTreeMap<usize, Point>> = BTreeMap::new();
    for point in points {
        let own = part.pins.iter().filter_map(|(frame, pins)| Some((*frame, *pins.get(&point)?))).collect();
        for (frame, p) in made(&own, &conform.frames, |p| conform.placement.place(*p), &mut met) {
            result.entry(frame).or_default().insert(point, p);
        }
    }
    result
}

/// What was computed goes to all frames that show the drawing.
fn shown<T, U>(map: &BTreeMap<FrameNumber, T>, frames: &FrameMap, place: impl Fn(&T) -> U) -> BTreeMap<FrameNumber, U> {
    map.iter()
        .flat_map(|(frame, value)| frames.shown(*frame).map(|new| (new, place(value))).collect::<Vec<_>>())
        .collect()
}

/// Times of absence. A new drawing between two on which the part is absent does not show it either.
fn absences(part: &Part, frames: &FrameMap) -> Vec<[FrameNumber; 2]> {
    let within = |frame: FrameNumber| part.absent.iter().any(|[first, last]| (*first..=*last).contains(&frame));
    let (mut found, mut unknown): (Vec<[FrameNumber; 2]>, Option<FrameNumber>) = (Vec::new(), None);
    let mut before = false;
    for (&new, source) in frames.sources() {
        match source {
            Source::New => unknown = unknown.or(Some(new)),
            Source::Same(old) | Source::Redrawn(old) => {
                let absent = within(*old);
                if absent {
                    found.push([unknown.filter(|_| before).unwrap_or(new), new]);
                }
                (before, unknown) = (absent, None);
            }
        }
    }
    found
}

/// Gives the part keys in place of a first and a last one whose drawings are gone.
fn end_keys(part: &Part, conform: &Conform, result: &mut Part, notes: &mut Vec<Note>) {
    let ends = [part.keys.keys().next(), part.keys.keys().next_back()];
    for (end, &frame) in ends.into_iter().enumerate().filter_map(|(end, frame)| Some((end, frame?))) {
        if conform.frames.made(frame).is_some() {
            continue;
        }
        let there = |new: &&FrameNumber| !result.is_absent(**new);
        let by = match end {
            0 => result.tracks.keys().find(there),
            _ => result.tracks.keys().rev().find(there),
        };
        // A part with one key has it at both ends.
        let Some(by) = by.copied().filter(|by| !result.keys.contains_key(by)) else { continue };
        if end == 1 && ends[0] == ends[1] && !result.keys.is_empty() {
            continue;
        }
        result.keys.insert(by, result.tracks[&by].clone());
        notes.push(Note::Replaced { part: part.name.clone(), frame, by });
    }
}

/// Names keys and corrections whose drawings are gone or were drawn again.
fn noted(part: &Part, frames: &FrameMap, notes: &mut Vec<Note>) {
    let name = &part.name;
    let each = [
        ("key", part.keys.keys().copied().collect::<Vec<_>>()),
        ("pins", part.pins.keys().copied().collect()),
        ("centre", part.centers.keys().copied().collect()),
    ];
    for (kind, made) in each {
        for frame in made {
            let what = format!("part {name:?}: the {kind}");
            match frames.made(frame) {
                None => {
                    let replaced = |note: &Note| matches!(note, Note::Replaced { part, frame: on, .. } if part == name && *on == frame);
                    if kind != "key" || !notes.iter().any(replaced) {
                        notes.push(Note::Gone { what, frame });
                    }
                }
                Some(new) if frames.is_redrawn(new) => notes.push(Note::Redrawn { what, frame: new }),
                Some(_) => {}
            }
        }
    }
}
