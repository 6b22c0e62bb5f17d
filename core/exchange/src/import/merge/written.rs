//! The outlines of a snapped part, as an export wrote them.
//!
//! **Why.** An export does not have all that the part has: points in distances follow a winding path by chords, and Bézier curves are near the path, not on it.
//! The file does not say which distance or tolerance was chosen. Compared with the paths, frames would be edited that nobody has touched.
//!
//! **How.** The export is made again. Points in distances: the distance that gives as many points. Bézier curves: the tolerances that people choose ([`TOLERANCES`]),
//! that of the file's other shapes first, and then from the distances that the file keeps. One that gives the file's outlines on all frames ends the search; otherwise the one that does
//! on most frames is taken, and what differs from these outlines was edited. Smaller tolerances often give most of the same outlines, so most are not enough to end it. If none gives any,
//! because another tolerance was chosen, a frame is the same where all joints lie on the file's outline and the paths are no farther from it than on other frames ([`FARTHER`]).
//!
//! **Limits.** With a tolerance that is not in the list, frames may count as edited where one in the list gives other curves, and edits of about its size may not be seen.

use super::compared::Compared;
use super::near::Near;
use super::outline::{self, NEAR, lies_on};
use super::{Shape, of_file};
use crate::export::knot::Knot;
use crate::export::outlines::{Detail, Outlines};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{FrameNumber, Part};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Tolerances of an export that are tried, in pixels.
const TOLERANCES: [f64; 26] = [
    0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0, 1.2, 1.25, 1.5, 2.0, 2.5,
    3.0, 4.0, 5.0, 7.5, 10.0,
];
/// Greatest number of tolerances that are tried for a part from the distance on most frames on, and below it.
const MOST_TRIED: usize = 12;
/// Least and greatest distance of points that is tried, in pixels.
const SPACINGS: [f64; 2] = [0.2, 2000.0];
/// Halvings in the search for a distance of points.
const HALVINGS: usize = 60;
/// How much farther from the paths than on most frames a file's outline may be, if its tolerance is not known.
const FARTHER: f64 = 1.5;
/// Number of straight pieces of a curve. A piece of 100 px whose handles are 50 px off its chord is within 0.01 px of them.
const STEPS: usize = 64;

/// By what an export writes.
pub(super) struct Written {
    /// The outline that an export writes on each frame; empty if its tolerance is not known.
    outlines: Outlined,
    /// Distance of the file from the paths within which they are the same, if the tolerance is not known.
    near: f64,
}

/// Outlines by frame.
type Outlined = BTreeMap<FrameNumber, Vec<Point>>;

impl Written {
    /// How a part is compared with a file that an export may have written; `None` if none has. The file speaks of the frames for which `spoken` is true.
    /// `chosen` is the tolerance of other shapes of the file, and becomes that of this one.
    pub fn of(
        part: &Part,
        shape: &Shape,
        spoken: impl Fn(&FrameNumber) -> bool,
        chosen: &mut Option<f64>,
    ) -> Option<Self> {
        let mut part = part.clone();
        part.curves.retain(|frame, _| spoken(frame));
        let of_file = |frame: &FrameNumber| {
            part.complete_curves(*frame)?;
            part.points_at(*frame)?;
            Some((*frame, of_file(shape, *frame)?))
        };
        let files: Outlined = part.curves.keys().filter_map(of_file).collect();
        let count = files.values().next()?.len();
        // So many points may be those of curves by chance, which lie on some frames where the path is nearly straight.
        let spaced = spaced(&part, count).map(|written| (same(&part, &files, &written), written));
        let is_whole = spaced.as_ref().is_some_and(|(same, _)| *same == files.len());
        let curved = if is_whole { None } else { curved(&part, &files, chosen) };
        let best = spaced.into_iter().chain(curved).rev().max_by_key(|(same, _)| *same);
        if let Some((_, outlines)) = best.filter(|(same, _)| *same > 0) {
            return Some(Self { outlines, near: 0.0 });
        }
        let distances = distances(&part, &files);
        let near = FARTHER * distances.get(distances.len() / 2)?;
        let joints = files.iter().filter(|(frame, file)| has_all_joints(&part, **frame, file)).count();
        let known = 2 * joints > files.len() && near <= TOLERANCES[TOLERANCES.len() - 1];
        known.then(|| Self { outlines: Outlined::new(), near })
    }
}

impl Compared for Written {
    fn is_same(&self, part: &Part, frame: FrameNumber, file: &[Point]) -> bool {
        if let Some(own) = self.outlines.get(&frame) {
            return lies_on(file, own, part.closed);
        }
        outline::Outline.is_same(part, frame, file)
            || has_all_joints(part, frame, file) && distance(part, frame, file).is_some_and(|own| own <= self.near)
    }

    fn taken(&self, part: &Part, frame: FrameNumber, file: Vec<Point>) -> (Vec<Point>, Vec<Vec<Point>>) {
        outline::taken(part, frame, &file, |like| self.outlines.get(&like).cloned())
    }
}

