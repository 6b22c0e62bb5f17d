//! The same strokes on the next drawing.
//!
//! 1. [`register`] finds roughly where every point of every stroke is, or that the drawings have nothing to do with each
//!    other. Then all strokes end, and those of the next drawing are new.
//! 2. [`follow`] lays each stroke onto the ink there. A stroke that is mostly off the ink has ended. Solid shapes are laid onto the
//!    outlines of solid shapes, or [looked for](blot) where there are none.
//! 3. [`rivals`]: of strokes that lie on the same ink one stays.
//! 4. [`rest`]: ink that no stroke explains lengthens strokes or begins new ones, with numbers of their own.
//!
//! All strokes are carried on, and a drawing has those that it [shows](Shown): one line of ink is explained by one stroke.
//!
//! Where the same picture is shown again, its strokes stay as they are.
//!
//! Between two drawn keys strokes come from both: [`between()`].

mod belief;
mod between;
mod bind;
mod blot;
mod confidence;
mod context;
mod follow;
mod identify;
mod labels;
mod own;
mod pieces;
mod register;
mod rest;
mod rivals;
mod samples;
mod shown;

pub use between::{Key, between, bound};
pub use bind::{Bound, bind};
pub use identify::identify;
pub use register::{Displaced, displaced};
pub use shown::{Shown, is_same};

use crate::drawing::Drawing;
use crate::stroke::{Stroke, Tracked};
use crate::strokes::Walked;
use confidence::Signs;
use follow::Followed;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polyline};
use std::ops::Range;

/// Share of a stroke that must be on ink, or it has ended.
const ON_INK: f64 = 0.4;
/// Steps off the ink over which an open stroke goes on: another line may hide it, or the pen left a gap.
const AWAY: usize = 10;
/// Distance in which a stroke explains ink, at 540 lines, added to half the width.
const EXPLAINS: f64 = 0.75;
/// Length of the shortest new stroke, at 540 lines, added to the width.
const NEW: f64 = 3.0;
/// Share of a solid shape's outline that must be on the outline of one.
const ON_SOLID: f64 = 0.8;

/// The strokes of the drawing `from` on the drawing `to`. New strokes get numbers from `next` on, which is raised. If the
/// drawings have nothing to do with each other, all strokes are new.
pub fn carry(from: &Drawing, strokes: &[Tracked], to: &Drawing, next: &mut usize) -> Vec<Tracked> {
    let (mut out, mut rests) = carried(from, strokes, to);
    rests.retain(|rest| polyline::length(&rest.points, rest.closed) >= NEW * to.unit + to.width);
    for rest in rests {
        out.push(Tracked::sure(*next, to.finished(&rest)));
        *next += 1;
    }
    out
}

/// As [`carry()`], without new strokes.
pub fn carry_known(from: &Drawing, strokes: &[Tracked], to: &Drawing) -> Vec<Tracked> {
    carried(from, strokes, to).0
}

