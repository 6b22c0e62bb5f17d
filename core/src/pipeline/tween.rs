//! In-betweens from the drawings of a document.

use super::PipelineError;
use crate::memory;
use crate::project::Document;
use crate::project::drawings::{
    Drawing, Drawings, DrawnBetween, DrawnPeg, DrawnStroke, WrittenTiming, drawing_place, peg_key_place, peg_place,
    read_pegs, read_timing,
};
use crate::project::schema::MAX_FRAMES;
use crate::scene::{Cancelled, FrameNumber, Part, Progress, Scene};
use crate::tween::Stroke;
use crate::tween::between::{Captured, GivenPegs, InBetween, Key, Options, Sequence, Spacing};
use crate::tween::breakdown::Shown;
use crate::tween::matching::{HandPair, InPieces, Matching, Options as MatchingOptions, match_strokes};
use crate::tween::peg::{Peg, PegKey, PegTree, Timing};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What [`tween`] says of the in-betweens that it put into the document.
#[derive(Clone, Debug, Default)]
pub struct Tweened {
    /// The drawings and the in-betweens in time order, for [`super::suggest_breakdown`].
    pub shown: Vec<Shown>,
    /// The frames of both drawings of each span whose earlier drawing is held, because no movement between the two can be
    /// believed.
    pub held: Vec<[FrameNumber; 2]>,
    /// The frames of both drawings of each span in which strokes are exchanged half way, because their counterparts are not sure, with the
    /// number of these strokes.
    pub exchanged: Vec<([FrameNumber; 2], usize)>,
}

impl Tweened {
    /// What a person is told of the spans that are held. `None` if there are none.
    pub fn holding(&self) -> Option<String> {
        let spans: Vec<String> = self.held.iter().map(|[first, last]| format!("{first} to {last}")).collect();
        let why = "no movement between the two drawings can be believed, so the earlier one is held";
        let advice = "pair their strokes by hand, or draw a breakdown";
        (!spans.is_empty()).then(|| format!("frames {}: {why}; {advice}", spans.join(", ")))
    }

    /// What a person is told of strokes that are exchanged. `None` if there are none.
    pub fn exchanging(&self) -> Option<String> {
        let span = |([first, last], count): &([FrameNumber; 2], usize)| {
            format!("{first} to {last} ({count} {})", if *count == 1 { "stroke" } else { "strokes" })
        };
        let spans: Vec<String> = self.exchanged.iter().map(span).collect();
        let why = "strokes of one drawing give way to those of the other half way, because it is not sure which belong together";
        (!spans.is_empty())
            .then(|| format!("frames {}: {why}; pair them by hand, or draw a breakdown", spans.join(", ")))
    }
}

