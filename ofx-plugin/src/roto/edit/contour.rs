//! Makes keys of drawn contours.
//!
//! A contour drawn for a part that exists becomes its key on the frame. Its order, direction, start and number of points are
//! free: the core finds the part's control points on it, as in Blender ([`rototoon::scene::correspondence`]). If as many
//! points were set as the part has, they are its points. Another contour becomes a new part in front of all others.

use super::change::{inside_footage, make_key, middle};
use super::{Lens, Refused, naming};
use rototoon::geometry::{Point, polygon, polyline};
use rototoon::project::Document;
use rototoon::render::motion::outline_at;
use rototoon::scene::correspondence::{DrawnContour, MatchOptions, match_contours};
use rototoon::scene::{FrameNumber, Part};

/// Distance on the screen, in pixels, within which a freehand contour keeps to the pen.
const TOLERANCE: f64 = 1.5;
/// Least number of points of a freehand contour.
const LEAST_FREEHAND: usize = 6;
/// Any contour costs less.
const MOST_COST: f64 = 1e6;
/// Least area of a closed contour in square pixels.
const LEAST_AREA: f64 = 1e-3;

/// Draws a contour on a frame: the key of the part with this name, or a new part. `set` says that its points were set one by
/// one, and not drawn in a stroke. Returns the part's index.
pub fn draw(
    document: &mut Document,
    frame: FrameNumber,
    name: &str,
    points: Vec<Point>,
    closed: bool,
    set: bool,
) -> Result<usize, Refused> {
    inside_footage(document, frame)?;
    check(&points, closed)?;
    let parts = &mut document.scene.parts;
    let known = parts.iter().position(|part| !name.is_empty() && part.name == name);
    if let Some(index) = known {
        let part = &mut parts[index];
        if part.closed != closed {
            let (is, drawn) = if closed { ("open", "closed") } else { ("closed", "open") };
            let switch = if closed { "off" } else { "on" };
            return Err(Refused::new(format!(
                "{name:?} is {is}, but the contour is {drawn}: switch Closed {switch}, or press New part; then press Return"
            )));
        }
        let shape = key_of(part, frame, points, set);
        make_key(part, frame, shape);
        return Ok(index);
    }
    naming::check(name, "Part")?;
    // Parts may be nearer on some frames.
    let depths = parts.iter().flat_map(|part| part.depths.values().chain([&part.depth]));
    let nearest = depths.copied().fold(f64::NEG_INFINITY, f64::max);
    let depth = if nearest.is_finite() { nearest.floor() + 1.0 } else { 0.0 };
    let name = if name.is_empty() { free_name(parts) } else { name.to_owned() };
    parts.push(Part { name, closed, depth, keys: [(frame, points)].into(), ..Part::default() });
    Ok(parts.len() - 1)
}

fn check(points: &[Point], closed: bool) -> Result<(), Refused> {
    let least = if closed { 3 } else { 2 };
    if points.len() < least {
        let (found, points) = (points.len(), if points.len() == 1 { "point" } else { "points" });
        return Err(Refused::new(format!("found {found} {points}, expected at least {least} for a contour")));
    }
    if closed && polygon::signed_area(points).abs() < LEAST_AREA {
        return Err(Refused::new("the contour encloses no area"));
    }
    Ok(())
}

/// A part's control points on a contour. `set` says that the contour's points were set one by one.
fn key_of(part: &Part, frame: FrameNumber, points: Vec<Point>, set: bool) -> Vec<Point> {
    let nearest = part.keys.iter().min_by_key(|(key, _)| (i64::from(**key) - i64::from(frame)).abs());
    let shown = outline_at(part, f64::from(frame), false).filter(|shape| shape.len() == part.point_count());
    let Some(before) = shown.or_else(|| nearest.map(|(_, points)| points.clone())) else { return points };
    let contour =
        |points: &[Point]| DrawnContour { points: points.to_vec(), closed: part.closed, ..Default::default() };
    // The artist says which part it is, however little it resembles it.
    let options = MatchOptions { max_cost: MOST_COST, ..MatchOptions::default() };
    let found = match_contours(&[contour(&before)], &[contour(&points)], &options);
    let found = found.ok().and_then(|found| found.into_iter().next().flatten());
    let found = found.map(|found| found.points).filter(|found| found.len() == before.len());
    match found {
        // Points that were set one by one are meant. The map says which is which.
        _ if set && points.len() == before.len() => {
            nearest_order(&points, found.as_ref().unwrap_or(&before), part.closed)
        }
        Some(found) => found,
        None => polyline::resample(&points, part.closed, before.len()),
    }
}