/// The strokes on the drawing `to`, and its ink that no stroke explains.
fn carried(from: &Drawing, strokes: &[Tracked], to: &Drawing) -> (Vec<Tracked>, Vec<Walked>) {
    if to.graph.branches.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let unit = to.unit;
    let mut strokes: Vec<Tracked> = strokes.iter().filter(|s| s.stroke.points.len() > 1).cloned().collect();
    let order = shortest_first(&mut strokes);
    let reach = EXPLAINS * unit + 0.5 * to.width;
    if is_same(from, to) {
        let rests = rest::left(to.lines(), &covered(strokes.iter().map(of_stroke), reach), reach, NEW * unit);
        return (as_they_came(order.into_iter().zip(strokes)), rests);
    }
    let registered = register::register(from, &strokes, to);
    if !registered.related {
        strokes.clear();
    }
    let step = 0.5 * follow::STEP * unit;
    let ink = follow::Ink::new(samples::of_ink(to, step, false), unit);
    let solids = follow::Ink::new(samples::of_solids(to, step), unit);
    let mut laid: Vec<Option<Laid>> = strokes
        .par_iter()
        .enumerate()
        .map(|(k, Tracked { stroke, .. })| {
            let expected = moved(stroke, &registered.lengths[k], &registered.shifts[k]);
            if stroke.fill
                && stroke.closed
                && let Some(patch) = blot::Patch::of(from, &stroke.points)
            {
                return solid((from, &patch), &stroke.points, &expected, (to, &solids), registered.signs[k]);
            }
            kept(ink.follow(&expected, stroke.closed), stroke.closed, registered.signs[k])
        })
        .collect();
    rivals::settled(&mut laid, &strokes, reach, unit);
    let (mut numbers, mut lines) = (Vec::new(), Vec::new());
    for (k, laid) in laid.into_iter().enumerate().filter_map(|(k, laid)| Some((k, laid?))) {
        numbers.push((k, laid.signs));
        lines.push((laid.points, laid.closed));
    }
    let rests = rest::left(to.lines(), &covered(lines.iter().map(of_line), reach), reach, NEW * unit);
    let rests = rest::lengthened(&mut lines, rests, reach);
    let shared = confidence::shared(&lines.iter().map(of_line).collect::<Vec<_>>(), reach);
    for ((own, shared), line) in numbers.iter_mut().zip(shared).zip(&lines) {
        let before = &strokes[own.0].stroke;
        own.1 =
            Signs { shared, longer: confidence::longer((&before.points, before.closed), (&line.0, line.1)), ..own.1 };
    }
    let known = |(&(k, signs), (points, closed)): (&(usize, Signs), &(Vec<Point>, bool))| Tracked {
        confidence: strokes[k].confidence * signs.probability(),
        ..finished(&strokes[k], points, *closed, to)
    };
    let found: Vec<(usize, Tracked)> = numbers.par_iter().zip(&lines).map(|own| (order[own.0.0], known(own))).collect();
    (as_they_came(found), rests)
}

/// Puts the shortest strokes first, and returns the place in the list at which each was. Messages between points run in an order, so the list would decide
/// where nothing else does: the same strokes in another order would go to other lines. Long strokes know best where they are. On the way back they speak
/// first.
fn shortest_first(strokes: &mut Vec<Tracked>) -> Vec<usize> {
    fn numbers(tracked: &Tracked) -> impl Iterator<Item = f64> + '_ {
        tracked.stroke.points.iter().flat_map(|p| [p.y, p.x])
    }
    let length = |tracked: &Tracked| polyline::length(&tracked.stroke.points, tracked.stroke.closed);
    let all = std::mem::take(strokes).into_iter().enumerate();
    let mut all: Vec<(f64, usize, Tracked)> = all.map(|(k, tracked)| (length(&tracked), k, tracked)).collect();
    all.sort_by(|(a_length, _, a), (b_length, _, b)| {
        let places = numbers(a).zip(numbers(b)).map(|(x, y)| x.total_cmp(&y)).find(|order| order.is_ne());
        a_length.total_cmp(b_length).then(places.unwrap_or(a.track.cmp(&b.track)))
    });
    let (order, sorted) = all.into_iter().map(|(_, k, tracked)| (k, tracked)).unzip();
    *strokes = sorted;
    order
}

/// Strokes in the order of their places in the list.
fn as_they_came(strokes: impl IntoIterator<Item = (usize, Tracked)>) -> Vec<Tracked> {
    let mut all: Vec<(usize, Tracked)> = strokes.into_iter().collect();
    all.sort_by_key(|found| found.0);
    all.into_iter().map(|(_, tracked)| tracked).collect()
}

fn of_stroke(tracked: &Tracked) -> (&[Point], bool) {
    (&tracked.stroke.points, tracked.stroke.closed)
}

fn of_line((points, closed): &(Vec<Point>, bool)) -> (&[Point], bool) {
    (points, *closed)
}

/// Places along lines, which explain the ink within `reach`.
fn covered<'a>(lines: impl Iterator<Item = (&'a [Point], bool)>, reach: f64) -> Vec<Point> {
    lines.flat_map(|(points, closed)| samples::of_line(points, closed, 0.5 * reach)).map(|s| s.place).collect()
}