/// Matches the strokes of a document's drawings and puts the in-betweens into the document. With `follow`, strokes on
/// tracked parts of the document follow these parts. It runs on the caller's rayon pool; the result does not depend on
/// the pool.
///
/// # Errors
///
/// [`PipelineError::Tween`] names the field or the frames; [`PipelineError::Cancelled`] is returned when `progress`
/// asks to stop.
pub fn tween(
    document: &mut Document,
    options: &Options,
    follow: bool,
    progress: &dyn Progress,
) -> Result<Tweened, PipelineError> {
    let wrong = |error: &dyn std::fmt::Display| PipelineError::Tween(error.to_string());
    let read = document.drawings().map_err(|e| wrong(&e))?;
    if read.drawings.len() < 2 {
        let found = read.drawings.len();
        let advice = "`rototoon trace --drawings` makes them of pictures";
        return Err(PipelineError::Tween(format!(
            "drawings: found {found}, expected at least two to draw between; {advice}"
        )));
    }
    check_extent(&read.drawings)?;
    let keys = read.drawings.iter().enumerate().map(|(k, d)| key(d, k)).collect::<Result<Vec<_>, _>>()?;
    let pegs = given(&read)?;
    let mut matchings = Vec::new();
    for (k, pair) in keys.windows(2).enumerate() {
        progress.report("matching strokes", 0.8 * k as f64 / (keys.len() - 1) as f64)?;
        let by_hand: Vec<HandPair> =
            read.pairs.iter().filter(|p| p.drawing == k).map(|p| HandPair { from: p.from, to: p.to }).collect();
        let [first, second] = pegs.compared(k, [&pair[0], &pair[1]]);
        let found = match_strokes(&first, &second, &by_hand, &MatchingOptions::default(), &crate::scene::Silent);
        matchings.push(found.map_err(|e| wrong(&format!("frames {} and {}: {e}", pair[0].frame, pair[1].frame)))?);
    }
    progress.report("drawing in-betweens", 0.8)?;
    let frames: Vec<i32> = keys.windows(2).flat_map(|pair| pair[0].frame + 1..pair[1].frame).collect();
    let on_keys: Vec<i32> = keys.iter().map(|key| key.frame).collect();
    let mut sequence = Sequence::new(keys, &matchings, &pegs, options).map_err(|e| wrong(&e))?;
    if follow {
        sequence = sequence.following(captured(&document.scene));
    }
    let done = AtomicUsize::new(0);
    let drawn = frames.par_iter().map(|&frame| {
        let share = done.fetch_add(1, Ordering::Relaxed) as f64 / frames.len() as f64;
        progress.report("drawing in-betweens", 0.8 + 0.2 * share)?;
        Ok(DrawnBetween { frame, strokes: sequence.at(frame).into_iter().map(stroke_of).collect() })
    });
    let drawn = drawn.collect::<Result<Vec<_>, Cancelled>>()?;
    progress.report("drawing in-betweens", 1.0)?;
    let spans = || on_keys.windows(2).enumerate().map(|(k, pair)| ([pair[0], pair[1]], sequence.is_held(k)));
    let numbers: Vec<Vec<usize>> =
        on_keys.iter().map(|&frame| sequence.at(frame).iter().map(|drawn| drawn.track).collect()).collect();
    let found = spans().zip(&matchings).zip(numbers.windows(2));
    let matches = found.map(|((span, matching), tracks)| written(span, matching, tracks)).collect();
    document.set_in_betweens(matches, &drawn);
    // Where no frame lies between, nothing is held.
    let held = spans().filter(|([first, last], held)| *held && first + 1 < *last).map(|(span, _)| span).collect();
    let exchanged =
        spans().enumerate().map(|(k, (span, held))| (span, if held { 0 } else { sequence.exchanged_strokes(k) }));
    let exchanged = exchanged.filter(|([first, last], count)| *count > 0 && first + 1 < *last).collect();
    Ok(Tweened { shown: shown(&sequence, &on_keys, drawn), held, exchanged })
}

/// The drawings on keys and between them, in time order.
fn shown(sequence: &Sequence, keys: &[FrameNumber], between: Vec<DrawnBetween>) -> Vec<Shown> {
    let key = |&frame: &FrameNumber| {
        let strokes = sequence.at(frame).into_iter().map(|drawn| drawn.stroke).collect();
        Shown { frame, key: true, strokes, apart: None }
    };
    let drawn = |DrawnBetween { frame, strokes }: DrawnBetween| {
        let seen = strokes.into_iter().filter(|(_, opacity, _)| *opacity > 0.0);
        let strokes = seen.map(|(_, _, stroke)| Stroke::new(stroke.points, stroke.closed)).collect();
        Shown { frame, key: false, strokes, apart: None }
    };
    let mut all: Vec<Shown> = keys.iter().map(key).chain(between.into_iter().map(drawn)).collect();
    all.sort_by_key(|shown| shown.frame);
    all
}

