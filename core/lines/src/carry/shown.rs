//! Which of the carried strokes a drawing shows: one line of ink is explained by one stroke.
//!
//! Where limbs pass each other, the ink of some strokes is gone. They find other ink nearby, and lie on the strokes of that ink. They go on
//! being carried, because their own ink comes back; but on such a drawing they are not there, or only as far as they alone explain
//! ink:
//!
//! 1. Strokes claim ink in the order of their worth: length on ink times confidence. A stroke's *own* points are those on ink that no stroke
//!    before it explains. It is cut back to the stretch from its first own run to its last one. A closed stroke is opened at its longest stretch without
//!    own points, if that is a quarter of it. A stroke without own ink is hidden. A stroke that is sure stays as it is: lines do run together.
//! 2. A cut may leave a bit of ink to nobody, where the other line parts from the stroke's before it ends. The stroke takes it back.
//! 3. A stroke that was needed at first, and of which later ones explain nearly everything, is hidden too.
//!
//! Strokes that lay on each other where they were drawn, such as sketched lines, or outlines that run together, may always do so. A drawing of
//! the artist is never cut.
//!
//! **Limits.** A hidden stroke comes back with its number only in the same run: a run that begins between does not know it. A short bar over blank paper
//! within a stroke stays where ink on both its sides is the stroke's own.

use super::confidence::near;
use super::samples::{Cells, of_ink, of_line};
use super::{EXPLAINS, of_stroke};
use crate::drawing::Drawing;
use crate::stroke::{Stroke, Tracked};
use rototoon_base::geometry::{Point, polyline};
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// Share of a stroke on another one, where it was drawn, from which the two may always share ink.
const TOGETHER: f64 = 0.3;
/// Distance of a point from the middle of its ink, at 540 lines, added to half the width.
const ON: f64 = 1.5;
/// Longest end without own ink that stays, in distances in which a stroke explains ink.
const END: f64 = 3.0;
/// How far behind a cut a stroke's own ink is looked for, in the same unit.
const BACK: f64 = 4.0;
/// Share of a closed stroke without own ink at which it is opened.
const OPENED: f64 = 0.25;
/// Confidence from which a stroke is there as it was carried: what it shares with others was drawn so.
const SURE: f64 = 0.8;
/// Share of a stroke on others from which it may be hidden.
const MOST: f64 = 0.75;

/// What is known of strokes that share ink for good reasons.
#[derive(Debug, Default)]
pub struct Shown {
    together: BTreeSet<(usize, usize)>,
    /// The strokes that an artist drew.
    drawn: BTreeSet<usize>,
}

/// A stroke that claims ink.
struct Claim {
    /// Length for which a point stands.
    step: f64,
    /// By point whether it is on ink.
    on: Vec<bool>,
    worth: f64,
    /// The points that are shown. Those of a closed stroke may go over its start.
    kept: Range<usize>,
}

/// Points along shown strokes, with the place of each one's stroke.
pub(super) struct Cover {
    points: Vec<(Point, usize)>,
    cells: Cells,
    reach: f64,
}

impl Shown {
    /// Learns from a drawing which of its strokes lie on each other.
    pub fn learn(&mut self, strokes: &[Tracked], drawing: &Drawing) {
        let lines: Vec<_> = strokes.iter().map(of_stroke).collect();
        for (k, others) in near(&lines, reach(drawing)).into_iter().enumerate() {
            let close = others.into_iter().filter(|&(_, share)| share > TOGETHER);
            self.together.extend(close.map(|(other, _)| pair(strokes[k].track, strokes[other].track)));
        }
    }

    /// Learns which strokes an artist drew. Their division of lines is respected.
    pub fn learn_drawn(&mut self, tracks: impl IntoIterator<Item = usize>) {
        self.drawn.extend(tracks);
    }

    pub(super) fn is_drawn(&self, track: usize) -> bool {
        self.drawn.contains(&track)
    }

    pub(super) fn is_together(&self, a: &Tracked, b: &Tracked) -> bool {
        self.together.contains(&pair(a.track, b.track))
    }

    /// The strokes that a drawing shows, as far as it shows them.
    pub fn of(&self, strokes: &[Tracked], drawing: &Drawing) -> Vec<Tracked> {
        self.with_places(strokes, drawing).into_iter().map(|(_, shown)| shown).collect()
    }

