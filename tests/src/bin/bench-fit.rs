//! Measures the default fit, and kurbo's, for `tests/bench_fit.py`.
//!
//! `bench-fit TOLERANCE` reads a file of curves from standard input and writes a JSON list. Each entry has a curve's guiding
//! points, corners and error, and the milliseconds of the fastest of `--rounds` fits on one thread.
//!
//! `bench-fit --kurbo A,B,…` simplifies the first curve with kurbo, for each accuracy. Each entry has the cubics and the
//! milliseconds. kurbo is told the angle below which a join is smooth; the fewest pieces of three such angles count.

use anyhow::{Context, Result};
use clap::Parser;
use kurbo::simplify::{SimplifyOptions, simplify_bezpath};
use kurbo::{BezPath, CubicBez};
use rototoon::fit::{Options, fit};
use rototoon::geometry::Point;
use rototoon::project::curves::Curves;
use serde_json::{Value, json};
use std::io::Read;
use std::time::Instant;

/// Tangents of the angles below which kurbo takes a join as smooth: none is a corner, corners from 60°, corners from 30°.
const SMOOTH: [f64; 3] = [1e9, 1.73, 0.577];

#[derive(Parser)]
#[command(about = "Measures fits of curves from standard input")]
struct Arguments {
    /// Tolerance in pixels.
    #[arg(default_value_t = 1.0)]
    tolerance: f64,
    /// Number of fits of each curve.
    #[arg(long, default_value_t = 40)]
    rounds: usize,
    /// Fits with kurbo at these accuracies instead.
    #[arg(long, value_delimiter = ',')]
    kurbo: Vec<f64>,
}

fn main() -> Result<()> {
    let Arguments { tolerance, rounds, kurbo } = Arguments::parse();
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let curves = Curves::from_json(&text, "standard input")?;
    let mut results = Vec::new();
    if !kurbo.is_empty() {
        let line = curves.curves.first().context("found no curve")?;
        results.extend(kurbo.iter().map(|&accuracy| simplified(&line.points, line.closed, accuracy, rounds)));
        println!("{}", json!(results));
        return Ok(());
    }
    for line in &curves.curves {
        let mut best = None;
        let mut ms = f64::INFINITY;
        for _ in 0..rounds {
            let start = Instant::now();
            let fitted = fit(&line.points, line.closed, &Options::new(tolerance))?;
            ms = ms.min(1e3 * start.elapsed().as_secs_f64());
            best = Some(fitted);
        }
        let fitted = best.context("no rounds")?;
        let guides: Vec<_> = fitted.spline.guides().iter().map(|g| [g.x, g.y]).collect();
        let corners = fitted.spline.corners();
        results.push(json!({"guides": guides, "corners": corners, "max_error": fitted.max_error, "ms": ms}));
    }
    println!("{}", json!(results));
    Ok(())
}

/// kurbo's curve with the fewest pieces.
fn simplified(points: &[Point], closed: bool, accuracy: f64, rounds: usize) -> Value {
    let mut path = BezPath::new();
    let at = |p: &Point| kurbo::Point::new(p.x, p.y);
    path.move_to(at(&points[0]));
    let rest = points.windows(2).filter(|pair| pair[0] != pair[1]).map(|pair| &pair[1]);
    rest.chain(closed.then(|| &points[0])).for_each(|p| path.line_to(at(p)));
    let mut best: Option<(Vec<CubicBez>, f64)> = None;
    for smooth in SMOOTH {
        let options = SimplifyOptions::default().angle_thresh(smooth);
        let mut ms = f64::INFINITY;
        let mut cubics: Vec<CubicBez> = Vec::new();
        for _ in 0..rounds {
            let start = Instant::now();
            let found = simplify_bezpath(path.elements().iter().copied(), accuracy, &options);
            ms = ms.min(1e3 * start.elapsed().as_secs_f64());
            cubics = found.segments().map(|segment| segment.to_cubic()).collect();
        }
        if best.as_ref().is_none_or(|(old, _)| cubics.len() < old.len()) {
            best = Some((cubics, ms));
        }
    }
    let (cubics, ms) = best.unwrap_or_default();
    let xy = |p: kurbo::Point| [p.x, p.y];
    let cubics: Vec<_> = cubics.iter().map(|c| [xy(c.p0), xy(c.p1), xy(c.p2), xy(c.p3)]).collect();
    json!({"cubics": cubics, "ms": ms})
}