/// The points in the order that is nearest to a shape's: as drawn or backwards, and for closed contours from any of them.
/// Middles are aligned first.
fn nearest_order(points: &[Point], shape: &[Point], closed: bool) -> Vec<Point> {
    let count = points.len();
    let shift = middle(shape) - middle(points);
    let backwards: Vec<Point> = points.iter().rev().copied().collect();
    let starts = if closed { count } else { 1 };
    let orders = [points, &backwards].into_iter().flat_map(|points| {
        (0..starts).map(move |start| {
            let mut order = points.to_vec();
            order.rotate_left(start);
            order
        })
    });
    let apart =
        |order: &Vec<Point>| -> f64 { order.iter().zip(shape).map(|(a, b)| (*a + shift).distance_squared(*b)).sum() };
    orders.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_else(|| points.to_vec())
}

/// "part 1" or the next name that no part has.
pub fn free_name(parts: &[Part]) -> String {
    let taken = |name: &String| parts.iter().any(|part| part.name == *name);
    let mut names = (1..).map(|number| format!("part {number}"));
    names.find(|name| !taken(name)).unwrap_or_default()
}

/// The control points of a contour that was drawn in one stroke: those that keep it within a tolerance of the pen.
pub fn simplified(stroke: &[Point], closed: bool, lens: &Lens) -> Vec<Point> {
    let mut line: Vec<Point> = stroke.to_vec();
    line.dedup();
    if closed && line.len() > 2 && line.first() == line.last() {
        line.pop();
    }
    if line.len() < 3 {
        return line;
    }
    // A closed stroke is divided at the point that is farthest from its start.
    let away = |k: &usize| lens.distance(line[*k], line[0]);
    let far = (1..line.len()).max_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(line.len() - 1);
    let mut kept = vec![false; line.len()];
    if closed {
        (kept[0], kept[far]) = (true, true);
        keep(&line, 0, far, lens, &mut kept);
        let around: Vec<Point> = line[far..].iter().chain(&line[..1]).copied().collect();
        let mut back = vec![false; around.len()];
        keep(&around, 0, around.len() - 1, lens, &mut back);
        back.iter().enumerate().take(line.len() - far).for_each(|(k, own)| kept[far + k] |= own);
    } else {
        let last = line.len() - 1;
        (kept[0], kept[last]) = (true, true);
        keep(&line, 0, last, lens, &mut kept);
    }
    let points: Vec<Point> = line.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(p, _)| *p).collect();
    // A smooth small contour would keep too few points to bend later.
    if points.len() < LEAST_FREEHAND && line.len() >= LEAST_FREEHAND {
        return polyline::resample(&line, closed, LEAST_FREEHAND);
    }
    points
}

/// Keeps the points between two kept ones that are farther than the tolerance from the line between them (Ramer 1972,
/// Douglas and Peucker 1973).
fn keep(line: &[Point], first: usize, last: usize, lens: &Lens, kept: &mut [bool]) {
    let mut ranges = vec![(first, last)];
    while let Some((first, last)) = ranges.pop() {
        let off = |k: usize| lens.nearest(line[k], line[first], line[last]).1;
        let farthest = (first + 1..last).map(|k| (k, off(k))).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, _)) = farthest.filter(|(_, distance)| *distance > TOLERANCE) {
            kept[k] = true;
            ranges.extend([(first, k), (k, last)]);
        }
    }
}
