//! Solid blacks: pupils, boots, spotted blacks. They are shapes with an outline, not lines.
//!
//! **What is too fat for lines.** Two lines of one width w that cross at any angle, that meet in a corner, or that run beside
//! each other hold no disc of ink of a radius above w. So lines that were drawn twice, side by side, hold none above 2w
//! where they cross. Single lines through one point reach that radius only if there are more than six: with n of them it is
//! w / (2 sin(90°/n)). Pixels of ink that are [`FAT`] w deep or deeper are the *cores* of what may be solid. w is the usual
//! width of the drawing's lines.
//!
//! **Solid or hatched.** Lines that were drawn close to each other leave seams that are less dark. A core with seams within
//! its discs of ink is hatching or a scribble, which stays lines.
//!
//! **Line or shape.** A brush line that swells has a core too. There the medial axis is long against the width
//! ([`LONG`]), as that of a line is, and so has a ring whose hole is broader than its line. The stretch that counts goes on
//! while it is at least half as thick as the core. Then the core is compared with that line's width instead: cores above
//! [`FAT`] times *it* are looked for within. A core without such a line is a shape.
//!
//! **The shape** is the union of the discs of ink whose centres are in the core, and what hangs on it and is short against
//! its base: the tip of a star, the fillet beside a line. What is longer is a line that ends at the shape. The outline is
//! where the ink is half as dark as within.
//!
//! **Limits.** A shape that is long against its width, such as a black sleeve, is a line of that width. A hole smaller than
//! a line is broad is not seen.

use crate::graph::{Branch, Graph};
use crate::ink::Ink;
use crate::ink::{discs, distance};
use crate::outline::outlines;
use crate::strokes::Walked;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::Raster;
use std::ops::Range;

/// Radius of a disc of ink that lines do not make, in widths.
const FAT: f64 = 2.0;
/// The least such radius in pixels: thinner blots are grain.
const LEAST: f64 = 2.5;
/// Length of the medial axis of a line, in widths.
const LONG: f64 = 4.0;
/// As [`LONG`], of a ring whose hole is as broad as its line.
const LONG_RING: f64 = std::f64::consts::TAU;
/// Length of what belongs to a shape and hangs on it, in halves of its base.
const TIP: f64 = 3.0;
/// A seam is less dark than this share of the ink on both sides of it.
const EVEN: f32 = 0.9;
/// A shape is even if no more than one pixel in so many is on a seam.
const SEAMS: usize = 20;
/// Places on each side of a pixel at which the ink beside a seam is looked for.
const PROBES: usize = 8;
/// Width of lines where there is none, in pixels of 540 lines.
const PEN: f64 = 3.0;

/// The solid shapes of a drawing, the largest first, and the ink without them.
pub struct Solids {
    /// Outlines of shapes and of their holes. Each lies over those before it.
    pub outlines: Vec<Vec<Point>>,
    /// The usual width of the lines beside them, in pixels.
    pub width: f64,
    /// The ink that is left.
    pub lines: Raster<bool>,
    shapes: Raster<bool>,
}

impl Solids {
    /// Finds the solid shapes of an ink with its graph, whose branches are at the centres of pixels. `None` if there is none.
    pub fn new(ink: &Ink, graph: &Graph, unit: f64) -> Option<Self> {
        let width = usual_width(graph).unwrap_or(PEN * unit);
        let mut cores = Cores { ink, graph, found: Vec::new() };
        let all: Vec<usize> = (0..ink.mask.data().len()).collect();
        cores.search(&all, (FAT * width).max(LEAST));
        if cores.found.is_empty() {
            return None;
        }
        let shapes = shapes(ink, &cores.found);
        let mut outlines = outlined(ink, &shapes, width);
        outlines.sort_by(|a, b| area(b).total_cmp(&area(a)));
        let lines = Raster::from_fn(shapes.width(), shapes.height(), |x, y| ink.mask.get(x, y) && !shapes.get(x, y));
        (!outlines.is_empty()).then_some(Self { outlines, width, lines, shapes })
    }

