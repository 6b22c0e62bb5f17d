//! Checks a document stage by stage: its scene, its limbs, its drawings, pairs and pegs, and its frames.

use super::report::runs;
use super::reshape::depths::contradiction;
use super::tween::{peg_of, spacing};
use super::{PipelineError, changed, contradicted, gaps, outside};
use crate::pictures::Sequence;
use crate::project::drawings::{Drawings, DrawnPeg, WrittenTiming, drawing_place, peg_key_place, peg_place};
use crate::project::seen::Made;
use crate::project::{Document, FieldError, Problems};
use crate::reshape::capture::Bindings;
use crate::scene::limbs::LimbSet;
use crate::scene::{Footage, FrameError, FrameNumber, FrameSource, Progress, Scene};
use crate::track::rototoon::{WIDEST, too_wide};
use crate::tween::peg::{self, PegError};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeSet;
use std::path::Path;

/// All problems of a document in `folder` and of its frames. Every frame is read.
///
/// # Errors
///
/// An invalid pattern, or [`PipelineError::Cancelled`].
pub fn check(document: &Document, folder: &Path, progress: &dyn Progress) -> Result<Problems, PipelineError> {
    let mut problems = document.problems();
    problems.append(document.misspelt());
    match document.limbs() {
        Ok(set) => limbs(&set, &document.scene, &mut problems),
        Err(error) => problems.error(error.place, format!("found {}, expected {}", error.found, error.expected)),
    }
    problems.append(drawing_problems(document));
    strokes(document, &mut problems);
    if let Err(error) = paint(document, &mut problems) {
        problems.error(error.place, format!("found {}, expected {}", error.found, error.expected));
    }
    for part in &document.scene.parts {
        for frame in part.outdated() {
            let place = format!("part {:?} keys.\"{frame}\"", part.name);
            problems.warning(
                place,
                "the key was changed after tracking, and the old contour is used: run `rototoon track`",
            );
        }
    }
    if let Some(outside) = outside(&document.scene) {
        problems.warning("footage", outside);
    }
    shape(&document.scene.footage, &mut problems);
    let sequence = Sequence::keeping(&document.scene.footage, folder, 0)?;
    // A picture that is held for many frames is read once.
    let mut shown = BTreeSet::new();
    let numbers = document.scene.footage.first..=document.scene.footage.last;
    let numbers: Vec<FrameNumber> = numbers.filter(|&frame| shown.insert(sequence.shown(frame))).collect();
    let (mut done, mut unreadable) = (0, Vec::new());
    progress.report("Reading frames", 0.0)?;
    for batch in numbers.chunks(rayon::current_num_threads().max(1)) {
        let errors: Vec<Option<FrameError>> = batch.par_iter().map(|&frame| sequence.picture(frame).err()).collect();
        unreadable.extend(batch.iter().zip(errors).filter_map(|(&frame, error)| Some((frame, error?))));
        done += batch.len();
        progress.report("Reading frames", done as f64 / numbers.len() as f64)?;
    }
    for found in contradicted(&document.scene, &sequence, progress)? {
        problems.warning(format!("part {:?} keys.\"{}\"", found.part, found.keys[1]), found.to_string());
    }
    gaps::lines(&unreadable).into_iter().for_each(|line| problems.error("footage", line));
    match changed(document, folder, &Made::ALL, None) {
        Ok(lines) => lines.into_iter().for_each(|line| problems.warning("footage", line)),
        Err(PipelineError::Field(wrong)) => problems.error("seen", wrong),
        Err(other) => return Err(other),
    }
    Ok(problems)
}

