//! Draws contours over the viewer, and lets the user drag their control points.
//!
//! A drag on a key frame moves the key's point. A drag on a frame between keys makes a pin, which the next **Track** keeps.
//! The point moves at once on that frame. The document is written when the pen goes up.

use super::parts::selected;
use super::placement::Placement;
use super::settings::Settings;
use super::{instance, stored};
use crate::ofx::Failure;
use crate::ofx::interact::{Event, View};
use rototoon::geometry::Point;
use rototoon::project::{Document, validate};
use rototoon::render::motion::outline_at;
use rototoon::scene::{FrameNumber, palette};
use std::sync::Arc;

/// Largest distance from the pen at which a point is picked, in screen pixels.
const NEAR: f64 = 8.0;
/// Half the side of a control point's square, in screen pixels.
const HANDLE: f64 = 3.0;

/// A control point that is being dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    part: usize,
    point: usize,
    frame: FrameNumber,
    /// Position of the pen in pixels of the footage.
    at: Point,
}

/// The shapes that the viewer shows.
struct Shown {
    document: Arc<Document>,
    parts: Vec<usize>,
    settings: Settings,
    placement: Placement,
}

impl Shown {
    fn of(view: &View) -> Result<Self, Failure> {
        let (instance, parameters) = (instance(&view.effect)?, view.effect.parameters()?);
        // Rendering reports the errors of a document.
        let document = instance.document(&parameters).ok().flatten().ok_or(Failure::Default)?;
        let settings = Settings::read(&parameters, view.time)?;
        let mut parts = selected(&document.scene.parts, &settings.parts).0;
        parts.sort_by(|&a, &b| document.scene.parts[a].depth.total_cmp(&document.scene.parts[b].depth));
        let placement = Placement::of(&view.effect, &document.scene.footage, view.time, [1.0; 2])?;
        Ok(Self { document, parts, settings, placement })
    }

    /// The document's frame at the viewer's time; `None` between frames.
    fn frame(&self) -> Option<FrameNumber> {
        let time = self.settings.document_time;
        (time.fract() == 0.0 && time.abs() < 1e9).then_some(time as FrameNumber)
    }

    /// The control point nearest to the pen. Of several at the same distance, that of the frontmost part.
    fn nearest(&self, view: &View) -> Option<Drag> {
        let (frame, pen) = (self.frame()?, Point::from(view.pen));
        let points = self.parts.iter().rev().flat_map(|&part| {
            let points = self.document.scene.parts[part].points_at(frame).into_iter().flatten();
            points.enumerate().map(move |(point, &at)| Drag { part, point, frame, at })
        });
        let distance = |drag: &Drag| Point::from(self.placement.shown(drag.at)).distance(pen);
        let near = points.filter(|drag| distance(drag) <= NEAR * view.pixel);
        near.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// Handles an event of the viewer.
pub fn perform(view: &View) -> Result<(), Failure> {
    let dragged = instance(&view.effect)?.drag();
    match (view.event, dragged) {
        (Event::Draw, _) => draw(view, dragged),
        (Event::Down, _) => {
            let drag = Shown::of(view)?.nearest(view).ok_or(Failure::Default)?;
            instance(&view.effect)?.set_drag(Some(drag));
            view.redraw();
            Ok(())
        }
        (Event::Move | Event::Up, None) => Err(Failure::Default),
        (Event::Move, Some(drag)) => {
            let at = Shown::of(view)?.placement.footage(view.pen);
            instance(&view.effect)?.set_drag(Some(Drag { at, ..drag }));
            view.redraw();
            Ok(())
        }
        (Event::Up, Some(drag)) => {
            instance(&view.effect)?.set_drag(None);
            let shown = Shown::of(view)?;
            let drag = Drag { at: shown.placement.footage(view.pen), ..drag };
            let done = keep(view, &shown, drag);
            view.redraw();
            done
        }
    }
}

fn draw(view: &View, dragged: Option<Drag>) -> Result<(), Failure> {
    let shown = Shown::of(view)?;
    let frame = shown.frame();
    for &index in &shown.parts {
        let part = &shown.document.scene.parts[index];
        let [r, g, b] = palette::distinct(index);
        let drag = dragged.filter(|drag| drag.part == index && Some(drag.frame) == frame);
        let outline = |points: &[Point]| points.iter().map(|&p| shown.placement.shown(p)).collect::<Vec<_>>();
        // A drag moves control points, so snapped curves are not shown while it lasts.
        let curves = shown.settings.curves && drag.is_none();
        let Some(mut points) = outline_at(part, shown.settings.document_time, curves) else { continue };
        if let Some(drag) = drag
            && let Some(point) = points.get_mut(drag.point)
        {
            *point = drag.at;
        }
        view.line(&outline(&points), part.closed, [r, g, b, 1.0], 1.5);
        let Some(points) = frame.and_then(|frame| part.points_at(frame)) else { continue };
        let key = frame.is_some_and(|frame| part.keys.contains_key(&frame));
        for (number, &point) in points.iter().enumerate() {
            let at = drag.filter(|drag| drag.point == number).map_or(point, |drag| drag.at);
            let [x, y] = shown.placement.shown(at);
            let size = HANDLE * view.pixel;
            let corners = [[x - size, y - size], [x + size, y - size], [x + size, y + size], [x - size, y + size]];
            view.line(&corners, true, if key { [1.0; 4] } else { [r, g, b, 1.0] }, 1.0);
        }
    }
    Ok(())
}

/// Stores a dragged point in the document.
fn keep(view: &View, shown: &Shown, drag: Drag) -> Result<(), Failure> {
    let mut document = Document::clone(&shown.document);
    let part = document.scene.parts.get_mut(drag.part).ok_or(Failure::Default)?;
    let before = part.points_at(drag.frame).and_then(|points| points.get(drag.point)).copied();
    if before.is_none_or(|before| before.distance(drag.at) < 1e-6) {
        return Ok(());
    }
    if let Some(point) = part.keys.get_mut(&drag.frame).and_then(|key| key.get_mut(drag.point)) {
        *point = drag.at;
    } else if validate::acts(part, drag.frame) {
        part.pins.entry(drag.frame).or_default().insert(drag.point, drag.at);
    } else {
        return Err(Failure::Default);
    }
    if let Some(point) = part.tracks.get_mut(&drag.frame).and_then(|track| track.get_mut(drag.point)) {
        *point = drag.at;
    }
    // The snapped curve belongs to the old contour.
    part.curves.remove(&drag.frame);
    let problems = document.problems();
    if problems.error_count() > 0 {
        view.effect.complain(&problems.to_string());
        return Err(Failure::Told(problems.to_string()));
    }
    view.effect.parameters()?.set("Move point", &[(c"document", &stored::encode(&document.to_json()))])
}
