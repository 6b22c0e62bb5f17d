//! The clip on the drawing: limbs and feet on every frame.
//!
//! The clip is brought to the drawing's proportions and place ([`crate::reshape::fit`]). Unless it is a motion of the
//! drawing itself, its feet are put on the drawing's ground ([`crate::reshape::stand`]). The ground is found in the
//! drawing: the lowest point of its feet, on most of the frames that show it.
//!
//! A clip on twos gives a drawing on twos ([`Holds`]): the frames of a hold get the same limbs, bends and feet.
//!
//! In a motion of the drawing itself the feet are as drawn on the frames that the document shows, and on the ground on
//! the others.

use super::feet::{Feet, FootLimb, feet, ground};
use super::moves::{Moves, moves};
use super::{PipelineError, ReshapeJob, Sides, wrong};
use crate::geometry::Point;
use crate::reshape::capture::{Bindings, capture};
use crate::reshape::contacts::Contacts;
use crate::reshape::fit::{Shown, fit};
use crate::reshape::foot::Foot;
use crate::reshape::limb::{Bend, bend_at};
use crate::reshape::puppet::LimbPose;
use crate::reshape::stand::{stand, stand_own};
use crate::reshape::still::keep_still;
use crate::scene::holds::Holds;
use crate::scene::limbs::LimbSet;
use crate::scene::{Clip, FrameNumber, Part, Template};
use std::collections::BTreeSet;

/// Two postures are one if their key points are this near, as a root mean square in torso lengths, whatever the shift.
const ONE_POSTURE: f64 = 0.01;

/// Postures by frame.
pub(super) type ByFrame = Vec<(FrameNumber, Vec<Point>)>;

/// All limbs at rest, on every frame of the clip, and on the frames that show the drawing. After the document's limbs
/// come those of the feet.
pub(super) struct Motion {
    /// The limbs at rest.
    pub rest: Vec<LimbPose>,
    /// The pelvis at rest.
    pub root: Point,
    /// The limbs on every frame of the clip.
    pub frames: Vec<Vec<LimbPose>>,
    /// The pelvis on every frame of the clip.
    pub way: Vec<Point>,
    /// Frames of the document that show all limbs: frame, limbs, pelvis.
    pub examples: Vec<(FrameNumber, Vec<LimbPose>, Point)>,
    /// Length of the torso in pixels.
    pub size: f64,
    /// The y of the ground.
    pub ground: f64,
    /// Whether the clip is a motion of the drawing itself.
    pub own: bool,
    /// The feet.
    pub feet: Vec<FootLimb>,
    /// Whether every foot of the clip's figure stands on some frame.
    pub all_stand: bool,
    /// Chains of the drawing's skeleton that no chain of the clip moves.
    pub still: Vec<String>,
    /// Whether the clip was mirrored.
    pub mirrored: bool,
    /// To which sides drawing and clip look, if that decided it.
    pub sides: Option<Sides>,
}

/// Fits a job's clip to the drawing of a document. `first` is the frame of the clip's first posture in the result.
pub(super) fn of(
    set: &LimbSet,
    bindings: &Bindings,
    parts: &[Part],
    rest: FrameNumber,
    (job, first): (&ReshapeJob, FrameNumber),
) -> Result<Motion, PipelineError> {
    check(job.clip)?;
    let template = set.template.as_ref();
    let (known, shown) = shown(set, bindings, parts, rest)?;
    let poses = Poses::new(set, bindings, rest)?;
    let limbs = poses.at_rest();
    let size = template.torso_length(&known.rest);
    let feet = Feet { legs: template.legs(), size, feet: feet(set, parts, rest, &limbs, &known.rest) };
    let moves = moves(&known, &feet.plain(), job)?;
    let fitted = fit(&known, &moves.postures)
        .ok_or_else(|| wrong("clip: found a torso of length 0, expected a positive length"))?;
    let examples: Vec<Example> = shown
        .iter()
        .filter(|(f, _)| !set.swapped(*f))
        .filter_map(|shown| example(shown, &feet, parts, &poses))
        .collect();
    let floor = ground(parts, &feet.feet, &shown).unwrap_or(known.rest[0].y);
    let (mut postures, own) = (fitted.postures, fitted.own);
    let mut begins = begins(template, if own { &postures } else { &moves.postures });
    let (turns, ground) = if own {
        let drawn = drawn_frames(&known, &examples, &postures);
        let (turns, found) = own_on_ground(template, &mut postures, &feet.plain(), &drawn, &mut begins);
        (turns, found.unwrap_or(floor))
    } else {
        on_ground(&known, &moves, &mut postures, (fitted.size, &feet.plain(), floor))
    };
    computable(&postures)?;
    let frame_limbs = |(t, posture): (usize, &Vec<Point>)| {
        feet.added(poses.of(posture, first + begins[t] as FrameNumber), posture, |k| turns[k][t])
    };
    let (root, frames) = (known.rest[0], postures.iter().enumerate().map(frame_limbs).collect());
    Ok(Motion {
        rest: feet.added(limbs, &known.rest, |_| 0.0),
        root,
        frames,
        way: postures.iter().map(|p| p[0]).collect(),
        examples: examples.into_iter().map(|e| (e.frame, e.limbs, e.posture[0])).collect(),
        size,
        ground,
        own,
        feet: feet.feet,
        all_stand: Contacts::of_clip(&job.clip.template, &job.clip.postures).all_stand(),
        still: moves.still,
        mirrored: moves.mirrored,
        sides: moves.sides,
    })
}

