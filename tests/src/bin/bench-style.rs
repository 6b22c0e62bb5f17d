//! Makes measurements for `tests/bench_style.py` and `tests/bench_style_paper.py`: the factorisation of postures,
//! as-rigid-as-possible manipulation, bent limbs, overlap order, translation.
//!
//! It reads one job from standard input and writes the result to standard output, both as JSON. Times are in seconds, one
//! per repetition.

use anyhow::{Context, Result, bail};
use faer::Mat;
use rototoon::geometry::Point;
use rototoon::project::clips::Clips;
use rototoon::reshape::arap::{Mesh, Solver, deform};
use rototoon::style::factorisation::{Options, factor};
use rototoon_tests::stylebench::{limbs, order, translation};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Instant;

#[derive(Deserialize)]
struct Job {
    #[serde(default = "once")]
    repetitions: usize,
    #[serde(flatten)]
    what: What,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum What {
    Factor(Postures),
    Reshape(Reshaping),
    Limbs {},
    Order {},
    Translate {
        /// A file of clips.
        clips: PathBuf,
        /// The character whose motions are used; by default "normal" or else the first character.
        content: Option<String>,
    },
}

fn once() -> usize {
    1
}

#[derive(Deserialize)]
struct Postures {
    /// One row per posture.
    rows: Vec<Vec<f64>>,
    rank: usize,
    rounds: usize,
    /// Whether to return the codes.
    #[serde(default)]
    codes: bool,
}

#[derive(Deserialize)]
struct Reshaping {
    vertices: Vec<[f64; 2]>,
    triangles: Vec<[usize; 3]>,
    handles: Vec<usize>,
    /// The new positions of the handles.
    places: Vec<[f64; 2]>,
}

#[derive(Serialize)]
struct Factored {
    error: f64,
    seconds: Vec<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    codes: Vec<Vec<f64>>,
}

#[derive(Serialize)]
struct Reshaped {
    prepare: Vec<f64>,
    frame: Vec<f64>,
    /// Largest distance between vertices of the reused solver and of the one-shot function.
    apart: f64,
    vertices: Vec<[f64; 2]>,
}

fn main() -> Result<()> {
    let job: Job = serde_json::from_reader(std::io::stdin().lock()).context("standard input: expected a job")?;
    if job.repetitions == 0 {
        bail!("repetitions: found 0, expected at least 1");
    }
    let result = match job.what {
        What::Factor(postures) => serde_json::to_string(&factored(&postures, job.repetitions)?)?,
        What::Reshape(reshaping) => serde_json::to_string(&reshaped(&reshaping, job.repetitions)?)?,
        What::Limbs {} => serde_json::to_string(&limbs::measure()?)?,
        What::Order {} => serde_json::to_string(&order::measure()?)?,
        What::Translate { clips, content } => {
            serde_json::to_string(&translation::measure(&Clips::load(&clips)?, content.as_deref())?)?
        }
    };
    println!("{result}");
    Ok(())
}

fn factored(job: &Postures, repetitions: usize) -> Result<Factored> {
    let columns = job.rows.first().map_or(0, Vec::len);
    if job.rows.iter().any(|row| row.len() != columns) {
        bail!("rows: found rows of different lengths, expected {columns} numbers in each");
    }
    let x = Mat::from_fn(job.rows.len(), columns, |i, j| job.rows[i][j]);
    let options = Options { rank: job.rank, rounds: job.rounds, tolerance: 0.0, ..Options::default() };
    let (mut error, mut seconds, mut codes) = (f64::NAN, Vec::new(), Vec::new());
    for _ in 0..repetitions {
        let start = Instant::now();
        let found = factor(x.as_ref(), &[], &options)?;
        seconds.push(start.elapsed().as_secs_f64());
        error = found.error;
        if job.codes {
            codes = found.codes.row_iter().map(|row| row.iter().copied().collect()).collect();
        }
    }
    Ok(Factored { error, seconds, codes })
}

fn reshaped(job: &Reshaping, repetitions: usize) -> Result<Reshaped> {
    let points = |all: &[[f64; 2]]| all.iter().map(|&[x, y]| Point::new(x, y)).collect::<Vec<Point>>();
    let places = points(&job.places);
    let mesh = Mesh::new(points(&job.vertices), job.triangles.clone())?;
    let (mut prepare, mut frame, mut vertices) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..repetitions {
        let start = Instant::now();
        let mut solver = Solver::new(mesh.clone(), &job.handles)?;
        prepare.push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        vertices = solver.solve(&places)?;
        frame.push(start.elapsed().as_secs_f64());
    }
    let once = deform(&mesh, &job.handles, &places)?;
    let apart = vertices.iter().zip(&once).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    Ok(Reshaped { prepare, frame, apart, vertices: vertices.iter().map(|p| [p.x, p.y]).collect() })
}
