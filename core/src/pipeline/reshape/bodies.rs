//! The closed parts of a drawing with everything that follows them, and where they are on each frame.

use super::loose::{self, Given};
use super::motion::Motion;
use super::{PipelineError, wrong};
use crate::geometry::{Point, polygon, polyline};
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
    /// What it follows if no limb carries it.
    follows: Option<Given>,
    /// The same, if the document does not say it.
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
    Root,
    Contact,
    Nothing,
}

impl Drive {
    /// The points in a pose of the limbs, with the pelvis at `root`.
    fn pose(&mut self, points: &[Point], limbs: &[LimbPose], shift: Point) -> Result<Vec<Point>, PuppetError> {
        let shift = match self {
            Self::Limbs(puppet) => return puppet.pose(limbs),
            Self::Root => shift,
            Self::Contact => Point::new(shift.x, 0.0),
            Self::Nothing => Point::ZERO,
        };
        Ok(points.iter().map(|p| *p + shift).collect())
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
            Some(Given::Root) => Drive::Root,
            Some(Given::Contact) => Drive::Contact,
            Some(Given::Nothing) => Drive::Nothing,
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

/// The closed parts, each with the strokes and open contours that lie on it.
pub(super) fn of(
    parts: &[Part],
    strokes: &[DrawnStroke],
    set: &LimbSet,
    motion: &Motion,
    frame: FrameNumber,
) -> Result<Vec<Body>, PipelineError> {
    let closed = parts.iter().enumerate().filter(|(_, part)| part.closed);
    let mut bodies: Vec<Body> = closed.filter_map(|(index, part)| body((index, part), set, motion, frame)).collect();
    if bodies.is_empty() {
        return Err(wrong(format!("parts: found no closed contour on frame {frame}, expected at least one")));
    }
    put_loose(&mut bodies, (parts, frame), set, motion)?;
    let open = parts.iter().filter(|part| !part.closed).filter_map(|part| part.points_at(frame));
    let lines: Vec<&Vec<Point>> = strokes.iter().map(|stroke| &stroke.points).chain(open).collect();
    for (number, line) in lines.into_iter().enumerate() {
        let owner = owner(&bodies, parts, frame, line);
        bodies[owner].points.extend(line);
        bodies[owner].strokes.push((number, line.len()));
    }
    Ok(bodies)
}

/// Gives the bodies that no limb carries what they follow.
fn put_loose(
    bodies: &mut [Body],
    (parts, frame): (&[Part], FrameNumber),
    set: &LimbSet,
    motion: &Motion,
) -> Result<(), PipelineError> {
    let carried = bodies.iter().filter(|body| !body.carriers.is_empty()).map(|body| loose::Carried {
        name: &body.name,
        outline: &body.outline,
        depth: parts[body.part].depth_at(frame),
    });
    let carried: Vec<loose::Carried> = carried.collect();
    let what = |body: &Body| match loose::asked(set, &body.name) {
        Some(asked) => (asked, true),
        None => (loose::found(&body.outline, &carried, set, motion), false),
    };
    let loose: Vec<(usize, (Given, bool))> =
        (0..bodies.len()).filter(|&k| bodies[k].carriers.is_empty()).map(|k| (k, what(&bodies[k]))).collect();
    for (k, (what, asked)) in loose {
        if let Given::Part(name) = &what {
            let other = bodies.iter().find(|body| body.name == *name && body.follows.is_none());
            let other = other.filter(|body| !body.carriers.is_empty()).ok_or_else(|| {
                let found = format!("follows.{:?}: found part {name:?}", bodies[k].name);
                wrong(format!("{found}, expected a closed part that a limb carries"))
            })?;
            let (carriers, shoe) = (other.carriers.clone(), other.shoe);
            (bodies[k].carriers, bodies[k].shoe) = (carriers, shoe);
        }
        bodies[k].given = (!asked).then(|| what.clone());
        bodies[k].follows = Some(what);
    }
    Ok(())
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
