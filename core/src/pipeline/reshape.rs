//! A drawing made to follow a skeleton clip: its contours and strokes on every frame of the clip.
//!
//! The drawing is a document's contours on one frame, at rest, with limbs.
//!
//! - `moves`: the clip as one of the drawing's body
//! - `motion`: the clip in the drawing's proportions and place, its feet on the drawing's ground
//! - `feet`: the drawing's feet and its ground
//! - `bodies`: every closed part follows the limbs that carry it ([`crate::reshape::puppet`]), corrected by what other
//!   frames show of it ([`crate::reshape::examples`])
//! - `lines`: the strokes and open contours, with the part on which they lie or on their own
//! - `loose`: what parts and lines follow that no limb carries
//! - `depths`: what is in front of what on each frame
//! - `store`: the result in the document
//! - `kept`: what the artist corrected on an earlier result
//! - `own`: what the drawing's own motion has and a result has not
//! - `sunk`: parts that go through the ground
//! - `hover`: feet that never reach it
//! - `told`: what is said about the result
//! - `rate`: the clip at the document's frame rate

mod bodies;
pub(super) mod depths;
mod feet;
mod hover;
mod kept;
mod lines;
mod loose;
mod motion;
mod moves;
mod own;
mod rate;
mod store;
mod sunk;
mod told;

use super::{PipelineError, guesses};
use crate::geometry::Point;
use crate::project::Document;
use crate::project::drawings::DrawnStroke;
use crate::reshape::capture::Bindings;
use crate::reshape::puppet::Options;
use crate::scene::limbs::{Binding, LimbSet};
use crate::scene::{Clip, Footage, FrameNumber, Part, Progress};
use bodies::{Body, Moved};
use kept::Corrections;
use motion::Motion;
use own::OwnMotion;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

pub use crate::reshape::facing::Side;
pub use loose::Given;
pub use rate::at_rate_of;

/// Whether a clip is mirrored, left for right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mirror {
    /// If drawing and clip look to different sides ([`crate::reshape::facing`]).
    #[default]
    Auto,
    /// Yes.
    On,
    /// No.
    Off,
}

impl Mirror {
    /// All values by their names in options.
    pub const ALL: [(&'static str, Self); 3] = [("auto", Self::Auto), ("on", Self::On), ("off", Self::Off)];

    /// The value of a name.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| *name == id).map(|(_, mirror)| *mirror)
    }
}

/// The sides to which a drawing and a clip look; none where it cannot be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// Of the drawing.
    pub drawing: Option<Side>,
    /// Of the clip.
    pub clip: Option<Side>,
}

/// What is to be made of a drawing.
#[derive(Clone, Debug)]
pub struct ReshapeJob<'a> {
    /// The motion, in any unit.
    pub clip: &'a Clip,
    /// Frames a second of the result.
    pub fps: f64,
    /// The frame on which the drawing is at rest; none for the first on which every part has a contour.
    pub rest: Option<FrameNumber>,
    /// The footage that the result lies over; none for the drawing's own, with as many frames as the clip has. One picture is held
    /// on all of them.
    pub over: Option<Footage>,
    /// Chains of the clip's skeleton and of the drawing's that belong together though their names differ. A clip of another
    /// skeleton is retargeted ([`crate::reshape::retarget`]).
    pub chains: Vec<(String, String)>,
    /// Whether the clip is mirrored.
    pub mirror: Mirror,
    /// How parts are reshaped.
    pub options: Options,
    /// By name of a closed part, points that shall follow it beside its own: those of a picture's mesh.
    pub points: BTreeMap<String, Vec<Point>>,
}

