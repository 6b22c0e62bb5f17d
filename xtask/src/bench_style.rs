//! `bench-style`: factorisation beside scikit-learn, reshaping beside libigl.
//!
//! Makes a Python environment under `target/bench-style`, builds the optimised program, and runs `tests/bench_style.py`, which
//! says what is measured and how.

use crate::python;
use crate::shell::{cargo, command, root, run, target};
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// Peers, beside NumPy.
const PYTHON: [&str; 3] = ["numpy", "scikit-learn==1.9.1", "libigl==2.6.3"];

/// What to measure.
#[derive(Args)]
pub struct Arguments {
    /// A clips document whose postures are factored; made-up gaits where none is given.
    #[arg(long)]
    clips: Option<PathBuf>,
}

/// Measures.
pub fn bench_style(arguments: &Arguments) -> Result<()> {
    eprintln!("building the optimised benchmark");
    run(cargo().args(["build", "--quiet", "--release", "-p", "rototoon-tests", "--bin", "bench-style"]))?;
    let own = target().join("release").join(format!("bench-style{}", std::env::consts::EXE_SUFFIX));
    let interpreter = python::venv("bench-style/venv", &python::find_any()?, &PYTHON)?;
    let mut measure = command(&interpreter);
    measure.arg(root().join("tests/bench_style.py")).arg("--own").arg(own);
    if let Some(clips) = &arguments.clips {
        measure.arg("--clips").arg(clips);
    }
    run(&mut measure)
}
