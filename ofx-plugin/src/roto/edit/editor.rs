//! The selection and the pen's unfinished work, and what each event makes of them.
//!
//! With the tool *Select* the pen picks, in this order: a handle of the box around the selection, a control point, a
//! contour, and else it opens a box. A contour that is picked selects its part. A click inside a closed part selects it; a
//! click beside all of them selects nothing. With Shift, points are added to the selection; with Control, a click on a
//! contour inserts a point, and a drag away from a point sets the feather of the selected points to its length.
//!
//! With *Draw contour* each click sets a point. A click on the first point closes the contour, one on the last point ends an
//! open one. Return ends it too, Backspace takes the last point back, Escape drops the contour. With *Draw freehand* the
//! contour is drawn in one stroke. Only with *Select* do Delete and Backspace delete what is selected.
//!
//! A contour that is refused stays unfinished: Return finishes it when what the message asks for is done.

use super::handles::{Handle, Handles, Transform};
use super::{Lens, Place, Refused, Selection, change, feather, hit, naming, points};
use crate::roto::reach::Reach;
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::FrameNumber;
use std::collections::{BTreeMap, BTreeSet};

/// Movement of the pen in screen pixels up to which a press is a click.
const CLICK: f64 = 2.0;

/// What the pen does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// It selects and moves points.
    #[default]
    Select,
    /// It sets the points of a contour.
    Contour,
    /// It draws a contour in one stroke.
    Freehand,
    /// It does nothing.
    Off,
}

/// A key of the keyboard that means something here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Deletes the selected points with the tool *Select*.
    Delete,
    /// Takes the last point back, or deletes as the other one does.
    Back,
    /// Drops the unfinished work, or the selection.
    Escape,
    /// Ends a contour.
    Enter,
    /// Adds to the selection while it is down.
    Shift(bool),
    /// Inserts points while it is down.
    Control(bool),
}

/// What an event works on.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    /// The document.
    pub document: &'a Document,
    /// The document's frame.
    pub frame: FrameNumber,
    /// The parts that can be picked, the farthest first.
    pub parts: &'a [usize],
    /// Distances on the screen.
    pub lens: Lens,
    /// What the pen does.
    pub tool: Tool,
    /// Whether drawn contours are closed.
    pub closed: bool,
    /// Name of the part that is drawn; empty for a new one.
    pub name: &'a str,
    /// The frames of the source.
    pub reach: Reach,
}

impl Work<'_> {
    /// The document for an edit on the frame, which the footage has where the source has it.
    pub fn draft(&self) -> Document {
        let mut document = self.document.clone();
        self.reach.widen(&mut document.scene.footage, self.frame);
        document
    }

    /// Why nothing can be drawn: the part that is named must not be changed, or no new part may have the name.
    fn refusal(&self) -> Option<Refused> {
        match self.document.scene.parts.iter().position(|part| part.name == self.name) {
            Some(part) => (!self.parts.contains(&part)).then(|| Refused::protected(self.name)),
            None => naming::check(self.name, "Part").err(),
        }
    }
}

/// What an event led to.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Nothing: the event is left to the host.
    Ignored,
    /// The overlay looks different.
    Shown,
    /// Points are selected; of one part only if it is named.
    Selected(Option<String>),
    /// An edit, as one undo step.
    Edited(Edit),
    /// An edit that cannot be made.
    Refused(Refused),
}

/// A finished edit.
#[derive(Clone, Debug)]
pub struct Edit {
    /// Name of the undo step.
    pub label: &'static str,
    /// The document after it.
    pub document: Document,
}

/// What the pen holds.
#[derive(Clone, Debug)]
enum Grip {
    /// The selected points.
    Points,
    /// A corner of a box that selects.
    Box,
    /// A handle of the box around the selection.
    Handle(Handle, Handles),
    /// A freehand stroke.
    Stroke,
    /// The border's outer edge, from a control point at this place.
    Feather(Point),
}

/// A drag of the pen.
#[derive(Clone, Debug)]
struct Drag {
    grip: Grip,
    frame: FrameNumber,
    from: Point,
    to: Point,
}