/// For each frame of a clip the first frame of its drawing.
fn begins(template: &Template, clip: &[Vec<Point>]) -> Vec<usize> {
    let holds = Holds::of(template, clip);
    (0..clip.len()).map(|t| holds.as_ref().map_or(t, |holds| holds.begin(t))).collect()
}

/// Puts the feet of the drawing's own motion on its ground. Where the document itself shows what is drawn on a frame of a hold, that
/// is no repeat. Returns the feet's turns by frame, and the ground where it is known.
fn own_on_ground(
    template: &Template,
    postures: &mut [Vec<Point>],
    feet: &[Foot],
    drawn: &[Option<(FrameNumber, Vec<f64>)>],
    begins: &mut [usize],
) -> (Vec<Vec<f64>>, Option<f64>) {
    let before = postures.to_vec();
    let turned: Vec<_> = drawn.iter().map(|shown| shown.as_ref().map(|(_, turns)| turns.clone())).collect();
    let (mut turns, ground) = stand_own(template, postures, feet, &turned);
    for (t, begin) in begins.iter_mut().enumerate() {
        let shown = |t: usize| drawn[t].as_ref().map(|(frame, _)| *frame);
        if let Some(drawn) = turned[t].as_ref().filter(|_| shown(t) != shown(*begin)) {
            postures[t].clone_from(&before[t]);
            turns.iter_mut().zip(drawn).for_each(|(turns, drawn)| turns[t] = *drawn);
            *begin = t;
        }
    }
    (turns, ground)
}

/// Puts the feet of another figure's motion on the drawing's ground. `size`: the clip's unit in pixels. Returns the feet's turns
/// by frame, and the ground.
fn on_ground(
    known: &Shown,
    moves: &Moves,
    postures: &mut [Vec<Point>],
    (size, feet, ground): (f64, &[Foot], f64),
) -> (Vec<Vec<f64>>, f64) {
    if moves.moved.contains(&false) {
        keep_still(known, &moves.moved, postures);
    }
    (stand(&known.template, postures, (&moves.postures, size), feet, ground), ground)
}

/// A frame of the document that shows the drawing.
struct Example {
    frame: FrameNumber,
    /// Its limbs, after the document's own those of the feet.
    limbs: Vec<LimbPose>,
    posture: Vec<Point>,
    /// The turns of the feet.
    turns: Option<Vec<f64>>,
}

/// What a frame of the document shows. A shoe whose turn cannot be measured there has that of the air.
fn example(
    (frame, posture): &(FrameNumber, Vec<Point>),
    feet: &Feet,
    parts: &[Part],
    poses: &Poses,
) -> Option<Example> {
    let turns = feet.drawn(parts, (poses.rest, *frame), posture);
    let swing = |k: usize| {
        let foot = &feet.feet[k].foot;
        foot.swing(feet.legs[foot.leg], posture)
    };
    let limbs =
        feet.added(poses.drawn(*frame)?, posture, |k| turns.as_ref().map_or_else(|| swing(k), |turns| turns[k]));
    Some(Example { frame: *frame, limbs, posture: posture.clone(), turns })
}

/// For each posture of the drawing's own motion the frame of the document that shows it, if any does, and the turns of its feet.
fn drawn_frames(known: &Shown, examples: &[Example], postures: &[Vec<Point>]) -> Vec<Option<(FrameNumber, Vec<f64>)>> {
    let told: Vec<usize> = (0..known.told.len()).filter(|&k| known.told[k]).collect();
    let apart = |a: &[Point], b: &[Point]| {
        let shift = told.iter().map(|&k| b[k] - a[k]).sum::<Point>() / told.len().max(1) as f64;
        let square: f64 = told.iter().map(|&k| (a[k] + shift).distance_squared(b[k])).sum();
        (square / told.len().max(1) as f64).sqrt() / known.template.torso_length(b).max(f64::MIN_POSITIVE)
    };
    let of = |posture: &Vec<Point>| {
        let off = examples.iter().map(|example| (apart(posture, &example.posture), example));
        let (off, nearest) = off.min_by(|a, b| a.0.total_cmp(&b.0))?;
        nearest.turns.clone().filter(|_| off <= ONE_POSTURE).map(|turns| (nearest.frame, turns))
    };
    postures.iter().map(of).collect()
}

