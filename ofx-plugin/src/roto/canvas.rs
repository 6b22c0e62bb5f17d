//! Draws the overlay: contours in their parts' colours, control points, the selection with its box, and the contour that is
//! being drawn.
//!
//! - A lost contour is a black line with red in it, which shows on any background, and says so beside its name. A doubtful
//!   one has an amber border.
//! - A contour whose track is older than its keys and corrections, or than the source, is dashed.
//! - A part without a shape on the frame shows its nearest key: thin and pale, dashed if the part is hidden there, and
//!   black and red dashes if it is lost.
//! - The outer edge of a border with a feather of its points is a thin pale line.
//! - The upper left corner of the footage lists the lost, doubtful and hidden parts.
//! - Squares are control points: white on a key frame, in the part's colour on a tracked one, filled if selected. A pin has a
//!   cross, a corrected centre a larger cross.

use super::edit::{Editor, Place, Work};
use super::overlay::Shown;
use super::pen::Pen;
use super::standing::{self, Standing};
use crate::ofx::interact::View;
use rototoon::geometry::{Point, polygon, polyline};
use rototoon::render::motion::{outline_at, segments_at};
use rototoon::render::widths;
use rototoon::scene::{FrameNumber, Part};

/// Half the side of a control point's square, in screen pixels.
const HANDLE: f64 = 3.0;
/// Opacity of what is not on this frame.
const PALE: f32 = 0.35;
/// Opacity of the line up to which a border fades.
const EDGE: f32 = 0.7;
const WHITE: [f32; 4] = [1.0; 4];
const BLACK: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
/// The colour of lost contours.
const RED: [f32; 4] = [1.0, 0.0, 0.1, 1.0];
/// The colour of doubtful contours' borders.
const AMBER: [f32; 4] = [1.0, 0.65, 0.0, 1.0];
/// The colour of hidden parts' names.
const GREY: [f32; 4] = [0.8, 0.8, 0.8, 1.0];
/// Height of a line of text, in screen pixels.
const LINE: f64 = 17.0;
/// Most letters of a line of the list of parts, unless one name is longer.
const MOST_LETTERS: usize = 60;
/// The colour of the box, the handles and the contour that is being drawn.
const TOOLS: [f32; 4] = [1.0, 0.85, 0.2, 1.0];

/// A pen, and what is drawn with it.
struct Sheet<'a> {
    pen: Pen<'a>,
    shown: &'a Shown,
}

/// Draws the overlay.
pub fn draw(view: &View, shown: &Shown, editor: &Editor) {
    let pen = Pen { view, placement: &shown.placement, lens: shown.lens };
    let sheet = Sheet { pen, shown };
    let frame = shown.frame();
    for &index in &shown.parts {
        part(&sheet, index, frame, editor);
    }
    let Some(frame) = frame else { return };
    list(&sheet, frame);
    let work = shown.work(frame);
    if let Some(handles) = editor.handles(&work) {
        sheet.pen.line(&handles.corners(), true, TOOLS, 1.0);
        for (_, at) in handles.places() {
            sheet.pen.square(at, HANDLE + 1.0, TOOLS, false);
        }
    }
    if let Some([a, b]) = editor.box_corners() {
        sheet.pen.line(&[a, Point::new(b.x, a.y), b, Point::new(a.x, b.y)], true, TOOLS, 1.0);
    }
    if let Some(sketch) = editor.sketch(frame) {
        let mut line = sketch.points.clone();
        line.push(sketch.pen);
        sheet.pen.line(&line, false, TOOLS, 1.5);
        sketch.points.iter().for_each(|&at| sheet.pen.square(at, HANDLE, TOOLS, false));
    }
}

