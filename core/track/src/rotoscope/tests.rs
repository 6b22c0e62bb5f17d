//! Test data for the terms, and the complete Jacobian of a term.

use super::curve::Curve;
use super::pose::Pose;
use super::views::{LEVELS, Scenery, View};
use super::{Handle, MOST_HANDLES, Sink, Term};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::gradient_check::{WorstEntry, worst_entry};
use rototoon_base::numeric::sparse_least_squares::Problem;
use rototoon_base::scene::Raster;
use rototoon_image::pyramid::Pyramid;
use std::sync::Arc;

/// Irregular curves without symmetry: 4 frames of `points` points.
pub fn curve_case(points: usize, closed: bool) -> (Curve, Vec<Point>) {
    let at = |k: usize| {
        let (frame, j) = (k / points, k % points);
        let angle = j as f64 * std::f64::consts::TAU / points as f64;
        let radius = 18.0 + (1.7 * k as f64).sin() * 2.0;
        Point::from_angle(angle + 0.1 * frame as f64) * radius + Point::new(60.3 + frame as f64, 58.4)
    };
    let x: Vec<Point> = (0..4 * points).map(at).collect();
    (Curve::new([&x[..points], &x[3 * points..]], closed), x)
}

/// The pose of all frames.
pub fn pose(curve: &Curve, x: &[Point]) -> Pose {
    Pose::new(curve, x.chunks(curve.points))
}

/// Four pictures of planes, one plane per channel, that shift by (2, 1) per frame. Bilinear reading is exact and has no
/// creases.
pub fn scenery() -> Scenery {
    scenery_with(&vec![Vec::new(); 4])
}

/// The same pictures, hidden by nearer contours, by frame.
pub fn scenery_with(occluders: &[Vec<Vec<Point>>]) -> Scenery {
    let view = |frame: usize| -> Arc<View> {
        let picture = Raster::from_fn(128, 128, |x, y| {
            let (x, y) = (x as f32 + 0.5 - 2.0 * frame as f32, y as f32 + 0.5 - frame as f32);
            [20.0 + 0.7 * x - 0.2 * y, 60.0 + 0.9 * y, 200.0 - 0.6 * x - 0.4 * y, 10.0 + 0.2 * x + 0.25 * y]
        });
        Arc::new(Pyramid::new(picture, LEVELS, 0.0))
    };
    Scenery::new((0..4).map(view).collect(), occluders)
}

/// Number of residuals, and the sum of their squares and of the constants, over all frames of `x`.
pub fn residuals(term: &impl Term, curve: &Curve, x: &[Point]) -> (usize, f64) {
    let mut rows = Rows::new(curve);
    rows.walk(term, x);
    (rows.values.len(), rows.values.iter().map(|v| v * v).sum::<f64>() + rows.constants)
}

/// The entry of a term's Jacobian that differs most from the difference quotient, for a term in f64.
pub fn worst(term: &impl Term, curve: &Curve, x: &[Point]) -> Option<WorstEntry> {
    worst_with_step(term, curve, x, 1e-5)
}

/// The same for a term that reads f32 pictures, with a longer step.
pub fn worst_of_pictures(term: &impl Term, curve: &Curve, x: &[Point]) -> Option<WorstEntry> {
    worst_with_step(term, curve, x, 1e-2)
}

fn worst_with_step(term: &impl Term, curve: &Curve, x: &[Point], step: f64) -> Option<WorstEntry> {
    let whole = Whole { term, curve, points: x.len() };
    let flat: Vec<f64> = x.iter().flat_map(|p| [p.x, p.y]).collect();
    worst_entry(&whole, &flat, step)
}

/// Collects residuals and the Jacobian's entries by control point.
struct Rows<'a> {
    curve: &'a Curve,
    frame: usize,
    handles: Vec<(usize, Vec<(usize, f64)>)>,
    values: Vec<f64>,
    entries: Vec<(usize, usize, f64)>,
    constants: f64,
}

impl<'a> Rows<'a> {
    fn new(curve: &'a Curve) -> Self {
        Self { curve, frame: 0, handles: Vec::new(), values: Vec::new(), entries: Vec::new(), constants: 0.0 }
    }

    fn walk(&mut self, term: &impl Term, x: &[Point]) {
        let pose = pose(self.curve, x);
        for frame in 0..pose.frames() - 1 {
            self.frame = frame;
            term.walk(frame, &pose, self);
        }
    }
}

impl Sink for Rows<'_> {
    const SLOPES: bool = true;

    fn open(&mut self, handles: &[Handle<'_>]) {
        assert!(handles.len() <= MOST_HANDLES);
        let read = |h: &Handle<'_>| (self.frame + usize::from(h.later), h.functional.entries().collect());
        self.handles = handles.iter().map(read).collect();
    }

    fn residual(&mut self, value: f64, by: &[Point]) {
        assert_eq!(by.len(), self.handles.len());
        let row = self.values.len();
        self.values.push(value);
        for ((frame, entries), by) in self.handles.iter().zip(by) {
            for &(point, weight) in entries {
                let column = 2 * (frame * self.curve.points + point);
                self.entries.push((row, column, weight * by.x));
                self.entries.push((row, column + 1, weight * by.y));
            }
        }
    }

    fn close(&mut self) {
        self.handles.clear();
    }

    fn constant(&mut self, cost: f64) {
        self.constants += cost;
    }
}

struct Whole<'a, T> {
    term: &'a T,
    curve: &'a Curve,
    points: usize,
}

impl<T: Term> Whole<'_, T> {
    fn rows(&self, x: &[f64]) -> Rows<'_> {
        let points: Vec<Point> = x.chunks(2).map(|p| Point::new(p[0], p[1])).collect();
        let mut rows = Rows::new(self.curve);
        rows.walk(self.term, &points);
        rows
    }

    fn start(&self) -> Vec<f64> {
        // The pattern and the number of rows are the same for every x for which all places stay in the picture.
        let (_, x) = curve_case(self.curve.points, self.curve.chords.len() == self.curve.places.len());
        x.iter().flat_map(|p| [p.x, p.y]).collect()
    }
}

impl<T: Term> Problem for Whole<'_, T> {
    fn variables(&self) -> usize {
        2 * self.points
    }

    fn residuals(&self) -> usize {
        self.rows(&self.start()).values.len()
    }

    fn pattern(&self) -> Vec<(usize, usize)> {
        self.rows(&self.start()).entries.iter().map(|&(row, column, _)| (row, column)).collect()
    }

    fn evaluate(&self, x: &[f64], residuals: &mut [f64]) {
        residuals.copy_from_slice(&self.rows(x).values);
    }

    fn linearise(&self, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let rows = self.rows(x);
        residuals.copy_from_slice(&rows.values);
        jacobian.iter_mut().zip(&rows.entries).for_each(|(slot, &(_, _, value))| *slot = value);
    }
}

/// The residuals, and the row of the Jacobian of each as entries (coordinate, derivative).
pub fn jacobian(term: &impl Term, curve: &Curve, x: &[Point]) -> (Vec<f64>, Vec<Vec<(usize, f64)>>) {
    let mut rows = Rows::new(curve);
    rows.walk(term, x);
    let mut jacobian = vec![Vec::new(); rows.values.len()];
    rows.entries.iter().for_each(|&(row, column, value)| jacobian[row].push((column, value)));
    (rows.values, jacobian)
}