    /// As [`Self::of`], each with its place among all strokes.
    pub fn with_places(&self, strokes: &[Tracked], drawing: &Drawing) -> Vec<(usize, Tracked)> {
        let reach = reach(drawing);
        let ink = Cover::of_ink(drawing);
        let mut claims: Vec<Claim> = strokes.iter().map(|tracked| Claim::new(tracked, &ink)).collect();
        let mut order: Vec<usize> = (0..strokes.len()).collect();
        order.sort_by(|&a, &b| claims[b].worth.total_cmp(&claims[a].worth).then(a.cmp(&b)));
        let mut cover = Cover::new(reach);
        for &k in &order {
            if !is_whole(&strokes[k]) {
                let own = self.own(strokes, k, &claims[k].on, &cover);
                claims[k].cut(&own, strokes[k].stroke.closed, reach);
            }
            cover.add(k, &strokes[k].stroke, &claims[k].kept);
        }
        for &k in order.iter().filter(|&&k| !is_whole(&strokes[k])) {
            let Stroke { points, closed, .. } = &strokes[k].stroke;
            let loose = |i: usize| claims[k].on[i] && !cover.explains(points[i], |_| true);
            let kept = claims[k].taken_back(loose, *closed, reach);
            if kept != claims[k].kept {
                claims[k].kept = kept;
                cover.add(k, &strokes[k].stroke, &claims[k].kept);
            }
        }
        for &k in order.iter().rev().filter(|&&k| !is_whole(&strokes[k])) {
            if self.is_needless(strokes, &claims, k, &cover) {
                claims[k].kept = 0..0;
                cover.remove(k);
            }
        }
        let shown = strokes.iter().zip(&claims).enumerate().filter(|(_, (_, claim))| claim.kept.len() > 1);
        shown.map(|(k, (tracked, claim))| (k, cut(tracked, &claim.kept))).collect()
    }

    /// Whether others explain nearly all of a stroke, and hardly any ink is left to nobody without it, on its own line or on that of a hidden
    /// stroke.
    fn is_needless(&self, strokes: &[Tracked], claims: &[Claim], k: usize, cover: &Cover) -> bool {
        let (points, kept) = (&strokes[k].stroke.points, &claims[k].kept);
        let own = kept.clone().filter(|i| !self.explained(strokes, k, points[i % points.len()], cover)).count();
        if kept.is_empty() || own as f64 > (1.0 - MOST) * kept.len() as f64 {
            return false;
        }
        let mine: Vec<Point> = kept.clone().map(|i| points[i % points.len()]).collect();
        let far = cover.reach + claims[k].step;
        let [low, high] = [
            mine.iter().fold(Point::INFINITY, |a, b| a.min(*b)) - Point::splat(far),
            mine.iter().fold(Point::NEG_INFINITY, |a, b| a.max(*b)) + Point::splat(far),
        ];
        let bare = |p: &Point| {
            p.cmpge(low).all()
                && p.cmple(high).all()
                && cover.explains(*p, |own| own == k)
                && !cover.explains(*p, |own| own != k)
        };
        let others = strokes.iter().zip(claims).filter(|(tracked, _)| !tracked.stroke.fill);
        others
            .map(|(tracked, claim)| {
                let all = tracked.stroke.points.iter().zip(&claim.on);
                all.filter(|(p, on)| **on && bare(p)).count() as f64 * claim.step
            })
            .all(|left| left < cover.reach)
    }

    /// By point of a stroke whether it is on ink that no other one explains.
    fn own(&self, strokes: &[Tracked], k: usize, on: &[bool], cover: &Cover) -> Vec<bool> {
        let points = &strokes[k].stroke.points;
        on.iter().zip(points).map(|(&on, &p)| on && !self.explained(strokes, k, p, cover)).collect()
    }

    /// Whether a stroke explains a point of stroke `k` that has no reason to share it.
    fn explained(&self, strokes: &[Tracked], k: usize, p: Point, cover: &Cover) -> bool {
        let apart = |other: usize| other != k && !self.together.contains(&pair(strokes[k].track, strokes[other].track));
        cover.explains(p, apart)
    }
}

impl Claim {
    fn new(Tracked { stroke, confidence, .. }: &Tracked, ink: &Cover) -> Self {
        let n = stroke.points.len();
        let length = polyline::length(&stroke.points, stroke.closed);
        let on: Vec<bool> = stroke.points.iter().map(|&p| ink.explains(p, |_| true)).collect();
        let share = on.iter().filter(|on| **on).count() as f64 / n.max(1) as f64;
        Self { step: length / n.max(1) as f64, on, worth: confidence * length * share, kept: 0..n }
    }

    /// Keeps the stroke as a whole, unless nearly all of it is another one's.
    fn whole(&mut self, own: &[bool]) {
        let (n, count) = (own.len(), own.iter().filter(|own| **own).count());
        self.kept = if count as f64 > (1.0 - MOST) * n as f64 { 0..n } else { 0..0 };
    }

