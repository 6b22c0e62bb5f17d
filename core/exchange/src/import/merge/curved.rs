//! The Bézier curves of a snapped part, as an export wrote them.
//!
//! **Why.** An export with Bézier curves is near the snapped paths and not on them, and the file does not say how near. Compared with the paths, every
//! frame would be an edited one.
//!
//! **How.** The export is made again with the tolerances that people choose ([`TOLERANCES`]), from the distance that the file keeps on most frames. The one that gives
//! the file's curves on most frames is taken: what differs from these curves was edited. If none does, because another tolerance was chosen, a frame is the same
//! where all joints lie on the file's outline and the paths are no farther from it than on other frames ([`FARTHER`]).
//!
//! **Limits.** With a tolerance that is not in the list, edits of about its size are not seen.

use super::compared::Compared;
use super::outline::{self, NEAR, lies_on};
use super::{Shape, of_file};
use crate::export::knot::Knot;
use crate::export::outlines::{Detail, Outlines};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{FrameNumber, Part};
use std::collections::BTreeMap;

/// Tolerances of an export that are tried, in pixels.
const TOLERANCES: [f64; 26] = [
    0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0, 1.2, 1.25, 1.5, 2.0, 2.5,
    3.0, 4.0, 5.0, 7.5, 10.0,
];
/// Greatest number of tolerances that are tried for a part.
const MOST_TRIED: usize = 12;
/// How much farther from the paths than on most frames a file's outline may be, if its tolerance is not known.
const FARTHER: f64 = 1.5;
/// Number of straight pieces of a curve. A piece of 100 px whose handles are 50 px off its chord is within 0.01 px of them.
const STEPS: usize = 64;

/// By curves near the paths.
pub(super) struct Curved {
    /// The outline that an export writes on each frame; empty if its tolerance is not known.
    written: BTreeMap<FrameNumber, Vec<Point>>,
    /// Distance of the file from the paths within which they are the same, if the tolerance is not known.
    near: f64,
}

impl Curved {
    /// How a part is compared with the Bézier curves of a file; `None` if it has none, or if the file has no such curves. The file speaks of the frames
    /// for which `spoken` is true.
    pub fn of(part: &Part, shape: &Shape, spoken: impl Fn(&FrameNumber) -> bool) -> Option<Self> {
        let mut part = part.clone();
        part.curves.retain(|frame, _| spoken(frame));
        let of_file = |frame: &FrameNumber| {
            part.complete_curves(*frame)?;
            part.points_at(*frame)?;
            Some((*frame, of_file(shape, *frame)?))
        };
        let files: BTreeMap<FrameNumber, Vec<Point>> = part.curves.keys().filter_map(of_file).collect();
        let mut distances: Vec<f64> = files.iter().filter_map(|(frame, file)| distance(&part, *frame, file)).collect();
        distances.sort_by(f64::total_cmp);
        let usual = *distances.get(distances.len() / 2)?;
        let from = TOLERANCES.partition_point(|tolerance| *tolerance < distances[distances.len() / 4] - NEAR);
        let mut best = (0, None);
        for &tolerance in TOLERANCES[from..].iter().take(MOST_TRIED) {
            let written = written(&part, tolerance)?;
            let is_same = |(frame, file): &(&FrameNumber, &Vec<Point>)| {
                written.get(frame).is_some_and(|own| lies_on(file, own, part.closed))
            };
            let same = files.iter().filter(is_same).count();
            if same > best.0 {
                best = (same, Some(written));
            }
            if 2 * same > files.len() {
                break;
            }
        }
        let known = best.1.map(|written| Self { written, near: 0.0 });
        known.or_else(|| {
            let joints = files.iter().filter(|(frame, file)| has_all_joints(&part, **frame, file)).count();
            let own = Self { written: BTreeMap::new(), near: FARTHER * usual };
            (2 * joints > files.len() && own.near <= TOLERANCES[TOLERANCES.len() - 1]).then_some(own)
        })
    }
}

impl Compared for Curved {
    fn is_same(&self, part: &Part, frame: FrameNumber, file: &[Point]) -> bool {
        if let Some(own) = self.written.get(&frame) {
            return lies_on(file, own, part.closed);
        }
        outline::Outline.is_same(part, frame, file)
            || has_all_joints(part, frame, file) && distance(part, frame, file).is_some_and(|own| own <= self.near)
    }

    fn taken(&self, part: &Part, frame: FrameNumber, file: Vec<Point>) -> (Vec<Point>, Vec<Vec<Point>>) {
        outline::taken(part, frame, &file, |like| self.written.get(&like).cloned())
    }
}

/// The outlines that an export with Bézier curves writes; `None` if it writes none.
fn written(part: &Part, tolerance: f64) -> Option<BTreeMap<FrameNumber, Vec<Point>>> {
    let outlines = Outlines::new(part, Detail::Bezier(tolerance));
    let frames = part.keys.keys().chain(part.tracks.keys());
    let found = frames.filter_map(|frame| Some((*frame, drawn(&outlines.at(*frame)?, part.closed))));
    outlines.bent().then(|| found.collect())
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
        line.iter().map(|&p| polyline::distance(p, other, part.closed)).fold(0.0, f64::max)
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