/// Refuses postures that are too far away to compute with.
fn computable(postures: &[Vec<Point>]) -> Result<(), PipelineError> {
    match postures.iter().position(|p| p.iter().any(|q| !q.is_finite())) {
        None => Ok(()),
        Some(frame) => Err(wrong(format!(
            "clip, frame {frame}: found coordinates too large to compute with, expected smaller ones"
        ))),
    }
}

fn check(clip: &Clip) -> Result<(), PipelineError> {
    let Some(frame) = clip.postures.iter().position(|p| p.iter().any(|q| !q.is_finite())) else { return Ok(()) };
    let (character, motion) = (&clip.character, &clip.motion);
    Err(wrong(format!(
        "clip ({character:?}, {motion:?}), frame {frame}: found a coordinate that is not finite, expected finite coordinates"
    )))
}

/// What the document shows of the drawing, and its postures by frame.
fn shown(
    set: &LimbSet,
    bindings: &Bindings,
    parts: &[Part],
    rest: FrameNumber,
) -> Result<(Shown, ByFrame), PipelineError> {
    let drawn = capture(set, parts, rest..=rest).map_err(wrong)?;
    let of_frame = |frame: FrameNumber| Some((frame, capture(set, parts, frame..=frame).ok()?.postures.swap_remove(0)));
    let frames = frames_shown(set, bindings, parts, rest);
    let by_frame: ByFrame = frames.into_iter().filter_map(of_frame).collect();
    let told = drawn.guessed.iter().map(|frames| *frames == 0).collect();
    let postures = by_frame.iter().map(|(_, p)| p.clone()).collect();
    let rest = drawn.postures[0].clone();
    Ok((Shown { template: set.template.clone(), rest, postures, told }, by_frame))
}

/// The frames on which the contours determine all limbs, the one at rest among them.
fn frames_shown(set: &LimbSet, bindings: &Bindings, parts: &[Part], rest: FrameNumber) -> Vec<FrameNumber> {
    let all: BTreeSet<FrameNumber> =
        parts.iter().flat_map(|part| part.keys.keys().chain(part.tracks.keys())).copied().collect();
    let whole =
        |frame: &FrameNumber| (0..set.limbs.len()).all(|k| bindings.limb(k, *frame).iter().all(Option::is_some));
    let shown = |frame: &FrameNumber| *frame == rest || whole(frame);
    all.into_iter().filter(shown).collect()
}

/// The poses of the document's limbs.
struct Poses<'a> {
    set: &'a LimbSet,
    bindings: &'a Bindings<'a>,
    rest: FrameNumber,
    ends: Vec<(Point, Point)>,
    bends: Vec<Vec<(FrameNumber, Bend)>>,
}

impl<'a> Poses<'a> {
    fn new(set: &'a LimbSet, bindings: &'a Bindings<'a>, rest: FrameNumber) -> Result<Self, PipelineError> {
        let drawn = bindings.drawn(rest);
        let mut poses = Self { set, bindings, rest, ends: Vec::new(), bends: Vec::new() };
        for (k, limb) in set.limbs.iter().enumerate() {
            let [from, to] = [limb.from, limb.to].map(|k| set.template.point_name(k));
            let named = |what: &str| wrong(format!("limbs[{k}] ({from} to {to}), {what}"));
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
            poses.ends.push(ends);
            poses.bends.push(bends);
        }
        Ok(poses)
    }

    fn at_rest(&self) -> Vec<LimbPose> {
        let one = |(ends, bends): (&(Point, Point), &Vec<_>)| LimbPose { ends: *ends, bend: bend_at(bends, self.rest) };
        self.ends.iter().zip(&self.bends).map(one).collect()
    }

    /// The limbs in a posture. Bends drawn on a few frames are those of the drawing; the motion goes from one to the next.
    fn of(&self, posture: &[Point], frame: FrameNumber) -> Vec<LimbPose> {
        // A drawing that shows the other side hangs on the other side's key points.
        let side = |point: usize| if self.set.swapped(self.rest) { self.set.template.mirror(point) } else { point };
        let one = |(limb, bends): (&crate::scene::limbs::Limb, &Vec<_>)| LimbPose {
            ends: (posture[side(limb.from)], posture[side(limb.to)]),
            bend: bend_at(bends, frame),
        };
        self.set.limbs.iter().zip(&self.bends).map(one).collect()
    }

    /// The limbs as a frame of the document shows them.
    fn drawn(&self, frame: FrameNumber) -> Option<Vec<LimbPose>> {
        let points = self.bindings.drawn(frame);
        let one = |(limb, bends): (&crate::scene::limbs::Limb, &Vec<_>)| {
            Some(LimbPose { ends: points[limb.from].zip(points[limb.to])?, bend: bend_at(bends, frame) })
        };
        self.set.limbs.iter().zip(&self.bends).map(one).collect()
    }
}