/// A contour that is being drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Sketch {
    /// The document's frame.
    pub frame: FrameNumber,
    /// Its points so far.
    pub points: Vec<Point>,
    /// Where the pen is.
    pub pen: Point,
}

/// The selection and the pen's unfinished work.
#[derive(Clone, Debug, Default)]
pub struct Editor {
    /// The selected points.
    pub selection: Selection,
    /// The names of the parts that the selection counts.
    names: Vec<String>,
    drag: Option<Drag>,
    sketch: Option<Sketch>,
    /// Whether the last press of the pen was handled here, so that its release is too.
    pressed: bool,
    shift: bool,
    control: bool,
}

impl Editor {
    /// The contour that is being drawn on a frame.
    pub fn sketch(&self, frame: FrameNumber) -> Option<&Sketch> {
        self.sketch.as_ref().filter(|sketch| sketch.frame == frame)
    }

    /// The corners of the box that selects.
    pub fn box_corners(&self) -> Option<[Point; 2]> {
        self.drag.as_ref().filter(|drag| matches!(drag.grip, Grip::Box)).map(|drag| [drag.from, drag.to])
    }

    /// The box around the selection on a frame. It is not shown while the pen drags.
    pub fn handles(&self, work: &Work) -> Option<Handles> {
        if self.drag.is_some() || work.tool != Tool::Select {
            return None;
        }
        self.around(work)
    }

    fn around(&self, work: &Work) -> Option<Handles> {
        let scene = &work.document.scene;
        let places = self.selection.on_frame(scene, work.frame);
        let at = |place: Place| scene.parts[place.part].points_at(work.frame).map(|points| points[place.point]);
        Handles::around(places.filter_map(at), &work.lens)
    }

    /// The shape of a part on a frame, with the drag that is going on.
    pub fn shown(&self, work: &Work, part: usize, shape: &[Point]) -> Vec<Point> {
        let mut shape = shape.to_vec();
        if let Some(transform) = self.transform(work) {
            for point in self.selection.of_part(part) {
                if let Some(at) = shape.get_mut(point) {
                    *at = transform.apply(*at);
                }
            }
        }
        shape
    }

    /// Whether a drag is changing a part.
    pub fn drags(&self, work: &Work, part: usize) -> bool {
        self.transform(work).is_some() && !self.selection.of_part(part).is_empty()
    }

    /// What the drag does to the selected points.
    fn transform(&self, work: &Work) -> Option<Transform> {
        let drag = self.drag.as_ref().filter(|drag| drag.frame == work.frame)?;
        match &drag.grip {
            Grip::Points if self.moved(work) => Some(Transform::shift(drag.to - drag.from)),
            Grip::Handle(handle, handles) if self.moved(work) => {
                Some(handles.drag(*handle, drag.from, drag.to, self.shift, &work.lens))
            }
            _ => None,
        }
    }

    /// The feather of a part's points, with the drag that is going on; empty for a sharp border.
    pub fn feather(&self, work: &Work, part: usize) -> Vec<f64> {
        let shown = &work.document.scene.parts[part];
        let own = shown.soft_widths().unwrap_or_default().to_vec();
        match self.feathering(work) {
            Some(width) if shown.closed && work.parts.contains(&part) => {
                feather::changed(&own, shown.point_count(), &self.selection.of_part(part), width)
            }
            _ => own,
        }
    }

    /// The feather that the drag gives the selected points.
    fn feathering(&self, work: &Work) -> Option<f64> {
        let drag = self.drag.as_ref().filter(|drag| drag.frame == work.frame)?;
        match drag.grip {
            Grip::Feather(from) if self.moved(work) => Some(feather::dragged(from, drag.to, &work.lens)),
            _ => None,
        }
    }

    fn moved(&self, work: &Work) -> bool {
        self.drag.as_ref().is_some_and(|drag| work.lens.distance(drag.from, drag.to) > CLICK)
    }

    /// Drops the unfinished work.
    pub fn drop_work(&mut self) {
        (self.drag, self.sketch) = (None, None);
    }