    /// Cuts the stroke back to its own points.
    fn cut(&mut self, own: &[bool], closed: bool, reach: f64) {
        let n = own.len();
        let first = if closed { own.iter().position(|own| !own).unwrap_or(0) } else { 0 };
        let places: Vec<usize> = (first..first + n).collect();
        let runs: Vec<&[usize]> = places.chunk_by(|&a, &b| own[a % n] == own[b % n]).collect();
        let long = |run: &&&[usize]| own[run[0] % n] && run.len() as f64 * self.step >= reach;
        let runs: Vec<Range<usize>> = runs.iter().filter(long).map(|run| run[0]..run[run.len() - 1] + 1).collect();
        let (Some(start), Some(end)) = (runs.first().map(|run| run.start), runs.last().map(|run| run.end)) else {
            // A stroke may be shorter than that, and still be the only one there.
            self.whole(own);
            return;
        };
        if closed {
            self.kept = opened(&runs, n);
            return;
        }
        let is_short = |count: usize| count as f64 * self.step <= END * reach;
        self.kept = if is_short(start) { 0 } else { start }..if is_short(n - end) { n } else { end };
    }

    /// The points that are shown with those behind its ends that are `loose`: on ink that no stroke explains.
    fn taken_back(&self, loose: impl Fn(usize) -> bool, closed: bool, reach: f64) -> Range<usize> {
        let (n, mut kept) = (self.on.len(), self.kept.clone());
        if kept.is_empty() || kept.len() >= n {
            return kept;
        }
        let far = ((BACK * reach / self.step.max(1e-9)) as usize).min(n);
        // A closed stroke goes on at its other end.
        let (low, high) = if closed { (kept.end - n.min(kept.end), kept.start + n) } else { (0, n) };
        while let Some(end) = (kept.end..(kept.end + far).min(high)).rev().find(|i| loose(i % n)) {
            kept.end = end + 1;
        }
        while let Some(start) = (kept.start.saturating_sub(far).max(low)..kept.start).find(|i| loose(i % n)) {
            kept.start = start;
        }
        if kept.len() > n { self.kept.clone() } else { kept }
    }
}

/// What is shown of a closed stroke of `n` points with these runs of own points.
fn opened(runs: &[Range<usize>], n: usize) -> Range<usize> {
    let gap = |k: usize| match runs.get(k + 1) {
        Some(next) => next.start - runs[k].end,
        None => runs[0].start + n - runs[k].end,
    };
    let widest = (0..runs.len()).max_by_key(|&k| (gap(k), std::cmp::Reverse(k))).unwrap_or(0);
    if (gap(widest) as f64) < OPENED * n as f64 {
        return 0..n;
    }
    match runs.get(widest + 1) {
        Some(next) => next.start..runs[widest].end + n,
        None => runs[0].start..runs[widest].end,
    }
}

fn cut(tracked: &Tracked, kept: &Range<usize>) -> Tracked {
    let Stroke { points, widths, closed, .. } = &tracked.stroke;
    let n = points.len();
    if kept.len() >= n {
        return tracked.clone();
    }
    let stroke = Stroke {
        points: kept.clone().map(|i| points[i % n]).collect(),
        widths: if widths.is_empty() { Vec::new() } else { kept.clone().map(|i| widths[i % n]).collect() },
        closed: false,
        // A piece of a closed line does not enclose what the line does.
        fill_colour: tracked.stroke.fill_colour.filter(|_| !closed),
        ..tracked.stroke.clone()
    };
    Tracked { stroke, ..tracked.clone() }
}

impl Cover {
    fn new(reach: f64) -> Self {
        Self { points: Vec::new(), cells: Cells::new(std::iter::empty(), reach), reach }
    }

    /// The middle of a drawing's ink.
    pub(super) fn of_ink(drawing: &Drawing) -> Self {
        let mut cover = Self::new(ON * drawing.unit + 0.5 * drawing.width);
        let places = of_ink(drawing, 0.5 * cover.reach, false);
        places.into_iter().for_each(|sample| cover.push(sample.place, 0));
        cover
    }

    fn push(&mut self, p: Point, own: usize) {
        self.cells.add(self.points.len(), p);
        self.points.push((p, own));
    }

    /// Adds what is shown of a stroke.
    fn add(&mut self, own: usize, stroke: &Stroke, kept: &Range<usize>) {
        let n = stroke.points.len();
        if kept.len() < 2 {
            return;
        }
        let points: Vec<Point> = kept.clone().map(|i| stroke.points[i % n]).collect();
        for sample in of_line(&points, stroke.closed && kept.len() == n, 0.5 * self.reach) {
            self.push(sample.place, own);
        }
    }

    fn remove(&mut self, own: usize) {
        self.points.iter_mut().filter(|(_, of)| *of == own).for_each(|(p, _)| *p = Point::splat(f64::NAN));
    }

    /// Distance in which a point is explained.
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether a stroke of these explains a point.
    pub(super) fn explains(&self, p: Point, of: impl Fn(usize) -> bool) -> bool {
        let near = |k: usize| self.points[k].0.distance(p) <= self.reach && of(self.points[k].1);
        self.cells.near(p, self.reach).any(near)
    }
}

