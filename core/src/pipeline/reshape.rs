//! A drawing made to follow a skeleton clip: its contours and strokes on every frame of the clip.
//!
//! The drawing is a document's contours on one frame, at rest, with limbs. The clip is brought to the drawing's
//! proportions limb by limb, its way and its ground to the drawing's size and ground; shoulders and hips stay on its
//! body, feet that stand in the clip stay where they stand. Every closed part follows the limbs that carry it
//! ([`crate::reshape::puppet`]), and takes along the strokes and open contours that lie on it. Marks "in front" and
//! "behind" give the depths of each frame.

mod store;

use super::PipelineError;
use crate::geometry::{Point, polygon, polyline};
use crate::project::Document;
use crate::project::drawings::DrawnStroke;
use crate::reshape::capture::{Bindings, capture};
use crate::reshape::depth::{DepthError, Mark, infer};
use crate::reshape::limb::{Bend, bend_at};
use crate::reshape::puppet::{Carrier, LimbPose, Options, Puppet};
use crate::scene::limbs::{Binding, Limb, LimbSet};
use crate::scene::proportions::Proportions;
use crate::scene::skeleton::{LEGS, MIRROR, NAMES, Posture};
use crate::scene::{Clip, Footage, FrameNumber, Part, Progress};
use crate::style::finish::keep_contacts;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Depths are written to a millionth.
const DEPTH_SCALE: f64 = 1e6;
/// Share of a clip's frames whose lowest foot is no lower than its ground.
const GROUND: f64 = 0.75;

/// Share of the shin's turn that a shoe takes which no limb carries: feet keep nearly the angle that they are drawn
/// with.
const FOOT_TURN: f64 = 0.3;

/// What is to be made of a drawing.
#[derive(Clone, Debug)]
pub struct ReshapeJob<'a> {
    /// The motion, in any unit.
    pub clip: &'a Clip,
    /// Frames a second of the result.
    pub fps: f64,
    /// The frame on which the drawing is at rest; none for the first on which every part has a contour.
    pub rest: Option<FrameNumber>,
    /// The footage that the result lies over; none for the drawing's own, with as many frames as the clip has.
    pub over: Option<Footage>,
    /// How parts are reshaped.
    pub options: Options,
    /// By name of a closed part, points that shall follow it beside its own: those of a picture's mesh.
    pub points: BTreeMap<String, Vec<Point>>,
}

/// What was made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reshaped {
    /// Parts that no limb carries, each with the limb (its key points) that it was given: the nearest.
    pub given: Vec<(String, (&'static str, &'static str))>,
    /// Parts that move without bending.
    pub rigid: Vec<String>,
    /// By part and frame where the points of [`ReshapeJob::points`] are.
    pub points: BTreeMap<String, Vec<Vec<Point>>>,
}