/// The frames on which an export writes what the file has.
fn same(part: &Part, files: &Outlined, written: &Outlined) -> usize {
    let is_same = |(frame, file): &(&FrameNumber, &Vec<Point>)| {
        written.get(frame).is_some_and(|own| lies_on(file, own, part.closed))
    };
    files.iter().filter(is_same).count()
}

/// What an export with points in a distance writes that gives this number of them; `None` if no distance does.
fn spaced(part: &Part, count: usize) -> Option<Outlined> {
    let [mut least, mut most] = SPACINGS;
    for _ in 0..HALVINGS {
        let spacing = (least * most).sqrt();
        let outlines = Outlines::new(part, Detail::Spacing(spacing));
        let found = part.curves.keys().find_map(|&frame| outlines.at(frame))?.len();
        match found.cmp(&count) {
            Ordering::Less => most = spacing,
            Ordering::Greater => least = spacing,
            Ordering::Equal => return Some(written(part, &outlines)),
        }
    }
    None
}

/// What an export with Bézier curves writes, with the tolerance that gives the outlines of most frames, and their number; `None` if none does. One that gives
/// those of all frames is the file's, which is `chosen`.
fn curved(part: &Part, files: &Outlined, chosen: &mut Option<f64>) -> Option<(usize, Outlined)> {
    let distances = distances(part, files);
    // On frames on which little is drawn the distance is far below the tolerance, and on edited ones far above it.
    let [few, most] = [files.len() / 4, 3 * files.len() / 4].map(|k| distances.get(k).copied());
    let [few, most] = [few?, most?].map(|least| TOLERANCES.partition_point(|tolerance| *tolerance < least - NEAR));
    let likely = TOLERANCES[most..].iter().take(MOST_TRIED);
    let others = likely.chain(TOLERANCES[few..most].iter().rev().take(MOST_TRIED)).copied();
    let others = others.filter(|tolerance| Some(*tolerance) != *chosen);
    let mut best: Option<(usize, Outlined)> = None;
    for tolerance in chosen.iter().copied().chain(others) {
        let outlines = Outlines::new(part, Detail::Bezier(tolerance));
        if !outlines.bent() {
            return None;
        }
        let written = written(part, &outlines);
        let same = same(part, files, &written);
        if same == files.len() {
            *chosen = Some(tolerance);
            return Some((same, written));
        }
        if same > best.as_ref().map_or(0, |(same, _)| *same) {
            best = Some((same, written));
        }
    }
    best
}

/// The distances of a file from a part's paths on all frames, in order.
fn distances(part: &Part, files: &Outlined) -> Vec<f64> {
    let mut found: Vec<f64> = files.iter().filter_map(|(frame, file)| distance(part, *frame, file)).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// The outlines of an export, as lines.
fn written(part: &Part, outlines: &Outlines) -> Outlined {
    let frames = part.keys.keys().chain(part.tracks.keys());
    let found = frames.filter_map(|frame| Some((*frame, outlines.at(*frame)?)));
    let line = |knots: Vec<Knot>| match outlines.bent() {
        true => drawn(&knots, part.closed),
        false => knots.iter().map(|knot| knot.at).collect(),
    };
    found.map(|(frame, knots)| (frame, line(knots))).collect()
}

/// The curve through knots, as a line.
fn drawn(knots: &[Knot], closed: bool) -> Vec<Point> {
    let nexts = knots.iter().skip(1).chain(knots.first().filter(|_| closed));
    let piece = |(from, to): (&Knot, &Knot)| {
        let guides = [from.at, from.handles()[1], to.handles()[0], to.at];
        (0..STEPS).map(move |k| on_cubic(guides, k as f64 / STEPS as f64))
    };
    let end = knots.last().filter(|_| !closed).map(|knot| knot.at);
    knots.iter().zip(nexts).flat_map(piece).chain(end).collect()
}

/// The point of a cubic at a parameter (de Casteljau).
fn on_cubic([a, b, c, d]: [Point; 4], t: f64) -> Point {
    let [ab, bc, cd] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
    ab.lerp(bc, t).lerp(bc.lerp(cd, t), t)
}

/// The greatest distance between a part's outline and that of a file, both ways.
fn distance(part: &Part, frame: FrameNumber, file: &[Point]) -> Option<f64> {
    let own = part.outline(frame)?;
    let most = |line: &[Point], other: &[Point]| {
        let mut near = Near::new(other, part.closed);
        line.iter().fold(0.0, |most, &p| near.at_least(p, most))
    };
    Some(most(file, &own).max(most(&own, file)))
}

/// Whether all control points of a part lie on the outline of a file.
fn has_all_joints(part: &Part, frame: FrameNumber, file: &[Point]) -> bool {
    let is_on = |paths: &Vec<Vec<Point>>| {
        paths.iter().filter_map(|path| path.first()).all(|&p| polyline::distance(p, file, part.closed) <= NEAR)
    };
    part.complete_curves(frame).is_some_and(is_on)
}