    /// A mask with the shapes in it.
    pub fn with(&self, mask: &Raster<bool>) -> Raster<bool> {
        let at = |x, y| mask.get(x, y) || self.shapes.get(x, y);
        Raster::from_fn(mask.width(), mask.height(), at)
    }
}

fn area(outline: &[Point]) -> f64 {
    polygon::signed_area(outline).abs()
}

/// Lengthens lines that end at a solid shape to its outline. `width` is the usual width of lines.
pub fn met(strokes: &mut [Walked], width: f64) {
    let outlines: Vec<Vec<Point>> = strokes.iter().filter(|s| s.fill).map(|s| s.points.clone()).collect();
    if outlines.is_empty() {
        return;
    }
    for stroke in strokes.iter_mut().filter(|s| !s.fill && !s.closed && !s.points.is_empty()) {
        for side in 0..2 {
            let (end, radius) = if side == 0 {
                (stroke.points[0], stroke.radii[0])
            } else {
                (stroke.points[stroke.points.len() - 1], stroke.radii[stroke.radii.len() - 1])
            };
            let reach = width.max(2.0 * radius) + 1.0;
            let nearest =
                |outline: &Vec<Point>| outline.iter().map(|&p| (p.distance(end), p)).min_by(|a, b| a.0.total_cmp(&b.0));
            let found = outlines.iter().filter_map(nearest).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, place)) = found.filter(|found| stroke.free[side] && found.0 <= reach) else { continue };
            stroke.free[side] = false;
            let at = if side == 0 { 0 } else { stroke.points.len() };
            stroke.points.insert(at, place);
            stroke.radii.insert(at, radius);
        }
    }
}

/// The usual width of what is a line by its shape: the middle one of all points of branches that are long.
fn usual_width(graph: &Graph) -> Option<f64> {
    let long =
        |points: &[Point], radii: &[f64], closed: bool| polyline::length(points, closed) >= LONG * 2.0 * mean(radii);
    let lines = graph.branches.iter().filter(|b| long(&b.points, &b.radii, b.closed));
    middle(lines.flat_map(|branch| branch.radii.iter().copied()).collect()).map(|radius| 2.0 * radius)
}

fn middle(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Half the width of the ink around a pixel.
fn radius(ink: &Ink, pixel: usize) -> f64 {
    f64::from(ink.depth.data()[pixel]) - 0.5
}

/// The search for the cores of solid shapes.
struct Cores<'a> {
    ink: &'a Ink,
    graph: &'a Graph,
    /// The pixels within the discs of ink around each core.
    found: Vec<Vec<usize>>,
}

impl Cores<'_> {
    /// Looks among pixels for cores in which the ink is at least `level` pixels deep.
    fn search(&mut self, among: &[usize], level: f64) {
        let deep: Vec<usize> = among.iter().copied().filter(|&i| radius(self.ink, i) >= level).collect();
        for core in components(&deep, self.ink.mask.width(), self.ink.mask.height()) {
            match self.broadest_line(&core, level) {
                None => {
                    let shape = discs::union(&self.ink.depth, &core);
                    if is_even(self.ink, &shape, 0.5 * level) {
                        self.found.push(shape);
                    }
                }
                // The line is at least half as thick as the core's run, and so the level rises.
                Some(width) => self.search(&core, FAT * width),
            }
        }
    }

    /// The width of the broadest line that runs through a core.
    fn broadest_line(&self, core: &[usize], level: f64) -> Option<f64> {
        let columns = self.ink.mask.width();
        let within = |p: &Point| core.binary_search(&(p.y as usize * columns + p.x as usize)).is_ok();
        let lines = self.graph.branches.iter().flat_map(|branch| {
            let on: Vec<bool> =
                branch.points.iter().zip(&branch.radii).map(|(p, &r)| r >= level && within(p)).collect();
            runs(&on).into_iter().filter_map(|run| line_width(branch, run)).collect::<Vec<f64>>()
        });
        lines.max_by(f64::total_cmp)
    }
}