/// Reshapes a document's drawing: tracks, snapped paths and depths of its parts, and its strokes, on every frame of the
/// clip. Runs on the caller's rayon pool; the result does not depend on it.
pub fn reshape(document: &mut Document, job: &ReshapeJob, progress: &dyn Progress) -> Result<Reshaped, PipelineError> {
    let set = document.limbs().map_err(wrong)?;
    let rest = rest_frame(&document.scene.parts, job.rest)?;
    let strokes = strokes_at(document, rest)?;
    let footage = footage(&document.scene.footage, job);
    let parts = &document.scene.parts;
    let bindings = Bindings::new(&set, parts).map_err(wrong)?;
    let postures = fitted(&set, parts, rest, job.clip)?;
    let limbs = limb_poses(&set, &bindings, rest, footage.first, &postures)?;
    let mut bodies = bodies(parts, &strokes, &set, &limbs.rest, rest)?;
    add_points(&mut bodies, &job.points)?;
    let depths = depths(&set, parts, footage.first..=footage.last)?;
    progress.report(STEP, 0.05)?;
    let done = AtomicUsize::new(0);
    let moved = bodies.par_iter().map(|body| {
        let moved = body.moved(&limbs, &job.options)?;
        let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report(STEP, 0.05 + 0.95 * finished as f64 / bodies.len() as f64)?;
        Ok(moved)
    });
    // Of several errors the first part's is told, whichever was met first.
    let moved: Vec<Result<Moved, PipelineError>> = moved.collect();
    let moved = moved.into_iter().collect::<Result<Vec<_>, _>>()?;
    let rigid = bodies.iter().zip(&moved).filter(|(_, m)| m.rigid).map(|(b, _)| parts[b.part].name.clone()).collect();
    let given = bodies.iter().filter_map(|body| {
        let limb = &set.limbs[body.nearest?];
        Some((parts[body.part].name.clone(), (NAMES[limb.from], NAMES[limb.to])))
    });
    let points = bodies.iter().zip(&moved).filter(|(body, _)| body.more > 0);
    let points = points.map(|(body, moved)| {
        let tail = |points: &Vec<Point>| points[points.len() - body.more..].to_vec();
        (body.name.clone(), moved.frames.iter().map(tail).collect())
    });
    let report = Reshaped { given: given.collect(), rigid, points: points.collect() };
    let placed = rebound(&set, &bindings, parts, rest);
    store::store(document, footage, (&bodies, &moved), &strokes, &depths);
    document.set_limbs(&placed);
    Ok(report)
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
                Err(wrong(format!("frame {frame}: found no contour of {:?}, expected one of every part", part.name)))
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

/// The strokes of the drawing on the frame at rest.
fn strokes_at(document: &Document, rest: FrameNumber) -> Result<Vec<DrawnStroke>, PipelineError> {
    let read = document.drawings().map_err(wrong)?;
    Ok(read.drawings.into_iter().find(|drawing| drawing.frame == rest).map_or_else(Vec::new, |d| d.strokes))
}

fn footage(own: &Footage, job: &ReshapeJob) -> Footage {
    let frames = job.clip.postures.len() as FrameNumber;
    let mut footage = match &job.over {
        Some(over) => over.clone(),
        None => Footage { fps: job.fps, ..own.clone() },
    };
    footage.last = footage.first + frames - 1;
    footage
}

/// The clip's postures in the drawing's proportions and place.
fn fitted(set: &LimbSet, parts: &[Part], rest: FrameNumber, clip: &Clip) -> Result<Vec<Posture>, PipelineError> {
    if let Some(frame) = clip.postures.iter().position(|p| p.iter().any(|q| !q.is_finite())) {
        let (character, motion) = (&clip.character, &clip.motion);
        return Err(wrong(format!(
            "clip ({character:?}, {motion:?}), frame {frame}: found a coordinate that is not finite, expected finite coordinates"
        )));
    }
    let drawn = capture(set, parts, rest..=rest).map_err(wrong)?;
    let posture = drawn.postures[0];
    let (own, theirs) = (Proportions::of(&[posture]), Proportions::of(&clip.postures));
    if theirs.torso() <= 0.0 {
        return Err(wrong("clip: found a torso of length 0, expected a positive length"));
    }
    let told = |leg: &[usize; 3]| leg.iter().all(|&k| drawn.guessed[k] == 0);
    let legs =
        |p: &Proportions| LEGS.iter().filter(|leg| told(leg)).map(|leg| p.0[leg[1] - 1] + p.0[leg[2] - 1]).sum::<f64>();
    let stands = legs(&own) > 0.0 && legs(&theirs) > 0.0;
    let size = if stands { legs(&own) / legs(&theirs) } else { own.torso() / theirs.torso() };
    let lowest = |p: &Posture| LEGS.iter().map(|leg| p[leg[2]].y).fold(f64::NEG_INFINITY, f64::max);
    let mut low: Vec<f64> = clip.postures.iter().map(lowest).collect();
    low.sort_by(f64::total_cmp);
    let first = clip.postures[0][0];
    // What lies on the drawing's ground, or on its pelvis where it has no legs.
    let (level, ground) = match low.get(((low.len() - 1) as f64 * GROUND) as usize) {
        Some(level) if stands => (*level, lowest(&posture)),
        _ => (first.y, posture[0].y),
    };
    let place = |p: &Posture| {
        let pelvis = Point::new(posture[0].x + size * (p[0].x - first.x), ground + size * (p[0].y - level));
        theirs.to_drawing(&own, p).map(|q| q - p[0] + pelvis)
    };
    let mut postures: Vec<Posture> = clip.postures.iter().map(place).collect();
    keep_contacts(&mut postures, &clip.postures);
    Ok(postures)
}

/// All limbs at rest and on every frame.
struct Limbs {
    rest: Vec<LimbPose>,
    frames: Vec<Vec<LimbPose>>,
}

fn limb_poses(
    set: &LimbSet,
    bindings: &Bindings,
    rest: FrameNumber,
    first: FrameNumber,
    postures: &[Posture],
) -> Result<Limbs, PipelineError> {
    let drawn = bindings.drawn(rest);
    let mut limbs = Limbs { rest: Vec::new(), frames: vec![Vec::with_capacity(set.limbs.len()); postures.len()] };
    for (k, limb) in set.limbs.iter().enumerate() {
        let named = |what: &str| wrong(format!("limbs[{k}] ({} to {}), {what}", NAMES[limb.from], NAMES[limb.to]));
        let ends = drawn[limb.from].zip(drawn[limb.to]);
        let ends =
            ends.ok_or_else(|| named(&format!("frame {rest}: found no contour for its key points, expected one")))?;
        if ends.0.distance(ends.1) <= 1e-6 {
            return Err(named(&format!("frame {rest}: found a length of 0, expected a positive one")));
        }
        let mut bends = Vec::new();
        for (&frame, &control) in &limb.bends {
            let [Some(a), Some(b)] = bindings.limb(k, frame) else {
                return Err(named(&format!("bends, frame {frame}: found no contour for the limb, expected one")));
            };
            bends.push((frame, Bend::of(a, b, control)));
        }
        limbs.rest.push(LimbPose { ends, bend: bend_at(&bends, rest) });
        // A drawing that shows the other side hangs on the other side's key points.
        let side = |point: usize| if set.swapped(rest) { MIRROR[point] } else { point };
        for (frame, (posture, poses)) in (first..).zip(postures.iter().zip(&mut limbs.frames)) {
            let ends = (posture[side(limb.from)], posture[side(limb.to)]);
            // Bends drawn on a few frames are those of the drawing; the motion goes from one to the next.
            poses.push(LimbPose { ends, bend: bend_at(&bends, frame) });
        }
    }
    Ok(limbs)
}

/// A closed part with everything that follows it.
struct Body {
    part: usize,
    outline: Vec<Point>,
    carriers: Vec<Carrier>,
    /// The limb that it was given, since none carries it.
    nearest: Option<usize>,
    rest: Vec<LimbPose>,
    name: String,
    /// Control points, then the points of its snapped paths, those of its strokes, and those asked for.
    points: Vec<Point>,
    /// Number of control points.
    count: usize,
    /// Numbers of points of its snapped paths.
    paths: Vec<usize>,
    /// Strokes by number (those of the drawing first, then the open parts), with their numbers of points.
    strokes: Vec<(usize, usize)>,
    /// Number of points asked for.
    more: usize,
}

/// Where the points of a body are on each frame.
struct Moved {
    frames: Vec<Vec<Point>>,
    rigid: bool,
}

impl Body {
    fn moved(&self, limbs: &Limbs, options: &Options) -> Result<Moved, PipelineError> {
        let named = |error: &dyn std::fmt::Display| wrong(format!("part {:?}: {error}", self.name));
        let mut puppet =
            Puppet::new(&self.outline, &self.points, &self.rest, &self.carriers, options).map_err(|e| named(&e))?;
        let frames = limbs.frames.iter().map(|poses| puppet.pose(poses)).collect::<Result<_, _>>();
        Ok(Moved { frames: frames.map_err(|e| named(&e))?, rigid: puppet.is_rigid() })
    }
}

/// The closed parts, each with the strokes and open contours that lie on it.
fn bodies(
    parts: &[Part],
    strokes: &[DrawnStroke],
    set: &LimbSet,
    rest: &[LimbPose],
    frame: FrameNumber,
) -> Result<Vec<Body>, PipelineError> {
    let closed = parts.iter().enumerate().filter(|(_, part)| part.closed);
    let mut bodies: Vec<Body> = closed.filter_map(|(index, part)| body((index, part), set, rest, frame)).collect();
    if bodies.is_empty() {
        return Err(wrong(format!("parts: found no closed contour on frame {frame}, expected at least one")));
    }
    let open = parts.iter().filter(|part| !part.closed).filter_map(|part| part.points_at(frame));
    let lines: Vec<&Vec<Point>> = strokes.iter().map(|stroke| &stroke.points).chain(open).collect();
    for (number, line) in lines.into_iter().enumerate() {
        let owner = owner(&bodies, parts, frame, line);
        bodies[owner].points.extend(line);
        bodies[owner].strokes.push((number, line.len()));
    }
    Ok(bodies)
}

/// A closed part on the frame where it is at rest; none where it has no points there.
fn body((index, part): (usize, &Part), set: &LimbSet, rest: &[LimbPose], frame: FrameNumber) -> Option<Body> {
    let (mut points, outline) = (part.points_at(frame)?.clone(), part.outline(frame)?);
    let (carriers, nearest) = carriers(part, set, rest, &outline);
    let curves = part.complete_curves(frame);
    let count = points.len();
    points.extend(curves.into_iter().flatten().flatten());
    Some(Body {
        part: index,
        name: part.name.clone(),
        rest: rest.to_vec(),
        paths: curves.into_iter().flatten().map(Vec::len).collect(),
        strokes: Vec::new(),
        more: 0,
        outline,
        carriers,
        nearest,
        points,
        count,
    })
}

/// The limbs that carry a part; where none is told to, the nearest one, which is also given.
fn carriers(part: &Part, set: &LimbSet, rest: &[LimbPose], outline: &[Point]) -> (Vec<Carrier>, Option<usize>) {
    let carrier = |limb: usize, turn: f64| {
        let whole = skull(&set.limbs[limb]);
        Carrier { limb, turn, rigidity: set.limbs[limb].rigidity, whole }
    };
    let told = set.limbs.iter().enumerate().filter_map(|(limb, l)| {
        let own = l.carries.iter().find(|carried| carried.part == part.name)?;
        Some(carrier(limb, own.turn))
    });
    let told: Vec<Carrier> = told.collect();
    if !told.is_empty() {
        return (told, None);
    }
    let limb = nearest_limb(rest, outline);
    let foot = LEGS.iter().any(|leg| leg[2] == set.limbs[limb].to);
    (vec![carrier(limb, if foot { FOOT_TURN } else { 1.0 })], Some(limb))
}

/// Whether a limb holds up the head, which keeps its shape.
fn skull(limb: &Limb) -> bool {
    ["head", "head_top"].contains(&NAMES[limb.to])
}

fn nearest_limb(rest: &[LimbPose], outline: &[Point]) -> usize {
    let middle = polygon::center(outline);
    let away = |pose: &LimbPose| pose.spline().nearest(middle).distance;
    (0..rest.len()).min_by(|&a, &b| away(&rest[a]).total_cmp(&away(&rest[b]))).unwrap_or(0)
}

/// The body that a line lies on: the one with most of its points inside, of several the nearest to the viewer; else the
/// one whose outline is nearest.
fn owner(bodies: &[Body], parts: &[Part], frame: FrameNumber, line: &[Point]) -> usize {
    let inside = |body: &Body| line.iter().filter(|p| polygon::contains(&body.outline, **p)).count();
    let depth = |body: &Body| parts[body.part].depth_at(frame);
    let best = (0..bodies.len()).max_by(|&a, &b| {
        let (a, b) = (&bodies[a], &bodies[b]);
        inside(a).cmp(&inside(b)).then(depth(a).total_cmp(&depth(b)))
    });
    let middle = polygon::center(line);
    let away = |k: &usize| polyline::distance(middle, &bodies[*k].outline, true);
    let nearest = || (0..bodies.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
    best.filter(|&k| inside(&bodies[k]) > 0).or_else(nearest).unwrap_or(0)
}

/// Depths by part and frame.
fn depths(
    set: &LimbSet,
    parts: &[Part],
    frames: std::ops::RangeInclusive<FrameNumber>,
) -> Result<Vec<Vec<f64>>, PipelineError> {
    let index = |name: &str| parts.iter().position(|part| part.name == name).unwrap_or(usize::MAX);
    let mark = |m: &crate::scene::limbs::DepthMark| Mark {
        front: index(&m.front),
        behind: index(&m.behind),
        first: m.first,
        last: m.last,
    };
    let marks: Vec<Mark> = set.marks.iter().map(mark).collect();
    let own: Vec<f64> = parts.iter().map(|part| part.depth).collect();
    let named =
        |k: &usize| format!("depth_marks[{k}] ({:?} in front of {:?})", set.marks[*k].front, set.marks[*k].behind);
    let of = |frame| {
        infer(&own, &marks, frame).map_err(|error| match error {
            DepthError::Contradiction { frame, marks } => {
                let list: Vec<String> = marks.iter().map(named).collect();
                wrong(format!("frame {frame}: found marks that contradict each other: {}", list.join(", ")))
            }
            other => wrong(format!("depth_marks: {other}")),
        })
    };
    let by_frame = frames.map(of).collect::<Result<Vec<_>, _>>()?;
    let rounded = |d: f64| (d * DEPTH_SCALE).round() / DEPTH_SCALE;
    Ok((0..parts.len()).map(|k| by_frame.iter().map(|all| rounded(all[k])).collect()).collect())
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
mod tests;
