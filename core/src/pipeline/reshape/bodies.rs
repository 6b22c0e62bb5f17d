//! The closed parts of a drawing with everything that follows them, and where they are on each frame.

use super::lines::{self, LooseLine};
use super::loose::{self, Given, Host, Scenery};
use super::motion::Motion;
use super::{PipelineError, wrong};
use crate::geometry::{Point, polygon};
use crate::project::drawings::DrawnStroke;
use crate::reshape::examples::Corrections;
use crate::reshape::mean_value::weights;
use crate::reshape::puppet::{Carrier, LimbPose, Options, Puppet, PuppetError};
use crate::scene::limbs::LimbSet;
use crate::scene::{FrameNumber, Part};

/// A closed part with everything that follows it.
pub(super) struct Body {
    pub part: usize,
    pub name: String,
    pub outline: Vec<Point>,
    /// The limbs that carry it; none if it follows something else.
    pub carriers: Vec<Carrier>,
    /// What moves it if no limb does; a part in place of limbs has that part's limbs.
    pub follows: Option<Given>,
    /// What it follows if no limb carries it, if the document does not say it.
    pub given: Option<Given>,
    /// Whether it is a shoe.
    shoe: bool,
    /// Control points, then the points of its snapped paths, those of its strokes, and those asked for.
    pub points: Vec<Point>,
    /// Number of control points.
    pub count: usize,
    /// Numbers of points of its snapped paths.
    pub paths: Vec<usize>,
    /// Strokes by number (those of the drawing first, then the open parts), with their numbers of points.
    pub strokes: Vec<(usize, usize)>,
    /// Number of points asked for.
    pub more: usize,
}

/// Where the points of a body are on each frame.
pub(super) struct Moved {
    pub frames: Vec<Vec<Point>>,
    pub rigid: bool,
}

/// What moves the points of a body.
enum Drive {
    Limbs(Box<Puppet>),
    Given(Given),
}

impl Drive {
    /// The points in a pose of the limbs, with the pelvis at `root`.
    fn pose(&mut self, points: &[Point], limbs: &[LimbPose], shift: Point) -> Result<Vec<Point>, PuppetError> {
        match self {
            Self::Limbs(puppet) => puppet.pose(limbs),
            Self::Given(given) => Ok(points.iter().map(|p| *p + given.shift(shift)).collect()),
        }
    }
}

impl Body {
    /// Its points on every frame.
    pub fn moved(&self, motion: &Motion, parts: &[Part], options: &Options) -> Result<Moved, PipelineError> {
        let named = |error: &dyn std::fmt::Display| wrong(format!("part {:?}: {error}", self.name));
        let mut drive = self.drive(motion, options).map_err(|e| named(&e))?;
        let corrections = self.corrections(&mut drive, motion, &parts[self.part]).map_err(|e| named(&e))?;
        let control = &self.points[..self.count];
        let shares: Vec<Vec<f64>> = match corrections {
            Some(_) => self.points[self.count..].iter().map(|p| weights(control, *p)).collect(),
            None => Vec::new(),
        };
        let frame = |(limbs, root): (&Vec<LimbPose>, &Point)| {
            let mut points = drive.pose(&self.points, limbs, *root - motion.root)?;
            if let Some(corrections) = &corrections {
                let off = corrections.at(limbs);
                let more = shares.iter().map(|share| share.iter().zip(&off).map(|(w, p)| *p * *w).sum::<Point>());
                let all: Vec<Point> = off.iter().copied().chain(more).collect();
                points.iter_mut().zip(all).for_each(|(p, correction)| *p += correction);
            }
            Ok(points)
        };
        let frames: Result<_, PuppetError> = motion.frames.iter().zip(&motion.way).map(frame).collect();
        let rigid = !matches!(&drive, Drive::Limbs(puppet) if !puppet.is_rigid());
        Ok(Moved { frames: frames.map_err(|e| named(&e))?, rigid })
    }

    fn drive(&self, motion: &Motion, options: &Options) -> Result<Drive, PuppetError> {
        Ok(match &self.follows {
            None | Some(Given::Part(_)) => {
                let puppet = Puppet::new(&self.outline, &self.points, &motion.rest, &self.carriers, options)?;
                Drive::Limbs(Box::new(puppet))
            }
            Some(given) => Drive::Given(given.clone()),
        })
    }

    /// What the other frames of the document teach about the part. Shoes on the ground, and what no limb carries, learn from
    /// the drawing's own motion alone: elsewhere their drawn turn would tilt a sole, and their drawn way would not be the
    /// figure's.
    fn corrections(&self, drive: &mut Drive, motion: &Motion, part: &Part) -> Result<Option<Corrections>, PuppetError> {
        let by_limbs = matches!(drive, Drive::Limbs(_));
        if motion.examples.len() < 2 || (!motion.own && (self.shoe || !by_limbs)) {
            return Ok(None);
        }
        let mut examples = Vec::new();
        for (frame, limbs, root) in &motion.examples {
            let Some(drawn) = part.points_at(*frame).filter(|points| points.len() == self.count) else { continue };
            let guess = drive.pose(&self.points, limbs, *root - motion.root)?;
            examples.push((limbs.clone(), drawn.iter().zip(&guess).map(|(a, b)| *a - *b).collect()));
        }
        let own = self.carriers.iter().map(|carrier| carrier.limb).collect();
        Ok(Corrections::new(own, motion.size, &examples))
    }
}

