//! The clip on the drawing: limbs and feet on every frame.
//!
//! The clip is brought to the drawing's proportions and place ([`crate::reshape::fit`]). Unless it is a motion of the
//! drawing itself, its feet are put on the drawing's ground ([`crate::reshape::stand`]). The ground is found in the
//! drawing: the lowest point of its feet, on most of the frames that show it.
//!
//! A shoe gets a limb of its own, from the ankle in the direction of the picture's x, which turns with the foot's pitch.
//! A leg without a shoe stands on its end.

use super::{PipelineError, wrong};
use crate::geometry::Point;
use crate::reshape::capture::{Bindings, capture};
use crate::reshape::fit::{Shown, facing, fit};
use crate::reshape::limb::{Bend, bend_at};
use crate::reshape::puppet::LimbPose;
use crate::reshape::retarget::retarget;
use crate::reshape::stand::{Foot, stand};
use crate::scene::limbs::LimbSet;
use crate::scene::{Clip, FrameNumber, Part, Template};
use std::collections::BTreeSet;

/// A part hangs on the end of a limb if its centre is nearest to a point of the limb beyond this share of it.
const END: f64 = 0.75;
/// A point belongs to the end of a leg if it is within this share of the shin of the ankle.
const LEG_END: f64 = 0.35;
/// Share of the frames that show the drawing on which its lowest foot is no lower than its ground.
const GROUND: f64 = 0.75;
/// Length of a foot's limb, as a share of the torso. It has no influence on the result.
const FOOT: f64 = 0.25;

/// Postures by frame.
type ByFrame = Vec<(FrameNumber, Vec<Point>)>;

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
    /// Chains of the drawing's skeleton that no chain of the clip moves.
    pub still: Vec<String>,
}

/// A foot and its limb.
pub(super) struct FootLimb {
    /// Index of its limb.
    pub limb: usize,
    /// Index of the shin.
    pub shin: usize,
    /// The parts that are its shoe; without one those of the leg's end.
    pub parts: Vec<String>,
    /// What stands on the ground.
    pub foot: Foot,
}

/// Fits a clip to the drawing of a document. `first` is the frame of the clip's first posture in the result.
pub(super) fn of(
    set: &LimbSet,
    bindings: &Bindings,
    parts: &[Part],
    rest: FrameNumber,
    (clip, first): (&Clip, FrameNumber),
    chains: &[(String, String)],
) -> Result<Motion, PipelineError> {
    check(clip)?;
    let template = set.template.as_ref();
    let (known, shown) = shown(set, bindings, parts, rest)?;
    let posture = known.rest.clone();
    let (moves, still) = moves(set, &known, clip, chains)?;
    let fitted =
        fit(&known, &moves).ok_or_else(|| wrong("clip: found a torso of length 0, expected a positive length"))?;
    let poses = Poses::new(set, bindings, rest)?;
    let limbs = poses.at_rest();
    let size = template.torso_length(&posture);
    let feet = Feet { legs: template.legs(), size, feet: feet(set, parts, rest, &limbs, &posture) };
    let ground = ground(parts, &feet.feet, &shown).unwrap_or(posture[0].y);
    let mut postures = fitted.postures;
    let turns = match fitted.own {
        true => feet.swings(&postures),
        false => stand(template, &mut postures, (&moves, fitted.size), &feet.plain(), ground),
    };
    computable(&postures)?;
    let frame_limbs = |(t, posture): (usize, &Vec<Point>)| {
        feet.added(poses.of(posture, first + t as FrameNumber), posture, |k| turns[k][t])
    };
    let example = |(frame, posture): &(FrameNumber, Vec<Point>)| {
        Some((*frame, feet.added(poses.drawn(*frame)?, posture, |k| feet.swing(k, posture)), posture[0]))
    };
    Ok(Motion {
        rest: feet.added(limbs, &posture, |_| 0.0),
        root: posture[0],
        frames: postures.iter().enumerate().map(frame_limbs).collect(),
        way: postures.iter().map(|p| p[0]).collect(),
        examples: shown.iter().filter(|(f, _)| !set.swapped(*f)).filter_map(example).collect(),
        size,
        ground,
        own: fitted.own,
        feet: feet.feet,
        still,
    })
}

/// The feet, and what their limbs are made of.
struct Feet<'a> {
    feet: Vec<FootLimb>,
    legs: Vec<&'a [usize]>,
    /// Length of the torso in pixels.
    size: f64,
}

