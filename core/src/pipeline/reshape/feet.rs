//! The feet of a drawing, each with a limb of its own, and the ground on which they stand.
//!
//! A shoe gets a limb from the ankle in the direction of the picture's x, which turns with the foot's pitch. A leg without a shoe
//! stands on its end.

use super::motion::ByFrame;
use crate::geometry::Point;
use crate::reshape::facing;
use crate::reshape::foot::{Foot, turned};
use crate::reshape::limb::Bend;
use crate::reshape::puppet::LimbPose;
use crate::scene::limbs::LimbSet;
use crate::scene::{FrameNumber, Part, Template};

/// A part hangs on the end of a limb if its centre is nearest to a point of the limb beyond this share of it.
const END: f64 = 0.75;
/// A point belongs to the end of a leg if it is within this share of the shin of the ankle.
const LEG_END: f64 = 0.35;
/// Share of the frames that show the drawing on which its lowest foot is no lower than its ground.
const GROUND: f64 = 0.75;
/// Length of a foot's limb, as a share of the torso. It has no influence on the result.
const FOOT: f64 = 0.25;

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

impl FootLimb {
    /// The control points of its parts on a frame; `None` if one is not there.
    fn points(&self, parts: &[Part], frame: FrameNumber) -> Option<Vec<Point>> {
        let of = |name: &String| parts.iter().find(|part| part.name == *name)?.points_at(frame);
        Some(self.parts.iter().map(of).collect::<Option<Vec<_>>>()?.into_iter().flatten().copied().collect())
    }
}

/// The feet, and what their limbs are made of.
pub(super) struct Feet<'a> {
    pub feet: Vec<FootLimb>,
    pub legs: Vec<&'a [usize]>,
    /// Length of the torso in pixels.
    pub size: f64,
}

impl Feet<'_> {
    pub fn plain(&self) -> Vec<Foot> {
        self.feet.iter().map(|f| f.foot.clone()).collect()
    }

    /// The turns of all feet on a frame that shows the drawing, in radians from rest: of a shoe as measured, of the end of a leg as
    /// its bone. `None` if a shoe is not there or has other points.
    pub fn drawn(
        &self,
        parts: &[Part],
        (rest, frame): (FrameNumber, FrameNumber),
        posture: &[Point],
    ) -> Option<Vec<f64>> {
        let turn = |limb: &FootLimb| match limb.foot.turn {
            None => Some(limb.foot.swing(self.legs[limb.foot.leg], posture)),
            Some(_) => turned(&limb.points(parts, rest)?, &limb.points(parts, frame)?),
        };
        self.feet.iter().map(turn).collect()
    }

    /// The limbs of a posture and those of the feet, each turned by the radians of `turn`.
    pub fn added(&self, mut limbs: Vec<LimbPose>, posture: &[Point], turn: impl Fn(usize) -> f64) -> Vec<LimbPose> {
        limbs.extend(self.feet.iter().enumerate().map(|(k, foot)| {
            let ankle = posture[end_of(self.legs[foot.foot.leg])];
            let toe = ankle + Point::from_angle(turn(k)) * (FOOT * self.size);
            LimbPose { ends: (ankle, toe), bend: Bend::STRAIGHT }
        }));
        limbs
    }
}

/// The last key point of a chain.
fn end_of(chain: &[usize]) -> usize {
    chain[chain.len() - 1]
}

/// The feet of the drawing.
pub(super) fn feet(
    set: &LimbSet,
    parts: &[Part],
    rest: FrameNumber,
    limbs: &[LimbPose],
    posture: &[Point],
) -> Vec<FootLimb> {
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
        let foot = match turn {
            Some(turn) => Foot::shoe(leg, shape, upright(template, to, posture), turn),
            None => Foot::end(leg, shape, posture[to] - posture[template.parent(to)]),
        };
        found.push(FootLimb { limb: limbs.len() + found.len(), shin, parts, foot });
    }
    found
}

/// The typical direction of the bone that ends in a key point, for a body that looks as a posture does.
fn upright(template: &Template, point: usize, posture: &[Point]) -> Point {
    let typical = template.typical();
    let bone = typical[point] - typical[template.parent(point)];
    // Without joints and shoes only a body that lies has a side; of a standing one the typical shin is upright.
    let side = facing::of_drawing(template, &[posture.to_vec()], |_| false, &[]);
    let other = side.is_some_and(|side| side != facing::typical(template));
    if other { Point::new(-bone.x, bone.y) } else { bone }
}

/// The y of the ground: of the lowest foot, on most of the frames that show the drawing; none without feet.
pub(super) fn ground(parts: &[Part], feet: &[FootLimb], shown: &ByFrame) -> Option<f64> {
    let bottom = |frame: FrameNumber| {
        let names = feet.iter().flat_map(|foot| &foot.parts);
        let outlines = names.filter_map(|name| parts.iter().find(|p| p.name == *name)?.outline(frame));
        outlines.flatten().map(|p| p.y).reduce(f64::max)
    };
    let mut low: Vec<f64> = shown.iter().filter_map(|(frame, _)| bottom(*frame)).collect();
    low.sort_by(f64::total_cmp);
    low.get((low.len().saturating_sub(1) as f64 * GROUND) as usize).copied()
}