/// What was made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reshaped {
    /// Parts that no limb carries, and open contours that lie on no part, for which the document does not say what they follow, each
    /// with what it was given.
    pub given: Vec<(String, Given)>,
    /// By number the strokes of the drawing that lie on no part, each with what it was given.
    pub strokes: Vec<(usize, Given)>,
    /// Parts that move without bending.
    pub rigid: Vec<String>,
    /// Chains of the drawing's skeleton that no chain of the clip moves.
    pub still: Vec<String>,
    /// Whether the clip was mirrored.
    pub mirrored: bool,
    /// The sides to which drawing and clip look, where they decided whether the clip was mirrored. None if the job said it, and for
    /// a motion of the drawing itself.
    pub sides: Option<Sides>,
    /// What a person should know beside, in words: parts that go through the ground, feet that never reach it, strokes that lie on no part.
    pub notes: Vec<String>,
    /// What a person may like to know, in words: what a shot's own motion had and this one has not.
    pub remarks: Vec<String>,
    /// By part and frame where the points of [`ReshapeJob::points`] are.
    pub points: BTreeMap<String, Vec<Vec<Point>>>,
}

/// Reshapes a document's drawing: tracks, snapped paths and depths of its parts, and its strokes, on every frame of the
/// clip. What the artist corrected on an earlier result stays. Runs on the caller's rayon pool; the result does not depend on it.
pub fn reshape(document: &mut Document, job: &ReshapeJob, progress: &dyn Progress) -> Result<Reshaped, PipelineError> {
    let set = document.limbs().map_err(wrong)?;
    let rest = rest_frame(&document.scene.parts, job.rest)?;
    let strokes = strokes_at(document, rest)?;
    let own = OwnMotion::of(document, &set, rest)?;
    let mut corrections = Corrections::of(document, rest)?;
    let outdated = corrections.outdated(document, rest);
    let footage = footage(&document.scene.footage, job);
    let parts = &document.scene.parts;
    let bindings = Bindings::new(&set, parts).map_err(wrong)?;
    let motion = motion::of(&set, &bindings, parts, rest, (job, footage.first))?;
    let (mut bodies, loose) = bodies::of(parts, &strokes, &set, &motion, rest)?;
    add_points(&mut bodies, &job.points)?;
    let depths = depths::of(&set, parts, &bodies, footage.first..=footage.last)?;
    let moved = all_moved(&bodies, &motion, parts, &job.options, progress)?;
    let mut report = told::report(parts, (&bodies, &moved), &loose, &motion, footage.first);
    let mut placed = rebound(&set, &bindings, parts, rest);
    let loose: Vec<_> =
        loose.into_iter().map(|line| (line.moved(&motion), line)).map(|(at, line)| (line, at)).collect();
    own.forget(document);
    store::store(document, footage, (&bodies, &moved), &loose, (&strokes, rest), &depths.by_part);
    correct(document, &mut corrections, &mut report);
    // All frames show the drawing at rest, and with it its side.
    let frames = (document.scene.footage.first, document.scene.footage.last);
    placed.swaps = if set.swapped(rest) { vec![frames] } else { Vec::new() };
    document.set_limbs(&placed);
    if strokes.is_empty() {
        report.notes.extend(own.show_no_strokes(document, rest));
    }
    let same = job.clip.template.same_points(&set.template) && job.chains.is_empty();
    report.notes.extend(outdated);
    report.notes.extend(guesses::followed(job.clip, (&set, &document.scene.parts), report.mirrored, same));
    report.remarks.extend(own.said());
    report.remarks.extend(depths.said);
    Ok(report)
}