/// The closed parts, each with the strokes and open contours that go with it, and the lines that go with none.
pub(super) fn of(
    parts: &[Part],
    strokes: &[DrawnStroke],
    set: &LimbSet,
    motion: &Motion,
    frame: FrameNumber,
) -> Result<(Vec<Body>, Vec<LooseLine>), PipelineError> {
    let closed = parts.iter().enumerate().filter(|(_, part)| part.closed);
    let mut bodies: Vec<Body> = closed.filter_map(|(index, part)| body((index, part), set, motion, frame)).collect();
    if bodies.is_empty() {
        return Err(wrong(format!("parts: found no closed contour on frame {frame}, expected at least one")));
    }
    let scenery = put_loose(&mut bodies, parts, set, motion)?;
    let loose = lines::put(&mut bodies, (parts, strokes, frame), set, &scenery)?;
    Ok((bodies, loose))
}

/// Gives the bodies that no limb carries what they follow. Returns on what lines may lie.
fn put_loose<'a>(
    bodies: &mut [Body],
    parts: &[Part],
    set: &LimbSet,
    motion: &'a Motion,
) -> Result<Scenery<'a>, PipelineError> {
    let host = |body: &Body| Host {
        name: body.name.clone(),
        outline: body.outline.clone(),
        depth: parts[body.part].depth,
        limb: loose::is_limb(set, &body.name),
        loose: body.follows.is_some(),
        given: body.follows.clone().filter(|given| !matches!(given, Given::Part(_))),
    };
    let (carried, mut waiting): (Vec<usize>, Vec<usize>) =
        (0..bodies.len()).partition(|&k| !bodies[k].carriers.is_empty());
    let whole: Vec<Point> = carried.iter().flat_map(|&k| bodies[k].outline.iter().copied()).collect();
    let hosts = carried.iter().map(|&k| host(&bodies[k])).collect();
    let mut scenery = Scenery { hosts, figure: polygon::bounds(&whole), motion };
    let area = |k: &usize| polygon::signed_area(&bodies[*k].outline).abs();
    waiting.sort_by(|a, b| area(b).total_cmp(&area(a)));
    while !waiting.is_empty() {
        // A part waits for the one of which the document says that it follows it.
        let asked = |k: &usize| loose::asked(set, &bodies[*k].name);
        let waits =
            |k: &usize| matches!(asked(k), Some(Given::Part(of)) if waiting.iter().any(|w| bodies[*w].name == of));
        let next = waiting.iter().position(|k| !waits(k)).unwrap_or(0);
        let k = waiting.remove(next);
        let asked = loose::asked(set, &bodies[k].name);
        let what = asked.clone().unwrap_or_else(|| scenery.of_part(&bodies[k].outline, parts[bodies[k].part].depth));
        follow(bodies, k, &what, &scenery)?;
        bodies[k].given = asked.is_none().then_some(what);
        scenery.hosts.push(host(&bodies[k]));
    }
    Ok(scenery)
}

/// Lets a body move as another one, or as it is given.
fn follow(bodies: &mut [Body], k: usize, what: &Given, scenery: &Scenery) -> Result<(), PipelineError> {
    bodies[k].follows = Some(what.clone());
    if let Given::Part(name) = what {
        let known = scenery.hosts.iter().any(|host| host.name == *name);
        let other = bodies.iter().find(|body| known && body.name == *name);
        let other = other.ok_or_else(|| not_followed(&bodies[k].name, name))?;
        let (carriers, shoe, follows) = (other.carriers.clone(), other.shoe, other.follows.clone());
        bodies[k].follows = follows.or_else(|| Some(what.clone()));
        (bodies[k].carriers, bodies[k].shoe) = (carriers, shoe);
    }
    Ok(())
}

/// The error about a part that another one cannot follow.
pub(super) fn not_followed(part: &str, found: &str) -> PipelineError {
    wrong(format!(
        "follows.{part:?}: found part {found:?}, expected a closed part that does not itself follow {part:?}"
    ))
}

/// A closed part on the frame where it is at rest; none where it has no points there.
fn body((index, part): (usize, &Part), set: &LimbSet, motion: &Motion, frame: FrameNumber) -> Option<Body> {
    let (mut points, outline) = (part.points_at(frame)?.clone(), part.outline(frame)?);
    let (carriers, shoe) = carriers(part, set, motion);
    let curves = part.complete_curves(frame);
    let count = points.len();
    points.extend(curves.into_iter().flatten().flatten());
    Some(Body {
        part: index,
        name: part.name.clone(),
        paths: curves.into_iter().flatten().map(Vec::len).collect(),
        strokes: Vec::new(),
        more: 0,
        outline,
        carriers,
        follows: None,
        given: None,
        shoe,
        points,
        count,
    })
}

/// The limbs that carry a part, and whether it is a shoe. A shoe has the limb of its foot.
fn carriers(part: &Part, set: &LimbSet, motion: &Motion) -> (Vec<Carrier>, bool) {
    let foot = motion.feet.iter().find(|foot| foot.foot.turn.is_some() && foot.parts.contains(&part.name));
    if let Some(foot) = foot {
        let rigidity = set.limbs[foot.shin].rigidity;
        return (vec![Carrier { limb: foot.limb, turn: 1.0, rigidity, whole: true }], true);
    }
    let told = set.limbs.iter().enumerate().filter_map(|(limb, l)| {
        let own = l.carries.iter().find(|carried| carried.part == part.name)?;
        Some(Carrier { limb, turn: own.turn, rigidity: l.rigidity, whole: set.template.on_head(l.to) })
    });
    (told.collect(), false)
}
