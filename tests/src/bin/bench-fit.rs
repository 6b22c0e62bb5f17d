//! Measures the time of the default fit, for `tests/bench_fit.py`.
//!
//! `bench-fit TOLERANCE` reads a file of curves from standard input and writes a JSON list. Each entry has a curve's guiding
//! points, corners and error, and the milliseconds of the fastest of [`ROUNDS`] fits on one thread.

use anyhow::{Context, Result};
use clap::Parser;
use rototoon::fit::{Options, fit};
use rototoon::project::curves::Curves;
use serde_json::json;
use std::io::Read;
use std::time::Instant;

/// Number of fits of each curve.
const ROUNDS: usize = 40;

#[derive(Parser)]
#[command(about = "Measures the time of the default fit on curves from standard input")]
struct Arguments {
    /// Tolerance in pixels.
    tolerance: f64,
}

fn main() -> Result<()> {
    let Arguments { tolerance } = Arguments::parse();
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let curves = Curves::from_json(&text, "standard input")?;
    let mut results = Vec::new();
    for line in &curves.curves {
        let mut best = None;
        let mut ms = f64::INFINITY;
        for _ in 0..ROUNDS {
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
