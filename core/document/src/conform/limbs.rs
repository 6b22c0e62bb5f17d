//! Limbs moved to new footage, with what is marked of them: places that were drawn on frames, bends, limbs that change places, and which part is in front.
//!
//! Each goes with its drawing, and what has none any more is named. A calibration point whose last drawn place goes keeps its place along the contour: it
//! becomes one that is bound there.

use super::drawn::{frame, number, place, ranged, set};
use super::{Document, FieldError, Note};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::conform::Conform;
use rototoon_base::scene::{FrameNumber, Part};
use serde_json::{Map, Value, json};

/// Moves the limbs of a document. `parts` are those that it had for the old footage.
pub(super) fn moved(
    document: &mut Document,
    parts: &[Part],
    conform: &Conform,
    notes: &mut Vec<Note>,
) -> Result<(), FieldError> {
    let mut limbs = document.other_list("limbs")?;
    for limb in &mut limbs {
        let name = |end: &str| limb.get(end).and_then(Value::as_str).unwrap_or("?").to_owned();
        let name = format!("the limb from {} to {}", name("from"), name("to"));
        let mut gone = |what: &str, frames: Vec<FrameNumber>| {
            notes.extend(frames.into_iter().map(|frame| Note::Gone { what: format!("{what} of {name}"), frame }));
        };
        if let Some(bends) = limb.get_mut("bends") {
            gone("a bend", by_frame(bends, conform));
        }
        for end in ["start", "end"] {
            let Some(Value::Array(points)) = limb.get_mut(end).and_then(|end| end.get_mut("points")) else { continue };
            points.iter_mut().for_each(|point| gone("a drawn place", calibration(point, parts, conform)));
        }
    }
    let there = !limbs.is_empty();
    set(document, "limbs", there, limbs);
    swaps(document, conform, notes)?;
    let marks = document.other_list("depth_marks")?;
    let mut moved = Vec::new();
    for mark in &marks {
        match ranged(mark, conform) {
            Some(mark) => moved.push(mark),
            None => {
                let frame = frame(mark, "first").or_else(|| frame(mark, "last")).unwrap_or_default();
                notes.push(Note::Gone { what: "a mark of which part is in front".into(), frame });
            }
        }
    }
    set(document, "depth_marks", !marks.is_empty(), moved);
    Ok(())
}

/// The ranges in which left and right change places.
fn swaps(document: &mut Document, conform: &Conform, notes: &mut Vec<Note>) -> Result<(), FieldError> {
    let swaps = document.other_list("limb_swaps")?;
    let mut moved = Vec::new();
    for swap in &swaps {
        let ends = [0, 1].map(|k| swap.get(k).and_then(number));
        let [Some(first), Some(last)] = ends else { continue };
        match conform.frames.range(first, last) {
            Some(range) => moved.push(json!(range)),
            None => notes.push(Note::Gone { what: "limbs that change places".into(), frame: first }),
        }
    }
    set(document, "limb_swaps", !swaps.is_empty(), moved);
    Ok(())
}

/// Moves the drawn places of a calibration point. Returns the frames of those that are gone.
fn calibration(point: &mut Value, parts: &[Part], conform: &Conform) -> Vec<FrameNumber> {
    let Some(drawn) = point.get_mut("drawn") else { return Vec::new() };
    let old = drawn.clone();
    let gone = by_frame(drawn, conform);
    let is_empty = drawn.as_object().is_some_and(Map::is_empty);
    let part = parts.iter().find(|part| point.get("part").and_then(Value::as_str) == Some(&part.name));
    let bound = part.filter(|_| is_empty).and_then(|part| gone.iter().find_map(|&frame| along(part, frame, &old)));
    if let (Some(at), Some(fields)) = (bound, point.as_object_mut()) {
        fields.remove("drawn");
        fields.insert("at".into(), json!(at));
    }
    gone
}

/// Where along a part's contour the place lies that was drawn on a frame: 7.5 is halfway from control point 7 to 8.
fn along(part: &Part, frame: FrameNumber, drawn: &Value) -> Option<f64> {
    let drawn = drawn.get(frame.to_string())?;
    let p = Point::new(drawn.get(0)?.as_f64()?, drawn.get(1)?.as_f64()?);
    let sides = polyline::segments(part.points_at(frame)?, part.closed).enumerate();
    let places = sides.map(|(k, (a, b))| {
        let foot = polyline::nearest_on_segment(p, a, b);
        let share = if a == b { 0.0 } else { foot.distance(a) / b.distance(a) };
        (foot.distance(p), k as f64 + share)
    });
    let nearest = places.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)?;
    // Once round is the first point again.
    Some(if part.closed && nearest >= part.point_count() as f64 { 0.0 } else { nearest })
}

/// Moves an object of points by frame. Returns the frames whose drawings are gone.
fn by_frame(object: &mut Value, conform: &Conform) -> Vec<FrameNumber> {
    let Value::Object(old) = object else { return Vec::new() };
    let frames = old.keys().filter_map(|name| name.parse().ok());
    let gone = frames.filter(|&on| conform.frames.made(on).is_none()).collect();
    let mut moved = Map::new();
    for own in [true, false] {
        for (name, value) in old.iter() {
            let Ok(on) = name.parse::<FrameNumber>() else { continue };
            let Some(new) = conform.frames.made(on).filter(|_| conform.frames.has_own(on) == own) else { continue };
            let mut value = value.clone();
            place(&mut value, conform);
            moved.entry(new.to_string()).or_insert(value);
        }
    }
    *old = moved;
    gone
}