/// Finds what is wrong with limbs as clips and reshaping find it, and warns of what they carry in vain.
fn limbs(set: &LimbSet, scene: &Scene, problems: &mut Problems) {
    for error in Bindings::problems(set, &scene.parts) {
        let told = error.to_string();
        let (place, what) = told.split_once(": ").unwrap_or(("limbs", &told));
        problems.error(place, what);
    }
    let footage = &scene.footage;
    if let Some(told) = contradiction(set, &scene.parts, footage.first..=footage.last) {
        problems.error("depth_marks", told);
    }
    for (k, limb) in set.limbs.iter().enumerate() {
        for carried in limb.carries.iter().filter(|carried| scene.part_index(&carried.part).is_err()) {
            let told = format!("there is no part {:?}, so the limb does not carry it", carried.part);
            problems.warning(format!("limbs[{k}].carries"), told);
        }
    }
}

/// Names clicks outside of the footage, and warns of colours that become others without effect, and of what lies outside. The error is the first invalid
/// field of the document's paint.
fn paint(document: &Document, problems: &mut Problems) -> Result<(), FieldError> {
    let footage = &document.scene.footage;
    let own = footage.first..=footage.last;
    for (k, clicks) in document.fills()?.iter().enumerate().filter(|(_, clicks)| !own.contains(&clicks.frame)) {
        problems.error(format!("fills[{k}].frame"), super::fill::outside(clicks.frame, footage));
    }
    never_drawn("filled", document.filled()?.into_iter().map(|drawing| drawing.frame), footage, problems);
    super::recolour::problems(document, problems)
}

/// Warns of strokes outside of the footage.
fn strokes(document: &Document, problems: &mut Problems) {
    let footage = &document.scene.footage;
    let between = document.in_betweens().unwrap_or_default();
    never_drawn("in_betweens", between.into_iter().map(|drawing| drawing.frame), footage, problems);
    let traced = document.traced().unwrap_or_default();
    never_drawn("traced", traced.into_iter().map(|drawing| drawing.frame), footage, problems);
}

/// Warns of frames of a field that are outside of the footage.
fn never_drawn(field: &str, frames: impl Iterator<Item = FrameNumber>, footage: &Footage, problems: &mut Problems) {
    let (first, last) = (footage.first, footage.last);
    let unused: Vec<FrameNumber> = frames.filter(|frame| !(first..=last).contains(frame)).collect();
    if !unused.is_empty() {
        let told = format!("found frames {}, which are never drawn: the footage has {first} to {last}", runs(&unused));
        problems.warning(field, told);
    }
}

/// Warns of pictures that can be drawn on but are too wide for the default preset of tracking.
fn shape(footage: &Footage, problems: &mut Problems) {
    if too_wide(footage) {
        let (width, height) = (footage.width, footage.height);
        let expected = format!("the default preset tracks those at most {WIDEST} times as wide as high");
        problems.warning("footage", format!("found pictures of {width}x{height} pixels; {expected}"));
    }
}

/// All problems of a document's drawings, pairs, pegs, in-betweens and traced strokes. Invalid fields come first. Only if all fields are valid,
/// tweening's further conditions are checked.
pub fn drawing_problems(document: &Document) -> Problems {
    let mut problems = Problems::default();
    let (read, wrong) = document.drawings_and_problems();
    for error in &wrong {
        problems.error(&*error.place, format!("found {}, expected {}", error.found, error.expected));
    }
    // What the numbers of strokes belong to is known only of drawings that can be read.
    let numbers = if wrong.is_empty() { document.stroke_numbers().err() } else { None };
    for error in [numbers, document.in_betweens().err(), document.traced().err()].into_iter().flatten() {
        problems.error(&*error.place, format!("found {}, expected {}", error.found, error.expected));
    }
    if wrong.is_empty() {
        spacings(&read, &mut problems);
        pegs(&read, &mut problems);
        odd(&read, &document.scene.footage, &mut problems);
    }
    problems
}

