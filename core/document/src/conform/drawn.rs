//! Strokes, pegs and clicks moved to new footage: the lists beside the parts, as JSON values, so that fields of other tools stay.

use super::{Document, FieldError, Note, limbs};
use crate::drawings::lines;
use crate::recolours::hand_on;
use crate::save::rounded;
use rototoon_base::geometry::Point;
use rototoon_base::scene::conform::Conform;
use rototoon_base::scene::{FrameNumber, Part};
use serde_json::{Value, json};

/// Moves all lists of a document. `parts` are those that it had for the old footage.
pub(super) fn moved(
    document: &mut Document,
    parts: &[Part],
    conform: &Conform,
    notes: &mut Vec<Note>,
) -> Result<(), FieldError> {
    drawings(document, conform, notes)?;
    between(document, conform, notes)?;
    for (name, kind, command) in [("traced", "strokes", "trace"), ("filled", "regions", "fill")] {
        let list = document.other_list(name)?;
        let moved: Vec<Value> = list.iter().flat_map(|entry| computed(entry, kind, conform)).collect();
        let redrawn = |entry: &Value| {
            let new = frame(entry, "frame").and_then(|old| conform.frames.made(old));
            new.is_some_and(|new| conform.frames.is_redrawn(new))
        };
        if list.iter().any(redrawn) {
            let what = if name == "traced" {
                "strokes of drawings that were drawn again"
            } else {
                "paint of drawings that were drawn again"
            };
            notes.push(Note::Again { what, command });
        }
        set(document, name, !list.is_empty(), moved);
    }
    let clicks = document.other_list("fills")?;
    let moved =
        made(&clicks, "clicks", conform, notes, |entry| each(entry, "regions", |click| point(click, "at", conform)));
    set(document, "fills", !clicks.is_empty(), moved);
    recolours(document, conform, notes)?;
    pegs(document, conform, notes)?;
    limbs::moved(document, parts, conform, notes)
}

/// Writes a list; one that was not there stays away.
pub(super) fn set(document: &mut Document, name: &'static str, there: bool, list: Vec<Value>) {
    match (there, list.is_empty()) {
        (false, _) => {}
        (true, true) => document.remove_other_field(name),
        (true, false) => document.set_other_field(name, lines(list.into_iter())),
    }
}

/// Drawings on keys, and the pairs between those that stay neighbours.
fn drawings(document: &mut Document, conform: &Conform, notes: &mut Vec<Note>) -> Result<(), FieldError> {
    let list = document.other_list("drawings")?;
    let moved =
        made(&list, "the drawing", conform, notes, |entry| each(entry, "strokes", |value| stroke(value, conform)));
    let old: Vec<Option<FrameNumber>> = list.iter().map(|entry| frame(entry, "frame")).collect();
    let new: Vec<Option<FrameNumber>> = moved.iter().map(|entry| frame(entry, "frame")).collect();
    // The next drawing is still the next one, and each of both is where its own went.
    let kept = |on: FrameNumber| -> Option<FrameNumber> {
        let at = old.iter().position(|frame| *frame == Some(on))?;
        let [one, next] = [at, at + 1].map(|k| conform.frames.made((*old.get(k)?)?));
        let there = new.iter().position(|frame| *frame == one)?;
        (one.is_some() && new.get(there + 1) == Some(&next)).then_some(one?)
    };
    let pairs = document.other_list("pairs")?;
    let mut moved_pairs = Vec::new();
    for pair in &pairs {
        match frame(pair, "frame").map(|on| (on, kept(on))) {
            Some((_, Some(to))) => moved_pairs.push(with_frame(pair, "frame", to)),
            Some((on, None)) => notes.push(Note::Gone { what: "a pair of strokes".into(), frame: on }),
            None => moved_pairs.push(pair.clone()),
        }
    }
    set(document, "drawings", !list.is_empty(), moved);
    set(document, "pairs", !pairs.is_empty(), moved_pairs);
    Ok(())
}

/// In-betweens stay if only numbers and places have changed.
fn between(document: &mut Document, conform: &Conform, notes: &mut Vec<Note>) -> Result<(), FieldError> {
    let lists = [document.other_list("matches")?, document.other_list("in_betweens")?];
    if lists.iter().all(Vec::is_empty) {
        return Ok(());
    }
    if !conform.frames.only_renumbers() {
        document.remove_other_field("matches");
        document.remove_other_field("in_betweens");
        notes.push(Note::Again { what: "in-betweens", command: "tween" });
        return Ok(());
    }
    let [matches, drawn] = lists;
    let renumbered = |value: &Value, name: &str| match frame(value, name).and_then(|on| conform.frames.made(on)) {
        Some(new) => with_frame(value, name, new),
        None => value.clone(),
    };
    let matches = matches.iter().map(|value| renumbered(&renumbered(value, "frame"), "next")).collect();
    let drawn = drawn.iter().map(|value| {
        let mut value = renumbered(value, "frame");
        each(&mut value, "strokes", |value| stroke(value, conform));
        value
    });
    let drawn = drawn.collect();
    set(document, "matches", true, matches);
    set(document, "in_betweens", true, drawn);
    Ok(())
}