    /// Forgets which keys of the keyboard are down, because the viewer no longer hears of them.
    pub fn release_keys(&mut self) {
        (self.shift, self.control) = (false, false);
    }

    /// The pen goes down.
    pub fn down(&mut self, work: &Work, pen: Point) -> Outcome {
        self.follow(&work.document.scene);
        self.drag = None;
        self.pressed = work.tool != Tool::Off;
        if matches!(work.tool, Tool::Contour | Tool::Freehand)
            && let Some(refused) = work.refusal()
        {
            return Outcome::Refused(refused);
        }
        match work.tool {
            Tool::Off => Outcome::Ignored,
            Tool::Contour => self.set_point(work, pen),
            Tool::Freehand => {
                self.sketch = Some(Sketch { frame: work.frame, points: vec![pen], pen });
                self.hold(work, Grip::Stroke, pen)
            }
            Tool::Select => self.pick(work, pen),
        }
    }

    fn hold(&mut self, work: &Work, grip: Grip, pen: Point) -> Outcome {
        self.drag = Some(Drag { grip, frame: work.frame, from: pen, to: pen });
        Outcome::Shown
    }

    fn pick(&mut self, work: &Work, pen: Point) -> Outcome {
        let (scene, frame) = (&work.document.scene, work.frame);
        let pickable = self.selection.iter().all(|place| work.parts.contains(&place.part));
        if let Some(handles) = self.around(work).filter(|_| pickable)
            && let Some(handle) = handles.hit(&work.lens, pen)
        {
            return self.hold(work, Grip::Handle(handle, handles), pen);
        }
        if let Some(place) = hit::point(scene, frame, work.parts, &work.lens, pen) {
            if self.shift {
                self.selection.toggle(place);
                return self.selected(work);
            }
            if !self.selection.contains(place) {
                self.selection = Selection::of([place]);
            }
            let at = scene.parts[place.part].points_at(frame).map(|points| points[place.point]);
            let grip = at.filter(|_| self.control).map_or(Grip::Points, Grip::Feather);
            return self.hold(work, grip, pen);
        }
        let Some(found) = hit::contour(scene, frame, work.parts, &work.lens, pen) else {
            return self.hold(work, Grip::Box, pen);
        };
        if self.control {
            return self.insert_at(work, found);
        }
        let whole = Selection::part(found.part, scene);
        if self.shift {
            self.selection.add(&whole);
        } else if whole.iter().any(|place| !self.selection.contains(place)) {
            self.selection = whole;
        }
        self.hold(work, Grip::Points, pen)
    }

    fn insert_at(&mut self, work: &Work, place: hit::OnContour) -> Outcome {
        let mut document = work.draft();
        match points::insert(&mut document, place.part, &[(place.segment, place.share)].into()) {
            Ok(new) => {
                self.selection = Selection::of(new.into_iter().map(|point| Place { part: place.part, point }));
                Outcome::Edited(Edit { label: "Insert point", document })
            }
            Err(refused) => Outcome::Refused(refused),
        }
    }

    fn selected(&self, work: &Work) -> Outcome {
        let parts = self.selection.parts();
        let only = if parts.len() == 1 { parts.first() } else { None };
        Outcome::Selected(only.map(|&part| work.document.scene.parts[part].name.clone()))
    }

    /// The pen moves.
    pub fn move_to(&mut self, work: &Work, pen: Point) -> Outcome {
        if let Some(drag) = &mut self.drag {
            drag.to = pen;
            if let (Grip::Stroke, Some(sketch)) = (&drag.grip, &mut self.sketch) {
                sketch.points.push(pen);
                sketch.pen = pen;
            }
            return Outcome::Shown;
        }
        match self.sketch.as_mut().filter(|sketch| sketch.frame == work.frame && work.tool == Tool::Contour) {
            Some(sketch) => {
                sketch.pen = pen;
                Outcome::Shown
            }
            None => Outcome::Ignored,
        }
    }

