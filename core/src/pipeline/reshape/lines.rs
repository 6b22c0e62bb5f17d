//! The strokes and open contours of a drawing: with the part on which they lie, or on their own. The snapped paths of an open
//! contour go where it goes.
//!
//! A line on a part is held by that part's mesh. A line that lies on none has what the document says, or what
//! [`super::loose`] finds: it goes with the pelvis or along the ground, or it stays where it is drawn.

use super::PipelineError;
use super::bodies::{Body, not_followed};
use super::loose::{self, Given, Scenery};
use super::motion::Motion;
use crate::geometry::Point;
use crate::project::drawings::DrawnStroke;
use crate::scene::limbs::LimbSet;
use crate::scene::{FrameNumber, Part};

/// A line that goes with no part.
pub(super) struct LooseLine {
    /// Its number: strokes of the drawing first, then the open contours.
    pub number: usize,
    /// The name of an open contour; a stroke has none.
    pub name: Option<String>,
    /// Its points, and after those of an open contour the points of its snapped paths.
    points: Vec<Point>,
    /// What moves it.
    moves: Given,
    /// The same, if the document does not say it.
    pub given: Option<Given>,
}

impl LooseLine {
    /// Its points on every frame.
    pub fn moved(&self, motion: &Motion) -> Vec<Vec<Point>> {
        let shift = |root: &Point| self.moves.shift(*root - motion.root);
        motion.way.iter().map(|root| self.points.iter().map(|p| *p + shift(root)).collect()).collect()
    }
}

/// Gives lines to the bodies with which they go. Returns those that go with none.
pub(super) fn put(
    bodies: &mut [Body],
    (parts, strokes, frame): (&[Part], &[DrawnStroke], FrameNumber),
    set: &LimbSet,
    scenery: &Scenery,
) -> Result<Vec<LooseLine>, PipelineError> {
    let strokes = strokes.iter().map(|stroke| (None, &stroke.points, stroke.closed, None));
    let open = parts.iter().filter(|part| !part.closed);
    let open =
        open.filter_map(|part| Some((Some(&part.name), part.points_at(frame)?, false, part.complete_curves(frame))));
    let mut loose = Vec::new();
    for (number, (name, points, closed, paths)) in strokes.chain(open).enumerate() {
        let asked = name.and_then(|name| loose::asked(set, name));
        let what = asked.clone().unwrap_or_else(|| scenery.of_line(points, closed));
        let points: Vec<Point> = points.iter().chain(paths.into_iter().flatten().flatten()).copied().collect();
        if let Given::Part(of) = &what {
            let body = bodies.iter_mut().find(|body| body.name == *of);
            let body = body.ok_or_else(|| not_followed(name.map_or("", String::as_str), of))?;
            body.strokes.push((number, points.len()));
            body.points.extend(points);
        } else {
            let given = asked.is_none().then(|| what.clone());
            loose.push(LooseLine { number, name: name.cloned(), points, moves: what, given });
        }
    }
    Ok(loose)
}
