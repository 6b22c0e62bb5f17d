//! Solves a job from coarse to fine.
//!
//! 1. The curves start as the linear blend of the keys. The artist's corrections are spread to the frames around them.
//! 2. On each level of the pyramid, the coarsest first, the [energy](super::energy) is minimised over all frames at
//!    once by [Gauss–Newton in a trust region](rototoon_base::numeric::trust_region). No point moves more than 10 working
//!    pixels per step.
//!
//! The steps come from conjugate gradients, as in the authors' system. JᵀJ is block-tridiagonal with narrow bands and
//! changes with every step, and a step needs no more precision than the region allows. Constraints, and directions
//! without information (a flat area with weak terms), need no special treatment. A factorisation would be no faster and
//! less robust. The authors' region bounds the Euclidean length of all variables together, which makes the steps
//! shorter for more frames and points. Here it bounds every point by itself.
//!
//! Keys, pins and corrected centres are exact.

use super::curve::Curve;
use super::energy::{Energy, Fixed, Method, Weights};
use super::sureness::confidence;
use super::views::{Scenery, Views, working_scale};
use crate::contract::error::TrackError;
use crate::contract::job::{Job, SpanSummary, SpanTrack, Termination};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::trust_region::{Objective, TrustOptions, TrustSummary, TrustTermination, minimise};
use rototoon_base::scene::{Cancelled, FrameNumber, FrameSource, Progress};
use std::ops::ControlFlow;

/// Share of a job's progress for reading the pictures.
const READ: f64 = 0.3;

/// Largest motion of a point in a step, in working pixels.
const RADIUS: f64 = 10.0;

fn options(level: usize) -> TrustOptions {
    TrustOptions {
        radius: RADIUS,
        smallest_radius: if level == 0 { 0.1 } else { 0.5 },
        step_tolerance: 0.1,
        cost_tolerance: 1e-4,
        max_iterations: 60,
        max_directions: 300,
    }
}

/// Solves a job by a method. A job without free frames or points returns the blended keys.
///
/// # Errors
///
/// The error of a picture that cannot be read, or the cancellation by `progress`.
pub fn solve(
    method: &Method,
    views: &Views,
    job: &Job,
    frames: &dyn FrameSource,
    progress: &dyn Progress,
) -> Result<SpanTrack, TrackError> {
    let count = job.span.len();
    if count < 3 || job.keys[0].is_empty() {
        return Ok(job.keys_only());
    }
    let scale = working_scale(job.size.1);
    let scenery = scenery(views, job, frames, progress, scale)?;
    let fixed = fixed(job);
    let start = start(method, job, &scenery, &fixed, scale);
    let curve = Curve::new([&start[0], &start[count - 1]], job.closed);
    let mut x = flat(&start);
    let initial_cost = Energy::new(method, &curve, &scenery, 0, &fixed, &start).cost(&x);
    let (mut iterations, mut last) = (0, None);
    for level in (0..scenery.levels()).rev() {
        let mut energy = Energy::new(method, &curve, &scenery, level, &fixed, &start);
        let done = (scenery.levels() - 1 - level) as f64 / scenery.levels() as f64;
        let report =
            Report { progress, from: READ + (1.0 - READ) * done, share: (1.0 - READ) / scenery.levels() as f64 };
        let summary = on_level(&mut energy, &mut x, &options(level), &report)?;
        iterations += summary.iterations;
        last = Some(summary);
    }
    let working = unflat(&x, curve.points);
    let confidence = confidence(job, &curve, &scenery, &working);
    let mut points: Vec<Vec<Point>> = working.iter().map(|curve| curve.iter().map(|&p| p * scale).collect()).collect();
    points.iter_mut().enumerate().for_each(|(index, curve)| job.enforce(index, curve));
    let summary = SpanSummary {
        termination: last.map_or(Termination::NothingToSolve, |s| termination(s.termination)),
        iterations,
        initial_cost,
        final_cost: last.map_or(initial_cost, |s| s.final_cost),
    };
    Ok(SpanTrack { points, confidence, summary })
}

/// The section of the progress that belongs to one level.
struct Report<'a> {
    progress: &'a dyn Progress,
    from: f64,
    share: f64,
}