    /// The pen goes up.
    pub fn up(&mut self, work: &Work, pen: Point) -> Outcome {
        self.follow(&work.document.scene);
        let pressed = std::mem::take(&mut self.pressed);
        let Some(drag) = &mut self.drag else {
            return if pressed { Outcome::Shown } else { Outcome::Ignored };
        };
        drag.to = pen;
        let (frame, corners) = (drag.frame, [drag.from, drag.to]);
        let (moved, transform, feathering) = (self.moved(work), self.transform(work), self.feathering(work));
        let Some(Drag { grip, .. }) = self.drag.take() else { return Outcome::Ignored };
        if frame != work.frame {
            // The viewer shows another frame: the drag was meant for what is no longer seen.
            self.sketch = None;
            return Outcome::Shown;
        }
        match grip {
            Grip::Stroke => match self.sketch.take() {
                Some(stroke) => self.finish(work, stroke),
                None => Outcome::Shown,
            },
            Grip::Box if moved => self.select_box(work, corners),
            Grip::Box => self.select_inside(work, pen),
            Grip::Points | Grip::Feather(_) if !moved => self.selected(work),
            Grip::Feather(_) => feathering.map_or(Outcome::Shown, |width| self.feather_selected(work, width)),
            Grip::Points | Grip::Handle(..) => {
                let label = if matches!(grip, Grip::Points) { "Move points" } else { "Transform points" };
                transform.map_or(Outcome::Shown, |transform| self.apply(work, &transform, label))
            }
        }
    }

    fn apply(&self, work: &Work, transform: &Transform, label: &'static str) -> Outcome {
        let scene = &work.document.scene;
        let mut moved = BTreeMap::new();
        for place in self.selection.on_frame(scene, work.frame).filter(|place| work.parts.contains(&place.part)) {
            let at = scene.parts[place.part].points_at(work.frame).map(|points| points[place.point]);
            moved.extend(at.map(|at| (place, transform.apply(at))));
        }
        let complete = |part: &usize| self.selection.of_part(*part).len() == scene.parts[*part].point_count();
        let whole: BTreeSet<usize> = self.selection.parts().into_iter().filter(complete).collect();
        let whole = if transform.is_shift() { whole } else { BTreeSet::new() };
        let mut document = work.draft();
        match change::move_points(&mut document, work.frame, &moved, &whole) {
            Ok(true) => Outcome::Edited(Edit { label, document }),
            Ok(false) => Outcome::Shown,
            Err(refused) => Outcome::Refused(refused),
        }
    }

    /// A key of the keyboard goes down or up.
    pub fn key(&mut self, work: &Work, key: Key) -> Outcome {
        self.follow(&work.document.scene);
        match key {
            Key::Shift(down) => self.shift = down,
            Key::Control(down) => self.control = down,
            Key::Escape if self.sketch.is_some() || self.drag.is_some() => {
                self.drop_work();
                return Outcome::Shown;
            }
            Key::Escape if !self.selection.is_empty() => {
                self.selection = Selection::default();
                return self.selected(work);
            }
            Key::Enter => {
                // The contour stays, so that it can be finished when the part may be changed again.
                if let Some(refused) = self.sketch(work.frame).and_then(|_| work.refusal()) {
                    return Outcome::Refused(refused);
                }
                if let Some(sketch) = self.sketch.take_if(|sketch| sketch.frame == work.frame) {
                    return self.finish(work, sketch);
                }
            }
            Key::Back if self.sketch.is_some() => {
                let empty = self.sketch.as_mut().is_some_and(|sketch| {
                    sketch.points.pop();
                    sketch.points.is_empty()
                });
                if empty {
                    self.sketch = None;
                }
                return Outcome::Shown;
            }
            // The part that was drawn last is selected. One key too many must not delete it, and in the host it may delete a node.
            Key::Delete | Key::Back if matches!(work.tool, Tool::Contour | Tool::Freehand) => return Outcome::Shown,
            Key::Delete | Key::Back if !self.selection.is_empty() && work.tool == Tool::Select => {
                return self.delete_selected(work);
            }
            Key::Delete | Key::Back | Key::Escape => {}
        }
        // The host may have its own use for a key that changes nothing here.
        Outcome::Ignored
    }
}

mod on_selection;
mod selecting;
mod sketching;
#[cfg(test)]
mod tests;
