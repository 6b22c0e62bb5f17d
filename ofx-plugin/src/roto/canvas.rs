//! Draws the overlay: contours in their parts' colours, control points, the selection with its box, and the contour that is
//! being drawn.
//!
//! - A contour whose track is older than its keys and corrections is dashed.
//! - A part without a shape on the frame shows its nearest key, thin and pale.
//! - Squares are control points: white on a key frame, in the part's colour on a tracked one, filled if selected. A pin has a
//!   cross, a corrected centre a larger cross.

use super::edit::{Editor, Place, Work};
use super::overlay::Shown;
use crate::ofx::interact::View;
use rototoon::geometry::Point;
use rototoon::render::motion::outline_at;
use rototoon::scene::{FrameNumber, Part, palette};

/// Half the side of a control point's square, in screen pixels.
const HANDLE: f64 = 3.0;
/// Length of a dash and of a gap, in screen pixels.
const DASH: f64 = 6.0;
/// Opacity of what is not on this frame.
const PALE: f32 = 0.35;
const WHITE: [f32; 4] = [1.0; 4];
/// The colour of the box, the handles and the contour that is being drawn.
const TOOLS: [f32; 4] = [1.0, 0.85, 0.2, 1.0];

/// Draws the overlay.
pub fn draw(view: &View, shown: &Shown, editor: &Editor) {
    let pen = Pen { view, shown };
    let frame = shown.frame();
    for &index in &shown.parts {
        part(&pen, index, frame, editor);
    }
    let Some(frame) = frame else { return };
    let work = shown.work(frame);
    if let Some(handles) = editor.handles(&work) {
        pen.line(&handles.corners(), true, TOOLS, 1.0);
        for (_, at) in handles.places() {
            pen.square(at, HANDLE + 1.0, TOOLS, false);
        }
    }
    if let Some([a, b]) = editor.box_corners() {
        pen.line(&[a, Point::new(b.x, a.y), b, Point::new(a.x, b.y)], true, TOOLS, 1.0);
    }
    if let Some(sketch) = editor.sketch(frame) {
        let mut line = sketch.points.clone();
        line.push(sketch.pen);
        pen.line(&line, false, TOOLS, 1.5);
        sketch.points.iter().for_each(|&at| pen.square(at, HANDLE, TOOLS, false));
    }
}

fn part(pen: &Pen, index: usize, frame: Option<FrameNumber>, editor: &Editor) {
    let (shown, part) = (pen.shown, &pen.shown.document.scene.parts[index]);
    let [r, g, b] = palette::distinct(index);
    let colour = [r, g, b, 1.0];
    let Some(frame) = frame else {
        if let Some(points) = outline_at(part, shown.settings.document_time, shown.settings.curves) {
            pen.line(&points, part.closed, colour, 1.5);
        }
        return;
    };
    let work = shown.work(frame);
    let Some(points) = part.points_at(frame) else {
        if let Some(points) = nearest_key(part, frame) {
            pen.line(points, part.closed, [r, g, b, PALE], 1.0);
            pen.name(part, points, [r, g, b, PALE]);
        }
        return;
    };
    let points = editor.shown(&work, index, points);
    // A drag moves control points, so snapped curves are not shown while it lasts.
    let curves = if shown.settings.curves && !editor.drags(&work, index) { part.outline(frame) } else { None };
    let line = curves.as_ref().unwrap_or(&points);
    if shown.state.is_old(part) {
        pen.dashes(line, part.closed, colour);
    } else {
        pen.line(line, part.closed, colour, 1.5);
    }
    pen.name(part, &points, colour);
    controls(pen, &work, index, &points, editor, colour);
}

/// The control points of a part with their marks.
fn controls(pen: &Pen, work: &Work, index: usize, points: &[Point], editor: &Editor, colour: [f32; 4]) {
    let part = &work.document.scene.parts[index];
    let key = part.keys.contains_key(&work.frame);
    let pins = part.pins.get(&work.frame);
    for (point, &at) in points.iter().enumerate() {
        let chosen = editor.selection.contains(Place { part: index, point });
        pen.square(at, HANDLE, if key { WHITE } else { colour }, chosen);
        if pins.is_some_and(|pins| pins.contains_key(&point)) {
            pen.cross(at, 2.0 * HANDLE, WHITE);
        }
    }
    if let Some(&centre) = part.centers.get(&work.frame) {
        pen.cross(centre, 4.0 * HANDLE, WHITE);
    }
}

fn nearest_key(part: &Part, frame: FrameNumber) -> Option<&Vec<Point>> {
    let nearest = part.keys.iter().min_by_key(|(key, _)| (i64::from(**key) - i64::from(frame)).abs());
    nearest.map(|(_, points)| points)
}

/// Draws in pixels of the footage.
struct Pen<'a> {
    view: &'a View<'a>,
    shown: &'a Shown,
}

impl Pen<'_> {
    fn place(&self, p: Point) -> [f64; 2] {
        self.shown.placement.shown(p)
    }

    fn line(&self, points: &[Point], closed: bool, colour: [f32; 4], width: f32) {
        let points: Vec<[f64; 2]> = points.iter().map(|&p| self.place(p)).collect();
        self.view.line(&points, closed, colour, width);
    }

    /// A square of a half side in screen pixels. A filled one has its diagonals too, because overlays only draw lines.
    fn square(&self, at: Point, half: f64, colour: [f32; 4], filled: bool) {
        let [x, y] = self.place(at);
        let [w, h] = self.view.pixel.map(|pixel| half * pixel);
        let corners = [[x - w, y - h], [x + w, y - h], [x + w, y + h], [x - w, y + h]];
        self.view.line(&corners, true, colour, 1.0);
        if filled {
            let rows = (-(half as i32) + 1)..(half as i32);
            for row in rows {
                let y = y + f64::from(row) * self.view.pixel[1];
                self.view.line(&[[x - w, y], [x + w, y]], false, colour, 1.0);
            }
        }
    }

    fn cross(&self, at: Point, half: f64, colour: [f32; 4]) {
        let [x, y] = self.place(at);
        let [w, h] = self.view.pixel.map(|pixel| half * pixel);
        self.view.line(&[[x - w, y], [x + w, y]], false, colour, 1.0);
        self.view.line(&[[x, y - h], [x, y + h]], false, colour, 1.0);
    }

    /// A dashed line.
    fn dashes(&self, points: &[Point], closed: bool, colour: [f32; 4]) {
        let mut along = 0.0;
        for (a, b) in rototoon::geometry::polyline::segments(points, closed) {
            let length = self.shown.lens.distance(a, b);
            let mut done = 0.0;
            while done < length {
                let left = DASH - along % DASH;
                let next = (done + left).min(length);
                if (along / DASH) as i64 % 2 == 0 {
                    self.line(&[a.lerp(b, done / length), a.lerp(b, next / length)], false, colour, 1.5);
                }
                along += next - done;
                done = next;
                // Rounding must not end on the same dash for ever.
                if left < 1e-9 {
                    along += 1e-6;
                }
            }
        }
    }

    /// The part's name at the top of its shape, with a note if its track is old.
    fn name(&self, part: &Part, points: &[Point], colour: [f32; 4]) {
        let Some(top) = points.iter().copied().min_by(|a, b| a.y.total_cmp(&b.y)) else { return };
        let note = if self.shown.state.is_old(part) { " (track again)" } else { "" };
        let [x, y] = self.place(top);
        self.view.text(&format!("{}{note}", part.name), [x, y + 6.0 * self.view.pixel[1]], colour);
    }
}