impl Feet<'_> {
    fn plain(&self) -> Vec<Foot> {
        self.feet.iter().map(|f| f.foot.clone()).collect()
    }

    /// The turn of a foot in the air, in radians from rest.
    fn swing(&self, k: usize, posture: &[Point]) -> f64 {
        let foot = &self.feet[k].foot;
        foot.swing(self.legs[foot.leg], posture)
    }

    /// The turns of all feet on every frame.
    fn swings(&self, postures: &[Vec<Point>]) -> Vec<Vec<f64>> {
        (0..self.feet.len()).map(|k| postures.iter().map(|p| self.swing(k, p)).collect()).collect()
    }

    /// The limbs of a posture and those of the feet, each turned by the radians of `turn`.
    fn added(&self, mut limbs: Vec<LimbPose>, posture: &[Point], turn: impl Fn(usize) -> f64) -> Vec<LimbPose> {
        limbs.extend(self.feet.iter().enumerate().map(|(k, foot)| {
            let ankle = posture[end_of(self.legs[foot.foot.leg])];
            let toe = ankle + Point::from_angle(turn(k)) * (FOOT * self.size);
            LimbPose { ends: (ankle, toe), bend: Bend::STRAIGHT }
        }));
        limbs
    }
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

/// The clip's postures as those of the drawing's body: retargeted if the clip is of another body, and mirrored if it looks
/// to the other side; and the chains that nothing moves.
fn moves(
    set: &LimbSet,
    known: &Shown,
    clip: &Clip,
    chains: &[(String, String)],
) -> Result<(Vec<Vec<Point>>, Vec<String>), PipelineError> {
    let (postures, still) = if clip.template.same_points(&set.template) && chains.is_empty() {
        (clip.postures.clone(), Vec::new())
    } else {
        let made = retarget(clip, &set.template, chains).map_err(wrong)?;
        (made.clip.postures, made.still)
    };
    Ok((facing(known, &postures).unwrap_or(postures), still))
}

/// The last key point of a chain.
fn end_of(chain: &[usize]) -> usize {
    chain[chain.len() - 1]
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

/// The feet of the drawing.
fn feet(set: &LimbSet, parts: &[Part], rest: FrameNumber, limbs: &[LimbPose], posture: &[Point]) -> Vec<FootLimb> {
    let (template, swapped): (&Template, bool) = (&set.template, set.swapped(rest));
    let legs = template.legs();
    let mut found: Vec<FootLimb> = Vec::new();
    for (shin, limb) in set.limbs.iter().enumerate() {
        let to = if swapped { template.mirror(limb.to) } else { limb.to };
        let Some(leg) = legs.iter().position(|leg| end_of(leg) == to) else { continue };
        let ankle = limbs[shin].ends.1;
        let mut shoes: Vec<(String, f64, Vec<Point>)> = Vec::new();
        let mut end = vec![ankle];
        for carried in &limb.carries {
            let outline = parts.iter().find(|p| p.name == carried.part && p.closed).and_then(|p| p.outline(rest));
            let Some(outline) = outline else { continue };
            let others = set.limbs.iter().enumerate().filter(|(k, _)| *k != shin);
            let shared = others.flat_map(|(_, l)| &l.carries).any(|other| other.part == carried.part);
            let middle = crate::geometry::polygon::center(&outline);
            if !shared && limbs[shin].spline().nearest(middle).parameter > END {
                shoes.push((carried.part.clone(), carried.turn, outline));
            } else {
                let reach = LEG_END * limbs[shin].ends.0.distance(ankle);
                end.extend(outline.into_iter().filter(|p| p.distance(ankle) <= reach));
            }
        }
        let turn = shoes.first().map(|(_, turn, _)| *turn);
        let (parts, outline) = match shoes.is_empty() {
            true => (limb.carries.iter().map(|c| c.part.clone()).collect(), end),
            false => (shoes.iter().map(|s| s.0.clone()).collect(), shoes.iter().flat_map(|s| s.2.clone()).collect()),
        };
        let shape = outline.into_iter().map(|p| p - ankle).collect();
        let foot = Foot { leg, shape, shin: posture[to] - posture[template.parent(to)], turn };
        found.push(FootLimb { limb: limbs.len() + found.len(), shin, parts, foot });
    }
    found
}

/// The y of the ground: of the lowest foot, on most of the frames that show the drawing; none without feet.
fn ground(parts: &[Part], feet: &[FootLimb], shown: &[(FrameNumber, Vec<Point>)]) -> Option<f64> {
    let bottom = |frame: FrameNumber| {
        let names = feet.iter().flat_map(|foot| &foot.parts);
        let outlines = names.filter_map(|name| parts.iter().find(|p| p.name == *name)?.outline(frame));
        outlines.flatten().map(|p| p.y).reduce(f64::max)
    };
    let mut low: Vec<f64> = shown.iter().filter_map(|(frame, _)| bottom(*frame)).collect();
    low.sort_by(f64::total_cmp);
    low.get((low.len().saturating_sub(1) as f64 * GROUND) as usize).copied()
}