/// Refuses drawings so far apart that their in-betweens would fill the memory.
fn check_extent(drawings: &[Drawing]) -> Result<(), PipelineError> {
    /// Bytes of a point in the document, in its text and while it is made.
    const POINT: u64 = 200;
    let (Some(first), Some(last)) = (drawings.first(), drawings.last()) else { return Ok(()) };
    let frames = i64::from(last.frame) - i64::from(first.frame) + 1;
    if frames > MAX_FRAMES {
        let extent = format!("found {frames} frames from {} to {}", first.frame, last.frame);
        return Err(PipelineError::Tween(format!("drawings: {extent}, expected at most {MAX_FRAMES}")));
    }
    let count = |drawing: &Drawing| drawing.strokes.iter().map(|stroke| stroke.points.len()).sum::<usize>() as u64;
    let between = |pair: &[Drawing]| {
        pair[0].frame.abs_diff(pair[1].frame).saturating_sub(1) as u64 * count(&pair[0]).max(count(&pair[1]))
    };
    let points: u64 = drawings.windows(2).map(between).sum();
    memory::ask(points.saturating_mul(POINT))
        .map_err(|error| PipelineError::Tween(format!("drawings: found {points} points of in-betweens: {error}")))
}

/// The tracked parts of a scene, for strokes to follow.
pub fn captured(scene: &Scene) -> Arc<[Captured]> {
    let part = |part: &Part| Captured { closed: part.closed, contours: part.tracks.clone() };
    scene.parts.iter().map(part).collect()
}

fn key(drawing: &Drawing, k: usize) -> Result<Key, PipelineError> {
    let stroke = |s: &DrawnStroke| Stroke {
        points: s.points.clone(),
        closed: s.closed,
        colour: s.colour,
        fill: s.fill,
        fill_colour: s.fill_colour,
        widths: s.widths.clone(),
        material: s.material,
        layer: s.layer,
        // The given pegs say it.
        peg: None,
    };
    let place = || format!("{}.spacing", drawing_place(k, drawing.frame));
    let spacing = spacing(&drawing.spacing).map_err(|e| PipelineError::Tween(format!("{}: {e}", place())))?;
    let strokes = drawing.strokes.iter().map(stroke).collect();
    Ok(Key { frame: drawing.frame, strokes, spacing, corner: drawing.corner })
}

/// The spacing in a JSON value of the document's form; `place` names it in errors.
///
/// # Errors
///
/// [`PipelineError::Tween`].
pub fn spacing_of(value: &Value, place: &str) -> Result<Spacing, PipelineError> {
    let written = read_timing(value, place).map_err(|error| PipelineError::Tween(error.to_string()))?;
    spacing(&written).map_err(|error| PipelineError::Tween(format!("{place}: {error}")))
}

/// The pegs in JSON values of the document's form.
///
/// # Errors
///
/// [`PipelineError::Tween`].
pub fn pegs_of(values: &[Value]) -> Result<PegTree, PipelineError> {
    tree(&read_pegs(values).map_err(|error| PipelineError::Tween(error.to_string()))?)
}

/// Converts a spacing. The error states the found and the expected value.
pub(super) fn spacing(written: &WrittenTiming) -> Result<Spacing, String> {
    Ok(match written {
        WrittenTiming::Smooth => Spacing::Smooth,
        WrittenTiming::Chart(shares) => Spacing::Chart(shares.clone()),
        other => Spacing::Timing(movement(other, "smooth, ")?),
    })
}

fn timing(written: &WrittenTiming) -> Result<Timing, String> {
    movement(written, "")
}

/// A movement function. Errors name `also` before the names of functions.
fn movement(written: &WrittenTiming, also: &str) -> Result<Timing, String> {
    let wrong = |found: &str| {
        let known = "constant, linear, ease_in, ease_out, ease_in_out, cosine or bounce";
        format!("found {found}, expected a movement function: {also}{known}")
    };
    match written {
        WrittenTiming::Smooth => Ok(Timing::EaseInOut),
        WrittenTiming::Named(name) => Timing::from_id(name).ok_or_else(|| wrong(&format!("{name:?}"))),
        WrittenTiming::Curve(places) => Ok(Timing::Custom(places.clone())),
        WrittenTiming::Bounce(count) => Ok(Timing::Bounce(*count)),
        WrittenTiming::Chart(shares) => Err(wrong(&format!("a list of {}", shares.len()))),
    }
}