/// A solid shape on the outline of one there, or where it is [found](blot) without.
fn solid(
    (from, patch): (&Drawing, &blot::Patch),
    outline: &[Point],
    expected: &[Point],
    (to, solids): (&Drawing, &follow::Ink),
    signs: Signs,
) -> Option<Laid> {
    let followed = solids.follow(expected, true);
    if followed.on.iter().filter(|on| **on).count() as f64 >= ON_SOLID * followed.on.len() as f64 {
        return kept(followed, true, signs);
    }
    // What registration says of it is what it says of lines.
    blot::found(patch, from, outline, expected, to)
}

/// The mean way of points from their places to the expected ones.
fn carried_along(points: &[Point], expected: &[Point]) -> Point {
    points.iter().zip(expected).map(|(p, q)| *q - *p).sum::<Point>() / points.len().max(1) as f64
}

/// A stroke at its expected place: shifts between its registered points are interpolated.
fn moved(stroke: &Stroke, lengths: &[f64], shifts: &[Point]) -> Vec<Point> {
    let mut at = 0.0;
    let mut k = 0;
    let shift = |i: usize| {
        if i > 0 {
            at += stroke.points[i].distance(stroke.points[i - 1]);
        }
        while k + 1 < lengths.len() && lengths[k + 1] < at {
            k += 1;
        }
        let next = if k + 1 < lengths.len() {
            k + 1
        } else if stroke.closed {
            0
        } else {
            k
        };
        let way = if next > k { lengths[next] - lengths[k] } else { (at - lengths[k]).max(1e-9) };
        let share = ((at - lengths[k]) / way.max(1e-9)).clamp(0.0, 1.0);
        let share = if next == k { 0.0 } else { share };
        stroke.points[i] + shifts[k].lerp(shifts[next], share)
    };
    (0..stroke.points.len()).map(shift).collect()
}

/// A stroke on the next drawing.
struct Laid {
    points: Vec<Point>,
    closed: bool,
    signs: Signs,
}

/// The stroke without the ends that are off the ink; `None` if too little is on it.
fn kept(followed: Followed, closed: bool, signs: Signs) -> Option<Laid> {
    let Followed { mut points, on, far } = followed;
    let all = on.len() as f64;
    let count = on.iter().filter(|&&on| on).count();
    if count < 2 || (count as f64) < ON_INK * on.len() as f64 {
        return None;
    }
    if !closed {
        let kept = longest(&on);
        points = points[kept].to_vec();
    }
    points.dedup_by(|a, b| a.distance(*b) < 1e-6);
    let signs = Signs { off: 1.0 - count as f64 / all, far, ..signs };
    (points.len() > 1).then_some(Laid { points, closed, signs })
}

/// The longest stretch of steps that is on ink at both ends and nowhere off it for more than [`AWAY`] steps.
fn longest(on: &[bool]) -> Range<usize> {
    let steps: Vec<usize> = (0..on.len()).filter(|&k| on[k]).collect();
    let runs = steps.chunk_by(|&a, &b| b - a <= AWAY + 1);
    let found = runs.max_by_key(|run| (run[run.len() - 1] - run[0], std::cmp::Reverse(run[0])));
    found.map_or(0..0, |run| run[0]..run[run.len() - 1] + 1)
}

fn finished(before: &Tracked, points: &[Point], closed: bool, to: &Drawing) -> Tracked {
    let widths = &before.stroke.widths;
    let radius = 0.5 * if widths.is_empty() { to.width } else { widths.iter().sum::<f64>() / widths.len() as f64 };
    let fill = before.stroke.fill && closed;
    let walked = Walked { points: points.to_vec(), radii: vec![radius; points.len()], closed, free: [true; 2], fill };
    // A piece of a closed line does not enclose what the line does.
    let fill_colour = before.stroke.fill_colour.filter(|_| closed == before.stroke.closed);
    Tracked::sure(before.track, Stroke { fill_colour, ..to.finished(&walked) })
}