fn on_level(
    energy: &mut Energy<'_>,
    x: &mut [f64],
    options: &TrustOptions,
    report: &Report<'_>,
) -> Result<TrustSummary, Cancelled> {
    let mut cancelled = None;
    let summary = minimise(energy, x, options, |iteration| {
        let done = iteration as f64 / options.max_iterations as f64;
        match report.progress.report("Tracking", report.from + report.share * done) {
            Ok(()) => ControlFlow::Continue(()),
            Err(stop) => {
                cancelled = Some(stop);
                ControlFlow::Break(())
            }
        }
    });
    cancelled.map_or(Ok(summary), Err)
}

fn scenery(
    views: &Views,
    job: &Job,
    frames: &dyn FrameSource,
    progress: &dyn Progress,
    scale: f64,
) -> Result<Scenery, TrackError> {
    let numbers: Vec<FrameNumber> = job.span.frames().collect();
    progress.report("Reading frames", 0.0)?;
    let read = |&frame: &FrameNumber| {
        progress.report("Reading frames", 0.0)?;
        views.get(frames, frame)
    };
    let seen = numbers.par_iter().map(read).collect::<Result<Vec<_>, TrackError>>()?;
    let to_working = |contour: &Vec<Point>| contour.iter().map(|&p| p / scale).collect();
    let occluders: Vec<Vec<Vec<Point>>> =
        job.occluders.iter().map(|contours| contours.iter().map(to_working).collect()).collect();
    Ok(Scenery::new(seen, &occluders))
}

/// The blended keys. If the artist corrected something, the curves that minimise E_C and E_V with the corrections
/// fixed. Both terms are quadratic, and without corrections the blend is their minimum.
fn start(method: &Method, job: &Job, scenery: &Scenery, fixed: &Fixed, scale: f64) -> Vec<Vec<Point>> {
    let on_frame = |index: usize| {
        let mut points = job.interpolated(index);
        job.enforce(index, &mut points);
        points.into_iter().map(|p| p / scale).collect::<Vec<Point>>()
    };
    let start: Vec<Vec<Point>> = (0..job.span.len()).map(on_frame).collect();
    if job.corrections.is_empty() {
        return start;
    }
    let shape = Weights { length: 0.0, image: 0.0, edge: 0.0, colours: 0.0, ..method.weights };
    let method = Method { weights: shape, ..method.clone() };
    let curve = Curve::new([&start[0], &start[start.len() - 1]], job.closed);
    let coarsest = scenery.levels() - 1;
    let mut x = flat(&start);
    let anywhere = TrustOptions { radius: f64::MAX.sqrt(), max_iterations: 4, ..options(0) };
    minimise(&mut Energy::new(&method, &curve, scenery, coarsest, fixed, &start), &mut x, &anywhere, |_| {
        ControlFlow::Continue(())
    });
    unflat(&x, curve.points)
}

fn flat(points: &[Vec<Point>]) -> Vec<f64> {
    points.iter().flatten().flat_map(|p| [p.x, p.y]).collect()
}

fn unflat(x: &[f64], points: usize) -> Vec<Vec<Point>> {
    let frame = |x: &[f64]| x.chunks_exact(2).map(|p| Point::new(p[0], p[1])).collect();
    x.chunks_exact(2 * points).map(frame).collect()
}

fn fixed(job: &Job) -> Fixed {
    let last = job.span.len() - 1;
    let points = |index: usize| {
        let pins = job.corrections.get(&index).map(|correction| &correction.pins);
        let pinned = |j: usize| index == 0 || index == last || pins.is_some_and(|pins| pins.contains_key(&j));
        (0..job.keys[0].len()).map(pinned).collect()
    };
    let center = |index: usize| job.corrections.get(&index).is_some_and(|correction| correction.center.is_some());
    Fixed { points: (0..=last).map(points).collect(), centers: (0..=last).map(center).collect() }
}

fn termination(of_solver: TrustTermination) -> Termination {
    match of_solver {
        TrustTermination::StepConverged => Termination::StepConverged,
        TrustTermination::CostConverged => Termination::CostConverged,
        TrustTermination::NoDescent | TrustTermination::Interrupted => Termination::NoDescent,
        TrustTermination::IterationLimit => Termination::IterationLimit,
    }
}