/// The stretches of a list that are on.
fn runs(on: &[bool]) -> Vec<Range<usize>> {
    let mut at = 0;
    let all = on.chunk_by(|a, b| a == b).map(|run| {
        at += run.len();
        (run[0], at - run.len()..at)
    });
    all.filter(|(on, _)| *on).map(|(_, run)| run).collect()
}

/// The width of the line that a run on a branch is the thickest part of; `None` if that is no line. The line goes on while
/// it is at least half as thick as the run.
fn line_width(branch: &Branch, run: Range<usize>) -> Option<f64> {
    let radii = &branch.radii;
    let least = 0.5 * mean(&radii[run.clone()]);
    let before = radii[..run.start].iter().rev().take_while(|&&r| r >= least).count();
    let behind = radii[run.end..].iter().take_while(|&&r| r >= least).count();
    let own = run.start - before..run.end + behind;
    let closed = branch.closed && own.len() == radii.len();
    let width = 2.0 * middle(radii[own.clone()].to_vec())?;
    let ring = branch.closed || branch.ends[0].is_some() && branch.ends[0] == branch.ends[1];
    let long = if ring { LONG_RING } else { LONG };
    (polyline::length(&branch.points[own.clone()], closed) >= long * 2.0 * mean(&radii[own])).then_some(width)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Whether the ink of a shape is even, without seams between lines. What is less than `edge` pixels deep does not count.
fn is_even(ink: &Ink, shape: &[usize], edge: f64) -> bool {
    let (columns, reach) = (ink.mask.width(), 2.0 * edge);
    let inner: Vec<usize> = shape.iter().copied().filter(|&i| f64::from(ink.depth.data()[i]) >= edge).collect();
    let seams = inner.iter().filter(|&&i| is_seam(&ink.darkness, (i % columns, i / columns), reach)).count();
    SEAMS * seams <= inner.len()
}

/// Whether a pixel is less dark than ink on both sides of it, in one of four directions, not farther than `reach`. So what
/// grows slowly darker or lighter, as the estimate of the paper does, has no seams.
fn is_seam(darkness: &Raster<f32>, (x, y): (usize, usize), reach: f64) -> bool {
    let own = darkness.get(x, y);
    let darkest = |(dx, dy): (f64, f64)| {
        let at = |k: usize| {
            let far = reach * k as f64 / PROBES as f64;
            darkness.clamped((x as f64 + far * dx).round() as isize, (y as f64 + far * dy).round() as isize)
        };
        (1..=PROBES).map(at).fold(0.0, f32::max)
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    [(1.0, 0.0), (0.0, 1.0), (half, half), (half, -half)]
        .into_iter()
        .any(|(dx, dy)| own < EVEN * darkest((dx, dy)).min(darkest((-dx, -dy))))
}

/// The pixels of shapes, with what hangs on them and is short.
fn shapes(ink: &Ink, found: &[Vec<usize>]) -> Raster<bool> {
    let (columns, rows) = (ink.mask.width(), ink.mask.height());
    let mut shape = Raster::new(columns, rows, false);
    found.iter().flatten().for_each(|&i| shape.data_mut()[i] = true);
    // What is left of the ink beside them.
    let away = distance::inside(&shape.map(|on| !on));
    let left: Vec<usize> = (0..columns * rows).filter(|&i| ink.mask.data()[i] && !shape.data()[i]).collect();
    for part in components(&left, columns, rows) {
        let base = part.iter().filter(|&&i| away.data()[i] < 2.0).map(|&i| radius(ink, i)).fold(0.0, f64::max);
        let far = part.iter().map(|&i| f64::from(away.data()[i])).fold(0.0, f64::max);
        if base > 0.0 && far <= TIP * base.max(1.0) {
            part.iter().for_each(|&i| shape.data_mut()[i] = true);
        }
    }
    shape
}

/// The outlines of shapes and of their holes.
fn outlined(ink: &Ink, shapes: &Raster<bool>, width: f64) -> Vec<Vec<Point>> {
    let (columns, rows) = (shapes.width(), shapes.height());
    let pixels: Vec<usize> = (0..columns * rows).filter(|&i| shapes.data()[i]).collect();
    let mut found = Vec::new();
    for part in components(&pixels, columns, rows) {
        let dark = part.iter().map(|&i| f64::from(ink.darkness.data()[i])).collect();
        let half = 0.5 * middle(dark).unwrap_or(0.0) as f32;
        let (low, field) = field(ink, &part, half);
        let at = |points: Vec<Point>| points.into_iter().map(|p| p + low).collect::<Vec<Point>>();
        let mut loops: Vec<Vec<Point>> = outlines(&field).into_iter().map(at).collect();
        loops.sort_by(|a, b| polygon::signed_area(b).total_cmp(&polygon::signed_area(a)));
        // Of the outer ones the largest counts: others are crumbs of its edge.
        for (k, points) in loops.into_iter().enumerate() {
            let area = polygon::signed_area(&points);
            if k == 0 && area > 0.0 || area < -width * width {
                found.push(points);
            }
        }
    }
    found
}

/// The darkness of a part above `half`, with a margin, and the place of its first pixel. Ink of lines beside the part is not
/// of the part.
fn field(ink: &Ink, part: &[usize], half: f32) -> (Point, Raster<f32>) {
    const MARGIN: isize = 3;
    let (columns, rows) = (ink.mask.width() as isize, ink.mask.height() as isize);
    let place = |i: usize| (i as isize % columns, i as isize / columns);
    let (mut low, mut high) = ((isize::MAX, isize::MAX), (0, 0));
    for (x, y) in part.iter().map(|&i| place(i)) {
        low = (low.0.min(x), low.1.min(y));
        high = (high.0.max(x), high.1.max(y));
    }
    let low = (low.0 - MARGIN, low.1 - MARGIN);
    let size = ((high.0 - low.0 + 1 + MARGIN) as usize, (high.1 - low.1 + 1 + MARGIN) as usize);
    let mut own = Raster::new(size.0, size.1, false);
    for (x, y) in part.iter().map(|&i| place(i)) {
        own.set((x - low.0) as usize, (y - low.1) as usize, true);
    }
    let near = |u: usize, v: usize| {
        let around = |n: usize| n.saturating_sub(1)..n + 2;
        around(v).flat_map(|b| around(u).map(move |a| (a, b))).any(|(a, b)| a < size.0 && b < size.1 && own.get(a, b))
    };
    let value = |u: usize, v: usize| {
        let (x, y) = (u as isize + low.0, v as isize + low.1);
        let within = x >= 0 && y >= 0 && x < columns && y < rows;
        if !within || !own.get(u, v) && (ink.mask.get(x as usize, y as usize) || !near(u, v)) {
            return -half.max(1e-3);
        }
        ink.darkness.get(x as usize, y as usize) - half
    };
    (Point::new(low.0 as f64, low.1 as f64), Raster::from_fn(size.0, size.1, value))
}

/// The connected parts of some pixels (with diagonals), each in rising order.
fn components(pixels: &[usize], columns: usize, rows: usize) -> Vec<Vec<usize>> {
    let mut open = Raster::new(columns, rows, false);
    pixels.iter().for_each(|&i| open.data_mut()[i] = true);
    let mut found = Vec::new();
    for &start in pixels {
        if !std::mem::replace(&mut open.data_mut()[start], false) {
            continue;
        }
        let (mut part, mut next) = (vec![start], 0);
        while next < part.len() {
            let (x, y) = (part[next] % columns, part[next] / columns);
            next += 1;
            for v in y.saturating_sub(1)..(y + 2).min(rows) {
                for u in x.saturating_sub(1)..(x + 2).min(columns) {
                    if open.get(u, v) {
                        open.set(u, v, false);
                        part.push(v * columns + u);
                    }
                }
            }
        }
        part.sort_unstable();
        found.push(part);
    }
    found
}