fn given(read: &Drawings) -> Result<GivenPegs, PipelineError> {
    let of = read.drawings.iter().map(|d| d.strokes.iter().map(|s| s.peg).collect()).collect();
    Ok(GivenPegs { tree: tree(&read.pegs)?, of })
}

fn tree(pegs: &[DrawnPeg]) -> Result<PegTree, PipelineError> {
    let pegs = pegs.iter().enumerate().map(|(k, peg)| peg_of(peg, k)).collect::<Result<Vec<_>, _>>();
    let pegs = pegs.map_err(|(place, message)| PipelineError::Tween(format!("{place}: {message}")))?;
    PegTree::new(pegs).map_err(|error| PipelineError::Tween(format!("pegs: {error}")))
}

/// Converts the peg with index `k`. The error consists of its place, and of the found and the expected value.
pub(super) fn peg_of(drawn: &DrawnPeg, k: usize) -> Result<Peg, (String, String)> {
    let keys = drawn.keys.iter().enumerate().map(|(j, key)| {
        let place = || format!("{}.timing", peg_key_place(&peg_place(k, &drawn.name), j, key.frame));
        let timing = timing(&key.timing).map_err(|message| (place(), message))?;
        Ok(PegKey { frame: key.frame, shift: key.shift, turn: key.turn.to_radians(), scale: key.scale, timing })
    });
    let keys = keys.collect::<Result<_, (String, String)>>()?;
    Ok(Peg { name: drawn.name.clone(), parent: drawn.parent, pivot: drawn.pivot, keys })
}

fn stroke_of(drawn: InBetween) -> (usize, f64, DrawnStroke) {
    let Stroke { points, closed, colour, fill, fill_colour, widths, material, layer, peg: _ } = drawn.stroke;
    let stroke = DrawnStroke { points, closed, fill, widths, colour, fill_colour, material, layer, peg: None };
    (drawn.track, drawn.opacity, stroke)
}

/// What the document says of a span: its frames, whether it is held, how strokes match, and the numbers of both drawings'
/// strokes.
fn written(([frame, next], held): ([FrameNumber; 2], bool), matching: &Matching, tracks: &[Vec<usize>]) -> Value {
    let short = |v: f64| (v * 1e4).round() / 1e4;
    let pairs: Vec<Value> = matching
        .pairs
        .iter()
        .map(|p| {
            json!({"from": p.from, "to": p.to, "reversed": p.reversed, "start": short(p.start),
                "confidence": short(p.confidence), "by_hand": p.by_hand})
        })
        .collect();
    let pieces = |list: &[InPieces]| -> Vec<Value> {
        list.iter().map(|found| json!({"whole": found.whole, "pieces": found.pieces})).collect()
    };
    let chained: Vec<Value> = matching
        .chained
        .iter()
        .map(|line| {
            json!({"first": line.first.pieces, "second": line.second.pieces, "closed": line.first.closed,
                "reversed": line.reversed, "start": short(line.start), "confidence": short(line.confidence)})
        })
        .collect();
    let mut written = json!({"frame": frame, "next": next, "pairs": pairs, "split": pieces(&matching.split),
        "joined": pieces(&matching.joined), "vanished": matching.vanished, "appeared": matching.appeared,
        "tracks": tracks});
    // Most drawings have no such lines.
    if !chained.is_empty() {
        written["chained"] = Value::from(chained);
    }
    // Nor are most of them held.
    if held {
        written["held"] = Value::from(true);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_is_told_of_held_spans_and_of_strokes_that_are_exchanged() {
        let nothing = Tweened::default();
        assert_eq!((nothing.holding(), nothing.exchanging()), (None, None));
        let done = Tweened { held: vec![[0, 4]], exchanged: vec![([4, 9], 1), ([9, 12], 7)], ..Tweened::default() };
        assert!(done.holding().unwrap().starts_with("frames 0 to 4: no movement"));
        let said = done.exchanging().unwrap();
        assert!(
            said.starts_with("frames 4 to 9 (1 stroke), 9 to 12 (7 strokes): strokes of one drawing give way"),
            "{said}"
        );
    }
}