fn part(sheet: &Sheet, index: usize, frame: Option<FrameNumber>, editor: &Editor) {
    let (shown, part) = (sheet.shown, &sheet.shown.document.scene.parts[index]);
    let [r, g, b] = shown.colour(index);
    let colour = [r, g, b, 1.0];
    let Some(frame) = frame else {
        if let Some(points) = outline_at(part, shown.settings.document_time, shown.settings.curves) {
            sheet.pen.line(&points, part.closed, colour, 1.5);
        }
        return;
    };
    let work = shown.work(frame);
    let standing = standing::on(part, frame, &shown.document.scene.footage);
    let Some(points) = part.points_at(frame) else {
        without_shape(sheet, part, frame, [r, g, b, PALE], standing);
        return;
    };
    let points = editor.shown(&work, index, points);
    // A drag moves control points, so snapped curves are not shown while it lasts.
    let curves = if shown.settings.curves && !editor.drags(&work, index) { part.outline(frame) } else { None };
    contour(sheet, part, curves.as_ref().unwrap_or(&points), colour, standing);
    name(sheet, part, &points, colour, standing);
    outer_edge(sheet, part, &points, &editor.feather(&work, index), [r, g, b, EDGE]);
    controls(sheet, &work, index, &points, editor, colour);
}

/// A contour that shows how the part stands.
fn contour(sheet: &Sheet, part: &Part, line: &[Point], colour: [f32; 4], standing: Standing) {
    let (colour, width) = match standing {
        Standing::Lost => {
            sheet.pen.line(line, part.closed, BLACK, 5.0);
            (RED, 2.5)
        }
        Standing::Doubtful => {
            sheet.pen.line(line, part.closed, BLACK, 5.0);
            sheet.pen.line(line, part.closed, AMBER, 4.0);
            (colour, 1.5)
        }
        Standing::Fine | Standing::Hidden => (colour, 1.5),
    };
    if sheet.shown.is_old(part) {
        sheet.pen.dashes(line, part.closed, colour, width);
    } else {
        sheet.pen.line(line, part.closed, colour, width);
    }
}

/// The line up to which the border fades, for a part with a feather of its points.
fn outer_edge(sheet: &Sheet, part: &Part, points: &[Point], widths: &[f64], colour: [f32; 4]) {
    if widths.is_empty() || !part.closed {
        return;
    }
    let settings = &sheet.shown.settings;
    // These are in the host's pixels, and the points' own widths in those of the footage.
    let placement = &sheet.shown.placement;
    let all = placement.length(settings.feather + settings.look(&part.name).feather) / placement.magnification();
    let moved = part.points_at(settings.document_time as FrameNumber).is_none_or(|own| own != points);
    let paths = if moved { None } else { segments_at(part, settings.document_time, settings.curves) };
    let sides = || polyline::segments(points, true).map(|(a, b)| vec![a, b]).collect();
    let pieces = widths::pieces(&paths.unwrap_or_else(sides), widths);
    let outward = if polygon::signed_area(points) > 0.0 { -1.0 } else { 1.0 };
    let count = pieces.len();
    let edge: Vec<Point> = (0..count)
        .map(|k| {
            let along = pieces[(k + 1) % count].at - pieces[(k + count - 1) % count].at;
            pieces[k].at + outward * (pieces[k].width + all) * along.perp().normalize_or_zero()
        })
        .collect();
    sheet.pen.line(&edge, true, colour, 1.0);
}

/// A part that has no shape on the frame: its nearest key.
fn without_shape(sheet: &Sheet, part: &Part, frame: FrameNumber, pale: [f32; 4], standing: Standing) {
    let Some(points) = nearest_key(part, frame) else { return };
    match standing {
        Standing::Lost => {
            sheet.pen.line(points, part.closed, BLACK, 3.0);
            sheet.pen.dashes(points, part.closed, RED, 3.0);
        }
        Standing::Hidden => sheet.pen.dashes(points, part.closed, pale, 1.0),
        Standing::Fine | Standing::Doubtful => sheet.pen.line(points, part.closed, pale, 1.0),
    }
    name(sheet, part, points, pale, standing);
}