/// Entries of what was made, on the frames of their drawings. Of two that meet on one frame, the one whose own frame it is stays.
fn made(
    list: &[Value],
    what: &str,
    conform: &Conform,
    notes: &mut Vec<Note>,
    place: impl Fn(&mut Value),
) -> Vec<Value> {
    let mut moved: Vec<(FrameNumber, Value)> = Vec::new();
    let frames = &conform.frames;
    for own in [true, false] {
        for entry in list {
            let Some(old) = frame(entry, "frame").filter(|old| frames.has_own(*old) == own) else { continue };
            let new = frames.made(old).filter(|new| moved.iter().all(|(taken, _)| taken != new));
            let Some(new) = new else {
                notes.push(Note::Gone { what: what.into(), frame: old });
                continue;
            };
            if frames.is_redrawn(new) {
                notes.push(Note::Redrawn { what: what.into(), frame: new });
            }
            let mut value = with_frame(entry, "frame", new);
            place(&mut value);
            moved.push((new, value));
        }
    }
    moved.sort_by_key(|(frame, _)| *frame);
    moved.into_iter().map(|(_, value)| value).collect()
}

/// An entry of what was computed, on all frames that show its drawing.
fn computed(entry: &Value, kind: &str, conform: &Conform) -> Vec<Value> {
    let Some(old) = frame(entry, "frame") else { return vec![entry.clone()] };
    let placed = |new| {
        let mut value = with_frame(entry, "frame", new);
        each(&mut value, kind, |value| {
            stroke(value, conform);
            region(value, conform);
        });
        value
    };
    conform.frames.shown(old).map(placed).collect()
}

fn pegs(document: &mut Document, conform: &Conform, notes: &mut Vec<Note>) -> Result<(), FieldError> {
    let pegs = document.other_list("pegs")?;
    let moved = pegs.iter().map(|peg| {
        let mut peg = peg.clone();
        point(&mut peg, "pivot", conform);
        let name = peg.get("name").map_or(String::new(), Value::to_string);
        if let Some(Value::Array(keys)) = peg.get_mut("keys") {
            *keys = made(keys, &format!("peg {name}: the key"), conform, notes, |key| {
                if let Some(shift) = key.get_mut("shift") {
                    lengths(shift, conform);
                }
            });
        }
        peg
    });
    let moved = moved.collect();
    set(document, "pegs", !pegs.is_empty(), moved);
    Ok(())
}

/// Colours that become others, on the frames of their drawings.
fn recolours(document: &mut Document, conform: &Conform, notes: &mut Vec<Note>) -> Result<(), FieldError> {
    let list = document.other_list("recolours")?;
    let (mut moved, mut gone) = (Vec::new(), Vec::new());
    for entry in &list {
        match ranged(entry, conform) {
            Some(value) => moved.push(value),
            None => {
                gone.push(entry);
                let at = frame(entry, "first").or_else(|| frame(entry, "last")).unwrap_or_default();
                notes.push(Note::Gone { what: "a colour that becomes another one".into(), frame: at });
            }
        }
    }
    gone.into_iter().for_each(|entry| hand_on(entry, &mut moved));
    set(document, "recolours", !list.is_empty(), moved);
    Ok(())
}

/// An entry with `first` and `last` on its frames; an end without limit stays without.
pub(super) fn ranged(mark: &Value, conform: &Conform) -> Option<Value> {
    let ends = ["first", "last"].map(|name| frame(mark, name));
    if ends == [None, None] {
        return Some(mark.clone());
    }
    let range = conform.frames.range(ends[0].unwrap_or(FrameNumber::MIN), ends[1].unwrap_or(FrameNumber::MAX))?;
    let mut mark = mark.clone();
    for (k, name) in ["first", "last"].into_iter().enumerate().filter(|(k, _)| ends[*k].is_some()) {
        mark = with_frame(&mark, name, range[k]);
    }
    Some(mark)
}

pub(super) fn number(value: &Value) -> Option<FrameNumber> {
    value.as_i64().and_then(|number| FrameNumber::try_from(number).ok())
}

pub(super) fn frame(entry: &Value, name: &str) -> Option<FrameNumber> {
    entry.get(name).and_then(number)
}

fn with_frame(entry: &Value, name: &str, frame: FrameNumber) -> Value {
    let mut value = entry.clone();
    if let Some(own) = value.get_mut(name) {
        *own = json!(frame);
    }
    value
}

/// Changes each value of a list in a field.
fn each(entry: &mut Value, name: &str, change: impl FnMut(&mut Value)) {
    if let Some(Value::Array(list)) = entry.get_mut(name) {
        list.iter_mut().for_each(change);
    }
}

fn stroke(value: &mut Value, conform: &Conform) {
    if let Some(list) = value.get_mut("points") {
        points(list, conform);
    }
    if let Some(widths) = value.get_mut("widths") {
        lengths(widths, conform);
    }
}

fn region(value: &mut Value, conform: &Conform) {
    if let Some(outline) = value.get_mut("outline") {
        points(outline, conform);
    }
    each(value, "holes", |hole| points(hole, conform));
}

/// Places a list of points.
fn points(list: &mut Value, conform: &Conform) {
    if let Value::Array(list) = list {
        list.iter_mut().for_each(|point| place(point, conform));
    }
}

/// Places the point in a field.
fn point(value: &mut Value, name: &str, conform: &Conform) {
    if let Some(value) = value.get_mut(name) {
        place(value, conform);
    }
}

/// Places a point `[x, y]`. What is no point stays; reading the document names it.
pub(super) fn place(value: &mut Value, conform: &Conform) {
    let [x, y] = [0, 1].map(|k| value.get(k).and_then(Value::as_f64));
    if let (Some(x), Some(y), false) = (x, y, conform.placement.is_same()) {
        let placed = conform.placement.place(Point::new(x, y));
        *value = json!([rounded(placed.x), rounded(placed.y)]);
    }
}

/// Scales a list of lengths.
fn lengths(list: &mut Value, conform: &Conform) {
    let scale = conform.placement.scale;
    if let (Value::Array(list), true) = (list, scale != 1.0) {
        list.iter_mut().for_each(|length| {
            if let Some(own) = length.as_f64() {
                *length = json!(rounded(own * scale));
            }
        });
    }
}