/// All bodies on every frame of the clip.
fn all_moved(
    bodies: &[Body],
    motion: &Motion,
    parts: &[Part],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Vec<Moved>, PipelineError> {
    progress.report(STEP, 0.05)?;
    let done = AtomicUsize::new(0);
    let moved = bodies.par_iter().map(|body| {
        let moved = body.moved(motion, parts, options)?;
        let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report(STEP, 0.05 + 0.95 * finished as f64 / bodies.len() as f64)?;
        Ok(moved)
    });
    // Of several errors the first part's is told, whichever was met first.
    let moved: Vec<Result<Moved, PipelineError>> = moved.collect();
    moved.into_iter().collect()
}

/// Notes which keys were made, and puts the artist's corrections of an earlier result into the new one.
fn correct(document: &mut Document, corrections: &mut Corrections, report: &mut Reshaped) {
    let scene = &mut document.scene;
    let made = scene.parts.iter().map(|part| (part.name.clone(), part.keys.clone())).collect();
    let last = scene.footage.last;
    scene.footage = corrections.lengthened(scene.footage.clone());
    corrections.put(&mut scene.parts);
    let (stay, left) = corrections.said(&scene.parts, last);
    report.notes.extend(stay);
    report.remarks.extend(left);
    document.set_reshaped(&made);
}

/// Gives the bodies the points that are asked for.
fn add_points(bodies: &mut [Body], asked: &BTreeMap<String, Vec<Point>>) -> Result<(), PipelineError> {
    for (name, points) in asked {
        let body = bodies.iter_mut().find(|body| body.name == *name);
        let body =
            body.ok_or_else(|| wrong(format!("points: found part {name:?}, expected the name of a closed part")))?;
        if let Some(k) = points.iter().position(|p| !p.is_finite()) {
            return Err(wrong(format!(
                "points, part {name:?}, point {k}: found coordinates that are not finite, expected finite ones"
            )));
        }
        body.points.extend(points);
        body.more = points.len();
    }
    Ok(())
}

/// What progress is told.
const STEP: &str = "Reshaping";

fn wrong(error: impl std::fmt::Display) -> PipelineError {
    PipelineError::Style(error.to_string())
}

fn rest_frame(parts: &[Part], asked: Option<FrameNumber>) -> Result<FrameNumber, PipelineError> {
    let whole = |frame: FrameNumber| parts.iter().find(|part| part.points_at(frame).is_none_or(Vec::is_empty));
    if let Some(frame) = asked {
        return match whole(frame) {
            None => Ok(frame),
            Some(part) => {
                let name = &part.name;
                let reason = format!("found frame {frame} without a contour of {name:?}, expected one of every part");
                Err(PipelineError::option("rest", reason))
            }
        };
    }
    let frames = parts.first().into_iter().flat_map(|part| part.keys.keys().chain(part.tracks.keys()));
    let mut frames: Vec<FrameNumber> = frames.copied().collect();
    frames.sort_unstable();
    let found = frames.into_iter().find(|&frame| whole(frame).is_none());
    found.ok_or_else(|| {
        wrong("parts: found no frame on which every part has a contour, expected one for the drawing at rest")
    })
}

/// The strokes of the drawing on the frame at rest. Between key drawings they are those of its in-between that are more seen than not.
fn strokes_at(document: &Document, rest: FrameNumber) -> Result<Vec<DrawnStroke>, PipelineError> {
    let read = document.drawings().map_err(wrong)?;
    if let Some(drawing) = read.drawings.into_iter().find(|drawing| drawing.frame == rest) {
        return Ok(drawing.strokes);
    }
    let between = document.in_betweens().map_err(wrong)?.into_iter().filter(|between| between.frame == rest);
    let seen = between.flat_map(|between| between.strokes).filter(|(_, opacity, _)| *opacity >= 0.5);
    Ok(seen.map(|(_, _, stroke)| stroke).collect())
}

fn footage(own: &Footage, job: &ReshapeJob) -> Footage {
    let frames = job.clip.postures.len() as FrameNumber;
    let mut footage = match &job.over {
        Some(over) => over.clone(),
        None => Footage { fps: job.fps, ..own.clone() },
    };
    // A drawing on one picture moves before that picture, which is not there for each frame.
    footage.held |= footage.first == footage.last && frames > 1;
    footage.last = footage.first + frames - 1;
    footage
}

/// The limbs bound to the places of the contours that they have at rest: these keep their meaning on every frame.
fn rebound(set: &LimbSet, bindings: &Bindings, parts: &[Part], rest: FrameNumber) -> LimbSet {
    let mut set = set.clone();
    for (k, limb) in set.limbs.iter_mut().enumerate() {
        for (e, end) in [&mut limb.start, &mut limb.end].into_iter().enumerate() {
            for (p, point) in end.points.iter_mut().enumerate() {
                let bound = bindings.bound(k, e, p);
                let part = &parts[bound.part];
                let around = part.closed.then_some(part.point_count() as f64);
                point.binding = Binding::Place(bound.place(rest, around));
            }
        }
        limb.bends.clear();
    }
    set
}

#[cfg(test)]
mod animals;
#[cfg(test)]
mod scenery;
#[cfg(test)]
mod shots;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod walkers;