/// The part's name at the top of its shape, with what is to say of it.
fn name(sheet: &Sheet, part: &Part, points: &[Point], colour: [f32; 4], standing: Standing) {
    let Some(top) = points.iter().copied().min_by(|a, b| a.y.total_cmp(&b.y)) else { return };
    let (word, colour) = match standing {
        Standing::Lost => (Some("lost"), RED),
        Standing::Doubtful => (Some("doubtful"), colour),
        Standing::Hidden => (Some("hidden"), GREY),
        Standing::Fine => (None, colour),
    };
    let again = sheet.shown.is_old(part).then_some("track again");
    let notes: Vec<&str> = word.into_iter().chain(again).collect();
    let notes = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join(", ")) };
    sheet.pen.text(&format!("{}{notes}", part.name), top, [0.0, 6.0], colour);
}

/// The lost, doubtful and hidden parts by name, in the upper left corner of the footage.
fn list(sheet: &Sheet, frame: FrameNumber) {
    let scene = &sheet.shown.document.scene;
    let stands = |part: &&Part, wanted| standing::on(part, frame, &scene.footage) == wanted;
    let kinds =
        [("Lost", Standing::Lost, RED), ("Doubtful", Standing::Doubtful, AMBER), ("Hidden", Standing::Hidden, GREY)];
    let mut below = 0.0;
    for (title, standing, colour) in kinds {
        // The nearest part comes first.
        let parts = sheet.shown.parts.iter().rev().map(|&index| &scene.parts[index]);
        let names: Vec<&str> = parts.filter(|part| stands(part, standing)).map(|part| part.name.as_str()).collect();
        for line in lines(title, &names) {
            below += LINE;
            sheet.pen.text(&line, Point::ZERO, [6.0, -below], colour);
        }
    }
}

/// A title and names as lines of a bearable length.
fn lines(title: &str, names: &[&str]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for (k, name) in names.iter().enumerate() {
        let end = if k + 1 < names.len() { "," } else { "" };
        match lines.last_mut() {
            Some(line) if line.chars().count() + name.chars().count() + 2 <= MOST_LETTERS => {
                *line += &format!(" {name}{end}");
            }
            Some(_) => lines.push(format!("  {name}{end}")),
            None => lines.push(format!("{title}: {name}{end}")),
        }
    }
    lines
}

/// The control points of a part with their marks.
fn controls(sheet: &Sheet, work: &Work, index: usize, points: &[Point], editor: &Editor, colour: [f32; 4]) {
    let part = &work.document.scene.parts[index];
    let key = part.keys.contains_key(&work.frame);
    let pins = part.pins.get(&work.frame);
    for (point, &at) in points.iter().enumerate() {
        let chosen = editor.selection.contains(Place { part: index, point });
        sheet.pen.square(at, HANDLE, if key { WHITE } else { colour }, chosen);
        if pins.is_some_and(|pins| pins.contains_key(&point)) {
            sheet.pen.cross(at, 2.0 * HANDLE, WHITE);
        }
    }
    if let Some(&centre) = part.centers.get(&work.frame) {
        sheet.pen.cross(centre, 4.0 * HANDLE, WHITE);
    }
}

fn nearest_key(part: &Part, frame: FrameNumber) -> Option<&Vec<Point>> {
    let nearest = part.keys.iter().min_by_key(|(key, _)| (i64::from(**key) - i64::from(frame)).abs());
    nearest.map(|(_, points)| points)
}

#[cfg(test)]
mod tests {
    use super::lines;

    #[test]
    fn names_are_listed_in_lines_of_a_bearable_length() {
        assert!(lines("Lost", &[]).is_empty());
        assert_eq!(lines("Lost", &["head", "arm"]), ["Lost: head, arm"]);
        let many = vec!["a part with a name"; 7];
        let found = lines("Hidden", &many);
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(found.iter().all(|line| line.chars().count() <= 60), "{found:?}");
        assert_eq!(found.concat().matches("a part with a name").count(), 7);
    }
}