fn spacings(read: &Drawings, problems: &mut Problems) {
    for (k, drawing) in read.drawings.iter().enumerate() {
        let place = format!("{}.spacing", drawing_place(k, drawing.frame));
        match (spacing(&drawing.spacing), read.drawings.get(k + 1)) {
            (Err(message), _) => problems.error(place, message),
            (Ok(found), Some(next)) => {
                if let Err(error) = found.check(drawing.frame, next.frame) {
                    problems.error(place, error.to_string());
                }
            }
            (Ok(_), None) if drawing.spacing != WrittenTiming::Smooth => {
                problems.warning(place, "there is no next drawing, so the spacing has no effect");
            }
            (Ok(_), None) => {}
        }
    }
}

fn pegs(read: &Drawings, problems: &mut Problems) {
    let mut whole = Vec::new();
    for (k, drawn) in read.pegs.iter().enumerate() {
        match peg_of(drawn, k) {
            Ok(peg) => whole.push(peg),
            Err((place, message)) => problems.error(place, message),
        }
    }
    if whole.len() < read.pegs.len() {
        return;
    }
    for (k, error) in peg::problems(&whole) {
        let (place, message) = described(k, &read.pegs[k], &error);
        problems.error(place, message);
    }
}

/// Place and message of a peg's error.
fn described(k: usize, peg: &DrawnPeg, error: &PegError) -> (String, String) {
    let place = peg_place(k, &peg.name);
    // Of several keys on one frame the later one is out of order.
    let index = |frame: FrameNumber| peg.keys.iter().rposition(|key| key.frame == frame).unwrap_or_default();
    let key = |frame: FrameNumber| peg_key_place(&place, index(frame), frame);
    match error {
        PegError::Parent { parent, count, .. } => {
            (format!("{place}.parent"), format!("found {parent}, expected a number below {count}"))
        }
        PegError::Loop { .. } => {
            (format!("{place}.parent"), "the peg is its own ancestor, expected parents without a loop".to_owned())
        }
        PegError::Pivot { x, y, .. } => {
            (format!("{place}.pivot"), format!("found [{x}, {y}], expected numbers between -1e9 and 1e9"))
        }
        // The document has degrees, the peg radians.
        PegError::Key { frame, field: "turn", .. } => (
            format!("{}.turn", key(*frame)),
            format!("found {:e}, expected a number between -5e10 and 5e10", peg.keys[index(*frame)].turn),
        ),
        PegError::Key { frame, field, found, expected, .. } => {
            (format!("{}.{field}", key(*frame)), format!("found {found}, expected {expected}"))
        }
        PegError::Order { frame, before, .. } => (
            format!("{}.frame", key(*frame)),
            format!("found {frame}, expected more than {before}, the frame of the key before it"),
        ),
        PegError::Timing { frame, source, .. } => (format!("{}.timing", key(*frame)), source.to_string()),
    }
}

/// Warns of drawings and pegs without effect and of probable mistakes.
fn odd(read: &Drawings, footage: &Footage, problems: &mut Problems) {
    if read.drawings.len() == 1 {
        problems.warning("drawings", "there is one drawing, so there is nothing to draw between");
    }
    let mut used = vec![false; read.pegs.len()];
    for (k, drawing) in read.drawings.iter().enumerate() {
        let place = drawing_place(k, drawing.frame);
        if !(footage.first..=footage.last).contains(&drawing.frame) {
            let (first, last) = (footage.first, footage.last);
            problems.warning(&*place, format!("the drawing is outside of the footage, frames {first} to {last}"));
        }
        for (i, stroke) in drawing.strokes.iter().enumerate() {
            if stroke.points.is_empty() {
                problems.warning(format!("{place}.strokes[{i}]"), "the stroke has no points, so nothing is drawn");
            }
            let mut on = stroke.peg;
            while let Some(peg) = on.filter(|&peg| !used[peg]) {
                used[peg] = true;
                on = read.pegs[peg].parent;
            }
        }
    }
    for (k, peg) in read.pegs.iter().enumerate().filter(|(k, _)| !used[*k]) {
        problems.warning(peg_place(k, &peg.name), "no stroke hangs on the peg, so it has no effect");
    }
}

#[cfg(test)]
mod tests;