/// Whether a stroke is there as it was carried.
fn is_whole(tracked: &Tracked) -> bool {
    tracked.stroke.fill || tracked.confidence >= SURE
}

/// Distance in which a stroke explains ink.
fn reach(drawing: &Drawing) -> f64 {
    EXPLAINS * drawing.unit + 0.5 * drawing.width
}

fn pair(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

/// Whether two drawings have the same picture. Their strokes are the same then.
pub fn is_same(a: &Drawing, b: &Drawing) -> bool {
    Arc::ptr_eq(&a.picture, &b.picture) || a.picture == b.picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use rototoon_base::scene::Raster;

    /// A line at the height 30, and a ring whose right half is ink.
    fn drawing() -> Drawing {
        let ring = |x: f64, y: f64| x > 160.0 && ((x - 160.0).hypot(y - 60.0) - 30.0).abs() < 1.5;
        let ink =
            |x: usize, y: usize| (10..110).contains(&x) && y.abs_diff(30) < 2 || ring(x as f64 + 0.5, y as f64 + 0.5);
        let picture = Raster::from_fn(220, 120, |x, y| if ink(x, y) { [0.05; 3] } else { [1.0; 3] });
        Drawing::new(Arc::new(picture), &Options::default())
    }

    fn line(track: usize, from: f64, to: f64, y: f64, confidence: f64) -> Tracked {
        let count = ((to - from) / 2.0) as usize;
        let points = (0..=count).map(|k| Point::new(from + 2.0 * k as f64, y)).collect();
        Tracked { track, stroke: Stroke { points, ..Stroke::default() }, confidence }
    }

    fn ends(shown: &[Tracked]) -> Vec<(usize, f64, f64)> {
        let of = |s: &Tracked| (s.track, s.stroke.points[0].x, s.stroke.points[s.stroke.points.len() - 1].x);
        shown.iter().map(of).collect()
    }

    #[test]
    fn of_strokes_on_the_same_ink_the_better_one_is_there_and_the_other_as_far_as_it_alone_explains_ink() {
        let drawing = drawing();
        let strokes = [line(1, 40.0, 108.0, 30.2, 0.4), line(2, 11.0, 71.0, 30.0, 0.9), line(3, 20.0, 50.0, 30.4, 0.7)];
        let shown = Shown::default().of(&strokes, &drawing);
        let found = ends(&shown);
        assert_eq!(found.iter().map(|own| own.0).collect::<Vec<_>>(), [1, 2], "all of stroke 3 is stroke 2's");
        assert!((found[0].1 - 72.0).abs() <= 4.0 && found[0].2 == 108.0, "{found:?}");
        assert_eq!((found[1].1, found[1].2), (11.0, 71.0));
    }

    #[test]
    fn a_speck_that_nobody_else_explains_stays() {
        let speck = line(4, 60.0, 62.0, 30.0, 0.1);
        assert_eq!(Shown::default().of(std::slice::from_ref(&speck), &drawing()).len(), 1);
        assert_eq!(ends(&Shown::default().of(&[speck, line(2, 11.0, 71.0, 30.0, 0.9)], &drawing())), [(2, 11.0, 71.0)]);
    }

    #[test]
    fn strokes_that_were_drawn_on_each_other_stay() {
        let drawing = drawing();
        let strokes = [line(1, 11.0, 101.0, 30.0, 0.9), line(2, 20.0, 60.0, 30.4, 0.7)];
        let mut shown = Shown::default();
        assert_eq!(shown.of(&strokes, &drawing).len(), 1);
        shown.learn(&strokes, &drawing);
        assert_eq!(shown.of(&strokes, &drawing), strokes);
    }

    #[test]
    fn what_lies_over_blank_paper_is_not_there() {
        let drawing = drawing();
        let at = |k: usize| Point::new(160.0, 60.0) + Point::from_angle(k as f64 / 40.0 * std::f64::consts::TAU) * 30.0;
        let ring = Stroke {
            points: (0..40).map(at).collect(),
            closed: true,
            fill_colour: Some([0.5; 3]),
            ..Stroke::default()
        };
        let strokes = [Tracked { confidence: 0.4, ..Tracked::sure(1, ring) }, line(2, 20.0, 100.0, 90.0, 0.7)];
        let shown = Shown::default().of(&strokes, &drawing);
        assert_eq!(shown.len(), 1, "no ink is below stroke 2");
        let Stroke { points, closed, fill_colour, .. } = &shown[0].stroke;
        assert!(!closed && fill_colour.is_none());
        assert!(points.len() > 17 && points.iter().all(|p| p.x > 156.0), "{points:?}");
    }
}
